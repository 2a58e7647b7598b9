"""Virtual work of loads on the beam: their generalised forces, complete, and to first order in the coordinates.

A load has six components, force and moment; `values` (loads, 6) holds those of all loads at one time.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.linear import LoadTerms
from gbeam.mechanics.fields.rotation import Field
from gbeam.mechanics.fields.taylor import EPSILON

Array = Any


@record
class LoadWork:
    """Loads on a field, δW = Σ F·δr + M·δθ.

    Parameters
    ----------
    field : Field
        Sampled at the loaded points.
    load : (p,) index of the load that acts there
    weight : (p,) 1, or the quadrature weight of a load per length, m
    follower : (p,) whether its axes are the section's
    """

    field: Field
    load: Array
    weight: Array
    follower: Array

    def generalised(self, q: Array, values: Array) -> Array:
        """Resultant force N and moment N m at the root, base axes, then the forces on the coordinates, (6 + n,).

        By JAX: the forces are pulled back along the places and rotations of the loaded points.
        """
        import jax
        import jax.numpy as jnp

        def place(q: Array) -> tuple[Array, Array]:
            return self.field.position(q), self.field.rotation(q)

        (r, rotation), pull_back = jax.vjp(place, q)
        force, moment = self.forces(rotation, values)
        # δR = [δθ]× R, so that ½ [M]× R : δR = M·δθ. The columns of [M]× R are M × those of R.
        turning = 0.5 * jnp.cross(moment[:, :, None], rotation, axis=1)
        (along,) = pull_back((force, turning))
        total = jnp.sum(jnp.cross(r, force) + moment, axis=0)
        return jnp.concatenate([jnp.sum(force, axis=0), total, along])

    def forces(self, rotation: Array, values: Array) -> tuple[Array, Array]:
        """Forces and moments at the loaded points, base axes, given their sections' rotations, (..., p, 3) each."""
        xp = namespace(rotation, values, self.weight)
        local = xp.asarray(self.weight)[:, None] * values[..., self.load, :]
        axes = xp.where(xp.asarray(self.follower)[:, None, None], rotation, xp.eye(3))
        return (
            xp.einsum("...pij,...pj->...pi", axes, local[..., :3]),
            xp.einsum("...pij,...pj->...pi", axes, local[..., 3:]),
        )

    def first_order(self, count: int) -> LoadTerms:
        """The generalised forces of `count` loads' unit components, to first order in q."""
        places, turns = self.field.places(), self.field.turns()
        xp = namespace(places.first, self.weight)
        r0, slope, bend = places.r0, places.first, places.second
        points, _, n = slope.shape
        unit = xp.broadcast_to(xp.eye(3), (points, 3, 3))  # [p, c, a]: component a of the unit vector c
        # How the unit vectors of a follower turn: R1 e_c, (p, c, a, n).
        turned = xp.asarray(self.follower)[:, None, None, None] * xp.einsum("paci->pcai", turns.first)

        def cross(left: Array, right: Array, form: str) -> Array:
            return xp.einsum(f"abd,{form}", xp.asarray(EPSILON), left, right)

        none = xp.zeros((points, 3, 3))
        force = xp.concat([unit, cross(r0, unit, "pb,pcd->pca"), xp.einsum("pai,pca->pci", slope, unit)], axis=2)
        force_slope = xp.concat(
            [
                turned,
                cross(slope, unit, "pbj,pcd->pcaj") + cross(r0, turned, "pb,pcdj->pcaj"),
                xp.einsum("paij,pca->pcij", bend, unit) + xp.einsum("pai,pcaj->pcij", slope, turned),
            ],
            axis=2,
        )
        # Of a moment, ½ [M]× R : ∂R/∂q.
        skew = -0.5 * xp.einsum("abd,pcd->pcab", xp.asarray(EPSILON), unit)
        skew_turned = -0.5 * xp.einsum("abd,pcdj->pcabj", xp.asarray(EPSILON), turned)
        moment = xp.concat([none, unit, xp.einsum("pcab,pabi->pci", skew, turns.first)], axis=2)
        along = (
            xp.einsum("pcab,pabij->pcij", skew, turns.second)
            + xp.einsum("pcab,pbdj,padi->pcij", skew, turns.first, turns.first)
            + xp.einsum("pcabj,pabi->pcij", skew_turned, turns.first)
        )
        moment_slope = xp.concat([xp.zeros((points, 3, 3, n)), turned, along], axis=2)
        weight = xp.asarray(self.weight)
        onto = (np.arange(count)[:, None] == np.asarray(self.load)) * weight  # (loads, p)
        return LoadTerms(
            xp.einsum("lp,pcj->lcj", onto, xp.concat([force, moment], axis=1)),
            xp.einsum("lp,pcjn->lcjn", onto, xp.concat([force_slope, moment_slope], axis=1)),
        )


@record
class LoadHistory:
    """The components of all loads over time; called as ``history(t)``.

    Parameters
    ----------
    profiles : tuple of (force, moment)
        Per load, vector profiles of time.
    """

    profiles: tuple[tuple[Any, Any], ...]

    def __call__(self, t: Array) -> Array:
        """Components (..., loads, 6) at times t, s: N, N m; per metre where the load is."""
        parts = [[p(t) for p in pair] for pair in self.profiles]
        xp = namespace(*(part for pair in parts for part in pair))
        return xp.stack([xp.concatenate(pair, axis=-1) for pair in parts], axis=-2)

    def corners(self, step: float) -> np.ndarray:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        return np.unique(np.concatenate([p.corners(step) for pair in self.profiles for p in pair]))
