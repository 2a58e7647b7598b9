"""Sections by stiffness and mass matrices: what they have in common with those by dimensions, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.results import Base

ALUMINIUM = gb.Material(2700.0, 70e9, poissons_ratio=0.33)
SECTION = gb.Section.rectangle(0.03, 0.02)
LENGTH = 0.5
PLAIN = gb.Beam(LENGTH, SECTION, ALUMINIUM, rotary_inertia=True)
SHAPES = {"axial": 5, "y": 5, "z": 5, "twist": 5, "shear_y": 5, "shear_z": 5}


def matrices(centre: tuple[float, float] = (0.0, 0.0), angle: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Matrices of the rectangle, its centre beside the axis and its axes turned."""
    about = SECTION.at(0.0)
    stiffness = np.diag([float(each) for each in PLAIN.stiffnesses(0.0)])
    line, jy, jz = (2700.0 * float(each) for each in (about.area, about.inertia_y, about.inertia_z))
    mass = np.diag([line, line, line, jy + jz, jy, jz])
    y, z = centre
    # Strains at the centre: γ + κ × c, and rates of motion likewise; then in the section's own axes.
    moved = np.eye(6)
    moved[:3, 3:] = [[0, z, -y], [-z, 0, 0], [y, 0, 0]]
    turn = np.kron(np.eye(2), Rotation.from_rotvec([angle, 0, 0]).as_matrix().T)
    both = turn @ moved
    return both.T @ stiffness @ both, both.T @ mass @ both


def test_matrices_of_a_rectangle_are_the_rectangle() -> None:
    beam = gb.Beam(LENGTH, gb.Section.of_matrices(*matrices()), rotary_inertia=True)
    one, two = (gb.assemble(each, "exact", **SHAPES) for each in (PLAIN, beam))
    np.testing.assert_allclose(
        gb.modes(two, errors=False).frequency[:8], gb.modes(one, errors=False).frequency[:8], rtol=1e-9
    )
    load = (30.0, 2000.0, -8000.0)
    np.testing.assert_allclose(
        gb.static(two, acceleration=load).tip, gb.static(one, acceleration=load).tip, rtol=1e-8, atol=1e-12
    )


def test_the_axis_may_lie_beside_the_section() -> None:
    """One beam described from two axes: what one strains, turns and resists, the other does, bent by its length."""
    centre, angle = (0.04, -0.03), 0.6
    beside = gb.Beam(LENGTH, gb.Section.of_matrices(*matrices(centre, angle)), rotary_inertia=True)
    turned = gb.Line.of_pieces([0.0, LENGTH], twist=[angle, 0.0])
    middle = gb.Beam(LENGTH, SECTION, ALUMINIUM, rotary_inertia=True, line=turned)
    one, two = (gb.assemble(each, "exact", **SHAPES) for each in (middle, beside))
    np.testing.assert_allclose(gb.modes(two).frequency[:8], gb.modes(one).frequency[:8], rtol=1e-9)
    # The root of the other beam lies beside the base's, which turns: its acceleration is that of the centre less what
    # the turning brings there.
    rate, load = np.array([3.0, -40.0, 20.0]), np.array([30.0, 40000.0, -80000.0])
    arm = np.array([0.0, *centre])
    base = Base(load, rate, np.zeros(3))
    moved = Base(load - np.cross(rate, np.cross(rate, arm)), rate, np.zeros(3))
    of_one, of_two = gb.solve_equilibrium(one, base), gb.solve_equilibrium(two, moved)
    assert two.strain_energy(of_two.q) == pytest.approx(float(one.strain_energy(of_one.q)), rel=1e-7)
    ends = [structure.output[-1:] for structure in (one, two)]
    rotation = ends[1].rotation(of_two.q)[0]
    place = ends[1].positions(of_two.q)[0] + rotation @ arm - arm
    np.testing.assert_allclose(place, ends[0].positions(of_one.q)[0], atol=1e-7 * LENGTH)
    assert np.linalg.norm(place - [LENGTH, 0, 0]) > 0.2 * LENGTH


def test_strains_without_shapes_carry_no_force() -> None:
    """With the axis 40 mm beside the centre, bending alone would be several times as stiff at zero stretch."""
    beam = gb.Beam(LENGTH, gb.Section.of_matrices(*matrices((0.0, 0.04))), rotary_inertia=True)
    for kind in ("FOAM", "exact"):
        bent = gb.modes(gb.assemble(beam, kind, z=5)).frequency[0]
        assert bent == pytest.approx(gb.modes(gb.assemble(PLAIN, kind, z=5)).frequency[0], rel=0.02)


