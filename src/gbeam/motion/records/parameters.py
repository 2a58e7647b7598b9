"""Parameters of a record, declared once: columns and units, what they hold, the part that is flown, what is mended."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Annotated, Any

from gbeam.constants import Check, RecordQuantity, Vehicle
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Duration, Frequency
from gbeam.motion.records.soundness import CHECKS
from gbeam.motion.records.times import Moment
from gbeam.motion.records.units import LoadUnit, RateUnit, TimeUnit
from gbeam.printable import advise


class Word:
    """Annotation of a text that a file may also give as a number, as it is found in a column."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> dict[str, Any]:
        """Validate text, or a number in words."""
        return {
            "type": "function-before",
            "schema": handler(str),
            "function": {"type": "no-info", "function": read_word},
        }

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Describe it as a number or text."""
        return {"anyOf": [{"type": "number"}, {"type": "string"}]}


def read_word(value: Any) -> Any:
    """Return a number as text; anything else as it is."""
    return f"{value:.12g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else value


RecordFile = Annotated[
    str | os.PathLike[str],
    "text of any dialect, or by its suffix MAT (.mat), HDF5 (.h5, .hdf5), netCDF (.nc) or UFF 58 (.uff, .unv); "
    "in a scenario relative to the folder of its file",
]
TimeColumn = Annotated[
    str | None,
    "name of the column of times, numbers or times of day; in MAT, HDF5 and netCDF of the variable, such as rec.t or "
    "acc(:,1); in UFF time",
]
XColumn = Annotated[str, 'column of the x component, along the beam; "-" in front changes the sign, "0" is none']
YColumn = Annotated[str, 'column of the y component, along the width; "-" in front changes the sign, "0" is none']
ZColumn = Annotated[str, 'column of the z component, through the thickness; "-" and "0" likewise']
LoadUnitOf = Annotated[
    LoadUnit, "unit of the components, g being 9.80665 m/s^2, or the size of a count: 1 g / 2048, 1 g / 100 mV"
]
TimeUnitOf = Annotated[TimeUnit | None, "unit of the times; what the file says if left out, or else s"]
SampleRate = Annotated[Frequency | None, "in place of time, such as 100 Hz: the first sample is at 0 s"]
QuantityOf = Annotated[
    RecordQuantity,
    "what the components are. specific-force: what accelerometers measure, 1 g upwards in level flight; acceleration: "
    "none then",
]
VehicleOf = Annotated[
    Vehicle,
    "of what it is. aircraft: flies level somewhere, 1 g upwards along z; rocket: begins at 1 g, or is pushed, along "
    "any axis; other: nothing of that is asked",
]
SectionsBy = Annotated[
    str | None,
    "column that numbers or names the sections of the file, such as an event marker or the number of a manoeuvre",
]
From = Annotated[
    Moment | None,
    "first time of the part that is flown, on the record's own clock, such as 2 s, or 12:34:56.7 where its times are "
    "times of day; the record's first if left out",
]
To = Annotated[Moment | None, "last time of the part that is flown, likewise; the record's last if left out"]
SectionFlown = Annotated[
    Annotated[str, Word()] | None,
    "section that is flown: the number or word that the column of sections holds through it; of one that stands in "
    "several stretches, from and to choose",
]


@dataclass(frozen=True)
class Rates:
    """Columns of a record that hold the body's rates about the base axes, and their unit."""

    p: Annotated[str, "column of the body rate about x; p, q and r fly the specimen with them"]
    q: Annotated[str, 'column of the body rate about y; "-" and "0" as for x, y and z']
    r: Annotated[str, 'column of the body rate about z; "-" and "0" likewise']
    rate_unit: Annotated[RateUnit, "unit of p, q and r"]

    @classmethod
    def from_columns(
        cls, p: str | None = None, q: str | None = None, r: str | None = None, rate_unit: str | None = None
    ) -> Rates | None:
        """Return the rates of columns that are given, all of them, or None of none; InputError if some are."""
        if p is not None and q is not None and r is not None and rate_unit is not None:
            return cls(p, q, r, rate_unit)
        keys = {"p": p, "q": q, "r": r, "rate_unit": rate_unit}
        named = [key for key, value in keys.items() if value is not None]
        if named:
            lacking = next(key for key, value in keys.items() if value is None)
            fix = 'give p, q and r ("0" for none) and rate_unit = "rad/s" or "deg/s"'
            raise InputError("record", f"has no {lacking} beside {named[0]}", fix)
        return None


@typed
@dataclass(frozen=True)
class Conditioning:
    """Steps that are taken on a record.

    The low-pass is Butterworth's of fourth order, forwards and backwards. Spikes are runs of up to five samples between
    two jumps far off what is around them. Gaps are bridged before the low-pass and resampling.
    """

    cutoff: Annotated[Frequency | None, "cut-off of a zero-phase low-pass, -6 dB, such as 5 Hz; none if left out"] = (
        None
    )
    resample: Annotated[
        Frequency | None,
        "new sampling rate, such as 200 Hz; the record's own if left out. With it, or with cutoff, times may jitter, "
        "repeat and come late",
    ] = None
    bridge: Annotated[
        Duration | None,
        "longest gap, such as 50 ms, that is bridged with resample or cutoff: lost samples are put on straight lines",
    ] = None
    despike: Annotated[bool, "replace spikes, up to five samples between two jumps, by straight lines"] = False
    skip_checks: Annotated[
        bool | tuple[Check, ...],
        "true to take the record as it is, or a list of the checks to leave out: sampling (rate), spikes, unit (size, "
        "level flight), sign (level flight is upwards), dropouts, columns (their names), rest (that the load there is "
        "steady, and how far sensors are off)",
    ] = False

    def __post_init__(self) -> None:
        if self.bridge is not None and not self.evened:
            fix = 'add resample = "100 Hz", or a cutoff: what is bridged is evened out'
            raise InputError("record.bridge", "is given without resample and cutoff", fix)

    @property
    def evened(self) -> bool:
        """True if the samples are evened out: times may jitter, repeat and come late then."""
        return self.cutoff is not None or self.resample is not None

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
