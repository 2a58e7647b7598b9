"""Record of a flight: its columns, conditioned and judged, as a profile."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.constants import RecordQuantity, Vehicle
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.limits import BINARY_BYTES, LARGEST, SAMPLES, refuse_large_file, refuse_more
from gbeam.io.table import NO_COLUMN, Table, as_word
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.records.columns import (
    RATE,
    load_factors,
    mirrored,
    refuse_other_axes,
    refuse_other_kinds,
    upended,
)
from gbeam.motion.records.conditioning import FEWEST, LEAST_TURN, filtered, spikes, without_spikes
from gbeam.motion.records.instrument import Instrument, KnownLoads, LevelStretch, TurnOfBlock
from gbeam.motion.records.parameters import (
    Conditioning,
    From,
    LoadUnitOf,
    QuantityOf,
    Rates,
    RecordFile,
    SampleRate,
    SectionFlown,
    SectionsBy,
    TimeColumn,
    TimeUnitOf,
    To,
    VehicleOf,
    XColumn,
    YColumn,
    ZColumn,
)
from gbeam.motion.records.rest import Offsets, offsets_of
from gbeam.motion.records.sections import Sections
from gbeam.motion.records.soundness import Samples, curves, level, oddities, refuse_unlevel, refuse_unsound
from gbeam.motion.records.text import read_text
from gbeam.motion.records.times import Span, Timeline, Times, check_interval
from gbeam.motion.records.units import Unit, unit_of
from gbeam.numerics.samples import true_runs
from gbeam.results.description import Channels, RecordSummary


def read_table(path: str | os.PathLike[str], words: Iterable[str] = ()) -> Table:
    """Read the columns of a record, and the samples of those that are needed."""
    from gbeam.io.binary import is_binary, read_binary  # what only records need is imported for them

    try:
        refuse_large_file("record.file", path, BINARY_BYTES, "cut the record, or export it at a lower rate")
        return read_binary(path, words) if is_binary(path) else read_text(path)
    except OSError as error:
        problem = f"{path} cannot be read ({error.strerror})"
        raise InputError("record.file", problem, "give the path of a record") from None


def columns_of_text(path: str, column_limit: int) -> tuple[list[tuple[str, str]], list[float]]:
    """Return the names and units of the first `column_limit` columns of a record of text, and its sample rates, Hz."""
    table = read_text(path)
    return [(column.name, column.unit) for column in table.columns[:column_limit]], [
        stated.rate for stated in table.stated
    ]


@dataclass(frozen=True)
class FlightRecord:
    """A record ready to be flown."""

    acceleration: PiecewiseLinear  # m/s², base axes; its record says what it is
    rates: PiecewiseLinear | None = None  # angular velocity, rad/s, base axes

    @property
    def summary(self) -> RecordSummary:
        """The record in numbers: what is read and what is flown, what was done to it, and what looks odd."""
        assert self.acceleration.record is not None
        return self.acceleration.record


@typed
def read_record(
    path: RecordFile,
    time: TimeColumn,
    x: XColumn,
    y: YColumn,
    z: ZColumn,
    unit: LoadUnitOf,
    conditioning: Annotated[Conditioning, "what is done to the record: nothing if left out"] = Conditioning(),
    *,
    time_unit: TimeUnitOf = None,
    sample_rate: SampleRate = None,
    quantity: QuantityOf = "specific-force",
    vehicle: VehicleOf = "aircraft",
    turn: TurnOfBlock = (0.0, 0.0, 0.0),
    level: LevelStretch = None,
    rest: KnownLoads = (),
    span: Annotated[Span, "first and last time of the part that is flown, on the record's own clock"] = (None, None),
    sections: SectionsBy = None,
    section: SectionFlown = None,
) -> PiecewiseLinear:
    """Read an acceleration (or specific-force) record.

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
    >>> print(record.read.samples, f"{record.flown.largest[2] / 9.80665:.2f} g at {record.flown.time_of_peak} s")
    1600 8.06 g at 4.92 s
    """
    return read_flight(
        path, time, x, y, z, unit, conditioning=conditioning, time_unit=time_unit, sample_rate=sample_rate,
        quantity=quantity, vehicle=vehicle, instrument=Instrument(turn, level, rest=tuple(rest)), span=span,
        sections=sections, section=section,
    ).acceleration  # fmt: skip


def read_flight(
    path: str | os.PathLike[str],
    time: str | None,
    x: str,
    y: str,
    z: str,
    unit: str,
    *,
    span: Span = (None, None),
    section: str | None = None,
    **options: Any,
) -> FlightRecord:
    """Read a record with the body's rates, and say what was done to it; see :func:`read_record`, and
    :meth:`Recording.read` for the options.
    """
    recording = Recording.read(path, time, x, y, z, unit, **options)
    flight = recording.flight(*span, section)
    if flight.summary.is_part:
        recording.refuse_unlevel()
    return flight


@dataclass(frozen=True)
class Recording:
    """Columns of a record's file, read once, of which each flight is a part."""

    path: str
    table: Table
    times: Times
    stated: Mapping[str, float]  # sample rates that the file states, Hz
    names: dict[str, str]  # columns of x, y and z, with their signs
    turns: dict[str, str]  # columns of p, q and r, likewise; none without rates
    units: tuple[Unit, ...]  # of the loads, and of rates if there are any
    load: Floats  # (t, 3) m/s², axes of the columns; what is no number where no flight is
    rates: Floats  # (t, 3) rad/s, or (t, 0)
    sound: Flags  # (t,) samples that are numbers of a possible size
    channels: Channels  # as the file has them
    done: tuple[str, ...]  # in words
    sections: Sections | None
    conditioning: Conditioning
    quantity: RecordQuantity
    vehicle: Vehicle
    instrument: Instrument
    axes: Floats  # (3, 3) rotation from those of the columns to base axes
    mounted: tuple[str, ...]  # how these were found, in words
    levelled: tuple[float, float] | None  # first and last time of the level stretch, s
    offsets: Offsets

    @classmethod
    @np.errstate(all="ignore")  # numbers beyond a float's are refused by their row, without a warning before
    def read(
        cls,
        file: RecordFile,
        time: TimeColumn,
        x: XColumn,
        y: YColumn,
        z: ZColumn,
        unit: LoadUnitOf,
        *,
        rates: Rates | None = None,
        conditioning: Conditioning = Conditioning(),
        time_unit: TimeUnitOf = None,
        sample_rate: SampleRate = None,
        quantity: QuantityOf = "specific-force",
        vehicle: VehicleOf = "aircraft",
        instrument: Instrument = Instrument(),
        sections: SectionsBy = None,
    ) -> Recording:
        """Read the columns that are named; arguments as of :func:`read_record`."""
        skip, trust = conditioning.skipped, "unit" in conditioning.skipped
        names = {"x": x, "y": y, "z": z}
        turns = {} if rates is None else {"p": rates.p, "q": rates.q, "r": rates.r}
        if {*names.values()} == {NO_COLUMN}:
            raise InputError("record", 'takes nothing of the file: x, y and z are "0"', "name a column for one of them")
        if any(instrument.arm) and rates is None:
            fix = 'name the columns of the body\'s rates, p, q and r ("0" for none), and rate_unit'
            raise InputError("record.arm", "is given without the rates that the body turns at", fix)
        columns = [*names.values(), *turns.values()]
        table = read_table(file, [*columns, *(column for column in (time, sections) if column is not None)])
        if "columns" not in skip:
            refuse_other_kinds(table, names)
            if turns:
                refuse_other_kinds(table, turns, RATE)
                refuse_other_axes(table, names, turns)
        units = [_unit(table, "unit", "acceleration", unit, names, trust=trust)]
        if rates is not None:
            units.append(_unit(table, "rate_unit", "rate", rates.rate_unit, turns, trust=trust))
        stated = {} if "sampling" in skip else table.rates(columns)
        times = _times(table, time, time_unit, sample_rate, names, stated, trust=trust)
        count, fewer = len(times.values), "cut the record, or export it at a lower rate"
        refuse_more("record.file", "samples", count, SAMPLES, 200.0, fewer)
        if count < FEWEST:
            raise InputError("record.file", f"{file} has {table.counted(count)}", f"give {FEWEST} samples or more")
        nowhere = slice(0, 0)  # each flight refuses what is no number in its part
        read = [table.vector(named, count, nowhere) for named in (names, turns) if named]
        sound = np.logical_and.reduce([(np.abs(vectors) <= LARGEST).all(axis=1) for vectors in read])
        load = units[0].size * read[0]
        rate = units[1].size * read[1] if rates is not None else np.empty((count, 0))
        specific, columns_of = quantity == "specific-force", {**names, **turns}
        axes, mounted, levelled = instrument.axes(times, load, rate, table.counted, specific=specific)
        is_stated = time_unit is None and times.unit.size != 1
        return cls(
            path=os.fspath(file),
            table=table,
            times=times,
            stated=stated,
            names=names,
            turns=turns,
            units=tuple(units),
            load=load,
            rates=rate,
            sound=sound,
            channels=_as_read(table, times, (names, turns), units, read),
            done=(f"time in {times.unit.text}, as the file says",) if is_stated else (),
            sections=None if sections is None else Sections.read(table, sections, times.values),
            conditioning=conditioning,
            quantity=quantity,
            vehicle=vehicle,
            instrument=instrument,
            axes=axes,
            mounted=tuple(mounted),
            levelled=levelled,
            offsets=offsets_of(
                instrument.rest, times, load, rate, axes, columns_of, table.counted,
                specific=specific, trust="rest" in skip,
            ),
        )  # fmt: skip

    def part(self, span: Span, section: str | None) -> tuple[slice, tuple[float, float]]:
        """Return the samples within a span and a section, and the ends, s, of the section or else of the file.

        InputError if one of the samples is no number.
        """
        part, whole = self.times.part(span, self.table.counted), self.times.ends
        if section is not None:
            if self.sections is None:
                fix = 'name the column that numbers them, such as sections = "event"'
                raise InputError("record.section", f"is {section}, and the record has no sections", fix)
            part, run = self.sections.part(section, part, self.table.counted)
            whole = self.sections.ends(run)
        if not self.sound[part].all():
            for columns in (self.names, self.turns):
                self.table.vector(columns, len(self.sound), part)  # refuses the first cell that is no number
        return part, whole

    def _samples(self, time: Floats, load: Floats, rows: Indices) -> Samples:
        """Make samples as the checks of :mod:`.soundness` take them. `rows` are their rows in the file."""

        def place(i: int) -> str:
            return self.table.place(int(rows[i]))

        specific, upside = self.quantity == "specific-force", upended(self.table, self.names)
        return Samples(time, load, self.names, self.units[0], specific, self.vehicle, upside, place, self.axes)

    @np.errstate(all="ignore")
    def refuse_unlevel(self) -> None:
        """Raise InputError if the whole record, of which flights are parts, is level in another unit or upside down."""
        # Outside the flights there may be what is no number.
        finite_rows = np.flatnonzero(np.isfinite(self.load).all(axis=1))
        samples = self._samples(self.times.values[finite_rows], self.load[finite_rows], finite_rows)
        refuse_unlevel(samples, self.conditioning.skipped)

    @np.errstate(all="ignore")
    def flight(self, from_: From = None, to: To = None, section: SectionFlown = None) -> FlightRecord:
        """Return a part of the record, conditioned and judged, and say what was done to it."""
        conditioning, skip, evened = self.conditioning, self.conditioning.skipped, self.conditioning.evened
        table, times, clock, stated = self.table, self.times, self.times.values, self.stated
        names, turns, load, rates = self.names, self.turns, self.load, self.rates
        load_unit, vehicle, instrument = self.units[0], self.vehicle, self.instrument
        (part, whole), axes, offsets = self.part((from_, to), section), self.axes, self.offsets

        def judge(time: Floats) -> None:
            if "sampling" not in skip:
                check_interval(time, times, stated, brief=vehicle == "other")

        load_and_rates, bridge = np.concatenate([load, rates], axis=1), conditioning.bridge
        line = Timeline.from_times(times, part, load_and_rates, table.place, bridge=bridge, evened=evened, judge=judge)

        flown = self._samples(line.time, line.values[:, :3], line.rows)
        ignored = (*skip, "spikes") if conditioning.despike else skip
        refuse_unsound(flown, ignored, is_part=part != slice(0, len(clock)))
        notes = [*table.remarks]
        if "columns" not in skip:
            notes += [*mirrored(table, names), *load_factors(table, names, load_unit.text, specific=flown.specific)]
        notes += oddities(flown)
        notes += offsets.extrapolation_warnings(*line.time[[0, -1]])
        calm, spiked = _despiked(flown, turns, line.values[:, 3:], despike=conditioning.despike)
        offset = offsets.evaluate(line.time)
        calm = calm - offset
        turned = np.concatenate([calm[:, k : k + 3] @ axes.T for k in range(0, calm.shape[1], 3)], axis=1)
        resampled_time, load_and_rates = filtered(line.time, turned, conditioning.cutoff, conditioning.resample)
        done = [*self.done, *line.done]
        (done if conditioning.despike else notes).extend(spiked)
        if conditioning.cutoff is not None:
            done.append(f"low-pass at {conditioning.cutoff:g} Hz, zero phase")
        if conditioning.resample is not None:
            done.append(f"resampled at {conditioning.resample:g} Hz")
        at_root, carried = instrument.carried(resampled_time, load_and_rates[:, :3], load_and_rates[:, 3:])
        done += [*self.mounted, *carried]
        as_read = line.values[line.read]
        facts = RecordSummary(
            file=self.path,
            columns=(names["x"], names["y"], names["z"]),
            quantity=self.quantity,
            vehicle=vehicle,
            span=(float(line.time[0]), float(line.time[-1])),
            whole=whole,
            read=curves(line.time[line.read], as_read[:, :3], as_read[:, 3:]),
            flown=curves(resampled_time, at_root, load_and_rates[:, 3:]),
            level=level(replace(flown, load=flown.load - offset[:, :3])),
            rate_columns=(turns["p"], turns["q"], turns["r"]) if turns else None,
            gaps=line.gaps,
            offsets=offsets.of_stretches,
            levelled=self.levelled,
            sections_by="" if self.sections is None else self.sections.column,
            section="" if section is None else as_word(section),
            sections=() if self.sections is None else tuple(self.sections.listed()),
            clock="" if times.zero is None else times.zero.first,
            done=tuple(done),
            notes=tuple(notes),
            as_read=self.channels,
            as_flown=Channels(
                (*names, *turns),
                ("m/s^2",) * 3 + ("rad/s",) * len(turns),
                resampled_time,
                np.concatenate([at_root, load_and_rates[:, 3:]], axis=1),
            ),
        )
        flown_rates = PiecewiseLinear(resampled_time, load_and_rates[:, 3:]) if turns else None
        return FlightRecord(PiecewiseLinear(resampled_time, at_root, record=facts), flown_rates)


