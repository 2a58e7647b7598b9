"""Joints: how a body hangs on a point of another, or on the ground. A new kind is one entry of :data:`JOINT_KINDS`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gbeam.arrays.namespace import as_array, concatenated, is_jax
from gbeam.arrays.tree import Value, assign, follows
from gbeam.constants import Coordinate, Direction, JointKind, Rate
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, choice, finite, positive, vector
from gbeam.guards.kinds import Kinds, kinds
from gbeam.guards.parameters import parameters_of
from gbeam.guards.quantities import OfCoordinate, PositionVector, RotationVector, Shape
from gbeam.mechanics.tree.course import Course
from gbeam.mechanics.tree.links import SLIP, SLIPS, Holder
from gbeam.mechanics.tree.steps import (
    Ball,
    Placed,
    Rotation,
    Slide,
    Step,
    parameter_rates,
    parameters_of_vector,
    rotation_matrix,
)
from gbeam.motion.profiles.combine import as_profile
from gbeam.motion.profiles.profile import Profile

Array = Any
Floats = NDArray[np.float64]
_Values = ArrayLike | Mapping[Coordinate, ArrayLike] | None  # of a single coordinate, or by name
_Rates = ArrayLike | Mapping[Rate, ArrayLike] | None
_Drives = Profile | ArrayLike | Mapping[Rate, Profile | ArrayLike] | None
GROUND = "ground"
_FRICTION = (
    f"Coulomb friction, times tanh(rate/{SLIP:g}), the rate in m/s or rad/s: less below {' and '.join(SLIPS)}, so that "
    "what it holds creeps"
)
_EYE = np.eye(3)
_EASY = ("stiffness", "ease", "damping", "friction", "stop_stiffness")
OF_RATES = ("initial_rate", "damping", "friction", "rate", "effort")  # keys by the names of rates
DIRECTIONS = get_args(Direction)
SLIDES = ("displacement", "x", "y", "z")  # coordinates in m; others are angles
COUPLINGS = ("rotational stiffness", "force", "stiffness")  # of two coordinates, by how many are displacements


def kind_of_value(key: str, coordinate: str) -> str:
    """Kind of quantity, such as "torque", that a joint's key takes for a coordinate."""
    mark = OF_COORDINATES[key]
    return mark.displacement if coordinate in SLIDES else mark.angle


def _kinds_of(key: str, arguments: Mapping[str, Any]) -> Kinds:
    """Kinds of what a key says of a joint, by its arguments."""
    name: Any = str(arguments.get("kind"))
    kind = JOINT_KINDS.get(name)
    return {} if kind is None else {name: kind_of_value(key, name) for name in kind.names_in(key)}


def _kinds_of_coupling(arguments: Mapping[str, Any]) -> Kinds:
    """Kinds of the stiffness between two coordinates, by both names."""
    pairs = arguments.get("coupling")
    names = pairs if isinstance(pairs, Mapping) else ()
    slides = {pair: sum(end in SLIDES for end in str(pair).split("-")[:2]) for pair in names}
    return {pair: COUPLINGS[count] for pair, count in slides.items()}


class Kind(NamedTuple):
    """A kind of joint.

    It has its motion in `words`, the function that makes its `steps` of its axes (k, 3), the `names` of their
    coordinates and the number k of `axes`. `rates` are the names of its rates where they differ from the coordinates',
    `sprung` the directions along which it gives way where these have a spring.
    """

    words: str
    steps: Callable[[Floats], tuple[Step, ...]]
    names: tuple[str, ...]
    axes: int = 0
    rates: tuple[str, ...] = ()
    sprung: tuple[str, ...] = ()

    @property
    def value_names(self) -> tuple[str, ...]:
        """Names of the values on which springs act: its coordinates, the rotation vector for Euler parameters."""
        names = tuple(name for name in self.names if name not in _BALL)
        return (*self.sprung, *names, *(_TURN if self.turns else ()))

    @property
    def turns(self) -> bool:
        """True if it ends with a ball."""
        return _BALL[0] in self.names

    def names_in(self, key: str) -> tuple[str, ...]:
        """Names that a key of the joint takes: of rates, or of values."""
        return self.rates if self.rates and key in OF_RATES else self.value_names


