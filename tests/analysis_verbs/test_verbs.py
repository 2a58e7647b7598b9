"""The verbs as a user calls them: what they print, and what they refuse with the verb that can."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gbeam.figures import campbell
from gbeam.io import read_stored
from gbeam.plots import draw
from gbeam.results import Campbell, each_once

from ..scenarios import SLEWING, SLEWING_AND_FLYING


@pytest.fixture
def scenario(tmp_path, monkeypatch):
    """A slewing hub and a flight of the same beam, in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("hub.toml").write_text(SLEWING_AND_FLYING, encoding="utf-8")


@pytest.fixture
def call(scenario, gbeam):
    """Call a verb on the scenario: exit status, JSON, stderr."""

    def run(verb, *options):
        answer = gbeam(verb, "hub.toml", "--json", *options)
        return answer.status, answer.json, answer.err

    return run


def test_modes(call, with_figures):
    status, facts, _ = call("modes", "--motion", "slew", "--at", "32 s", "--out", "there")
    assert status == 0
    frequencies = [mode["frequency"] for mode in facts["modes"]]
    assert frequencies == sorted(frequencies) and facts["modes"][0]["direction"] == "y"
    assert frequencies[0] == pytest.approx(0.336597, rel=1e-3)  # sqrt(2.91074² − 2²)/2π
    assert {file.name for file in Path("there").iterdir()} == {"modes.json", "modes.png", "modes.svg"}
    beam = facts["bodies"]["beam"]
    first = beam["modes"][0]["shape"]["y"]
    assert abs(first[0]) < 1e-15 and first[-1] == pytest.approx(1.0) and len(first) == len(beam["stations"])


def test_an_equilibrium_and_its_loss_have_pages(call):
    motion = {"static": "flight", "critical-speed": "slew"}
    for verb, key, options in (
        ("static", "static", ()),
        ("critical-speed", "critical_speed", ()),
        ("critical-speed", "critical_speed", ("--masses", "0.5 kg", "--positions", "2 m, 8 m")),
    ):
        status, facts, _ = call(verb, "--motion", motion[verb], *options, "--out", "pages", "--report")
        page = Path("pages", f"{key}.html").read_text(encoding="utf-8")
        assert status == 0 and f"gbeam {verb}" in page
        if verb == "static":
            flight = facts["motions"]["flight"]["bodies"]["beam"]
            shown = [1e3 * flight["tip"]["y"], flight["loads"]["root_moment"]["z"]]
            assert shown[0] < -1 and shown[1] > 0  # the root goes one way, the tip stays behind
        else:
            shown = np.ravel(facts["critical_speed"])
        numbers = [float(each) for each in re.findall(r"-?\d+\.\d+", page)]
        assert len(shown) and all(np.isclose(numbers, each, rtol=1e-4).any() for each in shown)
    assert np.ravel(facts["critical_speed"])[0] == pytest.approx(2.9107, rel=0.2)


def test_no_unit_is_torn_and_no_rounding_is_damping(scenario, gbeam):
    answer = gbeam("linearize", "hub.toml", "--motion", "slew")
    assert answer.status == 0
    assert any(line.split()[1:3] == ["N", "m"] for line in answer.out.splitlines())
    answer = gbeam("modes", "hub.toml", "--motion", "slew", "--at", "32 s")
    assert answer.status == 0 and "e-1" not in answer.out


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
    status, facts, err = call(*words)
    assert status == 2 and facts["error"][0]["path"] == option and err.startswith(f"gbeam: {option} is ")


@pytest.mark.parametrize("verb", ["static", "modes", "campbell", "critical-speed", "linearize", "models", "run"])
def test_help_names_the_files_and_the_exit_status(verb, gbeam):
    answer = gbeam(verb, "--help")
    words = " ".join(answer.out.split())
    assert answer.status == 0 and "--out" in words and ("Exit status" in words or "exit status 0" in words)


def test_campbells_plot_shows_the_modes_that_the_multiples_meet():
    speed = np.linspace(0, 1, 5)
    frequency = np.outer(1 + 0.1 * speed, [0.2, 0.5, 80.0])
    diagram = Campbell(
        "slew", "FOAM", speed, frequency, 0 * frequency, 0 * frequency, ("y", "y", "x"), (1, 2), (), None
    )
    panel = draw(campbell(diagram, "title")).axes[0]
    assert panel.get_ylim()[1] < 1.0 and len(panel.lines) == 2 + 2
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["mode 1, y", "mode 2, y"]

    # In rpm: the same on another axis, each multiple with its name on its line and inside.
    panel = draw(campbell(replace(diagram, orders=(1, 2, 40)), "title", (30 / np.pi, "rpm"))).axes[0]
    assert panel.get_xlabel() == "hub rate, rpm"
    np.testing.assert_allclose(panel.lines[0].get_xdata(), speed * 30 / np.pi)
    orders = {text.get_text(): text.get_position() for text in panel.texts}
    assert list(orders) == ["1P", "2P", "40P"]
    for name, (rpm, hertz) in orders.items():
        assert hertz == pytest.approx(int(name[:-1]) * rpm / 60)
        assert 0 < hertz < panel.get_ylim()[1] and 0 < rpm < speed[-1] * 30 / np.pi


