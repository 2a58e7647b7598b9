"""Von Mises stress by bending, shear and torsion, against closed forms and printed tables."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.structure import rectangle_stresses, saint_venant, von_mises

STEEL = gb.Material(7850.0, 210e9, poissons_ratio=0.3, yield_strength=400e6)
# Timoshenko and Goodier, Theory of Elasticity, 109: largest stress T/(k a b²), by b/a.
TABLE = {1.0: 0.208, 1.2: 0.219, 1.5: 0.231, 2.0: 0.246, 2.5: 0.258, 3.0: 0.267, 4.0: 0.282, 5.0: 0.291, 10.0: 0.312}


@pytest.mark.parametrize("aspect", TABLE)
def test_torsion_of_a_rectangle_is_saint_venants(aspect: float) -> None:
    middle, end = np.array([0.0]), np.array([1.0])
    on_long, _ = saint_venant(np.array([aspect]), np.array([1.0]), middle, end)
    assert 1 / (aspect * on_long[0]) == pytest.approx(TABLE[aspect], abs=8e-4)


@pytest.mark.parametrize(("width", "thickness"), [(2.0, 1.0), (1.0, 3.0)])
def test_stresses_over_a_rectangle_sum_to_what_it_carries(width: float, thickness: float) -> None:
    """Torque: the integral of y τ_xz − z τ_xy, by Gauss' rule."""
    at, weight = np.polynomial.legendre.leggauss(24)
    wide = width >= thickness
    long, thin = max(width, thickness), min(width, thickness)
    total = 0.0
    for u, wu in zip(at, weight, strict=True):
        for v, wv in zip(at, weight, strict=True):
            of = [np.array([each]) for each in (long, thin, u if wide else v, v if wide else u)]
            on_long, on_short = (float(each[0]) for each in saint_venant(*of))
            y, z = u * width / 2, v * thickness / 2
            moment = y * on_short + z * on_long if wide else y * on_long + z * on_short
            total += wu * wv * width * thickness / 4 * moment
    assert total == pytest.approx(1.0, abs=1e-5)


def carried(section: gb.Section, force: Any, moment: Any) -> float:
    stresses = section.stresses(np.zeros(1))
    return float(von_mises(stresses, np.reshape(force, (1, 1, 3)), np.reshape(moment, (1, 1, 3)))[0, 0])


def test_pure_loads_have_their_closed_forms() -> None:
    width, thickness, diameter, wall = 0.03, 0.02, 0.04, 0.003
    strip, rod = gb.Section.rectangle(width, thickness), gb.Section.circle(diameter)
    tube = gb.Section.tube(diameter, wall)
    area = width * thickness
    root3 = np.sqrt(3)
    assert carried(strip, (100.0, 0, 0), (0, 0, 0)) == pytest.approx(100 / area)
    assert carried(strip, (0, 0, 100.0), (0, 0, 0)) == pytest.approx(root3 * 1.5 * 100 / area)
    assert carried(strip, (0, 0, 0), (0, 5.0, 2.0)) == pytest.approx(
        6 * 5 / (width * thickness**2) + 6 * 2 / (thickness * width**2)
    )
    assert carried(rod, (0, 0, 0), (7.0, 0, 0)) == pytest.approx(root3 * 16 * 7 / (np.pi * diameter**3))
    assert carried(rod, (0, 30.0, 0), (0, 0, 0)) == pytest.approx(root3 * 4 / 3 * 30 / (np.pi * diameter**2 / 4))
    # Of a thin tube 2 V/A, less by 1 % of a wall of 7.5 % of the diameter.
    thin = root3 * 2 * 30 / (np.pi * (diameter - wall) * wall)
    assert carried(tube, (0, 0, 30.0), (0, 0, 0)) == pytest.approx(thin, rel=0.01)
    # Bending and torsion of a rod: √(σ² + 3 τ²) with the largest of both at one place.
    bend, twist = 32 * 5 / (np.pi * diameter**3), 16 * 7 / (np.pi * diameter**3)
    assert carried(rod, (0, 0, 0), (7.0, 5.0, 0)) == pytest.approx(np.sqrt(bend**2 + 3 * twist**2))


def test_the_corner_of_a_rectangle_has_no_shear_and_its_long_faces_the_most() -> None:
    stresses = rectangle_stresses(np.array([0.03]), np.array([0.02]))[..., 0]
    shear = np.hypot(stresses[:, 1, 3], stresses[:, 2, 3])
    normal = np.abs(stresses[:, 0, 4:]).sum(axis=1)
    assert shear[normal.argmax()] == pytest.approx(0.0, abs=0.01 * shear.max())
    assert stresses[shear.argmax(), 0, 5] == 0.0


def test_a_shaft_yields_by_torsion() -> None:
    """The margin on yield is by von Mises': a normal stress has none to say of a twisted rod."""
    torque, diameter = 20.0, 0.01
    twist = gb.Load(0.3, moment=(torque, 0.0, 0.0))
    rod = gb.Beam(0.3, gb.Section.circle(diameter), STEEL, rotary_inertia=True, damping_ratio=0.01, loads=[twist])
    structure = gb.assemble(rod, "FOAM", z=2, twist=3)
    loads = gb.static(structure).loads
    assert loads is not None and loads.von_mises is not None and loads.margin is not None
    expected = np.sqrt(3) * 16 * torque / (np.pi * diameter**3)
    np.testing.assert_allclose(loads.von_mises[0], expected)
    np.testing.assert_allclose(loads.margin[0], 400e6 / expected - 1)
    assert np.abs(loads.stress).max() < 1e-6 * expected
    response = gb.simulate(structure, gb.Flight(z=0.0), duration=0.02)
    # The tip does not move, nor is there a force: no error is a share of that, and no step is refined by it.
    assert response.steps <= 1000 and not response.warnings
    assert response.errors.displacement.total == 0.0 and response.errors.loads.total < 1e-9
    peak = response.peaks.loads
    assert peak is not None and peak.largest_von_mises is not None and peak.least_margin is not None
    assert peak.largest_von_mises.value == pytest.approx(expected, rel=1e-6)
    assert peak.least_margin.value == pytest.approx(400e6 / expected - 1, rel=1e-6)


def test_sections_without_formulas_have_none() -> None:
    strip = gb.Section.general(6e-4, 2e-8, 4.5e-8, extreme_fibre_y=0.015, extreme_fibre_z=0.01)
    loads = gb.static(gb.assemble(gb.Beam(0.3, strip, STEEL), "FOAM", z=2), acceleration=(0.0, 0.0, 10.0)).loads
    assert loads is not None and loads.von_mises is not None and loads.margin is not None
    assert np.isnan(loads.von_mises).all()
    assert loads.margin[0, 0] == pytest.approx(400e6 / loads.stress[0, 0] - 1)
