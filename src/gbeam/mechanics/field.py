"""Displacement fields r(x; q): where the points of the beam are, in axes that move with its root.

A field answers three things: positions along its axis, the rotation of its sections, and the strains that store energy
(axial strain, curvatures). The base axes are B: x along the beam,
z through the thickness. Coordinates are ordered axial, bending along y, bending along z, springs of the root.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.mechanics.basis import Families, Quadrature, closed_forms, polynomials

Points = Float[Array, "points 3"]
Rotations = Float[Array, "points 3 3"]
Coordinates = Float[Array, " n"]


class Strains(NamedTuple):
    """What stores energy: axial strain, curvature about y and about z, 1/m, at the quadrature nodes, (g,) each.

    `root` is the stretch of the root's springs, m or rad, (springs,); empty for a clamped root.
    """

    axial: Array
    about_y: Array
    about_z: Array
    root: Array | np.ndarray = np.zeros(0)


class Field(Protocol):
    """A displacement field sampled at the points it was built for."""

    def position(self, q: Coordinates) -> Points:
        """Positions r of the points of the axis, base axes, m."""
        ...

    def rotation(self, q: Coordinates) -> Rotations:
        """Rotation matrices R_BS of the sections at the points."""
        ...

    def strains(self, q: Coordinates) -> Strains:
        """Strains that store energy, at the quadrature nodes."""
        ...


def rotation_matrix(angle: Points) -> Rotations:
    """Rotation matrices of rotation vectors, smooth through zero."""
    sinc, versine, _ = _exponential(jnp.sum(angle**2, axis=-1))
    x, y, z = angle[..., 0], angle[..., 1], angle[..., 2]
    o = jnp.zeros_like(x)
    skew = jnp.stack([jnp.stack([o, -z, y], -1), jnp.stack([z, o, -x], -1), jnp.stack([-y, x, o], -1)], -2)
    return jnp.eye(3) + sinc[..., None, None] * skew + versine[..., None, None] * (skew @ skew)


class ProjectedField(eqx.Module):
    """The field (x + s − ½∫(v'² + w'²), v, w) of TLAM (without the integral), FOAM, SFOAM and CFOAM.

    2009 (2), (3), (11); 2020 (7), (12). q are amplitudes in m of dimensionless shapes with ∫f² dx = L.
    """

    x: Float[Array, " points"]
    s: Float[Array, "points n"]
    v: Float[Array, "points n"]
    w: Float[Array, "points n"]
    slope_s: Float[Array, "points n"]
    slope_v: Float[Array, "points n"]
    slope_w: Float[Array, "points n"]
    node_slope_v: Float[Array, "g n"]
    node_slope_w: Float[Array, "g n"]
    cumulative: Float[Array, "points g"]
    node_slope_s: Float[Array, "g n"]
    curvature_v: Float[Array, "g n"]
    curvature_w: Float[Array, "g n"]
    foreshortening: bool = eqx.field(static=True)

    def position(self, q: Coordinates) -> Points:
        """Positions of the points of the axis, (points, 3) m."""
        along = self.x + self.s @ q
        if self.foreshortening:
            # 2009 (3): w_c = −½ ∫ v'² dx, in both planes.
            along = along - 0.5 * self.cumulative @ ((self.node_slope_v @ q) ** 2 + (self.node_slope_w @ q) ** 2)
        return jnp.stack([along, self.v @ q, self.w @ q], axis=-1)

    def rotation(self, q: Coordinates) -> Rotations:
        """Rotations of the sections, (points, 3, 3), right to the second order that T needs.

        The sections follow the tangent, whose slopes the axial strain lessens, in a frame free of torsion.
        """
        stretch = 1 - self.slope_s @ q
        slope_v, slope_w = stretch * (self.slope_v @ q), stretch * (self.slope_w @ q)
        arc = rotation_matrix(jnp.stack([jnp.zeros_like(slope_v), -slope_w, slope_v], axis=-1))
        v, w = self.node_slope_v @ q, self.node_slope_w @ q
        twist = 0.5 * self.cumulative @ (v * (self.curvature_w @ q) - w * (self.curvature_v @ q))
        return arc @ _about_x(twist)

    def strains(self, q: Coordinates) -> Strains:
        """Strains s', −w'', v'' at the quadrature nodes: linear (2009 (10); 2020 (8), corrected)."""
        return Strains(self.node_slope_s @ q, -self.curvature_w @ q, self.curvature_v @ q)


