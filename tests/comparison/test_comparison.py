"""The comparison of two responses: bounds of theory, separation of trend and vibration, spectra, the verdict."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.signal
from scipy.linalg import expm

from gbeam import Comparison, Flight, InputError, Joint, SmoothStep, System, compare, simulate, tabulated
from gbeam.numerics import displacement, largest_oscillator_acceleration, low_pass, oscillator_acceleration
from gbeam.report import comparison_lines as lines

from ..analysis.helpers import with_body

M, L, EI = 2700 * 0.02 * 0.004, 0.3, 70e9 * 0.02 * 0.004**3 / 12


@pytest.fixture(scope="module")
def pair(structure: Any, flight: Any, spin: Any, settings: Any) -> tuple[Any, Any]:
    return simulate(structure, flight, settings, name="flight"), simulate(structure, spin(), settings, name="arm")


@pytest.fixture(scope="module")
def compared(pair: tuple[Any, Any]) -> Comparison:
    return compare(*pair)


@pytest.mark.parametrize(("at", "advised"), [(0.15, True), (0.2, False), (0.218, False), (0.22, False), (0.24, True)])
def test_what_is_placed_is_not_to_be_placed_again(compared: Comparison, at: float, advised: bool) -> None:
    assert compared.load_difference is not None
    moved = replace(compared, load_difference=replace(compared.load_difference, control_point=at))
    assert ("gbeam place" in " ".join(lines(moved))) is advised
    small = replace(moved, peak_flight=1000 * moved.peak_flight)
    assert "gbeam place" not in " ".join(lines(small))


def test_bounds_of_the_loads_difference_are_those_of_a_uniform_cantilever(compared: Comparison) -> None:
    load_difference = compared.load_difference
    assert load_difference is not None and load_difference.control_point == 0.15 and load_difference.length == L
    gradient = load_difference.max_gradient[2]
    np.testing.assert_allclose(load_difference.force_bound[2], 0, atol=1e-12)
    np.testing.assert_allclose(load_difference.moment_bound[2], M * L**3 * abs(1 / 3 - 1 / 4) * gradient, rtol=1e-9)
    np.testing.assert_allclose(
        load_difference.tip_bound[2], M * L**5 / EI * abs(11 / 120 - 1 / 16) * gradient, rtol=2e-3
    )
    np.testing.assert_allclose(load_difference.tip_envelope.max(axis=0), load_difference.tip_bound)
    assert load_difference.max_acceleration[2] == pytest.approx(0.15 * gradient)
    assert load_difference.best == pytest.approx((2 / 3 * L, 11 / 15 * L), rel=2e-3)
    np.testing.assert_allclose(
        load_difference.field(np.array([0.15, 0.3]))[:, :, 2].T,
        [0 * load_difference.gradient[:, 2], 0.15 * load_difference.gradient[:, 2]],
    )


def test_plateau_vibration_of_the_corner(compared: Comparison) -> None:
    """0.0836 mm at mid-span after 4 g/s, smoothed over 59.6 ms; in flight 0.00507 mm: docs/theory.md, section 9."""
    late = compared.time > 1.45  # clear of the corner's own spectrum, and of the end
    late &= compared.time < 1.93
    assert compared.stations is not None
    # The run starts on the ramp without its speed, and so with a kink's vibration of its own, 0.00507 mm.
    assert np.abs(compared.stations.vibration_centrifuge[late, 2]).max() == pytest.approx(0.0836e-3, abs=0.006e-3)
    assert np.abs(compared.stations.vibration_flight[late, 2]).max() < 0.0103e-3


def test_statistics_root_and_verdict(compared: Comparison, pair: tuple[Any, Any]) -> None:
    flight, _ = pair
    assert compared.stations is not None and compared.root is not None
    np.testing.assert_allclose(compared.stations.difference.peak[-1], compared.max_difference)
    np.testing.assert_allclose(compared.stations.flight.peak[-1], compared.peak_flight)
    moment = np.abs(flight.loads.root_moment[:, 1]).max()
    assert compared.root.moment_flight[1] == pytest.approx(moment, rel=1e-3)
    assert moment == pytest.approx(M * L**2 / 2 * 98.0665, rel=5e-3)
    assert compared.root.stress_flight == pytest.approx(
        6 * compared.root.moment_flight[1] / (0.02 * 0.004**2), rel=1e-6
    )
    assert 0 < compared.root.moment_agreement < 0.08
    pair_of = compared.peaks
    assert pair_of["root_moment"].flight == pytest.approx(moment, rel=1e-4)
    assert pair_of["stress"].flight == pytest.approx(compared.root.stress_flight, rel=1e-3)
    assert pair_of["root_force"].flight == pytest.approx(M * L * 98.0665, rel=5e-3)
    # The corner's vibration, 0.0836 mm on 2.88 mm, and the load's difference on top.
    assert 1.02 < pair_of["tip"].ratio < 1.1 and "above the flight's" in compared.findings[-1]
    (peak,) = compared.accounting.peaks
    assert peak.load == pytest.approx(98.0665) and peak.error < 1e-3 and compared.accounting.followed_share == 1
    assert compared.verdict.endswith(", followed 100 % of the time")
    assert any(each.startswith("Peaks: 1 of 1 reproduced; ") for each in compared.findings)


def test_shock_and_damage_are_limited(compared: Comparison) -> None:
    """The corner's vibration rides on the machine's spectra: at the first mode along z, which the flight has not."""
    assert compared.shock is not None and compared.fatigue is not None
    most = max(compared.shock.extremes, key=lambda each: each.ratio)
    z = compared.shock.centrifuge[:, 2] / compared.shock.flight[:, 2]
    assert most.ratio >= z.max() > 1.02 and compared.figures["srs"] in (most.ratio, compared.shock.extremes[1].ratio)
    ratio = compared.fatigue.damage_ratio
    for name, value in {"srs": most.ratio, "damage": ratio}.items():
        near, far = (replace(compared, accept={name: (1 / limit, limit)}) for limit in (0.99 * value, 1.01 * value))
        assert (near.accepted, far.accepted) == (False, True) and near.criteria[0].value == pytest.approx(value)
    assert f"damage {ratio:.3g} of the root (limit 0.5 to 2)" in "\n".join(
        lines(replace(compared, accept={"damage": 2.0}))
    )


def test_root_history(compared: Comparison, pair: tuple[Any, Any]) -> None:
    assert compared.root is not None
    history = compared.root.history
    np.testing.assert_array_equal(history.moment_centrifuge, pair[1].loads.section_moment[:, 0])
    np.testing.assert_allclose(np.abs(history.force_flight).max(axis=0), compared.root.force_flight, rtol=1e-12)
    assert compared.root.main == 1


def test_a_response_without_a_name_goes_by_its_environment(pair: tuple[Any, Any]) -> None:
    flight, arm = (replace(each, name="") for each in pair)
    compared = compare(flight, arm)
    assert (compared.flight, compared.centrifuge) == ("flight", "centrifuge")
    assert str(compared).startswith("No limits set for a part of the flight: largest load 11 g (flight 10 g), ")
    assert "100 % of the time from 0.5 to 2 of 2 s, the part that was run, (no" in str(compared)
    assert compare(flight, flight).centrifuge == "the second flight"


def test_a_flight_at_another_level_is_the_flight_of_so_many_times_the_load(
    structure: Any, flight: Any, settings: Any, pair: tuple[Any, Any]
) -> None:
    table = flight.acceleration.parts[2]
    larger = Flight(z=tabulated(table.times, 1.25 * table.values))
    scaled, other = (
        simulate(structure, each, settings, name="flight")
        for each in (Flight(acceleration=flight.acceleration, scale=1.25), larger)
    )
    np.testing.assert_allclose(scaled.tip, other.tip, rtol=1e-9, atol=1e-12)
    assert (scaled.scale, other.scale, pair[0].scale) == (1.25, None, None)
    verdict = compare(scaled, pair[1]).verdict
    assert (
        verdict.startswith("No limits set for a part of the flight × 1.25: largest load ")
        and "(flight 12.5 g)" in verdict
    )
    assert "(flight 10 g)" in compare(*pair).verdict and "×" not in compare(*pair).verdict


def test_what_does_not_agree_says_so(pair: tuple[Any, Any]) -> None:
    flight, arm = pair

    def scaled(response: Any, factor: float) -> Any:
        of = response.peaks
        moved = {"max_abs": factor * of.max_abs, "max_size": factor * of.max_size, "displacement": None}
        return with_body(response, displacement=factor * response.displacement, peaks=replace(of, **moved))

    nine = compare(flight, scaled(arm, 9.0))
    tip = nine.peaks["tip"]
    assert tip.machine == pytest.approx(9 * compare(flight, arm).peaks["tip"].machine)
    times = (
        f"Tip: {1e3 * tip.machine:.4g} mm at 1.24 s, 9.6 times the flight's {1e3 * tip.flight:.4g} mm (no limit set)."
    )
    assert times in nine.findings
    assert any("% below the flight's" in each for each in compare(flight, scaled(arm, 0.5)).findings)
    still = compare(scaled(flight, 0.0), arm)
    assert "Tip: 3.088 mm at 1.24 s, in flight none (no limit set)." in still.findings


def test_comparison_needs_no_loads(pair: tuple[Any, Any]) -> None:
    flight, arm = (with_body(each, loads=None, acceleration=None, frequencies=np.empty(0)) for each in pair)
    bare = compare(flight, arm)
    assert bare.root is None and bare.shock is None and bare.stations is None
    assert bare.load_difference is not None


def test_shock_spectrum(compared: Comparison) -> None:
    shock = compared.shock
    assert shock is not None and shock.quality == 10.0
    # Slow oscillators do not see the flight's corner; all see its plateau.
    assert shock.flight[:, 2].min() >= 5 * 9.8 and shock.centrifuge[:, 2].max() > shock.flight[:, 2].max()
    peak = int(shock.centrifuge[:, 2].argmax())
    assert shock.frequency[peak] == pytest.approx(36.56, rel=0.1)  # the beam's own frequency rings


def test_oscillators_against_closed_forms() -> None:
    """Half-sine shock: an oscillator of the same frequency as the pulse, undamped, Smallwood's classic 1.77."""
    h, width = 1e-4, 0.02
    t = np.arange(0, 0.2, h)
    pulse = np.where(t < width, np.sin(np.pi * t / width), 0.0)
    fn = 0.8 / width
    assert np.abs(oscillator_acceleration(pulse, 2 * np.pi * fn, 0.0, h)).max() == pytest.approx(1.768, abs=0.002)
    ramp = 3.0 * t
    w = 2 * np.pi * 30
    np.testing.assert_allclose(displacement(ramp, w, 0.0, h), 3 * (t - np.sin(w * t) / w) / w**2, atol=1e-10)


