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

from typing import Any, Literal

from pydantic import Field

from gbeam.scenario.bodies.common import BodyKind
from gbeam.scenario.schema.fields import Length, Mass, Table


class Dumbbell(Table):
    """Two equal masses on a light rod, the root in its middle."""

    kind: Literal["dumbbell"] = Field(description="kind of the body")
    mass: Mass = Field(description="mass of each")
    span: Length = Field(description="distance of the masses, along y")


def _body(parts: Any, where: str, table: Dumbbell) -> Any:
    from gbeam.mechanics.tree.system import RigidBody

    about = table.mass * table.span**2 / 2
    return parts.attempt(where, RigidBody, 2 * table.mass, (about, 0.0, about))


BODY = BodyKind(Dumbbell, _body)
'''
PLANAR = """

KINDS["planar"] = Kind(
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
    assert any(re.search(r"table\.v \S+ m\b.*table\.angle \S+ rad", line) for line in response["lines"])


def test_their_keys_are_in_the_schema_and_their_units_are_asked_for(widened: Path) -> None:
    page = run(widened, "schema", "--markdown").stdout
    assert '[bodies.NAME], kind = "dumbbell"' in page and '[joints.NAME], kind = "planar"' in page
    assert "distance of the masses, along y" in page
    (widened / "wrong.toml").write_text(
        SCENARIO.replace("1 N/mm", "1 N m/rad").replace("300 mm", "3 kg"), encoding="utf-8"
    )
    refused = run(widened, "check", "wrong.toml")
    assert refused.returncode == 2
    assert "bodies.bell.span" in refused.stderr and "joints.table.stiffness.u" in refused.stderr
