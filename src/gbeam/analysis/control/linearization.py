"""State-space models about an operating point: A, B, C, D with names and units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from gbeam.analysis.steady.frequency_errors import BY_RICHER, doubtful, pole_errors, unknown_errors
from gbeam.analysis.steady.stability import hub_of
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.drive import Drive, turning_of
from gbeam.analysis.system.gauges import Strained
from gbeam.analysis.system.linear import frozen, instabilities, linearize_system, named_acceleration
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.rest import placed, undeformed
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import record
from gbeam.arrays.types import Floats
from gbeam.constants import BY_STRAINS
from gbeam.errors import InputError, placing_within
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.integrate.equations import accelerations
from gbeam.mechanics.assembly import at_stations
from gbeam.mechanics.fields.basis import FAMILIES
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.section_forces import sections
from gbeam.mechanics.structure import Sections, Structure
from gbeam.mechanics.tree.control import signal_names
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.one_body import on_motion
from gbeam.mechanics.tree.system import System
from gbeam.motion import Flight
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.series import STEP
from gbeam.progress import Progress, tell
from gbeam.results.errors import along
from gbeam.results.parts import Base
from gbeam.results.state_space import ACCURATE, Gauge, Signal, StateSpace, import_control
from gbeam.structure.attachments import TIP
from gbeam.structure.beam import Beam, fibre_strain, names_at


@typed
def surface_gauges(beam: Beam, stations: Iterable[float]) -> list[Gauge]:
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
    for i, at in enumerate(stations):
        with placing_within(f"stations[{i}]"):
            gauges += [surface_gauge(beam, at, face) for face in ("z", "y")]
    return gauges


def surface_gauge(beam: Beam, at: float, face: str) -> Gauge:
    """Return the gauge `at` m from the root on the extreme fibre towards a face, ``z``, ``-z``, ``y`` or ``-y``."""
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
    """Outputs of one body as a function of y, ẏ, ÿ and the inputs u of its system, in axes of its base: displacement
    and absolute acceleration of the tip, root moment, strains, displacement and acceleration of other `points` (numbers
    of stations), and a free hub's angle and rate. Strains are of beams by section forces times `strains` (gauges, 6) at
    the sections `at`, of solids by coordinates times `shares` (gauges, n). u has the torque on a free hub, or the
    base's acceleration, angular velocity and angular acceleration, and then the components of the loads.
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
    def first(self) -> int:
        """Index of the body's first coordinate in y: 1 behind the angle of a free hub."""
        return len(self.tree.free) - self.structure.size

    @property
    def held(self) -> Array:
        """Inputs u (m,) of the state."""
        drives, ground = self.drives, self.drives.ground
        efforts: Any = drives.efforts
        driven = [efforts[self.tree.free[:1]]] if self.first else [ground.a, ground.w, ground.alpha]
        loads = [] if drives.loads[-1] is None else [np.ravel(drives.loads[-1])]
        return np.concatenate([*driven, *loads])

    def __call__(self, y: Array, yd: Array, ydd: Array, u: Array) -> Array:
        """Outputs (t, p) of states (t, n) and inputs (t, m)."""
        i, inputs = self.first, self.inputs(u)
        q, qd, qdd = y[:, i:], yd[:, i:], ydd[:, i:]
        root = self.tree.motion(y, yd, ydd, inputs).roots[-1]
        base = Base(root.a, root.w, root.alpha)
        _, moment, *section_loads, a, _ = sections(self.structure, self.outboard, base, q, qd, qdd, inputs.loads[-1])
        strain = (np.concatenate([load[:, self.at] for load in section_loads], axis=-1) * self.strains).sum(axis=-1)
        moved = self.structure.displacement(q)
        # Accelerations are of the root and the stations, displacements of the stations alone.
        named = np.concatenate([moved[:, self.points], a[:, self.points + 1]], axis=-1).reshape(len(y), -1)
        strains = strain, q @ self.shares.T
        return np.concatenate([moved[:, -1], a[:, -1], -moment[:, 0], *strains, named, y[:, :i], yd[:, :i]], axis=-1)

    def inputs(self, u: Array) -> Inputs:
        """Inputs of the tree from vectors u (..., m)."""
        drives, ground = self.drives, self.drives.ground
        if self.first:
            driven, loads = np.split(u, [1], axis=-1)
            efforts = driven * np.equal(np.arange(self.tree.size), self.tree.free[0])
            drives = replace(drives, efforts=efforts)
        else:
            a, w, alpha, loads = np.split(u, [3, 6, 9], axis=-1)
            drives = replace(drives, ground=replace(ground, a=a, w=w, alpha=alpha))
        if drives.loads[-1] is not None:
            of_body = loads.reshape(*u.shape[:-1], *np.shape(drives.loads[-1]))
            drives = replace(drives, loads=(*drives.loads[:-1], of_body))
        return drives

    def matrices(self, point: Point) -> tuple[Array, Array, Array]:
        """Values (p,) at a point, their derivatives (p, 3 n + m) by (y, ẏ, ÿ, u), and forces (n, m) by u."""
        u = self.held
        state = np.concatenate([point.y, point.yd, point.ydd, u])
        moved = np.concatenate([state[None] + 0j, state + 1j * STEP * np.eye(len(state))])
        y, yd, ydd, drive = np.split(moved, len(point.y) * np.arange(1, 4), axis=1)
        values = self(y, yd, ydd, drive)
        left = self.tree(y, yd, ydd, self.inputs(drive))[-len(u) :]
        return values[0].real, values[1:].imag.T / STEP, -left.imag.T / STEP

    def rates(self, x: Array, u: Array) -> tuple[Array, Array]:
        """Rates of a state x, and outputs; x is (y, ẏ) and, unless on a free hub, the base's angular velocity."""
        i = self.first
        n = self.structure.size + i
        y, yd, rate = x[:n], x[n : 2 * n], x[2 * n :]
        full = (u if i else np.concatenate([u[:3], rate, u[3:]]))[None]
        ydd = accelerations(self.tree, y[None], yd[None], self.inputs(full))
        rates = np.concatenate([yd, ydd[0], u[3:6] if not i else []])
        return rates, self(y[None], yd[None], ydd, full)[0]


