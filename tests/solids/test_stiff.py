"""A stiff specimen on a slow flight: what automatic steps cost, and the scheme that is advised in their place."""

from __future__ import annotations

import numpy as np

import gbeam as gb


def test_a_stiff_specimen_is_told_a_scheme_that_damps_what_is_not_excited() -> None:
    """A hundredth of the steps, and the error is less than it states."""
    model = gb.ImportedModel(0.5 * np.eye(3), np.diag([2e9, 4.4e7, 4.4e7]), nodes=[(0.1, 0, 0)])
    box = model.reduced(modes=3, damping_ratio=0.02)
    flight = gb.Flight(z=gb.trapezoid(50.0, jerk=500.0, start=0.1, hold=0.1))
    followed = gb.simulate(box, flight, duration=1.0)
    (said,) = [each for each in followed.warnings if "far below the lowest frequency, 1493 Hz" in each]
    assert "rho_inf = 0" in said and followed.steps > 50_000
    how = {"step": 1e-3, "integrator": "generalized-alpha", "parameters": {"rho_inf": 0.0}}
    advised = gb.simulate(box, flight, duration=1.0, **how)
    assert advised.steps == 1000 and not any("far below" in each for each in advised.warnings)
    there = np.interp(advised.time, followed.time, followed.displacement[:, -1, 2])
    away = np.abs(advised.displacement[:, -1, 2] - there).max() / np.abs(there).max()
    assert away < advised.error_estimate < 0.05
    still = gb.static(box, acceleration=(0, 0, 50.0)).tip[2]
    np.testing.assert_allclose(np.abs(advised.displacement[:, -1, 2]).max(), abs(still), rtol=0.05)
