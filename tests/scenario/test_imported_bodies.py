"""Scenarios of bodies that other programs and tests give, of fixtures, and of control points."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import gbeam as gb
from gbeam.figures import figures_of
from gbeam.results import facts_of
from gbeam.scenario import ScenarioError
from tests.solids.test_imported import reduced, write_storage
from tests.solids.test_modal_tests import beam, measured

pytestmark = pytest.mark.usefixtures("reading_in_process")

EXAMPLES = Path("examples/data").resolve()
TURN = """
[motion.turn]
kind = "flight"
acceleration = { z = { profile = "trapezoid", level = "4 g", jerk = "40 g/s", start = 0, hold = "0.1 s" } }
"""
RESPONSE = '\n[response]\nduration = "0.4 s"\nstep = "1 ms"\nintegrator = "gauss"\n'
SID = '[bodies.strip]\nstandard_input_data = "strip.sid"\ndamping_ratio = "1 %"\n'


def case_of(folder: Path, text: str) -> Any:
    file = folder / "scenario.toml"
    file.write_text(text, encoding="utf-8")
    return gb.read_scenario(file)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copy(EXAMPLES / "strip.sid", tmp_path)
    return tmp_path


def test_standard_input_data_are_a_specimen_and_a_body(folder: Path) -> None:
    """Alone, and on a rigid joint: the body that Python reads, moved alike; computed again without its file."""
    alone = case_of(folder, SID + TURN + RESPONSE)
    read = gb.read_sid(folder / "strip.sid", damping_ratio=0.01)
    np.testing.assert_array_equal(alone.subject.coefficients.k_ww, read.coefficients.k_ww)
    study = gb.study(alone)
    joint = '[joints.foot]\nkind = "fixed"\nbody = "strip"\n'
    tree = case_of(folder, SID + joint + TURN + RESPONSE)
    held = gb.simulate(tree.system, tree.motions["turn"], tree.response)
    place = held.place[:, held.points.index("strip.tip")]
    moved = study.responses["turn"]
    z = np.interp(moved.time, held.time, (place - place[0])[:, 2])
    np.testing.assert_allclose(z, moved.tip[:, 2], atol=2e-3 * np.abs(z).max())
    study.save(folder / "result.nc")
    (folder / "strip.sid").unlink()
    assert gb.rerun(folder / "result.nc").reproduced


def test_matrices_of_several_files_are_computed_again_without_them(folder: Path) -> None:
    """CalculiX's, whose rows are in a third file: each is named, and the result holds it."""
    files = write_storage(folder, reduced())
    names = ", ".join(f'"{file.name}"' for file in files)
    text = f'[bodies.beam]\nmatrices = [{names}]\nclamp = [7]\nmodes = 5\ndamping_ratio = "1 %"\n'
    study = gb.study(case_of(folder, text + TURN + RESPONSE))
    study.save(folder / "result.nc")
    for file in files:
        file.unlink()
    assert gb.rerun(folder / "result.nc").reproduced


def modal_text(**changes: str) -> str:
    """Two modes of a tip and a middle of equal masses on a string: exact shapes (1, ±1)."""
    keys = {
        "kind": '"modal-test"',
        "frequency": '["20 Hz", "35 Hz"]',
        "damping_ratio": '["1 %", "2 %"]',
        "nodes": '[["150 mm", 0, 0], ["300 mm", 0, 0]]',
        "shapes": "[[[0, 0, 1], [0, 0, 1]], [[0, 0, 1], [0, 0, -1]]]",
        "modal_mass": '"0.2 kg"',
        "masses": '["0.1 kg", "0.1 kg"]',
        "points": "{ middle = 0 }",
    } | changes
    return "[bodies.panel]\n" + "".join(f"{key} = {value}\n" for key, value in keys.items() if value) + TURN + RESPONSE


