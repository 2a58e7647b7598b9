"""Nonlinear equations in time, compiled by JAX: steps without conditions, and the safe way for those that fail.

On a CPU a loop with a condition inside costs as much as the arithmetic of a step. So a step makes a given number of
corrections from an extrapolated guess, with the inverse Jacobian of its chunk's beginning; the size of the last two
says what error is left. A run of steps in which one leaves too much is done again with more corrections by the same
program, and where these do not suffice by Newton's method proper.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.integrate.schemes import Tableau

Array = Any
# By the order of the scheme, since a higher one takes longer steps: corrections per step, steps per Jacobian.
CORRECTIONS, PER_JACOBIAN = {2: 4, 4: 6}, {2: 20, 4: 4}
PATIENT = 25  # corrections where those did not suffice
ACCEPTED = 1e-8  # of the largest acceleration: the error that the last correction may leave
_TOLERANCE, _ROUNDING, _ITERATIONS = 1e-9, 1e3, 25  # Newton's method proper


class Carry(NamedTuple):
    """What goes from step to step: z (m, n); the stages' accelerations of the last two steps, (s, n) each."""

    z: Array
    x: Array
    before: Array


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
    return last * jnp.where(before > 0, jnp.minimum(last / jnp.maximum(before, 1e-300), 1.0), 0.0)


@jax.jit
def accelerations(residual: Any, q: Array, qd: Array, inputs: Any) -> Array:
    """q̈ (n,) that the equations demand, which are linear in them."""
    n = q.shape[0]
    units = jnp.concatenate([jnp.zeros((1, n)), jnp.eye(n)])
    forces = jax.vmap(lambda qdd: residual(q, qd, qdd, inputs))(units)
    return jnp.linalg.solve((forces[1:] - forces[0]).T, -forces[0])


def _next(t: Tableau, carry: Carry, x: Array) -> tuple[Carry, tuple[Array, Array, Array]]:
    """The next carry, and q, q̇, q̈ at the end of the step, which is the last stage."""
    q, qd = t.w_q[-1] @ carry.z + t.c_q[-1] @ x, t.w_v[-1] @ carry.z + t.c_v[-1] @ x
    return Carry(t.g @ carry.z + t.d @ x, x, carry.x), (q, qd, x[-1])


def steps(residual: Any, t: Tableau, carry: Carry, inputs: Any, corrections: Any) -> Any:
    """Steps with a given number of corrections each.

    Parameters
    ----------
    residual : callable record
        (q, q̇, q̈, inputs) -> (n,).
    t : Tableau
        Whose last stage is the end of the step.
    inputs : arrays (chunks, steps, s, ...)
        At the stages; one Jacobian for each chunk.
    corrections : int
        A plain number where the run is to be differentiated backwards.

    Returns
    -------
    Carry, and q, q̇, q̈ at the ends (chunks, steps, n) with the relative error that each step's corrections left
    """
    stages, n = carry.x.shape

    def chunk(carry: Carry, chunk_inputs: Any) -> Any:
        first = jax.tree.map(lambda leaf: leaf[0], chunk_inputs)

        def flat(x: Array) -> Array:
            return _stage_residual(residual, t, carry.z, first, x.reshape(stages, n)).ravel()

        inverse = jnp.linalg.inv(jax.jacfwd(flat)((2 * carry.x - carry.before).ravel()))

        def step(carry: Carry, at: Any) -> Any:
            def correct(_: Any, state: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
                x, last, _ = state
                correction = (inverse @ _stage_residual(residual, t, carry.z, at, x).ravel()).reshape(stages, n)
                x = x - correction
                return x, _size(correction, x), last

            far = jnp.full((), jnp.inf)
            x, last, before = jax.lax.fori_loop(0, corrections, correct, (2 * carry.x - carry.before, far, far))
            after, ends = _next(t, carry, x)
            return after, (*ends, _left(last, before))

        return jax.lax.scan(step, carry, chunk_inputs)

    return jax.lax.scan(chunk, carry, inputs)


quick = jax.jit(steps)


@jax.jit
def safe(residual: Any, t: Tableau, carry: Carry, inputs: Any) -> Any:
    """Steps by Newton's method with as many iterations as each needs, the Jacobian renewed every fourth.

    Parameters and returns as for :func:`steps`, with (steps, ...) in place of (chunks, steps, ...) and, in place of the
    error left, whether the step has been solved.
    """
    stages, n = carry.x.shape

    def step(carry: Carry, at: Any) -> Any:
        def flat(x: Array) -> Array:
            return _stage_residual(residual, t, carry.z, at, x.reshape(stages, n)).ravel()

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
        after, ends = _next(t, carry, x.reshape(stages, n))
        return after, (*ends, (size <= _ROUNDING * _TOLERANCE) & jnp.all(jnp.isfinite(x)))

    return jax.lax.scan(step, carry, inputs)
