"""Criteria of acceptance: what each holds against its limit, what bounds mean, and how they are written."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gbeam import InputError
from gbeam.results import (
    RULES,
    Accounting,
    Criterion,
    Fatigue,
    Judged,
    LoadPeak,
    PeakPair,
    Shock,
    StressCycles,
    checked_limits,
    state_of,
)

DOCS = Path(__file__).parents[2] / "docs"
FREQUENCY = np.array([1.0, 10.0, 100.0])
MISSED = LoadPeak(7.0, 60.0, 7.04, 30.0, 0.5, (0.01, -0.02), (0.0, 0.0), "corner", 0.6)


def cycle(size: float) -> StressCycles:
    return StressCycles(np.array([size]), np.zeros(1), np.ones(1))


class Imitation(Judged):
    """Imitation of two peaks, one missed; spectra that differ by a factor; twice the stress in one cycle."""

    def __init__(self, accept: dict[str, object], *, response: bool = True) -> None:
        peaks = (LoadPeak(2.0, 80.0, 2.1, 79.0, 0.02, (-0.2, 0.1), (0.0, 0.0)), MISSED)
        self.peaks = {"tip": PeakPair(2.0, 2.1), "largest_load": PeakPair(80.0, 96.0, 2.0, 3.0, "", "the root")}
        self.accounting = Accounting(0.05, 4.0, 14.0, (0.0, 9.0), 0.8, peaks, ())
        flight = np.array([[1.0, 5.0, 100.0], [1.0, 50.0, 100.0], [1.0, 5.0, 100.0]])
        machine = np.array([[2.0, 5.0, 90.0], [1.0, 75.0, 100.0], [8.0, 15.0, 50.0]])
        self.shock = Shock(10.0, FREQUENCY, flight, machine)
        self.fatigue = Fatigue(5.0, cycle(1.0), cycle(1.1))
        self.accept = checked_limits(accept)
        self.with_response = response


def judged(**limit: object) -> Criterion:
    (criterion,) = Imitation(limit).criteria
    return criterion


@pytest.mark.parametrize(
    ("name", "kept", "broken", "value", "where"),
    [
        ("tip", 0.051, 0.049, 0.05, ""),
        ("largest_load", 0.21, 0.19, 0.2, "at the root at 3.00 s"),
        ("peaks", 0.51, 0.49, 0.5, "at 7.00 s"),
        ("spread", 0.21, 0.19, -0.2, "at the root at 2.10 s"),
        ("followed", 0.79, 0.81, 0.8, ""),
        ("srs", 2.1, 1.9, 0.5, "at 100 Hz along z"),  # the half is further off than three halves
        ("damage", 1.7, 1.5, 1.1**5, "of the root"),
    ],
)
def test_every_criterion(name: str, kept: float, broken: float, value: float, where: str) -> None:
    one, other = judged(**{name: kept}), judged(**{name: broken})
    assert (one.passed, other.passed) == (True, False)
    assert one.value == other.value == pytest.approx(value) and one.where == where
    assert Imitation({}).figures[name] == pytest.approx(value)


def test_a_band_may_be_wider_one_way() -> None:
    """Spectra of the machine from half the flight's to three halves of it: −6 and +3.5 dB."""
    over, under = judged(srs=(0.49, 1.4)), judged(srs=(0.71, 2.0))
    assert (over.value, over.where, over.passed) == (pytest.approx(1.5), "at 10 Hz along y", False)
    assert (under.value, under.where, under.passed) == (pytest.approx(0.5), "at 100 Hz along z", False)
    assert judged(srs=(0.49, 1.6)).passed
    assert str(over) == "shock spectrum +3.52 dB at 10 Hz along y (limit -6.2 dB to +2.92 dB)"
    assert str(judged(srs=10**0.15)) == "shock spectrum -6.02 dB at 100 Hz along z (limit ±3 dB)"
    assert str(judged(damage=2)) == "damage 1.61 of the root (limit 0.5 to 2)"
    assert judged(damage=(0.9, 1.7)).passed and not judged(damage=(1 / 1.7, 1.6)).passed


