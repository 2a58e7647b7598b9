"""Sums over the elements of solids and shells: mass, stiffness, stress, and what static stress adds to stiffness."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.numerics.sparse import add_to_rows
from gbeam.solids.shape_functions import KINDS, jacobians, shape_functions
from gbeam.solids.shells import FACTOR, shell_strains

CHUNK = 2**14  # points of elements at once: a quarter of a gigabyte with thirty coordinates
FEW = 2**9  # likewise, where all that is of them is to stay in a core's memory
NEAR = 1.5  # ratio of two frequencies

# Strains xx, yy, zz, yz, xz, xy, with twice the tensor's shear, of the gradients [displacement, along].
STRAIN = np.zeros((6, 3, 3))
for _row, _pairs in enumerate(([(0, 0)], [(1, 1)], [(2, 2)], [(1, 2), (2, 1)], [(0, 2), (2, 0)], [(0, 1), (1, 0)])):
    for _pair in _pairs:
        STRAIN[_row][_pair] = 1.0
TENSOR = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # place of each component of stress


@dataclass(frozen=True, eq=False)
class Block(Value):
    """Elements of one kind and one material: nodes (e, k), their numbers (e,) in the file, the material's name, and its
    strain `expansion` (3, 3) by a kelvin, zero where the mesh has no temperature.
    """

    kind: str
    nodes: Indices
    numbers: Indices
    material: str
    density: float
    elasticity: Floats
    expansion: Floats


class Part(NamedTuple):
    """Elements of a block at the q points of a rule: nodes (e, k), volumes (e, q), gradients (e, q, k, 3) of the shape
    functions, elasticity (..., 6, 6), and displacements (e, k, 3) by a kelvin of nodes that are free to expand.

    Shells have strains (e, q, 6, k, 3) `assumed` per displacement, in place of those of the gradients.
    """

    block: Block
    nodes: Indices
    volume: Floats
    gradients: Floats
    assumed: Floats | None
    elasticity: Floats
    expanded: Floats

    def hindered(self, u: Floats, rise: Floats | None) -> Floats:
        """Displacements (e, k, 3, m) of the elements' nodes beyond free expansion, by those (k, 3, m) of all nodes."""
        moved = u[self.nodes]
        return moved if rise is None else moved - np.multiply.outer(self.expanded, rise)

    def slopes(self, u: Floats, rise: Floats | None = None) -> Floats:
        """Slopes (e, q, 3, 3, m) of displacements (k, 3, m) of all nodes: the axis along which, then the component.

        Those of free expansion by a `rise` (m,) of the temperature, K, are left out of them.
        """
        (e, q, k, _), m = self.gradients.shape, u.shape[-1]
        along = self.gradients.swapaxes(2, 3).reshape(e, 3 * q, k)
        return (along @ self.hindered(u, rise).reshape(e, k, 3 * m)).reshape(e, q, 3, 3, m)

    def stress(self, u: Floats, slopes: Floats | None = None, rise: Floats | None = None) -> Floats:
        """Stresses (e, q, 6, m) under displacements (k, 3, m) of all nodes, whose `slopes` may be known, and under a
        `rise` (m,) of the temperature, K.
        """
        if self.assumed is not None:
            e, q, _, k, _ = self.assumed.shape
            moved = self.hindered(u, rise).reshape(e, 3 * k, u.shape[-1])
            strained = self.assumed.reshape(e, q * 6, 3 * k) @ moved
            return np.asarray(self.elasticity @ strained.reshape(e, q, 6, u.shape[-1]))
        slopes = self.slopes(u, rise) if slopes is None else slopes
        law = (self.elasticity @ STRAIN.reshape(6, 9)).reshape(6, 3, 3).swapaxes(1, 2).reshape(6, 9)  # of slopes
        return np.asarray(law @ slopes.reshape(*slopes.shape[:2], 9, slopes.shape[-1]))


def determinants(points: Floats, block: Block) -> Floats:
    """Determinants (e, q) of the maps from the reference element, at the points of the rule of mass."""
    slopes = shape_functions(block.kind, KINDS[block.kind].mass)[-1]
    return np.linalg.det(jacobians(points, block.nodes, slopes))


