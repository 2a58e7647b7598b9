"""From rest and pre-yawed: standstill at first, no jump where the inverse takes over, the load on the way."""

from pathlib import Path

import numpy as np
import pytest

from gbeam.errors import InputError
from gbeam.motion import (
    STANDARD_GRAVITY,
    Axes,
    Base,
    Centrifuge,
    Flight,
    Profile,
    build_target,
    forward,
    read_record,
    smoothed,
    tabulated,
    trapezoid,
    vector,
)
from gbeam.motion.centrifuge.spin_up import LEAST_TURNED

G, R = STANDARD_GRAVITY, 3.3
F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
SPIN_UP, W = 3.0, 0.2
RISING = vector(
    x=tabulated([0, 4, 6], [0.5 * G, 0.5 * G, G]),
    y=tabulated([0.0], [G]),
    z=tabulated([0, 3.5, 5, 8], np.array([2, 2, 5, 4]) * G),
)


def machine(
    start: str, inverse: str, *, raw: Profile = RISING, gravity: bool = True, sign: int = 1, spin_up: float = SPIN_UP,
    smoothing: float = W, idle: float | None = None,
) -> Centrifuge:  # fmt: skip
    return Centrifuge(
        Flight(acceleration=raw), arm=R, control_point=0.15, inverse=inverse, gravity=gravity, idle=idle,
        smoothing=smoothing, mounting="upright" if sign == 1 else "inverted", start=start, spin_up=spin_up,
        span=(0.0, 8.0),
    )  # fmt: skip


def seen(spin: Centrifuge, t: np.ndarray) -> tuple[Axes, np.ndarray, Base, np.ndarray, np.ndarray]:
    axes, jerk = spin.axes_and_jerks(t)
    return axes, jerk, spin.base(t), spin.reference(t), forward(axes, spin.geometry.arm, spin.geometry.gravity).a_WO_B


def states(axes: Axes) -> np.ndarray:
    return np.stack([np.asarray(getattr(axes, name)) for name in axes.__dataclass_fields__])


@pytest.mark.parametrize(("gravity", "sign"), [(False, 1), (True, -1)])
@pytest.mark.parametrize(
    ("start", "inverse"),
    [("rest", "quasi-static"), ("rest", "flat"), ("rest", "planned"), ("pre-yawed", "exact"), ("pre-yawed", "flat")],
)
def test_standstill_first_and_no_jump_at_the_join(start: str, inverse: str, gravity: bool, sign: int) -> None:
    spin = machine(start, inverse, gravity=gravity, sign=sign)
    axes, _, base, _, actual = seen(spin, np.array([0.0]))
    moving = [axes.rate1, axes.rate2, axes.rate3, axes.acceleration1, axes.acceleration2, axes.acceleration3]
    np.testing.assert_allclose(np.concatenate(moving), 0, atol=1e-9)
    # Gravity alone, across the beam where the load is across the beam.
    np.testing.assert_allclose(np.linalg.norm(actual), G if gravity else 0, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(base.a_WO_B), G if gravity else 0, atol=1e-9)
    if gravity:
        np.testing.assert_allclose(actual[0, 1:] / G, np.array([1, 2]) / np.sqrt(5), atol=1e-9)
    end = SPIN_UP - W
    before, after = (seen(spin, end + np.array([side])) for side in (-1e-6, 1e-6))
    rough = 1e-3 if inverse == "planned" else 0.0
    np.testing.assert_allclose(after[1], before[1], atol=1e-3 + 100 * rough)  # jerk: the slope of the fourth order left
    for one, other in ((before[2].a_WO_B, after[2].a_WO_B), (before[2].alpha_WB_B, after[2].alpha_WB_B)):
        np.testing.assert_allclose(other, one, atol=1e-6 + rough)
    np.testing.assert_allclose(states(after[0]), states(before[0]), atol=1e-4 if inverse == "planned" else 1e-6)


def test_rates_belong_to_the_angles_all_the_way() -> None:
    for start, inverse, gravity in (
        ("rest", "flat", True),
        ("pre-yawed", "exact", True),
        ("pre-yawed", "exact", False),
    ):
        spin, t, h = machine(start, inverse, gravity=gravity), np.linspace(0.01, 3.5, 400), 1e-5
        here, jerk, _, _, _ = seen(spin, t)
        (before, _, _, _, _), (after, _, _, _, _) = seen(spin, t - h), seen(spin, t + h)
        for value, rate in (("rate1", "acceleration1"), ("angle2", "rate2"), ("rate2", "acceleration2"),
                            ("angle3", "rate3"), ("rate3", "acceleration3")):  # fmt: skip
            finite = (np.asarray(getattr(after, value)) - getattr(before, value)) / (2 * h)
            np.testing.assert_allclose(getattr(here, rate), finite, atol=2e-5)
        assert np.isfinite(jerk).all()


