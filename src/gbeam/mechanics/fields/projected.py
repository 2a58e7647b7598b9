"""The field of the projected displacements: TLAM, FOAM, SFOAM and CFOAM."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.basis import Families, Quadrature, closed_forms
from gbeam.mechanics.fields.rotation import Strains, about_x, block, rotation_matrix
from gbeam.mechanics.fields.taylor import Places, Turns, exponential

Array = Any


@record
class ProjectedField:
    """The field (x + s − ½∫(v'² + w'²), v, w) of TLAM (without the integral), FOAM, SFOAM and CFOAM.

    2009 (2), (3), (11); 2020 (7), (12). q are amplitudes in m of dimensionless shapes with ∫f² dx = L. Shapes and
    slopes at the points are (points, n), those at the quadrature nodes (g, n).
    """

    x: Array
    s: Array
    v: Array
    w: Array
    slope_s: Array
    slope_v: Array
    slope_w: Array
    node_slope_v: Array
    node_slope_w: Array
    cumulative: Array
    node_slope_s: Array
    curvature_v: Array
    curvature_w: Array
    foreshortening: bool = static()

    def position(self, q: Array) -> Array:
        """Positions of the points of the axis at coordinates (..., n), (..., points, 3) m."""
        xp = namespace(self.x, q)
        along = self.x + q @ self.s.T
        if self.foreshortening:
            # 2009 (3): w_c = −½ ∫ v'² dx, in both planes.
            square = (q @ self.node_slope_v.T) ** 2 + (q @ self.node_slope_w.T) ** 2
            along = along - 0.5 * square @ self.cumulative.T
        return xp.stack([along, q @ self.v.T, q @ self.w.T], axis=-1)

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3), to second order.

        The sections follow the tangent, whose slopes the axial strain lessens, in a frame free of torsion.
        """
        xp = namespace(self.x, q)
        stretch = 1 - q @ self.slope_s[at].T
        slope_v, slope_w = stretch * (q @ self.slope_v[at].T), stretch * (q @ self.slope_w[at].T)
        arc = rotation_matrix(xp.stack([xp.zeros_like(slope_v), -slope_w, slope_v], axis=-1))
        v, w = q @ self.node_slope_v.T, q @ self.node_slope_w.T
        twist = 0.5 * (v * (q @ self.curvature_w.T) - w * (q @ self.curvature_v.T)) @ self.cumulative[at].T
        return arc @ about_x(twist)

    def strains(self, q: Array) -> Strains:
        """Strains s', −w'', v'' at the quadrature nodes: linear (2009 (10); 2020 (8), corrected)."""
        return Strains(q @ self.node_slope_s.T, -q @ self.curvature_w.T, q @ self.curvature_v.T)

    def strain_slopes(self) -> Strains:
        """Derivatives of the strains, (g, n) each."""
        return Strains(self.node_slope_s, -self.curvature_w, self.curvature_v)

    def places(self) -> Places:
        """The positions, which are a polynomial of second degree."""
        xp = namespace(self.cumulative, self.s)
        o = xp.zeros_like(self.x)
        points, n = self.s.shape
        second = xp.zeros((points, 3, n, n))
        if self.foreshortening:
            square = _products(xp, self.node_slope_v, self.node_slope_v)
            square = square + _products(xp, self.node_slope_w, self.node_slope_w)
            short = -xp.reshape(self.cumulative @ xp.reshape(square, (-1, n * n)), (points, n, n))
            second = xp.stack([short, 0 * short, 0 * short], axis=1)
        return Places(xp.stack([self.x, o, o], -1), xp.stack([self.s, self.v, self.w], axis=1), second)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations."""
        xp = namespace(self.cumulative, self.s)
        twist = _products(xp, self.node_slope_v, self.curvature_w) - _products(xp, self.node_slope_w, self.curvature_v)
        points, n = self.s.shape
        twist = 0.5 * xp.reshape(self.cumulative @ xp.reshape(twist, (-1, n * n)), (points, n, n))
        first = xp.stack([0 * self.s, -self.slope_w, self.slope_v], axis=1)
        lessened = [_products(xp, self.slope_s, slope) for slope in (self.slope_w, -self.slope_v)]
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
    """Build the field of TLAM, FOAM, SFOAM and CFOAM.

    Parameters
    ----------
    length : beam length, m
    rule : quadrature along the beam
    x : (points,) positions where r is sampled, m
    counts : numbers of axial shapes, bending shapes along y, bending shapes along z
    foreshortening : whether the transverse shapes shorten the beam (not in TLAM)
    families : the shapes; clamped-free closed forms unless given
    """
    n = sum(counts)
    starts = (0, counts[0], counts[0] + counts[1])

    def at(points: np.ndarray) -> list[list[np.ndarray]]:
        shapes = [family(points) for family in families or closed_forms(length, counts)]
        return [[block(f, i, n) for f in shape] for shape, i in zip(shapes, starts, strict=True)]

    s, v, w = at(x)
    node_s, node_v, node_w = at(rule.node)
    return ProjectedField(
        x=x,
        s=s[0],
        v=v[0],
        w=w[0],
        slope_s=s[1],
        slope_v=v[1],
        slope_w=w[1],
        node_slope_v=node_v[1],
        node_slope_w=node_w[1],
        cumulative=rule.cumulative(x),
        node_slope_s=node_s[1],
        curvature_v=node_v[2],
        curvature_w=node_w[2],
        foreshortening=foreshortening,
    )
