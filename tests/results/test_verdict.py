"""The verdict in words: one line of at most 25 words and three numbers, and at most six sentences with their limits."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from gbeam.results import RULES, UNITS, Accounting, Limit, LoadPeak, NotFollowed, PeakPair, Verdict, Worded

G = 9.80665
WORDS, SENTENCES = 25, 6
DECISIONS = ("PASS", "NOT ACCEPTED", "NOT DECIDED", "No limits set")
ALL = {name: (0.6, 1.7) if rule.band else 0.5 for name, rule in RULES.items() if name not in ("srs", "damage")}
MISSED = LoadPeak(12.5, 2 * G, 12.6, 1.6 * G, 0.33, (1.8, -0.4), (0.0, 0.0), "axis 2 jerk, axis 3 acceleration")
KEPT = LoadPeak(4.9, 8 * G, 4.9, 8 * G, 1e-4, (0.1, 0.1), (0.0, 0.0))
STRETCHES = (NotFollowed(0.0, 1.0, "below idle", G), NotFollowed(12.4, 12.6, "axis 2 jerk", 2 * G))


class Imitation(Worded):
    """An imitation that makes `ratio` of the flight's sizes."""

    def __init__(self, accept: Mapping[str, Limit], ratio: float = 1.2, known: tuple[str, ...] = tuple(UNITS)) -> None:
        self.accept = accept
        self.peaks = {
            name: PeakPair(8.0, 8.0 * ratio, 4.9, 10.1, "", "the root" if name == "largest_load" else "")
            for name in known
        }
        self.accounting = Accounting(0.05, 0.4 * G, 1.4 * G, (0.0, 16.0), 0.93, (KEPT, MISSED), STRETCHES)
        self.exceeded = ""

    @property
    def words(self) -> Verdict:
        return Verdict(self, exceeded=self.exceeded)


def numbers(text: str) -> list[str]:
    return re.findall(r"(?<![\w.])[+-]?\d+(?:\.\d+)?", text.replace("axis 1", "axis").replace("axis 2", "axis"))


def check(imitation: Worded, begins: str) -> None:
    line, findings = imitation.verdict, imitation.findings
    assert line.startswith(begins) and "\n" not in line
    assert len(line.split()) <= WORDS and len(numbers(line)) == 3, line
    assert len(findings) <= SENTENCES and len({each.partition(":")[0] for each in findings}) == len(findings)
    for each in findings:
        assert each.endswith(".") and (each.startswith("Machine: ") or "limit" in each or "tolerance" in each), each


@pytest.mark.parametrize("ratio", [0.3, 0.98, 1.0, 1.0001, 1.2, 4.0, 400.0])
@pytest.mark.parametrize("name", ["", *ALL])
def test_one_line_of_three_numbers(name: str, ratio: float) -> None:
    imitation = Imitation({name: ALL[name]} if name else {}, ratio)
    decided = {True: "PASS: ", False: "NOT ACCEPTED: ", None: "No limits set: "}[imitation.accepted]
    check(imitation, decided)


def test_the_three_decisions() -> None:
    wide = {"tip": 0.5, "root_moment": 0.5, "followed": 0.9}
    check(Imitation(wide), "PASS: all limits are kept, the nearest: followed 93 % of the time (limit 90 % or more); ")
    check(Imitation({**wide, "tip": 0.1}), "NOT ACCEPTED: tip +20 % (limit 10 %); largest load 0.979 g")
    strict = Imitation({**wide, "tip": 0.1, "root_moment": 0.05})
    check(strict, "NOT ACCEPTED: worst of all: root moment +20 % (limit 5 %); largest load 0.979 g")
    assert any(each.startswith("Tip: ") and "(limit 10 %, missed)" in each for each in strict.findings)
    check(Imitation({"tip": 0.5}, known=("root_moment",)), "NOT DECIDED: tip is not known (limit 50 %); ")


def test_a_machine_beyond_its_limits_does_not_pass() -> None:
    imitation = Imitation({"tip": 0.5})
    imitation.exceeded = "axis 2 jerk 120 % of its limit"
    check(imitation, "NOT ACCEPTED: the machine exceeds its limits, axis 2 jerk 120 % of its limit; ")


