"""The driver: chunks without seams, failures and stops that say where; and the adaptive method."""

from __future__ import annotations

import time
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from gbeam.integrate import Gauss4, LinearSystem, NonlinearSystem, integrate, integrate_adaptively, newmark
from gbeam.integrate.driver import CHUNK

from .systems import OSCILLATOR, PENDULUM, VARYING, reference, state

H = 0.02  # of the oscillator's period
ROUNDING = 1e-10
GIVES_UP = 40.0  # s, compilation included


def test_chunks_leave_no_seam() -> None:
    """Average acceleration turns the oscillator by φ = 2 arctan(ωh/2) each step: q_n = cos nφ, whatever the chunk."""
    count = CHUNK + CHUNK // 2
    run = integrate(OSCILLATOR, newmark(), state(1.0, 0.0), step=H, count=count)
    phi = 2 * np.arctan(np.pi * H)
    n = np.arange(count + 1)
    assert run.converged and not run.stopped
    np.testing.assert_allclose(run.time, H * n, rtol=1e-15)
    np.testing.assert_allclose(run.q[:, 0], np.cos(phi * n), atol=ROUNDING)
    np.testing.assert_allclose(run.qdd[:, 0], -((2 * np.pi) ** 2) * np.cos(phi * n), atol=ROUNDING * 100)


@pytest.mark.parametrize("count", [1, CHUNK - 1, CHUNK, CHUNK + 1])
def test_any_number_of_steps(count: int) -> None:
    run = integrate(OSCILLATOR, newmark(), state(1.0, 0.0), step=H, count=count)
    assert len(run.time) == len(run.q) == len(run.qd) == len(run.qdd) == count + 1
    assert run.q[-1, 0] == pytest.approx(np.cos(2 * np.arctan(np.pi * H) * count), abs=ROUNDING)


def test_inputs_are_taken_at_the_right_times() -> None:
    """q̈ = F(t) with F a ramp from the start: Newmark is exact for it, Gauss for a quintic too."""
    start, h, count = 3.0, 0.1, 20

    def matrices(f: Any) -> Any:
        return jnp.zeros((1, 1)), jnp.zeros((1, 1)), jnp.atleast_1d(f)

    run = integrate(
        LinearSystem(jnp.eye(1), matrices, lambda t: t), newmark(), state(0.0, 0.0), step=h, count=count, start=start
    )
    np.testing.assert_allclose(run.time, start + h * np.arange(count + 1))
    np.testing.assert_allclose(run.qdd[:, 0], run.time, rtol=1e-14)
    np.testing.assert_allclose(run.qd[:, 0], (run.time**2 - start**2) / 2, rtol=1e-12)
    cubic = LinearSystem(jnp.eye(1), matrices, lambda t: t**2)
    run = integrate(cubic, Gauss4(), state(0.0, start**3 / 3), step=h, count=count, start=start)
    np.testing.assert_allclose(run.q[:, 0], (run.time**4 - start**4) / 12, rtol=1e-12, atol=1e-12)


def test_times_do_not_drift() -> None:
    """Times are products, not sums: after thousands of steps they are still multiples of the step."""
    h = 0.1
    drive = LinearSystem(
        jnp.eye(1),
        lambda f: (jnp.zeros((1, 1)), jnp.zeros((1, 1)), jnp.atleast_1d(f)),
        lambda t: jnp.round(t / h) * h - t,
    )
    run = integrate(drive, newmark(), state(0.0, 0.0), step=h, count=2 * CHUNK)
    assert np.abs(run.qdd).max() < 1e-12


def test_stop_ends_the_run_where_it_says() -> None:
    calls = []

    def past_half(q: np.ndarray) -> int | None:
        calls.append(len(q))
        low = np.flatnonzero(q[:, 0] < 0.5)
        return int(low[0]) + 1 if low.size else None

    slow = LinearSystem(jnp.eye(1), lambda _: (jnp.zeros((1, 1)), jnp.eye(1), jnp.zeros(1)), jnp.zeros_like)
    run = integrate(slow, newmark(), state(1.0, 0.0), step=1e-3, count=5000, stop=past_half)
    assert run.stopped and run.converged
    assert calls == [CHUNK, CHUNK]  # the third chunk is not computed
    assert run.time[-1] == pytest.approx(np.pi / 3, abs=1e-3)
    assert run.q[-1, 0] < 0.5 <= run.q[-2, 0]


def test_progress_reaches_the_end() -> None:
    shares: list[float] = []
    integrate(OSCILLATOR, newmark(), state(1.0, 0.0), step=H, count=2500, progress=shares.append)
    assert shares == [0.4, 0.8, 1.0]


def _rootless(q: Any, qd: Any, qdd: Any, t: Any) -> Any:
    return qdd**2 - (1 - t)


def _undefined(q: Any, qd: Any, qdd: Any, t: Any) -> Any:
    return qdd - jnp.sqrt(1 - t)


