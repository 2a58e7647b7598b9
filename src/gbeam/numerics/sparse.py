"""Large sparse symmetric matrices: factors by the best of the libraries installed, lowest modes by Lanczos iteration.

The iteration has blocks: solving for many right-hand sides costs little more than for one, and a block finds as many
equal frequencies as it has columns.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, files
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.limits import in_bytes

# Measured on solids of quadratic tetrahedra: bytes for each of n^(4/3), seconds for each of n² unknowns.
BYTES = {"Pardiso": 260.0, "RSLAB": 300.0, "SuperLU": 700.0}
SECONDS = {"Pardiso": 2e-9, "RSLAB": 2e-9, "SuperLU": 1e-8}
MOST = 64e9  # bytes
PROPRIETARY = {"Pardiso": "Pardiso of MKL (proprietary: Intel Simplified Software License)"}


@cache
def solver() -> str:
    """Name of the solver: MKL's Pardiso, which only its own extra brings, RSLAB, else SciPy's SuperLU."""
    # Else pypardiso looks for MKL in all that is installed, for a second at its import and for each solver.
    with suppress(PackageNotFoundError):
        for file in files("mkl") or ():
            if "mkl_rt" in file.name:
                os.environ.setdefault("PYPARDISO_MKL_RT", str(file.locate()))
    # Else rslab's allocator takes address space by the GiB, which limits of memory count.
    os.environ.setdefault("MIMALLOC_ARENA_RESERVE", "64MiB")
    for module, name in ("pypardiso", "Pardiso"), ("rslab", "RSLAB"):
        with suppress(ImportError, OSError):
            import_module(module)
            return name
    return "SuperLU"


def cost(unknowns: float) -> tuple[float, float]:
    """Memory, bytes, and time, s, that factors of a solid with so many unknowns take at most, roughly."""
    solver_name = solver()
    return BYTES[solver_name] * unknowns ** (4 / 3), SECONDS[solver_name] * unknowns**2


def refuse_cost(where: str, unknowns: float, cause: str = "makes") -> None:
    """Raise InputError if the factors would not fit into any usual memory, with what they would cost."""
    memory, seconds = cost(unknowns)
    if memory > MOST:
        raise InputError(
            where,
            f"{cause} {unknowns:.3g} unknowns, whose factors would take about {in_bytes(memory)} and "
            f"{seconds / 3600:.2g} hours by {PROPRIETARY.get(solver(), solver())}",
            "mesh it more coarsely, with quadratic elements",
        )


@contextmanager
def factorised(matrix: Any, where: str = "stiffness") -> Iterator[Callable[[Floats], Floats]]:
    """Yield a function that solves for right-hand sides (n, m); InputError if the matrix is singular, MemoryError if
    its factors do not fit.
    """
    if solver() == "Pardiso":
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError
        from scipy.sparse import csr_matrix, triu

        upper = csr_matrix(triu(matrix, format="csr"))
        pardiso = PyPardisoSolver(mtype=2)  # symmetric and positive definite
        try:
            try:
                pardiso.factorize(upper)
            except (PyPardisoError, ValueError):  # which it raises of an empty row
                raise InputError(where, "is not positive definite", HOLD) from None
            pardiso.set_iparm(8, 0)  # refine no answer: two steps of it, which is usual, take three quarters of a solve
            yield lambda b: pardiso.solve(upper, np.asfortranarray(b)).reshape(b.shape)
        finally:
            pardiso.free_memory(everything=True)
        return
    if solver() == "RSLAB":
        import rslab

        symbolic = rslab.analyze(matrix, path="ldlt")
        np.empty(
            symbolic.memory_plan("float64")["peak_bytes"], np.uint8
        )  # where there is no room, rslab ends the process
        try:
            factors = symbolic.factor(matrix)
        except RuntimeError:
            raise InputError(where, "is singular", HOLD) from None
        if factors.inertia[1]:  # pivots below zero
            raise InputError(where, "is not positive definite", HOLD)
        yield factors.solve_many
        return
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        lower_upper = splu(
            csc_matrix(matrix),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        raise InputError(where, "is singular", HOLD) from None
    yield lower_upper.solve


HOLD = "hold the structure, such as by a clamp, so that nothing moves without strain"
CLOSE = 1e-8  # of an inverse eigenvalue: residual of a mode that has converged; its value errs by the square
ROUGH = 1e-2  # likewise, of those that only show what the others lack
NONE = 1e-12  # of its length: what is left of a vector that is in the space already
OUTSIDE = 0.5  # of the square of its length: what is left of a vector that was nearly outside of the space
SAME = 1e-13  # of the largest eigenvalue of the products of unit vectors: two that are one


def lowest_modes(
    solve: Callable[[Floats], Floats], mass: Any, start: Floats, modes: int, extra: int = 0
) -> tuple[Floats, Floats]:
    """Inverse eigenvalues (m,), the largest in size first, and vectors (n, m) of unit modal mass.

    They are those of `modes` that have converged and of some `extra` roughly. There are fewer where no more motions
    move mass.

    `solve` applies the inverse of the stiffness, and `start` (n, b) begins the space. All of its vectors are kept
    orthogonal (Golub and Underwood 1977, The block Lanczos method for computing eigenvalues).
    """
    basis, steps = list[Floats](), list[Floats]()
    flexibility, value = np.zeros((0, 0)), np.zeros(0)
    vector, residual = flexibility, value
    directions, weighed = _orthonormal(start, mass @ start, basis, mass)
    close = np.repeat([CLOSE, ROUGH], [modes, extra])
    while directions.shape[1] and not (len(value) == modes + extra and (residual < close * np.abs(value)).all()):
        basis.append(directions)
        step = solve(weighed)
        steps.append(step)
        heavy = mass @ step
        products = _products(basis, heavy)
        flexibility = np.block([[flexibility, products[: len(flexibility)]], [products.T]])
        directions, weighed = _orthonormal(step, heavy, basis, mass, products)
        value, vector = np.linalg.eigh(flexibility)
        lowest = np.argsort(-np.abs(value), kind="stable")[: modes + extra]
        value, vector = value[lowest], vector[:, lowest]
        residual = np.linalg.norm(directions.T @ heavy @ vector[-step.shape[1] :], axis=0)
    # Once more by the stiffness: without what has no mass, of which products with the mass do not know.
    return value, _combined(steps, vector) / value if steps else vector


def _orthonormal(
    vectors: Floats, weighed: Floats, basis: list[Floats], mass: Any, cross_products: Floats | None = None
) -> tuple[Floats, Floats]:
    """Vectors W (n, l), orthonormal in the mass M, that span what `vectors` V (n, b) have beside a basis Q; and M W.

    `weighed` (n, b) is M V, and `cross_products` (m, b) Qᵀ M V.
    """
    lengths = np.sqrt(np.maximum(np.einsum("ij,ij->j", vectors, weighed), 0.0))
    for _ in range(3):  # twice is enough, and once more for what was small
        if basis:
            cross_products = _products(basis, weighed) if cross_products is None else cross_products
            vectors = vectors - _combined(basis, cross_products)
            weighed, cross_products = mass @ vectors, None
        products = vectors.T @ weighed
        size = np.sqrt(np.maximum(np.diagonal(products), 0.0))
        is_new = (size > NONE * lengths) & (lengths > 0)
        size, products, share = size[is_new], products[np.ix_(is_new, is_new)], size[is_new] / lengths[is_new]
        value, vector = np.linalg.eigh(products / np.outer(size, size))
        is_independent = value > SAME * value.max(initial=0.0)
        change = vector[:, is_independent] / np.sqrt(value[is_independent]) / size[:, None]
        vectors, weighed = vectors[:, is_new] @ change, weighed[:, is_new] @ change
        lengths = np.ones(vectors.shape[1])
        if value[is_independent].min(initial=1.0) * share.min(initial=1.0) ** 2 > OUTSIDE:
            break
    return vectors, weighed


def add_to_rows(total: Floats, rows: Indices, values: Floats) -> None:
    """Add values (k, ...) to rows (k,) of `total`, of which several may be the same."""
    from scipy.sparse import csr_array

    met, place = np.unique(rows, return_inverse=True)
    sums = csr_array((np.ones(len(rows)), (place, np.arange(len(rows)))), shape=(len(met), len(rows)))
    total[met] += (sums @ values.reshape(len(rows), -1)).reshape(len(met), *values.shape[1:])


def _products(basis: list[Floats], weighed: Floats) -> Floats:
    """Products (m, b) of all vectors of a basis, in blocks, with `weighed` (n, b)."""
    return np.concatenate([block.T @ weighed for block in basis])


def _combined(basis: list[Floats], factors: Floats) -> Floats:
    """Combinations (n, k) of a basis by factors (m, k), block by block: joined, the basis would be copied."""
    total = np.zeros((len(basis[0]), factors.shape[1]))
    first = 0
    for block in basis:
        total += block @ factors[first : first + block.shape[1]]
        first += block.shape[1]
    return total
