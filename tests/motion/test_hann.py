"""The rounded ramp: its derivatives, its ends, and what it does as a soft floor."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import quad

from gbeam.motion import hann, soft_floor

X = np.array([-0.7, -0.5, -0.31, -0.1, 0.0, 0.2, 0.45, 0.5, 0.8])


def test_kernel_is_the_hann_kernel_of_integral_one() -> None:
    np.testing.assert_allclose(hann(2, X), np.where(np.abs(X) < 0.5, 1 + np.cos(2 * np.pi * X), 0), atol=1e-15)
    assert quad(lambda x: float(hann(2, jnp.asarray(x))), -0.5, 0.5)[0] == pytest.approx(1, abs=1e-12)


def test_ramp_is_the_ramp_convolved_with_the_kernel() -> None:
    for x in X:
        ramp = quad(
            lambda s, x=x: max(x - s, 0) * (1 + np.cos(2 * np.pi * s)),
            -0.5,
            0.5,
            points=[np.clip(x, -0.5, 0.5)],
        )
        assert float(hann(0, jnp.asarray(x))) == pytest.approx(ramp[0], abs=1e-12)


@pytest.mark.parametrize("order", range(6))
def test_next_order_is_the_derivative(order: int) -> None:
    x = X[np.abs(np.abs(X) - 0.5) > 1e-3]
    finite = (hann(order, x + 1e-6) - hann(order, x - 1e-6)) / 2e-6
    np.testing.assert_allclose(hann(order + 1, x), finite, atol=1e-6 * (2 * np.pi) ** order)
    np.testing.assert_array_equal(
        jax.jvp(lambda s: hann(order, s), (jnp.asarray(X),), (jnp.ones(X.size),))[1], hann(order + 1, X)
    )


def test_third_derivative_is_continuous_at_the_ends() -> None:
    edge = np.array([-0.5, 0.5])
    np.testing.assert_allclose(hann(3, edge - 1e-9), hann(3, edge + 1e-9), atol=1e-6)


def test_soft_floor() -> None:
    value = np.array([0.0, 0.94, 0.95, 1.0, 1.05, 2.0])
    raised = np.asarray(soft_floor(value, 1.0, 0.1))
    np.testing.assert_allclose(raised[[0, 1, 2, 4, 5]], [1, 1, 1, 1.05, 2], atol=1e-15)
    assert 1.0 < raised[3] < 1.01
