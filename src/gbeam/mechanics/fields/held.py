"""A field in the coordinates that rigid supports leave.

A support holds components of a section's displacement and rotation vector: g(q) = 0 with rows A = ∂g/∂q. Of the
coordinates q of the free beam the dependent ones d follow from the others, p, by Newton's method, and

    q̇ = Φ ṗ,  q̈ = Φ p̈ + [−A_d⁻¹ γ; 0],  Φ = [−A_d⁻¹ A_p; 1],

with γ the second derivative of g at q̈ = 0. Motion goes out through the free field, forces come back by Φᵀ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.measures import Measures
from gbeam.mechanics.fields.taylor import Places, Turns
from gbeam.mechanics.fields.vectors import Vector

CORRECTIONS, AS_LONG = 24, 4  # of Newton's method at most, and with the same slopes
NEAR = 1e-10  # likewise: a larger last correction has found nothing
TRACED = 8  # corrections under JAX
CLOSE = 1e-14  # of a length or rad: a smaller correction is rounding
DIFFERENCE = 1e-4  # m or rad: step of the rows' second difference along a motion


def null_basis(rows: Array, dependents: Sequence[int], inverse: Array | None = None) -> Array:
    """Basis Φ (..., n, k) of the coordinates that conditions with rows (..., m, n) leave.

    The independent coordinates are free, and the `dependents` follow. The `inverse` (..., m, m) of the columns of the
    dependents is used where it is known.
    """
    unit, dependent = np.eye(rows.shape[-1]), np.array(dependents, dtype=int)
    free_columns = np.delete(unit, dependent, axis=1)
    if not len(dependent):
        return free_columns
    if inverse is None:
        return free_columns - unit[:, dependent] @ namespace(rows).linalg.solve(
            rows[..., dependent], rows @ free_columns
        )
    return free_columns - unit[:, dependent] @ (inverse @ (rows @ free_columns))


@record
class Conditions:
    """Measures that rigid supports keep zero, and indices of the coordinates that are `dependent`, out of `size`.

    There are none where only springs hold a beam.
    """

    measures: Measures
    dependent: tuple[int, ...] = static()
    size: int = static()

    @property
    def independent(self) -> Array:
        """Indices of the coordinates p that are left."""
        return np.delete(np.arange(self.size), self.dependent)

    def lifted(self, p: Array) -> Array:
        """Coordinates q (..., n) of the free beam at those that are left, (..., k)."""
        if not self.dependent:
            return p
        xp, dependent, unit = namespace(p), np.array(self.dependent, dtype=int), np.eye(self.size)
        spread, dependent_columns = unit[self.independent], unit[dependent]
        if is_jax(p):
            import jax

            q = jax.lax.stop_gradient(p) @ spread
            for _ in range(TRACED):
                values, rows = self.measures.values_and_rows(q)
                q = q - xp.linalg.solve(rows[..., dependent], values[..., None])[..., 0] @ dependent_columns
            slope = jax.lax.stop_gradient(self.measures.rows(q)[..., dependent])
            q = p @ spread + jax.lax.stop_gradient(q)[..., dependent] @ dependent_columns
            return q - xp.linalg.solve(slope, self.measures.values(q)[..., None])[..., 0] @ dependent_columns
        q = _first_if_equal(np.real(p)) @ spread
        for k in range(CORRECTIONS):
            state = self.measures.state(q)
            if k % AS_LONG == 0:
                inverse = np.linalg.inv(self.measures.rows_at(state, q)[..., dependent])
            correction = (inverse @ self.measures.values_at(state, q)[..., None])[..., 0]
            q = q - correction @ dependent_columns
            if not np.abs(correction).max(initial=0.0) > CLOSE * (1 + np.abs(q).max(initial=0.0)):
                break
        else:
            is_lost = np.abs(correction).max(axis=-1, keepdims=True) > NEAR * (
                1 + np.abs(q).max(axis=-1, keepdims=True)
            )
            q = np.where(is_lost, np.nan, q)  # no motion near by meets the conditions
        if not np.iscomplexobj(p):
            return np.broadcast_to(q, (*p.shape[:-1], self.size))
        # One more correction carries the complex step.
        rows, step = self.measures.rows(q), np.imag(p) @ spread
        follow = np.linalg.solve(rows[..., dependent], rows @ step[..., None])[..., 0]
        return q + 1j * (step - follow @ dependent_columns)

    def basis(self, q: Array) -> Array:
        """Φ (..., n, k), by which small motions of the coordinates follow those of the independent ones."""
        if not self.dependent:
            return np.eye(self.size)
        return null_basis(self.measures.rows(q), self.dependent)

    def motion(self, p: Array, pd: Array, pdd: Array) -> tuple[Array, Array, Array]:
        """Coordinates, rates and accelerations (..., n) of the free beam."""
        return self.moving(p, pd, pdd)[:3]

    def moving(self, p: Array, pd: Array, pdd: Array) -> tuple[Array, Array, Array, Array]:
        """Coordinates, rates and accelerations (..., n) of the free beam, and Φ there.

        Complex steps from one real motion follow from the derivatives there.
        """
        if not self.dependent:
            return p, pd, pdd, np.eye(self.size)
        if any(map(np.iscomplexobj, (p, pd, pdd))):
            stepped = self._stepped(p, pd, pdd)
            if stepped is not None:
                return stepped
        q, dependent = self.lifted(p), np.array(self.dependent, dtype=int)
        state = self.measures.state(q)
        rows = self.measures.rows_at(state, q)
        inverse = namespace(rows).linalg.inv(rows[..., dependent])
        phi = null_basis(rows, self.dependent, inverse)
        qd, qdd = ((phi @ rates[..., None])[..., 0] for rates in (pd, pdd))
        fallen = (inverse @ self.measures.drift_at(state, q, qd)[..., None])[..., 0]
        return q, qd, qdd - fallen @ np.eye(self.size)[dependent], phi

    def _stepped(self, p: Array, pd: Array, pdd: Array) -> tuple[Array, Array, Array, Array] | None:
        """Motion as :meth:`moving` returns it, for complex steps of one real motion; else None."""
        axes = max(values.ndim for values in (p, pd, pdd))
        motion = [values if values.ndim == axes else values[None] for values in (p, pd, pdd)]
        real = [_first_if_equal(np.real(values)) for values in motion]
        if axes < 2 or any(len(values) > 1 for values in real):
            return None
        q, qd, qdd, phi = self.moving(*real)
        step_p, step_pd, step_pdd = (np.imag(values) for values in motion)
        dependent, dependent_columns = (
            np.array(self.dependent, dtype=int),
            np.eye(self.size)[np.array(self.dependent, dtype=int)],
        )
        rows, bent = self.measures.rows(q), self.measures.bent_rows(q)
        inverse = np.linalg.inv(rows[..., dependent])

        def follow(measures: Array) -> Array:
            """Coordinates (..., n) of which the dependent ones take back changes of measures (..., m)."""
            return -(inverse @ measures[..., None])[..., 0] @ dependent_columns

        def free(steps: Array) -> Array:
            """Motion (..., n) of the free beam by steps (..., k) of the independent coordinates."""
            return (phi @ steps[..., None])[..., 0]

        def along(vector: Array) -> Array:
            """Change (..., m, n) of the rows along a vector (..., n)."""
            return np.einsum("...mji,...j->...mi", bent, vector)

        by_rate, by_change = along(qd), along(qdd)
        dq = free(step_p)
        dqd = free(step_pd) + follow((by_rate @ dq[..., None])[..., 0])
        drift = 2 * (by_rate @ dqd[..., None])[..., 0] + (by_change @ dq[..., None])[..., 0]
        size = np.abs(qd).max(initial=0.0)
        if size > 0:
            h = DIFFERENCE / size
            ahead, behind = (self.measures.rows(q + sign * h * qd) for sign in (1, -1))
            drift = drift + (((ahead - 2 * rows + behind) / h**2) @ dq[..., None])[..., 0]
        dqdd = free(step_pdd) + follow(drift)
        turned_phi = np.einsum("...mji,...j->...mi", bent, dq) @ phi
        dphi = -np.swapaxes(dependent_columns, 0, 1) @ (inverse @ turned_phi)
        return q + 1j * dq, qd + 1j * dqd, qdd + 1j * dqdd, phi + 1j * dphi

    def projected(self, q: Array, forces: Array) -> Array:
        """Forces (..., k) on the independent coordinates that do the work of forces (..., n)."""
        return projection(self.basis(q), forces)

    def curvature(self, q: Array, phi: Array) -> Array:
        """Second derivatives (d, k, k) of the dependent coordinates by the independent ones, at q (n,)."""
        bent = phi.T @ self.measures.bent_rows(q) @ phi
        slope = self.measures.rows(q)[:, np.array(self.dependent, dtype=int)]
        return -np.linalg.solve(slope, bent.reshape(len(slope), -1)).reshape(bent.shape)


@record
class HeldField:
    """A field, `free`, in the coordinates that conditions leave: of strains, or polynomials."""

    free: Any
    conditions: Conditions

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.conditions.size - len(self.conditions.dependent)

    def __getitem__(self, at: Any) -> HeldField:
        """The field at some of the points."""
        return replace(self, free=self.free[at])

    def points(self, at: Any, offset: Array | None = None) -> HeldField:
        """The field of points fixed to the sections `at`, `offset` (p, 3) m from the axis, section axes."""
        return replace(self, free=self.free.points(at, offset))

    def sections(self, at: Any) -> HeldField:
        """The field of some sections."""
        return replace(self, free=self.free.sections(at))

    def joined(self, axis: HeldField) -> HeldField:
        """Field of these points followed by the points of `axis`, a field of the same beam's axis."""
        return replace(self, free=self.free.joined(axis.free))

    def expand_rest(self) -> Places:
        """Places about the beam at rest, to first order."""
        rest = np.zeros(self.size)
        return Places(self.positions(rest), self.slopes(rest))

    def positions(self, q: Array) -> Array:
        """Places of the points at coordinates (..., n), base axes, (..., p, 3) m."""
        return self.free.positions(self.conditions.lifted(q))

    def rotation(self, q: Array, *at: Any) -> Array:
        """Rotation matrices R_BS (..., p, 3, 3) of the sections `at` some points, of all unless given."""
        return self.free.rotation(self.conditions.lifted(q), *at)

    def paths(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Places, velocities and accelerations of the points relative to the base axes, (..., p, 3) each."""
        return self.free.paths(*self.conditions.motion(q, qd, qdd))

    def poses(self, q: Array, qd: Array, qdd: Array, at: slice) -> tuple[tuple[Array, Array, Array], Array]:
        """Paths (..., p, 3) of all points, and rotations (..., k, 3, 3) of the sections `at` k of them, in one pass."""
        return self.free.poses(*self.conditions.motion(q, qd, qdd), at)

    def generalised_forces(self, q: Array, push: Vector, *turn: Vector) -> Array:
        """Generalised forces (..., n) of forces, and moments, on the points, base axes, by components (..., p)."""
        coordinates = self.conditions.lifted(q)
        return self.conditions.projected(coordinates, self.free.generalised_forces(coordinates, push, *turn))

    def slopes(self, q: Array) -> Array:
        """∂r/∂q of the points at coordinates (..., n), (..., p, 3, n)."""
        coordinates = self.conditions.lifted(q)
        return self.free.slopes(coordinates) @ self.conditions.basis(coordinates)[..., None, :, :]

    def jacobians(self, q: Array) -> tuple[Array, Array]:
        """Derivatives ∂r/∂q of the points and of their sections' angles by the coordinates, (..., p, 3, n) each."""
        coordinates = self.conditions.lifted(q)
        phi = self.conditions.basis(coordinates)[..., None, :, :]
        slopes, angles = self.free.jacobians(coordinates)
        return slopes @ phi, angles @ phi

    def curved(self, q: Array) -> tuple[Places, Array, Turns]:
        """Positions near coordinates (n,) to second order, the sections' rotations (p, 3, 3) and their derivatives."""
        coordinates, dependent = self.conditions.lifted(q), np.array(self.conditions.dependent, dtype=int)
        places, rotation, turns = self.free.curved(coordinates)
        phi = self.conditions.basis(coordinates)
        curved = self.conditions.curvature(coordinates, phi)
        second = phi.T @ places.second @ phi + np.einsum("pad,dij->paij", places.first[..., dependent], curved)
        bent = phi.T @ turns.second @ phi + np.einsum("pabd,dij->pabij", turns.first[..., dependent], curved)
        return Places(places.r0, places.first @ phi, second), rotation, Turns(turns.first @ phi, bent)


def projection(basis: Array, forces: Array) -> Array:
    """Forces (..., k) along the columns of a basis (..., n, k) that do the work of forces (..., n)."""
    return (namespace(basis, forces).swapaxes(basis, -1, -2) @ forces[..., None])[..., 0]


def _first_if_equal(real: Array) -> Array:
    """Values (..., n), one along the first axis where they are alike there, as those of complex steps are."""
    return real[:1] if real.ndim > 1 and len(real) > 1 and (real == real[:1]).all() else real
