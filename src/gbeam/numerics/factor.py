"""Factors of a large sparse symmetric matrix: MKL's Pardiso where pypardiso is installed, else SciPy's SuperLU."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import in_bytes
from gbeam.numerics.eigen import Floats

# Measured on solids of quadratic tetrahedra: bytes for each of n^(4/3), seconds for each of n² unknowns.
BYTES = {"Pardiso": 260.0, "SuperLU": 700.0}
SECONDS = {"Pardiso": 2e-9, "SuperLU": 1e-8}
MOST = 64e9  # bytes


def solver() -> str:
    """Name of the solver that is installed."""
    try:
        import pypardiso  # noqa: F401
    except (ImportError, OSError):
        return "SuperLU"
    return "Pardiso"


def cost(unknowns: float) -> tuple[float, float]:
    """Memory, bytes, and time, s, that factors of a solid with so many unknowns take at most, roughly."""
    which = solver()
    return BYTES[which] * unknowns ** (4 / 3), SECONDS[which] * unknowns**2


def refuse_cost(where: str, unknowns: int) -> None:
    """Raise InputError if the factors would not fit into any usual memory, with what they would cost."""
    memory, seconds = cost(unknowns)
    if memory > MOST:
        raise InputError(
            where,
            f"makes {unknowns:.3g} unknowns, whose factors would take about {in_bytes(memory)} and "
            f"{seconds / 3600:.2g} hours by {solver()}",
            "mesh it more coarsely, with quadratic elements",
        )


@contextmanager
def factorised(matrix: Any, where: str = "stiffness") -> Iterator[Callable[[Floats], Floats]]:
    """Yield a function that solves for right-hand sides (n,) or (n, m); an InputError where the matrix is singular."""
    fix = "hold the structure so that nothing moves without strain"
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
                raise InputError(where, "is not positive definite", fix) from None
            yield lambda b: pardiso.solve(upper, np.asfortranarray(b)).reshape(b.shape)
        finally:
            pardiso.free_memory(everything=True)
        return
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    try:
        factors = splu(
            csc_matrix(matrix),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        raise InputError(where, "is singular", fix) from None
    yield factors.solve
