"""Outputs of linear models: signals, strain gauges and points, and their rows of coordinates and rates."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from gbeam.analysis.system.gauges import Strained
from gbeam.analysis.system.linear import named_acceleration
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import record
from gbeam.arrays.types import Floats
from gbeam.constants import BY_STRAINS
from gbeam.errors import InputError, placing_within
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.guards.quantities import OfKind
from gbeam.integrate.equations import accelerations
from gbeam.mechanics.assembly import replace_stations
from gbeam.mechanics.causes import causes_of
from gbeam.mechanics.fields.basis import FAMILIES
from gbeam.mechanics.reactions import demanded_with_supports
from gbeam.mechanics.recovery import Sections
from gbeam.mechanics.section_forces import sections
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.numerics.series import STEP
from gbeam.results.parts import Base
from gbeam.results.state_space import Gauge, Signal
from gbeam.structure.attachments import TIP
from gbeam.structure.beam import Beam, fibre_strain, names_at


@typed
def surface_gauges(beam: Beam, stations: Annotated[Iterable[float], OfKind("length")]) -> list[Gauge]:
    """Return two gauges at each station, on the extreme fibres towards +z and +y.

    Parameters
    ----------
    beam : Beam
    stations : iterable of float
        From the root, m.

    Raises
    ------
    InputError
        If a station is off the beam, or the extreme fibres of its section are not known.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> [(each.at, each.y, each.z) for each in gb.surface_gauges(beam, [0.01])]
    [(0.01, 0.0, 0.002), (0.01, 0.01, 0.0)]
    """
    gauges: list[Gauge] = []
    for i, station in enumerate(stations):
        with placing_within(f"stations[{i}]"):
            gauges += [surface_gauge(beam, station, face) for face in ("z", "y")]
    return gauges


def surface_gauge(beam: Beam, at: float, face: str) -> Gauge:
    """Return the gauge `at` m from the root, on the extreme fibre towards a face, ``z``, ``-z``, ``y`` or ``-y``."""
    if not 0 <= at <= beam.length:
        raise InputError("", f"is {at:g} m, off the beam", f"give 0 to {beam.length:g} m")
    sign, axis = -1.0 if face.startswith("-") else 1.0, face[-1]
    fibre = sign * float(getattr(beam.section.at(at), f"extreme_fibre_{axis}"))
    if not math.isfinite(fibre):
        raise InputError("", "needs the extreme fibres", "add extreme_fibre_y and extreme_fibre_z to beam.section")
    return Gauge(at, y=fibre) if axis == "y" else Gauge(at, z=fibre)


BASE_RATES = tuple(Signal(f"base_rate_{i}", "rad/s") for i in "xyz")


@record
class Outputs:
    """Outputs of one body as a function of y, ẏ, ÿ and the inputs u of its system, in axes of its base.

    They are displacement and absolute acceleration of the tip, root moment, strains, displacement and acceleration of
    other `points` (numbers of stations), and a free hub's angle and rate. Strains of beams are section forces times
    `strains` (gauges, 6) at the sections `at`. Those of solids are their causes times `shares` (gauges, n + h). The
    first inputs are the torque on a free hub, or the base's acceleration, angular velocity and angular acceleration.
    The components of the loads follow.
    """

    structure: Structure
    tree: Tree
    outboard: Sections
    at: Array
    strains: Array
    shares: Array
    points: Array
    drives: Inputs

    @property
    def first_coordinate(self) -> int:
        """Index of the body's first coordinate in y: 1 behind the angle of a free hub."""
        return len(self.tree.unknowns) - self.structure.size

    @property
    def holding_inputs(self) -> Array:
        """Inputs u (m,) that hold the state."""
        drives, ground = self.drives, self.drives.ground
        efforts: Any = drives.efforts
        driven = [efforts[self.tree.unknowns[:1]]] if self.first_coordinate else [ground.a, ground.w, ground.alpha]
        loads = np.zeros(0) if drives.loads[-1] is None else np.ravel(drives.loads[-1])
        return np.concatenate([*driven, loads[: len(loads) - self.idle]])

    @property
    def idle(self) -> int:
        """Number of components of the loads that are no inputs: of a temperature, behind them, all but the first."""
        return 5 * self.structure.heated

    def __call__(self, y: Array, yd: Array, ydd: Array, u: Array) -> Array:
        """Outputs (t, p) of states (t, n) and inputs (t, m)."""
        i, inputs = self.first_coordinate, self.inputs(u)
        q, qd, qdd = y[:, i:], yd[:, i:], ydd[:, i:]
        root = self.tree.motion(y, yd, ydd, inputs).roots[-1]
        base = Base(root.a, root.w, root.alpha)
        loads = inputs.loads[-1]
        hung = demanded_with_supports(self.structure, base, q, qd, qdd, loads, None)
        _, moment, *section_loads, a, _ = sections(self.structure, self.outboard, base, q, qd, qdd, loads, hung)
        strain = (np.concatenate([load[:, self.at] for load in section_loads], axis=-1) * self.strains).sum(axis=-1)
        moved = self.structure.displacement(q)
        # Accelerations are of the root and the stations, displacements of the stations alone.
        named = np.concatenate([moved[:, self.points], a[:, self.points + 1]], axis=-1).reshape(len(y), -1)
        strains = strain, causes_of(self.structure, q, loads) @ self.shares.T
        return np.concatenate([moved[:, -1], a[:, -1], -moment[:, 0], *strains, named, y[:, :i], yd[:, :i]], axis=-1)

    def inputs(self, u: Array) -> Inputs:
        """Inputs of the tree from vectors u (..., m): torque on a free hub or motion of the base, then loads."""
        drives, ground = self.drives, self.drives.ground
        if self.first_coordinate:
            driven, loads = np.split(u, [1], axis=-1)
            efforts = driven * np.equal(np.arange(self.tree.size), self.tree.unknowns[0])
            drives = replace(drives, efforts=efforts)
        else:
            a, w, alpha, loads = np.split(u, [3, 6, 9], axis=-1)
            drives = replace(drives, ground=replace(ground, a=a, w=w, alpha=alpha))
        if drives.loads[-1] is not None:
            loads = np.concatenate([loads, np.zeros((*loads.shape[:-1], self.idle))], axis=-1)
            of_body = loads.reshape(*u.shape[:-1], *np.shape(drives.loads[-1]))
            drives = replace(drives, loads=(*drives.loads[:-1], of_body))
        return drives

    def matrices(self, point: Point) -> tuple[Array, Array, Array]:
        """Outputs (p,) at a point, their derivatives (p, 3 n + m) by (y, ẏ, ÿ, u), and generalised forces (n, m) by u.

        The derivatives are taken by complex steps.
        """
        u = self.holding_inputs
        state = np.concatenate([point.y, point.yd, point.ydd, u])
        moved = np.concatenate([state[None] + 0j, state + 1j * STEP * np.eye(len(state))])
        y, yd, ydd, drive = np.split(moved, len(point.y) * np.arange(1, 4), axis=1)
        values = self(y, yd, ydd, drive)
        residual = self.tree(y, yd, ydd, self.inputs(drive))[-len(u) :]
        return values[0].real, values[1:].imag.T / STEP, -residual.imag.T / STEP

    def rates(self, x: Array, u: Array) -> tuple[Array, Array]:
        """Rates of a state x, and outputs. x is (y, ẏ) and, unless on a free hub, the base's angular velocity."""
        i = self.first_coordinate
        n = self.structure.size + i
        y, yd, rate = x[:n], x[n : 2 * n], x[2 * n :]
        full = (u if i else np.concatenate([u[:3], rate, u[3:]]))[None]  # with the angular velocity, a state
        ydd = accelerations(self.tree, y[None], yd[None], self.inputs(full))
        rates = np.concatenate([yd, ydd[0], u[3:6] if not i else []])
        return rates, self(y[None], yd[None], ydd, full)[0]


