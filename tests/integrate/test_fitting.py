"""Steps fitted to the vibration at rest: exact there, and of the scheme's order elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from gbeam.integrate import LinearEquations, NonlinearEquations, fitting_terms, gauss, integrate, newmark

from .systems import PENDULUM, VARYING

MASS = np.array([[2.0, 0.3], [0.3, 1.0]])
STIFFNESS = np.array([[5.0, -1.0], [-1.0, 9.0]])
SQUARE, SHAPES = eigh(STIFFNESS, MASS)  # of unit length in M
FREQUENCY = np.sqrt(SQUARE)
STEP = 0.6  # s: the faster mode turns by nearly 2 rad in it


def vibrating(ratio: float) -> LinearEquations:
    """Two modes of one damping ratio, undriven."""
    damping = MASS @ SHAPES * (2 * ratio * FREQUENCY) @ SHAPES.T @ MASS

    def matrices(t: Any) -> Any:
        return *(np.broadcast_to(x, (len(t), 2, 2)) for x in (damping, STIFFNESS)), np.zeros((len(t), 2))

    return LinearEquations(MASS, matrices, lambda t: t, rest=(damping, STIFFNESS))


@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.3])
def test_free_vibration_keeps_its_phase_and_decay(ratio: float) -> None:
    """From rest in a displaced state, 100 steps of a third of a period: the classical steps lose their time."""
    equations, start = vibrating(ratio), np.array([0.3, -0.2])
    every = equations, replace(equations, rest=None)
    fitted, classical = (integrate(each, gauss(), start, np.zeros(2), step=STEP, count=100) for each in every)
    decay, turning = -ratio * FREQUENCY, FREQUENCY * np.sqrt(1 - ratio**2)
    assert 1.6 < turning.max() * STEP < 2.0

    # A mode's two states a and b with q = e^(decay t) (a cos + b sin): from two steps all others follow.
    def extrapolated(q: np.ndarray) -> np.ndarray:
        modal, t = q @ MASS @ SHAPES, STEP * np.arange(len(q))[:, None]
        wave = np.exp(decay * t) * np.stack([np.cos(turning * t), np.sin(turning * t)])
        b = (modal[1] - modal[0] * wave[0, 1]) / wave[1, 1]
        return np.asarray((modal[0] * wave[0] + b * wave[1]) @ SHAPES.T)

    size = np.abs(start).max()
    np.testing.assert_allclose(fitted.q, extrapolated(fitted.q), atol=1e-11 * size)
    t = STEP * np.arange(101)[:, None]
    wave = np.exp(decay * t) * (np.cos(turning * t) - decay / turning * np.sin(turning * t))
    exact = (start @ MASS @ SHAPES * wave) @ SHAPES.T
    np.testing.assert_allclose(fitted.q, exact, atol=(1e-11 if ratio == 0 else 0.03) * size)
    assert ratio > 0.1 or np.abs(classical.q - exact).max() > 0.3 * size


def test_the_deflection_under_a_steady_load_is_the_elastic_one() -> None:
    equations, force = vibrating(0.01), np.array([1.0, 2.0])
    rest = np.linalg.solve(STIFFNESS, force)
    loaded = replace(equations, matrices=lambda t: (*equations.matrices(t)[:2], np.broadcast_to(force, (len(t), 2))))
    run = integrate(loaded, gauss(), rest, np.zeros(2), step=STEP, count=50)
    np.testing.assert_allclose(run.q, np.broadcast_to(rest, run.q.shape), rtol=1e-12)


def test_fitted_steps_have_the_order_of_the_scheme_where_the_matrices_vary() -> None:
    """Fitted to a symmetric part of what is neither symmetric nor constant."""
    fitted, start = (
        replace(VARYING, rest=(0.1 * np.eye(2), np.diag([4.0, 9.0]))),
        (np.array([1.0, -0.5]), np.array([0.3, 0.2])),
    )
    truth = integrate(VARYING, gauss(), *start, step=4 / 2560, count=2560).q[-1]
    errors = [
        np.abs(integrate(fitted, gauss(), *start, step=4 / count, count=count).q[-1] - truth).max()
        for count in (40, 80, 160)
    ]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx((4, 4), abs=0.2)


@pytest.mark.parametrize("ratio", [0.0, 0.02])
def test_nonlinear_equations_are_fitted_as_linear_ones_are(ratio: float) -> None:
    linear = vibrating(ratio)
    assert linear.rest is not None
    damping, stiffness = linear.rest

    def residual(q: Any, qd: Any, qdd: Any, t: Any) -> Any:
        return qdd @ linear.mass + qd @ damping + q @ stiffness

    equations = NonlinearEquations(residual, lambda t: t, idle_inputs=np.zeros(1))

    def run(of: Any) -> Any:
        return integrate(of, gauss(), np.array([1.0, -0.5]), np.array([0.3, 0.2]), step=STEP, count=50)

    expected, fitted, plain = map(run, (linear, equations, replace(equations, idle_inputs=None)))
    for name in ("q", "qd", "qdd"):
        want, size = getattr(expected, name), np.abs(getattr(expected, name)).max()
        np.testing.assert_allclose(getattr(fitted, name), want, atol=1e-9 * size)
        assert np.abs(getattr(plain, name) - want).max() > 1e-3 * size


def test_fitted_steps_of_nonlinear_equations_have_the_order_of_the_scheme() -> None:
    fitted, start = replace(PENDULUM, idle_inputs=np.zeros(1)), (np.array([0.8]), np.array([0.3]))
    truth = integrate(PENDULUM, gauss(), *start, step=4 / 2560, count=2560).q[-1]
    errors = [
        np.abs(integrate(fitted, gauss(), *start, step=4 / count, count=count).q[-1] - truth).max()
        for count in (40, 80, 160)
    ]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx((4, 4), abs=0.2)


def test_a_scheme_that_does_not_fit_and_a_mode_without_vibration_add_nothing() -> None:
    equations = vibrating(0.01)
    none = np.zeros((2, 2))
    for each, scheme in ((equations, newmark()), (replace(equations, rest=None), gauss())):
        np.testing.assert_array_equal(fitting_terms(each, scheme, STEP), (none, none))
    creeping = vibrating(1.2)
    np.testing.assert_array_equal(fitting_terms(creeping, gauss(), STEP), (none, none))
    small = fitting_terms(equations, gauss(), STEP / 100), fitting_terms(equations, gauss(), STEP / 50)
    for few, twice in zip(*small, strict=True):
        assert np.abs(twice).max() == pytest.approx(16 * np.abs(few).max(), rel=1e-2)


def test_a_mode_that_grows_without_turning_is_left_as_it_is() -> None:
    """A hub's own rotation has no stiffness but rounding's, and the base's motion may feed it: NaN came of it."""
    equations = LinearEquations(
        np.eye(2), lambda _: (), lambda t: t, rest=(np.diag([-2e-5, 0.1]), np.diag([4e-12, 5.0]))
    )
    mass, damping = fitting_terms(equations, gauss(), 0.04)
    assert np.isfinite(mass).all() and np.isfinite(damping).all()
    assert mass[0, 0] == damping[0, 0] == 0.0 != mass[1, 1]


@pytest.mark.parametrize("rate", [1e-4, -1e-4])
def test_a_mode_that_hardly_vibrates_is_left_as_it_is(rate: float) -> None:
    """A free hub's rigid mode: of a frequency that is rounding, and a decay, or a growth, that is many times that."""
    damping, stiffness = np.diag([rate, 0.1]), np.diag([1e-12, 9.0])
    equations = replace(vibrating(0.0), mass=np.eye(2), rest=(damping, stiffness))
    mass, decay = fitting_terms(equations, gauss(), STEP)
    assert np.isfinite(mass).all() and np.isfinite(decay).all()
    assert not mass[0].any() and not decay[0].any() and mass[1, 1] != 0
