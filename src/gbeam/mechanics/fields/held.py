"""A field of strains in the coordinates that rigid supports leave.

A support holds components of a section's displacement and rotation vector: g(q) = 0 with rows A = ∂g/∂q. Of the
coordinates q of the free beam the dependent ones d follow from the others, p, by Newton's method, and

    q̇ = Φ ṗ,  q̈ = Φ p̈ + [−A_d⁻¹ γ; 0],  Φ = [−A_d⁻¹ A_p; 1],

with γ the second derivative of g at q̈ = 0. Motion goes out through the free field, forces come back by Φᵀ.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.strains import StrainField, Tangents
from gbeam.mechanics.fields.taylor import Places, Turns
from gbeam.mechanics.fields.vectors import NONE, Vector, absent, add, cross, joined, mapped
from gbeam.numerics.series import STEP

CORRECTIONS, AS_LONG = 24, 4  # of Newton's method at most, and with the same slopes
NEAR = 1e-10  # likewise: a larger last correction has found nothing
TRACED = 8  # corrections under JAX
CLOSE = 1e-14  # of a length or rad: a smaller correction is rounding
DIFFERENCE = 1e-4  # m or rad: step of the rows' second difference along a motion
SMALL = 1e-2  # rad²: squares of smaller angles have series


@record
class Measures:
    """Displacements and rotation vectors of sections of a beam, of a straight one at rest: m of them, each of a
    section, by its number among the `sections`, in a direction from 0 to 5, in axes of the root.
    """

    sections: StrainField
    rest: Array
    which: tuple[tuple[int, int], ...] = static()

    def chosen(self, moved: Array, turned: Array) -> Array:
        """Components (..., m, ...) of the vectors (..., k, 3, ...) of displacements and rotations, as measured."""
        parts = [moved[..., k, d, :] if d < 3 else turned[..., k, d - 3, :] for k, d in self.which]
        return namespace(moved, turned).stack(parts, axis=-2)

    def values(self, q: Array) -> Array:
        """Measures (..., m) at coordinates (..., n)."""
        return self.values_at(self.sections.tangents(q, points=True), q)

    def rows(self, q: Array) -> Array:
        """Derivatives (..., m, n) of the measures by the coordinates (..., n)."""
        return self.rows_at(self.sections.tangents(q, points=True), q)

    def values_at(self, tangents: Tangents, q: Array) -> Array:
        """Measures (..., m) by the tangents at coordinates (..., n)."""
        place = mapped(tangents.t, self.sections.cumulative)
        moved = joined(namespace(q), place, (*q.shape[:-1], len(self.rest))) - self.rest
        angle = moved
        if any(direction > 2 for _, direction in self.which):
            angle = rotation_vectors(self._rotation(tangents, q))
        return self.chosen(moved[..., None], angle[..., None])[..., 0]

    def rows_at(self, tangents: Tangents, q: Array) -> Array:
        """Derivatives (..., m, n) of the measures by the coordinates (..., n): what unit loads on them do."""
        xp, count = namespace(q), len(self.rest)
        force = np.zeros((3, len(self.which), count))
        turning = [(k, section, direction - 3) for k, (section, direction) in enumerate(self.which) if direction > 2]
        for k, (section, direction) in enumerate(self.which):
            if direction < 3:
                force[direction, k, section] = 1.0
        push: Any = tuple(force)
        turn: Any = NONE
        if turning:
            vector_rate, _ = _vector_rates(rotation_vectors(self._rotation(tangents, q)))
            moment = xp.zeros((*q.shape[:-1], 3, len(self.which), count))
            for k, section, axis in turning:
                unit = np.zeros((len(self.which), count))
                unit[k, section] = 1.0
                moment = moment + vector_rate[..., section, axis, :, None, None] * unit
            turn = tuple(moment[..., axis, :, :] for axis in range(3))
        alike = _for_each_row(tangents)
        return self.sections.pulled(alike, *self.sections.nodal_forces(alike, push, turn))

    def bent_rows(self, q: Array) -> Array:
        """Second derivatives (..., m, n, n) of the measures by the coordinates (..., n), where they are real."""
        field, count = self.sections, len(self.rest)
        tangents = field.tangents(q[..., None, :], points=True)  # components (..., 1, G)
        fixed = Tangents(tangents.rotation, tangents.t)
        columns = field.columns(fixed)
        (place, angle), outboard = (columns.place[0], columns.angle[0]), field.node_cumulative.T
        turned_points = joined(
            np, field.columns_of_points(fixed, columns).angle[0], (*q.shape[:-1], q.shape[-1], count)
        )
        bent = list[Array]()
        for section, direction in self.which:
            reach = field.cumulative[section]
            if direction < 3:
                x, y, z = (reach if axis == direction else 0 for axis in range(3))
                push: Vector = (x, y, z)
                carried = mapped(cross(tangents.t, push), outboard)
                moment = add(cross(carried, angle), mapped(cross(place, push), outboard))
                bent.append(field.inward(tangents, cross(push, angle), moment))
                continue
            at = self._rotation(tangents, q[..., None, :])[..., 0, section, :, :]
            vector_rate, by_vector = _vector_rates(rotation_vectors(at))
            unit, along = (
                vector_rate[..., direction - 3, :],
                turned_points[..., section, :] @ np.swapaxes(vector_rate, -1, -2),
            )
            change = sum(along[..., k, None] * by_vector(np.eye(3)[k])[..., None, direction - 3, :] for k in range(3))
            spin: Any = tuple(unit[..., k, None, None] * reach for k in range(3))
            grown: Any = tuple(change[..., k, None] * reach for k in range(3))
            bent.append(field.inward(tangents, NONE, add(cross(spin, angle), grown)))
        return np.stack(bent, axis=-3)

    def drift_at(self, tangents: Tangents, q: Array, qd: Array) -> Array:
        """Second derivatives (..., m) of the measures with respect to time, at coordinates that do not accelerate."""
        xp = namespace(q, qd)
        moving = self.sections.moving(q, qd, 0 * qd, points=True, at_rest=tangents)
        shape = (*np.broadcast_shapes(q.shape[:-1], qd.shape[:-1]), len(self.rest))
        vectors = moving.tdd, moving.turn, moving.turnd
        change, w, alpha = (joined(xp, mapped(each, self.sections.cumulative), shape) for each in vectors)
        vector_rate, by_vector = _vector_rates(rotation_vectors(self._rotation(tangents, q)))
        phi_rate = (vector_rate @ w[..., None])[..., 0]
        turned = vector_rate @ alpha[..., None] + by_vector(phi_rate) @ w[..., None]
        return self.chosen(change[..., None], turned)[..., 0]

    def _rotation(self, tangents: Tangents, q: Array) -> Array:
        """Rotations (..., k, 3, 3) of the sections."""
        shape = (*q.shape[:-1], len(self.rest))
        return namespace(q).stack([joined(namespace(q), row, shape) for row in tangents.at_points], axis=-2)


@record
class Conditions:
    """Measures that rigid supports keep zero, and indices of the coordinates that are `dependent`, out of `size`."""

    measures: Measures
    dependent: tuple[int, ...] = static()
    size: int = static()

    @property
    def independent(self) -> Array:
        """Indices of the coordinates p that are left."""
        return np.delete(np.arange(self.size), self.dependent)

    def lifted(self, p: Array) -> Array:
        """Coordinates q (..., n) of the free beam at those that are left, (..., k)."""
        xp, held, unit = namespace(p), np.array(self.dependent, dtype=int), np.eye(self.size)
        spread, onto = unit[self.independent], unit[held]
        if is_jax(p):
            import jax

            q = jax.lax.stop_gradient(p) @ spread
            for _ in range(TRACED):
                q = q - self._correction(q) @ onto
            slope = jax.lax.stop_gradient(self.measures.rows(q)[..., held])
            q = p @ spread + jax.lax.stop_gradient(q)[..., held] @ onto
            return q - xp.linalg.solve(slope, self.measures.values(q)[..., None])[..., 0] @ onto
        q = _alike(np.real(p)) @ spread
        for k in range(CORRECTIONS):
            tangents = self.measures.sections.tangents(q, points=True)
            if k % AS_LONG == 0:
                slope = self.measures.rows_at(tangents, q)[..., held]
            correction = np.linalg.solve(slope, self.measures.values_at(tangents, q)[..., None])[..., 0]
            q = q - correction @ onto
            if not np.abs(correction).max(initial=0.0) > CLOSE * (1 + np.abs(q).max(initial=0.0)):
                break
        else:
            lost = np.abs(correction).max(axis=-1, keepdims=True) > NEAR * (1 + np.abs(q).max(axis=-1, keepdims=True))
            q = np.where(lost, np.nan, q)  # no motion near by meets the conditions
        if not np.iscomplexobj(p):
            return np.broadcast_to(q, (*p.shape[:-1], self.size))
        # One more correction carries the complex step.
        rows, step = self.measures.rows(q), np.imag(p) @ spread
        follow = np.linalg.solve(rows[..., held], rows @ step[..., None])[..., 0]
        return q + 1j * (step - follow @ onto)

    def _correction(self, q: Array) -> Array:
        """Newton's correction (..., d) of the dependent coordinates."""
        xp, slope = namespace(q), self.measures.rows(q)[..., np.array(self.dependent, dtype=int)]
        return xp.linalg.solve(slope, self.measures.values(q)[..., None])[..., 0]

    def basis(self, q: Array) -> Array:
        """Φ (..., n, k), by which small motions of the coordinates follow those of the independent ones."""
        return self._basis(self.measures.rows(q))

    def _basis(self, rows: Array) -> Array:
        """Φ (..., n, k) by the rows (..., m, n) of the conditions."""
        held, unit = np.array(self.dependent, dtype=int), np.eye(self.size)
        follow = -namespace(rows).linalg.solve(rows[..., held], rows[..., self.independent])
        return unit[:, self.independent] + unit[:, held] @ follow

    def motion(self, p: Array, pd: Array, pdd: Array) -> tuple[Array, Array, Array]:
        """Coordinates, rates and accelerations (..., n) of the free beam."""
        return self.moving(p, pd, pdd)[:3]

    def moving(self, p: Array, pd: Array, pdd: Array) -> tuple[Array, Array, Array, Array]:
        """Coordinates, rates and accelerations (..., n) of the free beam, and Φ there.

        Complex steps from one real motion follow from the derivatives there.
        """
        if any(map(np.iscomplexobj, (p, pd, pdd))):
            stepped = self._stepped(p, pd, pdd)
            if stepped is not None:
                return stepped
        q, held = self.lifted(p), np.array(self.dependent, dtype=int)
        tangents = self.measures.sections.tangents(q, points=True)
        rows = self.measures.rows_at(tangents, q)
        phi = self._basis(rows)
        qd, qdd = ((phi @ each[..., None])[..., 0] for each in (pd, pdd))
        drift = self.measures.drift_at(tangents, q, qd)
        fallen = namespace(rows, drift).linalg.solve(rows[..., held], drift[..., None])[..., 0]
        return q, qd, qdd - fallen @ np.eye(self.size)[held], phi

    def _stepped(self, p: Array, pd: Array, pdd: Array) -> tuple[Array, Array, Array, Array] | None:
        """Motion as :meth:`moving` returns it, for complex steps of one real motion; else None."""
        axes = max(values.ndim for values in (p, pd, pdd))
        motion = [values if values.ndim == axes else values[None] for values in (p, pd, pdd)]
        real = [_alike(np.real(values)) for values in motion]
        if axes < 2 or any(len(values) > 1 for values in real):
            return None
        q, qd, qdd, phi = self.moving(*real)
        step_p, step_pd, step_pdd = (np.imag(values) for values in motion)
        held, onto = np.array(self.dependent, dtype=int), np.eye(self.size)[np.array(self.dependent, dtype=int)]
        rows, bent = self.measures.rows(q), self.measures.bent_rows(q)
        inverse = np.linalg.inv(rows[..., held])

        def follow(measures: Array) -> Array:
            """Coordinates (..., n) of which the dependent ones take back changes of measures (..., m)."""
            return -(inverse @ measures[..., None])[..., 0] @ onto

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
        dphi = -np.swapaxes(onto, 0, 1) @ (inverse @ turned_phi)
        return q + 1j * dq, qd + 1j * dqd, qdd + 1j * dqdd, phi + 1j * dphi

    def projected(self, q: Array, forces: Array) -> Array:
        """Forces (..., k) on the independent coordinates that do the work of forces (..., n)."""
        return projection(self.basis(q), forces)

    def curvature(self, q: Array, phi: Array) -> Array:
        """Second derivatives (d, k, k) of the dependent coordinates by the independent ones, at q (n,)."""
        along = np.array(q) + 1j * STEP * phi.T
        change = np.imag(self.measures.rows(along)) / STEP  # of the rows, along each independent coordinate
        bent = np.moveaxis(change @ phi, 0, -1)
        slope = self.measures.rows(q)[:, np.array(self.dependent, dtype=int)]
        return -np.linalg.solve(slope, bent.reshape(len(slope), -1)).reshape(bent.shape)


