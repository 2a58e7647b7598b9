"""Peaks of responses between steps, the stress they carry, and the warnings that look at them."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from gbeam import (
    Beam,
    Flight,
    Hub,
    Material,
    Model,
    Response,
    Section,
    Sine,
    SmoothStep,
    Structure,
    assemble,
    constant,
    simulate,
    smoothed,
    static,
    trapezoid,
)
from gbeam.results import VectorPeaks

from ..specimens import hub_beam
from .helpers import LENGTH, strip

TOLERANCE = 1e-4
PULL = Flight(
    y=smoothed(trapezoid(30.0, jerk=900.0, start=0.15, hold=0.3), 0.06),
    z=smoothed(trapezoid(78.5, jerk=390.0, start=0.1, hold=0.3), 0.06),
)
MOTIONS: dict[str, tuple[Structure, Any, float]] = {
    "flight": (strip("FOAM", (1, 2, 2), 0.01), PULL, 1.0),
    "slew": (hub_beam("FOAM", 1, 3, 0), Hub(radius=0.5, rate=SmoothStep(3.0, 15.0)), 25.0),
    "free hub": (hub_beam("FOAM", 1, 3, 0), Hub(radius=0.5, inertia=200.0, torque=Sine(50.0, 10.0)), 12.0),
}


@cache
def found_and_finer(name: str) -> tuple[Response, Response]:
    """A response, and one of a quarter of its step."""
    structure, motion, duration = MOTIONS[name]
    response = simulate(structure, motion, duration=duration, tolerance=TOLERANCE, estimate=False)
    return response, simulate(structure, motion, duration=duration, step=response.step / 4, estimate=False)


def every(peaks: VectorPeaks, place: int = -1) -> np.ndarray:
    """Sizes of the components and of the vector at one place, (4,)."""
    return np.append(peaks.components.value[place], peaks.size.value[place])


@pytest.mark.parametrize("name", MOTIONS)
def test_peaks_are_those_of_a_quarter_of_the_step(name: str) -> None:
    """To a tenth of the tolerance; the samples of torques and slews are not."""
    answer, finer = found_and_finer(name)
    one, two = answer.peaks, finer.peaks
    assert one.displacement is not None and two.displacement is not None
    np.testing.assert_allclose(every(one.displacement), every(two.displacement), atol=0.1 * TOLERANCE * two.max_size)
    assert one.max_size == pytest.approx(two.max_size, rel=0.1 * TOLERANCE)
    assert one.time_of_max_size == pytest.approx(two.time_of_max_size, abs=answer.time[1] - answer.time[0])
    assert one.loads is not None and two.loads is not None
    moment = every(two.loads.moment, 0)
    np.testing.assert_allclose(every(one.loads.moment, 0), moment, atol=0.1 * TOLERANCE * moment.max())
    stress = [each.loads.stress.value[0] for each in (one, two) if each.loads is not None]
    assert stress[0] == pytest.approx(stress[1], rel=0.1 * TOLERANCE, nan_ok=True)  # a hub-beam has no fibres


def test_a_step_found_by_a_large_jump_is_checked() -> None:
    """Coarse steps do not resolve the higher modes: by the order alone the peak was promised three times too well."""
    answer, finer = found_and_finer("free hub")
    assert answer.peaks.loads is not None and finer.peaks.loads is not None
    one, two = (every(each.peaks.loads.moment, 0) for each in (answer, finer))
    np.testing.assert_allclose(one, two, atol=1e-5 * two.max())


@pytest.mark.parametrize("name", ["flight", "free hub"])
def test_peaks_of_loads_are_found_between_the_steps_kept(name: str) -> None:
    """Against all loads of the same steps, many of newmark's, sampled; the response keeps some of them only."""
    structure, motion, duration = MOTIONS[name]
    how = {"duration": duration, "integrator": "newmark", "estimate": False}
    kept = simulate(structure, motion, tolerance=1e-5, **how)
    whole = simulate(structure, motion, step=kept.step, **how)
    assert len(whole.time) > 2 * len(kept.time)
    assert kept.peaks.loads is not None and whole.loads is not None and kept.loads is not None
    for peaks, history, sparse in (
        (kept.peaks.loads.force, whole.loads.section_force, kept.loads.section_force),
        (kept.peaks.loads.moment, whole.loads.section_moment, kept.loads.section_moment),
    ):
        samples, few = (np.linalg.norm(each, axis=2).max(axis=0) for each in (history, sparse))
        rounding = 1e-12 * samples.max()  # at the tip there is nothing else
        assert (peaks.size.value >= samples - rounding).all() and (peaks.size.value >= few - rounding).all()
        np.testing.assert_allclose(peaks.size.value, samples, rtol=1e-3, atol=rounding)


