"""Runs of nonlinear equations that JAX traces: solved as all others are, outside of its programs.

Their derivative is that of the discrete solution. Differentiated, every step of a run solves with the Jacobian J of its
stages' accelerations x and the derivative L by the state z before it

    δx = −J⁻¹ (δr + L δz),    δz₊ = g δz + d δx,

where δr is the residual's own derivative by what it is made of and by what drives it: JAX traces the residual and this
recurrence, but neither Newton's method nor the run. Commands of controllers, which act in whole steps, add to δr.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.arrays.tree import each_leaf
from gbeam.integrate.equations import Demanded, Fitted, NonlinearEquations, exact, slopes
from gbeam.integrate.sampled import Sampling, Uncontrolled
from gbeam.integrate.schemes import Scheme, stepped
from gbeam.integrate.steps import Steps
from gbeam.integrate.traced_loop import Samples, TracedLoop
from gbeam.integrate.windows import windows

Array = Any


def traced(equations: NonlinearEquations, scheme: Scheme, q: Array, qd: Array, steps: Steps) -> tuple[Array, ...]:
    """q, q̇, q̈ (t + 1, n) at the beginning and the ends of steps; NaN from one that fails on, as their derivatives."""
    ends = [] if scheme.ends else [steps.end]
    loop = TracedLoop(equations.controllers or Uncontrolled(), steps)
    times = np.concatenate([steps.first[:1], *(steps.times(offset) for offset in scheme.offsets), *ends, steps.begin])
    steps = replace(steps, kept=np.ones(len(steps), dtype=bool))
    shape = (len(steps) + 1, len(q))

    of_steps = stepped(equations, scheme, steps, len(q))

    def solved(residual: Any, q: Any, qd: Any, driven: Any, inputs: Any) -> Any:
        residual, q, qd, driven, inputs = jax.tree.map(np.asarray, (residual, q, qd, driven, inputs))
        order = np.argsort(times)

        def drive(t: Any) -> Any:
            at = order[np.searchsorted(times, t, sorter=order)]
            return each_leaf(lambda leaf: leaf[at], driven)

        of, out, done = NonlinearEquations(residual, drive), np.full((3, *shape), np.nan), 0
        if laws := loop.laws_of(inputs):
            of = replace(of, controllers=loop.controllers.of(exact(residual), laws), samplings=[])
        with np.errstate(all="ignore"):  # of what is no number
            for *piece, _ in windows(of, scheme, q, qd, steps):
                out[: len(piece), done : done + len(piece[0])] = piece
                done += len(piece[0])
            if not scheme.ends:
                out[2, :done] = Demanded(of, steps, *out[:2])(np.arange(done))
        return tuple(out), loop.recorded(of.samplings[-1], inputs) if laws else []

    @jax.custom_jvp
    def run(residual: Any, q: Array, qd: Array, driven: Any, inputs: Any) -> Any:
        result = (jax.ShapeDtypeStruct(shape, float),) * 3, loop.shapes
        return jax.pure_callback(solved, result, residual, q, qd, driven, inputs, vmap_method="sequential")

    @run.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        (residual, _, _, driven, inputs), (changed, dq, dqd, redriven, by_inputs) = primals, tangents
        every, in_loop = run(*primals), (loop, inputs, by_inputs)
        return every, _changes(scheme, steps, every, (residual, driven), (changed, redriven), dq, dqd, in_loop)

    inputs = jax.tree.map(lambda leaf: jnp.asarray(leaf, dtype=float), loop.inputs)
    start = jnp.asarray(q, dtype=float), jnp.asarray(qd, dtype=float)
    histories, samples = run(of_steps, *start, equations.drive(times), inputs)
    if loop.laws:
        loop.values = samples
        equations.samplings.append(loop)
    return tuple(histories)


def _changes(
    scheme: Scheme, steps: Steps, results: Any, of: Any, changed: Any, dq: Array, dqd: Array, in_loop: Any
) -> Any:
    """Derivatives of a run's q, q̇, q̈ and samples along changes of its residual and drives, of q, q̇ at the start, and of
    the laws of its controllers.
    """
    (run, samples), (loop, *laws), t = results, in_loop, scheme.tableau(steps.length)
    q, qd, qdd = run
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
    solved_at, begun = (
        [jax.tree.map(lambda leaf, some=some: leaf[some], each) for each in (of[1], changed[1])]
        for some in (slice(len(states[0])), slice(len(states[0]), None))
    )
    held, driven_by = loop.held(samples), loop.controllers.driven
    commands = jnp.concatenate([0 * held[:1], *[held] * ((len(states[0]) - 1) // count)])
    follow = loop.changes((of[0], begun[0]), (changed[0], begun[1]), run, *laws, samples)

    def host(*arguments: Any) -> Any:
        (q, qd, qdd), residual, driven, commands = jax.tree.map(np.asarray, arguments)
        inputs = driven_by(driven, commands)
        with np.errstate(all="ignore"):
            onto = Sampling(loop.controllers, residual, None, steps).onto(q, qd, qdd, inputs)
            return (*slopes(residual, q, qd, qdd, inputs), onto)

    square = (jax.ShapeDtypeStruct((len(states[0]), n, n), float),) * 3
    wide = jax.ShapeDtypeStruct((len(states[0]), n, commands.shape[1]), float)
    arguments = states, of[0], solved_at[0], commands
    *slope, onto = jax.pure_callback(host, (*square, wide), *arguments, vmap_method="sequential")
    _, direct = jax.jvp(
        lambda residual, driven: residual(*states, driven_by(driven, commands)),
        (of[0], solved_at[0]),
        (changed[0], solved_at[1]),
    )

    def accelerated(some: slice, dq: Array, dqd: Array, du: Array) -> Array:
        k, c, m = (each[some] for each in slope)
        if isinstance(of[0], Fitted):
            c, m = c - of[0].damping, m - of[0].mass
        left = direct[some] + (k @ dq[..., None] + c @ dqd[..., None] + onto[some] @ du[..., None])[..., 0]
        return -jnp.linalg.solve(m, left[..., None])[..., 0]

    def by_stage(values: Array) -> Array:
        return jnp.moveaxis(values[1 : 1 + stages * count].reshape(stages, count, *values.shape[1:]), 0, 1)

    jacobian, by_z = t.jacobians(*map(by_stage, slope))
    inverse = jnp.linalg.inv(jacobian)

    def step(carried: Any, at: Any) -> Any:
        dz, law = carried
        inverse, by_z, by_command, direct, g, d, sampled = at
        law, du, taken = follow.step(law, dz, sampled)
        change = direct.ravel() + by_z @ dz.ravel() + (by_command @ du).ravel()
        dx = -(inverse @ change).reshape(stages, n)
        return (g @ dz + d @ dx, law), (dz, dx, du, taken)

    dqdd = accelerated(slice(0, 1), dq[None], dqd[None], jnp.zeros((1, commands.shape[1])))
    begin = first @ jnp.stack([dq, dqd, dqdd[0]]), follow.begin
    by_step = inverse, by_z, by_stage(onto), by_stage(direct), t.g, t.d, follow.by_step
    _, (dz, dx, du, taken) = jax.lax.scan(step, begin, by_step)
    ends = t.end_z @ dz + t.end_x @ dx
    changes = ends[:, 0], ends[:, 1]
    at_ends = dx[:, -1] if scheme.ends else accelerated(slice(-count, None), *changes, du)
    before = dq[None], dqd[None], dqdd
    histories = tuple(jnp.concatenate(pair) for pair in zip(before, (*changes, at_ends), strict=True))
    return histories, [Samples(*(part[k] for part in each)) for each, k in zip(taken, follow.at, strict=True)]
