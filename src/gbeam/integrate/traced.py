"""Runs of nonlinear equations that JAX traces: solved as all others are, outside of its programs.

Their derivative is that of the discrete solution. Differentiated, every step of a run solves with the Jacobian J of its
stages' accelerations x and the derivative L by the state z before it

    δx = −J⁻¹ (δr + L δz),    δz₊ = g δz + d δx,

where δr is the residual's own derivative by what it is made of and by what drives it: JAX traces the residual and this
recurrence, but neither Newton's method nor the run.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.arrays.tree import each_leaf
from gbeam.integrate.equations import Demanded, Fitted, NonlinearEquations, slopes
from gbeam.integrate.schemes import Scheme, stepped
from gbeam.integrate.steps import Steps
from gbeam.integrate.windows import windows

Array = Any


def traced(equations: NonlinearEquations, scheme: Scheme, q: Array, qd: Array, steps: Steps) -> tuple[Array, ...]:
    """q, q̇, q̈ (t + 1, n) at the beginning and the ends of steps; NaN from one that fails on, as their derivatives."""
    ends = [] if scheme.ends else [steps.end]
    times = np.concatenate([steps.first[:1], *(steps.times(offset) for offset in scheme.offsets), *ends])
    shape = (len(steps) + 1, len(q))

    of_steps = stepped(equations, scheme, steps, len(q))

    def solved(residual: Any, q: Any, qd: Any, driven: Any) -> tuple[Any, ...]:
        residual, q, qd, driven = jax.tree.map(np.asarray, (residual, q, qd, driven))
        order = np.argsort(times)

        def drive(t: Any) -> Any:
            at = order[np.searchsorted(times, t, sorter=order)]
            return each_leaf(lambda leaf: leaf[at], driven)

        of, out, done = NonlinearEquations(residual, drive), np.full((3, *shape), np.nan), 0
        with np.errstate(all="ignore"):  # of what is no number
            for *piece, _ in windows(of, scheme, q, qd, steps):
                out[: len(piece), done : done + len(piece[0])] = piece
                done += len(piece[0])
            if not scheme.ends:
                out[2, :done] = Demanded(of, steps, *out[:2])(np.arange(done))
        return tuple(out)

    @jax.custom_jvp
    def run(residual: Any, q: Array, qd: Array, driven: Any) -> tuple[Array, ...]:
        result = (jax.ShapeDtypeStruct(shape, float),) * 3
        return jax.pure_callback(solved, result, residual, q, qd, driven, vmap_method="sequential")

    @run.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        every, (residual, _, _, driven), (changed, dq, dqd, redriven) = run(*primals), primals, tangents
        return every, _changes(scheme, steps, every, (residual, driven), (changed, redriven), dq, dqd)

    return run(of_steps, jnp.asarray(q, dtype=float), jnp.asarray(qd, dtype=float), equations.drive(times))


def _changes(scheme: Scheme, steps: Steps, run: Any, of: Any, changed: Any, dq: Array, dqd: Array) -> tuple[Array, ...]:
    """Derivatives of a run's q, q̇, q̈ along changes of its residual and drives, and of q, q̇ at the start."""
    (q, qd, qdd), t = run, scheme.tableau(steps.length)
    count, n, stages, first = len(steps), q.shape[1], len(scheme.offsets), scheme.tableau(steps.length[0]).first
    x: Array
    z: Array
    if scheme.ends:
        x = qdd[1:, None]
        start = first @ jnp.stack([q[0], qd[0], qdd[0]])
        _, z = jax.lax.scan(lambda z, at: (at[0] @ z + at[1] @ at[2], z), start, (t.g, t.d, x))
    else:  # z is q and q̇: what a step adds to it says what its stages' accelerations were
        z = jnp.stack([q, qd], axis=1)
        x, z = jnp.linalg.solve(t.d, z[1:] - t.g @ z[:-1]), z[:-1]
    at_stages = t.w_q @ z + t.c_q @ x, t.w_v @ z + t.c_v @ x, x
    parts = [[each[:1], *(part[:, k] for k in range(stages))] for each, part in zip(run, at_stages, strict=True)]
    states = tuple(
        jnp.concatenate([*part, *([] if scheme.ends else [each[1:]])]) for part, each in zip(parts, run, strict=True)
    )

    def host(*arguments: Any) -> Any:
        (q, qd, qdd), (residual, driven) = jax.tree.map(np.asarray, arguments)
        with np.errstate(all="ignore"):
            return tuple(slopes(residual, q, qd, qdd, driven))

    square = (jax.ShapeDtypeStruct((len(states[0]), n, n), float),) * 3
    slope = jax.pure_callback(host, square, states, of, vmap_method="sequential")
    _, direct = jax.jvp(lambda residual, driven: residual(*states, driven), of, changed)

    def accelerated(some: slice, dq: Array, dqd: Array) -> Array:
        k, c, m = (each[some] for each in slope)
        if isinstance(of[0], Fitted):
            c, m = c - of[0].damping, m - of[0].mass
        left = direct[some] + (k @ dq[..., None] + c @ dqd[..., None])[..., 0]
        return -jnp.linalg.solve(m, left[..., None])[..., 0]

    def by_stage(values: Array) -> Array:
        return jnp.moveaxis(values[1 : 1 + stages * count].reshape(stages, count, *values.shape[1:]), 0, 1)

    jacobian, onto = t.jacobians(*map(by_stage, slope))
    inverse = jnp.linalg.inv(jacobian)

    def step(dz: Array, at: Any) -> Any:
        inverse, onto, direct, g, d = at
        dx = -(inverse @ (direct.ravel() + onto @ dz.ravel())).reshape(stages, n)
        return g @ dz + d @ dx, (dz, dx)

    dqdd = accelerated(slice(0, 1), dq[None], dqd[None])
    _, (dz, dx) = jax.lax.scan(step, first @ jnp.stack([dq, dqd, dqdd[0]]), (inverse, onto, by_stage(direct), t.g, t.d))
    ends = t.end_z @ dz + t.end_x @ dx
    changes = ends[:, 0], ends[:, 1]
    at_ends = dx[:, -1] if scheme.ends else accelerated(slice(-count, None), *changes)
    begun = dq[None], dqd[None], dqdd
    return tuple(jnp.concatenate(pair) for pair in zip(begun, (*changes, at_ends), strict=True))
