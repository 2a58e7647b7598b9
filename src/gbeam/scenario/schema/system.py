"""[bodies], [joints], [forces], [controllers] and [system]: a tree of bodies in place of one beam.

Tables of joints follow from the kinds of joint that there are: by the names of their coordinates they know which are
displacements and which are angles, and so the units of everything about them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial, reduce
from itertools import combinations
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, StrictBool, Tag, create_model, model_validator
from pydantic_core import PydanticCustomError

from gbeam.guards.limits import ENTRIES
from gbeam.mechanics.tree.equations import SLIP, SLIPS
from gbeam.mechanics.tree.joints import COUPLINGS, GROUND, KINDS, SLIDES, Kind, kind_of_value
from gbeam.scenario.bodies import BODIES
from gbeam.scenario.bodies.common import Direction, Name
from gbeam.scenario.schema.fields import (
    Acceleration,
    Duration,
    File,
    Loc,
    Place3,
    Quantity,
    Ratio,
    Sign,
    Table,
    Time,
    Turn3,
    Vector,
    optional,
    refuse,
    wrong,
)
from gbeam.scenario.schema.profile import ForceOverTime, MomentOverTime, SpeedOverTime, TurnOverTime
from gbeam.scenario.schema.scenario import Environments, Titled


def _kind(body: Any) -> str | None:
    if not isinstance(body, Mapping):
        return getattr(body, "kind", None)
    by_key = (name for name, kind in BODIES.items() if kind.known_by and kind.known_by in body)
    kind = body.get("kind", next(by_key, None))
    return kind if kind is None or isinstance(kind, str) else str(kind)


if TYPE_CHECKING:
    Body = Any
else:
    _TABLES = (Annotated[each.table, Tag(name)] for name, each in BODIES.items())
    Body = Annotated[reduce(or_, _TABLES), Discriminator(_kind)]


_OVER_TIME = {"speed": SpeedOverTime, "angular rate": TurnOverTime, "force": ForceOverTime, "torque": MomentOverTime}


def _number(kind: str, sign: Sign = "any") -> Any:
    return Annotated[float, Quantity(kind, sign)]


_size = partial(_number, sign="zero or more")


def _pair(kind: str) -> Any:
    return tuple.__class_getitem__((_number(kind), _number(kind)))


# By key about coordinates: a function from the kind of quantity to the type of its value, and its words.
_ABOUT: dict[str, tuple[Callable[[str], Any], str]] = {
    "initial": (_number, "coordinate at the start"),
    "initial_rate": (_number, "rate at the start"),
    "stiffness": (_size, "spring"),
    "ease": (_number, "coordinate at which the spring has no force"),
    "damping": (_size, "damper"),
    "friction": (
        _size,
        f"Coulomb friction, times tanh(rate/{SLIP:g}), the rate in m/s or rad/s: less below {' and '.join(SLIPS)}, so "
        "that what it holds creeps",
    ),
    "stops": (_pair, "lowest and highest coordinate, at which stops begin to give way"),
    "stop_stiffness": (_size, "stiffness of the stops"),
    "rate": (_OVER_TIME.__getitem__, "prescribed rate, instead of effort: a quantity or a profile"),
    "effort": (_OVER_TIME.__getitem__, "force or torque of a drive: a quantity or a profile"),
}


class Coordinates(Table):
    """Values by the names of a joint's coordinates."""

    model_config = ConfigDict(json_schema_extra={"x-coordinates": True})


def _table(base: type[Table], name: str, about: str, fields: Mapping[str, Any]) -> Any:
    """Create a table with these fields, and make it a name of this module, by which it is pickled."""
    table = create_model(name, __base__=base, __module__=__name__, __doc__=about, **dict(fields))
    globals()[name] = table
    return table


def _optional(of: Any, description: str) -> tuple[Any, Any]:
    return (of | None, optional(description))


