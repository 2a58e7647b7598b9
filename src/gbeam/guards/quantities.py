"""Quantities of parameters: annotations by which texts with a unit are read, values checked and forms written.

A parameter is declared once, where it stands in the signature of a class or function: its type, its quantity and its
words, ``at: Annotated[Position, "position from the root"]``. Checks and docstrings follow from it
(`gbeam.guards.arguments`), and so do the tables of scenarios, their schema and their reference (`gbeam.scenario`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import Array, is_jax
from gbeam.arrays.types import Numbers
from gbeam.errors import InputError
from gbeam.guards.checks import finite, positive, possible
from gbeam.guards.kinds import KINDS, PLAIN
from gbeam.guards.limits import LARGEST, SMALLEST
from gbeam.guards.units import BEGINNING, UnitError, quantity

NAME_OF_POINT = r"[A-Za-z_]\w*"
Sign = Literal["any", "positive", "zero or more"]

# Kinds whose sizes are checked by the objects, which also suggest the unit that was meant: gbeam.guards.checks.
_BY_RANGE = ("length", "area", "second moment of area", "density", "pressure", "time")


@dataclass(frozen=True)
class Quantity:
    """Annotation of a number: its kind of quantity, sign and range of values.

    In a scenario it is a number in SI or a text with a unit, or one of the `words`, which are kept as they are.
    """

    kind: str  # a key of KINDS
    sign: Sign = "any"
    span: str = ""  # a key of RANGES, in which a value can be computed with
    words: tuple[str, ...] = ()

    def check(self, where: str, value: Any) -> None:
        """Raise InputError unless a number, or every one of several, has this sign and range."""
        if is_jax(value) or (isinstance(value, str) and self.accepts(value)):
            return
        if isinstance(value, Mapping):
            for key, element in value.items():
                self.check(f"{where}.{key}", element)
        elif isinstance(value, np.ndarray) and value.ndim and value.dtype.kind in "fiuc":
            self._check_array(where, value)
        elif isinstance(value, (list, tuple)) or (hasattr(value, "ndim") and value.ndim > 0):
            for i, element in enumerate(value):
                self.check(f"{where}[{i}]", element)
        elif self.sign == "any":
            finite(where, value)
        else:
            positive(where, value, self.unit or "(a number)", zero=self.sign == "zero or more")
            if self.span:
                possible(where, self.span, value)

    def _check_array(self, where: str, values: Any) -> None:
        """Check the first number of an array that is wrong, and the least and the largest size, if there are any.

        Of complex numbers, such as modal masses of complex modes, only that they are finite is asked.
        """
        size = np.abs(values)
        suspects = ~np.isfinite(size)
        if values.dtype.kind == "c":
            if suspects.any():
                raise InputError(where, "is not finite", "give finite numbers")
            return
        if self.sign != "any":
            suspects |= (values < 0) | (values == 0 if self.sign == "positive" else False)
        if suspects.any():
            chosen = [np.argmax(suspects)]
        else:
            chosen = [np.argmin(size), np.argmax(size)] if size.size else []
        for flat_index in chosen:
            index = np.unravel_index(flat_index, values.shape)
            self.check(where + "".join(f"[{i}]" for i in index), float(values[index]))

    @property
    def unit(self) -> str:
        """SI unit as it is printed, such as kg/m³, or empty of a plain number."""
        unit = KINDS[self.kind].unit
        return unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")

    def accepts(self, text: str) -> bool:
        """True if a text is kept as it is."""
        return text in self.words

    @property
    def accepted(self) -> list[dict[str, Any]]:
        """Texts that are kept, as alternatives of the JSON schema."""
        return [{"const": word} for word in self.words]

    def read(self, value: object) -> float | str:
        """Return the value of a scenario in SI, or an accepted word as it is; UnitError, with advice, otherwise."""
        if isinstance(value, str) and self.accepts(value):
            return value
        alternatives = "".join(f', or "{word}"' for word in self.words)
        try:
            number = quantity(value, self.kind)
        except UnitError as error:
            raise UnitError(error.problem, error.hint + alternatives) from None
        if number and self.kind not in _BY_RANGE and not SMALLEST <= abs(number) <= LARGEST:
            size = "large" if abs(number) > LARGEST else "small"
            raise UnitError(f"{{value}} is too {size} to compute with", f"give a size from {SMALLEST:g} to {LARGEST:g}")
        if number < 0 and self.sign != "any":
            raise UnitError("{value} is negative", f"give {self._signed}{alternatives}")
        if number == 0 and self.sign == "positive":
            raise UnitError("{value} is zero", f"give {self._signed}{alternatives}")
        return number

    @property
    def _signed(self) -> str:
        noun = KINDS[self.kind].phrase.split(" ", 1)[1]
        return f"a positive {noun}" if self.sign == "positive" else f"zero or a positive {noun}"

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> dict[str, Any]:
        """Validate with :meth:`read` alone: pydantic's own floats would take "10" and true."""
        return {"type": "function-plain", "function": {"type": "no-info", "function": self.read}}

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """Describe it as a number in SI or as text with a unit."""
        kind = KINDS[self.kind]
        limit = {"positive": {"exclusiveMinimum": 0}, "zero or more": {"minimum": 0}}.get(self.sign, {})
        number = {"type": "number", "description": f"{kind.phrase} in {kind.unit or 'plain numbers'}"} | limit
        text = {"type": "string", "description": f"{kind.phrase} with its unit", "examples": [kind.example]}
        return {"anyOf": [number, text, *self.accepted], "x-quantity": self.kind, "x-unit": kind.unit}