def coordinate_signals(structure: Structure, first: int) -> tuple[Signal, ...]:
    """Names and units of coordinates and rates (y, ẏ). `first` is 1 where a free hub's angle comes first."""
    units = ("1", "rad", "rad", "rad", "1", "1") if structure.kind in BY_STRAINS else ("m",) * 6
    names = [("hub_angle", "rad")] if first else []
    for group, unit, count in zip(FAMILIES, units, structure.counts, strict=True):
        names += [(f"q_{group}_{k + 1}", unit) for k in range(count)]
    if structure.field is None:  # particles, whose coordinates are whatever they were given by
        names += [(f"q_{k + 1}", "1") for k in range(structure.size)]
    if structure.source is not None:
        springs = structure.source.beam.root.springs
        names += [(f"q_root_{way}", "m" if way.startswith("translation") else "rad") for way in springs]
    rates = [Signal("hub_rate" if name == "hub_angle" else f"rate_{name}", f"{unit}/s") for name, unit in names]
    return tuple([Signal(*pair) for pair in names] + rates)


def input_signals(structure: Structure, motion: Motion) -> tuple[Signal, ...]:
    """Names and units of the inputs: the torque or the base's motion, then the components of each load."""
    if motion.free:
        signals = [Signal("torque", "N m")]
    else:
        signals = [Signal(f"base_{named_acceleration(motion)}_{i}", "m/s^2") for i in "xyz"]
        signals += [Signal(f"base_angular_acceleration_{i}", "rad/s^2") for i in "xyz"]
    if structure.work is not None:
        counts = np.bincount(np.asarray(structure.work.load))
        points_on_beam = counts[: len(counts) - structure.heated]
        for k, unit_suffix in enumerate("/m" if points > 1 else "" for points in points_on_beam):
            signals += [Signal(f"load_{k + 1}_force_{i}", f"N{unit_suffix}") for i in "xyz"]
            signals += [Signal(f"load_{k + 1}_moment_{i}", f"N m{unit_suffix}") for i in "xyz"]
    signals += [Signal("temperature", "K")] * structure.heated
    return tuple(signals)


