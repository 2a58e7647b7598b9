"""Taylor polynomials at the straight beam of where points lie and how sections turn, to second order in q."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gbeam.arrays.namespace import concatenated, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.fields.vectors import NONE, Vector, absent, cross, joined, split


@record
class Places:
    """Places r = r0 + J q + ½ q H q of points, base axes: (p, 3) m, (p, 3, n), and (p, 3, n, n) or None if linear."""

    r0: Any
    first: Any
    second: Any = None

    def __getitem__(self, chosen: Any) -> Places:
        """The polynomials of some of the points."""
        return Places(self.r0[chosen], self.first[chosen], None if self.second is None else self.second[chosen])

    def turned(self, basis: Any) -> Places:
        """The polynomials in coordinates p with q = basis p."""
        second = None if self.second is None else basis.T @ self.second @ basis
        return Places(self.r0, self.first @ basis, second)

    def expand_rest(self) -> Places:
        """Return the polynomials themselves: they are about the beam at rest already."""
        return self

    def expand(self, q: Any) -> Places:
        """The polynomials about coordinates (n,)."""
        return Places(self.positions(q), self.slopes(q), self.second)

    def slopes(self, q: Any) -> Any:
        """∂r/∂q = J + H q at coordinates (..., n), (..., p, 3, n)."""
        xp = namespace(self.first, q)
        if self.second is None:
            return xp.broadcast_to(self.first, (*q.shape[:-1], *self.first.shape))
        return self.first + xp.einsum("paij,...j->...pai", self.second, q)

    def positions(self, q: Any) -> Any:
        """Positions (..., p, 3), m, at coordinates (..., n)."""
        points, axes, n = self.first.shape
        if self.second is None:
            return self.r0 + self._linear(q)
        if points * axes > n:
            return self.r0 + self._sum(q, 0.5 * _outer(q, q))
        # Of few points, as of the tip, H q is smaller than q qᵀ.
        xp = namespace(self.first, q)
        turned = xp.reshape(q @ xp.reshape(self.second, (-1, n)).T, (*q.shape[:-1], points * axes, n))
        curved = xp.reshape(xp.einsum("...ai,...i->...a", turned, q), (*q.shape[:-1], points, axes))
        return self.r0 + self._linear(q) + 0.5 * curved

    def paths(self, q: Any, qd: Any, qdd: Any) -> tuple[Any, Any, Any]:
        """Places, velocities and accelerations relative to the base axes, (..., p, 3) each."""
        if self.second is None:
            return self.positions(q), self._linear(qd), self._linear(qdd)
        return self.positions(q), self._sum(qd, _outer(q, qd)), self._sum(qdd, _outer(q, qdd) + _outer(qd, qd))

    def components(self, q: Any, qd: Any, qdd: Any) -> tuple[Vector, Vector, Vector]:
        """Places, velocities and accelerations by components (..., p)."""
        r, rd, rdd = (split(component) for component in self.paths(q, qd, qdd))
        return r, rd, rdd

    def generalised_forces(self, q: Any, push: Vector) -> Any:
        """Generalised forces (..., n) of forces on the points, by components (..., p): the slopes at q, transposed,
        times the forces.
        """
        xp, (points, axes, n) = namespace(self.first, q), self.first.shape
        force = xp.stack(xp.broadcast_arrays(*push), axis=-1)
        rows = xp.reshape(force, (*force.shape[:-2], points * axes))
        straight = rows @ xp.reshape(self.first, (-1, n))
        if self.second is None:
            return straight
        curved = xp.reshape(rows @ xp.reshape(self.second, (points * axes, n * n)), (*rows.shape[:-1], n, n))
        return straight + xp.sum(curved * q[..., None, :], axis=-1)

    def _linear(self, q: Any) -> Any:
        """J·q of (..., n)."""
        points, axes, n = self.first.shape
        rows = namespace(self.first, q).reshape(self.first, (-1, n))
        return (q @ rows.T).reshape(*q.shape[:-1], points, axes)

    def _sum(self, linear: Any, quadratic: Any) -> Any:
        """J·linear + H:quadratic, of (..., n) and (..., n, n): one matrix product over all times."""
        xp = namespace(self.first, linear)
        points, axes, n = self.first.shape
        rows = concatenated([linear, xp.reshape(quadratic, (*quadratic.shape[:-2], n * n))])
        table = xp.concatenate([self.first, xp.reshape(self.second, (points, axes, n * n))], axis=-1)
        return xp.reshape(rows @ xp.reshape(table, (points * axes, -1)).T, (*rows.shape[:-1], points, axes))


def _outer(left: Any, right: Any) -> Any:
    return left[..., :, None] * right[..., None, :]


@record
class Turns:
    """Rotation matrices R = R0 + R1 q + ½ q R2 q of sections, base axes.

    `first` is R1 (p, 3, 3, n), `second` R2 (p, 3, 3, n, n), and `rest` R0 (p, 3, 3), None where it is 1.
    """

    first: Any
    second: Any
    rest: Any = None

    def __getitem__(self, chosen: Any) -> Turns:
        """The polynomials of some of the sections."""
        return Turns(self.first[chosen], self.second[chosen], None if self.rest is None else self.rest[chosen])

    def turned(self, basis: Any) -> Turns:
        """The polynomials in coordinates p with q = basis p."""
        return Turns(self.first @ basis, basis.T @ self.second @ basis, self.rest)

    def slopes(self, q: Any) -> Any:
        """∂R/∂q at coordinates (..., n), (..., p, 3, 3, n)."""
        return self.first + namespace(self.first, q).einsum("pabij,...j->...pabi", self.second, q)

    def after(self, other: Turns) -> Turns:
        """The product R_self R_other, of sections that do not turn at rest."""
        xp = namespace(self.first, other.first)
        cross = xp.einsum("pabi,pbcj->pacij", self.first, other.first)
        return Turns(self.first + other.first, self.second + other.second + cross + xp.swapaxes(cross, -1, -2))

    def carry(self, places: Places, offset: Any) -> Places:
        """Positions of points that are fixed to the sections at `offset` (p, 3), m, from `places`, in section axes."""
        xp = namespace(self.first, places.first, offset)
        return Places(
            places.r0 + (offset if self.rest is None else xp.einsum("pab,pb->pa", self.rest, offset)),
            places.first + xp.einsum("pabi,pb->pai", self.first, offset),
            places.second + xp.einsum("pabij,pb->paij", self.second, offset),
        )


@record
class Polynomials:
    """Places and rotations of points on sections that both follow polynomials of second degree."""

    places: Places
    turns: Turns

    def __getitem__(self, chosen: Any) -> Polynomials:
        """The polynomials of some of the points."""
        return Polynomials(self.places[chosen], self.turns[chosen])

    def positions(self, q: Any) -> Any:
        """Places at coordinates (..., n), (..., p, 3) m."""
        return self.places.positions(q)

    def rotation(self, q: Any) -> Any:
        """Rotation matrices at coordinates (..., n), (..., p, 3, 3)."""
        xp, rest = namespace(self.turns.first, q), self.turns.rest
        change = xp.einsum("...pabi,...i->...pab", (self.turns.slopes(q) + self.turns.first) / 2, q)
        return (xp.eye(3) if rest is None else rest) + change

    @property
    def rotation_vectors(self) -> tuple[Any, Any]:
        """Derivatives (p, 3, n) and (p, 3, n, n) at rest of the sections' rotation vectors."""
        xp = namespace(self.turns.first)
        axes = self.turns.rest
        parts = (self.turns.first, self.turns.second)
        if axes is not None:  # [θ]× R0
            parts = tuple(xp.einsum("pab...,pcb->pac...", part, axes) for part in parts)
        first, second = (-0.5 * xp.einsum("abc,pbc...->pa...", EPSILON, part) for part in parts)
        return first, second

    def generalised_forces(self, q: Any, push: Vector, turn: Vector = NONE) -> Any:
        """Generalised forces (..., n) of forces `push` and moments `turn` on the points, by components (..., p)."""
        straight = self.places.generalised_forces(q, push)
        if all(map(absent, turn)):
            return straight
        # δR = [δθ]× R, so that ½ [M]× R : δR = M·δθ. The columns of [M]× R are M × those of R.
        xp, rotation = namespace(self.turns.first, q), self.rotation(q)
        columns = [joined(xp, cross(turn, split(rotation[..., d])), rotation.shape[:-2]) for d in range(3)]
        return straight + 0.5 * xp.einsum("...pad,...padi->...i", xp.stack(columns, axis=-1), self.turns.slopes(q))

    def jacobians(self, q: Any) -> tuple[Any, Any]:
        """∂r/∂q of the points, and the angles by which their sections turn with q, (..., p, 3, n) each."""
        xp = namespace(self.turns.first, q)
        # [θ]× = ∂R/∂q Rᵀ
        spin = xp.einsum("...padi,...pbd->...pabi", self.turns.slopes(q), self.rotation(q))
        return self.places.slopes(q), -0.5 * xp.einsum("abe,...pabi->...pei", xp.asarray(EPSILON), spin)

    def curved(self, q: Any) -> tuple[Places, Any, Turns]:
        """Places about coordinates (n,) to second order, rotations (p, 3, 3), and the derivatives of these."""
        return self.places.expand(q), self.rotation(q), Turns(self.turns.slopes(q), self.turns.second)


