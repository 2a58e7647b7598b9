"""A structure by the matrices of a finite-element program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, StrictInt

from gbeam.errors import naming
from gbeam.scenario.bodies.common import BodyKind, Inertia, NodePoints, Reduced, inertia_of
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.fields import File, Mass, OneOrSome, Place3, optional

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure


class MatricesBody(Reduced):
    """A structure by the matrices of a finite-element program."""

    kind: Literal["matrices"] = Field(default="matrices", description="kind of the body; may be left out")
    matrices: OneOrSome[File] = Field(
        description="file with mass and stiffness matrix, or a list of several that complete one another: NPZ, NPY, "
        "Matrix Market, MAT, matrices of Abaqus, CalculiX and Nastran; relative to the folder of the scenario file"
    )
    mass_matrix: str = Field(default="", description="name of the mass matrix in them, where it is not the usual one")
    stiffness_matrix: str = Field(default="", description="name of the stiffness matrix, likewise")
    nodes: File | None = optional(
        "file of a matrix with the places of the nodes, a row of x, y, z each, in length_unit, where the "
        "others have none, as an array nodes or in files of their programs"
    )
    length_unit: str = Field(default="m", description="unit of length of the program, such as mm; of time it is s")
    mass_unit: str = Field(default="kg", description="unit of mass of the program, such as Mg")
    clamp: tuple[StrictInt, ...] = Field(
        default=(),
        description="numbers of nodes that follow the base; none where the matrices are of the others alone",
    )
    points: NodePoints = Field(default_factory=dict, description="numbers of nodes of output by name")
    interfaces: tuple[str, ...] = Field(default=(), description="names of points on which other bodies hang")
    total_mass: Mass | None = optional("mass that the matrices must have, within 1 %")
    centre: Place3 | None = optional("centre of mass that they must have: [x, y, z]")
    inertia: Inertia | None = optional("inertia about the centre of mass that they must have: [x, y, z], or three rows")


def _body(parts: Collector, where: str, table: MatricesBody) -> Structure | None:
    """Structure from the matrices of another program; None if they are refused."""
    from gbeam.io.models.registry import read_matrix
    from gbeam.solids.imported import ImportedModel

    def places() -> Any:
        if table.nodes is None:
            return None
        with naming("nodes"):
            matrix = read_matrix(table.nodes)
        return matrix.toarray() if hasattr(matrix, "toarray") else matrix

    def model() -> Structure:
        files = (table.matrices,) if isinstance(table.matrices, str) else table.matrices
        inertia = None if table.inertia is None else inertia_of(table.inertia)
        names = {"mass": table.mass_matrix, "stiffness": table.stiffness_matrix}
        keys = {argument: f"{argument}_matrix" if name else "matrices" for argument, name in names.items()}
        with naming(keys | {"paths": "matrices", "path": "matrices"}):
            imported = ImportedModel.read(
                *files,
                mass=table.mass_matrix,
                stiffness=table.stiffness_matrix,
                nodes=places(),
                length_unit=table.length_unit,
                mass_unit=table.mass_unit,
            )
            return imported.reduced(
                **{key: getattr(table, key) for key in _AS_THEY_ARE},
                inertia=inertia,
            )

    return parts.attempt(where, model)


_AS_THEY_ARE = ("modes", "damping_ratio", "clamp", "points", "interfaces", "total_mass", "centre")


BODY = BodyKind(MatricesBody, _body, known_by="matrices")
