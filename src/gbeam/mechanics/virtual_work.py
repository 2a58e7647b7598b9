"""Virtual work of loads on the beam: their generalised forces, and the truncation of these to first order.

A load has six components, force and moment; `applied` (loads, 6) holds those of all loads at one time.
"""

from __future__ import annotations

from typing import Any, Protocol

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.mechanics.field import Coordinates, Field

Applied = Float[Array, "loads 6"]
Generalised = Float[Array, " n_6"]


class Work(Protocol):
    """What loads do to the root and to the coordinates."""

    def generalised(self, q: Coordinates, applied: Applied) -> Generalised:
        """Resultant force N and moment N m at the root O, base axes, then the forces on the coordinates, (6 + n,)."""
        ...


class FieldWork(eqx.Module):
    """Loads on a field, δW = Σ F·δr + M·δθ.

    Parameters
    ----------
    field : Field
    station : (p,) index of each loaded point in the field
    load : (p,) index of the load that acts there
    weight : (p,) 1, or the quadrature weight of a load per length, m
    follower : (p,) whether its axes are the section's
    """

    field: Field
    station: Array
    load: Array
    weight: Float[Array, " p"]
    follower: Array

    def generalised(self, q: Coordinates, applied: Applied) -> Generalised:
        """Resultant at the root and forces on the coordinates."""

        def place(q: Coordinates) -> tuple[Array, Array]:
            return self.field.position(q)[self.station], self.field.rotation(q)[self.station]

        (r, rotation), pull_back = jax.vjp(place, q)
        here = self.weight[:, None] * applied[self.load]
        axes = jnp.where(self.follower[:, None, None], rotation, jnp.eye(3))
        force = jnp.einsum("pij,pj->pi", axes, here[:, :3])
        moment = jnp.einsum("pij,pj->pi", axes, here[:, 3:])
        # δR = [δθ]× R, so that ½ [M]× R : δR = M·δθ. The columns of [M]× R are M × those of R.
        turning = 0.5 * jnp.cross(moment[:, :, None], rotation, axis=1)
        (along,) = pull_back((force, turning))
        total = jnp.sum(jnp.cross(r, force) + moment, axis=0)
        return jnp.concatenate([jnp.sum(force, axis=0), total, along])


class LinearWork(eqx.Module):
    """Loads on a truncated model: forces to first order in q, the derivative of a work to second order."""

    constant: Float[Array, "loads 6 n_6"]
    slope: Float[Array, "loads 6 n_6 n"]

    def generalised(self, q: Coordinates, applied: Applied) -> Generalised:
        """Resultant at the root and forces on the coordinates."""
        return jnp.einsum("li,lij->j", applied, self.constant + self.slope @ q)


@eqx.filter_jit
def first_order(work: FieldWork, applied: Applied, size: int) -> LinearWork:
    """Truncate the forces of loads to first order in q; `applied` gives their number only."""

    def per_load(q: Coordinates) -> Array:
        return jnp.moveaxis(jax.jacfwd(work.generalised, 1)(q, jnp.zeros_like(applied)), 0, 2)

    zero = jnp.zeros(size)
    return LinearWork(per_load(zero), jax.jacfwd(per_load)(zero))


class LoadHistory(eqx.Module):
    """The components of all loads over time; called as ``history(t)``.

    Parameters
    ----------
    profiles : tuple of (force, moment)
        Per load, vector profiles of time.
    """

    profiles: tuple[tuple[Any, Any], ...]

    def __call__(self, t: Float[Array, "*t"]) -> Float[Array, "*t loads 6"]:
        """Components at times t, s: N, N m; per metre where the load is."""
        return jnp.stack([jnp.concatenate([p(t) for p in pair], axis=-1) for pair in self.profiles], axis=-2)

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times at which an integrator should stop and start afresh, s."""
        return jnp.sort(jnp.concatenate([p.breaks for pair in self.profiles for p in pair]))
