"""What a target keeps, holds, bridges and refuses."""

import numpy as np
import pytest

from gbeam.errors import InputError
from gbeam.motion import (
    STANDARD_GRAVITY,
    PiecewiseLinear,
    Profile,
    Sine,
    SmoothStep,
    Sum,
    Target,
    build_target,
    constant,
    smoothed,
    trapezoid,
    vector,
)
from gbeam.motion.centrifuge.target.load_limits import MIN_TRANSVERSE_LOAD, nearest_to_zero

G = STANDARD_GRAVITY
TRAPEZOID = vector(z=trapezoid(10 * G, jerk=4 * G, start=1.0, hold=4.0))
T = np.linspace(0, 12, 1201)


def target(
    raw: Profile,
    idle: float | None = None,
    smoothing: float | None = 0.06,
    gravity: bool = False,
    clip: bool = False,
) -> Target:
    return build_target(raw, span=(0.0, 12.0), idle=idle, smoothing=smoothing, gravity=gravity, clip=clip)


def sizes(load: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.asarray(load), axis=-1) / G


def test_a_load_above_idle_is_smoothed_and_nothing_else() -> None:
    raw = PiecewiseLinear([0.0, 3.0, 5.0, 12.0], [[0, 2, 3], [-1, 4, 3], [1, 1, 6], [0, 1, 3]] * np.array(G))
    for gravity in (False, True):
        made = target(raw, idle=1.4 * G, gravity=gravity)
        np.testing.assert_allclose(made.load(T), smoothed(raw, 0.06)(T), rtol=1e-14)
        assert made.episodes() == [] and not np.any(made.not_followed(T))


@pytest.mark.parametrize("gravity", [False, True])
def test_idle_is_held_below_and_the_load_kept_above(gravity: bool) -> None:
    made = target(TRAPEZOID, idle=1.4 * G, gravity=gravity)
    load, held = np.asarray(made.load(T)), np.asarray(made.not_followed(T))
    kept = smoothed(TRAPEZOID, 0.06)(T)
    np.testing.assert_allclose(load[~held], kept[~held], atol=1e-11)
    np.testing.assert_allclose(sizes(load)[T < 1.2], 1.4, rtol=1e-12)
    assert sizes(load).min() > 1.4 - 1e-12
    assert not np.any(load[:, :2])
    first, last = made.episodes()
    assert first.reason == last.reason == "below idle"
    assert first.start == 0 and first.end == pytest.approx(1.3675, abs=0.05)  # 1.47 g, and half a kernel
    assert last.end == 12
    inside = (first.start <= T) & (first.end - 0.02 > T)
    assert held[inside].all()


def test_the_hold_keeps_the_direction() -> None:
    raw = PiecewiseLinear([0.0, 12.0], [[0.3 * G, 0.4 * G, 0.0], [0.0, 0.6 * G, 0.8 * G]])
    inner = T[5:-5]  # away from the corners at either end
    load, given = np.asarray(target(raw, idle=2 * G).load(inner)), np.asarray(raw(inner))
    np.testing.assert_allclose(sizes(load), 2, rtol=1e-5)
    unit = [f / np.linalg.norm(f, axis=1, keepdims=True) for f in (load, given)]
    np.testing.assert_allclose(unit[0], unit[1], atol=1e-4)


def test_loads_gravity_exceeds_are_bridged_and_the_axial_one_is_kept() -> None:
    # Across the beam the load dips to 0.2 g between 4 s and 6 s and comes back turned by a right angle.
    raw = PiecewiseLinear(
        [0.0, 4.0, 5.0, 6.0, 12.0],
        np.array([[2, 0, 3], [2, 0, 3], [2, 0.15, 0.15], [2, 3, 0], [2, 3, 0]]) * G,
    )
    with pytest.raises(InputError, match=r"0\.212 g only at 5\.000 s.*clip = true"):
        target(raw, gravity=True)  # a held target only if asked for: by idle, or by clip
    made = target(raw, gravity=True, clip=True)
    load = np.asarray(made.load(T))
    across = np.hypot(load[:, 1], load[:, 2])
    assert across.min() > 1.01 * G
    np.testing.assert_allclose(load[:, 0], 2 * G)
    held = np.asarray(made.not_followed(T))
    np.testing.assert_allclose(load[~held], smoothed(raw, 0.06)(T)[~held], atol=1e-10)
    (episode,) = made.episodes()
    assert episode.reason == "out of reach of the gimbals" and 4.5 < episode.start < 5 < episode.end < 5.5


