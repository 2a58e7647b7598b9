"""Modes that were measured, or computed elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from gbeam.errors import InputError, naming
from gbeam.guards.limits import ENTRIES
from gbeam.scenario.bodies.common import BodyKind, Direction, NodePoints
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.fields import File, Mass, OneOrSome, Place3, Quantity, Ratios, Table, optional, refuse, wrong

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure
    from gbeam.solids.modal_test import ModalTest

_Frequencies = Annotated[
    tuple[Annotated[float, Quantity("frequency", "positive")], ...], Field(min_length=1, max_length=ENTRIES)
]
_Masses = OneOrSome[Mass]
_Shape = Annotated[tuple[Direction, ...], Field(max_length=ENTRIES)]
MEASURED = ("frequency", "damping_ratio", "shapes", "nodes", "modal_mass")


class ModalTestBody(Table):
    """Modes that were measured, or computed elsewhere: frequencies, damping and shapes on a base at rest."""

    kind: Literal["modal-test"] = Field(
        default="modal-test", description="kind of the body; may be left out beside modal_test"
    )
    modal_test: File | None = optional(
        "universal file (.uff, .unv) of the modes and the nodes; or frequency, damping_ratio, shapes, "
        "nodes and modal_mass. Relative to the folder of the scenario file"
    )
    frequency: _Frequencies | None = optional("natural frequencies, without a file")
    damping_ratio: Ratios | None = optional(
        "of critical damping, of every mode, or a list; beside a file in place of its own"
    )
    shapes: Annotated[tuple[_Shape, ...], Field(max_length=ENTRIES)] | None = optional(
        "displacements of the nodes in each mode, without a file: [ [ [x, y, z], ... ], ... ]"
    )
    nodes: Annotated[tuple[Place3, ...], Field(max_length=ENTRIES)] | None = optional(
        "places of the nodes from the root, without a file: [ [x, y, z], ... ]"
    )
    modal_mass: _Masses | None = optional(
        "that goes with the shapes, of every mode, or a list; beside a file in place of its own"
    )
    masses: _Masses = Field(
        description="share of the specimen's mass at the nodes, in the order of their numbers: a list, or one that all "
        "have"
    )
    points: NodePoints = Field(
        default_factory=dict, description="numbers of nodes of output by name; without a file from 0"
    )

    @model_validator(mode="after")
    def _one_way(self) -> ModalTestBody:
        written = [key for key in MEASURED if getattr(self, key) is not None]
        beside = [key for key in written if key in ("frequency", "shapes", "nodes")]
        if self.modal_test is not None and beside:
            refuse([((beside[0],), wrong("is given beside modal_test", "keep one of them", mark="key"))])
        missing = [key for key in MEASURED if key not in written]
        if self.modal_test is None and missing:
            hint = "give modal_test = FILE, or frequency, damping_ratio, shapes, nodes and modal_mass"
            refuse([((), wrong(f"{missing[0]} is missing", hint, mark="key"))])
        return self


def _body(parts: Collector, where: str, table: ModalTestBody) -> Structure | None:
    """Structure from measured modes; None if they are refused."""
    from gbeam.solids.modal_test import ModalTest

    def test() -> ModalTest:
        if table.modal_test is None:
            measured: dict[str, Any] = {key: getattr(table, key) for key in MEASURED}
            return ModalTest(**measured | {"shapes": _same_nodes(table.shapes, len(measured["nodes"]))})
        in_file = ModalTest.read(table.modal_test, modal_mass=table.modal_mass)
        return in_file if table.damping_ratio is None else replace(in_file, damping_ratio=table.damping_ratio)

    def model() -> Structure:
        with naming({"path": "modal_test"}):
            measured = test()
        count = len(np.asarray(measured.nodes))
        masses = np.full(count, table.masses) if np.ndim(table.masses) == 0 else table.masses
        try:
            return measured.structure(masses, points=table.points)
        except InputError as error:
            raise error.at(error.where.replace("mass", "masses", 1)) from None

    return parts.attempt(where, model)


def _same_nodes(shapes: Any, count: int) -> Any:
    """Shapes by mode (m, k, 3) as displacements of nodes (k, 3, m)."""
    for i, shape in enumerate(shapes):
        if len(shape) != count:
            fix = f"give {count} of [x, y, z]"
            raise InputError(f"shapes[{i}]", f"has {len(shape)} displacements for {count} nodes", fix)
    return np.moveaxis(np.asarray(shapes), 0, -1)


BODY = BodyKind(ModalTestBody, _body, known_by="modal_test")