def test_static(call, with_figures):
    status, facts, _ = call("static", "--motion", "flight", "--out", "there")
    # w L⁴/8EI of a uniform load, down where the base accelerates up
    expected = 2766.7 * 7.2968e-5 * 0.980665 * 8**4 / (8 * 6.8952e10 * 8.2189e-9)
    flight = facts["motions"]["flight"]["bodies"]["beam"]
    assert status == 0 and flight["tip"]["y"] == pytest.approx(-expected, rel=1e-3)
    weight = 2766.7 * 7.2968e-5 * 8 * 0.980665
    loads = flight["loads"]
    assert loads["root_force"]["y"] == pytest.approx(weight, rel=1e-9)
    assert loads["section_moment"]["z"][0] == pytest.approx(-weight * 4, rel=5e-3)
    assert loads["section_moment"]["z"][-1] == 0.0 and len(loads["stations"]) == len(loads["section_force"]["x"])
    assert loads["stress"] == [None] * len(loads["stations"])  # of such a section no outer fibre is known
    names = {f"{stem}.{kind}" for stem in ("static", "loads_flight") for kind in ("png", "svg")}
    assert {file.name for file in Path("there").iterdir()} == {"static.json", *names}


def test_critical_speed(call):
    status, facts, _ = call("critical-speed")
    assert status == 0 and facts["critical_speed"] == pytest.approx(2.91074, abs=1e-5)
    status, facts, _ = call("critical-speed", "--set", "model.kind=FOAM", "--to", "60 rpm")
    assert status == 0 and facts["critical_speed"] is None and "keeps its equilibrium" in facts["reason"]


def test_campbell(call, with_figures):
    status, facts, _ = call("campbell", "--modes", "2", "--out", "there")
    assert status == 0 and facts["speed"][-1] == pytest.approx(2.0) and len(facts["tracks"]) == 2
    assert Path("there/campbell.png").stat().st_size > 1000


def test_campbell_speaks_in_the_unit_given(scenario, gbeam, with_figures):
    answer = gbeam("campbell", "hub.toml", "--modes", "2", "--to", "20 rpm", "--out", "there")
    assert answer.status == 0 and "TLAM, 0 to 20 rpm" in answer.out and "rad/s" not in answer.out
    assert json.loads(Path("there/campbell.json").read_text(encoding="utf-8"))["speed"][-1] == pytest.approx(
        2 * np.pi / 3
    )
    assert "<!-- hub rate, rpm -->" in Path("there/campbell.svg").read_text(encoding="utf-8")


def test_linearize(call):
    status, facts, _ = call("linearize", "--motion", "flight", "--out", "there")
    assert status == 0 and len(facts["A"]) == 8 and facts["inputs"][0]["unit"] == "m/s^2"
    assert Path("there/linear.mat").exists()


def test_linearize_balanced_with_strain_on_the_face_of_the_root(call):
    rectangle = ("--set", 'beam.section={ shape = "rectangle", width = "20 mm", thickness = "4 mm" }')
    options = ("--motion", "flight", *rectangle, "--set", "beam.damping_ratio=0.01")
    status, facts, _ = call("linearize", *options, "--strain-at", "0 mm", "--balanced", "4")
    assert status == 0 and len(facts["A"]) == 4 and len(facts["hankel_singular_values"]) == 8
    assert [signal["name"] for signal in facts["outputs"]].count("strain_1") == 1
    assert facts["gauges"] == [
        {"at": 0.0, "y": 0.0, "z": 0.002, "along": [1.0, 0.0, 0.0], "body": ""},
        {"at": 0.0, "y": 0.01, "z": 0.0, "along": [1.0, 0.0, 0.0], "body": ""},
    ]
    # ε = −v'' y at the root of a uniformly loaded cantilever, v'' = w L²/2EI.
    strain = facts["outputs"][[signal["name"] for signal in facts["outputs"]].index("strain_2")]["value"]
    inertia, area = 0.004 * 0.02**3 / 12, 0.02 * 0.004
    assert strain == pytest.approx(0.01 * 2766.7 * area * 0.980665 * 8**2 / (2 * 6.8952e10 * inertia), rel=1e-6)
    assert "--balanced is 40" in call("linearize", *options, "--balanced", "40")[2]
    assert "--strain-at is 9 m" in call("linearize", *options, "--strain-at", "9 m")[2]


