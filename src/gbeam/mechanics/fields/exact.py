"""The geometrically exact field."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.basis import Families, Quadrature, polynomials
from gbeam.mechanics.fields.rotation import (
    Strains,
    about_x,
    at_nodes,
    block,
    exponential_of,
    one_minus_sinc,
    rotation_matrix,
    sine_cosine,
)
from gbeam.mechanics.fields.taylor import Places, Turns, exponential

Array = Any


@record
class ExactField:
    """The geometrically exact field r = ∫(1 + ε) R e₁ dσ, R = exp[φ]× Rx(α), free of torsion: ε and φ = (0, φ_y, φ_z)
    are sums of shapes, with a pole at |φ| = π out of plane; `angles` (points, n), `nodal` (3, g, n), `node_slopes` (2,
    g, n), `plane` (2,).
    """

    angle_y: Array
    angle_z: Array
    nodal: Array
    node_slopes: Array
    cumulative: Array
    node_cumulative: Array
    turning: Array
    plane: Array
    planar: bool = static()
    extensible: bool = static()

    def position(self, q: Array) -> Array:
        """Positions of the points of the axis at coordinates (..., n), (..., points, 3) m."""
        xp = namespace(self.cumulative, q)
        # Component by component: a product of large matrices, not one of small ones for every time.
        return xp.stack([part @ self.cumulative.T for part in self.components(q)], axis=-1)

    def components(self, q: Array) -> tuple[Array, Array, Array]:
        """Tangents (1 + ε) R e₁ at the quadrature nodes at coordinates (..., n), by components (..., g)."""
        if not self.planar:
            return self._tangents(*at_nodes(self.nodal, q))
        stretch = 1 + q @ self.nodal[0].T if self.extensible else 1.0
        return self._in_plane(stretch, q @ self.turning.T)

    def tangents(self, strain: Array, y: Array, z: Array) -> Array:
        """Tangents (..., 3) at strains and angles (...)."""
        return namespace(self.cumulative, strain).stack(self._tangents(strain, y, z), axis=-1)

    def _in_plane(self, stretch: Array, angle: Array) -> tuple[Array, Array, Array]:
        sine, cosine = sine_cosine(angle)
        across = stretch * sine
        return stretch * cosine, self.plane[0] * across, -self.plane[1] * across

    def _tangents(self, strain: Array, y: Array, z: Array) -> tuple[Array, Array, Array]:
        stretch = 1 + strain
        if self.planar:  # one of the angles is zero, and one sine is enough
            return self._in_plane(stretch, y + z)
        sinc, _, cosine = exponential_of(y**2 + z**2)
        return stretch * cosine, stretch * sinc * z, -stretch * sinc * y

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        xp = namespace(self.cumulative, q)
        y, z = q @ self.angle_y[at].T, q @ self.angle_z[at].T
        arc = rotation_matrix(xp.stack([0 * y, y, z], axis=-1))
        return arc if self.planar else arc @ about_x(self._twist_rate(q) @ self.cumulative[at].T)

    def strains(self, q: Array) -> Strains:
        """Axial strain and curvatures at the quadrature nodes, in the torsion-free frame."""
        xp = namespace(self.cumulative, q)
        (strain, y, z), (slope_y, slope_z) = at_nodes(self.nodal, q), at_nodes(self.node_slopes, q)
        if self.planar:
            return Strains(strain, slope_y, slope_z)
        bend_y, bend_z, rate = self.bending(y, z, slope_y, slope_z)
        twist = rate @ self.node_cumulative.T
        c, s = xp.cos(twist), xp.sin(twist)
        return Strains(strain, c * bend_y + s * bend_z, c * bend_z - s * bend_y)

    def bending(self, y: Array, z: Array, slope_y: Array, slope_z: Array) -> tuple[Array, Array, Array]:
        """Curvatures about y and z of exp[φ]×, and −κ_x, the rate α' of the twist, at angles and their slopes (...)."""
        sinc, versine, _ = exponential_of(y**2 + z**2)
        # Curvature of exp[φ]×: sinc φ' + (1 − sinc)/φ² (φ·φ') φ − versine φ × φ', the last along x.
        along = one_minus_sinc(y**2 + z**2) * (y * slope_y + z * slope_z)
        return sinc * slope_y + along * y, sinc * slope_z + along * z, versine * (y * slope_z - z * slope_y)

    def sampled(self, at: Any) -> ExactField:
        """The field at some of the points."""
        return replace(self, angle_y=self.angle_y[at], angle_z=self.angle_z[at], cumulative=self.cumulative[at])

    @property
    def cumulates(self) -> bool:
        """The positions are sums of nodal vectors, ``cumulative @ components(q)``."""
        return True

    @property
    def linear_strains(self) -> bool:
        """Whether the strains are linear in q."""
        return self.planar

    def strain_slopes(self) -> Strains:
        """Derivatives of the strains at the straight beam, (g, n) each."""
        return Strains(self.nodal[0], *self.node_slopes)

    def places(self) -> Places:
        """Taylor polynomial of the positions: (1 + ε) (1 − ½ φ², φ_z, −φ_y), integrated."""
        xp = namespace(self.cumulative, self.nodal)
        strain, y, z = self.nodal
        first = xp.stack([strain, z, -y], axis=1)
        square = -0.5 * (xp.einsum("pi,pj->pij", y, y) + xp.einsum("pi,pj->pij", z, z))
        second = xp.stack([square, xp.einsum("pi,pj->pij", strain, z), -xp.einsum("pi,pj->pij", strain, y)], axis=1)
        o = xp.zeros(self.cumulative.shape[0])
        r0 = xp.stack([xp.sum(self.cumulative, axis=1), o, o], -1)
        second = xp.einsum("pg,gaij->paij", self.cumulative, second + xp.swapaxes(second, -1, -2))
        return Places(r0, xp.einsum("pg,gai->pai", self.cumulative, first), second)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations."""
        xp = namespace(self.cumulative, self.nodal)
        first = xp.stack([0 * self.angle_y, self.angle_y, self.angle_z], axis=1)
        points, n = self.angle_y.shape
        second = xp.zeros((points, 3, n, n))
        if not self.planar:
            (_, y, z), (slope_y, slope_z) = self.nodal, self.node_slopes
            rate = 0.5 * (xp.einsum("pi,pj->pij", y, slope_z) - xp.einsum("pi,pj->pij", z, slope_y))
            twist = xp.einsum("pg,gij->pij", self.cumulative, rate + xp.swapaxes(rate, -1, -2))
            second = xp.stack([twist, 0 * twist, 0 * twist], axis=1)
        return exponential(first, second)

    def _twist_rate(self, q: Array) -> Array:
        """α' = −κ_x of exp[φ]× at the nodes."""
        (_, y, z), (slope_y, slope_z) = at_nodes(self.nodal, q), at_nodes(self.node_slopes, q)
        return self.bending(y, z, slope_y, slope_z)[2]


