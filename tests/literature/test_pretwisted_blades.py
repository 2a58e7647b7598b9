"""A blade that is twisted evenly at rest: exact transfer matrix of its linear equations beside gbeam's modes.

In axes that turn with the sections by k = β e₁/L, with f and m what the sections carry and γ, κ their strains,

    u' = γ + θ × e₁ − k × u    θ' = κ − k × θ    f' = −ω² ρA u − k × f    m' = −ω² ρJ θ − e₁ × f − k × m

has constant coefficients. The blade is Carnegie's (1959): 152.4 by 25.4 by 1.727 mm of steel, twisted by 45°.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import gbeam as gb

LENGTH, TURN = 0.1524, np.pi / 4
SECTION, STEEL = gb.Section.rectangle(0.0254, 0.001727), gb.Material(7857.6, 206.85e9, poissons_ratio=0.3)
STRAIGHT = gb.Beam(LENGTH, SECTION, STEEL)
BLADE = gb.Beam(LENGTH, SECTION, STEEL, line=gb.Line.of_pieces([LENGTH], twist=[TURN]))


def cross(vector: np.ndarray) -> np.ndarray:
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def determinant(frequency: float) -> float:
    """Determinant of force and moment at the tip, by those at the root, at a frequency, Hz; over its bending's."""
    section, square = SECTION.at(0.0), (2 * np.pi * frequency) ** 2
    stiffness = np.array([float(each) for each in STRAIGHT.stiffnesses(np.zeros(()))])
    along, turn = cross([1.0, 0.0, 0.0]), cross([TURN / LENGTH, 0.0, 0.0])
    none, line = np.zeros((3, 3)), STEEL.density * float(section.area)
    inertia = STEEL.density * np.diag([section.inertia_y + section.inertia_z, section.inertia_y, section.inertia_z])
    matrix = np.block(
        [
            [-turn, -along, np.diag(1 / stiffness[:3]), none],
            [none, -turn, none, np.diag(1 / stiffness[3:])],
            [-square * line * np.eye(3), none, -turn, none],
            [none, -square * inertia, -along, -turn],
        ]
    )
    return float(np.linalg.slogdet(expm(matrix * LENGTH)[6:, 6:])[0])


@pytest.mark.parametrize("model", ["exact", "FOAM"])
def test_five_frequencies_are_those_of_the_transfer_matrix(model: str) -> None:
    shapes = {"axial": 1, "y": 9, "z": 9, "twist": 4, "shear_y": 7, "shear_z": 7}
    ours = gb.modes(gb.assemble(BLADE, model, **shapes), errors=False).frequency[:5]
    for each in ours:
        assert each == pytest.approx(brentq(determinant, 0.998 * each, 1.002 * each, xtol=1e-9), rel=1e-5)
    straight = gb.modes(gb.assemble(STRAIGHT, "FOAM", y=6, z=6), errors=False).frequency
    assert ours[1] < 0.9 * straight[1]  # chord and flap have come together
