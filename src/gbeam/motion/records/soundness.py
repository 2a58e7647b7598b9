"""Soundness of a record: what its samples show, refused or flown all the same, and its summary in numbers."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.constants import STANDARD_GRAVITY, Check, Vehicle
from gbeam.errors import InputError
from gbeam.motion.records.conditioning import dropout, flat_tops, spikes, without_spikes
from gbeam.motion.records.units import UNITS, Unit
from gbeam.numerics.samples import true_runs
from gbeam.results.description import BodyRates, Curves, Level, Vector

CHECKS = get_args(Check)
_SIZES = UNITS["acceleration"]
LARGEST = 50.0  # g
_FRAGMENT = 2.0  # s
_BEGINS = 3.0  # g: above that, no flight begins
_BOOST = 3.0  # g: beyond that, along an axis, a vehicle is pushed and does not turn over
_OUTSTANDING = 1.5  # a spike that much above the rest would be the record's peak
_LASTS = 1.0  # s: for less, what passes 1 g is no level flight
LEVEL = (0.75, 1.35)  # g: level flight, thrust included
_BEGINS_LEVEL = (0.7, 1.6)  # g
_SOME, _HARDLY = 0.05, 0.02  # of the record
_TURNED = 0.7  # of the load: within 45° of upwards or downwards
_NEVER = 0.7  # g: what stays below does not fly level anywhere
_PILOTED = 12.0  # g: no aircraft, and few rockets
_ACCELERATION = 'if it is acceleration without gravity, add quantity = "acceleration"'
_ROCKET = 'if it is a rocket\'s, add vehicle = "rocket"'
_OTHER = 'if it is of no aircraft or rocket, add vehicle = "other"'


@dataclass(frozen=True)
class Samples:
    """Subject of the checks."""

    time: Floats  # (t,) s
    load: Floats  # (t, 3) m/s², axes of the columns
    names: dict[str, str]  # columns of x, y and z, with their signs
    unit: Unit  # that the load was read in
    specific: bool  # whether it is specific force, 1 g upwards in level flight
    vehicle: Vehicle
    upended: dict[str, str]  # columns by axis that turn z over
    place: Callable[[int], str]  # where a sample is in its file, in words
    axes: Floats  # (3, 3) rotation from those of the columns to base axes

    def said(self, value: float) -> str:
        """A load, m/s², in the record's unit; in g where that is a count."""
        unit = self.unit.text if self.unit.text in _SIZES else "g"
        return f"{value / _SIZES[unit]:.4g} {unit}"


def refuse_unsound(record: Samples, skip: Collection[str], *, is_part: bool) -> None:
    """Raise InputError if a record, or a part of one, does not look like a flight's. Spikes are judged first.

    A part need not hold level flight: only its size and dropouts are judged.
    """
    spiked, load, size = _calmed(record)
    if "spikes" not in skip and _lasts(record):
        _check_spikes(record, spiked, size)
    if "unit" not in skip:
        _check_size(record, size)
    if not is_part:
        _refuse_unlevel(record, load, size, skip)
    if "dropouts" not in skip:
        _check_dropouts(record)


def refuse_unlevel(whole: Samples, skip: Collection[str]) -> None:
    """Raise InputError if the whole of a record, of which parts are flown, is level in another unit or upside down."""
    if _flies(whole) and not {"unit", "sign"} <= set(skip):
        _, calm, size = _calmed(whole)
        _refuse_unlevel(whole, calm, size, skip)


def _refuse_unlevel(record: Samples, load: Floats, size: Floats, skip: Collection[str]) -> None:
    """Judge level flight by the load (t, 3) without spikes, of `size` (t,); a fragment below 2 s need hold none."""
    if not _flies(record):
        return
    if "unit" not in skip:
        _check_level(record, size)
    if "sign" not in skip and record.vehicle == "aircraft":
        _check_sign(record, load @ record.axes[2], size)


def _lasts(record: Samples) -> bool:
    return float(record.time[-1] - record.time[0]) >= _FRAGMENT


def _flies(record: Samples) -> bool:
    """True if a record holds specific force, of an aircraft or a rocket, for so long that 1 g is somewhere."""
    return _lasts(record) and record.specific and record.vehicle != "other"


def _calmed(record: Samples) -> tuple[Flags, Floats, Floats]:
    """Spikes of a record, its load without them, and the size of that."""
    odd = spikes(record.load)
    calm = without_spikes(record.time, record.load, odd)
    return odd, calm, np.linalg.norm(calm, axis=1)


def _trust(check: str, otherwise: str = "if the record is right as it is") -> str:
    return f'{otherwise}, add skip_checks = ["{check}"]'


