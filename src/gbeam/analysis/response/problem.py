"""What is integrated: the equations of a model in one environment, and the state they start from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.analysis.response.initial import Initial, initial_state
from gbeam.arrays.namespace import is_jax, namespace
from gbeam.integrate.equations import LinearEquations, NonlinearEquations
from gbeam.mechanics.equations.residuals import OnBase, OnHub
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.motion.protocol import Motion

Array = Any
EQUILIBRIUM = Initial()


@dataclass(frozen=True)
class Problem:
    """Equations and initial state (n,) for the integrator, the beam's from index `first`; `stable` tells of its
    equilibrium.
    """

    equations: LinearEquations | NonlinearEquations
    q: Array
    qd: Array
    first: int
    stable: bool


def problem_of(structure: Structure, motion: Motion, start: float, initial: Initial = EQUILIBRIUM) -> Problem:
    """Pose the problem: it starts in relative equilibrium, without vibration, or as `initial` says."""
    if motion.free:
        return _on_free_hub(structure, motion, start, initial)

    def drive(t: Array) -> tuple[Base, Any]:
        return motion.base(t), None if structure.history is None else structure.history(t)

    q, qd, stable = start_of(structure, motion, start, initial)
    if structure.linear:
        c = structure.coefficients

        def matrices(inputs: tuple[Base, Any]) -> tuple[Array, Array, Array]:
            now, loads = inputs
            return c.at(now.a_WO_B, now.w_WB_B, now.alpha_WB_B, loads)

        def features(inputs: tuple[Base, Any]) -> Array:
            now, loads = inputs
            return c.features(now.a_WO_B, now.w_WB_B, now.alpha_WB_B, loads)

        # No derivative is taken through the modes: those of equal frequencies have none.
        rest = None if any(map(is_jax, (c.mass, c.damping, c.stiffness))) else (c.damping, c.stiffness)
        equations = LinearEquations(c.mass, matrices, drive, lambda: c.terms, features, rest)
        return Problem(equations, q, qd, 0, stable)
    return Problem(NonlinearEquations(OnBase(structure.equations), drive), q, qd, 0, stable)


def _on_free_hub(structure: Structure, hub: Any, start: float, initial: Initial) -> Problem:
    def drive(t: Array) -> tuple[Array, Any]:
        return hub.torque(t), None if structure.history is None else structure.history(t)

    q, qd, stable = start_of(structure, hub, start, initial)
    residual = OnHub(structure.on_free_hub(hub), hub.mount)
    q, qd = (namespace(x).append(0.0, x) for x in (q, qd))
    return Problem(NonlinearEquations(residual, drive), q, qd, 1, stable)


def start_of(structure: Structure, motion: Any, start: float, initial: Initial) -> tuple[Array, Array, bool]:
    """The beam's coordinates and rates (n,) at the start, and whether they are those of no equilibrium that is lost."""
    if motion.free:
        pulled, o = motion.mount.gravity is not None or structure.history is not None, np.zeros(())
        return initial_state(structure, motion.mount.base(o, o, o) if pulled else None, start, initial)
    base = motion.base(np.array([start]))
    first = Base(*(x[0] for x in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)))
    return initial_state(structure, first, start, initial)
