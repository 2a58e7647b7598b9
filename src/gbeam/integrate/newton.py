"""Nonlinear equations in time, compiled by JAX: steps without control flow, and the safe way for those that fail.

On a CPU a loop with a condition inside costs as much as the arithmetic of a step. So a step makes a fixed number of
corrections from an extrapolated guess, with the inverse Jacobian of its chunk's beginning; the size of the last
corrections says what error is left, and a run of steps in which one leaves too much is done again by Newton's method
proper.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.integrate.schemes import Tableau

Array = Any
# By the number of stages, since a scheme of higher order takes longer steps: corrections per step, steps per Jacobian.
CORRECTIONS, PER_JACOBIAN = {1: 3, 2: 5}, {1: 20, 2: 4}
ACCEPTED = 1e-6  # of the largest acceleration: the error that the last correction may leave
_TOLERANCE, _ROUNDING, _ITERATIONS = 1e-9, 1e3, 25  # Newton's method proper


class Carry(NamedTuple):
    """What goes from step to step: z (m, n); the stages' accelerations of the last two steps (s, n), and at the end."""

    z: Array
    x: Array
    before: Array
    end: Array


def _stage_residual(residual: Any, t: Tableau, z: Array, inputs: Any, x: Array) -> Array:
    """Residuals of all stages, (s, n)."""
    q, qd = t.w_q @ z + t.c_q @ x, t.w_v @ z + t.c_v @ x
    if len(t.c_q) == 1:
        return residual(q[0], qd[0], x[0], jax.tree.map(lambda leaf: leaf[0], inputs))[None]
    return jax.vmap(residual)(q, qd, x, inputs)


def _size(correction: Array, x: Array) -> Array:
    # An error in q̈ matters as it moves q: measure against what the step itself can move.
    return jnp.max(jnp.abs(correction)) / (1.0 + jnp.max(jnp.abs(x)))


def _left(last: Array, before: Array) -> Array:
    """Error left after the last of two corrections, which shrink by a constant factor."""
    return last * jnp.where(before > 0, jnp.minimum(last / before, 1.0), 0.0)


@jax.jit
def accelerations(residual: Any, q: Array, qd: Array, inputs: Any) -> Array:
    """q̈ (n,) that the equations demand, which are linear in them."""
    zero = jnp.zeros_like(q)
    mass = jax.jacfwd(residual, 2)(q, qd, zero, inputs)
    return jnp.linalg.solve(mass, -residual(q, qd, zero, inputs))


def _end(t: Tableau, z: Array, x: Array, ends: bool) -> tuple[Array, Array]:
    if ends:
        return t.w_q[-1] @ z + t.c_q[-1] @ x, t.w_v[-1] @ z + t.c_v[-1] @ x
    new = t.g @ z + t.d @ x
    return new[0], new[1]


@partial(jax.jit, static_argnames="ends")
def quick(residual: Any, t: Tableau, carry: Carry, inputs: Any, end_inputs: Any, *, ends: bool) -> Any:
    """Steps with a fixed number of corrections.

    Parameters
    ----------
    inputs : arrays (chunks, steps, s, ...)
        At the stages; one Jacobian for each chunk.
    end_inputs : arrays (chunks, steps, ...)
        At the ends, where these are no stage.

    Returns
    -------
    Carry, and q, q̇, q̈ at the ends (chunks, steps, n) with the relative error that each step's corrections left
    """
    stages, n = carry.x.shape

    def chunk(carry: Carry, chunk_inputs: tuple[Any, Any]) -> Any:
        first = jax.tree.map(lambda leaf: leaf[0], chunk_inputs)

        def flat(x: Array) -> Array:
            return _stage_residual(residual, t, carry.z, first[0], x.reshape(stages, n)).ravel()

        inverse = jnp.linalg.inv(jax.jacfwd(flat)((2 * carry.x - carry.before).ravel()))
        if not ends:
            q, qd = carry.z[0], carry.z[1]
            of_mass = jnp.linalg.inv(jax.jacfwd(residual, 2)(q, qd, carry.end, first[1]))

        def step(carry: Carry, at: tuple[Any, Any]) -> Any:
            x = 2 * carry.x - carry.before
            sizes = []
            for _ in range(CORRECTIONS[stages]):
                correction = (inverse @ _stage_residual(residual, t, carry.z, at[0], x).ravel()).reshape(stages, n)
                x = x - correction
                sizes.append(_size(correction, x))
            left = _left(sizes[-1], sizes[-2])
            q, qd = _end(t, carry.z, x, ends)
            end = x[-1]
            if not ends:
                end, sizes = carry.end + (x[-1] - carry.x[-1]), []
                for _ in range(2):
                    correction = of_mass @ residual(q, qd, end, at[1])
                    end = end - correction
                    sizes.append(_size(correction, end))
                left = jnp.maximum(left, _left(sizes[-1], sizes[-2]))
            return Carry(t.g @ carry.z + t.d @ x, x, carry.x, end), (q, qd, end, left)

        return jax.lax.scan(step, carry, chunk_inputs)

    return jax.lax.scan(chunk, carry, (inputs, end_inputs))


@partial(jax.jit, static_argnames="ends")
def safe(residual: Any, t: Tableau, carry: Carry, inputs: Any, end_inputs: Any, *, ends: bool) -> Any:
    """Steps by Newton's method with as many iterations as each needs, the Jacobian renewed every fourth.

    Parameters and returns as for :func:`quick`, with (steps, ...) in place of (chunks, steps, ...) and, in place
    of the error left, whether the step has been solved.
    """
    stages, n = carry.x.shape

    def step(carry: Carry, at: tuple[Any, Any]) -> Any:
        def flat(x: Array) -> Array:
            return _stage_residual(residual, t, carry.z, at[0], x.reshape(stages, n)).ravel()

        def go_on(state: tuple[Any, ...]) -> Array:
            _, _, size, before, count = state
            stalled = (size > before / 2) & (size <= _ROUNDING * _TOLERANCE)
            return (size > _TOLERANCE) & ~stalled & (count < _ITERATIONS)

        def iterate(state: tuple[Any, ...]) -> tuple[Any, ...]:
            x, inverse, size, _, count = state
            renewed = jax.lax.cond(count % 4 == 0, lambda x: jnp.linalg.inv(jax.jacfwd(flat)(x)), lambda _: inverse, x)
            correction = renewed @ flat(x)
            x = x - correction
            return x, renewed, _size(correction, x), size, count + 1

        far = jnp.array(jnp.inf)
        begin = (carry.x.ravel(), jnp.eye(stages * n), far, far, jnp.array(0))
        x, _, size, _, _ = jax.lax.while_loop(go_on, iterate, begin)
        x = x.reshape(stages, n)
        q, qd = _end(t, carry.z, x, ends)
        end = x[-1] if ends else accelerations(residual, q, qd, at[1])
        ok = (size <= _ROUNDING * _TOLERANCE) & jnp.all(jnp.isfinite(end))
        return Carry(t.g @ carry.z + t.d @ x, x, carry.x, end), (q, qd, end, ok)

    return jax.lax.scan(step, carry, (inputs, end_inputs))
