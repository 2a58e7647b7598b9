"""The inertia of a complete model: the particles of its field, and what their motions and forces sum to."""

from __future__ import annotations

from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, concatenated, is_jax, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.linear import NOTHING, Geometric, geometric_of
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import Columns, StrainField, Tangents
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.fields.vectors import (
    NONE,
    Vector,
    absent,
    add,
    cross,
    joined,
    mapped,
    plus,
    scaled,
    split,
    swept,
    times,
    turned,
    turned_back,
)
from gbeam.numerics.series import STEP

x, y, z = np.eye(3)[..., None]
UNITS: Vector = (x, y, z)  # of the three unit vectors, in columns


class Demanded(NamedTuple):
    """Forces that a motion demands on the tangents t, and moments on the sections at the nodes.

    `total` is their resultant, `about` their moment about the root. Parts of these are the moments `turn` of the
    sections' own inertia at the nodes, and the forces `push` on points beside the axis.
    """

    force: Vector
    moment: Vector
    total: Vector
    about: Vector
    turn: Vector
    push: Vector


@record
class Particles:
    """Particles (p,) kg of a field."""

    field: StrainField | SeriesField | Places
    mass: Array

    def forces(
        self, q: Array, qd: Array, qdd: Array, a: Vector, w: Vector, alpha: Vector
    ) -> tuple[Array, Vector, Vector]:
        """Forces Σ m (∂r/∂q)·a on the coordinates (..., n), and the resultant and moment about the root, by components.

        The base's motion has components (..., 1), which are spread over the particles.
        """
        field: Any = self.field
        r, rd, rdd = field.components(q, qd, qdd)
        force = scaled(self.mass, add(_relative(r, rd, rdd, w, alpha), a))
        return field.generalised_forces(q, force), _summed(force), _summed(cross(r, force))


