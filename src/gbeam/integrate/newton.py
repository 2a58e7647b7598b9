"""Nonlinear equations in time, compiled by JAX: steps of many runs side by side, in chunks of equal size.

A step is corrected from an extrapolated guess, with the inverse Jacobian of its group's beginning, until the size of
the last two corrections says that the error left is small. Meanwhile a run that is near waits, unchanged, for those
beside it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from gbeam.arrays.jax_setup import with_slope
from gbeam.arrays.namespace import Array
from gbeam.integrate.equations import Drive, exact_residual
from gbeam.integrate.schemes import Scheme, Tableau
from gbeam.integrate.steps import Steps
from gbeam.integrate.verdict import shrinkage

CHUNK = 200  # steps per compiled call at most, and per look at whether to stop
_AT_ONCE = 20  # chunks whose inputs are computed at once


@dataclass(frozen=True)
class Chunk:
    """Steps of one compiled call, in groups of equal size that are filled up by repeated steps.

    `last` (groups,) is the index, within a group, of its last step that counts, −1 if none does. `inputs` (groups,
    steps, s, ...) are those at the stages, `at_ends` (groups, steps, ...) those at the ends of steps.
    """

    steps: Steps
    last_counted: Any
    tableau: Any
    inputs: Any
    at_ends: Any

    @cached_property
    def counted(self) -> Any:
        """Flags (steps,) of the steps that count."""
        return (np.arange(len(self.steps) // len(self.last_counted)) <= self.last_counted[:, None]).ravel()

    @property
    def count(self) -> int:
        """Number of groups with a step that counts."""
        return int(np.count_nonzero(self.last_counted >= 0))

    @property
    def end(self) -> Steps:
        """The last step that counts."""
        return self.steps[np.flatnonzero(self.counted)[-1]]


@dataclass(frozen=True)
class Stretch:
    """Many chunks without inputs. `shape` is (groups, steps), `times` (steps, stages) s where inputs are needed."""

    steps: Steps
    shape: tuple[int, int]
    lasts: list[Any]
    tableau: Any
    times: Any


def stretches(scheme: Scheme, steps: Steps, size: int) -> Iterator[Stretch]:
    """Divide steps into groups of `size` that share one Jacobian, and yield them by up to `_AT_ONCE` chunks."""
    all_chunks = list(_groups(steps, size, restart=scheme.ends))
    for first in range(0, len(all_chunks), _AT_ONCE):
        indices, lasts = zip(*all_chunks[first : first + _AT_ONCE], strict=True)
        index = np.concatenate(indices)  # (groups, size)
        chosen = steps[index.ravel()]
        times = [chosen.times(offset) for offset in scheme.offsets]
        if not scheme.ends:  # q̈ at the end of a step is computed from the inputs there
            times.append(chosen.end)
        tableau = scheme.tableau(steps.length[index[:, 0]])
        yield Stretch(chosen, index.shape, list(lasts), tableau, np.stack(times, axis=1))


def chunks(drive: Drive, scheme: Scheme, all_stretches: Iterable[Stretch]) -> Iterator[Chunk]:
    """Yield the chunks of stretches with their inputs. `drive` is evaluated once for each stretch."""
    import jax

    stages = len(scheme.offsets)
    for stretch in all_stretches:
        groups, size = stretch.shape
        by_group = (groups, size, -1)
        driven = jax.tree.map(
            lambda leaf, shape=by_group: leaf.reshape(*shape, *leaf.shape[1:]), drive(stretch.times.ravel())
        )
        inputs = jax.tree.map(lambda leaf: leaf[:, :, :stages], driven)
        at_ends = None if scheme.ends else jax.tree.map(lambda leaf: leaf[:, :, stages], driven)
        first = 0
        for last in stretch.lasts:
            part = slice(first, first + len(last))
            pieces = jax.tree.map(lambda leaf, part=part: leaf[part], (stretch.tableau, inputs, at_ends))
            yield Chunk(stretch.steps[part.start * size : part.stop * size], last, *pieces)
            first = part.stop


def _groups(steps: Steps, size: int, *, restart: bool) -> Iterator[tuple[Any, Any]]:
    """Yield the groups of each chunk: indices (groups, size) of their steps, and the place (groups,) of the last step
    that counts in each group, −1 if none does.

    A group ends where the scheme starts anew; with `restart`, the chunk does, too. A group of fewer steps repeats its
    last one. Groups without a step that counts fill the last chunk, so that one program serves every duration.
    """
    restarts = np.append(np.flatnonzero(steps.anew[:-1]), len(steps) - 1)  # last steps of the stretches between them
    stretch_begins = np.append(0, restarts[:-1] + 1)
    stretches = []  # of each stretch: the first steps of its groups, and its last step for each of them
    for begin, end in zip(stretch_begins, restarts, strict=True):
        firsts = np.arange(begin, end + 1, size)
        stretches.append(np.stack([firsts, np.full(len(firsts), end)]))
    if not restart:
        stretches = [np.concatenate(stretches, axis=1)]
    groups_per_chunk = CHUNK // size
    for stretch in stretches:
        for done in range(0, stretch.shape[1], groups_per_chunk):
            first, end = stretch[:, done : done + groups_per_chunk]
            missing = groups_per_chunk - len(first)
            last = np.append(np.minimum(end - first, size - 1), np.full(missing, -1))
            first = np.append(first, np.full(missing, end[-1]))
            end = np.append(end, np.full(missing, end[-1]))
            yield np.minimum(first[:, None] + np.arange(size), end[:, None]), last


PER_JACOBIAN = {2: 20, 4: 4}  # steps, by the order of the scheme: a higher one takes longer steps
LEAST = 1e-3  # m/s² or rad/s²: beside smaller accelerations errors are not measured
FEWEST, MOST = 2, 8  # corrections of a step
NEAR, ACCEPTED = 1e-10, 1e-8  # of the largest acceleration: errors left after which no correction follows, at most


class Carry(NamedTuple):
    """State between steps: z (m, n); the stages' accelerations of the last two steps, (s, n) each."""

    z: Array
    x: Array
    previous_x: Array


