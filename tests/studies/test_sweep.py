"""Sweeps against closed forms, and what they do with cases that fail."""

from __future__ import annotations

import json
from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import gbeam as gb
from gbeam.studies import Facts, Inquiry, find, value_at

Call = Callable[..., Any]
ARM = ("--over", "motion.spin.arm=1:2:2")
LEVEL = "motion.flight.acceleration.z.level"
STIFFNESS = "beam.material.youngs_modulus"
G = 9.80665


def test_static_deflection_over_load_and_stiffness_is_the_closed_form(fast: Path) -> None:
    grid = {LEVEL: "2 g:8 g:4", STIFFNESS: ["60 GPa", "80 GPa"]}
    swept = gb.sweep(
        fast, grid, ["flight.tip.z", "flight.loads.root_moment.y"], verb="static", overrides=["model.modes.z=4"]
    )
    level, stiffness = np.array([2.0, 4.0, 6.0, 8.0])[:, None] * G, np.array([60e9, 80e9])
    mass, inertia, length = 2700 * 0.02 * 0.004, 0.02 * 0.004**3 / 12, 0.3
    tip = -mass * level * length**4 / (8 * stiffness * inertia)
    # Four clamped-free shapes give the tip to 1e-4 (sum of their quasi-static parts).
    assert swept.measures["flight.tip.z"] == pytest.approx(tip, rel=3e-4)
    assert np.abs(swept.measures["flight.loads.root_moment.y"]) == pytest.approx(
        np.broadcast_to(mass * level * length**2 / 2, (4, 2)), rel=1e-4
    )
    assert swept.units == {"flight.tip.z": "m", "flight.loads.root_moment.y": "N m"}
    assert swept.dimensions == (LEVEL, STIFFNESS) and set(swept.outcome.ravel()) == {"done"}
    ds = swept.to_xarray()
    assert ds[LEVEL].attrs["units"] == "g" and ds.sizes == {LEVEL: 4, STIFFNESS: 2}
    at = ds["flight.tip.z"].sel({LEVEL: 6, STIFFNESS: 80})
    assert float(at) == swept.measures["flight.tip.z"][2, 1]


def test_frequencies_of_drawn_stiffnesses_are_its_root(fast: Path) -> None:
    over = [f"{STIFFNESS}=lognormal(70 GPa, 0.05)"]
    swept = gb.sweep(fast, over, ["modes[0].frequency"], verb="modes", motion="flight", samples=8)
    (stiffness,) = swept.parameters
    assert stiffness.drawn == "lognormal(70 GPa, 0.05)" and stiffness.unit == "GPa"
    ratio = swept.measures["modes[0].frequency"] / np.sqrt(stiffness.values)
    assert ratio == pytest.approx(ratio[0], rel=1e-9)
    assert swept.units == {"modes[0].frequency": "Hz"}


def test_frequencies_of_twist_are_measured(fast: Path) -> None:
    """A beam that twists has edges, by which its modes are told apart: a defect stopped all studies of its modes."""
    twisting = [
        "model.kind=exact",
        "model.modes.twist=2",
        "beam.material.poissons_ratio=0.3",
        "beam.rotary_inertia=true",
    ]
    swept = gb.sweep(
        fast, {"beam.length": [0.15, 0.3]}, ["modes[3].frequency"], verb="modes", motion="flight", overrides=twisting
    )
    case = gb.read_scenario(fast, twisting)
    alone = gb.modes(case.subject, case.motions["flight"])
    assert alone.direction[3] == "twist" and swept.measures["modes[3].frequency"][1] == alone.frequency[3]
    # GJ/(ρ I_p) is that of the section: a frequency is as one over the length.
    assert swept.measures["modes[3].frequency"][0] == pytest.approx(2 * alone.frequency[3], rel=1e-2)


def test_the_verdict_is_a_measure(fast: Path) -> None:
    swept = gb.sweep(fast, {"motion.spin.control_point": [0.0, 0.15]}, ["verdict.tip", "flight.tip.z.max_abs"])
    compared = gb.study(gb.read_scenario(fast)).comparisons[0]
    assert swept.measures["verdict.tip"][1] == compared.peaks["tip"].ratio - 1
    assert swept.parameters[0].unit == "m"  # the schema's, where none was written
    assert swept.units == {"verdict.tip": "", "flight.tip.z.max_abs": "m"}


