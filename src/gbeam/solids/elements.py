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
FEW = 2**9  # likewise, where all that is of them is to stay in a core's memory
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
    points: Floats, blocks: Sequence[Block], degree: str, most: int = CHUNK
) -> Iterator[tuple[Block, slice, Floats, Floats, Floats]]:
    """Parts of all elements: block, which, volumes (e, q), gradients (e, q, k, 3) and shape functions (q, k)."""
    for block in blocks:
        _, weights, values, slopes = shape_functions(block.kind, getattr(KINDS[block.kind], degree))
        step = max(1, most // len(weights))
        for start in range(0, len(block.nodes), step):
            part = slice(start, start + step)
            jacobians = _jacobians(points, block.nodes[part], slopes)
            gradients = np.einsum("qkc,eqcd->eqkd", slopes, np.linalg.inv(jacobians), optimize=True)
            yield block, part, np.linalg.det(jacobians) * weights, gradients, values


def _assembled(size: int, blocks: Sequence[Block], width: int, parts: Iterable[Floats]) -> Any:
    """Sparse matrix of `size` nodes of the matrices of elements, part by part: for each pair of an element's nodes, in
    the order of the blocks, an entry of (width, width).
    """
    from scipy.sparse import bsr_array, csr_array

    pairs = np.concatenate([(size * each.nodes[:, :, None] + each.nodes[:, None]).ravel() for each in blocks])
    order = np.argsort(pairs, kind="stable")
    pairs = pairs[order]
    first = np.flatnonzero(np.diff(pairs, prepend=-1))
    entries, start = np.empty((len(order), width**2)), 0
    for part in parts:
        flat = part.reshape(-1, width**2)
        entries[start : start + len(flat)] = flat
        start += len(flat)
    shape = (len(first), len(order))
    total = csr_array((np.ones(len(order)), order, np.append(first, len(order))), shape=shape) @ entries
    rows = np.searchsorted(pairs[first], size * np.arange(size + 1))
    matrix = bsr_array((total.reshape(-1, width, width), pairs[first] % size, rows), shape=(width * size,) * 2)
    return matrix.tocsr()


def stiffness_matrix(points: Floats, blocks: Sequence[Block]) -> Any:
    """Elastic stiffness (3 k, 3 k), node by node."""

    def parts() -> Iterator[Floats]:
        for block, _, volume, gradients, _ in chunks(points, blocks, "stiffness"):
            e, q, k, _ = gradients.shape
            flat = gradients.reshape(e, q, 3 * k)
            products = (flat * volume[..., None]).swapaxes(1, 2) @ flat
            by_pair = products.reshape(e, k, 3, k, 3).swapaxes(2, 3).reshape(-1, 9)  # of slopes a and b
            # Forces along c by displacements along d: the stress's component ca by the slope of d along b.
            law = np.einsum("vca,vw,wdb->abcd", STRAIN, block.elasticity, STRAIN)
            yield by_pair @ law.reshape(9, 9)

    return _assembled(len(points), blocks, 3, parts())


def mass_matrix(points: Floats, blocks: Sequence[Block]) -> Any:
    """Consistent mass (k, k) of one component of the displacement."""

    def parts() -> Iterator[Floats]:
        for block, _, volume, _, values in chunks(points, blocks, "mass"):
            q, k = values.shape
            yield block.density * volume @ (values[:, :, None] * values[:, None]).reshape(q, k * k)

    return _assembled(len(points), blocks, 1, parts())


def slopes_at(nodes: Indices, gradients: Floats, u: Floats) -> Floats:
    """Slopes (e, q, 3, 3, m) of displacements (k, 3, m) of elements: along an axis, of a component."""
    (e, q, k, _), m = gradients.shape, u.shape[-1]
    along = gradients.swapaxes(2, 3).reshape(e, 3 * q, k)
    return (along @ u[nodes].reshape(e, k, 3 * m)).reshape(e, q, 3, 3, m)


def stress_of(block: Block, slopes: Floats) -> Floats:
    """Stresses (e, q, 6, m) by slopes (e, q, 3, 3, m)."""
    law = (block.elasticity @ STRAIN.reshape(6, 9)).reshape(6, 3, 3).swapaxes(1, 2).reshape(6, 9)
    return np.asarray(law @ slopes.reshape(*slopes.shape[:2], 9, slopes.shape[-1]))


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
    for block, part, volume, gradients, _ in chunks(points, blocks, "stiffness", FEW):
        nodes, weights = block.nodes[part], volume.ravel()[:, None, None, None]
        slopes, moved = (slopes_at(nodes, gradients, each) for each in (shapes, static))
        of_shapes, stress = (
            stress_of(block, each).reshape(len(weights), 6, -1)[:, TENSOR] * weights for each in (slopes, moved)
        )
        tall, wide = slopes.reshape(-1, n), slopes.reshape(-1, 3, 3 * n)
        across = np.ascontiguousarray(slopes.swapaxes(2, 3)).reshape(-1, 3, 3 * n)
        # Load by load in one piece each: products of small matrices that lie apart take four times as long.
        pulls, turns = (np.moveaxis(each.reshape(-1, 3, 3, m), -1, 0).copy() for each in (stress, moved))
        for load in range(m):
            stressed[load] += tall.T @ (pulls[load] @ wide).reshape(-1, n)
            turned[load] += of_shapes.reshape(-1, n).T @ (turns[load] @ across).reshape(-1, n)
    ratio = np.sqrt(np.maximum.outer(squares, squares) / np.minimum.outer(squares, squares))
    total = stressed / 2 + turned * (ratio < NEAR)
    return total + total.swapaxes(1, 2)
