"""The field of the projected displacements: TLAM, FOAM, SFOAM and CFOAM."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.basis import Families, Quadrature, closed_forms
from gbeam.mechanics.fields.rotation import Strains, about_x, at_nodes, block, rotation_matrix
from gbeam.mechanics.fields.taylor import Places, Turns, exponential

Array = Any


@record
class ProjectedField:
    """The field (x + s − ½∫(v'² + w'²), v, w) of TLAM (without the integral), FOAM, SFOAM and CFOAM, 2009 (2), (3),
    (11), 2020 (7), (12): shapes and slopes (3, points, n), nodal slopes and curvatures (2, g, n).
    """

    x: Array
    shapes: Array
    slopes: Array
    node_slopes: Array
    curvatures: Array
    node_slope_s: Array
    cumulative: Array
    foreshortening: bool = static()

    def position(self, q: Array) -> Array:
        """Positions of the points of the axis at coordinates (..., n), (..., points, 3) m."""
        xp = namespace(self.x, q)
        s, v, w = at_nodes(self.shapes, q)
        along = self.x + s
        if self.foreshortening:
            # 2009 (3): w_c = −½ ∫ v'² dx, in both planes.
            square = (at_nodes(self.node_slopes, q) ** 2).sum(axis=0)
            along = along - 0.5 * square @ self.cumulative.T
        return xp.stack([along, v, w], axis=-1)

    def components(self, q: Array) -> tuple[Array, Array, Array]:
        """None: see `cumulates`."""
        raise TypeError("the positions of this field are no plain sums of nodal vectors")

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations (..., points, 3, 3) of sections to second order: they follow the tangent, whose slopes the strain
        lessens.
        """
        xp = namespace(self.x, q)
        slope_s, slope_v, slope_w = at_nodes(self.slopes[:, at], q)
        slope_v, slope_w = (1 - slope_s) * slope_v, (1 - slope_s) * slope_w
        arc = rotation_matrix(xp.stack([xp.zeros_like(slope_v), -slope_w, slope_v], axis=-1))
        (v, w), (bend_v, bend_w) = at_nodes(self.node_slopes, q), at_nodes(self.curvatures, q)
        twist = 0.5 * (v * bend_w - w * bend_v) @ self.cumulative[at].T
        return arc @ about_x(twist)

    def strains(self, q: Array) -> Strains:
        """Strains s', −w'', v'' at the quadrature nodes: linear (2009 (10); 2020 (8), corrected)."""
        bend_v, bend_w = at_nodes(self.curvatures, q)
        return Strains(q @ self.node_slope_s.T, -bend_w, bend_v)

    def sampled(self, at: Any) -> ProjectedField:
        """The field at some of the points."""
        return replace(
            self,
            x=self.x[at],
            shapes=self.shapes[:, at],
            slopes=self.slopes[:, at],
            cumulative=self.cumulative[at],
        )

    @property
    def cumulates(self) -> bool:
        """The positions are no plain sums of nodal vectors."""
        return False

    @property
    def linear_strains(self) -> bool:
        """The strains are linear in q."""
        return True

    def strain_slopes(self) -> Strains:
        """Derivatives of the strains, (g, n) each."""
        return Strains(self.node_slope_s, -self.curvatures[1], self.curvatures[0])

    def places(self) -> Places:
        """The positions, which are a polynomial of second degree."""
        xp = namespace(self.cumulative, self.shapes)
        o = xp.zeros_like(self.x)
        _, points, n = self.shapes.shape
        second = xp.zeros((points, 3, n, n))
        if self.foreshortening:
            square = xp.einsum("cpi,cpj->pij", self.node_slopes, self.node_slopes)
            short = -xp.reshape(self.cumulative @ xp.reshape(square, (-1, n * n)), (points, n, n))
            second = xp.stack([short, 0 * short, 0 * short], axis=1)
        return Places(xp.stack([self.x, o, o], -1), xp.moveaxis(self.shapes, 0, 1), second)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations."""
        xp = namespace(self.cumulative, self.shapes)
        (v, w), (bend_v, bend_w), (s, slope_v, slope_w) = self.node_slopes, self.curvatures, self.slopes
        twist = _products(xp, v, bend_w) - _products(xp, w, bend_v)
        points, n = s.shape
        twist = 0.5 * xp.reshape(self.cumulative @ xp.reshape(twist, (-1, n * n)), (points, n, n))
        first = xp.stack([0 * s, -slope_w, slope_v], axis=1)
        lessened = [_products(xp, s, slope) for slope in (slope_w, -slope_v)]
        second = xp.stack([twist, *lessened], axis=1)
        return exponential(first, second + xp.swapaxes(second, -1, -2))


def _products(xp: Any, left: Array, right: Array) -> Array:
    """Products of two families' values at points, (p, n, n)."""
    return xp.einsum("pi,pj->pij", left, right)


def projected_field(
    length: float,
    rule: Quadrature,
    x: np.ndarray,
    counts: tuple[int, int, int],
    *,
    foreshortening: bool,
    families: Families | None = None,
) -> ProjectedField:
    """Build the field of TLAM (without foreshortening), FOAM, SFOAM and CFOAM at points (p,) m."""
    n = sum(counts)
    starts = (0, counts[0], counts[0] + counts[1])

    def at(points: np.ndarray) -> list[list[np.ndarray]]:
        shapes = [family(points) for family in families or closed_forms(length, counts)]
        return [[block(f, i, n) for f in shape] for shape, i in zip(shapes, starts, strict=True)]

    s, v, w = at(x)
    node_s, node_v, node_w = at(rule.node)
    return ProjectedField(
        x=x,
        shapes=np.stack([s[0], v[0], w[0]]),
        slopes=np.stack([s[1], v[1], w[1]]),
        node_slopes=np.stack([node_v[1], node_w[1]]),
        curvatures=np.stack([node_v[2], node_w[2]]),
        node_slope_s=node_s[1],
        cumulative=rule.cumulative(x),
        foreshortening=foreshortening,
    )
