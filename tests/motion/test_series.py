"""Truncated Taylor series against symbolic differentiation, and the small numerics beside them."""

import numpy as np
import pytest
import sympy

from gbeam.numerics import (
    Series,
    arctan2,
    compose,
    cumulative,
    joined,
    power,
    sin_cos,
    sqrt,
    square,
    stack,
    true_runs,
    where,
)

T = np.array([-0.7, 0.0, 0.31, 1.9])
s = sympy.Symbol("s")
POLYNOMIAL = s**3 - 2 * s + 1
t = Series.variable(T, 5)
p = t**3 - 2 * t + 1

CASES = {
    "sum, product, power": (lambda: (p + t) * p - t**5 * 3 + 1, (POLYNOMIAL + s) * POLYNOMIAL - 3 * s**5 + 1),
    "quotient": (lambda: (1 + p) / (2 + t * t), (1 + POLYNOMIAL) / (2 + s**2)),
    "constants either side": (lambda: 3 - 2 * (p - 1) / 4, 3 - (POLYNOMIAL - 1) / 2),
    "square root": (lambda: sqrt(t * t + 2), sympy.sqrt(s**2 + 2)),
    "real power": (lambda: power(t * t + 2, -0.75), (s**2 + 2) ** sympy.Rational(-3, 4)),
    "sine": (lambda: sin_cos(p)[0], sympy.sin(POLYNOMIAL)),
    "cosine": (lambda: sin_cos(p)[1], sympy.cos(POLYNOMIAL)),
    "angle": (lambda: arctan2(p, t - 3), sympy.atan2(POLYNOMIAL, s - 3)),
    "a function of known derivatives": (
        lambda: compose([np.exp(p.value)] * 6, p),
        sympy.exp(POLYNOMIAL),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_coefficients_are_the_symbolic_derivatives(name: str) -> None:
    built, expression = CASES[name][0](), CASES[name][1]
    for value in built.derivatives():
        exact = np.array([float(expression.subs(s, sympy.Float(x, 30))) for x in T])
        expression = sympy.diff(expression, s)
        np.testing.assert_allclose(value, exact, rtol=1e-11, atol=1e-11 * (1 + np.abs(exact).max()))


def test_rate_truncation_and_orders() -> None:
    np.testing.assert_allclose(p.rate().derivatives(), p.derivatives()[1:])
    assert p.rate().order == 4 and (p * t.truncated(2)).order == 2 and Series.variable(0.5, 0).derivatives() == (0.5,)


def test_vectors() -> None:
    vector = stack([p, t, 0.0 * t + 2.0])
    assert vector.value.shape == (4, 3)
    np.testing.assert_allclose(vector[..., 0].derivatives(), p.derivatives())
    np.testing.assert_allclose(square(vector).derivatives(), (p * p + t * t + 4).derivatives(), atol=1e-12)
    np.testing.assert_allclose((np.array([1.0, 2.0, 3.0]) * vector).value[:, 1], 2 * T)


def test_where_takes_constants() -> None:
    built = where(T > 0, p, 7.0)
    np.testing.assert_allclose(built.value, np.where(T > 0, p.value, 7.0))
    np.testing.assert_allclose(built.derivatives()[1], np.where(T > 0, p.derivatives()[1], 0.0))


def test_runs_of_true_flags() -> None:
    flags = np.array([1, 1, 0, 0, 1, 0, 1, 1], dtype=bool)
    runs = true_runs(flags)
    assert runs == [slice(0, 2), slice(4, 5), slice(6, 8)]
    assert true_runs(~np.ones(3, bool)) == [] and true_runs(np.ones(3, bool)) == [slice(0, 3)]
    assert joined(runs, 0.1 * np.arange(8), 0.25) == [slice(0, 2), slice(4, 8)]


def test_the_corrected_trapezium_rule_is_of_fourth_order() -> None:
    errors = []
    for n in (11, 21):
        time = np.linspace(0, 2, n)
        errors.append(np.abs(cumulative(time, np.cos(time), -np.sin(time)) - np.sin(time)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.1)
