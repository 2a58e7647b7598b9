"""The planned inverse: least error against the flight within the limits, from standstill to standstill."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY
from scipy.integrate import cumulative_simpson
from scipy.signal import find_peaks

import gbeam as gb
from gbeam.arrays import record as record_class
from gbeam.motion import AxisSplines, Geometry, KeptLimits, Limits, Profile, Tracking
from gbeam.numerics import Grid

G, R = STANDARD_GRAVITY, 3.3
IDLE = 1.4 * G
DATA = Path(__file__).parents[2] / "examples" / "data"
LAST = {"f16_8g_turn": 15.99, "f16_pulls_and_push": 35.99}
SPECIMEN = gb.machines["specimen-3.3m"].limits
TIGHT = gb.MachineLimits(
    gb.AxisLimit(10, 20, 40), gb.AxisLimit(20, 60, 3e3), gb.AxisLimit(10, 30, 1e3), inertia=2e3, power=1e5
)


@cache
def record(name: str) -> Profile:
    return gb.read_record(DATA / f"{name}.csv", "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")


@cache
def spin(name: str, limits: gb.MachineLimits | None = SPECIMEN, **options: Any) -> gb.Centrifuge:
    arguments = {"inverse": "planned", "arm": R, "control_point": 0.15, "gravity": True, "idle": IDLE}
    arguments |= {"smoothing": 0.06, **options}
    return gb.Centrifuge(gb.Flight(acceleration=record(name)), limits=limits, span=(0.0, LAST[name]), **arguments)


def times(machine: gb.Centrifuge, step: float) -> np.ndarray:
    first, last = machine.extent
    return np.linspace(first, last, 2 * round((last - first) / step / 2) + 1)


def size(load: np.ndarray) -> np.ndarray:
    return np.linalg.norm(load, axis=1)


@pytest.mark.parametrize("name", LAST)
def test_commands_integrate_back_from_standstill_to_standstill_within_every_limit(name: str) -> None:
    """Jerks are integrated by Simpson's rule, positions differentiated; nothing else of the plan is read."""
    machine = spin(name)
    t = times(machine, 1e-3)
    axes, jerk = machine.axes_and_jerks(t)
    assert t[0] < -1 and t[-1] > LAST[name] + 1
    integral = [jerk]
    for _ in range(3):
        integral.append(cumulative_simpson(integral[-1], x=t, axis=0, initial=0))
    _, acceleration, rate, angle = integral
    start = np.array([0.0, axes.angle2[0], axes.angle3[0]])  # of axis 1, whose angle moves nothing, any
    np.testing.assert_allclose(rate[:, 0], axes.rate1, atol=1e-5)
    np.testing.assert_allclose((angle + start)[:, 1:], np.column_stack([axes.angle2, axes.angle3]), atol=1e-3)
    for values, row in ((rate, "rate"), (acceleration, "acceleration"), (jerk, "jerk")):
        allowed = np.array([getattr(axis, row) for axis in SPECIMEN.axes])
        share = np.abs(values) / allowed
        assert share.max() <= 1 + 1e-6
        assert np.abs(share[[0, -1]]).max() < 1e-5  # at rest
    differentiated = np.gradient(np.gradient(np.gradient(angle + start, t, axis=0), t, axis=0), t, axis=0)[3:-3]
    assert (np.abs(differentiated) / [axis.jerk for axis in SPECIMEN.axes]).max() <= 1.001


@pytest.mark.parametrize("name", LAST)
def test_the_load_is_that_of_a_point_at_the_end_of_the_arm(name: str) -> None:
    """Its position is differentiated twice, in the base axes; gravity is added."""
    machine = spin(name)
    t = times(machine, 5e-4)
    axes = machine.axes(t)
    turned = cumulative_simpson(axes.rate1, x=t, initial=0)
    position = R * np.column_stack([np.cos(turned), np.sin(turned)])
    a = np.gradient(np.gradient(position, t, axis=0), t, axis=0)
    yaw = turned + axes.angle2
    across = a[:, 1] * np.cos(yaw) - a[:, 0] * np.sin(yaw)
    along = a[:, 0] * np.cos(yaw) + a[:, 1] * np.sin(yaw)
    sine, cosine = np.sin(axes.angle3), np.cos(axes.angle3)
    load = np.column_stack([along, across * cosine + G * sine, G * cosine - across * sine])
    np.testing.assert_allclose(machine.actual(t)[3:-3], load[3:-3], atol=2e-3 * G)


