"""Displacements and rotation vectors of a beam's sections, with their derivatives: what supports measure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.products import times
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import StrainField, Tangents
from gbeam.mechanics.fields.taylor import Expanded
from gbeam.mechanics.fields.vectors import NONE, Vector, absent, add, cross, joined, mapped, skew

SMALL = 1e-2  # rad²: squares of smaller angles have series


def components(conditions: Sequence[tuple[int, int]], moved: Array, turned: Array) -> Array:
    """Components (..., m, n) of vectors (..., k, 3, n): each `conditions` of one place's displacement or rotation."""
    xp, shape = namespace(moved, turned), moved.shape
    if not conditions:
        return xp.zeros((*shape[:-3], 0, shape[-1]))
    return xp.stack([moved[..., k, d, :] if d < 3 else turned[..., k, d - 3, :] for k, d in conditions], axis=-2)


class Measures:
    """Measures of m displacements and rotations of sections, in axes of the root, by coordinates (..., n).

    What several answers at the same coordinates share is their `state`. By it `values_at` are the measures (..., m),
    `rows_at` their derivatives (..., m, n), and `drift_at` their second rates (..., m) where q does not accelerate.
    Their second derivatives (..., m, n, n) at real coordinates are `bent_rows`.
    """

    state: Callable[[Array], Any]
    values_at: Callable[[Any, Array], Array]
    rows_at: Callable[[Any, Array], Array]
    drift_at: Callable[[Any, Array, Array], Array]
    bent_rows: Callable[[Array], Array]

    def values_and_rows(self, q: Array) -> tuple[Array, Array]:
        """Measures (..., m), and their derivatives (..., m, n), at coordinates (..., n)."""
        state = self.state(q)
        return self.values_at(state, q), self.rows_at(state, q)

    def values(self, q: Array) -> Array:
        """Measures (..., m) at coordinates (..., n)."""
        return self.values_at(self.state(q), q)

    def rows(self, q: Array) -> Array:
        """Derivatives (..., m, n) of the measures by the coordinates (..., n)."""
        return self.rows_at(self.state(q), q)


@record
class PolynomialMeasures(Measures):
    """Measures J q + ½ q H q of second degree: `first` J (m, n) and `second` H (m, n, n).

    Displacements are those of the field's polynomials. Angles are of first degree: a bent section turns by its slope,
    to third order but for the product with the stretch.
    """

    first: Array
    second: Array

    @classmethod
    def from_stations(cls, field: Expanded, first: int, conditions: Sequence[tuple[int, int]]) -> PolynomialMeasures:
        """Measures of a field's stations, by their numbers behind its point `first`, each in a direction."""
        stations = [station for station, _ in conditions]
        sections = field.sections(first + np.array(stations, dtype=int))
        places, angles = sections.places, sections.rotation_vectors[0]
        numbered = [(k, direction) for k, (_, direction) in enumerate(conditions)]
        size, moved = places.first.shape[-1], places.second.reshape(len(conditions), 3, -1)
        bent = components(numbered, moved, 0 * moved)
        return cls(components(numbered, places.first, angles), bent.reshape(len(conditions), size, size))

    def state(self, q: Array) -> Array:
        """Products H q (..., m, n)."""
        return times(self.second, q)

    def values_at(self, state: Array, q: Array) -> Array:
        """Measures (..., m) by the state at coordinates (..., n)."""
        return ((self.first + state / 2) @ q[..., None])[..., 0]

    def rows_at(self, state: Array, q: Array) -> Array:
        """Derivatives (..., m, n) of the measures by the coordinates (..., n)."""
        return self.first + state

    def drift_at(self, state: Array, q: Array, qd: Array) -> Array:
        """Second derivatives (..., m) of the measures with respect to time, at coordinates that do not accelerate."""
        return (self.state(qd) @ qd[..., None])[..., 0]

    def bent_rows(self, q: Array) -> Array:
        """Second derivatives (m, n, n) of the measures by the coordinates, the same everywhere."""
        return self.second