def test_low_pass_has_no_phase_and_bounded_corners() -> None:
    t = np.arange(0, 4, 1e-3)
    slow, fast = np.sin(2 * np.pi * 1.0 * t), 0.1 * np.sin(2 * np.pi * 40 * t)
    middle = slice(500, -500)
    np.testing.assert_allclose(low_pass(slow + fast, 1e-3, 10.0)[middle], slow[middle], atol=1e-3)
    kink = np.maximum(t - 2, 0) * 7.0
    left = np.abs(kink - low_pass(kink, 1e-3, 10.0))
    assert left.max() <= 0.12 * 7.0 / 10.0 and left[(t < 1.8)].max() < 2e-3


def test_filters_are_the_recurrences_they_stand_for() -> None:
    """Exact under a straight load: the state after a step by the exponential of the oscillator's matrix."""
    step, damping = 1e-3, 0.05
    load = np.cumsum(np.random.default_rng(0).standard_normal((200, 2)), axis=0)
    frequencies = np.array([0.7, 40.0, 900.0, 1100.0, 5000.0])
    together, riding = (f(load, frequencies, damping, step) for f in (displacement, oscillator_acceleration))
    for omega, eta, riders in zip(frequencies, together, riding, strict=True):
        a = np.zeros((4, 4))  # η, η̇, the load and its slope
        a[0, 1], a[1], a[2, 3] = 1, [-(omega**2), -2 * damping * omega, 1, 0], 1
        free = expm(a * step)
        state, expected = np.zeros((2, 2)), np.zeros((200, 2, 2))
        for n in range(1, 200):
            slope = (load[n] - load[n - 1]) / step
            state = free[:2] @ np.concatenate([state, [load[n - 1] - load[0], slope]])
            expected[n] = state
        place, rate = expected[:, 0], expected[:, 1]
        np.testing.assert_allclose(eta, place + load[0] / omega**2, rtol=1e-11, atol=1e-12 * np.abs(eta).max())
        acceleration = omega**2 * place + 2 * damping * omega * rate + load[0]
        np.testing.assert_allclose(riders, acceleration, rtol=1e-11, atol=1e-12 * np.abs(riders).max())
        np.testing.assert_allclose(displacement(load[:, 0], omega, damping, step), eta[:, 0], rtol=1e-12)
    covered = np.arange(200) % 3 > 0
    largest = largest_oscillator_acceleration(load, frequencies, damping, step, covered)
    np.testing.assert_allclose(largest, np.abs(riding[:, covered]).max(axis=1), rtol=1e-12)


