"""Cases integrated together: the answers of one case alone, and the same bytes in any company."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis.response import record
from gbeam.integrate import side_by_side
from gbeam.scenario import load
from gbeam.studies import Inquiry, ScenarioTemplate, may_share, rows, settle

LEVEL = "motion.flight.acceleration.z.level"
MEASURES = ["flight.tip.z.max_abs", "spin.tip.z.max_abs", "verdict.tip", "flight.loads.root_moment.y.max_abs"]
FIXED = ("response.step=5 ms",)


def test_a_case_has_the_figures_of_its_own_run(fast: Path) -> None:
    swept = gb.sweep(fast, {LEVEL: ["3 g", "6 g", "8 g"]}, MEASURES, overrides=FIXED)
    for k, level in enumerate(("3 g", "6 g", "8 g")):
        study = gb.study(gb.read_scenario(fast, [*FIXED, f"{LEVEL}={level}"]))
        flight, spin = study.responses["flight"], study.responses["spin"]
        assert flight.peaks.loads is not None
        alone = [
            flight.peaks.max_abs[2],
            spin.peaks.max_abs[2],
            study.comparisons[0].peaks["tip"].ratio - 1,
            flight.peaks.loads.moment[0].components.value[1],
        ]
        assert [swept.measures[name][k] for name in MEASURES] == pytest.approx(alone, rel=1e-9)


def test_bytes_depend_neither_on_the_company_nor_on_the_workers_nor_on_the_store(fast: Path) -> None:
    over = {LEVEL: "2 g:8 g:40"}  # more than stand together

    def bytes_of(sweep: gb.Sweep) -> list[bytes]:
        return [sweep.measures[name].tobytes() for name in MEASURES]

    whole = gb.sweep(fast, over, MEASURES, overrides=FIXED, store="there")
    lines = Path("there/cases.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    kept = np.random.default_rng(1).choice(np.arange(1, 41), 17, replace=False)
    Path("there/cases.jsonl").write_text(lines[0] + "".join(lines[k] for k in kept), encoding="utf-8")
    resumed = gb.sweep(fast, over, MEASURES, overrides=FIXED, store="there", resume=True)
    two = gb.sweep(fast, over, MEASURES, overrides=FIXED, workers=2)
    assert bytes_of(whole) == bytes_of(resumed) == bytes_of(two)


def test_a_case_that_fails_leaves_its_batch_as_it_is(fast: Path) -> None:
    over = {"motion.spin.control_point": ["100 mm", "400 mm", "200 mm"], LEVEL: ["4 g", "600 g"]}
    swept = gb.sweep(fast, over, MEASURES, overrides=FIXED)
    fine = gb.sweep(fast, {**over, "motion.spin.control_point": ["100 mm"]}, MEASURES, overrides=FIXED)
    assert swept.outcome[:, 0].tolist() == ["done", "refused", "done"] and set(swept.outcome[:, 1]) != {"done"}
    assert all(swept.measures[name][0, 0] == fine.measures[name][0, 0] for name in MEASURES)


def test_each_case_of_a_batch_that_fails_is_computed_once(fast: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The batch of a case that raises is halved until that one is alone; every other has its own figures."""
    computed: list[int] = []
    whole = Inquiry(
        ScenarioTemplate(load(fast)),
        "run",
        None,
        keys=(("motions", "flight", "bodies", "beam", "tip", "z", "max_abs"),),
        together=True,
    )
    tasks = [(k, (*FIXED, f"{LEVEL}={2 + k / 2} g", f"beam.length={200 + k} mm")) for k in range(11)]
    alone = [next(iter(rows(whole, [task]))) for task in tasks]
    real = gb.simulate_batch

    def failing(cases: Any, *args: Any, **more: Any) -> Any:
        some = list(cases)
        lengths = [round(1e3 * system.flexible["beam"].length) for system, motion in some if motion.kind == "flight"]
        if any(abs(system.flexible["beam"].length - 0.206) < 1e-9 for system, _ in some):
            raise RuntimeError("case 6 fails")
        computed.extend(lengths)
        return real(iter(some), *args, **more)

    monkeypatch.setattr("gbeam.studies.evaluate.simulate_batch", failing)
    answer = sorted(rows(whole, tasks), key=lambda row: row.case)
    assert [row.case for row in answer] == list(range(11)) and sorted(computed) == [*range(200, 206), *range(207, 211)]
    for row, single in zip(answer, alone, strict=True):
        if row.case == 6:
            assert row.outcome == "failed" and row.message == "RuntimeError: case 6 fails"
        else:
            assert row == single and row.outcome == "done"