class Expanded:
    """A field whose points and sections follow the polynomials `places` and `turns` of second degree."""

    places: Callable[[], Places]
    turns: Callable[[], Turns]

    def __getitem__(self, at: Any) -> Places:
        """Places of some of the points."""
        return self.points(at)

    def points(self, at: Any, offset: Any = None) -> Places:
        """Places of points fixed to the sections `at`, `offset` (p, 3) m from the axis, section axes."""
        places = self.places()[at]
        return places if offset is None else self.turns()[at].carry(places, offset)

    def sections(self, at: Any) -> Polynomials:
        """Places and rotations of some sections."""
        return Polynomials(self.places()[at], self.turns()[at])


EPSILON = np.zeros((3, 3, 3))  # Levi-Civita's symbol
EPSILON[0, 1, 2] = EPSILON[1, 2, 0] = EPSILON[2, 0, 1] = 1.0
EPSILON[0, 2, 1] = EPSILON[2, 1, 0] = EPSILON[1, 0, 2] = -1.0


def exponential(first: Any, second: Any) -> Turns:
    """Turns exp[φ]× of rotation vectors φ = φ1 q + ½ q φ2 q, with `first` (p, 3, n) and `second` (p, 3, n, n)."""
    xp = namespace(first, second)
    skew, bend = -xp.einsum("abc,pci->pabi", EPSILON, first), -xp.einsum("abc,pcij->pabij", EPSILON, second)
    square = xp.einsum("pabi,pbcj->pacij", skew, skew)  # ½ [φ]×²
    return Turns(skew, bend + 0.5 * (square + xp.swapaxes(square, -1, -2)))