@record
class HeldStrainField:
    """A field of strains, `free`, in the coordinates that conditions leave."""

    free: StrainField
    conditions: Conditions

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.conditions.size - len(self.conditions.dependent)

    @property
    def cumulative(self) -> Array:
        """Weights that integrate from the root to each point."""
        return self.free.cumulative

    def __getitem__(self, at: Any) -> HeldStrainField:
        """The field at some of the points."""
        return replace(self, free=self.free[at])

    def points(self, at: Any, offset: Array | None = None) -> HeldStrainField:
        """The field of points fixed to the sections `at`, `offset` (p, 3) m from the axis, section axes."""
        return replace(self, free=self.free.points(at, offset))

    def sections(self, at: Any) -> HeldStrainField:
        """The field of some sections."""
        return self.points(at)

    def joined(self, axis: HeldStrainField) -> HeldStrainField:
        """Field of these points followed by the points of `axis`, a field of the same beam's axis."""
        return replace(self, free=self.free.joined(axis.free))

    def expand_rest(self) -> Places:
        """Places about the beam at rest, to first order."""
        rest = np.zeros(self.size)
        return Places(self.positions(rest), self.slopes(rest))

    def positions(self, q: Array) -> Array:
        """Places of the points at coordinates (..., n), base axes, (..., p, 3) m."""
        return self.free.positions(self.conditions.lifted(q))

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotation matrices R_BS (..., p, 3, 3) of the sections `at` some points, of all unless given."""
        return self.free.rotation(self.conditions.lifted(q), at)

    def components(self, q: Array, qd: Array, qdd: Array) -> tuple[Vector, Vector, Vector]:
        """Places, velocities and accelerations of the points relative to the base axes, by components (..., p)."""
        return self.free.components(*self.conditions.motion(q, qd, qdd))

    def paths(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Places, velocities and accelerations of the points relative to the base axes, (..., p, 3) each."""
        return self.free.paths(*self.conditions.motion(q, qd, qdd))

    def poses(self, q: Array, qd: Array, qdd: Array, at: slice) -> tuple[tuple[Array, Array, Array], Array]:
        """Paths (..., p, 3) of all points, and rotations (..., k, 3, 3) of the sections `at` k of them, in one pass."""
        return self.free.poses(*self.conditions.motion(q, qd, qdd), at)

    def turning(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Rotations (..., p, 3, 3) of the points' sections, their angular velocities and accelerations, base axes."""
        return self.free.turning(*self.conditions.motion(q, qd, qdd))

    def generalised_forces(self, q: Array, push: Vector, turn: Vector = NONE) -> Array:
        """Generalised forces (..., n) of forces and moments on the points, base axes, by components (..., p)."""
        whole = self.conditions.lifted(q)
        return self.conditions.projected(whole, self.free.generalised_forces(whole, push, turn))

    def slopes(self, q: Array) -> Array:
        """∂r/∂q of the points at coordinates (..., n), (..., p, 3, n)."""
        return self.jacobians(q)[0]

    def jacobians(self, q: Array) -> tuple[Array, Array]:
        """Derivatives ∂r/∂q of the points and of their sections' angles by the coordinates, (..., p, 3, n) each."""
        whole = self.conditions.lifted(q)
        phi = self.conditions.basis(whole)[..., None, :, :]
        slopes, angles = self.free.jacobians(whole)
        return slopes @ phi, angles @ phi

    def expand(self, q: Array, mass: Array) -> tuple[Places, Array]:
        """Places about coordinates (n,), to first order, and Σ m ∂²r/∂q² and Σ m r_b ∂²r/∂q², (4, 3, n, n)."""
        whole = self.conditions.lifted(q)
        places, bent = self.free.expand(whole, mass)
        phi = self.conditions.basis(whole)
        curved = self.conditions.curvature(whole, phi)
        weights = np.concatenate([mass[None], mass * places.r0.T])
        by_held = np.einsum("wp,pad->wad", weights, places.first[..., np.array(self.conditions.dependent, dtype=int)])
        second = phi.T @ bent @ phi + np.einsum("wad,dij->waij", by_held, curved)
        return Places(places.r0, places.first @ phi), second

    def curved(self, q: Array) -> tuple[Places, Array, Turns]:
        """Positions near coordinates (n,) to second order, the sections' rotations (p, 3, 3) and their derivatives."""
        whole, held = self.conditions.lifted(q), np.array(self.conditions.dependent, dtype=int)
        places, rotation, turns = self.free.curved(whole)
        phi = self.conditions.basis(whole)
        curved = self.conditions.curvature(whole, phi)
        second = phi.T @ places.second @ phi + np.einsum("pad,dij->paij", places.first[..., held], curved)
        bent = phi.T @ turns.second @ phi + np.einsum("pabd,dij->pabij", turns.first[..., held], curved)
        return Places(places.r0, places.first @ phi, second), rotation, Turns(turns.first @ phi, bent)


def projection(basis: Array, forces: Array) -> Array:
    """Forces (..., k) along the columns of a basis (..., n, k) that do the work of forces (..., n)."""
    return (namespace(basis, forces).swapaxes(basis, -1, -2) @ forces[..., None])[..., 0]


def _alike(real: Array) -> Array:
    """Values (..., n), one along the first axis where they are alike there, as those of complex steps are."""
    return real[:1] if real.ndim > 1 and len(real) > 1 and (real == real[:1]).all() else real


def _for_each_row(tangents: Tangents) -> Tangents:
    """Tangents (..., 1, G) for forces (..., m, G) that act one row after the other."""

    def wider(part: Any) -> Any:
        return part if absent(part) else part[..., None, :]

    x, y, z = (wider(part) for part in tangents.t)
    rotation: Any = tuple(
        tuple(part if isinstance(part, int) else wider(part) for part in row) for row in tangents.rotation
    )
    return Tangents(rotation, (x, y, z))


def rotation_vectors(R: Array) -> Array:
    """Rotation vectors (..., 3) of rotations (..., 3, 3) by less than half a turn."""
    xp = namespace(R)
    sine = 0.5 * xp.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], -1)
    cosine = (R[..., 0, 0] + R[..., 1, 1] + R[..., 2, 2] - 1) / 2
    square = (sine * sine).sum(axis=-1)
    small = (square.real < SMALL**2) & (cosine.real > 0)
    safe = xp.sqrt(xp.where(small, 1.0, square))
    large = 2 * xp.arctan(safe / (1 + xp.where(small, 1.0, cosine))) / safe
    series = 1 + square / 6 + 3 * square**2 / 40 + 5 * square**3 / 112
    return xp.where(small, series, large)[..., None] * sine


