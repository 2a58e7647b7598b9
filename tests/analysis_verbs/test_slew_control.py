"""The worked example holds what it prints, on the exact model."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "slew_control.py"


@pytest.mark.slow
def test_the_designs_hold_on_the_exact_model():
    measured = runpy.run_path(str(EXAMPLE))["main"]()
    assert measured["ZVD residual"] < 0.02 * measured["bang-bang residual"]
    assert measured["LQR residual"] < 1e-3
    assert measured["LQR error"] < 5e-3
