"""Mass and stiffness matrices of another program: what they must be, and the mass of each direction in them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.errors import InputError
from gbeam.mechanics.equations.linear import PAIRS
from gbeam.mechanics.fields.taylor import EPSILON
from gbeam.mechanics.reduction import linear_fields
from gbeam.structure.attachments import TIP

OWN = 0  # direction of a coordinate that belongs to no node
SYMMETRIC = 1e-6  # of the largest entry
STRAINED = 1e-5  # of the forces in it: a rigid motion that strains the structure
EXACT = 1e-6  # of a mode's mass: what is left out below it is rounding
MOST = 0.05  # of a mode's mass, left out
ROUNDING = 1e-12  # of the size
NEAR = 0.01  # of a given mass, or of the size of the structure


def sparse_matrix(where: str, matrix: Any, size: int | None = None) -> Any:
    """Convert a matrix to a sparse one. It must be square, of `size`, finite, symmetric, and have no negative
    diagonal.
    """
    from scipy.sparse import csr_array

    try:
        square = csr_array(matrix, dtype=float)
    except (TypeError, ValueError):
        raise InputError(where, "is no matrix of numbers", "give an array, or a sparse one of SciPy") from None
    if square.ndim != 2 or square.shape[0] != square.shape[1]:
        raise InputError(where, f"has the shape {square.shape}", "give a square matrix")
    if size is not None and square.shape[0] != size:
        raise InputError(where, f"has {square.shape[0]} rows", f"give {size}, as the other matrix has")
    if not np.isfinite(square.data).all():
        raise InputError(where, "has values that are not finite", "give finite ones")
    difference, largest = abs(square - square.T), abs(square).max()
    if difference.max() > SYMMETRIC * largest:
        i, j = (int(index[difference.tocoo().data.argmax()]) for index in difference.tocoo().coords)
        problem = f"is not symmetric: {square[i, j]:.4g} in row {i}, column {j}, and {square[j, i]:.4g} across"
        raise InputError(where, problem, "write it with both triangles, and without damping or rotation in it")
    negative = np.flatnonzero(square.diagonal() < 0)
    if negative.size:
        problem = f"is not positive: {square.diagonal()[negative[0]]:.4g} on the diagonal in row {negative[0]}"
        raise InputError(where, problem, "is it the right matrix?")
    return (square + square.T) / 2


def every_unknown(places: Floats, unknowns: int) -> Indices:
    """Nodes and directions (u, 2) of matrices that have three or six unknowns for each node in turn. InputError if they
    have other numbers of rows.
    """
    nodes = len(places) if places.ndim else 0
    if not nodes or unknowns not in (3 * nodes, 6 * nodes):
        fix = "give a row of x, y, z for each three or six rows of the matrices, or give unknowns"
        raise InputError("nodes", f"has the shape {places.shape}, and the matrices {unknowns} rows", fix)
    per = unknowns // nodes
    return np.stack([np.repeat(np.arange(nodes), per), np.tile(np.arange(1, per + 1), nodes)], axis=1)


def fields_of(points: Floats, unknowns: Indices) -> Floats:
    """Motions (u, 12) of the unknowns in twelve displacement fields: 1, x, y and z along x, then along y, then along z.
    Nodes turn by half the curl of the field.
    """
    node, way = unknowns.T
    linear = linear_fields(points)
    fields = np.zeros((len(unknowns), 3, 4))
    for axis in range(3):
        moves, turns = way == axis + 1, way == axis + 4
        fields[moves, axis] = linear[node[moves]]
        fields[turns, :, 1:] = EPSILON[axis].T / 2  # θ_c = ½ ε_cfa for u_a = x_f
    return fields.reshape(-1, 12)


def rigid_motions(fields: Floats) -> Floats:
    """Motions (u, 6) of the unknowns in translations along and rotations about the axes, from their motions in the
    twelve fields of :func:`fields_of`.
    """
    by_axis = fields.reshape(-1, 3, 4)
    return np.concatenate([by_axis[:, :, 0], np.einsum("acf,uaf->uc", EPSILON, by_axis[:, :, 1:])], axis=1)


def rigid_body(mass: Any, rigid: Floats) -> Floats:
    """Mass, first and second moments xx, yy, zz, xy, yz, zx about the root, (10,), by M and rigid motions (u, 6)."""
    body = rigid.T @ (mass @ rigid)
    total = float(np.trace(body[:3, :3])) / 3
    if not total > 0:
        raise InputError("mass", f"weighs {total:.4g} kg", "give the matrix with its mass, and the nodes that have it")
    if np.abs(body[:3, :3] - total * np.eye(3)).max() > NEAR * total:
        shown = ", ".join(f"{weight:.4g}" for weight in np.diagonal(body)[:3])
        problem = f"weighs {shown} kg along x, y and z"
        raise InputError("mass", problem, "give the mass matrix of every direction, of a structure without joints")
    first = np.einsum("abc,bc->a", EPSILON, body[:3, 3:]) / 2  # Σ m e_c × r
    inertia = body[3:, 3:]
    second = np.trace(inertia) / 2 * np.eye(3) - inertia
    pairs = (second[i, j] for i, j in PAIRS)
    return np.array([total, *first, *pairs])


def extent_of(places: Floats, body: Floats) -> float:
    """Reach of a structure from the root, m: the distance of its farthest node, at places (k, 3).

    Where its mass lies beyond all nodes, as with one interface and modes, it is the length of a uniform beam with the
    radius of gyration of the body (10,).
    """
    farthest = float(np.linalg.norm(places, axis=1).max())
    gyration = float(np.sqrt(body[4:7].sum() / body[0]))
    return farthest if farthest >= gyration else 3**0.5 * gyration


def resisted(stiffness: Any, rigid: Floats) -> Flags:
    """Flags (6,) of rigid motions (u, 6) that a stiffness resists."""
    return _strains(stiffness, rigid) > STRAINED


def _strains(stiffness: Any, rigid: Floats) -> Floats:
    """Largest forces (6,) against rigid motions (u, 6), as shares of those in a stiffness."""
    force, magnitude = np.abs(stiffness @ rigid), abs(stiffness) @ np.abs(rigid)
    return np.asarray(force.max(axis=0) / np.maximum(magnitude.max(axis=0), 1e-300))


def refuse_held(stiffness: Any, rigid: Floats) -> None:
    """Refuse a stiffness that resists rigid motions (u, 6): the structure is held, or its nodes lie elsewhere."""
    if resisted(stiffness, rigid).any():
        i, force = int(_strains(stiffness, rigid).argmax()), np.abs(stiffness @ rigid)
        name = f"moving along {'xyz'[i]}" if i < 3 else f"turning about {'xyz'[i - 3]}"
        problem = f"resists {name} as a rigid body, in row {int(force[:, i].argmax())}"
        fix = "are nodes, units and the order of rows right? Give the matrices of the free structure, or no clamp"
        raise InputError("stiffness", problem, fix)


def displaced(unknowns: Indices, nodes: int) -> tuple[Indices, Indices]:
    """Nodes (d,) that have all three displacements, and the rows of these, (d, 3)."""
    rows = np.full((nodes, 3), -1)
    for axis in range(3):
        which = np.flatnonzero(unknowns[:, 1] == axis + 1)
        rows[unknowns[which, 0], axis] = which
    complete = np.flatnonzero((rows >= 0).all(axis=1))
    return complete, rows[complete]


def with_tip(points: dict[str, int], places: Floats, held: Sequence[int] = ()) -> dict[str, int]:
    """Nodes of points by name, with the tip as the last.

    Where no point is called so, the tip is the node farthest from the root, at places (k, 3), that is not held.
    """
    distance = np.linalg.norm(places, axis=1)
    distance[[*held]] = 0.0
    tip = points.get(TIP, int(distance.argmax()))
    return {name: node for name, node in points.items() if name != TIP} | {TIP: tip}


def turned(unknowns: Indices, node: int) -> Indices | None:
    """Rows (6,) of a node's displacements and rotations, or None where it lacks some."""
    which = np.flatnonzero((unknowns[:, 0] == node) & (unknowns[:, 1] != OWN))
    order = which[np.argsort(unknowns[which, 1])]
    return order if len(order) == 6 else None


