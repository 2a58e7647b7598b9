"""The verbs as a user calls them: what they print, and what they refuse with the verb that can."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from gbeam.cli import main
from gbeam.plots.campbell import plot_campbell
from gbeam.results.modal import Campbell

HUB = """\
title = "hub"
[beam]
length = "8 m"
section = { area = "7.2968e-5 m^2", inertia_y = "8.2189e-9 m^4", inertia_z = "8.2189e-9 m^4" }
material = { density = "2766.7 kg/m^3", youngs_modulus = "6.8952e10 Pa" }
damping_ratio = 0
[model]
kind = "TLAM"
modes = { axial = 1, y = 3, z = 0 }
[motion.slew]
kind = "hub"
radius = "0.5 m"
rate = { profile = "smooth-step", level = "2 rad/s", duration = "30 s" }
[motion.flight]
kind = "flight"
acceleration = { y = { profile = "constant", level = "0.1 g" } }
[response]
duration = "35 s"
"""


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """Call a verb on the scenario: exit status, JSON, stderr."""
    monkeypatch.chdir(tmp_path)
    Path("hub.toml").write_text(HUB)

    def run(verb, *options):
        status = main([verb, "hub.toml", "--json", *options])
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        return status, json.loads(said.out), said.err

    return run


def test_modes(call):
    status, told, _ = call("modes", "--motion", "slew", "--at", "32 s", "--out", "there")
    assert status == 0
    frequencies = [it["frequency"] for it in told["modes"]]
    assert frequencies == sorted(frequencies) and told["modes"][0]["direction"] == "y"
    assert frequencies[0] == pytest.approx(0.336597, rel=1e-3)  # sqrt(2.91074² − 2²)/2π
    assert {it.name for it in Path("there").iterdir()} == {"modes.json", "modes.png", "modes.svg"}
    first = told["modes"][0]["shape"]["y"]
    assert abs(first[0]) < 1e-15 and first[-1] == 1.0 and len(first) == len(told["stations"])


def test_no_unit_is_torn_and_no_rounding_is_damping(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("hub.toml").write_text(HUB)
    assert main(["linearize", "hub.toml", "--motion", "slew"]) == 0
    assert "[N m]" in capsys.readouterr().out.replace("\N{NO-BREAK SPACE}", " ").splitlines()[-2]
    assert main(["modes", "hub.toml", "--motion", "slew", "--at", "32 s"]) == 0
    assert "e-1" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (("campbell", "--modes", "0"), "--modes"),
        (("campbell", "--orders", "-1"), "--orders"),
        (("campbell", "--from", "3 rad/s", "--to", "1 rad/s"), "--to"),
        (("critical-speed", "--to", "0 rad/s"), "--to"),
        (("linearize", "--motion", "slew", "--modes", "-1"), "--modes"),
        (("modes", "--motion", "nope"), "--motion"),
    ],
)
def test_a_wrong_option_is_named_and_not_a_line_of_the_file(call, words, option):
    status, told, said = call(*words)
    assert status == 2 and told["error"][0]["path"] == option and said.startswith(f"gbeam: {option} is ")


@pytest.mark.parametrize("verb", ["static", "modes", "campbell", "critical-speed", "linearize", "models", "run"])
def test_help_tells_the_files_and_the_exit_status(verb, capsys):
    assert main([verb, "--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "--out" in told and ("Exit status" in told or "exit status 0" in told)


def test_campbells_plot_shows_the_modes_that_the_multiples_meet():
    speed = np.linspace(0, 1, 5)
    frequency = np.outer(1 + 0.1 * speed, [0.2, 0.5, 80.0])
    diagram = Campbell(
        "slew", "FOAM", speed, frequency, 0 * frequency, 0 * frequency, ("y", "y", "x"), (1, 2), (), None
    )
    panel = plot_campbell(diagram, "title").axes[0]
    assert panel.get_ylim()[1] < 1.0 and len(panel.lines) == 2 + 2
    assert [it.get_text() for it in panel.get_legend().get_texts()] == ["mode 1, y", "mode 2, y"]


def test_static(call):
    status, told, _ = call("static", "--motion", "flight", "--out", "there")
    # w L⁴/8EI of a uniform load, down where the base accelerates up
    wanted = 2766.7 * 7.2968e-5 * 0.980665 * 8**4 / (8 * 6.8952e10 * 8.2189e-9)
    assert status == 0 and told["motions"]["flight"]["tip"]["y"] == pytest.approx(-wanted, rel=1e-3)
    weight = 2766.7 * 7.2968e-5 * 8 * 0.980665
    loads = told["motions"]["flight"]["loads"]
    assert loads["root_force"]["y"] == pytest.approx(weight, rel=1e-9)
    assert loads["section_moment"]["z"][0] == pytest.approx(-weight * 4, rel=5e-3)
    assert loads["section_moment"]["z"][-1] == 0.0 and len(loads["stations"]) == len(loads["section_force"]["x"])
    assert loads["stress"] == [None] * len(loads["stations"])  # of such a section no outer fibre is known
    names = {f"{stem}.{kind}" for stem in ("static", "loads_flight") for kind in ("png", "svg")}
    assert {it.name for it in Path("there").iterdir()} == {"static.json", *names}


def test_critical_speed(call):
    status, told, _ = call("critical-speed")
    assert status == 0 and told["critical_speed"] == pytest.approx(2.91074, abs=1e-5)
    status, told, _ = call("critical-speed", "--set", "model.kind=FOAM", "--to", "60 rpm")
    assert status == 0 and told["critical_speed"] is None and "keeps its equilibrium" in told["reason"]


def test_campbell(call):
    status, told, _ = call("campbell", "--modes", "2", "--out", "there")
    assert status == 0 and told["speed"][-1] == pytest.approx(2.0) and len(told["tracks"]) == 2
    assert Path("there/campbell.png").stat().st_size > 1000


def test_linearize(call):
    status, told, _ = call("linearize", "--motion", "flight", "--out", "there")
    assert status == 0 and len(told["A"]) == 8 and told["inputs"][0]["unit"] == "m/s^2"
    assert Path("there/linear.mat").exists()


def test_linearize_balanced_with_strain_on_the_face_of_the_root(call):
    rectangle = ("--set", 'beam.section={ shape = "rectangle", width = "20 mm", thickness = "4 mm" }')
    options = ("--motion", "flight", *rectangle, "--set", "beam.damping_ratio=0.01")
    status, told, _ = call("linearize", *options, "--strain-at", "0 mm", "--balanced", "4")
    assert status == 0 and len(told["A"]) == 4 and len(told["hankel_singular_values"]) == 8
    assert [it["name"] for it in told["outputs"]].count("strain_1") == 1
    assert told["gauges"] == [{"at": 0.0, "y": 0.0, "z": 0.002}, {"at": 0.0, "y": 0.01, "z": 0.0}]
    # ε = −v'' y at the root of a uniformly loaded cantilever, v'' = w L²/2EI; three shapes come within 8 %.
    strain = told["outputs"][[it["name"] for it in told["outputs"]].index("strain_2")]["value"]
    inertia, area = 0.004 * 0.02**3 / 12, 0.02 * 0.004
    assert strain == pytest.approx(0.01 * 2766.7 * area * 0.980665 * 8**2 / (2 * 6.8952e10 * inertia), rel=0.1)
    assert "--balanced is 40" in call("linearize", *options, "--balanced", "40")[2]
    assert "--strain-at is 9 m" in call("linearize", *options, "--strain-at", "9 m")[2]


def test_linearize_of_some_signals(call):
    options = ("--motion", "slew", "--rate", "1 rad/s", "--outputs", "tip_y", "--inputs", "base_acceleration_y")
    # One vibration, and two components of the base's rate.
    status, told, _ = call("linearize", *options, "--modes", "1")
    assert status == 0 and np.shape(told["A"]) == (4, 4) and np.shape(told["D"]) == (1, 1)
    assert [it["name"] for it in told["outputs"]] == ["tip_y"]
    assert call("linearize", *options, "--at", "1 s")[0] == 2
    status, _, said = call("linearize", "--motion", "slew", "--outputs", "nose")
    assert status == 2 and "choose from tip_x" in said


@pytest.mark.parametrize(("verb", "answers"), [("campbell", "gbeam modes"), ("critical-speed", "gbeam modes")])
def test_a_flight_is_refused_with_the_verb_that_can(call, verb, answers):
    status, told, said = call(verb, "--motion", "flight")
    assert status == 2 and answers in said
    assert told["error"][0]["path"] == "motion.flight"


def test_unknown_motion_and_time(call):
    assert "slew, flight" in call("modes", "--motion", "slow")[2]
    assert call("modes", "--motion", "slew", "--at", "3 kg")[0] == 2
    assert "name one of" in call("modes")[2]


@pytest.mark.slow
def test_models(call):
    changes = ("motion.slew.rate.level=1 rad/s", "response.residual_from=30 s")
    status, told, _ = call("models", *(word for it in changes for word in ("--set", it)))
    rows = {it["model"]: it for it in told["rows"] if it["motion"] == "slew"}
    assert status == 0 and set(rows) == {"TLAM", "FOAM", "SFOAM", "CFOAM", "exact"}
    # The first-order models beat the linear one by far, and the complete one too.
    assert abs(rows["FOAM"]["peak_error"]) < 1e-3 < 0.02 < abs(rows["TLAM"]["peak_error"])
