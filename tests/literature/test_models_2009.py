"""TLAM aside, which model is nearest to the truth? The 24 drives of the 2009 hub-beam, against the exact model.

Erratum 16: the complete kinetic energy makes CFOAM worse than FOAM, not better: it keeps fourth-order inertial
softening without the fourth-order hardening of bending and foreshortening, which nearly cancel it in the real beam.
References: an elastica in tangent angles by Galerkin's method, computed outside this project.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from gbeam import Hub, ResponseSettings, Sine, SmoothStep
from gbeam.analysis import pose, prepared
from validation.published.hubbeam2009 import HUB_INERTIA, HUB_RADIUS, LENGTH
from validation.published.tables import SLEWS, TORQUES

from .test_hubbeam2009 import structure

# A step for all models: its error, of 5e-4 and less, is common to them and drops out of their differences.
STEP = 0.02  # s
EXACT, SHAPES, BENDING = (2, 5), (5, 5), (0, 5)  # BENDING: the Lagrangian form of SFOAM
PEAK, RESIDUAL = 0.025, 0.2  # %: the references are printed to 0.01 % of the peak and 0.1 % of the residual

# Not in the list of references, and so against gbeam's exact model only.
FAST = [(8.0, 0.0), (8.0, 0.1), (8.0, 0.5)]  # rad/s
CASES = [("slew", *key) for key in [*SLEWS, *FAST]] + [("torque", *key) for key in TORQUES]


@cache
def tip(kind: str, counts: tuple[int, int], drive: str, level: float, mt: float) -> np.ndarray:
    """Displacement along y, m, from rest to 20 s after the drive has ended, every STEP."""
    beam = structure(kind, *counts, mt)
    motion = (
        Hub(radius=HUB_RADIUS, rate=SmoothStep(level, 30.0))
        if drive == "slew"
        else Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA, torque=Sine(level, 10.0))
    )
    settings = ResponseSettings(50.0 if drive == "slew" else 20.0, step=STEP, integrator="newmark")
    posed = pose(prepared(beam, motion, settings), settings, STEP)
    answer = posed.integrated(STEP)
    assert answer.converged
    return beam.displacement(answer.q[:, posed.columns("beam")])[:, -1, 1]


def sizes(drive: str, history: np.ndarray) -> tuple[float, float]:
    """Peak, and half peak-to-peak after the drive has ended, m."""
    after = history[round((30.0 if drive == "slew" else 10.0) / STEP) :]
    return float(np.abs(history).max()), float(np.ptp(after) / 2)


# Cases that lie between others of the same drive.
BETWEEN = [
    *[("slew", level, 0.1) for level in (2.8, 8.0)],
    *[("slew", 3.0, mass) for mass in (0.0, 0.1, 0.5)],
    *[("torque", level, 0.1) for level in (50.0, 200.0)],
    *[("torque", 100.0, mass) for mass in (0.0, 0.1, 0.5)],
]
QUICK = [("slew", 5.0, 0.1), ("slew", 8.0, 0.5)]


def marks(case: tuple[str, float, float]) -> Any:
    """Marks of a case."""
    if case in BETWEEN:
        return pytest.mark.thorough
    return () if case in QUICK else pytest.mark.slow


@pytest.mark.parametrize(("drive", "level", "mt"), [pytest.param(*case, marks=marks(case)) for case in CASES])
def test_foam_is_nearer_to_exact_than_cfoam(drive: str, level: float, mt: float) -> None:
    exact = tip("exact", EXACT, drive, level, mt)
    peak, residual = sizes(drive, exact)

    def error(kind: str, counts: tuple[int, int]) -> tuple[float, float, float]:
        """Errors of the peak, of the residual, and the largest at any time, %."""
        history = tip(kind, counts, drive, level, mt)
        p, r = sizes(drive, history)
        return 100 * (p / peak - 1), 100 * (r / residual - 1), float(100 * np.abs(history - exact).max() / peak)

    foam, cfoam, bending = error("FOAM", SHAPES), error("CFOAM", SHAPES), error("FOAM", BENDING)
    fourth = error("fourth-order", EXACT)
    assert fourth[2] < min(foam[2] / 3, cfoam[2] / 37)
    assert abs(fourth[1]) < min(abs(foam[1]), abs(cfoam[1]))
    assert 0.03 < abs(fourth[0]) / 100 / (peak / LENGTH) ** 4 < 0.19
    assert foam[2] < cfoam[2]
    assert abs(foam[1]) < abs(cfoam[1])
    # The one exception: at 200 N m without a mass CFOAM's peak is right by 0.53 %, FOAM's by 0.58 %.
    assert (abs(foam[0]) < abs(cfoam[0])) == ((drive, level, mt) != ("torque", 200.0, 0.0))
    assert bending[0] == pytest.approx(foam[0], abs=0.012)
    known = {"slew": SLEWS, "torque": TORQUES}[drive].get((level, mt))
    if known is None:
        return
    assert peak == pytest.approx(known[0], rel=1e-3)
    assert residual == pytest.approx(known[1], rel=0.025)
    assert foam[0] == pytest.approx(known[2], abs=PEAK)
    assert cfoam[0] == pytest.approx(known[4], abs=PEAK)
    assert foam[1] == pytest.approx(known[3], abs=RESIDUAL)
    assert cfoam[1] == pytest.approx(known[5], abs=RESIDUAL, rel=0.03)
