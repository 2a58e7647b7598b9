"""Limits and reach: what is used, where the machine cannot follow, and what is refused."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.motion import TOO_SHARP, Limits, Profile, usage
from gbeam.results import Shortfall

G, R = STANDARD_GRAVITY, 3.3


def test_usage_of_a_known_motion() -> None:
    t = np.linspace(0, np.pi, 2001)
    angle = np.stack([2 * t, np.sin(3 * t), 0 * t], axis=1)
    rate = np.stack([2 + np.sin(t), 3 * np.cos(3 * t), 0 * t], axis=1)
    acceleration = np.stack([np.cos(t), -9 * np.sin(3 * t), 0 * t], axis=1)
    jerk = np.stack([-np.sin(t), -27 * np.cos(3 * t), 0 * t], axis=1)
    assert angle.shape == rate.shape
    limits = Limits(gb.MachineLimits(gb.AxisLimit(rate=4.0), gb.AxisLimit(acceleration=6.0), inertia=100.0, power=1e3))
    use = {(each.axis, each.quantity): each for each in usage(t, rate, acceleration, jerk, limits)}
    assert len(use) == 10
    first = use["axis 1", "rate"]
    assert (first.used, first.share, first.exceeded) == (pytest.approx(3), pytest.approx(0.75), False)
    assert first.time == pytest.approx(np.pi / 2, abs=1e-3)
    assert use["axis 2", "acceleration"].share == pytest.approx(1.5) and use["axis 2", "acceleration"].exceeded
    assert use["axis 2", "jerk"].used == pytest.approx(27) and use["axis 2", "jerk"].share == 0
    assert use["axis 3", "rate"].used == 0
    assert use["arm", "power"].used == pytest.approx(100 * np.max(np.abs(rate[:, 0] * acceleration[:, 0])))


def test_jerks_are_the_derivatives_of_the_accelerations() -> None:
    flight, t, h = gb.Flight(z=gb.trapezoid(10 * G, jerk=4 * G, start=1.0, hold=4.0)), np.linspace(2.2, 3.4, 31), 1e-6
    machine = gb.Centrifuge(
        flight, arm=R, control_point=0.15, inverse="flat", gravity=True, idle=2 * G, smoothing=0.3, span=(0.0, 12.0)
    )
    (after, _), (before, _), (_, jerk) = (machine.axes_and_jerks(t + side) for side in (h, -h, 0.0))
    for i, name in enumerate(("acceleration1", "acceleration2", "acceleration3")):
        finite = (getattr(after, name) - getattr(before, name)) / (2 * h)
        np.testing.assert_allclose(jerk[:, i], finite, atol=1e-3 * (1 + np.abs(jerk[:, i]).max()))


@pytest.mark.parametrize(
    ("limits", "where"),
    [
        (lambda: gb.AxisLimit(rate=0.0), "rate"),
        (lambda: gb.AxisLimit(jerk=-1.0), "jerk"),
        (lambda: Limits(gb.MachineLimits(power=1e3)), "limits.power"),
        (lambda: gb.MachineLimits(inertia=0.0), "inertia"),
    ],
)
def test_impossible_limits_are_refused(limits: Callable[[], object], where: str) -> None:
    with pytest.raises(gb.InputError) as caught:
        limits()
    assert caught.value.where == where


def test_example_machines_are_marked_as_examples_and_reach_their_load() -> None:
    assert set(gb.machines) == {"human-7.6m", "specimen-3.3m", "large-15m"}
    for machine in gb.machines.values():
        assert machine.source.startswith("EXAMPLE") and "assumed" in machine.source
        rate = machine.limits.axis1.rate
        assert rate is not None and machine.arm * rate**2 > 10 * G


def shortfalls(
    raw: Profile, arm: float = R, smoothing: float = 0.06, idle: float | None = None, gravity: bool = True
) -> tuple[Shortfall, ...]:
    return gb.Centrifuge(
        gb.Flight(acceleration=raw), arm=arm, control_point=0.15, inverse="flat", gravity=gravity, idle=idle,
        smoothing=smoothing, span=(0.0, 8.0),
    ).shortfalls()  # fmt: skip


def dip(level: float) -> Profile:
    """From 6 g to a level and back in 1 s each, m/s²."""
    return gb.vector(z=gb.tabulated([0.0, 2.0, 3.0, 5.0, 6.0, 8.0], np.array([6, 6, level, level, 6, 6]) * G))


def quoted(each: Shortfall) -> float:
    """Number that a remedy names."""
    return float(each.remedy.split('"')[1].split()[0])


def test_loads_below_idle_are_followed_with_the_idle_that_is_named_and_not_above() -> None:
    (low,) = (each for each in shortfalls(dip(1.25), idle=1.4 * G) if each.reason == "below idle")
    assert (low.reference, low.possible) == (pytest.approx(1.25), pytest.approx(1.4))
    assert low.start == pytest.approx(2.968, abs=3e-3) and low.end == pytest.approx(5.032, abs=3e-3)
    built = gb.build_target(dip(1.25), span=(0.0, 8.0), idle=quoted(low) * G, smoothing=0.06, gravity=True, arm=R)
    assert built.episodes() == [] and 'idle = "1.13 g" or less' in low.remedy
    assert any(each.reason == "below idle" for each in shortfalls(dip(1.25), idle=quoted(low) * G / 0.9))


def test_what_no_idle_lets_is_said() -> None:
    """Idle is 1.1 g at least, and raises what is below 1.1 times it."""
    for level, words in ((1.12, "without idle it would be followed"), (0.9, "no machine follows a load below 1.05 g")):
        (low,) = (each for each in shortfalls(dip(level), idle=1.4 * G) if each.reason == "below idle")
        assert words in low.remedy
    built = gb.build_target(dip(1.12), span=(0.0, 8.0), idle=None, smoothing=0.06, gravity=True, arm=R)
    assert built.episodes() == []


@pytest.mark.parametrize(
    ("raw", "arm", "gravity", "formula"),
    [
        (gb.vector(z=gb.trapezoid(4 * G, jerk=8 * G, start=1.0, hold=2.0)), R, False, 2 * 8 * R / (16 * G)),
        (dip(2.0), R, True, 2 * 4 * 6 / np.sqrt(35) * R / (35 * G)),  # the horizontal load's slope is f f'/H
        (dip(1.25), R, True, None),
        (gb.vector(z=gb.tabulated([0.0, 1.0, 8.0], np.array([1.06, 1.06, 4.5]) * G)), 15.0, True, None),
    ],
)
def test_the_smoothing_that_is_named_is_the_least_that_does(
    raw: Profile, arm: float, gravity: bool, formula: float | None
) -> None:
    """docs/theory.md (8.5): −ä = 2j/T <= a²/R, which gives the width of a corner to the first order.

    The load has not reached a where the corner is sharpest, so more is needed; where gravity bends a straight slope,
    several times more.
    """
    idle = None if gravity else G
    first = next(each for each in shortfalls(raw, arm, idle=idle, gravity=gravity) if each.reason == TOO_SHARP)
    width = 1e-3 * quoted(first)
    assert formula is None or formula < width < 1.3 * formula

    def remains(smoothing: float) -> bool:
        left = shortfalls(raw, arm, smoothing, idle, gravity)
        return any(each.reason == TOO_SHARP and each.start <= first.end and each.end >= first.start for each in left)

    assert remains(0.06) and remains(0.9 * width) and not remains(width)