@record
class Bodies:
    """Rigid sections on the axis of a strain field, and particles of `off_axis_mass` (p,) kg beside it, its points.

    The places of sections are constant sums C t of the field's tangents: `pairs` CᵀmC (G, G) and `first` Cᵀm (G,), kg,
    have their `mass`. `moments_of_inertia` kg m² are the sections' about the axis, the principal ones (3, G) or those
    and the products xy, yz, zx (6, G), or None. `first_moments` (3, G) kg m are those of their mass, or None.
    """

    field: StrainField
    off_axis_mass: Array
    mass: Array
    pairs: Array
    first: Array
    moments_of_inertia: Array | None
    first_moments: Array | None = None

    def forces(
        self, q: Array, qd: Array, qdd: Array, a: Vector, w: Vector, alpha: Vector
    ) -> tuple[Array, Vector, Vector]:
        """Forces on the coordinates, resultant and moment about the root, as :meth:`Particles.forces` returns them."""
        tangents = self.field.moving(q, qd, qdd, base=(w, alpha))
        demanded = self._demanded(tangents, a)
        return self.field.pulled(tangents, demanded.force, demanded.moment), demanded.total, demanded.about

    def _demanded(self, tangents: Tangents, a: Vector) -> Demanded:
        """Forces at the nodes that the motion demands, and resultants at the root.

        `turn` is the part of the sections' own rotary inertia, `push` that of particles beside the axis. Mass on the
        axis makes the rest. `a` is the base's acceleration. Forces and moments are on the tangents and on the angles of
        the nodes.
        """
        force, moment = add(mapped(tangents.tdd, self.pairs), scaled(self.first, a)), NONE
        base: Any = tuple(part if absent(part) else part[..., 0] for part in a)  # without the axis of nodes
        total = add(_weighted(tangents.tdd, self.first), scaled(self.mass, base))
        moments = _summed(cross(tangents.t, force))
        turn, push = NONE, NONE
        if self.moments_of_inertia is not None:
            turn = self._rotary_moments(tangents)
            on_sections = turn
            if self.first_moments is not None:
                aside, lever = self._eccentric_forces(tangents, a)
                force = add(force, mapped(aside, self.field.node_cumulative.T))
                on_sections = add(turn, lever)
                place = mapped(tangents.t, self.field.node_cumulative)
                total = add(total, _summed(aside))
                moments = add(moments, _summed(cross(place, aside)))
            moment = mapped(on_sections, self.field.node_cumulative.T)
            moments = add(moments, _summed(on_sections))
        if len(self.off_axis_mass):
            r, _, rdd = self.field.carried(tangents)
            push = scaled(self.off_axis_mass, add(rdd, a))
            node_force, node_moment = self.field.nodal_forces(tangents, push)
            force, moment = add(force, node_force), add(moment, node_moment)
            total = add(total, _summed(push))
            moments = add(moments, _summed(cross(r, push)))
        return Demanded(force, moment, total, moments, turn, push)

    def slopes(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, axes: list[int], *, still: bool
    ) -> tuple[Array, Array]:
        """Forces on the coordinates, resultant and moment (..., n + 6), and their derivatives with respect to q, q̇, q̈,
        a, ω and α, (..., 3 n + 9, n + 6). Rows of ω and α about axes of the root that are not in `axes` are zero, and
        so are those of q and q̇ where these are `still`.
        """
        shape = np.broadcast_shapes(*(values.shape[:-1] for values in (q, qd, qdd, a, w, alpha)))
        n, outboard = self.field.size, self.field.node_cumulative.T  # sums of all that is outboard of a node
        # The last axis are nodes or points, the one before it the columns by q, q̇, q̈, ω and α.
        base, w, alpha = (_components(vectors[..., None, :]) for vectors in (a, w, alpha))
        q, qd, qdd = (values[..., None, :] for values in (q, qd, qdd))
        tangents = self.field.moving(q, qd, qdd, base=(w, alpha))
        demand = self._demanded(tangents, base)
        fixed = Tangents(tangents.rotation, tangents.t, tangents.arm) if still else tangents
        columns, side = self.field.columns(fixed), _Side.from_axes(shape, n, axes, still)
        # The root's turn moves t, and turns sections, as a coordinate does.
        moved = side.rows(columns.place[0], cross(UNITS, tangents.t))
        change = side.changes(columns, tangents.t, tangents.td, w)
        work, resultant = _work(mapped(change, self.pairs), moved), _weighted(change, self.first)
        by_a, mass, swung = _weighted(moved, self.first), self.mass, cross(columns.place[0], demand.force)
        lever, about = mapped(swung, outboard), _summed(swung)
        if self.moments_of_inertia is not None:
            turn = self._rotary_moment_slopes(tangents, columns, demand.turn, side)
            work = work + _work(turn, side.rows(columns.angle[0], UNITS))
        if len(self.off_axis_mass):
            (r, rd, _), points = self.field.carried(tangents), self.field.columns_of_points(fixed, columns)
            moved = side.rows(points.place[0], cross(UNITS, r))
            change = scaled(self.off_axis_mass, side.changes(points, r, rd, w))
            work, resultant = work + _work(change, moved), add(resultant, _summed(change))
            by_a, mass = add(by_a, _weighted(moved, self.off_axis_mass)), mass + self.off_axis_mass.sum()
            arm = cross(cross(points.angle[0], tangents.arm), demand.push)
            lever = add(lever, mapped(arm, self.field.cumulative.T))
            about = add(about, _summed(arm))
        if not still:
            carried = add(demand.moment, mapped(cross(tangents.t, demand.force), outboard))  # by the sections
            # Moments on the nodes do other work where these have turned.
            force, moment = cross(demand.force, columns.angle[0]), add(cross(carried, columns.angle[0]), lever)
            work[..., :n, :n] += self.field.inward(tangents, force, moment)
            work[..., :n, n:] += joined(np, about, (*shape, n))
        out, turns = np.zeros((*shape, 3 * n + 9, n + 6)), 3 * n + 3 + np.array(axes, dtype=int)
        motion, rows = np.r_[2 * n * still : 3 * n, turns, turns + 3], np.r_[:n, n + 3 : n + 6]
        out[..., motion[:, None], rows] = work
        out[..., motion, n : n + 3] = joined(np, resultant, (*shape, len(motion)))
        out[..., 3 * n : 3 * n + 3, rows] = np.moveaxis(joined(np, by_a, (*shape, n + 3)), -1, -2)
        out[..., 3 * n : 3 * n + 3, n : n + 3] = mass * np.eye(3)
        along = self.field.pulled(tangents, demand.force, demand.moment)
        value = [along, *(joined(np, vector, (*shape, 1)) for vector in (demand.total, demand.about))]
        return concatenated(value)[..., 0, :], out

    def _rotary_moment_slopes(self, tangents: Tangents, columns: Columns, turn: Vector, side: _Side) -> Vector:
        """Derivatives of the sections' torque `turn` (:meth:`_rotary_moments`), in the columns of `side`."""
        (angle, rate, change), rotation, w = columns.angle, tangents.rotation, tangents.w
        relative = add(w, scaled(-1.0, tangents.base[0]))
        # Derivatives of ω and α as seen in axes that turn with the sections.
        by_w = side.joined(rate, angle, NONE, side.units, NONE)
        by_alpha = side.joined(
            add(change, cross(rate, w)),
            add(scaled(2.0, rate), cross(angle, w)),
            angle,
            cross(side.units, relative),
            side.units,
        )
        # In the sections' axes the torque is J α + ω × J ω, with constant J.
        w, by_w, by_alpha = (turned_back(rotation, vector) for vector in (w, by_w, by_alpha))
        torque = add(
            self._multiply_inertia(by_alpha),
            cross(by_w, self._multiply_inertia(w)),
            cross(w, self._multiply_inertia(by_w)),
        )
        return add(turned(rotation, torque), side.joined(cross(angle, turn), NONE, NONE, NONE, NONE))

    def _rotary_moments(self, tangents: Tangents) -> Vector:
        """Moments J α + ω × J ω of the sections at the nodes."""
        rotation = tangents.rotation
        rate, change = turned_back(rotation, tangents.w), turned_back(rotation, tangents.alpha)
        momentum, torque = self._multiply_inertia(rate), self._multiply_inertia(change)
        return turned(rotation, add(torque, cross(rate, momentum)))

    def _multiply_inertia(self, vector: Vector) -> Vector:
        """Multiply vectors in the sections' axes by J, which has three principal moments, or products, too."""
        x, y, z, *products = self.moments_of_inertia  # type: ignore[misc]
        if not products:
            return times(x, vector[0]), times(y, vector[1]), times(z, vector[2])
        xy, yz, zx = products
        rows = (x, xy, zx), (xy, y, yz), (zx, yz, z)
        return turned(rows, vector)

    def _eccentric_forces(self, tangents: Tangents, base: Vector) -> tuple[Vector, Vector]:
        """Forces and moments about the axis, at the nodes, of sections whose centres of mass lie off the axis.

        They come on top of those of the sections' mass on the axis.
        """
        assert self.first_moments is not None
        x, y, z = self.first_moments
        arm = turned(tangents.rotation, (x, y, z))
        axis = add(mapped(tangents.tdd, self.field.node_cumulative), base)
        return swept(tangents.w, tangents.alpha, arm), cross(arm, axis)


