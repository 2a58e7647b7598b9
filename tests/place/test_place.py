"""On a uniform cantilever the best control points are those of theory: 1/2, 2/3, 0.7265 and 11/15 of the length.

Mounting and width are searched for within the machine's limits; what breaks them is told and not chosen.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gbeam import AxisLimit, Choice, InputError, MachineLimits, place
from gbeam.cli import parse
from gbeam.numerics import coarse, refine
from gbeam.results import MEASURES, Candidate, LimitUse, Placement

from ..calling import main
from ..scenarios import FLIGHT, SPECIMEN, SPIN, model, response


def only(spin: Any, width: float = 0.0596) -> Choice:
    return Choice(lambda mounting, w: spin(w), ("upright",), (width,), refined=False)


@pytest.mark.parametrize(
    ("measure", "fraction"),
    [("root-shear", 1 / 2), ("root-moment", 2 / 3), ("vibration", 0.726477), ("tip", 11 / 15)],
)
def test_best_control_point(
    structure: Any, flight: Any, spin: Any, settings: Any, measure: str, fraction: float
) -> None:
    placement = place(structure, flight, only(spin), settings, {measure: 1.0}, current=spin())
    # Three shapes put the static tip of a linear load 2e-4 of the length off.
    assert placement.fraction == pytest.approx(fraction, abs=3e-4 if measure == "tip" else 1e-5)
    assert (
        placement.values["best"][measure]
        < 1e-4 * placement.values["current"]["vibration" if measure != "vibration" else "tip"]
    )
    assert placement.current == 0.15


def test_weighted_sum_lies_between(structure: Any, flight: Any, spin: Any, settings: Any) -> None:
    placement = place(structure, flight, only(spin), settings, {"root-shear": 1.0, "tip": 1.0}, current=spin())
    assert 0.5 - 1e-5 <= placement.fraction <= 0.7334


def test_proof_shows_the_gain_over_mid_span(structure: Any, flight: Any, spin: Any, settings: Any) -> None:
    """docs/theory.md, section 9: 0.0873 mm at mid-span, 0.0009 mm at 0.7265 L."""
    placement = place(structure, flight, only(spin), settings, {"vibration": 1.0}, current=spin(), check=True)
    verifications = {proof.name: proof for proof in placement.verifications}
    # The corner's 0.0873 mm, and what the start on the ramp adds to it.
    assert 0.08e-3 < verifications["middle"].vibration < 0.2e-3
    assert placement.vibration_gain > 50
    assert verifications["best"].tip_difference < verifications["middle"].tip_difference


def test_mirror_images_keep_the_scenario_and_the_width_is_searched_for(
    structure: Any, flight: Any, spin: Any, settings: Any
) -> None:
    # The jerk of axis 2 at the corner goes with the width's inverse square: at 59.6 ms it is 470 rad/s³.
    jerk = max(use.used for use in spin(0.0596).usage() if (use.axis, use.quantity) == ("axis 2", "jerk"))
    limits = MachineLimits(axis2=AxisLimit(jerk=jerk))
    built = []

    def make(mounting: str, width: float) -> Any:
        built.append(width)
        return spin(width, sign=1 if mounting == "upright" else -1, limits=limits)

    choice = Choice(make, ("upright", "inverted"), coarse(0.02, 0.32))
    placement = place(structure, flight, choice, settings, {"tip": 1.0}, current=spin())
    # With no lever left, rounding the corners less changes the load less: down to what the machine can do.
    assert placement.best.mounting == "upright"
    assert placement.best.smoothing == pytest.approx(0.0596, rel=0.05) and 0.9 < placement.best.share <= 1
    assert len(built) <= 25
    broken = [each for each in placement.options if each.exceeded]
    assert broken and all(each.smoothing < 0.0596 and each.exceeded[0].quantity == "jerk" for each in broken)
    assert placement.options[-1] in broken and not placement.options[0].exceeded
    total = {(each.mounting, each.smoothing): each.total_error for each in placement.options}
    assert total["upright", 0.32] == pytest.approx(total["inverted", 0.32], rel=1e-6)


def test_no_option_within_the_limits_is_an_outcome_that_names_the_nearest(
    structure: Any, flight: Any, spin: Any, settings: Any
) -> None:
    limits = MachineLimits(AxisLimit(rate=1.0), axis2=AxisLimit(jerk=1.0))
    choice = Choice(lambda mounting, w: spin(w, limits=limits), ("upright",), (0.06, 0.24))
    placement = place(structure, flight, choice, settings, {"tip": 1.0}, current=spin(), check=True)
    assert placement.outcome == "limits exceeded" and len(placement.options) == 2 and not placement.verifications
    assert re.match(r"none of 2.*nearest comes upright, 240 ms: axis 1 rate", placement.message)
    assert not placement.changes


def test_search_finds_an_inner_minimum_and_stops_at_what_is_allowed() -> None:
    for allowed, best in ((0.0, 0.08), (0.1, 0.1), (0.5, 0.5)):
        seen = {}

        def evaluate(x: float, allowed: float = allowed, seen: dict[float, float] = seen) -> tuple[float, float]:
            seen[x] = np.log(x / 0.08) ** 2
            return seen[x], allowed / x

        refine(evaluate, coarse(0.02, 0.64))
        assert min((x for x in seen if x >= allowed), key=seen.__getitem__) == pytest.approx(best, rel=0.05)
        assert len(seen) <= 20


def test_refusals(structure: Any, flight: Any, spin: Any, settings: Any) -> None:
    with pytest.raises(InputError, match="did you mean 'tip'"):
        place(structure, flight, only(spin), settings, {"tips": 1.0}, current=spin())
    with pytest.raises(InputError, match="no weight"):
        place(structure, flight, only(spin), settings, {"tip": 0.0}, current=spin())
    with pytest.raises(InputError, match=r"motion\.arm\.smoothing"):
        place(structure, flight, only(spin, -1.0), settings, {"tip": 1.0}, current=spin(), names=("flight", "arm"))
    with pytest.raises(InputError, match="weight 'x'"):
        parse("tip=x")
    assert parse("tip=2, root-moment") == {"tip": 2.0, "root-moment": 1.0}


SCENARIO = (
    SPECIMEN
    + model("FOAM", 0, 1, 2)
    + FLIGHT.replace('"constant", level = "6 g"', '"table", times = [0, 0.5, 1], values = ["5 g", "5 g", "7 g"]')
    + SPIN
    + 'smoothing = "60 ms"\n'
    + response("1.2 s")
)


def test_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "s.toml"
    file.write_text(SCENARIO, encoding="utf-8")
    command = ["place", str(file), "--measure", "vibration", "--no-proof"]
    assert main([*command, "--json", "--smoothing", "60 ms"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["fraction_of_length"] == pytest.approx(0.7265, abs=1e-4) and len(facts["options"]) == 2
    limit = ["--set", "motion.spin.limits.axis2.jerk=1 rad/s^3"]
    assert main([*command, *limit, "--smoothing", "60 ms", "--json"]) == 1
    answer = capsys.readouterr()
    facts = json.loads(answer.out)
    assert facts["outcome"] == "limits exceeded" and "nearest comes upright, 60 ms" in answer.err
    assert len(facts["options"]) == 2 and all(each["exceeded"] for each in facts["options"]) and facts["set"] == []
    assert main([*command, *limit, "--smoothing", "60 ms", "--write", "--out", str(tmp_path / "out")]) == 1
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["inverted", "60.00"] in [row[:2] for row in rows] and file.read_text(encoding="utf-8") == SCENARIO
    assert json.loads((tmp_path / "out" / "place.json").read_text())["outcome"] == "limits exceeded"
    assert main([*command, *limit, "--smoothing", "60 ms", "--ignore-limits"]) == 0
    assert "exceeds axis 2 jerk" in capsys.readouterr().out
    for words in (["1 kg"], ["0 s", "1 s"], ["1 s", "2 s", "3 s"]):
        assert main([*command, *(part for each in words for part in ("--smoothing", each))]) == 2
        assert "--smoothing" in capsys.readouterr().err


def test_the_answer_is_applied(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "s.toml"
    file.write_text(SCENARIO.replace('"150 mm"', '"150 mm"  # by the middle'), encoding="utf-8")
    command = ["place", str(file), "--measure", "vibration", "--smoothing", "60 ms"]
    assert main([*command, "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    assert first["set"] == ["motion.spin.control_point=217.955 mm"] and first["written"] is None
    for measure in MEASURES:  # all of them, before and after
        assert first["difference"]["current"][measure] > 0 and first["total_error"]["best"][measure] > 0
    assert first["verifications"]["best"]["vibration"] < 0.1 * first["verifications"]["current"]["vibration"]
    assert main([*command, "--no-proof", "--set", first["set"][0], "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["set"] == [] and "best placement already" in again["message"]
    assert main([*command, "--no-proof", "--write"]) == 0
    words = capsys.readouterr().out
    assert '--set "motion.spin.control_point=217.955 mm"' in words and f"written to {file}" in words
    assert file.read_text(encoding="utf-8") == SCENARIO.replace('"150 mm"', '"217.955 mm"  # by the middle')
    assert main([*command, "--no-proof", "--write"]) == 0 and "already" in capsys.readouterr().out


def test_a_placement_says_when_the_load_itself_dominates() -> None:
    jerk = LimitUse("axis 2", "jerk", "rad/s^3", 10.0, 10.0, 1.25)
    best = Candidate("upright", 0.06, 0.22, 0.001, 0.041, (1.0, 2.0, 0.0), 1.0, most_used=jerk, tracking=0.04)
    before = replace(best, control_point=0.15, difference=0.01, total_error=0.043)
    placement = Placement("f", "s", {"tip": 1.0}, 0.3, best, (best,), 0.15, {}, before=before)
    assert placement.changes == {"control_point": "220 mm"}
    assert "changes little" in placement.message
    assert "makes 4 %; the machine is at its limit: axis 2 jerk 10 of 10" in placement.message
    assert replace(placement, before=replace(before, total_error=0.08)).message == ""
    rounded = replace(best, smoothing=0.0600001)  # never less than what keeps the limits
    assert replace(placement, best=rounded, before=replace(before, smoothing=0.12)).changes["smoothing"] == "60.01 ms"