def test_low_pass_has_the_gain_of_butterworth_twice() -> None:
    """1/(1 + (tan πfh / tan πf_c h)⁸), −6 dB at the cut-off; a line stays."""
    t, cutoff = np.arange(0, 4, 1e-3), 30.0
    middle = slice(1000, -1000)
    for frequency in (10.0, 30.0, 45.0):
        wave = np.sin(2 * np.pi * frequency * t)
        gain = 1 / (1 + (np.tan(1e-3 * np.pi * frequency) / np.tan(1e-3 * np.pi * cutoff)) ** 8)
        np.testing.assert_allclose(low_pass(wave, 1e-3, cutoff)[middle], gain * wave[middle], atol=1e-9)
    line = np.stack([3 + 2 * t, -t], axis=1)[:, None]
    np.testing.assert_allclose(low_pass(line, 1e-3, cutoff)[middle], line[middle], atol=1e-9)
    for wrong in (500.0, 0.2, 1e-4, 1e-9, 0.0):
        with pytest.raises(InputError, match=r"apart over 3\.999 s; give 0\.250063 Hz or more, below 500 Hz"):
            low_pass(line, 1e-3, wrong)
    np.testing.assert_allclose(low_pass(line, 1e-3, 0.250063), line, atol=0.01 * np.ptp(line[..., 0]))


