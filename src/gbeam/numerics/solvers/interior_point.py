"""Least squares within limits: a primal-dual interior-point method with Gauss and Newton's steps.

It minimises f(c) with abs(share) <= 1 for any number of shares of c, each limit having a slack z and a multiplier λ:

    ∇f + Aᵀ(λ₊ − λ₋) = 0,    ± share + z = 1,    z λ = μ,    z, λ > 0,    μ → 0,

A being the shares' derivative (Nocedal and Wright, Numerical Optimization, 2006, chapter 19). The start may exceed the
limits. A step solves the same banded equations as without limits; thousands of limits in force cost no more than one.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

_STEPS = 100  # at most
_ENOUGH = 1e-4  # relative gain of a step that ends the search
_BARRIER, _LAST = 1e-2, 1e-3  # first μ; last sum of all z λ as a fraction of the cost
_LEAST_SLACK = 0.05  # at the start, also beyond a limit
_INSIDE = 0.99  # of the way to z = 0 or λ = 0
_MOST_DAMPING = 1e6

Floats = NDArray[np.float64]


class Problem(Protocol):
    """A cost, and shares of limits, of coefficients c (n, k)."""

    def cost(self, c: Floats) -> float:
        """f, a sum of squares."""

    def shares(self, c: Floats) -> Floats:
        """Shares of the limits, with their signs."""

    def linearise(self, c: Floats) -> None:
        """Make c the place at which `step` and `change` are taken."""

    def step(self, weight: Floats, pull: Floats, damping: float) -> Floats:
        """Solve (H + Aᵀ weight A + damping) Δc = −∇f − Aᵀ pull; LinAlgError if the matrix is not positive definite."""

    def change(self, move: Floats) -> Floats:
        """A Δc."""


class _Point(NamedTuple):
    """Coefficients with what belongs to them; the limits' columns are towards the upper and towards the lower one."""

    c: Floats
    cost: float
    share: Floats
    slack: Floats
    pull: Floats  # λ

    def merit(self, barrier: float, rigour: float) -> float:
        missed = np.abs(self.share + self.slack - 1)
        return self.cost - barrier * float(np.log(self.slack).sum()) + rigour * float(missed.sum())


def minimise(problem: Problem, c: Floats) -> tuple[Floats, float]:
    """Find the minimum near `c`.

    Parameters
    ----------
    problem : Problem
    c : array, shape (n, k)

    Returns
    -------
    tuple of array (n, k) and float
        Coefficients and cost. Where the search ends early some share may be above one: the caller looks.
    """
    share = _both(problem.shares(c))
    barrier, damping, rigour = _BARRIER if share.size else 0.0, 1e-8, 0.0
    slack = np.maximum(1 - share, _LEAST_SLACK)
    at = _Point(c, problem.cost(c), share, slack, barrier / slack)
    for _ in range(_STEPS):
        problem.linearise(at.c)
        while (step := _step(problem, at, barrier, rigour, damping)) is None:
            damping *= 10
            if damping > _MOST_DAMPING:
                return at.c, at.cost
        at, gain, part, rigour = step
        damping = max(damping / 10, 1e-13) if part > 0.5 else damping
        little, left = gain < _ENOUGH * at.cost, barrier * share.size
        if little and np.max(at.share, initial=0.0) <= 1 and left <= 1.01 * _LAST * at.cost:
            break
        if share.size and (little or gain < 0.3 * left or part > 0.9):
            barrier = max(barrier * (0.1 if part > 0.5 else 0.3), _LAST * at.cost / share.size)
    return at.c, at.cost


def _step(
    problem: Problem, at: _Point, barrier: float, rigour: float, damping: float
) -> tuple[_Point, float, float, float] | None:
    """One step: where to, the gain in merit, the part of it taken, the price of a missed limit. None: no part gains."""
    missed = at.share + at.slack - 1
    upper, lower = (barrier + at.pull * missed) / at.slack
    try:
        move = problem.step(np.sum(at.pull / at.slack, axis=0), upper - lower, damping)
    except np.linalg.LinAlgError:
        return None
    closing = -missed - _both(problem.change(move))
    lifting = (barrier - at.pull * (at.slack + closing)) / at.slack
    part, part_pull = _part(at.slack, closing), _part(at.pull, lifting)
    pull = at.pull + part_pull * lifting
    # The price is above every multiplier, so that the step goes downhill.
    rigour = max(rigour, 2 * float(np.max(np.abs(pull), initial=0.0)))
    before = at.merit(barrier, rigour)
    for _ in range(4):
        c, slack = at.c + part * move, at.slack + part * closing
        kept = np.clip(pull, 1e-3 * barrier / slack, 1e3 * barrier / slack)  # z λ stays near μ
        new = _Point(c, problem.cost(c), _both(problem.shares(c)), slack, kept)
        gain = before - new.merit(barrier, rigour)
        if gain >= -1e-10 * abs(before):
            return new, gain, part, rigour
        part /= 2.5
    return None


def _both(share: Floats) -> Floats:
    return np.stack([share, -share])


def _part(value: Floats, change: Floats) -> float:
    """How much of a change leaves positive values positive."""
    return min(1.0, _INSIDE / max(float(np.max(-change / value, initial=0.0)), 1e-9))
