"""Scenarios of one specimen that is no beam: a solid by its mesh, matrices of another program, a rigid box."""

from __future__ import annotations

import re
from pathlib import Path

import meshio
import numpy as np
import pytest
from scipy.io import mmwrite

import gbeam as gb
from gbeam.questions import QUESTIONS
from gbeam.report import html_of, viewer_data
from gbeam.scenario import ScenarioError
from tests.solids.bodies import block
from tests.solids.test_shells import sheet

pytestmark = pytest.mark.usefixtures("reading_in_process")

BODY = """
[bodies.arm]
mesh = "arm.inp"
unit = "m"
clamp = "wall"
modes = 4
damping_ratio = 0.02
material = { density = 7850.0, youngs_modulus = "210 GPa", poissons_ratio = 0.3, yield_strength = "250 MPa" }
"""
FLIGHT = """
[motion.turn]
kind = "flight"
acceleration = { z = { profile = "trapezoid", level = "8 g", jerk = "4 g/s", start = "0.5 s", hold = "1 s" } }

[response]
duration = "4 s"
step = "5 ms"
integrator = "gauss"
"""
JOINT = '[joints.foot]\nkind = "fixed"\nbody = "arm"\n'
RATE = 'rate = { profile = "constant", level = 5.0 }'
TORQUE = 'inertia = "2 kg m^2"\ntorque = { profile = "constant", level = 1.0 }'
BOX = """
[bodies.box]
kind = "rigid"
mass = "3 kg"
size = ["300 mm", "200 mm", "100 mm"]
centre = [0, 0, "50 mm"]
bolts = [[-0.1, -0.08, 0], [0.1, -0.08, 0], [-0.1, 0.08, 0], [0.1, 0.08, 0]]
bolt_axis = [0, 0, 1]
"""
SPIN = """
[motion.spin]
kind = "hub"
radius = "3.3 m"
rate = { profile = "constant", level = 5.0 }

[response]
duration = "1 s"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    meshio.write(tmp_path / "arm.inp", block("hexahedron20", (4, 1, 1), (0.2, 0.02, 0.01)))
    return tmp_path


def case_of(folder: Path, text: str) -> gb.Case:
    file = folder / "scenario.toml"
    file.write_text(text, encoding="utf-8")
    return gb.read_scenario(file)


def test_a_solid_alone_is_what_python_makes_of_it(folder: Path) -> None:
    case = case_of(folder, BODY + FLIGHT)
    assert case.system.order == ("arm",)
    steel = gb.Material(7850, 210e9, poissons_ratio=0.3, yield_strength=250e6)
    solid = gb.SolidMesh.read(folder / "arm.inp", materials=steel, clamp="wall", unit="m")
    model = solid.reduced(modes=4, damping_ratio=0.02)
    assert case.subject == model.structure
    response = gb.study(case).responses["turn"]
    assert response.solid is not None and response.loads is not None
    alone = model.stress(gb.simulate(model.structure, case.motions["turn"], case.response, name="turn"))
    assert response.solid.worst.von_mises == alone.worst.von_mises
    # Its page says, not folded away, what of its mesh is known.
    gb.study(case).report(folder / "page.html")
    page = re.sub("<details.*?</details>", "", (folder / "page.html").read_text(encoding="utf-8"), flags=re.DOTALL)
    assert '<p class="faint">Turn: the mesh is not judged</p>' in page and "file of bodies.arm.mesh" in page
    assert response.solid.worst.spread == 0 and "elements differ by" in page  # at a corner of one element
    assert response.solid.nearest_yield is not None and response.solid.nearest_yield.margin == pytest.approx(
        250e6 / response.solid.worst.von_mises - 1
    )
    # Held as slowly as this, it is what the base carries: mass times acceleration.
    middle = np.argmin(np.abs(response.time - 3.0))
    a = response.base.a_WO_B[middle]
    mass = case.subject.coefficients.rigid[0]
    assert response.loads.root_force[middle] == pytest.approx(mass * a, rel=1e-3, abs=1e-6)


def test_a_solid_at_rest_needs_neither_motion_nor_duration(folder: Path) -> None:
    case, moved = case_of(folder, BODY), case_of(folder, BODY + FLIGHT)
    frequency = QUESTIONS["modes"].answer(case).frequency
    np.testing.assert_allclose(frequency, gb.modes(moved.subject).frequency, rtol=1e-12)
    np.testing.assert_allclose(gb.linearize(case.subject).a, gb.linearize(moved.subject, moved.motions["turn"]).a)
    with pytest.raises(gb.InputError, match="motion is missing; add what the base does"):
        gb.study(case)


def test_a_solid_on_a_fixed_joint_moves_as_on_the_base(folder: Path) -> None:
    alone = gb.study(case_of(folder, BODY + FLIGHT)).responses["turn"]
    tree = case_of(folder, BODY + JOINT + FLIGHT)
    answer = gb.simulate(tree.system, tree.motions["turn"], tree.response)
    assert answer.outcome == "done"
    place = answer.place[:, answer.points.index("arm.tip")]
    moved = np.stack([np.interp(alone.time, answer.time, each) for each in (place - place[0]).T], axis=1)
    assert np.abs(moved - alone.tip).max() < 2e-3 * np.abs(alone.tip).max()


def test_a_box_alone_is_a_rigid_specimen(folder: Path) -> None:
    case = case_of(folder, BOX + SPIN)
    assert case.subject.size == 0
    answer = gb.study(case)
    loads = answer.responses["spin"].specimen
    bolts = [(x, y, 0.0) for x in (-0.1, 0.1) for y in (-0.08, 0.08)]
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0, 0, 0.05), bolts=bolts, bolt_axis=(0, 0, 1))
    same = box.loads(case.motions["spin"], duration=1.0, sample=0.1)
    assert loads is not None
    assert loads.force_max == pytest.approx(same.force_max, rel=1e-12)
    assert loads.bolt_tension.max() == pytest.approx(same.bolt_tension.max(), rel=1e-12)
    assert gb.describe(case).mass == pytest.approx(3.0)
    assert answer.state == "done"


def test_a_box_is_drawn_with_its_load(folder: Path) -> None:
    """Its corners, and the acceleration of its base at the time of the largest."""
    case = case_of(folder, BOX + SPIN)
    header, numbers = viewer_data(gb.study(case))
    (motion,) = header["scene"]["motions"]
    (part,) = motion["parts"]
    assert part["box"]["size"] == pytest.approx([0.3, 0.2, 0.1]) and part["box"]["centre"] == pytest.approx(
        [0, 0, 0.05]
    )
    load = numbers.array[motion["load"]["at"] :][: np.prod(motion["load"]["shape"])].reshape(-1, 3)
    largest = np.linalg.norm(gb.study(case).responses["spin"].base.a_WO_B, axis=1).max()
    assert motion["largestLoad"] == pytest.approx(largest) and len(load) == motion["time"]["shape"][0]
    assert np.linalg.norm(load, axis=1).max() == pytest.approx(largest, rel=1e-6)


@pytest.mark.parametrize(
    ("limit", "state", "word"), [("10 %", "PASS", "PASS"), ("5 %", "NOT ACCEPTED", "NOT ACCEPTED")]
)
def test_the_spread_is_held_against_the_orders_limit(folder: Path, limit: str, state: str, word: str) -> None:
    """Of a box whose corners are 150 and 100 mm from its centre, on an arm of 3.3 m: √(150² + 100²)/3300 = 5.46 %."""
    answer = gb.study(case_of(folder, BOX + f'spread_limit = "{limit}"\n' + SPIN))
    loads = answer.responses["spin"].specimen
    assert loads is not None and loads.spread_max == pytest.approx(np.hypot(0.15, 0.1) / 3.3, rel=1e-9)
    assert answer.state == state and f", {word} (limit {limit})" in str(answer)
    assert ("spin" in answer.refusals) == (state != "PASS")
    assert f'<span class="badge {"good" if word == "PASS" else "bad"}">{word}</span>' in html_of(answer)
    still = gb.study(case_of(folder, BOX + f'spread_limit = "{limit}"\n' + SPIN.replace("level = 5.0", "level = 0.0")))
    assert still.state == "done" and word not in str(still)  # nothing accelerates


def test_matrices_of_files_are_a_specimen(folder: Path) -> None:
    mmwrite(folder / "m.mtx", 2.0 * np.eye(6))
    mmwrite(folder / "k.mtx", np.diag([800.0, 5e3, 9e3] * 2))
    text = """
    [bodies.oscillator]
    matrices = ["m.mtx", "k.mtx"]
    mass_matrix = "m"
    stiffness_matrix = "k"
    nodes = "nodes.npy"
    modes = 2
    damping_ratio = 0.01
    """
    np.save(folder / "nodes.npy", np.array([[0.1, 0.0, 0.0], [0.2, 0.0, 0.0]]))
    case = case_of(folder, text + FLIGHT)
    assert case.subject.rest[0][0] == pytest.approx(20.0)


@pytest.mark.parametrize(
    ("before", "after", "place", "words"),
    [
        ('clamp = "wall"', 'clamp = "foot"', "bodies.arm.clamp", "no group of the mesh"),
        ('clamp = "wall"', "clamp = []", "bodies.arm.clamp", "moves without strain"),
        ('clamp = "wall"\n', "", "bodies.arm", "clamp is missing"),
        ('unit = "m"', 'unit = "furlong s"', "bodies.arm.unit", "unit"),
        ("arm.inp", "leg.inp", "bodies.arm.mesh", "no file"),
        ("modes = 4", "modes = 0", "bodies.arm.modes", "below 1"),
        ("modes = 4", "modes = 4\nmasses = { lens = 0.1 }", "bodies.arm.masses.lens", "no group"),
        ("modes = 4", "modes = 4\npoints = { lens = [1.0, 1.0, 1.0] }", "bodies.arm.points.lens", "nearest node"),
        ("modes = 4", "modes = 4\nscale = [1, 1, 0]", "bodies.arm.scale[2]", "zero"),
        (", poissons_ratio = 0.3", "", "bodies.arm.material.poissons_ratio", "missing"),
        ("material = {", "materials.a = {", "bodies.arm.materials.a", "no group"),
        ("modes = 4", 'modes = 4\nthickness = "2 mm"', "bodies.arm.thickness", "solid elements too"),
        ("modes = 4", 'modes = 4\nthicknesses.lid = "2 mm"', "bodies.arm.thicknesses.lid", "no group"),
        ("modes = 4", "modes = 4\nthickness = 1\nthicknesses.a = 1", "bodies.arm.thicknesses", "beside"),
        ('mesh = "arm.inp"', 'kind = "shell"\nmesh = "arm.inp"', "bodies.arm.kind", "unknown choice"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_with_its_place(folder: Path, before: str, after: str, place: str, words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        case_of(folder, BODY.replace(before, after) + FLIGHT)
    assert f"{place}: " in str(caught.value) and words in str(caught.value)


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (BOX.replace('size = ["300 mm", "200 mm", "100 mm"]\n', "") + SPIN, "bodies.box.size", "missing"),
        (BOX.replace('"300 mm"', '"-300 mm"') + SPIN, "bodies.box.size[0]", "positive"),
        (BOX + "middle = [0, 0, 0]\n" + SPIN, "bodies.box.inertia", "not even"),
        (BOX.replace("bolt_axis = [0, 0, 1]\n", "") + SPIN, "bodies.box.bolt_axis", "missing"),
        (BOX + SPIN.replace(RATE, TORQUE), "motion.spin", "turns freely"),
    ],
)  # fmt: skip
def test_a_box_that_cannot_be_is_named_with_its_place(folder: Path, text: str, place: str, words: str) -> None:
    with pytest.raises((ScenarioError, gb.InputError)) as caught:
        case_of(folder, text)
    assert f"{place}: " in str(caught.value) and words in str(caught.value)


def test_a_rigid_box_has_no_modes(folder: Path) -> None:
    from gbeam.questions import QUESTIONS, refuse_rigid

    case = case_of(folder, BOX + SPIN)
    with pytest.raises(gb.InputError, match="is rigid"):
        QUESTIONS["modes"].refuse(case)
    with pytest.raises(gb.InputError, match="is rigid, and linearize is of what deforms"):
        refuse_rigid(case, "linearize")
    QUESTIONS["run"].refuse(case)


def test_millimetres_read_as_metres_are_told_by_the_mass(folder: Path) -> None:
    mesh = meshio.read(folder / "arm.inp")
    mesh.points *= 1e3
    meshio.write(folder / "arm.inp", mesh)
    for motion in (FLIGHT, ""):
        warning = next(each for each in gb.describe(case_of(folder, BODY + motion)).warnings if "the mesh" in each)
        assert "is it mm?" in warning and "3.14e+08 kg" in warning


def test_a_result_is_computed_again_with_its_mesh(folder: Path) -> None:
    case = case_of(folder, BODY + FLIGHT.replace('duration = "4 s"', 'duration = "0.2 s"'))
    gb.study(case).save(folder / "result.nc")
    (folder / "arm.inp").unlink()
    assert gb.rerun(folder / "result.nc").reproduced


def test_thickness_and_material_are_swept(folder: Path) -> None:
    """A cantilever's frequency goes as its thickness and the root of its modulus."""
    case_of(folder, BODY + "scale = [1, 1, 1]\n" + FLIGHT)
    sweep = gb.sweep(
        folder / "scenario.toml",
        {"bodies.arm.scale[2]": [1.0, 1.1], "bodies.arm.material.youngs_modulus": ["210 GPa", "231 GPa"]},
        ["modes[0].frequency"], verb="modes",
    )  # fmt: skip
    values = next(iter(sweep.measures.values()))
    assert values[1, 0] / values[0, 0] == pytest.approx(1.1, rel=1e-2)
    assert values[0, 1] / values[0, 0] == pytest.approx(np.sqrt(1.1), rel=1e-6)