def test_linearize_of_some_signals(call):
    options = ("--motion", "slew", "--rate", "1 rad/s", "--outputs", "tip_y", "--inputs", "base_acceleration_y")
    # One vibration, and two components of the base's rate.
    status, facts, _ = call("linearize", *options, "--modes", "1")
    assert status == 0 and np.shape(facts["A"]) == (4, 4) and np.shape(facts["D"]) == (1, 1)
    assert [signal["name"] for signal in facts["outputs"]] == ["tip_y"]
    assert call("linearize", *options, "--at", "1 s")[0] == 2
    status, _, err = call("linearize", "--motion", "slew", "--outputs", "nose")
    assert status == 2 and "choose from tip_x" in err


@pytest.mark.parametrize(("verb", "answers"), [("campbell", "gbeam modes"), ("critical-speed", "gbeam modes")])
def test_a_flight_is_refused_with_the_verb_that_can(call, verb, answers):
    status, facts, err = call(verb, "--motion", "flight")
    assert status == 2 and answers in err
    assert facts["error"][0]["path"] == "motion.flight"


def test_unknown_motion_and_time(call):
    assert "slew, flight" in call("modes", "--motion", "slow")[2]
    assert call("modes", "--motion", "slew", "--at", "3 kg")[0] == 2
    assert "name one of" in call("modes")[2]


@pytest.mark.slow
def test_models(call):
    Path("hub.toml").write_text(SLEWING, encoding="utf-8")
    changes = ("motion.slew.rate.level=1 rad/s", "response.residual_from=30 s")
    status, facts, _ = call("models", *(word for change in changes for word in ("--set", change)))
    rows = {row["model"]: row for row in facts["rows"] if row["motion"] == "slew"}
    assert status == 0 and set(rows) == {"TLAM", "FOAM", "SFOAM", "CFOAM", "fourth-order", "exact"}
    # The first-order models beat the linear one by far, and the complete one too.
    assert abs(rows["FOAM"]["peak_error"]) < 1e-3 < 0.02 < abs(rows["TLAM"]["peak_error"])


def test_the_rounding_of_a_profile_turns_no_base(scenario, gbeam):
    answer = gbeam("modes", "hub.toml", "--motion", "slew", "--at", "0 s")
    assert answer.status == 0 and "at 0 s\n" in answer.out and "turning at" not in answer.out


SHORT = ("--set", "response.duration=1 s", "--set", "response.step=50 ms", "--set", "response.estimate=false")


@pytest.mark.parametrize(
    "words",
    [
        ("check",),
        ("run", *SHORT),
        ("static", "--motion", "slew"),
        ("modes", "--motion", "slew"),
        ("campbell", "--to", "1 rad/s"),
        ("critical-speed",),
        ("critical-speed", "--masses", "0.5 kg", "--positions", "8 m"),
        ("linearize", "--motion", "slew"),
        ("models", *SHORT),
        ("sweep", "--verb", "modes", "--over", "motion.slew.radius=1 m, 2 m", "--measure", "modes[0].frequency"),
        ("sensitivity", "--verb", "modes", "--with", "motion.slew.radius", "--of", "modes[0].frequency"),
    ],
    ids=" ".join,
)
def test_every_answer_on_a_hub_says_once_that_gravity_is_left_out(scenario, gbeam, words):
    """It is meant of a satellite, and not of a test arm: information, which no warning is."""
    verb, *options = words
    motion = () if "--motion" in options or verb in ("check", "run", "models") else ("--motion", "slew")
    answer = gbeam(verb, "hub.toml", *motion, *options)
    assert answer.status == 0, answer.err
    (line,) = (line for line in answer.out.splitlines() if "gravity" in line)
    assert line.startswith("  note: motion.slew: gravity is left out")
    if verb == "check":  # the offered line is taken, and says nothing of none that is meant
        gravity = re.search(r"give (gravity = .*\]),", line)[1]
        text = Path("hub.toml").read_text(encoding="utf-8")
        for line in (gravity, gravity.replace("-1 g", "0 g")):
            Path("hub.toml").write_text(text.replace("\nradius", f"\n{line}\nradius"), encoding="utf-8")
            assert "gravity is left out" not in gbeam("check", "hub.toml").out


def test_the_root_of_a_file_and_of_json_has_the_warnings_and_notes_of_every_motion(scenario, gbeam):
    """Each once, and with the motion's name where it is not of all and does not say it."""
    run = gbeam("run", "hub.toml", "--json", *SHORT[:4], "--out", "there").json
    root, motions = read_stored("there/result.nc").attrs[""], run["motions"]
    assert run["notes"] == motions["slew"]["notes"] and "notes" not in motions["flight"]
    (warning,) = motions["flight"]["warnings"]  # of its error, which is above the tolerance
    assert run["warnings"] == [f"flight: {warning}"] and motions["slew"]["warnings"] == []
    for kind in ("warnings", "notes"):
        assert root[kind].split("\n") == run[kind]
    assert each_once({"a": ("x", "y", "motion.a is long"), "b": ("x", "z")}) == (
        "x",
        "a: y",
        "motion.a is long",
        "b: z",
    )
