"""[joints.NAME]: tables that follow from the kinds of joint that there are.

By the names of a kind's coordinates they know which are displacements and which are angles, and so the units of
everything about them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import combinations
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, create_model

from gbeam.guards.quantities import Quantity, Sign
from gbeam.mechanics.tree.equations import SLIP, SLIPS
from gbeam.mechanics.tree.joints import COUPLINGS, GROUND, JOINT_KINDS, SLIDES, Joint, Kind, kind_of_value
from gbeam.scenario.schema.declared import OVER_TIME, chosen, makes
from gbeam.scenario.schema.fields import Direction, Place3, Table, Turn3, fields_of, optional


def _number(kind: str, sign: Sign = "any") -> Any:
    return Annotated[float, Quantity(kind, sign)]


_size = partial(_number, sign="zero or more")


def _pair(kind: str) -> Any:
    return tuple.__class_getitem__((_number(kind), _number(kind)))


# By key about coordinates: a function from the kind of quantity to the type of its value, and its words.
_ABOUT: dict[str, tuple[Callable[[str], Any], str]] = {
    "initial": (_number, "coordinate at the start"),
    "initial_rate": (_number, "rate at the start"),
    "stiffness": (_size, "spring"),
    "ease": (_number, "coordinate at which the spring has no force"),
    "damping": (_size, "damper"),
    "friction": (
        _size,
        f"Coulomb friction, times tanh(rate/{SLIP:g}), the rate in m/s or rad/s: less below {' and '.join(SLIPS)}, so "
        "that what it holds creeps",
    ),
    "stops": (_pair, "lowest and highest coordinate, at which stops begin to give way"),
    "stop_stiffness": (_size, "stiffness of the stops"),
    "rate": (OVER_TIME.__getitem__, "prescribed rate, instead of effort: a quantity or a profile"),
    "effort": (OVER_TIME.__getitem__, "force or torque of a drive: a quantity or a profile"),
}


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
    """Table of a kind of joint; values are written plainly for one coordinate, in tables by name for several."""
    fields = _placed(name, kind)
    for key, (type_of, words) in _ABOUT.items():
        coordinates = kind.names_in(key)
        kinds = {coordinate: kind_of_value(key, coordinate) for coordinate in coordinates}
        by_coordinate = {coordinate: _optional(type_of(kinds[coordinate]), words) for coordinate in coordinates}
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
    hung = 'what it hangs on: "ground", or a point of a body, such as "bus.left"; "bus.root" is its root'
    turn = "rotation vector of the body's root axes in those of the point, where all coordinates are zero: [x, y, z]"
    fields: dict[str, Any] = {
        "kind": (Literal[name], Field(description="kind of the joint")),
        "body": (str, Field(description="NAME of the body that it holds, by its root")),
        "on": (str, Field(default=GROUND, description=hung)),
    }
    if kind.axes:
        vectors = ", ".join(["[x, y, z]"] * kind.axes)
        second = ", the second as it stands at a first angle of zero" if kind.axes > 1 else ""
        directions = Annotated[tuple[Direction, ...], Field(min_length=kind.axes, max_length=kind.axes)]
        fields["axes"] = (directions, Field(description=f"directions in axes of the point{second}: [{vectors}]"))
    fields["at"] = (Place3, Field(default=(0.0, 0.0, 0.0), description="place of the joint from the point: [x, y, z]"))
    fields["turn"] = (Turn3, Field(default=(0.0, 0.0, 0.0), description=turn))
    return fields


def _coupling(name: str, kind: Kind) -> tuple[Any, Any]:
    """Key of stiffnesses between two coordinates of a kind of joint, by both names."""
    words = "stiffness between two coordinates"
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