def _stage_residual(residual: Any, t: Tableau, z: Array, inputs: Any, x: Array) -> Array:
    """Residuals (s, n) at all stages of a step, from the state z before it and the stages' accelerations x."""
    q, qd = t.w_q @ z + t.c_q @ x, t.w_v @ z + t.c_v @ x
    return jax.lax.map(lambda stage: residual(*stage), (q, qd, x, inputs))


def slopes(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> tuple[Array, Array, Array]:
    """Derivatives K, C, M (n, n) of a residual by q, q̇, q̈ (n,)."""
    k, c, m = jax.jacfwd(lambda *state: residual(*state, inputs), argnums=(0, 1, 2))(q, qd, qdd)
    return k, c, m


def _inverse_jacobian(residual: Any, t: Tableau, z: Array, inputs: Any, x: Array) -> Array:
    """Inverse Jacobian (s n, s n) of a step's residuals with respect to its accelerations. K, C and M are taken once,
    at the mean of the stages.
    """
    q, qd, qdd = (jnp.mean(values, axis=0) for values in (t.w_q @ z + t.c_q @ x, t.w_v @ z + t.c_v @ x, x))
    k, c, m = slopes(residual, q, qd, qdd, jax.tree.map(lambda leaf: jnp.mean(leaf, axis=0), inputs))
    return jnp.linalg.inv(jnp.kron(t.c_q, k) + jnp.kron(t.c_v, c) + jnp.kron(jnp.eye(len(x)), m))


def _size(correction: Array, x: Array) -> Array:
    """Largest component of a correction as a share of the largest acceleration of the step."""
    return jnp.max(jnp.abs(correction)) / (LEAST + jnp.max(jnp.abs(x)))


def _remaining_error(last: Array, previous: Array) -> Array:
    """Estimated error after the last of two corrections, whose sizes are taken to shrink by a constant factor."""
    return last * jnp.where(previous > 0, shrinkage(last, previous), 0.0)


def _guess(t: Tableau, carry: Carry) -> Array:
    """First guess of a step's accelerations (s, n), extrapolated linearly from the last two steps or two stages."""
    x = carry.x
    if len(x) == 1:
        return 2 * x - carry.previous_x
    return x + (x[-1] - x[0]) * t.end_z[0, 1] / (t.w_q[-1, 1] - t.w_q[0, 1])


def mass_and_acceleration(residual: Any, q: Array, qd: Array, inputs: Any) -> tuple[Array, Array]:
    """M (n, n) and q̈ (n,) of equations, which are linear in q̈, at one state."""
    rest, mass = with_slope(lambda qdd: residual(q, qd, qdd, inputs))(jnp.zeros_like(q))
    return mass, jnp.linalg.solve(mass, -rest)


@jax.jit
def compiled_accelerations(residual: Any, q: Array, qd: Array, inputs: Any) -> Array:
    """q̈ that the equations demand at states (k, n) and inputs (k, ...): (k, n)."""
    return jax.vmap(lambda *state: mass_and_acceleration(exact_residual(residual), *state)[1])(q, qd, inputs)


def _advance(t: Tableau, carry: Carry, x: Array) -> tuple[Carry, Array, Array]:
    """The next carry, and q, q̇ at the end of the step."""
    q, qd = t.end_z @ carry.z + t.end_x @ x
    return Carry(t.g @ carry.z + t.d @ x, x, carry.x), q, qd


def steps(
    residual: Any,
    tableau: Tableau,
    carry: Carry,
    inputs: Any,
    at_ends: Any,
    last: Any,
    count: Any,
) -> Any:
    """Take `count` groups of steps with inputs (groups, steps, s, ...) and one Jacobian for each group.

    The result is the carry, q, q̇, q̈ (groups · steps, n) and the relative error of each step. `last` (groups,) is the
    last step that counts in each group.
    """
    stages, n = carry.x.shape

    def take_group(carry: Carry, of_group: Any) -> Any:
        """Take a group's steps by one inverse Jacobian. A scheme of many stages goes on from the last that counts."""
        t, group_inputs, group_ends, end = of_group
        first = jax.tree.map(lambda leaf: leaf[0], group_inputs)
        inverse = _inverse_jacobian(residual, t, carry.z, first, _guess(t, carry))

        def take_step(carry: Carry, stage_inputs: Any) -> Any:
            """Correct the stages of a step until they have converged; return the next carry, and q, q̇, q̈ and error."""

            def unconverged(state: tuple[Array, ...]) -> Array:
                _, size, before, tries = state
                return (tries < FEWEST) | ((tries < MOST) & (_remaining_error(size, before) > NEAR))

            def corrected(state: tuple[Array, ...]) -> tuple[Array, ...]:
                x, size, _, tries = state
                residuals = _stage_residual(residual, t, carry.z, stage_inputs, x)
                correction = (inverse @ residuals.ravel()).reshape(stages, n)
                x = x - correction
                return x, _size(correction, x), size, tries + 1

            x, size, before, _ = jax.lax.while_loop(unconverged, corrected, (_guess(t, carry), jnp.inf, jnp.inf, 0))
            after, q, qd = _advance(t, carry, x)
            return after, (q, qd, x[-1], _remaining_error(size, before))

        after, (q, qd, qdd, error) = jax.lax.scan(take_step, carry, group_inputs)
        if stages > 1:  # z is q and q̇
            filled = end < len(q) - 1
            guess = jnp.broadcast_to(qdd[end], (stages, n))
            from_last = Carry(jnp.stack([q[end], qd[end]]), guess, guess)
            after = jax.tree.map(lambda a, b: jnp.where(filled, a, b), from_last, after)
        at_end = qdd if group_ends is None else compiled_accelerations(residual, q, qd, group_ends)
        return after, (q, qd, at_end, error)

    by_group = tableau, inputs, at_ends, last
    carry, history = _loop_over_groups(take_group, carry, by_group, count, (*jax.tree.leaves(inputs)[0].shape[:2], n))
    return carry, tuple(x.reshape(-1, *x.shape[2:]) for x in history)


def _loop_over_groups(take: Any, carry: Carry, by_group: Any, count: Any, shape: tuple[int, ...]) -> Any:
    """Apply `take` to the first `count` groups in turn, and collect the histories.

    Those of q, q̇ and q̈ have the `shape` (groups, steps, n), that of the error is without n. A scan would take all
    groups, also those that only fill the chunk.
    """

    def take_next(k: Any, state: Any) -> Any:
        carry, history = state
        group = jax.tree.map(lambda leaf: jax.lax.dynamic_index_in_dim(leaf, k, keepdims=False), by_group)
        carry, values = take(carry, group)
        put = partial(jax.lax.dynamic_update_index_in_dim, index=k, axis=0)
        return carry, tuple(put(history_array, part) for history_array, part in zip(history, values, strict=True))

    history = (*[jnp.zeros(shape)] * 3, jnp.zeros(shape[:-1]))
    return jax.lax.fori_loop(0, count, take_next, (carry, history))
