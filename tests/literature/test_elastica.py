"""Large static deflection: the elastica under a dead tip force, that of a heavy tip mass in acceleration."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from gbeam import Beam, Material, Model, PointMass, Section, Structure, assemble, solve_equilibrium
from gbeam.motion import Base
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
