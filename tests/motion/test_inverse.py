"""Inverse kinematics: exact where theory says so, and wrong by what theory says elsewhere.

Ledger of the source: its claim that the control point is "always consistent" cannot hold for its own sharp
trapezoid: a turning point of the load a can be followed only where −ä <= a²/R.
"""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.motion import INVERSES, Axes, Profile
from gbeam.results import Base

G, R = STANDARD_GRAVITY, 3.3
T = np.linspace(0.2, 1.8, 33)
SEARCH = 1e-4  # g0: where the search for a plan ends


def centrifuge(
    raw: Profile, inverse: str, gravity: bool = False, sign: int = 1, control_point: float = 0.0
) -> gb.Centrifuge:
    return gb.Centrifuge(
        gb.Flight(acceleration=raw), arm=R, control_point=control_point, inverse=inverse, gravity=gravity,
        smoothing=None, mounting="upright" if sign == 1 else "inverted", span=(0.0, 2.0),
    )  # fmt: skip


def seen(machine: gb.Centrifuge, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, Axes, Base]:
    """Wanted and achieved loads, axes and base."""
    return machine.reference(t), machine.actual(t), machine.axes(t), machine.base(t)


def swinging() -> Profile:
    """A load that varies smoothly in size and direction over all of T."""
    y, z = gb.Sine(2 * G, 4.0, start=-1.0), gb.Sum((gb.constant(5 * G), gb.Sine(1.5 * G, 5.0, start=-2.0)))
    return gb.vector(x=gb.Sine(G, 6.0, start=-1.0), y=y, z=z)


@settings(max_examples=40)
@given(
    load=st.tuples(*[st.floats(-8, 8)] * 3), sign=st.sampled_from([1, -1]), gravity=st.booleans(),
    inverse=st.sampled_from(sorted(INVERSES)),
)  # fmt: skip
@example(load=(0.0, 1.0625, 0.25), sign=1, gravity=True, inverse="exact")
@example(load=(0.0, 1.05, 0.0), sign=-1, gravity=True, inverse="flat")
def test_constant_loads_are_exact(load: tuple[float, float, float], sign: int, gravity: bool, inverse: str) -> None:
    assume(np.hypot(load[1], load[2]) > (1.05 - 1e-9 if gravity else 0.1))  # what the gimbals reach
    f = np.array(load) * G
    machine = centrifuge(gb.constant(f), inverse, gravity, sign)
    _, actual, _, base = seen(machine, 1.0)
    np.testing.assert_allclose(actual, f, atol=SEARCH * G if inverse == "planned" else 1e-9)
    # the splines' rounding, two derivatives on; what the search for a plan leaves
    np.testing.assert_allclose(base.alpha_WB_B, 0, atol=1e-2 if inverse == "planned" else 1e-5)
    assert inverse in ("exact", "planned") or not np.any(base.alpha_WB_B)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("inverse", sorted(INVERSES))
def test_six_g_through_the_thickness(inverse: str, sign: int) -> None:
    base = seen(centrifuge(gb.constant([0.0, 0.0, 6 * G]), inverse, sign=sign), 1.0)[3]
    left = SEARCH * G if inverse == "planned" else 1e-12
    np.testing.assert_allclose(base.w_WB_B, [0, -sign * np.sqrt(6 * G / R), 0], atol=left)
    np.testing.assert_allclose(base.a_WO_B, [0, 0, 6 * G], atol=left)  # the control point is the root here


@pytest.mark.parametrize("inverse", sorted(INVERSES))
def test_a_load_along_the_beam_is_free_of_nan(inverse: str) -> None:
    load = gb.vector(x=gb.Sum((gb.constant(-4 * G), gb.Sine(G, 4.0, start=-1.0))))
    base = seen(centrifuge(load, inverse), T)[3]
    for part in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B):
        assert np.isfinite(part).all()


def test_flat_has_the_direction_and_is_high_by_the_lag() -> None:
    reference, actual, axes, _ = seen(centrifuge(swinging(), "flat"), T)
    excess = np.linalg.norm(actual, axis=1) / np.linalg.norm(reference, axis=1)
    np.testing.assert_allclose(np.cross(actual, reference), 0, atol=1e-9)
    np.testing.assert_allclose(excess, np.hypot(1, axes.acceleration1 / axes.rate1**2), rtol=1e-12)
    assert excess.max() - 1 > 1e-4  # or this would test nothing


def test_flat_with_gravity_has_the_direction_of_the_horizontal_load() -> None:
    reference, actual, _, _ = seen(centrifuge(swinging(), "flat", gravity=True), T)

    def horizontal(f: np.ndarray) -> np.ndarray:
        return np.stack([f[:, 0], np.sqrt(f[:, 1] ** 2 + f[:, 2] ** 2 - G**2)])

    (x0, b0), (x1, b1) = horizontal(reference), horizontal(actual)
    np.testing.assert_allclose(x0 * b1 - x1 * b0, 0, atol=1e-9)


def test_quasi_static_errs_along_the_beam_by_the_tangential_acceleration() -> None:
    load = gb.Sum((gb.constant(5 * G), gb.Sine(0.5 * G, 8.0, start=-3.0)))
    machine = centrifuge(gb.vector(z=load), "quasi-static")
    reference, actual, axes, _ = seen(machine, T)
    tangential, error = R * np.asarray(axes.acceleration1), np.asarray(actual - reference)
    np.testing.assert_allclose(machine.tracking_error(T), error, atol=1e-12)
    np.testing.assert_allclose(np.abs(error[:, 0]), np.abs(tangential), atol=1e-12)
    np.testing.assert_allclose(error[:, 1:], 0, atol=1e-12)


@pytest.mark.parametrize("gravity", [False, True])
@pytest.mark.parametrize("inverse", sorted(INVERSES))
def test_rates_are_the_derivatives_of_the_angles(inverse: str, gravity: bool) -> None:
    machine, h = centrifuge(swinging(), inverse, gravity), 1e-5
    before, axes, after = (seen(machine, T + s)[2] for s in (-h, 0, h))
    for value, rate in (
        ("rate1", "acceleration1"), ("angle2", "rate2"), ("rate2", "acceleration2"),
        ("angle3", "rate3"), ("rate3", "acceleration3"),
    ):  # fmt: skip
        finite = (getattr(after, value) - getattr(before, value)) / (2 * h)
        np.testing.assert_allclose(getattr(axes, rate), finite, atol=2e-7)
