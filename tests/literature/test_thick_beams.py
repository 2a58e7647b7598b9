"""Beams that twist, shear and turn: Timoshenko's equations, Saint-Venant's torsion, Prandtl's lateral buckling.

The frequencies are roots of the determinant of an exact transfer matrix, exp(A L) of the equations in x.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import jv

import gbeam as gb
from gbeam.questions import modes

from ..lagrange import quickly_compiled

ALUMINIUM = gb.Material(2700.0, 70e9, poissons_ratio=0.33)
WIDTH, THICKNESS, LENGTH = 0.03, 0.02, 0.3
SECTION = gb.Section.rectangle(WIDTH, THICKNESS)
LINE = ALUMINIUM.density * WIDTH * THICKNESS


def beam(length: float = LENGTH, **changes: Any) -> gb.Beam:
    return replace(gb.Beam(length, SECTION, ALUMINIUM, damping_ratio=0.01, rotary_inertia=True), **changes)


_, _, IN_SHEAR, TORSION, ABOUT_Y, ABOUT_Z = (float(each) for each in beam().stiffnesses(0.0))
TURNING, POLAR = (ALUMINIUM.density / ALUMINIUM.youngs_modulus * each for each in (ABOUT_Y, ABOUT_Y + ABOUT_Z))


def roots(function: Callable[[float], float], upper: float, count: int) -> np.ndarray:
    """Lowest frequencies, Hz, up to a circular one at which a function changes its sign."""
    grid = np.linspace(1e-3 * upper, upper, 2000)
    values = np.array([function(w) for w in grid])
    at = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]
    assert len(at) == count
    return np.array([brentq(function, grid[i], grid[i + 1], xtol=1e-10 * upper) for i in at]) / (2 * np.pi)


def bending(w: float, *, shear: bool) -> np.ndarray:
    """Matrix A (4, 4) of w' = Q/kGA − θ, θ' = M/EI_y, M' = Q − ρI_y ω² θ, Q' = −ρA ω² w (Timoshenko, 1921)."""
    a = np.zeros((4, 4))
    a[0, 1], a[0, 3], a[1, 2] = -1.0, shear / IN_SHEAR, 1 / ABOUT_Y
    a[2, 1], a[2, 3], a[3, 0] = -TURNING * w**2, 1.0, -LINE * w**2
    return a


def timoshenko(length: float, count: int, *, shear: bool = True) -> np.ndarray:
    """Frequencies, Hz, of a cantilever that bends along z."""

    def free_end(w: float) -> float:
        return float(np.linalg.det(expm(bending(w, shear=shear) * length)[2:, 2:]))

    return roots(free_end, 40 * 3.516 * np.sqrt(ABOUT_Y / LINE) / length**2, count)


@pytest.mark.parametrize("slenderness", [5, 10, 50])
def test_frequencies_are_timoshenkos_from_stout_to_slender(slenderness: int) -> None:
    length = slenderness * THICKNESS
    computed = gb.modes(gb.assemble(beam(length), "exact", z=9, shear_z=8))
    np.testing.assert_allclose(computed.frequency[:3], timoshenko(length, 3), rtol=5e-6)
    assert computed.errors is not None and (computed.errors.shapes[:3] < 1e-6).all()
    assert computed.errors.theory in ("", "plate action")


def test_automatic_numbers_of_shapes_twist_and_shear_a_stout_bar() -> None:
    """Without twist and shear the fourth frequency of a bar of L/h = 5 was 14 % too high, and torsion was not there."""
    bar = beam(5 * THICKNESS)
    case = gb.Case.of_beam("bar", bar, gb.Model.of("FOAM"), {}, None)
    answer = modes(case)
    along_z = timoshenko(bar.length, 2)
    lowest = np.sort(answer.frequency)[:6]
    for expected in along_z:
        assert np.abs(lowest / expected - 1).min() < 1e-4
    assert "twist" in answer.direction[:6] and answer.errors.theory == "plate action"
    assert answer.error_estimate[:6].max() < 0.02
    slender = gb.modes(gb.assemble(bar, gb.Model.of("FOAM")))
    assert np.abs(np.sort(slender.frequency) / along_z[1] - 1).min() > 0.05
    assert slender.error_estimate.max() > 0.05


def test_a_body_of_a_system_has_as_many_shapes_as_its_errors_ask_for() -> None:
    """The bar at the end of a rigid arm that is clamped on the ground has Timoshenko's frequencies, too."""
    bar = gb.assemble(beam(5 * THICKNESS), gb.Model.of("FOAM"))
    arm = gb.RigidBody(1.0, (0.1, 0.1, 0.1), points={"end": (0.2, 0.0, 0.0)})
    joints = {"foot": gb.Joint("fixed", "arm"), "clamp": gb.Joint("fixed", "bar", "arm.end")}
    case = gb.Case("bar", gb.System({"arm": arm, "bar": bar}, joints), {}, None)
    lowest = np.sort(modes(case).frequency)[:6]
    for expected in timoshenko(5 * THICKNESS, 2):
        assert np.abs(lowest / expected - 1).min() < 1e-4
    assert list(case.automatic_beams) == ["bar"]