def _check_spikes(record: Samples, spiked: Flags, size: Floats) -> None:
    """Refuse a spike that would be the record's peak: where `spiked` (t, 3). `size` (t,) is without spikes."""
    raw_size = np.linalg.norm(record.load, axis=1)
    i = int(np.argmax(np.where(spiked.any(axis=1), raw_size, 0)))
    calm_size, largest = size.max(), LARGEST * STANDARD_GRAVITY
    if not spiked[i].any() or not (raw_size[i] > _OUTSTANDING * calm_size or raw_size[i] > largest >= calm_size):
        return
    axis = int(np.argmax(np.where(spiked[i], np.abs(record.load[i]), 0)))
    name = record.names["xyz"[axis]].lstrip("-")
    raise InputError(
        f"record.{'xyz'[axis]}",
        f"column {name!r} has {spiked.any(axis=1).sum()} sample(s) that look like spikes: the load is "
        f"{record.said(raw_size[i])} at {record.time[i]:g} s ({record.place(i)}), {record.said(size[i])} beside it",
        f"add despike = true, which replaces them; {_trust('spikes')}",
    )


def _check_size(record: Samples, size: Floats) -> None:
    """Refuse a load that nothing withstands, in the declared unit."""
    i = int(size.argmax())
    if size[i] > LARGEST * STANDARD_GRAVITY:
        raise InputError(
            "record.unit",
            f"is {record.unit.text}, which makes {size[i] / STANDARD_GRAVITY:.3g} g of {record.place(i)}, "
            f"at {record.time[i]:g} s",
            "; ".join([*_other_units(record, size), _trust("unit")]),
        )


def _check_level(record: Samples, size: Floats) -> None:
    """Refuse a load that would be level flight in another unit, and is none in the declared one."""
    if not _is_flight(record, size, record.unit.size):
        peak = float(size.max())
        raise InputError(
            "record.unit",
            f"is {record.unit.text}, and the record begins at {record.said(np.median(size[_beginning(record)]))} and "
            f"reaches {record.said(peak)}, {peak / STANDARD_GRAVITY:.3g} g: level flight is 1 g, which is 9.81 m/s^2",
            "; ".join([*_other_units(record, size), _ACCELERATION, *_vehicles(record, size), _trust("unit")]),
        )


def _vehicles(record: Samples, size: Floats) -> list[str]:
    """Advice to say another vehicle, of which less is asked: a rocket if the load may be one's."""
    rocket = record.vehicle == "aircraft" and _is_flight(replace(record, vehicle="rocket"), size, record.unit.size)
    return [_ROCKET, _OTHER] if rocket else [_OTHER]


def _other_units(record: Samples, size: Floats) -> list[str]:
    """Advice to write another unit, likeliest first.

    Likely units make a flight of the record; among these, those in which it begins level are preferred.
    """
    judged = _flies(record)
    fitting = []
    for unit, unit_size in _SIZES.items():
        in_g = size * unit_size / record.unit.size / STANDARD_GRAVITY
        sound = _is_flight(record, size, unit_size) if judged else unit_size < record.unit.size
        if unit_size != record.unit.size and in_g.max() <= LARGEST and sound:
            fitting.append((_begins_level(record, in_g), _share(in_g, LEVEL), unit))
    begins_level = [candidate for candidate in fitting if candidate[0]]
    likely = sorted(begins_level or fitting, reverse=True)
    return [f"if it is in {unit}, {record.unit.instead('unit', unit)}" for *_, unit in likely]


def _is_flight(record: Samples, size: Floats, unit: float) -> bool:
    """Tell if a load of the size (t,) may be a flight's in a unit of `unit` m/s².

    A listed unit is doubted where the record is level in another listed one. The size of a count only the user knows.
    """
    in_g = size * unit / record.unit.size / STANDARD_GRAVITY
    peak, begins = float(in_g.max()), float(np.median(in_g[_beginning(record)]))
    other_units = [other for other in _SIZES.values() if unit in _SIZES.values() and not 0.5 < other / unit < 2]
    loads_in_others = [in_g * other / unit for other in other_units]
    level_in_others = [load for load in loads_in_others if _share(load, LEVEL) > _SOME]
    if record.vehicle == "rocket":
        begins_high = begins > _BEGINS_LEVEL[1]
        return peak >= _NEVER and not (begins_high and any(_begins_level(record, load) for load in level_in_others))
    if unit == STANDARD_GRAVITY:
        # Level at 9.8 and nowhere at 1; a rocket that passes 9.8 g has been at less.
        return begins <= _BEGINS and not (level_in_others and _share(in_g, LEVEL) < _HARDLY and peak > _PILOTED)
    # A flight that is level at 0.1 g either pulls more than 1 g to stay in the air, or is in g.
    return peak >= _NEVER and not any(peak < LEVEL[1] or _begins_level(record, load) for load in level_in_others)


def _beginning(record: Samples) -> slice:
    return slice(max(int(1 / np.median(np.diff(record.time))), 4))


def _begins_level(record: Samples, in_g: Floats) -> bool:
    return bool(_BEGINS_LEVEL[0] < np.median(in_g[_beginning(record)]) < _BEGINS_LEVEL[1])


def _share(size: Floats, band: tuple[float, float]) -> float:
    return float(np.mean((size > band[0]) & (size < band[1])))