def coordinate_signals(structure: Structure, first: int) -> tuple[Signal, ...]:
    """Names and units of the coordinates and rates (y, ẏ); `first` is 1 with a free hub's angle."""
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
    """Names and units of the inputs: torque or base, then the components of each load on the beam."""
    if motion.free:
        signals = [Signal("torque", "N m")]
    else:
        signals = [Signal(f"base_{named_acceleration(motion)}_{i}", "m/s^2") for i in "xyz"]
        signals += [Signal(f"base_angular_acceleration_{i}", "rad/s^2") for i in "xyz"]
    if structure.work is not None:
        counts = np.bincount(np.asarray(structure.work.load))
        for k, per in enumerate("/m" if points > 1 else "" for points in counts):
            signals += [Signal(f"load_{k + 1}_force_{i}", f"N{per}") for i in "xyz"]
            signals += [Signal(f"load_{k + 1}_moment_{i}", f"N m{per}") for i in "xyz"]
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
    measured, shares = structure.sections, np.zeros((0, structure.size))
    strains, at, rows = np.zeros((0, 6)), np.zeros(0, dtype=int), [0, -1]  # rows of the sections: root and tip
    if measured is None:
        by_gauge = [_of_solid(structure, i, gauge) for i, gauge in enumerate(gauges)]
        shares, gauges = np.array(by_gauge).reshape(-1, structure.size), ()
        mass, count = structure.mass, len(structure.stations)
        outboard_mass = np.concatenate([mass[None], np.zeros((count, len(mass)))])
        measured = Sections(None, outboard_mass, np.zeros((count + 1, 0)), np.eye(3))
    if gauges:
        positions, strains = _of_beam(structure, dict(enumerate(gauges)))
        structure = at_stations(structure, positions)
        measured = structure.sections
        assert measured is not None
        at = _nearest(structure, positions)
    points = np.array(list(points_of(structure).values()), dtype=int)
    if gauges or points.size:
        rows = list(range(len(structure.stations) + 1))
    outboard = replace(measured, mass=measured.mass[rows], loaded=measured.loaded[rows])
    point = state.point
    drives = point.inputs
    if len(point.tree.free) > structure.size:  # the torque that a free hub needs to go on as it does
        needed = replace(drives, efforts=None)
        efforts = point.tree.rows(point.y, point.yd, point.ydd, needed)[0]
        drives = replace(drives, efforts=efforts)
    return Outputs(structure, point.tree, outboard, at, strains, shares, points, drives)


