"""A solid of finite elements, by its mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from gbeam.errors import InputError, naming
from gbeam.guards.quantities import Factor, Length, Mass, Quantity
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.scenario.bodies.common import BodyKind, Inertia, PlaceOfBody, Reduced, placed
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.beam import Material
from gbeam.scenario.schema.declared import chosen, makes, object_of, table_of
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    File,
    Place3,
    Table,
    Turn3,
    by_name,
    optional,
    refuse,
    wrong,
)
from gbeam.structure.material import Orthotropic as _Orthotropic

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure
    from gbeam.solids.mesh import SolidMesh
    from gbeam.solids.model import SolidModel

_Meshed = tuple[str, float | None]  # file, and largest edge of the elements by which a shape is meshed
Orthotropic = table_of(_Orthotropic)


def _symmetry(material: Any) -> str:
    keys = material if isinstance(material, Mapping) else getattr(material, "model_fields_set", ())
    several = {"youngs_moduli", "poissons_ratios", "shear_moduli"}
    return "isotropic" if several.isdisjoint(keys) else "orthotropic"


if TYPE_CHECKING:  # type checkers make no tables
    SolidMaterial = Any
else:
    SolidMaterial = chosen("symmetry", {"isotropic": Material, "orthotropic": Orthotropic}, _symmetry)
_Groups = Annotated[Annotated[str, Tag("one")] | Annotated[tuple[str, ...], Tag("list")], ONE_OR_LIST]
_MeshPoint = Annotated[
    Annotated[str, Tag("one")] | Annotated[Place3, Tag("list")] | Annotated[PlaceOfBody, Tag("table")],
    Discriminator(placed),
]


class Carried(Table):
    """A body that a rigid link carries, its root in the middle of the link's nodes."""

    mass: Mass = Field(description="mass")
    centre: Place3 = Field(
        default=(0.0, 0.0, 0.0), description="centre of mass from the middle of the link's nodes: [x, y, z]"
    )
    inertia: Inertia = Field(
        default=(0.0, 0.0, 0.0),
        description="moments about the centre of mass and the axes of the base, or three rows of the tensor",
    )


_Spring = Annotated[float, Quantity("stiffness", "zero or more")]
_TurnSpring = Annotated[float, Quantity("rotational stiffness", "zero or more")]


class SpringStiffness(Table):
    """Stiffness along and about the axes of the base."""

    x: _Spring = Field(default=0.0, description="along x")
    y: _Spring = Field(default=0.0, description="along y")
    z: _Spring = Field(default=0.0, description="along z")
    rx: _TurnSpring = Field(default=0.0, description="about x")
    ry: _TurnSpring = Field(default=0.0, description="about y")
    rz: _TurnSpring = Field(default=0.0, description="about z")


class Spring(Table):
    """A spring in the middle of the nodes of a rigid link."""

    between: Annotated[tuple[str, ...], Field(min_length=1, max_length=2)] = Field(
        description="names of two links, or of one that the spring holds to the base"
    )
    stiffness: SpringStiffness = Field(description="{ x, y, z, rx, ry, rz }, those left out are zero")


