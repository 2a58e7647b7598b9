"""A flexible body of standard input data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from gbeam.errors import naming
from gbeam.scenario.bodies.common import BodyKind, NodePoints
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.fields import File, Ratios, Table, optional

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure


class StandardInputBody(Table):
    """A flexible body of standard input data, as multibody programs exchange them."""

    kind: Literal["standard-input-data"] = Field(
        default="standard-input-data", description="kind of the body; may be left out beside standard_input_data"
    )
    standard_input_data: File = Field(
        description="file of the body's modal object, in SI; relative to the folder of the scenario file"
    )
    damping_ratio: Ratios | None = optional("of critical damping, in place of the damping in the file")
    points: NodePoints = Field(default_factory=dict, description="numbers of nodes of output by name")


def _body(parts: Collector, where: str, table: StandardInputBody) -> Structure | None:
    """Structure from standard input data; None if they are refused."""
    from gbeam.solids.standard_input import read_sid

    def model() -> Structure:
        with naming({"path": "standard_input_data"}):
            return read_sid(table.standard_input_data, damping_ratio=table.damping_ratio, points=table.points)

    return parts.attempt(where, model)


BODY = BodyKind(StandardInputBody, _body, known_by="standard_input_data")
