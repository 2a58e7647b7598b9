"""A root between two bounds. scipy.optimize has the same method, and takes longer to import than most searches take."""

from __future__ import annotations

from collections.abc import Callable

EPS = 2.0**-52


def brent(
    function: Callable[[float], float], low: float, high: float, *, xtol: float = 2e-12, rtol: float = 4 * EPS
) -> float:
    """Root of a continuous function by Brent's method: inverse interpolation, or bisection where that is slow."""
    before, best, f_before, f_best = low, high, function(low), function(high)
    if f_before == 0:
        return low
    if f_best == 0:
        return high
    if (f_before > 0) == (f_best > 0):
        raise ValueError("the function has the same sign at both bounds")
    other, f_other, step, last = before, f_before, best - before, best - before
    for _ in range(200):
        if (f_before > 0) != (f_best > 0):  # the root lies between `before` and `best`
            other, f_other = before, f_before
            step = last = best - before
        if abs(f_other) < abs(f_best):
            before, best, other = best, other, best
            f_before, f_best, f_other = f_best, f_other, f_best
        tolerance = (xtol + rtol * abs(best)) / 2
        half = (other - best) / 2
        if f_best == 0 or abs(half) < tolerance:
            return best
        if abs(last) > tolerance and abs(f_best) < abs(f_before):
            if before == other:  # a straight line
                move = -f_best * (best - before) / (f_best - f_before)
            else:
                to_before = (f_before - f_best) / (before - best)
                to_other = (f_other - f_best) / (other - best)
                move = (
                    -f_best
                    * (f_other * to_other - f_before * to_before)
                    / (to_other * to_before * (f_other - f_before))
                )
            shorter = 2 * abs(move) < min(abs(last), 3 * abs(half) - tolerance)
            last, step = (step, move) if shorter else (half, half)
        else:
            last = step = half
        before, f_before = best, f_best
        best += step if abs(step) > tolerance else (tolerance if half > 0 else -tolerance)
        f_best = function(best)
    return best
