"""Times of a record: its clock, the part that is flown, their order, gaps and intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.guards.quantities import Quantity
from gbeam.io.table import Clock, is_clock
from gbeam.motion.records.conditioning import FEWEST, UNEVEN
from gbeam.motion.records.units import UNITS, Unit
from gbeam.results.description import Gap


@dataclass(frozen=True)
class ClockTime(Quantity):
    """Annotation of a time on a record's own clock, which may be a time of day."""

    def accepts(self, text: str) -> bool:
        return is_clock(text)

    @property
    def accepted(self) -> list[dict[str, Any]]:
        return [{"type": "string", "description": "a time of day", "examples": ["12:34:56.7"]}]


Moment = Annotated[float | str, ClockTime("time")]
Span = tuple[float | str | None, float | str | None]  # moments, of which each may be left out
Place = Callable[[int], str]

SLOWEST = 5.0  # Hz
_FASTEST, _BRIEF = 1000.0, 10.0  # Hz, s: flight loads need no such rate, and last longer
_USUAL = (1e-3, 0.2)  # s: intervals of flight records
_ROUND = 1 + 1e-9
_GAP = 1.9  # of the usual interval: a sample is missing, and no clock that jitters is as late
_LATE = 5.0  # intervals that a sample may come late: by more the clock was set, or another record begins
_BRIDGED = 0.25  # s: what is lost for longer is no detail
_RESOLVED = 1e-6  # of an interval: what a clock's numbers must tell apart
_LISTED = 20  # in a message
TRUST = 'if the file is wrong, add skip_checks = ["sampling"]'


@dataclass(frozen=True)
class Times:
    """Times of a record's samples."""

    values: Floats  # (t,) s
    unit: Unit  # that they were in
    zero: Clock | None = None  # of which the first is zero seconds; None where the numbers themselves are flown
    key: str = "time"  # of the record, which says them; or sample_rate

    @classmethod
    def from_numbers(cls, numbers: Floats, unit: Unit, first: str) -> Times:
        """Read times from numbers in a unit; from `first` on, where floats are too coarse for them (1970 in ns)."""
        interval = float(np.median(np.abs(np.diff(numbers)))) if len(numbers) > 1 else math.inf
        if np.spacing(np.abs(numbers).max(initial=0)) > _RESOLVED * interval > 0:
            return cls((numbers - numbers[0]) * unit.size, unit, Clock(f"{first} {unit.text}"))
        return cls(numbers * unit.size, unit)

    @property
    def ends(self) -> tuple[float, float]:
        """First and last time, s."""
        return float(self.values.min()), float(self.values.max())

    def part(self, span: Span, counted: Callable[[int], str], keys: tuple[str, str] = ("from", "to")) -> slice:
        """Return the samples within a span of the record's own clock. `keys` are those at which the scenario gives it.

        InputError if an end lies outside the record, or if too few samples are left.
        """
        if span == (None, None):
            return slice(0, len(self.values))
        first, last = self.ends
        interval = float(np.median(np.abs(np.diff(self.values))))
        extent = f"{first:g} to {last:g} s" + ("" if self.zero is None else f", 0 s being {self.zero.first}")

        def read(key: str, value: float | str | None, otherwise: float) -> float:
            """Time, s, of an end of the span; `otherwise` where it is None."""
            if value is None:
                return otherwise
            number = self.zero.seconds(value) if isinstance(value, str) and self.zero is not None else value
            if number is None or isinstance(number, str):
                raise InputError(f"record.{key}", f"is {value!r}", f"give a time of the record's own clock, {extent}")
            if not first - interval <= number <= last + interval:
                text = value if isinstance(value, str) else f"{value:g} s"
                raise InputError(f"record.{key}", f"is {text}, and the record lasts {extent}", "give a time of it")
            return float(number)

        begin, end = read(keys[0], span[0], first), read(keys[1], span[1], last)
        slack = 1e-6 * interval
        inside = np.flatnonzero((self.values >= begin - slack) & (self.values <= end + slack))
        if inside.size < FEWEST:
            problem = f"leaves {counted(inside.size)} from {begin:g} to {end:g} s"
            fix = f"give more of {extent}: {FEWEST} samples at least"
            raise InputError(f"record.{keys[span[1] is not None]}", problem, fix)
        return slice(int(inside[0]), int(inside[-1]) + 1)


