"""Compiled functions of complete models over many times; their key is sizes, never values."""

from __future__ import annotations

from typing import Any

import jax

import gbeam.arrays.jax_setup  # noqa: F401


@jax.jit
def paths(inertia: Any, q: Any, qd: Any, qdd: Any) -> Any:
    """Places, velocities and accelerations of the particles and of the field's points over times, and its rotations.

    Parameters
    ----------
    inertia : Inertia
    q, qd, qdd : (t, n)

    Returns
    -------
    (r, ṙ, r̈) of the particles (t, k, 3); the same of the points (t, p, 3); rotations (t, p, 3, 3)
    """

    def everything(q: Any) -> tuple[Any, Any]:
        return inertia.positions(q), inertia.field.position(q)

    def moving(q: Any, qd: Any) -> Any:
        return jax.jvp(everything, (q,), (qd,))

    def at(q: Any, qd: Any, qdd: Any) -> Any:
        (r, rd), (_, rdd) = jax.jvp(moving, (q, qd), (qd, qdd))
        particles, points = zip(r, rd, rdd, strict=True)
        return particles, points, inertia.field.rotation(q)

    return jax.vmap(at)(q, qd, qdd)


@jax.jit
def slopes(inertia: Any, q: Any) -> Any:
    """Derivatives with respect to q of the particles' places (k, 3, n) and of the field's points (p, 3, n)."""
    return jax.jacfwd(lambda q: (inertia.positions(q), inertia.field.position(q)))(q)
