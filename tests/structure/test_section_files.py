"""Sections in files of VABS and BECAS, as these write them, and drawn ones by sectionproperties."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gbeam as gb

STEEL = gb.Material(7850.0, 210e9, poissons_ratio=0.3)
INCH, POUND = 0.0254, 0.45359237


def matrices(centre: tuple[float, float] = (0.004, -0.003)) -> tuple[np.ndarray, np.ndarray]:
    """Matrices of a 30 × 20 mm rectangle of steel whose centre lies beside the axis."""
    beam = gb.Beam(1.0, gb.Section.rectangle(0.03, 0.02), STEEL)
    about = beam.section.at(0.0)
    line, jy, jz = (7850.0 * float(each) for each in (about.area, about.inertia_y, about.inertia_z))
    y, z = centre
    moved = np.eye(6)
    moved[:3, 3:] = [[0, z, -y], [-z, 0, 0], [y, 0, 0]]
    stiffness = np.diag([float(each) for each in beam.stiffnesses(0.0)])
    return moved.T @ stiffness @ moved, moved.T @ np.diag([line, line, line, jy + jz, jy, jz]) @ moved


def _table(matrix: np.ndarray, form: str) -> str:
    return "\n".join(" ".join(form % value for value in row) for row in matrix)


def vabs(path: Path, stiffness: np.ndarray, mass: np.ndarray) -> Path:
    """Write a file of VABS, other matrices before and after those that count."""
    rule = " " + "=" * 56
    parts = [
        ("The 6X6 Mass Matrix", mass),
        ("The 6X6 Mass Matrix at the Mass Center", np.diag(np.diag(mass))),
        (
            "Classical Stiffness Matrix (1-extension; 2-twist; 3,4-bending)",
            stiffness[np.ix_([0, 3, 4, 5], [0, 3, 4, 5])],
        ),
        ("Timoshenko Stiffness Matrix (1-extension; 2,3-shear, 4-twist; 5,6-bending)", stiffness),
        ("Timoshenko Compliance Matrix (1-extension; 2,3-shear, 4-twist; 5,6-bending)", np.linalg.inv(stiffness)),
    ]
    text = "\n\n".join(f" {title}\n{rule}\n\n{_table(matrix, '%20.10E')}" for title, matrix in parts)
    path.write_text(
        f"{text}\n\n The Area of the Cross Section\n{rule}\n\n Area =     6.0000000000E-04\n", encoding="utf-8"
    )
    return path


def becas(path: Path, stiffness: np.ndarray, mass: np.ndarray) -> Path:
    """Write a file of BECAS, whose rows are shears, stretch, curvatures and twist."""
    order = [1, 2, 0, 4, 5, 3]
    parts = [("Stiffness", "K", stiffness), ("Compliance", "F", np.linalg.inv(stiffness)), ("Mass", "M", mass)]
    texts = [
        f"{title} matrix w.r.t. to the cross section reference point \n{name}=\n"
        + _table(matrix[np.ix_(order, order)], "%19.12g\t")
        for title, name, matrix in parts
    ]
    path.write_text("\n\n".join(["* BECAS 2.3 *", *texts, "Shear center;\nShearX= 0.004 \n"]), encoding="utf-8")
    return path


@pytest.mark.parametrize("write", [vabs, becas])
def test_files_hold_the_matrices(tmp_path: Path, write: object) -> None:
    stiffness, mass = matrices()
    section = gb.Section.read(write(tmp_path / "box", stiffness, mass))  # type: ignore[operator]
    for one, other in zip(section.matrices(0.0), (stiffness, mass), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12 * np.abs(other).max())


def test_units_of_the_program_and_several_stations(tmp_path: Path) -> None:
    stiffness, mass = matrices()
    turned = np.outer(*[np.repeat([1.0, INCH], 3)] * 2)
    files = [
        vabs(tmp_path / f"{k}.K", size * stiffness / turned / POUND / INCH, mass / turned / POUND * INCH)
        for k, size in enumerate((1.0, 3.0))
    ]
    section = gb.Section.read(*files, stations=[0.0, 2.0], length_unit="in", mass_unit="lb")
    np.testing.assert_allclose(section.matrices(1.0)[0], 2 * stiffness, rtol=1e-8, atol=1e-12 * stiffness.max())
    np.testing.assert_allclose(section.matrices(1.0)[1], mass, rtol=1e-8, atol=1e-12)


def test_what_is_no_such_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("nothing")
    with pytest.raises(gb.InputError, match=r"has no matrices of a section.*the .K of VABS"):
        gb.Section.read(tmp_path / "text")
    whole = vabs(tmp_path / "whole", *matrices()).read_text()
    (tmp_path / "classical").write_text(whole.replace("Timoshenko Stiffness", "Other"))
    with pytest.raises(gb.InputError, match=r"of VABS has no stiffness matrix of six rows.*ask VABS for Timoshenko"):
        gb.Section.read(tmp_path / "classical")
    with pytest.raises(gb.InputError, match=r"length_unit is 'kg'"):
        gb.Section.read(tmp_path / "whole", length_unit="kg")


SCENARIO = """
[bodies.bar]
kind = "beam"
length = "1 m"
damping_ratio = 0.01
{section}
model = {{ kind = "exact", modes = {{ axial = 1, y = 3, z = 3, twist = 2, shear_y = 1, shear_z = 1 }} }}
[joints.root]
kind = "fixed"
body = "bar"
[response]
duration = "1 s"
"""


def test_a_scenario_names_the_file(tmp_path: Path) -> None:
    becas(tmp_path / "box.out", *matrices())
    text = SCENARIO.format(section='section = { shape = "matrices", file = "box.out" }')
    (tmp_path / "bar.toml").write_text(text)
    bar = gb.read_scenario(tmp_path / "bar.toml").system.bodies["bar"]  # type: ignore[union-attr]
    np.testing.assert_allclose(bar.source.beam.section.matrices(0.0)[0], matrices()[0], rtol=1e-9, atol=1e-3)  # type: ignore[union-attr]
    (tmp_path / "bar.toml").write_text(text.replace('file = "box.out"', 'file = "box.out", mass = 1'))
    with pytest.raises(gb.InputError):
        gb.read_scenario(tmp_path / "bar.toml")
    (tmp_path / "bar.toml").write_text(text.replace(', file = "box.out"', ', length_unit = "mm"'))
    with pytest.raises(gb.InputError, match="stiffness is missing"):
        gb.read_scenario(tmp_path / "bar.toml")


def rectangle(width: float, thickness: float) -> list[tuple[float, float]]:
    return [(a * width / 2, b * thickness / 2) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def test_a_drawn_rectangle_is_the_rectangle() -> None:
    pytest.importorskip("sectionproperties")
    drawn = gb.Section.drawn(rectangle(0.03, 0.02), STEEL)
    expected = gb.Beam(1.0, gb.Section.rectangle(0.03, 0.02), STEEL).stiffnesses(0.0)
    # Shear by Pilkey's coefficients, not by Cowper's, which are for even curvature.
    off = np.diag(drawn.matrices(0.0)[0]) / expected - 1
    assert (np.abs(off) < [1e-9, 0.05, 0.05, 1e-4, 1e-9, 1e-9]).all()
    assert np.abs(drawn.matrices(0.0)[0] - np.diag(np.diag(drawn.matrices(0.0)[0]))).max() < 10


def test_a_drawn_channel_has_its_shear_centre_outside() -> None:
    pytest.importorskip("sectionproperties")
    height, width, wall = 0.1, 0.05, 0.002
    corners = [(0, 0), (width, 0), (width, wall), (wall, wall), (wall, height - wall), (width, height - wall)]
    stiffness, mass = gb.Section.drawn(
        [*corners, (width, height), (0, height)], STEEL, axis=(0.0, height / 2)
    ).matrices(0.0)
    b, h = width - wall / 2, height - wall
    outside = 3 * b**2 / (h + 6 * b) - wall / 2  # thin walls (Timoshenko, Strength of Materials)
    flexible = np.linalg.inv(stiffness)
    assert stiffness[2, 3] / stiffness[2, 2] == pytest.approx(-outside, rel=0.02)
    assert 1 / flexible[3, 3] == pytest.approx(STEEL.rigidity * (2 * b + h) * wall**3 / 3, rel=0.03)
    assert mass[2, 3] / mass[0, 0] == pytest.approx(stiffness[0, 5] / -stiffness[0, 0])  # axes of mass and of tension


def test_a_drawing_is_looked_at() -> None:
    pytest.importorskip("sectionproperties")
    with pytest.raises(gb.InputError, match=r"outline.*crosses itself"):
        gb.Section.drawn([(0, 0), (1, 1), (1, 0), (0, 1)], STEEL)
    with pytest.raises(gb.InputError, match=r"outline.*three corners"):
        gb.Section.drawn([(0, 0), (1, 1)], STEEL)


def test_a_drawn_tube_in_a_scenario(tmp_path: Path) -> None:
    pytest.importorskip("sectionproperties")
    section = (
        'section = { shape = "drawn", '
        'outline = [["-15 mm","-10 mm"],["15 mm","-10 mm"],["15 mm","10 mm"],["-15 mm","10 mm"]], '
        'holes = [[["-13 mm","-8 mm"],["13 mm","-8 mm"],["13 mm","8 mm"],["-13 mm","8 mm"]]] }\n'
        'material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poissons_ratio = 0.3 }'
    )
    (tmp_path / "bar.toml").write_text(SCENARIO.format(section=section))
    system = gb.read_scenario(tmp_path / "bar.toml").system  # type: ignore[union-attr]
    about_y = (0.03 * 0.02**3 - 0.026 * 0.016**3) / 12
    area = 0.03 * 0.02 - 0.026 * 0.016
    first = 1.8751**2 / (2 * np.pi) * np.sqrt(210e9 * about_y / (7850 * area))
    assert gb.modes(system).frequency[0] == pytest.approx(first, rel=3e-3)
