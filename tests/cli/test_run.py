"""gbeam run: its JSON contract, the files, and what it does when the answer is bad."""

from __future__ import annotations

import contextlib
import io
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

from ..calling import main
from ..files import opened
from ..scenarios import FAST, RAMPS

Call = Callable[..., Any]


def test_json_contract(fast: Path, gbeam: Call) -> None:
    answer = gbeam("run", fast, "--set", "response.estimate=true", "--json")
    assert answer.status == 0 and answer.err == ""
    facts = answer.json
    assert facts["title"] == "fast" and facts["outcome"] == "done" and facts["files"] == []
    assert list(facts["motions"]) == ["flight", "spin"]
    for motion in facts["motions"].values():
        body = motion["bodies"]["beam"]
        assert motion["outcome"] == "done" and motion["message"] == "" and body["model"] == "FOAM"
        assert motion["error_estimate"] >= 0 and motion["step"] > 0
        for axis in "xyz":
            assert set(body["tip"][axis]) == {"max_abs", "time_of_max", "residual_amplitude"}
            assert body["tip"][axis]["residual_amplitude"] is None  # the scenario has no time to measure it from
    # 6 g on a cantilever with one mode: close to w L⁴ / 8 EI = 1.721 mm.
    assert facts["motions"]["flight"]["bodies"]["beam"]["tip"]["z"]["max_abs"] == pytest.approx(1.72e-3, rel=0.02)
    spin = facts["motions"]["spin"]
    assert spin["axes"]["1"]["rate"]["max_abs"] == pytest.approx((6 * 9.80665 / 3.3) ** 0.5)
    assert spin["tracking_error"]["max"] < 1e-9 and spin["not_followed"] == []
    (comparison,) = facts["comparisons"]
    assert (comparison["flight"], comparison["centrifuge"]) == ("flight", "spin")
    assert comparison["relative"]["z"] < 1e-3 and comparison["covered"] == 1
    assert comparison["relative"]["y"] is None  # there is none along y
    assert comparison["accepted"] is None and comparison["criteria"] == []
    for name, unit in {"tip": "m", "root_force": "N", "root_moment": "N m", "stress": "Pa"}.items():
        pair = comparison["peaks"][name]
        assert set(pair) == {"flight", "machine", "ratio", "time_flight", "time_machine", "unit"}
        assert pair["unit"] == unit and pair["ratio"] == pytest.approx(1, abs=2e-3)
    accounting = comparison["accounting"]
    assert accounting["tolerance"] == 0.05 and accounting["followed_share"] == 1 and accounting["not_followed"] == []
    assert accounting["units"] == {"load": "m/s^2", "time": "s"}
    (peak,) = accounting["peaks"]
    assert peak["load"] == pytest.approx(6 * 9.80665) == peak["reproduced"] and peak["reason"] is None
    # The arm's load along the beam goes with the radius: across the arm it stays the same to second order.
    assert peak["spread"]["root"] == pytest.approx(np.hypot(1, 0.15 / 3.3) - 1, rel=1e-3)
    assert not Path("out").exists()