@record
class SectionMeasures(Measures):
    """Measures of sections of a strain field: each of a section, by its number among the `sections`, in a direction
    from 0 to 5. At rest the nodes' tangents are `rest` (3, G), and the sections' `axes` (k, 3, 3) in columns.

    Displacements are sums of what the tangents differ from rest, so that the places' own rounding is not in them.
    """

    sections: StrainField
    rest: Array
    axes: Array
    which: tuple[tuple[int, int], ...] = static()

    @classmethod
    def from_stations(cls, field: StrainField, first: int, conditions: Sequence[tuple[int, int]]) -> SectionMeasures:
        """Measures of a field's stations, by their numbers behind its point `first`, each in a direction."""
        stations = sorted({station for station, _ in conditions})
        sections = field.sections(first + np.array(stations, dtype=int))
        numbered = tuple((stations.index(station), direction) for station, direction in conditions)
        zeros = np.zeros(field.size)
        tangents = joined(namespace(sections.strains), sections.tangents(zeros).t, sections.cumulative.shape[1:])
        return cls(sections, tangents.T, sections.rotation(zeros), numbered)

    def state(self, q: Array) -> Tangents:
        """Tangents at the sections."""
        return self.sections.tangents(q, points=True)

    def values_at(self, state: Tangents, q: Array) -> Array:
        """Measures (..., m) by the tangents at coordinates (..., n)."""
        drawn = add(state.t, tuple(-part for part in self.rest))
        moved = joined(namespace(q), mapped(drawn, self.sections.cumulative), (*q.shape[:-1], len(self.axes)))
        angle = moved
        if any(direction > 2 for _, direction in self.which):
            angle = rotation_vectors(self._rotation(state, q))
        return components(self.which, moved[..., None], angle[..., None])[..., 0]

    def rows_at(self, state: Tangents, q: Array) -> Array:
        """Derivatives (..., m, n) of the measures by the coordinates (..., n): what unit loads on them do."""
        xp, count = namespace(q), len(self.axes)
        force = np.zeros((3, len(self.which), count))
        turns = [(k, section, direction - 3) for k, (section, direction) in enumerate(self.which) if direction > 2]
        for k, (section, direction) in enumerate(self.which):
            if direction < 3:
                force[direction, k, section] = 1.0
        push: Any = tuple(force)
        turn: Any = NONE
        if turns:
            vector_rate, _ = vector_rates(rotation_vectors(self._rotation(state, q)))
            moment = xp.zeros((*q.shape[:-1], 3, len(self.which), count))
            for k, section, axis in turns:
                unit = np.zeros((len(self.which), count))
                unit[k, section] = 1.0
                moment = moment + vector_rate[..., section, axis, :, None, None] * unit
            turn = tuple(moment[..., axis, :, :] for axis in range(3))
        repeated = _for_each_row(state)
        return self.sections.pulled(repeated, *self.sections.nodal_forces(repeated, push, turn))

    def bent_rows(self, q: Array) -> Array:
        """Second derivatives (..., m, n, n) of the measures by the coordinates (..., n), where they are real."""
        field, count = self.sections, len(self.axes)
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
            section_axes = self._rotation(tangents, q[..., None, :])[..., 0, section, :, :]
            vector_rate, by_vector = vector_rates(rotation_vectors(section_axes))
            unit, projected = (
                vector_rate[..., direction - 3, :],
                turned_points[..., section, :] @ np.swapaxes(vector_rate, -1, -2),
            )
            change = sum(
                projected[..., k, None] * by_vector(np.eye(3)[k])[..., None, direction - 3, :] for k in range(3)
            )
            spin: Any = tuple(unit[..., k, None, None] * reach for k in range(3))
            grown: Any = tuple(change[..., k, None] * reach for k in range(3))
            bent.append(field.inward(tangents, NONE, add(cross(spin, angle), grown)))
        shape = (*q.shape[:-1], q.shape[-1], q.shape[-1])
        return np.stack([np.broadcast_to(part, shape) for part in bent], axis=-3)

    def drift_at(self, state: Tangents, q: Array, qd: Array) -> Array:
        """Second derivatives (..., m) of the measures with respect to time, at coordinates that do not accelerate."""
        xp = namespace(q, qd)
        motion = self.sections.moving(q, qd, 0 * qd, points=True, at_rest=state)
        shape = (*np.broadcast_shapes(q.shape[:-1], qd.shape[:-1]), len(self.axes))
        vectors = motion.tdd, motion.turn, motion.turnd
        change, w, alpha = (joined(xp, mapped(vector, self.sections.cumulative), shape) for vector in vectors)
        vector_rate, by_vector = vector_rates(rotation_vectors(self._rotation(state, q)))
        phi_rate = (vector_rate @ w[..., None])[..., 0]
        turned = vector_rate @ alpha[..., None] + by_vector(phi_rate) @ w[..., None]
        return components(self.which, change[..., None], turned)[..., 0]

    def _rotation(self, tangents: Tangents, q: Array) -> Array:
        """Rotations (..., k, 3, 3) of the sections from rest."""
        shape = (*q.shape[:-1], len(self.axes))
        axes = namespace(q).stack([joined(namespace(q), row, shape) for row in tangents.at_points], axis=-2)
        return axes @ namespace(self.axes).swapaxes(self.axes, -1, -2)


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


