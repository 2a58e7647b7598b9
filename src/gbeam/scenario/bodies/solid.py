"""A solid of finite elements, by its mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Field, Tag

from gbeam.errors import InputError, naming
from gbeam.guards.limits import ENTRIES
from gbeam.guards.parameters import parameters_of
from gbeam.guards.processes import file_digest
from gbeam.guards.quantities import Length, Mass, Quantity
from gbeam.io.kept import kept
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.scenario.bodies.common import BodyKind, Inertia, PlaceOfBody, placed
from gbeam.scenario.schema.beam import Material
from gbeam.scenario.schema.declared import chosen, makes, read_as, table_of
from gbeam.scenario.schema.fields import File, Place3, Table, by_name, optional
from gbeam.solids.links import LinkSpring
from gbeam.solids.mesh import SolidMesh
from gbeam.solids.model import SolidModel
from gbeam.structure.material import Orthotropic as _Orthotropic

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
_MeshPoint = Annotated[
    Annotated[str, Tag("one")] | Annotated[Place3, Tag("list")] | Annotated[PlaceOfBody, Tag("table")],
    Discriminator(placed),
]


Carried = table_of(
    RigidBody,
    name="Carried",
    about="A body that a rigid link carries, its root in the middle of the link's nodes.",
    without={"points"},
    types={"inertia": Inertia},
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


makes(SpringStiffness, dict)
read_as(LinkSpring, makes(Spring, LinkSpring))
read_as(RigidBody, Carried)


def _body(
    *,
    mesh: str,
    element_size: float | None = None,
    material: Any = None,
    materials: Any = None,
    thickness: float | None = None,
    thicknesses: Mapping[str, float] | None = None,
    masses: Mapping[str, float] | None = None,
    coarser: str | None = None,
    coarser_size: float | None = None,
    modes: int = 10,
    damping_ratio: Any,
    **options: Any,
) -> Structure:
    """A solid of finite elements, by its mesh, reduced to modes and kept on disk."""
    if material is not None and materials is not None:
        raise InputError("materials", "is given beside material", "keep one of them")
    if material is None and materials is None:
        fix = "add material = { density, youngs_modulus, poissons_ratio }"
        raise InputError("", "material is missing", fix)
    if thickness is not None and thicknesses is not None:
        raise InputError("thicknesses", "is given beside thickness", "keep one of them")
    if not {"clamp", "supports", "springs"} & options.keys():
        raise InputError("", "clamp is missing", "add the name of the group that is screwed on, or supports")
    options |= {"materials": material or materials, "thickness": thickness or thicknesses, "point_masses": masses}
    keys = {"point_masses": "masses", "materials": "materials" if materials else "material"}
    keys |= {"thickness": "thicknesses" if thicknesses else "thickness", "source": "mesh"}
    modal = {"modes": modes, "damping_ratio": damping_ratio}

    def reduced(of: _Meshed, coarser: _Meshed | None = None) -> SolidModel:
        def make() -> SolidModel:
            with naming(keys):  # arguments become the scenario's keys
                mesh = SolidMesh.read(of[0], element_size=of[1], **options)
            with _of_coarser():
                coarse = None if coarser is None else reduced(coarser)
            with naming({"stiffness": "springs" if "springs" in options else "clamp"}):
                return mesh.reduced(**modal, coarser=coarse)

        def source() -> Any:
            """Return all that is read: of a mesh one file, with its name, which says its form."""
            parts = [(file_digest(file), Path(file).name, size) for file, size in filter(None, (of, coarser))]
            return modal, options, parts

        return kept(f"reducing {of[0]}", SolidModel, source, make)

    fine = mesh, element_size
    if coarser is None and coarser_size is None:
        return reduced(fine).structure
    with naming({"coarser": "coarser_size" if coarser is None else "coarser"}):
        return reduced(fine, (coarser or mesh, coarser_size)).structure


@contextmanager
def _of_coarser() -> Iterator[None]:
    """Place InputErrors raised inside at the key of the coarser mesh."""
    try:
        yield
    except InputError as error:
        raise InputError("coarser", f"{error.where} {error.problem}", error.fix) from None


_READ = parameters_of(SolidMesh.read)
_MATERIAL = (
    "of all elements: { density, youngs_modulus, poissons_ratio, yield_strength }, or orthotropic "
    "{ density, youngs_moduli, poissons_ratios, shear_moduli, axes }"
)
_MATERIALS = "of the elements of each group, by its name or number, instead of material"
_THICKNESS = "of all triangles and quadrilaterals of a mesh without solids, which are shells by it"
_THICKNESSES = (
    "of the shells of each group, by its name or number, instead of thickness; in a mesh with solids other surfaces "
    "only name groups"
)
_COARSER_SIZE = "element_size of a coarser mesh, by which the mesh's error is estimated"
_COARSER = "file of a coarser mesh with the same groups, by which the mesh's error is estimated"
BODY = BodyKind(
    table_of(
        _body,
        SolidMesh.read,
        SolidMesh.reduced,
        name="SolidBody",
        about="A solid of finite elements, by its mesh.",
        tag=("kind", "solid"),
        known=True,
        without={"source", "point_masses", "kind"},
        types={"points": Annotated[dict[str, _MeshPoint], Field(max_length=ENTRIES)]},
        changed={
            "mesh": (File, Field(description=_READ["source"].words)),
            "material": (SolidMaterial | None, optional(_MATERIAL)),
            "materials": (dict[str, SolidMaterial], by_name(_MATERIALS)),
            "thickness": (Length | None, optional(_THICKNESS)),
            "thicknesses": (dict[str, Length], by_name(_THICKNESSES)),
            "masses": (dict[str, Mass], by_name(_READ["point_masses"].words)),
            "coarser_size": (Length | None, optional(_COARSER_SIZE)),
            "coarser": (File | None, optional(_COARSER)),
        },
    ),
    known_by="mesh",
)
