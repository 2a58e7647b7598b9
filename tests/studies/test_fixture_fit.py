"""A fixture's 6 × 6 stiffness fitted to the frequencies of a tap test, which its matrices have."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.linalg import eigh

import gbeam as gb
from gbeam.solids import mass_matrix, stiffness_matrix
from gbeam.studies import changed, physical_values, template_of

from ..solids.bodies import block

pytestmark = pytest.mark.usefixtures("reading_in_process")

SCENARIO = """
[bodies.dummy]
kind = "rigid"
mass = "6 kg"
size = ["200 mm", "160 mm", "150 mm"]
centre = [0, 0, "75 mm"]

[joints.fixture]
kind = "fixed"
body = "dummy"
stiffness = { x = 1e7, y = 1e7, z = 5e7, rx = 4e4, ry = 4e4, rz = 1e5 }
coupling = { x-ry = -1e5 }

[response]
duration = "1 s"
"""


def test_a_tap_test_gives_the_springs_and_their_coupling(tmp_path: Path) -> None:
    """From five frequencies of the matrices: the scenario's values lead 12 % astray, other starts do not."""
    stiffness = np.diag([1e7, 1e7, 5e7, 2.5e4, 1.6e4, 1e5])
    stiffness[0, 4] = stiffness[4, 0] = -1.5e5
    edges = np.square([0.2, 0.16, 0.15])
    mass = np.diag([6.0, 6, 6, *(6 / 12 * (edges.sum() - edges))])
    move = np.eye(6)
    move[:3, 3:] = [[0, 0.075, 0], [-0.075, 0, 0], [0, 0, 0]]  # the centre of mass over the root: θ × r
    frequency = np.sqrt(eigh(stiffness, move.T @ mass @ move, eigvals_only=True)) / (2 * np.pi)
    (tmp_path / "fixture.toml").write_text(SCENARIO, encoding="utf-8")
    taps = np.column_stack([np.arange(1, 6), frequency[:5]])
    np.savetxt(tmp_path / "taps.csv", taps, delimiter=",", header="mode,frequency", comments="")
    free = ["joints.fixture.stiffness.ry", "joints.fixture.stiffness.rx", "joints.fixture.coupling.x-ry"]
    answer = gb.fit(tmp_path / "fixture.toml", tmp_path / "taps.csv", free, starts=6)
    assert answer.values == pytest.approx([1.6e4, 2.5e4, -1.5e5], rel=1e-5)
    assert list(answer.units) == ["N m/rad", "N m/rad", "N"]
    with pytest.raises(gb.InputError, match=r"joints\.fixture\.coupling\.x-rz"):
        gb.fit(tmp_path / "fixture.toml", tmp_path / "taps.csv", ["joints.fixture.coupling.x-rz"])


MESHED = """
[bodies.fixture]
mesh = "plate.inp"
unit = "m"
clamp = []
modes = 8
damping_ratio = "2 %"
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.3 }
interfaces = { pad = "top" }
links = { left = "left", right = "right", seat = "top" }

[bodies.fixture.springs.left]
between = ["left"]
stiffness = { x = 4e6, y = 4e6, z = 6e6, rx = 500 }

[bodies.fixture.springs.right]
between = ["right"]
stiffness = { x = 4e6, y = 4e6, z = 6e6, rx = 500 }

[bodies.dummy]
kind = "rigid"
mass = "0.2 kg"
inertia = [2e-5, 2e-5, 2e-5]
centre = [0, 0, "10 mm"]

[joints]
base = { kind = "fixed", body = "fixture" }
screws = { kind = "fixed", body = "dummy", on = "fixture.pad" }

[response]
duration = "1 s"
"""
SIZE = (0.06, 0.03, 0.004)
GROUPS = {
    "left": lambda x: x[:, 0] == 0,
    "right": lambda x: x[:, 0] == SIZE[0],
    "top": lambda x: (x[:, 2] == SIZE[2] / 2) & (np.abs(x[:, 0] - SIZE[0] / 2) < 0.011),
}