@dataclass(frozen=True)
class Timeline:
    """Samples of the part of a record that is flown, in the order of their times and without gaps."""

    time: Floats  # (n,) s
    values: Floats  # (n, k)
    rows: Indices  # (n,) sample of the file that each is, or is behind
    gaps: tuple[Gap, ...]  # that were bridged
    done: tuple[str, ...]  # in words

    @classmethod
    def from_times(
        cls,
        times: Times,
        part: slice,
        values: Floats,
        place: Place,
        *,
        bridge: float | None,
        evened: bool,
        judge: Callable[[Floats], None],
    ) -> Timeline:
        """Make the timeline of the `part` of a record with values (t, k).

        If samples are `evened` out later, times may jitter, repeat and come late, and lost samples of gaps up to
        `bridge`, s, are put on straight lines; InputError otherwise. `judge` refuses ordered times of a wrong unit.
        """
        clock = times.values[part]
        order, starts = _in_order(clock, values[part], lambda i: place(part.start + i), judge, evened=evened)
        rows, time = part.start + order[starts], clock[order[starts]]
        gaps = _gaps(time, lambda i: place(int(rows[i])), bridge, evened=evened)
        bridged_time, bridged = _bridged(time, _averaged(values[part], order, starts), gaps)
        rows = rows[np.searchsorted(time, bridged_time, side="right") - 1]
        jitter = _unevenness(bridged_time, lambda i: place(int(rows[i])), evened=evened)
        late = int(np.sum(np.diff(clock) < 0))
        repeated = len(order) - len(starts)
        notes = []
        if late:
            notes.append(f"times go back {late} times: the samples are put in order")
        if repeated:
            notes.append(f"{repeated} samples repeat a time: the mean of its samples is flown")
        if jitter:
            notes.append(f"times up to {1e3 * jitter:.3g} ms off even ones: a spline through the samples is flown")
        return cls(bridged_time, bridged, rows, gaps, tuple(notes))

    @property
    def read(self) -> Indices:
        """Samples that the file has, of all."""
        in_gap = [(self.time > gap.start) & (self.time < gap.end) for gap in self.gaps]
        return np.flatnonzero(~np.logical_or.reduce(in_gap)) if in_gap else np.arange(len(self.time))


def _in_order(
    time: Floats, values: Floats, place: Place, judge: Callable[[Floats], None], *, evened: bool
) -> tuple[Indices, Indices]:
    """Samples (t,) of times (t,), s, and values (t, n), in the order of their times, and the first (m,) of each time.

    InputError, unless samples are `evened`, if times repeat or a few come late; always for a clock that is too coarse,
    or goes back by more.
    """
    order, steps = np.argsort(time, kind="stable"), np.diff(time)
    starts = np.flatnonzero(np.diff(time[order], prepend=-math.inf) > 0)
    back = np.flatnonzero(steps <= 0)
    if not back.size:
        judge(time)
        return order, starts
    forward = steps[steps > 0]
    usual = float(np.median(forward)) if forward.size else math.inf
    changes = np.flatnonzero(steps > 0) + 1  # samples at which the clock has just ticked
    fresh = (np.diff(values, axis=0) != 0).any(axis=1)  # no sample that was written again
    if np.mean(steps == 0) > 0.5 and np.mean(fresh[steps == 0]) > 0.5:
        rate = _round_rate((changes[-1] - changes[0]) / np.ptp(time[changes])) if changes.size > 1 else 100.0
        ticks = f"ticks every {usual:g} s" if forward.size else "stands still"
        problem = (
            f"repeats {time[back[0]]:g} s at {place(int(back[0]) + 1)}: the clock {ticks}, and samples lie between"
        )
        raise InputError("record.time", problem, f'write sample_rate = "{rate:g} Hz" in place of time')
    late = np.maximum.accumulate(time) - time
    farthest = int(late.argmax())
    if late[farthest] > _LATE * usual:
        raise InputError("record.time", *_set_back(time, farthest, float(late[farthest]), place))
    judge(time[order[starts]])
    if not evened:
        told = [
            f"{'repeats' if steps[i] == 0 else 'goes back to'} {time[i + 1]:g} s at {place(int(i) + 1)}"
            for i in back[:_LISTED]
        ]
        done = "late samples are put in order, and those of one time become their mean"
        fix = f'add resample = "{_round_rate(1 / usual):g} Hz": {done}'
        raise InputError("record.time", ", ".join(told) + _further_words(len(back)), fix)
    return order, starts


