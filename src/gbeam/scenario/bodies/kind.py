"""A kind of body: its table in a scenario, and the objects of the core that it makes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

if TYPE_CHECKING:
    from pydantic_core import PydanticCustomError

    from gbeam.scenario.schema.fields import Loc, Table


class BodyKind(NamedTuple):
    """A kind of body.

    It has the table, with the name of the kind in ``kind``; a builder of the body of a system, by the collector of
    errors, the place and the table; one of the specimen alone on a base, where that is another object; the key
    beside which ``kind`` may be left out; and the errors of a table that is one body among others.
    """

    table: type[Table]
    build: Callable[[Any, str, Any], Any]
    alone: Callable[[Any, str, Any], Any] | None = None
    known_by: str = ""
    among: Callable[[Any], Iterable[tuple[Loc, PydanticCustomError]]] = lambda table: ()

    @property
    def name(self) -> str:
        """Name of the kind."""
        return str(get_args(self.table.model_fields["kind"].annotation)[0])