def taps_of_the_whole_mesh(mesh: Any, modulus: float, spring: float) -> Any:
    """Frequencies of all unknowns of the plate, whose ends and seat are rigid, with springs and dummy by hand."""
    metal = gb.Material(2700, modulus, poissons_ratio=0.3)
    solid = gb.SolidMesh.read(mesh, materials=metal, clamp="left", unit="m")
    points, blocks = solid.points, solid.blocks
    stiffness, mass = (
        stiffness_matrix(points, blocks).toarray(),
        np.kron(mass_matrix(points, blocks).toarray(), np.eye(3)),
    )
    groups = [np.flatnonzero(np.isin(solid.numbers, mesh.point_sets[name] + 1)) for name in GROUPS]
    rigid = np.zeros((3 * len(points), 18))
    for k, nodes in enumerate(groups):
        for node in nodes:
            x, y, z = points[node] - points[nodes].mean(axis=0)
            rigid[3 * node : 3 * node + 3, 6 * k : 6 * k + 3] = np.eye(3)
            rigid[3 * node : 3 * node + 3, 6 * k + 3 : 6 * k + 6] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]  # θ × r
    free = np.setdiff1d(np.arange(3 * len(points)), (3 * np.concatenate(groups)[:, None] + range(3)).ravel())
    moved = np.hstack([rigid, np.eye(3 * len(points))[:, free]])
    stiffness, mass = moved.T @ stiffness @ moved, moved.T @ mass @ moved
    for k in (0, 6):
        stiffness[k : k + 6, k : k + 6] += np.diag([4e6, 4e6, spring, 500, 0, 0])
    arm = np.eye(6)
    arm[:3, 3:] = [[0, 0.01, 0], [-0.01, 0, 0], [0, 0, 0]]
    mass[12:18, 12:18] += arm.T @ np.diag([0.2, 0.2, 0.2, 2e-5, 2e-5, 2e-5]) @ arm
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True)[:6]) / (2 * np.pi)


def test_a_tap_test_gives_a_meshed_fixtures_modulus_and_the_springs_of_its_feet(tmp_path: Path) -> None:
    """Both feet by one value: from the frequencies of all unknowns, of which eight modes have the lowest to 1e-4."""
    mesh = block("hexahedron20", (3, 2, 1), SIZE, groups=GROUPS)
    meshio.write(tmp_path / "plate.inp", mesh)
    (tmp_path / "fixture.toml").write_text(MESHED, encoding="utf-8")
    taps = np.column_stack([np.arange(1, 7), taps_of_the_whole_mesh(mesh, 62e9, 5e6)])
    np.savetxt(tmp_path / "taps.csv", taps, delimiter=",", header="mode,frequency", comments="")
    free = ["bodies.fixture.material.youngs_modulus", "bodies.fixture.springs.*.stiffness.z"]
    answer = gb.fit(tmp_path / "fixture.toml", tmp_path / "taps.csv", free)
    assert answer.values == pytest.approx([62e9, 5e6], rel=1e-4)


def test_a_pattern_names_values_that_are_alike_once(tmp_path: Path) -> None:
    """And each is refused that fits no value, values that differ, or one that is named already."""
    (tmp_path / "plate.inp").touch()
    (tmp_path / "fixture.toml").write_text(MESHED, encoding="utf-8")
    template, both = template_of(tmp_path / "fixture.toml"), "bodies.fixture.springs.*.stiffness.z"
    (value,) = physical_values(template, [both])
    sides = [f"bodies.fixture.springs.{side}.stiffness.z" for side in ("left", "right")]
    assert changed([value], [5e6]) == dict.fromkeys(sides, 5e6)
    wrong = {
        ("bodies.*.springs.*.stiffness.rw",): "is no physical value",
        ("bodies.*.springs.left.stiffness.*",): r"values that differ, .*left\.stiffness\.x = 4e\+06 N/m and .*\.z = 6e",
        (both, sides[0]): r"names bodies\.fixture\.springs\.left\.stiffness\.z twice",
    }
    for names, problem in wrong.items():
        with pytest.raises(gb.InputError, match=problem):
            physical_values(template, names)