def test_what_no_measure_needs_changes_no_digit(fast: Path) -> None:
    tip, error = ("motions", "flight", "bodies", "beam", "tip", "z", "max_abs"), ("motions", "flight", "error_estimate")
    base = load(fast, ["response.estimate=true"])
    plain = Inquiry(ScenarioTemplate(base), "run", None, keys=(tip,))
    judged = replace(plain, keys=(tip, error))
    (bare,), (whole,) = (rows(each, [(0, ())]) for each in (plain, judged))
    assert bare.values[0] == whole.values[0] and whole.values[1] > 0
    assert not plain.needs.errors and judged.needs.errors


def test_loads_that_are_not_measured_change_no_digit(fast: Path) -> None:
    over, tips = {LEVEL: ["3 g", "6 g"]}, [*MEASURES[:3], "verdict.followed", "spin.axes.1.rate.max_abs"]
    lean = gb.sweep(fast, over, tips, overrides=FIXED)
    whole = gb.sweep(fast, over, [*tips, MEASURES[3]], overrides=FIXED)
    assert all(np.array_equal(lean.measures[name], whole.measures[name]) for name in tips)
    assert np.isfinite([lean.measures[name] for name in tips]).all()


@pytest.mark.parametrize(
    ("keys", "loads"),
    [
        ("motions.flight.tip.z.max_abs", False),
        ("motions.spin.step", False),
        ("comparisons.spin.verdict.tip", False),
        ("motions.flight.loads.root_moment.y.max_abs", True),
        ("comparisons.spin.verdict.stress", True),
    ],
)
def test_loads_are_computed_where_a_figure_is_one_of_them(fast: Path, keys: str, loads: bool) -> None:
    assert Inquiry(ScenarioTemplate(load(fast)), "run", None, keys=(tuple(keys.split(".")),)).needs.loads == loads


def test_few_cases_of_an_automatic_step_are_computed_one_by_one(fast: Path) -> None:
    for arguments, cases, together in (((), 31, False), ((), 32, True), (FIXED, 2, True)):
        inquiry = Inquiry(
            ScenarioTemplate(load(fast, arguments)),
            "run",
            None,
            keys=(("motions", "flight", "bodies", "beam", "tip", "z", "max_abs"),),
            together=True,
        )
        case = inquiry.case(())
        assert settle(inquiry, case, cases).together == together
        assert not settle(inquiry, case.remade(model=replace(case.model, automatic=True)), cases).together


def test_many_cases_of_an_automatic_step_have_the_figures_of_their_own_runs(fast: Path) -> None:
    """The machine's runs, which spin up, are integrated alone."""
    swept = gb.sweep(fast, {LEVEL: "3 g:8 g:32"}, MEASURES, overrides=["response.duration=0.6 s"])
    levels = np.linspace(3, 8, 32).tolist()
    for k in (0, 17):
        arguments = [f"{LEVEL}={levels[k]!r} g", "response.duration=0.6 s", "response.estimate=false"]
        study = gb.study(gb.read_scenario(fast, arguments))
        peaks = study.responses["flight"].peaks
        assert peaks.loads is not None
        alone = [peaks.max_abs[2], peaks.loads.moment[0].components.value[1]]
        assert [swept.measures[MEASURES[i]][k] for i in (0, 3)] == pytest.approx(alone, rel=1e-9)


