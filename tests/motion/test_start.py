"""From standstill to standstill: spin-up before the flight, spin-down after, no jump where the inverse takes over."""

from pathlib import Path

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.motion import LEAST_TURNED, USUAL_TURNED, Axes, Profile, forward_kinematics
from gbeam.results import Base

G, R = STANDARD_GRAVITY, 3.3
F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
SPIN_UP, SPIN_DOWN, LAST, W = 3.0, 4.0, 8.0, 0.2
# It begins and ends with corners, which are rounded within half a width of the flight's edges.
RISING = gb.vector(
    x=gb.tabulated([0, 4, 6], [0.5 * G, 0.5 * G, G]),
    y=gb.tabulated([0.0], [G]),
    z=gb.tabulated([0, 3.5, 5, 8], np.array([2, 2.5, 5, 4]) * G),
)


def machine(
    start: str = "rest", inverse: str = "flat", *, raw: Profile = RISING, gravity: bool = True, sign: int = 1,
    spin_up: float | None = SPIN_UP, spin_down: float | None = SPIN_DOWN, smoothing: float = W,
    idle: float | None = None, limits: gb.MachineLimits | None = None,
) -> gb.Centrifuge:  # fmt: skip
    return gb.Centrifuge(
        gb.Flight(acceleration=raw), arm=R, control_point=0.15, inverse=inverse, gravity=gravity, idle=idle,
        smoothing=smoothing, mounting="upright" if sign == 1 else "inverted", start=start, spin_up=spin_up,
        spin_down=spin_down, limits=limits, span=(0.0, LAST),
    )  # fmt: skip


def seen(spin: gb.Centrifuge, t: np.ndarray) -> tuple[Axes, np.ndarray, Base, np.ndarray, np.ndarray]:
    axes, jerk = spin.axes_and_jerks(t)
    return (
        axes,
        jerk,
        spin.base(t),
        spin.reference(t),
        forward_kinematics(axes, spin.geometry.arm, spin.geometry.gravity).a_WO_B,
    )


def states(axes: Axes) -> np.ndarray:
    return np.stack([np.asarray(getattr(axes, name)) for name in axes.__dataclass_fields__])


CASES = [("rest", "quasi-static"), ("rest", "flat"), ("rest", "exact"), ("pre-yawed", "exact"), ("pre-yawed", "flat")]


@pytest.mark.parametrize(("gravity", "sign"), [(False, 1), (True, -1)])
@pytest.mark.parametrize(("start", "inverse"), CASES)
def test_standstill_at_both_ends_and_no_jump_at_the_joins(start: str, inverse: str, gravity: bool, sign: int) -> None:
    spin = machine(start, inverse, gravity=gravity, sign=sign)
    assert spin.extent == pytest.approx((-SPIN_UP, LAST + SPIN_DOWN), abs=1e-12)
    for end, across in ((-SPIN_UP, [1, 2]), (LAST + SPIN_DOWN, [1, 4])):
        for beyond in (0.0, np.sign(end)):  # before the beginning and after the end it stands still as well
            axes, jerk, base, _, actual = seen(spin, np.array([end + beyond]))
            moving = [axes.rate1, axes.rate2, axes.rate3, axes.acceleration1, axes.acceleration2, axes.acceleration3]
            np.testing.assert_allclose(np.concatenate(moving), 0, atol=1e-9)
            np.testing.assert_allclose(jerk, 0, atol=1e-7)
            # Gravity alone, across the beam where the load is across the beam.
            for load in (actual, base.a_WO_B):
                np.testing.assert_allclose(np.linalg.norm(load), G if gravity else 0, atol=1e-9)
            if gravity:
                np.testing.assert_allclose(actual[0, 1:] / G, np.array(across) / np.hypot(*across), atol=1e-9)
    rough = 1e-3 if inverse == "exact" else 1e-5  # what its collocation leaves of the rates of the lag
    for join in (-W / 2, LAST + W / 2):
        before, after = (seen(spin, join + np.array([side])) for side in (-1e-8, 1e-8))
        for one, other in ((before[2].a_WO_B, after[2].a_WO_B), (before[2].alpha_WB_B, after[2].alpha_WB_B)):
            np.testing.assert_allclose(other, one, atol=rough)
        np.testing.assert_allclose(states(after[0]), states(before[0]), atol=rough)