def test_numbers_that_are_given_are_kept() -> None:
    case = gb.Case.of_beam("bar", beam(5 * THICKNESS), gb.Model("FOAM", axial=1, y=2, z=2), {}, None)
    assert len(modes(case).frequency) == 5


def test_shear_and_rotary_inertia_are_the_error_that_is_stated_without_them() -> None:
    slender = gb.modes(gb.assemble(beam(10 * THICKNESS, rotary_inertia=False), "exact", z=9))
    stated, expected = slender.errors, timoshenko(10 * THICKNESS, 3)
    assert stated is not None
    np.testing.assert_allclose(stated.beam_theory[:3], slender.frequency[:3] / expected - 1, rtol=0.05)


@pytest.mark.parametrize("model", [gb.Model("FOAM", z=9), gb.Model("exact", z=9)], ids=lambda model: model.kind)
def test_rotary_inertia_alone_is_rayleighs(model: gb.Model) -> None:
    computed = gb.modes(gb.assemble(beam(10 * THICKNESS), model)).frequency[:2]
    closeness = 1e-4 if model.kind == "FOAM" else 1e-8  # shapes of a beam without it converge slowly
    np.testing.assert_allclose(computed, timoshenko(10 * THICKNESS, 2, shear=False), rtol=closeness)


def test_adapted_shapes_have_timoshenkos_frequencies_at_once() -> None:
    structure = gb.assemble(beam(5 * THICKNESS), "exact", z=2, shear_z=2, shapes="adapted")
    np.testing.assert_allclose(gb.modes(structure).frequency[:2], timoshenko(5 * THICKNESS, 2), rtol=1e-8)


def test_a_shaft_turns_a_disc_by_saint_venants_torsion() -> None:
    moment = 2e-3
    structure = gb.assemble(
        beam(masses=[gb.PointMass(LENGTH, 0.5, inertia=(moment, 1e-3, 1e-3))]), "exact", [LENGTH / 3], twist=8
    )

    def at_disc(w: float) -> float:
        k = w * np.sqrt(POLAR / TORSION)
        return float(TORSION * k * np.cos(k * LENGTH) - moment * w**2 * np.sin(k * LENGTH))

    expected = roots(at_disc, 8 / LENGTH * np.sqrt(TORSION / POLAR), 2)
    computed = gb.modes(structure)
    np.testing.assert_allclose(computed.frequency[:2], expected, rtol=1e-7)
    assert computed.direction[:2] == ("twist", "twist") and computed.twist is not None
    # The shape is a sine, and its edge moves by 1 where it moves most.
    sine = np.sin(2 * np.pi * expected[0] * np.sqrt(POLAR / TORSION) * structure.stations)
    assert computed.twist[0, 0] / computed.twist[0, 1] == pytest.approx(sine[0] / sine[1], rel=1e-6)
    assert np.abs(computed.body.moved(0)[1]).max() == pytest.approx(1.0) and not np.abs(computed.shape[0]).any()


def test_a_mass_off_the_axis_bends_and_twists_the_beam() -> None:
    """100 mm beside the axis, where a model without torsion has the second frequency twice as high."""
    mass, arm = 0.2, 0.1
    carrying = beam(masses=[gb.PointMass(LENGTH, mass, offset=(0.0, arm, 0.0))])

    def at_mass(w: float) -> float:
        a = np.zeros((6, 6))
        a[:4, :4], a[4, 5], a[5, 4] = bending(w, shear=False), 1 / TORSION, -POLAR * w**2
        end = expm(a * LENGTH)[:, [2, 3, 5]]  # by moment, shear force and torque at the root
        pull = mass * w**2 * (end[0] + arm * end[4])  # of the mass, which moves by w + arm φ
        return float(np.linalg.det(np.stack([end[2], end[3] - pull, end[5] - arm * pull])))

    expected = roots(at_mass, 2 * np.pi * 2000.0, 3)
    twisting = gb.modes(gb.assemble(carrying, "exact", z=7, twist=6))
    np.testing.assert_allclose(twisting.frequency[:3], expected, rtol=1e-6)
    assert gb.modes(gb.assemble(carrying, "exact", z=7)).frequency[1] > 2 * expected[1]


