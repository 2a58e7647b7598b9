"""Operating points: the states about which outputs and equations are linearised, on a given base or a free hub."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.estimate import BEAM
from gbeam.analysis.steady.equilibrium import equilibrium_about, expanded
from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Complex, Floats
from gbeam.errors import ComputationError, InputError
from gbeam.integrate.equations import slopes
from gbeam.mechanics.equations.dalembert import OnBase, OnHub
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.plausibility import elastic_bend
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.numerics.eigen import Linear, Steady
from gbeam.numerics.whirl import Whirl, whirl_of
from gbeam.results.modal import outermost
from gbeam.results.parts import Base

REST = Base(*np.zeros((3, 3)))


@dataclass(frozen=True, eq=False)
class OperatingPoint(Steady):
    """A state (y, ẏ, ÿ) at which a residual vanishes under inputs, with the motion of the base, and the free hub if
    there is one; `known` are the coefficients about it, if they have been computed.
    """

    structure: Structure
    residual: OnBase | OnHub
    y: Array
    yd: Array
    ydd: Array
    inputs: Any
    base: Base
    known: Coefficients | None = None
    hub: Any = None
    zero = 0.0

    @cached_property
    def about(self) -> Coefficients:
        """Coefficients of small departures from the beam's coordinates."""
        return expanded(self.structure, self.q)[0] if self.known is None else self.known

    @property
    def of(self) -> Structure:
        """The structure."""
        return self.structure

    @property
    def first(self) -> int:  # type: ignore[override]
        """Index of the beam's first coordinate in y."""
        return self.residual.first

    @property
    def q(self) -> Array:
        """Coordinates of the beam, (n,)."""
        return self.y[self.first :]

    @property
    def loads(self) -> Array | None:
        """Components of the loads, (loads, 6); None without loads."""
        return self.inputs[1]

    @property
    def bend(self) -> float:
        """Bend, as a share of the length, by the elastic stiffness alone."""
        return elastic_bend(self.structure, self.base)

    @cached_property
    def linear(self) -> Linear:
        """M, C and K of small departures."""
        q, residual, none = self.q, self.residual, np.zeros((len(self.y), 0))
        if self.structure.linear or not (self.yd[self.first :].any() or self.ydd[self.first :].any()):
            # A complete model's small departures from where it rests are a linear model about that place.
            if isinstance(residual, OnBase):
                drive = self.base.a_WO_B, self.base.w_WB_B, self.base.alpha_WB_B, self.loads
                return Linear(self.about.mass, *self.about.at(*drive)[:2], none)
            if not self.structure.linear:
                residual, q = OnHub(residual.equations.about(self.about), residual.mount), 0 * q
        y = np.concatenate([self.y[: self.first], q])
        k, c, m = _slopes(residual, y, self.yd, self.ydd, self.inputs)
        return Linear(m, c, k, none)

    @property
    def names(self) -> list[str]:
        """Names of the beam's coordinates."""
        return [f"{BEAM}.q{k + 1}" for k in range(self.structure.size)]

    @property
    def whirl(self) -> Whirl | None:
        """Its stations as they turn in the ground frame; None where the base does not. On a free hub, which swings with
        the beam, no frequency is known there.
        """
        places = self.structure.station_places.r0 + self.structure.displacement(self.q)
        slopes = np.pad(self.structure.station_slopes(self.q), ((0, 0), (0, 0), (self.first, 0)))
        base = (np.asarray(each) for each in (self.base.w_WB_B, self.base.a_WO_B))
        whirl = whirl_of(places[None], slopes[None], 0.0, *base)
        return whirl._replace(rate=math.nan) if whirl and self.first else whirl

    def richer(self, structure: Structure) -> OperatingPoint:
        """Relative equilibrium of another structure in the same motion, under the same loads."""
        structure = replace(structure, load_values=self.structure.load_values)
        if self.hub is None:
            return on_base(structure, self.base)
        angle, rate, acceleration = (float(values[0]) for values in (self.y, self.yd, self.ydd))
        return on_hub(structure, self.hub, rate, acceleration, angle=angle)

    def directions(self, modes: Complex | Floats) -> tuple[str, ...]:
        """Axis along which each mode (n, k) moves the structure most, or twist where the sections' edges move more."""
        structure, coordinates = self.structure, modes[self.first :]
        particles, stations = structure.particles.slopes(self.q), structure.station_slopes(self.q)
        moved = np.abs(np.concatenate([particles, stations]) @ coordinates).max(axis=0)
        ways = ["xyz"[i] for i in moved.argmax(axis=0)]
        twist = structure.station_twist(self.q)
        if twist is not None:
            edges, moved = (np.abs(slope @ coordinates) for slope in (extent(structure)[:, None] * twist, stations))
            twisted = edges.max(axis=0) > moved.max(axis=(0, 1))
            ways = ["twist" if flag else way for way, flag in zip(ways, twisted, strict=True)]
        return tuple(ways)