def _gauged(system: System, gauges: Sequence[Gauge]) -> tuple[System, dict[str, Strained]]:
    """The system with stations at the gauges on its beams, and the gauges by the names of their signals."""
    strained, named = dict[str, Strained](), dict[str, dict[int, Gauge]]()
    bodies, flexible = dict(system.bodies), system.flexible
    for i, gauge in enumerate(gauges):
        choice(f"gauges[{i}].body", gauge.body, flexible)
        named.setdefault(gauge.body, {})[i] = gauge
    for name, on_body in named.items():
        body = flexible[name]
        if body.sections is None:
            strained |= {f"strain_{i + 1}": Strained(name, _of_solid(body, i, gauge)) for i, gauge in on_body.items()}
            continue
        positions, shares = _of_beam(body, on_body)
        bodies[name] = body = at_stations(body, np.union1d(body.stations, positions))
        rows = zip(on_body, shares, _nearest(body, positions), strict=True)
        strained |= {f"strain_{i + 1}": Strained(name, share, int(section)) for i, share, section in rows}
    return replace(system, bodies=bodies), {f"strain_{i + 1}": strained[f"strain_{i + 1}"] for i in range(len(gauges))}


def _nearest(structure: Structure, positions: Floats) -> Any:
    """Numbers (g,) of the sections, root and then stations, nearest to positions (g,), m."""
    return np.abs(np.append(0.0, structure.stations) - positions[:, None]).argmin(axis=1)


def _of_beam(structure: Structure, gauges: Mapping[int, Gauge]) -> tuple[Floats, Floats]:
    """Positions (g,), m, of numbered gauges on a beam, and their strains (g, 6) by unit forces and moments there."""
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


def _of_solid(structure: Structure, i: int, gauge: Gauge) -> Floats:
    """Strains (n,) at gauge number i on a solid by unit coordinates; InputError if it is on no mesh."""
    if structure.recovery is None:
        fix = "leave them out: particles, matrices and modes have no strain"
        raise InputError("gauges", "are given of no beam and no mesh", fix)
    with placing_within(f"gauges[{i}]"):
        return np.asarray(structure.recovery.strain(str(gauge.at), gauge.along))


