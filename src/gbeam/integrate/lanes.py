"""Steps of many runs of linear equations at once, compiled by JAX: the last axis of every array is the runs'.

So a processor's vector holds one number of several runs, and a matrix of a step is a few sums of such vectors. What
happens in one run does not depend on the others: with equally many runs its digits are the same beside any of them.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from gbeam.arrays.namespace import namespace
from gbeam.integrate.equations import LinearTerms
from gbeam.integrate.schemes import Scheme, Tableau, powers_of_step

Array = Any
Parts = tuple[tuple[int, ...], ...]  # of C, K and F: which of the features each of their terms has
STEPS = 256  # per compiled call at most


@partial(jax.jit, static_argnames=("parts", "ends"))
def steps(
    mass: Array,
    damping: Array,
    inverse: Array,
    terms: LinearTerms,
    unit: Tableau,
    z: Array,
    lengths: Array,
    features: Array,
    count: Array,
    *,
    parts: Parts,
    ends: bool,
) -> tuple[Array, tuple[Array, ...]]:
    """Take the first `count` of t steps of b runs from z (m, n, b), matrices (n, n, b), features (t, s, k, b) at the
    stages and, unless the last one `ends` the step, at its end; returns z, and q, q̇, q̈ (b, t, n).
    """

    def step(z: Array, h: Array, phi: Array) -> tuple[Array, tuple[Array, Array, Array]]:
        t = _tableau(unit, h)
        stages, (_, n, b) = len(t.c_q), z.shape
        c, k, f = ([_sum(of, at, chosen) for at in phi] for of, chosen in zip(terms.each, parts, strict=True))
        # The compiler would compute these anew wherever they are read, and the matrix below for each of its pivots.
        c, k, f = jax.lax.optimization_barrier((c, k, f))
        q0, v0 = _combined(t.w_q, z), _combined(t.w_v, z)
        rows, within = [], [at + damping for at in c[:stages]]
        for i in range(stages):
            blocks = [t.c_v[i, j] * within[i] + t.c_q[i, j] * k[i] + (mass if i == j else 0.0) for j in range(stages)]
            side = f[i] - _times(within[i], v0[i]) - _times(k[i], q0[i])
            rows.append(jnp.concatenate([*blocks, side[:, None]], axis=1))
        x = eliminated(jax.lax.optimization_barrier(jnp.concatenate(rows))).reshape(stages, n, b)
        q, qd = _combined(t.end_z, z) + _combined(t.end_x, x)
        qdd = x[-1] if ends else _times(inverse, f[-1] - _times(k[-1], q) - _times(c[-1], qd))
        return _combined(t.g, z) + _combined(t.d, x), (q, qd, qdd)

    def turn(i: Any, state: Any) -> Any:
        z, history = state
        z, new = step(z, lengths[i], features[i])
        return z, tuple(jax.lax.dynamic_update_index_in_dim(a, b, i, 0) for a, b in zip(history, new, strict=True))

    history = (jnp.zeros((len(lengths), *z.shape[1:])),) * 3
    z, history = jax.lax.fori_loop(0, count, turn, (z, history))
    return z, tuple(jnp.moveaxis(x, -1, 0) for x in history)


def eliminated(rows: Array) -> Array:
    """Solve many small systems (n, n + 1, b), nearly definite, by elimination without pivots, (n, b)."""
    pivots = []
    while len(rows):
        pivots.append(rows[0, 1:] / rows[0, :1])
        rows = rows[1:, 1:] - rows[1:, :1] * pivots[-1]
    x: list[Array] = []
    for pivot in reversed(pivots):
        x.insert(0, pivot[-1] - sum(pivot[j] * value for j, value in enumerate(x)))
    return jnp.stack(x)


def stages(scheme: Scheme) -> int:
    """At how many times of a step its features are read."""
    return len(scheme.offsets) + (not scheme.ends)


def accelerations(inverse: Array, terms: LinearTerms, features: Array, parts: Parts, q: Array, qd: Array) -> Array:
    """q̈ (n, b) that the equations demand at features (k, b)."""
    c, k, f = (_sum(of, features, chosen) for of, chosen in zip(terms.each, parts, strict=True))
    return _times(inverse, f - _times(k, q) - _times(c, qd))


def _tableau(unit: Tableau, h: Array) -> Tableau:
    """The scheme at steps of lengths (b,), with a last axis of these."""
    powers = jnp.stack([1 / h**2, 1 / h, jnp.ones_like(h), h, h**2])
    shapes = powers_of_step(*unit.d.shape)
    return Tableau(**{name: getattr(unit, name)[..., None] * powers[power + 2] for name, power in shapes.items()})


def _sum(terms: Array, features: Array, chosen: tuple[int, ...]) -> Array:
    """Sum of terms (k, ..., b) weighted with their features, of all (k, b); zero where there are none."""
    if not chosen:
        return namespace(terms).zeros(terms.shape[1:])
    return sum(term * features[i] for term, i in zip(terms, chosen, strict=True))


def _times(matrices: Array, vectors: Array) -> Array:
    """Products of matrices (n, n, b) and vectors (n, b); a compiled sum along an axis is slower."""
    return sum(matrices[:, j] * vector for j, vector in enumerate(vectors))


def _combined(weights: Array, vectors: Array) -> Array:
    """Sums of vectors (m, n, b) with weights (s, m, b), (s, n, b)."""
    return jnp.sum(weights[:, :, None] * vectors, axis=1)
