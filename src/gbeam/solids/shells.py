"""Shells: the points on their two faces that stand for a node of the mesh, and the strains assumed in their elements.

A shell is a layer of solid elements whose points on one normal are a rigid link, with plane stress between the faces.
Transverse shear is interpolated from where elements of a thin plate have none (MITC3 and MITC4: Lee and Bathe 2004,
Dvorkin and Bathe 1984) or taken at the points of a reduced rule (eight and six nodes); but for quadrilaterals of four
nodes, thin elements lock by it, and it is softer by their size (Lyly, Stenberg and Vihinen 1993). Quadrilaterals of
four nodes have the four strains of Simo and Rifai (1990) besides, by which they bend in their own plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.solids.shape_functions import (
    KINDS,
    both_faces,
    jacobians,
    middle_nodes,
    shape_functions,
    shapes_at,
    tangents,
)

SMOOTH = np.cos(np.radians(20.0))  # between normals of elements that share one at a node
UPRIGHT = np.cos(np.radians(3.0))  # between a laminate's third axis and the normal
# Of the ratio of an element's longest side to its thickness, squared.
SOFTER = {"triangle": 0.1, "triangle6": 0.025, "quad8": 0.005}
FACTOR = 5 / 6  # of transverse shear in a plate, Reissner's
# Components of the strain of the surface, of its shear across, and of that across its thickness.
PAIRS = ((0, 0), (1, 1), (0, 1), (0, 2), (1, 2))
# Enhanced strains of quadrilaterals: component, and the coordinate in which it is linear.
ENHANCED = ((0, 0), (1, 1), (2, 0), (2, 1))
TYING = {
    "triangle": np.array([[0.5, 0.0], [0.0, 0.5], [0.5, 0.5]]),
    "quad": np.array([[0.5, 0.0], [0.5, 1.0], [0.0, 0.5], [1.0, 0.5]]),
}


def _tied(kind: str, places: Floats) -> tuple[Floats, Floats]:
    """Points (p, 2) of the middle surface from which transverse shear is interpolated, and its interpolation to
    `places` (q, 2).

    The latter are the shares (q, 2, p, 2) of the two components at the first points in those at the second.
    """
    x, y = places.T
    if kind not in TYING:
        return places, np.einsum("qp,ab->qapb", np.eye(len(places)), np.eye(2))
    share = np.zeros((len(places), 2, len(TYING[kind]), 2))
    if kind == "quad":
        share[:, 0, 0, 0], share[:, 0, 1, 0], share[:, 1, 2, 1], share[:, 1, 3, 1] = 1 - y, y, 1 - x, x
    else:
        share[:, 0, 0, 0], share[:, 0, 1, 1], share[:, 0, 2] = 1 - y, y, np.stack([y, -y], axis=1)
        share[:, 1, 1, 1], share[:, 1, 0, 0], share[:, 1, 2] = 1 - x, x, np.stack([-x, x], axis=1)
    return TYING[kind], share


def _covariant(base: Floats, slopes: Floats, pair: tuple[int, int]) -> Floats:
    """Covariant component a, b of the strain per displacement of the nodes, (e, q, k, 3).

    With base vectors g, (e, q, 3, 3), it is (g_a · u_,b + g_b · u_,a)/2; `slopes` (q, k, 3) are those of the shape
    functions.
    """
    a, b = pair
    slope_a, slope_b = slopes[None, ..., a, None], slopes[None, ..., b, None]
    return (base[:, :, None, a] * slope_b + base[:, :, None, b] * slope_a) / 2


def _cartesian(dual: Floats, pair: tuple[int, int]) -> Floats:
    """Strains (..., 6) xx, yy, zz, yz, xz, xy of a unit covariant component, from the dual base vectors (..., 3, 3) in
    columns. Shear is twice that of the tensor.
    """
    a, b = dual[..., pair[0]], dual[..., pair[1]]
    factor = 1.0 if pair[0] == pair[1] else 2.0
    normal = factor * a * b
    shear = [factor * (a[..., i] * b[..., j] + a[..., j] * b[..., i]) for i, j in ((1, 2), (0, 2), (0, 1))]
    return np.concatenate([normal, np.stack(shear, axis=-1)], axis=-1)


def plane_stress(elasticity: Floats, normal: Floats) -> Floats:
    """Elasticity (..., 6, 6) of plane stress: without stress along unit normals (..., 3)."""
    stretch = _cartesian(normal[..., None], (0, 0))
    stress = stretch @ elasticity
    return elasticity - stress[..., :, None] * stress[..., None, :] / (stretch * stress).sum(axis=-1)[..., None, None]


def shell_strains(
    points: Floats, nodes: Indices, kind: str, elasticity: Floats, degree: int, shear: Any
) -> tuple[Floats, Floats]:
    """Strains (e, q, 6, k, 3) per displacement of the nodes of shells, and their elasticity in plane stress (e, q, 6,
    6).

    Transverse shear is multiplied by `shear`.
    """
    places, weights, _, slopes = shape_functions(kind, degree)
    base = jacobians(points, nodes, slopes).swapaxes(2, 3)
    dual = np.asarray(np.linalg.inv(base), dtype=float)
    normal = dual[..., 2] / np.linalg.norm(dual[..., 2], axis=-1, keepdims=True)
    law = plane_stress(elasticity, normal)
    parts = [_covariant(base, slopes, pair) for pair in PAIRS[:3]]
    tying, share = _tied(kind, places[:, :2])
    middle = shapes_at(kind, np.insert(tying, 2, 0.5, axis=1))[1]
    at_ties = jacobians(points, nodes, middle).swapaxes(2, 3)
    tie_strains = np.stack([_covariant(at_ties, middle, pair) for pair in PAIRS[3:]], axis=2)
    if kind in SOFTER:
        first, second = base[..., 0, :], base[..., 1, :]
        sides = (first, second, first - second) if KINDS[kind].shell == 3 else (first, second)
        slenderness = (dual[..., 2] ** 2).sum(axis=-1) * np.max([(side**2).sum(axis=-1) for side in sides], axis=0)
        shear = shear / np.sqrt(1 + SOFTER[kind] * slenderness)[..., None, None]
    shear_strains = shear * np.einsum("qapb,epbkc->aeqkc", share, tie_strains, optimize=True)
    components = np.stack([_cartesian(dual, pair) for pair in PAIRS], axis=-1)
    strain = np.einsum("eqvp,peqkc->eqvkc", components, np.stack([*parts, *shear_strains]), optimize=True)
    if kind == "quad":
        volume = np.linalg.det(base)
        enhanced = _enhanced(points, nodes, kind, places, volume)
        pulled = np.einsum("eqvw,eqwa,eq->eqva", law, enhanced, volume * weights, optimize=True)
        stiffness = np.einsum("eqva,eqvb->eab", pulled, enhanced, optimize=True)
        forces = np.einsum("eqva,eqvkc->eakc", pulled, strain, optimize=True)
        sizes = np.linalg.solve(stiffness, forces.reshape(*forces.shape[:2], -1)).reshape(forces.shape)
        strain = strain - np.einsum("eqva,eakc->eqvkc", enhanced, sizes, optimize=True)
    return strain, law


def _enhanced(points: Floats, nodes: Indices, kind: str, places: Floats, volume: Floats) -> Floats:
    """Enhanced strains (e, q, 6, 4) of quadrilaterals at `places` (q, 3), linear in these.

    They are turned to the axes by the base vectors in the middle. The Jacobian has the determinant `volume` (e, q).
    """
    middle = jacobians(points, nodes, shapes_at(kind, np.full((1, 3), 0.5))[1]).swapaxes(2, 3)
    dual = np.asarray(np.linalg.inv(middle), dtype=float)
    ratio = np.linalg.det(middle) / volume
    strains = []
    for pair, i in ENHANCED:
        size = ratio * (2 * places[:, i] - 1)
        strains.append(_cartesian(dual, PAIRS[pair]) * size[..., None])
    return np.stack(strains, axis=-1)


def _normals(places: Floats, kind: str, nodes: Indices) -> Floats:
    """Unit normals (e, k, 3) of elements at their nodes, all on the side of the normal in the element's middle."""

    def normals_at(points: Floats) -> Floats:
        first, second = np.moveaxis(tangents(kind, places, nodes, points), 2, 0)
        return np.cross(first, second)

    corners = middle_nodes(kind)
    normals = normals_at(corners)
    middle = normals_at(corners[: KINDS[kind].shell].mean(axis=0, keepdims=True))
    size = np.linalg.norm(normals, axis=-1, keepdims=True)
    side = np.where((normals * middle).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)
    return normals / np.where(size > 0, size, 1.0) * side


