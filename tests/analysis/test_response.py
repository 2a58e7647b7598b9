"""Response over time: closed forms of the oscillator, honest error estimates, outcomes and warnings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam import (
    Beam,
    Flight,
    Hub,
    InputError,
    Load,
    Material,
    Model,
    ResponseSettings,
    Section,
    Sine,
    SmoothStep,
    Structure,
    assemble,
    constant,
    simulate,
    smoothed,
    tabulated,
    trapezoid,
    vector,
)

from ..specimens import TIP, appendage
from .helpers import ALUMINIUM, EI, LENGTH, LINE, OMEGA, SECTION, of_tip, strip

HONEST = 3.0  # factor within which an error estimate brackets the error
PERIOD = 2 * np.pi / OMEGA
PULSE = [0.0, 3.0, 3.00025, 3.0005, 6.0], [0.0, 0.0, 400.0, 0.0, 0.0]  # s; m/s² or N
RAMP = tabulated([0.0, 0.002, 1.0], [0.0, 50.0, 50.0])  # m/s², a kick of 0.07 periods


def flight(acceleration: Any) -> Flight:
    return Flight(z=acceleration)


def run(structure: Structure, motion: Any, duration: float, **how: Any) -> Any:
    return simulate(structure, motion, ResponseSettings(duration=duration, **how))


# --- physics


def test_steady_load_leaves_the_beam_at_rest() -> None:
    """It starts in relative equilibrium, at any start."""
    result = run(strip(), flight(constant(50.0)), 0.2, start=3.0)
    assert result.outcome == "done" and result.warnings == ()
    assert (result.time[0], result.time[-1]) == (3.0, pytest.approx(3.2))
    np.testing.assert_allclose(result.tip[:, 2], -LINE * 50 * LENGTH**4 / (8 * EI), rtol=1e-3)
    assert np.ptp(result.tip[:, 2]) < 1e-12
    assert not result.tip[:, 1].any()


@pytest.mark.parametrize("ratio", [0.01, 0.05])
def test_vibration_decays_with_the_damping_ratio(ratio: float) -> None:
    """Maxima of the first mode about its rest, over ten periods: ln(a₀/a₁₀) = 10 · 2πζ/√(1 − ζ²)."""
    structure = strip("FOAM", (0, 0, 1), ratio)
    result = run(structure, flight(RAMP), 12 * PERIOD, integrator="gauss", step=PERIOD / 400, estimate=False)
    q = result.q[:, 0] - steady_first_mode(structure)
    turning = np.flatnonzero((np.diff(np.sign(np.diff(q))) < 0) & (result.time[1:-1] > 0.002)) + 1
    peaks = q[turning]
    measured = np.log(peaks[0] / peaks[10]) / 10
    assert measured == pytest.approx(2 * np.pi * ratio / np.sqrt(1 - ratio**2), rel=2e-3)
    assert np.diff(result.time[turning]).mean() == pytest.approx(PERIOD / np.sqrt(1 - ratio**2), rel=1e-3)


def steady_first_mode(structure: Structure) -> float:
    return float(run(structure, flight(constant(50.0)), 0.01, step=0.005).q[0, 0])


def test_undamped_ramp_response_is_the_oscillators() -> None:
    """q = q_s (t − sin ωt/ω)/T on the ramp: one mode, against the closed form."""
    structure = strip("FOAM", (0, 0, 1))
    steady = steady_first_mode(structure)
    result = run(structure, flight(tabulated([0.0, 1.0], [0.0, 50.0])), 0.3, integrator="gauss")
    wanted = steady * (result.time - np.sin(OMEGA * result.time) / OMEGA)
    np.testing.assert_allclose(result.q[:, 0], wanted, atol=1e-4 * np.abs(wanted).max())


def test_truncated_model_is_linear_in_the_load() -> None:
    one, two = (
        run(strip(), flight(trapezoid(a, jerk=100 * a, start=0.0, hold=0.05)), 0.1, step=1e-3) for a in (10.0, 20.0)
    )
    np.testing.assert_allclose(two.q, 2 * one.q, atol=1e-15)
    np.testing.assert_allclose(two.tip[:, 0], 4 * one.tip[:, 0], atol=1e-15)  # the foreshortening


def test_hub_angle_is_the_integral_of_its_rate() -> None:
    """A slew of 3 rad/s in 1 s turns by 1.5 rad, then by 3 rad each second."""
    result = run(strip("FOAM", (0, 2, 0)), Hub(radius=0.5, rate=SmoothStep(3.0, 1.0)), 2.0)
    assert result.environment == "hub" and result.hub is not None
    assert result.hub.angle[-1] == pytest.approx(4.5, abs=1e-6)
    assert result.hub.rate[-1] == pytest.approx(3.0)
    assert result.hub.drive_torque is None  # the inertia of its hub is not known
    np.testing.assert_allclose(result.base.a_WO_B[-1], [-0.5 * 9, 0, 0], atol=1e-12)


def test_free_hub_turns_as_a_rigid_body_would() -> None:
    """Against τ = J θ̈ of hub and beam together: the strip is 10⁵ times lighter than what turns it."""
    inertia = 50.0 + LINE * ((0.5 + LENGTH) ** 3 - 0.5**3) / 3
    result = run(strip("FOAM", (0, 2, 0)), Hub(radius=0.5, inertia=50.0, torque=Sine(20.0, 2.0)), 2.0, step=2e-3)
    assert result.hub is not None
    wanted = 20 / inertia * (2 / (2 * np.pi)) * (result.time - np.sin(np.pi * result.time) / np.pi)
    np.testing.assert_allclose(result.hub.angle, wanted, atol=1e-5 * wanted.max())
    np.testing.assert_allclose(result.hub.drive_torque, 20 * np.sin(np.pi * result.time), atol=1e-9)


# --- steps and their errors


@pytest.mark.parametrize(
    ("integrator", "how"),
    [
        ("newmark", {"tolerance": 1e-3, "estimate": False}),  # that of automatic steps is known without
        ("newmark", {"tolerance": 1e-5, "estimate": False}),
        ("newmark", {"step": 5e-4, "tolerance": 1.0}),
        ("gauss", {"tolerance": 1e-5, "estimate": False}),
        ("generalized-alpha", {"tolerance": 1e-3, "parameters": {"rho_inf": 0.8}, "estimate": False}),
        ("hht", {"step": 5e-4, "tolerance": 1.0}),
    ],
    ids=["newmark loose", "newmark tight", "newmark given step", "gauss", "generalised-α", "hht given step"],
)
def test_error_estimate_brackets_the_error(integrator: str, how: dict[str, Any]) -> None:
    """The largest error of the tip over its largest size, against a step far below."""
    load = flight(smoothed(trapezoid(50.0, jerk=1000.0, start=0.03, hold=0.1), 0.02))
    done = run(strip(), load, 0.4, integrator=integrator, **how)
    truth = run(strip(), load, 0.4, integrator="gauss", step=done.time[1] / 8, estimate=False)
    error = np.abs(done.tip - truth.tip[::8]).max() / np.abs(truth.tip).max()
    # An order that has not been observed is not believed: of Gauss's method two runs differ by 15 times the error.
    assert error / HONEST < done.errors.displacement.step < error * (20 if integrator == "gauss" else HONEST)
    assert done.errors.displacement.step <= how["tolerance"]


def test_automatic_steps_come_back_to_the_common_grid() -> None:
    """500 or more steps over the duration whatever the refinement; extremes are of every step computed."""
    loose, tight = (run(strip(), flight(RAMP), 0.3, tolerance=t, estimate=False) for t in (1e-2, 1e-5))
    np.testing.assert_allclose(loose.time, tight.time, rtol=1e-12)
    assert len(loose.time) > 500 and tight.steps >= 4 * loose.steps
    assert loose.step == pytest.approx(0.3 / loose.steps)
    assert tight.peaks.max_abs[2] >= np.abs(tight.tip[:, 2]).max()


def test_given_step_is_kept_and_warned_about() -> None:
    coarse = run(strip(), flight(RAMP), 0.2, step=5e-3)
    assert coarse.step == pytest.approx(5e-3) and coarse.steps == 40
    assert coarse.error_estimate > 1e-2
    assert any("wrong by an estimated" in w and "auto" in w for w in coarse.warnings)


def test_residual_vibration_is_half_of_peak_to_peak() -> None:
    """Rest in one, 2·(kick's share) in the other; not a number where not asked for."""
    structure = strip("FOAM", (0, 0, 1))
    settings = dict(integrator="gauss", step=PERIOD / 200, estimate=False)
    done = run(structure, flight(RAMP), 5 * PERIOD, residual_from=2 * PERIOD, **settings)
    after = done.tip[done.time >= 2 * PERIOD, 2]
    assert done.peaks.residual_amplitude[2] == pytest.approx(np.ptp(after) / 2, rel=1e-4)
    share = np.sin(OMEGA * 0.001) / (OMEGA * 0.001)  # of a step, by a ramp of 2 ms
    assert done.peaks.residual_amplitude[2] == pytest.approx(abs(done.tip[:, 2].mean()) * share, rel=2e-2)
    assert np.isnan(run(structure, flight(RAMP), PERIOD, **settings).peaks.residual_amplitude).all()


def test_progress_is_told() -> None:
    told: list[tuple[str, float]] = []
    settings = ResponseSettings(duration=0.1, step=1e-3)
    simulate(strip(), flight(RAMP), settings, progress=lambda what, share: told.append((what, share)))
    assert {what for what, _ in told} == {
        "integrating",
        "checking with twice the step",
        "checking with four times the step",
        "errors of shapes and models",
    }
    assert told[-1][1] == 1.0


# --- outcomes and warnings


def test_tlam_is_lost_beyond_its_divergence_only() -> None:
    """A hundredth beyond it a deviation grows e¹⁶-fold in a tenth of a second, twofold in four thousandths."""
    stiff = 1.875104068711961**2 * np.sqrt(7e10 * 0.004 * 0.02**3 / 12 / (LINE * LENGTH**4))  # bending along y
    below, beyond, briefly = (
        run(strip("TLAM", (0, 1, 0)), Hub(radius=0.1, rate=constant(share * stiff)), end, step=end / 100)
        for share, end in ((0.99, 0.1), (1.01, 0.1), (1.01, 0.006))
    )
    assert below.outcome == briefly.outcome == "done" and beyond.outcome == "diverged"
    assert not any("definite" in w for w in below.warnings)
    (warning,) = (w for w in briefly.warnings if "definite" in w)
    for words in (warning, beyond.message):
        assert f"turns at {1.01 * stiff:.4g} rad/s" in words
    assert "grows 2." in warning and "use FOAM or exact" in beyond.message


def test_divergence_stops_the_run_where_the_model_ends() -> None:
    result = run(strip("TLAM", (0, 2, 0)), Hub(radius=0.1, rate=SmoothStep(4000.0, 0.5)), 1.0)
    assert result.outcome == "diverged"
    assert "TLAM's stiffness is not positive definite" in result.message and "FOAM or exact" in result.message
    assert result.time[-1] < 1.0
    assert np.isfinite(result.tip).all()


def test_large_deflection_is_warned_about_in_second_order_models_only() -> None:
    """Of a dead uniform load a second-order model loses 0.80 (v/L)²: the case at hand says so itself."""
    heavy = flight(constant(1600.0))
    foam = run(strip(), heavy, 0.02, step=1e-3)
    (warning,) = (w for w in foam.warnings if "deflections are wrong" in w)
    share = np.linalg.norm(foam.tip, axis=1).max() / LENGTH
    assert foam.errors.displacement.model == pytest.approx(0.80 * share**2, rel=0.1) and "exact" in warning
    small = run(strip(), flight(constant(300.0)), 0.02, step=1e-3)
    assert small.warnings == ()


def test_gauss_and_newmark_agree_on_a_nonlinear_model() -> None:
    structure = assemble(appendage(TIP), Model("CFOAM", 1, 1, 1))  # and a hub of the sizes of loads/test_loads.py
    motion = Hub(radius=0.5, inertia=50.0, torque=Sine(50.0, 2.0), gravity=[1.0, 2.0, -9.8])
    how = {"loads": False, "estimate": False}
    steps = {"gauss": 2.5e-3, "newmark": 2.5e-4}  # ten times as many of the one
    quick, slow = (run(structure, motion, 2.0, integrator=name, step=step, **how) for name, step in steps.items())
    np.testing.assert_allclose(quick.tip, slow.tip[::10], atol=2e-6 * np.abs(slow.tip).max())


def test_unknown_integrator_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        run(strip(), flight(RAMP), 0.1, integrator="euler")
    assert caught.value.where == "response.integrator" and "'euler'" in caught.value.problem


def test_result_carries_what_plots_need() -> None:
    result = run(strip(), flight(RAMP), 0.1, step=1e-3, tolerance=1.0)
    n = len(result.time)
    assert result.displacement.shape == (n, 1, 3) and result.q.shape == result.qd.shape == (n, 2)
    np.testing.assert_allclose(result.base.a_WO_B[:, 2], RAMP(result.time))
    assert (result.model, result.environment, result.integrator, result.step) == ("FOAM", "flight", "gauss", 1e-3)
    assert result.hub is None and result.axes is None
    assert of_tip("x", result.time, result.tip).tip.shape == (n, 3)


def test_a_start_that_no_beam_would_keep_is_warned_of() -> None:
    """Compressed at ten times the load at which the column buckles (Greenhill), the straight beam is in equilibrium."""
    none = Load(distributed=(0.0, 0.0, 0.0))  # of the sizes of structure/test_loads.py
    column = Beam(10.0, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9), damping_ratio=0.0, loads=[none])
    m, stiffness = 2700 * 0.02 * 0.004, 70e9 * 0.02 * 0.004**3 / 12
    critical = 7.8373 * stiffness / (m * 10.0**3)
    structure = assemble(column, Model("exact", 0, 0, 2))
    for share, expected in ((0.5, False), (10.0, True)):
        flight = Flight(x=constant(share * critical))
        answer = simulate(structure, flight, ResponseSettings(duration=0.1, step=0.01))
        assert any("not stable" in warning for warning in answer.warnings) == expected