def test_a_plan_does_not_pass_what_needs_a_response() -> None:
    imitation = Imitation({"tip": 0.5, "followed": 0.9}, known=("largest_load",))
    imitation.with_response = False
    check(
        imitation,
        "Machine alone, no limit missed: followed 93 % of the time (limit 90 % or more); largest load 0.979 g",
    )
    assert imitation.findings[-1] == "Specimen: `gbeam run` judges its limit, tip."
    without = Imitation(ALL)
    without.peaks, without.with_response = imitation.peaks, False
    without.accept = {name: limit for name, limit in ALL.items() if RULES[name].response}
    check(without, "Machine alone, no limit judged: largest load 0.979 g (flight 0.816 g), followed 93 % of the time")
    assert without.findings[-1] == "Specimen: `gbeam run` judges its limits, tip, root force and 2 more."


@pytest.mark.parametrize("whole", [None, (0.0, 20.0)])
@pytest.mark.parametrize("scale", [None, 1.25])
@pytest.mark.parametrize("exceeded", ["", "axis 2 acceleration 120 % of its limit"])
@pytest.mark.parametrize("limit", [0.5, 0.05])
def test_whatever_is_to_be_said_the_headline_is_short(
    whole: tuple[float, float] | None, scale: float | None, exceeded: str, limit: float
) -> None:
    """Of a part of a flight at another level, with its largest peak missed; what decides is never left out."""
    imitation = Imitation({"tip": limit, "root_moment": 0.5, "followed": 0.9})
    imitation.whole, imitation.point = whole, "the camera on its bracket"
    largest = replace(MISSED, load=9 * G)
    imitation.accounting = replace(imitation.accounting, peaks=(KEPT, largest))
    words = Verdict(imitation, exceeded=exceeded, scale=scale)
    decision = "NOT ACCEPTED" if exceeded or limit < 0.2 else "PASS"
    assert words.headline.startswith(decision) and len(words.headline.split()) <= WORDS, words.headline
    assert ("camera on its bracket +20 %" in words.headline) is (limit < 0.2)
    assert (exceeded in words.headline) is (limit > 0.2 or not exceeded)
    assert "× 1.25" in words.headline or scale is None
    assert len(words.findings) == SENTENCES


def test_the_headline_names_the_point_that_is_judged() -> None:
    imitation = Imitation({"tip": 0.1})
    imitation.point = "camera"
    check(imitation, "NOT ACCEPTED: camera +20 % (limit 10 %); largest load 0.979 g")


def test_a_missed_limit_of_the_same_kind_stands_beside() -> None:
    said = Imitation({"tip": 0.5, "stress": 0.1, "spread": 0.1}).findings
    assert said[0].endswith("(no limit set); missed: spread of the load +180 % at the root at 12.60 s (limit 10 %).")
    root = next(each for each in said if each.startswith("Root: "))
    assert (
        root == "Root: moment 9.6 N m, 20 % above the flight's 8 N m (no limit set); missed: stress +20 % (limit 10 %)."
    )


DIGITS = [(1.0204, 0.02, "+2.04 %"), (1.0204, 0.03, "+2.0 %"), (1.10004, 0.1, "+10.004 %"), (1.00003, 1e-5, "+0.003 %")]


@pytest.mark.parametrize(("ratio", "limit", "said"), DIGITS)
def test_a_value_has_the_digits_that_decide(ratio: float, limit: float, said: str) -> None:
    (tip,) = Imitation({"tip": limit}, ratio).criteria
    assert tip.number == said


SIDES = [(1.9, "NOT ACCEPTED: damage 1.9 (limit 1.7); "), (0.7, "PASS: damage 0.7 (limit 0.6); ")]


@pytest.mark.parametrize(("ratio", "said"), SIDES)
def test_a_band_says_the_limit_on_the_side_of_the_value(ratio: float, said: str) -> None:
    imitation = Imitation({"damage": (0.6, 1.7)})
    imitation.fatigue = cast("Any", SimpleNamespace(damage_ratio=ratio, place="of the root"))
    check(imitation, said + "largest load 0.979 g")