def exact_field(
    length: float,
    rule: Quadrature,
    x: np.ndarray,
    counts: tuple[int, int, int],
    families: Families | None = None,
) -> ExactField:
    """Build the geometrically exact field at points (p,) m, the quadrature nodes first; axial slopes are strains,
    bending slopes rotations.
    """
    strain, along_y, along_z = counts
    n, nodes = sum(counts), len(rule.node)
    if not np.array_equal(x[:nodes], rule.node):
        raise ValueError("the points of an exact field start with the quadrature nodes")
    s, v, w = families or polynomials(length, counts)
    shapes_v, shapes_w = v(x), w(x)
    # Bending towards +z turns about −y.
    about_y = [-block(f, strain + along_y, n) for f in (shapes_w.slope, shapes_w.curvature)]
    about_z = [block(f, strain, n) for f in (shapes_v.slope, shapes_v.curvature)]
    cumulative = rule.cumulative(x)
    nodal = np.stack([block(s(rule.node).slope, 0, n), about_y[0][:nodes], about_z[0][:nodes]])
    return ExactField(
        angle_y=about_y[0],
        angle_z=about_z[0],
        nodal=nodal,
        node_slopes=np.stack([about_y[1][:nodes], about_z[1][:nodes]]),
        cumulative=cumulative,
        node_cumulative=cumulative[:nodes],
        turning=nodal[1] + nodal[2],
        plane=np.array([along_z == 0, along_z > 0], dtype=float),
        planar=along_y == 0 or along_z == 0,
        extensible=strain > 0,
    )
