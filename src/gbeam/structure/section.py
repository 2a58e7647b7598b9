"""Cross-sections: rectangle, circle, tube, or free area and second moments; constant, or given at stations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.tree import record, static
from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.guards.plausibility import possible

Array = NDArray[np.float64]


def rectangle(width: Array, thickness: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, extreme fibres along y and z of a rectangle: width along y, thickness along z."""
    return width * thickness, width * thickness**3 / 12, thickness * width**3 / 12, width / 2, thickness / 2


def circle(diameter: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, extreme fibres of a solid circle."""
    inertia = np.pi * diameter**4 / 64
    return np.pi * diameter**2 / 4, inertia, inertia, diameter / 2, diameter / 2


def tube(diameter: Array, wall: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, extreme fibres of a round tube: outer diameter and wall thickness."""
    inner = diameter - 2 * wall
    inertia = np.pi * (diameter**4 - inner**4) / 64
    return np.pi * (diameter**2 - inner**2) / 4, inertia, inertia, diameter / 2, diameter / 2


def general(
    area: Array,
    inertia_y: Array,
    inertia_z: Array,
    extreme_fibre_y: Array | None = None,
    extreme_fibre_z: Array | None = None,
) -> tuple[Array, ...]:
    """Area and second moments as given; the extreme fibres, if unknown, are NaN (no stress is known)."""
    unknown = namespace(area).full_like(area, np.nan)
    return (
        area,
        inertia_y,
        inertia_z,
        unknown if extreme_fibre_y is None else extreme_fibre_y,
        unknown if extreme_fibre_z is None else extreme_fibre_z,
    )


def _listed(value: Any) -> tuple[Any, ...]:
    """Values of a dimension, one per station; JAX's stay what they are."""
    if is_jax(value):
        return tuple(value) if value.ndim else (value,)
    return tuple(float(x) for x in np.atleast_1d(np.asarray(value, dtype=float)))


Rule = Callable[..., tuple[Array, ...]]
SHAPES: dict[str, tuple[Rule, tuple[str, ...], tuple[str, ...]]] = {
    "rectangle": (rectangle, ("width", "thickness"), ()),
    "circle": (circle, ("diameter",), ()),
    "tube": (tube, ("diameter", "wall"), ()),
    "general": (general, ("area", "inertia_y", "inertia_z"), ("extreme_fibre_y", "extreme_fibre_z")),
}
ROUND = ("circle", "tube")
KINDS = {
    "area": "area",
    "inertia_y": "second moment",
    "inertia_z": "second moment",
}  # of plausible values; else section
_UNITS = {"area": "m²", "inertia_y": "m⁴", "inertia_z": "m⁴"}


@dataclass(frozen=True)
class Section:
    """Cross-section of the beam, constant or given at stations and interpolated linearly in its dimensions.

    Build it with :meth:`rectangle`, :meth:`circle`, :meth:`tube` or :meth:`general`.

    Parameters
    ----------
    shape : str
        ``rectangle``, ``circle``, ``tube`` or ``general``.
    dimensions : dict of str to sequence of float
        The shape's dimensions, one value per station (m; ``general``: m², m⁴, m).
    stations : sequence of float
        Positions along x from the root, m, strictly increasing; empty for a constant section.

    Notes
    -----
    I_y = ∫z² dA bends the beam along z, I_z = ∫y² dA along y (2020 (14), (22)).
    """

    shape: str
    dimensions: dict[str, tuple[Any, ...]]
    stations: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise InputError("shape", f"is {self.shape!r}", f"choose one of {', '.join(SHAPES)}")
        _, required, optional = SHAPES[self.shape]
        for name in required:
            if name not in self.dimensions:
                raise InputError(name, "is missing", f"a {self.shape} section needs {', '.join(required)}")
        for name in self.dimensions:
            if name not in required + optional:
                raise InputError(
                    name, f"does not belong to a {self.shape}", f"it takes {', '.join(required + optional)}"
                )
        count = max(len(self.stations), 1)
        for name, values in self.dimensions.items():
            for i, value in enumerate(values):
                place = f"{name}[{i}]" if len(values) > 1 else name
                possible(place, KINDS.get(name, "section"), positive(place, value, _UNITS.get(name, "m")))
            if len(values) != count:
                raise InputError(
                    name, f"has {len(values)} value(s) for {count} station(s)", "give one value per station"
                )
        for i, (before, after) in enumerate(zip(self.stations, self.stations[1:], strict=False)):
            if not after > before:
                raise InputError(
                    f"stations[{i + 1}]",
                    f"is {after:g} m, after {before:g} m",
                    "list stations in increasing order",
                )
        if len(self.stations) == 1:
            raise InputError("stations", "has one value", "give two or more, or leave it out for a constant section")
        if self.stations and not (math.isfinite(self.stations[0]) and math.isfinite(self.stations[-1])):
            raise InputError("stations", "holds a value that is not finite", "give finite positions in m")
        if self.shape == "tube":
            for outer, wall in zip(self.dimensions["diameter"], self.dimensions["wall"], strict=True):
                if not (is_jax(outer) or is_jax(wall)) and 2 * wall > outer:
                    raise InputError("wall", f"is {wall:g} m", f"at most half the diameter {outer:g} m")

    @classmethod
    def of(cls, shape: str, stations: ArrayLike = (), **dimensions: ArrayLike | None) -> Section:
        """Build a section from scalars or sequences; a scalar holds at every station.

        Parameters
        ----------
        shape : str
            A key of ``SHAPES``.
        stations : array_like
            Positions from the root, m; empty for a constant section.
        **dimensions : array_like or None
            As the shape takes them; None counts as not given.

        Raises
        ------
        InputError
            If the shape, a dimension or a station is impossible.
        """
        at = tuple(float(x) for x in np.atleast_1d(np.asarray(stations, dtype=float)))
        values: dict[str, tuple[Any, ...]] = {}
        for name, value in dimensions.items():
            if value is not None:
                listed = _listed(value)
                values[name] = listed * len(at) if len(listed) == 1 and at else listed
        return cls(shape, values, at)

    @classmethod
    def rectangle(cls, width: ArrayLike, thickness: ArrayLike, stations: ArrayLike = ()) -> Section:
        """Rectangle.

        Parameters
        ----------
        width, thickness : array_like
            Along y and along z, the soft direction, m; numbers, or one per station.
        stations : array_like
            Positions from the root at which the other values are listed, m; empty for a constant section.
        """
        return cls.of("rectangle", stations, width=width, thickness=thickness)

    @classmethod
    def circle(cls, diameter: ArrayLike, stations: ArrayLike = ()) -> Section:
        """Solid circle.

        Parameters
        ----------
        diameter : array_like
            m; a number, or one per station.
        stations : array_like
            Positions from the root at which the other values are listed, m; empty for a constant section.
        """
        return cls.of("circle", stations, diameter=diameter)

    @classmethod
    def tube(cls, diameter: ArrayLike, wall: ArrayLike, stations: ArrayLike = ()) -> Section:
        """Round tube.

        Parameters
        ----------
        diameter, wall : array_like
            Outer diameter and thickness of the wall, m; numbers, or one per station.
        stations : array_like
            Positions from the root at which the other values are listed, m; empty for a constant section.
        """
        return cls.of("tube", stations, diameter=diameter, wall=wall)

    @classmethod
    def general(
        cls,
        area: ArrayLike,
        inertia_y: ArrayLike,
        inertia_z: ArrayLike,
        stations: ArrayLike = (),
        extreme_fibre_y: ArrayLike | None = None,
        extreme_fibre_z: ArrayLike | None = None,
    ) -> Section:
        """Any section, by its properties: numbers, or one per station each.

        Parameters
        ----------
        area : array_like
            m².
        inertia_y, inertia_z : array_like
            Second moments ∫z² dA, which bends the beam along z, and ∫y² dA, along y, m⁴.
        stations : array_like
            Positions from the root at which the other values are listed, m; empty for a constant section.
        extreme_fibre_y, extreme_fibre_z : array_like, optional
            Of the outermost fibres along y and along z, m; without them there is no stress.
        """
        return cls.of(
            "general",
            stations,
            area=area,
            inertia_y=inertia_y,
            inertia_z=inertia_z,
            extreme_fibre_y=extreme_fibre_y,
            extreme_fibre_z=extreme_fibre_z,
        )

    def at(self, x: ArrayLike) -> SectionValues:
        """Area, second moments and extreme fibres at positions `x`, m (any shape)."""
        where = np.asarray(x, dtype=float)
        rule = SHAPES[self.shape][0]
        xp = namespace(*self.dimensions.values(), *(v[0] for v in self.dimensions.values()))
        if self.stations:
            local = {k: xp.interp(where, np.asarray(self.stations), xp.asarray(v)) for k, v in self.dimensions.items()}
        else:
            local = {k: v[0] + xp.zeros(where.shape) for k, v in self.dimensions.items()}
        area, inertia_y, inertia_z, fibre_y, fibre_z = rule(**local)
        return SectionValues(area, inertia_y, inertia_z, fibre_y, fibre_z, round=self.shape in ROUND)


@record
class SectionValues:
    """Section properties at positions: area m², inertia_y and inertia_z m⁴, extreme fibres along y and z m.

    The extreme fibres are the corners (±y, ±z), or where `round` a circle through (y, 0) and (0, z).
    """

    area: Array
    inertia_y: Array
    inertia_z: Array
    extreme_fibre_y: Array
    extreme_fibre_z: Array
    round: bool = static(default=False)

    def extents(self) -> tuple[Array, Array]:
        """Extents along y and z, m; without extreme fibres those of the rectangle with the same second moments."""
        xp = namespace(self.area, self.inertia_y, self.inertia_z)
        rectangle = [xp.sqrt(12 * each / self.area) for each in (self.inertia_z, self.inertia_y)]
        fibres = (2 * self.extreme_fibre_y, 2 * self.extreme_fibre_z)
        width, thickness = (xp.where(xp.isfinite(a), a, b) for a, b in zip(fibres, rectangle, strict=True))
        return width, thickness
