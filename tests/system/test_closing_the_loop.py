"""The worked example points the exact model, through delay and limit."""

from __future__ import annotations

import runpy
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb

EXAMPLE = Path(__file__).parents[2] / "examples" / "closing_the_loop.py"


def test_the_regulator_holds_on_the_exact_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """It points as docs/howto/closing_the_loop.md says; errors of a plant in its loop are in test_errors.py."""
    monkeypatch.setattr(gb, "simulate", partial(gb.simulate, estimate=False))
    response = runpy.run_path(str(EXAMPLE))["main"]()
    angle, loop = response.coordinate("axis.angle"), response.loop
    assert angle[len(angle) // 2] == pytest.approx(2.97e-3, abs=5e-6) and abs(angle[-1]) < 1e-5
    assert np.abs(loop.applied).max() == 20.0 and loop.saturated[0] == pytest.approx(0.314, abs=2e-3)