class ExactField(eqx.Module):
    """The geometrically exact field r = ∫(1 + ε) R e₁ dσ, any rotation: R = exp[φ]× Rx(α).

    ε and the rotation vector φ = (0, φ_y, φ_z) are sums of shapes. The twist α keeps the frame free of torsion
    (κ_x = 0): the beam is stiff in torsion, which is out of scope. In one plane φ is the angle itself and has no limit;
    out of plane the rotation vector has its pole where the tangent points straight back, |φ| = π.
    """

    angle_y: Float[Array, "points n"]
    angle_z: Float[Array, "points n"]
    node_angle_y: Float[Array, "g n"]
    node_angle_z: Float[Array, "g n"]
    node_strain: Float[Array, "g n"]
    node_slope_y: Float[Array, "g n"]
    node_slope_z: Float[Array, "g n"]
    cumulative: Float[Array, "points g"]
    planar: bool = eqx.field(static=True)

    def position(self, q: Coordinates) -> Points:
        """Positions of the points of the axis, (points, 3) m."""
        y, z = self.node_angle_y @ q, self.node_angle_z @ q
        sinc, _, cosine = _exponential(y**2 + z**2)
        tangent = jnp.stack([cosine, sinc * z, -sinc * y], axis=-1)
        return self.cumulative @ ((1 + self.node_strain @ q)[:, None] * tangent)

    def rotation(self, q: Coordinates) -> Rotations:
        """Rotations of the sections, (points, 3, 3)."""
        y, z = self.angle_y @ q, self.angle_z @ q
        arc = rotation_matrix(jnp.stack([0 * y, y, z], axis=-1))
        return arc if self.planar else arc @ _about_x(self.cumulative @ self._twist_rate(q))

    def strains(self, q: Coordinates) -> Strains:
        """Axial strain and curvatures at the quadrature nodes, in the torsion-free frame."""
        slope_y, slope_z = self.node_slope_y @ q, self.node_slope_z @ q
        if self.planar:
            return Strains(self.node_strain @ q, slope_y, slope_z)
        y, z = self.node_angle_y @ q, self.node_angle_z @ q
        sinc, _, _ = _exponential(y**2 + z**2)
        # Curvature of exp[φ]×: sinc φ' + (1 − sinc)/φ² (φ·φ') φ − versine φ × φ', the last along x.
        along = _one_minus_sinc(y**2 + z**2) * (y * slope_y + z * slope_z)
        bend_y, bend_z = sinc * slope_y + along * y, sinc * slope_z + along * z
        nodes = self.node_strain.shape[0]
        twist = self.cumulative[:nodes] @ self._twist_rate(q)
        c, s = jnp.cos(twist), jnp.sin(twist)
        return Strains(self.node_strain @ q, c * bend_y + s * bend_z, c * bend_z - s * bend_y)

    def _twist_rate(self, q: Coordinates) -> Array:
        """α' = −κ_x of exp[φ]× at the nodes."""
        y, z = self.node_angle_y @ q, self.node_angle_z @ q
        _, versine, _ = _exponential(y**2 + z**2)
        return versine * (y * (self.node_slope_z @ q) - z * (self.node_slope_y @ q))


class RootedField(eqx.Module):
    """Another field on a root that springs hold: moved by p and turned by R(φ) as a whole.

    Its last coordinates are the stretches of the springs: components of p, m, and of the rotation vector φ, rad.

    Parameters
    ----------
    inner : Field
    x : (points,) positions of the points along the beam, m
    move, turn : (3, springs) directions of p and φ
    linear : bool
        Whether the points move linearly with φ, as TLAM's do.
    """

    inner: Field
    x: Float[Array, " points"]
    move: Float[Array, "3 springs"]
    turn: Float[Array, "3 springs"]
    linear: bool = eqx.field(static=True)

    def _split(self, q: Coordinates) -> tuple[Coordinates, Coordinates]:
        springs = self.move.shape[1]
        return q[:-springs], q[-springs:]

    def position(self, q: Coordinates) -> Points:
        """Positions of the points of the axis, (points, 3) m."""
        beam, root = self._split(q)
        r, turned = self.inner.position(beam), self.turn @ root
        if self.linear:
            straight = jnp.stack([self.x, 0 * self.x, 0 * self.x], axis=-1)
            return r + self.move @ root + jnp.cross(turned, straight)
        return r @ rotation_matrix(turned).T + self.move @ root

    def rotation(self, q: Coordinates) -> Rotations:
        """Rotations of the sections, (points, 3, 3)."""
        beam, root = self._split(q)
        return rotation_matrix(self.turn @ root) @ self.inner.rotation(beam)

    def strains(self, q: Coordinates) -> Strains:
        """Strains of the beam, and the springs' stretches."""
        beam, root = self._split(q)
        return self.inner.strains(beam)._replace(root=root)


