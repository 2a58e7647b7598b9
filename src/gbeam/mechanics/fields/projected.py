"""The field of the projected displacements, clamped or on a root that springs hold: TLAM, FOAM, SFOAM and CFOAM."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.basis import Families, Quadrature
from gbeam.mechanics.fields.held import HeldField
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import ExpandedField, StrainField
from gbeam.mechanics.fields.taylor import EPSILON, Expanded, Places, Turns, exponential
from gbeam.mechanics.fields.vectors import rotation_matrix


@record
class ProjectedField(Expanded):
    """The field (x + s − ½∫(v'² + w'²), v, w) of TLAM (without the integral), FOAM, SFOAM and CFOAM, 2009 (2), (3),
    (11), 2020 (7), (12): shapes and slopes of s, v and w (3, points, n), nodal slopes and curvatures of v and w (2, g,
    n).
    """

    x: Array
    shapes: Array
    slopes: Array
    node_slopes: Array
    curvatures: Array
    cumulative: Array
    foreshortening: bool = static()

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations (..., points, 3, 3) to second order: along the tangent, which the stretch flattens, and twist.

        The twist is what a section turns about the tangent when it bends along y and z: ½ ∫ (v' w'' − w' v'') dx.
        """
        xp = namespace(self.x, q)
        slope_s, slope_v, slope_w = at_nodes(self.slopes[:, at], q)
        slope_v, slope_w = (1 - slope_s) * slope_v, (1 - slope_s) * slope_w
        arc = rotation_matrix(xp.stack([xp.zeros_like(slope_v), -slope_w, slope_v], axis=-1))
        (v, w), (bend_v, bend_w) = at_nodes(self.node_slopes, q), at_nodes(self.curvatures, q)
        twist = 0.5 * (v * bend_w - w * bend_v) @ self.cumulative[at].T
        return arc @ about_x(twist)

    def places(self) -> Places:
        """Positions as polynomials of second degree: bending shortens the beam along x by ½ ∫ (v'² + w'²) dx."""
        xp = namespace(self.cumulative, self.shapes)
        zeros = xp.zeros_like(self.x)
        _, points, n = self.shapes.shape
        second = xp.zeros((points, 3, n, n))
        if self.foreshortening:
            square = xp.einsum("cpi,cpj->pij", self.node_slopes, self.node_slopes)
            short = -xp.reshape(self.cumulative @ xp.reshape(square, (-1, n * n)), (points, n, n))
            second = xp.stack([short, 0 * short, 0 * short], axis=1)
        return Places(xp.stack([self.x, zeros, zeros], -1), xp.moveaxis(self.shapes, 0, 1), second)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations, as :meth:`rotation` has them."""
        xp = namespace(self.cumulative, self.shapes)
        (v, w), (bend_v, bend_w), (s, slope_v, slope_w) = self.node_slopes, self.curvatures, self.slopes
        twist = _products(xp, v, bend_w) - _products(xp, w, bend_v)
        points, n = s.shape
        twist = 0.5 * xp.reshape(self.cumulative @ xp.reshape(twist, (-1, n * n)), (points, n, n))
        first = xp.stack([0 * s, -slope_w, slope_v], axis=1)
        reduced_slopes = [_products(xp, s, slope) for slope in (slope_w, -slope_v)]
        second = xp.stack([twist, *reduced_slopes], axis=1)
        return exponential(first, second + xp.swapaxes(second, -1, -2))


def _products(xp: Any, left: Array, right: Array) -> Array:
    """Products of two families' values at points, (p, n, n)."""
    return xp.einsum("pi,pj->pij", left, right)


def projected_field(
    rule: Quadrature, x: np.ndarray, counts: tuple[int, ...], families: Families, *, foreshortening: bool
) -> ProjectedField:
    """Build the field of TLAM (without foreshortening), FOAM, SFOAM and CFOAM at points x (p,), m."""
    n = sum(counts)
    starts = (0, counts[0], counts[0] + counts[1])

    def in_all_coordinates(points: np.ndarray) -> list[list[np.ndarray]]:
        shapes = [family(points) for family in families[:3]]
        return [[block(f, i, n) for f in shape] for shape, i in zip(shapes, starts, strict=True)]

    s, v, w = in_all_coordinates(x)
    _, node_v, node_w = in_all_coordinates(rule.node)
    return ProjectedField(
        x=x,
        shapes=np.stack([s[0], v[0], w[0]]),
        slopes=np.stack([s[1], v[1], w[1]]),
        node_slopes=np.stack([node_v[1], node_w[1]]),
        curvatures=np.stack([node_v[2], node_w[2]]),
        cumulative=rule.cumulative(x),
        foreshortening=foreshortening,
    )


