"""[[beam.loads]]: forces and moments on the beam."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field, StrictBool, model_validator
from pydantic_core import PydanticCustomError

from gbeam.scenario.schema.common.fields import Loc, Position, Table, refuse, wrong
from gbeam.scenario.schema.profile import ForceOverTime, MomentOverTime, SpreadForceOverTime


class _Vector(Table):
    @model_validator(mode="after")
    def _any(self) -> _Vector:
        if all(getattr(self, axis) is None for axis in "xyz"):
            refuse([((), wrong("has no component", "give one or more of x, y and z"))])
        return self


class Forces(_Vector):
    """A force by components, each a quantity or a profile; those left out are zero."""

    x: ForceOverTime | None = Field(default=None, description="component along the beam")
    y: ForceOverTime | None = Field(default=None, description="component along the width")
    z: ForceOverTime | None = Field(default=None, description="component through the thickness")


class LoadMoments(_Vector):
    """A moment by components, each a quantity or a profile; those left out are zero."""

    x: MomentOverTime | None = Field(default=None, description="moment about x, along the beam")
    y: MomentOverTime | None = Field(default=None, description="moment about y: positive bends the tip to -z")
    z: MomentOverTime | None = Field(default=None, description="moment about z: positive bends the tip to +y")


class SpreadForces(_Vector):
    """A force per length by components, each a quantity or a profile; those left out are zero."""

    x: SpreadForceOverTime | None = Field(default=None, description="component along the beam")
    y: SpreadForceOverTime | None = Field(default=None, description="component along the width")
    z: SpreadForceOverTime | None = Field(default=None, description="component through the thickness")


class Load(Table):
    """A force, a moment or both at a station; or a force spread evenly over the length."""

    at: Position | None = Field(default=None, description="position from the root, along the beam")
    force: Forces | None = Field(default=None, description="force at the station: { x, y, z }")
    moment: LoadMoments | None = Field(default=None, description="moment at the station: { x, y, z }")
    distributed: SpreadForces | None = Field(
        default=None, description="force per length over the whole beam: { x, y, z }; instead of at, force and moment"
    )
    follower: StrictBool = Field(
        default=False,
        description="true if the components turn with the section; false if they keep to the base axes",
    )

    @model_validator(mode="after")
    def _one_kind(self) -> Load:
        def problems() -> Iterator[tuple[Loc, PydanticCustomError]]:
            point = [name for name in ("at", "force", "moment") if getattr(self, name) is not None]
            if self.distributed is not None:
                for name in point:
                    yield (name,), wrong("is given beside distributed", "make two loads of them", mark="key")
            elif self.force is None and self.moment is None:
                hint = 'give force, moment or distributed, such as force = { z = "5 N" }'
                yield (), wrong("the load is missing", hint)
            elif self.at is None:
                yield (), wrong("at is missing", 'say where the load acts: at = "300 mm"', mark="key")

        refuse(problems())
        return self
