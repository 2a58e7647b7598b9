"""Modes that were measured, or computed elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from gbeam.errors import InputError, naming
from gbeam.guards.limits import ENTRIES
from gbeam.guards.quantities import Mass, Quantity
from gbeam.mechanics.structure import Structure
from gbeam.scenario.bodies.common import BodyKind, NodePoints
from gbeam.scenario.schema.declared import table_of
from gbeam.scenario.schema.fields import Direction, File, OneOrSome
from gbeam.solids.modal_test import ModalTest

_Frequencies = Annotated[
    tuple[Annotated[float, Quantity("frequency", "positive")], ...], Field(min_length=1, max_length=ENTRIES)
]
_Masses = OneOrSome[Mass]
_Shape = Annotated[tuple[Direction, ...], Field(max_length=ENTRIES)]
_Shapes = Annotated[tuple[_Shape, ...], Field(max_length=ENTRIES)]
MEASURED = ("frequency", "damping_ratio", "shapes", "nodes", "modal_mass")


def _body(
    *, modal_test: str | None = None, masses: Any, points: dict[str, int] | None = None, **measured: Any
) -> Structure:
    """Modes that were measured, or computed elsewhere: frequencies, damping and shapes, on a base at rest."""
    with naming({"path": "modal_test"}):
        test = _test(modal_test, measured)
    count = len(np.asarray(test.nodes))
    try:
        return test.structure(np.full(count, masses) if np.ndim(masses) == 0 else masses, points=points)
    except InputError as error:
        raise error.at(error.where.replace("mass", "masses", 1)) from None


def _test(file: str | None, measured: dict[str, Any]) -> ModalTest:
    """The modes of a file, or those that are written; InputError unless it is one of both."""
    own_keys = [key for key in ("frequency", "shapes", "nodes") if key in measured]
    if file is not None and own_keys:
        raise InputError(own_keys[0], "is given beside modal_test", "keep one of them")
    if file is not None:
        test = ModalTest.read(file, modal_mass=measured.get("modal_mass"))
        return replace(test, damping_ratio=measured["damping_ratio"]) if "damping_ratio" in measured else test
    lacking = [key for key in MEASURED if key not in measured]
    if lacking:
        fix = "give modal_test = FILE, or frequency, damping_ratio, shapes, nodes and modal_mass"
        raise InputError("", f"{lacking[0]} is missing", fix)
    return ModalTest(**measured | {"shapes": _same_nodes(measured["shapes"], len(measured["nodes"]))})


def _same_nodes(shapes: Any, count: int) -> Any:
    """Shapes by mode (m, k, 3) as displacements of nodes (k, 3, m)."""
    for i, shape in enumerate(shapes):
        if len(shape) != count:
            fix = f"give {count} of [x, y, z]"
            raise InputError(f"shapes[{i}]", f"has {len(shape)} displacements for {count} nodes", fix)
    return np.moveaxis(np.asarray(shapes), 0, -1)


_FILE = (
    "universal file (.uff, .unv) of the modes and the nodes; or frequency, damping_ratio, shapes, nodes and "
    "modal_mass. Relative to the folder of the scenario file"
)
_SHAPES = "displacements of the nodes in each mode, without a file: [ [ [x, y, z], ... ], ... ]"
_MODAL_MASS = "that goes with the shapes, of every mode, or a list; beside a file in place of its own"
_SHARES = "share of the specimen's mass at the nodes, in the order of their numbers: a list, or one that all have"
_POINTS = "numbers of nodes of output by name; without a file from 0"
BODY = BodyKind(
    table_of(
        _body,
        ModalTest,
        name="ModalTestBody",
        tag=("kind", "modal-test"),
        known=True,
        without={"numbers"},
        optional={"damping_ratio", "nodes"},
        changed={
            "modal_test": (File | None, Field(default=None, description=_FILE)),
            "frequency": (
                _Frequencies | None,
                Field(default=None, description="natural frequencies, without a file"),
            ),
            "shapes": (_Shapes | None, Field(default=None, description=_SHAPES)),
            "modal_mass": (_Masses | None, Field(default=None, description=_MODAL_MASS)),
            "masses": (_Masses, Field(description=_SHARES)),
            "points": (NodePoints, Field(default_factory=dict, description=_POINTS)),
        },
    ),
    known_by="modal_test",
)
