"""Solid elements: their shape functions and quadrature are scikit-fem's, the sums over them stand here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.results.result import Floats

Indices = NDArray[np.intp]
CHUNK = 2**14  # points of elements at once: a quarter of a gigabyte with thirty coordinates
NEAR = 1.5  # ratio of two frequencies

_CORNERS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
_FACES = [[0, 0.5, 0.5], [1, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 1, 0.5], [0.5, 0.5, 0], [0.5, 0.5, 1], [0.5, 0.5, 0.5]]
_HEXAHEDRON = np.array([*_CORNERS, *((np.add(_CORNERS[i], _CORNERS[j]) / 2) for i, j in _EDGES), *_FACES])


@dataclass(frozen=True)
class Kind:
    """Kind of element by meshio's name: scikit-fem's, and the degrees of the quadrature of stiffness, mass and stress;
    the monomials in which stress is extrapolated, by their exponents; the ratio of length to thickness above which a
    layer of one locks in bending: of eight across a clamped plate by 3 % and more (`tests/solids/test_thin.py`).
    """

    element: str
    stiffness: int
    mass: int
    stress: int
    monomials: tuple[tuple[int, int, int], ...]
    linear: bool = False
    long: float = np.inf


_LINEAR = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_TRILINEAR = tuple((i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1))
_WEDGE = tuple((i, j, k) for i, j in ((0, 0), (1, 0), (0, 1)) for k in (0, 1))
KINDS = {
    "tetra": Kind("ElementTetP1", 1, 2, 1, _LINEAR[:1], linear=True),
    "tetra10": Kind("ElementTetP2", 2, 5, 2, _LINEAR, long=6.0),
    "hexahedron": Kind("ElementHex1", 3, 5, 3, _TRILINEAR, linear=True),
    "hexahedron20": Kind("ElementHexS2", 5, 7, 3, _TRILINEAR, long=12.0),
    "hexahedron27": Kind("ElementHex2", 5, 7, 3, _TRILINEAR),
    "wedge": Kind("ElementWedge1", 3, 5, 3, _WEDGE, linear=True),
}
# Strains xx, yy, zz, yz, xz, xy, with twice the tensor's shear, of the gradients [displacement, along].
STRAIN = np.zeros((6, 3, 3))
for _row, _pairs in enumerate(([(0, 0)], [(1, 1)], [(2, 2)], [(1, 2), (2, 1)], [(0, 2), (2, 0)], [(0, 1), (1, 0)])):
    for _pair in _pairs:
        STRAIN[_row][_pair] = 1.0
TENSOR = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # place of each component of stress


@dataclass(frozen=True, eq=False)
class Block(Value):
    """Elements of one kind and one material: nodes (e, k), their numbers (e,) in the file, the material's name."""

    kind: str
    nodes: Indices
    numbers: Indices
    material: str
    density: float
    elasticity: Floats


def import_skfem() -> Any:
    """Import scikit-fem; an InputError says how to install it where it is not."""
    try:
        import skfem
    except ModuleNotFoundError:
        raise InputError("", "scikit-fem is not installed", 'install it with: pip install "gbeam[mesh]"') from None
    return skfem