def _joint(name: str, kind: Kind) -> Any:
    """Table of a kind of joint; values are written plainly for one coordinate, in tables by name for several."""
    hung = 'what it hangs on: "ground", or a point of a body, such as "bus.left"; "bus.root" is its root'
    turn = "rotation vector of the body's root axes in those of the point, where all coordinates are zero: [x, y, z]"
    fields: dict[str, Any] = {
        "kind": (Literal[name], Field(description="kind of the joint")),
        "body": (str, Field(description="NAME of the body that it holds, by its root")),
        "on": (str, Field(default=GROUND, description=hung)),
    }
    if kind.axes:
        vectors = ", ".join(["[x, y, z]"] * kind.axes)
        second = ", the second as it stands at a first angle of zero" if kind.axes > 1 else ""
        listed = Annotated[tuple[Direction, ...], Field(min_length=kind.axes, max_length=kind.axes)]
        fields["axes"] = (listed, Field(description=f"directions in axes of the point{second}: [{vectors}]"))
    fields["at"] = (Place3, Field(default=(0.0, 0.0, 0.0), description="place of the joint from the point: [x, y, z]"))
    fields["turn"] = (Turn3, Field(default=(0.0, 0.0, 0.0), description=turn))
    for key, (type_of, words) in _ABOUT.items():
        names = kind.names_in(key)
        within = {coordinate: _optional(type_of(kind_of_value(key, coordinate)), words) for coordinate in names}
        if len(names) == 1:
            fields[key] = within[names[0]]
        elif names:
            title = f"{name}_{key}".title().replace("_", "")
            table = _table(Coordinates, title, f"{words[0].upper()}{words[1:]}, by coordinate.", within)
            fields[key] = _optional(table, f"{words}: {{ {', '.join(names)} }}")
    if len(kind.value_names) > 1:
        words = "stiffness between two coordinates"
        within = {
            f"{one}_{two}": (Annotated[float, Quantity(COUPLINGS[(one in SLIDES) + (two in SLIDES)])] | None,
                             optional(words, alias=f"{one}-{two}"))
            for one, two in combinations(kind.value_names, 2)
        }  # fmt: skip
        title = f"{name}_coupling".title().replace("_", "")
        table = _table(Coordinates, title, "Coupling, by two coordinates.", within)
        first = "-".join(kind.value_names[:2])
        fields["coupling"] = _optional(table, f"{words} that have springs, by both names: {{ {first}, ... }}")
    return _table(Table, name.title(), f"{kind.words[0].upper()}{kind.words[1:]}.", fields)


_JOINTS = [_joint(name, kind) for name, kind in KINDS.items()]
if TYPE_CHECKING:  # type checkers make no tables
    Joint = Any
else:
    Joint = Annotated[reduce(or_, _JOINTS), Discriminator("kind")]


_Rate = Annotated[float, Quantity("angular rate", "positive")]
_Rows = tuple[tuple[Ratio, ...], ...]
_SI = "in SI units of effort and measurement"


class Gains(Table):
    """State feedback: every effort is a sum of gains times errors."""

    kind: Literal["gains"] = Field(description="kind of the law")
    gains: _Rows = Field(min_length=1, description=f"a row for every effort, a gain for every measurement, {_SI}")


class PID(Table):
    """Proportional, integral and derivative gain of one error."""

    kind: Literal["pid"] = Field(description="kind of the law")
    kp: Ratio = Field(default=0.0, description=f"proportional gain, {_SI}")
    ki: Ratio = Field(default=0.0, description=f"integral gain, {_SI} s")
    kd: Ratio = Field(default=0.0, description=f"derivative gain, {_SI}/s")
    smoothing: Duration | None = optional("time constant of the filter of the derivative: needed with kd")

    @model_validator(mode="after")
    def _filtered(self) -> PID:
        if self.kd and self.smoothing is None:
            refuse([((), wrong("smoothing is missing", 'a derivative needs a filter: smoothing = "50 ms"'))])
        return self


class LeadLag(Table):
    """Lead or lag: gain (1 + s/zero)/(1 + s/pole) of one error."""

    kind: Literal["lead-lag"] = Field(description="kind of the law")
    gain: Ratio = Field(description=f"gain at rest, {_SI}")
    zero: _Rate = Field(description="zero, such as 1 Hz")
    pole: _Rate = Field(description="pole: above the zero a lead, below it a lag")


class Notch(Table):
    """A notch at a vibration: a gain of one but near its frequency."""

    kind: Literal["notch"] = Field(description="kind of the law")
    frequency: _Rate = Field(description="of the notch, such as 4.2 Hz")
    depth: Ratio = Field(description="gain at the frequency, such as 0.1")
    damping: Annotated[float, Quantity("ratio", "positive")] = Field(description="half the width over the frequency")


class Matrices(Table):
    """A law with states of its own: x' = A x + B e, efforts = C x + D e, by rows or from a file."""

    kind: Literal["state-space"] = Field(description="kind of the law")
    file: File | None = optional(
        "file of matrices A, B, C, D: .npz, .mat or .json, relative to the scenario's folder; with dt, Ts "
        "or step, s, above zero it is in discrete time, and then the only law"
    )
    a: _Rows | None = optional("A, by rows, in continuous time")
    b: _Rows | None = optional("B, by rows: a column for every measurement")
    c: _Rows | None = optional("C, by rows: a row for every effort")
    d: _Rows | None = optional("D, by rows")

    @model_validator(mode="after")
    def _one_way(self) -> Matrices:
        matrices = [name for name in "abcd" if getattr(self, name) is not None]
        if self.file is not None and matrices:
            refuse([((matrices[0],), wrong("is given beside file", "give the matrices or their file", mark="key"))])
        if self.file is None and len(matrices) < 4:
            lacking = next(name for name in "abcd" if name not in matrices)
            refuse([((), wrong(f"{lacking} is missing", 'give a, b, c and d, or file = "controller.mat"'))])
        return self


Law = Annotated[Gains | PID | LeadLag | Notch | Matrices, Discriminator("kind")]


