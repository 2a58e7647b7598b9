"""Kinds of elements, with the shape functions and the quadrature of scikit-fem, in meshio's order of the nodes.

An element of a shell has that of its middle surface on two faces: its nodes are the corners of the lower face, those of
the upper one, and then the middles of their edges alike; between the faces it is linear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices

ACROSS = 3  # degree of the quadrature through the thickness of a shell

_CORNERS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
_FACES = [[0, 0.5, 0.5], [1, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 1, 0.5], [0.5, 0.5, 0], [0.5, 0.5, 1], [0.5, 0.5, 0.5]]
_HEXAHEDRON = np.array([*_CORNERS, *((np.add(_CORNERS[i], _CORNERS[j]) / 2) for i, j in _EDGES), *_FACES])


@dataclass(frozen=True)
class Kind:
    """Kind of element by meshio's name: scikit-fem's name, and the degrees of the quadrature of stiffness, mass and
    stress.

    `monomials` are those in which stress is extrapolated, by their exponents. `long` is the ratio of length to
    thickness above which a layer of one locks in bending: of eight across a clamped plate by 3 % and more
    (`tests/solids/test_thin.py`). `shell` is the number of its corners in a shell's surface, `along` the degree of the
    quadrature along a wedge where that is another one.
    """

    element: str
    stiffness: int
    mass: int
    stress: int
    monomials: tuple[tuple[int, int, int], ...]
    linear: bool = False
    long: float = np.inf
    shell: int = 0
    along: int = 0


_LINEAR = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_TRILINEAR = tuple((i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1))
_WEDGE = tuple((i, j, k) for i, j in ((0, 0), (1, 0), (0, 1)) for k in (0, 1))
# The serendipity wedge of 15 nodes, which scikit-fem has not: its monomials, its corners and middles of edges.
_WEDGE15 = (*_WEDGE, *((i, 2 - i, k) for i in (0, 1, 2) for k in (0, 1)), (0, 0, 2), (1, 0, 2), (0, 1, 2))
_UPRIGHT = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (0, 1))])
_SIDES = np.array([(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)])
_NODES = {"wedge15": np.concatenate([_UPRIGHT, _UPRIGHT[_SIDES].mean(axis=1)])}
KINDS = {
    "tetra": Kind("ElementTetP1", 1, 2, 1, _LINEAR[:1], linear=True),
    "tetra10": Kind("ElementTetP2", 2, 5, 2, _LINEAR, long=6.0),
    "hexahedron": Kind("ElementHex1", 3, 5, 3, _TRILINEAR, linear=True),
    "hexahedron20": Kind("ElementHexS2", 5, 7, 3, _TRILINEAR, long=12.0),
    "hexahedron27": Kind("ElementHex2", 5, 7, 3, _TRILINEAR),
    "wedge": Kind("ElementWedge1", 3, 5, 3, _WEDGE, linear=True),
    "wedge15": Kind("ElementWedge1", 2, 5, 2, _WEDGE, long=6.0, along=5),
    "triangle": Kind("ElementTriP1", 2, 4, 2, _WEDGE[:2], shell=3),
    "triangle6": Kind("ElementTriP2", 2, 5, 2, _WEDGE, shell=3),
    "quad": Kind("ElementQuad1", 3, 5, 3, _TRILINEAR, shell=4),
    "quad8": Kind("ElementQuadS2", 3, 7, 3, _TRILINEAR, shell=4),
}
# Kinds in files, also those that are not computed, by their dimensions and numbers of nodes.
SHAPES = {
    0: {1: "vertex"},
    1: {2: "line", 3: "line3"},
    2: {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"},
    3: {4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron", 10: "tetra10", 13: "pyramid13", 15: "wedge15",
        20: "hexahedron20", 27: "hexahedron27"},
}  # fmt: skip
DIMENSIONS = {kind: dim for dim, kinds in SHAPES.items() for kind in kinds.values()}
# Nodes in meshio's order, where Nastran, Exodus and Gmsh have another one.
NASTRAN_ORDER = {"hexahedron20": [*range(12), *range(16, 20), *range(12, 16)]}
NASTRAN_ORDER |= {"wedge15": [*range(9), 12, 13, 14, 9, 10, 11]}
EXODUS_ORDER = NASTRAN_ORDER | {"hexahedron27": [*NASTRAN_ORDER["hexahedron20"], 23, 24, 25, 26, 21, 22, 20]}
_OF_GMSH = [*range(8), 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
GMSH_ORDER = {"hexahedron20": _OF_GMSH, "hexahedron27": [*_OF_GMSH, 22, 23, 21, 24, 20, 25, 26]}
GMSH_ORDER |= {"tetra10": [*range(8), 9, 8], "wedge15": [*range(7), 9, 7, 12, 14, 13, 8, 10, 11]}
# Of MED, whose elements are those of VTK seen in a mirror.
MED_ORDER = {"tetra": [0, 2, 1, 3], "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8], "wedge": [0, 2, 1, 3, 5, 4]}
MED_ORDER |= {"hexahedron": [0, 3, 2, 1, 4, 7, 6, 5]}
MED_ORDER |= {"hexahedron20": [*MED_ORDER["hexahedron"], 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17]}


def _element(kind: str) -> Any:
    """Scikit-fem's class of a kind of element."""
    import skfem

    return getattr(skfem, KINDS[kind].element)