def layered(places: Floats, elements: Sequence[tuple[str, Indices, Floats]]) -> tuple[Floats, Indices, list[Indices]]:
    """Points (p, 3) on the faces of shells, the nodes (p,) for which they stand, and the points (e, 2 k) of elements.

    Of the two points on a normal the upper one is first. Nodes are at places (k, 3); elements have a kind, nodes (e, k)
    and thicknesses (e,). Those that meet at a node share a normal, the mean of theirs, where theirs are nearly one.
    """
    normal = np.concatenate([_normals(places, kind, nodes).reshape(-1, 3) for kind, nodes, _ in elements])
    node = np.concatenate([nodes.ravel() for _, nodes, _ in elements])
    thickness = np.concatenate([np.repeat(thick, nodes.shape[1]) for _, nodes, thick in elements])
    # A family shares one normal at a node; `along` is 1 where an element's has its sense, −1 where not, 0 if undecided.
    along, family = np.zeros(len(node)), np.zeros(len(node), dtype=int)
    rounds = 0
    undecided = np.arange(len(node))
    while undecided.size:
        first = np.full(len(places), -1)
        first[node[undecided[::-1]]] = undecided[::-1]
        leader = first[node[undecided]]
        cosine = (normal[undecided] * normal[leader]).sum(axis=1)
        smooth = (np.abs(cosine) >= SMOOTH) & (thickness[undecided] == thickness[leader])
        same = smooth | (undecided == leader)
        along[undecided[same]] = np.where(cosine[same] < 0, -1.0, 1.0)
        family[undecided[same]] = rounds * len(places) + node[undecided[same]]
        undecided = np.flatnonzero(along == 0)
        rounds += 1
    _, index, family = np.unique(family, return_index=True, return_inverse=True)
    total = np.zeros((len(index), 3))
    np.add.at(total, family, along[:, None] * normal)
    # So long that its part along the elements' own normals is half of their thickness.
    half = total / np.maximum((total**2).sum(axis=1) / np.bincount(family), 1e-300)[:, None]
    half *= thickness[index, None] / 2
    points = np.stack([places[node[index]] + half, places[node[index]] - half], axis=1).reshape(-1, 3)
    upper = 2 * family + (along < 0)
    ends = np.cumsum([0, *(nodes.size for _, nodes, _ in elements)])
    of_elements = []
    for (kind, nodes, _), start in zip(elements, ends, strict=False):
        above = upper[start : start + nodes.size].reshape(nodes.shape)
        of_elements.append(np.asarray(both_faces(kind, above ^ 1, above)))
    return points, np.repeat(node[index], 2), of_elements


