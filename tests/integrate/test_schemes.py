"""The schemes against their theory: period elongation, damping, observed order.

Newmark 1959; Hilber, Hughes and Taylor 1977; Chung and Hulbert 1993; Hairer, Nørsett and Wanner, II.7.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gbeam import InputError
from gbeam.arrays import namespace, record
from gbeam.integrate import (
    Corners,
    LinearEquations,
    NonlinearEquations,
    Scheme,
    chunk,
    gauss,
    generalized_alpha,
    hht,
    integrate,
    make_steps,
    newmark,
)
from validation.published.tables import SCHEMES_THEORY

from .systems import BEAD, OSCILLATOR, PENDULUM, VARYING, Pushed, driven, reference

SCHEMES = {
    "Newmark": newmark(),
    "HHT -0.1": hht(-0.1),
    "generalised-α 0.9": generalized_alpha(0.9),
    "generalised-α 0.5": generalized_alpha(0.5),
}
DIGITS = 1e-3  # the theory's numbers have four or five


def amplification(scheme: Scheme, h: float) -> np.ndarray:
    """Matrix of one step on what the scheme carries: q, q̇ and, where it damps, its own acceleration."""
    carried, steps = [np.reshape(z, (-1, 1)) for z in np.eye(len(scheme.unit.g))], make_steps(0.0, h, 1)
    columns = [chunk(OSCILLATOR, scheme, z, steps)[0][:, 0] for z in carried]
    return np.array(columns).T


def principal_root(matrix: np.ndarray) -> complex:
    """The eigenvalue that turns: the other one of its pair is its conjugate, a third is real."""
    roots = np.linalg.eigvals(matrix)
    return roots[np.argmax(np.abs(roots) * (roots.imag > 0))]


@pytest.mark.parametrize("name", SCHEMES_THEORY)
def test_period_elongation_and_damping_of_an_undamped_oscillator(name: str) -> None:
    for h, (elongation, damping) in SCHEMES_THEORY[name][0].items():
        principal = principal_root(amplification(SCHEMES[name], h))
        angle, decay = np.angle(principal), -np.log(np.abs(principal))
        assert 2 * np.pi * h / angle - 1 == pytest.approx(elongation, rel=DIGITS)
        assert decay / np.hypot(angle, decay) == pytest.approx(damping, rel=DIGITS, abs=1e-11)


@pytest.mark.parametrize("name", SCHEMES_THEORY)
def test_spectral_radius_at_infinite_frequency(name: str) -> None:
    """And nowhere above one on the way there: unconditionally stable."""
    radius = [np.abs(np.linalg.eigvals(amplification(SCHEMES[name], h))).max() for h in np.logspace(-2, 4, 31)]
    assert max(radius) < 1 + 1e-7
    assert radius[-1] == pytest.approx(SCHEMES_THEORY[name][1], abs=1e-3)


def test_gauss_neither_damps_nor_loses_stability() -> None:
    for h in np.logspace(-2, 3, 11):
        exact = amplification(gauss(), h)
        assert exact.shape == (2, 2)  # no acceleration of its own
        np.testing.assert_allclose(np.abs(np.linalg.eigvals(exact)), 1, atol=1e-9)
    angle = np.angle(np.linalg.eigvals(amplification(gauss(), 0.05))).max()
    z = 2 * np.pi * 0.05  # of the diagonal Padé approximant (12 + 6iz − z²)/(12 − 6iz − z²)
    assert angle == pytest.approx(2 * np.arctan2(6 * z, 12 - z**2), rel=1e-12)


def observed_order(system: Any, scheme: Any, steps: int, end: float, q: Any, qd: Any) -> tuple[float, float]:
    """Order from halving the step, for q and q̇ at the end."""
    exact = reference(system, q, qd, end)
    errors = []
    for count in (steps, 2 * steps):
        run = integrate(system, scheme, np.atleast_1d(q), np.atleast_1d(qd), step=end / count, count=count)
        assert run.converged
        errors.append(np.abs(np.concatenate([run.q[-1], run.qd[-1]]) - exact).reshape(2, -1).max(axis=1))
    return tuple(np.log2(errors[0] / errors[1]))


@pytest.mark.parametrize("name", SCHEMES)
def test_one_step_schemes_are_of_second_order(name: str) -> None:
    scheme = SCHEMES[name]
    assert scheme.order == 2
    for system, q, qd in ((VARYING, [0.5, -0.3], [0.0, 1.0]), (PENDULUM, 2.0, 0.5), (BEAD, 1.0, 0.5)):
        order = observed_order(system, scheme, 200, 4.0, q, qd)
        assert order == pytest.approx((2, 2), abs=0.1)


@pytest.mark.parametrize(
    ("system", "q", "qd"), [(VARYING, [0.5, -0.3], [0.0, 1.0]), (PENDULUM, 2.0, 0.5), (BEAD, 1.0, 0.5)]
)
def test_gauss_is_of_fourth_order(system: Any, q: Any, qd: Any) -> None:
    assert gauss().order == 4
    assert observed_order(system, gauss(), 40, 4.0, q, qd) == pytest.approx((4, 4), abs=0.1)


def test_known_members_of_the_family() -> None:
    """HHT(0) and generalised-α(1) are Newmark's average acceleration; the parameters are the authors' own."""
    wanted = principal_root(amplification(newmark(), 0.1))
    for member in (hht(0.0), generalized_alpha(1.0)):
        matrix = amplification(member, 0.1)
        assert np.angle(principal_root(matrix)) == pytest.approx(np.angle(wanted), rel=1e-9)
        np.testing.assert_allclose(np.abs(np.linalg.eigvals(matrix)).max(), 1, rtol=1e-9)
    middle = generalized_alpha(0.5)
    assert parameters(middle) == pytest.approx((0, 1 / 3, 5 / 6, 4 / 9))


def parameters(scheme: Scheme) -> tuple[float, float, float, float]:
    """α_m, α_f, γ and β from the tableau at a step of 1 s."""
    t = scheme.unit
    known, carried = t.initial[2, 2], t.d[2, 0]  # (α_f − α_m)/(1 − α_m), and that over 1 − α_m
    alpha_m = 1 - known / carried
    return alpha_m, alpha_m + known * (1 - alpha_m), t.c_v[0, 0] / (1 - known), t.c_q[0, 0] / (1 - known)


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: newmark(0.25, 0.4), "beta"),
        (lambda: newmark(0.2, 0.5), "beta"),
        (lambda: newmark(float("nan")), "beta"),
        (lambda: hht(0.1), "alpha"),
        (lambda: hht(-0.4), "alpha"),
        (lambda: generalized_alpha(1.1), "rho_inf"),
        (lambda: generalized_alpha(-0.1), "rho_inf"),
    ],
)
def test_unstable_parameters_are_refused(make: Callable[[], Scheme], where: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.where == where
    assert caught.value.fix


CORNERS = [0.37, 1.1, 2.03]  # a jump, a corner and a jump, none at a step's end


def cornered(t: Any) -> Any:
    xp = namespace(t)
    return xp.where(t < 0.37, 0.0, 1.0) * xp.cos(3 * t) + 2 * xp.maximum(t - 1.1, 0) - xp.where(t < 2.03, 0.0, 1.5)


@record
class Duffing:
    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return qdd + 0.2 * qd + 20 * q + 5 * q**3 - force[..., None]


def duffing_at(end: float, cubic: float) -> np.ndarray:
    """(q, q̇) at the end, by an explicit method that starts anew at the corners."""
    state = np.array([0.3, 0.0])
    for begin, stop in itertools.pairwise([0.0, *CORNERS, end]):

        def right(t: float, y: np.ndarray, low: float = begin + 1e-12, high: float = stop - 1e-12) -> np.ndarray:
            force = float(cornered(np.clip(t, low, high)))
            return np.array([y[1], force - 0.2 * y[1] - 20 * y[0] - cubic * y[0] ** 3])

        state = solve_ivp(right, (begin, stop), state, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return state


def linear_duffing() -> LinearEquations:
    def matrices(f: Any) -> Any:
        ones = np.ones((len(f), 1, 1))
        return 0.2 * ones, 20 * ones, f[:, None]

    return LinearEquations(np.eye(1), matrices, cornered)


@pytest.mark.parametrize("name", ["Newmark", "HHT -0.1", "generalised-α 0.5", "Gauss"])
@pytest.mark.parametrize("kind", ["linear", "nonlinear"])
def test_corners_and_jumps_between_steps_leave_the_order(kind: str, name: str) -> None:
    """Steps that pass over them leave every scheme of first order here."""
    system: Any = linear_duffing() if kind == "linear" else NonlinearEquations(Duffing(), cornered)
    scheme, exact = {**SCHEMES, "Gauss": gauss()}[name], duffing_at(3.0, 0.0 if kind == "linear" else 5.0)
    corners = Corners.from_times(CORNERS, cornered, 0.0, 3.0)
    np.testing.assert_array_equal(corners.jump, [True, False, True])

    def error(count: int, known: Corners | None) -> float:
        run = integrate(system, scheme, np.array([0.3]), np.zeros(1), step=3 / count, count=count, corners=known)
        assert run.reached_end and len(run.time) == len(run.qdd) == count + 1
        return float(np.abs([run.q[-1, 0], run.qd[-1, 0]] - exact).max())

    counts = (50, 100) if scheme.order > 2 else (400, 800)
    assert np.log2(error(counts[0], corners) / error(counts[1], corners)) == pytest.approx(scheme.order, abs=0.2)
    assert scheme.order == 2 or error(counts[1], None) > 100 * error(counts[1], corners)


def test_results_at_a_jump_are_those_of_the_time_itself() -> None:
    """A step ends at the load from the left and the next begins with that from the right; the result has the latter."""
    kick = lambda t: namespace(t).where(t < 1.0, 0.0, 1.0)  # noqa: E731
    for scheme in (newmark(), generalized_alpha(0.8), gauss()):
        for system in (driven(1.0, kick), NonlinearEquations(Pushed(), kick)):
            corners = Corners.from_times([1.0], kick, 0.0, 2.0)
            run = integrate(system, scheme, np.zeros(1), np.zeros(1), step=0.1, count=20, corners=corners)
            after = np.maximum(run.time - 1, 0)
            np.testing.assert_allclose(run.q[:, 0], after**2 / 2, atol=1e-8)
            np.testing.assert_allclose(run.qd[:, 0], after, atol=1e-8)
            np.testing.assert_allclose(run.qdd[:, 0], kick(run.time), atol=1e-12)