def _set_back(time: Floats, i: int, jump: float, place: Place) -> tuple[str, str]:
    """Problem and fix of a clock that goes back at sample `i` by more than a late sample does.

    The fix is the longest part between two such steps if no other samples have its times; else the file is to be split.
    """
    problem = f"goes back by {jump:g} s at {place(i)}: the clock was set, or another record begins"
    edges = [0, *(np.flatnonzero(np.diff(time) < 0) + 1).tolist(), len(time)]
    first, last = max(pairwise(edges), key=lambda ends: ends[1] - ends[0])
    begin, end = float(time[first]), float(time[last - 1])
    samples_there = np.count_nonzero((time >= begin) & (time <= end))
    if samples_there == last - first >= FEWEST:
        return problem, f'write from = "{begin:.12g} s", to = "{end:.12g} s", of {place(first)} to {place(last - 1)}'
    return problem, f"split the file at {place(i)}, and fly one of its parts"


def _averaged(values: Floats, order: Indices, starts: Indices) -> Floats:
    """Values (t, …) in an order, the mean of those from each start to the next, (n, …)."""
    if len(starts) == len(order):
        return values[order]
    counts = np.diff(starts, append=len(order)).reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(np.add.reduceat(values[order], starts, axis=0) / counts)


def _gaps(time: Floats, place: Place, bridge: float | None, *, evened: bool) -> tuple[Gap, ...]:
    """Gaps in the times (t,), s, which are to be bridged. InputError, which lists them, if they may not be."""
    steps = np.diff(time)
    usual = float(np.median(steps))
    gap_starts = np.flatnonzero(steps > _GAP * usual)
    gaps = tuple(
        Gap(float(time[i]), float(time[i + 1]), round(float(steps[i]) / usual) - 1, place(int(i))) for i in gap_starts
    )
    longest = float(steps[gap_starts].max(initial=0))
    if not gap_starts.size or (evened and bridge is not None and longest <= bridge * _ROUND):
        return gaps
    listed = [f"{gap.end - gap.start:g} s from {gap.start:g} s to {gap.end:g} s (after {gap.after})" for gap in gaps]
    problem = (
        f"has {len(gaps)} gap{'s' if len(gaps) > 1 else ''}, where the interval is {usual:g} s: "
        + ", ".join(listed[:_LISTED])
        + _further_words(len(gaps))
    )
    resampling = "" if evened else f' and resample = "{_round_rate(1 / usual):g} Hz"'
    verb = "add" if bridge is None else "write"
    bridge_fix = (
        f'{verb} bridge = "{_round_up(1e3 * longest):g} ms"{resampling}: lost samples are put on straight lines'
    )
    stretches = np.split(np.arange(len(time)), np.flatnonzero(steps > max(_BRIDGED, _GAP * usual)) + 1)
    stretch = max(stretches, key=len)
    cut_fix = f'write from = "{time[stretch[0]]:.12g} s", to = "{time[stretch[-1]]:.12g} s", between the long ones'
    fixes = [cut_fix, bridge_fix] if longest > _BRIDGED and len(stretch) >= FEWEST else [bridge_fix]
    raise InputError("record.time", problem, "; ".join(fixes))


