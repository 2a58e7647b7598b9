"""The steps of a run: equal ones, split where what drives the equations has a corner or jumps.

A scheme has its order where the solution is smooth over each step. A jump of the drive within a step leaves an error of
first order, whatever the scheme; a corner one of third, which only schemes of fourth order feel.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Flags, Floats
from gbeam.integrate.equations import Drive
from gbeam.integrate.schemes import Scheme

_NEAR, _ULPS = 1e-8, 8  # of a step, and roundings of a time: nearer to one another, two times are one
_JUMP = 1e-4  # of the largest value at or between the corners: less is no jump
_MIDWAY = 0.37  # of the way from one corner to the next
FEW = 10_000  # steps: what is kept of them is small
_SIDE_STEP = 1e-12  # of the span: where a drive is looked at on both sides of a corner


@dataclass(frozen=True)
class Corners:
    """Times at which the drive has a corner, s, ascending, and at which of them it jumps; (k,) each."""

    time: Floats
    jump: Flags

    @staticmethod
    def from_times(times: Any, drive: Drive, start: float, end: float) -> Corners:
        """Corners at those `times` (s) in [start, end). One is a jump if the drive differs on its two sides."""
        time = np.unique(np.asarray(times, dtype=np.float64))
        time = time[(time >= start) & (time < end)]
        if not len(time):
            return Corners(time, np.zeros(0, dtype=bool))
        side_step = _SIDE_STEP * (end - start) + _ULPS * np.spacing(max(abs(start), abs(end)))
        # Between them the drive is seen at its size: a sine is zero at both its ends.
        midway = time + _MIDWAY * np.diff(time, append=end)
        count, jump = len(time), np.zeros(len(time), dtype=bool)

        def mark_jumps(leaf: Any) -> None:
            left_values, right_values, middle = np.asarray(leaf).reshape(3, count, -1)
            change = np.abs(right_values - left_values).max(axis=1, initial=0.0)
            largest = np.abs([left_values, right_values, middle]).max(initial=0.0)
            jump[:] |= change > _JUMP * largest

        each_leaf(mark_jumps, drive(np.concatenate([time - side_step, time + side_step, midway])))
        return Corners(time, jump)

    def felt_by(self, scheme: Scheme) -> Corners:
        """Return the corners at which a scheme's steps have to end: all, or for schemes of second order the jumps."""
        return self if scheme.order > 2 else Corners(self.time[self.jump], self.jump[self.jump])


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps in order, (t,) each: the times at which they begin and end, and their lengths.

    The drive is read from `drive_begin` to `drive_end`, which are just inside a step where the drive jumps. Steps that
    are `kept` end at a time of output; `jump` flags a jump at the end, and after `anew` the scheme starts anew.
    `resume` is `drive_begin` of the next step, `following` its length.
    """

    begin: Floats
    length: Floats
    end: Floats
    drive_begin: Floats
    drive_end: Floats
    kept: Flags
    jump: Flags
    anew: Flags
    resume: Floats
    following: Floats

    def __len__(self) -> int:
        return len(self.begin)

    def __getitem__(self, index: Any) -> Steps:
        return Steps(*(getattr(self, field.name)[index] for field in dataclasses.fields(self)))

    def times(self, offset: float) -> Floats:
        """Times, s, at a share `offset` of the way through the steps."""
        if offset == 1.0:
            return self.drive_end
        return np.clip(self.begin + offset * self.length, self.drive_begin, self.drive_end)

    @property
    def longest(self) -> float:
        """Length of the longest step, s."""
        return float(self.length.max())

    @property
    def equal(self) -> bool:
        """True if all steps have one length, and the scheme starts anew after none."""
        return bool((self.length == self.length[0]).all() and not self.anew.any())


def make_steps(start: float, step: float, count: int, corners: Corners | None = None) -> Steps:
    """Return `count` steps of length `step`, split at the corners within them.

    Their times are products of the step, so that they do not drift.
    """
    if count > FEW:
        return _fitted(start, step, count, corners)
    key = None if corners is None else (corners.time.tobytes(), corners.jump.tobytes())
    return _shared(start, step, count, key)


def join_steps(parts: Sequence[Steps]) -> Steps:
    """Join steps of parts that follow one another. A scheme starts anew where their lengths differ."""
    if len(parts) == 1:
        return parts[0]
    names = [field.name for field in dataclasses.fields(Steps)]
    joined = Steps(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
    last = np.cumsum([len(part) for part in parts[:-1]]) - 1
    following, resume = joined.following.copy(), joined.resume.copy()
    following[last], resume[last] = joined.length[last + 1], joined.drive_begin[last + 1]
    anew = joined.jump | (following != joined.length)
    return dataclasses.replace(joined, following=following, resume=resume, anew=anew)


@lru_cache(maxsize=8)
def _shared(start: float, step: float, count: int, corners: tuple[bytes, bytes] | None) -> Steps:
    """Return steps from a cache, whose keys are numbers and the bytes of the corners."""
    restored = None if corners is None else Corners(np.frombuffer(corners[0]), np.frombuffer(corners[1], dtype=bool))
    return _fitted(start, step, count, restored)


def _fitted(start: float, step: float, count: int, corners: Corners | None) -> Steps:
    """Make steps between equidistant nodes, and cut them at the corners that lie off the nodes."""
    nodes = np.asarray(start + step * np.arange(count + 1), dtype=np.float64)
    if corners is None or not len(corners.time):
        ones, length = np.ones(count, dtype=bool), np.full(count, step)
        return Steps(nodes[:-1], length, nodes[1:], nodes[:-1], nodes[1:], ones, ~ones, ~ones, nodes[1:], length)
    tolerance = _NEAR * step + _ULPS * np.spacing(np.abs(nodes).max())
    nearest = np.clip(np.round((corners.time - start) / step).astype(int), 0, count)
    off_grid = np.abs(corners.time - nodes[nearest]) > tolerance
    cuts = corners.time[off_grid & (corners.time > start) & (corners.time < nodes[-1])]
    cuts = cuts[np.append(np.diff(cuts) > tolerance, True)[: len(cuts)]]
    times, is_recorded = np.concatenate([nodes, cuts]), np.arange(len(nodes) + len(cuts)) <= count
    order = np.argsort(times)
    times, is_recorded = times[order], is_recorded[order]
    jump = np.zeros(len(times), dtype=bool)
    jump[np.searchsorted(times, corners.time[corners.jump] - tolerance).clip(max=len(times) - 1)] = True
    length = np.where(is_recorded[1:] & is_recorded[:-1], step, np.diff(times))
    # The drive is read just inside a step where it jumps at an end.
    inside = 2 * tolerance * jump
    first, last = times[:-1] + inside[:-1], times[1:] - inside[1:]
    following, resume = np.append(length[1:], length[-1]), np.append(first[1:], times[-1])
    anew = jump[1:] | (following != length)
    return Steps(times[:-1], length, times[1:], first, last, is_recorded[1:], jump[1:], anew, resume, following)
