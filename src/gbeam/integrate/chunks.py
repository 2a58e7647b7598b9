"""Steps of nonlinear equations in chunks of equal size, one for each call of a compiled program."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gbeam.integrate.equations import Drive
from gbeam.integrate.schemes import Scheme
from gbeam.integrate.steps import Steps

CHUNK = 200  # steps per compiled call at most, and per look at whether to stop
_AT_ONCE = 20  # chunks whose inputs are computed at once


@dataclass(frozen=True)
class Chunk:
    """Steps of one compiled call in groups; `last` (groups,) is −1 where a group only fills, `inputs` (groups, steps,
    s, ...).
    """

    steps: Steps
    last: Any
    tableau: Any
    inputs: Any
    at_ends: Any

    @cached_property
    def inside(self) -> Any:
        """Flags of the steps that are no fillings."""
        return (np.arange(len(self.steps) // len(self.last)) <= self.last[:, None]).ravel()

    @property
    def count(self) -> int:
        """Groups that are not of fillings."""
        return int(np.count_nonzero(self.last >= 0))

    @property
    def end(self) -> Steps:
        """The last step that is no filling."""
        return self.steps[np.flatnonzero(self.inside)[-1]]


@dataclass(frozen=True)
class Stretch:
    """Many chunks of a run's steps without inputs; `shape` is (groups, steps), `times` (steps, stages) s is where
    inputs are needed.
    """

    steps: Steps
    shape: tuple[int, int]
    lasts: list[Any]
    tableau: Any
    times: Any


def stretches(scheme: Scheme, steps: Steps, size: int) -> Iterator[Stretch]:
    """Steps in groups of `size`, some chunks at a time."""
    all_groups = list(_groups(steps, size, restart=scheme.ends))
    for some in (all_groups[k : k + _AT_ONCE] for k in range(0, len(all_groups), _AT_ONCE)):
        index = np.concatenate([each for each, _ in some])
        chosen, tableau = steps[index.ravel()], scheme.tableau(steps.length[index[:, 0]])
        times = [chosen.times(offset) for offset in scheme.offsets] + ([] if scheme.ends else [chosen.end])
        yield Stretch(chosen, index.shape, [last for _, last in some], tableau, np.stack(times, axis=1))


def chunks(drive: Drive, scheme: Scheme, of: Iterable[Stretch]) -> Iterator[Chunk]:
    """The chunks with what drives them, which is computed for many at once."""
    import jax

    stages = len(scheme.offsets)
    for stretch in of:
        (groups, size), first = stretch.shape, 0
        driven = drive(stretch.times.ravel())
        driven = jax.tree.map(lambda leaf, to=(groups, size, -1): leaf.reshape(*to, *leaf.shape[1:]), driven)
        at_ends = None if scheme.ends else jax.tree.map(lambda leaf: leaf[:, :, stages], driven)
        inputs = jax.tree.map(lambda leaf: leaf[:, :, :stages], driven)
        for last in stretch.lasts:
            part = slice(first, first + len(last))
            pieces = jax.tree.map(lambda leaf, part=part: leaf[part], (stretch.tableau, inputs, at_ends))
            yield Chunk(stretch.steps[part.start * size : part.stop * size], last, *pieces)
            first = part.stop


def _groups(steps: Steps, size: int, *, restart: bool) -> Iterator[tuple[Any, Any]]:
    """Indices (groups, size) of the steps of each chunk, of one length a group, and the last real group's (groups,)."""
    ends = np.append(np.flatnonzero(steps.anew[:-1]), len(steps) - 1)
    starts = [np.arange(a, b + 1, size) for a, b in zip(np.append(0, ends[:-1] + 1), ends, strict=True)]
    spans = [np.stack([first, np.full(len(first), end)]) for first, end in zip(starts, ends, strict=True)]
    for run in spans if restart else [np.concatenate(spans, axis=1)]:
        for done in range(0, run.shape[1], CHUNK // size):
            first, end = run[:, done : done + CHUNK // size]
            # Groups beyond the last fill the chunk, so that one program serves every duration.
            fill = CHUNK // size - len(first)
            last = np.append(np.minimum(end - first, size - 1), np.full(fill, -1))
            first, end = (np.append(x, np.full(fill, end[-1])) for x in (first, end))
            yield np.minimum(first[:, None] + np.arange(size), end[:, None]), last
