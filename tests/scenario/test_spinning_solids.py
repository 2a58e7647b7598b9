"""Campbell diagrams and critical speeds of a solid from its scenario, beside those of the beam that it is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb
from gbeam.cli import main
from tests.solids.bodies import block

pytestmark = pytest.mark.usefixtures("reading_in_process")

SCENARIO = """
[bodies.arm]
mesh = "arm.inp"
unit = "m"
clamp = "wall"
modes = 6
damping_ratio = 0.0
material = { density = 2700.0, youngs_modulus = "70 GPa", poissons_ratio = 0.0 }

[motion.spin]
kind = "hub"
radius = "1 m"
rate = { profile = "constant", level = 20.0 }
setting_angle = "90 deg"
pointing = "outward"

[response]
duration = "1 s"
"""


def answer(folder: Path, capsys: pytest.CaptureFixture[str], *command: str, pointing: str = "outward") -> Any:
    meshio.write(folder / "arm.inp", block("hexahedron20", (12, 1, 1), (0.3, 0.02, 0.004)))
    (folder / "arm.toml").write_text(SCENARIO.replace('"outward"', f'"{pointing}"'), encoding="utf-8")
    assert main([command[0], str(folder / "arm.toml"), *command[1:], "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def beam() -> gb.Structure:
    metal = gb.Material(2700, 70e9, poissons_ratio=0.0)
    whole = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), metal, damping_ratio=0.0)
    return gb.assemble(whole, "FOAM", axial=2, y=3, z=4)


def test_a_solid_has_the_campbell_diagram_of_its_beam(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    facts = answer(tmp_path, capsys, "campbell", "--to", "60 rad/s", "--modes", "2", "--report", "--out", str(tmp_path))
    hub = gb.Hub(radius=1.0, rate=gb.constant(20.0), setting_angle=np.pi / 2)
    same = gb.campbell(beam(), hub, end=60.0, modes=2)
    result = np.array([each["frequency"] for each in facts["tracks"]])
    np.testing.assert_allclose(result, same.frequency.T, rtol=3e-3)
    assert result[0, -1] > 1.1 * result[0, 0]
    assert "arm" in (tmp_path / "campbell.html").read_text(encoding="utf-8")


def test_a_solid_that_points_inward_buckles_as_its_beam(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    facts = answer(tmp_path, capsys, "critical-speed", pointing="inward")
    hub = gb.Hub(radius=1.0, rate=gb.constant(20.0), setting_angle=np.pi / 2, pointing="inward")
    same = gb.critical_speed(beam(), hub)
    assert facts["critical_speed"] == pytest.approx(same.value, rel=5e-3)
