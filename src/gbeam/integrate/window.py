"""A window of steps taken together: their states, accelerations and inputs, corrected in place by Newton's method.

One correction of all unknowns is a recurrence over the steps: with the residual r of a step's stages, its Jacobian J
with respect to their accelerations x and L with respect to the state z before it

    δx = −J⁻¹ (r + L δz),    δz₊ = g δz + d δx + (g z + d x − z₊).
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.integrate.derivatives import Stages, products
from gbeam.integrate.linear import recurrence
from gbeam.integrate.sampled import HeldCommands, Sampling
from gbeam.integrate.schemes import Scheme, Tableau
from gbeam.integrate.steps import Steps
from gbeam.integrate.verdict import ROUNDING

# Speed: factors by which corrections of 14 runs become more if a number is half or twice as large (mean, and most).
FIRST = 100  # steps in a window at first; speed: 1.12, 0.88 (most 2.0)
MOST = 200  # steps in a window at most; speed: 1.03, 1.03 (most 1.8)
LONGEST = 1000  # steps in a window where one state's derivatives serve all; speed: 1.00, 1.00
AHEAD = 400  # steps whose drives are evaluated at once; it changes no correction and no answer
FEW = 64  # steps under way, up to which more follow: of many, a call costs little beside its sums; speed: 1.07, 0.95
HALVINGS = 8  # of a correction of a single step
SHARE = 1e-9  # of states: a change by which the second difference of a smooth force is less than rounding
ROUNDED = 10 * float(np.finfo(float).eps)  # of forces that cancel: their second difference, with a margin


class Window:
    """The steps under way, from number `first` on: states z (t + 1, m, n) and accelerations x (t, s, n) of stages.

    `residuals` (t, s n) are those of the last iterate, `start` (n,) the accelerations that the first steps begin with.
    `growth` is the number of steps to append next, `limit` the most steps of a window that has begun anew.
    """

    z: Array
    x: Array
    start: Array
    residuals: Array
    tableau: Tableau
    inputs: Any

    def __init__(self, residual: Any, drive: Any, scheme: Scheme, steps: Steps, sampling: Sampling | None) -> None:
        self.residual, self.drive, self.scheme, self.steps, self.sampling = residual, drive, scheme, steps, sampling
        self.first, self.growth, self.limit = 0, FIRST, LONGEST
        self.ahead, self.driven, self.held = range(0), cast(Any, None), cast(Any, None)
        self.done, self.lengths = list[tuple[Array, ...]](), np.zeros(0)

    def __len__(self) -> int:
        return len(self.x)

    def begin(self, z: Array, x: Array) -> None:
        """Begin with no step, from a state z (m, n) and accelerations (n,)."""
        self.z, self.x, self.start = z[None], np.zeros((0, len(self.scheme.offsets), len(x))), x

    def room(self, end: int, *, single: bool) -> int:
        """Number of steps before `end` to append, if the last one is near its solution.

        A window is longer where all its steps have a `single` set of derivatives. None are added to one with samples of
        controllers, with many steps, or with a single step that has failed before.
        """
        count = len(self)
        if count and (self.sampling is not None or count > FEW or self.limit == 1):
            return 0
        largest_room = LONGEST if single else MOST
        return max(min(self.growth, end - self.first - count, largest_room - count), 0)

    def extend(self, added: int) -> None:
        """Append steps, and guess each like the last one."""
        last = self.x[-1:, -1:] if len(self) else self.start
        self.z = np.concatenate([self.z, np.repeat(self.z[-1:], added, axis=0)])
        self.x = np.concatenate([self.x, np.broadcast_to(last, (added, *self.x.shape[1:]))])
        self._place()

    def grow(self) -> None:
        """Let more steps follow the next time, half as many again."""
        self.growth = min(self.growth + self.growth // 2 + 1, LONGEST)

    def _keep(self, rows: slice) -> None:
        """Reduce the window to a slice of its steps, the first or the last."""
        states = slice(rows.start, rows.stop if rows.stop is None else rows.stop + 1)
        self.z, self.x = self.z[states], self.x[rows]
        if len(self):
            self._place()

    def leave(self, count: int) -> None:
        """Move the first `count` steps, which have converged, out of the window, and store their ends in `done`."""
        z, x, t = self.z[:count], self.x[:count], self.tableau
        end_z, end_x = t.end_z, t.end_x
        if len(end_z) > 1:  # steps of several lengths
            end_z, end_x = end_z[:count], end_x[:count]
        ends = end_z @ z + end_x @ x
        qdd = [x[:, -1]] if self.scheme.ends else []
        self.done.append((ends[:, 0], ends[:, 1], *qdd))
        self.start, self.first, self.limit = x[-1, -1], self.first + count, LONGEST
        self._keep(slice(count, None))

    def take_ends(self) -> tuple[Array, ...]:
        """Return q, q̇ and, if the scheme has it, q̈ (t, n) at the ends of the steps that left since the last call."""
        ends = tuple(map(np.concatenate, zip(*self.done, strict=True)))
        self.done = []
        return ends

    def cut(self, count: int) -> None:
        """Take out all but the first `count` steps, and let half as many follow the next time."""
        self.growth = max(min(self.growth, len(self)) // 2, 1)
        self._keep(slice(count))

    def shrink(self) -> bool:
        """Begin again with a quarter of the steps, at last with one. Return False if a single step has failed."""
        if len(self) == self.limit == 1:
            return False
        self.growth = self.limit = max(min(len(self), self.limit) // 4, 1)
        self.begin(self.z[0], self.start)
        return True

    def stages(self) -> Stages:
        """States and inputs at the stages of all steps, by the last iterate."""
        starts_and_solutions = self.weights @ np.concatenate([self.z[:-1], self.x], axis=1)[:, None]
        states = (
            np.concatenate([starts_and_solutions, self.x[:, None]], axis=1)
            .swapaxes(0, 1)
            .reshape(3, -1, self.x.shape[-1])
        )
        return Stages(self.times, states, self.inputs)

    def correct(self, stages: Stages, maps: tuple[Array, Array, Array]) -> Array:
        """Correct states and accelerations of all steps by Newton's method; return the largest correction of each
        step's accelerations, (t,). That of a single step is halved until it makes the next one smaller.
        """
        inverse, answer, step = maps
        t, count = self.tableau, len(self)
        self.residuals = self.residual(*stages.states, self.inputs).reshape(count, -1)
        by_residual = products(inverse, self.residuals)
        # g z + d (x − J⁻¹ r) − z₊, the part of δz₊ that is there without a change of the state before
        defect = t.g @ self.z[:-1] + t.d @ (self.x - by_residual.reshape(self.x.shape)) - self.z[1:]
        by_step = self._state_changes(step, defect.reshape(count, -1))
        # −δx = J⁻¹ (r + L δz)
        change = (by_residual + products(answer, by_step[:-1])).reshape(self.x.shape)
        commands = self._commands
        if commands is not None:
            change = change + commands.apply_change(self.x.shape)
            self.inputs = commands.add_commands(self.free, self.x.shape[1])
        by_state = by_step.reshape(self.z.shape)
        self.z += by_state
        self.x -= change
        if count == 1:
            self._shorten(inverse, by_state, change)
        return np.asarray(np.abs(change).max(axis=(1, 2)))

    def loads(self, stages: Stages) -> tuple[Array, Array]:
        """Sizes (t, s n) of the loads, and of the forces that cancel within bodies, by residuals near the last one.

        That of the loads is the change if every component of an input changed by its largest one. So a weight counts
        even where it acts only across what a joint lets move. What cancels is shown by its rounding, the second
        difference where the states change. The rounding of a step stays in the following ones.
        """

        def near(share: float, inputs: Any) -> Array:
            """Residuals where the states change by a share of themselves."""
            return np.asarray(self.residual(*((1 + share) * stages.states), inputs).reshape(len(self), -1))

        shifted = each_leaf(lambda leaf: leaf + SHARE * np.abs(leaf).max(initial=0.0), stages.inputs)
        by_inputs = np.abs(near(0.0, shifted) - self.residuals) / SHARE
        change = near(SHARE, stages.inputs) - 2 * self.residuals + near(-SHARE, stages.inputs)
        return by_inputs, np.sqrt(np.cumsum(change**2, axis=0)) / ROUNDED

    @property
    def _commands(self) -> HeldCommands | None:
        """Commands to be corrected: none where they have settled."""
        return None if self.held is None or self.held.is_settled else self.held

    def _place(self) -> None:
        """Set tableau, times and inputs of the steps under way. Drives are evaluated for `AHEAD` steps at once."""
        stages, last = len(self.scheme.offsets), self.first + len(self)
        if last > self.ahead.stop:
            self.ahead = range(self.first, min(max(last, self.first + AHEAD), len(self.steps)))
            ahead = self.steps[self.ahead.start : self.ahead.stop]
            self.all_times = np.stack([ahead.times(offset) for offset in self.scheme.offsets], axis=1).ravel()
            self.driven = self.drive(self.all_times)
        length, begin = self.steps.length[self.first : last], self.first - self.ahead.start
        lengths = length[:1] if (length == length[0]).all() else length
        if not np.array_equal(lengths, self.lengths):
            t: Tableau = self.scheme.tableau(lengths)
            # Weights of (z, x) in q and q̇ at the stages.
            q_row = np.concatenate([t.w_q, t.c_q], axis=-1)
            v_row = np.concatenate([t.w_v, t.c_v], axis=-1)
            self.lengths, self.tableau, self.weights = lengths, t, np.stack([q_row, v_row], axis=1)
        under_way = slice(stages * begin, stages * (begin + len(length)))
        self.times = self.all_times[under_way]
        self.inputs = self.free = each_leaf(lambda leaf: leaf[under_way], self.driven)
        if self.sampling is not None:
            self.held = HeldCommands(self.sampling, self.first, len(length))
            self.held.begin(self.z[:-1])
            self.inputs = self.held.add_commands(self.free, stages)

    def _state_changes(self, step: Array, defect: Array) -> Array:
        """Changes δz (t + 1, m n) of the states by the recurrence δz₊ = S δz + defect, from zero.

        `step` S is (1 or t, m n, m n), `defect` (t, m n). Commands of controllers add what they change.
        """
        count, commands = len(defect), self._commands
        if len(step) > 1 and commands is None:
            return recurrence(np, np.concatenate([step, defect[..., None]], axis=-1), np.zeros(defect.shape[1]))
        changes = np.zeros((count + 1, defect.shape[1]))
        if commands is None:  # one map: each pass doubles the number of steps over which defects are summed
            changes[1:], power, reach = defect, step[0].T, 1
            while reach < count:
                changes[1 + reach :] += changes[1:-reach] @ power
                power, reach = power @ power, 2 * reach
            return changes
        commands.measure(self.z[:-1])
        maps = np.broadcast_to(step, (count, *step.shape[1:]))
        for k in range(count):
            changes[k + 1] = maps[k].dot(changes[k]) + defect[k] + commands.take_samples(k, changes[k])
        return changes

    def _shorten(self, inverse: Array, by_state: Array, change: Array) -> None:
        """Halve a single step's correction until the next one would be smaller. Friction or a stop bends the residual,
        so that a full correction may go too far.
        """
        share, full_size = 1.0, np.linalg.norm(change)
        for _ in range(HALVINGS):
            following = inverse @ self.residual(*self.stages().states, self.inputs).reshape(1, -1, 1)
            if np.linalg.norm(following) <= (1 - share / 2) * full_size or full_size <= ROUNDING * np.linalg.norm(
                self.x
            ):
                return
            share /= 2
            self.z -= share * by_state
            self.x += share * change
