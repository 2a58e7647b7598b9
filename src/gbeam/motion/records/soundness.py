"""Soundness of a record: what its columns are named, and what its samples show."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.io.tables.table import Table
from gbeam.motion.bases.conditioning import dropout, spikes, without_spikes
from gbeam.motion.records.units import UNITS, words_of

_TRUST = 'if the name misleads, add skip_checks = ["columns"]'
_LOADS = re.compile(r"(a|n|f|g|nlf|load|factor|acc\w*)[xyz]?")  # words of which a name is a load's
_FACTOR = re.compile(r"\b(n ?[xyz]|nlf|load factor)\b")
_AXIS = re.compile(r"(?:a|n|f|g|acc|accel|imu)?([xyz])")
# Words, or ends of names, of what is no load.
_OTHERS = {
    "a rate of rotation": ("p", "q", "r", "wx", "wy", "wz", "gyro", "gyr", "omega", "rad/s", "deg/s", "dps", "rpm"),
    "an angle": ("roll", "pitch", "yaw", "heading", "phi", "theta", "psi", "alpha", "beta", "aoa", "deg", "rad"),
    "a speed": ("speed", "velocity", "vel", "tas", "ias", "cas", "eas", "mach", "kt", "kts", "knots", "mps", "fps"),
    "a height": ("altitude", "alt", "height", "agl", "msl"),
    "a time": ("time", "timestamp", "utc"),
    "a temperature": ("temperature", "temp"),
}


def refuse_other_kinds(table: Table, names: dict[str, str]) -> None:
    """Refuse a column that is no load by its name, and one that is named for two components."""
    used: dict[str, str] = {}
    for axis, name in names.items():
        _, column = table.signed(name)
        if column is None:
            continue
        table.column(axis, column)
        kind = _other_kind(column)
        if kind:
            loads = [one.name for one in table.columns if any(map(_is_load, words_of(one.name)))]
            fix = f"name a column of load, such as {loads[0]!r}" if loads else "name a column of load"
            raise InputError(f"record.{axis}", f"names {column!r}, by its name {kind} and no load", f"{fix}; {_TRUST}")
        if column in used:
            fix = 'name each once, and "0" for a component that is zero; or add skip_checks = ["columns"]'
            raise InputError(f"record.{axis}", f"names {column!r}, which is {used[column]} too", fix)
        used[column] = axis


def mirrored(table: Table, names: dict[str, str]) -> Iterator[str]:
    """Say where the columns' axes, right-handed by their names, become left-handed ones of the beam."""
    mapping = np.zeros((3, 3))
    for row, name in zip(mapping, names.values(), strict=True):
        sign, column = table.signed(name)
        axes = [] if column is None else [match[1] for word in words_of(column) if (match := _AXIS.fullmatch(word))]
        if len(axes) == 1:
            row["xyz".index(axes[0])] = sign
    if round(float(np.linalg.det(mapping))) == -1:
        listed = ", ".join(f"{axis} = {name!r}" for axis, name in names.items())
        yield (
            f"{listed} mirrors the columns' axes (determinant -1): two are exchanged, or one has the wrong sign; "
            'aircraft axes, x forward, y right, z down, want x = "X", y = "-Y", z = "-Z". If the columns themselves '
            'are left-handed, such as with a load factor upwards, add skip_checks = ["columns"]'
        )


def load_factors(table: Table, names: dict[str, str], unit: str, *, specific: bool) -> Iterator[str]:
    """Say where columns are load factors by their names, and are taken for something else."""
    columns = [column for _, column in map(table.signed, names.values()) if column is not None]
    factors = [column for column in columns if _FACTOR.search(" ".join(words_of(column)))]
    if factors and unit != "g":
        yield f"{factors[0]!r} is a load factor by its name, which is in g, and unit is {unit}"
    if factors and not specific:
        yield (
            f"{factors[0]!r} is a load factor by its name, which is specific force, 1 g in level flight, and quantity "
            "is acceleration"
        )


