"""Commands of scenarios: what they must do is what the scenario's own slew does."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gbeam as gb
from gbeam.studies import scenario_with

from ..scenarios import APPENDAGE, FREE_HUB, SLEW, SPECIMEN, model, response

Call = Callable[..., Any]
QUICK = SLEW.replace("60 rpm", "1 rad/s").replace('"2 s"', '"6 s"')
SLEWING = APPENDAGE + model("FOAM", 0, 2, 0) + QUICK + response("7 s")


@pytest.fixture
def slewing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "slewing.toml"
    file.write_text(SLEWING, encoding="utf-8")
    return file


def test_a_command_does_what_the_slew_does_and_its_scenario_leaves_what_it_says(
    slewing: Path, gbeam: Call, with_figures: None
) -> None:
    answer = gbeam("shape", slewing, "--out", "shaped", "--json").json
    assert answer["goal"] == {"rate": 1.0} and answer["duration"] == 6.0 and answer["motion"] == "slew"
    left = {name: each["residual_amplitude"] for name, each in answer["commands"].items()}
    assert left["shaped"] < 0.1 * left["smooth-step"]
    names = {file.name for file in Path("shaped").iterdir()}
    plots = {f"{name}.{kind}" for name in ("shaping", "robustness") for kind in ("png", "svg")}
    assert names == {"shaping.nc", "command.json"} | plots
    # The smooth step of the scenario is that of the comparison, and its table the command.
    smooth, shaped = (gb.study(gb.read_scenario(each)).responses["slew"] for each in (slewing, "shaped/command.json"))
    after = smooth.time >= 6.0
    amplitude = np.ptp(smooth.tip[after, 1]) / 2
    assert amplitude > 0.3 * left["smooth-step"] and shaped.residual_from == 6.0
    assert shaped.peaks.residual_amplitude[1] < left["shaped"] + 1e-3 * left["smooth-step"]


def test_a_command_decides_how_long_its_scenario_lasts_where_that_says_nothing(slewing: Path) -> None:
    """As it may where a record of another motion has the duration."""
    samples = "".join(f"{k / 10},{k % 3}\n" for k in range(40))
    Path("record.csv").write_text(f"t,z\n{samples}", encoding="utf-8")
    record = '{ file = "record.csv", time = "t", x = "0", y = "0", z = "z", unit = "g" }'
    flown = f'{SPECIMEN}{model("FOAM", 0, 2, 0)}{SLEW}[motion.flight]\nkind = "flight"\nrecord = {record}\n'
    slewing.write_text(flown, encoding="utf-8")
    written = json.loads(scenario_with(gb.shape_hub_command(slewing, duration=0.4), slewing))
    assert written["response"] == {"duration": pytest.approx(0.5), "residual_from": 0.4} and len(written["motion"]) == 1


def test_other_goals_and_times(slewing: Path) -> None:
    case = gb.read_scenario(slewing)
    angle = gb.shape_hub_command(case, angle=0.5, duration=8.0)
    assert not angle.to_rate and angle.goal == 0.5 and angle.duration == 8.0
    turned = gb.Hub(radius=0.5, rate=gb.SplineProfile(angle.duration, angle.coefficients)).angle(9.0)
    assert turned == pytest.approx(0.5, abs=1e-9)
    same = gb.shape_command(case.subject, gb.Hub(radius=0.5), angle=0.5, duration=8.0)
    assert np.array_equal(same.coefficients, angle.coefficients)


MODAL = """
[bodies.panel]
kind = "modal-test"
frequency = ["2 Hz", "3.5 Hz"]
damping_ratio = ["1 %", "2 %"]
nodes = [["150 mm", 0, 0], ["300 mm", 0, 0]]
shapes = [[[0, 1, 0], [0, 1, 0]], [[0, 1, 0], [0, -1, 0]]]
modal_mass = "0.2 kg"
masses = ["0.1 kg", "0.1 kg"]
points = { middle = 0 }
[motion.hub]
kind = "hub"
radius = "200 mm"
rate = { profile = "smooth-step", level = "0.5 rad/s", duration = "2 s" }
[response]
duration = "3 s"
residual_from = "2 s"
step = "5 ms"
estimate = false
"""


def oscillators(rate: Any, times: np.ndarray) -> np.ndarray:
    """Displacement of the two masses of MODAL across the hub's arm, (t, 2) m: two oscillators in its axes."""
    shapes, at = np.array([[1.0, 1.0], [1.0, -1.0]]), 0.2 + np.array([0.15, 0.3])
    omega, damping = 2 * np.pi * np.array([2.0, 3.5]), np.array([0.01, 0.02])

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        turn, alpha = rate.derivatives(np.array([t]))
        pushed = -alpha[0] * shapes @ at / 2 - (omega**2 - turn[0] ** 2) * y[:2] - 2 * damping * omega * y[2:]
        return np.concatenate([y[2:], pushed])

    how: Any = {"t_eval": times, "rtol": 1e-10, "atol": 1e-14}
    return (solve_ivp(slope, (0.0, times[-1]), np.zeros(4), **how).y[:2].T) @ shapes