def mass_of_nodes(mass: Any, rows: Indices) -> Any:
    """The mass matrix (d, d) of one component of the displacement: the mean of the three directions'."""
    return sum(mass[way][:, way] for way in rows.T) / 3


def mass_defect(of_nodes: Any, moved: Floats) -> float:
    """Largest difference from 1 of the modal masses that the mass (d, d) of the nodes has in modes (d, 3, n)."""
    kept = sum(np.einsum("kn,kn->n", moved[:, i], of_nodes @ moved[:, i]) for i in range(3))
    return float(np.abs(1 - kept).max())


def compare_mass(body: Floats, size: float, total: float | None, centre: Any, inertia: Any) -> None:
    """Refuse a mass, a centre of mass or an inertia about it that differs from that of the matrices' body (10,)."""
    mass, middle = body[0], body[1:4] / body[0]
    xx, yy, zz, xy, yz, zx = body[4:]
    second = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) - mass * np.outer(middle, middle)
    about_centre = np.trace(second) * np.eye(3) - second
    fix = "are the units those of SI, and the places in the order of the matrices?"
    if total is not None and abs(mass / total - 1) > NEAR:
        raise InputError("total_mass", f"is {total:.6g} kg, and the matrix has {mass:.6g} kg", fix)
    if centre is not None and np.linalg.norm(np.subtract(centre, middle)) > NEAR * size:
        words = ", ".join(f"{x:.4g}" for x in np.where(np.abs(middle) < ROUNDING * size, 0.0, middle))
        raise InputError("centre", f"is not that of the matrix, ({words}) m", fix)
    if inertia is not None and np.abs(np.subtract(inertia, about_centre)).max() > NEAR * np.trace(about_centre):
        words = ", ".join(f"{moment:.4g}" for moment in np.diagonal(about_centre))
        raise InputError("inertia", f"is not that of the matrix, {words} kg m² on the diagonal", fix)
