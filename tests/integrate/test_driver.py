"""The driver: chunks without seams, failures and stops that say where."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam.arrays import namespace, record
from gbeam.integrate import CHUNK, LINEAR_CHUNK, LinearEquations, NonlinearEquations, gauss, integrate, newmark

from .systems import OSCILLATOR, VARYING, Bead, Pushed, driven, one, undriven

H = 0.02  # of the oscillator's period
ROUNDING = 1e-10


def test_chunks_leave_no_seam() -> None:
    """Average acceleration turns the oscillator by φ = 2 arctan(ωh/2) each step: q_n = cos nφ, whatever the chunk."""
    count = LINEAR_CHUNK + LINEAR_CHUNK // 2
    run = integrate(OSCILLATOR, newmark(), one(1.0), one(0.0), step=H, count=count)
    phi = 2 * np.arctan(np.pi * H)
    n = np.arange(count + 1)
    assert run.converged and not run.stopped
    np.testing.assert_allclose(run.time, H * n, rtol=1e-15)
    np.testing.assert_allclose(run.q[:, 0], np.cos(phi * n), atol=ROUNDING)
    np.testing.assert_allclose(run.qdd[:, 0], -((2 * np.pi) ** 2) * np.cos(phi * n), atol=ROUNDING * 100)


@pytest.mark.parametrize("count", [1, LINEAR_CHUNK - 1, LINEAR_CHUNK, LINEAR_CHUNK + 1])
def test_any_number_of_steps(count: int) -> None:
    run = integrate(OSCILLATOR, newmark(), one(1.0), one(0.0), step=H, count=count)
    assert len(run.time) == len(run.q) == len(run.qd) == len(run.qdd) == count + 1
    assert run.q[-1, 0] == pytest.approx(np.cos(2 * np.arctan(np.pi * H) * count), abs=ROUNDING)


@pytest.mark.parametrize("scheme", [newmark(), gauss()], ids=["newmark", "gauss"])
def test_nonlinear_chunks_leave_no_seam(scheme: Any) -> None:
    """Any number of steps is the beginning of a longer run, and the bead keeps its energy across the chunks."""
    undriven_bead = NonlinearEquations(Bead(), undriven)
    runs = [
        integrate(undriven_bead, scheme, one(1.0), one(0.5), step=H / 2, count=count)
        for count in (2 * CHUNK + 7, 1, CHUNK - 1, CHUNK, CHUNK + 1)
    ]
    longest = runs[0]
    energy = (((1 + longest.q**2) * longest.qd**2 + longest.q**2) / 2)[:, 0]
    np.testing.assert_allclose(energy, energy[0], rtol={"newmark": 1e-4, "gauss": 1e-8}[scheme.name])
    for run, count in zip(runs[1:], (1, CHUNK - 1, CHUNK, CHUNK + 1), strict=True):
        assert len(run.time) == len(run.q) == len(run.qd) == len(run.qdd) == count + 1
        np.testing.assert_allclose(run.q, longest.q[: count + 1], atol=1e-9)


@pytest.mark.parametrize("scheme", [newmark(), gauss()], ids=["newmark", "gauss"])
def test_coordinates_that_nothing_couples_move_as_they_would_alone(scheme: Any) -> None:
    """Two systems as one, the second's coordinate between those of the first."""

    def joined(outer: Any, inner: Any) -> Any:
        built = np.zeros((*outer.shape[:-2], 3, 3))
        built[..., ::2, ::2], built[..., 1:2, 1:2] = outer, inner
        return built

    def matrices(t: Any) -> Any:
        (c, k, f), (c1, k1, f1) = VARYING.matrices(t), OSCILLATOR.matrices(undriven(t))
        return joined(c, c1), joined(k, k1), np.stack([f[:, 0], f1[:, 0], f[:, 1]], axis=1)

    both = LinearEquations(joined(VARYING.mass, OSCILLATOR.mass), matrices, VARYING.drive)
    options = {"step": H, "count": LINEAR_CHUNK + 20}
    run = integrate(both, scheme, np.array([0.1, 1.0, -0.2]), np.array([0.5, 0.0, 0.3]), **options)
    outer = integrate(VARYING, scheme, np.array([0.1, -0.2]), np.array([0.5, 0.3]), **options)
    inner = integrate(OSCILLATOR, scheme, one(1.0), one(0.0), **options)
    for built, first, second in zip(*((x.q, x.qd, x.qdd) for x in (run, outer, inner)), strict=True):
        np.testing.assert_allclose(built[:, ::2], first, atol=ROUNDING)
        np.testing.assert_allclose(built[:, 1:2], second, atol=ROUNDING)


