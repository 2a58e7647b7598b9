"""Bodies of a tree: each takes the motion of its root and gives that of its points, and takes wrenches on these and
gives the forces on its coordinates and the wrench at its root.

A wrench is what motion demands: Σ m a outboard, less the loads. Forces on coordinates are the rows of the equations.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.contraction import RigidRows, Roots, rigid_rows
from gbeam.mechanics.equations.dalembert import Complete
from gbeam.mechanics.equations.held import HeldComplete
from gbeam.mechanics.equations.moments import Moments
from gbeam.mechanics.fields.held import Conditions
from gbeam.mechanics.fields.products import cross, times, turned, turned_back
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import StrainField
from gbeam.mechanics.fields.taylor import Polynomials
from gbeam.mechanics.fields.vectors import split
from gbeam.mechanics.tree.frames import Frame, Relative, Wrench
from gbeam.mechanics.tree.steps import component_moments, rotation_by_vector


class Acting(NamedTuple):
    """A wrench on the point with an index, in axes of the point, and the point's motion `by` in the root's axes."""

    point: int
    by: Relative
    wrench: Wrench


class Body(Protocol):
    """A rigid or flexible body."""

    @property
    def size(self) -> int:
        """Number of coordinates."""
        ...

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        """Motions of the points in the root's axes, by coordinates (..., n)."""
        ...

    def places_of(self, q: Array) -> Array:
        """Places (..., p, 3) m of the points in the root's axes, by coordinates (..., n)."""
        ...

    def demanded(self, q: Array, qd: Array, qdd: Array, root: Frame, loads: Array | None) -> tuple[Array, Wrench]:
        """Forces (..., n) on the coordinates and wrench at the root that a motion demands under load components."""
        ...

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        """Forces (..., n) on the coordinates that do the work of wrenches on points."""
        ...

    def stored(self, q: Array) -> Array:
        """Strain energy (...) J."""
        ...

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        """Mass kg, and its first moment (..., 3) kg m about the root, its axes."""
        ...

    def elastic(self, q: Array) -> Array:
        """Forces (..., n) of the strain energy on the coordinates."""
        ...


@record
class Rigid:
    """A rigid body: mass kg, centre (3,) m and inertia (3, 3) kg m² about it, and its points: places (p, 3) m and
    rotations (p, 3, 3), all in the axes of its root.
    """

    mass: Array
    centre: Array
    inertia: Array
    places: Array
    rotations: Array
    contraction: RigidRows | None = None

    @property
    def size(self) -> int:
        return 0

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        shape, xp = q.shape[:-1], namespace(q, self.places, self.rotations)
        return [
            Relative(xp.broadcast_to(r, (*shape, 3)), None, None, R)
            for r, R in zip(self.places, self.rotations, strict=True)
        ]

    def places_of(self, q: Array) -> Array:
        return namespace(q, self.places).broadcast_to(self.places, (*q.shape[:-1], *self.places.shape))

    def demanded(self, q: Array, qd: Array, qdd: Array, root: Frame, loads: Array | None) -> tuple[Array, Wrench]:
        if self.contraction is not None:
            wrench = self.contraction.wrench(root.a, root.w, root.alpha)
            return q, Wrench(wrench[..., :3], wrench[..., 3:])
        at_centre = root.a + cross(root.alpha, self.centre) + cross(root.w, cross(root.w, self.centre))
        force, spin = self.mass * at_centre, root.w @ self.inertia
        return q, Wrench(force, root.alpha @ self.inertia + cross(root.w, spin) + cross(self.centre, force))

    def contracted(self, carrier: Roots, root: Roots) -> Rigid:
        """Contract it with its `carrier`'s motion, which determines that of its `root`; itself if that is doubtful."""
        reach = carrier.reach(root)
        if reach is None:
            return self
        # Moments of inertia about the root by the parallel axis theorem.
        parallel_axis = (self.centre @ self.centre) * np.eye(3) - np.outer(self.centre, self.centre)
        terms = self.mass, self.mass * self.centre, self.inertia + self.mass * parallel_axis
        return replace(self, contraction=rigid_rows(*terms, reach))

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        return q

    def stored(self, q: Array) -> Array:
        return q.sum(axis=-1)  # of no coordinates: zero

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        return self.mass, self.mass * self.centre + 0 * q.sum(axis=-1, keepdims=True)

    def elastic(self, q: Array) -> Array:
        return q


