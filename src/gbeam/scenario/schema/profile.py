"""Profiles: a quantity in time. What it is a quantity of, and so its units, depends on where it stands."""

from __future__ import annotations

from typing import Annotated, Any, Generic, Literal, TypeVar, get_args

from pydantic import ConfigDict, Discriminator, Field, Tag

from gbeam.scenario.schema.fields import (
    Acceleration,
    AngularAcceleration,
    AngularRate,
    Duration,
    Force,
    ForcePerLength,
    ForcePerLengthRate,
    ForceRate,
    Growth,
    Jerk,
    Speed,
    Table,
    Time,
    Torque,
    TorqueRate,
)

L = TypeVar("L")  # the quantity itself
S = TypeVar("S")  # its rate of change


def _described(schema: dict[str, Any], model: type[Any]) -> None:
    """Describe a profile of one quantity by the words of the profile of any, which pydantic leaves out."""
    origin = model.__pydantic_generic_metadata__["origin"]
    schema.setdefault("description", (origin or model).__doc__)


class Smoothed(Table, Generic[L, S]):
    """Common keys of profiles."""

    model_config = ConfigDict(json_schema_extra=_described)

    smoothing: Time = Field(
        default=0.0, description="width of the kernel that rounds the profile's corners; 0 leaves them sharp"
    )

    @classmethod
    def model_parametrized_name(cls, params: tuple[Any, ...]) -> str:
        """Name the class in the JSON schema: ``Trapezoid of acceleration``."""
        quantity = get_args(params[0])
        return f"{cls.__name__} of {quantity[1].kind}" if len(quantity) > 1 else cls.__name__


class Constant(Smoothed[L, S], Generic[L, S]):
    """A constant value."""

    profile: Literal["constant"] = Field(description="name of the profile")
    level: L = Field(description="value")


class Trapezoid(Smoothed[L, S], Generic[L, S]):
    """Up at a constant rate, a plateau, down at the same rate."""

    profile: Literal["trapezoid"] = Field(description="name of the profile")
    level: L = Field(description="value of the plateau")
    jerk: S = Field(description="rate of change on the flanks, as a magnitude")
    start: Time = Field(description="time at which the rise begins")
    hold: Time = Field(description="duration of the plateau")


class SmoothStep(Smoothed[L, S], Generic[L, S]):
    """From zero to a level without a kink, 2009 (43)."""

    profile: Literal["smooth-step"] = Field(description="name of the profile")
    level: L = Field(description="value at the end")
    duration: Duration = Field(description="duration of the rise")
    start: Time = Field(default=0.0, description="time at which the rise begins")


class Sine(Smoothed[L, S], Generic[L, S]):
    """One period of a sine, then zero, 2009 (44)."""

    profile: Literal["sine"] = Field(description="name of the profile")
    amplitude: L = Field(description="amplitude")
    duration: Duration = Field(description="duration of the one period")


class Listed(Smoothed[L, S], Generic[L, S]):
    """Values at times, linear in between."""

    profile: Literal["table"] = Field(description="name of the profile")
    times: tuple[Time, ...] = Field(min_length=2, description="times, increasing")
    values: tuple[L, ...] = Field(min_length=2, description="one value per time")


class Sum(Smoothed[L, S], Generic[L, S]):
    """The sum of other profiles."""

    profile: Literal["sum"] = Field(description="name of the profile")
    terms: tuple[
        Annotated[
            Constant[L, S] | Trapezoid[L, S] | SmoothStep[L, S] | Sine[L, S] | Listed[L, S],
            Discriminator("profile"),
        ],
        ...,
    ] = Field(min_length=1, description="the profiles that are added")


