"""Against solutions by another method, written here: Hermite finite elements, and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from gbeam import Beam, Material, Model, PointMass, Section, assemble
from gbeam.analysis.equilibrium.static import static
from gbeam.analysis.vibration.modal import modes
from gbeam.analysis.vibration.stability import buckling_acceleration, critical_speed
from gbeam.motion import Hub, constant

from .beams import slender, structure_2009

ELEMENTS = 60
XI, WEIGHT = np.polynomial.legendre.leggauss(6)
XI, WEIGHT = (XI + 1) / 2, WEIGHT / 2


def hermite_flap(length, area, inertia, density, e, rate, radius, tip=0.0):
    """Flapping frequencies of a rotating beam by cubic finite elements, rad/s; `area` and `inertia` are functions."""
    h = length / ELEMENTS
    size = 2 * ELEMENTS + 2
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    s = XI
    shape = np.array([1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)])
    slope = np.array([-6 * s + 6 * s**2, h * (1 - 4 * s + 3 * s**2), 6 * s - 6 * s**2, h * (3 * s**2 - 2 * s)]) / h
    curve = np.array([-6 + 12 * s, h * (-4 + 6 * s), 6 - 12 * s, h * (6 * s - 2)]) / h**2
    fine_s, fine_w = np.polynomial.legendre.leggauss(40)
    for k in range(ELEMENTS):
        x, i = (k + s) * h, slice(2 * k, 2 * k + 4)
        tension = []
        for at in x:
            out = at + (length - at) * (fine_s + 1) / 2
            pull = np.sum(density * area(out) * (radius + out) * fine_w) * (length - at) / 2
            tension.append(rate**2 * (pull + tip * (radius + length)))
        mass[i, i] += (shape * WEIGHT * h * density * area(x)) @ shape.T
        stiffness[i, i] += (curve * WEIGHT * h * e * inertia(x)) @ curve.T
        stiffness[i, i] += (slope * WEIGHT * h * np.array(tension)) @ slope.T
    mass[-2, -2] += tip
    return np.sqrt(scipy.linalg.eigh(stiffness[2:, 2:], mass[2:, 2:], eigvals_only=True))


def flap(beam, count, rate, radius, shapes="clamped-free"):
    structure = assemble(beam, Model("FOAM", 0, 0, count, shapes=shapes))
    return 2 * np.pi * modes(structure, Hub(radius=radius, rate=constant(rate)), 0.0).frequency


@pytest.mark.parametrize("radius", [0.0, 1.0, 3.0])
def test_hub_radius(radius):
    wanted = hermite_flap(1.0, np.ones_like, np.ones_like, 1.0, 1.0, 4.0, radius)
    assert flap(slender(1e4), 14, 4.0, radius)[:3] == pytest.approx(wanted[:3], rel=2e-5)


def test_taper():
    """Width and thickness halve from root to tip, with a mass on it."""
    ends = (0.02, 0.01), (0.004, 0.002)
    section = Section.rectangle(*ends, stations=(0.0, 0.3))
    beam = Beam(0.3, section, Material(2700.0, 7e10), [PointMass(0.3, 0.002)])
    width, thick = (lambda x: 0.02 * (1 - x / 0.6)), (lambda x: 0.004 * (1 - x / 0.6))
    wanted = hermite_flap(
        0.3, lambda x: width(x) * thick(x), lambda x: width(x) * thick(x) ** 3 / 12, 2700.0, 7e10, 300.0, 0.1, tip=0.002
    )
    assert flap(beam, 10, 300.0, 0.1, "adapted")[:3] == pytest.approx(wanted[:3], rel=1e-4)


def test_rotating_bar():
    """The exact bar stretches to sin(ax)/(a cos aL), a = ω sqrt(ρ/E): the tan formula at the tip."""
    structure = assemble(slender(10.0), Model("exact", 8, 1, 0))
    for rate in (1.0, 5.0):
        a = rate / 10.0
        tip = static(structure, Hub(radius=0.0, rate=constant(rate)), 0.0).tip
        assert tip[0] == pytest.approx(np.tan(a) / a - 1, rel=1e-9)


def test_heavy_column():
    """Greenhill 1881: 7.8373 EI/(m L³). TLAM has no geometric stiffness and never buckles."""
    found = buckling_acceleration(assemble(slender(1e4), Model("FOAM", 1, 0, 8)))
    assert found.value == pytest.approx(7.83735, rel=1e-5)
    assert (found.kind, found.direction) == ("divergence", "z")
    none = buckling_acceleration(assemble(slender(1e4), Model("TLAM", 1, 0, 8)))
    assert none.value is None and none.kind == "none" and "keeps" in none.reason


def test_foam_has_no_critical_speed():
    from .beams import HUB_2009

    found = critical_speed(structure_2009("FOAM", 2, 5), HUB_2009, upper=20.0)
    assert found.value is None and found.searched_to == 20.0


def test_a_beam_pointing_inward_diverges():
    """The hub's centre beyond the tip pushes the beam: FOAM and exact agree on the speed at which it gives way."""
    inward = Hub(radius=16.0, rate=constant(1.0), pointing="inward")
    foam = critical_speed(structure_2009("FOAM", 1, 5), inward)
    assert foam.kind == "divergence" and foam.value == pytest.approx(1.694305, abs=2e-5)
