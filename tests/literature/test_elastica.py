"""Large static deflection: the elastica under a dead tip force, that of a heavy tip mass in acceleration."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from gbeam import Beam, Load, Material, Model, PointMass, Section, Structure, assemble, solve_equilibrium, static
from gbeam.results import Base
from validation.published.specimens import PLANAR
from validation.published.tables import ELASTICA


@cache
def light_beam(counts: tuple[int, int, int]) -> Structure:
    """EI = 1 N m², EA = 1e8 N, 1e-9 kg, with 1 kg at the tip."""
    section = Section.general(1.0, 1e-8, 1e-8)
    return assemble(Beam(1.0, section, Material(1e-9, 1e8), [PointMass(1.0, 1.0)]), Model("exact", *counts))


@pytest.mark.parametrize("force", ELASTICA)
@pytest.mark.parametrize("direction", [0.0, 0.6], ids=["in a plane", "between the planes"])
def test_tip_force(force: float, direction: float) -> None:
    """A base accelerating away from the force; between the planes, the spatial rotations must find the same curve."""
    c, s = np.cos(direction), np.sin(direction)
    structure = light_beam(PLANAR if direction == 0 else (1, 9, 9))
    o = np.zeros(3)
    q = solve_equilibrium(structure, Base(-force * np.array([0.0, c, s]), o, o)).q
    short, across, slope = ELASTICA[force]
    np.testing.assert_allclose(structure.displacement(q)[-1], [-short, c * across, s * across], atol=2e-6)
    tangent = structure.field.rotation(q)[-1, :, 0]
    np.testing.assert_allclose(tangent, [np.cos(slope), c * np.sin(slope), s * np.sin(slope)], atol=2e-6)


@pytest.mark.parametrize("angle", [0.3, 1.5])
def test_tip_moment(angle: float) -> None:
    """An arc of a circle; to fourth order the tip lies where the arc's Taylor polynomial ends, in any plane."""
    section, metal = Section.general(1.0, 1e-8, 1e-8), Material(1e-9, 1e8)
    arc = np.sin(angle) / angle - 1, (1 - np.cos(angle)) / angle
    ended = -(angle**2) / 6 + angle**4 / 120, angle / 2 - angle**3 / 24
    for kind, (short, across) in {"exact": arc, "fourth-order": ended}.items():
        for moment, way in (((0.0, 0.0, angle), (0.0, 1.0)), ((0.0, -0.6 * angle, 0.8 * angle), (0.6, 0.8))):
            beam = Beam(1.0, section, metal, loads=[Load(1.0, moment=moment)])
            tip = static(assemble(beam, Model(kind, 1, 2, 2))).tip
            np.testing.assert_allclose(tip, [short, way[1] * across, way[0] * across], atol=1e-9)