def test_every_peak_above_idle_is_made() -> None:
    machine = spin("f16_pulls_and_push")
    t = np.linspace(0, LAST["f16_pulls_and_push"], 36001)
    flight, built = np.asarray(record("f16_pulls_and_push")(t)), machine.actual(t)
    peaks, _ = find_peaks(size(flight), height=IDLE, prominence=0.05 * G)
    assert len(peaks) == 7 and size(flight)[peaks].max() > 9.7 * G
    np.testing.assert_allclose(size(built)[peaks], size(flight)[peaks], rtol=0.025)
    assert size(built - flight)[size(flight) >= IDLE].max() < 0.07 * G


def test_below_idle_the_arm_keeps_idle_and_the_specimen_is_loaded_no_more() -> None:
    machine = spin("f16_pulls_and_push")
    t = np.linspace(0, LAST["f16_pulls_and_push"], 36001)
    arm = np.sqrt((R * machine.axes(t).rate1 ** 2) ** 2 + G**2)
    assert arm.min() >= IDLE
    below = size(np.asarray(record("f16_pulls_and_push")(t))) < IDLE
    assert size(machine.actual(t))[below].max() < 1.05 * IDLE
    # Nor on the way there and back, which asks for no more than the flight begins and ends with.
    begin, end = machine.extent
    ends = IDLE, max(IDLE, float(size(np.asarray(record("f16_pulls_and_push")([LAST["f16_pulls_and_push"]])))[0]))
    for way, edge in zip(((begin, 0.0), (LAST["f16_pulls_and_push"], end)), ends, strict=True):
        assert size(machine.actual(np.linspace(*way, 4001))).max() < 1.05 * edge


def test_the_f16_pull_is_followed_as_well_as_the_exact_inverse_does_within_limits_that_it_breaks() -> None:
    t = np.linspace(3.2, 11.2, 8001)
    flat, exact = (spin("f16_8g_turn", None, inverse=inverse) for inverse in ("flat", "exact"))
    planned = spin("f16_8g_turn")
    flight = np.asarray(record("f16_8g_turn")(t))
    errors = [size(machine.actual(t) - flight).max() for machine in (flat, exact, planned)]
    assert errors[0] > 4 and errors[2] < 0.35 and errors[2] < 1.1 * errors[1]
    used = {(each.axis, each.quantity): each.used for each in exact.usage()}
    assert used["axis 2", "acceleration"] > SPECIMEN.axis2.acceleration
    assert max(each.share for each in planned.usage()) <= 1


def test_in_the_other_mounting_as_well() -> None:
    t = np.linspace(3.2, 11.2, 8001)
    machine = spin("f16_8g_turn", mounting="inverted")
    assert size(machine.actual(t) - record("f16_8g_turn")(t)).max() < 0.5
    assert max(each.share for each in machine.usage()) <= 1


def test_all_ten_limits_are_kept_where_flat_breaks_them() -> None:
    flat, best = (spin("f16_8g_turn", TIGHT, inverse=inverse) for inverse in ("flat", "planned"))
    assert any(use.exceeded for use in flat.usage()) and not any(use.exceeded for use in best.usage())
    assert len(best.usage()) == 10 and max(use.share for use in best.usage()) > 0.99


def test_what_no_machine_of_this_speed_can_do_is_missed_and_the_limit_is_kept() -> None:
    flight = gb.Flight(z=gb.trapezoid(8 * G, jerk=8 * G, start=1.0, hold=2.0))
    # 8 g needs 4.88 rad/s; with a strong arm and a quick gimbal it would swing to and fro to make up for that.
    slow = gb.MachineLimits(gb.AxisLimit(4.5, 6.0, 200.0), gb.AxisLimit(acceleration=100.0), inertia=2e3, power=25e3)
    machine = gb.Centrifuge(
        flight, arm=R, control_point=0.15, inverse="planned", gravity=False, limits=slow, idle=2 * G, smoothing=0.1,
        span=(0.0, 5.0),
    )  # fmt: skip
    uses = {f"{use.axis} {use.quantity}": use.share for use in machine.usage()}
    assert max(uses.values()) <= 1
    assert min(uses["axis 1 rate"], uses["arm power"]) > 0.98
    # In the middle of the plateau nothing helps; at its ends the arm's tangential acceleration does.
    assert 8 * G - R * 4.5**2 <= float(np.linalg.norm(machine.tracking_error(3.0))) < 1.3 * (8 * G - R * 4.5**2)


def test_from_idle_to_idle_the_machine_begins_and_ends_in_a_steady_state() -> None:
    machine = spin("f16_8g_turn", start="idle")
    assert machine.extent == pytest.approx((0.0, LAST["f16_8g_turn"]))
    axes, jerk = machine.axes_and_jerks(np.array([-1.0, 0.0, LAST["f16_8g_turn"], 20.0]))
    assert R * axes.rate1.min() ** 2 >= np.sqrt(IDLE**2 - G**2)
    moving = [axes.acceleration1, axes.rate2, axes.acceleration2, axes.rate3, axes.acceleration3, *jerk.T]
    assert np.abs(moving).max() < 1e-6
    np.testing.assert_allclose([axes.rate1[0], axes.angle3[3]], [axes.rate1[1], axes.angle3[2]], rtol=1e-12)