@pytest.mark.parametrize(("count", "cutoff"), [(40, 300.0), (500, 100.0), (500, 2.1), (5000, 10.0)])
def test_low_pass_is_that_of_scipy_up_to_the_ends(count: int, cutoff: float) -> None:
    values, step = np.random.default_rng(count).normal(size=(count, 2, 3)).cumsum(axis=0), 1e-3
    beyond = min(count - 1, math.ceil(1 / (cutoff * step)))
    sections = scipy.signal.butter(4, cutoff, fs=1 / step, output="sos")
    expected = scipy.signal.sosfiltfilt(sections, values, axis=0, padlen=beyond)
    np.testing.assert_allclose(low_pass(values, step, cutoff), expected, rtol=0, atol=1e-11 * np.abs(values).max())


def test_a_beam_on_a_turned_clamp_is_compared_in_axes_of_the_ground(structure: Any) -> None:
    """Turned by a right angle about x, and loaded along the ground's y: the same as the beam on the ground itself."""
    clamp = Joint("fixed", "strip", turn=(np.pi / 2, 0.0, 0.0))
    turned = System({"strip": structure}, {"clamp": clamp})
    options: dict[str, Any] = {"duration": 0.3, "step": 1e-3, "estimate": False}
    plain = compare(*(simulate(structure, Flight(z=SmoothStep(level, 0.1)), **options) for level in (10.0, 12.0)))
    other = compare(
        *(simulate(turned, Flight(y=SmoothStep(-level, 0.1)), **options) for level in (10.0, 12.0)), point="tip"
    )
    np.testing.assert_allclose(other.difference[:, 1], -plain.difference[:, 2], atol=1e-9 * plain.peak_flight[2])
    assert plain.shock is not None and other.shock is not None
    np.testing.assert_allclose(other.shock.flight[:, 1], plain.shock.flight[:, 2], rtol=1e-6)
    for name in ("tip", "root_force", "root_moment", "stress"):
        assert other.peaks[name].ratio == pytest.approx(plain.peaks[name].ratio, rel=1e-4), name
        assert other.peaks[name].flight == pytest.approx(plain.peaks[name].flight, rel=1e-4), name
