"""Attachments of a beam: bodies and loads on it, and a root that springs hold."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array
from gbeam.guards.limits import NAME
from gbeam.guards.quantities import NAME_OF_POINT, Components, Mass, NamedPosition, Position, PositionVector, Quantity
from gbeam.motion.profiles.profile import Profile
from gbeam.printable import shortened

TIP = "tip"
FORCE = Components(
    "A force, or one per length, by components, each a quantity or a profile; those left out are zero.",
    x="component along the beam",
    y="component along the width",
    z="component through the thickness",
)
MOMENT = Components(
    "A moment, or one per length, by components, each a quantity or a profile; those left out are zero.",
    x="moment about x, along the beam",
    y="moment about y: positive bends the tip to -z",
    z="moment about z: positive bends the tip to +y",
)
_Spring = Annotated[float, Quantity("stiffness", "zero or more")]
_Turning = Annotated[float, Quantity("rotational stiffness", "zero or more")]
# Of quantities that stand where a point's name may stand.
_TAKEN = (TIP, "root_force", "root_moment", "hub", "strain", "size")


def checked_name(name: str) -> None:
    """Raise InputError unless a name is one word, and not that of a quantity."""
    if not re.fullmatch(NAME_OF_POINT, name) or name in _TAKEN:
        fix = f"give letters, digits and underscores, and none of {', '.join(_TAKEN)}"
        raise InputError("name", f"is {shortened(repr(name))}", fix)
    if len(name) > NAME:
        raise InputError("name", f"has {len(name)} characters", f"give {NAME} or fewer")


@typed
@dataclass(frozen=True, eq=False)
class Point(Value):
    """A named point of output.

    Raises
    ------
    InputError
        If the name is no word, or that of another quantity, such as tip; or the position is impossible.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> camera = gb.Point("camera", at=0.12)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01, points=[camera])
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> response = gb.simulate(gb.assemble(beam, "FOAM", z=2), turn, duration=6.0)
    >>> response.body.points, response.body.at("camera").shape[1:]
    (('camera', 'tip'), (3,))
    """

    name: Annotated[str, "letters, digits and underscores"]
    at: Annotated[Position, "position from the root, along the beam"]

    def __post_init__(self) -> None:
        checked_name(self.name)


@typed
@dataclass(frozen=True, eq=False)
class PointMass(Value):
    """A mass, or a small rigid body, fixed to the beam.

    Raises
    ------
    InputError
        If a value is impossible, or the moments break the triangle inequality of a rigid body.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> sensor = gb.PointMass(at=0.3, mass=0.02, offset=(0.0, 0.0, 0.005))
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), masses=[sensor])
    >>> print(gb.modes(gb.assemble(beam, "FOAM", axial=1, z=3)).frequency[:2].round(1))
    [ 24.3 182.6]
    """

    at: Annotated[Position, "position from the root, along the beam"]
    mass: Annotated[Mass, "mass"]
    inertia: Annotated[
        Numbers,
        Quantity("moment of inertia", "zero or more"),
        Components(
            "Principal moments of inertia, in axes of the section.",
            x="moment about x, along the beam",
            y="moment about y, along the width",
            z="moment about z, through the thickness",
        ),
        "principal moments of inertia (x, y, z) about its centre, in axes of the section; zero for a point",
    ] = (0.0, 0.0, 0.0)
    offset: Annotated[PositionVector, "centre of mass from the beam's axis: [x, y, z] in axes of the section"] = (
        0.0,
        0.0,
        0.0,
    )
    name: Annotated[str, "name of the point of output at its place"] = ""

    def __post_init__(self) -> None:
        """Refuse a name or an inertia that no body has."""
        if self.name:
            checked_name(self.name)
        for name, values in (("inertia", self.inertia), ("offset", self.offset)):
            if len(values) != 3:
                raise InputError(name, f"is {values!r}", "give three values, along x, y and z")
        if self._traced:
            return
        if any(self.inertia) and self.mass == 0:
            raise InputError("mass", "is 0 kg with a moment of inertia", "give the body its mass")
        if min(self.second_moments) < -1e-12 * max(self.inertia):
            raise InputError(
                "inertia",
                f"is {self.inertia!r} kg m²",
                "no moment of a rigid body exceeds the sum of the other two",
            )

    @property
    def second_moments(self) -> tuple[float, float, float]:
        """∫x² dm, ∫y² dm, ∫z² dm about the centre, kg m²."""
        jx, jy, jz = self.inertia
        return (jy + jz - jx) / 2, (jz + jx - jy) / 2, (jx + jy - jz) / 2

    def particles(self) -> tuple[Any, Any]:
        """Equivalent particles: masses (p,) kg and positions (p, 3) m from the beam's axis, in section axes.

        Six particles at ±sqrt(3 S_i/m) along the principal axes have the body's mass, centre and inertia, so that a
        rigid body needs no energy of its own; without inertia one particle is enough.
        """
        xp = namespace(self.mass, *self.inertia, *self.offset)
        centre = xp.asarray(self.offset)
        if not any(is_jax(moment) or moment for moment in self.inertia):
            return xp.reshape(xp.asarray(self.mass), (1,)), centre[None]
        arms = xp.diag(xp.sqrt(3 * xp.maximum(xp.asarray(self.second_moments), 0) / self.mass))
        return xp.full(6, self.mass / 6), centre + xp.concatenate([arms, -arms])

    @property
    def _traced(self) -> bool:
        """True if a value is JAX's, which has nothing to check."""
        return any(is_jax(value) for value in (self.mass, *self.inertia))