def _turns(axes: Floats) -> tuple[Step, ...]:
    return tuple(Rotation(axis[:, None], _EYE) for axis in axes)


_BALL, _PLACE = ("e0", "e1", "e2", "e3"), ("x", "y", "z")
_TURN, SPIN = ("rx", "ry", "rz"), ("wx", "wy", "wz")
JOINT_KINDS: dict[JointKind, Kind] = {
    "fixed": Kind("a clamp, or springs and dampers", lambda axes: (), (), sprung=DIRECTIONS),
    "revolute": Kind("a hinge: one angle", _turns, ("angle",), 1),
    "prismatic": Kind("a slide: one displacement", lambda axes: (Slide(axes.T),), ("displacement",), 1),
    "cylindrical": Kind(
        "a slide that turns about its axis", lambda axes: (Slide(axes.T), *_turns(axes)), ("displacement", "angle"), 1
    ),
    "universal": Kind("two angles, one after the other", _turns, ("angle_1", "angle_2"), 2),
    "spherical": Kind("any rotation", lambda axes: (Ball(),), _BALL, 0, SPIN),
    "free": Kind("any motion", lambda axes: (Slide(_EYE), Ball()), (*_PLACE, *_BALL), 0, (*_PLACE, *SPIN)),
}


@typed
@dataclass(frozen=True, eq=False)
class Joint(Value):
    """A joint that holds a body on a point of another body, or on the ground.

    Values are given by the names of coordinates: ``angle``, ``displacement``, ``angle_1``, ``angle_2``, ``x``, ``y``
    and ``z``. Of a single coordinate just the value is given. A spherical or free joint turns by the rotation vector
    ``rx``, ``ry``, ``rz``, of half a turn at most, from where `turn` sets it, at the angular velocity ``wx``, ``wy``,
    ``wz``. Both are in axes of the body: `initial`, `stiffness`, `ease` and `stops` are given by the former,
    `initial_rate`, `damping`, `friction`, `rate` and `effort` by the latter.

    A ``fixed`` joint gives way along and about the axes that have a stiffness: ``x``, ``y``, ``z``, ``rx``, ``ry``,
    ``rz``, the last three components of a rotation vector. Its `coupling` is the stiffness between two of them, by both
    names, such as ``{"y-rz": -2e4}``: with six springs it is the 6 × 6 stiffness of a fixture, in N/m, N and N m.

    What friction F holds against a load P creeps, by s artanh(P/F) with the rate s of its law. Equilibria and small
    departures are without friction. Coordinates with a prescribed `rate` are no unknowns, and what their drives need is
    a result; of ``wx``, ``wy`` and ``wz`` all three are prescribed, or none.

    Attributes
    ----------
    coordinates, values, rate_names : tuple of str
        Names of its coordinates, of the values on which its springs act (its coordinates, the rotation vector of a
        ball), and of the rates at which it moves.
    steps : tuple of Step
        The chain of elementary motions from the point to the root of the body.
    holder : Holder
        Springs, dampers, friction and stops.
    start, start_rate : (h,)
        Coordinates and their rates at the start.
    rates, efforts : dict of str to Profile
        Prescribed rates, and drives, by the names of rates.

    Raises
    ------
    InputError
        If a value is impossible or a name is no coordinate of the joint.

    Examples
    --------
    >>> hinge = gb.Joint("revolute", "panel", on="bus.left", axes=[(0, 1, 0)], stiffness=20.0, damping=0.1)
    >>> hinge.coordinates
    ('angle',)
    """

    kind: Annotated[
        JointKind,
        "kind of the joint: fixed, revolute (one angle), prismatic (one displacement), cylindrical (both along one "
        "axis), universal (two angles, one after the other), spherical (any rotation) or free (any motion)",
    ]
    body: Annotated[
        str, "NAME of the body that it holds, by its root, or a point that another joint moves: it closes a loop there"
    ]
    on: Annotated[
        str, 'what it hangs on: "ground", or a point of a body, such as "bus.left"; "bus.root" is its root'
    ] = GROUND
    axes: Annotated[
        ArrayLike | None,
        "directions in axes of the point, of any length: one of a revolute, prismatic or cylindrical joint, two of a "
        "universal one, the second as it stands at a first angle of zero",
    ] = None
    at: Annotated[PositionVector, "place of the joint from the point: [x, y, z]"] = (0.0, 0.0, 0.0)
    turn: Annotated[
        RotationVector | None,
        "rotation vector of the body's root axes in those of the point, where all coordinates are zero: [x, y, z]; "
        "none unless given, but of a joint that closes a loop the one by which its coordinates begin at zero",
    ] = None
    initial: Annotated[_Values, OfCoordinate("length", "angle"), "coordinate at the start"] = None
    initial_rate: Annotated[_Rates, OfCoordinate("speed", "angular rate"), "rate at the start"] = None
    stiffness: Annotated[_Values, OfCoordinate("stiffness", "rotational stiffness", "zero or more"), "spring"] = None
    ease: Annotated[_Values, OfCoordinate("length", "angle"), "coordinate at which the spring has no force"] = None
    damping: Annotated[_Rates, OfCoordinate("damping", "rotational damping", "zero or more"), "damper"] = None
    friction: Annotated[_Rates, OfCoordinate("force", "torque", "zero or more"), _FRICTION] = None
    stops: Annotated[
        _Values,
        OfCoordinate("length", "angle"),
        Shape((2,)),
        "lowest and highest coordinate, at which stops begin to give way",
    ] = None
    stop_stiffness: Annotated[
        _Values, OfCoordinate("stiffness", "rotational stiffness", "zero or more"), "stiffness of the stops"
    ] = None
    rate: Annotated[
        _Drives,
        OfCoordinate("speed", "angular rate"),
        "prescribed rate, instead of effort: a quantity or a profile",
    ] = None
    effort: Annotated[
        _Drives, OfCoordinate("force", "torque"), "force or torque of a drive: a quantity or a profile"
    ] = None
    coupling: Annotated[Any, "stiffness between two coordinates"] = None
    coordinates: tuple[str, ...] = follows()
    values: tuple[str, ...] = follows()
    rate_names: tuple[str, ...] = follows()
    steps: tuple[Step, ...] = follows()
    holder: Holder = follows()
    start: Array = follows()
    start_rate: Array = follows()
    rates: dict[str, Profile] = follows()
    efforts: dict[str, Profile] = follows()

    def __post_init__(self) -> None:
        """Check the axes and values, and derive from them the steps, the holder, the start and the profiles."""
        choice("kind", self.kind, JOINT_KINDS)
        axis_count = JOINT_KINDS[self.kind].axes
        axes = np.asarray(array("axes", () if self.axes is None else self.axes), dtype=float)
        axes = axes if axes.size else np.zeros((0, 3))
        if axes.shape != (axis_count, 3):
            problem = "is missing" if not axes.size else f"has the shape {axes.shape}"
            fix = f"give {axis_count} of 3 components each: a {self.kind} joint has as many"
            raise InputError("axes", problem, fix if axis_count else "leave it out")
        length = np.linalg.norm(axes, axis=1)
        if not (np.isfinite(length).all() and (length > 0).all()):
            raise InputError("axes", f"is {self.axes!r}", "give directions of finite length above zero")
        assign(self, axes=tuple(map(tuple, axes)))
        vector("at", self.at)
        if self.turn is not None:
            vector("turn", self.turn)
        if self.kind == "fixed":
            for name in (*_EASY, "stops"):
                if getattr(self, name) is not None and not isinstance(getattr(self, name), Mapping):
                    raise InputError(name, f"is {getattr(self, name)!r}", 'say of which directions: {"rx": 5000.0}')
            for direction in self._sprung:
                choice("stiffness", direction, DIRECTIONS)
        kind = JOINT_KINDS[self.kind]
        names, values = kind.names, kind.value_names
        if self.kind == "fixed":  # its springs' directions are its coordinates
            names = values = tuple(direction for direction in DIRECTIONS if direction in self._sprung)
        assign(self, coordinates=names, values=values, rate_names=kind.rates or names)
        assign(self, holder=self._holder(), steps=self._chained(), start=self._started())
        assign(self, start_rate=self._start_rates(), rates=self._prescribed())
        assign(self, efforts=self._driven())

    @property
    def _sprung(self) -> Mapping[Coordinate, ArrayLike]:
        """Springs that are named."""
        return self.stiffness if isinstance(self.stiffness, Mapping) else {}

    def numbers(self, rate: str) -> tuple[int, ...]:
        """Return the indices, among the joint's coordinates, of those that a rate moves: a spin, all Euler parameters.

        Parameters
        ----------
        rate : str
            One of ``rate_names``.
        """
        if rate in SPIN:
            return tuple(self.coordinates.index(parameter) for parameter in _BALL)
        return (self.coordinates.index(rate),)

    def start_flags(self, key: str) -> tuple[bool, ...]:
        """Return, for each coordinate, whether its value, or rate, at the start is given; of a ball by any component.

        Parameters
        ----------
        key : str
            "initial" or "initial_rate".
        """
        named = self._named(key, getattr(self, key))
        turns = any(name in named for name in (*_TURN, *SPIN))
        return tuple(turns if name in _BALL else name in named for name in self.coordinates)

    def row(self, rate: str) -> int:
        """Return the index, among the joint's equations, of the one on which an effort along a rate acts.

        Parameters
        ----------
        rate : str
            One of ``rate_names``.
        """
        # A ball's first equation keeps its Euler parameters at unit length.
        return self.numbers(rate)[1 + SPIN.index(rate) if rate in SPIN else 0]

    def _chained(self) -> tuple[Step, ...]:
        """Chain of elementary motions from the point that holds the joint to the root of the body."""
        turn = (0.0, 0.0, 0.0) if self.turn is None else self.turn
        placed = Placed(as_array(self.at), rotation_matrix(turn))
        axes = np.asarray(self.axes, dtype=float).reshape(-1, 3)
        steps = JOINT_KINDS[self.kind].steps(axes / np.linalg.norm(axes, axis=1, keepdims=True))
        if self.kind == "fixed" and self.coordinates:
            slide_axes = [k for k in range(3) if DIRECTIONS[k] in self.coordinates]
            turn_axes = [k for k in range(3) if DIRECTIONS[3 + k] in self.coordinates]
            steps = (Slide(_EYE[:, slide_axes]),) if slide_axes else ()
            steps += (Rotation(_EYE[:, turn_axes], _EYE),) if turn_axes else ()
        # The coordinates are in axes of the point, and the body is turned after them; a ball turns the body's axes.
        moves, turns = (is_jax(vector) or bool(vector.any()) for vector in map(as_array, (self.at, turn)))
        before = (Placed(placed.r, None),) if moves else ()
        after = (Placed(np.zeros(3), placed.R),) if turns else ()
        ball = len(steps) - JOINT_KINDS[self.kind].turns  # its index, or behind the last
        return before + steps[:ball] + after + steps[ball:]

    @property
    def loose(self) -> bool:
        """True if it has no spring, damper, friction or stop."""
        return all(getattr(self, name) is None for name in (*_EASY, "stops"))

    @property
    def sprung(self) -> bool:
        """True if it has a spring."""
        stiffness = self.holder.stiffness
        return is_jax(stiffness) or bool(stiffness.any())

    @property
    def floats(self) -> bool:
        """True if it is free, and neither a spring nor a prescribed rate holds its body."""
        return self.kind == "free" and not self.sprung and len(self.rates) < len(self.rate_names)

    @property
    def holds_turns(self) -> bool:
        """True if springs or stops hold the rotation vector of a ball."""
        if not JOINT_KINDS[self.kind].turns:
            return False
        return any(name in _TURN for key in ("stiffness", "stops") for name in self._named(key, getattr(self, key)))

    def _holder(self) -> Holder:
        """Springs, dampers, friction and stops. InputError if one is impossible, or does nothing without another."""
        values = {name: self._numbers(name, getattr(self, name)) for name in _EASY}
        for name in ("stiffness", "damping", "friction", "stop_stiffness"):
            for coordinate, value in zip(self._names(name), values[name], strict=True):
                positive(f"{name}.{coordinate}", value, "SI", zero=True)
        low, high = np.full(len(self.values), -np.inf), np.full(len(self.values), np.inf)
        for coordinate, pair in self._named("stops", self.stops).items():
            k = self.values.index(coordinate)
            ends = array(f"stops.{coordinate}", pair)
            if ends.shape != (2,) or not ends[0] < ends[1]:
                unit, ends_in_unit = ("m", ends) if coordinate in SLIDES else ("deg", np.degrees(ends))
                listed = ", ".join(f"{end:.6g} {unit}" for end in np.ravel(ends_in_unit))
                raise InputError(f"stops.{coordinate}", f"is {listed}", "give the lowest and the highest coordinate")
            low[k], high[k] = ends
            if not (is_jax(values["stop_stiffness"]) or values["stop_stiffness"][k] > 0):
                raise InputError("stop_stiffness", "is missing", f"a stop of {coordinate} needs one")
        for name, needed in (("ease", "stiffness"), ("stop_stiffness", "stops")):
            present = self._named(needed, getattr(self, needed))
            for coordinate in self._named(name, getattr(self, name)):
                if coordinate not in present:
                    fix = f"give {needed} of {coordinate} too, or leave it out"
                    raise InputError(f"{name}.{coordinate}", f"does nothing without {needed}", fix)
        coupling = self._coupling(values["stiffness"])
        return Holder(low=low, high=high, stop=values.pop("stop_stiffness"), coupling=coupling, **values)

    def _coupling(self, stiffness: Floats) -> Floats | None:
        """Stiffness (h, h) that couples pairs of values, or None without any.

        InputError unless it names pairs of values, and is positive semidefinite together with the springs' `stiffness`.
        """
        if self.coupling is None or self.coupling == {}:
            return None
        names = self.values
        if not isinstance(self.coupling, Mapping):
            raise InputError("coupling", f"is {self.coupling!r}", 'name pairs of coordinates, such as {"y-rz": -2e4}')
        rows = [[0.0] * len(names) for _ in names]
        for pair, value in self.coupling.items():
            ends = str(pair).split("-")
            if len(ends) != 2 or ends[0] == ends[1] or not set(ends) <= set(names):
                fix = f"give two of {', '.join(names)}" if names else "give the springs of the directions as well"
                raise InputError(f"coupling.{pair}", "is no pair of coordinates", fix)
            i, j = (names.index(name) for name in ends)
            rows[i][j] = rows[j][i] = finite(f"coupling.{pair}", value)
        coupling = as_array([entry for row in rows for entry in row]).reshape(len(names), len(names))
        if is_jax(stiffness) or is_jax(coupling):
            return coupling
        total = np.diag(np.asarray(stiffness, dtype=float)) + coupling
        if np.linalg.eigvalsh(total)[0] < -1e-9 * np.abs(total).max():
            raise InputError(
                "coupling", "makes springs that give energy", "give a stiffness without negative eigenvalue"
            )
        return coupling

    @property
    def frictions(self) -> dict[str, float]:
        """Friction, N or N m, by the names of the rates that have any."""
        friction = self._numbers("friction", self.friction)
        return {name: float(force) for name, force in zip(self.rate_names, friction, strict=True) if force > 0}

    @property
    def start_values(self) -> dict[str, Any]:
        """Values at the start, by name."""
        return dict(zip(self.values, self._numbers("initial", self.initial), strict=True))

    def _started(self) -> Array:
        """Coordinates at the start."""
        values = self._numbers("initial", self.initial)
        if not JOINT_KINDS[self.kind].turns:
            return values
        return concatenated([values[:-3], parameters_of_vector(values[-3:])])

    def _start_rates(self) -> Array:
        """Rates of the coordinates at the start."""
        values = self._numbers("initial_rate", self.initial_rate)
        if not JOINT_KINDS[self.kind].turns:
            return values
        return concatenated([values[:-3], parameter_rates(self.start[-4:], values[-3:])])

    def _prescribed(self) -> dict[str, Profile]:
        """Profiles of the prescribed rates; InputError if only a part of a ball's spin is prescribed."""
        rates = self._profiles("rate", self.rate)
        spin = [name for name in SPIN if name in rates]
        if spin and len(spin) < len(SPIN):
            fix = (
                "give wx, wy and wz, zero where it does not turn; or a universal or revolute joint, which turns freely"
            )
            raise InputError(f"rate.{spin[0]}", "is prescribed without the other two components of the spin", fix)
        return rates

    @property
    def course(self) -> Course:
        """Attitude over time of a ball whose spin is prescribed."""
        if not {*SPIN} <= self.rates.keys():
            raise InputError("rate", "prescribes no spin of a ball", "give wx, wy and wz")
        return Course([self.rates[name] for name in SPIN], self.start[-4:])

    def _driven(self) -> dict[str, Profile]:
        """Profiles of the drives."""
        efforts = self._profiles("effort", self.effort)
        for name in efforts.keys() & self.rates.keys():
            raise InputError(f"effort.{name}", f"is given beside rate.{name}", "keep one of them")
        return efforts

    def _profiles(self, where: str, values: Any) -> dict[str, Profile]:
        """Profiles of a key's values by name."""
        named = self._named(where, values)
        return {name: as_profile(f"{where}.{name}", value) for name, value in named.items()}

    def _names(self, key: str) -> tuple[str, ...]:
        """Names of the rates or values that a key takes."""
        return self.rate_names if key in OF_RATES else self.values

    def _numbers(self, where: str, named: Any) -> Array:
        """Numbers (h,) of a key in the order of its names, zero where `named` has none."""
        values = {name: finite(f"{where}.{name}", value) for name, value in self._named(where, named).items()}
        return as_array([values.get(name, 0.0) for name in self._names(where)])

    def _named(self, where: str, values: Any) -> dict[str, Any]:
        """Values of a key by coordinate; a bare value will do for one. InputError for coordinates of other joints."""
        names = self._names(where)
        if values is None:
            return {}
        if not isinstance(values, Mapping):
            if len(names) != 1:
                listed = ", ".join(names) or "none"
                fix = f"say of which coordinate, by name; a {self.kind} joint has {listed}"
                raise InputError(where, "is one value", fix)
            return {names[0]: values}
        for name in values:
            if name not in names:
                listed = f"choose from {', '.join(names)}" if names else "leave it out"
                raise InputError(f"{where}.{name}", f"is no coordinate of a {self.kind} joint", listed)
        return dict(values)


# Quantities of what is said of a coordinate, by key.
OF_COORDINATES = {
    name: parameter.of_coordinate for name, parameter in parameters_of(Joint).items() if parameter.of_coordinate
}
kinds(coupling=_kinds_of_coupling, **{key: partial(_kinds_of, key) for key in OF_COORDINATES})(Joint)