def _exponential(square: Array) -> tuple[Array, Array, Array]:
    """sin φ/φ, (1 − cos φ)/φ² and cos φ of φ², smooth through zero."""
    small = square < 1e-4
    theta = jnp.sqrt(jnp.where(small, 1.0, square))
    sinc = jnp.where(small, 1 - square / 6 * (1 - square / 20 * (1 - square / 42)), jnp.sin(theta) / theta)
    versine = jnp.where(
        small, 0.5 - square / 24 * (1 - square / 30 * (1 - square / 56)), (1 - jnp.cos(theta)) / theta**2
    )
    return sinc, versine, 1 - square * versine


def _one_minus_sinc(square: Array) -> Array:
    """(1 − sin φ/φ)/φ² of φ², smooth through zero."""
    small = square < 1e-2
    theta = jnp.sqrt(jnp.where(small, 1.0, square))
    series = (1 - square / 20 * (1 - square / 42 * (1 - square / 72 * (1 - square / 110)))) / 6
    return jnp.where(small, series, (1 - jnp.sin(theta) / theta) / theta**2)


def _about_x(angle: Array) -> Rotations:
    """Rotation matrices about x."""
    c, s, o = jnp.cos(angle), jnp.sin(angle), jnp.zeros_like(angle)
    return jnp.stack([jnp.stack([o + 1, o, o], -1), jnp.stack([o, c, -s], -1), jnp.stack([o, s, c], -1)], -2)


def _block(shapes: np.ndarray, start: int, total: int) -> np.ndarray:
    """Place (points, k) shape values in columns start … start + k of (points, total)."""
    out = np.zeros((shapes.shape[0], total))
    out[:, start : start + shapes.shape[1]] = shapes
    return out


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
    x : (points,) positions where r is wanted, m
    counts : numbers of axial shapes, bending shapes along y, bending shapes along z
    foreshortening : whether the transverse shapes shorten the beam (not in TLAM)
    families : the shapes; clamped-free closed forms unless given
    """
    n = sum(counts)
    starts = (0, counts[0], counts[0] + counts[1])

    def at(points: np.ndarray) -> list[list[np.ndarray]]:
        shapes = [family(points) for family in families or closed_forms(length, counts)]
        return [[_block(f, i, n) for f in shape] for shape, i in zip(shapes, starts, strict=True)]

    s, v, w = at(x)
    node_s, node_v, node_w = at(rule.node)
    arrays = (
        x,
        s[0],
        v[0],
        w[0],
        s[1],
        v[1],
        w[1],
        node_v[1],
        node_w[1],
        rule.cumulative(x),
        node_s[1],
        node_v[2],
        node_w[2],
    )
    return ProjectedField(*map(jnp.array, arrays), foreshortening)  # type: ignore[call-arg, arg-type]


def exact_field(
    length: float,
    rule: Quadrature,
    x: np.ndarray,
    counts: tuple[int, int, int],
    families: Families | None = None,
) -> ExactField:
    """Build the geometrically exact field: axial slopes are its strains, bending slopes its rotations.

    Parameters
    ----------
    length, rule : as :func:`projected_field`
    x : (points,) positions where r is wanted, m; they start with the quadrature nodes
    counts : numbers of strain shapes, and of rotation shapes for bending along y and along z
    families : the shapes; polynomials unless given
    """
    strain, along_y, along_z = counts
    n, nodes = sum(counts), len(rule.node)
    if not np.array_equal(x[:nodes], rule.node):
        raise ValueError("the points of an exact field start with the quadrature nodes")
    s, v, w = families or polynomials(length, counts)
    shapes_v, shapes_w = v(x), w(x)
    # Bending towards +z turns about −y.
    about_y = [-_block(f, strain + along_y, n) for f in (shapes_w.slope, shapes_w.curvature)]
    about_z = [_block(f, strain, n) for f in (shapes_v.slope, shapes_v.curvature)]
    arrays = (
        about_y[0],
        about_z[0],
        about_y[0][:nodes],
        about_z[0][:nodes],
        _block(s(rule.node).slope, 0, n),
        about_y[1][:nodes],
        about_z[1][:nodes],
        rule.cumulative(x),
    )
    planar = along_y == 0 or along_z == 0
    return ExactField(*map(jnp.array, arrays), planar)  # type: ignore[call-arg, arg-type]