def test_a_peak_between_samples_is_the_oscillators() -> None:
    """An undamped mode under a load that is suddenly constant swings to twice its rest, wherever the samples are."""
    structure = strip("FOAM", (0, 0, 1))
    rest = static(structure, acceleration=(0, 0, 1.0)).tip[2]
    step = 2 * np.pi / structure.rest[0][0] / 13
    shove = Flight(z=trapezoid(1.0, jerk=1e7, start=0.0, hold=10.0))
    response = simulate(structure, shove, duration=20 * step, step=step, integrator="gauss")
    assert np.abs(response.tip[:, 2]).max() < 0.99 * 2 * abs(rest)
    assert response.peaks.max_abs[2] == pytest.approx(2 * abs(rest), rel=2e-4)
    assert response.peaks.time_of_max[2] / step % 13 == pytest.approx(6.5, rel=2e-3)  # of one of two like peaks


def test_residual_vibration_is_measured_between_samples() -> None:
    structure = strip("FOAM", (0, 0, 1))
    rest, step = abs(static(structure, acceleration=(0, 0, 1.0)).tip[2]), 2 * np.pi / structure.rest[0][0] / 13
    shove = Flight(z=trapezoid(1.0, jerk=1e7, start=0.0, hold=10.0))
    response = simulate(structure, shove, duration=40 * step, step=step, integrator="gauss", residual_from=10.2 * step)
    late = response.time >= 10.2 * step
    assert np.ptp(response.tip[late, 2]) < 0.997 * 2 * rest
    assert response.peaks.residual_amplitude[2] == pytest.approx(rest, rel=5e-4)


def test_the_models_error_is_the_vectors() -> None:
    """Bent by 0.09 of the length in each of two directions: twice the square, and twice the error, of one."""
    beam = Beam(LENGTH, Section.circle(0.004), Material(2700.0, 7e10), damping_ratio=0.0)
    structure = assemble(beam, Model("FOAM", 0, 2, 2))
    along = static(structure, acceleration=(0, 0, 1.0)).tip[2] / LENGTH
    load = constant(0.09 / abs(along))
    alone, both = (
        simulate(structure, flight, duration=0.02, step=1e-3) for flight in (Flight(z=load), Flight(y=load, z=load))
    )
    assert both.peaks.max_size / LENGTH == pytest.approx(0.09 * np.sqrt(2), rel=0.01)
    errors = [each.errors.displacement.model for each in (alone, both)]
    assert errors == pytest.approx([0.8 * 0.09**2, 1.6 * 0.09**2], rel=0.1)  # a dead uniform load: 0.80 (v/L)²
    assert not any("the model" in each for each in alone.warnings)
    (warning,) = (each for each in both.warnings if "deflections are wrong" in each)
    assert "the model" in warning


def yielding(strength: float | None, acceleration: float) -> Response:
    """A strip pressed along its axis: N/A = ρ L a at the root."""
    beam = Beam(
        LENGTH, Section.rectangle(0.02, 0.004), Material(2700.0, 7e10, yield_strength=strength), damping_ratio=0.0
    )
    structure = assemble(beam, Model("FOAM", 1, 0, 1), [0.15])
    return simulate(structure, Flight(x=constant(acceleration)), duration=0.01, step=1e-3)


def test_compression_counts_as_stress_and_against_yield() -> None:
    """1000 g along the beam: 7.9 MPa at the root, half of it in the middle."""
    a = 9806.65
    stress = 2700.0 * LENGTH * a
    sound, crushed = yielding(1.01 * stress, a), yielding(0.99 * stress, a)
    assert sound.loads is not None and sound.peaks.loads is not None
    np.testing.assert_allclose(sound.loads.stress_compression[0], [-stress, -stress / 2, 0], atol=1e-5 * stress)
    np.testing.assert_allclose(sound.loads.stress[0], [stress, stress / 2, 0], atol=1e-5 * stress)
    assert sound.peaks.loads.stress.value[0] == pytest.approx(stress, rel=1e-5)
    assert sound.peaks.loads.compression.value[0] == pytest.approx(-stress, rel=1e-5)
    assert sound.loads.margin is not None
    np.testing.assert_allclose(sound.loads.margin[0, :2], [0.01, 1.02], atol=1e-4)
    assert not any("yield" in each for each in sound.warnings)
    (warning,) = (each for each in crushed.warnings if "yield" in each)
    assert "above the yield strength" in warning and f"{1e-6 * stress:.4g} MPa at 0 m" in warning
    without = yielding(None, a)
    assert without.loads is not None and without.loads.margin is None
    assert not any("yield" in each for each in without.warnings)
