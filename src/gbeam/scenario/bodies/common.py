"""A kind of body: its table and its builders; and parts that several of these tables share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, NamedTuple, get_args

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, StrictInt, Tag

from gbeam.guards.limits import ENTRIES, NAME
from gbeam.mechanics.tree.joints import GROUND
from gbeam.printable import shortened
from gbeam.scenario.schema.fields import MomentOfInertia, Place3, Quantity, Ratio, Ratios, Table, Turn3, wrong


class BodyKind(NamedTuple):
    """A kind of body.

    `table` names the kind in its ``kind``, which may be left out beside the key `known_by`. `build` makes the body of a
    system from the collector of errors, the path and the table; `alone` the specimen alone on a base, where that is
    another object.
    """

    table: type[Table]
    build: Callable[[Any, str, Any], Any]
    alone: Callable[[Any, str, Any], Any] | None = None
    known_by: str = ""

    @property
    def name(self) -> str:
        """Name of the kind."""
        return str(get_args(self.table.model_fields["kind"].annotation)[0])


def _named(name: str) -> str:
    if not name.isidentifier() or not name.isascii() or len(name) > NAME or name == GROUND:
        raise wrong(f"{shortened(repr(name))} is not a name", "give letters, digits and underscores", mark="key")
    return name


Name = Annotated[str, AfterValidator(_named)]
Direction = tuple[Ratio, Ratio, Ratio]
_Count = Annotated[StrictInt, Field(ge=1, le=1000)]
_Row = tuple[
    Annotated[float, Quantity("moment of inertia")],
    Annotated[float, Quantity("moment of inertia")],
    Annotated[float, Quantity("moment of inertia")],
]


def _rows(value: Any) -> str:
    return "list" if isinstance(value, (list, tuple)) and value and isinstance(value[0], (list, tuple)) else "one"


Inertia = Annotated[
    Annotated[tuple[MomentOfInertia, MomentOfInertia, MomentOfInertia], Tag("one")]
    | Annotated[tuple[_Row, _Row, _Row], Tag("list")],
    Discriminator(_rows),
]


class PlaceOfBody(Table):
    """A named point of a rigid body, or of a mesh at the nearest node, with axes."""

    at: Place3 = Field(default=(0.0, 0.0, 0.0), description="place from the body's root, in its axes: [x, y, z]")
    turn: Turn3 = Field(
        default=(0.0, 0.0, 0.0), description="rotation vector of the point's axes in those of the root: [x, y, z]"
    )


def placed(point: Any) -> str:
    if isinstance(point, (Mapping, PlaceOfBody)):
        return "table"
    return "list" if isinstance(point, (list, tuple)) else "one"


Point = Annotated[Annotated[Place3, Tag("list")] | Annotated[PlaceOfBody, Tag("table")], Discriminator(placed)]
NodePoints = Annotated[dict[str, StrictInt], Field(max_length=ENTRIES)]


class Reduced(Table):
    """Keys of what is reduced to modes."""

    modes: _Count = Field(default=10, description="number of modes; up to twelve static shapes come on top")
    damping_ratio: Ratios = Field(
        description="of critical damping, of all, or a list with one for each mode; static shapes have the last one's"
    )


def points_of(table: Any) -> dict[str, Any]:
    """Points of a body by name: tables as places with axes, groups and places unchanged."""
    from gbeam.mechanics.tree.rigid_body import Place

    return {
        name: Place(each.at, each.turn) if isinstance(each, PlaceOfBody) else each
        for name, each in table.points.items()
    }


def inertia_of(moments: Any) -> Any:
    """Inertia tensor (3, 3) from principal moments or three rows."""
    return np.diag(moments) if np.ndim(moments) == 1 else np.asarray(moments, dtype=float)
