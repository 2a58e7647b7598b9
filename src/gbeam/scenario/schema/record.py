"""[motion.NAME.record]: a measured flight, its columns and units, what is done to it and which checks are left out."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool, Tag, model_validator

from gbeam.scenario.schema.fields import ONE_OR_LIST, File, Moment, Quantity, Table, refuse, wrong

_Skipped = Annotated[
    Annotated[StrictBool, Tag("one")]
    | Annotated[tuple[Literal["sampling", "spikes", "unit", "sign", "dropouts", "columns"], ...], Tag("list")],
    ONE_OR_LIST,
]


class Record(Table):
    """A measured flight: a file of named columns."""

    file: File = Field(
        description="text of any dialect, or by its suffix MAT (.mat), HDF5 (.h5, .hdf5), netCDF (.nc) or UFF 58 "
        "(.uff, .unv), relative to the folder of the scenario file"
    )
    time: str = Field(
        description="name of the column of times, numbers or times of day; in MAT, HDF5 and netCDF of the variable, "
        "such as rec.t or acc(:,1); in UFF time"
    )
    time_unit: Literal["s", "ms", "us", "min"] | None = Field(
        default=None, description="unit of the times; what the file says if left out, or else s"
    )
    x: str = Field(description='column of the x component, along the beam; "-" in front changes the sign, "0" is none')
    y: str = Field(description='column of the y component, along the width; "-" in front changes the sign, "0" is none')
    z: str = Field(description='column of the z component, through the thickness; "-" and "0" likewise')
    unit: Literal["g", "m/s^2", "ft/s^2"] = Field(description="unit of the components: g is 9.80665 m/s^2")
    quantity: Literal["specific-force", "acceleration"] = Field(
        default="specific-force",
        description="what the components are. specific-force: what accelerometers measure, 1 g upwards in level "
        "flight; acceleration: none then",
    )
    p: str | None = Field(
        default=None, description="column of the body rate about x; p, q and r fly the specimen with them"
    )
    q: str | None = Field(default=None, description='column of the body rate about y; "-" and "0" as for x, y and z')
    r: str | None = Field(default=None, description='column of the body rate about z; "-" and "0" likewise')
    rate_unit: Literal["rad/s", "deg/s"] | None = Field(default=None, description="unit of p, q and r")
    begin: Moment | None = Field(
        default=None,
        alias="from",
        description="first time of the part that is flown, on the record's own clock, such as 2 s, or 12:34:56.7 where "
        "its times are times of day; the record's first if left out",
    )
    to: Moment | None = Field(
        default=None, description="last time of the part that is flown, likewise; the record's last if left out"
    )
    cutoff: Annotated[float, Quantity("frequency", "positive")] | None = Field(
        default=None, description="cut-off of a zero-phase low-pass, -6 dB, such as 5 Hz; none if left out"
    )
    resample: Annotated[float, Quantity("frequency", "positive")] | None = Field(
        default=None,
        description="new sampling rate, such as 200 Hz, and times may jitter; the record's own if left out",
    )
    despike: StrictBool = Field(default=False, description="replace single samples far off their neighbours")
    skip_checks: _Skipped = Field(
        default=False,
        description="true to take the record as it is, or a list of the checks to leave out: sampling (rate), spikes, "
        "unit (size, level flight), sign (level flight is upwards), dropouts, columns (their names)",
    )

    @model_validator(mode="after")
    def _rates_together(self) -> Record:
        keys = [name for name in ("p", "q", "r", "rate_unit") if getattr(self, name) is not None]
        if keys and len(keys) < 4:
            missing = next(name for name in ("p", "q", "r", "rate_unit") if name not in keys)
            hint = 'give p, q and r ("0" for none) and rate_unit = "rad/s" or "deg/s"'
            refuse([((), wrong(f"{missing} is missing beside {keys[0]}", hint, mark="key"))])
        return self
