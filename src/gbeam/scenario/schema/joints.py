"""[joints.NAME]: tables that follow from the kinds of joint that there are.

By the names of a kind's coordinates they know which are displacements and which are angles, and so the units of
everything about them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, create_model

from gbeam.guards.parameters import Parameter, alternatives, parameters_of
from gbeam.guards.quantities import Quantity, Shape
from gbeam.mechanics.tree.joints import (
    COUPLINGS,
    GROUND,
    JOINT_KINDS,
    OF_COORDINATES,
    SLIDES,
    Joint,
    Kind,
    kind_of_value,
)
from gbeam.motion.profiles.profile import Profile
from gbeam.scenario.schema.declared import OVER_TIME, chosen, makes
from gbeam.scenario.schema.fields import Direction, Place3, Table, Turn3, fields_of, optional

_PARAMETERS = parameters_of(Joint)


def _value_type(parameter: Parameter, coordinate: str) -> Any:
    """Type of what a parameter of joints says of a coordinate: a number, several, or a profile over time."""
    kind, mark = kind_of_value(parameter.name, coordinate), parameter.of_coordinate
    if Profile in alternatives(parameter.hint):
        return OVER_TIME[kind]
    number = Annotated[float, Quantity(kind, mark.sign if mark else "any")]
    shape = next((mark for mark in parameter.hint.__metadata__ if isinstance(mark, Shape)), None)
    return number if shape is None else tuple.__class_getitem__((number,) * shape.sizes[0])


class Coordinates(Table):
    """Values by the names of a joint's coordinates."""

    model_config = ConfigDict(json_schema_extra={"x-coordinates": True})


def _by_coordinate(table: type[Table]) -> Callable[..., dict[str, Any]]:
    """Return a function from the values of a table by coordinate to the argument of a joint."""
    keys = dict(zip(table.model_fields, fields_of(table), strict=True))
    return lambda **values: {keys[name]: value for name, value in values.items()}


def _table(base: type[Table], name: str, about: str, fields: Mapping[str, Any]) -> Any:
    """Create a table with these fields, and make it a name of this module, by which it is pickled."""
    table = create_model(name, __base__=base, __module__=__name__, __doc__=about, **dict(fields))
    globals()[name] = table
    return makes(table, Joint if base is Table else _by_coordinate(table))


def _optional(of: Any, description: str) -> tuple[Any, Any]:
    return (of | None, optional(description))


def _joint(name: str, kind: Kind) -> Any:
    """Table of a kind of joint. Values are written plainly for one coordinate, in tables by name for several."""
    fields = _placed(name, kind)
    for key in OF_COORDINATES:
        parameter, coordinates = _PARAMETERS[key], kind.names_in(key)
        words = parameter.words
        by_coordinate = {coordinate: _optional(_value_type(parameter, coordinate), words) for coordinate in coordinates}
        if len(coordinates) == 1:
            fields[key] = by_coordinate[coordinates[0]]
        elif coordinates:
            about = f"{words[0].upper()}{words[1:]}, by coordinate."
            table = _table(Coordinates, _title(name, key), about, by_coordinate)
            fields[key] = _optional(table, f"{words}: {{ {', '.join(coordinates)} }}")
    if len(kind.value_names) > 1:
        fields["coupling"] = _coupling(name, kind)
    return _table(Table, name.title(), f"{kind.words[0].upper()}{kind.words[1:]}.", fields)


def _placed(name: str, kind: Kind) -> dict[str, Any]:
    """Keys of a kind of joint that say between which bodies it is, and where."""
    words = {key: parameter.words for key, parameter in _PARAMETERS.items()}
    fields: dict[str, Any] = {
        "kind": (Literal[name], Field(description="kind of the joint")),
        "body": (str, Field(description=words["body"])),
        "on": (str, Field(default=GROUND, description=words["on"])),
    }
    if kind.axes:
        vectors = ", ".join(["[x, y, z]"] * kind.axes)
        second = ", the second as it stands at a first angle of zero" if kind.axes > 1 else ""
        directions = Annotated[tuple[Direction, ...], Field(min_length=kind.axes, max_length=kind.axes)]
        fields["axes"] = (directions, Field(description=f"directions in axes of the point{second}: [{vectors}]"))
    fields["at"] = (Place3, Field(default=(0.0, 0.0, 0.0), description=words["at"]))
    fields["turn"] = (Turn3, Field(default=(0.0, 0.0, 0.0), description=words["turn"]))
    return fields


def _coupling(name: str, kind: Kind) -> tuple[Any, Any]:
    """Key of stiffnesses between two coordinates of a kind of joint, by both names."""
    words = _PARAMETERS["coupling"].words
    fields = {}
    for one, two in combinations(kind.value_names, 2):
        slides = (one in SLIDES) + (two in SLIDES)
        number = Annotated[float, Quantity(COUPLINGS[slides])] | None
        fields[f"{one}_{two}"] = (number, optional(words, alias=f"{one}-{two}"))
    table = _table(Coordinates, _title(name, "coupling"), "Coupling, by two coordinates.", fields)
    first = "-".join(kind.value_names[:2])
    return _optional(table, f"{words} that have springs, by both names: {{ {first}, ... }}")


def _title(joint: str, key: str) -> str:
    """Name of the table of a key of a joint, such as RevoluteStiffness."""
    return f"{joint}_{key}".title().replace("_", "")


_JOINTS = [_joint(name, kind) for name, kind in JOINT_KINDS.items()]
JointTable = chosen("kind", dict(zip(JOINT_KINDS, _JOINTS, strict=True)))