@record
class StrainedPoints:
    """Sections of a field of strains."""

    field: StrainField | SeriesField

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        """Motions of the points relative to the root: places, velocities, accelerations and rotations
        with their rates.
        """
        r, rd, rdd = self.field.paths(q, qd, qdd)
        R, w, alpha = self.field.turning(q, qd, qdd)
        motions = []
        for k in range(r.shape[-2]):
            R_k = R[..., k, :, :]
            rates = turned_back(R_k, w[..., k, :]), turned_back(R_k, alpha[..., k, :])
            motions.append(Relative(r[..., k, :], rd[..., k, :], rdd[..., k, :], R_k, *rates))
        return motions

    def places_of(self, q: Array) -> Array:
        """Places (..., p, 3) m in the root's axes, by coordinates (..., n)."""
        return self.field.positions(q)

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        xp = namespace(q, *(acting.wrench.force for acting in wrenches))
        at_root = [
            (turned(relative.R, wrench.force), turned(relative.R, wrench.moment)) for _, relative, wrench in wrenches
        ]
        stacks = (xp.stack(xp.broadcast_arrays(*vectors), axis=-2) for vectors in zip(*at_root, strict=True))
        forces, moments = map(split, stacks)
        return self.field[np.array([acting.point for acting in wrenches])].generalised_forces(q, forces, moments)


@record
class PolynomialPoints:
    """Points whose displacements J q + ½ q H q (p, 3, n), (p, 3, n, n) and rotation vectors are polynomials."""

    r0: Array
    first: Array
    second: Array
    turn: Array
    bend: Array

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        r, rd, rdd = _polynomial(self.first, self.second, q, qd, qdd)
        R, w, alpha = rotation_by_vector(*_polynomial(self.turn, self.bend, q, qd, qdd), plane=False)
        r = self.r0 + r
        return [_point(k, (r, rd, rdd), R, w, alpha) for k in range(len(self.r0))]

    def places_of(self, q: Array) -> Array:
        """Places (..., p, 3) m in the root's axes, by coordinates (..., n)."""
        slope = self.first + times(self.second, q) / 2
        return self.r0 + namespace(slope, q).einsum("...pai,...i->...pa", slope, q)

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        """Generalised forces (..., n) of wrenches that act at the points."""
        xp = namespace(q, *(acting.wrench.force for acting in wrenches))
        points = np.array([acting.point for acting in wrenches])
        # Forces in the root's axes, moments in the point's.
        vectors = [(turned(relative.R, wrench.force), wrench.moment) for _, relative, wrench in wrenches]
        force, moment = (xp.stack(xp.broadcast_arrays(*parts), axis=-2) for parts in zip(*vectors, strict=True))
        slope = self.first[points] + xp.einsum("paij,...j->...pai", self.second[points], q)
        rotation_slopes = self.turn[points] + xp.einsum("paij,...j->...pai", self.bend[points], q)
        phi = xp.einsum("...pai,...i->...pa", (self.turn[points] + rotation_slopes) / 2, q)
        on_vector = component_moments(phi, moment)
        return (slope * force[..., None] + rotation_slopes * on_vector[..., None]).sum(axis=(-3, -2))


def _point(k: int, path: tuple[Array, Array, Array], R: Array, w: Array, alpha: Array) -> Relative:
    """Motion of the point k, by the motions of all (..., p)."""
    r, rd, rdd = (vectors[..., k, :] for vectors in path)
    return Relative(r, rd, rdd, R[..., k, :, :], w[..., k, :], alpha[..., k, :])