def _other_kind(name: str) -> str:
    words = words_of(name)
    if any(map(_is_load, words)):
        return ""
    ends = {*words, "/".join(words[-2:])}
    return next((kind for kind, known in _OTHERS.items() if ends & set(known)), "")


def _is_load(word: str) -> bool:
    return _LOADS.fullmatch(word) is not None


Floats = NDArray[np.float64]

CHECKS = ("sampling", "spikes", "unit", "sign", "dropouts", "columns")
LARGEST = 50.0  # g
_FRAGMENT = 2.0  # s
_BEGINS = 3.0  # g: above that, no flight begins
_OUTSTANDING = 1.5  # a spike that much above the rest would be the record's peak
LEVEL = (0.75, 1.35)  # g: level flight, thrust included
_BEGINS_LEVEL = (0.7, 1.6)  # g
_SOME, _HARDLY = 0.05, 0.02  # of the record
_TURNED = 0.7  # of the load: within 45° of upwards or downwards
_NEVER = 0.7  # g: what stays below does not fly level anywhere
_PILOTED = 12.0  # g: no aircraft, and few rockets
_ACCELERATION = 'if it is acceleration without gravity, add quantity = "acceleration"'


@dataclass(frozen=True)
class Samples:
    """Subject of the checks.

    Parameters
    ----------
    time : (t,) s
    load : (t, 3) m/s², base axes
    names : dict of str to str
        Columns of x, y and z, with their signs.
    unit : str
        That the load was read in, a key of ``UNITS["acceleration"]``.
    specific : bool
        Specific force, 1 g upwards in level flight; else acceleration.
    place : callable
        Where a sample is in its file, in words.
    """

    time: Floats
    load: Floats
    names: dict[str, str]
    unit: str
    specific: bool
    place: Callable[[int], str]

    def said(self, value: float) -> str:
        """A load, m/s², in the record's unit."""
        return f"{value / UNITS['acceleration'][self.unit]:.4g} {self.unit}"


def refuse_unsound(record: Samples, whole: Samples, skip: Collection[str]) -> None:
    """Raise InputError if a record does not look like a flight's; single samples far off are judged first.

    A fragment of less than 2 s need hold no level flight: of that only the size is judged, and dropouts.
    """
    odd, calm, size = _calmed(record)
    if "spikes" not in skip and _lasts(record):
        _check_spikes(record, odd, size)
    if "unit" not in skip:
        _check_size(record, size)
    if _lasts(whole) and whole.specific and not {"unit", "sign"} <= set(skip):
        if whole is not record:
            _, calm, size = _calmed(whole)
        if "unit" not in skip:
            _check_level(whole, size)
        if "sign" not in skip:
            _check_sign(whole, calm[:, 2], size)
    if "dropouts" not in skip:
        _check_dropouts(record)


def _lasts(record: Samples) -> bool:
    return float(record.time[-1] - record.time[0]) >= _FRAGMENT


def _calmed(record: Samples) -> tuple[NDArray[np.bool_], Floats, Floats]:
    """Spikes of a record, its load without them, and the size of that."""
    odd = spikes(record.load)
    calm = without_spikes(record.time, record.load, odd)
    return odd, calm, np.linalg.norm(calm, axis=1)


def _trust(check: str, otherwise: str = "if the record is right as it is") -> str:
    return f'{otherwise}, add skip_checks = ["{check}"]'


def _check_spikes(record: Samples, odd: NDArray[np.bool_], size: Floats) -> None:
    """Refuse a spike that would be the record's peak."""
    high = np.linalg.norm(record.load, axis=1)
    i = int(np.argmax(np.where(odd.any(axis=1), high, 0)))
    rest, largest = size.max(), LARGEST * STANDARD_GRAVITY
    if not odd[i].any() or not (high[i] > _OUTSTANDING * rest or high[i] > largest >= rest):
        return
    axis = int(np.argmax(np.where(odd[i], np.abs(record.load[i]), 0)))
    name = record.names["xyz"[axis]].lstrip("-")
    raise InputError(
        f"record.{'xyz'[axis]}",
        f"column {name!r} has {odd.any(axis=1).sum()} sample(s) that look like spikes: the load is "
        f"{record.said(high[i])} at {record.time[i]:g} s ({record.place(i)}), {record.said(size[i])} beside it",
        f"add despike = true, which replaces them; {_trust('spikes')}",
    )