def test_the_best_control_point_is_the_same_share_of_every_length(fast: Path) -> None:
    over = {"beam.length": ["250 mm", "300 mm"]}
    names = ["control_point", "difference.best.tip"]
    # A ramp: a load that stands still differs nowhere along the beam.
    ramp = LEVEL.removesuffix(".level") + '={ profile = "table", times = [0, 0.5], values = ["4 g", "6 g"] }'
    swept = gb.sweep(fast, over, names, verb="place", overrides=[ramp, "model.modes.z=4"])
    # The lever of a linear load on the static tip: docs/theory.md, 9.
    assert swept.measures["control_point"] == pytest.approx(0.7333 * np.array([0.25, 0.3]), rel=1e-3)
    assert swept.units == {"control_point": "m", "difference.best.tip": ""}


def test_every_case_is_computed_once(fast: Path) -> None:
    lengths: list[float] = []

    def length(case: gb.Case) -> float:
        lengths.append(case.beam.length)
        return case.beam.length

    over = {"beam.length": "0.2 m:0.3 m:24"}
    gb.sweep(fast, over, {"length": length}, store="there")
    assert sorted(lengths) == pytest.approx(np.linspace(0.2, 0.3, 24))
    swept = gb.sweep(fast, over, {"length": length}, store="there", resume=True)
    assert len(lengths) == 24 and swept.counts == {"done": 24} and swept.parameters[0].unit == "m"


def test_cases_that_are_not_accepted_say_so_and_are_counted(fast: Path, gbeam: Call) -> None:
    """The load along the specimen on a steady arm: near the control point at mid-span only 0.1 %."""
    control = "--set", "motion.spin.accept.spread=0.15 %"
    over = "--over", "motion.spin.control_point=0 mm, 150 mm, 300 mm"
    command = (
        "sweep",
        fast,
        *over,
        "--measure",
        "verdict.spread, verdict.accepted",
        *control,
        "--out",
        "there",
        "--report",
    )
    answer = gbeam(*command)
    assert answer.status == 0 and "outcome" in answer.out.splitlines()[0]
    rows = [line for line in answer.out.splitlines()[1:4]]
    assert [line.endswith("NOT ACCEPTED") for line in rows] == [True, False, True] and rows[1].endswith("done")
    assert "3 cases: 1 done, 2 NOT ACCEPTED" in answer.out
    assert "1 × NOT ACCEPTED: spin: spread" in answer.out and "(limit 0.15 %)" in answer.out
    with xr.open_zarr("there/sweep.zarr") as zarr:
        assert zarr["outcome"].values.tolist() == ["NOT ACCEPTED", "done", "NOT ACCEPTED"]
        assert (zarr["verdict.spread"].values > 1.5e-3).tolist() == [True, False, True]
        assert zarr["verdict.accepted"].values.tolist() == [0, 1, 0]
        assert zarr.attrs["outcome"] == "some cases not accepted"
    page = Path("there/report.html").read_text(encoding="utf-8")
    assert '<span class="badge bad">some cases not accepted</span>' in page
    assert "3 cases: 1 done, 2 NOT ACCEPTED" in page
    again = gbeam(*command, "--resume", "--json").json
    assert again["counts"] == {"done": 1, "NOT ACCEPTED": 2} and again["outcome"] == "some cases not accepted"


def test_a_case_beyond_the_machines_limits_has_an_answer_too(fast: Path, gbeam: Call) -> None:
    rates = ("--over", "motion.spin.limits.axis1.rate=1 rad/s, 60 rad/s")
    for verb, measure in (("run", "verdict.tip"), ("plan", "axis1.rate.used")):
        answer = gbeam("sweep", fast, *rates, "--verb", verb, "--measure", measure, "--out", verb, "--json")
        assert answer.status == 0 and None not in answer.json["measures"][measure]["values"]
        assert answer.json["outcomes"] == ["NOT ACCEPTED, machine limits exceeded", "done"]
        assert "exceeds axis 1 rate" in answer.json["messages"][0]


def test_a_function_of_the_case_is_a_measure(fast: Path) -> None:
    swept = gb.sweep(fast, {"beam.length": ["250 mm", "300 mm"]}, {"length": attrgetter("beam.length")})
    assert swept.measures["length"] == pytest.approx([0.25, 0.3])