@pytest.mark.parametrize("scheme", [newmark(), gauss()], ids=["newmark", "gauss"])
def test_steps_of_the_same_inputs_share_a_map(scheme: Any) -> None:
    """A drive that rests from 1 s on, whose equations are asked for once then, and not of every step."""
    asked, resting = list[int](), lambda t: np.minimum(t, 1.0)

    def matrices(t: Any) -> Any:
        asked.append(len(t))
        return VARYING.matrices(t)

    state, options = (np.array([0.1, -0.2]), np.array([0.5, 0.3])), {"step": H, "count": LINEAR_CHUNK}
    shared = integrate(LinearEquations(VARYING.mass, matrices, resting), scheme, *state, **options)
    moved = sum(shared.time[:-1] < 1.0)
    assert len(scheme.offsets) * moved <= max(asked) <= len(scheme.offsets) * (moved + 2) < LINEAR_CHUNK
    every = LinearEquations(VARYING.mass, lambda t: VARYING.matrices(resting(t)), lambda t: t)
    alone = integrate(every, scheme, *state, **options)
    np.testing.assert_allclose(shared.q, alone.q, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(shared.qd, alone.qd, rtol=0, atol=ROUNDING)


def test_inputs_are_taken_at_the_right_times() -> None:
    """q̈ = F(t) with F a ramp from the start: Newmark is exact for it, Gauss for a quintic too."""
    start, h, count = 3.0, 0.1, 20
    run = integrate(driven(1.0, lambda t: t), newmark(), one(0.0), one(0.0), step=h, count=count, start=start)
    np.testing.assert_allclose(run.time, start + h * np.arange(count + 1))
    np.testing.assert_allclose(run.qdd[:, 0], run.time, rtol=1e-14)
    np.testing.assert_allclose(run.qd[:, 0], (run.time**2 - start**2) / 2, rtol=1e-12)
    cubic = driven(1.0, lambda t: t**2)
    run = integrate(cubic, gauss(), one(0.0), one(start**3 / 3), step=h, count=count, start=start)
    np.testing.assert_allclose(run.q[:, 0], (run.time**4 - start**4) / 12, rtol=1e-12, atol=1e-12)


def test_inputs_of_a_residual_are_taken_at_the_right_times() -> None:
    start, h, count = 3.0, 0.1, 20
    pushed = NonlinearEquations(Pushed(), lambda t: t**2)
    run = integrate(pushed, gauss(), one(0.0), one(start**3 / 3), step=h, count=count, start=start)
    np.testing.assert_allclose(run.qdd[:, 0], run.time**2, rtol=1e-12)
    np.testing.assert_allclose(run.q[:, 0], (run.time**4 - start**4) / 12, rtol=1e-12, atol=1e-12)


def test_times_do_not_drift() -> None:
    """Times are products, not sums: after thousands of steps they are still multiples of the step."""
    h = 0.1
    drive = driven(1.0, lambda t: np.round(t / h) * h - t)
    run = integrate(drive, newmark(), one(0.0), one(0.0), step=h, count=4 * LINEAR_CHUNK)
    assert np.abs(run.qdd).max() < 1e-12


def test_stop_ends_the_run_where_it_says() -> None:
    calls = []

    def past_half(q: np.ndarray) -> int | None:
        calls.append(len(q))
        low = np.flatnonzero(q[:, 0] < 0.5)
        return int(low[0]) + 1 if low.size else None

    slow = driven(1.0, undriven, 1.0)
    run = integrate(slow, newmark(), one(1.0), one(0.0), step=1e-3, count=5000, stop=past_half)
    assert run.stopped and run.converged
    assert calls == [LINEAR_CHUNK] * 3  # the fourth chunk is not computed
    assert run.time[-1] == pytest.approx(np.pi / 3, abs=1e-3)
    assert run.q[-1, 0] < 0.5 <= run.q[-2, 0]


def test_progress_reaches_the_end() -> None:
    shares: list[float] = []
    integrate(OSCILLATOR, newmark(), one(1.0), one(0.0), step=H, count=1250, progress=shares.append)
    assert shares == [0.0, 0.4, 0.8, 1.0]


@record
class Rootless:
    """q̈ + k q² + L = 0, the load L from t = 1 s on: no step of these lengths has a solution with it."""

    def __call__(self, q: Any, qd: Any, qdd: Any, t: Any) -> Any:
        return qdd + 1e7 * q**2 + namespace(t).where(t > 1 - 1e-9, 1e7, 0.0)[..., None]


@record
class Massless:
    """(1 or 0) q̈ = 1: no mass from t = 1 s on."""

    def __call__(self, q: Any, qd: Any, qdd: Any, t: Any) -> Any:
        return namespace(t).where(t > 1 - 1e-9, 0.0, 1.0)[..., None] * qdd - 1


@record
class Undefined:
    def __call__(self, q: Any, qd: Any, qdd: Any, t: Any) -> Any:
        return qdd - namespace(t).sqrt(1 - t)[..., None]


@pytest.mark.parametrize("residual", [Rootless(), Massless(), Undefined()], ids=["no root", "no mass", "not a number"])
@pytest.mark.parametrize("count", [300, 3000])
def test_failure_ends_the_run_at_the_last_good_step(residual: Any, count: int) -> None:
    """From t = 1 s on there is no acceleration: the run says so and keeps what it has."""
    h = 3.0 / count
    run = integrate(NonlinearEquations(residual, lambda t: t), newmark(), one(0.0), one(0.0), step=h, count=count)
    assert not run.converged and not run.stopped
    assert 1 - 3 * h < run.time[-1] < 1 + h / 2  # at the root's end Newton may give up a step early
    assert len(run.time) == len(run.q) == len(run.qdd)
    assert np.isfinite(run.q).all() and np.isfinite(run.qdd).all()


@record
class Impossible:
    def __call__(self, q: Any, qd: Any, qdd: Any, t: Any) -> Any:
        return qdd**2 + 1 + t[..., None]


def test_failure_at_the_start() -> None:
    impossible = NonlinearEquations(Impossible(), lambda t: t)
    run = integrate(impossible, newmark(), one(0.0), one(0.0), step=0.1, count=10)
    assert not run.converged
    assert len(run.time) == 1


def test_singular_mass_is_a_failure_not_a_crash() -> None:
    massless = driven(0.0, lambda t: 0 * t + 1)
    run = integrate(massless, newmark(), one(0.0), one(0.0), step=0.1, count=10)
    assert not run.converged