PANEL = gb.Beam(3.0, gb.Section.rectangle(0.02, 0.5), gb.Material(2700.0, 70e9), damping_ratio=0.005)
DRIVES = {
    "slewed": gb.Hub(radius=0.5, rate=gb.SmoothStep(0.1, 5.0)),
    "pushed": gb.Hub(radius=0.5, inertia=50.0, torque=gb.Sine(1.0, 5.0)),
}
WIDTH, RATE = "beam.section.width", "motion.hub.rate.duration"


def panel(drive: str, duration: float) -> gb.Case:
    """A satellite's panel, whose steps are found automatically."""
    settings = gb.ResponseSettings(duration)
    return gb.Case.of_beam("A panel", PANEL, gb.Model("FOAM", y=2), {"hub": DRIVES[drive]}, settings)


@pytest.mark.parametrize(("drive", "duration"), [("slewed", 12.0), ("pushed", 7.0)])
def test_cases_of_other_structures_have_the_figures_of_their_own_runs(drive: str, duration: float) -> None:
    """Numbers of steps differ, and where the torque ends within them; the loads are measured or not."""
    widths, case = np.linspace(0.015, 0.03, 32), panel(drive, duration)
    lean, whole = (
        gb.sweep(case, {WIDTH: widths.tolist()}, measure)
        for measure in (["tip.y.max_abs", "steps"], ["tip.y.max_abs", "steps", "loads.root_moment.z.max_abs"])
    )
    assert len(set(lean.measures["steps"])) > 4
    for name in lean.measures:
        np.testing.assert_array_equal(lean.measures[name], whole.measures[name])
    for k in (0, 19):
        beam = replace(PANEL, section=gb.Section.rectangle(widths[k], 0.5))
        alone = gb.simulate(gb.assemble(beam, "FOAM", y=2), DRIVES[drive], duration=duration, estimate=False)
        assert alone.steps == lean.measures["steps"][k]
        assert lean.measures["tip.y.max_abs"][k] == pytest.approx(alone.peaks.max_abs[1], rel=1e-9)
        assert alone.peaks.loads is not None
        moment = alone.peaks.loads.moment[0].components.value[2]
        assert whole.measures["loads.root_moment.z.max_abs"][k] == pytest.approx(moment, rel=1e-9)


@pytest.mark.parametrize(("path", "values"), [(RATE, (3.0, 6.0)), (WIDTH, (0.015, 0.03))])
def test_a_study_costs_little_more_than_a_batch_by_hand(
    path: str, values: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Steps that are computed side by side, beside those of the cases' last runs, which a batch with these steps takes;
    and no loads of sections, which no figure is taken from.
    """
    steps, judged = [0], [0]
    integrate_together, loads_of = side_by_side.integrate_together, record.loads_of

    def integrated(runs: Any) -> Any:
        steps[0] += len(runs) * max(len(run.steps) for run in runs)
        return integrate_together(runs)

    def carried(*state: Any, **more: Any) -> Any:
        judged[0] += 1
        return loads_of(*state, **more)

    monkeypatch.setattr(side_by_side, "integrate_together", integrated)
    monkeypatch.setattr(record, "loads_of", carried)
    swept = gb.sweep(panel("slewed", 12.0), {path: np.linspace(*values, 64).tolist()}, ["tip.y.max_abs", "steps"])
    assert set(swept.outcome) == {"done"}
    # Beside them: runs by which a step is known to be enough, and places of batches that stay empty; 3.0 and 3.9.
    assert steps[0] < 5 * swept.measures["steps"].sum()
    assert judged[0] <= 6  # the first case's, whose figures are looked up, and those by which its steps are judged


def test_cases_with_other_steps_stay_apart() -> None:
    assert may_share("run", [LEVEL]) and not may_share("run", ["response"]) and not may_share("modes", [LEVEL])