class SolidBody(Reduced):
    """A solid of finite elements, by its mesh."""

    kind: Literal["solid"] = Field(default="solid", description="kind of the body; may be left out beside mesh")
    mesh: File = Field(
        description="file of Gmsh, Nastran bulk data, Abaqus, CalculiX, VTK, Exodus or another format of meshio, "
        'relative to the folder of the scenario file; or of STEP, which Gmsh meshes, with pip install "gbeam[gmsh]"'
    )
    unit: str | None = optional('unit of the coordinates in the mesh, such as "mm"; STEP files say theirs')
    mass_unit: str | None = optional(
        'unit of mass in a file of Nastran, Abaqus or CalculiX, such as "Mg" beside mm, N and s: with it '
        "the file's masses, rigid links and springs are read"
    )
    thickness: Length | None = optional(
        "of all triangles and quadrilaterals of a mesh without solids, which are shells by it"
    )
    thicknesses: dict[str, Length] = by_name(
        "of the shells of each group, by its name or number, instead of thickness; in a mesh with solids "
        "other surfaces only name groups"
    )
    element_size: Length | None = optional("largest edge of the elements by which STEP files are meshed")
    material: SolidMaterial | None = optional(
        "of all elements: { density, youngs_modulus, poissons_ratio, yield_strength }, or orthotropic "
        "{ density, youngs_moduli, poissons_ratios, shear_moduli, axes }"
    )
    materials: dict[str, SolidMaterial] = by_name(
        "of the elements of each group, by its name or number, instead of material"
    )
    clamp: _Groups = Field(description="name of the group whose nodes follow the base or the joint, or a list of them")
    masses: dict[str, Mass] = by_name(
        "masses by the name of a point, or of a group over whose nodes each is spread evenly"
    )
    points: dict[str, _MeshPoint] = by_name(
        "points of output by name: the place [x, y, z] from the root for the nearest node, or a group of "
        "one node, or with axes of stress and strain { at, turn }; tip is the free node farthest from the root where "
        "it is not given"
    )
    interfaces: dict[str, str] = by_name(
        "groups by the name of a point that moves and turns as their nodes do on average: other bodies "
        "hang on it, and it is put out"
    )
    links: dict[str, _Groups] = by_name(
        "rigid links by name: a group, or a list of them, whose nodes move together as one rigid body"
    )
    carried: dict[str, Carried] = by_name(
        "bodies by the name of the rigid link that carries each: { mass, centre, inertia }"
    )
    springs: dict[str, Spring] = by_name(
        "springs by name, between two rigid links or one and the base: { between, stiffness }"
    )
    origin: Place3 = Field(
        default=(0.0, 0.0, 0.0), description="the root in the mesh, whose acceleration the motion gives: [x, y, z]"
    )
    turn: Turn3 = Field(
        default=(0.0, 0.0, 0.0), description="rotation vector of the mesh's axes in those of the base: [x, y, z]"
    )
    scale: tuple[Factor, Factor, Factor] = Field(
        default=(1.0, 1.0, 1.0),
        description="factors of the mesh's coordinates, such as [1, 1, 1.25] for a board a quarter thicker",
    )
    coarser_size: Length | None = optional("element_size of a coarser mesh, by which the mesh's error is estimated")
    coarser: File | None = optional(
        "file of a coarser mesh with the same groups, by which the mesh's error is estimated"
    )

    @model_validator(mode="after")
    def _one_way(self) -> SolidBody:
        if (self.material is None) == (not self.materials):
            single = self.material is not None
            problem = "is given beside material" if single else "material is missing"
            hint = "keep one of them" if single else "add material = { density, youngs_modulus, poissons_ratio }"
            refuse([(("materials",) if single else (), wrong(problem, hint, mark="key"))])
        if self.thickness is not None and self.thicknesses:
            refuse([(("thicknesses",), wrong("is given beside thickness", "keep one of them", mark="key"))])
        return self


def _body(parts: Collector, where: str, table: SolidBody) -> Structure | None:
    """Structure of a mesh, reduced to modes and kept on disk; None if it is refused."""
    from gbeam.guards.processes import file_digest
    from gbeam.io.kept import kept
    from gbeam.solids.mesh import SolidMesh
    from gbeam.solids.model import SolidModel

    before = len(parts.errors)
    key = "materials" if table.material is None else "material"
    keys = {"materials": key, "points": "points", "carried": "carried"}
    objects = {argument: object_of(parts, f"{where}.{key}", getattr(table, key)) for argument, key in keys.items()}
    if len(parts.errors) > before:
        return None

    mesh_options: dict[str, Any] = {
        "clamp": table.clamp,
        "unit": table.unit,
        "thickness": table.thicknesses or table.thickness,
        "point_masses": table.masses,
        "interfaces": table.interfaces,
        "links": table.links,
        "springs": {name: each.model_dump() for name, each in table.springs.items()},
        "origin": table.origin,
        "turn": table.turn,
        "scale": table.scale,
        "mass_unit": table.mass_unit,
        **objects,
    }
    options: dict[str, Any] = {"modes": table.modes, "damping_ratio": table.damping_ratio}

    def read(file: str, size: float | None) -> SolidMesh:
        try:
            return SolidMesh.read(file, element_size=size, **mesh_options)
        except InputError as error:  # arguments become the scenario's keys
            where = error.where.replace("point_masses", "masses")
            where = where.replace("materials", "material", 1) if table.material is not None else where
            where = where.replace("thickness", "thicknesses", 1) if table.thicknesses else where
            raise error.at(where) from None

    def reduced(of: _Meshed, coarser: _Meshed | None = None) -> SolidModel:
        def make() -> SolidModel:
            mesh = read(*of)
            with _of_coarser():
                coarse = None if coarser is None else reduced(coarser)
            with naming({"stiffness": "springs" if table.springs else "clamp"}):
                return mesh.reduced(**options, coarser=coarse)

        def source() -> Any:
            """Return all that is read: of a mesh one file, with its name, which says its form."""
            parts = [(file_digest(file), Path(file).name, size) for file, size in filter(None, (of, coarser))]
            return options, mesh_options, parts

        return kept(f"reducing {of[0]}", SolidModel, source, make)

    def model() -> Structure:
        of = table.mesh, table.element_size
        if table.coarser is None and table.coarser_size is None:
            return reduced(of).structure
        with naming({"coarser": "coarser_size" if table.coarser is None else "coarser"}):
            return reduced(of, (table.coarser or table.mesh, table.coarser_size)).structure

    return parts.attempt(where, model)


@contextmanager
def _of_coarser() -> Iterator[None]:
    """Place InputErrors raised inside at the key of the coarser mesh."""
    try:
        yield
    except InputError as error:
        raise InputError("coarser", f"{error.where} {error.problem}", error.fix) from None


makes(Carried, RigidBody)
BODY = BodyKind(SolidBody, _body, known_by="mesh")
