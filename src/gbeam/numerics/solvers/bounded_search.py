"""One number between bounds that makes a value least, where a second value must not exceed one. Knows of no beam."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

GRID = 5  # coarse points
_RESOLUTION = 0.02  # of the number
_BISECTIONS, _REFINEMENTS = 6, 8

Evaluate = Callable[[float], tuple[float, float]]


def coarse(low: float, high: float) -> tuple[float, ...]:
    """Numbers from `low` to `high` in equal ratios."""
    return tuple(float(x) for x in np.geomspace(low, high, GRID)) if high > low else (low,)


def refine(evaluate: Evaluate, points: tuple[float, ...]) -> None:
    """Look for a better number around the best of the coarse ones; what was evaluated is the caller's to keep."""
    values = [evaluate(x) for x in points]
    allowed = [i for i, (_, share) in enumerate(values) if share <= 1]
    if not allowed:
        return
    best = min(allowed, key=lambda i: values[i][0])

    def edge(inside: float, outside: float) -> float:
        """The last number that is allowed on the way from `inside` to `outside`, by bisection of the ratio."""
        for _ in range(_BISECTIONS):
            if abs(np.log(outside / inside)) < _RESOLUTION:
                break
            middle = float(np.sqrt(inside * outside))
            inside, outside = (middle, outside) if evaluate(middle)[1] <= 1 else (inside, middle)
        return inside

    def neighbour(i: int) -> float:
        if not 0 <= i < len(points):
            return points[best]
        return points[i] if values[i][1] <= 1 else edge(points[best], points[i])

    low, high = neighbour(best - 1), neighbour(best + 1)
    if high <= low * (1 + _RESOLUTION):
        return
    import scipy.optimize

    scipy.optimize.minimize_scalar(
        lambda x: evaluate(float(np.exp(x)))[0],
        bounds=(np.log(low), np.log(high)),
        method="bounded",
        options={"xatol": _RESOLUTION, "maxiter": _REFINEMENTS},
    )
