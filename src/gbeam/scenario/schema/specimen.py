"""[bodies.NAME] of a solid by its mesh, of what another program or a modal test gives, and of a rigid specimen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StrictInt, Tag, model_validator

from gbeam.guards.limits import ENTRIES
from gbeam.scenario.schema.beam import Material
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    Density,
    Exponent,
    File,
    Length,
    Mass,
    MomentOfInertia,
    Offset,
    OneOrSome,
    Place3,
    Pressure,
    Quantity,
    Ratio,
    Ratios,
    Table,
    Turn3,
    by_name,
    optional,
    refuse,
    wrong,
)

Direction = tuple[Ratio, Ratio, Ratio]
_Moduli = tuple[Pressure, Pressure, Pressure]
_Count = Annotated[StrictInt, Field(ge=1, le=1000)]
_Row = tuple[
    Annotated[float, Quantity("moment of inertia")],
    Annotated[float, Quantity("moment of inertia")],
    Annotated[float, Quantity("moment of inertia")],
]


def _rows(value: Any) -> str:
    return "list" if isinstance(value, (list, tuple)) and value and isinstance(value[0], (list, tuple)) else "one"


Inertia = Annotated[
    Annotated[tuple[MomentOfInertia, MomentOfInertia, MomentOfInertia], Tag("one")]
    | Annotated[tuple[_Row, _Row, _Row], Tag("list")],
    Discriminator(_rows),
]


class Orthotropic(Table):
    """Linear elastic material with three planes of symmetry, such as a laminate."""

    density: Density = Field(description="mass per volume")
    youngs_moduli: _Moduli = Field(description="along its axes 1, 2 and 3")
    poissons_ratios: tuple[Ratio, Ratio, Ratio] = Field(
        description="nu12, nu23 and nu13: contraction along the second axis by a pull along the first"
    )
    shear_moduli: _Moduli = Field(description="G12, G23 and G13")
    axes: tuple[Direction, Direction] = Field(
        default=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), description="directions of its axes 1 and 2, in axes of the mesh"
    )


def _symmetry(material: Any) -> str:
    keys = material if isinstance(material, Mapping) else getattr(material, "model_fields_set", ())
    several = {"youngs_moduli", "poissons_ratios", "shear_moduli"}
    return "isotropic" if several.isdisjoint(keys) else "orthotropic"


SolidMaterial = Annotated[
    Annotated[Material, Tag("isotropic")] | Annotated[Orthotropic, Tag("orthotropic")], Discriminator(_symmetry)
]
_Groups = Annotated[Annotated[str, Tag("one")] | Annotated[tuple[str, ...], Tag("list")], ONE_OR_LIST]


class PlaceOfBody(Table):
    """A named point of a rigid body, or of a mesh at the nearest node, with axes."""

    at: Place3 = Field(default=(0.0, 0.0, 0.0), description="place from the body's root, in its axes: [x, y, z]")
    turn: Turn3 = Field(
        default=(0.0, 0.0, 0.0), description="rotation vector of the point's axes in those of the root: [x, y, z]"
    )


def _placed(point: Any) -> str:
    if isinstance(point, (Mapping, PlaceOfBody)):
        return "table"
    return "list" if isinstance(point, (list, tuple)) else "one"


Point = Annotated[Annotated[Place3, Tag("list")] | Annotated[PlaceOfBody, Tag("table")], Discriminator(_placed)]
_MeshPoint = Annotated[
    Annotated[str, Tag("one")] | Annotated[Place3, Tag("list")] | Annotated[PlaceOfBody, Tag("table")],
    Discriminator(_placed),
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


class Reduced(Table):
    """Keys of what is reduced to modes."""

    modes: _Count = Field(default=10, description="number of modes; up to twelve static shapes come on top")
    damping_ratio: Ratios = Field(
        description="of critical damping, of all, or a list with one for each mode; static shapes have the last one's"
    )


class SolidBody(Reduced):
    """A solid of finite elements, by its mesh."""

    kind: Literal["solid"] = Field(default="solid", description="kind of the body; may be left out beside mesh")
    mesh: File = Field(
        description="file of Gmsh, Nastran bulk data, Abaqus, CalculiX, VTK, Exodus or another format of meshio, "
        'relative to the folder of the scenario file; needs pip install "gbeam[mesh]"; or of STEP, which Gmsh meshes, '
        'with pip install "gbeam[gmsh]"'
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
    scale: tuple[Exponent, Exponent, Exponent] = Field(
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


_NodePoints = Annotated[dict[str, StrictInt], Field(max_length=ENTRIES)]


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
    points: _NodePoints = Field(default_factory=dict, description="numbers of nodes of output by name")
    interfaces: tuple[str, ...] = Field(default=(), description="names of points on which other bodies hang")
    total_mass: Mass | None = optional("mass that the matrices must have, within 1 %")
    centre: Place3 | None = optional("centre of mass that they must have: [x, y, z]")
    inertia: Inertia | None = optional("inertia about the centre of mass that they must have: [x, y, z], or three rows")


class StandardInputBody(Table):
    """A flexible body of standard input data, as multibody programs exchange them."""

    kind: Literal["standard-input-data"] = Field(
        default="standard-input-data", description="kind of the body; may be left out beside standard_input_data"
    )
    standard_input_data: File = Field(
        description="file of the body's modal object, in SI; relative to the folder of the scenario file"
    )
    damping_ratio: Ratios | None = optional("of critical damping, in place of the damping in the file")
    points: _NodePoints = Field(default_factory=dict, description="numbers of nodes of output by name")


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
    points: _NodePoints = Field(
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


_OF_SPECIMEN = "of a specimen alone on its base: "
_Places = Annotated[tuple[Place3, ...], Field(max_length=ENTRIES)]


class RigidKeys(Table):
    """Keys of a rigid body."""

    kind: Literal["rigid"] = Field(description="kind of the body")
    mass: Mass = Field(description="mass")
    inertia: Inertia = Field(
        default=(0.0, 0.0, 0.0),
        description="about the centre of mass, axes of the root: principal moments [x, y, z], or three rows; of a size "
        "where it is left out that of an even box",
    )
    centre: Place3 = Field(default=(0.0, 0.0, 0.0), description="centre of mass from the root: [x, y, z]")
    size: tuple[Offset, Offset, Offset] | None = optional("edges [x, y, z] of the box that it fills, about middle")
    middle: Place3 | None = optional("middle of the box from the root, [x, y, z]; the centre of mass where left out")
    corners: _Places = Field(
        default=(), description=_OF_SPECIMEN + "corners of its envelope where it is no box: [ [x, y, z], ... ]"
    )
    bolts: _Places = Field(
        default=(), description=_OF_SPECIMEN + "places of the bolts that hold it, alike: [ [x, y, z], ... ]"
    )
    bolt_axis: Direction | None = optional(_OF_SPECIMEN + "direction of the bolts, away from the fixture: [x, y, z]")

    spread_limit: Exponent | None = optional(
        _OF_SPECIMEN + "largest difference of the load at a corner to the centre's that the test order "
        'accepts, over the largest of the centre, such as "10 %"; beyond it the run is not accepted'
    )

    def alone(self) -> Iterator[str]:
        """Keys given that a body among others does not take."""
        yield from (key for key in ("corners", "bolts", "bolt_axis", "spread_limit") if getattr(self, key))
