"""What the structure is: material, section, point masses, beam. SI units; checked where built."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.loads import Load
from gbeam.root import Root

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Material:
    """Linear elastic material.

    Parameters
    ----------
    density : float
        Mass per volume, kg/m³.
    youngs_modulus : float
        Pa.

    Raises
    ------
    InputError
        If a value is not positive and finite.
    """

    density: float
    youngs_modulus: float

    def __post_init__(self) -> None:
        positive("density", self.density, "kg/m³")
        positive("youngs_modulus", self.youngs_modulus, "Pa")


def rectangle(width: Array, thickness: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, outer fibres along y and z of a rectangle: width along y, thickness along z."""
    return width * thickness, width * thickness**3 / 12, thickness * width**3 / 12, width / 2, thickness / 2


def circle(diameter: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, outer fibres of a solid circle."""
    inertia = np.pi * diameter**4 / 64
    return np.pi * diameter**2 / 4, inertia, inertia, diameter / 2, diameter / 2


def tube(diameter: Array, wall: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, outer fibres of a round tube: outer diameter and wall thickness."""
    inner = diameter - 2 * wall
    inertia = np.pi * (diameter**4 - inner**4) / 64
    return np.pi * (diameter**2 - inner**2) / 4, inertia, inertia, diameter / 2, diameter / 2


def general(
    area: Array,
    inertia_y: Array,
    inertia_z: Array,
    fibre_y: Array | None = None,
    fibre_z: Array | None = None,
) -> tuple[Array, ...]:
    """Area and second moments as given; the outer fibres, if unknown, are NaN (no stress can be told)."""
    unknown = np.full_like(area, np.nan)
    return (
        area,
        inertia_y,
        inertia_z,
        unknown if fibre_y is None else fibre_y,
        unknown if fibre_z is None else fibre_z,
    )


Rule = Callable[..., tuple[Array, ...]]
SHAPES: dict[str, tuple[Rule, tuple[str, ...], tuple[str, ...]]] = {
    "rectangle": (rectangle, ("width", "thickness"), ()),
    "circle": (circle, ("diameter",), ()),
    "tube": (tube, ("diameter", "wall"), ()),
    "general": (general, ("area", "inertia_y", "inertia_z"), ("fibre_y", "fibre_z")),
}
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
    dimensions: dict[str, tuple[float, ...]]
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
                positive(place, value, _UNITS.get(name, "m"))
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
                if 2 * wall > outer:
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
        values: dict[str, tuple[float, ...]] = {}
        for name, value in dimensions.items():
            if value is not None:
                listed = tuple(float(x) for x in np.atleast_1d(np.asarray(value, dtype=float)))
                values[name] = listed * len(at) if len(listed) == 1 and at else listed
        return cls(shape, values, at)

    @classmethod
    def rectangle(cls, width: ArrayLike, thickness: ArrayLike, stations: ArrayLike = ()) -> Section:
        """Rectangle: `width` along y and `thickness` along z, m."""
        return cls.of("rectangle", stations, width=width, thickness=thickness)

    @classmethod
    def circle(cls, diameter: ArrayLike, stations: ArrayLike = ()) -> Section:
        """Solid circle of the given `diameter`, m."""
        return cls.of("circle", stations, diameter=diameter)

    @classmethod
    def tube(cls, diameter: ArrayLike, wall: ArrayLike, stations: ArrayLike = ()) -> Section:
        """Round tube: outer `diameter` and `wall` thickness, m."""
        return cls.of("tube", stations, diameter=diameter, wall=wall)

    @classmethod
    def general(
        cls,
        area: ArrayLike,
        inertia_y: ArrayLike,
        inertia_z: ArrayLike,
        stations: ArrayLike = (),
        fibre_y: ArrayLike | None = None,
        fibre_z: ArrayLike | None = None,
    ) -> Section:
        """Any section: `area` m², second moments I_y and I_z m⁴, outer fibres along y and z m (for stress)."""
        return cls.of(
            "general",
            stations,
            area=area,
            inertia_y=inertia_y,
            inertia_z=inertia_z,
            fibre_y=fibre_y,
            fibre_z=fibre_z,
        )

    def at(self, x: ArrayLike) -> SectionValues:
        """Area, second moments and outer fibres at positions `x`, m (any shape)."""
        where = np.asarray(x, dtype=float)
        rule = SHAPES[self.shape][0]
        if self.stations:
            here = {k: np.interp(where, self.stations, v) for k, v in self.dimensions.items()}
        else:
            here = {k: np.full(where.shape, v[0]) for k, v in self.dimensions.items()}
        return SectionValues(*rule(**here))


@dataclass(frozen=True)
class SectionValues:
    """Section properties at positions: area m², inertia_y and inertia_z m⁴, outer fibres along y and z m."""

    area: Array
    inertia_y: Array
    inertia_z: Array
    fibre_y: Array
    fibre_z: Array


@dataclass(frozen=True)
class PointMass:
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

    Raises
    ------
    InputError
        If a value is impossible, or the moments break the triangle inequality of a rigid body.
    """

    at: float
    mass: float
    inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        positive("at", self.at, "m", zero=True)
        positive("mass", self.mass, "kg", zero=True)
        for name, values in (("inertia", self.inertia), ("offset", self.offset)):
            if len(values) != 3 or not all(math.isfinite(v) for v in values):
                raise InputError(name, f"is {values!r}", "give three finite values, along x, y and z")
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

    def particles(self) -> tuple[Array, Array]:
        """Equivalent particles: masses (p,) kg and positions (p, 3) m from the beam's axis, in section axes.

        Six particles at ±sqrt(3 S_i/m) along the principal axes have the body's mass, centre and inertia, so that a
        rigid body needs no energy of its own; without inertia one particle is enough.
        """
        centre = np.array(self.offset)
        if not any(self.inertia):
            return np.array([self.mass]), centre[None]
        reach = np.sqrt(3 * np.maximum(self.second_moments, 0) / self.mass)
        arms = np.diag(reach)
        return np.full(6, self.mass / 6), centre + np.concatenate([arms, -arms])


@dataclass(frozen=True)
class Beam:
    """A straight beam along x, held at x = 0 by the moving base.

    Parameters
    ----------
    length : float
        m.
    section : Section
    material : Material
    masses : sequence of PointMass
    damping_ratio : float or sequence of float
        Modal damping ratio: one for all modes, or one per mode of the model, ascending in frequency.
    root : Root
        Springs that hold the root; clamped where there is none.
    loads : sequence of Load

    Raises
    ------
    InputError
        If a value is impossible, a mass or a load lies off the beam, or the section's stations do not cover it.
    """

    length: float
    section: Section
    material: Material
    masses: Sequence[PointMass] = field(default=())
    damping_ratio: float | Sequence[float] = 0.0
    root: Root = field(default_factory=Root)
    loads: Sequence[Load] = field(default=())

    def __post_init__(self) -> None:
        positive("length", self.length, "m")
        object.__setattr__(self, "masses", tuple(self.masses))
        object.__setattr__(self, "loads", tuple(self.loads))
        places = [(f"masses[{i}].at", mass.at) for i, mass in enumerate(self.masses)]
        places += [(f"loads[{i}].at", load.at) for i, load in enumerate(self.loads) if load.at is not None]
        for place, at in places:
            if at > self.length * (1 + 1e-12):
                raise InputError(
                    place,
                    f"is {at:g} m, beyond the tip",
                    f"give 0 to {self.length:g} m from the root",
                )
        stations = self.section.stations
        if stations and (abs(stations[0]) > 1e-9 * self.length or abs(stations[-1] / self.length - 1) > 1e-9):
            raise InputError(
                "section.stations",
                f"cover {stations[0]:g} to {stations[-1]:g} m",
                f"start at the root, 0 m, and end at the tip, {self.length:g} m",
            )
        ratios = self.damping_ratio
        if not isinstance(ratios, (int, float)):
            object.__setattr__(self, "damping_ratio", tuple(float(z) for z in ratios))
        for i, ratio in enumerate(np.atleast_1d(np.asarray(self.damping_ratio, dtype=float))):
            place = "damping_ratio" if np.ndim(self.damping_ratio) == 0 else f"damping_ratio[{i}]"
            if not 0 <= ratio < 1:
                raise InputError(
                    place, f"is {ratio:g}", "give a ratio of critical damping from 0 up to 1, such as 0.01"
                )
