"""Operating points: a model's equations, frozen at one instant of its base's motion, and their derivatives there.

Modes, Campbell diagrams, critical speeds and state-space models all read the same M, C, K: the derivatives of one
residual with respect to ÿ, ẏ and y. Nothing here knows which model or which base it differentiates.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import scipy.integrate
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.analysis.equilibrium.equilibrium import equilibrium
from gbeam.analysis.response.problem import free_hub
from gbeam.analysis.study.case import Motion
from gbeam.errors import ComputationError, InputError
from gbeam.mechanics.assembly import Structure
from gbeam.mechanics.equations import Damped, Hub, hub_kinetic, on_free_hub, on_prescribed_base
from gbeam.motion import Base, HubRate, HubTorque, Mount, constant
from gbeam.results.response import Floats


def _inputs(system: Damped, driven: Array) -> Array:
    """What drives the base, followed by the components of the loads on the beam."""
    return driven if system.applied is None else jnp.concatenate([driven, system.applied.ravel()])


def _under(system: Damped, loads: Array) -> Damped:
    """The system under loads given as one list."""
    return system if system.applied is None else system.under(loads.reshape(system.applied.shape))


class OnBase(eqx.Module):
    """Residual on a base whose motion is given; u = (a_O, ω, α, loads), base axes, (9 + 6 loads,)."""

    system: Damped

    def base(self, y: Array, yd: Array, ydd: Array, u: Array) -> Base:
        """Motion of the base."""
        return Base(u[:3], u[3:6], u[6:9])

    def loaded(self, u: Array) -> Damped:
        """The system under the loads in `u`."""
        return _under(self.system, u[9:])

    def __call__(self, y: Array, yd: Array, ydd: Array, u: Array) -> Array:
        """Residual (n,)."""
        return on_prescribed_base(self.loaded(u), y, yd, ydd, u[:3], u[3:6], u[6:9])


class OnHub(eqx.Module):
    """Residual on a free hub, y = (θ, q); u = (torque, and the loads' components), (1 + 6 loads,)."""

    system: Damped
    hub: Hub
    mount: Mount
    hub_force: bool = eqx.field(static=True)

    def base(self, y: Array, yd: Array, ydd: Array, u: Array) -> Base:
        """Motion of the base; its acceleration is the specific force where gravity acts."""
        return self.mount.base(y[0], yd[0], ydd[0])

    def loaded(self, u: Array) -> Damped:
        """The system under the loads in `u`."""
        return _under(self.system, u[1:])

    def __call__(self, y: Array, yd: Array, ydd: Array, u: Array) -> Array:
        """Residual (n + 1,)."""
        return on_free_hub(self.loaded(u), self.hub, y, yd, ydd, u[0], hub_force=self.hub_force)


class Linear(NamedTuple):
    """M δÿ + C δẏ + K δy = B δu; C holds damping and gyroscopic coupling. (n, n), (n, n), (n, n), (n, inputs)."""

    mass: Floats
    velocity: Floats
    stiffness: Floats
    inputs: Floats


class OperatingPoint(eqx.Module):
    """A state (y, ẏ, ÿ; u) at which a residual vanishes, and the base's motion there.

    Parameters
    ----------
    residual : OnBase or OnHub
    y, yd, ydd : (n,) beam coordinates; on a free hub (n + 1,), the hub's angle first
    u : (inputs,) as the residual takes them
    base : Base
        Frozen motion of the root.
    """

    residual: OnBase | OnHub
    y: Array
    yd: Array
    ydd: Array
    u: Array
    base: Base

    @property
    def first(self) -> int:
        """Index of the beam's first coordinate in y."""
        return 1 if isinstance(self.residual, OnHub) else 0

    @property
    def q(self) -> Array:
        """Coordinates of the beam, (n,)."""
        return self.y[self.first :]


@eqx.filter_jit
def _matrices(residual: OnBase | OnHub, y: Array, yd: Array, ydd: Array, u: Array) -> tuple[Array, ...]:
    n = y.shape[0]

    def stacked(z: Array) -> Array:
        return residual(z[:n], z[n : 2 * n], z[2 * n : 3 * n], z[3 * n :])

    # One derivative with respect to everything: the residual is compiled once, not four times.
    d = jax.jacfwd(stacked)(jnp.concatenate([y, yd, ydd, u]))
    return d[:, 2 * n : 3 * n], d[:, n : 2 * n], d[:, :n], -d[:, 3 * n :]


def linear_matrices(point: OperatingPoint) -> Linear:
    """Derivatives of the residual at an operating point.

    Compiled once per structure and kind of base: a search or a diagram calls one program at many points.

    Returns
    -------
    Linear
        NumPy arrays.
    """
    return Linear(*map(np.asarray, _matrices(point.residual, point.y, point.yd, point.ydd, point.u)))


@eqx.filter_jit
def _base(motion: Motion, time: Array) -> Base:
    return motion.base(time)  # type: ignore[union-attr]


def frozen_base(motion: Motion, time: float) -> Base:
    """Base motion at one time, arrays (3,)."""
    return jax.tree.map(lambda x: x[0], _base(motion, jnp.array([time])))


def steady_base(motion: HubRate | HubTorque, rate: float) -> Base:
    """Base motion of a hub that turns at a constant rate, rad/s."""
    profile = constant(rate)
    if isinstance(motion, HubTorque):
        return motion.mount.base(jnp.zeros(()), jnp.asarray(float(rate)), jnp.zeros(()))
    # Whatever else the hub has stays as it is.
    return frozen_base(eqx.tree_at(lambda hub: hub.rate, motion, profile), 0.0)


@eqx.filter_jit
def _beam_acceleration(residual: OnBase | OnHub, y: Array, yd: Array, ydd: Array, u: Array) -> Array:
    """q̈ that the beam's equations ask for, the hub's acceleration being given, (n,)."""
    first = ydd.shape[0] - residual.system.damping.shape[0]

    def beam(qdd: Array) -> Array:
        return residual(y, yd, jnp.concatenate([ydd[:first], qdd]), u)[first:]

    o = jnp.zeros_like(ydd[first:])
    return jnp.linalg.solve(jax.jacfwd(beam)(o), -beam(o))


def _placed(structure: Structure, base: Base, q: Array | None, qd: Array | None) -> tuple[Array, Array, bool]:
    """Coordinates and rates, those of the relative equilibrium unless given; and whether that is where they are."""
    here = equilibrium(structure, base) if q is None else jnp.asarray(q, dtype=float)
    moving = 0 * here if qd is None else jnp.asarray(qd, dtype=float)
    return here, moving, q is None and qd is None


def held_base(motion: Motion, time: float) -> Base:
    """Base motion at one time; that of a free hub held at rest, at angle zero."""
    return steady_base(motion, 0.0) if isinstance(motion, HubTorque) else frozen_base(motion, time)


def on_base(structure: Structure, base: Base, q: Array | None = None, qd: Array | None = None) -> OperatingPoint:
    """Operating point on a base with a frozen motion.

    At its relative equilibrium, or with the coordinates and rates `q`, `qd` (n,) and the accelerations that follow.
    """
    here, moving, rests = _placed(structure, base, q, qd)
    residual = OnBase(structure.system)
    u = _inputs(structure.system, jnp.concatenate([base.a_WO_B, base.w_WB_B, base.alpha_WB_B]))
    still = jnp.zeros_like(here)
    qdd = still if rests else _beam_acceleration(residual, here, moving, still, u)
    return OperatingPoint(residual, here, moving, qdd, u, base)


@eqx.filter_jit
def _hub_force(residual: OnHub, y: Array, yd: Array, ydd: Array) -> tuple[Array, Array]:
    """Torque that a state needs, and the angular momentum that it has."""
    torque = residual(y, yd, ydd, _inputs(residual.system, jnp.zeros(1)))[0]
    return torque, jax.grad(hub_kinetic, 3)(residual.system.energy, residual.hub, y, yd)[0]


def on_hub(
    structure: Structure,
    motion: HubTorque,
    rate: float,
    acceleration: float = 0.0,
    q: Array | None = None,
    angle: float = 0.0,
    qd: Array | None = None,
) -> OperatingPoint:
    """Operating point on a free hub at a rate, rad/s, and acceleration, rad/s²; the torque is what that needs.

    `q` and `qd` as for :func:`on_base`.
    """
    base = motion.mount.base(jnp.asarray(float(angle)), jnp.asarray(float(rate)), jnp.asarray(float(acceleration)))
    here, moving, rests = _placed(structure, base, q, qd)
    residual = OnHub(structure.system, free_hub(motion), motion.mount, structure.hub_force)
    y, yd, ydd = (
        jnp.concatenate([jnp.array([float(hub)]), beam])
        for hub, beam in ((angle, here), (rate, moving), (acceleration, 0 * here))
    )
    if not rests:
        free = _beam_acceleration(residual, y, yd, ydd, _inputs(structure.system, jnp.zeros(1)))
        ydd = ydd.at[1:].set(free)
    torque, _ = _hub_force(residual, y, yd, ydd)
    return OperatingPoint(residual, y, yd, ydd, _inputs(structure.system, torque[None]), base)


def operating_point(
    structure: Structure, motion: Motion, time: float, q: Array | None = None, qd: Array | None = None
) -> OperatingPoint:
    """Freeze a motion at a time, with the beam in relative equilibrium.

    A free hub turns at the rate that gives hub and beam the angular momentum that torque and damper have left since
    time zero, and accelerates as its torque demands, the beam not vibrating. On a spring it rests at the angle at which
    the spring balances the torque.

    Parameters
    ----------
    structure : Structure
    motion : Flight, Centrifuge, HubRate or HubTorque
    time : float
        s.
    q, qd : (n,), optional
        Coordinates and rates in place of the equilibrium's.

    Raises
    ------
    InputError
        If a free hub without a spring swings in gravity or under loads: only a response tells how it moves.
    ComputationError
        ``not converged``: there is no such equilibrium.
    """
    loaded, structure = structure.history is not None, structure.at_time(time)
    if not isinstance(motion, HubTorque):
        return on_base(structure, frozen_base(motion, time), q, qd)
    if time > 0 and float(motion.stiffness) == 0 and (loaded or motion.mount.gravity is not None):
        raise InputError(
            "time",
            f"is {time:g} s, when gravity or loads have moved a free hub",
            "give time 0 or a rate, or ask `gbeam run` how it moves",
        )
    breaks = [float(b) for b in motion.breaks if 0 < b < time]
    torque, spring = float(motion.torque(time)), float(motion.stiffness)
    unit = on_hub(structure, motion, 1.0, q=jnp.zeros(structure.size) if q is None else q)
    decay = float(motion.damping) / float(_hub_force(unit.residual, unit.y, unit.yd, unit.ydd)[1])  # type: ignore[arg-type]
    momentum, _ = scipy.integrate.quad(
        lambda t: float(motion.torque(t)) * math.exp(-decay * (time - t)), 0, time, points=breaks or None, limit=200
    )
    rate = acceleration = angle = 0.0
    for _ in range(60):
        point = on_hub(structure, motion, rate, acceleration, q, angle)
        needed, has = (float(x) for x in _hub_force(point.residual, point.y, point.yd, point.ydd))  # type: ignore[arg-type]
        if spring > 0:
            turn = (torque - needed) / spring
            if abs(turn) <= 1e-12 * (1 + abs(angle)):
                return on_hub(structure, motion, rate, acceleration, q, angle, qd)
            angle += turn
            continue
        # The beam's own inertia hardly depends on its shape: the rigid hub's step converges fast.
        unit = on_hub(structure, motion, 1.0, 0.0, point.q)
        inertia = float(_hub_force(unit.residual, unit.y, unit.yd, unit.ydd)[1])  # type: ignore[arg-type]
        step = (momentum - has) / inertia, (torque - needed) / inertia
        rate, acceleration = rate + step[0], acceleration + step[1]
        if abs(step[0]) <= 1e-12 * (1 + abs(rate)) and abs(step[1]) <= 1e-12 * (1 + abs(acceleration)):
            return on_hub(structure, motion, rate, acceleration, q, qd=qd)
    raise ComputationError(
        "not converged", f"no steady turning of the hub under {torque:.4g} N m at t = {time:.4g} s was found"
    )