@pytest.mark.parametrize("kind", ["base", "load"])
def test_a_short_pulse_in_a_long_run_is_not_missed(kind: str) -> None:
    """A pulse of 0.5 ms in 6 s: steps that knew the first frequency alone went over it without a word."""
    structure, motion = strip(), flight(tabulated(*PULSE) if kind == "base" else constant(0.0))
    if kind == "load":
        kick = Load(at=LENGTH, force=vector(z=tabulated(*PULSE)))
        structure = assemble(Beam(LENGTH, SECTION, ALUMINIUM, damping_ratio=0.0, loads=[kick]), "FOAM", z=2)
    how = {"integrator": "gauss", "estimate": False}
    done = run(structure, motion, 6.0, tolerance=1e-3, **how)
    near = run(structure, motion, 0.2, start=2.95, step=2e-5, **how)
    assert done.peaks.max_size == pytest.approx(near.peaks.max_size, rel=2e-3) and near.peaks.max_size > 1e-5


@pytest.mark.parametrize(
    ("name", "value"), [("tolerance", -1.0), ("tolerance", 0.0), ("tolerance", np.nan), ("start", np.inf)]
)
def test_settings_that_no_run_can_keep_are_refused(name, value):
    """A tolerance below zero took every step that there may be, and was said to be missed."""
    with pytest.raises(InputError, match=name):
        ResponseSettings(duration=1.0, **{name: value})
