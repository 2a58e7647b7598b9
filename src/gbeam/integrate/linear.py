"""Linear equations in time: every step is an affine map of the state, found for many steps at once.

The same lines serve NumPy, where a plain loop applies the maps (nothing is compiled), and JAX, where a scan does. An
affine map of z (m, n) is an array (..., m n + 1), whose last column is what it adds.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, holds_jax, namespace
from gbeam.arrays.tree import each_leaf, leaves_of
from gbeam.integrate.equations import LinearEquations, solve_systems
from gbeam.integrate.relaxed import FEWEST, take_equal_steps
from gbeam.integrate.schemes import Scheme, Tableau
from gbeam.integrate.steps import Steps


def start(
    equations: LinearEquations, scheme: Scheme, steps: Steps, q: Array, qd: Array
) -> tuple[Array, tuple[Array, ...]]:
    """The first z (m, n) of a run, and the initial q, q̇ and q̈ (n,).

    q̈ is left out where the scheme has no accelerations at the ends of steps, unless JAX traces the run.
    """
    inputs, first = equations.drive(steps.drive_begin[:1]), scheme.tableau(steps.length[0]).initial
    if not (scheme.ends or holds_jax(q, qd, inputs, equations.mass, equations.terms or equations.matrices(inputs))):
        return first[:, :2] @ np.stack([q, qd]), (q, qd)
    qdd = equations.accelerations(q[None], qd[None], inputs)[0]
    return first @ namespace(q, qdd).stack([q, qd, qdd]), (q, qd, qdd)


def _sum(weights: Array, values: Array) -> Array:
    """Sums over k of weights (t or 1, j, k) and values (t or 1, k, ...)."""
    rest = values.shape[2:]
    sums = weights @ values.reshape(*values.shape[:2], -1)
    return sums.reshape(*sums.shape[:2], *rest)


def chunk(
    equations: LinearEquations,
    scheme: Scheme,
    z: Array,
    steps: Steps,
    added: tuple[Array | float, Array | float] = (0.0, 0.0),
) -> tuple[Array, tuple[Array, ...]]:
    """Take steps from z (m, n) with terms `added` to M and C.

    Returns the next z, and q and q̇ (k, n) at the ends of recorded steps. q̈ is returned, too, where the scheme has it
    or JAX traces the equations.
    """
    t = scheme.tableau(steps.length[:1] if steps.equal else steps.length)
    count, stages, (m, n) = len(steps), len(scheme.offsets), z.shape
    times = np.stack([steps.times(offset) for offset in scheme.offsets], axis=1)
    inputs, map_index = equations.drive(times.ravel()), slice(None)  # of the map that each step has
    if steps.equal and not holds_jax(inputs):
        inputs, map_index = _distinct(inputs, count)
    matrices = equations.matrices(inputs)
    xp, mass = namespace(equations.mass, z, *matrices), equations.mass + added[0]
    c, k, f = (xp.reshape(values, (-1, stages, *values.shape[1:])) for values in matrices)
    c = c + added[1]
    anew = scheme.ends and not steps.equal
    groups = [np.arange(n)] if xp is not np or anew else _uncoupled(mass, c, k)
    settled = None
    if xp is np and steps.equal and not scheme.ends and len(groups) == 1 and n >= FEWEST and len(c) == count:
        settled = take_equal_steps(t, mass, c, k, f, z)
    if settled is not None:
        first_states, x = settled
        states, last = first_states[:-1].reshape(count, m, n), first_states[-1].reshape(m, n)
        ends = _sum(t.end_z, states) + _sum(t.end_x, x.reshape(count, stages, n))
        return last, tuple(ends[:, part][steps.kept] for part in (0, 1))
    # Of each group of coordinates, maps of z to the stages' x and to the next z.
    of_groups = [_stages(xp, t, mass, c, k, f, group) for group in groups]
    maps = of_groups[0][1] if len(groups) == 1 else np.zeros((len(c), m, n, m * n + 1))
    if anew:
        ends = _sum(t.end_z, _unit(m, n)) + _sum(t.end_x, of_groups[0][0])
        maps = _started_anew(equations, scheme, maps, ends, steps)
    for group, (_, to_next) in zip(groups, of_groups, strict=True):
        if len(groups) > 1:
            columns = np.append((n * np.arange(m)[:, None] + group).ravel(), m * n)
            maps[:, :, group[:, None], columns] = to_next
    flat_states = recurrence(xp, xp.reshape(maps, (-1, m * n, m * n + 1))[map_index], xp.reshape(z, (-1,)))
    states, last, parts = xp.reshape(flat_states[:-1], (count, m, n)), xp.reshape(flat_states[-1], (m, n)), []
    for group, (to_stages, _) in zip(groups, of_groups, strict=True):
        state = xp.reshape(states if len(groups) == 1 else states[:, :, group], (count, -1, 1))
        first_states = xp.reshape(to_stages, (len(c), stages * len(group), -1))[map_index]
        parts.append(xp.reshape((first_states[..., :-1] @ state)[..., 0] + first_states[..., -1], (count, stages, -1)))
    x = parts[0] if len(groups) == 1 else np.concatenate(parts, axis=-1)[..., np.argsort(np.concatenate(groups))]
    ends = _sum(t.end_z, states) + _sum(t.end_x, x)
    recorded = tuple(
        values if steps.kept.all() else values[steps.kept] for values in (ends[:, 0], ends[:, 1], x[:, -1])
    )
    if xp is np and not scheme.ends:
        return last, recorded[:2]
    q, qd, qdd = recorded
    # The last stage's acceleration is that at the end, unless the stage lies before it, or just before a jump.
    lacking = np.flatnonzero(steps.jump[steps.kept]) if scheme.ends else np.arange(len(q))
    if lacking.size:
        at_ends = equations.drive(steps.end[steps.kept][lacking])
        acceleration = equations.accelerations(q[lacking], qd[lacking], at_ends)
        if scheme.ends:
            qdd[lacking] = acceleration
        else:
            qdd = acceleration
    return last, (q, qd, qdd)


def _distinct(inputs: Any, count: int) -> tuple[Any, Array]:
    """Inputs of those of `count` steps whose inputs differ from the step before's, and an index (count,) into these.

    A base that rests, or turns steadily, so has one map for all steps.
    """
    leaves = [leaf.reshape(count, -1) for leaf in leaves_of(inputs)]
    changed = np.append(True, np.any([(leaf[1:] != leaf[:-1]).any(axis=1) for leaf in leaves], axis=0))

    def chosen(leaf: Array) -> Array:
        return leaf.reshape(count, -1, *leaf.shape[1:])[changed].reshape(-1, *leaf.shape[1:])

    return each_leaf(chosen, inputs), np.cumsum(changed) - 1


def _uncoupled(mass: Array, c: Array, k: Array) -> list[Array]:
    """Groups of coordinates that no matrix couples, such as the directions of a beam that does not turn."""
    coupled = (mass != 0) | np.eye(len(mass), dtype=bool)
    for matrices in (c, k):
        coupled = coupled | matrices.any(axis=(0, 1))
    coupled = coupled | coupled.T
    for _ in range(len(mass).bit_length()):  # chains of couplings, twice as long each time
        coupled = coupled @ coupled
    return [np.flatnonzero(row) for i, row in enumerate(coupled) if row.argmax() == i]


def _unit(m: int, n: int) -> Array:
    """The affine map (1, m, n, m n + 1) of z (m, n) that leaves it as it is."""
    return np.eye(m * n, m * n + 1).reshape(1, m, n, m * n + 1)


def _stages(xp: Any, t: Tableau, mass: Array, c: Array, k: Array, f: Array, group: Array) -> tuple[Array, Array]:
    """Affine maps of a group's z to its stages' accelerations, (t, s, n, m n + 1), and next z, (t, m, n, m n + 1)."""
    (*_, stages, m), n = t.w_q.shape, len(group)
    if n < len(mass):
        pair = np.ix_(group, group)
        mass, c, k, f = mass[pair], c[..., *pair], k[..., *pair], f[..., group]
    # J x = F − L z at all stages together.
    jacobian, input_map = t.jacobians(k, c, mass[None, None])
    x = solve_systems(jacobian, xp.concatenate([-input_map, xp.reshape(f, (-1, stages * n, 1))], axis=-1))
    x = xp.reshape(x, (-1, stages, n, m * n + 1))
    return x, _sum(t.g, _unit(m, n)) + _sum(t.d, x)


def _started_anew(equations: LinearEquations, scheme: Scheme, maps: Array, ends: Array, steps: Steps) -> Array:
    """Replace those of the `maps` (t, m, n, m n + 1) to the next z after which the scheme starts anew.

    There z is that of an initial state: of q and q̇ at the end of the step, by the maps `ends` (t, 2, n, m n + 1), and
    of the accelerations that satisfy the equations.
    """
    anew = np.flatnonzero(steps.anew)
    if not anew.size:
        return maps
    c, k, f = equations.matrices(equations.drive(steps.resume[anew]))
    q, qd = ends[anew, 0], ends[anew, 1]
    force = -(k @ q + c @ qd)
    force[..., -1] += f
    qdd = solve_systems(equations.mass, force)
    maps[anew] = _sum(scheme.tableau(steps.following[anew]).initial, np.stack([q, qd, qdd], axis=1))
    return maps


def recurrence(xp: Any, maps: Array, z: Array) -> Array:
    """Apply affine maps (t, m n, m n + 1) in turn to z (m n,); return all states, (t + 1, m n), with the first."""
    if xp is np:
        states = np.ones((len(maps) + 1, z.size + 1))
        states[0, :-1] = z
        for of_step, before, after in zip(maps, states[:-1], states[1:, :-1], strict=True):
            np.dot(of_step, before, out=after)
        return states[:, :-1]
    import jax

    def step(z: Array, of_step: Array) -> tuple[Array, Array]:
        return of_step[:, :-1] @ z + of_step[:, -1], z

    last, before = jax.lax.scan(step, z, maps)
    return xp.concatenate([before, last[None]])
