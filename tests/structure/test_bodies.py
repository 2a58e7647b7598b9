"""A tip body with rotary inertia and an offset centre, in every model."""

from __future__ import annotations

import numpy as np
import pytest
from exact_beams import AREA, DENSITY, INERTIA, LENGTH, MODULUS, with_bodies

from gbeam import Hub, Material, Model, PointMass, Section, assemble
from validation.residuals import hinged

from ..lagrange import Complete, hub_kinetic
from ..specimens import appendage

BOX, METAL = Section.general(AREA, INERTIA, INERTIA), Material(DENSITY, MODULUS)
ALONG = PointMass(LENGTH, 0.5, inertia=(0.0, 0.2, 0.2), offset=(0.3, 0.0, 0.0))
ASKEW = PointMass(LENGTH, 0.5, inertia=(0.03, 0.04, 0.05), offset=(0.2, -0.15, 0.1))
KINDS = ["TLAM", "FOAM", "SFOAM", "CFOAM", "exact"]


@pytest.mark.parametrize("kind", KINDS)
def test_frequency_equation(kind: str) -> None:
    """Body's centre beyond the tip, on the axis: the closed frequency equation."""
    truth = with_bodies(3, mass=0.5, inertia=0.2, offset=0.3)
    structure = assemble(appendage(ALONG), Model(kind, 0, 3, 0, "adapted"))
    np.testing.assert_allclose(structure.rest[0], truth, rtol=1e-7)


def test_the_exact_field_vibrates_as_foams_field_does_with_a_body_askew() -> None:
    """Offset across the axis couples bending, stretch and the other plane; small vibrations must agree."""
    beam = appendage(ASKEW)
    first, second = (assemble(beam, Model(kind, 1, 3, 3, "adapted")).rest[0] for kind in ("CFOAM", "exact"))
    np.testing.assert_allclose(first, second, rtol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_planar_rigid_body_limit(kind: str) -> None:
    """At rest on the hub, the beam does not bend: inertia about the axis is that of rigid bodies."""
    structure = assemble(appendage(ASKEW), Model(kind, 0, 3, 0, "adapted"))
    energy = Complete(structure)
    unit = np.array([1.0, 0.0, 0.0, 0.0])
    inertia = 2 * hub_kinetic(energy, 0.5, 200.0, np.eye(3), 0 * unit, unit)
    slender = DENSITY * AREA * ((0.5 + LENGTH) ** 3 - 0.5**3) / 3
    body = 0.05 + 0.5 * ((0.5 + LENGTH + 0.2) ** 2 + 0.15**2)
    assert float(inertia) == pytest.approx(200 + slender + body, rel=1e-12)
    if structure.linear:
        torque = hinged(structure, Hub(radius=0.5, inertia=200.0)).residual(0 * unit, 0 * unit, unit, 0.0)[0]
        assert float(torque) == pytest.approx(200 + slender + body, rel=1e-12)
