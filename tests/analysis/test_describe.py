"""Descriptions: masses and centres by hand, frequencies of a cantilever, and words on one body as on several."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from gbeam.report import description_text as text

STRIP = gb.Beam(
    0.3,
    gb.Section.rectangle(width=0.02, thickness=0.004),
    gb.Material(2700, 70e9),
    damping_ratio=0.01,
    masses=[gb.PointMass(0.3, 0.1)],
)
BARE = 2700 * 0.3 * 0.02 * 0.004  # kg
SETTINGS = gb.ResponseSettings(1.0)


def test_a_beam_has_its_mass_centre_and_frequencies() -> None:
    strip = gb.Beam(0.3, STRIP.section, STRIP.material, damping_ratio=0.01)
    case = gb.Case.of_beam("strip", strip, gb.Model("FOAM", z=3), {"still": gb.Flight(z=0.0)}, SETTINGS)
    description = gb.describe(case)
    beam = description.bodies["beam"]
    assert description.mass == beam.mass == pytest.approx(BARE) and not description.joints
    np.testing.assert_allclose(description.centre, [0.15, 0.0, 0.0], atol=1e-12)
    # beta_1^2 sqrt(EI / rho A) / (2 pi L^2)
    bending = 1.875104**2 * np.sqrt(70e9 * 0.004**2 / 12 / 2700) / (2 * np.pi * 0.3**2)
    assert beam.frequency[0] == pytest.approx(bending, rel=1e-4) and beam.direction == ("z",) * 3
    assert text(description).splitlines()[1:3] == [
        "  beam      FOAM, 300 mm, 0.0648 kg",
        "            3 coordinates: 0 axial, 0 y, 3 z; points tip",
    ]


def test_a_system_has_the_mass_of_its_bodies_and_their_centre_at_the_start() -> None:
    """A strip with a mass at its tip hangs from the end of a rod that a hinge has turned upright."""
    strip = gb.assemble(STRIP, "FOAM", axial=0, y=0, z=2)
    rod = gb.RigidBody(2.0, (0.0, 0.1, 0.1), centre=(0.4, 0, 0), points={"end": (1, 0, 0)})
    hinge = gb.Joint("revolute", "rod", axes=[(0, -1, 0)], initial=np.pi / 2)
    clamp = gb.Joint("fixed", "strip", on="rod.end", turn=(0.0, np.pi / 2, 0.0))
    system = gb.System({"rod": rod, "strip": strip}, {"hinge": hinge, "clamp": clamp}, gravity=(0, 0, -9.81))
    description = gb.describe(gb.Case("raised", system, {}, SETTINGS))
    mass = BARE + 0.1
    assert description.mass == pytest.approx(2.0 + mass)
    assert description.bodies["strip"].bare_mass == pytest.approx(BARE)
    # The rod points along z, and the strip along x from its end.
    moment = 2.0 * np.array([0, 0, 0.4]) + mass * np.array([0, 0, 1.0]) + np.array([BARE * 0.15 + 0.1 * 0.3, 0, 0])
    np.testing.assert_allclose(description.centre, moment / (2.0 + mass), atol=1e-12)
    lowest = gb.modes(gb.System.of(strip)).frequency[0]
    assert description.bodies["strip"].frequency[0] == pytest.approx(lowest, rel=1e-9)
    assert description.bodies["rod"].frequency.shape == (0,) and set(description.joints) == {"hinge", "clamp"}
    words = text(description)
    assert "strip: FOAM, 300 mm, 0.0648 kg, 0.1648 kg with 1 added; 2 coordinates" in words
    assert "hinge: revolute, rod on ground; free angle" in words and "gravity   0, 0, -9.81 m/s²" in words
