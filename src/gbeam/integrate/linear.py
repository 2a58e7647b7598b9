"""Linear equations in time: every step is an affine map of the state, found for many steps at once.

The same lines serve NumPy, where a plain loop applies the maps (nothing is compiled), and JAX, where a scan does.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.integrate.equations import LinearEquations
from gbeam.integrate.schemes import Scheme, Tableau

Array = Any


def start(equations: LinearEquations, tableau: Tableau, time: float, q: Array, qd: Array) -> tuple[Array, Array]:
    """The first z (m, n) from an initial state, and the accelerations (n,) that its equations demand."""
    c, k, f = (x[0] for x in equations.matrices(equations.drive(np.array([time]))))
    xp = namespace(equations.mass, k, q)
    qdd = _solved(xp, equations.mass, (f - k @ q - c @ qd)[:, None])[:, 0]
    return tableau.first @ xp.stack([q, qd, qdd]), qdd


def _solved(xp: Any, left: Array, right: Array) -> Array:
    """Solutions of linear systems; NaN where one is singular, which NumPy raises an error for."""
    try:
        return xp.linalg.solve(left, right)
    except np.linalg.LinAlgError:
        if left.ndim == 2:
            return np.full_like(right, np.nan)
        return np.stack([_solved(xp, *pair) for pair in zip(left, right, strict=True)])


def chunk(
    equations: LinearEquations, scheme: Scheme, tableau: Tableau, z: Array, times: Array, step: float
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Steps from `times` (t,) s; returns the next z, and q, q̇, q̈ at the ends of the steps, (t, n) each."""
    count, stages, m, n = len(times), len(scheme.offsets), z.shape[0], z.shape[1]
    at = [equations.matrices(equations.drive(times + offset * step)) for offset in scheme.offsets]
    xp = namespace(equations.mass, z, *at[0])
    mass = equations.mass
    t = tableau
    # S x = F − L z at all stages together.
    rows, sides = [], []
    for i, (c, k, f) in enumerate(at):
        blocks = [t.c_v[i, j] * c + t.c_q[i, j] * k + (mass if i == j else 0) for j in range(stages)]
        onto = [t.w_v[i, a] * c + t.w_q[i, a] * k for a in range(m)]
        rows.append(xp.concatenate(blocks, axis=-1) if stages > 1 else blocks[0])
        sides.append(xp.concatenate([*onto, xp.broadcast_to(f, (count, n))[..., None]], axis=-1))
    left = xp.concatenate(rows, axis=-2) if stages > 1 else rows[0]
    solved = _solved(xp, left, xp.concatenate(sides, axis=-2) if stages > 1 else sides[0])
    solved = xp.reshape(solved, (count, stages, n, m * n + 1))
    # z₊ = g z + d x with x = f − X z.
    added = xp.reshape(xp.tensordot(t.d, solved, axes=((1,), (1,))).swapaxes(0, 1), (count, m * n, m * n + 1))
    maps, shifts = np.kron(t.g, np.eye(n)) - added[..., :-1], added[..., -1]
    before, last = _recur(xp, maps, shifts, xp.reshape(z, (-1,)))
    x = solved[..., -1] - (solved[..., :-1] @ before[:, None, :, None])[..., 0]
    zs = xp.reshape(before, (count, m, n))
    after = xp.reshape(last, (m, n))
    ends = xp.tensordot(t.end_z, zs, axes=((1,), (1,))) + xp.tensordot(t.end_x, x, axes=((1,), (1,)))
    q, qd = ends[0], ends[1]
    if scheme.ends:
        return after, (q, qd, x[:, -1])
    c, k, f = equations.matrices(equations.drive(times + step))
    force = f - (k @ q[..., None] + c @ qd[..., None])[..., 0]
    return after, (q, qd, xp.linalg.solve(mass, force.T).T)


def _recur(xp: Any, maps: Array, shifts: Array, z: Array) -> tuple[Array, Array]:
    """States before each step, (t, m n), and the one after the last."""
    if xp is np:
        before = np.empty_like(shifts)
        for k in range(len(shifts)):
            before[k] = z
            z = maps[k] @ z + shifts[k]
        return before, z
    import jax

    def step(z: Array, at: tuple[Array, Array]) -> tuple[Array, Array]:
        return at[0] @ z + at[1], z

    last, before = jax.lax.scan(step, z, (maps, shifts))
    return before, last
