"""[beam]: its section, material, masses, root, and the loads on it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, StrictBool, StringConstraints, Tag, model_validator
from pydantic_core import PydanticCustomError

from gbeam.guards.limits import ENTRIES
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    Angle,
    Areas,
    Density,
    Exponent,
    File,
    Length,
    Lengths,
    Loc,
    Mass,
    MomentOfInertia,
    Offset,
    OneOrSome,
    Position,
    Pressure,
    Ratio,
    Ratios,
    RotationalStiffness,
    SecondMoments,
    Stiffness,
    Table,
    Vector,
    existing_file,
    listed,
    optional,
    refuse,
    wrong,
)
from gbeam.scenario.schema.profile import ForceOverTime, MomentOverTime, SpreadForceOverTime

PointName = Annotated[str, StringConstraints(pattern=r"^[A-Za-z_]\w*$", max_length=64)]


class Forces(Vector):
    """A force by components, each a quantity or a profile; those left out are zero."""

    x: ForceOverTime | None = optional("component along the beam")
    y: ForceOverTime | None = optional("component along the width")
    z: ForceOverTime | None = optional("component through the thickness")


class LoadMoments(Vector):
    """A moment by components, each a quantity or a profile; those left out are zero."""

    x: MomentOverTime | None = optional("moment about x, along the beam")
    y: MomentOverTime | None = optional("moment about y: positive bends the tip to -z")
    z: MomentOverTime | None = optional("moment about z: positive bends the tip to +y")


class SpreadForces(Vector):
    """A force per length by components, each a quantity or a profile; those left out are zero."""

    x: SpreadForceOverTime | None = optional("component along the beam")
    y: SpreadForceOverTime | None = optional("component along the width")
    z: SpreadForceOverTime | None = optional("component through the thickness")


class Load(Table):
    """A force, a moment or both at a station; or a force spread evenly over the length."""

    at: Position | None = optional("position from the root, along the beam")
    force: Forces | None = optional("force at the station: { x, y, z }")
    moment: LoadMoments | None = optional("moment at the station: { x, y, z }")
    distributed: SpreadForces | None = optional(
        "force per length over the whole beam: { x, y, z }; instead of at, force and moment"
    )
    follower: StrictBool = Field(
        default=False,
        description="true if the components turn with the section; false if they keep to the base axes",
    )

    @model_validator(mode="after")
    def _one_kind(self) -> Load:
        def problems() -> Iterator[tuple[Loc, PydanticCustomError]]:
            point = [name for name in ("at", "force", "moment") if getattr(self, name) is not None]
            if self.distributed is not None:
                for name in point:
                    yield (name,), wrong("is given beside distributed", "make two loads of them", mark="key")
            elif self.force is None and self.moment is None:
                hint = 'give force, moment or distributed, such as force = { z = "5 N" }'
                yield (), wrong("the load is missing", hint)
            elif self.at is None:
                yield (), wrong("at is missing", 'say where the load acts: at = "300 mm"', mark="key")

        refuse(problems())
        return self


class Stations(Table):
    """Positions at which the dimensions of a section are listed."""

    stations: tuple[Position, ...] = listed(
        "positions from root to tip at which the dimensions are listed, linear in between"
    )


class Flat(Stations):
    """A section with a width to be kept from bending across."""

    plate: StrictBool = Field(
        default=False,
        description="true if it bends along z as a plate that stays flat across its width, EI_y/(1 - ν²): a strip wide "
        "beside its length, or bent far; needs material.poissons_ratio",
    )


class Rectangle(Flat):
    """A rectangle."""

    shape: Literal["rectangle"] = Field(description="name of the shape")
    width: Lengths = Field(description="width, along y")
    thickness: Lengths = Field(description="thickness, along z, the soft direction")


class Circle(Stations):
    """A solid circle."""

    shape: Literal["circle"] = Field(description="name of the shape")
    diameter: Lengths = Field(description="diameter")


class Tube(Stations):
    """A round tube."""

    shape: Literal["tube"] = Field(description="name of the shape")
    diameter: Lengths = Field(description="outer diameter")
    wall: Lengths = Field(description="wall thickness")


class General(Flat):
    """Any section, by its properties."""

    shape: Literal["general"] = Field(default="general", description="name of the shape; may be left out")
    area: Areas = Field(description="area")
    inertia_y: SecondMoments = Field(description="∫z² dA, which bends the beam along z")
    inertia_z: SecondMoments = Field(description="∫y² dA, which bends the beam along y")
    extreme_fibre_y: Lengths | None = optional("outer fibre along y, for stress")
    extreme_fibre_z: Lengths | None = optional("outer fibre along z, for stress")
    torsion_constant: SecondMoments | None = optional(
        "J of the torque G J α', for modes.twist and for the stated error of a model without twist"
    )
    shear_coefficient_y: Ratios | None = optional(
        "k of the shear force k G A γ along y, for modes.shear_y; in the stated error 1/2 where left out"
    )
    shear_coefficient_z: Ratios | None = optional("k of the shear force along z, for modes.shear_z, likewise")


Entry = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Row = Annotated[tuple[Entry, ...], Field(min_length=6, max_length=6)]
Matrix = Annotated[tuple[Row, ...], Field(min_length=6, max_length=6)]


def _depth(value: Any) -> str:
    try:
        return "list" if isinstance(value[0][0], (list, tuple)) else "one"
    except (TypeError, LookupError):
        return "one"


Matrices = Annotated[
    Annotated[Matrix, Tag("one")] | Annotated[tuple[Matrix, ...], Field(min_length=1, max_length=ENTRIES), Tag("list")],
    Discriminator(_depth),
]


class ByMatrices(Stations):
    """A section by its stiffness and mass matrices, in SI; rows: stretch, shears y and z, twist, curvatures y and z."""

    shape: Literal["matrices"] = Field(description="name of the shape")
    stiffness: Matrices | None = optional(
        "(6, 6) in N, N m and N m^2, or one per station; VABS has the same order; or file"
    )
    mass: Matrices | None = optional("(6, 6) of a rigid slice in kg/m, kg and kg m, or one per station")
    file: OneOrSome[File] | None = optional(
        "file of VABS (.K) or BECAS (.out) with both matrices instead, or one per station; relative to the folder of "
        "the scenario file"
    )
    length_unit: str | None = optional("unit of length in the file, such as mm; m where left out. Of time it is s")
    mass_unit: str | None = optional("unit of mass in the file, such as Mg; kg where left out")

    @model_validator(mode="after")
    def _one_way(self) -> ByMatrices:
        ways = {name: getattr(self, name) is not None for name in ("stiffness", "mass", "file")}
        if ways["file"] and (ways["stiffness"] or ways["mass"]):
            refuse([(("file",), wrong("is given beside matrices", "keep one of them", mark="key"))])
        for name in () if ways["file"] else ("stiffness", "mass"):
            if not ways[name]:
                hint = "give stiffness and mass, (6, 6) each, or file of VABS or BECAS"
                refuse([((), wrong(f"{name} is missing", hint, mark="key"))])
        for name in () if ways["file"] else ("length_unit", "mass_unit"):
            if getattr(self, name) is not None:
                refuse([((name,), wrong("is given without a file", "leave it out: matrices are in SI", mark="key"))])
        return self


Corners = Annotated[tuple[tuple[Offset, Offset], ...], Field(min_length=3, max_length=ENTRIES)]


class Drawn(Table):
    """A section of one material by its outline, whose matrices sectionproperties computes: `gbeam[sections]`."""

    shape: Literal["drawn"] = Field(description="name of the shape")
    outline: Corners = Field(description="corners in order: [ [y, z], ... ]")
    holes: tuple[Corners, ...] = listed("corners of each hole: [ [ [y, z], ... ] ]")
    axis: tuple[Offset, Offset] | None = optional(
        "where the axis of the beam meets the drawing, [y, z]; the centroid where left out"
    )
    element_size: Length | None = optional("edge of the triangles; about 400 of them where left out")


def _shape(section: Any) -> str | None:
    if not isinstance(section, dict):
        return getattr(section, "shape", None)
    by_properties = any(key in section for key in ("area", "inertia_y", "inertia_z"))
    shape = section.get("shape", "general" if by_properties else None)
    return shape if shape is None or isinstance(shape, str) else str(shape)


Section = Annotated[
    Annotated[Rectangle, Tag("rectangle")]
    | Annotated[Circle, Tag("circle")]
    | Annotated[Tube, Tag("tube")]
    | Annotated[General, Tag("general")]
    | Annotated[ByMatrices, Tag("matrices")]
    | Annotated[Drawn, Tag("drawn")],
    Discriminator(_shape),
]


class Material(Table):
    """Linear elastic material."""

    density: Density = Field(description="mass per volume")
    youngs_modulus: Pressure = Field(description="Young's modulus")
    yield_strength: Pressure | None = optional("stress at which it yields; with it results give the margin")
    fatigue_exponent: Exponent | None = optional(
        "m of Wöhler's curve, N Δσᵐ = constant: about 3 for welds, 10 for smooth parts; 5 where left out"
    )
    poissons_ratio: Ratio | None = optional("of plates, and for the stated error, where 0.3 is taken if it is left out")
    shear_modulus: Pressure | None = optional(
        "of twist and shear, in exact and in the stated error; E/(2 (1 + ν)) where left out"
    )


class Moments(Table):
    """Principal moments of inertia, in axes of the section."""

    x: MomentOfInertia = Field(description="moment about x, along the beam")
    y: MomentOfInertia = Field(description="moment about y, along the width")
    z: MomentOfInertia = Field(description="moment about z, through the thickness")


class PointMass(Table):
    """A mass, or a small rigid body, fixed to the beam."""

    at: Position = Field(description="position from the root, along the beam")
    mass: Mass = Field(description="mass")
    inertia: Moments | None = optional("moments of inertia about its centre, for a body that is not a point")
    offset: tuple[Offset, Offset, Offset] | None = optional(
        "centre of mass from the beam's axis: [x, y, z] in axes of the section"
    )
    name: PointName | None = optional("name of the point of output at its place")


class Point(Table):
    """A named point of output."""

    name: PointName = Field(description="letters, digits and underscores")
    at: Position = Field(description="position from the root, along the beam")


class Root(Table):
    """Springs between the base and the beam's root; a direction left out is rigid."""

    translation_x: Stiffness | None = optional("spring along x, along the beam")
    translation_y: Stiffness | None = optional("spring along y, along the width")
    translation_z: Stiffness | None = optional("spring along z, through the thickness")
    rotation_y: RotationalStiffness | None = optional("spring about y, against bending along z")
    rotation_z: RotationalStiffness | None = optional("spring about z, against bending along y")