def test_given_times_to_spin_up_and_down_are_taken() -> None:
    machine = spin("f16_8g_turn", spin_up=3.0, spin_down=5.0)
    assert machine.extent == pytest.approx((-3.0, LAST["f16_8g_turn"] + 5.0))
    assert max(use.share for use in machine.usage()) <= 1


def test_a_spin_up_in_which_idle_is_not_reached_is_refused_with_one_that_is_enough() -> None:
    weak = gb.MachineLimits(gb.AxisLimit(acceleration=0.5), gb.AxisLimit(), gb.AxisLimit())
    with pytest.raises(gb.InputError) as refusal:
        spin("f16_8g_turn", weak, spin_up=2.5)
    assert refusal.value.where == "spin_up" and "axis 1" in refusal.value.problem
    enough = float(refusal.value.fix.split('"')[1].split()[0])
    machine = spin("f16_8g_turn", weak, spin_up=enough)
    assert max(use.share for use in machine.usage()) <= 1


def test_an_idle_beyond_what_the_arm_can_do_is_refused() -> None:
    with pytest.raises(gb.InputError) as refusal:
        spin("f16_8g_turn", gb.MachineLimits(gb.AxisLimit(1.5), gb.AxisLimit(), gb.AxisLimit()))
    assert refusal.value.where == "idle" and "axis 1" in refusal.value.problem


def a_plan(standstill: bool, limits: Limits) -> tuple[AxisSplines, Tracking, KeptLimits]:
    """Plan of a flight of 3 s that falls below idle, on knots 0.2 s apart."""
    flight = gb.trapezoid(6 * G, jerk=8 * G, start=1.0, hold=0.5)
    target = gb.build_target(
        gb.Flight(z=flight, x=0.5 * G).acceleration, span=(0.0, 3.0), idle=IDLE, smoothing=0.1, gravity=True, arm=R
    )
    geometry = Geometry(np.asarray(R), G)
    splines = AxisSplines(Grid(-2.0 * standstill, 3.0 + 2.0 * standstill, 0.2, np.array([1, 3, 5]) / 6), standstill)
    return splines, Tracking(splines, geometry, target), KeptLimits(splines, geometry, limits, target)


@pytest.mark.parametrize("standstill", [True, False])
def test_the_slope_of_the_cost_is_that_of_its_differences(standstill: bool) -> None:
    splines, tracking, _ = a_plan(standstill, Limits())
    rng = np.random.default_rng(3)
    x, direction = rng.normal(size=(2, splines.size))
    _, slope = tracking.model(x)
    step = 1e-6
    finite = (tracking.cost(x + step * direction) - tracking.cost(x - step * direction)) / (2 * step)
    assert slope @ direction == pytest.approx(finite, rel=1e-6)
    assert 0 < tracking.bound < tracking.cost(x) < tracking.gentler(2.0).cost(x)


def test_the_second_derivatives_by_the_states_are_those_of_differences() -> None:
    _, tracking, _ = a_plan(True, Limits())
    state = np.random.default_rng(4).normal(size=(4, tracking.weight.size))
    error, slope, second = tracking.error(state, 2)
    half = lambda at: np.sum(tracking.error(at, 0)[0] ** 2, axis=0) / 2  # noqa: E731
    np.testing.assert_allclose(np.sum(error**2, axis=0) / 2, half(state))
    for i, up in enumerate(1e-4 * np.eye(4)[:, :, None]):
        ahead, behind = (tracking.error(state + side, 2) for side in (up, -up))
        np.testing.assert_allclose(slope[:, i], (ahead[0] - behind[0]) / 2e-4, atol=1e-7)
        by_state = [np.einsum("kit,kt->ti", each[1], each[0]) for each in (ahead, behind)]
        np.testing.assert_allclose(second[:, i], (by_state[0] - by_state[1]) / 2e-4, atol=1e-6)


def test_the_matrix_of_the_search_is_positive_semidefinite_and_the_second_derivative_where_that_is() -> None:
    splines, tracking, _ = a_plan(False, Limits())
    x = np.random.default_rng(5).normal(size=splines.size)
    matrix = tracking.model(x)[0].toarray()
    assert np.linalg.eigvalsh(matrix).min() > -1e-12
    # The flight's own load is made everywhere: what is left is the product of the first derivatives.
    tracking.flight = tracking.error((tracking.states @ x).reshape(4, -1), 0)[1].T
    step = 1e-6
    slopes = [tracking.model(x + side * np.eye(splines.size)[7])[1] for side in (step, -step)]
    np.testing.assert_allclose(tracking.model(x)[0].toarray()[7], (slopes[0] - slopes[1]) / (2 * step), atol=1e-6)


