"""The centrifuge as a motion: the root, the axes over time, the F-16 record, refusals."""

from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
import gbeam.arrays.jax_setup  # JAX knows the records, in whatever order modules were imported
from gbeam.motion import axis_angles, shift_base

G, R, XC = STANDARD_GRAVITY, 3.3, 0.15
F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
TRAPEZOID = gb.Flight(z=gb.trapezoid(10 * G, jerk=4 * G, start=1.0, hold=4.0))
SPAN = (0.0, 12.0)


def machine(**options: Any) -> gb.Centrifuge:
    arguments = {"arm": R, "control_point": XC, "inverse": "flat", "gravity": True, "idle": 1.4 * G, "smoothing": 0.06}
    return gb.Centrifuge(TRAPEZOID, **{**arguments, "span": SPAN, **options})


@pytest.fixture(scope="module")
def f16() -> gb.Centrifuge:
    record = gb.read_record(F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
    return gb.Centrifuge(
        gb.Flight(acceleration=record), arm=R, control_point=XC, inverse="flat", gravity=True, idle=1.4 * G,
        smoothing=0.06, span=(0.0, 15.99),
    )  # fmt: skip


def test_root_has_the_control_points_motion_moved() -> None:
    turning, t = machine(), np.linspace(0, 12, 61)
    root, actual = turning.base(t), turning.actual(t)
    back = shift_base(root, [XC, 0.0, 0.0])
    np.testing.assert_allclose(back.a_WO_B, actual, atol=1e-11)
    scalar = turning.base(3.0)
    np.testing.assert_allclose(scalar.a_WO_B, root.a_WO_B[15], atol=1e-12)


def test_steady_load_at_the_root_is_less_the_centrifugal_one() -> None:
    still = gb.Centrifuge(gb.Flight(z=6 * G), arm=R, control_point=XC, inverse="flat", gravity=False, span=(0.0, 1.0))
    base = still.base(0.5)
    # C is at rest in the turning axes, the root XC nearer the tip of r = (−XC, 0, 0): a_O = a_C + XC Ω² e1
    np.testing.assert_allclose(base.a_WO_B, [XC * 6 * G / R, 0, 6 * G], atol=1e-12)


def test_f16_record_on_a_short_arm(f16: gb.Centrifuge) -> None:
    t = np.linspace(0, 15.99, 4001)
    base, error, held = f16.base(t), f16.tracking_error(t), f16.not_followed(t)
    for part in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B):
        assert np.isfinite(part).all()
    reference = np.asarray(f16.reference(t))
    assert np.hypot(reference[:, 1], reference[:, 2]).min() > 1.01 * G
    # The 8 g turn. Near idle the aileron's steps change the load faster than so slow an arm can follow.
    turn = (t > 3.2) & (t < 11.2)
    assert not np.asarray(held)[turn].any()
    relative = np.linalg.norm(np.asarray(error), axis=1) / np.linalg.norm(reference, axis=1)
    assert relative[turn].max() < 0.3 and np.sqrt(np.mean(relative[(t > 4.5) & (t < 10)] ** 2)) < 1e-3
    assert {episode.reason for episode in f16.episodes()} == {"below idle"}
    assert all(0 <= e.start < e.end <= 15.99 for e in f16.episodes())


def test_axis_angles_are_integrated_and_unwrapped(f16: gb.Centrifuge) -> None:
    t = np.linspace(2.2, 15.99, 20001)  # the steps of the aileron before are over
    axes = f16.axes(t)
    angles = axis_angles(axes, t)
    for angle, rate in ((angles[:, 0], axes.rate1), (angles[:, 2], axes.rate3)):
        assert np.abs(np.diff(angle)).max() < np.pi
        np.testing.assert_allclose(np.gradient(angle, t)[1:-1], rate[1:-1], atol=0.02 * np.abs(rate).max())
    assert angles[0, 0] == 0


def test_like_scenarios_share_one_compiled_function() -> None:
    traces = []

    @jax.jit
    def base(machine: gb.Centrifuge, t: np.ndarray) -> object:
        traces.append(1)
        return machine.base(t)

    t = np.linspace(0, 12, 11)
    for arm, mounting, level in ((3.3, "upright", 10.0), (5.0, "inverted", 10.0), (5.0, "upright", 9.9)):
        flight = gb.Flight(z=gb.trapezoid(level * G, jerk=level * 0.4 * G, start=1.0, hold=4.0))
        idle = 0.14 * level * G
        like = gb.Centrifuge(
            flight, arm=arm, control_point=XC, inverse="flat", gravity=True, idle=idle, smoothing=0.06,
            mounting=mounting, span=SPAN,
        )  # fmt: skip
        np.testing.assert_allclose(base(like, t).w_WB_B, like.base(t).w_WB_B, atol=1e-12)
    assert len(traces) == 1