def test_a_modal_test_is_a_specimen(folder: Path) -> None:
    """Two masses move as oscillators under an even load: the first mode as the closed form, the second at rest."""
    case = case_of(folder, modal_text())
    np.testing.assert_allclose(case.subject.rest[0] / (2 * np.pi), [20.0, 35.0])
    modes = gb.modes(case.subject, case.motions["turn"])
    np.testing.assert_allclose(modes.damping_ratio, [0.01, 0.02], rtol=1e-9)
    response = gb.study(case).responses["turn"]
    assert response.body.points == ("middle", "tip")
    np.testing.assert_allclose(response.body.at("middle"), response.tip, atol=1e-12)
    rest = gb.static(case.subject, acceleration=(0, 0, 10.0))
    assert rest.tip[2] == pytest.approx(-10.0 / (40 * np.pi) ** 2, rel=1e-9)
    assert any("no geometric stiffness" in each for each in response.warnings)


def test_a_modal_test_of_a_file_is_swept(folder: Path) -> None:
    """The file's damping gives way to the scenario's, which a sweep varies; the command line reports it."""
    import pyuff

    each = measured()
    numbers = np.arange(1, len(each["nodes"]) + 1)
    grid = {"type": 15, "node_nums": numbers, "def_cs": 0 * numbers, "disp_cs": 0 * numbers, "color": 0 * numbers}
    sets = [grid | dict(zip("xyz", each["nodes"].T, strict=True))]
    for i, frequency in enumerate(each["frequency"][:2]):
        about = {"type": 55, "model_type": 1, "node_nums": numbers, "data_ch": 2, "spec_data_type": 8, "load_case": 0,
                 "mode_n": i + 1, "n_data_per_node": 3, "analysis_type": 2, "data_type": 2, "freq": frequency,
                 "modal_m": 1.0, "modal_damp_vis": 0.01, "modal_damp_his": 0.0,
                 **{f"id{k}": "strip" for k in range(1, 6)}}  # fmt: skip
        sets.append(about | dict(zip(("r1", "r2", "r3"), each["shapes"][:, :, i].T, strict=True)))
    pyuff.UFF(str(folder / "strip.uff")).write_sets(sets, "overwrite")
    masses = ", ".join(f"{mass:.12g}" for mass in beam().mass)
    body = f'[bodies.strip]\nmodal_test = "strip.uff"\nmasses = [{masses}]\ndamping_ratio = 0.03\n'
    case_of(folder, body + TURN + RESPONSE)
    sweep = gb.sweep(
        folder / "scenario.toml", {"bodies.strip.damping_ratio": [0.03, 0.06]}, ["modes[0].damping_ratio"], verb="modes"
    )
    np.testing.assert_allclose(next(iter(sweep.measures.values())), [0.03, 0.06], rtol=1e-6)
    command = [sys.executable, "-m", "gbeam", "run", "scenario.toml", "--json", "--report", "--out", "."]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    facts = json.loads(done.stdout)
    assert facts["motions"]["turn"]["outcome"] == "done"
    assert "strip" in (folder / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (SID.replace("strip.sid", "strip.sit"), "bodies.strip.standard_input_data", "no file"),
        (SID + "points = { lens = 99 }\n", "bodies.strip.points.lens", "no node"),
        (SID.replace('"1 %"', "-1"), "bodies.strip.damping_ratio", "from 0 up to 1"),
        (SID.replace("1 %", "200 %"), "bodies.strip.damping_ratio", "from 0 up to 1"),
        (modal_text(masses='["0.1 kg"]'), "bodies.panel.masses", "shape"),
        (modal_text(masses='["1 g", "1 g"]'), "bodies.panel.masses", "modal mass"),
        (modal_text(shapes="[[[0, 0, 1], [0, 0, 1]], [[0, 0, 1]]]"), "bodies.panel.shapes[1]", "1 displacements"),
        (modal_text(frequency='["20 Hz"]'), "bodies.panel.shapes", "frequencies"),
        (modal_text(frequency='["20 Hz", "-3 Hz"]'), "bodies.panel.frequency[1]", "negative"),
        (modal_text(modal_mass=""), "bodies.panel", "modal_mass is missing"),
        (modal_text(modal_test='"strip.sid"'), "bodies.panel.frequency", "given beside modal_test"),
        (modal_text(points="{ lens = 7 }"), "bodies.panel.points.lens", "no node"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_an_imported_body_is_named(folder: Path, text: str, place: str, words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        case_of(folder, text if "[response]" in text else text + TURN + RESPONSE)
    assert f"{place}: " in str(caught.value) and words in str(caught.value)


FIXTURE = """
[bodies.plate]
kind = "rigid"
mass = "1.5 kg"
inertia = [4e-3, 4e-3, 8e-3]
centre = [0, 0, "-10 mm"]

[joints.fixture]
kind = "fixed"
body = "plate"
stiffness = { x = "4e6 N/m", y = 4e6, z = 2e7, rx = "2e4 N m/rad", ry = 2e4, rz = 1e5 }
coupling = { x-ry = "-1e5 N", y-rx = "1e5 N" }

[joints.screws]
kind = "fixed"
body = "strip"
on = "plate.root"
"""


def test_a_fixture_of_a_scenario_is_the_one_of_python(folder: Path) -> None:
    case = case_of(folder, SID + FIXTURE + TURN + RESPONSE)
    springs = {"x": 4e6, "y": 4e6, "z": 2e7, "rx": 2e4, "ry": 2e4, "rz": 1e5}
    joints = {
        "fixture": gb.Joint("fixed", "plate", stiffness=springs, coupling={"x-ry": -1e5, "y-rx": 1e5}),
        "screws": gb.Joint("fixed", "strip", on="plate.root"),
    }
    plate = gb.RigidBody(1.5, (4e-3, 4e-3, 8e-3), (0, 0, -0.01))
    strip = gb.read_sid(folder / "strip.sid", damping_ratio=0.01)
    same = gb.System({"strip": strip, "plate": plate}, joints)
    np.testing.assert_allclose(gb.modes(case.system).frequency, gb.modes(same).frequency, rtol=1e-10)
    path = "joints.fixture.coupling.x-ry"
    sweep = gb.sweep(folder / "scenario.toml", {path: ["-1e5 N", "0 N"]}, ["modes[1].frequency"], verb="modes")
    coupled, plain = next(iter(sweep.measures.values()))
    assert coupled != plain


@pytest.mark.parametrize(
    ("before", "after", "place", "words"),
    [
        ("x-ry", "x-rw", "joints.fixture.coupling.x-rw", "did you mean"),
        ('x-ry = "-1e5 N"', 'x-ry = "-1e5 N/m"', "joints.fixture.coupling.x-ry", "force"),
        ('x-ry = "-1e5 N"', 'x-ry = "1 GN"', "joints.fixture.coupling", "give energy"),
        (", rz = 1e5 }", " }", "joints.fixture.coupling.x-rz", "no pair"),
    ],
)  # fmt: skip
def test_couplings_that_cannot_be_are_placed(folder: Path, before: str, after: str, place: str, words: str) -> None:
    fixture = FIXTURE.replace(before, after)
    fixture = fixture.replace("{ x-ry", "{ x-rz = 0.1, x-ry") if place.endswith("x-rz") else fixture
    with pytest.raises(ScenarioError) as caught:
        case_of(folder, SID + fixture + TURN + RESPONSE)
    assert f"{place}: " in str(caught.value) and words in str(caught.value)


BOX = """
[bodies.box]
kind = "rigid"
mass = "3 kg"
size = ["300 mm", "200 mm", "100 mm"]
centre = [0, 0, "50 mm"]
points = { lid = [0, 0, "100 mm"], edge = { at = ["150 mm", 0, 0] } }
"""
MACHINE = """
[motion.machine]
kind = "centrifuge"
tracks = "turn"
arm = "3.3 m"
control_point = "50 mm"
gravity = true
idle = "1.3 g"
smoothing = "20 ms"
accept = { srs = "40 dB", control = { lid = 3, edge = 1 } }
"""


def test_control_points_of_a_scenario_judge_a_box(folder: Path) -> None:
    """The spectra are the weighted mean of those at its points, which a rigid box feels by a + α × r + ω × (ω × r)."""
    study = gb.study(case_of(folder, BOX + TURN + MACHINE + RESPONSE))
    (comparison,) = study.comparisons
    assert comparison.shock is not None and comparison.shock.control == "lid (75 %), edge (25 %)"
    (judged,) = comparison.criteria
    assert judged.name == "srs" and np.isfinite(judged.value)
    run = study.responses["machine"]
    leaking = '[[1, 0, "2 %"], [0, 1, 0], [0, 0, 1]]'
    lid = f'turn = [0, 0, "20 deg"], frequency = "50 Hz", damping_ratio = "60 %", sensitivity = {leaking}'
    sensed = gb.study(case_of(folder, BOX + TURN + MACHINE + RESPONSE + f"[sensors]\nlid = {{ {lid} }}\n"))
    by_sensor = sensed.comparisons[0].shock
    leaks = np.eye(3) + np.array([[0, 0, 0.02], [0, 0, 0], [0, 0, 0]])
    sensor = gb.Sensor(turn=(0, 0, np.radians(20)), frequency=50.0, damping_ratio=0.6, sensitivity=leaks)
    weights = {"lid": 3.0, "edge": 1.0}
    wanted = gb.compare(study.responses["turn"], run, control=weights, sensors={"lid": sensor}).shock
    assert by_sensor is not None and wanted is not None
    assert by_sensor.control == "lid (75 %, as its sensor reads), edge (25 %)"
    np.testing.assert_allclose(by_sensor.centrifuge, wanted.centrifuge, rtol=1e-12)
    assert not np.allclose(by_sensor.centrifuge, comparison.shock.centrifuge, rtol=0.05)
    for name, each in sensed.responses.items():
        readings, expected = each.readings, study.responses[name].reading_at("lid", sensor)
        assert readings is not None and readings.points == ("lid",)
        np.testing.assert_allclose(readings.acceleration[:, 0], expected, atol=1e-12)
        said = facts_of(each)["sensors"]["lid"]["size"]
        assert said["max_abs"] == pytest.approx(np.linalg.norm(expected, axis=1).max(), rel=1e-3)
        assert "sensors" in figures_of(each)
    sensed.save(folder / "read.nc")
    kept = xarray.open_datatree(folder / "read.nc")["motions/machine"]
    np.testing.assert_allclose(kept["sensor_acceleration"].sel(sensor="lid"), readings.acceleration[:, 0])
    assert run.body.points == ("lid", "edge", "tip") and run.body.acceleration is not None
    place = np.array([0.15, 0, 0])
    w, alpha, a = run.base.w_WB_B, run.base.alpha_WB_B, run.base.a_WO_B
    felt = a + np.cross(alpha, place) + np.cross(w, np.cross(w, place))
    np.testing.assert_allclose(run.body.acceleration[:, 1], felt, atol=1e-9 * np.abs(felt).max())


@pytest.mark.parametrize(
    ("before", "after", "place", "words"),
    [
        ("lid = 3", "lit = 3", "motion.machine.accept.control.lit", "did you mean 'lid'"),
        ("lid = 3", "lid = 0", "motion.machine.accept.control.lid", "zero"),
        ("{ lid = 3, edge = 1 }", "3", "motion.machine.accept.control", "table"),
        ('srs = "40 dB"', "damage = 2", "motion.machine.accept.damage", "is of a stress, and box is rigid"),
        ('srs = "40 dB"', 'tip = "5 %"', "motion.machine.accept.tip", "is of a displacement, and box is rigid"),
        ('srs = "40 dB"', 'damage_at = "lit"', "motion.machine.accept.damage_at", "did you mean 'lid'"),
        ('srs = "40 dB"', "damage_at = 2", "motion.machine.accept.damage_at", "text"),
        ('srs = "40 dB"', 'point = "lit"', "motion.machine.accept.point", "did you mean 'lid'"),
        ("[motion.machine]", "[sensors.lit]\n[motion.machine]", "sensors.lit", "did you mean 'lid'"),
        ("[motion.machine]", "[sensors]\nlid = 2\n[motion.machine]", "sensors.lid", "table"),
        ("[motion.machine]", '[sensors]\nlid.frequency = "2 s"\n[motion.machine]', "sensors.lid.frequency", "a freq"),
        ("[motion.machine]", "[sensors]\nlid.damping_ratio = 0\n[motion.machine]", "sensors.lid.damping_ratio", "zero"),
        ("[motion.machine]", "[sensors]\nlid.sensitivity = 1\n[motion.machine]", "sensors.lid.sensitivity", "list"),
    ],
)  # fmt: skip
def test_control_points_that_are_none_are_placed(folder: Path, before: str, after: str, place: str, words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        case_of(folder, BOX + TURN + MACHINE.replace(before, after) + RESPONSE)
    assert f"{place}: " in str(caught.value) and words in str(caught.value)