def masses(points: Floats, block: Block) -> Floats:
    """Masses (e, q) of elements at the points of the rule of mass."""
    weights = shape_functions(block.kind, KINDS[block.kind].mass)[1]
    return block.density * weights * determinants(points, block)


def chunks(points: Floats, blocks: Sequence[Block], degree: str, most: int = CHUNK) -> Iterator[Part]:
    """Yield all elements in parts of at most `most` points of the rule for a `degree`, "stiffness" or "stress".

    For stress, shells have no transverse shear, which vanishes on their faces.
    """
    for block in blocks:
        rule = getattr(KINDS[block.kind], degree)
        _, weights, _, slopes = shape_functions(block.kind, rule)
        step = max(1, most // len(weights))
        for start in range(0, len(block.nodes), step):
            nodes, elasticity, assumed = block.nodes[start : start + step], block.elasticity, None
            base = jacobians(points, nodes, slopes)
            gradients = np.einsum("qkc,eqcd->eqkd", slopes, np.linalg.inv(base), optimize=True)
            if KINDS[block.kind].shell:
                shear = np.sqrt(FACTOR) if degree == "stiffness" else 0.0
                assumed, elasticity = shell_strains(points, nodes, block.kind, elasticity, rule, shear)
            volume, expanded = np.linalg.det(base) * weights, points[nodes] @ block.expansion
            yield Part(block, nodes, volume, gradients, assumed, elasticity, expanded)


def _assembled(size: int, blocks: Sequence[Block], width: int, parts: Iterable[Floats]) -> Any:
    """Assemble the matrices of elements into a sparse one, for `size` nodes of `width` unknowns each.

    The parts, in the order of the blocks, have a matrix (width, width) for each pair of an element's nodes.
    """
    from scipy.sparse import bsr_array, csr_array

    pairs = np.concatenate([(size * block.nodes[:, :, None] + block.nodes[:, None]).ravel() for block in blocks])
    order = np.argsort(pairs, kind="stable")
    pairs = pairs[order]
    first = np.flatnonzero(np.diff(pairs, prepend=-1))
    entries, start = np.empty((len(order), width**2)), 0
    for part in parts:
        flat = part.reshape(-1, width**2)
        entries[start : start + len(flat)] = flat
        start += len(flat)
    # A row of ones over the entries of each pair sums them.
    summing = csr_array((np.ones(len(order)), order, np.append(first, len(order))), shape=(len(first), len(order)))
    total = summing @ entries
    rows = np.searchsorted(pairs[first], size * np.arange(size + 1))
    matrix = bsr_array((total.reshape(-1, width, width), pairs[first] % size, rows), shape=(width * size,) * 2)
    return matrix.tocsr()


def stiffness_matrix(points: Floats, blocks: Sequence[Block]) -> Any:
    """Elastic stiffness (3 k, 3 k), with the three displacements of each node in turn."""

    def parts() -> Iterator[Floats]:
        """Yield the matrices (3, 3) of all pairs of an element's nodes, part by part."""
        for part in chunks(points, blocks, "stiffness"):
            e, q, k, _ = part.gradients.shape
            if part.assumed is not None:
                strain = part.assumed.reshape(e, q, 6, 3 * k)
                stress = (part.elasticity @ strain * part.volume[..., None, None]).reshape(e, q * 6, 3 * k)
                matrices = strain.reshape(e, q * 6, 3 * k).swapaxes(1, 2) @ stress
                yield matrices.reshape(e, k, 3, k, 3).swapaxes(2, 3)
                continue
            flat = part.gradients.reshape(e, q, 3 * k)
            products = (flat * part.volume[..., None]).swapaxes(1, 2) @ flat
            by_pair = products.reshape(e, k, 3, k, 3).swapaxes(2, 3).reshape(-1, 9)  # of slopes a and b
            # Forces along c by displacements along d: the stress's component ca by the slope of d along b.
            law = np.einsum("vca,vw,wdb->abcd", STRAIN, part.elasticity, STRAIN)
            yield by_pair @ law.reshape(9, 9)

    return _assembled(len(points), blocks, 3, parts())


def mass_matrix(points: Floats, blocks: Sequence[Block]) -> Any:
    """Consistent mass (k, k), which is the same for each component of the displacement."""

    def parts() -> Iterator[Floats]:
        for block in blocks:
            values = shape_functions(block.kind, KINDS[block.kind].mass)[2]
            q, k = values.shape
            yield masses(points, block) @ (values[:, :, None] * values[:, None]).reshape(q, k * k)

    return _assembled(len(points), blocks, 1, parts())


def geometric_stiffness(
    points: Floats,
    blocks: Sequence[Block],
    static: Floats,
    shapes: Floats,
    *,
    rise: float = 0.0,
    strained: bool = True,
) -> Floats:
    """Geometric stiffness, to first order, of static displacements (k, 3, m) in `shapes` (k, 3, n), at a `rise` of the
    temperature, K.

    It has two halves, (2, m, n, n). With Green's strain the first is the static stress in the squares of the shapes'
    slopes, and the second the stress of the shapes in their slopes as the static displacement turns them.
    :func:`coupled` joins them. Unless the body is `strained`, slopes are those of rotations alone: then what stretches
    it evenly, as heat does, adds no stiffness against that stretch.
    """
    m, n = static.shape[-1], shapes.shape[-1]
    stressed, turned = np.zeros((2, m, n, n))
    for part in chunks(points, blocks, "stiffness", FEW):
        weights = part.volume.ravel()[:, None, None, None]
        slopes, moved = part.slopes(shapes), part.slopes(static, rise * np.ones(m))
        shape_stress = part.stress(shapes, slopes).reshape(len(weights), 6, -1)[:, TENSOR] * weights
        static_stress = part.stress(static, moved, rise * np.ones(m)).reshape(len(weights), 6, -1)[:, TENSOR] * weights
        # Arrays of points, axes, components and shapes, flat in all but one of these.
        if not strained:
            slopes, moved = (np.asarray((each - each.swapaxes(2, 3)) / 2) for each in (slopes, moved))
        tall, wide = slopes.reshape(-1, n), slopes.reshape(-1, 3, 3 * n)
        across = np.ascontiguousarray(slopes.swapaxes(2, 3)).reshape(-1, 3, 3 * n)
        # Load by load in one piece each: products of small matrices that lie apart take four times as long.
        pulls = np.moveaxis(static_stress.reshape(-1, 3, 3, m), -1, 0).copy()
        turns = np.moveaxis(moved.reshape(-1, 3, 3, m), -1, 0).copy()
        for load in range(m):
            stressed[load] += tall.T @ (pulls[load] @ wide).reshape(-1, n)
            turned[load] += shape_stress.reshape(-1, n).T @ (turns[load] @ across).reshape(-1, n)
    return np.stack([stressed / 2, turned])


def thermal_forces(points: Floats, blocks: Sequence[Block], swelling: Floats) -> Floats:
    """Forces (3 k,) on the nodes by which a temperature 1 K above the reference strains the mesh, beyond the `swelling`
    (k, 3) of its nodes that it brings: ∫ Bᵀ D (α − B s) dV.
    """
    forces = np.zeros((len(points), 3))
    for part in chunks(points, blocks, "stiffness"):
        stress = -part.stress(swelling[..., None], rise=np.ones(1))[..., 0] * part.volume[..., None]
        if part.assumed is None:
            of_elements = np.einsum("eqkb,eqbc->ekc", part.gradients, stress[..., TENSOR], optimize=True)
        else:
            of_elements = np.einsum("eqvkc,eqv->ekc", part.assumed, stress, optimize=True)
        add_to_rows(forces, part.nodes.ravel(), of_elements.reshape(-1, 3))
    return forces.ravel()


def coupled(halves: Floats, stiffness: Floats) -> Floats:
    """Join the two halves (2, m, n, n) of a geometric stiffness, in coordinates of unit mass with a stiffness (n, n).

    The second half couples soft modes with stiff ones in proportion to the stiff ones' stiffness. That acts to second
    order, where terms of fourth degree, which are left out, would cancel it. So only modes near in frequency are
    coupled.
    """
    squares, modes = np.linalg.eigh(stiffness)
    total = halves[0] + modes @ (modes.T @ halves[1] @ modes * nearby_modes(squares)) @ modes.T
    return np.asarray(total + total.swapaxes(1, 2))


def nearby_modes(squares: Floats) -> Flags:
    """Flags (n, n) of pairs of modes that are near in frequency, from the squares (n,) of the frequencies."""
    return np.maximum.outer(squares, squares) < NEAR**2 * np.minimum.outer(squares, squares)
