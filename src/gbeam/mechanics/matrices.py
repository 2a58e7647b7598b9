"""Mass and stiffness matrices of another program: what they must be, and the mass of each direction in them."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.numerics.eigen import Floats

SYMMETRIC = 1e-6  # of the largest entry
EXACT = 1e-6  # of a mode's mass: what is left out below it is rounding
MOST = 0.05  # of a mode's mass, left out
NEAR = 0.01  # of a given mass, or of the size of the structure


def sparse_matrix(where: str, matrix: Any, size: int | None = None) -> Any:
    """Return a matrix as a symmetric sparse one; an InputError where it is none, or of another size."""
    from scipy.sparse import csr_array

    try:
        found = csr_array(matrix, dtype=float)
    except (TypeError, ValueError):
        raise InputError(where, "is no matrix of numbers", "give an array, or a sparse one of SciPy") from None
    if found.ndim != 2 or found.shape[0] != found.shape[1]:
        raise InputError(where, f"has the shape {found.shape}", "give a square matrix")
    if size is not None and found.shape[0] != size:
        raise InputError(where, f"has {found.shape[0]} rows", f"give {size}, as the other matrix has")
    if not np.isfinite(found.data).all():
        raise InputError(where, "has values that are not finite", "give finite ones")
    apart, largest = abs(found - found.T), abs(found).max()
    if apart.max() > SYMMETRIC * largest:
        i, j = (int(each[apart.tocoo().data.argmax()]) for each in apart.tocoo().coords)
        problem = f"is not symmetric: {found[i, j]:.4g} in row {i}, column {j}, and {found[j, i]:.4g} across"
        raise InputError(where, problem, "write it with both triangles, and without damping or rotation in it")
    negative = np.flatnonzero(found.diagonal() < 0)
    if negative.size:
        problem = f"is not positive: {found.diagonal()[negative[0]]:.4g} on the diagonal in row {negative[0]}"
        raise InputError(where, problem, "is it the right matrix?")
    return (found + found.T) / 2


def mass_of_nodes(mass: Any, nodes: int) -> Any:
    """The mass matrix (k, k) of one component of the displacement: the mean of the three directions'."""
    per = mass.shape[0] // nodes
    return sum(mass[i::per][:, i::per] for i in range(3)) / 3


def left_out(mass: Any, of_nodes: Any, vectors: Floats) -> float:
    """Largest part of a modal mass that the mass of the nodes leaves out, of vectors (u, n) of unit modal mass."""
    nodes = of_nodes.shape[0]
    moved = vectors.reshape(nodes, -1, vectors.shape[1])[:, :3]
    kept = sum(np.einsum("kn,kn->n", moved[:, i], of_nodes @ moved[:, i]) for i in range(3))
    return float(np.abs(1 - kept).max())


def compare_mass(points: Floats, of_nodes: Any, total: float | None, centre: Any, inertia: Any) -> None:
    """Refuse a mass, centre of mass or inertia about it that the matrices do not have."""
    weight = np.asarray(of_nodes.sum(axis=0)).ravel()
    known = float(weight.sum())
    middle = weight @ points / known
    arms = points - middle
    moments = arms.T @ (of_nodes @ arms)
    about = np.trace(moments) * np.eye(3) - moments
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    fix = "are the units those of SI, and the places in the order of the matrices?"
    if total is not None and abs(known / total - 1) > NEAR:
        raise InputError("total_mass", f"is {total:.6g} kg, and the matrix has {known:.6g} kg", fix)
    if centre is not None and np.linalg.norm(np.subtract(centre, middle)) > NEAR * size:
        shown = ", ".join(f"{each:.4g}" for each in middle)
        raise InputError("centre", f"is not that of the matrix, ({shown}) m", fix)
    if inertia is not None and np.abs(np.subtract(inertia, about)).max() > NEAR * np.trace(about):
        shown = ", ".join(f"{each:.4g}" for each in np.diagonal(about))
        raise InputError("inertia", f"is not that of the matrix, {shown} kg m² on the diagonal", fix)