def test_a_tip_force_bends_and_shears_and_a_moment_twists() -> None:
    force, moment = 10.0, 0.5
    load = gb.Load(LENGTH, force=(0.0, 0.0, force), moment=(moment, 0.0, 0.0))
    structure = gb.assemble(beam(loads=[load]), "exact", axial=1, y=4, z=4, twist=2, shear_y=2, shear_z=2)
    rest = gb.static(structure)
    assert rest.tip[2] == pytest.approx(force * LENGTH**3 / (3 * ABOUT_Y) + force * LENGTH / IN_SHEAR, rel=1e-5)
    assert structure.field is not None and rest.loads is not None
    turned = structure.field.rotation(rest.q, slice(-1, None))[0]
    assert np.arctan2(turned[2, 1], turned[1, 1]) == pytest.approx(moment * LENGTH / TORSION, rel=1e-4)
    assert rest.loads.section_moment[0, 0, 0] == pytest.approx(moment, rel=1e-3)
    assert not rest.warnings


@pytest.mark.parametrize("at", [LENGTH, None], ids=["by a force at the tip", "by an even load"])
def test_a_strip_on_edge_buckles_sideways(at: float | None) -> None:
    """4.0126 √(EI GJ)/L² (Michell and Prandtl, 1899) and 12.85 √(EI GJ)/L³: J_{−1/4} and J_{−1/6} have their roots at
    a half and a sixth of them (Timoshenko and Gere, Theory of Elastic Stability, 6.3).
    """
    order, share = (-1 / 4, 2) if at else (-1 / 6, 6)
    factor = share * brentq(lambda x: jv(order, x), 1.5, 2.5)
    strip = gb.Section.rectangle(0.05, 0.0005)
    push = (0.0, 1.0, 0.0)
    pushed = gb.Load(distributed=push) if at is None else gb.Load(at, force=push)
    edge = gb.Beam(LENGTH, strip, ALUMINIUM, rotary_inertia=True, loads=[pushed])
    _, _, _, torsion, about_y, _ = (float(each) for each in edge.stiffnesses(0.0))
    expected = factor * np.sqrt(about_y * torsion) / LENGTH ** (2 if at else 3)
    critical = gb.critical_load(gb.assemble(edge, "exact", y=3, z=7, twist=7), upper=2 * expected)
    # The strip bends on edge before: more by the order of EI_y/EI_z, 1e-4 here, and of GJ/EI_z.
    assert 1 < critical.value / expected < 1 + 2e-4 and critical.kind == "divergence"
    flat = gb.critical_load(gb.assemble(edge, "exact", y=3, z=7), upper=2 * expected)
    assert flat.value is None and any("with shear and twist" in warning for warning in flat.warnings)


@pytest.mark.parametrize(
    ("changes", "counts", "where"),
    [
        ({"material": gb.Material(2700.0, 70e9)}, {"z": 2, "shear_z": 1}, "material.shear_modulus"),
        ({"rotary_inertia": False}, {"z": 2, "twist": 1}, "rotary_inertia"),
        ({"section": gb.Section.general(6e-4, 2e-8, 4e-8)}, {"twist": 1}, "section.torsion_constant"),
        ({"section": gb.Section.general(6e-4, 2e-8, 4e-8)}, {"shear_z": 1}, "section.shear_coefficient_z"),
    ],
    ids=lambda each: each if isinstance(each, str) else "",
)
def test_what_a_strain_needs_is_asked_for(changes: dict[str, Any], counts: dict[str, int], where: str) -> None:
    with pytest.raises(gb.InputError, match=r"is (missing|false), and") as caught:
        gb.assemble(beam(**changes), "exact", **counts)
    assert caught.value.where == where and caught.value.fix


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_inertia_of_sections_has_a_derivative(kind: str) -> None:
    def mass(density: Any) -> Any:
        heavier = beam(material=replace(ALUMINIUM, density=density))
        return gb.assemble(heavier, kind, axial=1, z=2, twist=1).coefficients.mass

    slope = quickly_compiled(jax.jacfwd(mass))(ALUMINIUM.density)
    np.testing.assert_allclose(slope * ALUMINIUM.density, mass(ALUMINIUM.density), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "CFOAM"])
def test_other_models_twist_and_shear_to_their_order(kind: str) -> None:
    """By the Taylor polynomials of the exact places: at rest all are one."""
    camera = beam(masses=[gb.PointMass(LENGTH, 0.1, offset=(0.0, 0.04, 0.0))])
    one, two = (
        gb.modes(gb.assemble(camera, each, axial=1, z=4, twist=3, shear_z=2, shapes="adapted"), errors=False)
        for each in (kind, "exact")
    )
    np.testing.assert_allclose(one.frequency, two.frequency, rtol=1e-9)
    assert two.twist is not None
    np.testing.assert_allclose(np.abs(one.twist), np.abs(two.twist), rtol=1e-5, atol=1e-6)
