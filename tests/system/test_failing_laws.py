"""Laws that raise an error, give no effort or keep something themselves: named, and the run up to there is kept."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.io import read_stored
from tests.crossing import crossed

SAMPLE, INERTIA, ANGLE = 0.1, 2.0, 0.5
NAMES = ["axis.angle", "axis.angle_rate"]
GAINS = np.array([3.0, 4.0])
OPTIONS: dict[str, Any] = {"duration": 2.0, "step": SAMPLE / 2, "estimate": False}


def hinged(law: Any, angle: float = ANGLE, gravity: float = 0.0, delay: float = 0.0, **more: Any) -> gb.System:
    """A body on a hinge across gravity, under a law named `pointing`; its centre is on the hinge without gravity."""
    body = gb.RigidBody(1.0, (INERTIA,) * 3, centre=(0.0, -1.0 if gravity else 0.0, 0.0))
    axis = gb.Joint("revolute", "body", axes=[(0, 0, 1)], initial=angle)
    feedback = gb.Feedback(law, NAMES, ["axis.angle"], SAMPLE, delay, **more)
    return gb.System({"body": body}, {"axis": axis}, gravity=(0, -gravity, 0), controllers={"pointing": feedback})


def angles(count: int) -> np.ndarray:
    """Angles and rates (count, 2) at samples of a double integrator under the gains, its torque held between them."""
    a = np.array([[1.0, SAMPLE], [0.0, 1.0]])
    step = a - np.outer([SAMPLE**2 / 2 / INERTIA, SAMPLE / INERTIA], GAINS)
    states = [np.array([ANGLE, 0.0])]
    for _ in range(count - 1):
        states.append(step @ states[-1])
    return np.array(states)


def until(end: float, then: Callable[[], Any]) -> Callable[[float, np.ndarray], Any]:
    """Return a law that gives what the gains ask for, and from a time on something else."""
    return lambda t, y: -GAINS @ y if t < end else then()


def raising() -> float:
    raise ZeroDivisionError("no gain\nis left")


ENDS: list[tuple[Any, str, str]] = [
    (raising, "law failed", "the law of axis.angle raises ZeroDivisionError: no gain\\nis left"),
    (lambda: math.nan, "diverged", "gives [nan] at 0.9 s"),
    (lambda: math.inf, "diverged", "gives [inf] at 0.9 s"),
    (lambda: [1.0, 2.0], "law failed", "the law of axis.angle gives [1.0, 2.0] at 0.9 s: give 1 finite effort"),
    (
        lambda: [1.0, [2.0, 3.0]],
        "law failed",
        "the law of axis.angle gives [1.0, [2.0, 3.0]] at 0.9 s: give 1 finite effort",
    ),
    (lambda: "full", "law failed", "the law of axis.angle gives 'full' at 0.9 s: give 1 finite effort"),
]


# Each end at once, and one of each outcome late.
@pytest.mark.parametrize(
    ("late", "which"), crossed(lambda late, which: not late or which < 2, (0.0, 1.5), range(len(ENDS)))
)
def test_the_run_up_to_a_failing_law_is_kept(late: float, which: int, tmp_path: Path) -> None:
    then, outcome, words = ENDS[which]
    delay = late * SAMPLE
    response = gb.simulate(hinged(until(0.85, then), delay=delay), **OPTIONS)
    assert response.outcome == outcome
    assert response.message.startswith("controllers.pointing") and words in response.message
    assert response.time[-1] == pytest.approx(0.9) and response.loop is not None
    whole = gb.simulate(hinged(until(9.0, then), delay=delay), **OPTIONS)
    np.testing.assert_allclose(response.q, whole.q[: len(response.time)], atol=1e-12)
    if not delay:
        np.testing.assert_allclose(response.loop.measured[::2][:-1], angles(9), atol=1e-12)
        np.testing.assert_allclose(response.coordinate("axis.angle")[::2], angles(10)[:, 0], atol=1e-12)
    file = tmp_path / "result.nc"
    response.save(file)
    assert read_stored(file).attrs[""]["outcome"] == outcome


def test_an_error_of_a_law_is_shown_with_its_line() -> None:
    response = gb.simulate(hinged(until(0.85, raising)), **OPTIONS)
    line = 1 + Path(__file__).read_text(encoding="utf-8").splitlines().index(
        '    raise ZeroDivisionError("no gain\\nis left")'
    )
    assert f"(test_failing_laws.py, line {line}: raise ZeroDivisionError(" in response.message
    assert response.message.endswith("at 0.9 s")
    automatic = gb.simulate(hinged(until(0.85, raising)), duration=2.0)
    assert automatic.outcome == "law failed" and automatic.time[-1] == pytest.approx(0.9)


def test_a_law_that_fails_at_once_is_refused() -> None:
    with pytest.raises(
        gb.ComputationError, match=r"controllers.pointing: .* raises ZeroDivisionError.* at 0 s"
    ) as caught:
        gb.simulate(hinged(until(0.0, raising)), **OPTIONS)
    assert caught.value.outcome == "law failed" and isinstance(caught.value.__cause__, ZeroDivisionError)
    with pytest.raises(gb.ComputationError, match="1 finite effort and the state at the next sample"):
        gb.simulate(hinged(lambda t, y, state: -GAINS @ y, state=0.0), **OPTIONS)


def test_what_only_an_iterate_measures_is_no_failure() -> None:
    """A pendulum that swings far: on the way to the solution of many steps a law is asked of states that it has not."""
    asked = list[float]()

    def law(t: float, y: np.ndarray) -> float:
        asked.append(float(y[0]))
        return float(-0.2 * y[1])

    free = gb.simulate(hinged(law, gravity=9.81), **OPTIONS)
    largest = float(np.abs(free.coordinate("axis.angle")).max())
    assert max(map(abs, asked)) > 1.01 * largest

    def strict(t: float, y: np.ndarray) -> float:
        if abs(y[0]) > 1.005 * largest:
            raise ValueError(y)
        return float(-0.2 * y[1])

    response = gb.simulate(hinged(strict, gravity=9.81), **OPTIONS)
    assert response.outcome == "done"
    np.testing.assert_allclose(response.q, free.q, atol=1e-9)


class Kept:
    """A law that keeps its integral itself: at every call, or at those of a later time than the last."""

    def __init__(self, *, by_time: bool) -> None:
        self.by_time, self.last, self.integral = by_time, -1.0, 0.0

    def __call__(self, t: float, y: np.ndarray) -> float:
        if not self.by_time or t > self.last:
            self.last, self.integral = t, self.integral + SAMPLE * y[0]
        return float(-GAINS @ y - self.integral)


def in_place(t: float, y: np.ndarray, state: np.ndarray) -> tuple[float, np.ndarray]:
    state += SAMPLE * y[0]
    return float(-GAINS @ y - state[0]), state


def in_mapping(t: float, y: np.ndarray, state: dict[str, float]) -> tuple[float, dict[str, float]]:
    state["sum"] += SAMPLE * y[0]
    return float(-GAINS @ y - state["sum"]), state


@pytest.mark.parametrize("rest", [False, True], ids=["displaced", "at rest"])
@pytest.mark.parametrize(
    ("law", "state", "fix"),
    [
        (lambda: Kept(by_time=False), None, "give state"),
        (lambda: Kept(by_time=True), None, "give state"),
        (lambda: in_place, lambda: np.zeros(1), "nothing in place"),
        (lambda: in_mapping, lambda: {"sum": 0.0}, "nothing in place"),
    ],
    ids=["kept", "kept by time", "in place", "in a mapping"],
)
def test_a_law_that_keeps_something_is_named(law: Any, state: Any, fix: str, rest: bool) -> None:
    """At rest it shows only once a load has moved the body."""
    more: dict[str, Any] = {} if state is None else {"state": state()}
    if rest:
        more |= {"angle": 0.0, "reference": [gb.SmoothStep(ANGLE, 0.3, start=0.5), 0.0]}
    system = hinged(law(), **more)
    with pytest.raises(
        gb.InputError, match=r"answers .*, and called again .*, to the same measurements at .* s"
    ) as caught:
        gb.simulate(system, **OPTIONS)
    assert caught.value.where == "controllers.pointing.law" and caught.value.fix.endswith(fix)


def test_noise_and_what_begins_late_are_named() -> None:
    noise = np.random.default_rng(1)
    laws: list[tuple[Any, dict[str, Any]]] = [
        (lambda t, y: noise.normal(), {}),
        (lambda t, y, state: (float(-state), noise.normal()), {"state": 0.0}),  # of the next state alone
        (until(1.0, noise.normal), {}),  # sample 16 is taken at 1.6 s
    ]
    for law, more in laws:
        with pytest.raises(gb.InputError, match="called again"):
            gb.simulate(hinged(law, **more), **OPTIONS)


def test_measurements_belong_to_the_law() -> None:
    """One that changes them in place changes no record, and answers as any other."""

    def law(t: float, y: np.ndarray) -> float:
        y *= 2.0
        return float(-GAINS @ y / 2)

    response = gb.simulate(hinged(law), **OPTIONS)
    assert response.loop is not None
    np.testing.assert_allclose(response.loop.measured[:-1:2], angles(20), atol=1e-12)


def test_a_loop_is_not_linearised_with_a_law_that_fails() -> None:
    for law, problem in ((Kept(by_time=False), "called again"), (Kept(by_time=True), "called again")):
        with pytest.raises(gb.InputError, match=problem):
            gb.linearize(hinged(law), loop="closed")
    with pytest.raises(gb.ComputationError, match=r"controllers.pointing: .* raises ZeroDivisionError"):
        gb.linearize(hinged(until(0.0, raising)), loop="closed")


def test_a_law_that_jax_traces_is_named() -> None:
    jax = pytest.importorskip("jax")

    def angle(gain: Any) -> Any:
        return gb.simulate(hinged(lambda t, y: -gain * nothing @ y), **OPTIONS).q[-1, 0]  # noqa: F821

    def of_arrays(gain: Any) -> Any:
        return gb.simulate(hinged(lambda t, y: -gain * (y.fill and GAINS @ y)), **OPTIONS).q[-1, 0]

    for figure, words in ((angle, "raises NameError.* at 0 s"), (of_arrays, "raises AttributeError.* JAX traces it")):
        with pytest.raises(gb.ComputationError, match=f"controllers.pointing: .* {words}"):
            jax.jit(jax.grad(figure))(3.0)