@record
class Inertia:
    """Particles (p,) kg of a field, of quadrature points and bodies. `reduced` has the same inertia in fewer sums."""

    field: StrainField | SeriesField | Places
    mass: Array
    reduced: Particles | Bodies

    def forces(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array, Array]:
        """Forces Σ m (∂r/∂q)·a on the coordinates (..., n), resultant of m a, and moment about the root (..., 3).

        The base has the acceleration (or specific force) a_O, angular velocity ω and angular acceleration α, (..., 3):
        a = a_O + α × r + ω × (ω × r) + 2 ω × ṙ + r̈.
        """
        motion = (q, qd, qdd, a, w, alpha)
        if any(map(np.iscomplexobj, motion)):
            stepped = self._stepped(motion)
            if stepped is not None:
                return stepped[..., :-6], stepped[..., -6:-3], stepped[..., -3:]
        xp = namespace(self.mass, q, a)
        shape = np.broadcast_shapes(*(array.shape[:-1] for array in motion))
        generalised, total, moment = self.reduced.forces(q, qd, qdd, *(_components(vector) for vector in (a, w, alpha)))
        generalised = xp.broadcast_to(generalised, (*shape, generalised.shape[-1]))
        return generalised, joined(xp, total, shape), joined(xp, moment, shape)

    def _stepped(self, motion: tuple[Array, ...]) -> Array | None:
        """Forces, resultant and moment (..., n + 6) of a real motion with complex steps along the first axis.

        They come from derivatives at the real motion, computed once for all steps. None where :meth:`Bodies.slopes`
        does not apply.
        """
        axes = max(array.ndim for array in motion)
        real = [_common(array, axes) for array in motion]
        if (
            axes < 2
            or not isinstance(self.reduced, Bodies)
            or self.reduced.first_moments is not None
            or any(x is None for x in real)
        ):
            return None
        q, qd, qdd, a, w, alpha = real
        turns = [k for k in range(3) if any(np.imag(vector[..., k]).any() for vector in motion[4:])]
        still = not any(map(np.iscomplexobj, motion[:2]))
        out, slope = self.reduced.slopes(q, qd, qdd, a, w, alpha, turns, still=still)
        steps = np.moveaxis(concatenated([array.imag for array in motion]), 0, -2)
        return out + 1j * np.moveaxis(steps @ slope, -2, 0)

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        """Mass kg, and its first moment (..., 3) kg m about the root, its axes."""
        return self.mass.sum(), (self.mass[:, None] * self.field.positions(q)).sum(axis=-2)

    def expand(self, q: Array) -> tuple[Places, Geometric | None]:
        """Expand places about coordinates (n,), with geometric stiffness where only to first order (strain fields)."""
        if not isinstance(self.field, StrainField):
            return self.field.expand(q), None
        places, bent = self.field.expand(q, self.mass)
        return places, geometric_of(bent[0], bent[1:])


