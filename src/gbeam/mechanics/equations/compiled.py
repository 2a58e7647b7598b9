"""Compiled functions of complete models over many times; their key is sizes, never values."""

from __future__ import annotations

from typing import Any

import jax

import gbeam.arrays.jax_setup  # noqa: F401


@jax.jit
def paths(points: Any, q: Any, qd: Any, qdd: Any) -> tuple[Any, Any, Any]:
    """Places, velocities and accelerations of particles, or of a field's points, over times, (t, p, 3) each.

    Parameters
    ----------
    points : Inertia or Field
    q, qd, qdd : (t, n)
    """
    place = getattr(points, "positions", None) or points.position

    def moving(q: Any, qd: Any) -> Any:
        return jax.jvp(place, (q,), (qd,))

    def at(q: Any, qd: Any, qdd: Any) -> Any:
        (r, rd), (_, rdd) = jax.jvp(moving, (q, qd), (qd, qdd))
        return r, rd, rdd

    return jax.vmap(at)(q, qd, qdd)


@jax.jit
def slopes(inertia: Any, field: Any, q: Any) -> tuple[Any, Any]:
    """Derivatives with respect to q of the particles' places (k, 3, n) and of a field's points (p, 3, n)."""
    return jax.jacfwd(inertia.positions)(q), jax.jacfwd(field.position)(q)
