"""Record of a flight: its columns, conditioned and judged, as a profile."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.constants import Check, RecordQuantity
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import BINARY_BYTES, SAMPLES, refuse_large_file, refuse_more
from gbeam.io.binary import is_binary, read_binary
from gbeam.io.table import NO_COLUMN, Clock, Table
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.records.columns import RATE, load_factors, mirrored, refuse_other_axes, refuse_other_kinds
from gbeam.motion.records.conditioning import FEWEST, LEAST_TURN, filtered, spikes, without_spikes
from gbeam.motion.records.soundness import CHECKS, Samples, oddities, refuse_unsound, summary, summary_of_rates
from gbeam.motion.records.text import Span, check_interval, check_sampling, part_within, read_text
from gbeam.motion.records.units import Unit, unit_of
from gbeam.numerics.samples import true_runs
from gbeam.printable import advise


def read_table(path: str | os.PathLike[str], words: Iterable[str] = ()) -> Table:
    """Read the columns of a record, and the samples of those that are needed."""
    try:
        refuse_large_file("record.file", path, BINARY_BYTES, "cut the record, or export it at a lower rate")
        return read_binary(path, words) if is_binary(path) else read_text(path)
    except OSError as error:
        problem = f"{path} cannot be read ({error.strerror})"
        raise InputError("record.file", problem, "give the path of a record") from None


@dataclass(frozen=True)
class Rates:
    """Columns of a record that hold the body's rates about the base axes, with their signs, and their unit."""

    p: str
    q: str
    r: str
    unit: str  # rad/s, deg/s, rpm, or the size of a count


@dataclass(frozen=True)
class Conditioning:
    """Steps that are taken on a record.

    Parameters
    ----------
    cutoff : float or None
        Of a zero-phase low-pass (fourth-order Butterworth forwards and backwards, −6 dB), Hz.
    resample : float or None
        New sampling rate, Hz; times may then jitter.
    despike : bool
        Replace spikes, runs of up to five samples between two jumps far off what is around them, by straight lines.
    skip_checks : bool or tuple of str
        Checks to leave out, of ``sampling``, ``spikes``, ``unit``, ``sign``, ``dropouts`` and ``columns``; True leaves
        out all.
    """

    cutoff: float | None = None
    resample: float | None = None
    despike: bool = False
    skip_checks: bool | tuple[Check, ...] = False

    @property
    def skipped(self) -> tuple[Check, ...]:
        """Names of the checks that are left out."""
        if isinstance(self.skip_checks, bool):
            return CHECKS if self.skip_checks else ()
        for name in self.skip_checks:
            if name not in CHECKS:
                raise InputError(
                    "record.skip_checks", f"names no check {name!r}", advise(name, CHECKS, listed="choose of")
                )
        return self.skip_checks


@dataclass(frozen=True)
class FlightRecord:
    """A record ready to be flown."""

    acceleration: PiecewiseLinear  # m/s², base axes; its record says what it is
    rates: PiecewiseLinear | None = None  # angular velocity, rad/s, base axes

    @property
    def notes(self) -> tuple[str, ...]:
        """Steps taken, and oddities of the record."""
        return () if self.acceleration.record is None else self.acceleration.record.notes


