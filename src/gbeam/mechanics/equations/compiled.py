"""Complete models differentiated by JAX, compiled once per size."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from gbeam.arrays.jax_setup import linear_root, with_slope
from gbeam.integrate.newton import mass_and_acceleration
from gbeam.motion.bases.base import Base

Array = Any


STRIDES, ITERATIONS = 8, 8  # of the load, and of Newton's method in each
CLOSE, NOTHING = 1e-9, 1e-13  # of the coordinates, and m or rad: a last correction that is smaller has converged


@jax.jit
def evaluated(residual: Any, z: Array, u: Array) -> tuple[Array, Array]:
    """A residual (n,) at (y, ẏ, ÿ) and its inputs' vector u, and its derivatives there, (n, 3n + inputs)."""
    n = z.shape[0] // 3

    def stacked(x: Array) -> Array:
        return residual(x[:n], x[n : 2 * n], x[2 * n : 3 * n], residual.unpack(x[3 * n :]))

    # One derivative with respect to everything: the residual is compiled once, not four times.
    return with_slope(stacked)(jnp.concatenate([z, u]))


@jax.jit
def resting(residual: Any, base: Base, loads: Array | None) -> Array:
    """Coordinates (n,) at which a residual on a base vanishes at rest; NaN where Newton's method does not converge."""
    still = jnp.zeros(residual.equations.size)

    def force(q: Array, share: Any) -> Array:
        part = Base(share * base.a_WO_B, jnp.sqrt(share) * base.w_WB_B, share * base.alpha_WB_B)
        return residual(q, still, still, (part, None if loads is None else share * loads))

    return _root(force, still)


@partial(jax.jit, static_argnames="axes")
def displaced(structure: Any, axes: tuple[int, ...], wanted: Array) -> Array:
    """Coordinates (n,) of least strain energy at which the tip is displaced along axes by `wanted`; NaN likewise."""
    n, equations = structure.size, structure.equations

    def energy(z: Array, share: Any) -> Array:
        q, pull = z[:n], z[n:]
        return equations.strain_energy(q) - pull @ (structure.tip(q)[jnp.array(axes)] - share * wanted)

    return _root(jax.grad(energy), jnp.zeros(n + len(axes)))[:n]


def _root(function: Any, start: Array) -> Array:
    """Root of a function of x and a share of its drive, as the share grows to one; derivatives are implicit."""

    def newton(of: Any, start: Array) -> tuple[Array, Array]:
        def correct(k: Any, state: tuple[Array, Array]) -> tuple[Array, Array]:
            x, _ = state
            value, slope = with_slope(partial(function, share=(k // ITERATIONS + 1) / STRIDES))(x)
            correction = jnp.linalg.solve(slope, value)
            return x - correction, jnp.abs(correction).max()

        return jax.lax.fori_loop(0, STRIDES * ITERATIONS, correct, (start, jnp.inf))

    x, left = jax.lax.custom_root(partial(function, share=1.0), start, newton, linear_root, has_aux=True)
    return jnp.where(left <= NOTHING + CLOSE * jnp.abs(x).max(), 1.0, jnp.nan) * x


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
    _, ydd = mass_and_acceleration(residual, y, yd, residual.unpack(full))
    return jnp.concatenate([yd, ydd, u[3:6] if not i else jnp.zeros(0)]), outputs(y, yd, ydd, full)


_BLOCK = 256  # states handled together: one compiled shape


def about(residual: Any, q: Array, qd: Array, inputs: Any) -> tuple[Array, Array, Array, Array]:
    """M, C, K (t, n, n) and the accelerations q̈ (t, n) of equations at states and inputs with a leading axis t."""
    return _by_blocks(_about, residual, q, qd, inputs)


def residuals(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
    """Residuals (t, n) at states and inputs with a leading axis t."""
    return _by_blocks(_residuals, residual, q, qd, qdd, inputs)


@jax.jit
def _about(residual: Any, q: Array, qd: Array, inputs: Any) -> Any:
    def at(q: Array, qd: Array, inputs: Any) -> Any:
        mass, qdd = mass_and_acceleration(residual, q, qd, inputs)
        k, c = jax.jacfwd(lambda q, qd: residual(q, qd, qdd, inputs), argnums=(0, 1))(q, qd)
        return mass, c, k, qdd

    return jax.vmap(at)(q, qd, inputs)


@jax.jit
def _residuals(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> Any:
    return jax.vmap(residual)(q, qd, qdd, inputs)


def _by_blocks(function: Callable[..., Any], residual: Any, *values: Any) -> Any:
    size = len(values[0])
    pieces = []
    for first in range(0, size, _BLOCK):
        index = np.minimum(np.arange(first, first + _BLOCK), size - 1)  # the last fills the block
        piece = function(residual, *jax.tree.map(lambda leaf, index=index: leaf[index], values))
        pieces.append(jax.tree.map(lambda leaf, kept=size - first: np.asarray(leaf[:kept]), piece))
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *pieces)
