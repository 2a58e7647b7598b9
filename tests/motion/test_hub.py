"""Hubs: the prescribed one against positions differentiated twice in the inertial frame."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import gbeam as gb

RATE = gb.SmoothStep(level=3.0, duration=30.0)


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_root_acceleration_is_that_of_the_rim(radius: float) -> None:
    hub = gb.Hub(radius=radius, rate=RATE)
    T, level = 30.0, 3.0

    def angle(t: jax.Array) -> jax.Array:  # the integral of 2009 (43)
        return level / T * (t**2 / 2 + (T / (2 * jnp.pi)) ** 2 * (jnp.cos(2 * jnp.pi * t / T) - 1))

    def rim(t: jax.Array) -> jax.Array:
        return radius * jnp.array([jnp.cos(angle(t)), jnp.sin(angle(t)), 0.0])

    @jax.jit
    def differentiated(t: jax.Array) -> tuple[jax.Array, ...]:
        return angle(t), jax.grad(angle)(t), jax.grad(jax.grad(angle))(t), jax.jacfwd(jax.jacfwd(rim))(t)

    for t in (2.0, 11.0, 29.0):
        turned, w, alpha, a_W = (np.asarray(value) for value in differentiated(t))
        c, s = np.cos(turned), np.sin(turned)
        base = hub.base(t)
        np.testing.assert_allclose(base.a_WO_B, np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ a_W, atol=1e-12)
        np.testing.assert_allclose(base.w_WB_B, [0, 0, w], atol=1e-12)
        np.testing.assert_allclose(base.alpha_WB_B, [0, 0, alpha], atol=1e-12)


def test_vector_of_times_and_steady_rate() -> None:
    base = gb.Hub(radius=0.5, rate=gb.constant(4.0)).base(np.linspace(0, 1, 7))
    np.testing.assert_allclose(base.a_WO_B, np.tile([-8.0, 0.0, 0.0], (7, 1)))
    assert not np.any(base.alpha_WB_B)


def test_free_hub_keeps_its_numbers() -> None:
    hub = gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(200.0, 10.0))
    assert float(hub.torque(2.5)) == pytest.approx(200.0) and float(hub.inertia) == 200.0
    np.testing.assert_allclose(hub.corners(0.1), [0, 10])


def test_refusals() -> None:
    for build, where in (
        (lambda: gb.Hub(radius=-0.1, rate=RATE), "radius"),
        (lambda: gb.Hub(radius=1e300, rate=RATE), "radius"),
        (lambda: gb.Hub(radius=0.5, inertia=0.0, torque=RATE), "inertia"),
        (lambda: gb.Hub(radius=np.nan, inertia=1.0, torque=RATE), "radius"),
    ):
        with pytest.raises(gb.InputError) as caught:
            build()
        assert caught.value.where == where


def test_numbers_stand_for_constant_profiles_and_order_does_not_matter() -> None:
    hub = gb.Hub(rate=4.0, radius=0.5, inertia=3.0)
    np.testing.assert_allclose(hub.base(0.0).a_WO_B, [-8.0, 0.0, 0.0])
    assert not hub.free and hub.torque is None and hub.inertia == 3.0
    driven = gb.Hub(radius=0.5, inertia=3.0, torque=20.0)
    assert driven.free and driven.rate is None and float(driven.torque(1.0)) == 20.0
    assert gb.Hub(radius=0.5, inertia=3.0).free and float(gb.Hub(radius=0.5, inertia=3.0).torque(0.0)) == 0.0
    still = gb.Hub(radius=0.5)
    assert not still.free and not np.any(still.base(2.0).w_WB_B)
    assert still.kind == "hub" and still.over(0.0, 1.0) is still
    np.testing.assert_allclose(hub.angle(np.array([0.0, 2.5])), [0.0, 10.0], atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "where", "words"),
    [
        ({"rate": 1.0, "torque": 2.0, "inertia": 3.0}, "torque", "beside rate"),
        ({"torque": 2.0}, "inertia", "is missing"),
        ({"rate": 1.0, "stiffness": 3.0}, "stiffness", "not free"),
        ({"damping": 3.0}, "damping", "inertia and no rate"),
        ({"pointing": "up"}, "pointing", "outward, inward"),
    ],
)
def test_what_does_not_go_together_is_refused(arguments: dict[str, object], where: str, words: str) -> None:
    with pytest.raises(gb.InputError, match=words) as caught:
        gb.Hub(radius=0.5, **arguments)  # type: ignore[arg-type]
    assert caught.value.where == where


def test_a_free_hub_has_no_motion_of_its_own() -> None:
    with pytest.raises(gb.InputError, match="how the hub turns is a result"):
        gb.Hub(radius=0.5, inertia=3.0).base(0.0)
