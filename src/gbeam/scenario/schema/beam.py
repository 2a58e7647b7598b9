"""[beam] and [model]: tables of a beam, its section, material, masses, root, line and loads, and of its model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, Field, Tag

from gbeam.constants import ModelKind, Shapes
from gbeam.errors import InputError, naming, placing_within
from gbeam.guards.limits import ENTRIES
from gbeam.guards.quantities import Angle, Damping, Position, RotationalDamping, RotationalStiffness, Stiffness
from gbeam.mechanics.models import Model as _Model
from gbeam.scenario.line_files import read_line
from gbeam.scenario.schema.declared import chosen, read_as, table_of
from gbeam.scenario.schema.fields import ONE_OR_LIST, File, OneOrSome, Place3, existing_file
from gbeam.structure import attachments
from gbeam.structure.beam import Beam as _Beam
from gbeam.structure.line import Line as _Line
from gbeam.structure.line import Piece as _Piece
from gbeam.structure.material import Material as _Material
from gbeam.structure.section import Section as _Section
from gbeam.structure.supports import DIRECTIONS
from gbeam.structure.supports import Support as _Support
from gbeam.structure.temperature import Temperature as _Temperature

Material = read_as(_Material, table_of(_Material))
PointMass = read_as(attachments.PointMass, table_of(attachments.PointMass))
Point = read_as(attachments.Point, table_of(attachments.Point))
Root = read_as(attachments.Root, table_of(attachments.Root))
Load = read_as(attachments.Load, table_of(attachments.Load))
Temperature = read_as(_Temperature, table_of(_Temperature))


def _by_direction(**values: float) -> dict[str, float]:
    """Values by direction, in axes of the root."""
    return values


def _directions(name: str, what: str, along: Any, about: Any) -> Any:
    """Table of values by direction: of types of those along axes, and about them."""
    fields = dict[str, tuple[Any, Any]]()
    for direction in DIRECTIONS:
        turns = direction.startswith("r")
        words = f"{'about' if turns else 'along'} {direction[-1]}"
        fields[direction] = ((about if turns else along) | None, Field(default=None, description=words))
    sentence = f"{what} of a support by direction, in axes of the root."
    return table_of(_by_direction, name=name, without={"values"}, about=sentence, changed=fields)


_BY_DIRECTION = {
    "stiffness": _directions("SupportStiffness", "Springs", Stiffness, RotationalStiffness),
    "damping": _directions("SupportDamping", "Dampers", Damping, RotationalDamping),
}
Support = read_as(_Support, table_of(_Support, types=_BY_DIRECTION))
Piece = read_as(_Piece, table_of(_Piece))


def _by_matrices(*, file: str | tuple[str, ...] | None = None, **arguments: Any) -> _Section:
    """A section by its stiffness and mass matrices, in SI; rows: stretch, shears y and z, twist, curvatures y and z."""
    matrices = {"stiffness", "mass"} & arguments.keys()
    if file is not None:
        if matrices:
            raise InputError("file", "is given beside matrices", "keep one of them")
        with naming({"path": "file", "paths": "file"}):
            return _Section.read(*((file,) if isinstance(file, str) else file), **arguments)
    for name in ("stiffness", "mass"):
        if name not in matrices:
            raise InputError("", f"{name} is missing", "give stiffness and mass, (6, 6) each, or file of VABS or BECAS")
    for name in ("length_unit", "mass_unit"):
        if name in arguments:
            raise InputError(name, "is given without a file", "leave it out: matrices are in SI")
    return _Section.of_matrices(**arguments)


def _outlined(**drawing: Any) -> Callable[[_Material], _Section]:
    """A section of one material by its outline, whose matrices sectionproperties computes: `gbeam[sections]`."""
    return lambda material: _Section.drawn(material=material, **drawing)


def _shape(section: Any) -> str | None:
    """Shape of a section: general where it is not written beside properties."""
    if not isinstance(section, dict):
        return getattr(section, "shape", None)
    by_properties = any(key in section for key in ("area", "inertia_y", "inertia_z"))
    shape = section.get("shape", "general" if by_properties else None)
    return shape if shape is None or isinstance(shape, str) else str(shape)


_Files = OneOrSome[File]
_FILE = (
    "file of VABS (.K) or BECAS (.out) with both matrices instead, or one per station; relative to the folder of the "
    "scenario file"
)
Rectangle = table_of(_Section.rectangle, name="Rectangle", tag=("shape", "rectangle"))
Circle = table_of(_Section.circle, name="Circle", tag=("shape", "circle"))
Tube = table_of(_Section.tube, name="Tube", tag=("shape", "tube"))
General = table_of(_Section.general, name="General", tag=("shape", "general"), known=True)
ByMatrices = table_of(
    _by_matrices,
    _Section.of_matrices,
    _Section.read,
    name="ByMatrices",
    tag=("shape", "matrices"),
    without={"paths"},
    optional={"stiffness", "mass", "length_unit", "mass_unit"},
    changed={"file": (_Files | None, Field(default=None, description=_FILE))},
)
Drawn = table_of(_outlined, _Section.drawn, name="Drawn", tag=("shape", "drawn"), without={"material"})
_SECTIONS = {
    "rectangle": Rectangle,
    "circle": Circle,
    "tube": Tube,
    "general": General,
    "matrices": ByMatrices,
    "drawn": Drawn,
}
Section = read_as(
    _Section,
    chosen("shape", _SECTIONS, _shape),
)


def _line(
    *,
    points: Any = None,
    length_unit: Annotated[
        str | None, "unit of x, y and z in a file that does not say it, in brackets or a row of units"
    ] = None,
    smooth: Annotated[bool, "false if the points are corners of straight pieces, not of a cubic spline"] = True,
    pieces: Annotated[Sequence[_Piece] | None, "[ { length, twist, turn_y, turn_z } ] from root to tip"] = None,
    stations: Annotated[
        Sequence[Position] | None, "positions of the twist on a straight line, from root to tip"
    ] = None,
    twist: Annotated[
        Sequence[Angle] | None, "angle of the section about the line at each point or station, linear in between"
    ] = None,
) -> _Line:
    """The line along which a beam lies at rest: by points, by pieces, or straight with a twist at stations."""
    ways = {"points": points, "pieces": pieces, "stations": stations}
    way, *other_ways = [name for name, value in ways.items() if value is not None] or [""]
    if not way or other_ways:
        problem = f"{other_ways[0]} is given beside {way}" if other_ways else "the line is missing"
        raise InputError("", problem, "give one of points, pieces and stations")
    of_file = isinstance(points, str)
    if length_unit is not None and not of_file:
        raise InputError("length_unit", "is given without a file", "leave it out")
    if pieces is not None:
        if twist is not None:
            raise InputError("twist", "is given beside pieces", "give each piece its own twist")
        lengths = [piece.length for piece in pieces]
        turns = {name: [getattr(piece, name) for piece in pieces] for name in ("twist", "turn_y", "turn_z")}
        return _Line.of_pieces(lengths, **turns)
    if of_file:
        with placing_within("points"):
            return read_line(points, length_unit, twist, smooth)
    if stations is not None and twist is None:
        raise InputError("", "twist is missing beside stations", 'add twist = ["0 deg", "10 deg"]')
    places = points if stations is None else [(x, 0.0, 0.0) for x in stations]
    if twist is not None and len(twist) != len(places):
        raise InputError("twist", f"has {len(twist)} values for {len(places)} {way}", f"give one for each of the {way}")
    return _Line.of_points(places, twist or 0.0, smooth=smooth and stations is None)


_Places = Annotated[
    Annotated[str, AfterValidator(existing_file), Tag("one")]
    | Annotated[tuple[Place3, ...], Field(max_length=ENTRIES), Tag("list")],
    ONE_OR_LIST,
]
_POINTS = (
    "places in base axes, [x, y, z], from the root, [0, 0, 0]; or a file of text with a row for each, relative to the "
    "folder of the scenario file: columns x, y, z, of which those left out are zero, and twist"
)
Line = read_as(
    _Line,
    table_of(_line, name="Line", changed={"points": (_Places | None, Field(default=None, description=_POINTS))}),
)


def beam_of(
    *,
    section: _Section | Callable[[_Material], _Section],
    material: _Material | None = None,
    line: _Line | None = None,
    **arguments: Any,
) -> _Beam:
    """The beam: held at its root by the moving base, straight along x or along a line.

    Its length is that of the line where it is not written, and a drawn section has its material.
    """
    if "length" not in arguments and line is not None:
        arguments["length"] = line.length
    if "length" not in arguments:
        raise InputError("", "length is missing", 'add length = "20 mm": length from root to tip')
    if callable(section):
        if material is None:
            raise InputError("", "material is missing", "add material = { density, youngs_modulus }: of the drawing")
        with placing_within("section"):
            section, material = section(material), None
    return _Beam(section=section, material=material, line=line, **arguments)


Beam = table_of(beam_of, _Beam, name="Beam", optional={"length"})


def _counts(**counts: int) -> dict[str, Any]:
    """Numbers of shape functions."""
    return counts


def model_of(
    kind: ModelKind, modes: dict[str, Any] | None = None, shapes: Shapes | None = None
) -> Callable[[_Beam], _Model]:
    """The model of a beam's deformation: of these numbers of shapes, or of those that are chosen for the beam."""

    def model(beam: _Beam) -> _Model:
        if modes is not None:
            return _Model(kind, shapes=shapes or "clamped-free", **modes)
        return _Model.of(kind, shapes or ("clamped-free" if beam.coupled else None))

    return model


_COUNTS = {"axial", "y", "z", "twist", "shear_y", "shear_z"}
_MODES = (
    "numbers of shapes: { axial, y, z, twist, shear_y, shear_z }; where left out, `run` raises those of axial, y and z "
    "until they are enough"
)
Modes = table_of(_counts, _Model, name="Modes", without={"kind", "shapes", "automatic"})
Model = table_of(
    model_of,
    _Model,
    name="Model",
    without={*_COUNTS, "automatic"},
    optional={"shapes"},
    changed={"modes": (Modes | None, Field(default=None, description=_MODES))},
)
