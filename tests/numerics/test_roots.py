"""Roots between bounds, against SciPy's Brent."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
import scipy.optimize

from gbeam.numerics.solvers.roots import brent

CASES: dict[str, tuple[Callable[[float], float], float, float]] = {
    "cosine": (lambda x: math.cos(x) - x, 0.0, 2.0),
    "falling": (lambda x: 1 - x**3, -3.0, 5.0),
    "curved": (lambda x: math.exp(x) - 1e3, -5.0, 50.0),
    "steep": (lambda x: math.atan(1e6 * (x - 0.123)), -1.0, 1.0),
    "step": (lambda x: 1.0 if x > 0.3 else -1.0, 0.0, 1.0),
}


@pytest.mark.parametrize("name", CASES)
def test_as_good_and_as_quick_as_scipy(name: str) -> None:
    function, low, high = CASES[name]
    calls = 0

    def counted(x: float) -> float:
        nonlocal calls
        calls += 1
        return function(x)

    root = brent(counted, low, high, xtol=1e-12)
    ours, calls = calls, 0
    expected = scipy.optimize.brentq(counted, low, high, xtol=1e-12)
    assert root == pytest.approx(expected, abs=2e-12)
    assert ours <= calls + 5


def test_at_a_bound_and_without_a_root() -> None:
    assert brent(lambda x: x, 0.0, 1.0) == 0.0 and brent(lambda x: x - 1, 0.0, 1.0) == 1.0
    with pytest.raises(ValueError, match="same sign"):
        brent(lambda x: x * x + 1, 0.0, 1.0)
