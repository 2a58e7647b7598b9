"""[motion.NAME]: bases, and how well a centrifuge must reproduce its flight."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, Tag, create_model, model_validator

from gbeam.constants import MachineName, ToleranceOf
from gbeam.errors import InputError
from gbeam.guards.quantities import Duration, Factor, Quantity, Time
from gbeam.motion import flight, hub
from gbeam.motion.centrifuge import centrifuge, limits
from gbeam.motion.profiles.profile import Profile
from gbeam.results.criteria import RULES
from gbeam.results.sensors import Sensor as _Sensor
from gbeam.scenario.schema.arm import Arm
from gbeam.scenario.schema.declared import chosen, read_as, table_of
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    ControlPoint,
    Table,
    by_name,
    missing_one_of,
    optional,
    refuse,
    wrong,
)
from gbeam.scenario.schema.profile import rounded
from gbeam.scenario.schema.record import RecordOrPart

Level = Annotated[float, Quantity("amplitude ratio", "positive")]
Ratios = Annotated[Annotated[Factor, Tag("one")] | Annotated[tuple[Factor, Factor], Tag("list")], ONE_OR_LIST]
Levels = Annotated[Annotated[Level, Tag("one")] | Annotated[tuple[Level, Level], Tag("list")], ONE_OR_LIST]
_TYPES: dict[str, Any] = {"most": Factor, "least": Factor, "ratio": Ratios, "level": Levels}
_FIELDS: dict[str, Any] = {rule.name: (_TYPES[rule.kind] | None, optional(rule.words)) for rule in RULES.values()}
_Limits = create_model("_Limits", __base__=Table, **_FIELDS)


class Accept(_Limits):  # type: ignore[misc, valid-type]
    """Limits of the differences from flight; one that is not kept ends in exit status 1."""

    tolerance: Factor | None = optional(
        "difference from the flight's load within which it counts as followed, and of a peak from its own size within "
        "which that counts as reproduced, as a share; 5 % if left out"
    )
    tolerance_of: ToleranceOf | None = optional(
        "what tolerance is a share of. peak: the flight's largest load, as where it is left out; instant: "
        "its load at each time"
    )
    point: str | None = optional(
        'point whose displacement is that of the tip, and whose spectra srs is of: "camera", or of a '
        'system "arm.tip"; left out, the tip, and of a system the point that moves farthest in flight'
    )
    control: dict[str, Factor] = by_name(
        "weights of control points by the names of points: srs is of the weighted mean of the spectra "
        "there, in place of the tip's"
    )
    damage_at: str | None = optional(
        "point whose fatigue damage is that of damage; left out, the root of a beam, and of a solid where "
        "its von Mises stress is largest, of several materials that whose stress ranges most in flight"
    )
    stress_at: str | None = optional(
        "point whose stress is that of stress, of a solid von Mises', of a beam the normal stress; left out, the "
        "largest anywhere"
    )

    @property
    def limits(self) -> dict[str, Any]:
        """Values that are given, by name."""
        return {name: value for name, value in self if value not in (None, {})}


class _Source(Table):
    """Source of a flight: a record, or an acceleration."""

    record: RecordOrPart | None = optional(
        "a measured record: { file, time, x, y, z, unit }, or { of, from, to, section }, another part of that of "
        "another flight; or acceleration"
    )
    smoothing: Time = Field(default=0.0, description="width of the kernel that rounds the corners; 0 leaves them sharp")

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        acceleration: Any = self.acceleration  # type: ignore[attr-defined]
        if self.record is None and acceleration is None:
            refuse([missing_one_of("record", "acceleration")])
        if self.record is not None and acceleration is not None:
            hint = "keep record or acceleration, not both"
            refuse([(("acceleration",), wrong("is given beside record", hint, mark="key"))])
        return self


def _flight(*, acceleration: Profile, smoothing: float = 0.0, **others: Any) -> flight.Flight:
    """The root accelerates as recorded or prescribed; the axes turn only as a record with body rates says."""
    return flight.Flight(acceleration=rounded(acceleration, smoothing), **others)


class Commands(Table):
    """The axis motions as the machine's controller takes them."""

    sample: Duration = Field(description="sample time of the controller")


class _Imitation(Table):
    """Keys of an imitation: of which flight, by which machine and how well."""

    tracks: str = Field(description="NAME of the flight motion that it imitates")
    machine: MachineName | None = optional(
        "an example machine, which gives arm, idle and limits where they are left out"
    )
    commands: Commands | None = optional("axis motions for the controller: { sample }")
    accept: Accept | None = optional("how well it must reproduce the flight: { tip, peaks }")

    @property
    def control_point_x(self) -> float:
        """The control point along x, m."""
        place: Any = self.control_point  # type: ignore[attr-defined]
        return float(place[0] if isinstance(place, tuple) else place)

    @property
    def limits_of_acceptance(self) -> dict[str, Any]:
        """Limits of [accept] by name, or empty without the table."""
        return {} if self.accept is None else self.accept.limits


def _hub(**arguments: Any) -> hub.Hub:
    """A rigid hub that turns about z, the specimen on its rim: with a prescribed rate, or free under a torque."""
    if not {"rate", "torque"} & arguments.keys():
        raise InputError("", "rate or torque is missing", "add one of them: rate = ... or torque = ...")
    return hub.Hub(**arguments)


AxisLimit = read_as(limits.AxisLimit, table_of(limits.AxisLimit))
Limits = read_as(limits.MachineLimits, table_of(limits.MachineLimits, name="Limits"))
Sensor = table_of(_Sensor)
Flight = table_of(
    _flight, flight.Flight, name="Flight", tag=("kind", "flight"), base=_Source, without={"x", "y", "z", "rates"}
)
Hub = table_of(_hub, hub.Hub, name="Hub", tag=("kind", "hub"), without={"turn", "control_point", "standard"})
_POINT = "point of the specimen that feels the flight's load, from the root: along x, or [x, y, z]"
Centrifuge = table_of(
    centrifuge.Centrifuge,
    tag=("kind", "centrifuge"),
    base=_Imitation,
    without={"flight", "span"},
    changed={
        "control_point": (ControlPoint, Field(description=_POINT)),
        "limits": (
            Limits,
            Field(
                default_factory=Limits, description="what the machine can do: { axis1, axis2, axis3, inertia, power }"
            ),
        ),
    },
)
Motion = chosen("kind", {"flight": Flight, "centrifuge": Centrifuge, "hub": Hub, "arm": Arm})
