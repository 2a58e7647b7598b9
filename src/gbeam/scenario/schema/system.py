"""[bodies], [joints], [forces], [controllers] and [system]: a tree of bodies in place of one beam."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from gbeam.errors import InputError
from gbeam.mechanics.tree import point_force, system
from gbeam.scenario.bodies import BODIES
from gbeam.scenario.schema.declared import chosen, table_of
from gbeam.scenario.schema.fields import Loc, Name, refuse, wrong
from gbeam.scenario.schema.scenario import Environments, Titled


def _kind(body: Any) -> str | None:
    """Kind of a body, by the key that it is known by where it is not written."""
    if not isinstance(body, Mapping):
        return getattr(body, "kind", None)
    by_key = (name for name, kind in BODIES.items() if kind.known_by and kind.known_by in body)
    kind = body.get("kind", next(by_key, None))
    return kind if kind is None or isinstance(kind, str) else str(kind)


def _point_force(**arguments: Any) -> point_force.PointForce:
    """A force and a moment on a point, such as thrust."""
    if not {"force", "moment"} & arguments.keys():
        fix = 'give force or moment, such as force = { z = "5 N" }, or { z = 0 } where a controller drives it'
        raise InputError("", "the force is missing", fix)
    return point_force.PointForce(**arguments)


if TYPE_CHECKING:  # type checkers make no tables
    Body = Any
    Controller = Any
    Force = Any
    JointTable = Any
    Surroundings = Any
else:
    from gbeam.scenario.schema.control import Controller
    from gbeam.scenario.schema.joints import JointTable

    Body = chosen("kind", {name: body_kind.table for name, body_kind in BODIES.items()}, _kind)
    Force = table_of(_point_force, point_force.PointForce, name="PointForce")
    Surroundings = table_of(system.System, name="Surroundings", without={"bodies", "joints", "forces", "controllers"})


class Tree(Titled):
    """Bodies and what joins them."""

    bodies: dict[Name, Body] = Field(
        min_length=1,
        description="bodies, each [bodies.NAME]: instead of [beam] and [model]; one alone, without joints, is a "
        "specimen on the moving base",
    )
    joints: dict[Name, JointTable] = Field(
        description="[joints.NAME]: one for every body, which holds it by its root, and more of points, "
        "which close loops"
    )
    forces: dict[Name, Force] = Field(
        default_factory=dict, description="forces and moments on points, each [forces.NAME]"
    )
    controllers: dict[Name, Controller] = Field(
        default_factory=dict, description="controllers in the loop, each [controllers.NAME]"
    )
    system: Surroundings = Field(default_factory=Surroundings, description="what acts on all bodies")


def _stations(scenario: Environments) -> Iterator[tuple[Loc, PydanticCustomError]]:
    """Error of stations that are not given to the beam that they are of."""
    if scenario.response.stations is not None:
        hint = "give them to a beam: [bodies.NAME] stations = [...]; other output is at the points of the bodies"
        yield ("response", "stations"), wrong("is given beside bodies", hint, mark="key")


_BESIDE = {
    "beam": 'give the beam as a body: [bodies.NAME] with kind = "beam"',
    "model": "give each beam its own: [bodies.NAME.model]",
}


class SystemScenario(Environments, Tree):
    """A validated scenario of a system of bodies: SI floats throughout, frozen."""

    @model_validator(mode="before")
    @classmethod
    def _refuse_mixed_tables(cls, data: Any) -> Any:
        names = [name for name in _BESIDE if isinstance(data, dict) and name in data and "bodies" in data]
        refuse([((name,), wrong("is given beside bodies", _BESIDE[name], mark="key")) for name in names])
        return data

    def about_structure(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of keys that a system must not have or lacks."""
        yield from _stations(self)


class _Specimen(Titled):
    bodies: dict[Name, Body] = Field(
        min_length=1, max_length=1, description="the specimen on the moving base, [bodies.NAME]"
    )


class SpecimenScenario(Environments, _Specimen):
    """A validated scenario of one body alone on the moving base: SI floats throughout, frozen."""

    @property
    def specimen(self) -> tuple[str, Any]:
        """Name and table of the body."""
        return next(iter(self.bodies.items()))

    def about_structure(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of keys that are of a beam only."""
        yield from _stations(self)