@typed
def linearize(
    structure: Structure | System,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    rate: float | None = None,
    q: ArrayLike | None = None,
    qd: ArrayLike | None = None,
    gauges: Sequence[Gauge] = (),
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    at: Literal["rest", "start"] = "rest",
    loop: str = "open",
    name: str = "",
    progress: Progress = None,
) -> StateSpace:
    """State-space model of small departures from an operating point.

    Parameters
    ----------
    structure : Structure or System
    motion : Flight, Centrifuge or Hub
        Of the root of a structure, or of the ground of a system; either rests without one. A free hub has the torque as
        input; on any other base the root's acceleration (specific force where gravity acts, and then called so) and the
        angular acceleration are, in base axes. The components of each load on the beam are inputs too.
    time : float
        At which the motion is frozen, s.
    rate : float, optional
        A hub's steady rate in its place, rad/s.
    q, qd : (n,), optional
        Coordinates and rates to linearise at; by default the relative equilibrium. Elsewhere the beam accelerates, and
        the model is one of small departures from the motion that goes through this state.
    gauges : sequence of Gauge
        Where strain is measured: ``strain_1`` and so on.
    inputs, outputs : sequence of str, optional
        Those that are kept, by name. Of a system: efforts on coordinates (``hinge.angle``) and components of its forces
        (``thrust.force_x``); what is measured, ``joint.angle``, ``joint.angle_rate``, ``body.point.place_x``,
        ``velocity_x``, ``attitude_x``, ``acceleration_x``, ``spin_x``. By default the driven coordinates, all forces,
        and accelerations of the base and of prescribed coordinates (``base_acceleration_x``,
        ``axis.angle_acceleration``); coordinates, rates, places and strains.
    at : str
        Of a system: ``rest``, where it rests, or ``start``, the motion at its start.
    loop : str
        Of a system with controllers: ``open``, the plant alone; ``closed``, all of it from sample to sample, of several
        sample times over their common period, with its references as further inputs and the margins at every drive
        that is sampled once in it; or the name of a controller and such a drive, ``pointing: axis.angle``: the loop
        that is cut there, with negative feedback. Laws that are functions have their slopes where they ask for nothing:
        where the system rests, or else at no error. Errors of margins and poles are by the same laws around a richer
        system; a margin whose error exceeds one half is NaN, and a loop that grows has none.
    name : str
        Of the motion.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    StateSpace
        Outputs are displacement and acceleration of the tip, the root's moment, strains, displacement and acceleration
        of every other named point of the beam, and a free hub's angle and rate. States are the coordinates and their
        rates. Where the base's angular velocity acts to first order, that is about a turning base, its components are
        states too: the integrals of the angular acceleration.

    Raises
    ------
    InputError
        If the beam has no damping ratio, a gauge lies off the beam or at no point of a mesh, a rate is asked of a
        motion without a hub, or a time of a hub that swings; of a loop, if its controllers have no common period, or a
        law has no slope, such as a relay.
    ComputationError
        If there is no relative equilibrium.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> plant = gb.linearize(structure, gb.Hub(radius=0.5, inertia=2.0))
    >>> [each.name for each in plant.inputs]
    ['torque']
    >>> print(plant.frequency.round(2))
    [  36.56  183.55  229.04 1139.77 4243.13]
    """
    tell(progress, "equilibrium and slopes", 0.0)
    subject = subject_of(structure, motion)
    if not subject.body or structure is subject.system:  # signals of a system are named by its bodies
        if rate is not None:
            raise InputError(
                "rate", "is of a hub, and a system turns on its joints", "give a time, or a joint its rate"
            )
        system = subject.system
        drives = signal_names(system.controllers, "drive")
        if loop != "open" and not drives:
            raise InputError("loop", f"is {loop!r}, and the system has no controllers", "leave it out, or give it some")
        choice("loop", loop, ("open", "closed", *drives))
        system.require_damping("the state-space model")
        system, strained = _gauged(system, gauges)
        state = frozen(system, motion, time, at)
        options: Any = {"inputs": inputs, "outputs": outputs, "strained": strained, "name": name}
        if loop != "open":
            from gbeam.analysis.steady.loop_errors import JudgedLoops  # takes SciPy's linear algebra
            from gbeam.analysis.system.closed_loop import Loops

            loops, cut = Loops.of(state, **options), None if loop == "closed" else loop
            computed = loops.state_space(cut)
            tell(progress, BY_RICHER, 0.5)
            return JudgedLoops(state, loops, cut).judge(computed)
        plant = linearize_system(state, **options)
        tell(progress, BY_RICHER, 0.5)
        of_system, doubts = _poles(state, subject)
        if state.begins and state.point.yd.any():
            of_system["frame"] = "turning"
        return replace(plant, **of_system, warnings=plant.warnings + doubts)
    choice("loop", loop, ("open",))
    motion = Flight(z=0.0) if motion is None else motion
    subject = subject_of(structure, motion)
    subject.require_coordinates()
    structure.require_damping("the state-space model")
    for i, gauge in enumerate(gauges):
        if gauge.body:
            raise InputError(f"gauges[{i}].body", f"is {gauge.body!r}, and there is one structure", "leave it out")
    if rate is None:
        drive = subject.drive(time)
    else:
        hub_of(motion, "a rate", "leave it out and give a time", name)
        drive = Drive(subject.ground, time, turning_of(subject.system, subject.ground, None), rate)
    at_rest = q is None and qd is None
    coordinates = (None if each is None else np.asarray(each, dtype=float) for each in (q, qd))
    plant = _linearized(
        subject, placed(subject.system, drive, *coordinates), gauges, name, time, progress, at_rest=at_rest
    )
    return plant.select(inputs=inputs, outputs=outputs)


