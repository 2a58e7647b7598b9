"""Stretches of a record in which the load is known, such as at rest: that they are steady, and what sensors are off."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter
from typing import Annotated

import numpy as np

from gbeam.arrays.types import Floats, Numbers
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import vector
from gbeam.guards.quantities import Quantity, Shape
from gbeam.io.table import NO_COLUMN
from gbeam.motion.records.times import Moment, Times
from gbeam.results.description import Offset

_SPREAD, _DRIFT = 0.05, 0.02  # g: of a steady load about its mean, and between the means of both halves
TURNING = math.radians(2)  # rad/s, of a gyro's offset at most, and of the spread of its readings
_OFF = 0.1  # g: an accelerometer's offset at most
STILL = "give first and last time of a stretch in which all stands still"
_TRUST = 'if sensors are that far off, add skip_checks = ["rest"]'
_UP = (0.0, 0.0, STANDARD_GRAVITY)


@typed
@dataclass(frozen=True)
class Rest:
    """Stretch of a record in which the vehicle rests, or its load is known.

    What the sensors read beside the known load is their offset.
    """

    from_: Annotated[
        Moment | None, "first time of the stretch, on the record's own clock; the record's first if left out"
    ] = None
    to: Annotated[Moment | None, "last time of the stretch; the record's last if left out"] = None
    load: Annotated[
        Annotated[Numbers, Quantity("acceleration"), Shape((3,))] | None,
        'the load there, base axes, such as ["0 g", "0 g", "1 g"], which specific force is at rest if left out; '
        "acceleration is none then",
    ] = None
    rates: Annotated[
        Annotated[Numbers, Quantity("angular rate"), Shape((3,))],
        "the body's rates there, about base axes, such as of a rate table",
    ] = (0.0, 0.0, 0.0)


def mean_of(key: str, load: Floats, rates: Floats, span: str, still: str) -> tuple[Floats, Floats]:
    """Return the means of a load (t, 3), m/s², and of rates (t, 3) or (t, 0), rad/s, over a stretch at rest.

    InputError, at a key of the record, unless all are numbers and steady. `span` says where, `still` is the fix.
    """
    if not (np.isfinite(load).all() and np.isfinite(rates).all()):
        raise InputError(f"record.{key}", f"has cells {span} that hold no number", still)
    in_g, half = load / STANDARD_GRAVITY, len(load) // 2
    spread = float(np.linalg.norm(in_g.std(axis=0)))
    drift = float(np.linalg.norm(in_g[:half].mean(axis=0) - in_g[half:].mean(axis=0)))
    if spread > _SPREAD or drift > _DRIFT:
        moves = f"spreads by {spread:.3g} g about its mean" if spread > _SPREAD else f"drifts by {drift:.3g} g"
        raise InputError(f"record.{key}", f"is no stretch at rest: the load {moves} {span}", still)
    mean_rates = rates.mean(axis=0)
    largest_rate = 0.0
    if rates.size:
        largest_rate = max(float(np.linalg.norm(mean_rates)), float(np.linalg.norm(rates.std(axis=0))))
    if largest_rate > TURNING:
        problem = f"is no stretch at rest: the body turns at {math.degrees(largest_rate):.3g} deg/s {span}"
        raise InputError(f"record.{key}", problem, still)
    return load.mean(axis=0), mean_rates


@dataclass(frozen=True)
class Offsets:
    """Offsets of a record's sensors over time: constant of one stretch, on straight lines through those of several."""

    of_stretches: tuple[Offset, ...]  # in the order of their times
    times: Floats  # (s,) s, of which each is the mean
    values: Floats  # (s, n) of the columns x, y, z and p, q, r, m/s² and rad/s

    def evaluate(self, time: Floats) -> Floats:
        """Return the offsets (t, n) at times (t,), s. Beyond the stretches the lines go on."""
        if len(self.times) < 2:  # of one stretch, or of none
            return np.broadcast_to(self.values.sum(axis=0), (len(time), self.values.shape[1]))
        k = np.clip(np.searchsorted(self.times, time) - 1, 0, len(self.times) - 2)
        share = (time - self.times[k]) / (self.times[k + 1] - self.times[k])
        return np.asarray(self.values[k] + share[:, None] * (self.values[k + 1] - self.values[k]))

    def extrapolation_warnings(self, first: float, last: float) -> list[str]:
        """Warn if the offsets' drift is extrapolated by more than the time within which it was observed."""
        if len(self.times) < 2:
            return []
        extrapolated = max(self.times[0] - first, last - self.times[-1])
        if extrapolated <= self.times[-1] - self.times[0]:
            return []
        return [
            f"the offsets' drift, found within {self.times[-1] - self.times[0]:.4g} s, is carried on for "
            f"{extrapolated:.4g} s: a stretch at rest at the other end of the record would hold it"
        ]