@pytest.mark.parametrize("residual", [_rootless, _undefined], ids=["no root", "not a number"])
@pytest.mark.parametrize("count", [300, 3000])
def test_failure_ends_the_run_at_the_last_good_step(residual: Any, count: int) -> None:
    """From t = 1 s on there is no acceleration: the run says so and keeps what it has."""
    h, start = 3.0 / count, state(0.0, 0.0)._replace(qdd=jnp.ones(1))
    run = integrate(NonlinearSystem(residual, lambda t: t), newmark(), start, step=h, count=count)
    assert not run.converged and not run.stopped
    assert 1 - 3 * h < run.time[-1] < 1 + h / 2  # at the root's end Newton may give up a step early
    assert len(run.time) == len(run.q) == len(run.qdd)
    assert np.isfinite(run.q).all() and np.isfinite(run.qdd).all()


def test_failure_at_the_start() -> None:
    impossible = NonlinearSystem(lambda q, qd, qdd, t: qdd**2 + 1 + t, lambda t: t)
    run = integrate(impossible, newmark(), state(0.0, 0.0), step=0.1, count=10)
    assert not run.converged
    assert len(run.time) == 1


def test_singular_mass_is_a_failure_not_a_crash() -> None:
    massless = LinearSystem(
        jnp.zeros((1, 1)), lambda _: (jnp.zeros((1, 1)), jnp.zeros((1, 1)), jnp.ones(1)), jnp.zeros_like
    )
    run = integrate(massless, newmark(), state(0.0, 0.0), step=0.1, count=10)
    assert not run.converged


# --- adaptive


def test_adaptive_agrees_with_gauss_and_an_independent_method() -> None:
    times = np.linspace(0, 4, 81)
    found = integrate_adaptively(VARYING, state([0.5, -0.3], [0.0, 1.0]), times, tolerance=1e-9)
    gauss = integrate(VARYING, Gauss4(), state([0.5, -0.3], [0.0, 1.0]), step=4 / 800, count=800)
    assert found.converged
    np.testing.assert_array_equal(found.time, times)
    for ours, theirs in ((found.q, gauss.q), (found.qd, gauss.qd), (found.qdd, gauss.qdd)):
        np.testing.assert_allclose(ours, theirs[::10], atol=1e-6)
    end = reference(VARYING, [0.5, -0.3], [0.0, 1.0], 4.0)
    np.testing.assert_allclose(np.concatenate([found.q[-1], found.qd[-1]]), end, atol=1e-6)


def test_adaptive_error_follows_the_tolerance() -> None:
    end = reference(PENDULUM, 2.0, 0.5, 10.0)
    errors = []
    for tolerance in (1e-5, 1e-8):
        found = integrate_adaptively(PENDULUM, state(2.0, 0.5), np.array([0.0, 10.0]), tolerance=tolerance)
        errors.append(np.abs(np.array([found.q[-1, 0], found.qd[-1, 0]]) - end).max())
    assert errors[0] > 30 * errors[1]
    assert errors[1] < 1e-6


def test_adaptive_steps_end_at_corners_and_runs_end_where_told() -> None:
    """A load that is there for 0.1 s only is not stepped over."""

    def kick(t: Any) -> Any:
        return jnp.where((t >= 5.0) & (t < 5.1), 10.0, 0.0)

    free = LinearSystem(jnp.eye(1), lambda f: (jnp.zeros((1, 1)), jnp.zeros((1, 1)), jnp.atleast_1d(f)), kick)
    times = np.linspace(0, 10, 101)
    found = integrate_adaptively(free, state(0.0, 0.0), times, tolerance=1e-9, jumps=np.array([5.0, 5.1]))
    assert found.qd[-1, 0] == pytest.approx(1.0, rel=1e-7)
    assert found.q[-1, 0] == pytest.approx(4.95, rel=1e-7)
    short = integrate_adaptively(
        free,
        state(0.0, 0.0),
        times,
        tolerance=1e-9,
        jumps=np.array([5.0, 5.1]),
        stop=lambda q: int(np.argmax(q[:, 0] > 1)),
    )
    assert short.stopped and len(short.time) == int(np.argmax(found.q[:, 0] > 1))


def test_adaptive_failure() -> None:
    """q̈ = 6q² from q = 1, q̇ = 2 is 1/(1 − t)²: nothing beyond t = 1 s, and what there is, is finite."""
    blow_up = NonlinearSystem(lambda q, qd, qdd, f: qdd - 6 * q**2, jnp.zeros_like)
    began = time.perf_counter()
    found = integrate_adaptively(blow_up, state(1.0, 2.0), np.linspace(0, 2, 21), tolerance=1e-6)
    assert time.perf_counter() - began < GIVES_UP  # not after millions of ever smaller steps
    assert not found.converged
    assert found.time[-1] < 1.05
    assert np.isfinite(found.q).all()
    np.testing.assert_allclose(found.q[5], 4.0, rtol=1e-4)