@pytest.mark.parametrize(("start", "inverse"), [("rest", "flat"), ("pre-yawed", "exact"), ("rest", "exact")])
@pytest.mark.parametrize("gravity", [True, False])
def test_commands_integrate_from_standstill_to_standstill(start: str, inverse: str, gravity: bool) -> None:
    """Plain sums: jerks make the accelerations, these the rates, these the angles, and all end at rest."""
    spin = machine(start, inverse, gravity=gravity)
    rough = 3e-3 if inverse == "exact" else 1e-6  # rad/s²: what its collocation leaves at the joins
    edges = np.linspace(*spin.extent, 15_001)  # among them every time at which the third derivative of the load jumps
    h = edges[1] - edges[0]
    at_edges, _ = spin.axes_and_jerks(edges)
    inner = edges[:-1, None] + h * (0.5 + np.array([-0.5, 0.5]) / np.sqrt(3))  # Gauss's points of every step
    inside, jerk = spin.axes_and_jerks(inner)
    for axis in (1, 2, 3):
        rate, acceleration = f"rate{axis}", f"acceleration{axis}"
        pairs = [(jerk[..., axis - 1], acceleration), (getattr(inside, acceleration), rate)]
        pairs += [(getattr(inside, rate), f"angle{axis}")] if axis > 1 else []
        for slope, name in pairs:
            built, commanded = np.append(0.0, np.cumsum(h * slope.mean(axis=1))), np.asarray(getattr(at_edges, name))
            if name.startswith("angle"):
                commanded = np.unwrap(commanded) - commanded[0]
            else:
                assert commanded[0] == commanded[-1] == 0
            slack = rough if name.startswith("acceleration") else 1e-6
            np.testing.assert_allclose(built, commanded, atol=slack)


def test_no_sample_of_the_record_is_replaced() -> None:
    """A 10 g pull at 4.3 s stays, however long the spin-up; it used to vanish behind the load at its end."""
    pull = gb.tabulated([0, 3.5, 4.3, 5.1, 12, 16], np.array([1.5, 1.5, 10, 1.5, 3, 3]) * G)
    flight = gb.Flight(z=pull)
    spin = gb.Centrifuge(
        flight, arm=7.6, control_point=0.3, inverse="flat", gravity=True, idle=1.4 * G, smoothing=0.06, start="rest",
        spin_up=10.0, span=(0.0, 16.0),
    )  # fmt: skip
    assert spin.extent[0] == pytest.approx(-10.0, abs=1e-12)
    t = np.linspace(0, 16, 1601)
    load, reference = np.asarray(flight.acceleration(t)), np.asarray(spin.reference(t))
    rounded = np.abs(t[:, None] - np.array([3.5, 4.3, 5.1, 12.0])).min(axis=1) < 0.031
    np.testing.assert_allclose(reference[~rounded], load[~rounded], atol=0.03 * G)
    assert np.linalg.norm(reference, axis=1).max() > 9.5 * G
    assert not np.asarray(spin.not_followed(np.array([0.5, 4.3, 11.0]))).any()
    assert spin.episodes() == []


@pytest.mark.parametrize(("gravity", "sign"), [(False, 1), (True, -1)])
def test_pre_yawed_loads_in_the_right_direction_from_first_to_last(gravity: bool, sign: int) -> None:
    spin, t = machine("pre-yawed", "exact", gravity=gravity, sign=sign), np.linspace(-SPIN_UP, LAST + SPIN_DOWN, 15_001)
    axes, _, _, reference, actual = seen(spin, t)
    np.testing.assert_allclose(actual, reference, atol=1e-7 * 5.2 * G)
    down = G * gravity
    lag = np.arctan2(axes.acceleration1, axes.rate1**2)
    for way, edge in ((t <= -W / 2, 0.0), (t >= LAST + W / 2, LAST)):
        np.testing.assert_allclose(actual[way], reference[way], atol=1e-8)
        full = np.asarray(spin.target.load(edge + np.sign(edge - 1) * W / 2))
        # What is horizontal rises in proportion, along the beam and across it.
        horizontal = np.sqrt(np.maximum(np.hypot(reference[:, 1], reference[:, 2])[way] ** 2 - down**2, 0))
        np.testing.assert_allclose(
            reference[way, 0] * np.sqrt(full[1] ** 2 + full[2] ** 2 - down**2), horizontal * full[0], atol=1e-5
        )
        rising = np.diff(reference[way, 0]) * (1 if edge == 0 else -1)
        assert (rising >= -1e-12).all()  # it never falls on the way up, nor rises on the way down
    # docs/theory.md, section 8.4: all of it is tangential at standstill.
    assert lag[1] == pytest.approx(np.pi / 2, abs=1e-6) and lag[-2] == pytest.approx(-np.pi / 2, abs=1e-6)


def test_the_shortest_spin_up_does_not_overshoot() -> None:
    s = np.linspace(0.5, 1, 100_001)
    rise = s**5 * (126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4)
    need = np.sqrt(np.max(2520 * (s * (1 - s)) ** 3 * (2 * s - 1) / (2 * rise**3)))
    assert need < LEAST_TURNED < need * 1.001


def test_from_rest_ignores_the_tangential_acceleration_only() -> None:
    spin = machine("rest", "flat")
    for t in (np.linspace(-SPIN_UP, -W / 2, 501), np.linspace(LAST + W / 2, LAST + SPIN_DOWN, 501)):
        axes, _, _, reference, actual = seen(spin, t)
        error = np.linalg.norm(np.asarray(actual) - reference, axis=1)
        np.testing.assert_allclose(error, R * np.abs(axes.acceleration1), atol=1e-9)


