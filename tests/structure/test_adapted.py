"""Shapes adapted to the structure are its modes at rest: five of them are five right frequencies."""

from __future__ import annotations

import numpy as np
import pytest
from exact_beams import AREA, DENSITY, INERTIA, LENGTH, MODULUS, truncated_wedge, with_bodies

from gbeam import Beam, InputError, Material, Model, PointMass, Root, Section, assemble
from gbeam.mechanics import adapted_shapes, quadrature

from ..specimens import appendage

BOX, METAL = Section.general(AREA, INERTIA, INERTIA), Material(DENSITY, MODULUS)
CLOSE = 1e-7  # relative; what is asked for is 1e-4


def frequencies(beam: Beam, model: Model) -> np.ndarray:
    return assemble(beam, model).rest[0]


@pytest.mark.parametrize("kind", ["CFOAM", "exact"])
def test_five_modes_with_a_heavy_tip(kind: str) -> None:
    beam, truth = Beam(LENGTH, BOX, METAL, [PointMass(LENGTH, 0.5)], rotary_inertia=False), with_bodies(5, mass=0.5)
    np.testing.assert_allclose(frequencies(beam, Model(kind, 0, 0, 5, "adapted")), truth, rtol=CLOSE)
    # Clamped-free shapes leave 1.8 % in mode 5.
    assert frequencies(beam, Model("CFOAM", 0, 5, 0))[4] / truth[4] == pytest.approx(1.0178, abs=2e-3)


def test_five_modes_with_a_mass_in_mid_span() -> None:
    beam = Beam(LENGTH, BOX, METAL, [PointMass(3.0, 0.7)], rotary_inertia=False)
    truth = with_bodies(5, mass=0.7, at=3.0)
    np.testing.assert_allclose(frequencies(beam, Model("CFOAM", 0, 5, 0, "adapted")), truth, rtol=CLOSE)


def test_five_modes_of_a_taper() -> None:
    section = Section.rectangle(0.02, [0.01, 0.003], [0.0, 0.8])
    truth = truncated_wedge(5, 0.8, 0.01, 0.003, 70e9, 2700.0)
    beam = Beam(0.8, section, Material(2700.0, 70e9), rotary_inertia=False)
    np.testing.assert_allclose(frequencies(beam, Model("CFOAM", 0, 0, 5, "adapted")), truth, rtol=CLOSE)


def test_five_modes_on_root_springs_with_a_tip_body() -> None:
    body = PointMass(LENGTH, 0.5, inertia=(0.0, 0.2, 0.2), offset=(0.3, 0.0, 0.0))
    root = Root(rotation_z=300.0, translation_y=900.0)
    beam = Beam(LENGTH, BOX, METAL, [body], root=root, rotary_inertia=False)
    truth = with_bodies(5, mass=0.5, inertia=0.2, offset=0.3, rotation=300.0, translation=900.0)
    np.testing.assert_allclose(frequencies(beam, Model("CFOAM", 0, 5, 0, "adapted"))[:5], truth, rtol=CLOSE)


def test_axial_shapes_with_a_tip_mass() -> None:
    # Frequency equation of the bar: βL tan βL = ρAL/m; here the two masses are equal.
    beam = Beam(LENGTH, BOX, METAL, [PointMass(LENGTH, DENSITY * AREA * LENGTH)])
    truth = np.array([0.8603335890193797, 3.4256184594817283, 6.437298179171947]) / LENGTH * np.sqrt(MODULUS / DENSITY)
    for kind in ("CFOAM", "exact"):
        np.testing.assert_allclose(frequencies(beam, Model(kind, 3, 0, 0, "adapted")), truth, rtol=CLOSE)


def test_they_keep_the_closed_forms_normalisation_and_sign() -> None:
    plain = assemble(appendage(), Model("CFOAM", 2, 3, 3))
    adapted = assemble(appendage(), Model("CFOAM", 2, 3, 3, "adapted"))
    for name in ("shapes", "slopes", "node_slopes"):
        np.testing.assert_allclose(getattr(adapted.field, name), getattr(plain.field, name), atol=1e-8)


def test_unknown_shapes_are_refused() -> None:
    with pytest.raises(InputError, match="shapes is 'best'"):
        Model("FOAM", 0, 0, 3, "best")


def test_their_sign_is_that_of_the_root_whatever_the_nodes_are() -> None:
    """The third shape's curvature changes its sign within 1 mm of this root, between the first nodes of two rules."""
    root = Root(rotation_y=50.0, rotation_z=100.0, translation_z=1e4)
    beam, tip = Beam(0.3, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9), root=root), np.array([0.3])
    shapes = [adapted_shapes(beam, quadrature(0.3, nodes), (0, 3, 3, 0, 0, 0)) for nodes in (20, 24, 30)]
    for along in (1, 2):
        first, *others = (each[along](tip).value for each in shapes)
        for other in others:
            np.testing.assert_allclose(other, first, rtol=1e-6)
