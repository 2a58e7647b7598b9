"""When a linear model's stiffness stops being positive definite: the speed at which it stops being valid."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.mechanics.equations import Coefficients
from gbeam.results.response import BaseHistory, Floats


@eqx.filter_jit
def lowest_stiffness(coefficients: Coefficients, a_WO_B: Array, w_WB_B: Array, alpha_WB_B: Array) -> Array:
    """Lowest eigenvalue of K, M-normalised, at base motions (t, 3): negative where K is not positive definite, rad²/s².

    The antisymmetric part of K, from the angular acceleration, stores no energy and is left out.
    """
    scale = jnp.linalg.inv(jnp.linalg.cholesky(coefficients.mass))

    def lowest(a: Array, w: Array, al: Array) -> Array:
        _, k, _ = coefficients.at(a, w, al)
        return jnp.linalg.eigvalsh(scale @ (k + k.T) @ scale.T / 2)[0]

    return jax.vmap(lowest)(a_WO_B, w_WB_B, alpha_WB_B)


def first_loss(coefficients: Coefficients, time: Floats, base: BaseHistory) -> tuple[float, float] | None:
    """First time at which K loses definiteness and the base's rate there, rad/s; None if it never does.

    Found between the samples by interpolating the lowest eigenvalue.
    """
    lowest = np.asarray(lowest_stiffness(coefficients, *map(jnp.asarray, (base.a_WO_B, base.w_WB_B, base.alpha_WB_B))))
    lost = np.flatnonzero(lowest < 0)
    if not lost.size:
        return None
    i, rate = int(lost[0]), np.linalg.norm(base.w_WB_B, axis=1)
    if i == 0:
        return float(time[0]), float(rate[0])
    share = lowest[i - 1] / (lowest[i - 1] - lowest[i])
    return float(time[i - 1] + share * (time[i] - time[i - 1])), float(rate[i - 1] + share * (rate[i] - rate[i - 1]))