def test_stress_yield_and_fatigue(fast: Path, gbeam: Call) -> None:
    """A steady 6 g: M = m g L²/2 at the root, σ = 6 M/(b h²); a margin of one where the strength is twice that."""
    stress = 6 * (2700 * 0.02 * 0.004 * 6 * 9.80665 * 0.3**2 / 2) / (0.02 * 0.004**2)
    material = f"beam.material.yield_strength={2 * stress}"
    answer = gbeam("run", fast, "--json", "--set", material, "--set", "beam.material.fatigue_exponent=3")
    flight = answer.json["motions"]["flight"]["bodies"]["beam"]
    loads, tip = flight["loads"], flight["tip"]
    assert set(tip["size"]) == {"max_abs", "time_of_max"} and tip["size"]["max_abs"] >= tip["z"]["max_abs"]
    assert [each["at"] for each in flight["stations"]] == [0.3]
    assert flight["stations"][0]["size"] == tip["size"]
    assert loads["stress"]["max"] == pytest.approx(stress, rel=2e-3) and loads["stress"]["station"] == 0
    assert loads["stress"]["tension"]["max"] == pytest.approx(stress, rel=2e-3)
    assert loads["stress"]["compression"]["min"] == pytest.approx(-stress, rel=2e-3)
    assert loads["yield_strength"] == pytest.approx(2 * stress)
    assert loads["margin"]["min"] == pytest.approx(1, abs=4e-3) and loads["margin"]["station"] == 0
    root, end = loads["sections"]
    assert root["margin"] == loads["margin"]["min"] and end["margin"] is None  # the tip carries nothing
    assert root["moment"]["size"] == loads["root_moment"]["size"]
    compared = answer.json["comparisons"][0]
    margin, fatigue = compared["margin"], compared["fatigue"]
    assert margin["flight"] == pytest.approx(1, abs=4e-3) and margin["machine"] == pytest.approx(1, abs=0.1)
    assert any(f"margin on yield {margin['flight']:.3g} in flight" in each for each in compared["lines"])
    assert fatigue["exponent"] == 3 and set(fatigue["machine"]) == {"cycles", "largest_range", "equivalent_range"}
    said = gbeam("run", fast, "--set", f"beam.material.yield_strength={stress / 2}")
    words = " ".join(said.out.split())
    assert said.status == 0 and "above the yield strength" in words
    assert "; ABOVE YIELD in flight and on the machine." in words
    resting = gbeam("static", fast, "--json", "--set", material).json["motions"]["flight"]["bodies"]["beam"]["loads"]
    assert resting["margin"][0] == pytest.approx(1, abs=4e-3) and len(resting["margin"]) == len(resting["stations"])
    heads, row, *_ = gbeam("static", fast, "--set", material).out.partition("force, N")[2].splitlines()
    assert heads.endswith("margin on yield") and float(row.split()[-1]) == pytest.approx(1, abs=4e-3)


def test_accepted_or_not(fast: Path, gbeam: Call) -> None:
    accept = ["--set", "motion.spin.accept.peaks=1 %", "--set", "motion.spin.accept.tip=2 %"]
    good = gbeam("run", fast, *accept, "--json")
    assert good.status == 0 and good.json["comparisons"][0]["accepted"] is True
    # A smaller limit than the arm's geometry allows.
    bad = gbeam("run", fast, *accept, "--set", "motion.spin.accept.spread=0.01 %", "--json", "--ignore-limits")
    assert bad.status == 1 and bad.json["outcome"] == "done"
    assert (
        bad.err == "gbeam: motion.spin NOT ACCEPTED: spread of the load +0.1 % at the root at 0.00 s (limit 0.01 %)\n"
    )
    (comparison,) = bad.json["comparisons"]
    assert comparison["accepted"] is False
    assert [each["passed"] for each in comparison["criteria"]] == [True, True, False]
    tip = comparison["criteria"][0]
    assert (tip["name"], tip["limit"], tip["passed"]) == ("tip", 0.02, True) and abs(tip["value"]) < 2e-3


def test_accept_in_words(fast: Path, gbeam: Call) -> None:
    answer = gbeam("run", fast, "--set", "motion.spin.accept.followed=90 %")
    assert answer.status == 0 and "PASS: followed 100 % of the time (limit 90 % or more); largest load" in answer.out
    assert not [line for line in answer.out.splitlines() if line.endswith(" ")]


PULLS = """{ z = { profile = "sum", terms = [
  { profile = "constant", level = "1 g" },
  { profile = "trapezoid", level = "9 g", jerk = "9 g/s", start = "0.5 s", hold = "0.5 s" },
  { profile = "trapezoid", level = "2.55 g", jerk = "9 g/s", start = "4 s", hold = "0.1 s" } ] } }"""


