"""A new kind of body, or of joint, is one file: its table, its words and its units follow."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SOURCE = Path(__file__).parents[2] / "src"
DUMBBELL = '''
"""Two equal masses on a light rod."""

from __future__ import annotations

from typing import Annotated

from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Length, Mass
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.scenario.bodies.common import BodyKind
from gbeam.scenario.schema.declared import table_of


@typed
def dumbbell(
    mass: Annotated[Mass, "mass of each"], span: Annotated[Length, "distance of the masses, along y"]
) -> RigidBody:
    """Two equal masses on a light rod, the root in its middle."""
    about = mass * span**2 / 2
    return RigidBody(2 * mass, (about, 0.0, about))


BODY = BodyKind(table_of(dumbbell, name="Dumbbell", tag=("kind", "dumbbell")))
'''
WIDER = ('along y"]\n', 'along y"],\n    tilt: Annotated[Angle, "turn of the rod about x"] = 0.0,\n')
PLANAR = """

JOINT_KINDS["planar"] = Kind(
    "slides in a plane, and a turn about its normal",
    lambda axes: (Slide(np.linalg.svd(axes)[2][1:].T), *_turns(axes)),
    ("u", "v", "angle"),
    1,
)
SLIDES = (*SLIDES, "u", "v")
"""
SCENARIO = """
[bodies.bell]
kind = "dumbbell"
mass = "2 kg"
span = "300 mm"

[joints.table]
kind = "planar"
body = "bell"
axes = [[0, 0, 1]]
stiffness = { u = "1 N/mm", v = "4 N/mm", angle = "0.5 N m/deg" }
"""


@pytest.fixture(scope="module")
def widened(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package with one file more, and one of its files longer."""
    folder = tmp_path_factory.mktemp("source")
    shutil.copytree(SOURCE / "gbeam", folder / "gbeam")
    (folder / "gbeam/scenario/bodies/dumbbell.py").write_text(DUMBBELL, encoding="utf-8")
    with (folder / "gbeam/mechanics/tree/joints.py").open("a", encoding="utf-8") as file:
        file.write(PLANAR)
    return folder


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    path = {"PYTHONPATH": str(folder), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "gbeam", *arguments]
    return subprocess.run(command, env=path, cwd=folder, capture_output=True, text=True, timeout=300, check=False)


def test_a_toy_body_on_a_toy_joint_answers(widened: Path) -> None:
    (widened / "toy.toml").write_text(SCENARIO, encoding="utf-8")
    done = run(widened, "modes", "toy.toml", "--json")
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    of = next(each for each in answer.values() if isinstance(each, list) and each and "frequency" in each[0])
    about = 2.0 * 0.3**2 / 2
    expected = np.sqrt([1e3 / 4, 4e3 / 4, 0.5 * 180 / np.pi / about]) / (2 * np.pi)
    np.testing.assert_allclose(sorted(each["frequency"] for each in of), np.sort(expected), rtol=1e-6)


def test_a_run_says_the_units_of_its_coordinates(widened: Path) -> None:
    drives = 'effort = { v = "2 N", angle = "0.1 N m" }\n[response]\nduration = "20 ms"\nstep = "1 ms"\n'
    (widened / "run.toml").write_text(SCENARIO + drives, encoding="utf-8")
    done = run(widened, "run", "run.toml", "--json", "--out", "out")
    assert done.returncode == 0, done.stderr
    (response,) = json.loads(done.stdout)["motions"].values()
    assert {name: each["unit"] for name, each in response["coordinates"].items()} == {
        "table.u": "m", "table.v": "m", "table.angle": "rad"
    }  # fmt: skip
    assert any(re.search(r"table\.v \S+ m\b.*table\.angle \S+ deg", line) for line in response["lines"])


def test_their_keys_are_in_the_schema_and_their_units_are_asked_for(widened: Path) -> None:
    (widened / "wrong.toml").write_text(
        SCENARIO.replace("1 N/mm", "1 N m/rad").replace("300 mm", "3 kg"), encoding="utf-8"
    )
    (_, page, _), (status, _, refused) = called(widened, ["schema", "--markdown"], ["check", "wrong.toml"])
    assert '[bodies.NAME], kind = "dumbbell"' in page and '[joints.NAME], kind = "planar"' in page
    assert "distance of the masses, along y" in page
    assert status == 2
    assert "bodies.bell.span" in refused and "joints.table.stiffness.u" in refused


def test_a_parameter_is_declared_in_one_place(widened: Path, tmp_path: Path) -> None:
    """Added to the signature it is a key of the file, of --set, the form and the reference, and in the docstring."""
    copy = tmp_path / "source"
    shutil.copytree(widened, copy)
    file = copy / "gbeam/scenario/bodies/dumbbell.py"
    declared = file.read_text(encoding="utf-8").replace(*WIDER).replace("import Length", "import Angle, Length")
    file.write_text(declared, encoding="utf-8")
    (copy / "toy.toml").write_text(SCENARIO.replace('span = "300 mm"', 'span = "300 mm"\ntilt = "5 deg"'), "utf-8")
    plain, refused, turned, reference, form, words = called(
        copy,
        ["modes", "toy.toml"],
        ["modes", "toy.toml", "--set", "bodies.bell.tilt=5 mm"],
        ["modes", "toy.toml", "--set", "bodies.bell.tilt=6 deg"],
        ["schema", "--markdown"],
        FORM,
        WORDS,
    )
    assert plain[0] == turned[0] == 0
    assert refused[0] == 2 and '"5 mm" is a length = expected an angle' in " ".join(refused[2].split())
    assert "| `tilt` | angle in rad | `0.0` | turn of the rod about x |" in reference[1]
    assert "turn of the rod about x" in form[1]
    assert "tilt : float, rad, optional\n    Turn of the rod about x." in words[1]


FORM = """
from pathlib import Path
from tomllib import loads
from gbeam.app.form import form
print(form(loads(Path("toy.toml").read_text())))
"""
WORDS = """
from gbeam.scenario.bodies.dumbbell import dumbbell
print(dumbbell.__doc__)
"""
# One process that calls the command line with lists of words, and runs programs, one after the other.
CALLS = """
import io, json, sys, contextlib
from gbeam.cli import main
answers = []
for task in json.loads(sys.argv[1]):
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        status = exec(task, {}) if isinstance(task, str) else main(task)
    answers.append([status, out.getvalue(), err.getvalue()])
print(json.dumps(answers))
"""


def called(folder: Path, *tasks: list[str] | str) -> list[tuple[int, str, str]]:
    """Status, output and errors of commands, and of programs, with the package in a folder."""
    path = {"PYTHONPATH": str(folder), "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", CALLS, json.dumps(tasks)]
    done = subprocess.run(command, env=path, cwd=folder, capture_output=True, encoding="utf-8", check=True)
    return [tuple(answer) for answer in json.loads(done.stdout)]