def _as_read(
    table: Table, times: Times, named: Sequence[dict[str, str]], units: Sequence[Unit], values: Sequence[Floats]
) -> Channels:
    """Channels of the columns that are read, under the file's names: the signs that components add are undone."""
    names, texts, channels = list[str](), list[str](), list[Floats]()
    vectors = [columns for columns in named if columns]
    for columns, unit, array in zip(vectors, units, values, strict=True):
        for name, component in zip(columns.values(), array.T, strict=True):
            sign, column = table.signed(name)
            if column is not None:
                names.append(column)
                texts.append(unit.text)
                channels.append(sign * component)
    return Channels(tuple(names), tuple(texts), times.values, np.stack(channels, axis=1))


def _unit(table: Table, key: str, kind: str, declared: str | None, columns: dict[str, str], *, trust: bool) -> Unit:
    """The unit that scenario and file agree on, s where neither says one."""
    return unit_of(key, kind, declared, table.stated_units(columns), trust=trust) or Unit("s", 1.0)


def _times(
    table: Table,
    name: str | None,
    unit: str | None,
    rate: float | None,
    columns: dict[str, str],
    stated: Mapping[str, float],
    *,
    trust: bool,
) -> Times:
    """Times of the samples, of the column `name`, or at a rate in place of it."""
    if name is None or rate is not None:
        if name is not None:
            raise InputError("record.sample_rate", "is given beside time", "give one of them")
        if rate is None:
            fix = 'give the column of times, or sample_rate = "100 Hz"'
            raise InputError("record", "has neither time nor sample_rate", fix)
        if unit is not None:
            raise InputError("record.time_unit", "is given without time", "leave it out")
        interval = 1 / positive("record.sample_rate", rate, "Hz")
        return Times(interval * np.arange(table.count(columns)), Unit("s", 1.0), key="sample_rate")
    try:
        numbers, clock, first = table.times(name)
    except InputError as error:
        usual = next(iter(stated.values()), 100.0)
        rate_note = f", the {next(iter(stated))} of the file" if stated else ""
        fix = f'{error.fix}; or write sample_rate = "{usual:g} Hz" in place of time{rate_note}'
        raise InputError(error.where, error.problem, fix) from None
    if clock is not None and unit not in (None, "s"):
        raise InputError("record.time_unit", f"is {unit}, and the times are times of day", "leave it out")
    if clock is not None:
        return Times(numbers, Unit("s", 1.0), clock)
    return Times.from_numbers(numbers, _unit(table, "time_unit", "time", unit, {"time": name}, trust=trust), first)


