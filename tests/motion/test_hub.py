"""Hubs: the prescribed one against positions differentiated twice in the inertial frame."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from gbeam.errors import InputError
from gbeam.motion import HubRate, HubTorque, Sine, SmoothStep, constant

RATE = SmoothStep(level=3.0, duration=30.0)


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_root_acceleration_is_that_of_the_rim(radius: float) -> None:
    hub = HubRate(radius, RATE)
    T, level = 30.0, 3.0

    def angle(t: jax.Array) -> jax.Array:  # the integral of 2009 (43)
        return level / T * (t**2 / 2 + (T / (2 * jnp.pi)) ** 2 * (jnp.cos(2 * jnp.pi * t / T) - 1))

    def rim(t: jax.Array) -> jax.Array:
        return radius * jnp.array([jnp.cos(angle(t)), jnp.sin(angle(t)), 0.0])

    for t in (2.0, 11.0, 29.0):
        a_W = jax.jacfwd(jax.jacfwd(rim))(t)
        c, s = np.cos(angle(t)), np.sin(angle(t))
        base = hub.base(t)
        np.testing.assert_allclose(base.a_WO_B, np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ a_W, atol=1e-12)
        np.testing.assert_allclose(base.w_WB_B, [0, 0, jax.grad(angle)(t)], atol=1e-12)
        np.testing.assert_allclose(base.alpha_WB_B, [0, 0, jax.grad(jax.grad(angle))(t)], atol=1e-12)


def test_vector_of_times_and_steady_rate() -> None:
    base = HubRate(0.5, constant(4.0)).base(np.linspace(0, 1, 7))
    np.testing.assert_allclose(base.a_WO_B, np.tile([-8.0, 0.0, 0.0], (7, 1)))
    assert not np.any(base.alpha_WB_B)


def test_free_hub_keeps_its_numbers() -> None:
    hub = HubTorque(radius=0.5, inertia=200.0, torque=Sine(200.0, 10.0))
    assert float(hub.torque(2.5)) == pytest.approx(200.0) and float(hub.inertia) == 200.0
    np.testing.assert_allclose(hub.breaks, [0, 10])


def test_refusals() -> None:
    for build, where in (
        (lambda: HubRate(-0.1, RATE), "radius"),
        (lambda: HubTorque(0.5, 0.0, RATE), "inertia"),
        (lambda: HubTorque(np.nan, 1.0, RATE), "radius"),
    ):
        with pytest.raises(InputError) as caught:
            build()
        assert caught.value.where == where
