"""The derivative of a run: the equations linearised about it, taken through time by the steps of the run itself.

Every step of a run solves r(q, q̇, q̈, t; p) = 0 at its stages. Differentiated with respect to p it is the same step of

    M δq̈ + C δq̇ + K δq = −∂r/∂p,

with M, C and K at the states of the run: the derivative of the discrete solution, not of the continuous one. The
parameters are right-hand sides of one system, so many cost little more than one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.integrate.schemes import Scheme, Tableau
from gbeam.integrate.steps import Steps

# Times, q and q̇ (k, n) there -> M, C, K (k, n, n) and −∂r/∂p (k, n, p).
System = Callable[[Floats, Floats, Floats], tuple[Floats, Floats, Floats, Floats]]
_CHUNK = 256  # steps whose systems are solved at once


def tangent(
    system: System,
    scheme: Scheme,
    steps: Steps,
    run: Trajectory,
    q: Floats,
    qd: Floats,
    *,
    linear_system: System | None = None,
    accelerations: bool = True,
) -> tuple[Floats, Floats, Floats]:
    """Derivatives (t + 1, n, p) of a run's q, q̇ and q̈ with respect to p parameters, from those at its start, q and qd
    (n, p).

    `system` gives the equations linearised about the run's states, `linear_system` those that its fitted steps solve.
    Without `accelerations` the result's q̈ may be those of the last stage.
    """
    shape = (len(steps) + 1, *q.shape)
    histories = np.empty(shape), np.empty(shape), np.empty(shape)
    histories[0][0], histories[1][0] = q, qd
    histories[2][0] = _accelerations(system, steps.drive_begin[:1], run, [0], q[None], qd[None])[0]
    z = np.einsum(
        "ij,jnp->inp", scheme.tableau(steps.length[0]).initial, np.stack([history[0] for history in histories])
    )
    # A chunk ends where the scheme starts anew.
    ends = np.append(np.flatnonzero(steps.anew[:-1]) + 1, len(steps)) if scheme.ends else [len(steps)]
    begin = 0
    for end in ends:
        for first in range(begin, end, _CHUNK):
            part = slice(first, min(first + _CHUNK, end))
            z, piece = _chunk(system, linear_system or system, scheme, z, steps[part], _part(run, part), accelerations)
            for history, values in zip(histories, piece, strict=True):
                history[part.start + 1 : part.stop + 1] = values
        if end < len(steps):
            q, qd = histories[0][end], histories[1][end]
            qdd = _accelerations(system, steps.resume[[end - 1]], run, [end], q[None], qd[None])[0]
            z = np.einsum("ij,jnp->inp", scheme.tableau(steps.length[end]).initial, np.stack([q, qd, qdd]))
        begin = end
    return histories


def _part(run: Trajectory, steps: slice) -> Trajectory:
    """The run from the beginning of some steps to their end."""
    times = slice(steps.start, steps.stop + 1)
    return Trajectory(run.time[times], run.q[times], run.qd[times], run.qdd[times])


def _accelerations(system: System, time: Floats, run: Trajectory, indices: Any, q: Floats, qd: Floats) -> Floats:
    """δq̈ (k, n, p) by the linearised equations for δq, δq̇, `q` and `qd`, about the run's states at `indices`."""
    mass, c, k, f = system(time, run.q[indices], run.qd[indices])
    return np.asarray(np.linalg.solve(mass, f - c @ qd - k @ q), dtype=np.float64)


def _chunk(
    system: System, linear_system: System, scheme: Scheme, z: Floats, steps: Steps, run: Trajectory, accelerations: bool
) -> tuple[Floats, tuple[Floats, Floats, Floats]]:
    """Take steps from z (m, n, p); return the next z, and δq, δq̇, δq̈ (t, n, p) at their ends."""
    t = scheme.tableau(steps.length)
    stages, (m, n, p) = len(scheme.offsets), z.shape
    states = _states(run, scheme, t)
    at_stages = [
        linear_system(steps.times(offset), *state) for offset, state in zip(scheme.offsets, states, strict=True)
    ]
    mass, c, k, f = (np.stack(matrices, axis=1) for matrices in zip(*at_stages, strict=True))
    jacobian, by_state = t.jacobians(k, c, mass)
    # x = onto z + constant at all stages.
    x = np.linalg.solve(jacobian, np.concatenate([-by_state, f.reshape(len(steps), stages * n, p)], axis=-1))
    input_maps, constant = x[..., : m * n], x[..., m * n :]
    # Each step is an affine map of z, and the states before the steps are a recurrence.
    by_stage = x.reshape(len(steps), stages, n, m * n + p)
    unit = np.eye(m * n, m * n + p).reshape(m, n, m * n + p)
    maps = np.einsum("tij,jnk->tink", t.g, unit) + np.einsum("tis,tsnk->tink", t.d, by_stage)
    maps = maps.reshape(len(steps), m * n, m * n + p)
    earlier = np.empty((len(steps), m * n, p))
    state = z.reshape(m * n, p)
    for index, of_step in enumerate(maps):
        earlier[index] = state
        state = of_step[:, : m * n] @ state + of_step[:, m * n :]
    x = (input_maps @ earlier + constant).reshape(len(steps), stages, n, p)
    ends = np.einsum("tij,tjnp->tinp", t.end_z, earlier.reshape(len(steps), m, n, p))
    ends += np.einsum("tis,tsnp->tinp", t.end_x, x)
    q, qd, qdd = ends[:, 0], ends[:, 1], x[:, -1]
    # The last stage's q̈ is that at the end, unless the stage lies before it, or just before a jump.
    lacking = np.flatnonzero(steps.jump) if scheme.ends else np.arange(len(steps))
    if lacking.size and accelerations:
        qdd[lacking] = _accelerations(system, steps.end[lacking], run, lacking + 1, q[lacking], qd[lacking])
    return state.reshape(m, n, p), (q, qd, qdd)


def _states(run: Trajectory, scheme: Scheme, t: Tableau) -> list[tuple[Floats, Floats]]:
    """q and q̇ of the run at each stage of its steps."""
    if scheme.ends:
        return [(run.q[1:], run.qd[1:])]
    # z is q and q̇: what a step adds to it says what its stages' accelerations were.
    z = np.stack([run.q, run.qd], axis=1)
    x = np.linalg.solve(t.d, z[1:] - t.g @ z[:-1])
    q, qd = t.w_q @ z[:-1] + t.c_q @ x, t.w_v @ z[:-1] + t.c_v @ x
    return [(q[:, i], qd[:, i]) for i in range(len(scheme.offsets))]