def test_a_held_path_does_not_overshoot_through_zero() -> None:
    """A dip of the load across the beam, so steep that the smoothest path would go through zero and back."""
    raw = vector(
        x=constant(3 * G), z=PiecewiseLinear([0.0, 2.0, 3.0, 5.0, 6.0, 8.0], np.array([6, 6, 0.5, 0.5, 6, 6]) * G)
    )
    made = build_target(raw, span=(0.0, 8.0), idle=1.4 * G, smoothing=0.06, gravity=True, arm=3.3)
    assert np.asarray(made.load(T))[:, 2].min() > 1.01 * G
    assert {episode.reason for episode in made.episodes()} == {"out of reach of the gimbals"}


def test_every_derivative_is_finite_where_the_load_is_held() -> None:
    load = target(TRAPEZOID, idle=1.4 * G, gravity=True).load
    assert np.isfinite(load.derivatives(np.linspace(0, 12, 25), 3)).all()


def test_curved_profiles_are_kept_exactly_or_sampled_finely() -> None:
    raw = vector(z=Sum((constant(3 * G), Sine(2 * G, 10.0, start=1.0))))
    np.testing.assert_allclose(target(raw).load(T), smoothed(raw, 0.06)(T), rtol=1e-14)
    made = target(raw, idle=2 * G)
    held = np.asarray(made.not_followed(T))
    assert held.any() and not held.all()
    np.testing.assert_allclose(made.load(T)[~held], smoothed(raw, 0.06)(T)[~held], atol=1e-4)


def test_corners_and_turning() -> None:
    assert target(TRAPEZOID, idle=1.4 * G).rounded
    sharp = target(TRAPEZOID, idle=1.4 * G, smoothing=None)
    assert not sharp.rounded and not sharp.turns
    assert target(TRAPEZOID, idle=1.4 * G, smoothing=None, gravity=True).turns  # the roll angle varies with size
    assert target(vector(z=Sum((constant(2 * G), SmoothStep(G, 3.0)))), smoothing=None).rounded
    assert target(vector(y=constant(G), z=constant(2 * G)), smoothing=0.0).rounded


REVERSING = vector(z=PiecewiseLinear([0.0, 5.0, 7.0, 12.0], [5 * G, 5 * G, -5 * G, -5 * G]))
JUMPING = vector(z=PiecewiseLinear([0.0, 5.0, 5.001, 12.0], [5 * G, 5 * G, -5 * G, -5 * G]))
AXIAL = PiecewiseLinear([0.0, 6.0, 12.0], [[5 * G, 0, 3 * G], [5 * G, 0, 0], [5 * G, 3 * G, 3 * G]])


@pytest.mark.parametrize(
    ("raw", "options", "where", "words"),
    [
        (TRAPEZOID, {}, "tracks", ["next to no load at 0.000 s", "idle"]),
        (TRAPEZOID, {"idle": G, "gravity": True}, "idle", ["1.1 g"]),
        (TRAPEZOID, {"idle": -1.0}, "idle", ["positive"]),
        (TRAPEZOID, {"smoothing": -0.1, "idle": 2 * G}, "smoothing", ["negative"]),
        (REVERSING, {"idle": 1.4 * G}, "tracks", ["reverses", "6.0"]),
        (REVERSING, {"idle": 1.4 * G, "gravity": True}, "tracks", ["reverses", "6.0"]),
        (REVERSING, {"gravity": True}, "tracks", ["reverses", "6.0"]),
        (JUMPING, {"idle": 1.4 * G, "gravity": True}, "tracks", ["reverses", "5.0"]),
        (JUMPING, {"idle": 1.4 * G}, "tracks", ["reverses", "5.0"]),
        (JUMPING, {}, "tracks", ["next to no load", "5.0"]),
        (vector(z=constant(G)), {"gravity": True}, "tracks", ["1.05 g", "idle"]),
        (vector(), {"idle": 2 * G}, "tracks", ["direction"]),
        (AXIAL, {}, "tracks", ["along its axis only at 5.99"]),
    ],
)
def test_refusals(raw: Profile, options: dict[str, float], where: str, words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        target(raw, **options)  # type: ignore[arg-type]
    assert caught.value.where == where
    for word in words:
        assert word in str(caught.value)


def test_span_must_run_forward() -> None:
    with pytest.raises(InputError, match="after the start"):
        build_target(TRAPEZOID, span=(3.0, 3.0), idle=2 * G, smoothing=0.06, gravity=False)


def test_nearest_to_zero_looks_between_knots() -> None:
    when, distance = nearest_to_zero(np.array([0.0, 1.0, 3.0]), np.array([[4.0, 1.0], [2.0, 1.0], [-2.0, 1.0]]))
    assert (when, distance) == pytest.approx((2.0, 1.0))
    assert MIN_TRANSVERSE_LOAD > G