def extent(structure: Structure) -> Floats:
    """Distance of the outermost fibres from the axis at the stations, m."""
    outline = drawn(structure)
    return outermost(outline["width"], outline["thickness"], is_round=outline["round"])


def drawn(structure: Structure) -> dict[str, Any]:
    """Outline of a beam for pictures of its modes, by name: width, thickness, round, place, across; else empty."""
    if structure.source is None or structure.traced:
        return {}
    beam = structure.source.beam
    section = beam.section.at(structure.stations)
    width, thickness = section.extents()
    known = {"width": width, "thickness": thickness, "round": section.round}
    if beam.line is None:
        return known
    place, axes = beam.at_rest(structure.stations)
    return known | {"place": place, "across": axes[:, :, 1]}


def _slopes(residual: OnBase | OnHub, y: Array, yd: Array, ydd: Array, inputs: Any) -> tuple[Array, Array, Array]:
    """Derivatives K, C, M (n, n) of a residual at one state."""
    of_one_time = each_leaf(lambda leaf: np.asarray(leaf)[None], (y, yd, ydd, inputs))
    k, c, m = slopes(residual, *of_one_time)
    return k[0], c[0], m[0]


def steady_base(hub: Any, rate: float) -> Base:
    """Base motion of a hub that turns at a constant rate, rad/s, at angle zero."""
    return hub.mount.base(np.zeros(()), np.asarray(float(rate)), np.zeros(()))


def held_base(motion: Motion | None, time: float) -> Base:
    """Base motion at one time, s; at rest without a motion. A free hub is held at rest, at angle zero."""
    if motion is None:
        return REST
    if motion.free:
        return steady_base(motion, 0.0)
    return each_leaf(lambda x: np.asarray(x)[0], motion.base(np.array([time])))


def placed(
    structure: Structure, base: Base, q: Array | None, qd: Array | None
) -> tuple[Array, Array, Coefficients | None, bool]:
    """Coordinates and rates (n,), by default those of the relative equilibrium; its coefficients, None if q is given;
    and True if both are those of the equilibrium.
    """
    coefficients = None
    if q is None:
        (coordinates, _), coefficients = equilibrium_about(structure, base)
    else:
        coordinates = np.asarray(q, dtype=float)
    rates = 0 * coordinates if qd is None else np.asarray(qd, dtype=float)
    return coordinates, rates, coefficients, q is None and qd is None


def beam_acceleration(residual: OnBase | OnHub, y: Array, yd: Array, ydd: Array, inputs: Any) -> Array:
    """Accelerations (n,) of the beam by its equations, with that of a free hub as in `ydd`."""
    i = residual.first
    still = np.where(np.arange(len(y)) < i, ydd, 0.0)
    _, _, mass = _slopes(residual, y, yd, still, inputs)
    return np.linalg.solve(mass[i:, i:], -residual(y, yd, still, inputs)[i:])


def on_base(structure: Structure, base: Base, q: Array | None = None, qd: Array | None = None) -> OperatingPoint:
    """Operating point on a base with a frozen motion, at coordinates and rates (n,), by default in equilibrium."""
    coordinates, rates, coefficients, rests = placed(structure, base, q, qd)
    residual = structure.residual()
    inputs, still = (base, structure.load_values), np.zeros_like(coordinates)
    qdd = still if rests else beam_acceleration(residual, coordinates, rates, still, inputs)
    return OperatingPoint(structure, residual, coordinates, rates, qdd, inputs, base, coefficients)