def test_an_axis_that_is_no_part_of_the_shock_does_not_decide() -> None:
    """Along x the machine has twice a hundredth of the flight's z, and along y thrice a twentieth: against a tenth."""
    ratio = Imitation({}).shock.ratio
    np.testing.assert_allclose(ratio, [[1, 1, 0.9], [1, 1.5, 1], [1, 1.5, 0.5]])
    assert Shock(10.0, FREQUENCY, np.zeros((3, 3)), np.zeros((3, 3))).extremes == ()


def test_what_needs_a_response_is_not_judged_without_one() -> None:
    plan = Imitation({"tip": 0.01, "srs": 1.1, "followed": 0.7}, response=False)
    assert [each.name for each in plan.criteria] == ["followed"] and plan.accepted is True
    assert plan.not_judged == ("tip", "srs")
    assert set(plan.figures) == {"largest_load", "peaks", "spread", "followed"}
    only = Imitation({"tip": 0.01}, response=False)
    assert (
        only.accepted is None and state_of("done", [only, plan]) == "done"
    )  # not accepted, where a part is not judged


def test_what_is_not_known_is_not_decided() -> None:
    unknown = Imitation({"stress": 0.5, "damage": 9.0})
    unknown.fatigue = None
    assert [str(each) for each in unknown.criteria] == [
        "stress unknown (limit 50 %)",
        "damage unknown (limit 0.111 to 9)",
    ]
    assert unknown.accepted is None and unknown.decision == unknown.acceptance == "NOT DECIDED"
    assert unknown.refusal == "stress unknown (limit 50 %), damage unknown (limit 0.111 to 9)"
    assert state_of("done", [unknown]) == state_of("done", [unknown, Imitation({"tip": 0.06})]) == "NOT DECIDED"
    missed = Imitation({"stress": 0.5, "tip": 0.01})
    assert missed.accepted is False and missed.refusal == "tip +5.0 % (limit 1 %)"
    assert state_of("done", [unknown, missed]) == "NOT ACCEPTED"
    none = PeakPair(flight=0.0, machine=1.26749)
    for machine, words in (
        (1.26749, "root moment unknown as flight has none and the machine makes 1.267 N m (limit 50 %)"),
        (0.0, "root moment under 0.1 % (limit 50 %)"),
    ):
        moments = Imitation({"root_moment": 0.5})
        moments.peaks = {"root_moment": replace(none, machine=machine)}
        assert [str(each) for each in moments.criteria] == [words]
        assert moments.accepted is (machine == 0)


def test_states() -> None:
    good, bad = Imitation({"tip": 0.06}), Imitation({"tip": 0.01})
    assert state_of("diverged", [bad]) == "diverged"
    assert state_of("done", [good, bad]) == "NOT ACCEPTED"
    assert state_of("done", [good], exceeded=True) == "NOT ACCEPTED, machine limits exceeded"
    assert (state_of("done", [good]), state_of("done", [Imitation({})]), state_of("done", [])) == (
        "PASS",
        "done",
        "done",
    )
    good.accounting = Accounting(0.05, 4.0, 14.0, (0.0, 9.0), 0.8, (MISSED,), ())
    assert state_of("done", [good]) == "PASS, largest peak missed"


@pytest.mark.parametrize(
    "limits",
    [{"tip": 0.0}, {"followed": 1.2}, {"srs": 0.7}, {"srs": (1.2, 1.5)}, {"damage": (0.5,)}, {"loads": 1.0},
     {"tip": (0.1, 0.2)}],
)  # fmt: skip
def test_limits_that_mean_nothing(limits: dict[str, object]) -> None:
    with pytest.raises(InputError, match="accept"):
        checked_limits(limits)


def test_the_page_on_the_verdict_names_every_criterion() -> None:
    page = (DOCS / "verdict.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \|", page.split("## Pass or fail")[1].split("## For programs")[0], re.MULTILINE)
    assert rows == list(RULES)