@pytest.fixture(scope="module")
def pulls(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A run: level flight with a pull to 10 g, and a second one to 3.55 g that is over in 0.67 s."""
    text = FAST.replace(RAMPS, RAMPS.replace("1.3 s", "3 s")).replace(
        '{ z = { profile = "constant", level = "6 g" } }', PULLS
    )
    text = text.replace("gravity = false", 'gravity = true\nidle = "1.4 g"\nsmoothing = "60 ms"\nstart = "rest"')
    file = tmp_path_factory.mktemp("pulls") / "pulls.toml"
    file.write_text(text.replace('duration = "0.5 s"', 'duration = "6 s"\nintegrator = "gauss"'), encoding="utf-8")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        main(["run", str(file), "--set", "response.estimate=false", "--json"])
    return json.loads(out.getvalue())


def test_a_short_second_pull_is_accounted_for(pulls: Any) -> None:
    (comparison,) = pulls["comparisons"]
    accounting = comparison["accounting"]
    assert [peak["load"] / 9.80665 for peak in accounting["peaks"]] == pytest.approx([10, 3.55], rel=1e-3)
    assert [peak["time"] for peak in accounting["peaks"]] == pytest.approx([1.5, 4.283], abs=0.01)
    first, second = accounting["peaks"]
    assert first["ratio"] == pytest.approx(1, abs=0.02)
    if second["reason"] is not None:
        assert any(each.startswith("Peaks: 1 of 2 ") for each in comparison["findings"])
        (missed,) = (each for each in accounting["not_followed"] if each["reason"] == second["reason"])
        assert missed["flight_peak"] == pytest.approx(second["load"])
    for each in accounting["not_followed"]:  # what is called below idle is below it
        assert each["reason"] != "below idle" or each["flight_peak"] <= 1.4 * 9.80665


def test_the_peak_is_that_of_the_whole_flight(pulls: Any) -> None:
    """A machine that spins up from rest: no peak of the flight vanishes in that."""
    flown = pulls
    (comparison,) = flown["comparisons"]
    tip, peak = comparison["peaks"]["tip"], flown["motions"]["flight"]["bodies"]["beam"]["tip"]["z"]
    assert tip["flight"] == pytest.approx(peak["max_abs"], rel=1e-3)
    assert tip["time_flight"] == pytest.approx(peak["time_of_max"], abs=0.01)
    first = comparison["accounting"]["peaks"][0]
    assert first["load"] == pytest.approx(98.0665, rel=1e-3)
    lost = "largest peak missed"
    assert comparison["verdict"].endswith(lost) == (abs(first["ratio"] - 1) > 0.05)


def test_json_of_a_hub(hub: Path, gbeam: Call) -> None:
    facts = gbeam("run", hub, "--json").json
    slew = facts["motions"]["slew"]
    assert slew["hub"]["rate_max"] > 0 and slew["hub"]["angle_end"] > 0
    body = slew["bodies"]["beam"]
    assert body["tip"]["y"]["residual_amplitude"] > 0
    assert body["loads"]["beam_torque"]["max_abs"] > body["loads"]["root_moment"]["z"]["max_abs"] > 0
    assert facts["comparisons"] == []


def test_files(fast: Path, gbeam: Call, with_figures: None) -> None:
    answer = gbeam("run", fast, "--set", "motion.flight.acceleration.z.level=3 g")
    assert answer.status == 0
    assert "Tip: 0.87" in answer.out and "Displacement of the tip" not in answer.out
    folder = Path("out/fast")
    pictures = ["tip", "sizes", "tracking_spin", "comparison_spin", "shock_spin"]
    pictures += [f"axes_{each}_spin" for each in ("rate", "acceleration", "jerk")]
    pictures += [f"{what}_{motion}" for what in ("base", "loads") for motion in ("flight", "spin")]
    expected = {"result.nc"} | {f"{name}.{kind}" for name in pictures for kind in ("png", "svg")}
    assert {file.name for file in folder.iterdir()} == expected
    assert str(folder) in answer.out
    tree = opened(folder / "result.nc")
    assert tree.attrs["overrides"] == "motion.flight.acceleration.z.level=3 g"
    assert tree.attrs["command"].endswith("--set 'motion.flight.acceleration.z.level=3 g'")
    assert str(tree["scenario"].values) == fast.read_text(encoding="utf-8")


def test_json_lists_the_files_it_wrote(hub: Path, gbeam: Call, with_figures: None) -> None:
    facts = gbeam("run", hub, "--json", "--out", "there").json
    assert "there/hub_slew.png" in facts["files"]
    assert all(Path(file).stat().st_size > 0 for file in facts["files"])


def test_diverged_is_reported_stored_and_drawn(fast: Path, gbeam: Call, with_figures: None) -> None:
    """At 3000 g the tip moves by more than the beam is long."""
    level = "motion.flight.acceleration.z.level=3000 g"
    answer = gbeam("run", fast, "--set", level, "--json", "--out", "bad")
    assert answer.status == 1
    assert answer.json["outcome"] == "diverged"
    assert answer.json["motions"]["flight"]["outcome"] == "diverged"
    assert "motion.flight diverged" in answer.err and "exceeded the beam's length" in answer.err
    assert opened("bad/result.nc").attrs["outcome"] == "diverged" and Path("bad/tip.png").exists()


def test_diverged_in_words(fast: Path, gbeam: Call) -> None:
    level = "motion.flight.acceleration.z.level=3000 g"
    again = gbeam("run", fast, "--set", level)
    assert again.status == 1 and "diverged" in again.out and "out/fast" in again.out
    assert [file.name for file in Path("out/fast").iterdir()] == ["result.nc"]


def test_no_result_leaves_no_files(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise gb.ComputationError("not converged", "motion.flight: no relative equilibrium; use exact")

    monkeypatch.setattr("gbeam.analysis.environments.study", fail)
    answer = gbeam("run", fast, "--json", "--out", "there")
    assert answer.status == 1 and not Path("there").exists()
    assert answer.json["outcome"] == "not converged"
    assert answer.json["message"].startswith("motion.flight: no relative equilibrium")
    assert answer.err == "gbeam: not converged: motion.flight: no relative equilibrium; use exact\n"


def test_what_one_motion_lacks_the_others_keep(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*args: Any, name: str, **how: Any) -> gb.Response:
        if name == "spin":
            raise gb.ComputationError("not converged", "no relative equilibrium; use exact")
        return gb.simulate(*args, name=name, **how)

    monkeypatch.setattr("gbeam.analysis.environments.simulate", fail)
    answer = gbeam("run", fast, "--json", "--out", "half")
    assert answer.status == 1
    assert answer.err == "gbeam: motion.spin not converged: no relative equilibrium; use exact\n"
    assert answer.json["motions"]["flight"]["outcome"] == "done" and answer.json["comparisons"] == []
    assert answer.json["motions"]["spin"] == {
        "outcome": "not converged",
        "message": "no relative equilibrium; use exact",
    }
    tree = opened("half/result.nc")
    assert tree.attrs["failure_spin"].startswith("not converged: no relative") and list(tree["motions"]) == ["flight"]
    assert "spin: not converged\n  No relative equilibrium" in gbeam("run", fast).out


def test_interrupted_quietly(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("gbeam.analysis.environments.study", interrupt)
    answer = gbeam("run", fast)
    assert (answer.status, answer.out, answer.err) == (130, "", "")


@pytest.mark.skipif(sys.platform != "linux", reason="needs a device that is always full")
@pytest.mark.parametrize("wrong", [[], ["--set", "beam.length=short", "--json"]])
def test_full_disk_behind_stdout(fast: Path, wrong: list[str]) -> None:
    command = [sys.executable, "-m", "gbeam", "check", str(fast), *wrong]
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.endswith("gbeam: [Errno 28] No space left on device\n")
    assert "Traceback" not in done.stderr