def points_of(places: Floats, elements: Sequence[Any]) -> tuple[Floats, Indices, list[Indices]]:
    """Points (p, 3), the nodes (p,) for which they stand, and the points (e, k) of the elements of each block.

    A node of solids is one point, a node of shells two or more.
    """
    solids = [block for block in elements if block.thickness is None]
    used = np.unique(np.concatenate([np.empty(0, dtype=int), *(block.nodes.ravel() for block in solids)]))
    point_of_node = np.full(len(places), -1)
    point_of_node[used] = np.arange(len(used))
    shells = [(block.kind, block.nodes, block.thickness) for block in elements if block.thickness is not None]
    points, numbers, nodes = layered(places, shells) if shells else (np.empty((0, 3)), np.empty(0, dtype=int), [])
    of_shells = iter(nodes)
    of_elements = []
    for block in elements:
        of_elements.append(point_of_node[block.nodes] if block.thickness is None else len(used) + next(of_shells))
    return np.concatenate([places[used], points]), np.concatenate([used, numbers]), of_elements


def refuse_oblique(where: str, points: Floats, nodes: Indices, kind: str, axes: Any) -> None:
    """Refuse shells (e, 2 k) whose normal is not the third axis of their material; `axes` are the first two."""
    corners = KINDS[kind].shell
    normal = (points[nodes[:, corners : 2 * corners]] - points[nodes[:, :corners]]).mean(axis=1)
    third = np.cross(*np.asarray(axes, dtype=float))
    cosine = np.abs(normal @ third) / np.linalg.norm(normal, axis=1) / np.linalg.norm(third)
    oblique = int((cosine < UPRIGHT).sum())
    if oblique:
        fix = "give the elements of each plane a group, and a material with axes 1 and 2 in it"
        raise InputError(f"{where}.axes", f"do not lie in {oblique} elements of shells", fix)
