"""Relative equilibrium of the beam at a frozen base motion."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.errors import ComputationError
from gbeam.mechanics.assembly import Structure
from gbeam.mechanics.equations import Coefficients, Damped, coefficients, on_prescribed_base
from gbeam.mechanics.field import Coordinates
from gbeam.motion import Base


@eqx.filter_jit
def _newton(system: Damped, base: Base, share: Array, q: Array) -> tuple[Array, Array, Array]:
    """Solve at a share of all loads: accelerations and what is applied by the share, rates by its root.

    Coordinates, whether they were found, and the tangent stiffness there.
    """
    loaded = system if system.applied is None else system.under(share * system.applied)

    def residual(q: Array) -> Array:
        o = jnp.zeros_like(q)
        return on_prescribed_base(
            loaded, q, o, o, share * base.a_WO_B, jnp.sqrt(share) * base.w_WB_B, share * base.alpha_WB_B
        )

    def iterate(carry: tuple[Array, Array, Array, Array]) -> tuple[Array, Array, Array, Array]:
        q, _, count, _ = carry
        stiffness = jax.jacfwd(residual)(q)
        correction = jnp.linalg.solve(stiffness, residual(q))
        return q - correction, jnp.max(jnp.abs(correction)), count + 1, stiffness

    def go_on(carry: tuple[Array, Array, Array, Array]) -> Array:
        q, size, count, _ = carry
        return (size > 1e-13 + 1e-12 * jnp.max(jnp.abs(q))) & (count < 30)

    unknown = jnp.zeros((len(q), len(q)))
    q, _, count, stiffness = jax.lax.while_loop(go_on, iterate, (q, jnp.array(jnp.inf), jnp.array(0), unknown))
    return q, (count < 30) & jnp.all(jnp.isfinite(q)), stiffness


@eqx.filter_jit
def _direct(constants: Coefficients, base: Base, applied: Array | None) -> tuple[Array, Array]:
    _, stiffness, load = constants.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, applied)
    return jnp.linalg.solve(stiffness, load), stiffness


def equilibrium(structure: Structure, base: Base, time: float | None = None) -> Coordinates:
    """Coordinates at which the beam rests relative to a base whose motion is frozen, under its loads.

    Stable or not: see :func:`settled`.

    A linear model's equations are solved at once; others by Newton's method, along a path of growing load where one
    stride fails.

    Parameters
    ----------
    structure : Structure
    base : Base
        Of one time: arrays (3,).
    time : float, optional
        Time at which the beam's loads are taken, s; without, those that the structure has, of time zero or of its
        :meth:`~gbeam.model.Structure.at_time`.

    Returns
    -------
    q : (n,)

    Raises
    ------
    ComputationError
        ``not converged``, with the share of the load that was reached.
    """
    return settled(structure, base, time)[0]


def settled(structure: Structure, base: Base, time: float | None = None) -> tuple[Coordinates, bool]:
    """The equilibrium, and whether it is stable: the symmetric part of its tangent stiffness positive definite.

    Parameters and errors as for :func:`equilibrium`.
    """
    system = structure.system if time is None else structure.at_time(time).system
    if structure.linear:
        q, stiffness = _direct(coefficients(structure.system), base, system.applied)
        if bool(jnp.all(jnp.isfinite(q))):
            return q, _definite(stiffness)
        raise ComputationError(
            "not converged",
            f"no relative equilibrium: the stiffness is singular, or the base's motion not finite; "
            f"the rate is {_rate(base):.4g} rad/s",
        )
    q, reached, stride = jnp.zeros(structure.size), 0.0, 1.0
    while reached < 1.0:
        attempt = min(reached + stride, 1.0)
        found, ok, stiffness = _newton(system, base, jnp.asarray(attempt), q)
        if bool(ok):
            q, reached = found, attempt
        else:
            stride /= 4
            if stride < 1e-4:
                raise ComputationError(
                    "not converged",
                    f"no relative equilibrium beyond {reached:.4g} of the load: the beam buckles or diverges there; "
                    f"the rate is {_rate(base):.4g} rad/s",
                )
    return q, _definite(stiffness)


def _definite(stiffness: Array) -> bool:
    return bool(jnp.linalg.eigvalsh(stiffness + stiffness.T)[0] > 0)


def _rate(base: Base) -> float:
    return float(np.linalg.norm(base.w_WB_B))