def shares_of(splines: AxisSplines, x: np.ndarray, limits: Limits) -> np.ndarray:
    """Largest shares of rate, acceleration and jerk limits at 4001 times; then of the arm's power."""
    t = np.linspace(splines.grid.start, splines.grid.end, 4001)
    series = splines.grid.spline(splines.coefficients(x)).series(t, 3).derivatives()
    rates = [np.column_stack([series[k][:, 0], series[k + 1][:, 1:]]) for k in range(3)]
    power = limits.inertia * np.abs(rates[0][:, 0] * rates[1][:, 0]).max() / limits.power
    return np.append([np.max(np.abs(each / row)) for each, row in zip(rates, limits.axes, strict=True)], power)


@pytest.mark.parametrize("power", [1e4, 1e5])  # the first binds before the axes do
def test_what_keeps_the_rows_keeps_the_limits_at_all_times_and_they_are_not_much_tighter(power: float) -> None:
    rng = np.random.default_rng(6)
    limits = Limits(gb.MachineLimits(*TIGHT.axes, inertia=2e3, power=power))
    splines, _, kept = a_plan(True, limits)
    place = np.linspace(0, np.pi, splines.grid.size)[:, None]
    shape, waves = np.sin(place) ** 4, np.sin(place * np.arange(2, 6))

    def use(x: np.ndarray, about: np.ndarray) -> float:
        """Largest use of a row; idle and turning back are another matter."""
        rows, lower, upper = kept.linearise(about)
        value, least = rows @ x, np.where(lower < 0, lower, -np.inf)
        return float(np.max(np.maximum(value / np.where(upper > 0, upper, np.inf), value / least)))

    for _ in range(20):
        x = splines.unknowns(shape * ([3.0, 0.0, 0.0] + 0.15 * waves @ rng.normal(size=(4, 3))))
        about = splines.unknowns(shape * [3.0, 0.0, 0.0] * rng.uniform(0.5, 1.5))  # where the power has its tangents
        assert shares_of(splines, x / use(x, about), limits).max() <= 1
        shares = shares_of(splines, x, limits)
        x = x * min(0.85 / shares[:3].max(), np.sqrt(0.85 / shares[3]))
        assert shares_of(splines, x, limits).max() == pytest.approx(0.85)
        assert use(x, x) <= 1


def test_equal_machines_share_a_plan_and_a_load_of_another_kind_has_its_own() -> None:
    pulls = [gb.trapezoid(20.0, jerk=20.0, start=1.0, hold=1.0) for _ in range(3)]
    own_profile = record_class(type("UserProfile", (type(pulls[2]),), {}))  # of no module
    object.__setattr__(pulls[2], "__class__", own_profile)
    first, second, other = (
        gb.Centrifuge(
            gb.Flight(z=pull), gravity=False, limits=SPECIMEN, arm=R, control_point=0.15, idle=IDLE, span=(0.0, 5.0)
        )
        for pull in pulls
    )
    assert first.course is not None and second.course is not None and other.course is not None
    assert first.course.inverse is second.course.inverse and first.course.inverse is not other.course.inverse
    t = times(first, 0.1)
    np.testing.assert_array_equal(first.base(t).a_WO_B, other.base(t).a_WO_B)


def test_a_run_shorter_than_the_first_knots_is_planned() -> None:
    """From idle, so without a spin-up; a constant load is held as it is."""
    for seconds in (0.05, 0.2):
        machine = gb.Centrifuge(
            gb.Flight(z=30.0), arm=R, control_point=0.2, gravity=False, start="idle", span=(0.0, seconds)
        )
        assert machine.actual(np.linspace(0, seconds, 7)) == pytest.approx(np.array([[0.0, 0.0, 30.0]] * 7), abs=1e-9)


def test_only_a_plan_has_an_ease() -> None:
    arguments = {"arm": R, "control_point": 0.15, "gravity": True, "span": (0.0, 1.0)}
    flight = gb.Flight(z=gb.constant(2 * G))
    for inverse in ("flat", "exact", "quasi-static"):
        with pytest.raises(gb.InputError, match=f"ease is given beside inverse = {inverse}"):
            gb.Centrifuge(flight, inverse=inverse, ease=0.1, **arguments)
        assert gb.Centrifuge(flight, inverse=inverse, **arguments).less_eased() is None
    for wrong in (0.0, -1.0, np.inf):
        with pytest.raises(gb.InputError, match="ease is"):
            gb.Centrifuge(flight, ease=wrong, **arguments)
    gentle = gb.Centrifuge(flight, ease=0.1, **arguments).less_eased()
    assert gentle is not None and gentle.ease == pytest.approx(0.01)
