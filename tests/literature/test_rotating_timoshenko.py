"""Flapping of a turning Timoshenko beam: its differential equations, integrated from the root, beside gbeam's modes.

With m = L = EI = 1, F the force across the turning plane and M the moment, N(x) = Ω² (1 − x²)/2 the tension along the
sections' normals (Reissner's strains), w the deflection and φ the sections' angle:

    w' = φ + (F − N φ)/kGA    φ' = M    F' = −ω² w    M' = −ρI (ω² + Ω²) φ − (F − N w')
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import gbeam as gb

GYRATION, SHEAR = 1 / 30, 3.059  # √(I/A L²), and E/kG: k = 0.85 where Poisson's ratio is 0.3
RATIO = 0.3
BEAM = gb.Beam(
    1.0,
    gb.Section.general(
        1.0,
        GYRATION**2,
        GYRATION**2,
        torsion_constant=GYRATION**2,
        shear_coefficient_y=2 * (1 + RATIO) / SHEAR,
        shear_coefficient_z=2 * (1 + RATIO) / SHEAR,
    ),
    gb.Material(1.0, GYRATION**-2, poissons_ratio=RATIO),
)


def determinant(frequency: float, rate: float) -> float:
    """Determinant of force and moment at the tip, by those at the root."""

    def slopes(x: float, y: np.ndarray) -> np.ndarray:
        w, angle, force, moment = y.reshape(4, 2)
        tension = rate**2 * (1 - x**2) / 2
        slope = angle + (force - tension * angle) * GYRATION**2 * SHEAR
        turning = GYRATION**2 * (frequency**2 + rate**2) * angle
        return np.concatenate([slope, moment, -(frequency**2) * w, -turning - (force - tension * slope)])

    start = np.concatenate([np.zeros(4), [1.0, 0.0, 0.0, 1.0]])
    end = solve_ivp(slopes, (0.0, 1.0), start, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    return float(np.linalg.det(end[4:].reshape(2, 2)))


@pytest.mark.parametrize("rate", [0.0, 4.0, 10.0])
def test_three_flapping_frequencies_are_those_of_the_differential_equations(rate: float) -> None:
    structure = gb.assemble(BEAM, "exact", axial=0, y=0, z=9, shear_z=8)
    ours = 2 * np.pi * gb.modes(structure, gb.Hub(radius=0.0, rate=rate)).frequency[:3]
    for each in ours:
        theirs = brentq(determinant, 0.98 * each, 1.02 * each, args=(rate,), xtol=1e-10)
        assert each == pytest.approx(theirs, rel=5e-6)
    if rate == 0:  # Euler and Bernoulli's beam has 3.516, 22.03, 61.70
        assert ours[2] < 0.93 * 61.70