@cache
def shape_functions(kind: str, degree: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Points (q, 3), weights (q,), shape functions (q, k) and their derivatives (q, k, 3) at a rule of some degree, in
    meshio's order of the nodes.
    """
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefLine, RefTri

    element = getattr(import_skfem(), KINDS[kind].element)()
    if kind == "wedge":  # scikit-fem 12's rule has the triangle across another axis, and half the weights
        (flat, over), (line, along) = get_quadrature(RefTri, degree), get_quadrature(RefLine, degree)
        points = np.concatenate([np.repeat(flat, len(along), axis=1), np.tile(line, len(over))])
        weights = np.outer(over, along).ravel()
    else:
        points, weights = get_quadrature(element.refdom, degree)
    pairs = [element.lbasis(points, i) for i in _order(kind)]
    values = np.stack([np.broadcast_to(value, points.shape[1]) for value, _ in pairs], axis=1)
    slopes = [np.stack([np.broadcast_to(each, points.shape[1]) for each in slope], axis=1) for _, slope in pairs]
    return points.T, weights, values, np.stack(slopes, axis=1)


@cache
def extrapolation(kind: str) -> Floats:
    """Values at the nodes of a polynomial by those at the points of stress, (k, q)."""
    points = shape_functions(kind, KINDS[kind].stress)[0]
    powers = np.array(KINDS[kind].monomials)

    def monomials(at: Floats) -> Floats:
        return np.prod(at[:, None, :] ** powers, axis=-1)

    return monomials(reference(kind)) @ np.linalg.pinv(monomials(points))


def reference(kind: str) -> Floats:
    """Places of the nodes in the reference element, (k, 3), in meshio's order."""
    places = np.array(getattr(import_skfem(), KINDS[kind].element).doflocs)
    return _HEXAHEDRON[: len(places)] if kind.startswith("hexahedron") else places


@cache
def _order(kind: str) -> tuple[int, ...]:
    """Numbers in scikit-fem of an element's nodes."""
    theirs = np.array(getattr(import_skfem(), KINDS[kind].element).doflocs)
    apart = np.abs(reference(kind)[:, None] - theirs).max(axis=-1)
    return tuple(int(i) for i in apart.argmin(axis=1))


def _jacobians(points: Floats, nodes: Indices, slopes: Floats) -> Floats:
    """Derivatives (e, q, 3, 3) of places by those in the reference, of shape functions' derivatives (q, k, 3)."""
    return np.einsum("ekd,qkc->eqdc", points[nodes], slopes, optimize=True)


def determinants(points: Floats, nodes: Indices, slopes: Floats) -> Floats:
    """Determinants (e, q) of elements' maps from the reference."""
    return np.linalg.det(_jacobians(points, nodes, slopes))


def chunks(
    points: Floats, blocks: Sequence[Block], degree: str
) -> Iterator[tuple[Block, slice, Floats, Floats, Floats]]:
    """Parts of all elements: block, which, volumes (e, q), gradients (e, q, k, 3) and shape functions (q, k)."""
    for block in blocks:
        _, weights, values, slopes = shape_functions(block.kind, getattr(KINDS[block.kind], degree))
        step = max(1, CHUNK // len(weights))
        for start in range(0, len(block.nodes), step):
            part = slice(start, start + step)
            jacobians = _jacobians(points, block.nodes[part], slopes)
            gradients = np.einsum("qkc,eqcd->eqkd", slopes, np.linalg.inv(jacobians), optimize=True)
            yield block, part, np.linalg.det(jacobians) * weights, gradients, values


def _assembled(size: int, parts: Iterable[tuple[Indices, Floats]]) -> Any:
    """Sparse matrix of elements' unknowns (e, k) and matrices (e, k, k), part by part."""
    from scipy.sparse import coo_array

    summed = []
    for unknowns, matrices in parts:
        k = unknowns.shape[1]
        places = np.repeat(unknowns, k, axis=1).ravel(), np.tile(unknowns, (1, k)).ravel()
        summed.append(coo_array((matrices.ravel(), places), shape=(size, size)).tocsr().tocoo())
    values = np.concatenate([each.data for each in summed])
    rows, columns = (np.concatenate([each.coords[axis] for each in summed]) for axis in (0, 1))
    del summed
    return coo_array((values, (rows, columns)), shape=(size, size)).tocsr()


def stiffness_matrix(points: Floats, blocks: Sequence[Block]) -> Any:
    """Elastic stiffness (3 k, 3 k), node by node."""

    def parts() -> Iterator[tuple[Indices, Floats]]:
        for block, part, volume, gradients, _ in chunks(points, blocks, "stiffness"):
            e, q, k, _ = gradients.shape
            strain = np.einsum("vcd,eqkd->eqvkc", STRAIN, gradients, optimize=True).reshape(e, q, 6, 3 * k)
            stress = np.matmul(block.elasticity, strain) * volume[..., None, None]
            matrices = strain.reshape(e, q * 6, -1).swapaxes(1, 2) @ stress.reshape(e, q * 6, -1)
            yield (3 * block.nodes[part][..., None] + np.arange(3)).reshape(e, -1), matrices

    return _assembled(3 * len(points), parts())


def mass_matrix(points: Floats, blocks: Sequence[Block]) -> Any:
    """Consistent mass (k, k) of one component of the displacement."""
    return _assembled(
        len(points),
        (
            (block.nodes[part], np.einsum("eq,qi,qj->eij", block.density * volume, values, values, optimize=True))
            for block, part, volume, _, values in chunks(points, blocks, "mass")
        ),
    )


def stress_at(block: Block, nodes: Indices, gradients: Floats, u: Floats) -> Floats:
    """Stresses (e, q, 6, m) of elements under displacements (k, 3, m)."""
    moved = np.einsum("eqkd,ekcm->eqcdm", gradients, u[nodes], optimize=True)
    return np.einsum("vw,wcd,eqcdm->eqvm", block.elasticity, STRAIN, moved, optimize=True)


def geometric_stiffness(
    points: Floats, blocks: Sequence[Block], static: Floats, shapes: Floats, squares: Floats
) -> Floats:
    """Stiffness (m, n, n) that static displacements (k, 3, m) add in `shapes` (k, 3, n), to first order: with Green's
    strain, the static stress in the squares of the slopes, and the stress of the shapes in their slopes as they turn.

    `squares` (n,) are those of the shapes' frequencies. The second part couples soft coordinates with stiff ones by a
    multiple of the stiff ones' stiffness. The square of that, which terms of fourth degree would take away again, is of
    second order: of it only near coordinates are coupled.
    """
    m, n = static.shape[-1], shapes.shape[-1]
    stressed, turned = np.zeros((2, m, n, n))
    for block, part, volume, gradients, _ in chunks(points, blocks, "stiffness"):
        nodes = block.nodes[part]
        weights = volume[..., None, None, None]
        stress = stress_at(block, nodes, gradients, static)[:, :, TENSOR] * weights
        of_shapes = (stress_at(block, nodes, gradients, shapes)[:, :, TENSOR] * weights).reshape(-1, n)
        slopes = np.einsum("eqkd,ekcn->eqdcn", gradients, shapes[nodes], optimize=True)
        moved = np.einsum("eqkd,ekcm->eqdcm", gradients, static[nodes], optimize=True)
        flat, wide = slopes.reshape(-1, n), slopes.swapaxes(2, 3).reshape(*slopes.shape[:2], 3, -1)
        for load in range(m):
            pulled = np.matmul(stress[..., load], slopes.reshape(*slopes.shape[:3], -1))
            stressed[load] += flat.T @ pulled.reshape(-1, n)
            turned[load] += of_shapes.T @ np.matmul(moved[..., load], wide).reshape(-1, n)
    ratio = np.sqrt(np.maximum.outer(squares, squares) / np.minimum.outer(squares, squares))
    total = stressed / 2 + turned * (ratio < NEAR)
    return total + total.swapaxes(1, 2)
