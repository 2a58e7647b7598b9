"""A beam as a body."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Any

from pydantic import Field

from gbeam.errors import placing_within
from gbeam.guards.quantities import Position
from gbeam.mechanics.assembly import assemble
from gbeam.mechanics.structure import Structure
from gbeam.scenario.bodies.common import BodyKind
from gbeam.scenario.schema.beam import Model, beam_of
from gbeam.scenario.schema.declared import table_of
from gbeam.structure.beam import Beam


def _body(
    *,
    model: Callable[[Beam], Any],
    stations: Annotated[
        Sequence[Position], "positions from the root of sections with loads and stress, beside those of its points"
    ] = (),
    **arguments: Any,
) -> Structure:
    """A beam as a body: the keys of [beam], and its model. Its points are its named ones, tip and root."""
    beam = beam_of(**arguments)
    with placing_within("model"):
        chosen = model(beam)
    return assemble(beam, chosen, stations)


_MODEL = Field(description="the model of its deformation: { kind, modes, shapes }")
BODY = BodyKind(
    table_of(
        _body,
        Beam,
        _body,
        name="BeamBody",
        tag=("kind", "beam"),
        optional={"length"},
        changed={"model": (Model, _MODEL)},
    )
)
