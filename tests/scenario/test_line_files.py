"""A beam's line by the rows of a file: places, units, twist, and what is wrong with it at its place in the scenario."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.cli import main
from gbeam.scenario import ScenarioError

SCENARIO = """
title = "a swept wing"
[beam]
section = { shape = "rectangle", width = "30 mm", thickness = "20 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.33 }
damping_ratio = "1 %"
line = LINE
[model]
kind = "FOAM"
modes = { axial = 0, y = 2, z = 2 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "2 g" } }
[response]
duration = "20 ms"
"""
FILE = '{ points = "line.csv" }'


@pytest.fixture
def line(tmp_path: Path) -> Any:
    def read(content: str | bytes, written: str = FILE) -> gb.Line:
        (tmp_path / "line.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
        (tmp_path / "wing.toml").write_text(SCENARIO.replace("LINE", written), encoding="utf-8")
        of = gb.read_scenario(tmp_path / "wing.toml").beam.line
        assert of is not None
        return of

    return read


POINTS = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.2, 0.03, 0.01]]


@pytest.mark.parametrize(
    ("content", "written"),
    [
        ("x [mm],y [mm],z [mm]\n0,0,0\n100,0,0\n200,30,10\n", FILE),
        ("# from CAD\nx;y;z\nm;m;m\n0;0;0\n0,1;0;0\n0,2;0,03;0,01\n", FILE),
        ("x_cm y_cm z_m\n0 0 0\n10 0 0\n20 3 0.01\n", FILE),
        ("x\ty\tz\n0\t0\t0\n100\t0\t0\n200\t30\t10\n", '{ points = "line.csv", length_unit = "mm" }'),
    ],
)
def test_rows_are_points(line: Any, content: str, written: str) -> None:
    for smooth in (True, False):
        of, expected = (
            line(content, written.replace(" }", f", smooth = {str(smooth).lower()} }}")),
            gb.Line.of_points(POINTS, smooth=smooth),
        )
        x = np.linspace(0.0, expected.length, 4)
        assert of.length == pytest.approx(expected.length, rel=1e-12)
        np.testing.assert_allclose(of.places(x)[0], expected.places(x)[0], atol=1e-12)


def test_columns_that_are_left_out_are_zero_and_twist_turns_the_sections(line: Any) -> None:
    twisted = line("x [mm],twist [deg]\n0,5\n100,15\n200,35\n")
    place, axes = twisted.places([0.05, 0.15])
    np.testing.assert_allclose(place, [[0.05, 0, 0], [0.15, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(Rotation.from_matrix(axes).as_rotvec(degrees=True), [[10, 0, 0], [25, 0, 0]], atol=1e-7)
    beside = line("x [mm]\ty [mm]\n0\t0\n100\t0\n", '{ points = "line.csv", twist = ["0 deg", "8 deg"] }')
    assert np.degrees(beside.places([0.1])[1][0, 2, 1]) == pytest.approx(np.degrees(np.sin(np.radians(8))))


GOOD = "x [mm],y [mm]\n0,0\n100,0\n200,30\n"


@pytest.mark.parametrize(
    ("content", "written", "message"),
    [
        ("x,y\n0,0\n100,0\n", FILE, "does not say the unit of x.*length_unit"),
        (
            "x [m],y [mm]\n0,0\n100,0\n",
            '{ points = "line.csv", length_unit = "mm" }',
            "has x in m, and length_unit is mm",
        ),
        ("x [mm],y [kg]\n0,0\n100,0\n", FILE, "has y in kg"),
        ("x [mm],twist\n0,0\n100,1\n", FILE, "does not say the unit of twist"),
        ("x [mm],y [mm],chord [mm]\n0,0,1\n100,0,2\n", FILE, "has a column 'chord .mm.'.*x .mm., y"),
        ("x [mm],y [mm],x [cm]\n0,0,1\n100,0,2\n", FILE, "has a column 'x .cm.' a second time"),
        ("y [mm],z [mm]\n0,0\n100,0\n", FILE, "has no column x"),
        ("x [mm],y [mm]\n0,0\n100,abc\n", FILE, "row 3, column 'y .mm.' is 'abc'"),
        ("x [mm],y [mm]\n0,0\n100\n200,30\n300,30\n400,30\n", FILE, "row 3 has 1 cells"),
        ("x [mm],y [mm]\n0,0\n", FILE, r"has 1 row\(s\)"),
        ("x [mm],y [mm]\n0,0\n100,0\n100,0\n", FILE, "row 4 is where row 3 is"),
        ("x [mm],y [mm]\n0,0\n100,0\n50,0\n", FILE, "row 4 turns the line back onto itself"),
        ("x [mm],twist [deg]\n0,0\n100,9\n50,9\n", FILE, "row 4 turns the line back onto itself"),
        ("x [mm],y [mm]\n5,0\n100,0\n", FILE, r"row 2 is \[0.005, 0.0, 0.0\] m"),
        ("x [mm],y [mm]\n" + "".join(f"{i},0\n" for i in range(1001)), FILE, "has 1001"),
        (b"\x89PNG\r\n\x1a\n\0\0\0", FILE, "is not CSV text"),
        ("", FILE, "is empty"),
        (GOOD, '{ points = "line.csv", twist = ["1 deg"] }', "has 3 rows, and twist 1 values"),
        (
            "x [mm],twist [deg]\n0,0\n100,9\n",
            '{ points = "line.csv", twist = ["1 deg", "2 deg"] }',
            "twist is given too",
        ),
        (GOOD, '{ points = "lime.csv" }', "there is no file lime.csv.*line.csv"),
        (GOOD, '{ points = [[0, 0, 0], ["1 m", 0, 0]], length_unit = "mm" }', "length_unit: is given without a file"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_at_its_place(line: Any, content: Any, written: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=rf"(?s)wing.toml:7:\d+: beam.line.*{message}"):
        line(content, written)


def test_a_run_keeps_the_file_and_computes_it_again(line: Any, tmp_path: Path) -> None:
    line(GOOD)
    scenario, out = tmp_path / "wing.toml", tmp_path / "out"
    assert main(["run", str(scenario), "--out", str(out)]) == 0
    (tmp_path / "line.csv").unlink()
    assert main(["rerun", str(out / "result.nc")]) == 0
