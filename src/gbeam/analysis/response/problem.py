"""What is integrated: the equations of a model in one environment, and the state they start from."""

from __future__ import annotations

from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.analysis.equilibrium.equilibrium import settled
from gbeam.analysis.study.case import Motion
from gbeam.integrate import LinearSystem, NonlinearSystem, State, evaluate
from gbeam.mechanics.assembly import Structure
from gbeam.mechanics.equations import Coefficients, Damped, Hub, coefficients, on_free_hub, on_prescribed_base
from gbeam.mechanics.virtual_work import Applied, LoadHistory
from gbeam.motion import Base, HubTorque
from gbeam.numerics.batching import in_blocks
from gbeam.results.response import BaseHistory


class _Matrices(eqx.Module):
    """C, K, F of a linear model at a base motion and under loads."""

    coefficients: Coefficients

    def __call__(self, inputs: tuple[Base, Applied | None]) -> tuple[Array, Array, Array]:
        base, applied = inputs
        return self.coefficients.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, applied)


class _OnBase(eqx.Module):
    """Residual of a model on a prescribed base."""

    system: Damped

    def __call__(self, q: Array, qd: Array, qdd: Array, inputs: tuple[Base, Applied | None]) -> Array:
        base, applied = inputs
        return on_prescribed_base(self.system.under(applied), q, qd, qdd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B)


class _OnHub(eqx.Module):
    """Residual of a model on a free hub."""

    system: Damped
    hub: Hub
    hub_force: bool = eqx.field(static=True)

    def __call__(self, y: Array, yd: Array, ydd: Array, inputs: tuple[Array, Applied | None]) -> Array:
        torque, applied = inputs
        return on_free_hub(self.system.under(applied), self.hub, y, yd, ydd, torque, hub_force=self.hub_force)


class _Inputs(eqx.Module):
    """What drives a system over time: the base's motion or the hub's torque, and the loads on the beam."""

    drive: Motion
    history: LoadHistory | None

    def __call__(self, t: Array) -> tuple[Base | Array, Applied | None]:
        base = self.drive.torque(t) if isinstance(self.drive, HubTorque) else self.drive.base(t)
        return base, None if self.history is None else self.history(t)


def history_of(base: Base) -> BaseHistory:
    """Base motion, (t, 3) or of one time (3,), as a record."""
    return BaseHistory(*(np.atleast_2d(np.asarray(x)) for x in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)))


def free_hub(motion: HubTorque) -> Hub:
    """The hub of a motion, for the equations."""
    m = motion.mount
    return Hub(m.radius, motion.inertia, m.R_HB, motion.stiffness, motion.damping, m.gravity)


@dataclass(frozen=True)
class Problem:
    """What the integrator runs: the system, its initial state, and where the beam's coordinates start in it.

    `stable` says whether the relative equilibrium that it starts from is.
    """

    system: LinearSystem | NonlinearSystem
    state: State
    first: int
    coefficients: Coefficients | None
    stable: bool


def problem_of(structure: Structure, motion: Motion, start: float) -> Problem:
    """Pose the problem: it starts in relative equilibrium, without vibration."""
    inputs = _Inputs(motion, structure.history)
    if isinstance(motion, HubTorque):
        residual = _OnHub(structure.system, free_hub(motion), structure.hub_force)
        q, stable = jnp.zeros(structure.size), True
        if motion.mount.gravity is not None or structure.history is not None:
            o = jnp.zeros(())
            q, stable = settled(structure, motion.mount.base(o, o, o), start)
        return Problem(NonlinearSystem(residual, inputs), State.rest(jnp.append(0.0, q)), 1, None, stable)
    base, _ = in_blocks(evaluate, inputs, np.array([start]))
    q, stable = settled(structure, jax.tree.map(lambda x: x[0], base), start)
    if structure.linear:
        constants = coefficients(structure.system)
        return Problem(LinearSystem(constants.mass, _Matrices(constants), inputs), State.rest(q), 0, constants, stable)
    return Problem(NonlinearSystem(_OnBase(structure.system), inputs), State.rest(q), 0, None, stable)
