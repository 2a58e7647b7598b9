"""The page of a result: what it says, that nothing from outside is obeyed, and that it needs nothing else."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import warnings
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.figures import carried_at_root
from gbeam.numerics import thinned
from gbeam.report import COLUMNS, Numbers, as_json, facts, report_of, report_of_file
from gbeam.report import html as page_of
from gbeam.results import CommandRun, FittedColumn, Outline, Requirement, Result

from ..responses import clamped, with_body

pytestmark = pytest.mark.usefixtures("reading_in_process")

BEAM = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
NASTY = "</script><script>alert(1)</script> <b>&\" '\u202e\x1b[31m"


def header_of(page: str) -> dict[str, object]:
    match = re.search(r'<script type="application/json" id="gbeam-header">(.*?)</script>', page, re.DOTALL)
    assert match is not None
    built: dict[str, object] = json.loads(match[1])
    return built


def test_page_says_what_the_run_says(study: gb.Study) -> None:
    page = html.unescape(report_of(study))
    verdict = study.comparisons[0].verdict
    assert verdict[1:] in page and '<span class="badge good">done</span>' in page
    assert "axis 1 acceleration" in page and "89 %" in page
    assert "Largest error of the load while it is followed: 0.0612 g" in page


def test_page_of_several_imitations_begins_with_their_verdicts(study: gb.Study) -> None:
    (first,) = study.comparisons
    page = html.unescape(report_of(replace(study, comparisons=(first, replace(first, centrifuge="other")))))
    table = page[page.index(">Verdicts<") : page.index(">Verdict: spin<")]
    assert table.count(first.verdict) == 2 and "other" in table and ">Verdict: other<" in page
    assert ">Verdicts<" not in report_of(study)


def test_page_says_when_the_result_was_written(
    study: gb.Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert report_of(study).count("2025-06-15 15:06 UTC") == 2  # at the head, and with where it comes from
    study.save(tmp_path / "result.nc")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1800000000")
    assert "2027-01-15 08:00 UTC" in report_of(study)
    page = report_of_file(tmp_path)
    assert "2025-06-15 15:06 UTC" in page and "2027" not in page
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "tomorrow")
    assert f"{datetime.now(UTC):%Y-%m-%d}" in report_of(study)


def test_page_says_how_much_is_not_followed(study: gb.Study) -> None:
    assert "Not followed: 15 % of the flight's time (85 % is followed, within" in html.unescape(report_of(study))


def plots_of(page: str) -> dict[str, dict[str, np.ndarray]]:
    """The lines of every plot, by title and label."""
    packed = re.search(r'id="gbeam-numbers">(.*?)</script>', page)
    assert packed is not None
    numbers = np.frombuffer(base64.b64decode(packed[1]), dtype="<f4")
    plots: list[dict[str, Any]] = header_of(page)["plots"]  # type: ignore[assignment]
    return {
        each["title"]: {line["label"]: numbers[line["y"]["at"] :][: line["y"]["shape"][0]] for line in each["series"]}
        for each in plots
    }


def test_loads_are_shown_beside_the_flights(study: gb.Study) -> None:
    lines = plots_of(report_of(study))["spin: load at the control point: flight's, the target and the machine's: z"]
    assert [*lines] == ["flight", "target", "machine"]
    flight, axes = study.responses["flight"], study.responses["spin"].axes
    assert axes is not None
    flown = (flight.time > axes.span[0] - 1e-6) & (flight.time < axes.span[1] + 1e-6)
    for name, load in (("flight", flight.base.a_WO_B[flown]), ("target", axes.reference), ("machine", axes.actual)):
        np.testing.assert_allclose(lines[name], load[:, 2] / STANDARD_GRAVITY, rtol=1e-6)
    alone = plots_of(report_of(flight))  # without a machine that imitates it
    np.testing.assert_allclose(
        alone["flight: motion of the base, base axes: acceleration of the root"]["z"], 60 / STANDARD_GRAVITY, rtol=1e-6
    )


def test_nothing_from_outside_is_obeyed(study: gb.Study) -> None:
    response = replace(study.responses["flight"], warnings=(NASTY,), message=NASTY, outcome="diverged")
    page = report_of(replace(study, title=NASTY, responses={NASTY: response}, comparisons=()))
    assert "<script>alert" not in page and "<b>" not in page
    assert "\x1b" not in page and "\u202e" not in page
    assert page.count("<script") == 3
    assert NASTY[:9] in html.unescape(page)


def test_page_allows_its_own_script_only_and_needs_no_network(study: gb.Study) -> None:
    page = report_of(study)
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]+)"', page)
    assert policy is not None and policy[1].startswith("default-src 'none'")
    for tag in ('<script type="module">', "<style>"):
        inside = page.split(tag)[1].split("</s")[0]
        digest = base64.b64encode(hashlib.sha256(inside.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy[1]
    assert "unsafe" not in policy[1]
    assert not re.search(r'(?:src|href)="', page)
    assert set(re.findall(r"https?://[\w.]+", page)) <= {"http://www.w3.org"}  # a namespace


def test_page_of_a_file_is_that_of_the_result(study: gb.Study, tmp_path: Path) -> None:
    study.save(tmp_path / "result.nc")
    assert report_of_file(tmp_path) == report_of(study)


def test_page_of_a_file_has_what_sensors_read(tmp_path: Path) -> None:
    short = ["response.duration=2 s", "response.residual_from=1 s", "sensors.tip.damping_ratio=0.7"]
    study = gb.study(gb.read_scenario("examples/zhang2020_example1.toml", short))
    study.save(tmp_path / "result.nc")
    page = report_of_file(tmp_path)
    assert page == report_of(study)
    read = [each for each in header_of(page)["plots"] if "readings of the accelerometers" in each["title"]]  # type: ignore[attr-defined]
    assert len(read) == 2 and all(each["series"] for each in read)


def test_page_of_json_is_that_of_the_result(tmp_path: Path) -> None:
    modes = gb.modes(gb.assemble(BEAM, "FOAM", z=3))
    answer = facts(modes)
    assert answer is not None
    (tmp_path / "modes.json").write_text(as_json(answer))
    page = report_of_file(tmp_path / "modes.json")
    assert all(f"{frequency:#.4g}" in page for frequency in modes.frequency)
    (plot,) = header_of(page)["plots"]  # type: ignore[misc]
    assert plot["series"][0]["label"].startswith("36.5")


def test_no_report_without_a_result(tmp_path: Path) -> None:
    for name, text in (("a.json", "{"), ("b.json", "[]"), ("c.json", '{"outcome": "done"}'), ("d.nc", "x")):
        (tmp_path / name).write_text(text)
        with pytest.raises(gb.InputError):
            report_of_file(tmp_path / name)
    for kind, text in (("Study", '"motions": 1, "comparisons": []'), ("Modes", '"modes": [{}], "instabilities": []')):
        (tmp_path / "c.json").write_text(f'{{"form": {{"kind": "{kind}"}}, "outcome": "done", {text}}}')
        with pytest.raises(gb.InputError, match=r"c\.json holds no whole result"):
            report_of_file(tmp_path / "c.json")
    with pytest.raises(gb.InputError, match="holds several results"):
        report_of_file(tmp_path)
    with pytest.raises(gb.InputError, match="no file"):
        report_of_file(tmp_path / "none.nc")


def test_a_kind_without_a_page_of_its_own_shows_its_quantities() -> None:
    system = gb.linearize(gb.assemble(BEAM, "FOAM", y=1), gb.Hub(radius=0.5))
    page = report_of(system)
    assert "<h2>states</h2>" in page and f"<td>{system.states[0].name}</td>" in page and "accurate to" in page


@pytest.mark.parametrize("name", ["static", "critical", "load", "buckling", "map", "plan"])
def test_page_of_a_result_alone_is_that_of_its_file(name: str, tmp_path: Path) -> None:
    model = gb.Model("TLAM", y=2, z=2)
    structure, hub = gb.assemble(BEAM, "TLAM", y=2, z=2), gb.Hub(radius=0.5)
    pushed = gb.assemble(replace(BEAM, loads=(gb.Load(0.3, force=(-1.0, 0.0, 0.0)),)), "FOAM", y=2, z=2)
    machine = gb.Centrifuge(gb.Flight(z=20.0), arm=3.3, control_point=0.2, gravity=False, span=(0.0, 0.5))
    result: Result
    match name:  # with a number that its page has to say
        case "static":
            result = gb.static(structure, acceleration=(0, 0, 78.5))
            said = 1e3 * result.tip[2]
        case "critical":
            result = gb.critical_speed(structure, hub)
            said = result.value or 0.0
        case "load":
            result = gb.critical_load(pushed)
            said = result.value or 0.0
        case "buckling":
            result = gb.buckling_acceleration(structure, upper=1.0)
            said = 1.0  # the end of the search
        case "map":
            result = gb.critical_speed_map(BEAM, model, hub, [0.1], [0.1, 0.3])
            said = float(result.speed[0, 1])
        case _:
            result = gb.plan("", machine)
            said = result.axes.limits[0].used
    result.report(tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert f"{said:#.4g}" in re.sub(r"<script.*", "", page, flags=re.DOTALL)
    assert header_of(page)["plots"]
    result.save(tmp_path / "result.nc")
    assert report_of_file(tmp_path) == page


def test_modes_of_a_bent_beam_are_drawn_along_its_line() -> None:
    case = gb.read_scenario("examples/bent_bracket.toml")
    finer = case.remade(stations=np.linspace(0, case.beam.length, 61).tolist())
    header: Any = header_of(report_of(gb.modes(finer.subject)))
    first = header["modes"]["motions"][0]
    rest = np.array(first["parts"][0]["beam"]["rest"])
    np.testing.assert_allclose(rest[[0, -1]], [[0, 0, 0], [0.12, 0, 0.12]], atol=1e-6)  # a fillet of 20 mm
    assert np.linalg.norm(np.diff(rest, axis=0), axis=1).sum() == pytest.approx(0.231416, rel=1e-3)
    assert first["radiusShown"] < 0.12


def test_scene_has_the_motions_with_an_outline(study: gb.Study) -> None:
    flight = study.responses["flight"]
    outline = Outline(
        np.array([0.0, 0.3]), np.full(2, 0.02), np.full(2, 0.004), False, np.empty((0, 2)), flight.time[::50],
        np.zeros((5, 2, 3)),
    )  # fmt: skip
    shown = replace(study, responses={**study.responses, "flight": clamped(flight, outline)})
    scene = header_of(report_of(shown))["scene"]
    (motion,) = scene["motions"]  # type: ignore[index]
    (part,) = motion["parts"]
    assert motion["name"] == "flight" and part["beam"]["points"] == [0, 0.3] and motion["time"]["shape"] == [5]
    assert "middle" not in motion  # it is seen from its base
    assert "scene" not in header_of(report_of(study))


def test_shown_numbers_are_those_of_the_result(study: gb.Study) -> None:
    answer = facts(study)
    assert answer is not None
    page = page_of(answer, {})
    assert header_of(page)["plots"] == []  # no variables, no histories
    text = re.sub(r"<[^>]+>", " ", page)
    for pair in study.comparisons[0].peaks.values():
        assert f"{1e3 * pair.flight:#.4g}" in text and f"{1e3 * pair.machine:#.4g}" in text


@given(st.integers(1, 9000), st.integers(0, 3))
def test_thinned_keeps_the_least_and_the_largest(count: int, seed: int) -> None:
    time = np.linspace(-1, 2, count)
    values = np.random.default_rng(seed).normal(size=count)
    t, kept = thinned(time, values, COLUMNS)
    assert len(t) == len(kept) <= 4 * COLUMNS
    assert (kept.min(), kept.max()) == (values.min(), values.max())
    assert (np.diff(t) > 0).all() and (t[0], t[-1]) == (time[0], time[-1])


def test_values_beyond_all_bounds_are_drawn_as_gaps(study: gb.Study, tmp_path: Path) -> None:
    study.save(tmp_path / "result.nc")
    with h5py.File(tmp_path / "result.nc", "r+") as file:
        for name in ("place", "beam_displacement", "ground_root_acceleration"):
            file[f"motions/flight/{name}"][3] = 1e300
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert header_of(report_of_file(tmp_path))["plots"]


def test_numbers_come_back_and_stand_once() -> None:
    numbers = Numbers()
    first, second = np.arange(6.0).reshape(2, 3), np.array([7.0])
    assert numbers.add(first) == {"at": 0, "shape": [2, 3]} == numbers.add(first)
    assert numbers.add(second) == {"at": 6, "shape": [1]}
    back = np.frombuffer(base64.b64decode(numbers.encoded()), dtype="<f4")
    assert back.tolist() == [0, 1, 2, 3, 4, 5, 7]


def _fit() -> gb.Fit:
    two, time = np.array([1.0, 2.0]), np.linspace(0, 1, 5)
    column = FittedColumn("tip.z", "m", time, 2 * time, 3 * time, 0.125, 0.0)
    return gb.Fit(
        title="toy", data="d.csv", parameters=("a", "b"), units=("m", "kg"), before=two, values=3 * two,
        errors=0.0321 * two, intervals=np.array([[2.5, 3.5], [5, 7]]), covariance=np.eye(2),
        correlation=np.array([[1, 0.4321], [0.4321, 1]]), bounds=np.array([[0.0, 9], [0, 9]]),
        at_bound=np.array([False, True]), columns=(column,), at=time, modal=False, evaluations=7, condition=2.5,
        starts=3, agreed=2,
    )  # fmt: skip


def _optimum() -> gb.Optimum:
    return gb.Optimum(
        title="toy", minimise="tip", unit="m", parameters=("a",), units=("m",), before=np.array([1.0]),
        values=np.array([2.345]), bounds=np.array([[0.0, 9]]), at_bound=np.array([False]), figure_before=1.0,
        figure=0.5, error=0.01, requirements=(Requirement("q", "Pa", -np.inf, 3.0, 1.0, 4.0),),
        path=np.array([[1.0], [2.345]]), history=np.array([1.0, 0.5]), evaluations=9, outcome="limits exceeded",
    )  # fmt: skip


def _sensitivity() -> gb.Sensitivity:
    return gb.Sensitivity(
        title="toy", verb="run", measures=("tip", "share"), units=("m", ""), figures=np.array([2.0, 0.5]),
        parameters=("a", "b"), parameter_units=("m", "kg"), values=np.array([1.0, 3.0]),
        derivatives=np.array([[0.1, 4.0], [0.2, -0.3]]), errors=np.array([[0.001, np.nan], [0.002, np.nan]]),
        methods=("difference", "exact"), kinks=np.array([[True, False], [False, False]]), run_error=0.0123,
        not_varied=("c: no",),
    )  # fmt: skip


def _shaped() -> gb.ShapedCommand:
    time = np.linspace(0, 1, 5)
    tip = np.stack([0 * time, time, 0 * time], axis=1)
    runs = tuple(
        CommandRun(name, k * time, 0.5 * k, k * time[:3], time, k * tip, 1e-3 * k, "done")
        for k, name in ((1, "shaped"), (2, "ZVD"))
    )
    return gb.ShapedCommand(
        kind="rate", goal=0.25, to_rate=True, duration=2.0, coefficients=time, time=time, limit=np.inf, robust=0.1,
        frequency=np.array([0.5]), ratio=time[:3], runs=runs, design="FOAM", check="exact",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("result", "said", "drawn"),
    [
        (_fit(), ["± 0.032", "2.5 to 3.5", "on its bound", "0.4321", "0.1250", "2 of 3 searches"], 2),
        (_optimum(), ["Least tip: 0.5000 m, was 1.000", "2.345", "0 to 9", "NOT KEPT", "limits exceeded"], 2),
        (_sensitivity(), ["tip = 2.000 m", "6.0 %", "difference kink", "-0.009000", "1.2 %", "Not varied: c: no"], 0),
        (
            _shaped(),
            ["Rate to 0.25 rad/s in 2.000 s", "largest command, rad/s²", "for frequencies wrong by up to 10 %"],
            3,
        ),
    ],
    ids=["fit", "optimum", "sensitivity", "shape"],
)
def test_page_of_a_study_says_what_it_found(result: Result, said: list[str], drawn: int, tmp_path: Path) -> None:
    page = report_of(result)
    text = html.unescape(re.sub(r"<script.*?</script>|<style.*?</style>", "", page, flags=re.DOTALL))
    assert all(each in text for each in said), [each for each in said if each not in text]
    assert len(header_of(page)["plots"]) == drawn  # type: ignore[arg-type]
    result.save(tmp_path / "result.nc")
    assert report_of_file(tmp_path) == page
    (tmp_path / "result.nc").rename(tmp_path / "kept")
    (tmp_path / "found.json").write_text(as_json(facts(result)))
    assert header_of(report_of_file(tmp_path))["plots"] == []  # JSON holds no histories


def test_numbers_of_a_system_have_units_and_rounding_is_zero() -> None:
    """Of several motions as of one; and a spin across the beam, whose load lies along it, bends it by nothing."""
    arm = gb.RigidBody(1.0, (0.1, 0.1, 0.1), points={"end": (0.3, 0.0, 0.0)})
    hinge = gb.Joint("revolute", "arm", axes=[(0, 0, 1)], effort=1.0, stiffness=5.0)
    system = gb.System({"arm": arm}, {"hinge": hinge})
    run = gb.simulate(system, duration=0.1, step=0.05)
    for result in (run, gb.Study("", {"ground": run})):
        page = report_of(result)
        assert "<td>step</td><td>0.05000</td><td>s</td>" in page and ">at the end, m or rad<" in page
    assert ">at rest, m or rad<" in report_of(gb.static(system))
    turning = gb.Hub(radius=0.5, rate=10.0)
    spun = gb.simulate(gb.assemble(BEAM, "FOAM", axial=1, y=1, z=1), turning, duration=0.1, step=0.05)
    loads = spun.peaks.loads
    assert loads is not None and np.abs(loads.moment.size.value).max() < 1e-12
    tiny = replace(loads.moment, size=replace(loads.moment.size, value=np.full(2, 1e-15)))
    rounded = with_body(spun, peaks=replace(spun.peaks, loads=replace(loads, moment=tiny)))
    row = report_of(rounded).partition("root moment, N m")[2].partition("</tbody>")[0]
    assert '<td class="number">0</td>' in row


def test_a_moment_that_is_no_number_is_a_gap_and_rounding_is_none() -> None:
    """A force that is none leaves the lever of the others, and no moment is drawn as zero."""
    run = gb.simulate(gb.assemble(BEAM, "FOAM", y=1, z=1), gb.Flight(z=9.81), duration=0.1, step=0.01)
    assert run.loads is not None
    moment, force = run.loads.section_moment.copy(), run.loads.section_force.copy()
    moment[:], moment[0], moment[-1], force[-1] = 1e-18, 0.5, np.nan, np.nan
    loads = replace(run.loads, section_moment=moment, section_force=force)
    panel = next(each for each in carried_at_root(run.time, loads) if each.y.startswith("moment"))
    for line in panel.lines:
        assert np.isnan(line.y[-1]) and line.y[0] > 0 and not np.any(line.y[1:-1])
