"""A fixture's 6 × 6 stiffness fitted to the frequencies of a tap test, which its matrices have."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

import gbeam as gb

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
