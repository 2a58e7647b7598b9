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


def take_equal_steps(
    t: Tableau, mass: Floats, c: Floats, k: Floats, f: Floats, z: Floats
) -> tuple[Floats, Floats] | None:
    """Take equal steps with C and K (t, s, n, n) and F (t, s, n) from z (m, n) by iteration about their means.

    Returns the states before each step and after the last, (t + 1, m n), and the accelerations of stages, (t, s n);
    None where the iteration does not converge.
    """
    mean = _Mean(t, mass, c.mean(axis=(0, 1)), k.mean(axis=(0, 1)))
    state, states, accelerations = z.ravel(), list[Floats](), list[Floats]()
    for first in range(0, len(c), TOGETHER):
        part = slice(first, first + TOGETHER)
        change = np.concatenate([k[part] - mean.k, c[part] - mean.c], axis=3)
        settled = mean.settle(change, f[part].reshape(len(change), -1), state)
        if settled is None:
            return None
        before, x = settled
        state = before[-1]
        states.append(before[:-1])
        accelerations.append(x)
    return np.concatenate([*states, state[None]]), np.concatenate(accelerations)


class _Mean:
    """Maps of a step by mean matrices.

    `per_force` and `per_state` map forces and the state before to the accelerations of stages. `of_state` and
    `of_stages` map the state before and these accelerations to q and q̇ at the stages. `next` maps the accelerations to
    the next state. `powers` are those of the map from state to state.
    """

    def __init__(self, t: Tableau, mass: Floats, c: Floats, k: Floats) -> None:
        """Solve the equations of the stages by mean matrices, for unit forces and for unit states before the step."""
        self.c, self.k, (stages, n) = c, k, (t.w_q.shape[-2], len(mass))
        alike_k, alike_c = (np.broadcast_to(matrix, (1, stages, n, n)) for matrix in (k, c))
        (jacobian,), (onto,) = t.jacobians(alike_k, alike_c, mass[None, None])
        self.per_force = np.linalg.inv(jacobian)
        self.per_state, unit = -self.per_force @ onto, np.eye(n)
        w_q, w_v, c_q, c_v, g, d = (np.kron(weights[0], unit).T for weights in (t.w_q, t.w_v, t.c_q, t.c_v, t.g, t.d))
        self.of_state, self.of_stages, self.next = (w_q, w_v), (c_q, c_v), d
        self.powers = matrix_powers(g.T + d.T @ self.per_state, TOGETHER)

    def settle(self, change: Floats, driven: Floats, state: Floats) -> tuple[Floats, Floats] | None:
        """Return states (t + 1, m n) from the first, (m n,), and accelerations of stages, (t, s n).

        `driven` (t, s n) are forces; K and C differ from their means by `change` (t, s, n, 2 n). The forces of these
        changes are added, and the steps taken again, until the accelerations settle, or None where they do not.
        """
        count, stages, n, _ = change.shape
        forces, previous = driven, np.inf
        for _ in range(MOST):
            by_force = forces @ self.per_force.T
            states = chain(self.powers, by_force @ self.next, state)
            x = by_force + states[:-1] @ self.per_state.T
            if np.abs(x - previous).max() <= SETTLED * np.abs(x).max():
                return states, x
            previous = x
            q, qd = (states[:-1] @ w + x @ c for w, c in zip(self.of_state, self.of_stages, strict=True))
            at_stages = np.concatenate([values.reshape(count, stages, n, 1) for values in (q, qd)], axis=2)
            forces = driven - (change @ at_stages).reshape(count, -1)
        return None


def matrix_powers(step: Floats, count: int) -> Floats:
    """Powers 0, 1, ... (p, n, n) of the map of a step, about as many as the square root of `count`: then a chain of so
    many steps takes the fewest passes.
    """
    powers = [np.eye(len(step))]
    for _ in range(math.isqrt(count) + 1):
        powers.append(powers[-1] @ step)
    return np.array(powers)


def chain(powers: Floats, added: Floats, first: Floats) -> Floats:
    """States (t + 1, n) of z₊ = A z + added (t, n) from the first one, by powers of A.

    Blocks of steps are taken side by side from zero; then each is moved by what its first state adds.
    """
    (count, size), length = added.shape, len(powers) - 1
    blocks = -(-count // length)
    padded = np.zeros((blocks * length, size))
    padded[:count] = added
    by_step = padded.reshape(blocks, length, size).swapaxes(0, 1)
    from_zero = np.zeros((length + 1, blocks, size))
    for k, of_step in enumerate(by_step):
        from_zero[k + 1] = from_zero[k] @ powers[1].T + of_step
    starts = np.empty((blocks, size))
    for block in range(blocks):
        starts[block] = first
        first = powers[-1] @ first + from_zero[-1, block]
    states = from_zero[:-1] + starts @ powers[:-1].swapaxes(1, 2)
    return np.concatenate([states.swapaxes(0, 1).reshape(-1, size), first[None]])[: count + 1]