class Piece(Table):
    """A piece of the line that turns evenly: straight, an arc, a helix; without length a corner."""

    length: Position = Field(default=0.0, description="length of arc; 0, or left out, is a corner")
    twist: Angle = Field(default=0.0, description="turn of its end against its beginning about the line itself")
    turn_y: Angle = Field(default=0.0, description="turn about the section's y, towards -z")
    turn_z: Angle = Field(default=0.0, description="turn about the section's z, towards +y")


_Places = Annotated[
    Annotated[str, AfterValidator(existing_file), Tag("one")]
    | Annotated[tuple[tuple[Offset, Offset, Offset], ...], Field(max_length=ENTRIES), Tag("list")],
    ONE_OR_LIST,
]


class Line(Table):
    """The line along which a beam lies at rest: by points, by pieces, or straight with a twist at stations."""

    points: _Places | None = optional(
        "places in base axes, [x, y, z], from the root, [0, 0, 0]; or a file of text with a row for each, "
        "relative to the folder of the scenario file: columns x, y, z, of which those left out are zero, and twist"
    )
    length_unit: str | None = optional(
        "unit of x, y and z in a file that does not say it, in brackets or a row of units"
    )
    smooth: StrictBool = Field(
        default=True, description="false if the points are corners of straight pieces, not of a cubic spline"
    )
    pieces: tuple[Piece, ...] | None = optional(
        "[ { length, twist, turn_y, turn_z } ] from root to tip", max_length=ENTRIES
    )
    stations: tuple[Position, ...] | None = optional(
        "positions of the twist on a straight line, from root to tip", max_length=ENTRIES
    )
    twist: tuple[Angle, ...] | None = optional(
        "angle of the section about the line at each point or station, linear in between", max_length=ENTRIES
    )

    @model_validator(mode="after")
    def _one_way(self) -> Line:
        ways = [name for name in ("points", "pieces", "stations") if getattr(self, name) is not None]
        if len(ways) != 1:
            problem = f"{ways[1]} is given beside {ways[0]}" if ways else "the line is missing"
            refuse([((), wrong(problem, "give one of points, pieces and stations", mark="key"))])
        if self.pieces is not None and self.twist is not None:
            refuse([(("twist",), wrong("is given beside pieces", "give each piece its own twist", mark="key"))])
        of_file = isinstance(self.points, str)
        if self.length_unit is not None and not of_file:
            refuse([(("length_unit",), wrong("is given without a file", "leave it out", mark="key"))])
        listed = self.stations if of_file else self.points or self.stations
        if self.stations is not None and self.twist is None:
            refuse([((), wrong("twist is missing beside stations", 'add twist = ["0 deg", "10 deg"]', mark="key"))])
        if listed and self.twist is not None and len(self.twist) != len(listed):
            problem = f"has {len(self.twist)} values for {len(listed)} {ways[0]}"
            refuse([(("twist",), wrong(problem, f"give one for each of the {ways[0]}"))])
        return self


