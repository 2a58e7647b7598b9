"""A kind of body: its table and its builders; and parts that several of these tables share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, get_args

import numpy as np
from pydantic import Discriminator, Field, StrictInt, Tag

from gbeam.guards.limits import ENTRIES
from gbeam.guards.quantities import MomentOfInertia, Quantity
from gbeam.mechanics.tree.rigid_body import Place
from gbeam.scenario.schema.declared import chosen, object_of, table_of
from gbeam.scenario.schema.fields import Place3, Table


class BodyKind(NamedTuple):
    """A kind of body.

    `table` names the kind in its ``kind``, which may be left out beside the key `known_by`. `build` makes the body of a
    system from the collector of errors, the path and the table; `alone` the specimen alone on a base, where that is
    another object.
    """

    table: type[Table]
    build: Callable[[Any, str, Any], Any] = object_of
    alone: Callable[[Any, str, Any], Any] | None = None
    known_by: str = ""

    @property
    def name(self) -> str:
        """Name of the kind."""
        return str(get_args(self.table.model_fields["kind"].annotation)[0])


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


PlaceOfBody = table_of(Place, name="PlaceOfBody")


def placed(point: Any) -> str:
    if isinstance(point, (Mapping, PlaceOfBody)):
        return "table"
    return "list" if isinstance(point, (list, tuple)) else "one"


if TYPE_CHECKING:  # type checkers make no tables
    Point = Any
else:
    Point = chosen("kind", {"list": Place3, "table": PlaceOfBody}, placed)
NodePoints = Annotated[dict[str, StrictInt], Field(max_length=ENTRIES)]


def inertia_of(moments: Any) -> Any:
    """Inertia tensor (3, 3) from principal moments or three rows."""
    return np.diag(moments) if np.ndim(moments) == 1 else np.asarray(moments, dtype=float)