@dataclass(frozen=True)
class QuantityOrName(Quantity):
    """Annotation of a number in whose place a name may stand: any text that does not begin as a number does."""

    def accepts(self, text: str) -> bool:
        """True if a text is no number."""
        return not BEGINNING.match(text)

    @property
    def accepted(self) -> list[dict[str, Any]]:
        """Names, as an alternative of the JSON schema."""
        return [{"type": "string", "description": "the name of a point, a mass or a group", "examples": ["tip"]}]


@dataclass(frozen=True)
class OfKind:
    """Annotation of a number: only its kind of quantity. Its sign and range are checked by what takes it."""

    kind: str  # a key of KINDS, or PLAIN


@dataclass(frozen=True)
class OfCoordinate:
    """Annotation of a value of a coordinate: its kinds of quantity, of a displacement and of an angle, and its sign."""

    displacement: str  # a key of KINDS
    angle: str
    sign: Sign = "any"

    @property
    def unit(self) -> str:
        """Both SI units as they are printed, such as m or rad."""
        return " or ".join(Quantity(kind).unit for kind in (self.displacement, self.angle))


@dataclass(frozen=True)
class Count:
    """Annotation of a whole number: its least and largest value."""

    least: int
    most: int | None = None


@dataclass(frozen=True)
class Shape:
    """Annotation of numbers: how many stand in a list of a scenario, such as (3,) or (2, 3)."""

    sizes: tuple[int, ...]


@dataclass(frozen=True)
class Rows:
    """Annotation of any number of rows, of so many numbers each."""

    size: int


@dataclass(frozen=True)
class OneOrSome:
    """Annotation of one number, or one array of such sizes, or a list of several."""

    sizes: tuple[int, ...] = ()


@dataclass(frozen=True)
class OfProfile:
    """Annotation of a value of a profile, whose quantity is that of the profile: itself, or its rate of change."""

    rate: bool = False

    def quantity(self, kind: str) -> Quantity:
        """Quantity in a profile of a kind."""
        return Quantity(KINDS[kind].rate, "positive") if self.rate else Quantity(kind)


@dataclass(frozen=True)
class Components:
    """Annotation of a vector that is a table of its components in a scenario: what it is, and the words of each."""

    about: str
    x: str = ""
    y: str = ""
    z: str = ""


Length = Annotated[float, Quantity("length", "positive")]
Position = Annotated[float, Quantity("length", "zero or more")]
NamedPosition = Annotated[float | str, QuantityOrName("length", "zero or more")]
Offset = Annotated[float, Quantity("length")]
Mass = Annotated[float, Quantity("mass", "zero or more")]
MomentOfInertia = Annotated[float, Quantity("moment of inertia", "zero or more")]
Density = Annotated[float, Quantity("density", "positive", "density")]
Modulus = Annotated[float, Quantity("pressure", "positive", "modulus")]
Strength = Annotated[float, Quantity("pressure", "positive")]
Ratio = Annotated[float, Quantity("ratio")]
Factor = Annotated[float, Quantity("ratio", "positive")]
Duration = Annotated[float, Quantity("time", "positive")]
Time = Annotated[float, Quantity("time", "zero or more")]
Frequency = Annotated[float, Quantity("frequency", "positive")]
Speed = Annotated[float, Quantity("speed")]
Acceleration = Annotated[float, Quantity("acceleration")]
Jerk = Annotated[float, Quantity("jerk", "positive")]
Angle = Annotated[float, Quantity("angle")]
AngularRate = Annotated[float, Quantity("angular rate")]
Force = Annotated[float, Quantity("force")]
Stiffness = Annotated[float, Quantity("stiffness", "positive")]
RotationalStiffness = Annotated[float, Quantity("rotational stiffness", "positive")]
Damping = Annotated[float, Quantity("damping", "zero or more")]
RotationalDamping = Annotated[float, Quantity("rotational damping", "zero or more")]

# Of any sign; Times, Positions and Coordinates one or an array of them, NumPy's or JAX's.
Seconds = Annotated[float, OfKind("time")]
Times = Annotated[Any, OfKind("time")]
Positions = Annotated[ArrayLike, OfKind("length")]
Coordinates = Annotated[Array, OfKind(PLAIN)]

# Vectors of three components; JAX's and NumPy's arrays are numbers, too.
PositionVector = Annotated[Numbers, Quantity("length"), Shape((3,))]
RotationVector = Annotated[Numbers, Quantity("angle"), Shape((3,))]
AccelerationVector = Annotated[Numbers, Quantity("acceleration"), Shape((3,))]

ModalDamping = Annotated[float | Numbers, Quantity("ratio"), OneOrSome()]
MODES_KEPT = "number of modes; up to twelve static shapes come on top"
MODAL_DAMPING = "of critical damping, of all, or a list with one for each mode; static shapes have the last one's"