def test_a_board_of_shells_is_swept_over_its_thickness(folder: Path) -> None:
    """Half the thickness at half the frequency; with a second mesh the error of the first one is known."""
    for name, cells in (("arm.msh", (12, 2)), ("coarse.msh", (6, 1))):
        mesh = sheet("quad", cells, (0.2, 0.02))
        wall = np.isin(mesh.cells[0].data, mesh.point_sets.pop("wall")).any(axis=1)
        mesh.cell_data["gmsh:physical"] = [np.where(wall, 2, 1)]
        mesh.cell_data["gmsh:geometrical"] = [np.ones(len(wall), dtype=int)]
        mesh.field_data = {"free": np.array([1, 2]), "wall": np.array([2, 2])}
        meshio.write(folder / name, mesh, file_format="gmsh22", binary=False)
    text = BODY.replace("arm.inp", "arm.msh") + 'coarser = "coarse.msh"\nthickness = "2 mm"\n' + FLIGHT
    case = case_of(folder, text)
    study = gb.study(case)
    body = study.responses["turn"].body
    assert body.solid is not None and body.surface is not None
    sweep = gb.sweep(
        folder / "scenario.toml", {"bodies.arm.thickness": ["1 mm", "2 mm"]}, ["modes[0].frequency"], verb="modes"
    )
    (values,) = sweep.measures.values()
    assert values[1] / values[0] == pytest.approx(2.0, rel=5e-3)
