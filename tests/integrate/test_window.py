"""A window of steps alone: what it takes in and puts out, and one correction of all its unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam.integrate import Derivatives, Scheme, Window, gauss, make_steps, newmark, window

H, RATE = 0.05, 3.0


def oscillator(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
    return qdd + RATE**2 * q - force


def opened(residual: Any, scheme: Scheme, count: int, start: Any = (1.0, 0.0, 0.0)) -> Window:
    """A window of so many steps from q, q̇, q̈."""
    built = Window(residual, lambda t: 0 * t[:, None], scheme, make_steps(0.0, H, 10_000), None)
    built.begin(scheme.tableau(H).initial @ np.array(start)[:, None], np.array([start[2]]))
    if count:
        built.extend(count)
    return built


def corrected(built: Window) -> np.ndarray:
    """Correct a window by derivatives of its own; return the sizes of corrections."""
    derivatives = Derivatives(built.residual, None)
    derivatives.extend(len(built))
    stages = built.stages()
    derivatives.renew(stages)
    derivatives.factor(stages, built.tableau, None)
    return built.correct(stages, derivatives.maps)


@pytest.mark.parametrize("count", [1, 2, 37])
@pytest.mark.parametrize("scheme", [newmark(), gauss()], ids=["newmark", "gauss"])
def test_one_correction_solves_linear_equations(scheme: Scheme, count: int) -> None:
    """Of an oscillator, step by step, from the state at which it is released."""
    built = opened(oscillator, scheme, count, (1.0, 0.0, -(RATE**2)))
    assert corrected(built).min() > 0 and corrected(built).max() < 1e-12
    built.leave(count)
    q, qd, *qdd = built.take_ends()
    energy = qd[:, 0] ** 2 + RATE**2 * q[:, 0] ** 2
    assert len(q) == count and len(built) == 0 and built.first == count
    np.testing.assert_allclose(energy, RATE**2, rtol=1e-12)  # which both keep
    assert len(qdd) == scheme.ends
    angle = 2 * np.arctan(RATE * H / 2) if scheme.ends else 2 * np.arctan(6 * RATE * H / (12 - (RATE * H) ** 2))
    np.testing.assert_allclose(q[:, 0], np.cos(angle * np.arange(1, count + 1)), atol=1e-12)


def test_steps_that_leave_are_put_out_once() -> None:
    built = opened(oscillator, gauss(), 10)
    corrected(built)
    built.leave(3)
    built.leave(2)
    assert len(built) == 5 and built.first == 5 and len(built.z) == 6 and len(built.times) == 10
    assert [len(each) for each in built.take_ends()] == [5, 5]
    built.cut(2)
    assert len(built) == 2 and len(built.z) == 3 and len(built.times) == 4
    np.testing.assert_allclose(built.times.reshape(2, 2).mean(axis=1), H * np.array([5.5, 6.5]))


def test_a_window_takes_as_many_steps_as_are_good() -> None:
    built = opened(oscillator, gauss(), 0)
    assert built.room(10_000, single=False) == window.FIRST and built.room(30, single=False) == 30
    for _ in range(10):
        built.grow()
    assert built.room(10_000, single=False) == window.MOST and built.room(10_000, single=True) == window.LONGEST
    built.extend(window.FEW + 1)
    assert built.room(10_000, single=False) == 0


def test_a_window_that_fails_begins_anew_and_shorter() -> None:
    built, sizes = opened(oscillator, gauss(), window.FIRST), []
    while built.shrink():
        sizes.append(built.room(10_000, single=False))
        built.extend(sizes[-1])
    assert sizes == [25, 6, 1]
    assert built.room(10_000, single=False) == 0  # beside a single step none follows
    corrected(built)
    built.leave(1)
    assert built.limit == window.LONGEST


def holds_friction() -> None:
    """Newton's method finds where a law turns that is smooth over a hundredth of the way there."""

    def stiff(q: Any, qd: Any, qdd: Any, force: Any) -> Any:
        return np.arctan(100 * (qdd - 1))

    built = opened(stiff, newmark(), 1, (0.0, 0.0, 0.0))
    with np.errstate(all="ignore"):  # of iterates that diverge
        for _ in range(15):
            corrected(built)
    np.testing.assert_allclose(built.x, 1.0, atol=1e-12)


def test_a_correction_halved_less_often_goes_astray(monkeypatch: pytest.MonkeyPatch) -> None:
    holds_friction()
    monkeypatch.setattr(window, "HALVINGS", window.HALVINGS // 2)
    with pytest.raises(AssertionError):
        holds_friction()


def test_numbers_of_steps_evaluated_at_once_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def times(ahead: int) -> tuple[np.ndarray, int]:
        monkeypatch.setattr(window, "AHEAD", ahead)
        calls: list[int] = []
        built = opened(oscillator, gauss(), 0)
        built.drive = lambda t: calls.append(len(t)) or 0 * t[:, None]
        seen = []
        for _ in range(9):
            built.extend(50)
            seen.append(built.times)
            built.leave(50)
        return np.concatenate(seen), len(calls)

    (some, many), (all_times, few) = times(200), times(400)
    np.testing.assert_array_equal(some, all_times)
    assert (many, few) == (3, 2)
