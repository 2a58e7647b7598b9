"""A measured flight in a file: which columns, in which units and axes, and which part of it is flown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Field, Tag

from gbeam.motion.records.instrument import Instrument
from gbeam.motion.records.parameters import Conditioning, Rates
from gbeam.motion.records.record import Recording
from gbeam.motion.records.rest import Rest as _Rest
from gbeam.scenario.schema.declared import read_as, table_of
from gbeam.scenario.schema.fields import File

read_as(_Rest, table_of(_Rest))
PART = ("from_", "to", "section")  # of a record, that one flight flies
GROUPS = (Rates, Instrument, Conditioning)  # of a record's keys

Record = table_of(
    Recording.read,
    Recording.read,
    *GROUPS,
    Recording.flight,
    name="Record",
    about="A measured flight: a file of named columns.",
    without={"rates", "conditioning", "instrument"},
    optional={"time", "p", "q", "r", "rate_unit"},
    types={"file": File},
)
PartOfRecord = table_of(
    Recording.flight,
    name="PartOfRecord",
    about="Another part of the record of another flight, whose file is read once and whose keys hold for both.",
    changed={"of": (str, Field(description="NAME of the flight that has the record itself"))},
)


def _source(value: Any) -> str:
    """Tag of a record: ``part`` of one that names another flight's."""
    return "part" if isinstance(value, PartOfRecord) or (isinstance(value, dict) and "of" in value) else "file"


if TYPE_CHECKING:  # type checkers make no tables
    RecordOrPart = Any
else:
    RecordOrPart = Annotated[
        Annotated[Record, Tag("file")] | Annotated[PartOfRecord, Tag("part")],
        Discriminator(_source),
    ]