@typed
def read_record(
    path: str | os.PathLike[str],
    time: str,
    x: str,
    y: str,
    z: str,
    unit: str,
    conditioning: Conditioning = Conditioning(),
    *,
    time_unit: str | None = None,
    quantity: RecordQuantity = "specific-force",
    span: Span = (None, None),
) -> PiecewiseLinear:
    """Read an acceleration (or specific-force) record.

    Parameters
    ----------
    path : path
        Of text (commas, semicolons, tabs or white space; decimal point or comma), or by its suffix a MAT file
        (``.mat``), HDF5 or netCDF (``.h5``, ``.hdf5``, ``.nc``) or a universal file (``.uff``, ``.unv``).
    time : str
        Name of the column of times: numbers, or times of day such as ``12:34:56.789`` and ``2024-05-03T12:34:56Z``,
        which count from the first.
    x, y, z : str
        Names of the columns that hold the components in base axes; a leading ``-`` changes the sign (aircraft
        records have z down), ``0`` stands for a component that is zero.
    unit : str
        ``g`` (9.80665 m/s²), ``mg``, ``m/s^2``, ``cm/s^2``, ``mm/s^2``, ``ft/s^2`` or ``in/s^2``, or the size of a
        count, such as ``1 g / 2048`` or ``1 g / 100 mV``.
    conditioning : Conditioning
        Of :class:`gbeam.motion.records.record.Conditioning`; by default nothing is done to the record.
    time_unit : str, optional
        ``s``, ``ms``, ``us``, ``ns``, ``min``, ``h`` or ``day``; what the file says if left out, or else s.
    quantity : str
        ``specific-force``, 1 g upwards in level flight, which is checked; or ``acceleration``.
    span : tuple
        First and last time of the part that is flown, s on the record's own clock, or a time of day where it has these;
        None is the record's end. What is outside is not checked, but for level flight.

    Returns
    -------
    PiecewiseLinear
        Vector profile, m/s², over the record's own times, s; `record` is a summary, with the whole of which it is a
        part and the notes on what looks odd.

    Raises
    ------
    InputError
        If the file, a column, a cell or the sampling is wrong, the file states other units, or the record looks
        unsound; rows are counted from 1, samples too.

    Examples
    --------
    >>> columns = {"time": "time_s", "x": "n_x_g", "y": "-n_y_g", "z": "-n_z_g"}
    >>> record = gb.read_record("examples/data/f16_8g_turn.csv", **columns, unit="g").record
    >>> print(record.samples, f"{record.largest[2] / 9.80665:.2f} g at {record.time_of_peak} s")
    1600 8.06 g at 4.92 s
    """
    return read_flight(
        path, time, x, y, z, unit, conditioning=conditioning, time_unit=time_unit, quantity=quantity, span=span
    ).acceleration


@np.errstate(all="ignore")  # numbers beyond a float's are refused by their row, without a warning before
def read_flight(
    path: str | os.PathLike[str],
    time: str,
    x: str,
    y: str,
    z: str,
    unit: str,
    *,
    rates: Rates | None = None,
    conditioning: Conditioning = Conditioning(),
    time_unit: str | None = None,
    quantity: RecordQuantity = "specific-force",
    span: Span = (None, None),
) -> FlightRecord:
    """Read a record with the body's rates, and say what was done to it; see :func:`read_record`."""
    skip = conditioning.skipped
    trust = "unit" in skip
    names = {"x": x, "y": y, "z": z}
    turns = {} if rates is None else {"p": rates.p, "q": rates.q, "r": rates.r}
    if {*names.values()} == {NO_COLUMN}:
        raise InputError("record", 'takes nothing of the file: x, y and z are "0"', "name a column for one of them")
    table = read_table(path, [time, *names.values(), *turns.values()])
    if "columns" not in skip:
        refuse_other_kinds(table, names)
        if turns:
            refuse_other_kinds(table, turns, RATE)
            refuse_other_axes(table, names, turns)
    load_unit = _unit(table, "unit", "acceleration", unit, names, trust=trust)
    rate_unit = load_unit if rates is None else _unit(table, "rate_unit", "rate", rates.unit, turns, trust=trust)
    clock, seconds, of_day = _times(table, time, time_unit, trust=trust)
    refuse_more("record.file", "samples", len(clock), SAMPLES, 200.0, "cut the record, or export it at a lower rate")
    if len(clock) < FEWEST:
        raise InputError("record.file", f"{path} has {table.counted(len(clock))}", f"give {FEWEST} samples or more")
    part = part_within(clock, of_day, span, table.counted)
    when = clock[part]
    jitter = check_sampling(when, lambda i: table.place(part.start + i), jitter=conditioning.resample is not None)
    if "sampling" not in skip:
        check_interval(when, seconds)
    load = load_unit.size * table.vector(names, len(clock), part)

    def samples(index: Indices) -> Samples:
        specific = quantity == "specific-force"
        return Samples(clock[index], load[index], names, load_unit, specific, lambda i: table.place(int(index[i])))

    flown = samples(np.arange(part.start, part.stop))
    known = np.flatnonzero(np.isfinite(load).all(axis=1))  # outside the part there may be what is no number
    refuse_unsound(
        flown, flown if len(when) == len(clock) else samples(known), (*skip, "spikes") if conditioning.despike else skip
    )
    notes = [f"time in {seconds.text}, as the file says"] if time_unit is None and seconds.size != 1 else []
    if "columns" not in skip:
        notes += [*mirrored(table, names), *load_factors(table, names, load_unit.text, specific=flown.specific)]
    notes += oddities(flown)
    body_rates = rate_unit.size * table.vector(turns, len(clock), part)[part] if turns else np.empty((len(when), 0))
    calm, spike_notes = _despiked(flown, turns, body_rates, despike=conditioning.despike)
    notes += spike_notes
    new, both = filtered(when, calm, conditioning.cutoff, conditioning.resample)
    if jitter:
        notes.append(f"times up to {1e3 * jitter:.3g} ms off even ones: a spline through the samples is flown")
    if conditioning.cutoff is not None:
        notes.append(f"low-pass at {conditioning.cutoff:g} Hz, zero phase")
    if conditioning.resample is not None:
        notes.append(f"resampled at {conditioning.resample:g} Hz")
    zero = "" if of_day is None else of_day.first
    turning = summary_of_rates(turns, body_rates)
    facts = summary(flown, os.fspath(path), (float(clock[0]), float(clock[-1])), turning, zero, tuple(notes))
    flown_rates = None if rates is None else PiecewiseLinear(new, both[:, 3:])
    return FlightRecord(PiecewiseLinear(new, both[:, :3], record=facts), flown_rates)