def test_errors_of_a_composite_beam_are_what_more_strains_and_shapes_move() -> None:
    stiffness, mass = matrices((0.0, 0.01), 0.4)
    stiffness[3, 4] = stiffness[4, 3] = 0.3 * np.sqrt(stiffness[3, 3] * stiffness[4, 4])
    load = gb.Load(LENGTH, force=(0.0, 10.0, 20.0))
    beam = gb.Beam(LENGTH, gb.Section.of_matrices(stiffness, mass), rotary_inertia=True, loads=[load])
    few, many = (
        gb.assemble(beam, "exact", **shapes)
        for shapes in ({"y": 1, "z": 1, "twist": 1}, {**SHAPES, "axial": 3, "shear_y": 3, "shear_z": 3})
    )
    coarse, fine = gb.static(few), gb.static(many)
    moved = np.linalg.norm(coarse.tip - fine.tip) / np.linalg.norm(coarse.tip)
    assert coarse.errors is not None and fine.errors is not None
    assert coarse.errors.displacement.total == pytest.approx(moved, rel=0.1)
    assert fine.errors.displacement.total < 1e-5


def test_tables_of_stations_are_taken_between_them() -> None:
    one, two = matrices(), matrices((0.0, 0.01))
    section = gb.Section.of_matrices(np.stack([one[0], two[0]]), np.stack([one[1], two[1]]), stations=[0.0, LENGTH])
    np.testing.assert_allclose(section.matrices(LENGTH / 4)[0], 0.75 * one[0] + 0.25 * two[0], rtol=1e-12)
    assert section.altered(stations=[0.0, 2 * LENGTH]).stations == (0.0, 1.0)


def test_a_gauge_reads_the_strain_of_the_whole_matrix() -> None:
    """At the place of the centre's upper face, seen from an axis beside it."""
    from gbeam.structure import fibre_strain

    beam = gb.Beam(LENGTH, gb.Section.of_matrices(*matrices((0.04, -0.03))), rotary_inertia=True)
    force, moment = np.array([100.0, 3.0, -20.0]), np.array([0.4, 5.0, -2.0])
    arm = np.array([0.0, 0.04, -0.03])
    expected = fibre_strain(PLAIN, 0.1, force, moment, 0.0, 0.01)
    at_axis = moment + np.cross(arm, force)
    assert fibre_strain(beam, 0.1, force, at_axis, 0.04, -0.03 + 0.01) == pytest.approx(float(expected), rel=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda k, m: (k[:5], m), r"stiffness is an array \(5, 6\)"),
        (lambda k, m: (k + np.eye(6, k=1) * k[0, 0], m), "stiffness is not symmetric"),
        (lambda k, m: (k - 2 * np.diag([0, 0, 0, k[3, 3], 0, 0]), m), "stiffness is not positive definite"),
        (lambda k, m: (k, 0 * m), "mass has the mass 0 kg/m"),
        (lambda k, m: (k, m + np.diag([1.0, 0, 0, 0, 0, 0])), "mass is that of no rigid body"),
        (lambda k, m: (k, m - np.diag([0, 0, 0, 0.99 * m[3, 3], 0, 0])), "mass has moments that no body has"),
    ],
)
def test_matrices_of_nothing_are_refused(change: Callable[..., Any], message: str) -> None:
    with pytest.raises(gb.InputError, match=message):
        gb.Section.of_matrices(*change(*matrices()))


def test_matrices_have_their_material_and_others_need_one() -> None:
    with pytest.raises(gb.InputError, match="material is given beside a section by matrices"):
        gb.Beam(LENGTH, gb.Section.of_matrices(*matrices()), ALUMINIUM)
    with pytest.raises(gb.InputError, match="material is missing"):
        gb.Beam(LENGTH, SECTION)
    with pytest.raises(gb.InputError, match="shapes are adapted, and the section's matrices couple"):
        gb.assemble(gb.Beam(LENGTH, gb.Section.of_matrices(*matrices())), "FOAM", z=2, shapes="adapted")


def test_a_scenario_has_matrices(tmp_path: Any) -> None:
    stiffness, mass = matrices((0.0, 0.01))
    text = f"""
title = "a composite strip"
[beam]
length = "500 mm"
rotary_inertia = true
[beam.section]
shape = "matrices"
stiffness = {stiffness.tolist()}
mass = {mass.tolist()}
[model]
kind = "FOAM"
modes = {{ axial = 0, y = 3, z = 3, twist = 2 }}
[motion.flight]
kind = "flight"
acceleration = {{ z = {{ profile = "constant", level = "2 g" }} }}
[response]
duration = "1 s"
"""
    file = tmp_path / "composite.toml"
    file.write_text(text, encoding="utf-8")
    case = gb.read_scenario(file)
    assert case.beam.section == gb.Section.of_matrices(stiffness, mass)
    assert gb.describe(case).mass == pytest.approx(2700 * 0.03 * 0.02 * LENGTH)
    for written, wrong, message in (
        ("mass = [[", "mass = [[1.0], [", "mass: has 7 entries"),
        ('shape = "matrices"', 'shape = "general"', "area is missing"),
        ("[model]", "[beam.material]\ndensity = 1000\nyoungs_modulus = 1e9\n[model]", "is given beside a section by"),
    ):
        file.write_text(text.replace(written, wrong), encoding="utf-8")
        with pytest.raises(gb.GbeamError, match=message):
            gb.read_scenario(file)