def _relative(r: Vector, rd: Vector, rdd: Vector, w: Vector, alpha: Vector) -> Vector:
    """α × r + ω × (ω × r) + 2 ω × ṙ + r̈."""
    return add(swept(w, alpha, r), scaled(2.0, cross(w, rd)), rdd)


class _Side(NamedTuple):
    """Layout of derivatives in columns side by side, at instants of a `shape`: by q, q̇, q̈ (n each), ω and α.

    ω and α are taken about `axes` of the root's axes, whose unit vectors are `units`. Columns by q and q̇ are left out
    where it is `still`.
    """

    shape: tuple[int, ...]
    n: int
    axes: int
    units: Vector
    still: bool

    @classmethod
    def from_axes(cls, shape: tuple[int, ...], n: int, axes: list[int], still: bool) -> _Side:
        """Make the layout with ω and α about some of the axes 0, 1 and 2 of the root."""
        x, y, z = (row[axes, None] if k in axes else 0 for k, row in enumerate(np.eye(3)))
        return cls(shape, n, len(axes), (x, y, z), still)

    def joined(self, *parts: Vector) -> Vector:
        """Columns (..., 3 n + 2 axes, points) by q, q̇, q̈, ω and α, without those by q and q̇ where it is `still`."""
        counts, first = (self.n,) * 3 + (self.axes,) * 2, 2 * self.still
        return self._joined(parts[first:], counts[first:])

    def rows(self, by_coordinate: Vector, by_turn: Vector) -> Vector:
        """Columns (..., n + 3, points) by coordinates and turns of the root about all axes."""
        return self._joined((by_coordinate, by_turn), (self.n, 3))

    def _joined(self, parts: tuple[Vector, ...], counts: tuple[int, ...]) -> Vector:
        """Join vectors along their columns, `counts` of each: components (..., Σ counts, points) of `parts`."""
        ends, components = np.cumsum(counts), list[Any]()
        for component in zip(*parts, strict=True):
            if all(map(absent, component)):
                components.append(0)
                continue
            points = max(part.shape[-1] for part in component if not absent(part))
            components.append(np.empty((*self.shape, ends[-1], points)))
            for part, end, count in zip(component, ends, counts, strict=True):
                components[-1][..., end - count : end, :] = part
        x, y, z = components
        return x, y, z

    def changes(self, columns: Columns, r: Vector, rd: Vector, w: Vector) -> Vector:
        """Derivatives (..., columns, points), as :meth:`joined`, of the acceleration of places r with rates ṙ on a base
        with the angular velocity ω: ∂r̈/∂q̇ is twice the rate of ∂r/∂q.
        """
        slope, rate, change = columns.place
        by_w = add(scaled(2.0, cross(self.units, rd)), cross(cross(w, self.units), r))
        return self.joined(change, scaled(2.0, rate), slope, by_w, cross(self.units, r))