def output_signals(structure: Structure, gauges: Sequence[Gauge], motion: Motion) -> tuple[Signal, ...]:
    """Names and units of the outputs."""

    def moving(point: str) -> list[Signal]:
        kinds = ((point, "m"), (f"{point}_{named_acceleration(motion)}", "m/s^2"))
        return [Signal(f"{name}_{i}", unit) for name, unit in kinds for i in "xyz"]

    signals = moving(TIP) + [Signal(f"root_moment_{i}", "N m") for i in "xyz"]
    signals += [Signal(f"strain_{k + 1}", "1") for k in range(len(gauges))]
    signals += [signal for name in points_of(structure) for signal in moving(name)]
    return tuple(signals + ([Signal("hub_angle", "rad"), Signal("hub_rate", "rad/s")] if motion.free else []))


def points_of(structure: Structure) -> dict[str, int]:
    """Named points of the beam besides the tip, with the numbers of their stations."""
    if structure.source is None:
        return {name: k for k, name in enumerate(structure.points) if name != TIP}
    names = names_at(structure.source.beam, structure.stations)
    return {name: k for k, name in enumerate(names) if name in structure.source.beam.named_points and name != TIP}


def outputs_of(structure: Structure, state: SteadySystem, gauges: Sequence[Gauge]) -> Outputs:
    """Build the outputs of one body in a state of its system."""
    measured, causes = structure.sections, structure.size + structure.heated
    shares = np.zeros((0, causes))
    strains, sections, rows = np.zeros((0, 6)), np.zeros(0, dtype=int), [0, -1]  # rows of the sections: root and tip
    if measured is None:
        by_gauge = [_solid_gauge(structure, i, gauge) for i, gauge in enumerate(gauges)]
        shares, gauges = np.array(by_gauge).reshape(-1, causes), ()
        mass, count = structure.mass, len(structure.stations)
        outboard_mass = np.concatenate([mass[None], np.zeros((count, len(mass)))])
        measured = Sections(None, outboard_mass, np.zeros((count + 1, 0)), np.eye(3))
    if gauges:
        positions, strains = _beam_gauges(structure, dict(enumerate(gauges)))
        structure = replace_stations(structure, positions)
        measured = structure.sections
        assert measured is not None
        sections = _nearest(structure, positions)
    points = np.array(list(points_of(structure).values()), dtype=int)
    if gauges or points.size:
        rows = list(range(len(structure.stations) + 1))
    outboard = replace(measured, mass=measured.mass[rows], loaded=measured.loaded[rows])
    point = state.point
    drives = point.inputs
    if len(point.tree.unknowns) > structure.size:  # the torque that a free hub needs to go on as it does
        needed = replace(drives, efforts=None)
        efforts = point.tree.rows(point.y, point.yd, point.ydd, needed)[0]
        drives = replace(drives, efforts=efforts)
    return Outputs(structure, point.tree, outboard, sections, strains, shares, points, drives)


