"""A beam as a body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from gbeam.scenario.bodies.common import BodyKind
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.beam import Beam
from gbeam.scenario.schema.fields import Position, listed
from gbeam.scenario.schema.scenario import Model

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure


class BeamBody(Beam):
    """A beam as a body: the keys of [beam], and its model. Its points are its named ones, tip and root."""

    kind: Literal["beam"] = Field(description="kind of the body")
    model: Model = Field(description="the model of its deformation: { kind, modes, shapes }")
    stations: tuple[Position, ...] = listed(
        "positions from the root of sections with loads and stress, beside those of its points"
    )


def _body(parts: Collector, where: str, table: BeamBody) -> Structure | None:
    from gbeam.mechanics.assembly import assemble
    from gbeam.scenario.build_beam import beam_of, model_of

    beam = beam_of(parts, where, table)
    model = model_of(parts, f"{where}.model", table.model, beam)
    return None if beam is None or model is None else parts.attempt(where, assemble, beam, model, table.stations)


BODY = BodyKind(BeamBody, _body)
