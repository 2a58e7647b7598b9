"""Normal stress over sections, against the stress at every point of their boundaries."""

from __future__ import annotations

import numpy as np
import pytest

from gbeam import Section
from gbeam.structure.stress import extreme_stresses, worst_fibre

ANGLE = np.linspace(0, 2 * np.pi, 7201)
ROUND = np.cos(ANGLE), np.sin(ANGLE)
CORNERS = np.array([1, 1, -1, -1]), np.array([1, -1, 1, -1])
SECTIONS = {
    "rectangle": (Section.rectangle(0.02, 0.004), 0.01, 0.002, CORNERS),
    "circle": (Section.circle(0.01), 0.005, 0.005, ROUND),
    "tube": (Section.tube(0.012, 0.001), 0.006, 0.006, ROUND),
    "general": (
        Section.general(8e-5, 1e-10, 2e-9, extreme_fibre_y=0.011, extreme_fibre_z=0.003),
        0.011,
        0.003,
        CORNERS,
    ),
}


@pytest.mark.parametrize("shape", SECTIONS)
def test_extremes_are_those_of_the_boundary(shape: str) -> None:
    section, c_y, c_z, (y, z) = SECTIONS[shape]
    values = section.at(np.zeros(1))
    rng = np.random.default_rng(2)
    force, moment = rng.normal(size=(50, 1, 3)) * 300, rng.normal(size=(50, 1, 3))
    bent = moment[:, 0, 1, None] * z * c_z / values.inertia_y - moment[:, 0, 2, None] * y * c_y / values.inertia_z
    everywhere = force[:, 0, 0, None] / values.area + bent
    tension, compression = extreme_stresses(values, force, moment)
    np.testing.assert_allclose(tension[:, 0], everywhere.max(axis=1), atol=1e-6 * tension.max())
    np.testing.assert_allclose(compression[:, 0], everywhere.min(axis=1), atol=1e-6 * tension.max())


def test_a_round_section_bent_both_ways_is_bent_once() -> None:
    """√2 of the stress of one moment, and not twice it."""
    values = Section.circle(0.01).at(np.zeros(1))
    one, both = (extreme_stresses(values, np.zeros((1, 3)), np.array([[0, 1.25, m]]))[0] for m in (0.0, 1.25))
    np.testing.assert_allclose(both, np.sqrt(2) * one)
    np.testing.assert_allclose(one, 32 * 1.25 / (np.pi * 0.01**3))


@pytest.mark.parametrize("shape", ["rectangle", "tube"])
def test_the_worst_fibre_ranges_as_far_as_any(shape: str) -> None:
    section, c_y, c_z, (y, z) = SECTIONS[shape]
    values = section.at(np.zeros(2))
    rng = np.random.default_rng(3)
    force, moment = rng.normal(size=(40, 2, 3)) * 100, rng.normal(size=(40, 2, 3))
    bent = moment[:, 1, 1, None] * z * c_z / values.inertia_y[1] - moment[:, 1, 2, None] * y * c_y / values.inertia_z[1]
    ranges = np.ptp(force[:, 1, 0, None] / values.area[1] + bent, axis=0)
    found = np.ptp(worst_fibre(values, 1, force, moment))
    assert 0.99 * ranges.max() <= found <= ranges.max() * (1 + 1e-9)
