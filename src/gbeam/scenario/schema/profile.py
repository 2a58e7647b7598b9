"""Profiles: a quantity in time. What it is a quantity of, and so its units, depends on where it stands."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Generic, Literal, TypeVar, get_args

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
    Jerk,
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


_PROFILES: dict[str, Any] = {
    "constant": Constant, "trapezoid": Trapezoid, "smooth-step": SmoothStep, "sine": Sine, "table": Listed, "sum": Sum,
}  # fmt: skip


def _profile(level: Any, rate: Any) -> Any:
    """Type of a profile of a quantity that has a rate of change."""
    return Annotated[reduce(or_, (each[level, rate] for each in _PROFILES.values())), Discriminator("profile")]


def _over_time(level: Any, rate: Any) -> Any:
    """Type of a quantity, which is then constant, or of a profile of it."""
    profiles = (Annotated[each[level, rate], Tag(name)] for name, each in _PROFILES.items())
    return Annotated[reduce(or_, profiles, Annotated[level, Tag("one")]), Discriminator(_constant_or_profile)]


def _constant_or_profile(value: Any) -> Any:
    """Tag of a value: a table's profile, or ``one`` for a bare quantity, which is constant."""
    return value.get("profile") if isinstance(value, dict) else getattr(value, "profile", "one")


if TYPE_CHECKING:  # type checkers call no functions
    AccelerationProfile = Any
    RateProfile = Any
    TorqueProfile = Any
    ForceOverTime = Any
    MomentOverTime = Any
    SpreadForceOverTime = Any
else:
    AccelerationProfile = _profile(Acceleration, Jerk)
    RateProfile = _profile(AngularRate, AngularAcceleration)
    TorqueProfile = _profile(Torque, TorqueRate)
    ForceOverTime = _over_time(Force, ForceRate)
    MomentOverTime = _over_time(Torque, TorqueRate)
    SpreadForceOverTime = _over_time(ForcePerLength, ForcePerLengthRate)