def vector_rates(phi: Array) -> tuple[Array, Any]:
    """Matrices B (..., 3, 3) with φ̇ = B ω of rotation vectors (..., 3), and the function of φ̇ that gives Ḃ.

    B = 1 − ½ [φ]× + c [φ]×² with c = (1 − θ/2 cot θ/2)/θ²; ω is in the axes that do not turn.
    """
    xp = namespace(phi)
    cross = skew(xp, phi)
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
        rate = skew(xp, phi_rate)
        growth = 2 * (phi * phi_rate).sum(axis=-1)[..., None, None] * slope
        return -rate / 2 + c * (rate @ cross + cross @ rate) + growth * (cross @ cross)

    return np.eye(3) - cross / 2 + c * (cross @ cross), change


@record
class SeriesMeasures(Measures):
    """Measures of sections of a field whose places end at an order, with the `turns` of the exact one.

    Places at rest are `rest` (m, 3), one for each measure.
    """

    sections: SeriesField
    turns: SectionMeasures
    rest: Array

    @classmethod
    def from_stations(cls, field: SeriesField, first: int, conditions: Sequence[tuple[int, int]]) -> SeriesMeasures:
        """Measures of a field's stations, by their numbers behind its point `first`, each in a direction."""
        sections = field.sections(first + np.array([station for station, _ in conditions], dtype=int))
        turns = SectionMeasures.from_stations(field.exact, first, conditions)
        return cls(sections, turns, sections.positions(np.zeros(field.size)))

    def state(self, q: Array) -> Tangents:
        """Tangents at the sections."""
        return self.turns.state(q)

    def values_at(self, state: Tangents, q: Array) -> Array:
        """Measures (..., m) by the tangents at coordinates (..., n)."""
        moved = self.sections.positions(q) - self.rest
        return self._chosen(moved[..., None], self.turns.values_at(state, q)[..., None])[..., 0]

    def rows_at(self, state: Tangents, q: Array) -> Array:
        """Derivatives (..., m, n) of the measures by the coordinates (..., n)."""
        return self._chosen(self.sections.slopes(q), self.turns.rows_at(state, q))

    def bent_rows(self, q: Array) -> Array:
        """Second derivatives (..., m, n, n) of the measures by the coordinates (..., n), where they are real."""
        size = q.shape[-1]
        second = np.stack([self.sections.expand(each).second for each in q.reshape(-1, size)])
        places = second.reshape(*q.shape[:-1], len(self.rest), 3, size * size)
        turned = self.turns.bent_rows(q)
        chosen = self._chosen(places, turned.reshape(*turned.shape[:-2], size * size))
        return chosen.reshape(turned.shape)

    def drift_at(self, state: Tangents, q: Array, qd: Array) -> Array:
        """Second derivatives (..., m) of the measures with respect to time, at coordinates that do not accelerate."""
        moved = self.sections.paths(q, qd, 0 * qd)[2]
        return self._chosen(moved[..., None], self.turns.drift_at(state, q, qd)[..., None])[..., 0]

    def _chosen(self, moved: Array, turned: Array) -> Array:
        """Components (..., m, n): of displacements (..., m, 3, n), and of what is known of rotations (..., m, n)."""
        rows = (
            moved[..., k, direction, :] if direction < 3 else turned[..., k, :]
            for k, (_, direction) in enumerate(self.turns.which)
        )
        return namespace(moved, turned).stack(list(rows), axis=-2)


def measures_of(
    field: StrainField | SeriesField | Expanded, first: int, conditions: Sequence[tuple[int, int]]
) -> Measures:
    """Measures of a field's stations, by their numbers behind its point `first`, each in a direction from 0 to 5."""
    if isinstance(field, Expanded):
        return PolynomialMeasures.from_stations(field, first, conditions)
    if isinstance(field, SeriesField):
        return SeriesMeasures.from_stations(field, first, conditions)
    return SectionMeasures.from_stations(field, first, conditions)
