"""The field of strains whose places are a polynomial: Picard's iteration of the exact ones, ended at an order.

R' = R [κ]× has the solution S R₀ with R₀ at rest and S' = S [k]×, k = R₀ (κ − κ₀), which S ← 1 + ∫ S [k]× approaches by
one order in each turn; with t₀ and d = R₀ (ε − ε₀) the places, points beside the axis and their rates are

    r = ∫ S t₀ + S₋ d,  S₋ of one order less,

and what turns, such as bodies on a section and loads that follow it, does so as in the exact field: by rotations.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.strains import StrainField, Tangents, added_rates, cross_rates, mapped_rates
from gbeam.mechanics.fields.taylor import Places, Turns
from gbeam.mechanics.fields.vectors import (
    NONE,
    UNTURNED,
    Rotation,
    Vector,
    absent,
    add,
    cross,
    dot,
    joined,
    mapped,
    plus,
    scaled,
    split,
    times,
    turned,
)

Rates = tuple[Vector, Vector, Vector]  # a vector with its first and second derivatives with respect to time
Strains = tuple[Vector, Vector]  # d and k at the nodes, or their derivatives
STILL: Strains = (NONE, NONE)


@record
class SeriesField:
    """Points (p,) of a strain field whose places end at an `order`.

    `axes` (G, 3, 3) are those of the nodes' sections at rest, None where they are the base's. `arm` (p, 3) m is the
    distance from the axis at rest, base axes, or None.
    """

    exact: StrainField
    axes: Array | None
    arm: Array | None = None
    order: int = static(default=4)

    @classmethod
    def of(cls, exact: StrainField, order: int) -> SeriesField:
        """Field of points on the axis whose places end at an order."""
        bent = np.any(exact.rest[3:])
        return cls(exact, _matrices(exact.tangents(np.zeros(exact.size)).rotation) if bent else None, None, order)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.exact.size

    def __getitem__(self, at: Any) -> SeriesField:
        """The field at some of the points."""
        return replace(self, exact=self.exact[at], arm=None if self.arm is None else self.arm[at])

    def points(self, at: Any, offset: Array | None = None) -> SeriesField:
        """The field of points fixed to the sections `at`, `offset` (p, 3) m from the axis, section axes."""
        exact, arm = self.exact.points(at, offset), None
        if offset is not None:
            at_rest = exact.tangents(np.zeros(self.size)).arm
            arm = joined(namespace(offset), at_rest, (len(exact.cumulative),))
        return replace(self, exact=exact, arm=arm)

    def sections(self, at: Any) -> SeriesField:
        """The field of some sections."""
        return self.points(at)

    def joined(self, axis: SeriesField) -> SeriesField:
        """Field of these points and, behind them, of those of `axis`, on the axis of the same beam."""
        exact, arm = self.exact.joined(axis.exact), self.arm
        if arm is not None:
            arm = namespace(arm).pad(arm, ((0, len(axis.exact.cumulative)), (0, 0)))
        return replace(self, exact=exact, arm=arm)

    # --- motion goes out

    def _at_rest(self) -> tuple[Rotation, Vector, Vector]:
        """Axes of the nodes' sections, t at the nodes and arms at the points, at rest."""
        axes: Any = UNTURNED if self.axes is None else tuple(split(self.axes[:, k]) for k in range(3))
        arm = NONE if self.arm is None else split(self.arm)
        return axes, turned(axes, (self.exact.rest[0], 0, 0)), arm

    def _strains(self, q: Array) -> Strains:
        """d and k at the nodes, of coordinates (..., n) or of their rates."""
        axes, sums = self._at_rest()[0], self.exact.sums(q)
        return turned(axes, sums[:3]), turned(axes, sums[3:])

    def _rows(self, k: Rates) -> list[tuple[Rates, ...]]:
        """Rows of S at the nodes with their rates, approximated to each of the orders 0, 1, … to the field's."""
        orders: list[Any] = [tuple((row, NONE, NONE) for row in UNTURNED)]
        for _ in range(self.order):
            orders.append(self._next(orders[-1], k, self.exact.node_cumulative))
        return orders

    @staticmethod
    def _next(rows: Any, k: Rates, onto: Array) -> tuple[Rates, ...]:
        """Rows of 1 + ∫ S [k]× with their rates, by those of S; `onto` (p, G) integrates from the root to p points."""
        turned = (mapped_rates(cross_rates(row, k), onto) for row in rows)
        return tuple((add(unit, row), rate, change) for unit, (row, rate, change) in zip(UNTURNED, turned, strict=True))

    def components(self, q: Array, qd: Array, qdd: Array) -> Rates:
        """Places, velocities and accelerations of the points relative to the base axes, by components (..., p)."""
        return self._moved(self._strains(q), self._strains(qd), self._strains(qdd))

    def _moved(self, at: Strains, rate: Strains = STILL, change: Strains = STILL) -> Rates:
        """Positions of the points with first and second rates, by strains (d, k) at the nodes and their rates."""
        (d, k), (dd, kd), (ddd, kdd) = at, rate, change
        _, t, arm = self._at_rest()
        *_, lower, rows = self._rows((k, kd, kdd))
        # Components of S t₀ + S₋ d, each with its rates, then vectors: the tangent, its rate and its change.
        turned = [tuple(dot(row, t) for row in rates) for rates in rows]
        strained = [_dot_rates(row, (d, dd, ddd)) for row in lower]
        tangents: Any = zip(*(map(plus, *pair) for pair in zip(turned, strained, strict=True)), strict=True)
        r, rd, rdd = mapped_rates(tangents, self.exact.cumulative)
        if self.arm is None:
            return r, rd, rdd
        at_points = self._next(lower, (k, kd, kdd), self.exact.cumulative)
        swung = [[dot(row, arm) for row in rates] for rates in at_points]
        return added_rates((r, rd, rdd), tuple(zip(*swung, strict=True)))

    def paths(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Places, velocities and accelerations of the points relative to the base axes, (..., p, 3) each."""
        r, rd, rdd = (self._joined(component, q) for component in self.components(q, qd, qdd))
        return r, rd, rdd

    def poses(self, q: Array, qd: Array, qdd: Array, at: slice) -> tuple[tuple[Array, Array, Array], Array]:
        """Paths of all points, and rotations of the sections `at` some of them."""
        return self.paths(q, qd, qdd), self.rotation(q, at)

    def _joined(self, vectors: Vector, q: Array) -> Array:
        """Array (..., p, 3) of vectors at the points at coordinates q."""
        shape = (*q.shape[:-1], len(self.exact.cumulative))
        return joined(namespace(self.exact.strains, self.arm, q), vectors, shape)

    def positions(self, q: Array) -> Array:
        """Places of the points at coordinates (..., n), base axes, (..., p, 3) m."""
        return self._joined(self._moved(self._strains(q))[0], q)

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotation matrices R_BS (..., p, 3, 3) of the sections `at` some points, of all unless given."""
        return self.exact.rotation(q, at)

    def turning(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Rotations (..., p, 3, 3) of the points' sections, their angular velocities and accelerations, base axes."""
        return self.exact.turning(q, qd, qdd)

    # --- forces come back

    def generalised_forces(self, q: Array, push: Vector, turn: Vector = NONE) -> Array:
        """Generalised forces (..., n) of forces `push` and moments `turn` on the points, base axes, (..., p) each.

        The series is gone through from its highest order to its lowest.
        """
        d, k = self._strains(q)
        axes, t, arm = self._at_rest()
        *lower, _ = ([row[0] for row in rows] for rows in self._rows((k, NONE, NONE)))
        force = mapped(push, self.exact.cumulative.T)
        on_strain = add(*(scaled(component, row) for component, row in zip(force, lower[-1], strict=True)))
        # Forces on the rows of an order, and what the points' own arms and d add to those of the highest but one.
        pulls, strained = ([scaled(component, rate) for component in force] for rate in (t, d))
        on_arms = [mapped(scaled(component, arm), self.exact.cumulative.T) for component in push]
        on_turn, outboard = NONE, self.exact.node_cumulative.T
        for rows in reversed(lower):
            inward = [add(mapped(pull, outboard), moment) for pull, moment in zip(pulls, on_arms, strict=True)]
            on_turn = add(on_turn, *(cross(*pair) for pair in zip(inward, rows, strict=True)))
            pulls = [add(cross(k, pull), moment) for pull, moment in zip(inward, strained, strict=True)]
            on_arms = strained = [NONE] * 3
        forces = self.exact.inward(Tangents(axes, NONE), on_strain, on_turn)
        return forces if all(map(absent, turn)) else forces + self.exact.generalised_forces(q, NONE, turn)

    # --- how it changes

    def slopes(self, q: Array) -> Array:
        """∂r/∂q of the points at coordinates (..., n), (..., p, 3, n)."""
        repeated = q[..., None, :] + 0 * q[..., None]  # once for each rate of one
        moved = self._moved(self._strains(repeated), self._strains(np.eye(self.size)))[1]
        return namespace(q).moveaxis(self._joined(moved, repeated), -3, -1)

    def jacobians(self, q: Array) -> tuple[Array, Array]:
        """∂r/∂q of the points, and the angles by which their sections turn with q, (..., p, 3, n) each."""
        return self.slopes(q), self.exact.jacobians(q)[1]

    def expand_rest(self) -> Places:
        """Places about the beam at rest, to first order."""
        rest = np.zeros(self.size)
        return Places(self.positions(rest), self.slopes(rest))

    def expand(self, q: Array) -> Places:
        """Positions of the points near coordinates (n,), to second order."""
        xp, unit = namespace(self.exact.strains, self.arm, q), np.eye(self.size)
        pairs = unit[:, None] + unit  # D²(a, b) = ½ (D²(a + b, a + b) − D²(a, a) − D²(b, b))
        bent = self._joined(self._moved(self._strains(q), self._strains(pairs))[2], pairs)
        twice = xp.einsum("iipa->ipa", bent) / 4
        second = xp.moveaxis(bent - twice[:, None] - twice, (0, 1), (2, 3)) / 2
        return Places(self.positions(q), self.slopes(q), second)

    def curved(self, q: Array) -> tuple[Places, Array, Turns]:
        """Places about coordinates (n,) to second order, the sections' rotations (p, 3, 3) and their derivatives."""
        _, rotation, turns = self.exact.curved(q)
        return self.expand(q), rotation, turns


def _matrices(rotation: Rotation) -> Array:
    """Rotation matrices (G, 3, 3) of rotations by components (G,)."""
    size = next(part.shape for row in rotation for part in row if not isinstance(part, int))
    return np.stack([joined(np, row, size) for row in rotation], axis=-2)


def _dot_rates(left: Rates, right: Rates) -> Vector:
    """Scalar product with its first and second rates."""
    (a, a1, a2), (b, b1, b2) = left, right
    return dot(a, b), plus(dot(a1, b), dot(a, b1)), plus(plus(dot(a2, b), times(2.0, dot(a1, b1))), dot(a, b2))