def _unit(table: Table, key: str, kind: str, declared: str | None, columns: dict[str, str], *, trust: bool) -> Unit:
    """The unit that scenario and file agree on, s where neither says one."""
    return unit_of(key, kind, declared, table.stated_units(columns), trust=trust) or Unit("s", 1.0)


def _times(table: Table, name: str, unit: str | None, *, trust: bool) -> tuple[Floats, Unit, Clock | None]:
    """Times in s, the unit that they were in, and the clock where they are times of day."""
    times, of_day = table.times(name)
    if of_day is not None and unit not in (None, "s"):
        raise InputError("record.time_unit", f"is {unit}, and the times are times of day", "leave it out")
    if of_day is not None:
        return times, Unit("s", 1.0), of_day
    seconds = _unit(table, "time_unit", "time", unit, {"time": name}, trust=trust)
    return seconds.size * times, seconds, None


def _despiked(record: Samples, turns: Iterable[str], rates: Floats, *, despike: bool) -> tuple[Floats, list[str]]:
    """The load and the rates (t, n) of the body, without their spikes if `despike`, and a note on these."""
    values = np.concatenate([record.load, rates], axis=1)
    odd = np.concatenate([spikes(record.load), spikes(rates, LEAST_TURN)], axis=1)
    off = np.asarray(odd.any(axis=1))
    if not off.any():
        return values, []
    calm, first = without_spikes(record.time, values, odd), int(np.argmax(off))
    done, was, now = (
        ("were replaced", "was", "is") if despike else ("are kept; despike = true replaces them", "is", "then")
    )
    said = [record.said] * len(record.names) + [lambda value: f"{np.degrees(value):.4g} deg/s"] * rates.shape[1]
    ranges = [
        f"{key} {was} {say(before.min())} to {say(before.max())}, {now} {say(after.min())} to {say(after.max())}"
        for key, say, before, after in zip((*record.names, *turns), said, values.T, calm.T, strict=True)
        if (before != after).any()
    ]
    note = (
        f"{off.sum()} sample(s) that look like spikes, in {len(true_runs(off))} run(s), the first at "
        f"{record.time[first]:g} s ({record.place(first)}), {done}: {'; '.join(ranges)}"
    )
    return calm if despike else values, [note]
