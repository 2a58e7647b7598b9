"""The geometrically exact field of a beam that stretches, shears, twists and bends: shapes are strains.

r' = R (e₁ + ε) and R' = R [κ]×, with ε = (stretch, shears along y and z) and κ = (twist, curvatures about y and z),
sums of shapes given by their values at the quadrature nodes; a strain without shapes is rigid. A shape turns all that
is outboard of it, so that with C, the weights that integrate from the root to a node,

    ω = C R κ̇,  α = C (R κ̈ + ω × R κ̇),  t = R (e₁ + ε),  ṫ = ω × t + R ε̇,  ẗ = α × t + ω × (ω × t) + 2 ω × R ε̇ + R ε̈,

and motions of the points are integrals of t, ṫ and ẗ: nothing is differentiated, there is no limit to the rotation, and
the strain energy is quadratic. Motion goes out, forces come back: F and M on the nodes do work on ε and κ by Rᵀ F and
Rᵀ (M + Cᵀ (t × F)). A root on springs is one node that moves, and nodes that turn, before those of the beam.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.basis import Families, Quadrature
from gbeam.mechanics.fields.frames import Frames, beyond, frames_along, root_rule
from gbeam.mechanics.fields.taylor import EPSILON, Expanded, Places, Turns
from gbeam.mechanics.fields.vectors import (
    NONE,
    UNTURNED,
    Rotation,
    Vector,
    absent,
    add,
    cross,
    joined,
    mapped,
    plus,
    scaled,
    split,
    turned,
    turned_back,
)
from gbeam.structure.line import Line


class Tangents(NamedTuple):
    """Motion of the sections at the nodes: rotations, tangents t with rates `td` and `tdd`, Rκ̇ (`turn`) and its rate,
    angular velocities and accelerations. Of the points: arms from the axis, base axes, and `at_points` rotations of
    their sections where these were wanted. All rates contain ω and α of the `base`.
    """

    rotation: Rotation
    t: Vector
    arm: Vector = NONE
    td: Vector = NONE
    tdd: Vector = NONE
    turn: Vector = NONE
    turnd: Vector = NONE
    w: Vector = NONE
    alpha: Vector = NONE
    at_points: Rotation = UNTURNED
    base: tuple[Vector, Vector] = (NONE, NONE)


class Columns(NamedTuple):
    """Derivatives by the coordinates, (..., n, points), each with its first and second derivatives with respect to
    time: of t or of points' places, of the angles by which sections turn, and Rκ of the shapes at the nodes.
    """

    place: tuple[Vector, Vector, Vector]
    angle: tuple[Vector, Vector, Vector]
    turn: tuple[Vector, Vector, Vector]


@record
class StrainField:
    """Points (p,) of a beam by strains (6, G, n) at the nodes, and their values `rest` (6, G) at rest.

    `offset` (p, 3) m is the distance from the axis, section axes, or None. `shaped` tells which strains have shapes,
    `present` which there are at all.
    """

    cumulative: Array
    node_cumulative: Array
    strains: Array
    rest: Array
    frames: Frames
    offset: Array | None = None
    shaped: tuple[bool, ...] = static(default=(True,) * 6)
    present: tuple[bool, ...] = static(default=(True,) * 6)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.strains.shape[-1])

    def __getitem__(self, at: Any) -> StrainField:
        """The field at some of the points."""
        frames = replace(self.frames, points=self.frames.points[at], angles=self.frames.angles[at])
        offset = None if self.offset is None else self.offset[at]
        return replace(self, cumulative=self.cumulative[at], frames=frames, offset=offset)

    def turned(self, basis: Array) -> StrainField:
        """The field in coordinates p with q = basis p."""
        return replace(self, strains=self.strains @ basis)

    def points(self, at: Any, offset: Array | None = None) -> StrainField:
        """The field of points fixed to the sections `at`, `offset` (p, 3) m from the axis, section axes."""
        return replace(self[at], offset=offset)

    def sections(self, at: Any) -> StrainField:
        """The field of some sections."""
        return self.points(at)

    def joined(self, axis: StrainField) -> StrainField:
        """Field of these points followed by the points of `axis`, a field of the same beam's axis."""
        xp, offset, count = namespace(self.cumulative, self.offset), self.offset, len(axis.cumulative)
        cumulative = xp.concatenate([self.cumulative, axis.cumulative])
        points = xp.concatenate([self.frames.points, axis.frames.points])
        angles = xp.concatenate([self.frames.angles, axis.frames.angles])
        if offset is not None:
            offset = xp.pad(offset, ((0, count), (0, 0)))
        return replace(
            self, cumulative=cumulative, frames=replace(self.frames, points=points, angles=angles), offset=offset
        )

    def expand_rest(self) -> Places:
        """Places about the beam at rest, to first order."""
        rest = np.zeros(self.size)
        return Places(self.positions(rest), self.slopes(rest))

    # --- motion goes out

    def strain(self, q: Array) -> tuple[Any, ...]:
        """Stretch and shears, twist and curvatures at the nodes at coordinates (..., n), each (..., G)."""
        parts = []
        for part, rest, shaped, present in zip(self.sums(q), self.rest, self.shaped, self.present, strict=True):
            parts.append(0 if not present else (part + rest if shaped else rest + 0 * q[..., :1]))
        return tuple(parts)

    def sums(self, q: Array) -> tuple[Any, ...]:
        """Strains without those at rest at the nodes, six of (..., G), by coordinates (..., n); 0 of a rigid strain."""
        chosen = [k for k in range(6) if self.shaped[k]]
        xp, nodes = namespace(self.strains, self.offset, q), self.strains.shape[1]
        rows = xp.reshape(self.strains[np.array(chosen, dtype=int)], (-1, self.size))
        values = xp.reshape(q @ rows.T, (*q.shape[:-1], len(chosen), nodes))
        return tuple(values[..., chosen.index(k), :] if k in chosen else 0 for k in range(6))

    def tangents(self, q: Array, *, points: bool = False) -> Tangents:
        """Rotations and t at the nodes at coordinates (..., n), arms of points off the axis, rotations at `points`."""
        strain = self.strain(q)
        rotation, at_points = self.frames.at(strain[3:], points=points or self.offset is not None)
        arm = NONE if self.offset is None else turned(at_points, split(self.offset))
        return Tangents(rotation, turned(rotation, strain[:3]), arm, at_points=at_points)

    def moving(
        self,
        q: Array,
        qd: Array,
        qdd: Array,
        base: tuple[Vector, Vector] = (NONE, NONE),
        *,
        points: bool = False,
        at_rest: Tangents | None = None,
    ) -> Tangents:
        """Motion of tangents and sections at coordinates and rates (..., n), on a base with angular rate ω and
        acceleration α.

        Rotations at the points are returned if `points`. The tangents `at_rest` are computed unless they are given.
        """
        at_rest = self.tangents(q, points=points) if at_rest is None else at_rest
        rotation, t = at_rest.rotation, at_rest.t
        rate, change = (tuple(self.sums(x)) for x in (qd, qdd))
        stretching, turn = turned(rotation, rate[:3]), turned(rotation, rate[3:])
        # ω and α are sums of the nodes' turning up to a section: ω' = R κ̇, α' = R κ̈ + ω × R κ̇.
        w = add(base[0], mapped(turn, self.node_cumulative))
        turnd = add(turned(rotation, change[3:]), cross(w, turn))
        alpha = add(base[1], mapped(turnd, self.node_cumulative))
        td = add(cross(w, t), stretching)
        tdd = add(cross(alpha, t), cross(w, add(td, stretching)), turned(rotation, change[:3]))
        return Tangents(rotation, t, at_rest.arm, td, tdd, turn, turnd, w, alpha, at_rest.at_points, base)

    def components(self, q: Array, qd: Array, qdd: Array) -> tuple[Vector, Vector, Vector]:
        """Places, velocities and accelerations of the points relative to the base axes, by components (..., p)."""
        return self.carried(self.moving(q, qd, qdd))

    def carried(self, tangents: Tangents) -> tuple[Vector, Vector, Vector]:
        """Places, velocities and accelerations of the points, by components (..., p), as the tangents carry them."""
        r, rd, rdd = (mapped(vector, self.cumulative) for vector in (tangents.t, tangents.td, tangents.tdd))
        if self.offset is None:
            return r, rd, rdd
        arm, arm_rate, arm_change = self._arms(tangents)
        return add(r, arm), add(rd, arm_rate), add(rdd, arm_change)

    def _arms(self, tangents: Tangents) -> tuple[Vector, Vector, Vector]:
        """Arms of points off the axis with their first and second rates."""
        turns = zip(tangents.base, (tangents.turn, tangents.turnd), strict=True)
        w, alpha = (add(base, mapped(turn, self.cumulative)) for base, turn in turns)
        return _carried(tangents.arm, w, alpha)

    def paths(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Places, velocities and accelerations of the points relative to the base axes, (..., p, 3) each."""
        return self._paths(self.moving(q, qd, qdd), q)

    def _paths(self, tangents: Tangents, q: Array) -> tuple[Array, Array, Array]:
        """Paths of the points as arrays, (..., p, 3) each, from the tangents at coordinates q."""
        xp, shape = namespace(self.strains, self.offset, q), (*q.shape[:-1], len(self.cumulative))
        r, rd, rdd = (joined(xp, component, shape) for component in self.carried(tangents))
        return r, rd, rdd

    def poses(self, q: Array, qd: Array, qdd: Array, at: slice) -> tuple[tuple[Array, Array, Array], Array]:
        """Paths (..., p, 3) of all points, and rotations (..., k, 3, 3) of the sections `at` k of them, in one pass."""
        tangents = self.moving(q, qd, qdd, points=True)
        chosen = tuple(
            tuple(part if isinstance(part, int) else part[..., at] for part in row) for row in tangents.at_points
        )
        return self._paths(tangents, q), self._matrices(chosen, q, len(self.cumulative[at]))

    def positions(self, q: Array) -> Array:
        """Places of the points at coordinates (..., n), base axes, (..., p, 3) m."""
        tangents = self.tangents(q)
        r = add(mapped(tangents.t, self.cumulative), tangents.arm)
        return joined(namespace(self.strains, self.offset, q), r, (*q.shape[:-1], len(self.cumulative)))

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotation matrices R_BS (..., p, 3, 3) of the sections `at` some points, of all unless given."""
        field = self[at]
        _, at_points = field.frames.at(field.strain(q)[3:], points=True)
        return self._matrices(at_points, q, len(field.cumulative))

    def _matrices(self, rotation: Any, q: Array, count: int) -> Array:
        xp = namespace(self.strains, self.offset, q)
        return xp.stack([joined(xp, row, (*q.shape[:-1], count)) for row in rotation], axis=-2)

    def turning(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """Rotations (..., p, 3, 3) of the points' sections, their angular velocities and accelerations, base axes."""
        xp, shape = namespace(self.strains, self.offset, q), (*q.shape[:-1], len(self.cumulative))
        tangents = self.moving(q, qd, qdd, points=True)
        w, alpha = (joined(xp, mapped(vector, self.cumulative), shape) for vector in (tangents.turn, tangents.turnd))
        return self._matrices(tangents.at_points, q, len(self.cumulative)), w, alpha

    # --- forces come back

    def pulled(self, tangents: Tangents, force: Vector, moment: Vector = NONE) -> Array:
        """Generalised forces (..., n) of forces on t and moments on the sections at the nodes."""
        lever = mapped(cross(tangents.t, force), self.node_cumulative.T)
        return self.inward(tangents, force, add(moment, lever))

    def inward(self, tangents: Tangents, force: Vector, moment: Vector) -> Array:
        """Generalised forces (..., n) of the forces and moments that the sections at the nodes carry, base axes."""
        inward = (*turned_back(tangents.rotation, force), *turned_back(tangents.rotation, moment))
        parts = [part @ self.strains[k] for k, part in enumerate(inward) if self.shaped[k] and not absent(part)]
        return sum(parts[1:], start=parts[0]) if parts else np.zeros(self.size)

    def generalised_forces(self, q: Array, push: Vector, turn: Vector = NONE) -> Array:
        """Generalised forces (..., n) of forces and moments on the points, base axes, by components (..., p)."""
        tangents = self.tangents(q)
        return self.pulled(tangents, *self.nodal_forces(tangents, push, turn))

    def nodal_forces(self, tangents: Tangents, push: Vector, turn: Vector = NONE) -> tuple[Vector, Vector]:
        """Forces on t and moments on the sections at the nodes that do the work of forces and moments on the points."""
        turn = add(turn, cross(tangents.arm, push))
        return mapped(push, self.cumulative.T), mapped(turn, self.cumulative.T)

    # --- how it changes

    def _slopes(self, q: Array) -> tuple[Tangents, Vector, Vector, Vector]:
        """Tangents and, by coordinate (..., G, n), strains Rε and curvatures Rκ of the shapes, and
        angles of the nodes.
        """
        tangents = self.tangents(q)
        rotation: Any = tuple(
            tuple(part if isinstance(part, int) else part[..., None] for part in row) for row in tangents.rotation
        )
        s, t, u, x, y, z = (part if shaped else 0 for part, shaped in zip(self.strains, self.shaped, strict=True))
        strain, turn = turned(rotation, (s, t, u)), turned(rotation, (x, y, z))
        return tangents, strain, turn, self._summed(self.node_cumulative, turn)

    @staticmethod
    def _summed(matrix: Array, vector: Vector) -> Vector:
        """Products of a matrix (p, G) and components (..., G, n), (..., p, n)."""
        x, y, z = (0 if absent(part) else matrix @ part for part in vector)
        return x, y, z

    def columns(self, tangents: Tangents) -> Columns:
        """Derivatives of tangents and section angles, a column a coordinate. Tangents' components are (..., 1, G)."""
        shapes: Any = tuple(part.T if shaped else 0 for part, shaped in zip(self.strains, self.shaped, strict=True))
        fixed = (turned(tangents.rotation, part) for part in (shapes[:3], shapes[3:]))
        strain, turn = (_carried(vector, tangents.w, tangents.alpha) for vector in fixed)
        angle = mapped_rates(turn, self.node_cumulative)
        swung = cross_rates(angle, (tangents.t, tangents.td, tangents.tdd))
        return Columns(added_rates(swung, strain), angle, turn)

    def columns_of_points(self, tangents: Tangents, columns: Columns) -> Columns:
        """Columns of the points and their sections, by those of the nodes."""
        place, angle = (mapped_rates(rates, self.cumulative) for rates in (columns.place, columns.turn))
        if self.offset is None:
            return Columns(place, angle, columns.turn)
        swung = cross_rates(angle, self._arms(tangents))
        return Columns(added_rates(place, swung), angle, columns.turn)

    def slopes(self, q: Array) -> Array:
        """∂r/∂q of the points at coordinates (..., n), (..., p, 3, n)."""
        return self.jacobians(q)[0]

    def jacobians(self, q: Array) -> tuple[Array, Array]:
        """Derivatives ∂r/∂q of the points and of their sections' angles by the coordinates, (..., p, 3, n) each."""
        xp, shape = namespace(self.strains, self.offset, q), (*q.shape[:-1], len(self.cumulative), self.size)
        tangents, strain, turn, angle = self._slopes(q)
        x, y, z = (part if absent(part) else part[..., None] for part in tangents.t)
        first = self._summed(self.cumulative, add(cross(angle, (x, y, z)), strain))
        at_points = self._summed(self.cumulative, turn)
        if self.offset is not None:
            arm: Any = tuple(part if absent(part) else part[..., None] for part in tangents.arm)
            first = add(first, cross(at_points, arm))
        slopes, angles = (xp.swapaxes(joined(xp, vector, shape), -1, -2) for vector in (first, at_points))
        return slopes, angles

    def weighted(self, q: Array, weight: Array, arm: Array | None = None) -> Array:
        """Weighted sums over the points of second derivatives by the coordinates, (k, 3, n, n).

        With weights w (k, p) they are Σ w ∂²r/∂q². If weighted arms Ra (k, 3, p), base axes, are given, they are Σ w
        ∂²r/∂q² of the axis and Σ ∂²R/∂q² a.
        """
        tangents, strain, turn, angle = self._slopes(q)
        xp, n = namespace(self.strains, self.offset, q), self.size
        if arm is None:
            arm = xp.zeros((len(weight), 3, weight.shape[-1]))
            if self.offset is not None:
                arm = weight[:, None] * joined(xp, tangents.arm, weight.shape[-1:]).T
        at_nodes = weight @ self.cumulative
        arm_sums = arm @ self.cumulative
        levers = [part if absent(part) else at_nodes * part for part in tangents.t]
        moved = [part if absent(part) else part @ self.node_cumulative for part in levers]
        arm_sums = xp.stack([plus(part, arm_sums[:, axis]) for axis, part in enumerate(moved)], axis=1)
        blocks = [xp.zeros((len(weight), n, n)) for _ in range(3)]

        def add_to(axis: int, weights: Array, left: Array, right: Array) -> None:
            if not (absent(left) or absent(right)):
                blocks[axis] = blocks[axis] + (left.T[None] * weights[:, None]) @ right

        for a, b, c in np.argwhere(EPSILON):  # R' ε = θ × ε
            add_to(a, EPSILON[a, b, c] * at_nodes, angle[b], strain[c])
        for a in range(3):  # θ × (κ × d) = κ (θ·d) − d (θ·κ)
            for b in range(3):
                add_to(a, arm_sums[:, b], angle[b], turn[a])
                add_to(a, -arm_sums[:, a], angle[b], turn[b])
        summed = xp.stack(blocks, axis=1)
        return summed + xp.swapaxes(summed, -1, -2)

    def expand(self, q: Array, mass: Array) -> tuple[Places, Array]:
        """Places about coordinates (n,), to first order, and Σ m ∂²r/∂q² and Σ m r_b ∂²r/∂q², (4, 3, n, n)."""
        xp = namespace(self.strains, self.offset, q, mass)
        r = self.positions(q)
        return Places(r, self.slopes(q)), self.weighted(q, xp.concatenate([mass[None], mass * r.T]))

    def curved(self, q: Array) -> tuple[Places, Array, Turns]:
        """Positions near coordinates (n,) to second order, the sections' rotations (p, 3, 3) and their derivatives."""
        xp, count = namespace(self.strains, self.offset, q), len(self.cumulative)
        slopes, angle = self.jacobians(q)
        rotation, unit = self.rotation(q), xp.eye(count)  # of weights: each point by itself
        second = self.weighted(q, unit)
        turn = xp.einsum("abc,pbi,pcd->padi", EPSILON, angle, rotation)
        columns = [self.weighted(q, 0 * unit, xp.einsum("pa,pk->kap", rotation[:, :, d], unit)) for d in range(3)]
        return Places(self.positions(q), slopes, second), rotation, Turns(turn, xp.stack(columns, axis=2))


def _carried(vector: Vector, w: Vector, alpha: Vector) -> tuple[Vector, Vector, Vector]:
    """Vectors that turn at ω and α, with their first and second rates."""
    rate = cross(w, vector)
    return vector, rate, add(cross(alpha, vector), cross(w, rate))


def cross_rates(angle: Any, arm: Any) -> tuple[Vector, Vector, Vector]:
    """Vector product θ × r with its first and second rates, from those of θ and r."""
    (turn, rate, change), (r, rd, rdd) = angle, arm
    return (
        cross(turn, r),
        add(cross(rate, r), cross(turn, rd)),
        add(cross(change, r), scaled(2.0, cross(rate, rd)), cross(turn, rdd)),
    )


def mapped_rates(vectors: Any, matrix: Array) -> tuple[Vector, Vector, Vector]:
    value, rate, change = (mapped(vector, matrix) for vector in vectors)
    return value, rate, change


def added_rates(left: Any, right: Any) -> tuple[Vector, Vector, Vector]:
    value, rate, change = (add(*pair) for pair in zip(left, right, strict=True))
    return value, rate, change


@record
class ExpandedField(Expanded):
    """Taylor polynomials at rest of a strain field, to first order where it is `linear`."""

    expanded: Places
    turned: Turns

    @classmethod
    def of(cls, field: StrainField, *, linear: bool) -> ExpandedField:
        """Expand a field."""
        places, rotation, turns = field.curved(np.zeros(field.size))
        return cls(replace(places, second=0 * places.second) if linear else places, replace(turns, rest=rotation))

    def places(self) -> Places:
        """Taylor polynomial of the positions."""
        return self.expanded

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations."""
        return self.turned

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        return self.sections(at).rotation(q)


def strain_field(
    rule: Quadrature,
    x: Array,
    strains: Array,
    move: Array | None = None,
    turn: Array | None = None,
    line: Line | None = None,
) -> StrainField:
    """Field of a beam at points x (p,), m, by the `strains` (6, g, n) of its shapes at the quadrature nodes.

    Without a `line` the beam is straight at rest. Its root moves by `move` q, m, and turns by `turn` q, rad, (3, n)
    each.
    """
    n = strains.shape[-1]
    shift = np.zeros((3, n)) if move is None else move
    spin = np.zeros((3, n)) if turn is None else turn
    weights, root, turning = root_rule(shift, spin)
    corners = () if line is None else line.corners
    before, nodes = len(weights) + len(corners), len(rule.node)
    root_strains = np.where(
        turning[:, None], np.concatenate([0 * shift, spin])[:, None], np.concatenate([shift, 0 * spin])[:, None]
    )
    all_strains = np.concatenate([root_strains, np.zeros((6, len(corners), n)), strains], axis=1)
    rest = np.zeros((6, before + nodes))
    rest[0, before:] = 1.0
    if line is not None:
        rest[3:, before:] = line.curvature(rule.node).T
        rest[3:, len(weights) : before] = np.reshape(line.turns, (-1, 3)).T
    # A corner is a node without extent that turns at rest, and with it all that lies beyond.
    cumulative, node_cumulative = (
        np.concatenate([np.tile(weights, (len(places), 1)), beyond(corners, places), rule.cumulative(places)], axis=1)
        for places in (x, rule.node)
    )
    root_rows = np.pad(root, ((0, len(corners)), (0, len(corners) + nodes)))
    node_cumulative = np.concatenate([root_rows, node_cumulative])
    frames = frames_along(rule, x, turning, root, cumulative, node_cumulative, corners)
    shaped = tuple(bool(np.any(strain)) for strain in all_strains)
    present = tuple(has_shapes or bool(np.any(strain)) for has_shapes, strain in zip(shaped, rest, strict=True))
    return StrainField(cumulative, node_cumulative, all_strains, rest, frames, None, shaped, present)


# Strain of each family, in the order of the families: bending towards +z turns about −y.
STRAINS = (0, 5, 4, 3, 1, 2)


def shaped_strains(rule: Quadrature, families: Families) -> Array:
    """Values (6, g, n) of the strains of shapes. Bending families give curvatures, the others slopes."""
    columns = []
    for strain, family in zip(STRAINS, families, strict=True):
        shape = family(rule.node)
        values = {4: -shape.curvature, 5: shape.curvature}.get(strain, shape.slope)
        columns.append(np.zeros((6, *values.shape)))
        columns[-1][strain] = values
    return np.concatenate(columns, axis=2)