def test_a_modal_test_on_a_hub_is_shaped_and_swept_together_as_oscillators_move(slewing: Path, gbeam: Call) -> None:
    slewing.write_text(MODAL, encoding="utf-8")
    smooth, times = gb.SmoothStep(0.5, 2.0), np.linspace(0.0, 4.0, 4001)
    answer = gbeam("shape", slewing, "--json").json
    left = {name: each["residual_amplitude"] for name, each in answer["commands"].items()}
    after = oscillators(smooth, times)[times > 2.0, 1]
    assert (
        left["smooth-step"] == pytest.approx(np.ptp(after) / 2, rel=0.02)
        and left["shaped"] < 1e-5 * left["smooth-step"]
    )
    levels = [0.2, 0.5, 0.8]
    over = {"motion.hub.rate.level": levels}
    swept = gb.sweep(slewing, over, ["tip.y.max_abs"], histories=["middle.y"], times=4)
    for k, level in enumerate(levels):
        moved = oscillators(gb.SmoothStep(level, 2.0), np.linspace(0.0, 3.0, 3001))
        assert swept.measures["tip.y.max_abs"][k] == pytest.approx(np.abs(moved[:, 1]).max(), rel=2e-3)
        assert swept.histories["middle.y"][k][1] == pytest.approx(moved[1000, 0], rel=5e-3)
    refused = gbeam("sweep", slewing, "--over", "motion.hub.radius=0.1 m, 0.2 m", "--history", "root_torque.y")
    assert refused.status == 2 and "is no history; did you mean" in refused.err
    refused = gbeam("shape", slewing, "--check", "exact")
    assert refused.status == 2 and "no body is a beam, whose model could be another" in refused.err


def test_what_it_refuses(slewing: Path, gbeam: Call) -> None:
    free = Path("free.toml")
    free.write_text(FREE_HUB, encoding="utf-8")
    answer = gbeam("shape", free, "--duration", "6 s")
    assert (
        answer.status == 2
        and "the torque of motion.slew says of no angle or rate; give --angle or --rate" in answer.err
    )
    answer = gbeam("shape", slewing, "--motion", "spin")
    assert answer.status == 2 and "--motion is 'spin'; name one of slew" in answer.err
    answer = gbeam("shape", slewing, "--limit", "1 N")
    assert answer.status == 2 and "--limit" in answer.err
    answer = gbeam("shape", slewing, "--limit", "0.01 rad/s^2")
    assert answer.status == 1 and "no command of angular acceleration 0.01 or less" in answer.err
    answer = gbeam("shape", slewing, "--set", 'motion.slew.gravity=[0, "-1 g", 0]')
    assert answer.status == 2 and "motion.slew.gravity bends the beam" in answer.err


PANEL = """
[bodies.wheel]
kind = "rigid"
mass = "20 kg"
inertia = ["50 kg m^2", "50 kg m^2", "50 kg m^2"]
points = { rim = { at = ["0.5 m", 0, 0], turn = ["90 deg", 0, 0] } }
[bodies.panel]
kind = "beam"
length = "3 m"
damping_ratio = "0.5 %"
section = { shape = "rectangle", width = "500 mm", thickness = "20 mm" }
material = { density = "100 kg/m^3", youngs_modulus = "1 GPa" }
model = { kind = "FOAM", modes = { axial = 0, y = 0, z = 2 } }
[joints.axis]
kind = "revolute"
body = "wheel"
axes = [[0, 0, 1]]
rate = { profile = "smooth-step", level = "0.1 rad/s", duration = "6 s" }
[joints.clamp]
kind = "fixed"
body = "panel"
on = "wheel.rim"
[response]
duration = "8 s"
"""


def test_a_joint_of_a_scenario_does_what_its_rate_does_and_its_command_turns_it(slewing: Path, gbeam: Call) -> None:
    slewing.write_text(PANEL, encoding="utf-8")
    answer = gbeam("shape", slewing, "--robust", "10 %", "--check", "exact", "--out", "shaped", "--json").json
    assert answer["goal"] == {"rate": pytest.approx(0.1)} and answer["duration"] == 6.0 and answer["check"] == "exact"
    left = {name: each["residual_amplitude"] for name, each in answer["commands"].items()}
    assert left["shaped"] < 0.1 * left["smooth-step"]
    run = gb.study(gb.read_scenario("shaped/command.json")).responses["ground"]
    assert run.time[-1] == pytest.approx(8.0) and run.signal("axis.angle_rate")[-1] == pytest.approx(0.1, rel=1e-9)
    place = run.at("panel.tip") - run.at("panel.root")
    late = np.linalg.norm(place, axis=1)[run.time > 6.0]
    assert np.ptp(late) < 0.2 * left["smooth-step"]


def test_what_it_refuses_of_systems(slewing: Path, gbeam: Call) -> None:
    slewing.write_text(PANEL, encoding="utf-8")
    for option, said in (
        (("--joint", "axis.angel"), "choose one of axis.angle"),
        (("--point", "wheel.rim", "--rate", "1 rad/s"), "both given or both missing"),
        (("--distance", "1 m"), "what is driven turns"),
        (("--set", "system.gravity=[0, -9.81, 0]"), "system.gravity bends the beam"),
    ):
        answer = gbeam("shape", slewing, "--angle", "1 rad", *option)
        assert answer.status == 2 and said in answer.err, answer.err
    flown = '[motion.flight]\nkind = "flight"\nacceleration = { y = { profile = "constant", level = "1 g" } }\n'
    slewing.write_text(PANEL + flown, encoding="utf-8")
    assert "motion.flight bends the beam" in gbeam("shape", slewing, "--angle", "1 rad").err
    shaken = flown.replace(
        'profile = "constant", level = "1 g"', 'profile = "sine", amplitude = "1 g", duration = "1 s"'
    )
    slewing.write_text(PANEL + shaken, encoding="utf-8")
    assert "motion.flight shakes or turns the system" in gbeam("shape", slewing, "--angle", "1 rad").err
    slewing.write_text(SLEWING, encoding="utf-8")
    assert (
        "beam is on a hub, without joints; name it by --motion" in gbeam("shape", slewing, "--joint", "axis.angle").err
    )