def test_a_case_that_fails_is_recorded_and_the_rest_goes_on(fast: Path) -> None:
    over = {"motion.spin.control_point": ["100 mm", "400 mm", "200 mm"]}
    swept = gb.sweep(fast, over, {"inverse": _fussy})
    assert swept.outcome.tolist() == ["done", "refused", "failed"]
    assert "beyond the tip" in swept.message[1] and "ZeroDivisionError" in swept.message[2]
    assert np.isnan(swept.measures["inverse"]).tolist() == [False, True, True]
    assert swept.counts == {"done": 1, "failed": 1, "refused": 1}


def test_a_measure_that_fails_fails_itself_only(fast: Path) -> None:
    measures = {"inverse": _fussy, "length": _length}
    swept = gb.sweep(fast, {"motion.spin.control_point": ["100 mm", "200 mm"]}, measures)
    assert swept.outcome.tolist() == ["done", "done"] and "ZeroDivisionError" in swept.message[1]
    assert np.isnan(swept.measures["inverse"]).tolist() == [False, True]
    assert swept.measures["length"] == pytest.approx([0.3, 0.3])


@pytest.mark.parametrize(
    ("accept", "judged", "rest"),
    [
        ("", ["largest_load"], ["followed"]),
        ('tip = "5 %"\nfollowed = "50 %"', ["tip", "followed"], ["accepted"]),
    ],
)
def test_the_verdict_is_measured_by_default_then_tip_and_root_moment(
    fast: Path, accept: str, judged: list[str], rest: list[str]
) -> None:
    """The tip's peak in flight stood first, and was the map of the page: the same whatever varies of the machine."""
    fast.write_text(f"{fast.read_text(encoding='utf-8')}[motion.spin.accept]\n{accept}\n", encoding="utf-8")
    swept = gb.sweep(fast, ["motion.spin.arm=2 m, 3.3 m"])
    ends = ("tip.size.max_abs", "loads.root_moment.size.max_abs")
    moved = [f"motions.{name}.{end}" for name in ("flight", "spin") for end in ends]
    verdict = [[f"comparisons.spin.verdict.{end}" for end in each] for each in (judged, rest)]
    assert list(swept.measures) == [*verdict[0], *moved, *verdict[1]]
    assert [swept.units[name] for name in moved] == ["m", "N m", "m", "N m"]
    assert all(np.isfinite(each).all() for each in swept.measures.values())
    assert np.ptp(swept.measures["motions.flight.tip.size.max_abs"]) == 0 < np.ptp(swept.measures[verdict[0][0]])
    slopes = gb.sensitivity(fast, parameters=["beam.length"])
    assert list(slopes.measures) == moved


def _length(case: gb.Case) -> float:
    return float(case.beam.length)


def _fussy(case: gb.Case) -> float:
    return 1 / float(case.motions["spin"].control_point - 0.2)  # type: ignore[attr-defined]


def test_the_scenario_says_what_varies_where_the_call_does_not(fast: Path, gbeam: Call) -> None:
    table = '[sweep]\nverb = "static"\nmeasure = ["flight.tip.z"]\nover = { "beam.length" = "250 mm, 300 mm" }\n'
    fast.write_text(fast.read_text(encoding="utf-8") + table, encoding="utf-8")
    answer = gbeam("sweep", fast, "--json").json
    assert answer["verb"] == "static" and answer["parameters"][0]["values"] == [250, 300]
    short, long = answer["measures"]["flight.tip.z"]["values"]
    assert short / long == pytest.approx((250 / 300) ** 4, rel=1e-9)
    other = gb.sweep(fast, ["beam.length=280 mm"], ["flight.tip.z"])
    assert other.verb == "static" and other.outcome.shape == (1,)