def _skew(vector: Array) -> Array:
    """Matrices (..., 3, 3) of the vector product with vectors (..., 3)."""
    xp = namespace(vector)
    x, y, z = (vector[..., k] for k in range(3))
    zero = xp.zeros_like(x)
    return xp.stack([xp.stack([zero, -z, y], -1), xp.stack([z, zero, -x], -1), xp.stack([-y, x, zero], -1)], -2)


def _vector_rates(phi: Array) -> tuple[Array, Any]:
    """Matrices B (..., 3, 3) with φ̇ = B ω of rotation vectors (..., 3), and the function of φ̇ that gives Ḃ.

    B = 1 − ½ [φ]× + c [φ]×² with c = (1 − θ/2 cot θ/2)/θ²; ω is in the axes that do not turn.
    """
    xp, cross = namespace(phi), _skew(phi)
    square = (phi * phi).sum(axis=-1)[..., None, None]
    small = square.real < SMALL
    theta = xp.sqrt(xp.where(small, 1.0, square))
    cotangent = 1 / xp.tan(theta / 2)
    large = (1 - theta / 2 * cotangent) / theta**2
    c = xp.where(small, 1 / 12 + square / 720 + square**2 / 30240 + square**3 / 1209600, large)
    by_square = (theta / xp.sin(theta / 2) ** 2 / 2 + cotangent) / (4 * theta**3) - 1 / theta**4
    slope = xp.where(small, 1 / 720 + square / 15120 + square**2 / 403200, by_square)

    def change(phi_rate: Array) -> Array:
        """Ḃ by φ̇ (..., 3)."""
        rate = _skew(phi_rate)
        growth = 2 * (phi * phi_rate).sum(axis=-1)[..., None, None] * slope
        return -rate / 2 + c * (rate @ cross + cross @ rate) + growth * (cross @ cross)

    return np.eye(3) - cross / 2 + c * (cross @ cross), change