def _gauged(system: System, gauges: Sequence[Gauge]) -> tuple[System, dict[str, Strained]]:
    """The system with stations at the gauges on its beams, and the gauges by the names of their signals."""
    by_number, by_body = dict[int, Strained](), dict[str, dict[int, Gauge]]()
    bodies, flexible = dict(system.bodies), system.flexible
    for i, gauge in enumerate(gauges):
        choice(f"gauges[{i}].body", gauge.body, flexible)
        by_body.setdefault(gauge.body, {})[i] = gauge
    for name, on_body in by_body.items():
        body = flexible[name]
        if body.sections is None:
            by_number |= {i: Strained(name, _solid_gauge(body, i, gauge)) for i, gauge in on_body.items()}
            continue
        positions, shares = _beam_gauges(body, on_body)
        bodies[name] = body = replace_stations(body, np.union1d(body.stations, positions))
        for i, share, section in zip(on_body, shares, _nearest(body, positions), strict=True):
            by_number[i] = Strained(name, share, int(section))
    return replace(system, bodies=bodies), {f"strain_{i + 1}": by_number[i] for i in range(len(gauges))}


def _nearest(structure: Structure, positions: Floats) -> Any:
    """Numbers (g,) of the sections, root and then stations, nearest to positions (g,), m."""
    return np.abs(np.append(0.0, structure.stations) - positions[:, None]).argmin(axis=1)


def _beam_gauges(structure: Structure, gauges: Mapping[int, Gauge]) -> tuple[Floats, Floats]:
    """Positions (g,), m, of numbered gauges on a beam, and strains (g, 6) per unit force and moment there."""
    assert structure.source is not None
    beam, unit = structure.source.beam, np.eye(6)[:, None]
    for i, gauge in gauges.items():
        where, at = f"gauges[{i}].at", gauge.at
        if isinstance(at, str):
            raise InputError(where, f"is {at!r}, on a beam", "give the position along it, m")
        if not 0 <= at <= beam.length:
            raise InputError(where, f"is {at:g} m, off the beam", f"give 0 to {beam.length:g} m")
    at, y, z = np.array([[gauge.at, gauge.y, gauge.z] for gauge in gauges.values()], dtype=float).T
    return at, fibre_strain(beam, at, unit[..., :3], unit[..., 3:], y, z).T


def _solid_gauge(structure: Structure, i: int, gauge: Gauge) -> Floats:
    """Strains (n + h,) at gauge number i on a solid by a unit of each cause; InputError if the body is no mesh."""
    if structure.recovery is None:
        fix = "leave them out: particles, matrices and modes have no strain"
        raise InputError("gauges", "are given of no beam and no mesh", fix)
    with placing_within(f"gauges[{i}]"):
        return np.asarray(structure.recovery.strain(str(gauge.at), gauge.along))