def test_files_and_words(fast: Path, gbeam: Call, with_figures: None) -> None:
    arguments = ("--verb", "static", "--over", f"{LEVEL}=2:8:4 g", "--measure", "flight.tip.z", "--netcdf")
    answer = gbeam("sweep", fast, *arguments, "--out", "there")
    assert answer.status == 0 and "4 cases: 4 done" in answer.out and "flight.tip.z, m" in answer.out
    names = {file.name for file in Path("there").iterdir()}
    assert names == {
        ".lock",
        "cases.jsonl",
        "flight.tip.z.png",
        "flight.tip.z.svg",
        "sweep.json",
        "sweep.nc",
        "sweep.zarr",
    }
    with xr.open_zarr("there/sweep.zarr") as zarr, xr.open_dataset("there/sweep.nc") as netcdf:
        assert zarr["flight.tip.z"].attrs["units"] == "m" and set(zarr["outcome"].values.tolist()) == {"done"}
        assert np.array_equal(zarr["flight.tip.z"], netcdf["flight.tip.z"])


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (("--over", "motion.spin.amr=1:2:2", "--measure", "tip"), "did you mean 'arm'"),
        (("--over", "motion.spin.arm=1 kg:2 kg:2", "--measure", "tip"), "is a mass"),
        (("--over", "motion.spin.arm=1:2:2", "--verb", "static"), "--measure is missing"),
        (("--measure", "tip"), "--over is missing"),
        ((*ARM, "--measure", "flight.tip.z.maxabs"), "did you mean 'flight.tip.z.max_abs'"),
        ((*ARM, "--measure", "tip.z.max_abs"), "could be any of 2 figures"),
        ((*ARM, "--measure", "verdict.accepted"), "set them in [motion.NAME.accept]"),
        (("--over", "motion.spin.arm=1:2:1000000000", "--measure", "x"), "has 1e+09 values"),
        (
            (
                "--over",
                "motion.spin.arm=1:2:40000",
                "--over",
                "beam.length=1:2:40000",
                "--verb",
                "static",
                "--measure",
                "flight.tip.z",
            ),
            "1.6e+09 cases, which take about",
        ),
        ((*ARM, "--measure", "flight.tip.z.max_abs", "--workers", "0"), "--workers is 0"),
        ((*ARM, "--measure", "flight.tip.z", "--resume", "--verb", "all"), "--verb"),
        ((*ARM, "--measure", "flight.tip.z", "--sampler", "saltelli"), "is saltelli, without a distribution"),
    ],
)
def test_bad_input_is_refused_and_nothing_written(
    fast: Path, gbeam: Call, arguments: tuple[str, ...], problem: str
) -> None:
    answer = gbeam("sweep", fast, *arguments, "--out", "there")
    assert answer.status == 2 and problem in answer.err
    assert not Path("there").exists()


def test_figures_are_found_by_the_end_of_their_path() -> None:
    facts = json.loads('{"a": {"tip": {"z": 1.5}, "loads": [{"z": 2}, {"z": null}]}}')
    assert find(facts, "tip.z") == ("a", "tip", "z") and find(facts, "loads[1].z") == ("a", "loads", 1, "z")
    assert value_at(facts, ("a", "tip", "z")) == 1.5 and np.isnan(value_at(facts, ("a", "loads", 1, "z")))
    assert np.isnan(value_at(facts, ("a", "gone")))
    with pytest.raises(gb.InputError, match="did you mean 'outcome_of'"):
        find({"outcome_of": 1.0, "a": {"z": 2.0}}, "outcom_of")


def test_a_first_case_that_is_not_done_is_none_of_what_the_figures_are_called(
    fast: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers: list[Any] = []
    facts = Inquiry.facts

    def answered(inquiry: Inquiry, case: gb.Case) -> Facts:
        answers.append(case)
        return {"outcome": "diverged"} if len(answers) == 1 else facts(inquiry, case)

    monkeypatch.setattr(Inquiry, "facts", answered)
    swept = gb.sweep(fast, {LEVEL: ["2 g", "4 g"]}, ["flight.tip.z"], verb="static")
    assert swept.outcome.tolist() == ["diverged", "done"]
    answers[:] = [None]  # the next is no first one
    with pytest.raises(gb.InputError, match=r"'flight\.tip\.w' is no figure"):
        gb.sweep(fast, {LEVEL: ["2 g", "4 g"]}, ["flight.tip.w"], verb="static")
    assert answers == [None]  # nothing was computed


@pytest.mark.parametrize("verb", ["static", "modes", "plan"])
def test_a_motion_that_is_not_there_is_refused(fast: Path, verb: str) -> None:
    with pytest.raises(gb.InputError, match="--motion is 'nowhere'; the scenario has"):
        figure = {"modes": "modes[0].frequency", "plan": "spin_up"}.get(verb, "tip.z")
        gb.sweep(fast, [f"{LEVEL}=2 g, 4 g"], [figure], verb=verb, motion="nowhere")


def test_a_billion_processes_are_refused(fast: Path) -> None:
    with pytest.raises(gb.InputError, match="--workers is 1000000000; give 1 to"):
        gb.sweep(fast, [f"{LEVEL}=2 g, 4 g"], ["tip.z"], verb="static", workers=10**9)