def block(shapes: np.ndarray, start: int, total: int) -> np.ndarray:
    """Place (points, k) shape values in columns start … start + k of (points, total)."""
    padded = np.zeros((shapes.shape[0], total))
    padded[:, start : start + shapes.shape[1]] = shapes
    return padded


def at_nodes(stacked: Array, q: Array) -> Array:
    """Values (m, ..., g) of m families of shapes, stacked (m, g, n), at coordinates (..., n): one matrix product."""
    xp = namespace(stacked, q)
    families, nodes, n = stacked.shape
    values = q @ xp.reshape(stacked, (families * nodes, n)).T
    return xp.moveaxis(xp.reshape(values, (*q.shape[:-1], families, nodes)), -2, 0)


def about_x(angle: Array) -> Array:
    """Rotation matrices (..., 3, 3) about x."""
    xp = namespace(angle)
    c, s, o = xp.cos(angle), xp.sin(angle), xp.zeros_like(angle)
    return xp.stack([xp.stack([o + 1, o, o], -1), xp.stack([o, c, -s], -1), xp.stack([o, s, c], -1)], -2)


@record
class RootedField(Expanded):
    """A field on a root that springs hold, moved by p and turned by R(φ): the last coordinates, m and rad."""

    inner: ProjectedField
    x: Array
    move: Array
    turn: Array
    linear: bool = static()

    def _split(self, q: Array) -> tuple[Array, Array]:
        """Coordinates of the beam's shapes, and of the root's springs."""
        springs = self.move.shape[1]
        return q[..., :-springs], q[..., -springs:]

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        beam, root = self._split(q)
        return rotation_matrix(root @ self.turn.T)[..., None, :, :] @ self.inner.rotation(beam, at)

    def places(self) -> Places:
        """Taylor polynomial of the positions: the inner field's, moved and turned with the root."""
        xp = namespace(self.x, self.inner.x)
        inner, springs = self.inner.places(), self.move.shape[1]
        n = inner.first.shape[-1]
        # p + φ × r, and to second order φ × (J q) and ½ φ × (φ × r).
        turned_rest = xp.einsum("acb,ci,pb->pai", EPSILON, self.turn, inner.r0)
        first = xp.concat([inner.first, turned_rest + self.move], axis=-1)
        second = xp.pad(inner.second, ((0, 0), (0, 0), (0, springs), (0, springs)))
        if not self.linear:
            turned_shapes = xp.einsum("acb,ci,pbj->paij", EPSILON, self.turn, inner.first)
            turned_twice = 0.5 * xp.einsum("acb,ci,pbj->paij", EPSILON, self.turn, turned_rest)
            half = xp.pad(xp.concat([turned_shapes, turned_twice], axis=-1), ((0, 0), (0, 0), (n, 0), (0, 0)))
            second = second + half + xp.swapaxes(half, -1, -2)
        return Places(inner.r0, first, second)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations: the root's after the inner field's."""
        xp = namespace(self.x, self.inner.x)
        inner, springs = self.inner.turns(), self.move.shape[1]
        points, _, _, n = inner.first.shape
        first = xp.pad(xp.broadcast_to(self.turn, (points, 3, springs)), ((0, 0), (0, 0), (n, 0)))
        root = exponential(first, xp.zeros((points, 3, n + springs, n + springs)))
        padded = Turns(
            xp.pad(inner.first, ((0, 0),) * 3 + ((0, springs),)),
            xp.pad(inner.second, ((0, 0),) * 3 + ((0, springs),) * 2),
        )
        return root.after(padded)


@record
class ReducedField(Expanded):
    """A field in fewer coordinates p, q = basis p, such as those that supports leave of an `inner` one's."""

    inner: Any  # one of those above
    basis: Array

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        return self.inner.rotation(q @ self.basis.T, at)

    def places(self) -> Places:
        """Taylor polynomial of the positions."""
        return self.inner.places().turned(self.basis)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations."""
        return self.inner.turns().turned(self.basis)


Field = StrainField | SeriesField | HeldField | ExpandedField | ProjectedField | RootedField | ReducedField