def _check_size(record: Samples, size: Floats) -> None:
    """Refuse a load that nothing withstands in the declared unit."""
    i = int(size.argmax())
    if size[i] > LARGEST * STANDARD_GRAVITY:
        sizes = UNITS["acceleration"]
        smaller = [unit for unit in sizes if sizes[unit] < sizes[record.unit]]
        raise InputError(
            "record.unit",
            f"is {record.unit}, which makes {size[i] / STANDARD_GRAVITY:.3g} g of {record.place(i)}, "
            f"at {record.time[i]:g} s",
            "; ".join([*([_wants(*smaller)] if smaller else []), _trust("unit")]),
        )


def _check_level(record: Samples, size: Floats) -> None:
    """Refuse a load that is level flight in another unit and no flight in the declared one."""
    in_g, units = size / STANDARD_GRAVITY, UNITS["acceleration"]
    first = slice(max(int(1 / np.median(np.diff(record.time))), 4))
    begins, peak, level_share = float(np.median(in_g[first])), in_g.max(), _share(in_g, LEVEL)
    others = []
    for unit in units:
        as_other = in_g * units[unit] / units[record.unit]
        begins_level = _BEGINS_LEVEL[0] < float(np.median(as_other[first])) < _BEGINS_LEVEL[1]
        if unit != record.unit:
            others.append((begins_level, _share(as_other, LEVEL), unit))
    for begins_level, other_share, other in sorted(others, reverse=True):  # the likeliest first
        if record.unit == "g":
            # Level at 9.8 and nowhere at 1; a rocket that passes 9.8 g has been at less.
            doubtful = begins > _BEGINS or (other_share > _SOME and level_share < _HARDLY and peak > _PILOTED)
        else:
            # What is level at 0.1 g either pulls more than 1 g to stay in the air, or is in g.
            doubtful = peak < _NEVER or (other_share > _SOME and (peak < LEVEL[1] or begins_level))
        if doubtful:
            raise InputError(
                "record.unit",
                f"is {record.unit}, and the record begins at {record.said(begins * STANDARD_GRAVITY)} and reaches "
                f"{record.said(size.max())}, {peak:.3g} g: level flight is 1 g, which is 9.81 m/s^2",
                f"{_wants(other)}; {_ACCELERATION}; {_trust('unit')}",
            )


def _wants(*units: str) -> str:
    return ", ".join(f'a record in {unit} wants unit = "{unit}"' for unit in units)


def _share(size: Floats, band: tuple[float, float]) -> float:
    return float(np.mean((size > band[0]) & (size < band[1])))


def _check_sign(record: Samples, upwards: Floats, size: Floats) -> None:
    """Refuse a record whose level flight, where it is along z, is more often downwards than upwards."""
    in_g = size / STANDARD_GRAVITY
    level = (in_g > LEVEL[0]) & (in_g < LEVEL[1])
    down, up = level & (upwards < -_TURNED * size), level & (upwards > _TURNED * size)
    if down.mean() < _SOME or down.sum() <= up.sum():
        return
    i, name = int(down.argmax()), record.names["z"]
    turned = name[1:].strip() if name.startswith("-") else f"-{name}"
    raise InputError(
        "record.z",
        f"is {record.said(upwards[i])} at {record.time[i]:g} s ({record.place(i)}), and downwards for "
        f"{100 * down.sum() / level.sum():.0f} % of level flight, which is 1 g upwards, along +z",
        f'write z = "{turned}"; {_ACCELERATION}; {_trust("sign", "if the specimen hangs upside down")}',
    )


def _check_dropouts(record: Samples) -> None:
    step = float(np.median(np.diff(record.time)))
    for values, (axis, name) in zip(record.load.T, record.names.items(), strict=True):
        still = dropout(values, step)
        if still is not None:
            first, last = still
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