@cache
def shape_functions(kind: str, degree: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Points (q, 3), weights (q,), shape functions (q, k) and derivatives (q, k, 3) at a rule of some degree."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefLine, RefTri

    domain = _element(kind)().refdom
    upright = kind.startswith("wedge")
    if upright or KINDS[kind].shell:
        # scikit-fem 12's rule of wedges has the triangle across another axis, and half the weights.
        flat, flat_weights = get_quadrature(RefTri if upright else domain, degree)
        line, line_weights = get_quadrature(RefLine, (KINDS[kind].along or degree) if upright else ACROSS)
        points = np.concatenate([np.repeat(flat, len(line_weights), axis=1), np.tile(line, len(flat_weights))])
        weights = np.outer(flat_weights, line_weights).ravel()
    else:
        points, weights = get_quadrature(domain, degree)
    return points.T, weights, *shapes_at(kind, points.T)


def shapes_at(kind: str, points: Floats) -> tuple[Floats, Floats]:
    """Shape functions (q, k) and their derivatives (q, k, 3) at points (q, 3) of the reference element.

    Those of a shell are its surface's, times 1 − z for the lower face and z for the upper one.
    """
    if not KINDS[kind].shell:
        return _basis(kind, points)
    values, slopes = _basis(kind, points[:, :2])
    height = points[:, 2, None]
    below = np.concatenate([slopes * (1 - height)[..., None], -values[..., None]], axis=2)
    above = np.concatenate([slopes * height[..., None], values[..., None]], axis=2)
    return both_faces(kind, values * (1 - height), values * height), both_faces(kind, below, above)


def _basis(kind: str, points: Floats) -> tuple[Floats, Floats]:
    """Shape functions (q, k) and their derivatives (q, k, d) at points (q, d), for the nodes in meshio's order."""
    if kind in _NODES:  # polynomials that are 1 at one node and 0 at the others
        of_nodes = np.linalg.inv(_monomials(_NODES[kind], _WEDGE15))
        slopes = [_monomials(points, _WEDGE15, axis) @ of_nodes for axis in range(3)]
        return _monomials(points, _WEDGE15) @ of_nodes, np.stack(slopes, axis=2)
    element, columns = _element(kind)(), np.ascontiguousarray(points.T)
    pairs = [element.lbasis(columns, i) for i in _order(kind)]
    values = np.stack([np.broadcast_to(value, len(points)) for value, _ in pairs], axis=1)
    slopes = [np.stack([np.broadcast_to(part, len(points)) for part in slope], axis=1) for _, slope in pairs]
    return values, np.stack(slopes, axis=1)


def _monomials(points: Floats, powers: Sequence[tuple[int, int, int]], axis: int | None = None) -> Floats:
    """Monomials (q, m) with the exponents `powers` at points (q, 3), or their derivatives along an axis."""
    exponents, factor = np.array(powers), np.ones(len(powers))
    if axis is not None:
        factor = exponents[:, axis].astype(float)
        exponents = np.maximum(exponents - np.eye(3, dtype=int)[axis], 0)
    return np.asarray(factor * np.prod(points[:, None, :] ** exponents, axis=-1))


def tangents(kind: str, points: Floats, nodes: Indices, at: Floats) -> Floats:
    """Two tangents (e, q, 2, 3) of the middle surfaces of shells at points `at` (q, 2) of the reference element."""
    return np.einsum("ekc,qkd->eqdc", points[nodes], _basis(kind, at)[1], optimize=True)


def shared_area(kind: str, places: Floats) -> Floats:
    """Shares (k,) of the nodes, at places (k, 3), in an element's area: the integrals of the shape functions."""
    from skfem.quadrature import get_quadrature

    at, weights = get_quadrature(_element(kind)().refdom, KINDS[kind].mass)
    first, second = tangents(kind, places, np.arange(len(places))[None], at.T)[0].swapaxes(0, 1)
    return np.asarray(weights * np.linalg.norm(np.cross(first, second), axis=1) @ _basis(kind, at.T)[0])


def both_faces(kind: str, below: Any, above: Any) -> Any:
    """Join values (e, k, ...) at the nodes of a shell's two faces into the order of its nodes, (e, 2 k, ...)."""
    corners = KINDS[kind].shell
    return np.concatenate([below[:, :corners], above[:, :corners], below[:, corners:], above[:, corners:]], axis=1)


@cache
def extrapolation(kind: str) -> Floats:
    """Matrix (k, q) that extrapolates values at the points of stress to the nodes, by a polynomial."""
    points, powers = shape_functions(kind, KINDS[kind].stress)[0], KINDS[kind].monomials
    return np.asarray(_monomials(reference(kind), powers) @ np.linalg.pinv(_monomials(points, powers)))


def middle_nodes(kind: str) -> Floats:
    """Places of the nodes in the reference element, for shells those of the middle surface, in scikit-fem's order."""
    return _NODES[kind] if kind in _NODES else np.array(_element(kind).doflocs)


def reference(kind: str) -> Floats:
    """Places (k, 3) of the nodes in the reference element, in meshio's order."""
    places = middle_nodes(kind)
    if KINDS[kind].shell:
        low, high = (np.insert(places, 2, height, axis=1)[None] for height in (0.0, 1.0))
        return np.asarray(both_faces(kind, low, high)[0])
    return _HEXAHEDRON[: len(places)] if kind.startswith("hexahedron") else places


@cache
def _order(kind: str) -> tuple[int, ...]:
    """Numbers that scikit-fem gives the nodes of an element, for shells those of the middle surface."""
    theirs = middle_nodes(kind)
    ours = theirs if KINDS[kind].shell else reference(kind)
    distance = np.abs(ours[:, None] - theirs).max(axis=-1)
    return tuple(int(i) for i in distance.argmin(axis=1))


def jacobians(points: Floats, nodes: Indices, slopes: Floats) -> Floats:
    """Derivatives (e, q, 3, 3) of places with respect to those in the reference element, from the derivatives (q, k, 3)
    of the shape functions.
    """
    return np.einsum("ekd,qkc->eqdc", points[nodes], slopes, optimize=True)
