"""Centrifuge kinematics against positions and attitudes differentiated twice in the inertial frame.

The source's errata: the paper puts the control point at the intersection of axes 1 and 2, which are parallel;
axes 2 and 3 are meant.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

from gbeam.motion import Axes, forward_kinematics, shift_base


def turn(angle: jax.Array, axis: int) -> jax.Array:
    """Matrix whose columns are the axes turned by `angle` about one of them."""
    c, s = jnp.cos(angle), jnp.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    return jnp.eye(3).at[i, i].set(c).at[i, j].set(-s).at[j, i].set(s).at[j, j].set(c)


ARM = 3.3


@jax.jit
def differentiated(motion: jax.Array, offset: jax.Array) -> tuple[jax.Array, ...]:
    """R_WB, its derivative, ω's derivative as a matrix, and the acceleration, of angles that are parabolas in time."""
    angle, rate, acceleration = motion

    def angles(t: jax.Array) -> jax.Array:
        return angle + rate * t + acceleration * t**2 / 2

    def attitude(t: jax.Array) -> jax.Array:  # R_WB; a1, a2, Z are the columns of the first factor
        q = angles(t)
        return turn(q[0], 2) @ turn(q[1], 2) @ turn(q[2], 0)

    def position(t: jax.Array) -> jax.Array:
        return turn(angles(t)[0], 2) @ jnp.array([ARM, 0.0, 0.0]) + attitude(t) @ offset

    skew = jax.jacfwd(lambda t: attitude(t).T @ jax.jacfwd(attitude)(t))(0.0)
    return attitude(0.0), jax.jacfwd(attitude)(0.0), skew, jax.jacfwd(jax.jacfwd(position))(0.0)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("gravity", [0.0, STANDARD_GRAVITY])
def test_forward_and_shift_against_double_differentiation(seed: int, gravity: float) -> None:
    rng = np.random.default_rng(seed)
    a, r, dd = motion = rng.normal(size=(3, 3))
    offset = rng.normal(size=3)
    R_WB, dR, skew, a_W = (np.asarray(value) for value in differentiated(motion, offset))
    w = R_WB.T @ dR
    a_W = a_W + np.array([0, 0, gravity])  # a − g, g down

    axes = Axes(r[0], dd[0], a[1], r[1], dd[1], a[2], r[2], dd[2])
    base = shift_base(forward_kinematics(axes, ARM, gravity), offset)
    np.testing.assert_allclose(base.w_WB_B, [w[2, 1], w[0, 2], w[1, 0]], atol=1e-12)
    np.testing.assert_allclose(base.alpha_WB_B, [skew[2, 1], skew[0, 2], skew[1, 0]], atol=1e-12)
    np.testing.assert_allclose(base.a_WO_B, R_WB.T @ a_W, atol=1e-12)


def test_many_times_at_once() -> None:
    states = jnp.asarray(np.random.default_rng(1).normal(size=(8, 4, 5)))
    whole, one = forward_kinematics(Axes(*states), 3.3, 9.8), forward_kinematics(Axes(*states[:, 2, 3]), 3.3, 9.8)
    assert whole.a_WO_B.shape == (4, 5, 3)
    np.testing.assert_allclose(whole.alpha_WB_B[2, 3], one.alpha_WB_B, atol=1e-14)
    np.testing.assert_allclose(shift_base(whole, np.zeros(3)).a_WO_B, whole.a_WO_B)
