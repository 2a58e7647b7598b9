"""Derivatives of a complete model's inertia at many states at once, and by complex steps through everything at one."""

import numpy as np
import pytest

import gbeam as gb
from gbeam.numerics import STEP

STRIP = gb.Section.rectangle(width=0.02, thickness=0.004)
ALUMINIUM = gb.Material(2700.0, 70e9, poissons_ratio=0.33)
ASIDE = gb.PointMass(0.2, 0.1, offset=(0.01, 0.02, 0.03), inertia=(1e-5, 2e-5, 3e-5))
CASES = {
    "plane": (gb.Beam(0.3, STRIP, ALUMINIUM), {"axial": 1, "y": 2}),
    "space": (gb.Beam(0.3, STRIP, ALUMINIUM), {"axial": 1, "y": 2, "z": 2}),
    "all strains, rotary inertia, a body beside the axis": (
        gb.Beam(0.3, STRIP, ALUMINIUM, [ASIDE]),
        {"axial": 1, "y": 2, "z": 2, "twist": 1, "shear_y": 1, "shear_z": 1},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_derivatives_at_many_states_are_those_by_complex_steps_at_one(name):
    beam, counts = CASES[name]
    inertia = gb.assemble(beam, "exact", **counts).equations.inertia
    rng, n = np.random.default_rng(0), sum(counts.values())
    motion = [rng.normal(size=(3, size)) * scale for size, scale in ((n, 0.1), (n, 1.0), (n, 10.0), *[(3, 1.0)] * 3)]
    for k, part in enumerate(motion):
        steps = 1j * STEP * np.eye(part.shape[1])
        moved = [*motion[:k], part + steps[:, None], *motion[k + 1 :]]
        together = np.concatenate(inertia.forces(*moved), axis=-1)
        for column, step in enumerate(steps):
            for state in range(3):
                one = [each[state] for each in motion]
                one[k] = one[k] + step
                alone = np.concatenate(inertia.forces(*one), axis=-1)
                scale = np.abs(alone.imag).max()
                np.testing.assert_allclose(together[column, state].imag, alone.imag, rtol=0, atol=1e-9 * scale)
                np.testing.assert_allclose(together[column, state].real, alone.real, rtol=1e-11)