class Controller(Table):
    """A controller that samples measurements and holds its efforts; its laws act on reference less measurement."""

    measure: tuple[str, ...] = Field(
        min_length=1,
        max_length=ENTRIES,
        description='what is sampled: "joint.angle", "joint.angle_rate", "body.point.place_x", velocity_x, '
        "attitude_x (rotation vector, rad), acceleration_x, spin_x, of a section of a beam force_x, moment_y",
    )
    drive: tuple[str, ...] = Field(
        min_length=1, max_length=ENTRIES, description='efforts: "joint.angle", "force.force_x", "force.moment_z"'
    )
    law: tuple[Law, ...] = Field(min_length=1, description="laws one after the other: [{ kind, ... }, ...]")
    sample: Duration = Field(description="time between samples")
    delay: Time = Field(default=0.0, description="time from a sample until its efforts act")
    limit: tuple[Annotated[float, Quantity("ratio", "positive")], ...] | None = optional(
        "largest size of every effort, N or N m: [20]"
    )
    reference: tuple[Ratio, ...] | None = optional("aim of every measurement, in SI units; zero unless given: [0.5, 0]")


class PointForces(Vector):
    """A force on a point by components, each a quantity or a profile; those left out are zero."""

    x: ForceOverTime | None = optional("component along x")
    y: ForceOverTime | None = optional("component along y")
    z: ForceOverTime | None = optional("component along z")


class PointMoments(Vector):
    """A moment on a point by components, each a quantity or a profile; those left out are zero."""

    x: MomentOverTime | None = optional("component about x")
    y: MomentOverTime | None = optional("component about y")
    z: MomentOverTime | None = optional("component about z")


class PointForce(Table):
    """A force and a moment on a point, such as thrust."""

    on: str = Field(description='the point: "bus.nozzle"')
    force: PointForces | None = optional("force on the point: { x, y, z }")
    moment: PointMoments | None = optional("moment on the point: { x, y, z }")
    follower: StrictBool = Field(
        default=False, description="true if the components turn with the point; false if they keep to the ground's axes"
    )

    @model_validator(mode="after")
    def _any(self) -> PointForce:
        if self.force is None and self.moment is None:
            fix = 'give force or moment, such as force = { z = "5 N" }, or { z = 0 } where a controller drives it'
            refuse([((), wrong("the force is missing", fix))])
        return self


class Surroundings(Table):
    """[system]: loads that act on all bodies."""

    gravity: tuple[Acceleration, Acceleration, Acceleration] | None = optional(
        'acceleration of free fall, axes of the ground: [0, 0, "-1 g"]; none on a motion'
    )


class Tree(Titled):
    """Bodies and what joins them."""

    bodies: dict[Name, Body] = Field(
        min_length=1,
        description="bodies, each [bodies.NAME]: instead of [beam] and [model]; one alone, without joints, is a "
        "specimen on the moving base",
    )
    joints: dict[Name, Joint] = Field(description="one for every body, which holds it by its root: [joints.NAME]")
    forces: dict[Name, PointForce] = Field(
        default_factory=dict, description="forces and moments on points, each [forces.NAME]"
    )
    controllers: dict[Name, Controller] = Field(
        default_factory=dict, description="controllers in the loop, each [controllers.NAME]"
    )
    system: Surroundings = Field(default_factory=Surroundings, description="what acts on all bodies")


def _stations(scenario: Environments) -> Iterator[tuple[Loc, PydanticCustomError]]:
    """Error of stations that are not given to the beam that they are of."""
    if scenario.response.stations is not None:
        hint = "give them to a beam: [bodies.NAME] stations = [...]; other output is at the points of the bodies"
        yield ("response", "stations"), wrong("is given beside bodies", hint, mark="key")


_BESIDE = {
    "beam": 'give the beam as a body: [bodies.NAME] with kind = "beam"',
    "model": "give each beam its own: [bodies.NAME.model]",
}


class SystemScenario(Environments, Tree):
    """A validated scenario of a system of bodies: SI floats throughout, frozen."""

    @model_validator(mode="before")
    @classmethod
    def _alone(cls, data: Any) -> Any:
        both = [name for name in _BESIDE if isinstance(data, dict) and name in data and "bodies" in data]
        refuse([((name,), wrong("is given beside bodies", _BESIDE[name], mark="key")) for name in both])
        return data

    def about_structure(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of keys that a system must not have or lacks."""
        yield from _stations(self)


class _Specimen(Titled):
    bodies: dict[Name, Body] = Field(
        min_length=1, max_length=1, description="the specimen on the moving base, [bodies.NAME]"
    )


class SpecimenScenario(Environments, _Specimen):
    """A validated scenario of one body alone on the moving base: SI floats throughout, frozen."""

    @property
    def specimen(self) -> tuple[str, Any]:
        """Name and table of the body."""
        return next(iter(self.bodies.items()))

    def about_structure(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of keys that are of a beam only."""
        yield from _stations(self)
