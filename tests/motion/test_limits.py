"""Limits and reach: what is used, where the machine cannot follow, and what is refused."""

import equinox as eqx
import numpy as np
import pytest

from gbeam.errors import InputError
from gbeam.motion import (
    MACHINES,
    STANDARD_GRAVITY,
    AxisLimit,
    Centrifuge,
    Limits,
    MachineLimits,
    PiecewiseLinear,
    build_target,
    stack,
    trapezoid,
    usage,
)  # fmt: skip

G, R = STANDARD_GRAVITY, 3.3


def test_usage_of_a_known_motion() -> None:
    t = np.linspace(0, np.pi, 2001)
    angle = np.stack([2 * t, np.sin(3 * t), 0 * t], axis=1)
    rate = np.stack([2 + np.sin(t), 3 * np.cos(3 * t), 0 * t], axis=1)
    acceleration = np.stack([np.cos(t), -9 * np.sin(3 * t), 0 * t], axis=1)
    jerk = np.stack([-np.sin(t), -27 * np.cos(3 * t), 0 * t], axis=1)
    assert angle.shape == rate.shape
    limits = Limits(MachineLimits(AxisLimit(rate=4.0), AxisLimit(acceleration=6.0), inertia=100.0, power=1e3))
    use = {(it.axis, it.quantity): it for it in usage(t, rate, acceleration, jerk, limits)}
    assert len(use) == 10
    first = use["axis 1", "rate"]
    assert (first.used, first.share, first.exceeded) == (pytest.approx(3), pytest.approx(0.75), False)
    assert first.time == pytest.approx(np.pi / 2, abs=1e-3)
    assert use["axis 2", "acceleration"].share == pytest.approx(1.5) and use["axis 2", "acceleration"].exceeded
    assert use["axis 2", "jerk"].used == pytest.approx(27) and use["axis 2", "jerk"].share == 0
    assert use["axis 3", "rate"].used == 0
    assert use["arm", "power"].used == pytest.approx(100 * np.max(np.abs(rate[:, 0] * acceleration[:, 0])))


def test_jerks_are_the_derivatives_of_the_accelerations() -> None:
    made = build_target(stack(z=trapezoid(10 * G, 4 * G, 1.0, 4.0)), span=(0.0, 12.0), idle=2 * G, smoothing=0.3,
                        gravity=True, arm=R)  # fmt: skip
    machine, t, h = Centrifuge(made, R, 0.15, "flat", True), np.linspace(2.2, 3.4, 31), 1e-6
    states = eqx.filter_jit(lambda m, t: m.axes_and_jerks(t))
    (after, _), (before, _), (_, jerk) = states(machine, t + h), states(machine, t - h), states(machine, t)
    for i, name in enumerate(("acceleration1", "acceleration2", "acceleration3")):
        finite = (getattr(after, name) - getattr(before, name)) / (2 * h)
        np.testing.assert_allclose(jerk[:, i], finite, atol=1e-3 * (1 + np.abs(jerk[:, i]).max()))


@pytest.mark.parametrize(
    ("given", "where"),
    [
        (MachineLimits(AxisLimit(rate=0.0)), "limits.axis1.rate"),
        (MachineLimits(axis3=AxisLimit(jerk=-1.0)), "limits.axis3.jerk"),
        (MachineLimits(power=1e3), "limits.power"),
        (MachineLimits(inertia=0.0), "limits.inertia"),
    ],
)
def test_impossible_limits_are_refused(given: MachineLimits, where: str) -> None:
    with pytest.raises(InputError) as caught:
        Limits(given)
    assert caught.value.where == where


def test_example_machines_are_marked_as_examples_and_reach_their_load() -> None:
    assert set(MACHINES) == {"human-7.6m", "specimen-3.3m", "large-15m"}
    for machine in MACHINES.values():
        assert machine.source.startswith("EXAMPLE") and "assumed" in machine.source
        rate = machine.limits.axis1.rate
        assert rate is not None and machine.arm * rate**2 > 10 * G


def test_what_cannot_be_reached_is_named_with_the_smallest_change() -> None:
    times = [0.0, 2.0, 3.0, 5.0, 6.0, 8.0]
    raw = PiecewiseLinear(times, np.array([[0, 0, 6], [0, 0, 6], [0, 0, 1.25], [0, 0, 1.25], [0, 0, 6], [0, 0, 6]]) * G)
    made = build_target(raw, span=(0.0, 8.0), idle=1.4 * G, smoothing=0.06, gravity=True, arm=R)
    found = {it.reason: it for it in Centrifuge(made, R, 0.15, "flat", True).unreachable()}
    low = found["below idle"]
    assert (low.wanted, low.possible) == (pytest.approx(1.25), pytest.approx(1.4))
    assert low.start == pytest.approx(2.968, abs=3e-3) and low.end == pytest.approx(5.032, abs=3e-3)
    assert 'idle = "1.25 g"' in low.remedy or 'idle = "1.24 g"' in low.remedy
    assert "across below gravity" not in found


def test_the_width_that_a_corner_needs_is_2jr_over_a2() -> None:
    """theory.md A1: −ä = 2j/T <= a²/R at the corner of a ramp of slope j."""
    raw = stack(z=trapezoid(4 * G, 8 * G, 1.0, 2.0))
    made = build_target(raw, span=(0.0, 4.0), idle=G, smoothing=0.06, gravity=False)
    at = [it for it in Centrifuge(made, R, 0.15, "flat", False).unreachable() if it.reason == "turns sharply"]
    corner = min(at, key=lambda it: abs(it.time - 1.5))
    assert corner.wanted == pytest.approx(2 * 8 * G / 0.06, rel=0.02)
    assert corner.possible == pytest.approx((4 * G) ** 2 / R, rel=0.05)
    needed = 1e3 * 2 * 8 * G * R / (4 * G) ** 2
    assert float(corner.remedy.split('"')[1].split()[0]) == pytest.approx(needed, rel=0.08)
