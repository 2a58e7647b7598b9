"""`gbeam plan`: the machine's side alone, its limits, its commands, and what is wrong with its input."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.io import loadmat

import gbeam as gb
from gbeam.cli import FIGURES
from gbeam.report import report_of
from gbeam.scenario import build_machines, load_environments

from ..calling import main
from ..report.test_page import plots_of
from ..scenarios import SPECIMEN, model

PLAN = """\
title = "plan"
[motion.flight]
kind = "flight"
[motion.flight.acceleration.z]
profile = "sum"
terms = [
  { profile = "constant", level = "2 g" },
  { profile = "trapezoid", level = "4 g", jerk = "4 g/s", start = "0.5 s", hold = "0.5 s" },
]
[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "150 mm"
inverse = "flat"
gravity = true
smoothing = "100 ms"
[motion.spin.limits]
axis1 = { rate = "60 rpm", acceleration = "5 rad/s^2" }
inertia = "2000 kg m^2"
power = "50 kW"
[motion.spin.commands]
sample = "4 ms"
[response]
duration = "3 s"
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    file = tmp_path / "plan.toml"
    file.write_text(PLAN, encoding="utf-8")
    return file


def test_a_plans_figure_and_page_draw_the_flight(scenario: Path) -> None:
    """Its load from its first to its last time, 2 g, 6 g and the ramps between, in g, and all else in g beside it."""
    (machine,) = build_machines(load_environments(scenario)).values()
    answer = gb.plan("spin", machine, "flight")
    size, *_, error = answer.plot("tracking")
    assert size.get_ylabel() == "size, g" and error.get_ylabel() == "tracking error, g"
    drawn = {line.get_label(): line.get_xydata() for line in size.get_lines()}
    time, load_of_flight = drawn["flight"].T
    assert (time[0], time[-1]) == pytest.approx((0, 3), abs=2e-3)
    np.testing.assert_allclose(load_of_flight, np.interp(time, [0.5, 1.5, 2.0, 3.0], [2, 6, 6, 2]), rtol=1e-6)
    lines = plots_of(report_of(answer))["spin: load at the control point: flight's, the target and the machine's: size"]
    assert lines["flight"].max() == pytest.approx(6, rel=1e-5) and {"target", "machine"} < lines.keys()


def test_a_plan_needs_no_beam(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", str(scenario), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    spin = facts["motions"]["spin"]
    assert facts["outcome"] == spin["outcome"] == "done" and spin["tracks"] == "flight"
    use = {(each["axis"], each["quantity"]): each for each in spin["limits"]}
    assert use["axis 1", "rate"]["allowed"] == pytest.approx(2 * np.pi)
    assert use["axis 1", "rate"]["used"] == pytest.approx((6**2 - 1) ** 0.25 * (9.80665 / 3.3) ** 0.5)
    assert use["axis 2", "jerk"]["allowed"] is None and use["arm", "power"]["share"] > 0
    assert 0 < spin["tracking_error"]["fraction"] < 0.3
    assert main(["plan", str(scenario), "--verbose"]) == 0
    assert "axis 2 jerk" in capsys.readouterr().out


def test_a_plan_has_a_page(scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", str(scenario), "--json", "--out", str(tmp_path / "there"), "--report"]) == 0
    limits = json.loads(capsys.readouterr().out)["motions"]["spin"]["limits"]
    page = (tmp_path / "there" / "plan.html").read_text(encoding="utf-8")
    used = [each["used"] for each in limits if each["used"]]
    shown = [f"{each:#.4g}" if each < 1e4 else f"{float(f'{each:.4g}'):.0f}" for each in used]
    assert len(used) >= 7 and all(each in page for each in shown)
    assert "spin: load at the control point" in page and "spin: rate of the machine's axes" in page


def test_commands_are_the_axes_at_the_samples(scenario: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(FIGURES)
    assert main(["plan", str(scenario), "--out", str(tmp_path / "out"), "--json"]) == 0
    lines = (tmp_path / "out" / "commands_spin.csv").read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    assert any("Units" in line for line in head) and any("zero" in line for line in head)
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    mat = loadmat(tmp_path / "out" / "commands_spin.mat")
    assert len(rows) == mat["time"].size and float(mat["sample"].squeeze()) == 0.004
    # The flight's clock: a sample at its first time, spin-up before, spin-down after, standstill at both ends.
    time = mat["time"].squeeze()
    assert np.abs(time).min() == 0.0 and time[0] < -3 and time[-1] > 6
    np.testing.assert_allclose(np.diff(time), 0.004, rtol=1e-9)
    assert not mat["rate"][[0, -1]].any() and not mat["acceleration"][[0, -1]].any()
    assert sum("STANDSTILL" in line for line in head) == 2
    np.testing.assert_allclose([float(row["rate2_rad_per_s"]) for row in rows], mat["rate"][:, 1], atol=1e-11)
    # What a controller would check: the derivatives belong to the angles.
    for value, rate in (("angle", "rate"), ("rate", "acceleration")):
        slope = (mat[value][2:] - mat[value][:-2]) / 0.008
        np.testing.assert_allclose(slope, mat[rate][1:-1], atol=0.02 * np.abs(mat[rate]).max())
    assert (tmp_path / "out" / "axes_jerk_spin.svg").is_file()


def test_commands_say_what_they_are_made_for(scenario: Path, tmp_path: Path) -> None:
    assert main(["plan", str(scenario), "--out", str(tmp_path), "--json"]) == 0
    mat = loadmat(tmp_path / "commands_spin.mat", simplify_cells=True)
    head = (tmp_path / "commands_spin.csv").read_text(encoding="utf-8")
    for line in (
        "# Scenario: plan\n",
        "# Gravity 9.80665 m/s^2 on the machine is a part of the load, which is specific force.\n",
        "# Control point 0.15 m from the root along the beam; mounting upright.\n",
        "# Limits: axis 1 rate 6.28319 rad/s, axis 1 acceleration 5 rad/s^2, arm power 50000 W.\n",
        "# Time is the flight's: it lasts from 0 to 3 s.\n",
    ):
        assert line in head
    assert (mat["title"], mat["mounting"], mat["gravity"]) == ("plan", "upright", 9.80665)
    assert mat["control_point"] == 0.15 and mat["arm"] == 3.3
    assert mat["limits"]["rate"].tolist() == pytest.approx([2 * np.pi, np.inf, np.inf])
    assert mat["limits"]["power"] == 50e3 and np.isinf(mat["limits"]["jerk"]).all()
    without = ["--set", "motion.spin.gravity=false", "--set", "motion.spin.mounting=inverted", "--ignore-limits"]
    cut = ["--set", "response.duration=2.5 s"]
    assert main(["plan", str(scenario), *without, *cut, "--out", str(tmp_path), "--json"]) == 0
    head = (tmp_path / "commands_spin.csv").read_text(encoding="utf-8")
    assert "# NO GRAVITY: the load is acceleration; a machine on the earth adds its gravity" in head
    assert "mounting inverted" in head and "# Time is the flight's, of which this is a PART: 0 to 2.5 of 3 s." in head


def test_sample_of_the_command_line_wins_and_the_values_are_no_interpolation(scenario: Path, tmp_path: Path) -> None:
    for sample in ("4 ms", "20 ms"):
        assert main(["plan", str(scenario), "--sample", sample, "--out", str(tmp_path / sample), "--json"]) == 0
    fine, coarse = (loadmat(tmp_path / s / "commands_spin.mat") for s in ("4 ms", "20 ms"))
    shared = np.isin(np.round(fine["time"][:, 0], 9), np.round(coarse["time"][:, 0], 9))
    inside = np.isin(np.round(coarse["time"][:, 0], 9), np.round(fine["time"][:, 0], 9))
    assert shared.sum() > 700
    for name in ("time", "angle", "rate", "acceleration"):
        np.testing.assert_allclose(fine[name][shared], coarse[name][inside], atol=1e-9)


def test_exceeding_a_limit_is_status_1_unless_allowed(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    low = ["--set", "motion.spin.limits.axis1.rate=20 rpm"]
    assert main(["plan", str(scenario), *low, "--out", str(tmp_path / "low")]) == 1
    assert "limits exceeded: exceeds axis 1 rate" in capsys.readouterr().err
    assert "LIMITS EXCEEDED" in (tmp_path / "low" / "commands_spin.csv").read_text(encoding="utf-8")
    assert main(["plan", str(scenario), *low, "--ignore-limits", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] == "limits exceeded"


BEAM = SPECIMEN + model("FOAM", 1, 1, 1)
STEP = ("--set", "response.step=2 ms")  # of the machine's limits no step says anything


@pytest.mark.parametrize("verb", ["plan", "run"])
def test_what_is_followed_worse_than_aimed_at_is_told_by_every_verb(
    verb: str, scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = PLAN.replace('"flat"', '"planned"').replace("60 rpm", "30 rpm") + BEAM
    scenario.write_text(text, encoding="utf-8")
    assert main([verb, str(scenario), "--json", "--out", str(tmp_path), *STEP]) == 0
    spin = json.loads(capsys.readouterr().out)["motions"]["spin"]
    (warning,) = (each for each in spin["warnings"] if "cannot follow" in each)
    # 6 g, of which gravity is 1, against 3.3 m times (30 rpm)²; the arm's tangential acceleration helps a little.
    steady = 9.80665 * np.sqrt(35) - 3.3 * np.pi**2
    assert spin["tracking_error"]["max"] == pytest.approx(steady, rel=0.05)
    assert f"{spin['tracking_error']['max'] / 9.80665:.3g} g" in warning and "used up there: axis 1 rate" in warning
    if verb == "run":
        with xr.open_dataset(tmp_path / "result.nc", group="motions/spin") as stored:
            assert warning in stored.attrs["warnings"]


SLOW = PLAN.replace('"flat"', '"planned"').replace("60 rpm", "30 rpm")


def test_a_plan_that_misses_the_main_peak_is_never_done_alone(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """6 g, of which the arm makes 3.4: within the machine's limits, and not the flight."""
    scenario.write_text(SLOW, encoding="utf-8")
    assert main(["plan", str(scenario)]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "spin (3.3 m, tracks flight): done, largest peak missed" in words
    assert "No limits set: largest peak 3.4" in words and "; largest peak missed" in words
    assert "Peaks: 0 of 1 reproduced; 6 g at " in words and "% off (tolerance 5 %; used up: axis 1 rate)." in words
    assert main(["plan", str(scenario), "--json", "--report", "--out", str(tmp_path / "there")]) == 0
    facts = json.loads(capsys.readouterr().out)
    spin = facts["motions"]["spin"]
    assert (facts["outcome"], facts["state"]) == ("done", "done, largest peak missed")
    (peak,) = spin["accounting"]["peaks"]
    assert peak["reason"] == "axis 1 rate" and peak["ratio"] == pytest.approx(0.575, abs=0.01)
    assert spin["accepted"] is None and spin["criteria"] == [] and spin["verdict"].endswith("largest peak missed")
    assert spin["peaks"]["largest_load"]["machine"] is None  # no beam says how long the specimen is
    page = (tmp_path / "there" / "plan.html").read_text(encoding="utf-8")
    assert '<span class="badge bad">done, largest peak missed</span>' in page
    assert "not reproduced: axis 1 rate" in page and "Peaks of the load at the control point" in page


def test_limits_that_need_no_response_are_judged(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    accept = '[motion.spin.accept]\ntip = "1 %"\nfollowed = "10 %"\npeaks = "50 %"\nlargest_load = "50 %"\n'
    scenario.write_text(SLOW + accept + BEAM, encoding="utf-8")
    assert main(["plan", str(scenario)]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "Machine alone, no limit missed: error of peaks " in words and "`gbeam run` judges its limit, tip." in words
    assert not any(word in words for word in ("PASS", "NOT ACCEPTED", "NOT DECIDED"))
    said = {"peaks": "error of peaks", "followed": "followed", "largest_load": "largest load", "spread": "spread of"}
    for limit, value in {"peaks": "5 %", "followed": "99 %", "largest_load": "5 %", "spread": "0.05 %"}.items():
        assert main(["plan", str(scenario), "--set", f"motion.spin.accept.{limit}={value}", "--json"]) == 1
        answer = capsys.readouterr()
        assert answer.err.startswith(f"gbeam: motion.spin NOT ACCEPTED: {said[limit]} "), answer.err
        facts = json.loads(answer.out)
        assert (facts["outcome"], facts["state"]) == ("done", "NOT ACCEPTED")
        spin = facts["motions"]["spin"]
        assert spin["accepted"] is False and spin["not_judged"] == ["tip"]
        assert [each["name"] for each in spin["criteria"] if not each["passed"]] == [limit]
    scenario.write_text(SLOW + accept, encoding="utf-8")
    assert main(["plan", str(scenario)]) == 1  # without a beam nothing is known of the specimen's ends
    assert "NOT DECIDED: largest load unknown (limit 50 %)" in capsys.readouterr().err


def test_plan_run_and_place_agree_on_the_largest_load(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Between their own times: of the plan and the place every 2 ms, of the run its steps."""
    scenario.write_text(PLAN + BEAM, encoding="utf-8")
    answer = []
    for verb, *more in (("plan",), ("run", *STEP, "--ignore-limits"), ("place", "--no-proof", *STEP)):
        assert main([verb, str(scenario), "--json", *more]) in (0, 1)
        facts = json.loads(capsys.readouterr().out)
        if verb == "place":
            answer.append(facts["before"]["largest_load"])
            assert all(each["largest_load"]["machine"] > 0 for each in facts["options"])
        else:
            answer.append(
                (facts["motions"]["spin"] if verb == "plan" else facts["comparisons"][0])["peaks"]["largest_load"]
            )
    for name, accuracy in {"flight": 1e-9, "machine": 5e-4, "time_flight": 0.01, "time_machine": 0.01}.items():
        assert [each[name] for each in answer] == pytest.approx([answer[0][name]] * 3, rel=accuracy)
    assert {each["place_machine"] for each in answer} == {"the tip"} and answer[0]["ratio"] > 1.03


PEAK = ["--set", "motion.flight.acceleration.z={ profile = 'table', times = [0, 1, 1.2345, 1.5, 3], "
        "values = ['2 g', '2 g', '5.321 g', '3 g', '3 g'] }"]  # fmt: skip


def test_plan_and_run_say_the_same_numbers_of_the_load(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The peak is a corner of the flight, between the times of the plan and the steps of both responses."""
    scenario.write_text(PLAN.replace('"flat"', '"planned"') + BEAM, encoding="utf-8")
    answers = []
    for verb, *more in (("plan",), ("run", *STEP)):
        assert main([verb, str(scenario), *PEAK, "--json", "--ignore-limits", *more]) == 0
        facts = json.loads(capsys.readouterr().out)
        answers.append(
            (facts["motions"]["spin"], facts["motions"]["spin"] if verb == "plan" else facts["comparisons"][0])
        )
    (machine, planned), (spun, judged) = answers
    for name in ("tracking_error", "flight_error", "limits", "axes"):
        assert machine[name] == spun[name], name
    assert planned["accounting"] == judged["accounting"]
    assert planned["peaks"]["largest_load"] == judged["peaks"]["largest_load"]
    assert planned["findings"][:3] == judged["findings"][:3]
    largest = max(judged["accounting"]["peaks"], key=lambda peak: peak["load"])
    assert (largest["time"], largest["load"]) == pytest.approx((1.2345, 5.321 * 9.80665), rel=1e-12)


def test_the_load_is_compared_with_the_flight_and_not_only_with_the_rounded_target(
    scenario: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exact follows its target to rounding, which rounds a corner of the flight's 4 g/s off."""
    exact = ["--set", "motion.spin.inverse=exact", "--ignore-limits"]
    assert main(["plan", str(scenario), *exact, "--json"]) == 0
    spin = json.loads(capsys.readouterr().out)["motions"]["spin"]
    assert spin["tracking_error"]["fraction"] < 1e-6
    # At a corner the kernel w(s) = (1 + cos 2πs/W)/W leaves half the slope's change times ∫|s| w ds.
    width, change = 0.1, 4 * 9.80665
    s = np.linspace(-width / 2, width / 2, 2001)
    rounding = change / 2 * np.trapezoid(np.abs(s) * (1 + np.cos(2 * np.pi * s / width)) / width, s)
    off = 1e-3 * change / 2  # the nearest of the plan's times may be a millisecond away
    assert rounding - off <= spin["flight_error"]["max"] <= 1.001 * rounding
    assert main(["plan", str(scenario), *exact, "--verbose"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    within = f"{spin['flight_error']['max'] / 9.80665:.3g} g"
    assert f"largest error of the load while it is followed: {within}" in words


def test_run_names_the_limits_too(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenario.write_text(PLAN.replace("60 rpm", "20 rpm") + BEAM, encoding="utf-8")
    for allow, status, mark in ((), 1, "%) at"), (("--ignore-limits",), 0, "(allowed)"):
        assert main(["run", str(scenario), "--json", *STEP, *allow]) == status
        facts = capsys.readouterr()
        assert "motion.spin limits exceeded: exceeds axis 1 rate" in facts.err and mark in facts.err
        limits = json.loads(facts.out)["motions"]["spin"]["limits"]
        assert next((each["axis"], each["quantity"]) for each in limits if each["exceeded"]) == ("axis 1", "rate")


DIP = ["--set", "motion.flight.acceleration.z={ profile = 'table', times = [0, 1, 1.4, 1.6, 2, 3], "
       "values = ['4 g', '4 g', '0.9 g', '0.9 g', '4 g', '4 g'] }"]  # fmt: skip


def test_a_clipped_target_is_asked_for_and_marked(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    for verb in ("plan", "run"):
        scenario.write_text(PLAN + BEAM, encoding="utf-8")
        assert main([verb, str(scenario), *DIP, "--out", str(out)]) == 2
        facts = capsys.readouterr().err
        assert "0.9 g only at 1.400 s" in facts and "clip = true" in facts and "add 0.15 g across" in facts
        assert not out.exists()
    clip = ["--set", "motion.spin.clip=true", "--ignore-limits"]
    assert main(["plan", str(scenario), *DIP, *clip, "--out", str(out), "--json"]) == 0
    spin = json.loads(capsys.readouterr().out)["motions"]["spin"]
    (held,) = spin["not_followed"]
    (far,) = (each for each in spin["shortfalls"] if each["reason"] == "across below gravity")
    assert held["reason"] == "gimbals"
    # The flight's corners are rounded over 60 ms.
    assert (held["start"], held["end"]) == (pytest.approx(far["start"], abs=0.03), pytest.approx(far["end"], abs=0.03))
    marked = f"TARGET OTHER THAN FLIGHT {held['start']:.3f} to {held['end']:.3f} s: gimbals"
    assert marked in (out / "commands_spin.csv").read_text(encoding="utf-8")
    assert marked in str(loadmat(out / "commands_spin.mat")["conventions"])


def test_what_is_lacking_across_the_beam_is_enough_when_added(
    scenario: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for level, status in ("1.05 g", 0), ("1.035 g", 2):  # 0.9 g and 0.15 g; and 0.9 of that
        assert (
            main(["plan", str(scenario), *(each.replace("0.9 g", level) for each in DIP), "--ignore-limits"]) == status
        )
    assert "add 0.02 g across the beam" in capsys.readouterr().err


@pytest.mark.parametrize("start", ["rest", "pre-yawed"])
def test_spin_up_and_spin_down_are_told_and_commanded(
    scenario: Path, tmp_path: Path, start: str, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = f'inverse = "flat"\nstart = "{start}"\nspin_up = "2 s"\nspin_down = "3 s"'
    text = PLAN.replace('inverse = "flat"', arguments).replace(
        'acceleration = "5 rad/s^2"', 'acceleration = "2 rad/s^2"'
    )
    scenario.write_text(text, encoding="utf-8")
    assert main(["plan", str(scenario), "--ignore-limits", "--json", "--out", str(tmp_path)]) == 0
    spin = json.loads(capsys.readouterr().out)["motions"]["spin"]
    assert (spin["start"], spin["spin_up"], spin["spin_down"]) == (start, pytest.approx(2.0), pytest.approx(3.0))
    assert spin["not_followed"] == []  # of the flight nothing
    assert any("limits in the spin-up" in warning for warning in spin["warnings"])
    commands = loadmat(tmp_path / "commands_spin.mat")
    assert commands["time"][[0, -1], 0].tolist() == pytest.approx([-2.0, 6.0], abs=1e-9)
    for name in ("rate", "acceleration"):
        np.testing.assert_allclose(commands[name][[0, -1]], 0, atol=1e-12)
    turned = commands["rate"][:, 0]
    assert (np.diff(turned[commands["time"][:, 0] < -0.05]) >= 0).all()


def test_idle_commands_begin_and_end_in_the_state_that_their_header_gives(scenario: Path, tmp_path: Path) -> None:
    assert main(["plan", str(scenario), "--set", "motion.spin.start=idle", "--out", str(tmp_path), "--json"]) == 0
    mat = loadmat(tmp_path / "commands_spin.mat")
    assert mat["time"].size == 751 and mat["time"][[0, -1], 0].tolist() == pytest.approx([0.0, 3.0], abs=1e-12)
    steady = (2**2 - 1) ** 0.25 * (9.80665 / 3.3) ** 0.5  # 2 g, of which gravity is 1
    for line, sample in zip(
        [each for each in mat["conventions"][0].split("\n") if "TURNING" in each], (0, -1), strict=True
    ):
        assert f"axis 1 at {mat['rate'][sample, 0]:.9g} rad/s" in line
        assert f"axis 3 at {mat['angle'][sample, 2]:.9g} rad," in line or f"{mat['angle'][sample, 2]:.9g} rad;" in line
    assert mat["rate"][0, 0] == pytest.approx(steady, rel=1e-9)


@pytest.mark.parametrize("limit", ['axis1 = { acceleration = "3 rad/s^2" }', 'axis1 = { jerk = "8 rad/s^3" }'])
@pytest.mark.parametrize("name", ["spin_up", "spin_down"])
def test_the_spin_up_that_the_limits_need_is_named(
    scenario: Path, limit: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = PLAN.replace('inverse = "flat"', f'inverse = "quasi-static"\n{name} = "1.5 s"')
    text = text.replace('axis1 = { rate = "60 rpm", acceleration = "5 rad/s^2" }', limit)
    text = text.replace("0.5 s", "9 s").replace('duration = "3 s"', 'duration = "6 s"')  # a load of 2 g throughout
    scenario.write_text(text, encoding="utf-8")

    def to_json(*more: str) -> tuple[int, dict[str, Any]]:
        status = main(["plan", str(scenario), "--json", *more])
        return status, json.loads(capsys.readouterr().out)["motions"]["spin"]

    status, spin = to_json()
    part, warning = spin["warnings"]
    assert part == "motion.flight: 0 to 6 of 20 s are flown, and the rest is left out"
    assert status == 1 and spin["outcome"] == "limits exceeded"
    assert f"the machine exceeds its limits in the {name.replace('_', '-')}" in warning
    enough = float(warning.split('"')[1].split()[0])
    assert to_json("--set", f"motion.spin.{name}={enough} s")[0] == 0
    assert to_json("--set", f"motion.spin.{name}={0.9 * enough} s")[0] == 1


def test_a_spin_up_does_not_go_with_idle(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for change, words in (
        (["start=idle", "spin_up=2 s"], "motion.spin.spin_up: does not go with start = idle"),
        (["spin_down=0.3 s"], "beyond the flight's last load"),
        (["start=still"], "unknown choice"),
    ):
        sets = [word for each in change for word in ("--set", f"motion.spin.{each}")]
        assert main(["plan", str(scenario), *sets]) == 2
        assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("motion.spin.limits.axis1.rate=0 rpm", "is zero"),
        ("motion.spin.limits.axis2.jerk=3 m", "jerk"),
        ("motion.spin.limits.axis4.rate=3 rad/s", "unknown key"),
        ("motion.spin.machine=human-9m", "unknown choice"),
        ("motion.spin.commands.sample=0 s", "is zero"),
        ("motion.spin.tracks=spin", "not a flight"),
    ],
)
def test_wrong_input_is_status_2_at_its_place(
    scenario: Path, change: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plan", str(scenario), "--set", change]) == 2
    assert words in capsys.readouterr().err


def test_what_is_missing_is_said(scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = PLAN.replace('arm = "3.3 m"\n', "")
    file = tmp_path / "other.toml"
    file.write_text(text, encoding="utf-8")
    assert main(["plan", str(file)]) == 2 and "motion.spin.arm: is missing" in capsys.readouterr().err
    file.write_text(
        text.replace('tracks = "flight"\n', 'tracks = "flight"\nmachine = "human-7.6m"\n'), encoding="utf-8"
    )
    assert main(["plan", str(file), "--json"]) == 1  # 4 g/s from 2 g asks more of a gimbal than such a machine gives
    spin = json.loads(capsys.readouterr().out)["motions"]["spin"]
    assert spin["arm"] == 7.6 and spin["limits"][0]["allowed"] == pytest.approx(2 * np.pi)  # the scenario's own wins
    file.write_text(text.replace('inertia = "2000 kg m^2"\n', 'arm = "1 m"\n'), encoding="utf-8")
    assert main(["plan", str(file)]) == 2
    for sample in ("5", "-1 ms", "5 kg"):
        status = main(["plan", str(scenario), "--sample", sample])
        assert status == (0 if sample == "5" else 2)
    flight = PLAN.split("[motion.spin]")[0] + '[response]\nduration = "3 s"\n'
    file.write_text(flight, encoding="utf-8")
    capsys.readouterr()
    assert main(["plan", str(file)]) == 2 and "no centrifuge" in capsys.readouterr().err
    assert main(["run", str(scenario)]) == 2 and "beam is missing" in capsys.readouterr().err