@pytest.mark.parametrize(("gravity", "sign"), [(False, 1), (True, -1)])
def test_pre_yawed_follows_from_the_first_instant_in_the_right_direction(gravity: bool, sign: int) -> None:
    spin, t = machine("pre-yawed", "exact", gravity=gravity, sign=sign), np.linspace(0, 8, 8001)
    axes, _, _, reference, actual = seen(spin, t)
    np.testing.assert_allclose(actual, reference, atol=1e-7 * 5.2 * G)
    spinning = t <= SPIN_UP - W
    np.testing.assert_allclose(actual[spinning], np.asarray(reference)[spinning], atol=1e-11)
    full = np.asarray(reference)[2800]
    down = G * gravity
    across = np.hypot(reference[:, 1], reference[:, 2])[spinning]
    # What is horizontal rises in proportion, along the beam and across it, and never falls.
    horizontal = np.sqrt(np.maximum(across**2 - down**2, 0))
    np.testing.assert_allclose(
        reference[spinning, 0] * np.sqrt(full[1] ** 2 + full[2] ** 2 - down**2), horizontal * full[0], atol=1e-6
    )
    assert (np.diff(reference[spinning, 0]) >= -1e-13).all()
    # docs/theory.md, section 8.4: tangential at first.
    lag = np.arctan2(axes.acceleration1, axes.rate1**2)
    assert lag[1] == pytest.approx(np.pi / 2, abs=1e-6) and abs(lag[2800]) < 1e-9


def test_the_shortest_pre_yawed_spin_up_does_not_overshoot() -> None:
    s = np.linspace(0.5, 1, 100_001)
    rise = s**5 * (126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4)
    need = np.sqrt(np.max(2520 * (s * (1 - s)) ** 3 * (2 * s - 1) / (2 * rise**3)))
    assert need < LEAST_TURNED < need * 1.001


def test_from_rest_ignores_the_tangential_acceleration_only() -> None:
    spin, t = machine("rest", "flat"), np.linspace(0, SPIN_UP - W, 501)
    axes, _, _, reference, actual = seen(spin, t)
    error = np.linalg.norm(np.asarray(actual) - reference, axis=1)
    np.testing.assert_allclose(error, R * np.asarray(axes.acceleration1), atol=1e-9)


@pytest.mark.parametrize(("start", "inverse"), [("rest", "flat"), ("pre-yawed", "exact")])
def test_a_flight_that_begins_with_nothing(start: str, inverse: str) -> None:
    raw = vector(z=trapezoid(8 * G, jerk=2 * G, start=1.0, hold=9.0))
    with pytest.raises(InputError, match="next to no load"):
        build_target(raw, span=(0.0, 8.0), idle=None, smoothing=0.1, gravity=False)
    spin = machine(start, inverse, raw=raw, gravity=False, spin_up=2.0, smoothing=0.1)
    t = np.linspace(0, 8, 4001)
    axes, jerk, base, reference, actual = seen(spin, t)
    assert np.isfinite(states(axes)).all() and np.isfinite(jerk).all() and np.isfinite(base.alpha_WB_B).all()
    after = t >= 2.0
    np.testing.assert_allclose(np.asarray(reference)[after, 2], smoothed(raw, 0.1)(t)[after, 2], atol=1e-9)
    if inverse == "exact":
        np.testing.assert_allclose(actual, reference, atol=1e-6 * 8 * G)


def test_spin_up_is_an_episode_and_nothing_before_it_counts() -> None:
    raw = vector(z=tabulated([0, 1, 2, 5, 7, 8], np.array([0.2, 0.2, 3, 3, 1.2, 1.2]) * G))
    spin = machine("rest", "flat", raw=raw, idle=1.4 * G)
    spin_up, held = spin.episodes()
    assert (spin_up.start, spin_up.end, spin_up.reason) == (0.0, SPIN_UP, "spin-up")
    assert held.reason == "below idle" and held.start > 6
    assert np.asarray(spin.not_followed(np.array([0.0, 2.9, 3.001, 5.0]))).tolist() == [True, True, False, False]
    assert all(each.start >= SPIN_UP for each in spin.shortfalls())
    use = {(u.axis, u.quantity): u for u in spin.usage()}
    assert use["axis 1", "rate"].used == pytest.approx((3**2 - 1) ** 0.25 * np.sqrt(G / R), rel=1e-6)
    assert use["axis 1", "acceleration"].time < SPIN_UP  # not where the flight is followed


def test_the_f16_record_from_rest() -> None:
    record = read_record(F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
    options = {"arm": R, "control_point": 0.15, "gravity": True, "idle": 1.4 * G, "span": (0.0, 15.99)}
    spin = Centrifuge(Flight(acceleration=record), **options, start="rest", spin_up=3.0)
    idle, t = Centrifuge(Flight(acceleration=record), **options), np.linspace(0, 15.99, 3001)
    axes, _, _, reference, _ = seen(spin, t)
    others, _, _, usual, _ = seen(idle, t)
    turn = (t > 3.2) & (t < 11)
    np.testing.assert_allclose(np.asarray(reference)[turn], np.asarray(usual)[turn], atol=1e-9)
    np.testing.assert_allclose(np.asarray(axes.rate1)[turn], np.asarray(others.rate1)[turn], atol=1e-9)


@pytest.mark.parametrize(
    ("options", "where", "words"),
    [
        ({"start": "yawed"}, "start", "idle, rest, pre-yawed"),
        ({"start": "idle"}, "spin_up", "neither"),
        ({"spin_up": 8.0}, "spin_up", "below 8 s"),
        ({"spin_up": 0.0}, "spin_up", "positive"),
        ({"spin_up": 0.3}, "spin_up", "twice the smoothing"),
        ({"spin_up": 0.8, "start": "pre-yawed", "inverse": "exact"}, "spin_up", "overshoot"),
    ],
)
def test_refusals(options: dict[str, object], where: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        machine(**{"start": "rest", "inverse": "flat", **options})  # type: ignore[arg-type]
    assert caught.value.where == where
