"""Attachments of a beam: bodies and loads on it, and a root that springs hold."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, positive
from gbeam.guards.kinds import kinds

if TYPE_CHECKING:
    from gbeam.motion import Profile


TIP = "tip"
_NAME = re.compile(r"[A-Za-z_]\w*")
# Of quantities that stand where a point's name may stand.
_TAKEN = (TIP, "root_force", "root_moment", "hub", "strain", "size")


def checked_name(name: str) -> None:
    """Raise InputError unless a name is one word, and not that of a quantity."""
    if not _NAME.fullmatch(name) or name in _TAKEN:
        fix = f"give letters, digits and underscores, and none of {', '.join(_TAKEN)}"
        raise InputError("name", f"is {name!r}", fix)


@typed
@dataclass(frozen=True, eq=False)
class Point(Value):
    """A named point of output.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    at : float
        Position from the root, m.

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

    name: str
    at: float

    def __post_init__(self) -> None:
        checked_name(self.name)
        positive("at", self.at, "m", zero=True)


@typed
@dataclass(frozen=True, eq=False)
class PointMass(Value):
    """A mass, or a small rigid body, fixed to the beam.

    Parameters
    ----------
    at : float
        Position from the root, m.
    mass : float
        kg.
    inertia : tuple of float
        Principal moments of inertia about its centre, axes of the section (x, y, z), kg m²; zero for a point.
    offset : tuple of float
        Centre of mass from the beam's axis, in axes of the section, m.
    name : str
        Of the point of the beam at `at`, where output is then given.

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

    at: float
    mass: float
    inertia: Numbers = (0.0, 0.0, 0.0)
    offset: Numbers = (0.0, 0.0, 0.0)
    name: str = ""

    def __post_init__(self) -> None:
        if self.name:
            checked_name(self.name)
        positive("at", self.at, "m", zero=True)
        positive("mass", self.mass, "kg", zero=True)
        for name, values in (("inertia", self.inertia), ("offset", self.offset)):
            if len(values) != 3 or not all(is_jax(v) or math.isfinite(v) for v in values):
                raise InputError(name, f"is {values!r}", "give three finite values, along x, y and z")
        if self._traced:
            return
        for axis, value in zip("xyz", self.inertia, strict=True):
            positive(f"inertia.{axis}", value, "kg m²", zero=True)
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


def _spread(arguments: Mapping[str, Any]) -> bool:
    return arguments.get("at") is None


@kinds(
    force=lambda arguments: "force per length" if _spread(arguments) else "force",
    moment=lambda arguments: "force" if _spread(arguments) else "torque",  # N m/m
)
@typed
@dataclass(frozen=True, eq=False)
class Load(Value):
    """A force and a moment at a station, or per length along the whole beam.

    Parameters
    ----------
    at : float or None
        Position from the root, m; None spreads the load evenly over the length.
    force, moment : sequence of three floats, or vector Profile of time, or None
        N and N m; N/m and N m/m where spread. Along x, y, z of the base axes, which a dead load keeps.
    follower : bool
        Whether the axes are those of the section, with which a following load turns.

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

    at: float | None = None
    force: Numbers | Profile | None = None
    moment: Numbers | Profile | None = None
    follower: bool = False

    def __post_init__(self) -> None:
        if self.at is not None:
            positive("at", self.at, "m", zero=True)
        if self.force is None and self.moment is None:
            raise InputError("", "has neither force nor moment", "give one of them, or both")
        for name, value in (("force", self.force), ("moment", self.moment)):
            if value is None or callable(value):
                continue
            components = array(name, value)
            if components.shape != (3,) or not (is_jax(components) or np.isfinite(components).all()):
                raise InputError(name, f"is {value!r}", "give three finite components, along x, y and z, or a profile")


@typed
@dataclass(frozen=True, eq=False)
class Root(Value):
    """Springs between the base and the root; where there is none, the root is rigid in that direction.

    Each spring is one more coordinate of the model, in every kind of model, after the shapes' and in this order.

    Parameters
    ----------
    translation_x, translation_y, translation_z : float or None
        Along the base axes, N/m.
    rotation_y, rotation_z : float or None
        About them, N m/rad: y for bending along z, z for bending along y.

    Raises
    ------
    InputError
        If a stiffness is not positive and finite.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> hinge = gb.Root(rotation_y=50.0)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), root=hinge)
    >>> lowest = gb.modes(gb.assemble(beam, "FOAM", axial=1, z=4)).frequency[0]
    >>> print(f"{lowest:.2f} Hz")
    20.99 Hz
    """

    translation_x: float | None = None
    translation_y: float | None = None
    translation_z: float | None = None
    rotation_y: float | None = None
    rotation_z: float | None = None

    def __post_init__(self) -> None:
        for name, value in self.springs.items():
            positive(name, value, "N/m" if name.startswith("translation") else "N m/rad")

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
