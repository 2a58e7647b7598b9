"""Acceleration at points of solids and matrices, as sensors there read it, and control points of a comparison."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import gbeam as gb

from ..analysis.helpers import with_body
from .test_matrices import frame


@cache
def strip() -> gb.Structure:
    m, k, nodes = frame(8)
    model = gb.ImportedModel(m, k, nodes)
    return model.reduced(modes=3, damping_ratio=0.01, clamp=[0], points={"middle": 4, "tip": 8})


@pytest.mark.parametrize("ratio", [0.2, 1.0, 3.0])
def test_a_sensor_is_an_oscillator(ratio: float) -> None:
    """Its amplitude in a harmonic acceleration is that of the textbook; it reads what it settled in."""
    sensor = gb.Sensor(frequency=100.0, damping_ratio=0.7)
    step = 1e-4
    time = np.arange(0, 0.5, step)
    felt = np.zeros((len(time), 3))
    felt[:, 2] = 9.81
    felt[:, 0] = np.sin(2 * np.pi * 100.0 * ratio * time)
    read = sensor.reads(felt, step)
    late = time > 0.2
    amplitude = 1 / np.hypot(1 - ratio**2, 2 * 0.7 * ratio)
    assert np.abs(read[late, 0]).max() == pytest.approx(amplitude, rel=5e-3)
    np.testing.assert_allclose(read[:, 2], 9.81, rtol=1e-12)


def test_axes_and_leaks_of_a_sensor() -> None:
    felt = np.tile([1.0, 2.0, 3.0], (4, 1))
    np.testing.assert_allclose(gb.Sensor(turn=(0, 0, np.pi / 2)).reads(felt, 1e-3)[0], [2, -1, 3], atol=1e-12)
    leaks = np.array([[1, 0, 0.02], [0, 1, 0], [0, 0, 1]])
    np.testing.assert_allclose(gb.Sensor(sensitivity=leaks).reads(felt, 1e-3)[0], [1.06, 2, 3])


def test_points_of_matrices_feel_the_base_and_their_own_motion() -> None:
    """a + α × r + ω × (ω × r) + 2 ω × ṙ + r̈, the last two by differences of the displacements."""
    rate = gb.SmoothStep(level=6.0, duration=0.2)
    hub = gb.Hub(radius=0.4, rate=rate, setting_angle=np.pi / 2)
    step = 1e-4
    response = gb.simulate(strip(), hub, duration=0.3, step=step, integrator="gauss", estimate=False)
    assert response.body.points == ("middle", "tip")
    assert response.body.acceleration is not None
    read = response.body.acceleration[:, 0]
    place = np.array([0.25, 0, 0]) + response.body.at("middle")
    speed, push = np.gradient(place, step, axis=0), np.gradient(np.gradient(place, step, axis=0), step, axis=0)
    w, alpha = response.base.w_WB_B, response.base.alpha_WB_B
    whole = response.base.a_WO_B + np.cross(alpha, place) + np.cross(w, np.cross(w, place))
    whole = whole + 2 * np.cross(w, speed) + push
    inside = slice(50, -50)
    np.testing.assert_allclose(read[inside], whole[inside], atol=2e-3 * np.abs(whole).max())
    filtered = response.reading_at("middle", gb.Sensor(frequency=500.0))
    assert filtered.shape == read.shape and not np.allclose(filtered, read)
    with pytest.raises(gb.InputError, match=r"frequency is 20000 Hz, with samples 0.0001 s apart; simulate in steps"):
        response.reading_at("tip", gb.Sensor(frequency=20000.0))
    with pytest.raises(gb.InputError, match=r"point is 'nose'; choose from beam\.middle, beam\.tip"):
        response.reading_at("nose")


@cache
def pair() -> tuple[gb.Response, gb.Response]:
    load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=100.0, start=0.5, hold=0.5)))
    turn = gb.Flight(z=load)
    machine = gb.Centrifuge(turn, arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 3.0))
    options: dict[str, Any] = {"duration": 3.0, "step": 0.002, "estimate": False}
    return gb.simulate(strip(), turn, **options), gb.simulate(strip(), machine, **options)


def test_spectra_of_control_points_are_their_weighted_mean() -> None:
    """Of a structure without sections too, which had none."""
    tip = gb.compare(*pair(), accept={"srs": 3.0})
    (judged,) = tip.criteria
    assert judged.name == "srs" and np.isfinite(judged.value) and tip.shock is not None
    single = [gb.compare(*pair(), control={name: 1.0}).shock for name in ("middle", "tip")]
    both = gb.compare(*pair(), control={"middle": 3.0, "tip": 1.0}).shock
    assert both is not None and both.control == "middle (75 %), tip (25 %)"
    np.testing.assert_allclose(both.centrifuge, 0.75 * single[0].centrifuge + 0.25 * single[1].centrifuge)
    np.testing.assert_allclose(single[1].flight, tip.shock.flight)
    sensor = gb.Sensor(turn=(0.5, 0.0, 0.0), frequency=40.0, sensitivity=[[1, 0.02, 0], [0, 1, 0], [0.05, 0, 1]])
    weights = {"middle": 3.0, "tip": 1.0}
    by_sensor = gb.compare(*pair(), control=weights, sensors={"middle": sensor, "tip": sensor}).shock
    heard = [
        with_body(each, acceleration=np.stack([each.reading_at(name, sensor) for name in each.body.points], axis=1))
        for each in pair()
    ]
    wanted = gb.compare(*heard, control=weights).shock
    assert by_sensor.control == "middle (75 %, as its sensor reads), tip (25 %, as its sensor reads)"
    np.testing.assert_array_equal(by_sensor.flight, wanted.flight)
    np.testing.assert_array_equal(by_sensor.centrifuge, wanted.centrifuge)
    assert not np.allclose(wanted.flight, both.flight, rtol=0.1)
    one = gb.compare(*pair(), sensors={"tip": gb.Sensor()}).shock
    assert one.control == "the tip (as its sensor reads)"
    # It turns with the tip, by 7 mrad: along its x axis it reads some of the load along z.
    np.testing.assert_allclose(one.flight[:, 2], tip.shock.flight[:, 2], rtol=1e-4)
    assert 5e-3 < (one.flight[:, 0] / tip.shock.flight[:, 2]).max() < 2e-2
    for read, words in (
        ({"meddle": sensor}, "sensors.meddle.point is 'meddle'|sensors.meddle.* 'meddle'"),
        ({"tip": gb.Sensor(frequency=900.0)}, "sensors.tip.frequency is 900 Hz, with samples 0.002 s apart"),
    ):
        with pytest.raises(gb.InputError, match=words):
            gb.compare(*pair(), sensors=read)
    for control, words in (({"nose": 1.0}, "control is 'nose'; choose from middle, tip"), ({"tip": 0.0}, "is 0")):
        with pytest.raises(gb.InputError, match=words):
            gb.compare(*pair(), control=control)
