"""Peaks of what happens between the samples of a file: a blow on a stop, and what sensors and the ground feel of it."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb

MASS, STIFFNESS, HEIGHT, GRAVITY = 1.0, 2e4, 0.05, 9.81


@cache
def blow() -> gb.Response:
    """A body that falls on a stop, by automatic steps, many more than the samples of its file."""
    slide = gb.Joint("prismatic", "box", axes=[(0, 0, 1)], initial=HEIGHT, stops=(0.0, 1.0), stop_stiffness=STIFFNESS)
    system = gb.System({"box": gb.RigidBody(MASS, (0.01,) * 3)}, {"slide": slide}, gravity=(0, 0, -GRAVITY))
    return gb.simulate(system, duration=0.3)


def test_the_ground_feels_all_of_a_blow() -> None:
    """m g + √(m² g² + m k v²), v² = 2 g h: the spring's force where it is pressed most."""
    response = blow()
    weight = MASS * GRAVITY
    force = weight + math.sqrt(weight**2 + MASS * STIFFNESS * 2 * GRAVITY * HEIGHT)
    peaks = response.maxima
    assert peaks is not None and response.steps > 4 * len(response.time)
    assert float(peaks.ground_force.size.value) == pytest.approx(force, rel=2e-4)
    pressed = force / STIFFNESS
    k = response.coordinates.index("slide.displacement")
    assert peaks.lowest[k] == pytest.approx(-pressed, rel=2e-4)
    assert peaks.highest[k] == pytest.approx(HEIGHT, rel=1e-6)
    assert peaks.acceleration[0] == pytest.approx(force / MASS, rel=2e-4)
    fastest = math.sqrt(2 * GRAVITY * HEIGHT + weight**2 / MASS / STIFFNESS)
    assert peaks.rate[k] == pytest.approx(fastest, rel=1e-3)
    assert response.largest[0] == pytest.approx(HEIGHT + pressed, rel=2e-4)
    # The samples lack some of it.
    sampled = np.abs(response.ground_force).max()
    assert sampled < float(peaks.ground_force.size.value)


def test_a_file_keeps_the_results_times_and_the_peaks_of_all_steps(tmp_path: Path) -> None:
    response = blow()
    stored = response.to_xarray()
    assert len(stored.time) == len(response.time) < response.steps + 1
    response.save(tmp_path / "result.nc")
    from gbeam.io import read_stored

    kept = read_stored(tmp_path / "result.nc").variables
    assert len(kept["time"]) == len(response.time)
    assert response.maxima is not None
    assert kept["ground_force_max"] == pytest.approx(float(response.maxima.ground_force.size.value), rel=1e-12)
