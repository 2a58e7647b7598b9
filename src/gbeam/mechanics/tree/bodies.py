"""Bodies of a tree: each takes the motion of its root and gives that of its points, and takes wrenches on these and
gives the forces on its coordinates and the wrench at its root.

A wrench is what motion demands: Σ m a outboard, less the loads. Forces on coordinates are the rows of the equations.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np

from gbeam.arrays.namespace import Array, is_traced, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.equations.dalembert import Complete
from gbeam.mechanics.equations.held import HeldComplete
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.fields.held import HeldStrainField
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import StrainField
from gbeam.mechanics.fields.taylor import EPSILON, Polynomials
from gbeam.mechanics.fields.vectors import split
from gbeam.mechanics.tree.contraction import Contraction, RigidRows, Roots, contraction, rigid_rows
from gbeam.mechanics.tree.frames import Frame, Relative, Wrench, cross, turned, turned_back
from gbeam.mechanics.tree.steps import component_moments, rotation_by_vector

THIN = 1e-9  # of the largest moment of inertia: less is none


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

    field: StrainField | SeriesField | HeldStrainField

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
        at_root = [(turned(by.R, wrench.force), turned(by.R, wrench.moment)) for _, by, wrench in wrenches]
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
        slope = self.first + _times(self.second, q) / 2
        return self.r0 + namespace(slope, q).einsum("...pai,...i->...pa", slope, q)

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        """Generalised forces (..., n) of wrenches that act at the points."""
        xp = namespace(q, *(acting.wrench.force for acting in wrenches))
        points = np.array([acting.point for acting in wrenches])
        vectors = [(turned(by.R, wrench.force), wrench.moment) for _, by, wrench in wrenches]  # root's, point's axes
        force, moment = (xp.stack(xp.broadcast_arrays(*parts), axis=-2) for parts in zip(*vectors, strict=True))
        slope = self.first[points] + xp.einsum("paij,...j->...pai", self.second[points], q)
        turning = self.turn[points] + xp.einsum("paij,...j->...pai", self.bend[points], q)
        phi = xp.einsum("...pai,...i->...pa", (self.turn[points] + turning) / 2, q)
        on_vector = component_moments(phi, moment)
        return (slope * force[..., None] + turning * on_vector[..., None]).sum(axis=(-3, -2))


def _point(k: int, path: tuple[Array, Array, Array], R: Array, w: Array, alpha: Array) -> Relative:
    """Motion of the point k, by the motions of all (..., p)."""
    r, rd, rdd = (vectors[..., k, :] for vectors in path)
    return Relative(r, rd, rdd, R[..., k, :, :], w[..., k, :], alpha[..., k, :])


Points = StrainedPoints | PolynomialPoints


@record
class FieldBody:
    """A body whose particles follow a complete field: exact, fourth-order or CFOAM."""

    equations: Complete | HeldComplete
    points: Points

    @property
    def size(self) -> int:
        return self.equations.size

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        return self.points.relative(q, qd, qdd)

    def places_of(self, q: Array) -> Array:
        return self.points.places_of(q)

    def demanded(self, q: Array, qd: Array, qdd: Array, root: Frame, loads: Array | None) -> tuple[Array, Wrench]:
        along, *wrench = self.equations.demanded(q, qd, qdd, root.a, root.w, root.alpha, loads)
        return along, Wrench(*wrench)

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        return self.points.generalised_forces(q, wrenches)

    def stored(self, q: Array) -> Array:
        return self.equations.strain_energy(q)

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        inertia = self.equations.inertia
        return inertia.mass.sum(), (inertia.mass[:, None] * inertia.field.positions(q)).sum(axis=-2)

    def elastic(self, q: Array) -> Array:
        return self.equations.elastic(q)


@record
class LinearBody:
    """A body whose energies end at second order in its coordinates: TLAM, FOAM, particles, modes of a mesh.

    Its first and second moments of mass, S = S0 + S1 q + ½ q S2 q and J = J0 + J1 q + ½ q J2 q, and the momentum h_i =
    h0_i + B_ji q_j of its coordinates about the root, are the constant coefficients of its equations on a moving root;
    Lagrange's equations of these energies keep momentum and energy.

    Modes of a solid may carry nearly all of its inertia. Where its root is free to move against such a mode, the
    kinetic energy, cut off at second order, may be negative once the body is bent. `carried` = C0ᵀR0⁻¹C0 prevents that,
    with C q̇ the momentum of deforming and R the inertia of the body about its root: the kinetic energy has
    ½ q̇ᵀ(CᵀR⁻¹C − C0ᵀR0⁻¹C0) q̇ more, which is of third order in q and q̇. It is then that of the rigid motion with all
    momentum and of vibration about it, and positive wherever R is.

    Without `hub_force` the root does not feel the rates of the coordinates: so is SFOAM as printed, 2009 (32), which
    conserves nothing.

    With a `contraction` the wrench at the root has those components alone that the tree asks for.
    """

    coefficients: Coefficients
    points: Points
    carried: Array | None = None
    hub_force: bool = static(default=True)
    contraction: Contraction | None = None

    @property
    def size(self) -> int:
        return self.coefficients.size

    def relative(self, q: Array, qd: Array, qdd: Array) -> list[Relative]:
        return self.points.relative(q, qd, qdd)

    def places_of(self, q: Array) -> Array:
        return self.points.places_of(q)

    def demanded(self, q: Array, qd: Array, qdd: Array, root: Frame, loads: Array | None) -> tuple[Array, Wrench]:
        """Forces on the coordinates (..., n) and wrench at the root that a motion demands, by moments of mass."""
        c = self.coefficients
        if self.contraction is not None:
            return self._contracted(self.contraction, q, qd, qdd, root, loads)
        # Force at the root: d/dt of the momentum m v + ω × S + Ṡ; moment: d/dt of J ω + h, about the moving root.
        S, Si, Sd, J, Ji, h, hi = self._moments(q, qd)
        felt = qd if self.hub_force else 0 * qd  # rates that the root feels
        Sdd = turned(Si, qdd) + turned(_times(c.k_a, felt), qd)
        hd = turned(hi, qdd) + turned(_times(c.k_al, felt), qd)
        force = c.rigid[0] * root.a + cross(root.alpha, S) + Sdd
        force = force + cross(root.w, cross(root.w, S) + 2 * turned(Si, felt))
        swelling = (root.w[..., None, None, :] @ Ji)[..., 0, :]  # ∂(J ω)/∂q
        moment = cross(S, root.a) + turned(J, root.alpha) + turned(swelling, felt) + hd
        moment = moment + cross(root.w, turned(J, root.w) + h)
        along = qdd @ c.mass + qd @ c.damping + c.elastic(q)
        along = along + turned_back(Si, root.a) + turned_back(hi, root.alpha)
        along = along + turned_back(_times(c.gyroscopic, qd) - 0.5 * swelling, root.w)
        if self.carried is not None:  # the mean motion v, ω that has the momentum of deforming, R (v, ω) = (Ṡ, h)
            v, w = _mean_motion(c.rigid[0], S, J, Sd, h)
            swelling = (w[..., None, None, :] @ Ji)[..., 0, :]
            vd, wd = _mean_motion(c.rigid[0], S, J, Sdd - cross(w, Sd), hd - cross(Sd, v) - turned(swelling, qd))
            along = along - qdd @ self.carried + turned_back(Si, vd + cross(v, w)) + turned_back(hi, wd)
            along = along + turned_back(_times(c.gyroscopic, qd) + 0.5 * swelling, w)
        if loads is not None and c.loads is not None:
            forces = c.loads.generalised(q, loads)
            force, moment, along = force - forces[..., :3], moment - forces[..., 3:6], along - forces[..., 6:]
        if not self.hub_force and np.any(qd):
            return along, self.demanded(q, 0 * qd, qdd, root, loads)[1]
        return along, Wrench(force, moment)

    def _contracted(
        self, constants: Contraction, q: Array, qd: Array, qdd: Array, root: Frame, loads: Array | None
    ) -> tuple[Array, Wrench]:
        """Forces and wrench as :meth:`demanded` returns them, computed by contracted constants."""
        c, (along, rows) = self.coefficients, constants.demanded(q, qd, qdd, root.a, root.w, root.alpha)
        if c.bending is not None:
            along = along + c.bending.forces(q)
        if loads is not None and c.loads is not None:
            forces = c.loads.generalised(q, loads)
            along, rows = along - forces[..., 6:], rows - forces[..., :6] @ constants.loads
        wrench = rows @ constants.places
        return along, Wrench(wrench[..., :3], wrench[..., 3:])

    def contracted(self, carrier: Roots, root: Roots) -> LinearBody:
        """Contract the body by the motion of its `carrier`, which determines that of its root.

        The body itself is returned where that is in doubt, or would not be faster.
        """
        reach = None if self.carried is not None or not self.size else carrier.reach(root)
        constants = None if reach is None else contraction(self.coefficients, reach, felt=self.hub_force)
        return self if constants is None else replace(self, contraction=constants)

    def _moments(self, q: Array, qd: Array) -> tuple[Array, ...]:
        """Moments S, ∂S/∂q, Ṡ and J, ∂J/∂q, the angular momentum h = Σ h_i q̇_i, and the h_i, at `q` and `qd`."""
        c = self.coefficients
        Si = -c.f_a + _times(c.k_a, q)
        S = c.rigid[1:4] + turned((Si - c.f_a) / 2, q)
        Ji = 2 * c.f_ww - _times(2 * c.k_ww, q)
        J = c.second_moment + _times(c.f_ww, q) + namespace(Ji, q).einsum("...abi,...i->...ab", Ji, q) / 2
        hi = -c.f_al + _times(c.k_al, q)
        Sd, h = turned(Si, qd), turned(hi, qd)
        return S, Si, Sd, J, Ji, h, hi

    def generalised_forces(self, q: Array, wrenches: list[Acting]) -> Array:
        return self.points.generalised_forces(q, wrenches)

    def stored(self, q: Array) -> Array:
        return ((q @ self.coefficients.stiffness) * q).sum(axis=-1) / 2

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        return self.coefficients.rigid[0], self._moments(q, 0 * q)[0]

    def elastic(self, q: Array) -> Array:
        return self.coefficients.elastic(q)


def momentum(body: Body, q: Array, qd: Array, root: Frame) -> tuple[Array, Wrench]:
    """Kinetic energy (...), J, and momentum, N s, and angular momentum, N m s, about the root in its axes.

    The forces that accelerations demand of a body at rest become its momenta when rates take the accelerations' place.
    """
    still = 0 * root.w
    generalised, wrench = body.demanded(q, 0 * qd, qd, Frame(None, None, None, still, root.v, root.w), None)
    energy = (wrench.force * root.v + wrench.moment * root.w).sum(axis=-1)
    return (energy + ((generalised - body.elastic(q)) * qd).sum(axis=-1)) / 2, wrench


def carried(c: Coefficients) -> Array | None:
    """Inertia (n, n) of the mean rigid motion that has the momentum of deforming, C₀ᵀ R₀⁻¹ C₀ at q = 0.

    None where the particles lie on a line: the rigid body's inertia R₀ is singular there.
    """
    mass, S, J = c.rigid[0], c.rigid[1:4], c.second_moment
    if not is_traced(J):
        least, _, most = np.linalg.eigvalsh(_central_inertia(mass, S, J))
        if not least > THIN * most:
            return None
    v, w = _mean_motion(mass, S, J, c.f_a.T, c.f_al.T)
    return c.f_a.T @ v.T + c.f_al.T @ w.T


def _central_inertia(mass: Array, S: Array, J: Array) -> Array:
    """Moments of inertia (..., 3, 3) about the centre of mass, by the first moment S and J about the root."""
    square = (S * S).sum(axis=-1)[..., None, None] * np.eye(3)
    return J - (square - S[..., :, None] * S[..., None, :]) / mass


def _mean_motion(mass: Array, S: Array, J: Array, push: Array, spin: Array) -> tuple[Array, Array]:
    """Velocity and angular velocity (..., 3) at its root of a rigid body with a given momentum.

    The body has `mass` and, about the root, the moments S and J. `push` is its momentum, `spin` the angular momentum
    about the root.
    """
    centre, inertia = S / mass, _central_inertia(mass, S, J)
    x, y, z = (inertia[..., k, :] for k in range(3))  # rows; the inverse is by their vector products
    at_centre, yz = spin - cross(centre, push), cross(y, z)
    w = at_centre[..., :1] * yz + at_centre[..., 1:2] * cross(z, x) + at_centre[..., 2:] * cross(x, y)
    w = w / (x * yz).sum(axis=-1, keepdims=True)
    return push / mass - cross(w, centre), w


def _times(tensor: Array, q: Array) -> Array:
    """T_{...ij} q_j of a constant tensor, (..., its first axes, i)."""
    flat = q @ tensor.reshape(math.prod(tensor.shape[:-1]), tensor.shape[-1]).T  # -1 would fail without coordinates
    return flat.reshape(*q.shape[:-1], *tensor.shape[:-1])


def _polynomial(first: Array, second: Array, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
    """Value J q + ½ q H q of a polynomial (..., p, 3), with its first and second derivatives with respect to time."""
    xp = namespace(first, q)
    bend, bending = _times(second, q), _times(second, qd)

    def product(slope: Array, coordinates: Array) -> Array:
        return xp.einsum("...pai,...i->...pa", slope, coordinates)

    slope = first + bend
    return product(first + bend / 2, q), product(slope, qd), product(slope, qdd) + product(bending, qd)


def polynomial_points(sections: Polynomials) -> PolynomialPoints:
    """Points on sections whose places and rotations are polynomials of the coordinates."""
    places, turns = sections.places, sections.turns
    vectors = (
        -0.5 * namespace(part).einsum("abc,pbc...->pa...", EPSILON, part) for part in (turns.first, turns.second)
    )
    second = namespace(places.first).zeros((*places.first.shape, places.first.shape[-1]))
    return PolynomialPoints(places.r0, places.first, second if places.second is None else places.second, *vectors)