@pytest.mark.parametrize("start", ["rest", "pre-yawed"])
def test_times_left_out_turn_the_arm_once_or_keep_the_limits(start: str) -> None:
    free = machine(start, spin_up=None, spin_down=None)
    t = np.linspace(free.extent[0], -W / 2, 2001)
    turned = np.trapezoid(free.axes(t).rate1, t)
    assert turned == pytest.approx(USUAL_TURNED / 2, rel=1e-6) == pytest.approx(2 * np.pi, rel=1e-6)
    horizontal = R * free.axes(-W / 2).rate1 ** 2
    assert 0.19 < R * np.abs(free.axes(t).acceleration1).max() / horizontal < 0.2
    for limits, binding in (
        (gb.MachineLimits(gb.AxisLimit(acceleration=0.4)), ("axis 1", "acceleration")),
        (gb.MachineLimits(gb.AxisLimit(jerk=0.3)), ("axis 1", "jerk")),
        (gb.MachineLimits(axis3=gb.AxisLimit(rate=0.05)), ("axis 3", "rate")),
        (gb.MachineLimits(inertia=2000.0, power=1000.0), ("arm", "power")),
    ):
        spin = machine(start, spin_up=None, spin_down=None, limits=limits)
        begin, end = spin.extent
        assert begin < free.extent[0] and end > free.extent[1]
        for ramp in spin.course.ramps:  # type: ignore[union-attr]
            use = next(use for use in ramp.usage(spin.limits) if (use.axis, use.quantity) == binding)
            assert 0.89 < use.share < 0.9001


def test_limits_are_judged_from_standstill_to_standstill() -> None:
    limits = gb.MachineLimits(gb.AxisLimit(acceleration=3.0))
    for spin_up, spin_down, when in ((1.5, 4.0, (-1.5, 0)), (4.0, 1.5, (LAST, LAST + 1.5))):
        short = machine(spin_up=spin_up, spin_down=spin_down, limits=limits)
        use = {(each.axis, each.quantity): each for each in short.usage()}
        assert use["axis 1", "acceleration"].exceeded and when[0] < use["axis 1", "acceleration"].time < when[1]
    assert not any(each.exceeded for each in machine(limits=limits, spin_up=None, spin_down=None).usage())


def test_idle_begins_and_ends_with_the_flight() -> None:
    spin, t = machine("idle", spin_up=None, spin_down=None), np.linspace(0, LAST, 101)
    assert spin.extent == spin.target.span == (0.0, LAST)
    rest = machine("rest")
    for one, other in zip(seen(spin, t)[3:], seen(rest, t)[3:], strict=True):
        np.testing.assert_array_equal(one, other)  # between the ends all are the same
    assert spin.axes(0.0).rate1 > 1 and not np.asarray(spin.not_followed(t)).any()
    assert rest.not_followed(np.array([-1.0, 1.0, 9.0])).tolist() == [True, False, True]


def test_the_f16_record_from_standstill_to_standstill() -> None:
    record = gb.read_record(F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
    options = {
        "arm": R, "control_point": 0.15, "inverse": "flat", "gravity": True, "idle": 1.4 * G,
        "smoothing": 0.06, "span": (0.0, 15.99),
    }  # fmt: skip
    spin = gb.Centrifuge(gb.Flight(acceleration=record), **options)
    assert spin.ends.start == "rest"  # unless told otherwise
    idle, t = gb.Centrifuge(gb.Flight(acceleration=record), **options, start="idle"), np.linspace(0.03, 15.96, 3001)
    np.testing.assert_array_equal(states(spin.axes(t)), states(idle.axes(t)))
    begin, end = spin.extent
    way = np.concatenate([np.linspace(begin, -0.03, 500), np.linspace(16.02, end, 500)])
    assert np.linalg.norm(spin.actual(way), axis=1).max() < 1.41 * G  # never more than the flight begins and ends with


@pytest.mark.parametrize(
    ("options", "where", "words"),
    [
        ({"start": "yawed"}, "start", "rest, pre-yawed, idle"),
        ({"start": "idle"}, "spin_up", "idle"),
        ({"start": "idle", "spin_up": None}, "spin_down", "idle"),
        ({"spin_up": 0.0}, "spin_up", "positive"),
        ({"spin_down": float("nan")}, "spin_down", "positive"),
        ({"spin_up": 0.5}, "spin_up", "first load"),
        ({"spin_down": 0.5, "start": "pre-yawed"}, "spin_down", "last load"),
    ],
)
def test_refusals(options: dict[str, object], where: str, words: str) -> None:
    with pytest.raises(gb.InputError, match=words) as caught:
        machine(**options)  # type: ignore[arg-type]
    assert caught.value.where == where
