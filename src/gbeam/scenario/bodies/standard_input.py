"""A flexible body of standard input data."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from gbeam.errors import naming
from gbeam.mechanics.structure import Structure
from gbeam.scenario.bodies.common import BodyKind, NodePoints
from gbeam.scenario.schema.declared import table_of
from gbeam.scenario.schema.fields import File
from gbeam.solids.standard_input import read_sid


def _body(*, standard_input_data: str, **options: Any) -> Structure:
    """A flexible body of standard input data, as multibody programs exchange them."""
    with naming({"path": "standard_input_data"}):
        return read_sid(standard_input_data, **options)


_FILE = "file of the body's modal object, in SI; relative to the folder of the scenario file"
BODY = BodyKind(
    table_of(
        _body,
        read_sid,
        name="StandardInputBody",
        tag=("kind", "standard-input-data"),
        known=True,
        without={"path", "kind"},
        changed={
            "standard_input_data": (File, Field(description=_FILE)),
            "points": (NodePoints, Field(default_factory=dict, description="numbers of nodes of output by name")),
        },
    ),
    known_by="standard_input_data",
)
