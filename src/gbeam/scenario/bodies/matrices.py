"""A structure by the matrices of a finite-element program."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from gbeam.errors import naming
from gbeam.io.models.registry import read_matrix
from gbeam.mechanics.structure import Structure
from gbeam.scenario.bodies.common import BodyKind, Inertia, NodePoints, inertia_of
from gbeam.scenario.schema.declared import table_of
from gbeam.scenario.schema.fields import File, OneOrSome
from gbeam.solids.imported import ImportedModel


def _body(
    *,
    matrices: str | tuple[str, ...],
    mass_matrix: str = "",
    stiffness_matrix: str = "",
    nodes: str | None = None,
    length_unit: str = "m",
    mass_unit: str = "kg",
    inertia: Any = None,
    **reduction: Any,
) -> Structure:
    """A structure by the matrices of a finite-element program."""
    files = (matrices,) if isinstance(matrices, str) else matrices
    names = {"mass": mass_matrix, "stiffness": stiffness_matrix}
    keys = {argument: f"{argument}_matrix" if name else "matrices" for argument, name in names.items()}
    with naming(keys | {"paths": "matrices", "path": "matrices"}):
        imported = ImportedModel.read(
            *files,
            mass=mass_matrix,
            stiffness=stiffness_matrix,
            nodes=_places(nodes),
            length_unit=length_unit,
            mass_unit=mass_unit,
        )
        return imported.reduced(inertia=None if inertia is None else inertia_of(inertia), **reduction)


def _places(file: str | None) -> Any:
    """Places of the nodes in a file of a matrix, or None without a file."""
    if file is None:
        return None
    with naming("nodes"):
        matrix = read_matrix(file)
    return matrix.toarray() if hasattr(matrix, "toarray") else matrix


_Files = OneOrSome[File]
_MATRICES = (
    "file with mass and stiffness matrix, or a list of several that complete one another: NPZ, NPY, Matrix Market, "
    "MAT, matrices of Abaqus, CalculiX and Nastran; relative to the folder of the scenario file"
)
_NODES = (
    "file of a matrix with the places of the nodes, a row of x, y, z each, in length_unit, where the others have none, "
    "as an array nodes or in files of their programs"
)
_INERTIA = "inertia about the centre of mass that they must have: [x, y, z], or three rows"
BODY = BodyKind(
    table_of(
        _body,
        ImportedModel.read,
        ImportedModel.reduced,
        name="MatricesBody",
        tag=("kind", "matrices"),
        known=True,
        without={"paths", "mass", "stiffness", "geometric", "kind"},
        changed={
            "matrices": (_Files, Field(description=_MATRICES)),
            "mass_matrix": (
                str,
                Field(default="", description="name of the mass matrix in them, where it is not the usual one"),
            ),
            "stiffness_matrix": (str, Field(default="", description="name of the stiffness matrix, likewise")),
            "nodes": (File | None, Field(default=None, description=_NODES)),
            "points": (NodePoints, Field(default_factory=dict, description="numbers of nodes of output by name")),
            "inertia": (Inertia | None, Field(default=None, description=_INERTIA)),
        },
    ),
    known_by="matrices",
)
