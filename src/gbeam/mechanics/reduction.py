"""A large linear structure in a few coordinates: its lowest modes, and its static answers to unit inertial loads.

A field of displacement that is linear in the coordinates has an inertia that needs only the products of 1, x, y, z and
the shapes. Particles of equal mass that have the same products stand for the mass matrix, however large it was.
D'Alembert's sum over them is that over the mesh, to the last digits. Its cost does not depend on the mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.mechanics.equations.linear import Bending
from gbeam.mechanics.structure import Structure
from gbeam.numerics.sparse import HOLD, factorised, lowest_modes

_UNIT, _SPINS = np.eye(3), [*np.eye(3), (0, 1, 1), (1, 0, 1), (1, 1, 0)]
# Motions of a base as factors (12, 12) of unit loads: accelerations, angular accelerations, and spins.
MOTIONS = np.stack(
    [np.pad(axis[:, None], ((0, 0), (0, 3))).ravel() for axis in _UNIT]
    + [np.pad(np.cross(axis, _UNIT).T, ((0, 0), (1, 0))).ravel() for axis in _UNIT]
    + [np.pad(np.outer(w, w) - np.dot(w, w) * _UNIT, ((0, 0), (1, 0))).ravel() for w in _SPINS],
    axis=1,
)

Solve = Callable[[Floats], Floats]
BendingOf = Callable[[Floats, Floats, Solve], Bending]
NEGATIVE = 1e-6  # of the largest: a mass that is less than none, and no rounding
ZERO = 1e-10  # of the largest of the eigenvalues computed: a smaller one is that of a motion without strain
ALIKE = 1e-9  # of its energy: what is left of a static answer beside the modes and the others adds nothing
FAINTLY = 1e-3  # of its energy: as much of a static answer is left out with what moves next to no mass
MORE = 6  # modes besides, by which the error of those left out is judged
WIDTH = 8  # random vectors with which the search for modes begins: as many equal frequencies are told apart
FAINT = 1e-14  # of the largest: a product of shapes that is rounding


@dataclass(frozen=True, eq=False)
class Reduced:
    """Shapes (u, n) of unit modal mass, their stiffness (n, n), and static displacements (u, m) under the loads. The
    first `size` shapes, ascending in frequency, are a model's coordinates: they span `modes` modes and the static
    displacements. The others are what a few more modes have beside these, by which their error is judged, as it is by
    the forces of `bending`, where these are known. Static displacements `apart` (u, k) are in no shape.
    """

    shapes: Floats
    stiffness: Floats
    static: Floats
    apart: Floats
    modes: int
    size: int
    bending: Bending | None = None

    def structure(self, build: Callable[[int, Any], Structure], damping_ratio: Any) -> Structure:
        """Build a structure in the first `size` coordinates, whose `richer` is one in all coordinates.

        A list of damping ratios that ends at the modes, or at these coordinates, is continued with its last value.
        """

        def ratios(n: int) -> Any:
            count = np.ndim(damping_ratio) and len(damping_ratio)
            if count in (self.modes, self.size):
                return [*damping_ratio, *[damping_ratio[-1]] * (n - count)]
            return damping_ratio

        structure = build(self.size, ratios(self.size))  # first: it refuses a list that fits it no better
        total = len(self.stiffness)
        richer = replace(build(total, ratios(total)), bending=self.bending)
        return replace(structure, richer=richer)


def linear_fields(points: Floats) -> Floats:
    """Columns 1, x, y and z (k, 4) of points (k, 3)."""
    return np.concatenate([np.ones((len(points), 1)), points], axis=1)


def inertial_loads(weights: Floats) -> Floats:
    """Loads (3 k, 12) on nodes by body forces −1, −x, −y and −z along x, then along y, then along z. `weights` (k, 4)
    are the products of the mass matrix with 1, x, y and z.
    """
    return -np.einsum("kf,ac->kcaf", weights, np.eye(3)).reshape(3 * len(weights), 12)


def reduce(
    stiffness: Any,
    mass: Any,
    loads: Floats,
    modes: int,
    bending: BendingOf | None = None,
    apart: Floats | None = None,
) -> Reduced:
    """Reduce matrices (u, u) of the free unknowns to lowest modes and static displacements under `loads` (u, m).

    `bending` returns the forces of higher order from shapes (u, n), their stiffness (n, n), and a function that answers
    loads (u, m). Loads `apart` (u, k) are answered alone. InputError unless there are so many modes, and stiffness and
    mass are positive.
    """
    count, extra = len(loads), min(MORE, len(loads) - modes)
    if not 1 <= modes <= count:
        raise InputError("modes", f"is {modes}, of {count} unknowns", f"give 1 to {count}")
    with factorised(stiffness) as solve:
        static = solve(loads)
        if modes + extra > count // 2:  # the space of Lanczos' iteration would be all
            inverse_eigenvalues, vectors = _dense(stiffness.toarray(), mass.toarray())
        else:
            start_vectors = np.random.default_rng(0).standard_normal((count, WIDTH))
            inverse_eigenvalues, vectors = lowest_modes(solve, mass, start_vectors, modes, extra)
        reduced = _reduced(stiffness, mass, static, modes, extra, inverse_eigenvalues, vectors)
        if apart is not None and apart.size:
            reduced = replace(reduced, apart=solve(apart))
        if bending is None:
            return reduced
        return replace(reduced, bending=bending(reduced.shapes, reduced.stiffness, solve))


def _reduced(
    stiffness: Any, mass: Any, static: Floats, modes: int, more: int, inverse: Floats, vector: Floats
) -> Reduced:
    """Reduce matrices (u, u) to the first `modes` of the modes `vector` (u, k) and to static displacements (u, m).

    `inverse` (k,) are the modes' inverse eigenvalues. The next `more` modes are added behind, to judge the error.
    """
    moving_count = _count_massive(inverse)
    if not inverse[:modes].min() > -ZERO * inverse.max():
        raise InputError("stiffness", "is not positive definite", HOLD)
    if moving_count < modes:
        raise InputError(
            "modes", f"is {modes}, and only {moving_count} motions move mass", f"give at most {moving_count}"
        )
    vector, extra_vectors = vector[:, :modes], vector[:, modes : min(moving_count, modes + more)]
    basis = np.concatenate([vector, _complement(stiffness, mass, vector, static)], axis=1)
    inverse, in_basis = _dense(basis.T @ (stiffness @ basis), basis.T @ (mass @ basis))
    if inverse.min() < -NEGATIVE * inverse.max():
        raise InputError("mass", "is not positive definite", "is it the right matrix?")
    heavy = _count_massive(inverse)
    light = basis @ in_basis[:, heavy:]  # of unit stiffness
    by_motions, by_loads = (
        (_shares(stiffness, light, answers) > FAINTLY).any() for answers in (static[:, :12] @ MOTIONS, static[:, 12:])
    )
    if by_loads:
        problem = "leaves a static answer without mass, or with next to none beside the heaviest"
        fix = "give the nodes of interfaces mass in every direction, and inertia where they turn, or carry less"
        raise InputError("mass", problem, fix)
    if by_motions:
        problem = "is next to none in a static answer to the base's motion, beside that of the lowest mode"
        fix = "mesh a thin sheet by its middle surface, as a shell with its thickness, or carry less"
        raise InputError("mass", problem, fix)
    inverse, shapes = inverse[:heavy], basis @ in_basis[:, :heavy]
    size = shapes.shape[1]
    extra_vectors = _complement(stiffness, mass, shapes, extra_vectors)
    if extra_vectors.size:
        extra_vectors = (
            extra_vectors
            @ _dense(extra_vectors.T @ (stiffness @ extra_vectors), extra_vectors.T @ (mass @ extra_vectors))[1]
        )
        shapes = np.concatenate([shapes, extra_vectors], axis=1)
    reduced = shapes.T @ (stiffness @ shapes)
    reduced[:size, :size] = np.diag(1 / inverse)
    return Reduced(shapes, reduced, static, static[:, :0], modes, size)


def _dense(stiffness: Floats, mass: Floats) -> tuple[Floats, Floats]:
    """Inverse eigenvalues 1/ω², s², descending, and modes of unit modal mass.

    Modes that move no mass have eigenvalues of about zero. They are scaled to unit modal stiffness.
    """
    from scipy.linalg import eigh

    try:
        inverse, vector = eigh(mass, stiffness)
    except np.linalg.LinAlgError:
        raise InputError("stiffness", "is not positive definite", HOLD) from None
    return inverse[::-1], (vector / np.sqrt(np.where(inverse > ZERO * inverse[-1], inverse, 1.0)))[:, ::-1]


def _count_massive(inverse: Floats) -> int:
    """Number of motions that move mass, by inverse eigenvalues in descending order."""
    return int((inverse > ZERO * inverse[0]).sum())


def _shares(stiffness: Any, shapes: Floats, static: Floats) -> Floats:
    """Shares (n, m) of the strain energy of static answers (u, m) that shapes (u, n) of unit stiffness have."""
    forces = stiffness @ static
    energy = np.einsum("ij,ij->j", static, forces)
    return np.square(shapes.T @ forces) / np.where(energy > 0, energy, np.inf)


def _complement(stiffness: Any, mass: Any, modes: Floats, static: Floats) -> Floats:
    """Vectors (u, l), orthonormal in energy, that span static answers (u, m) without their parts in modes (u, k)."""
    energy = np.einsum("ij,ij->j", static, stiffness @ static)
    residual = static[:, energy > 0] / np.sqrt(energy[energy > 0])
    for _ in range(2):  # the second time removes what rounding left
        residual = residual - modes @ (modes.T @ (mass @ residual))
    value, vector = np.linalg.eigh(residual.T @ (stiffness @ residual))
    independent = value > ALIKE
    return residual @ (vector[:, independent] / np.sqrt(value[independent]))


def particles_of(points: Floats, shapes: Floats, mass: Any) -> tuple[Floats, Floats, Floats]:
    """Masses (p,), places (p, 3) and derivatives (p, 3, n) of particles with the products of places (k, 3) and shapes
    (k, 3, n) in a mass matrix (k, k) of one component.
    """
    functions = np.concatenate([linear_fields(points), shapes.reshape(len(points), -1)], axis=1)
    return _particles(functions.T @ (mass @ functions), shapes.shape[-1])


def equivalent_particles(body: Floats, sums: Floats, moments: Floats) -> tuple[Floats, Floats, Floats]:
    """Few particles, as :func:`particles_of` returns them, that have the same inertia as a body with many.

    They have the mass, first and second moments of the `body` (10,), and its `sums` Σ m ∂r_a/∂q (3, n) and `moments` Σ
    m r_b ∂r_a/∂q (3, 3, n). Their shapes are linear in the places.
    """
    total, (x, y, z), (xx, yy, zz, xy, yz, zx) = body[0], body[1:4], body[4:]
    places = np.array([[total, x, y, z], [x, xx, xy, zx], [y, xy, yy, yz], [z, zx, yz, zz]])
    moment_matrix = np.concatenate([sums[None], moments.swapaxes(0, 1)]).reshape(4, -1)
    shapes = moment_matrix.T @ np.linalg.pinv(places, rcond=FAINT, hermitian=True) @ moment_matrix
    return _particles(np.block([[places, moment_matrix], [moment_matrix.T, shapes]]), sums.shape[-1])


def _particles(products: Floats, n: int) -> tuple[Floats, Floats, Floats]:
    """Masses, places and derivatives of particles by the products Σ m a b (4 + 3 n, 4 + 3 n) of 1, x, y, z and shapes.

    The products' eigenvectors give one particle for each eigenvalue that is not rounding.
    """
    total = products[0, 0]
    size = np.sqrt(np.diagonal(products) / total)
    scale = np.where(size > 0, size, 1.0)
    value, vector = np.linalg.eigh(products / np.outer(scale, scale) / total)
    is_large = value > FAINT * value[-1]
    root = vector[:, is_large] * np.sqrt(value[is_large])
    # A reflection after which all particles have the same share of the mass.
    shares, equal = root[0] / np.linalg.norm(root[0]), np.full(is_large.sum(), 1 / np.sqrt(is_large.sum()))
    normal = shares - equal
    if normal.any():
        root = root - 2 * np.outer(root @ normal, normal) / (normal @ normal)
    values = (scale[:, None] * root * np.sqrt(is_large.sum())).T
    return np.full(len(values), total / len(values)), values[:, 1:4], values[:, 4:].reshape(-1, 3, n)
