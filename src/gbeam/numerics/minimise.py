"""Least values: of one number between bounds, of quadratics within limits, and of a sequence of these."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from gbeam.arrays.types import Floats

GRID = 5  # coarse points
_RESOLUTION = 0.02  # of the number
_BISECTIONS, _REFINEMENTS = 6, 8

Evaluate = Callable[[float], tuple[float, float]]


def coarse(low: float, high: float) -> tuple[float, ...]:
    """Numbers from `low` to `high` in equal ratios."""
    return tuple(float(x) for x in np.geomspace(low, high, GRID)) if high > low else (low,)


def refine(evaluate: Evaluate, points: Sequence[float]) -> None:
    """Evaluate numbers around the best of the `points` whose share of limits, the second value, is at most one."""
    values = [evaluate(x) for x in points]
    allowed = [i for i, (_, share) in enumerate(values) if share <= 1]
    if not allowed:
        return
    best_index = min(allowed, key=lambda i: values[i][0])

    def edge(inside: float, outside: float) -> float:
        """The last number that is allowed on the way from `inside` to `outside`, by bisection of the ratio."""
        for _ in range(_BISECTIONS):
            if abs(np.log(outside / inside)) < _RESOLUTION:
                break
            middle = float(np.sqrt(inside * outside))
            inside, outside = (middle, outside) if evaluate(middle)[1] <= 1 else (inside, middle)
        return inside

    def neighbour(i: int) -> float:
        """Bound of the search: point i, or the last allowed number on the way to it."""
        if not 0 <= i < len(points):
            return points[best_index]
        return points[i] if values[i][1] <= 1 else edge(points[best_index], points[i])

    low, high = neighbour(best_index - 1), neighbour(best_index + 1)
    if high <= low * (1 + _RESOLUTION):
        return
    import scipy.optimize

    scipy.optimize.minimize_scalar(
        lambda x: evaluate(float(np.exp(x)))[0],
        bounds=(np.log(low), np.log(high)),
        method="bounded",
        options={"xatol": _RESOLUTION, "maxiter": _REFINEMENTS},
    )


_CUTS, _ENDED = 200, 1e-7  # at most, and what the last one can still gain of the value at the start
_WORTH = 1e-6  # of the value at the start: a move that gains less is none
_NOTHING = 1e-9  # a value at the start that is less is rounding


def minimise_convex(evaluate: Callable[[Floats], tuple[float, Floats]], low: Floats, high: Floats, x: Floats) -> Floats:
    """Find the point between bounds (n,) at which a convex function is least; of several, the nearest to `x`.

    The method is that of cutting planes, tangents of the function (Kelley 1960). `evaluate` gives value and slope (n,).
    The bounds may be equal.
    """
    import scipy.optimize

    start, width, n = np.clip(x, low, high), high - low, len(low)
    start_share = (start - low) / np.where(width > 0, width, 1.0)
    # Unknown are shares of the way between the bounds, the value over that at the start, and distances from the start.
    distances = np.block([[np.eye(n), np.zeros((n, 1)), -np.eye(n)], [-np.eye(n), np.zeros((n, 1)), -np.eye(n)]])
    rows, sides = [*distances], [*start_share, *-start_share]
    bounds, costs = [*[(0.0, 1.0)] * n, (0.0, np.inf), *[(0.0, 1.0)] * n], np.zeros(2 * n + 1)
    costs[n] = 1.0
    x, best_point = start, (np.inf, start)
    unit = 0.0  # the value at the start
    for _ in range(_CUTS):
        value, slope = evaluate(x)
        unit = unit or max(value, _NOTHING)
        if costs[n] == 0 and value <= best_point[0] + _WORTH * unit:
            return x
        best_point = min(best_point, (value, x), key=lambda pair: pair[0])
        rows.append(np.concatenate([slope * width / unit, [-1.0], np.zeros(n)]))
        sides.append(float(slope @ (x - low) - value) / unit)
        solved = scipy.optimize.linprog(costs, np.array(rows), sides, bounds=bounds)
        if costs[n] and (not solved.success or best_point[0] / unit - solved.x[n] <= _ENDED):
            costs[:], costs[n + 1 :] = 0.0, 1.0  # the least is known: now the nearest of those
            bounds[n] = 0.0, best_point[0] / unit + _WORTH / 2
            solved = scipy.optimize.linprog(costs, np.array(rows), sides, bounds=bounds)
        if not solved.success:
            break
        x = low + width * np.clip(solved.x[:n], 0.0, 1.0)
    return best_point[1]


_TOLERANCE = 1e-7  # of what limits leave, which are of the order of one, and of the slope
_GAP = 1e-9, 1e-5  # between the costs of the two programs, alone and beside the cost
_SCALE = 1e4  # of the cost: the solver adds up to 1e-10 to H, which must be small beside its least eigenvalue


def solve_quadratic(hessian: Any, slope: Floats, rows: Any, lower: Floats, upper: Floats) -> Floats | None:
    """Find the x that minimises ½ xᵀHx + gᵀx within lower <= A x <= upper, H (n, n), A (m, n),
    or None if not solved.
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
    """A sparse matrix by columns with ascending rows: PIQP takes no others."""
    columns = matrix.tocsc()
    columns.sort_indices()
    return columns


_STEPS = 60  # at most
_ENOUGH = 1e-3  # gain of a step that ends the search, of what the cost has above its bound
_SUFFICIENT = 1e-4  # of the gain that the slope promises
_SHORTEST = 1e-3  # part of a step


class Cost(Protocol):
    """A cost of unknowns x (n,)."""

    bound: float  # below which it cannot be

    def cost(self, x: Floats) -> float:
        """The cost."""

    def model(self, x: Floats) -> tuple[Any, Floats]:
        """A positive semidefinite matrix near the cost's second derivatives, sparse (n, n), and its slope (n,)."""


class Limits(Protocol):
    """Limits of unknowns x (n,)."""

    def linearise(self, x: Floats) -> tuple[Any, Floats, Floats]:
        """Rows, sparse (m, n), with lower and upper limits (m,): whatever keeps them keeps the true ones."""


def minimise(cost: Cost, limits: Limits, x: Floats) -> tuple[Floats, float]:
    """Return a minimum near `x`, which must be within the limits, and its cost, by sequential quadratic programming."""
    value = cost.cost(x)
    for _ in range(_STEPS):
        hessian, slope = cost.model(x)
        rows, lower, upper = limits.linearise(x)
        row_values = rows @ x
        move = solve_quadratic(hessian, slope, rows, lower - row_values, upper - row_values)
        if move is None:
            break
        promised, fraction = float(slope @ move), 1.0  # promised: change of the cost, negative
        while (new_cost := cost.cost(x + fraction * move)) > value + _SUFFICIENT * fraction * promised:
            fraction /= 2
            if fraction < _SHORTEST:
                return x, value
        x, gain, value = x + fraction * move, value - new_cost, new_cost
        if gain <= _ENOUGH * (value - cost.bound):
            break
    return x, value


def nearest_point(limits: Limits, x: Floats) -> Floats | None:
    """Find the point within the limits that is nearest to `x`, or None if there is none."""
    import scipy.sparse

    rows, lower, upper = limits.linearise(x)
    row_values = rows @ x
    move = solve_quadratic(scipy.sparse.eye_array(x.size), 0 * x, rows, lower - row_values, upper - row_values)
    return None if move is None else x + move