def on_hub(
    structure: Structure,
    hub: Any,
    rate: float,
    acceleration: float = 0.0,
    q: Array | None = None,
    angle: float = 0.0,
    qd: Array | None = None,
) -> OperatingPoint:
    """Operating point on a free hub at a rate, rad/s, and acceleration, rad/s², under the torque that they need."""
    base = hub.mount.base(*(np.asarray(float(x)) for x in (angle, rate, acceleration)))
    coordinates, rates, coefficients, rests = placed(structure, base, q, qd)
    residual = structure.residual(hub)
    pairs = (angle, coordinates), (rate, rates), (acceleration, 0 * coordinates)
    y, yd, ydd = (np.append(of_hub, of_beam) for of_hub, of_beam in pairs)
    undriven: Any = 0.0, structure.load_values
    if not rests:
        ydd[1:] = beam_acceleration(residual, y, yd, ydd, undriven)
    inputs = residual(y, yd, ydd, undriven)[0], structure.load_values
    return OperatingPoint(structure, residual, y, yd, ydd, inputs, base, coefficients, hub)


def turning_inertia(structure: Structure, hub: Any, q: Array | None = None) -> float:
    """Moment of inertia of a free hub and the beam, straight or at q (n,), about the hub's axis, kg m²."""
    shape = np.zeros(structure.size) if q is None else q
    return float(on_hub(structure, hub, 0.0, q=shape).linear.mass[0, 0])


def settled_hub(structure: Structure, hub: Any, time: float, q: Array | None, qd: Array | None) -> OperatingPoint:
    """Operating point of a free hub that turns steadily at a time, s; see :func:`operating_point`."""
    torque, spring = float(hub.torque(time)), float(hub.stiffness)
    momentum = _momentum_of_the_torque(structure, hub, time, q)
    rate = acceleration = angle = 0.0
    for _ in range(60):
        point = on_hub(structure, hub, rate, acceleration, q, angle)
        needed = float(point.inputs[0])
        if spring > 0:
            turn = (torque - needed) / spring
            if abs(turn) <= 1e-12 * (1 + abs(angle)):
                return on_hub(structure, hub, rate, acceleration, q, angle, qd)
            angle += turn
            continue
        # The beam's own inertia hardly depends on its shape: the rigid hub's step converges fast.
        inertia = turning_inertia(structure, hub, point.q)
        step = momentum / inertia - rate, (torque - needed) / inertia
        rate, acceleration = rate + step[0], acceleration + step[1]
        if abs(step[0]) <= 1e-12 * (1 + abs(rate)) and abs(step[1]) <= 1e-12 * (1 + abs(acceleration)):
            return on_hub(structure, hub, rate, acceleration, q, qd=qd)
    raise ComputationError(
        "not converged", f"no steady turning of the hub under {torque:.4g} N m at t = {time:.4g} s was found"
    )


def _momentum_of_the_torque(structure: Structure, hub: Any, time: float, q: Array | None) -> float:
    """Angular momentum, N m s, at a time by the torque since time zero, less what the damper has taken."""
    if time <= 0:
        return 0.0
    decay = float(hub.damping) / turning_inertia(structure, hub, q)
    breaks = [float(b) for b in np.asarray(hub.torque.breaks) if 0 < b < time]
    import scipy.integrate  # only a free hub under a torque needs it

    momentum, _ = scipy.integrate.quad(
        lambda t: float(hub.torque(t)) * math.exp(-decay * (time - t)), 0, time, points=breaks or None, limit=200
    )
    return float(momentum)


def operating_point(
    structure: Structure, motion: Motion | None, time: float = 0.0, q: Array | None = None, qd: Array | None = None
) -> OperatingPoint:
    """Operating point in a motion frozen at a time, with the beam at q, qd (n,), by default in equilibrium. A free hub
    has the angular momentum of torque and damper since time zero, or rests where its spring balances the torque.
    """
    loaded, structure = structure.history is not None, structure.at_time(time)
    if motion is None or not motion.free:
        return on_base(structure, held_base(motion, time), q, qd)
    hub: Any = motion
    if time > 0 and float(hub.stiffness) == 0 and (loaded or hub.mount.gravity is not None):
        raise InputError(
            "time",
            f"is {time:g} s, when gravity or loads have moved a free hub",
            "give time 0 or a rate, or ask `gbeam run` how it moves",
        )
    return settled_hub(structure, hub, time, q, qd)
