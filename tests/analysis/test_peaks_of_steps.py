"""Peaks of a structure's loads between the samples of its results."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb


def test_a_ring_that_dies_out_between_two_samples_is_seen() -> None:
    """A rod whose base is suddenly pushed along: its root force overshoots within a sample, and no sample is near."""
    section = gb.Section.rectangle(width=0.02, thickness=0.004)
    beam = gb.Beam(1.0, section, gb.Material(2700, 70e9), damping_ratio=0.1)
    structure = gb.assemble(beam, "TLAM", axial=2, y=0, z=1)
    flight = gb.Flight(x=gb.SmoothStep(500.0, 1e-7, start=0.4008))
    how = {"duration": 1.2, "integrator": "gauss"}
    response = gb.simulate(structure, flight, tolerance=0.03, **how)
    every = gb.simulate(structure, flight, step=response.step, estimate=False, **how)
    assert response.steps > 8 * (len(response.time) - 1) and every.steps == response.steps
    assert response.peaks.loads is not None and every.peaks.loads is not None
    largest, truth = (float(run.peaks.loads.root_force.size.value) for run in (response, every))
    assert largest == pytest.approx(truth, rel=1e-9)
    # One damped shape overshoots its static answer by exp(−πζ/√(1 − ζ²)); the samples show less of it.
    static = np.abs(every.loads.root_force[-1, 0])
    ratio = 0.1
    assert truth > static * (1 + 0.5 * np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)))
    assert np.abs(response.loads.root_force[:, 0]).max() < 0.7 * truth
