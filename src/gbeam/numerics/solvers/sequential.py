"""Minimum of a smooth cost within limits, by a sequence of quadratic programs (Nocedal and Wright, 2006, chapter 18).

The limits are linear at every point, and every point between two that keep them keeps them: once within the limits the
search stays there, and the cost alone decides how far a step goes.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gbeam.numerics.solvers.quadratic import solve_quadratic

_STEPS = 60  # at most
_ENOUGH = 1e-3  # gain of a step that ends the search, of what the cost has above its bound
_SUFFICIENT = 1e-4  # of the gain that the slope promises
_SHORTEST = 1e-3  # part of a step

Floats = NDArray[np.float64]


class Cost(Protocol):
    """A cost of unknowns x (n,)."""

    bound: float  # below which it cannot be

    def cost(self, x: Floats) -> float:
        """The cost."""

    def model(self, x: Floats) -> tuple[Any, Floats]:
        """A positive semidefinite matrix near the cost's second derivatives, sparse (n, n), and its slope (n,)."""


class Limits(Protocol):
    """Limits of unknowns x (n,)."""

    def at(self, x: Floats) -> tuple[Any, Floats, Floats]:
        """Rows, sparse (m, n), with lower and upper limits (m,): whatever keeps them keeps the true ones."""


def minimise(cost: Cost, limits: Limits, x: Floats) -> tuple[Floats, float]:
    """Find the minimum near `x`, which keeps the limits; return it and its cost."""
    value = cost.cost(x)
    for _ in range(_STEPS):
        hessian, slope = cost.model(x)
        rows, lower, upper = limits.at(x)
        now = rows @ x
        move = solve_quadratic(hessian, slope, rows, lower - now, upper - now)
        if move is None:
            break
        promised, part = float(slope @ move), 1.0
        while (new := cost.cost(x + part * move)) > value + _SUFFICIENT * part * promised:
            part /= 2
            if part < _SHORTEST:
                return x, value
        x, gain, value = x + part * move, value - new, new
        if gain <= _ENOUGH * (value - cost.bound):
            break
    return x, value


def nearest_within(limits: Limits, x: Floats) -> Floats | None:
    """The point within the limits that is nearest to `x`; None if there is none."""
    import scipy.sparse

    rows, lower, upper = limits.at(x)
    now = rows @ x
    move = solve_quadratic(scipy.sparse.eye_array(x.size), 0 * x, rows, lower - now, upper - now)
    return None if move is None else x + move
