"""The worked example points the exact model, through delay and limit."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np

EXAMPLE = Path(__file__).parents[2] / "examples" / "closing_the_loop.py"


def test_the_regulator_holds_on_the_exact_model() -> None:
    response = runpy.run_path(str(EXAMPLE))["main"]()
    angle, loop = response.coordinate("axis.angle"), response.loop
    assert abs(angle[len(angle) // 2]) < 5e-3 and abs(angle[-1]) < 1e-5
    assert np.abs(loop.applied).max() == 20.0 and 0.2 < loop.saturated[0] < 0.4
    assert response.errors.place.slender < 1e-4
