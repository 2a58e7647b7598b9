"""What the structure is: material, point masses, beam (its section: section.py). SI units; checked where built."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.structure.loads import Load
from gbeam.structure.section import Section
from gbeam.structure.support import Root

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
