"""[motion.NAME]: what the base does. Flight, a centrifuge that tracks a flight, a hub."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, Discriminator, Field, StrictBool, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from gbeam.scenario.fields import (
    Length,
    Loc,
    Position,
    Quantity,
    Table,
    Time,
    refuse,
    wrong,
)
from gbeam.scenario.schema.profile import AccelerationProfile, RateProfile, TorqueProfile
from gbeam.scenario.suggest import closest


def _exactly_one(table: Table, first: str, second: str) -> Iterator[tuple[Loc, PydanticCustomError]]:
    given = [name for name in (first, second) if getattr(table, name) is not None]
    if len(given) == 2:
        yield (second,), wrong(f"is given beside {first}", f"keep {first} or {second}, not both", mark="key")
    if not given:
        yield (
            (),
            wrong(
                f"{first} or {second} is missing",
                f"add one of them: {first} = ... or {second} = ...",
                mark="key",
            ),
        )


def _existing(file: str, info: ValidationInfo) -> str:
    """Resolve `file` against the scenario's folder, which load passes as context."""
    path = Path((info.context or {}).get("folder", ".")) / file
    if path.is_file():
        return str(path)
    folder = path.parent
    neighbours = sorted(p.name for p in folder.iterdir() if p.is_file()) if folder.is_dir() else []
    near = closest(path.name, neighbours)
    looked = f"it is looked for in {folder}"
    raise wrong("there is no file {value}", f"did you mean {str(Path(file).with_name(near))!r}?" if near else looked)


class Record(Table):
    """A measured flight: a CSV file whose first line names the columns."""

    file: Annotated[str, AfterValidator(_existing)] = Field(
        description="CSV file, relative to the folder of the scenario file"
    )
    time: str = Field(description="name of the column of times, s")
    x: str = Field(description='column of the x component, along the beam; "-" in front changes the sign, "0" is none')
    y: str = Field(description='column of the y component, along the width; "-" in front changes the sign, "0" is none')
    z: str = Field(description='column of the z component, through the thickness; "-" and "0" likewise')
    unit: Literal["g", "m/s^2"] = Field(description="unit of the components: g is 9.80665 m/s^2")


class Components(Table):
    """An acceleration by components in base axes; those left out are zero."""

    x: AccelerationProfile | None = Field(default=None, description="profile of the component along the beam")
    y: AccelerationProfile | None = Field(default=None, description="profile of the component along the width")
    z: AccelerationProfile | None = Field(default=None, description="profile of the component through the thickness")

    @model_validator(mode="after")
    def _any(self) -> Components:
        if self.x is None and self.y is None and self.z is None:
            refuse([((), wrong("has no component", "give one or more of x, y and z"))])
        return self


class Flight(Table):
    """The root accelerates as recorded or prescribed, and the axes do not turn."""

    kind: Literal["flight"] = Field(description="kind of the motion")
    record: Record | None = Field(
        default=None, description="a measured record: { file, time, x, y, z, unit }; or acceleration"
    )
    acceleration: Components | None = Field(
        default=None, description="profiles: { x, y, z }, those left out zero; or record"
    )
    smoothing: Time = Field(default=0.0, description="width of the kernel that rounds the corners; 0 leaves them sharp")

    @model_validator(mode="after")
    def _one_source(self) -> Flight:
        refuse(_exactly_one(self, "record", "acceleration"))
        return self


def _available(inverse: str) -> str:
    # Delete this, and its use below, when the exact inverse comes.
    if inverse == "exact":
        raise wrong("the inverse {value} comes with a later version", "use flat")
    return inverse


class Centrifuge(Table):
    """A three-axis centrifuge that gives the control point the load of a flight."""

    kind: Literal["centrifuge"] = Field(description="kind of the motion")
    tracks: str = Field(description="NAME of the flight motion that it imitates")
    arm: Length = Field(description="radius from the main axis to the control point")
    control_point: Position = Field(description="point of the beam that feels the flight's load, from the root")
    inverse: Annotated[Literal["quasi-static", "flat", "exact"], AfterValidator(_available)] = Field(
        description="how the axis motions are found. quasi-static: the arm's tangential acceleration is "
        "ignored; flat: yaw makes up for it"
    )
    gravity: StrictBool = Field(
        description="true if the target is specific force, of which gravity is a part on the machine; "
        "false if it is acceleration"
    )
    idle: Annotated[float, Quantity("acceleration", "positive")] | None = Field(
        default=None, description="load below which the target is held up to this magnitude"
    )
    smoothing: Time = Field(
        default=0.0, description="width of the kernel that rounds the target's corners; 0 leaves them sharp"
    )
    mounting: Literal["upright", "inverted"] = Field(
        default="upright", description="which of the two ways the specimen sits in the gimbals"
    )


class Hub(Table):
    """A rigid hub that turns about z, the beam on its rim: with a prescribed rate, or free under a torque."""

    kind: Literal["hub"] = Field(description="kind of the motion")
    radius: Position = Field(description="from the hub's axis to the beam's root")
    rate: RateProfile | None = Field(default=None, description="profile of the hub's rate; or inertia and torque")
    inertia: Annotated[float, Quantity("moment of inertia", "positive")] | None = Field(
        default=None, description="moment of inertia of the hub about its axis"
    )
    torque: TorqueProfile | None = Field(default=None, description="profile of the torque on the hub; needs inertia")

    @model_validator(mode="after")
    def _one_drive(self) -> Hub:
        def problems() -> Iterator[tuple[Loc, PydanticCustomError]]:
            yield from _exactly_one(self, "rate", "torque")
            if self.torque is not None and self.inertia is None:
                yield (
                    (),
                    wrong(
                        "inertia is missing",
                        'a hub under a torque needs it: inertia = "200 kg m^2"',
                        mark="key",
                    ),
                )
            if self.torque is None and self.inertia is not None and self.rate is not None:
                yield (
                    ("inertia",),
                    wrong("is given beside rate", "a hub with a prescribed rate needs none", mark="key"),
                )

        refuse(problems())
        return self


Motion = Annotated[Flight | Centrifuge | Hub, Discriminator("kind")]