def _bridged(time: Floats, values: Floats, gaps: Sequence[Gap]) -> tuple[Floats, Floats]:
    """Fill gaps in the times (t,), s, and values (t, n): lost samples come at equal intervals, on straight lines."""
    if not gaps:
        return time, values
    lost_count = sum(gap.lost for gap in gaps)
    refuse_more("record.bridge", "samples", len(time) + lost_count, SAMPLES, 24.0, "bridge shorter gaps")
    parts = [np.linspace(gap.start, gap.end, gap.lost + 2)[1:-1] for gap in gaps]
    filled = np.sort(np.concatenate([time, *parts]))
    return filled, np.stack([np.interp(filled, time, channel) for channel in values.T], axis=1)


def _unevenness(time: Floats, place: Place, *, evened: bool) -> float:
    """Largest distance of the times (t,), s, from even ones, zero if slight. InputError unless they are `evened`."""
    steps = np.diff(time)
    median = float(np.median(steps))
    uneven = np.flatnonzero(np.abs(steps - median) > UNEVEN * median)
    if not uneven.size:
        return 0.0
    if not evened:
        i, rate = int(uneven[0]), _round_rate((len(time) - 1) / np.ptp(time))
        late = f"{time[i + 1]:g} s at {place(i + 1)}, after {time[i]:g} s, is {steps[i]:g} s"
        problem = f"is sampled unevenly: {late} where the interval is {median:g} s"
        fix = f'add resample = "{rate:g} Hz": at equal intervals, by a spline through the samples'
        raise InputError("record.time", problem, fix)
    samples = np.arange(len(time))
    return float(np.abs(time - np.polynomial.Polynomial.fit(samples, time, 1)(samples)).max())


def check_interval(time: Floats, times: Times, stated: Mapping[str, float], *, brief: bool) -> None:
    """Refuse an interval of the times (t,), s, that no record of a flight has, and say which unit would make it one.

    `stated` are the sample rates, Hz, by name, that the file states. Another one is refused, too. A `brief` record may
    be short and densely sampled.
    """
    where, step, length = f"record.{times.key}", float(np.median(np.diff(time))), float(time[-1] - time[0])
    for name, rate in stated.items():
        if abs(rate * step - 1) > UNEVEN:
            by_rate = times.key == "sample_rate"
            verb = "is" if by_rate else "has"
            problem = f"{verb} {_round_rate(1 / step):g} Hz, and the file states {name}, {rate:g} Hz"
            instead = f'write sample_rate = "{rate:g} Hz"; ' if by_rate else ""
            raise InputError(where, problem, f"{instead}{TRUST}")
    trust = 'if it is right as it is, add skip_checks = ["sampling"]'
    unit_sizes, step_in_unit = UNITS["time"], step / times.unit.size
    likely = [
        unit
        for unit, size in unit_sizes.items()
        if size != times.unit.size and _USUAL[0] <= step_in_unit * size * _ROUND <= _USUAL[1]
    ]
    hint = ""
    if likely and times.key == "time":
        hint = f"is the time in {likely[0]}? then {times.unit.instead('time_unit', likely[0])}; "
    if step > _ROUND / SLOWEST:
        problem = f"has a sample every {step:g} s ({1 / step:g} Hz), too coarse for the corners of a manoeuvre"
        raise InputError(where, problem, f"{hint}export the record at 20 Hz or more; {trust}")
    if step < 1 / _FASTEST and length < _BRIEF and not brief:
        problem = (
            f"lasts {length:.3g} s with a sample every {step:.3g} s ({1 / step:.4g} Hz), which no flight load needs"
        )
        fix = f"{hint}if it is no aircraft's or rocket's, add vehicle = \"other\"; {trust}"
        raise InputError(where, problem, fix)


def _round_rate(number: float) -> float:
    """Round a number to three digits."""
    return float(f"{number:.3g}")


def _round_up(number: float) -> float:
    """Round a number up to three digits."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 2)
    return float(f"{math.ceil(number / unit / _ROUND) * unit:.3g}")


def _further_words(count: int) -> str:
    return f" and {count - _LISTED} more" if count > _LISTED else ""