@typed
@dataclass(frozen=True, eq=False)
class Load(Value):
    """A force, a moment or both at a station; or spread evenly over the length.

    Raises
    ------
    InputError
        If the position is impossible, a component is not finite, or there is neither force nor moment.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> pull = gb.Load(at=0.3, force=(0.0, 0.0, -10.0))
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), loads=[pull])
    >>> rest = gb.static(gb.assemble(beam, "FOAM", axial=1, z=3))
    >>> print(f"{1e3 * rest.tip[2]:.2f} mm")
    -12.04 mm
    """

    at: Annotated[
        NamedPosition | None,
        "position of force and moment from the root, along the beam; or a point's name, such as tip",
    ] = None
    force: Annotated[Numbers | Profile | None, Quantity("force"), FORCE, "force at the station: { x, y, z }"] = None
    moment: Annotated[Numbers | Profile | None, Quantity("torque"), MOMENT, "moment at the station: { x, y, z }"] = None
    distributed: Annotated[
        Numbers | Profile | None,
        Quantity("force per length"),
        FORCE,
        "force per length over the whole beam: { x, y, z }; instead of at, force and moment",
    ] = None
    distributed_moment: Annotated[
        Numbers | Profile | None,
        Quantity("force"),
        MOMENT,
        "moment per length over the whole beam, in N m/m: { x, y, z }",
    ] = None
    follower: Annotated[bool, "true if the components turn with the section; false if they keep to the base axes"] = (
        False
    )

    def __post_init__(self) -> None:
        """Refuse a load without force and moment, one at a place beside a spread one, and a force without place."""
        at_station = {"force": self.force, "moment": self.moment}
        spread = {"distributed": self.distributed, "distributed_moment": self.distributed_moment}
        written = [name for name, value in at_station.items() if value is not None]
        spreads = [name for name, value in spread.items() if value is not None]
        if not written and not spreads:
            fix = 'give force, moment or distributed, such as force = { z = "5 N" }'
            raise InputError("", "has neither force nor moment", fix)
        if spreads and (self.at is not None or written):
            where = "at" if self.at is not None else written[0]
            raise InputError(where, f"is given beside {spreads[0]}", "make two loads of them")
        if written and self.at is None:
            raise InputError("", "at is missing", 'say where the load acts: at = "300 mm"')
        for name, value in (at_station | spread).items():
            if value is None or callable(value):
                continue
            components = array(name, value)
            if components.shape != (3,):
                raise InputError(name, f"is {value!r}", "give three finite components, along x, y and z, or a profile")

    @property
    def place(self) -> float:
        """Position from the root, m: where it names a point, of one that stands on a beam."""
        assert self.at is not None and not isinstance(self.at, str)
        return self.at

    @property
    def acting(self) -> tuple[Any, Any]:
        """Force N and moment N m at the station, or N/m and N m/m over the length; None where there is none."""
        return (self.distributed, self.distributed_moment) if self.at is None else (self.force, self.moment)


@typed
@dataclass(frozen=True, eq=False, kw_only=True)
class Root(Value):
    """Springs between the base and the root; where there is none, the root is rigid in that direction.

    Each spring is one more coordinate of the model, in every kind of model, after the shapes' and in this order.

    Raises
    ------
    InputError
        If a stiffness is negative or not finite.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> hinge = gb.Root(rotation_y=50.0)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), root=hinge)
    >>> lowest = gb.modes(gb.assemble(beam, "FOAM", axial=1, z=4)).frequency[0]
    >>> print(f"{lowest:.2f} Hz")
    20.99 Hz
    """

    translation_x: Annotated[_Spring | None, "spring along x, along the beam; 0 beside supports that hold x"] = None
    translation_y: Annotated[_Spring | None, "spring along y, along the width; 0 beside supports that hold y"] = None
    translation_z: Annotated[_Spring | None, "spring along z, through the thickness; 0 beside supports that hold z"] = (
        None
    )
    rotation_x: Annotated[_Turning | None, "spring about x, against turning; 0 beside supports that hold rx"] = None
    rotation_y: Annotated[_Turning | None, "spring about y, against bending along z; 0 for a pin, beside supports"] = (
        None
    )
    rotation_z: Annotated[_Turning | None, "spring about z, against bending along y; 0 for a pin, beside supports"] = (
        None
    )

    @property
    def springs(self) -> dict[str, float]:
        """The stiffnesses that are given, by name."""
        stiffnesses = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in stiffnesses.items() if value is not None}

    def directions(self) -> tuple[Floats, Floats]:
        """Matrices (3, springs) from the springs' stretches to the root's displacement and rotation vector."""
        move, turn = np.zeros((2, 3, len(self.springs)))
        for column, name in enumerate(self.springs):
            motion, axis = name.split("_")
            (move if motion == "translation" else turn)["xyz".index(axis), column] = 1.0
        return move, turn
