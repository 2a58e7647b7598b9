"""Quadratic programs with sparse matrices, by the interior-point solver PIQP."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_TOLERANCE = 1e-7  # of what limits leave, which are of the order of one, and of the slope
_GAP = 1e-9, 1e-5  # between the costs of the two programs, alone and beside the cost
_SCALE = 1e4  # of the cost: the solver adds up to 1e-10 to H, which must be small beside its least eigenvalue

Floats = NDArray[np.float64]


def solve_quadratic(hessian: Any, slope: Floats, rows: Any, lower: Floats, upper: Floats) -> Floats | None:
    """Find the x that minimises ½ xᵀHx + gᵀx within lower <= A x <= upper.

    `hessian` (n, n), `slope` (n,), `rows` (m, n), `lower`, `upper` (m,); returns (n,).
    """
    import piqp

    solver = piqp.SparseSolver()
    settings = solver.settings
    settings.kkt_solver = piqp.KKTSolver.sparse_ldlt_ineq_cond  # limits only widen the band of H
    settings.eps_abs = settings.eps_rel = _TOLERANCE
    settings.eps_duality_gap_abs, settings.eps_duality_gap_rel = _GAP
    settings.preconditioner_iter = 0  # limits and cost are scaled as they are given: it would take a quarter more steps
    solver.setup(_SCALE * _sorted(hessian), _SCALE * slope, G=_sorted(rows), h_l=lower, h_u=upper)
    status = solver.solve()
    return np.array(solver.result.x) if status == piqp.PIQP_SOLVED else None


def _sorted(matrix: Any) -> Any:
    """By columns, each in order: PIQP takes no others."""
    columns = matrix.tocsc()
    columns.sort_indices()
    return columns
