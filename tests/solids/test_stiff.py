"""A stiff specimen on a slow flight: how many automatic steps follow it."""

from __future__ import annotations

import numpy as np

import gbeam as gb
from gbeam.analysis import begun, prepared, tries


def box() -> gb.Structure:
    model = gb.ImportedModel(0.5 * np.eye(3), np.diag([2e9, 4.4e7, 4.4e7]), nodes=[(0.1, 0, 0)])
    return model.reduced(modes=3, damping_ratio=0.02)


def test_of_a_stiff_specimen_that_hardly_vibrates_few_steps_are_enough() -> None:
    """Twenty steps to a period of 1493 Hz would be 90,000; the tip follows the load statically."""
    flight = gb.Flight(z=gb.trapezoid(50.0, jerk=50.0, start=0.1, hold=0.1))
    followed = gb.simulate(box(), flight, duration=3.0)
    assert followed.steps == 5_000
    still = gb.static(box(), acceleration=(0, 0, 1.0)).tip[2]
    load = np.asarray(flight.acceleration.derivatives(followed.time, 0)[0])[..., 2]
    away = np.abs(followed.tip[:, 2] - still * load).max() / np.abs(followed.tip).max()
    assert away < max(followed.errors.displacement.step, 1e-4) < 0.01 / 3
    system = gb.System({"box": box()}, {"foot": gb.Joint("fixed", "box")})
    hung = gb.simulate(system, flight, duration=3.0)
    assert hung.steps == 5_000 and hung.errors.displacement.step < 0.01 / 3
    moved = hung.place[:, hung.points.index("box.tip"), 2]
    assert np.abs(moved - followed.tip[:, 2]).max() < 1e-3 * np.abs(followed.tip).max()


def test_few_steps_pass_no_pulse_unseen() -> None:
    """In an hour 5,000 steps are 720 ms and 40,000 90; a pulse of 3 was not seen, and the error stated of the rest."""
    settings = gb.ResponseSettings(duration=3600.0)
    pulse = gb.Sine(500.0, duration=0.003, start=50.0)
    for load, count in ((gb.constant(10.0), 4), (gb.Sum((gb.constant(10.0), pulse)), 1)):
        subject = prepared(box(), gb.Flight(z=load), settings)
        assert len(tries(subject, settings, begun(subject, settings, 0.0))) == count
