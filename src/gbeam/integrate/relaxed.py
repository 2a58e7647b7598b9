"""Steps of linear equations whose matrices hardly change: by their mean, the changes as forces, until these settle.

The map of a step by the mean matrices is found once. The stages that it gives make the forces of K(t) − K̄ and C(t) − C̄,
with which all steps are taken again. The answer is that of the steps one by one, to rounding.
"""

from __future__ import annotations

import math

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.integrate.schemes import Tableau

FEWEST = 10  # coordinates: of fewer, the maps of all steps cost less
TOGETHER = 100  # steps: what changes over more of them takes longer to settle
MOST = 16  # repetitions, after which the maps of all steps cost less
SETTLED = 1e-14  # of the largest acceleration


def relaxed(t: Tableau, mass: Floats, c: Floats, k: Floats, f: Floats, z: Floats) -> tuple[Floats, Floats] | None:
    """States before each step and after the last, (t + 1, m n), and accelerations of stages, (t, s n), from z (m, n) by
    equal steps with C and K (t, s, n, n) and F (t, s, n); None where they do not settle.
    """
    mean = _Mean(t, mass, c.mean(axis=(0, 1)), k.mean(axis=(0, 1)))
    state, states, accelerations = z.ravel(), list[Floats](), list[Floats]()
    for first in range(0, len(c), TOGETHER):
        part = slice(first, first + TOGETHER)
        change = np.concatenate([k[part] - mean.k, c[part] - mean.c], axis=3)
        settled = mean.settled(change, f[part].reshape(len(change), -1), state)
        if settled is None:
            return None
        before, x = settled
        state = before[-1]
        states.append(before[:-1])
        accelerations.append(x)
    return np.concatenate([*states, state[None]]), np.concatenate(accelerations)


class _Mean:
    """Maps of a step by mean matrices: of forces and the state before to the accelerations of stages, of these to
    coordinates and rates there and to the next state, and its powers.
    """

    def __init__(self, t: Tableau, mass: Floats, c: Floats, k: Floats) -> None:
        self.c, self.k, (stages, n) = c, k, (t.w_q.shape[-2], len(mass))
        alike_k, alike_c = (np.broadcast_to(matrix, (1, stages, n, n)) for matrix in (k, c))
        (jacobian,), (onto,) = t.jacobians(alike_k, alike_c, mass[None, None])
        self.per_force = np.linalg.inv(jacobian)
        self.per_state, unit = -self.per_force @ onto, np.eye(n)
        w_q, w_v, c_q, c_v, g, d = (np.kron(weights[0], unit).T for weights in (t.w_q, t.w_v, t.c_q, t.c_v, t.g, t.d))
        self.of_state, self.of_stages, self.next = (w_q, w_v), (c_q, c_v), d
        self.powers = _powers(g.T + d.T @ self.per_state, TOGETHER)

    def settled(self, change: Floats, driven: Floats, state: Floats) -> tuple[Floats, Floats] | None:
        """States (t + 1, m n) from one (m n,), and accelerations of stages, under forces (t, s n), where K and C change
        by (t, s, n, 2 n); None where they do not settle.
        """
        count, stages, n, _ = change.shape
        forces, before = driven, np.inf
        for _ in range(MOST):
            by_force = forces @ self.per_force.T
            states = _chain(self.powers, by_force @ self.next, state)
            x = by_force + states[:-1] @ self.per_state.T
            if np.abs(x - before).max() <= SETTLED * np.abs(x).max():
                return states, x
            before = x
            stage = [states[:-1] @ w + x @ c for w, c in zip(self.of_state, self.of_stages, strict=True)]
            moved = np.concatenate([each.reshape(count, stages, n, 1) for each in stage], axis=2)
            forces = driven - (change @ moved).reshape(count, -1)
        return None


def _powers(step: Floats, count: int) -> Floats:
    """Powers 0, 1, ... (p, n, n) of the map of a step: as many as make a chain of `count` steps shortest."""
    powers = [np.eye(len(step))]
    for _ in range(math.isqrt(count) + 1):
        powers.append(powers[-1] @ step)
    return np.array(powers)


def _chain(powers: Floats, added: Floats, first: Floats) -> Floats:
    """States (t + 1, n) of z₊ = A z + added (t, n) from the first, by powers of A: blocks of steps side by side, which
    are then joined.
    """
    (count, size), length = added.shape, len(powers) - 1
    blocks = -(-count // length)
    parts = np.zeros((blocks * length, size))
    parts[:count] = added
    apart = np.zeros((length + 1, blocks, size))  # states of blocks that begin at zero
    for state, following, part in zip(
        apart, apart[1:], parts.reshape(blocks, length, size).swapaxes(0, 1), strict=False
    ):
        following[:] = state @ powers[1].T + part
    starts = np.empty((blocks, size))
    for block in range(blocks):
        starts[block] = first
        first = powers[-1] @ first + apart[-1, block]
    states = apart[:-1] + starts @ powers[:-1].swapaxes(1, 2)
    return np.concatenate([states.swapaxes(0, 1).reshape(-1, size), first[None]])[: count + 1]
