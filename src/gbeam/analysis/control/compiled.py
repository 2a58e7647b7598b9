"""Derivatives of outputs and rates of the state of a complete model: compiled once per size."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from gbeam.arrays.derivatives import with_slope

Array = Any


@jax.jit
def output_matrices(outputs: Any, z: Array) -> tuple[Array, Array]:
    """Values (p,) of outputs at (y, ẏ, ÿ, u), and their derivatives."""
    return with_slope(outputs.stacked)(z)


@jax.jit
def rates(outputs: Any, x: Array, u: Array) -> tuple[Array, Array]:
    """Rate of the state (y, ẏ, and on a base that is not a free hub its angular velocity), and the outputs."""
    residual, i = outputs.residual, outputs.residual.first
    n = outputs.structure.size + i
    y, yd, rate = x[:n], x[n : 2 * n], x[2 * n :]
    full = u if i else jnp.concatenate([u[:3], rate, u[3:]])
    inputs = residual.unpack(full)
    rest, mass = with_slope(lambda ydd: residual(y, yd, ydd, inputs))(jnp.zeros(n))
    ydd = jnp.linalg.solve(mass, -rest)
    return jnp.concatenate([yd, ydd, u[3:6] if not i else jnp.zeros(0)]), outputs(y, yd, ydd, full)
