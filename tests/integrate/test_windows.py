"""Windows of steps: what the compiled way finds step by step, whatever their sizes, and nothing is compiled."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import jax
import numpy as np
import pytest

from gbeam.arrays import namespace, record
from gbeam.integrate import (
    Corners,
    LinearEquations,
    NonlinearEquations,
    accelerations,
    derivatives,
    gauss,
    generalized_alpha,
    integrate,
    newmark,
    slopes,
    verdict,
)

from ..lagrange import quickly_compiled

PUSH = 1.3  # s: the load jumps


@record
class Swing:
    """Two pendulums in one frame, coupled through their masses, far from linear; a load that turns with the first."""

    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        xp = namespace(q, qd, qdd, force)
        (a, b), (u, v), (x, y) = ((each[..., 0], each[..., 1]) for each in (q, qd, qdd))
        c, s = xp.cos(a - b), xp.sin(a - b)
        first = 2 * x + c * y + s * v**2 + 20 * xp.sin(a) + 0.1 * u - force[..., 0] * xp.cos(a)
        second = y + c * x - s * u**2 + 10 * xp.sin(b) - force[..., 1]
        return xp.stack(xp.broadcast_arrays(first, second), axis=-1)


def load(t: Any) -> Any:
    xp = namespace(t)
    return xp.stack([xp.where(t < PUSH, 0.0, 8.0) + 0 * t, 3 * xp.sin(5 * t)], axis=-1)


SWING = NonlinearEquations(Swing(), load)
START = np.array([1.2, -0.7]), np.array([0.5, 3.0])
KNOWN = {"step": 0.01, "count": 300, "corners": Corners.from_times([PUSH], load, 0.0, 3.0)}


@record
class Pushed:
    """A unit mass under a force."""

    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return qdd - force


def push(t: Any) -> Any:
    return namespace(t).where(t < PUSH, 0.0, 8.0)[..., None] + 0 * t[..., None]


def constant_terms(force: Any) -> Any:
    return 0 * force[..., None], 0 * force[..., None], force


@pytest.mark.parametrize("make", [newmark, lambda: generalized_alpha(0.7), gauss])
@pytest.mark.parametrize(
    "equations",
    [NonlinearEquations(Pushed(), push), LinearEquations(np.eye(1), constant_terms, push)],
    ids=["windows", "linear"],
)
def test_accelerations_are_renewed_where_a_load_jumps(make: Any, equations: Any) -> None:
    """A mass that a force pushes from 1.3 s on, within a step: every scheme finds its parabola to rounding."""
    known = {"step": 0.04, "count": 100, "corners": Corners.from_times([PUSH], push, 0.0, 4.0)}
    built = integrate(equations, make(), np.zeros(1), np.zeros(1), **known)
    pushed = np.maximum(built.time - PUSH, 0.0)
    np.testing.assert_allclose(built.qd[:, 0], 8 * pushed, atol=1e-9)
    np.testing.assert_allclose(built.q[:, 0], 4 * pushed**2, atol=1e-9)
    np.testing.assert_allclose(built.qdd[:, 0], np.where(pushed > 0, 8.0, 0.0), atol=1e-9)


@pytest.mark.parametrize("make", [newmark, lambda: generalized_alpha(0.7), gauss])
def test_windows_find_what_the_compiled_steps_find(make: Any) -> None:
    """Newton's method proper, step by step, is what JAX traces; only schemes without a stage at the end meet a jump."""
    scheme = make()
    driven = NonlinearEquations(Swing(), load if not scheme.ends else lambda t: load(t + PUSH))

    def run(q: Any, qd: Any) -> Any:
        built = integrate(driven, scheme, q, qd, **KNOWN if not scheme.ends else {"step": 0.01, "count": 300})
        return built.q, built.qd, built.qdd

    for built, expected in zip(run(*START), jax.jit(run)(*START), strict=True):
        assert isinstance(built, np.ndarray) and len(built) == 301
        np.testing.assert_allclose(built, expected, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("make", [newmark, gauss])
def test_no_digit_that_counts_depends_on_the_windows(make: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = integrate(SWING, make(), *START, **KNOWN)
    other = (
        {"window.FIRST": 1, "window.MOST": 1},
        {"window.FIRST": 7, "window.MOST": 13},
        {"derivatives.STALE": 0.1},
        {"verdict.LATE": 2, "verdict.MOVED": 0.5},
    )
    for sizes in other:
        with monkeypatch.context() as patch:
            for name, value in sizes.items():
                patch.setattr(f"gbeam.integrate.{name}", value)
            built = integrate(SWING, make(), *START, **KNOWN)
        np.testing.assert_allclose(built.q, expected.q, atol=1e-8)


@pytest.mark.parametrize("second", [1e3, 1e-5, 1e5])
@pytest.mark.parametrize("radian", [1.0, 1e-6, 1e6])
@pytest.mark.parametrize("make", [newmark, gauss])
def test_no_digit_that_counts_depends_on_the_units(make: Any, radian: float, second: float) -> None:
    """In other units of angle and time accelerations are up to 1e16 times as small: they converge as far."""

    def converted(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return Swing()(q / radian, qd * (second / radian), qdd * (second**2 / radian), force)

    def run(residual: Any, angle: float, time: float) -> list[Any]:
        drive = NonlinearEquations(residual, lambda t: np.stack([8 * np.sin(2 * t / time), 0 * t], axis=-1))
        start = (each * angle / time**k for k, each in enumerate(START))
        run = integrate(drive, make(), *start, step=0.01 * time, count=300)
        assert run.reached_end
        return [each * (time**k / angle) for k, each in enumerate((run.q, run.qd, run.qdd))]

    for each, expected in zip(run(converted, radian, second), run(Swing(), 1.0, 1.0), strict=True):
        np.testing.assert_allclose(each, expected, atol=1e-8 * np.abs(expected).max())


def test_derivatives_at_one_state_serve_windows_of_small_motions() -> None:
    def derivatives(size: float, rounding: float = 0.0) -> int:
        """Number of states at which they are found in a run of 300 steps, of a residual rounded to so much."""
        calls: list[int] = []

        def counted(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
            if np.iscomplexobj(q):
                calls.append(q.shape[1])
            return Swing()(q, qd, qdd, force) + rounding * np.sin(1e15 * qdd.real)

        equations = NonlinearEquations(counted, lambda t: size * np.stack([np.sin(5 * t), 0 * t], axis=-1))
        assert integrate(equations, gauss(), *np.zeros((2, 2)), step=0.01, count=300).reached_end
        return sum(calls)

    assert derivatives(1e-3) <= 6  # windows
    assert derivatives(1e-3, 1e-14) < 4000  # new ones do not help where corrections are rounding
    assert derivatives(1.0) > 60


def test_a_correction_by_new_derivatives_does_not_tell_how_it_shrinks() -> None:
    """Between states far away derivatives may be much too large, and corrections by them small wherever a step is."""

    def passes(size: float, fresh: bool) -> bool:
        one, no = np.ones(1), np.zeros(1, dtype=bool)
        return bool(verdict.converged_steps(size * one, 1e-3 * one, one, 0 * one, fresh=no | fresh, quick=no)[0])

    assert passes(1e-11, False) and not passes(1e-11, True) and passes(1e-13, True)


WIDE = [
    {"derivatives.NEAR": 16, "derivatives.APART": 64, "derivatives.FAR": 64, "verdict.LATE": 15},
    {"derivatives.NEAR": 16, "derivatives.APART": 16, "verdict.LATE": 10},
]


@pytest.mark.parametrize("spacing", WIDE)
@pytest.mark.parametrize("step", [0.05, 0.1])
def test_no_step_passes_that_leaves_forces(
    step: float, spacing: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Derivatives so wide apart are far too large: steps, which may fail by them, then leave without being solved."""

    def drive(t: Any) -> Any:
        return np.stack([40 * np.sin(9 * t), 30 * np.cos(7 * t)], axis=-1)

    for name, value in spacing.items():
        monkeypatch.setattr(f"gbeam.integrate.{name}", value)
    run = integrate(NonlinearEquations(Swing(), drive), newmark(), *START, step=step, count=60)
    known = np.abs(run.q).max(axis=1) < 1e5  # of an angle that is larger rounding leaves no direction
    left = Swing()(run.q, run.qd, run.qdd, drive(run.time))[known]
    assert len(left) > 10
    assert (np.abs(left) <= 1e-8 * (np.abs(run.qdd) + run.qd**2).max(axis=1, keepdims=True)[known]).all()


@record
class Taut:
    """A unit mass on a stiff spring, whose length is the difference of two places that are far away."""

    def __call__(self, q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return qdd + 20 * qd + 1e8 * ((1e2 + q + q**2) - 1e2) - force


def test_corrections_end_at_the_rounding_within_a_body(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forces that cancel within a residual leave rounding that its derivatives do not show."""
    judged: list[int] = []

    def judge(self: verdict.Verdict, *args: Any, **options: Any) -> Any:
        judged.append(len(self.shares))
        return original(self, *args, **options)

    original = verdict.Verdict.judge
    monkeypatch.setattr(verdict.Verdict, "judge", judge)

    def drive(t: Any) -> Any:
        return 1e5 * np.sin(30 * np.minimum(t, 0.2))[..., None]

    run = integrate(NonlinearEquations(Taut(), drive), newmark(), np.zeros(1), np.zeros(1), step=2e-3, count=1000)
    assert len(run.q) == 1001 and sum(judged) < 10 * 1000


def test_a_step_is_factored_again_only_where_its_derivatives_are_new(monkeypatch: pytest.MonkeyPatch) -> None:
    factored: list[int] = []
    states: list[int] = []
    solve = derivatives.solve_systems

    def counted(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        if not np.iscomplexobj(q):
            states.append(len(q))
        return Swing()(q, qd, qdd, force)

    monkeypatch.setattr(
        derivatives, "solve_systems", lambda left, right: factored.append(len(left)) or solve(left, right)
    )
    run = integrate(NonlinearEquations(counted, load), gauss(), *START, **KNOWN)
    assert run.reached_end
    assert sum(factored) < 0.4 * sum(states) / 2  # two stages a step


def test_accelerations_are_found_where_they_are_asked_for() -> None:
    states: list[int] = []

    def counted(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        states.append(len(q))
        return Swing()(q, qd, qdd, force)

    run = integrate(NonlinearEquations(counted, load), gauss(), *START, **KNOWN)
    states.clear()
    some = run.select(slice(None, None, 50)).select([1, 3, 5])
    for _ in range(2):
        np.testing.assert_allclose(Swing()(some.q, some.qd, some.qdd, load(some.time)), 0.0, atol=1e-11)
    assert states == [3]  # once
    assert len(run.qdd) == 301 and sum(states) == 301


def test_a_window_too_long_for_newton_is_cut() -> None:
    """A pendulum that nearly stands on its head, in steps of a tenth of a second: 100 s, energy kept."""

    @record
    class Pendulum:
        def __call__(self, q: Any, qd: Any, qdd: Any, inputs: Any) -> Any:
            return qdd + np.sin(q)

    solved: list[float] = []
    upright = NonlinearEquations(Pendulum(), lambda t: t)
    run = integrate(
        upright,
        gauss(),
        np.array([3.1]),
        np.zeros(1),
        step=0.1,
        count=1000,
        progress=solved.append,
    )
    assert run.reached_end and len(solved) > 8 and solved[-1] == 1.0
    energy = run.qd[:, 0] ** 2 / 2 - np.cos(run.q[:, 0])
    np.testing.assert_allclose(energy, energy[0], atol=1e-5)


def test_stop_ends_the_run_where_it_says() -> None:
    def past_two(q: np.ndarray) -> int | None:
        high = np.flatnonzero(np.abs(q[:, 1]) > 1.0)
        return int(high[0]) + 1 if high.size else None

    run = integrate(SWING, gauss(), *START, **KNOWN, stop=past_two)
    assert run.stopped and run.converged
    assert np.abs(run.q[-1, 1]) > 1.0 >= np.abs(run.q[1:-1, 1]).max()


def test_derivatives_are_those_of_automatic_differentiation() -> None:
    state = np.random.default_rng(1).normal(size=(3, 5, 2))
    force = load(np.linspace(0.0, 3.0, 5))
    built = slopes(Swing(), *state, force)
    expected = quickly_compiled(jax.vmap(jax.jacfwd(Swing(), argnums=(0, 1, 2))))(*state, force)
    for one, other in zip(built, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)
    qdd = accelerations(Swing(), *state[:2], force)
    np.testing.assert_allclose(Swing()(*state[:2], qdd, force), 0.0, atol=1e-12)


RUNS = """
import sys
import gbeam as gb
strip = gb.Section.rectangle(width=0.02, thickness=0.004)
beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
hub = gb.Hub(radius=0.5, inertia=0.02, torque=gb.Sine(0.2, 1.0))
for model in ("FOAM", "CFOAM", "exact"):
    gb.simulate(gb.assemble(beam, model, y=2, z=2), hub, duration=0.1, step=0.001, estimate=False)
assert "jax" not in sys.modules
"""


def test_a_run_on_a_free_hub_needs_no_jax() -> None:
    subprocess.run([sys.executable, "-c", RUNS], check=True, capture_output=True, text=True)