def _despiked(record: Samples, turns: Iterable[str], rates: Floats, *, despike: bool) -> tuple[Floats, list[str]]:
    """The load and rates (t, n), in which spikes are replaced if `despike`, and a note on the spikes, if any."""
    values = np.concatenate([record.load, rates], axis=1)
    spiked = np.concatenate([spikes(record.load), spikes(rates, LEAST_TURN)], axis=1)
    spiked_samples = np.asarray(spiked.any(axis=1))
    if not spiked_samples.any():
        return values, []
    calm, first = without_spikes(record.time, values, spiked), int(np.argmax(spiked_samples))
    outcome, was, change = (
        ("were replaced", "was", "is") if despike else ("are kept; despike = true replaces them", "is", "then")
    )
    formatters = [record.said] * len(record.names) + [lambda value: f"{np.degrees(value):.4g} deg/s"] * rates.shape[1]
    ranges = []
    for key, words, before, after in zip((*record.names, *turns), formatters, values.T, calm.T, strict=True):
        if (before != after).any():
            old_range = f"{words(before.min())} to {words(before.max())}"
            new_range = f"{words(after.min())} to {words(after.max())}"
            ranges.append(f"{key} {was} {old_range}, {change} {new_range}")
    note = (
        f"{spiked_samples.sum()} sample(s) that look like spikes, in {len(true_runs(spiked_samples))} run(s), "
        f"the first at {record.time[first]:g} s ({record.place(first)}), {outcome}: {'; '.join(ranges)}"
    )
    return calm if despike else values, [note]