def _check_sign(record: Samples, upwards: Floats, size: Floats) -> None:
    """Refuse a record whose level flight is more often downwards than upwards along z, where it is along z.

    To turn z over is advised only if the record does not begin upright, as a rocket does on its pad, and is not pushed
    upwards by more than downwards.
    """
    in_g = size / STANDARD_GRAVITY
    level = (in_g > LEVEL[0]) & (in_g < LEVEL[1])
    is_down, is_up = level & (upwards < -_TURNED * size), level & (upwards > _TURNED * size)
    if is_down.mean() < _SOME or is_down.sum() <= is_up.sum():
        return
    i = int(is_down.argmax())
    boost = upwards / STANDARD_GRAVITY - np.copysign(_BOOST, upwards)
    pushed = np.sum(boost[upwards > 0].clip(0)) > -np.sum(boost[upwards < 0].clip(None, 0))
    upright = np.median(upwards[_beginning(record)]) > _BEGINS_LEVEL[0] * STANDARD_GRAVITY
    turn_over = "write " + ", ".join(f'{axis} = "{name}"' for axis, name in record.upended.items())
    trust = _trust("sign", "if the specimen hangs upside down")
    raise InputError(
        "record.z",
        f"is {record.said(upwards[i])} at {record.time[i]:g} s ({record.place(i)}), and downwards for "
        f"{100 * is_down.sum() / level.sum():.0f} % of level flight, which is 1 g upwards, along +z",
        "; ".join([*([] if pushed or upright else [turn_over]), _ACCELERATION, *_vehicles(record, size), trust]),
    )


def _check_dropouts(record: Samples) -> None:
    """Refuse a channel that stops changing where a sensor dropped out."""
    step = float(np.median(np.diff(record.time)))
    for values, (axis, name) in zip(record.load.T, record.names.items(), strict=True):
        frozen = dropout(values, step)
        if frozen is not None:
            first, last = frozen
            raise InputError(
                f"record.{axis}",
                f"column {name.lstrip('-')!r} stands still at {record.said(values[first])} "
                f"from {record.time[first]:g} s to {record.time[last]:g} s "
                f"({rows(record.place(first), record.place(last))}): the sensor dropped out",
                f"mend or cut the record there; {_trust('dropouts')}",
            )


def rows(first: str, last: str) -> str:
    word, number = first.split()
    return f"{word}s {number} to {last.split()[1]}"


_ALONG = 0.7  # of the largest load: within 45° of the beam
_LISTED = 4  # flat tops


def curves(time: Floats, load: Floats, rates: Floats) -> Curves:
    """Summary of a load (t, 3), m/s², and rates (t, 3), rad/s, or none (t, 0), at times (t,), s: rate,
    ranges and peak.
    """
    top = int(np.linalg.norm(load, axis=1).argmax())
    return Curves(
        samples=len(time),
        rate=float((len(time) - 1) / (time[-1] - time[0])),
        smallest=_vector(load.min(axis=0)),
        largest=_vector(load.max(axis=0)),
        peak=_vector(load[top]),
        time_of_peak=float(time[top]),
        rates=BodyRates(_vector(rates.min(axis=0)), _vector(rates.max(axis=0))) if rates.size else None,
    )


def oddities(record: Samples) -> Iterator[str]:
    """Warn if a sensor seems to have reached the end of its range, and if the largest load lies along the beam."""
    for (axis, name), values in zip(record.names.items(), record.load.T, strict=True):
        for extreme, runs in flat_tops(values):
            stretches = ", ".join(
                f"{record.time[run.start]:g} to {record.time[run.stop - 1]:g} s "
                f"({rows(record.place(run.start), record.place(run.stop - 1))})"
                for run in runs[:_LISTED]
            )
            rest = f" and {len(runs) - _LISTED} times more" if len(runs) > _LISTED else ""
            yield (
                f"{axis}, column {name.lstrip('-')!r}, stands at its extreme, {record.said(extreme)}, from "
                f"{stretches}{rest}: its sensor seems to be at the end of its range, and what is beyond is lost"
            )
    size = np.linalg.norm(record.load, axis=1)
    top = int(size.argmax())
    along_beam = record.load[top] @ record.axes[0]
    if abs(along_beam) > _ALONG * size[top]:
        yield (
            f"the largest load, {record.said(size[top])} at {record.time[top]:g} s, lies along the beam (x is "
            f"{record.said(along_beam)}), which bends it little; x is {record.names['x']!r}"
        )


def level(record: Samples) -> Level | None:
    """Longest stretch of level flight, of at least a second, with its mean load, or None without any."""
    if not record.specific or record.vehicle != "aircraft":
        return None
    in_g = np.linalg.norm(record.load, axis=1) / STANDARD_GRAVITY
    runs = true_runs((in_g > LEVEL[0]) & (in_g < LEVEL[1]))
    if not runs:
        return None
    longest = max(runs, key=lambda run: run.stop - run.start)
    ends = float(record.time[longest.start]), float(record.time[longest.stop - 1])
    if ends[1] - ends[0] < _LASTS:
        return None
    return Level(*ends, _vector(record.axes @ record.load[longest].mean(axis=0)))


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