def test_a_plan_is_made_where_the_motion_is_needed() -> None:
    flight = gb.Flight(z=gb.trapezoid(6 * G, jerk=20 * G, start=0.5, hold=0.5))
    spin = gb.Centrifuge(flight, arm=R, control_point=XC, gravity=True, idle=1.4 * G)
    assert spin.method == "planned"
    waiting = spin.over(0.0, 2.0, ahead=False)
    assert waiting.course is not None and waiting.course.solution is None
    assert waiting.target.span == (0.0, 2.0) and waiting.course.solution is None
    assert waiting.axes(1.0).rate1 == pytest.approx((35**0.5 * G / R) ** 0.5, rel=1e-3)
    assert waiting.course.solution is None and waiting == spin.over(0.0, 2.0, ahead=False)  # a value stays what it is
    planned = waiting.over(0.5, 1.0)
    assert planned.course is not None and planned.course.inverse is waiting.inverse  # and its plan is made once
    assert planned.over(0.0, 2.0) is planned == spin.over(0.0, 2.0)


def test_a_load_with_corners_needs_no_smoothing_for_a_plan() -> None:
    flight = gb.Flight(z=gb.trapezoid(6 * G, jerk=20 * G, start=0.5, hold=0.5))
    spin = gb.Centrifuge(flight, arm=R, control_point=XC, gravity=True, idle=1.4 * G, smoothing=None, span=(0.0, 2.0))
    assert np.linalg.norm(spin.tracking_error(np.linspace(1.0, 1.1, 21)), axis=1).max() < 0.01 * G
    assert not [each for each in spin.shortfalls() if each.unit == "m/s^4"]


def test_sharp_corners_only_for_quasi_static_and_a_load_that_does_not_turn() -> None:
    sharp = machine(smoothing=None, gravity=False, inverse="quasi-static")
    assert np.isfinite(sharp.base(np.linspace(0, 12, 61)).alpha_WB_B).all() and sharp.corners(0.1).size
    for inverse, gravity in (("flat", False), ("quasi-static", True)):
        with pytest.raises(gb.InputError, match="60 ms") as caught:
            machine(smoothing=None, gravity=gravity, inverse=inverse)
        assert caught.value.where == "smoothing"


@pytest.mark.parametrize(
    ("change", "where", "words"),
    [
        ({"inverse": "quasistatic"}, "inverse", "did you mean 'quasi-static'"),
        ({"inverse": "newton"}, "inverse", "choose one of quasi-static, flat"),
        ({"arm": 0.0}, "arm", "positive"),
        ({"control_point": -0.1}, "control_point", "non-negative"),
        ({"mounting": "sideways"}, "mounting", "upright, inverted"),
        ({"arm": None}, "arm", "or a machine"),
        ({"idle": -1.0}, "idle", "positive"),
    ],
)
def test_refusals(change: dict[str, object], where: str, words: str) -> None:
    with pytest.raises(gb.InputError, match=words) as caught:
        machine(**{**change, "span": None})
    assert caught.value.where == where


def test_the_target_is_built_for_the_span_that_is_asked_of_it() -> None:
    with pytest.raises(gb.InputError, match="use over") as caught:
        machine(span=None).base(1.0)
    assert caught.value.where == "span"
    idle = machine(span=None)
    prepared = idle.over(0.0, 12.0)
    np.testing.assert_array_equal(prepared.base(3.0).a_WO_B, machine().base(3.0).a_WO_B)
    assert idle == machine(span=None) and idle.over(0.0, 12.0) == prepared and prepared.over(1.0, 5.0) is prepared
    assert idle.over(0.0, 6.0).target.span == (0.0, 6.0) and prepared.over(0.0, 20.0).target.span == (0.0, 20.0)
    assert prepared.kind == "centrifuge" and not prepared.free


def test_an_example_machine_tells_its_arm_limits_and_idle() -> None:
    example = gb.machines["specimen-3.3m"]
    options: Any = {"control_point": XC, "inverse": "flat", "gravity": False, "smoothing": 0.06, "span": SPAN}
    spin = gb.Centrifuge(TRAPEZOID, limits=example, **options)
    assert spin.geometry.arm == example.arm and spin.idle == example.idle
    assert spin.episodes()[0].reason == "below idle"  # the flight begins with no load
    assert {use.axis for use in spin.usage() if np.isfinite(use.allowed)} == {"axis 1", "axis 2", "axis 3"}
    longer = gb.Centrifuge(TRAPEZOID, arm=4.0, limits=example, idle=2 * G, **options)
    assert longer.geometry.arm == 4.0 and longer.idle == 2 * G


def test_altered_changes_what_is_named_and_nothing_else() -> None:
    spin, t = machine(mounting="inverted", inverse="quasi-static"), np.linspace(0, 12, 25)
    moved_on = spin.altered(control_point=0.25)
    assert moved_on.course is spin.course and float(moved_on.control_point) == 0.25
    np.testing.assert_array_equal(moved_on.actual(t), spin.actual(t))
    upright = spin.altered(mounting="upright", smoothing=0.1)
    np.testing.assert_allclose(upright.base(t).a_WO_B, machine(inverse="quasi-static", smoothing=0.1).base(t).a_WO_B)
    assert spin.mounting == "inverted" and upright.target.span == SPAN