def _work(forces: Vector, slopes: Vector) -> Array:
    """Work (..., c, n) of forces (..., c, points) along slopes (..., n, points), or (..., n, 1) if alike at all points.

    It is zero () where all are absent, as of a beam that only twists.
    """
    pairs = [(f, s) for f, s in zip(forces, slopes, strict=True) if not (absent(f) or absent(s))]
    if not pairs:
        return np.zeros(())
    spread = (np.broadcast_to(s, (*s.shape[:-1], f.shape[-1])) for f, s in pairs)
    return reduce(plus, (f @ np.swapaxes(s, -1, -2) for (f, _), s in zip(pairs, spread, strict=True)))


def _components(vectors: Array) -> Vector:
    """Components (..., 1) of vectors (..., 3); one that is zero at all times is absent."""
    x, y, z = split(vectors[..., None, :])
    if is_jax(vectors):
        return x, y, z
    x, y, z = (part if part.any() else 0 for part in (x, y, z))
    return x, y, z


def _common(part: Array, axes: int) -> Array:
    """Real part without its first axis, where it has one (`axes` axes in all),
    or None where it differs along this one.
    """
    real = part.real
    if part.ndim < axes:
        return real
    # The square of a step is left of a rate that is zero.
    return real[0] if (np.abs(real - real[:1]) <= STEP).all() else None


def _summed(vectors: Vector) -> Vector:
    """Sums over points, by components."""
    x, y, z = (0 if absent(part) else part @ np.ones(part.shape[-1]) for part in vectors)
    return x, y, z


def _weighted(vectors: Vector, weight: Array) -> Vector:
    """Sums over points with weights (points,)."""
    x, y, z = (0 if absent(part) else part @ weight for part in vectors)
    return x, y, z


def inertia_of(
    field: StrainField | SeriesField | Places, mass: Array, line: int = 0, nodes: int = 0, *, symmetric: bool = False
) -> Inertia:
    """Inertia of a field's particles (p,), kg.

    The first `line` particles are the sections at the `nodes`, one or several a node. If the sections are `symmetric`,
    their axes y and z are principal and their centres lie on the beam's axis.
    """
    if not isinstance(field, StrainField):
        return Inertia(field, mass, Particles(field, mass))
    offset = field.offset
    is_offset = np.zeros(len(mass), bool)
    if offset is not None:
        is_offset[line:] = True if is_jax(offset) else np.any(offset[line:], axis=1)
    on_axis, off_axis = np.flatnonzero(~is_offset), np.flatnonzero(is_offset)
    c, axis_mass = field.cumulative[on_axis], mass[on_axis]
    turning, aside = None, None
    if offset is not None and line and not (symmetric and line == nodes):
        root_nodes = field.strains.shape[1] - nodes
        turning, aside = _moments(mass[:line], offset[:line], nodes, root_nodes, symmetric=symmetric)
    points = field[off_axis] if len(off_axis) else field.points(off_axis)
    pairs, first = c.T @ (axis_mass[:, None] * c), c.T @ axis_mass
    return Inertia(field, mass, Bodies(points, mass[off_axis], axis_mass.sum(), pairs, first, turning, aside))


def _moments(
    mass: Array, offset: Array, nodes: int, before: int, *, symmetric: bool
) -> tuple[Array | None, Array | None]:
    """Moments of inertia (3 or 6, G), kg m², and first moments of mass (3, G), kg m, of the sections, as
    :class:`Bodies` takes them.

    They are zero at the `before` nodes of the root. What is only rounding is None.
    """
    xp = namespace(mass, offset)

    def at_nodes(values: Array) -> Array:
        return xp.pad(values.reshape(-1, nodes, values.shape[-1]).sum(axis=0).T, ((0, 0), (before, 0)))

    squares = at_nodes(mass[:, None] * offset**2)
    principal = squares.sum(axis=0) - squares
    if symmetric:
        return principal, None
    products = at_nodes(-mass[:, None] * offset * xp.roll(offset, -1, axis=1))
    aside = at_nodes(mass[:, None] * offset)
    if is_jax(principal):
        return xp.concatenate([principal, products]), aside
    size = principal.max(initial=0.0)
    if size == 0:
        return None, None
    has_products = np.abs(products).max() > NOTHING * size
    is_off_axis = np.abs(aside).max() > NOTHING * mass.max()
    turning = np.concatenate([principal, products]) if has_products else principal
    return turning, aside if is_off_axis else None