def _linearized(
    subject: Subject,
    state: SteadySystem,
    gauges: Sequence[Gauge],
    name: str,
    time: float,
    progress: Progress,
    *,
    at_rest: bool,
) -> StateSpace:
    """State-space model of one body in a state of its system; with the errors of its poles if it is `at_rest`."""
    structure, point, linear = subject.structure, state.point, state.linear
    motion: Any = subject.motion
    n, measured = len(point.y), outputs_of(structure, state, gauges)
    value, d, forces = measured.matrices(point)
    a, drive, out, through = linear._replace(inputs=forces).state_space(
        *np.split(d, len(linear.mass) * np.arange(1, 4), axis=1)
    )
    states, held = coordinate_signals(structure, measured.first), measured.held
    begun = np.concatenate([point.y, point.yd])
    if not measured.first:
        # u = (a, ω, α, loads): ω becomes a state where it acts, fed by α.
        acts = [i for i in range(3, 6) if np.abs(drive[:, i]).max() > 1e-12 or np.abs(through[:, i]).max() > 1e-12]
        kept = [i for i in range(len(held)) if not 3 <= i < 6]
        fed = np.array([[float(j == i + 3) for j in kept] for i in acts]).reshape(-1, len(kept))
        m = len(acts)
        a = np.block([[a, drive[:, acts]], [np.zeros((m, 2 * n + m))]])
        out = np.concatenate([out, through[:, acts]], axis=1)
        drive, through = np.concatenate([drive[:, kept], fed]), through[:, kept]
        states += tuple(BASE_RATES[i - 3] for i in acts)
        begun, held = np.concatenate([begun, held[acts]]), held[kept]
    warnings = input_warnings(structure, motion, name=name, span=(time, time), base=subject.base(state))
    poles: dict[str, Any] = {}
    if at_rest:
        tell(progress, BY_RICHER, 0.5)
        poles, doubts = _poles(state, subject)
        warnings += doubts
    return StateSpace(
        a=a,
        b=drive,
        c=out,
        d=through,
        states=states,
        inputs=input_signals(structure, motion),
        outputs=output_signals(structure, gauges, motion),
        state=begun,
        input=held,
        output=value,
        model=structure.kind,
        motion=name,
        time=time,
        **poles,
        warnings=warnings,
        notes=notes_on({name: motion}),
    )


def _poles(state: SteadySystem, subject: Subject) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Fields of the poles about a steady state: frequencies (k,) Hz, their errors and frame; and warnings of errors and
    instability.
    """
    frequency, errors, doubts = np.zeros(0), unknown_errors(state.system, 0), tuple[str, ...]()
    turning = {"frame": "turning"} if state.whirl is not None and state.whirl.turning else {}
    if judged_bodies(state.system):
        frequency, errors = pole_errors(state)
        doubts = doubtful(errors) if errors.within(ACCURATE) == 0 else ()
    growing = (
        f"the operating point is not stable: {motion.kind} {along(motion.direction)}, growing with "
        f"{motion.growth_rate:.4g} 1/s"
        for motion in instabilities(state, state.moving, subject.directions)
    )
    return {"frequency": frequency, "errors": errors, **turning}, (*doubts, *growing)


@typed
def nonlinear_system(structure: Structure, motion: Motion, *, gauges: Sequence[Gauge] = ()) -> Any:
    """Return the complete model as ``control.nlsys``: driven by the torque on a free hub, else by its base's motion.

    States are (y, ẏ) and, on a base that is not a free hub, the base's angular velocity; inputs and outputs are those
    of :func:`gbeam.linearize`, not as departures but whole.

    Parameters
    ----------
    structure : Structure
    motion : Flight, Centrifuge or Hub
        Tells the kind of base only.
    gauges : sequence of Gauge

    Raises
    ------
    InputError
        If python-control is not installed.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> system = gb.nonlinear_system(structure, gb.Hub(radius=0.5, inertia=2.0))
    >>> system.nstates, system.input_labels
    (12, ['torque'])
    """
    control = import_control()

    structure.require_coordinates()
    system, _ = on_motion(structure, motion)
    outputs = outputs_of(structure, undeformed(system), gauges)
    states = coordinate_signals(structure, outputs.first) + (() if outputs.first else BASE_RATES)

    def update(t: float, x: Any, u: Any, params: Any) -> Any:
        return outputs.rates(np.asarray(x, dtype=float), np.asarray(u, dtype=float))[0]

    def measure(t: float, x: Any, u: Any, params: Any) -> Any:
        return outputs.rates(np.asarray(x, dtype=float), np.asarray(u, dtype=float))[1]

    return control.nlsys(
        update,
        measure,
        states=[signal.name for signal in states],
        inputs=[signal.name for signal in input_signals(structure, motion)],
        outputs=[signal.name for signal in output_signals(structure, gauges, motion)],
        name=structure.kind,
    )