def offsets_of(
    rests: Sequence[Rest],
    times: Times,
    load: Floats,
    rates: Floats,
    axes: Floats,
    columns: Mapping[str, str],
    counted: Callable[[int], str],
    *,
    specific: bool,
    trust: bool,
) -> Offsets:
    """Return what the sensors of a record read in stretches besides what is known; `trust` judges none of it.

    Loads (t, 3), m/s², and rates (t, 3) or (t, 0), rad/s, are of the columns, which the rotation `axes` takes to base
    axes. What has no column has no offset.
    """
    sensed = np.array([column != NO_COLUMN for column in columns.values()])
    offsets: list[tuple[float, Offset, Floats]] = []
    for i, rest in enumerate(rests):
        key = f"rest[{i}]" if len(rests) > 1 else "rest"
        stretch = times.part((rest.from_, rest.to), counted, (f"rest[{i}].from", f"rest[{i}].to"))
        clock = times.values[stretch]
        start, end = float(clock.min()), float(clock.max())
        span = f"from {start:.6g} to {end:.6g} s"
        at_rest = _UP if specific else (0.0, 0.0, 0.0)
        rest_load = axes.T @ vector(f"record.{key}.load", at_rest if rest.load is None else rest.load)
        if np.any(rest.rates) and not rates.size:
            fix = "name the columns of the body's rates, p, q and r, and rate_unit, or leave it out"
            raise InputError(f"record.{key}.rates", "is given, and the record has no rates", fix)
        turn = axes.T @ vector(f"record.{key}.rates", rest.rates)
        unknown = load[stretch] - rest_load, rates[stretch] - (turn if rates.size else 0.0)
        if trust and all(np.isfinite(vectors).all() for vectors in unknown):
            means = [vectors.mean(axis=0) for vectors in unknown]
        else:
            means = [*mean_of(key, *unknown, span, STILL)]
        offset = sensed * np.concatenate(means)
        size = float(np.abs(offset[:3]).max()) / STANDARD_GRAVITY
        if size > _OFF and not trust:
            axis = "xyz"[int(np.abs(offset[:3]).argmax())]
            problem = f"is no stretch at rest: {axis} = {columns[axis]!r} is {size:.3g} g off what is known {span}"
            mean = np.round(axes @ load[stretch].mean(axis=0) / STANDARD_GRAVITY, 4) + 0.0  # no -0
            known_g = ", ".join(f'"{component:.4g} g"' for component in mean)
            if rest_load @ load[stretch].mean(axis=0) < 0:
                problem = f"is upside down: the load {span} points against what is known, {axis} = {columns[axis]!r}"
                fix = "change the signs of the columns: aircraft axes, z down, want y and z with a minus"
                raise InputError(f"record.{key}", problem, fix)
            fix = f"{STILL}; or say the load there, such as load = [{known_g}]; {_TRUST}"
            raise InputError(f"record.{key}", problem, fix)
        x, y, z, *rate_offsets = offset.tolist()
        facts = Offset(
            start, end, (x, y, z), (rate_offsets[0], rate_offsets[1], rate_offsets[2]) if rate_offsets else None
        )
        offsets.append((float(clock.mean()), facts, offset))
    offsets.sort(key=itemgetter(0))
    for (_, one, _), (_, other, _) in pairwise(offsets):
        if other.start <= one.end:
            problem = f"has stretches that overlap: {one.start:g} to {one.end:g} s, {other.start:g} to {other.end:g} s"
            raise InputError("record.rest", problem, "give stretches apart from one another, or one of them alone")
    times_of_stretches = np.array([time for time, _, _ in offsets])
    values = np.array([value for _, _, value in offsets]).reshape(-1, len(columns))
    return Offsets(tuple(facts for _, facts, _ in offsets), times_of_stretches, values)
