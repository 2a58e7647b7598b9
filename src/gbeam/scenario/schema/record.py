"""A measured flight in a file: which columns, in which units and axes, and which part of it is flown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, get_args

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    StrictBool,
    Tag,
    WithJsonSchema,
    model_validator,
)

from gbeam.constants import AccelerationUnit, Check, RateUnit, RecordQuantity, TimeUnit, Vehicle
from gbeam.errors import InputError
from gbeam.guards.quantities import Acceleration, AngularRate, Duration, Quantity
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    File,
    Moment,
    Place3,
    Table,
    Turn3,
    listed,
    optional,
    refuse,
    wrong,
)

_Skipped = Annotated[
    Annotated[StrictBool, Tag("one")] | Annotated[tuple[Check, ...], Tag("list")],
    ONE_OR_LIST,
]


def _unit_of(quantity: str, words: Any, example: str) -> Any:
    """Type of a unit of a record: one of the words, another spelling of one, or the size of a count."""

    def read(text: str) -> str:
        from gbeam.motion.records.units import sized  # not needed where there is no record

        try:
            sized("unit", quantity, text)
        except InputError as error:
            raise wrong(error.problem, error.fix) from None
        return text

    either = [{"enum": [*get_args(words)]}, {"type": "string", "examples": [example]}]
    return Annotated[str, AfterValidator(read), WithJsonSchema({"anyOf": either})]


if TYPE_CHECKING:  # type checkers make no types
    _LoadUnit = str
    _RateUnit = str
    _TimeUnit = str
else:
    _LoadUnit = _unit_of("acceleration", AccelerationUnit, "1 g / 2048")
    _RateUnit = _unit_of("rate", RateUnit, "1 deg/s / 16.4")
    _TimeUnit = _unit_of("time", TimeUnit, "1 s / 32768")


def _word(value: Any) -> Any:
    """A section as text, as it is found in its column."""
    return f"{value:.12g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else value


_Section = Annotated[str, BeforeValidator(_word), WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string"}]})]


_From = Annotated[
    Moment | None,
    Field(
        alias="from",
        description="first time of the part that is flown, on the record's own clock, such as 2 s, or 12:34:56.7 where "
        "its times are times of day; the record's first if left out",
    ),
]
_To = Annotated[
    Moment | None,
    Field(description="last time of the part that is flown, likewise; the record's last if left out"),
]
_OfSections = Annotated[
    _Section | None,
    Field(
        description="section that is flown: the number or word that the column of sections holds through it; of one "
        "that stands in several stretches, from and to choose"
    ),
]


class PartOfRecord(Table):
    """Another part of the record of another flight, whose file is read once and whose keys hold for both."""

    of: str = Field(description="NAME of the flight that has the record itself")
    begin: _From = None
    to: _To = None
    section: _OfSections = None


class Rest(Table):
    """A stretch of a record in which the vehicle rests, or its load is known."""

    begin: Moment | None = optional(
        "first time of the stretch, on the record's own clock; the record's first if left out", alias="from"
    )
    to: Moment | None = optional("last time of the stretch; the record's last if left out")
    load: tuple[Acceleration, Acceleration, Acceleration] | None = optional(
        'the load there, base axes, such as ["0 g", "0 g", "1 g"], which specific force is at rest if left out; '
        "acceleration is none then"
    )
    rates: tuple[AngularRate, AngularRate, AngularRate] = Field(
        default=(0.0, 0.0, 0.0), description="the body's rates there, about base axes, such as of a rate table"
    )


class Record(Table):
    """A measured flight: a file of named columns."""

    file: File = Field(
        description="text of any dialect, or by its suffix MAT (.mat), HDF5 (.h5, .hdf5), netCDF (.nc) or UFF 58 "
        "(.uff, .unv), relative to the folder of the scenario file"
    )
    time: str | None = optional(
        "name of the column of times, numbers or times of day; in MAT, HDF5 and netCDF of the variable, such as rec.t "
        "or acc(:,1); in UFF time"
    )
    sample_rate: Annotated[float, Quantity("frequency", "positive")] | None = optional(
        "in place of time, such as 100 Hz: the first sample is at 0 s"
    )
    time_unit: _TimeUnit | None = optional("unit of the times; what the file says if left out, or else s")
    x: str = Field(description='column of the x component, along the beam; "-" in front changes the sign, "0" is none')
    y: str = Field(description='column of the y component, along the width; "-" in front changes the sign, "0" is none')
    z: str = Field(description='column of the z component, through the thickness; "-" and "0" likewise')
    unit: _LoadUnit = Field(
        description="unit of the components, g being 9.80665 m/s^2, or the size of a count: 1 g / 2048, 1 g / 100 mV"
    )
    quantity: RecordQuantity = Field(
        default="specific-force",
        description="what the components are. specific-force: what accelerometers measure, 1 g upwards in level "
        "flight; acceleration: none then",
    )
    vehicle: Vehicle = Field(
        default="aircraft",
        description="of what it is. aircraft: flies level somewhere, 1 g upwards along z; rocket: begins at 1 g, or is "
        "pushed, along any axis; other: nothing of that is asked",
    )
    p: str | None = optional("column of the body rate about x; p, q and r fly the specimen with them")
    q: str | None = optional('column of the body rate about y; "-" and "0" as for x, y and z')
    r: str | None = optional('column of the body rate about z; "-" and "0" likewise')
    rate_unit: _RateUnit | None = optional("unit of p, q and r")
    turn: Turn3 = Field(
        default=(0.0, 0.0, 0.0),
        description="rotation vector of the axes that x, y and z name in base axes, where the instrument's block sits "
        "askew",
    )
    level: tuple[Moment, Moment] | None = optional(
        "first and last time of a stretch at rest and level, on the record's own clock: the block is turned on by the "
        "shortest way, so that the specific force there points along z"
    )
    rest: tuple[Rest, ...] = listed(
        "stretches at rest, or of another known load: what the sensors of x, y, z, p, q and r read there besides is "
        "their offset, and is subtracted; of several stretches it drifts on straight lines from one to the next, and on"
    )
    arm: Place3 = Field(
        default=(0.0, 0.0, 0.0),
        description="from the instrument to the specimen's root, base axes: by p, q and r it adds α × r + ω × (ω × r)",
    )
    begin: _From = None
    to: _To = None
    section: _OfSections = None
    sections: str | None = optional(
        "column that numbers or names the sections of the file, such as an event marker or the number of a manoeuvre"
    )
    cutoff: Annotated[float, Quantity("frequency", "positive")] | None = optional(
        "cut-off of a zero-phase low-pass, -6 dB, such as 5 Hz; none if left out"
    )
    resample: Annotated[float, Quantity("frequency", "positive")] | None = optional(
        "new sampling rate, such as 200 Hz; the record's own if left out. With it, or with cutoff, times may jitter, "
        "repeat and come late"
    )
    bridge: Duration | None = optional(
        "longest gap, such as 50 ms, that is bridged with resample or cutoff: lost samples are put on straight lines"
    )
    despike: StrictBool = Field(
        default=False, description="replace spikes, up to five samples between two jumps, by straight lines"
    )
    skip_checks: _Skipped = Field(
        default=False,
        description="true to take the record as it is, or a list of the checks to leave out: sampling (rate), spikes, "
        "unit (size, level flight), sign (level flight is upwards), dropouts, columns (their names), rest (that the "
        "load there is steady, and how far sensors are off)",
    )

    @model_validator(mode="after")
    def _one_clock(self) -> Record:
        if self.time is not None and self.sample_rate is not None:
            refuse([(("sample_rate",), wrong("is given beside time", "give one of them", mark="key"))])
        if self.time is None and self.sample_rate is None:
            refuse([((), wrong("time is missing", 'give the column of times, or sample_rate = "100 Hz"', mark="key"))])
        if self.sample_rate is not None and self.time_unit is not None:
            refuse([(("time_unit",), wrong("is given without time", "leave it out", mark="key"))])
        if self.section is not None and self.sections is None:
            hint = 'name the column that numbers them, such as sections = "event"'
            refuse([(("section",), wrong("is given without sections", hint, mark="key"))])
        if self.bridge is not None and self.resample is None and self.cutoff is None:
            hint = 'add resample = "100 Hz", or a cutoff: what is bridged is evened out'
            refuse([(("bridge",), wrong("is given without resample and cutoff", hint, mark="key"))])
        return self

    @model_validator(mode="after")
    def _rates_together(self) -> Record:
        keys = [name for name in ("p", "q", "r", "rate_unit") if getattr(self, name) is not None]
        if keys and len(keys) < 4:
            missing = next(name for name in ("p", "q", "r", "rate_unit") if name not in keys)
            hint = 'give p, q and r ("0" for none) and rate_unit = "rad/s" or "deg/s"'
            refuse([((), wrong(f"{missing} is missing beside {keys[0]}", hint, mark="key"))])
        return self


def _source(value: Any) -> str:
    """Tag of a record: ``part`` of one that names another flight's."""
    return "part" if isinstance(value, PartOfRecord) or (isinstance(value, dict) and "of" in value) else "file"


RecordOrPart = Annotated[
    Annotated[Record, Tag("file")] | Annotated[PartOfRecord, Tag("part")],
    Discriminator(_source),
]