@record
class HeldPoints:
    """Points of a body in the coordinates that conditions leave."""

    free: StrainedPoints | PolynomialPoints
    conditions: Conditions

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        """Motions of the points relative to the root."""
        return self.free.relative(*self.conditions.motion(q, qd, qdd))

    def places_of(self, q: Array) -> Array:
        """Places (..., p, 3) m in the root's axes, by coordinates (..., n)."""
        return self.free.places_of(self.conditions.lifted(q))

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        """Generalised forces (..., n) of wrenches that act at the points."""
        coordinates = self.conditions.lifted(q)
        return self.conditions.projected(coordinates, self.free.generalised_forces(coordinates, wrenches))


Points = StrainedPoints | PolynomialPoints | HeldPoints


@record
class DeformingBody:
    """A body with coordinates: its equations on any root, and its points."""

    equations: Complete | HeldComplete | Moments
    points: Points

    @property
    def size(self) -> int:
        return self.equations.size

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        return self.points.relative(q, qd, qdd)

    def places_of(self, q: Array) -> Array:
        return self.points.places_of(q)

    def demanded(self, q: Array, qd: Array, qdd: Array, root: Frame, loads: Array | None) -> tuple[Array, Wrench]:
        generalised, *wrench = self.equations.demanded(q, qd, qdd, root.a, root.w, root.alpha, loads)
        return generalised, Wrench(*wrench)

    def contracted(self, carrier: Roots, root: Roots) -> DeformingBody:
        """Contract its equations by the motion of its `carrier`, which determines that of its `root`.

        The body itself is returned where that is in doubt, or would not be faster.
        """
        reach = carrier.reach(root) if self.size else None
        equations = self.equations if reach is None else self.equations.contracted(reach)
        return self if equations is self.equations else replace(self, equations=equations)

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        return self.points.generalised_forces(q, wrenches)

    def stored(self, q: Array) -> Array:
        return self.equations.strain_energy(q)

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        return self.equations.mass_moment(q)

    def elastic(self, q: Array) -> Array:
        return self.equations.elastic(q)


def moments_of(body: Body) -> Moments | None:
    """Equations of a body by its moments of mass, or None where it has others."""
    equations = body.equations if isinstance(body, DeformingBody) else None
    return equations if isinstance(equations, Moments) else None


def momentum(body: Body, q: Array, qd: Array, root: Frame) -> tuple[Array, Wrench]:
    """Kinetic energy (...), J, and momentum, N s, and angular momentum, N m s, about the root in its axes.

    The forces that accelerations demand of a body at rest become its momenta when rates take the accelerations' place.
    """
    zero = 0 * root.w
    generalised, wrench = body.demanded(q, 0 * qd, qd, Frame(None, None, None, zero, root.v, root.w), None)
    energy = (wrench.force * root.v + wrench.moment * root.w).sum(axis=-1)
    return (energy + ((generalised - body.elastic(q)) * qd).sum(axis=-1)) / 2, wrench


def _polynomial(first: Array, second: Array, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
    """Value J q + ½ q H q of a polynomial (..., p, 3), with its first and second derivatives with respect to time."""
    xp = namespace(first, q)
    bend, bending = times(second, q), times(second, qd)

    def product(slope: Array, coordinates: Array) -> Array:
        return xp.einsum("...pai,...i->...pa", slope, coordinates)

    slope = first + bend
    return product(first + bend / 2, q), product(slope, qd), product(slope, qdd) + product(bending, qd)


def polynomial_points(sections: Polynomials) -> PolynomialPoints:
    """Points on sections whose places and rotations are polynomials of the coordinates."""
    places = sections.places
    second = namespace(places.first).zeros((*places.first.shape, places.first.shape[-1]))
    return PolynomialPoints(
        places.r0, places.first, second if places.second is None else places.second, *sections.rotation_vectors
    )
