"""The verdict on corrections alone: which steps have converged, shrink slowly, or are lost."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam.integrate import Judgement, Verdict, balanced_steps, reach, shrinkage, verdict


def judged(*sizes: Any, x: Any = 1.0, fresh: bool = False, trusted: bool = True, even: bool = True) -> Judgement:
    """Judgement after corrections of sizes (t,) of steps with accelerations x (t,), or the same for all."""
    built, count = Verdict(), len(sizes[0])
    accelerations = np.broadcast_to(x, count)[:, None, None] * np.ones((1, 1, 1))
    built.extend(count)
    flags = {key: np.full(count, value) for key, value in {"fresh": fresh, "trusted": trusted}.items()}
    for size in sizes:
        built.record(np.array(size, dtype=float), accelerations)
        judgement = built.judge(0.0, np.full(count, even), **flags)
    return judgement


def test_the_error_left_is_a_correction_times_its_factor() -> None:
    """The last corrections shrink by 0.2, 0.01 and, as no more is believed, 0.01."""
    good = judged([1e-10, 2e-9, 1e-3], [2e-11, 2e-11, 1e-8])
    assert (
        good.converged_steps.tolist() == [False, True, False]
        and not good.slow_steps.any()
        and not good.lost_steps.any()
    )
    assert judged([1e-10, 2e-9, 1e-3], [9e-12, 2e-11, 9e-11]).converged_steps.all()
    assert not judged([1e-14]).converged_steps.any()  # any error may be left after the first
    assert (
        not judged([1e-3], [1e-11], fresh=True).converged_steps.any()
        and judged([1e-3], [1e-13], fresh=True).converged_steps
    )


def test_corrections_shrink_by_one_factor() -> None:
    np.testing.assert_array_equal(
        shrinkage(np.array([1.0, 1.0, 3.0, 0.0]), np.array([np.inf, 4.0, 1.0, 0.0])), [0.0, 0.25, 1.0, 0.0]
    )


def test_slow_steps_have_not_halved_their_correction() -> None:
    assert judged([1e-3, 1e-3], [4e-4, 6e-4]).slow_steps.tolist() == [False, True]
    assert not judged([1e-3, 1e-3]).slow_steps.any()


def test_steps_are_lost_that_stay_far_or_diverge() -> None:
    far, near = 2 * verdict.MOVED, verdict.MOVED / 2
    assert judged(*[[near, far, near]] * (verdict.LATE - 1)).lost_steps.tolist() == [False] * 3
    assert judged(*[[near, far, near]] * verdict.LATE).lost_steps.tolist() == [False, True, False]
    assert judged([near, np.nan]).lost_steps.tolist() == [False, True]
    assert judged(*[[near, near]] * verdict.ALONE).lost_steps.tolist() == [True, False]  # a first one has had its time
    assert (
        not judged(*[[far]] * (verdict.ALONE - 1)).lost_steps.any()
        and judged(*[[far]] * verdict.ALONE).lost_steps.all()
    )


def test_by_derivatives_that_are_not_trusted_forces_must_be_balanced() -> None:
    sizes = [1e-5, 1e-5], [1e-13, 1e-13]
    assert judged(*sizes, trusted=False).converged_steps.all() and judged(*sizes, even=False).converged_steps.all()
    assert not judged(*sizes, trusted=False, even=False).converged_steps.any()
    small = np.array([[1e-10, 0.0], [1e-8, 0.0]])
    assert balanced_steps(small, np.ones((2, 2)), np.zeros((2, 2))).tolist() == [True, False]
    assert balanced_steps(small, np.ones((2, 2)), np.full((2, 2), 1e7)).all()  # beside their rounding


def test_accelerations_are_related_to_those_before() -> None:
    np.testing.assert_allclose(reach(np.array([1.0, -5.0, 0.1])[:, None, None]), [1.01, 5.05, 0.15])


def test_steps_that_leave_bound_the_rounding_of_those_that_follow() -> None:
    built = Verdict()
    built.extend(3)
    built.set_rounding(np.array([1.0, 5.0, 1e12]))
    built.leave(2)
    assert built.bound == pytest.approx(50 * verdict.CANCELLED) and built.corrections.shape == (5, 1)
    built.record(np.array([1e-6]), np.ones((1, 1, 1)))
    built.record(np.array([1e-6]), np.ones((1, 1, 1)))
    no = np.zeros(1, dtype=bool)
    assert not built.judge(0.0, ~no, fresh=no, trusted=~no).converged_steps.any()
    built.bound = np.inf
    assert built.judge(0.0, ~no, fresh=no, trusted=~no).converged_steps.all()


def rounding_passes() -> None:
    """Corrections by new derivatives that no longer shrink are rounding; larger ones are not."""
    assert (
        judged([1e-7], [1e-7], fresh=True).converged_steps.all()
        and judged([1e-7], [0.95e-7], fresh=True).converged_steps.all()
    )
    assert not judged([1e-7], [0.5e-7], fresh=True).converged_steps.any()
    assert not judged([1e-5], [1e-5], fresh=True).converged_steps.any()


@pytest.mark.parametrize(
    ("name", "factor", "holds"), [("STALLED", 0.5, rounding_passes), ("STALLED", 2, rounding_passes)]
)
def test_what_a_number_half_or_twice_as_large_breaks(
    name: str, factor: float, holds: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    holds()
    monkeypatch.setattr(verdict, name, factor * getattr(verdict, name))
    with pytest.raises(AssertionError):
        holds()


def test_rest_after_a_motion_is_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a step's own accelerations vanish, its corrections are beside those before."""
    sizes, x = ([1e-5, 1e-16], [1e-13, 0.9e-16]), np.array([1.0, 0.0])
    assert judged(*sizes, x=x).converged_steps.all()
    monkeypatch.setattr(verdict, "EARLIER", 0.0)
    assert judged(*sizes, x=x).converged_steps.tolist() == [True, False]
