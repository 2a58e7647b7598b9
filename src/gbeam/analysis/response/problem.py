"""The problem to integrate: the equations of a model in one environment, and the state they start from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.analysis.steady.equilibrium import solve_equilibrium
from gbeam.analysis.system.initial import Initial, Moved, on_bodies, rates_of, shape_of
from gbeam.analysis.system.point import solve_start
from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import each_leaf
from gbeam.errors import ComputationError
from gbeam.integrate.equations import LinearEquations, NonlinearEquations
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.parts import Base


def initial_state(structure: Structure, base: Base | None, time: float, initial: Initial) -> tuple[Array, Array, bool]:
    """Coordinates and rates (n,) at the start; False if they belong to an equilibrium that is not stable, else True."""
    q, stable = np.zeros(structure.size), True
    if initial.acceleration is not None:
        q, stable = solve_equilibrium(structure, Base(np.asarray(initial.acceleration), *np.zeros((2, 3))), time)
    elif initial.displaced:
        q = shape_of(structure, _of_one(structure, initial.displaced))
    elif initial.state != "undeformed" and base is not None:
        q, stable = solve_equilibrium(structure, base, time)
    return q, rates_of(structure, q, _of_one(structure, initial.moving)), stable


def _of_one(structure: Structure, moved: tuple[Moved, ...]) -> list[Moved]:
    """Components of points of the only body."""
    return on_bodies({"beam": structure}, moved)["beam"]


EQUILIBRIUM = Initial()


@dataclass(frozen=True)
class Problem:
    """Equations and initial state (n,) for the integrator; the beam's coordinates are from `first` on; `stable` is
    False if they start from an equilibrium that is not stable.
    """

    equations: LinearEquations | NonlinearEquations
    q: Array
    qd: Array
    first: int
    stable: bool


def problem_of(structure: Structure, motion: Motion, start: float, initial: Initial = EQUILIBRIUM) -> Problem:
    """Pose the equations of a structure in a motion, from an initial state at the `start`, s."""
    hub: Any = motion if motion.free else None

    def drive(t: Array) -> tuple[Any, Any]:
        return driven(structure, motion, t)

    q, qd, stable = start_of(structure, motion, start, initial)
    if hub is None and structure.linear:
        c = structure.coefficients
        terms = c.terms

        def features(inputs: tuple[Base, Any]) -> Array:
            now, loads = inputs
            return c.features(now.a_WO_B, now.w_WB_B, now.alpha_WB_B, loads)

        # No derivative is taken through the modes: those of equal frequencies have none.
        rest = None if any(map(is_jax, (c.mass, c.damping, c.stiffness))) else (c.damping, c.stiffness)
        equations = LinearEquations(c.mass, lambda x: terms.at(features(x)), drive, terms, features, rest)
        return Problem(equations, q, qd, 0, stable)
    residual = structure.residual(hub)
    if hub is not None:
        q, qd = (namespace(x).append(0.0, x) for x in (q, qd))
    idle = None if hub is None else each_leaf(lambda leaf: np.zeros(np.shape(leaf)), drive(np.array([start])))
    return Problem(NonlinearEquations(residual, drive, idle=idle), q, qd, residual.first, stable)


def driven(structure: Structure, motion: Any, t: Array) -> tuple[Any, Any]:
    """Inputs of the equations at times (t,): motion of the root, or torque on a free hub, and components of loads."""
    of_root = motion.torque(t) if motion.free else motion.base(t)
    return of_root, None if structure.history is None else structure.history(t)


def start_of(structure: Structure, motion: Any, start: float, initial: Initial) -> tuple[Array, Array, bool]:
    """Coordinates and rates (n,) of the beam at the start, and its stability, as in `initial_state`."""
    if motion.free and initial.state == "relief":
        residual, still = structure.residual(motion), np.zeros(1 + structure.size)
        inputs = each_leaf(lambda leaf: leaf[0], driven(structure, motion, np.array([start])))
        bent = np.arange(len(still)) >= residual.first
        q, _, adrift = solve_start(residual, still, still, inputs, bent=bent, accelerated=~bent)
        if adrift >= 0:
            problem = 'no place was found in which the beam rests on its hub; begin with initial = "undeformed"'
            raise ComputationError("no equilibrium", problem)
        q = q[residual.first :]
        return q, rates_of(structure, q, _of_one(structure, initial.moving)), True
    if motion.free:
        loaded, zero = motion.mount.gravity is not None or structure.history is not None, np.zeros(())
        return initial_state(structure, motion.mount.base(zero, zero, zero) if loaded else None, start, initial)
    base = motion.base(np.array([start]))
    return initial_state(structure, each_leaf(lambda x: x[0], base), start, initial)