class Beam(Table):
    """The beam: held at its root by the moving base, straight along x or along a line."""

    length: Length | None = optional("length from root to tip, along the line; left out where the line says it")
    section: Section = Field(description="cross-section, by shape or by properties: { area, inertia_y, inertia_z }")
    material: Material | None = optional(
        "linear elastic material: { density, youngs_modulus, yield_strength }; none beside matrices"
    )
    damping_ratio: Ratios | None = optional(
        "modal damping ratio: one for all modes, or a list with one per mode, ascending in frequency; of "
        "the modes of the beam on a base at rest, also where the hub is free. run, place, models and linearize need "
        "it, 0 for none; the rest take none where it is left out"
    )
    masses: tuple[PointMass, ...] = listed("masses fixed to the beam: [ { at, mass } ]")
    root: Root = Field(default_factory=Root, description="springs that hold the root, which is rigid where left out")
    loads: tuple[Load, ...] = listed("forces and moments on the beam: [ { at, force, moment, distributed, follower } ]")
    points: tuple[Point, ...] = listed("points of output beside the tip: [ { name, at } ]")
    rotary_inertia: StrictBool = Field(
        default=True,
        description="false for sections that do not resist turning by their own second moments, each a point on the "
        "axis: the theory of Euler and Bernoulli",
    )
    line: Line | None = optional("reference line at rest, where it is not straight along x: { points, pieces, twist }")

    @model_validator(mode="after")
    def _complete(self) -> Beam:
        if self.material is None and not isinstance(self.section, ByMatrices):
            hint = "add material = { density, youngs_modulus }: linear elastic material"
            refuse([((), wrong("material is missing", hint, mark="key"))])
        if self.length is None and (self.line is None or self.line.stations is not None):
            refuse([((), wrong("length is missing", 'add length = "20 mm": length from root to tip', mark="key"))])
        return self
