"""Against other methods: the finite elements of `validation`, and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from validation.codes.hermite_beam import HermiteBeam

from .beams import slender, structure_2009

ELEMENTS = 30


def flap(beam, count, rate, radius, shapes="clamped-free"):
    structure = gb.assemble(beam, gb.Model("FOAM", 0, 0, count, shapes=shapes))
    return 2 * np.pi * gb.modes(structure, gb.Hub(radius=radius, rate=gb.constant(rate)), 0.0).frequency


@pytest.mark.parametrize("radius", [0.0, 1.0, 3.0])
def test_hub_radius(radius):
    elements = HermiteBeam(1.0, np.ones_like, np.ones_like, np.ones_like, 1.0, 1.0, elements=ELEMENTS)
    reference = elements.frequencies(np.array([-radius * 16.0, 0, 0]), np.array([0, 0, 4.0]), 3, "w")
    assert flap(slender(1e4), 14, 4.0, radius)[:3] == pytest.approx(reference, rel=2e-5)


def test_taper():
    """Width and thickness halve from root to tip, with a mass on it."""
    ends = (0.02, 0.01), (0.004, 0.002)
    section = gb.Section.rectangle(*ends, stations=(0.0, 0.3))
    beam = gb.Beam(0.3, section, gb.Material(2700.0, 7e10), [gb.PointMass(0.3, 0.002)], rotary_inertia=False)
    width, thick = (lambda x: 0.02 * (1 - x / 0.6)), (lambda x: 0.004 * (1 - x / 0.6))
    elements = HermiteBeam(
        0.3,
        lambda x: width(x) * thick(x),
        lambda x: width(x) * thick(x) ** 3 / 12,
        lambda x: thick(x) * width(x) ** 3 / 12,
        2700.0,
        7e10,
        0.002,
        ELEMENTS,
    )
    reference = elements.frequencies(np.array([-0.1 * 300.0**2, 0, 0]), np.array([0, 0, 300.0]), 3, "w")
    assert flap(beam, 10, 300.0, 0.1, "adapted")[:3] == pytest.approx(reference, rel=1e-4)


def test_rotating_bar():
    """The exact bar stretches to sin(ax)/(a cos aL), a = ω sqrt(ρ/E): the tan formula at the tip."""
    structure = gb.assemble(slender(10.0), gb.Model("exact", 8, 1, 0))
    for rate in (1.0, 5.0):
        a = rate / 10.0
        tip = gb.static(structure, gb.Hub(radius=0.0, rate=gb.constant(rate)), 0.0).tip
        assert tip[0] == pytest.approx(np.tan(a) / a - 1, rel=1e-9)


def test_heavy_column():
    """Greenhill 1881: 7.8373 EI/(m L³). TLAM has no geometric stiffness and never buckles."""
    answer = gb.buckling_acceleration(gb.assemble(slender(1e4), gb.Model("FOAM", 1, 0, 8)))
    assert answer.value == pytest.approx(7.83735, rel=1e-5)
    assert (answer.kind, answer.direction) == ("divergence", "z")
    none = gb.buckling_acceleration(gb.assemble(slender(1e4), gb.Model("TLAM", 1, 0, 8)))
    assert none.value is None and none.kind == "none" and "keeps" in none.reason


def test_foam_has_no_critical_speed():
    from .beams import HUB_2009

    critical = gb.critical_speed(structure_2009("FOAM", 2, 5), HUB_2009, upper=20.0)
    assert critical.value is None and critical.searched_to == 20.0


def test_a_beam_pointing_inward_diverges():
    """The hub's centre beyond the tip pushes the beam: FOAM and exact agree on the speed at which it gives way."""
    inward = gb.Hub(radius=16.0, rate=gb.constant(1.0), pointing="inward")
    foam = gb.critical_speed(structure_2009("FOAM", 1, 5), inward)
    assert foam.kind == "divergence" and foam.value == pytest.approx(1.694305, abs=2e-5)
