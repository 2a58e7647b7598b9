"""Relative equilibrium of the beam at a frozen base motion."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import ComputationError
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.numerics.solvers.eigen import symmetric_modes

Array = Any


class Equilibrium(NamedTuple):
    """Coordinates (n,) at which the beam rests, and whether its stiffness there is positive definite."""

    q: Array
    stable: bool


def lowest_stiffness(mass: Array, stiffness: Array) -> tuple[float, Array]:
    """Lowest eigenvalue of the symmetric part of K in the measure of M, rad²/s², and its mode (n,).

    The antisymmetric part, from an angular acceleration, stores no energy and is left out.
    """
    value, mode = symmetric_modes((stiffness + stiffness.T) / 2, (mass + mass.T) / 2)
    return float(value[0]), mode[:, 0]


def solve_equilibrium(structure: Structure, base: Base, time: float | None = None) -> Equilibrium:
    """Coordinates at which the beam rests relative to a base whose motion is frozen, under its loads, stable or not.

    A linear model's equations are solved at once; others by Newton's method, along a path of growing load where one
    stride fails.

    Parameters
    ----------
    structure : Structure
    base : Base
        Of one time: arrays (3,).
    time : float, optional
        Time at which the beam's loads are taken, s; without, those that the structure has, of time zero or of its
        :meth:`~gbeam.Structure.at_time`.

    Returns
    -------
    Equilibrium

    Raises
    ------
    ComputationError
        ``not converged``, with the share of the load that was reached.
    """
    values = structure.load_values if time is None else structure.at_time(time).load_values
    if not structure.linear:
        return _along_a_path(structure, base, values)
    c = structure.coefficients
    _, stiffness, force = c.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values)
    if structure.traced:
        import jax.numpy as jnp

        return Equilibrium(jnp.linalg.solve(stiffness, force), True)
    try:
        q = np.linalg.solve(stiffness, force)
    except np.linalg.LinAlgError:
        q = np.full(len(force), np.nan)
    if np.isfinite(q).all():
        return Equilibrium(q, lowest_stiffness(c.mass, stiffness)[0] > 0)
    raise ComputationError(
        "not converged",
        f"no relative equilibrium: the stiffness is singular, or the base's motion not finite; "
        f"the rate is {_rate(base):.4g} rad/s",
    )


def _along_a_path(structure: Structure, base: Base, values: Array | None) -> Equilibrium:
    """Newton's method from the straight beam; where one stride fails, along a path of growing load."""
    from gbeam.analysis.equilibrium.newton import newton

    equations = structure.equations
    q, reached, stride, stiffness = np.zeros(structure.size), 0.0, 1.0, structure.coefficients.stiffness
    if structure.traced:
        found, _, _ = newton(equations, base, values, 1.0, q)
        return Equilibrium(found, True)
    while reached < 1.0:
        attempt = min(reached + stride, 1.0)
        found, ok, tangent = newton(equations, base, values, attempt, q)
        if bool(ok):
            q, stiffness, reached = np.asarray(found), np.asarray(tangent), attempt
        else:
            stride /= 4
            if stride < 1e-4:
                raise ComputationError(
                    "not converged",
                    f"no relative equilibrium beyond {reached:.4g} of the load: the beam buckles or diverges there; "
                    f"the rate is {_rate(base):.4g} rad/s",
                )
    return Equilibrium(q, bool(np.linalg.eigvalsh(stiffness + stiffness.T)[0] > 0))


def _rate(base: Base) -> float:
    return float(np.linalg.norm(base.w_WB_B))
