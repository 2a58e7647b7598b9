"""Piecewise-linear profiles and the closed form of their smoothing."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

import gbeam as gb
import gbeam.arrays.jax_setup
from gbeam.motion import PiecewiseLinear, Profile

TRAPEZOID = gb.trapezoid(level=10.0, jerk=4.0, start=1.0, hold=4.0)
WIDTH = 0.06


@st.composite
def tables(draw: st.DrawFn) -> PiecewiseLinear:
    """Five knots at random spacing (one shape for all, so that nothing compiles twice)."""
    gaps = draw(st.lists(st.floats(0.01, 2.0), min_size=5, max_size=5))
    values = draw(st.lists(st.floats(-50, 50), min_size=5, max_size=5))
    return PiecewiseLinear(np.cumsum(gaps), values)


def rates(profile: Profile, t: np.ndarray) -> tuple[np.ndarray, ...]:
    """Value and first three derivatives."""
    return profile.derivatives(t, 3)


def test_constant_trapezoid_table() -> None:
    t = np.array([-1.0, 1.0, 2.0, 3.5, 7.5, 8.75, 20.0])
    np.testing.assert_allclose(gb.constant(3.0)(t), 3.0)
    np.testing.assert_allclose(TRAPEZOID(t), [0, 0, 4, 10, 10, 5, 0], atol=1e-14)
    np.testing.assert_allclose(gb.trapezoid(-10.0, jerk=4.0, start=1.0, hold=4.0)(t), -TRAPEZOID(t), atol=1e-14)
    np.testing.assert_allclose(
        gb.trapezoid(2.0, jerk=2.0, start=0.0, hold=0.0)(np.array([0.5, 1.0, 1.5, 2.5])), [1, 2, 1, 0]
    )
    np.testing.assert_allclose(gb.tabulated([0, 1, 3], [1, 2, 0])(t), np.interp(t, [0, 1, 3], [1, 2, 0]))
    assert TRAPEZOID(2.0).shape == ()


@settings(max_examples=30)
@given(tables(), st.floats(0.02, 0.5))
def test_smoothing_equals_the_convolution(profile: PiecewiseLinear, width: float) -> None:
    t0 = float(profile.times[2]) + 0.1 * width
    corners = [float(t) for t in profile.times if abs(t - t0) < width / 2]

    def integrand(t: float) -> float:
        value = np.interp(t, np.asarray(profile.times), np.asarray(profile.values))
        return float(value * (1 + np.cos(2 * np.pi * (t - t0) / width)) / width)

    expected = quad(integrand, t0 - width / 2, t0 + width / 2, points=corners, epsabs=1e-11)[0]
    assert float(gb.smoothed(profile, width)(t0)) == pytest.approx(expected, abs=1e-9)


@settings(max_examples=30)
@given(tables(), tables(), st.floats(-3, 3))
def test_smoothing_is_linear_and_keeps_the_order_of_values(a: PiecewiseLinear, b: PiecewiseLinear, k: float) -> None:
    t = np.linspace(0, 12, 200)
    knots = np.union1d(a.times, b.times)
    mixed = PiecewiseLinear(knots, np.asarray(a(knots)) + k * np.asarray(b(knots)))
    parts = gb.smoothed(a, 0.1)(t) + k * gb.smoothed(b, 0.1)(t)
    np.testing.assert_allclose(gb.smoothed(mixed, 0.1)(t), parts, atol=1e-7)  # knots may be 1e-9 s apart
    rising = PiecewiseLinear(a.times, np.sort(np.asarray(a.values)))
    assert np.diff(np.asarray(gb.smoothed(rising, 0.1)(t))).min() > -1e-12


@settings(max_examples=20)
@given(tables())
def test_integral_is_preserved_and_straight_stretches_stay(profile: PiecewiseLinear) -> None:
    t = np.linspace(float(profile.times[0]) - 1, float(profile.times[-1]) + 1, 40001)
    before, after = np.asarray(profile(t)), np.asarray(gb.smoothed(profile, WIDTH)(t))
    rule = np.ptp(t[:2]) ** 2 * float(np.abs(profile.slopes).max()) + 1e-12  # error of the trapezium rule
    assert np.trapezoid(after - before, t) == pytest.approx(0, abs=rule)
    far = np.min(np.abs(t[:, None] - np.asarray(profile.times)), axis=1) >= WIDTH / 2
    np.testing.assert_allclose(after[far], before[far], atol=1e-12 * (1 + np.abs(before).max()))


def test_smoothing_of_a_straight_line_is_the_line() -> None:
    t = np.linspace(1, 9, 50)
    line = PiecewiseLinear(np.linspace(0, 10, 101), 3 + 2 * np.linspace(0, 10, 101))
    np.testing.assert_allclose(gb.smoothed(line, 0.5)(t), 3 + 2 * t, atol=1e-13)


def test_derivatives_at_a_corner_have_closed_forms() -> None:
    # Slope 0 to 4 at t = 1: f'' = 4 k, f''' = 4 k' with k the Hann kernel.
    t = 1 + WIDTH * np.array([-0.5, -0.4, -0.1, 0.0, 0.25, 0.5])
    phase = 2 * np.pi * (t - 1) / WIDTH
    _, slope, bend, third = rates(gb.smoothed(TRAPEZOID, WIDTH), t)
    np.testing.assert_allclose(slope, 4 * ((t - 1) / WIDTH + 0.5 + np.sin(phase) / (2 * np.pi)), atol=1e-12)
    np.testing.assert_allclose(bend, 4 * (1 + np.cos(phase)) / WIDTH, atol=1e-10)
    np.testing.assert_allclose(third, -8 * np.pi * np.sin(phase) / WIDTH**2, atol=1e-8)


def test_third_derivative_is_continuous() -> None:
    edges = np.concatenate([np.asarray(TRAPEZOID.times) - WIDTH / 2, np.asarray(TRAPEZOID.times) + WIDTH / 2])
    rounded = gb.smoothed(TRAPEZOID, WIDTH)
    jump = rates(rounded, edges + 1e-9)[3] - rates(rounded, edges - 1e-9)[3]
    assert np.abs(jump).max() < 1e-6 * 8 * np.pi / WIDTH**2


def test_vector_tables_scalar_times_and_compiled_maps_agree() -> None:
    rng = np.random.default_rng(0)
    raw = PiecewiseLinear(np.arange(50) * 0.01, rng.normal(size=(50, 3)))
    rounded = gb.smoothed(raw, WIDTH)
    t = np.linspace(-0.1, 0.6, 37)
    whole = np.asarray(rounded(t))
    assert whole.shape == (37, 3) and raw(t).shape == (37, 3) and rounded(0.1).shape == (3,)
    np.testing.assert_allclose(jax.jit(jax.vmap(rounded))(jnp.asarray(t)), whole, atol=1e-12)
    columns = [gb.smoothed(PiecewiseLinear(raw.times, raw.values[:, i]), WIDTH)(t) for i in range(3)]
    np.testing.assert_allclose(whole, np.stack(columns, axis=-1), atol=1e-12)
    np.testing.assert_allclose(rounded(t.reshape(1, 37))[0], whole)


def test_breaks() -> None:
    np.testing.assert_allclose(TRAPEZOID.breaks, [1, 3.5, 7.5, 10])
    assert gb.smoothed(TRAPEZOID, WIDTH).breaks.size == 0


@pytest.mark.parametrize(
    ("build", "where"),
    [
        (lambda: PiecewiseLinear([0, 1, 1], [0, 1, 2]), "times[2]"),
        (lambda: PiecewiseLinear([0, 1], [0, 1, 2]), "values"),
        (lambda: PiecewiseLinear([0, 1], [0, np.nan]), "values[1]"),
        (lambda: PiecewiseLinear([], []), "times"),
        (lambda: gb.constant(np.inf), "level"),
        (lambda: gb.trapezoid(10, jerk=0, start=0, hold=1), "jerk"),
        (lambda: gb.trapezoid(10, jerk=-4, start=0, hold=1), "jerk"),
        (lambda: gb.trapezoid(0, jerk=4, start=0, hold=1), "level"),
        (lambda: gb.trapezoid(10, jerk=4, start=np.nan, hold=1), "start"),
        (lambda: gb.trapezoid(10, jerk=4, start=0, hold=-1), "hold"),
        (lambda: gb.trapezoid("ten", jerk=4, start=0, hold=1), "level"),  # type: ignore[arg-type]
        (lambda: gb.smoothed(TRAPEZOID, 0.0), "smoothing"),
    ],
)
def test_refusals(build: object, where: str) -> None:
    with pytest.raises(gb.InputError) as caught:
        build()  # type: ignore[operator]
    assert caught.value.where == where


def test_times_so_near_that_the_slope_is_not_finite() -> None:
    with pytest.raises(gb.InputError, match=r"times\[1\] is 4.94066e-324 s, so near 0 s that the slope is not finite"):
        gb.tabulated([0.0, 5e-324, 1.0], [0.0, 1.0, 0.0])
