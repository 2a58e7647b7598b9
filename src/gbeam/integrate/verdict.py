"""Verdict on corrections by Newton's method: which steps have converged, which shrink slowly, which are lost."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.types import Flags

# Speed: factors by which corrections of 14 runs become more if a number is half or twice as large (mean, and most); the
# answers stay within 6e-12, of two chaotic runs within 5e-10.
LATE = 6  # corrections of a step until it is near; speed: 1.13, 0.98 (most 1.6)
ALONE = 25  # corrections of a single step, or of the first one, until it converges; speed: 1.41 (most 4.7), 0.92
# Speed of the next: 1.02, 0.92 (most 1.6)
MOVED = 0.3  # size of a correction, as a share of the accelerations, of a step that is far
QUICK = 2  # corrections until the last step is near, up to which more steps follow; speed: 1.21 (most 1.8), 0.99
SLOW = 0.5  # of the last correction: where one is larger, derivatives are closer; speed: 0.80, 1.24 (most 5.9)
FAST = 0.01  # of the last correction: where all are smaller, derivatives are farther apart; speed: 1.00, 1.00
QUICKEST = 0.01  # least factor by which corrections are thought to shrink; speed: 1.00, 1.01 (most 1.1)
STALLED = 0.9  # factor of corrections that do not shrink
TOLERANCE = 1e-12  # of the acceleration: error left by the last correction; speed: 1.02, 0.94 (most 1.5)
ROUNDING = 1e-6  # of the acceleration: largest correction that may stall; speed: 1.00, 1.00
# Speed of the next: 1.08 (most 2.8), 0.99
SUMMED = 1e-10  # of the acceleration: rounding, adding up over steps, where corrections stall
# Speed of the next: 1.00, 1.01 (most 1.2)
STUCK = 4  # corrections from which on, where they do not shrink, the loads' rounding counts
TINY = float(np.finfo(float).tiny)  # which keeps the share of no acceleration a number
CANCELLED = 100 * float(np.finfo(float).eps)  # of forces that cancel: their rounding; speed: 1.00, 0.98 (most 1.1)
BALANCED = 1e-9  # of the forces at a step: what is left of them where a correction may be the last; speed: 1.00, 1.00
# Speed of the next: 1.00, 1.00
SETTLED = 1e-9  # of the acceleration: error left by a correction after which samples are taken no more
GROWN = 10.0  # times the rounding of steps that have converged: the most that another one's may be; speed: 1.00, 1.00
EARLIER = 0.01  # of the largest acceleration before a step, whose own may all vanish; speed: 1.00, 1.03 (most 1.5)


class Judgement(NamedTuple):
    """Flags (t,) of steps that have converged, of steps whose corrections shrink slowly, and of steps that are lost.

    A step is lost that stays far from its solution, or diverges.
    """

    converged_steps: Flags
    slow_steps: Flags
    lost_steps: Flags


class Verdict:
    """Record of the corrections of a window's steps, and judge of them.

    The rows of `corrections` (5, t) are, of each step: the size of the last correction, this size as a share of the
    step's accelerations, the number of corrections, the least factor by which one shrank by the same derivatives, and
    the size of a correction that is rounding. `previous_sizes` (t,) are those of the corrections before the last,
    `reach` (t,) is the size of the accelerations. No rounding counts beyond `bound`.
    """

    previous_sizes: Array
    reach: Array
    arrived: bool

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """Begin with no step."""
        self.corrections, self.bound = np.zeros((5, 0)), np.inf

    def extend(self, added: int) -> None:
        """Append steps without corrections."""
        empty = np.repeat([[np.inf], [np.inf], [0.0], [np.inf], [0.0]], added, axis=1)
        self.corrections = np.concatenate([self.corrections, empty], axis=1)

    def _keep(self, rows: slice) -> None:
        """Reduce to a slice of the steps."""
        self.corrections = self.corrections[:, rows]

    def cut(self, count: int) -> None:
        """Take out all but the first `count` steps."""
        self._keep(slice(count))

    def leave(self, count: int) -> None:
        """Let the first `count` steps leave: their rounding bounds that of others."""
        self.bound = GROWN * float(self.corrections[4, :count].max())
        self._keep(slice(count, None))

    @property
    def last_is_near(self) -> bool:
        """True if the last step is near its solution."""
        return bool(self.corrections[1, -1] <= MOVED)

    @property
    def shares(self) -> Array:
        """Sizes (t,) of the last corrections as shares of the accelerations."""
        return self.corrections[1]

    @property
    def has_begun(self) -> bool:
        """True if a step has been corrected."""
        return bool(self.corrections[2].any())

    @property
    def stuck_steps(self) -> Flags:
        """Flags (t,) of steps whose corrections do not shrink: many, or small ones."""
        size, share, count, *_ = self.corrections
        may_be_rounding = (count >= STUCK) | ((count > 1) & (share <= ROUNDING))
        flags: Flags = may_be_rounding & ~(size <= SLOW * self.previous_sizes)
        return flags

    @property
    def shrinks_fast(self) -> bool:
        """True if the last correction of every step was much smaller than the one before."""
        return bool((self.corrections[0] < FAST * self.previous_sizes).all())

    @property
    def commands_settle(self) -> bool:
        """True if the commands of controllers, which follow the states, change no more."""
        return bool((self.corrections[0] * QUICKEST <= SETTLED * self.reach).all())

    def record(self, size: Array, x: Array) -> None:
        """Record the sizes (t,) of corrections, which have led to accelerations x (t, s, n).

        `arrived` becomes true if the last step has come near its solution by few corrections.
        """
        self.previous_sizes, was_near = self.corrections[0].copy(), self.last_is_near
        self.reach = reach(x)
        self.corrections[0], self.corrections[1] = size, size / self.reach
        self.corrections[2] += 1
        self.arrived = not was_near and self.last_is_near and bool(self.corrections[2, -1] <= QUICK)

    def set_rounding(self, accelerations: Array) -> None:
        """Set the rounding of the steps from the accelerations (t,) that the forces which cancel there would make
        alone.

        The rounding of a window's first steps bounds that of all later ones.
        """
        self.corrections[4] = CANCELLED * accelerations
        if self.bound == np.inf:
            self.bound = GROWN * float(self.corrections[4].max())

    def judge(self, loads: Any, balanced: Flags, *, fresh: Flags, trusted: Flags) -> Judgement:
        """Judge the corrections recorded last. `loads` (t,) are the accelerations that the loads alone would make.

        Derivatives are `fresh` by which no correction has been made before. Those that are not `trusted` are
        interpolated from states far away and may be far too large. A correction by them may be small wherever a step
        is, so that the forces of such a step have to be `balanced`, too.
        """
        size, share, count, smallest, rounding = self.corrections
        is_single = len(size) == 1
        noise = np.minimum(rounding, self.bound) + CANCELLED * loads
        # By derivatives of another state corrections may shrink slowly without being rounding.
        good = converged_steps(size, self.previous_sizes, self.reach, noise, fresh=fresh, quick=smallest <= FAST)
        doubtful = good & ~trusted & ~balanced
        good &= ~doubtful
        factor = size / np.where(fresh | np.isinf(self.previous_sizes), np.nan, self.previous_sizes)
        smallest[:] = np.fmin(smallest, factor)
        slow = (~good & (count > 1) & ~(size <= SLOW * self.previous_sizes)) | (is_single & doubtful)
        far = ~(share <= MOVED)
        is_lost = ~np.isfinite(size) | (far & (count >= (ALONE if is_single else LATE)))
        is_lost[0] |= count[0] >= ALONE
        return Judgement(good, slow, is_lost)


def balanced_steps(remaining: Array, forces: Array, loads: Array) -> Flags:
    """Flags (t,) of steps in balance: their `remaining` forces are small beside the `forces` that cancel there, or no
    more than the rounding of the `loads`; (t, n) each.
    """
    largest_remaining, largest_force, largest_load = (np.abs(sizes).max(axis=1) for sizes in (remaining, forces, loads))
    flags: Flags = largest_remaining <= BALANCED * largest_force + CANCELLED * largest_load
    return flags


def reach(x: Array) -> Array:
    """Size (t,) of the accelerations x (t, s, n) of each step, beside which errors are measured. A share of the largest
    before a step is added, since its own may all vanish.
    """
    largest = np.abs(x).max(axis=(1, 2))
    return largest + EARLIER * np.maximum.accumulate(largest) + TINY


def shrinkage(size: Any, previous: Any) -> Any:
    """Factor, at most 1, by which corrections shrink, from the sizes of the last two. It is 0 after the first one,
    where the size before is infinite.
    """
    xp = namespace(size, previous)
    return xp.minimum(size / xp.maximum(previous, 1e-300), 1.0)


def converged_steps(size: Array, previous: Array, reach: Array, noise: Array, *, fresh: Array, quick: Array) -> Flags:
    """Flags (t,) of steps whose last correction, of a `size`, leaves an error below a tolerance and rounding, `noise`.

    Corrections are taken to shrink by a constant factor, size / before. By `fresh` derivatives this factor is unknown
    and taken as 1, and after the first correction any error may remain. A small correction that stalls is rounding, by
    fresh derivatives or after `quick` ones: the rounding of earlier steps adds to a step's own.
    """
    repeated, factor = np.isfinite(previous), shrinkage(size, previous)
    remaining = size * np.where(fresh, 1.0, np.maximum(factor, QUICKEST))
    error = np.where(repeated, remaining, np.inf)
    stalled = (fresh & repeated & (factor > STALLED)) | (quick & (factor > SLOW) & (size <= SUMMED * reach))
    flags: Flags = (error <= TOLERANCE * reach + noise) | (stalled & (size <= ROUNDING * reach))
    return flags
