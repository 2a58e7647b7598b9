"""The summary for people and the one for programs, from records made by hand."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import gbeam as gb
from gbeam.report import as_json, text
from gbeam.report import facts as to_json

from ..responses import with_body


def test_summary_names_what_matters(study: gb.Study) -> None:
    said = text(study)
    assert said.startswith("a title\n")
    assert "spin (centrifuge): done" in said and "flight: done" in said
    assert "FOAM, newmark, 2000 steps of 1.000 ms; estimated error 0.0010 % (step < 0.001, model < 0.001)" in said
    # Largest while not held: 0.6 m/s² at the end, not the 9 m/s² in between.
    assert "largest error of the load while it is followed: 0.0612 g (1.0 %) at 2.000 s" in said
    assert "target is not the flight's load 0.505 to 0.795 s: below idle" in said
    assert "hub: angle at the end 114.6 deg, largest rate 38.20 rpm" in said
    verdict = study.comparisons[0].verdict
    assert verdict[1:] in " ".join(said.split())


def test_summary_of_a_failure(study: gb.Study) -> None:
    bad = replace(study.responses["flight"], outcome="diverged", message="it [bold] left", warnings=("mind",))
    said = text(gb.Study("", {"flight": bad}, ()))
    assert "flight: diverged" in said and "It [bold] left" in said and "warning: mind" in said


def test_rounding_is_not_a_displacement(study: gb.Study) -> None:
    response = study.responses["flight"]
    peaks = replace(response.peaks, max_abs=np.array([1e-20, 0.0, 1e-3]))
    said = text(gb.Study("", {"flight": with_body(response, peaks=peaks)}, ()))
    rows = [line.split() for line in said.splitlines()]
    assert [row[1] for row in rows if row[:1] == ["flight"]] == ["z"]


def test_many_episodes_are_counted(study: gb.Study) -> None:
    spin = study.responses["spin"]
    axes = replace(spin.axes, episodes=tuple((i, i + 0.5, "below idle") for i in range(20)))
    said = text(gb.Study("", {"spin": replace(spin, axes=axes)}, ()))
    assert said.count("below idle") == 8 and "12 times more" in said


def test_json(study: gb.Study) -> None:
    facts = json.loads(as_json(to_json(study)))
    spin = facts["motions"]["spin"]
    assert spin["tracking_error"] == pytest.approx({"max": 0.6, "time_of_max": 2.0, "fraction": 0.01})
    assert spin["not_followed"] == [{"start": 0.505, "end": 0.795, "reason": "below idle"}]
    assert spin["axes"]["1"]["acceleration"]["max_abs"] == pytest.approx(8 * np.sin(np.pi / 2), rel=1e-3)
    assert facts["motions"]["slew"]["hub"] == {"angle_end": 2.0, "rate_max": 4.0, "rate_end": 4.0}
    assert facts["comparisons"][0]["relative"]["z"] == pytest.approx(0.1)


def test_a_hub_that_turns_backwards_has_the_size_of_its_largest_rate(study: gb.Study) -> None:
    slew = study.responses["slew"]
    assert slew.hub is not None
    backwards = replace(slew, hub=replace(slew.hub, angle=-slew.hub.angle, rate=-slew.hub.rate))
    facts = json.loads(as_json(to_json(gb.Study("", {"slew": backwards}, ()))))
    assert facts["motions"]["slew"]["hub"] == {"angle_end": -2.0, "rate_max": 4.0, "rate_end": -4.0}


def test_json_has_null_for_what_is_no_number(study: gb.Study) -> None:
    axes = replace(study.responses["spin"].axes, not_followed=np.ones(201, dtype=bool))
    response = replace(study.responses["spin"], axes=axes, step=float("nan"), error_estimate=float("inf"))
    spin = json.loads(as_json(to_json(gb.Study("", {"spin": response}, ()))))["motions"]["spin"]
    assert spin["step"] is None and spin["error_estimate"] is None
    assert spin["tracking_error"] == {"max": None, "time_of_max": None, "fraction": None}


def test_steps_add_up_to_the_time(study: gb.Study) -> None:
    """Times of a machine's ways from and to standstill are the results', longer than the flight's refined ones."""
    spin = replace(study.responses["spin"], steps=1820)
    assert spin.steps_in_words == "1800 steps of 1.000 ms, 20 of 10.00 ms from and to standstill"
    np.testing.assert_allclose(1800 * 1e-3 + 20 * 10e-3, spin.time[-1] - spin.time[0])
    assert f"FOAM, newmark, {spin.steps_in_words}; " in text(replace(study, responses={"spin": spin}, comparisons=()))
    assert spin.steps_in_words in repr(spin)
    for same in (study.responses["flight"], replace(spin, step=0.01)):
        assert same.steps_in_words == f"{same.steps} steps of {1e3 * same.step:#.4g} ms"
