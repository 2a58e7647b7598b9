"""Several flights of one record: each over its own time, and what their tables may say."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.report import description_text as text
from gbeam.scenario import ScenarioError, build, load, scenario_of

CAMPAIGN = Path(__file__).parents[2] / "examples" / "campaign.toml"
SPANS = {"turn": (8.0, 18.0), "pull": (20.0, 27.5), "push": (28.0, 43.5)}  # of examples/campaign.py
QUICK = ["beam.damping_ratio=0.01", "response.step=20 ms", "response.estimate=false"]


def refused(*overrides: str) -> tuple[str, str]:
    with pytest.raises(ScenarioError) as caught:
        build(load(CAMPAIGN, list(overrides)))
    (error,) = caught.value.diagnostics
    return error.path, f"{error.message}; {error.hint}"


def test_each_manoeuvre_is_flown_over_its_own_time_and_its_file_is_read_once(monkeypatch: Any) -> None:
    from gbeam.motion.records import record

    read, files = record.read_table, list[str]()
    monkeypatch.setattr(record, "read_table", lambda path, *more: files.append(path) or read(path, *more))
    case = gb.read_scenario(CAMPAIGN)
    assert len(files) == 1
    assert {*case.spans} == {*SPANS}
    for name, (start, end) in SPANS.items():
        settings = case.settings_of(name)
        assert (settings.start, settings.duration) == pytest.approx((start, end - start))
        assert case.start_of(name) == start
    assert case.settings_of("turn").tolerance == 0.02
    assert (
        repr(case)
        == "Case('A strip in three manoeuvres of one sortie', FOAM, {turn: flight, pull: flight, push: flight})"
    )


def test_a_run_answers_for_every_manoeuvre_as_one_for_it_alone() -> None:
    together = gb.study(gb.read_scenario(CAMPAIGN, QUICK))
    assert together.outcome == "done"
    for name, (start, end) in SPANS.items():
        response = together.responses[name]
        assert (response.time[0], response.time[-1]) == pytest.approx((start, end))
    only = ["motion.turn.record.section=3"]
    scenario = CAMPAIGN.read_text(encoding="utf-8").split("# Other sections")[0] + "[response]\ntolerance = 0.02\n"
    alone_in = CAMPAIGN.with_name("campaign_alone.toml")
    from gbeam.scenario import loads

    alone = gb.study(build(loads(scenario, str(alone_in), [*QUICK, *only], folder=CAMPAIGN.parent)))
    np.testing.assert_array_equal(alone.responses["turn"].tip, together.responses["push"].tip)


def test_a_result_says_what_was_done_to_its_record_and_is_computed_again(tmp_path: Path) -> None:
    from gbeam import rerun

    study = gb.study(gb.read_scenario(CAMPAIGN, QUICK))
    (note,) = study.notes  # one of all three
    assert note.startswith(
        "done to the record: low-pass at 10 Hz, zero phase; offsets at rest (0 to 5 s, 47 to 52 s), and their drift"
    )
    study.save(tmp_path / "result.nc")
    again = rerun(tmp_path / "result.nc")
    assert again.reproduced, again


def test_frozen_questions_ask_each_motion_at_its_own_start() -> None:
    case = gb.read_scenario(CAMPAIGN)
    rests = gb.questions.QUESTIONS["static"].answer(case)
    assert [each.time for each in rests] == [8.0, 20.0, 28.0]


def test_a_sweep_keeps_histories_over_all_manoeuvres(tmp_path: Path) -> None:
    swept = gb.sweep(
        CAMPAIGN, ["beam.damping_ratio=1 %, 2 %"], histories=["turn.tip.z", "push.tip.z"], times=72, overrides=QUICK[1:]
    )
    times, turn = swept.time, np.asarray(swept.histories["turn.tip.z"])[0]
    assert (times[0], times[-1]) == pytest.approx((8.0, 43.5))
    inside = (times >= 8.0) & (times <= 18.0)
    assert np.isfinite(turn[inside]).all() and np.isnan(turn[~inside]).all()


def test_check_lists_the_sections_with_the_flights_of_each() -> None:
    lines = text(gb.describe(gb.read_scenario(CAMPAIGN))).split("\n")
    assert "  record    push: campaign.csv, event 3, 28 to 43.5 s, specific force" in lines
    assert "            event 2         20 to 27.5 s       pull" in lines
    assert "            event 0          0 to 7.98 s       not flown" in lines
    assert "  response  turn 8 to 18 s, pull 20 to 27.5 s, push 28 to 43.5 s, gauss, step auto" in lines
    assert lines.count("            offsets as of turn are subtracted") == 2


def test_offsets_of_the_example_are_those_that_its_program_puts_in() -> None:
    """At 2.5 s and 49.5 s of 52 s, of the mean of 250 samples of noise of 0.003 g; signs are those of the keys."""
    record = gb.describe(gb.read_scenario(CAMPAIGN)).records["turn"]
    first, last = np.array([0.012, 0.008, 0.02]), np.array([0.02, 0.02, 0.05])
    for offset, time in zip(record.offsets, (2.5, 49.5), strict=True):
        expected = first + (last - first) * time / 52
        np.testing.assert_allclose(np.array(offset.load) / 9.80665, expected, atol=4 * 0.003 / np.sqrt(250))
    case = gb.read_scenario(CAMPAIGN)
    truth = np.genfromtxt(CAMPAIGN.parent / "data" / "f16_pulls_and_push.csv", delimiter=",", names=True)
    flight = case.motions["push"]
    assert isinstance(flight, gb.Flight)
    times = np.arange(29.0, 43.0, 0.1)
    flown = np.asarray(flight.base(times).a_WO_B) / 9.80665
    np.testing.assert_allclose(flown[:, 2], -np.interp(times - 8.0, truth["time_s"], truth["n_z_g"]), atol=0.25)
    assert abs(np.mean(flown[:, 2] + np.interp(times - 8.0, truth["time_s"], truth["n_z_g"]))) < 0.003


@pytest.mark.parametrize(
    ("overrides", "path", "words"),
    [
        (["motion.pull.record.of=tunr"], "motion.pull.record.of", "'tunr' names no flight; did you mean 'turn'?"),
        (["motion.pull.record.of=push"], "motion.pull.record.of", "names a flight without a record of its own"),
        (
            ["motion.pull.record.section=9"],
            "motion.pull.record.section",
            "is 9, which no section is; column 'event' has",
        ),
        (["motion.pull.record.section=true"], "motion.pull.record.section", "true is not text"),
        (["motion.pull.record.section=0"], "motion.pull.record.section", "stands in 4 stretches: 0 to 7.98 s"),
        (["motion.pull.record.to=50 min"], "motion.pull.record.to", "is 3000 s, and the record lasts 0 to 52 s"),
        (["motion.pull.record.cutoff=5 Hz"], "motion.pull.record.cutoff", "the keys here are of, from, to, section"),
        (["response.residual_from=25 s"], "response.residual_from", "give a time from 8 s on, before 18 s"),
        (['motion.turn.record.rest=[{from="14 s", to="16 s"}]'], "motion.turn.record.rest", "drifts by 0.06 g"),
        (["motion.turn.record.z=n_z_g", "motion.turn.record.rest=[]"], "motion.turn.record.z", "downwards for"),
        (["motion.turn.record.z=n_z_g"], "motion.turn.record.rest[0]", "is upside down: the load from 0 to 5 s points"),
        (["motion.turn.record.sections=time_s"], "motion.turn.record.sections", "numbers no sections"),
    ],
)
def test_a_part_that_is_none_is_refused_at_its_place(overrides: list[str], path: str, words: str) -> None:
    where, said = refused(*overrides)
    assert where == path and words in said


def test_a_column_of_sections_that_is_left_out_is_asked_for_by_all_parts() -> None:
    text = CAMPAIGN.read_text(encoding="utf-8").replace('sections = "event"\nsection = 1\n', "")
    with pytest.raises(ScenarioError) as caught:
        from gbeam.scenario import loads

        loads(text, "s.toml", folder=CAMPAIGN.parent)
    said = {each.path: each.hint for each in caught.value.diagnostics}
    assert [*said] == ["motion.pull.record.section", "motion.push.record.section"]
    assert 'sections = "event" in [motion.turn.record]' in said["motion.pull.record.section"]


def test_what_has_no_time_of_its_own_is_refused_beside_manoeuvres() -> None:
    hub = ['motion.spin={kind="hub", radius="1 m", rate={profile="constant", level="1 rad/s"}}']
    path, words = refused(*hub)
    assert path == "motion.spin" and "has no time of its own" in words and "scenario of its own" in words


def test_a_duration_that_is_written_is_refused_with_a_fix_that_works() -> None:
    with pytest.raises(ScenarioError) as caught:
        build(load(CAMPAIGN, ["response.duration=3 s"]))
    assert any("leave it out: each has its own time then" in each.hint for each in caught.value.diagnostics)


def test_a_machine_has_the_time_of_the_flight_that_it_tracks() -> None:
    machine = (
        'motion.m={kind="centrifuge", tracks="push", machine="specimen-3.3m", control_point="220 mm", idle="1.4 g"}'
    )
    case = build(load(CAMPAIGN, [machine, "motion.m.gravity=true"]))
    assert case.spans["m"] == case.spans["push"]
    plan = gb.questions.QUESTIONS["plan"].answer(case)[0]
    assert plan.axes.span == pytest.approx(SPANS["push"])


def test_records_of_one_length_share_their_time() -> None:
    """Parts that last alike, from the same time, are run as before: over one time, which settings say."""
    same = ['motion.pull.record={of="turn", section=1}', 'motion.push.record={of="turn", section=1}']
    case = build(load(CAMPAIGN, same))
    assert not case.spans and case.over_time.duration == pytest.approx(10.0)
    assert scenario_of(case).motion.keys() == SPANS.keys()


@pytest.mark.parametrize(
    ("spans", "words"),
    [({"trun": (0.0, 1.0)}, "choose of turn, pull, push"), ({"turn": (2.0, 2.0)}, "let it end later")],
)
def test_spans_of_a_case_in_python_are_judged(spans: dict[str, tuple[float, float]], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        replace(gb.read_scenario(CAMPAIGN), spans=spans)
