"""Supports of a body: places that the base holds, rigidly or by springs and dampers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, get_args

from gbeam.arrays.namespace import is_jax
from gbeam.arrays.tree import Value
from gbeam.constants import Direction
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, positive
from gbeam.guards.quantities import NamedPosition
from gbeam.structure.attachments import Root

DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
_UNITS = {"stiffness": ("N/m", "N m/rad"), "damping": ("N s/m", "N m s/rad")}
# Springs of a root by the directions that they give way along.
ROOT: dict[Direction, str] = {
    direction: f"{'rotation' if direction.startswith('r') else 'translation'}_{direction[-1]}"
    for direction in DIRECTIONS
}


@dataclass(frozen=True)
class Label:
    """Name of a place that is held, and what holds it: in words, and by its directions with spaces between."""

    name: str
    words: str
    rigid: str
    yielding: str


@typed
@dataclass(frozen=True, eq=False)
class Support(Value):
    """A place of a body that the base holds, in directions of the root's axes.

    Raises
    ------
    InputError
        If the place is impossible, a direction is unknown or stands twice, a stiffness is not positive, a damping is
        negative or of a direction that is held rigidly, or nothing is held.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> rail = gb.Support(at=0.3, holds=["z"])
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), supports=[rail])
    >>> lowest = gb.modes(gb.assemble(beam, "FOAM", axial=1, z=4)).frequency[0]
    >>> print(f"{lowest:.1f} Hz")  # 4.39 times that of the cantilever
    160.3 Hz
    """

    at: Annotated[
        NamedPosition,
        "of a beam the position from the root, or the name of a point of it, such as tip; 0 says what the root itself "
        "holds. Of a mesh the name of a group, whose nodes are held each, of a point, or of an interface or rigid "
        "link, held by its mean motion; of matrices and rigid bodies the name of "
        "a point",
    ]
    holds: Annotated[
        Sequence[Direction],
        "directions that are held, of x, y, z and the rotations rx, ry, rz, in axes of the root: rigidly, or by the "
        "stiffness that is given",
    ] = ()
    stiffness: Annotated[
        Mapping[Direction, float], "springs by direction: { z, ry }; a direction with a spring need not stand in holds"
    ] = field(default_factory=dict)
    damping: Annotated[Mapping[Direction, float], "dampers by direction, beside springs or alone: { z, ry }"] = field(
        default_factory=dict
    )

    def __post_init__(self) -> None:
        """Refuse unknown and repeated directions, impossible values, and a support that holds nothing."""
        object.__setattr__(self, "holds", tuple(self.holds))
        for i, direction in enumerate(self.holds):
            choice(f"holds[{i}]", direction, DIRECTIONS)
            if direction in self.holds[:i]:
                raise InputError(f"holds[{i}]", f"is {direction!r} a second time", "give every direction once")
        for name, values in (("stiffness", self.stiffness), ("damping", self.damping)):
            object.__setattr__(self, name, dict(values))
            for direction, value in values.items():
                choice(f"{name}.{direction}", direction, DIRECTIONS)
                if not is_jax(value):
                    unit = _UNITS[name][direction.startswith("r")]
                    positive(f"{name}.{direction}", value, unit, zero=name == "damping")
        for direction in self.damping:
            if direction in self.rigid:
                fix = "leave it out, or give the direction a stiffness"
                raise InputError(f"damping.{direction}", f"damps {direction}, which is held rigidly", fix)
        if not (self.holds or self.stiffness or self.damping):
            raise InputError("holds", "is empty", 'say what is held, such as holds = ["y", "z"]')

    @property
    def place(self) -> float:
        """Position from the root, m: where it names a point, of one that stands on a beam."""
        assert not isinstance(self.at, str)
        return self.at

    @property
    def name(self) -> str:
        """Name of the place, of one on a mesh or matrices. Of a position it is that in mm, or from 1 m on in m."""
        if isinstance(self.at, str):
            return self.at
        return f"{self.at:.4g} m" if self.at >= 1 else f"{1e3 * self.at:.4g} mm"

    @property
    def rigid(self) -> tuple[Direction, ...]:
        """Directions that are held rigidly."""
        return tuple(direction for direction in self.holds if direction not in self.stiffness)

    @property
    def yielding(self) -> tuple[Direction, ...]:
        """Directions that springs or dampers hold."""
        return tuple(direction for direction in DIRECTIONS if direction in self.stiffness or direction in self.damping)

    @property
    def words(self) -> str:
        """Directions that are held, rigidly, by springs and by dampers: ``holds y z, spring ry``."""
        kinds = {"holds": self.rigid, "spring": (*self.stiffness,), "damper": (*self.damping,)}
        ordered = {kind: [way for way in DIRECTIONS if way in ways] for kind, ways in kinds.items()}
        return ", ".join(f"{kind} {' '.join(ways)}" for kind, ways in ordered.items() if ways)

    @property
    def label(self) -> Label:
        """The place and what is held, for lists and pictures."""
        return Label(self.name, self.words, " ".join(self.rigid), " ".join(self.yielding))


def root_held(support: Support) -> Root:
    """Root that a support at it makes: with springs where it gives way, and with none where nothing holds it."""
    springs: dict[str, Any] = {
        name: support.stiffness.get(direction, 0.0)
        for direction, name in ROOT.items()
        if direction not in support.rigid
    }
    return Root(**springs)