# Written out: a generic alias of a union of pydantic models loses its parameters, and of models that a function makes
# of a generic one none can be pickled.
AccelerationProfile = Annotated[
    Constant[Acceleration, Jerk]
    | Trapezoid[Acceleration, Jerk]
    | SmoothStep[Acceleration, Jerk]
    | Sine[Acceleration, Jerk]
    | Listed[Acceleration, Jerk]
    | Sum[Acceleration, Jerk],
    Discriminator("profile"),
]
RateProfile = Annotated[
    Constant[AngularRate, AngularAcceleration]
    | Trapezoid[AngularRate, AngularAcceleration]
    | SmoothStep[AngularRate, AngularAcceleration]
    | Sine[AngularRate, AngularAcceleration]
    | Listed[AngularRate, AngularAcceleration]
    | Sum[AngularRate, AngularAcceleration],
    Discriminator("profile"),
]
TorqueProfile = Annotated[
    Constant[Torque, TorqueRate]
    | Trapezoid[Torque, TorqueRate]
    | SmoothStep[Torque, TorqueRate]
    | Sine[Torque, TorqueRate]
    | Listed[Torque, TorqueRate]
    | Sum[Torque, TorqueRate],
    Discriminator("profile"),
]


def _constant_or_profile(value: Any) -> Any:
    """Tag of a value: a table's profile, or ``one`` for a bare quantity, which is constant."""
    return value.get("profile") if isinstance(value, dict) else getattr(value, "profile", "one")


ForceOverTime = Annotated[
    Annotated[Force, Tag("one")]
    | Annotated[Constant[Force, ForceRate], Tag("constant")]
    | Annotated[Trapezoid[Force, ForceRate], Tag("trapezoid")]
    | Annotated[SmoothStep[Force, ForceRate], Tag("smooth-step")]
    | Annotated[Sine[Force, ForceRate], Tag("sine")]
    | Annotated[Listed[Force, ForceRate], Tag("table")]
    | Annotated[Sum[Force, ForceRate], Tag("sum")],
    Discriminator(_constant_or_profile),
]
MomentOverTime = Annotated[
    Annotated[Torque, Tag("one")]
    | Annotated[Constant[Torque, TorqueRate], Tag("constant")]
    | Annotated[Trapezoid[Torque, TorqueRate], Tag("trapezoid")]
    | Annotated[SmoothStep[Torque, TorqueRate], Tag("smooth-step")]
    | Annotated[Sine[Torque, TorqueRate], Tag("sine")]
    | Annotated[Listed[Torque, TorqueRate], Tag("table")]
    | Annotated[Sum[Torque, TorqueRate], Tag("sum")],
    Discriminator(_constant_or_profile),
]
SpreadForceOverTime = Annotated[
    Annotated[ForcePerLength, Tag("one")]
    | Annotated[Constant[ForcePerLength, ForcePerLengthRate], Tag("constant")]
    | Annotated[Trapezoid[ForcePerLength, ForcePerLengthRate], Tag("trapezoid")]
    | Annotated[SmoothStep[ForcePerLength, ForcePerLengthRate], Tag("smooth-step")]
    | Annotated[Sine[ForcePerLength, ForcePerLengthRate], Tag("sine")]
    | Annotated[Listed[ForcePerLength, ForcePerLengthRate], Tag("table")]
    | Annotated[Sum[ForcePerLength, ForcePerLengthRate], Tag("sum")],
    Discriminator(_constant_or_profile),
]
SpeedOverTime = Annotated[
    Annotated[Speed, Tag("one")]
    | Annotated[Constant[Speed, Growth], Tag("constant")]
    | Annotated[Trapezoid[Speed, Growth], Tag("trapezoid")]
    | Annotated[SmoothStep[Speed, Growth], Tag("smooth-step")]
    | Annotated[Sine[Speed, Growth], Tag("sine")]
    | Annotated[Listed[Speed, Growth], Tag("table")]
    | Annotated[Sum[Speed, Growth], Tag("sum")],
    Discriminator(_constant_or_profile),
]
TurnOverTime = Annotated[
    Annotated[AngularRate, Tag("one")]
    | Annotated[Constant[AngularRate, AngularAcceleration], Tag("constant")]
    | Annotated[Trapezoid[AngularRate, AngularAcceleration], Tag("trapezoid")]
    | Annotated[SmoothStep[AngularRate, AngularAcceleration], Tag("smooth-step")]
    | Annotated[Sine[AngularRate, AngularAcceleration], Tag("sine")]
    | Annotated[Listed[AngularRate, AngularAcceleration], Tag("table")]
    | Annotated[Sum[AngularRate, AngularAcceleration], Tag("sum")],
    Discriminator(_constant_or_profile),
]
