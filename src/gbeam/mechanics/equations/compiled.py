"""Equilibria of complete models where JAX traces them, compiled once per size."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from gbeam.arrays.jax_setup import linear_root, with_slope
from gbeam.arrays.namespace import Array
from gbeam.results.parts import Base

STRIDES, ITERATIONS = 8, 8  # of the load, and of Newton's method in each
CLOSE, NOTHING = 1e-9, 1e-13  # of the coordinates, and m or rad: a last correction that is smaller has converged


@jax.jit
def resting(equations: Any, base: Base, loads: Array | None) -> Array:
    """Coordinates (n,) of the equilibrium on a base with constant motion, or NaN where Newton's method
    does not converge.
    """
    zeros = jnp.zeros(equations.size)

    def force(q: Array, share: Any) -> Array:
        spin_share: Any = jnp.sqrt(share)  # centrifugal forces grow with the square of the spin
        part = share * base.a_WO_B, spin_share * base.w_WB_B, share * base.alpha_WB_B
        return equations.residual(q, zeros, zeros, *part, None if loads is None else share * loads)

    return root(force, zeros)


@partial(jax.jit, static_argnames=("stations", "axes"))
def displaced(structure: Any, stations: tuple[int, ...], axes: tuple[int, ...], wanted: Array) -> Array:
    """Coordinates (n,) of least strain energy at which `stations` are displaced along `axes` by `wanted`, m.

    NaN where Newton's method does not converge.
    """
    n, equations = structure.size, structure.equations

    def lagrangian(z: Array, share: Any) -> Array:
        """Strain energy less the work of the forces that hold the displacements, its multipliers."""
        q, holding_forces = z[:n], z[n:]
        displacement = structure.displacement(q)[jnp.array(stations), jnp.array(axes)]
        return equations.strain_energy(q) - holding_forces @ (displacement - share * wanted)

    return root(jax.grad(lagrangian), jnp.zeros(n + len(axes)))[:n]


def root(function: Any, start: Array) -> Array:
    """Root x of ``function(x, share)`` at a share of 1, or NaN where Newton's method does not converge.

    The share grows in strides of some iterations each. Derivatives are implicit: they need no iterations.
    """

    def newton(_: Any, start: Array) -> tuple[Array, Array]:
        """Solution and the size of the last correction. The share grows after every :data:`ITERATIONS` steps."""

        def correct(k: Any, state: tuple[Array, Array]) -> tuple[Array, Array]:
            x, _ = state
            value, slope = with_slope(partial(function, share=(k // ITERATIONS + 1) / STRIDES))(x)
            correction = jnp.linalg.solve(slope, value)
            return x - correction, jnp.abs(correction).max()

        return jax.lax.fori_loop(0, STRIDES * ITERATIONS, correct, (start, jnp.inf))

    x, last_correction = jax.lax.custom_root(partial(function, share=1.0), start, newton, linear_root, has_aux=True)
    return jnp.where(last_correction <= NOTHING + CLOSE * jnp.abs(x).max(), 1.0, jnp.nan) * x
