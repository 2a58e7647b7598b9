"""The exact inverse: forward of inverse is the identity at the control point; docs/theory.md (8.4) and its limit (8.5).

Ledger of the source: "the control point is always consistent" holds for smooth loads with −ä <= a²/R at their maxima.
"""

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.motion import (
    Axes,  # fmt: skip
    Profile,
)
from gbeam.results import Base

G, R = STANDARD_GRAVITY, 3.3


def seen(m: gb.Centrifuge, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, Axes, Base]:
    return m.reference(t), m.actual(t), m.axes(t), m.base(t)


def machine(
    raw: Profile, span: tuple[float, float], *, smoothing: float = 0.0, gravity: bool = False, sign: int = 1,
    arm: float = R, inverse: str = "exact", idle: float | None = None,
) -> gb.Centrifuge:  # fmt: skip
    return gb.Centrifuge(
        gb.Flight(acceleration=raw), arm=arm, control_point=0.15, inverse=inverse, gravity=gravity, smoothing=smoothing,
        idle=idle, mounting="upright" if sign == 1 else "inverted", span=span,
    )  # fmt: skip


def swinging() -> Profile:
    y, z = gb.Sine(2 * G, 4.0, start=-1.0), gb.Sum((gb.constant(5 * G), gb.Sine(1.5 * G, 5.0, start=-2.0)))
    return gb.vector(x=gb.Sine(G, 6.0, start=-1.0), y=y, z=z)


@pytest.mark.parametrize("gravity", [False, True])
@pytest.mark.parametrize("sign", [1, -1])
def test_forward_of_inverse_is_the_identity_on_a_smooth_load(gravity: bool, sign: int) -> None:
    spin, t = machine(swinging(), (0.0, 2.0), gravity=gravity, sign=sign), np.linspace(0, 2, 2001)
    reference, actual, axes, base = seen(spin, t)
    np.testing.assert_allclose(actual, reference, atol=1e-8)
    np.testing.assert_allclose(actual[20:-20], reference[20:-20], atol=1e-9)  # within: the ends are one-sided
    # (9): ω1⁴ + (dω1/dt)² = (H/R)²
    horizontal = np.sqrt(np.sum(reference**2, axis=1) - (G**2 if gravity else 0))
    np.testing.assert_allclose(np.hypot(axes.rate1**2, axes.acceleration1), horizontal / R, rtol=1e-9)
    assert np.isfinite(base.alpha_WB_B).all()


def test_a_smooth_load_is_solved_on_the_coarsest_knots() -> None:
    lag = machine(swinging(), (0.0, 2.0)).inverse.lag  # type: ignore[union-attr]
    assert lag.step == pytest.approx(8e-3)


@pytest.mark.parametrize("width", [0.06, 0.2, 0.8])
def test_a_rounded_trapezoid_up_and_down_is_tracked_to_5e_7(width: float) -> None:
    raw = gb.vector(z=gb.Sum((gb.constant(2 * G), gb.trapezoid(8 * G, jerk=4 * G, start=1.0, hold=4.0))))
    t = np.linspace(0, 11, 11003)
    reference, actual, axes, _ = seen(machine(raw, (0.0, 11.0), smoothing=width), t)
    assert np.abs(actual - reference).max() < 5e-7 * 10 * G
    # Flat's lag is the solution's first order: on a straight flank they agree to the second.
    lag, first = np.arctan2(axes.acceleration1, axes.rate1**2), 4 * G * np.sqrt(R) / (2 * (6 * G) ** 1.5)
    assert lag[np.argmin(np.abs(reference[:, 2] - 6 * G))] == pytest.approx(first, rel=0.02)


def test_smooth_step_and_rates() -> None:
    spin = machine(gb.vector(z=gb.Sum((gb.constant(2 * G), gb.SmoothStep(8 * G, 4.0, 1.0)))), (0.0, 8.0))
    t, h = np.linspace(0.5, 7.5, 141), 1e-5
    reference, actual, axes, _ = seen(spin, t)
    assert np.abs(actual - reference).max() < 5e-7 * 10 * G
    before, after = seen(spin, t - h)[2], seen(spin, t + h)[2]
    for value, rate in (("rate1", "acceleration1"), ("angle2", "rate2"), ("rate2", "acceleration2")):
        finite = (getattr(after, value) - getattr(before, value)) / (2 * h)
        np.testing.assert_allclose(getattr(axes, rate), finite, atol=1e-6)


@pytest.mark.parametrize(("frequency", "arm", "possible"), [(0.5, 3.3, True), (1.0, 3.3, False), (0.5, 15.0, False)])
def test_a_maximum_can_be_followed_where_it_is_flat_enough(frequency: float, arm: float, possible: bool) -> None:
    t = np.arange(0, 4, 0.02)
    raw = gb.vector(z=gb.tabulated(t, 2 * G + 1.2 * G * np.sin(2 * np.pi * frequency * t)))
    sharp = 1.2 * G * (2 * np.pi * frequency) ** 2 / ((3.2 * G) ** 2 / arm)  # −ä over a²/R
    assert (sharp <= 1) == possible
    if possible:
        reference, actual, *_ = seen(machine(raw, (0.6, 3.4), smoothing=0.1, arm=arm), np.linspace(0.6, 3.4, 2801))
        assert np.abs(actual - reference).max() < 2e-6 * 3.2 * G
        return
    with pytest.raises(gb.InputError, match="the arm allows a²/R") as caught:
        machine(raw, (0.6, 3.4), smoothing=0.1, arm=arm)
    assert caught.value.where == "smoothing" and "planned" in caught.value.fix
    enough = 1e-3 * float(caught.value.fix.split('"')[1].split()[0])
    machine(raw, (0.6, 3.4), smoothing=enough, arm=arm)
    with pytest.raises(gb.InputError, match="the arm allows a²/R"):
        machine(raw, (0.6, 3.4), smoothing=0.6 * enough, arm=arm)


def test_a_return_that_no_motion_follows_is_left_out_by_name_unless_it_is_the_flight() -> None:
    """A quick pull to 2.5 g after a slow one to 6 g: −ä = 2j/T is four times a²/R at its top."""
    slow, quick = (
        gb.trapezoid(5 * G, jerk=2.5 * G, start=0.5, hold=1.0),
        gb.trapezoid(1.5 * G, jerk=7.5 * G, start=6.5, hold=0),
    )
    raw, t = gb.vector(z=gb.Sum((gb.constant(G), slow, quick))), np.linspace(0, 8, 4001)
    options = {"smoothing": 0.3, "gravity": True, "idle": 1.4 * G}
    spin = machine(raw, (0.0, 8.0), **options)
    reference, actual, *_ = seen(spin, t)
    (left,) = (episode for episode in spin.episodes() if episode.reason == "left out")
    assert left.flight_peak == pytest.approx(2.5 * G, rel=1e-3) and 6.5 < left.start < left.end < 6.9
    np.testing.assert_allclose(np.linalg.norm(reference[t > 6], axis=1), 1.4 * G)
    assert np.abs(actual - reference).max() < 1e-5 * 6 * G
    assert all(each.reason == "below idle" for each in machine(raw, (0.0, 8.0), inverse="flat", **options).episodes())
    with pytest.raises(gb.InputError, match="too small for the exact inverse"):
        machine(gb.vector(z=gb.Sum((gb.constant(G), quick))), (0.0, 8.0), **options)
