"""Cross-sections: rectangle, circle, tube, or free area and second moments; constant, or given at stations."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import as_array, is_jax, namespace
from gbeam.arrays.tree import Value, record, static
from gbeam.arrays.types import Floats, Numbers
from gbeam.constants import SectionShape
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, positive, possible
from gbeam.guards.kinds import kinds
from gbeam.guards.parameters import kinds_of_entries
from gbeam.guards.quantities import Length, OfKind, OneOrSome, Positions, Quantity, Ratio, Rows, Shape
from gbeam.structure.material import Material
from gbeam.structure.matrices import between, matrices_of, read_matrices, refuse_impossible
from gbeam.structure.matrices import listed as matrices
from gbeam.structure.shapes import (
    MATRICES,
    ROUND,
    SHAPES,
    Areas,
    Dimensions,
    Lengths,
    SecondMoments,
    ShearCoefficients,
)


def _listed(name: str, value: Any) -> tuple[Any, ...]:
    """Values of a dimension, one per station; JAX's stay what they are."""
    values = array(name, value)
    if is_jax(values):
        return tuple(values) if values.ndim else (values,)
    return tuple(float(x) for x in np.atleast_1d(values))


SectionMatrices = Annotated[ArrayLike, OneOrSome((6, 6))]
Corners = Annotated[ArrayLike, Quantity("length"), Rows(2)]
Stations = Annotated[
    Sequence[float] | Floats,
    Quantity("length", "zero or more"),
    "positions from root to tip at which the other values are listed, linear in between; none of a constant section",
]
Plate = Annotated[
    bool,
    "true if it bends along z as a plate that stays flat across its width, EI_y/(1 - ν²): a strip wide beside its "
    "length, or bent far; needs material.poissons_ratio",
]
KINDS = {
    "area": "area",
    "inertia_y": "second moment",
    "inertia_z": "second moment",
    "torsion_constant": "second moment",
    "shear_coefficient_y": "shear coefficient",
    "shear_coefficient_z": "shear coefficient",
}  # of plausible values; else section
_UNITS = {"area": "m²", "second moment": "m⁴", "shear coefficient": "(a number)"}


@kinds(dimensions=kinds_of_entries(Dimensions))
@typed
@dataclass(frozen=True, eq=False)
class Section(Value):
    """Cross-section of the beam, constant or given at stations and interpolated linearly in its dimensions.

    Build it with :meth:`rectangle`, :meth:`circle`, :meth:`tube`, :meth:`general`, :meth:`of_matrices`, :meth:`read` or
    :meth:`drawn`.

    Parameters
    ----------
    shape : str
        ``rectangle``, ``circle``, ``tube``, ``general`` or ``matrices``.
    dimensions : dict of str to sequence of float
        The shape's dimensions, one value per station (m; ``general``: m², m⁴, m; ``matrices``: (6, 6) each).
    stations : sequence of float
        Positions along x from the root, m, strictly increasing; empty for a constant section.
    plate : bool
        Whether the section bends along z as a plate that is kept from bending across, EI_y/(1 − ν²): a strip so wide,
        or bent so far, that it stays flat across its width. The material's Poisson's ratio is needed then.

    Notes
    -----
    I_y = ∫z² dA bends the beam along z, I_z = ∫y² dA along y (2020 (14), (22)).

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> tapered = gb.Section.tube([0.05, 0.03], [0.002, 0.002], stations=[0.0, 1.0])
    >>> print(f"{tapered.at(0.5).area:.4g} m²")
    0.0002388 m²
    """

    shape: SectionShape
    dimensions: dict[str, tuple[Any, ...]]
    stations: Annotated[tuple[float, ...], OfKind("length")] = ()
    plate: bool = False

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise InputError("shape", f"is {self.shape!r}", f"choose one of {', '.join(SHAPES)}")
        required, optional = SHAPES[self.shape].required, SHAPES[self.shape].optional
        for name in required:
            if name not in self.dimensions:
                raise InputError(name, "is missing", f"a {self.shape} section needs {', '.join(required)}")
        for name in self.dimensions:
            if name not in required + optional:
                raise InputError(
                    name, f"does not belong to a {self.shape}", f"it takes {', '.join(required + optional)}"
                )
        count = max(len(self.stations), 1)
        if self.shape == MATRICES:
            refuse_impossible(self.dimensions)
        for name, values in self.dimensions.items():
            for i, value in enumerate(() if self.shape == MATRICES else values):
                place = f"{name}[{i}]" if len(values) > 1 else name
                kind = KINDS.get(name, "section")
                possible(place, kind, positive(place, value, _UNITS.get(kind, "m")))
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
        if self.plate and self.shape in ROUND:
            raise InputError("plate", f"is given of a {self.shape}", "only a rectangle or a general section is flat")
        if self.plate and self.shape == "rectangle":
            for width, thickness in zip(self.dimensions["width"], self.dimensions["thickness"], strict=True):
                if not (is_jax(width) or is_jax(thickness)) and width < thickness:
                    fix = "exchange width and thickness and turn the section, or leave plate out"
                    raise InputError("plate", f"is given of {width:g} m across and {thickness:g} m thick", fix)

    @classmethod
    @typed
    def of(
        cls, shape: SectionShape, stations: Positions = (), *, plate: bool = False, **dimensions: Unpack[Dimensions]
    ) -> Section:
        """Build a section from scalars or sequences; a scalar holds at every station.

        Parameters
        ----------
        shape : str
            A key of ``SHAPES``.
        stations : array_like
            Positions from the root, m; empty for a constant section.
        plate : bool
            Whether it bends along z as a plate, EI_y/(1 − ν²).
        **dimensions : array_like or None
            As the shape takes them; None counts as not given.

        Raises
        ------
        InputError
            If the shape, a dimension or a station is impossible.
        """
        positions = tuple(float(x) for x in np.atleast_1d(np.asarray(stations, dtype=float)))
        values: dict[str, tuple[Any, ...]] = {}
        for name, value in dimensions.items():
            if value is not None:
                per_station = (matrices if shape == MATRICES else _listed)(name, value)
                holds_everywhere = len(per_station) == 1 and positions
                values[name] = per_station * len(positions) if holds_everywhere else per_station
        return cls(shape, values, positions, plate)

    @property
    def maker(self) -> Callable[..., Section]:
        """Function whose :attr:`arguments` make the section again."""
        return Section.of

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of :meth:`of` by their names: of a constant section the dimensions as numbers."""
        values = {name: size[0] if len(size) == 1 else size for name, size in self.dimensions.items()}
        return {"shape": self.shape, "stations": self.stations, "plate": self.plate, **values}

    def altered(self, **changes: Any) -> Section:
        """Section with other arguments, by the names of :meth:`of`."""
        return Section.of(**{**self.arguments, **changes})

    @classmethod
    @typed
    def rectangle(
        cls,
        width: Annotated[Lengths, "width, along y"],
        thickness: Annotated[Lengths, "thickness, along z, the soft direction"],
        stations: Stations = (),
        *,
        plate: Plate = False,
    ) -> Section:
        """Rectangle."""
        return cls.of("rectangle", stations, plate=plate, width=width, thickness=thickness)

    @classmethod
    @typed
    def circle(cls, diameter: Annotated[Lengths, "diameter"], stations: Stations = ()) -> Section:
        """Solid circle."""
        return cls.of("circle", stations, diameter=diameter)

    @classmethod
    @typed
    def tube(
        cls,
        diameter: Annotated[Lengths, "outer diameter"],
        wall: Annotated[Lengths, "wall thickness"],
        stations: Stations = (),
    ) -> Section:
        """Round tube."""
        return cls.of("tube", stations, diameter=diameter, wall=wall)

    @classmethod
    @typed
    def general(
        cls,
        area: Annotated[Areas, "area"],
        inertia_y: Annotated[SecondMoments, "∫z² dA, which bends the beam along z"],
        inertia_z: Annotated[SecondMoments, "∫y² dA, which bends the beam along y"],
        stations: Stations = (),
        extreme_fibre_y: Annotated[Lengths | None, "outer fibre along y, for stress"] = None,
        extreme_fibre_z: Annotated[Lengths | None, "outer fibre along z, for stress"] = None,
        *,
        torsion_constant: Annotated[
            SecondMoments | None,
            "J of the torque G J α', for modes.twist and for the stated error of a model without twist",
        ] = None,
        shear_coefficient_y: Annotated[
            ShearCoefficients | None,
            "k of the shear force k G A γ along y, for modes.shear_y; in the stated error 1/2 where left out",
        ] = None,
        shear_coefficient_z: Annotated[
            ShearCoefficients | None, "k of the shear force along z, for modes.shear_z, likewise"
        ] = None,
        plate: Plate = False,
    ) -> Section:
        """Any section, by its properties."""
        return cls.of(
            "general",
            stations,
            plate=plate,
            area=area,
            inertia_y=inertia_y,
            inertia_z=inertia_z,
            extreme_fibre_y=extreme_fibre_y,
            extreme_fibre_z=extreme_fibre_z,
            torsion_constant=torsion_constant,
            shear_coefficient_y=shear_coefficient_y,
            shear_coefficient_z=shear_coefficient_z,
        )

    @classmethod
    @typed
    def of_matrices(
        cls,
        stiffness: Annotated[
            SectionMatrices, "(6, 6) in N, N m and N m², or one per station; VABS has the same order; or file"
        ],
        mass: Annotated[SectionMatrices, "(6, 6) of a rigid slice in kg/m, kg and kg m, or one per station"],
        stations: Stations = (),
    ) -> Section:
        """Section by its stiffness and mass matrices, of a beam without a material.

        Rows and columns are in the order stretch, shear along y, shear along z, twist, curvature about y, curvature
        about z, in axes with x along the beam. VABS has the same order; :meth:`read` takes its files and those of
        BECAS. The axis of the beam is where the matrices are taken: axes of tension, shear and mass may lie beside it.
        A strain for which a model has no shapes moves nothing and follows the others without a force of its own: held
        at zero it would stiffen them by their coupling with it.

        Raises
        ------
        InputError
            If a matrix has another shape, is not symmetric, the stiffness not positive definite, or the mass that of no
            rigid body.
        """
        return cls.of(MATRICES, stations, stiffness=stiffness, mass=mass)

    @classmethod
    @typed
    def read(
        cls,
        *paths: Annotated[
            str | os.PathLike[str], "file of VABS (.K) or BECAS (.out) with both matrices, or one per station"
        ],
        stations: Stations = (),
        length_unit: Annotated[str, "unit of length in the file, such as mm; of time it is the second"] = "m",
        mass_unit: Annotated[str, "unit of mass in the file, such as Mg"] = "kg",
    ) -> Section:
        """Read a section's matrices from a file of VABS (.K) or BECAS (.out).

        Raises
        ------
        InputError
            If a file has no 6 × 6 stiffness and mass matrices, or they are those of no section.
        """
        if not paths:
            raise InputError("paths", "are missing", "give a file of VABS or BECAS, or one per station")
        pairs = [read_matrices(path, length_unit, mass_unit) for path in paths]
        stiffness, mass = (np.stack(matrices) for matrices in zip(*pairs, strict=True))
        return cls.of(MATRICES, stations, stiffness=stiffness, mass=mass)

    @classmethod
    @typed
    def drawn(
        cls,
        outline: Annotated[Corners, "corners in order: [ [y, z], ... ]"],
        material: Annotated[Material, "density, Young's and shear moduli"],
        *,
        holes: Annotated[Sequence[Corners], "corners of each hole: [ [ [y, z], ... ] ]"] = (),
        axis: Annotated[
            Annotated[Numbers, Quantity("length"), Shape((2,))] | None,
            "where the axis of the beam meets the drawing, [y, z]; the centroid where left out",
        ] = None,
        element_size: Annotated[Length | None, "edge of the triangles; about 400 of them where left out"] = None,
    ) -> Section:
        """Compute the matrices of a drawn section of one material by sectionproperties (``gbeam[sections]``).

        Returns
        -------
        Section
            By matrices, with the axes of tension, shear and mass where they are. It holds the material, and does not
            warp; stress over it is not known.

        Raises
        ------
        InputError
            If the outline encloses no area or crosses itself, or sectionproperties is not installed.
        """
        return cls.of_matrices(*matrices_of(outline, holes, material, axis, element_size))

    def at(self, x: Positions) -> SectionValues:
        """Area, second moments and extreme fibres at positions `x`, m (any shape), of matrices by mass."""
        area, inertia_y, inertia_z, fibre_y, fibre_z = SHAPES[self.shape].values(**self._local(x))
        return SectionValues(area, inertia_y, inertia_z, fibre_y, fibre_z, round=self.shape in ROUND)

    def torsion_constant(self, x: Positions) -> Floats:
        """J, m⁴, at positions `x`, m; NaN where it is not known."""
        return as_array(SHAPES[self.shape].torsion(**self._local(x)))

    def shear_coefficients(self, x: Positions, poissons_ratio: Ratio) -> tuple[Floats, Floats]:
        """Coefficients of the shear forces k G A γ along y and z at positions `x`, m, for a `poissons_ratio`."""
        y, z = SHAPES[self.shape].shear(poissons_ratio, **self._local(x))
        xp = namespace(y, z)
        return xp.broadcast_to(y, np.shape(x)), xp.broadcast_to(z, np.shape(x))

    def stresses(self, x: Positions) -> Floats | None:
        """Stresses (points, 3, 6, s), Pa, normal and along two shears, of unit loads at positions `x` (s,), m.

        None if the shape has no formulas, or JAX has the dimensions.
        """
        formula, local = SHAPES[self.shape].stresses, self._local(x)
        if formula is None or any(map(is_jax, local.values())):
            return None
        return np.asarray(formula(**local))

    def matrices(self, x: Positions) -> tuple[Floats, Floats]:
        """Stiffness and mass matrices (..., 6, 6) at positions `x`, m, of a section that has them."""
        if self.shape != MATRICES:
            raise InputError("shape", f"is {self.shape!r}, which has no matrices", "give gb.Section.of_matrices")
        local = self._local(x)
        return local["stiffness"], local["mass"]

    def _local(self, x: ArrayLike) -> dict[str, Any]:
        """Dimensions at positions `x`, m, by name, linear between stations."""
        positions = array("x", x)
        if self.shape == MATRICES:
            return {name: between(self.stations, matrices, positions) for name, matrices in self.dimensions.items()}
        xp = namespace(*(value for values in self.dimensions.values() for value in values))
        if not self.stations:
            return {name: values[0] + xp.zeros(positions.shape) for name, values in self.dimensions.items()}
        stations = np.asarray(self.stations)
        return {name: xp.interp(positions, stations, xp.asarray(values)) for name, values in self.dimensions.items()}


@record
class SectionValues:
    """Section properties at positions: area, m², second moments, m⁴, and distances of the extreme fibres, m, which are
    the corners (±y, ±z) or, where it is `round`, a circle.
    """

    area: Floats
    inertia_y: Floats
    inertia_z: Floats
    extreme_fibre_y: Floats
    extreme_fibre_z: Floats
    round: bool = static(default=False)

    def __getitem__(self, index: Any) -> SectionValues:
        """The properties of some of the sections."""
        names = [quantity.name for quantity in fields(self) if quantity.name != "round"]
        return replace(self, **{name: getattr(self, name)[index] for name in names})

    def extents(self) -> tuple[Floats, Floats]:
        """Extents along y and z, m; without extreme fibres those of the rectangle with the same second moments."""
        xp = namespace(self.area, self.inertia_y, self.inertia_z)
        rectangle = [xp.sqrt(12 * inertia / self.area) for inertia in (self.inertia_z, self.inertia_y)]
        fibres = (2 * self.extreme_fibre_y, 2 * self.extreme_fibre_z)
        width, thickness = (xp.where(xp.isfinite(a), a, b) for a, b in zip(fibres, rectangle, strict=True))
        return width, thickness


_ROUND = 24  # directions of fibres of a round section; the worst lies within 7.5°: 0.9 % of its bending stress


def extreme_stresses(values: SectionValues, force: Any, moment: Any) -> tuple[Any, Any]:
    """Largest and smallest normal stress (..., s), Pa, from force, N, and moment, N m, (..., s, 3) in section axes.

    They are N/A ± (|M_y| c_z/I_y + |M_z| c_y/I_z), of round sections N/A ± √(M_y² + M_z²) c/I; NaN where extreme fibres
    are unknown.
    """
    xp = namespace(force, moment, values.area)
    bending_z = moment[..., 1] * values.extreme_fibre_z / values.inertia_y
    bending_y = moment[..., 2] * values.extreme_fibre_y / values.inertia_z
    if values.round:
        square = bending_z**2 + bending_y**2
        is_bent = square > 0  # the root's derivative at zero is none that could be passed on
        bending = xp.where(is_bent, xp.sqrt(xp.where(is_bent, square, 1.0)), square)
    else:
        bending = xp.abs(bending_z) + xp.abs(bending_y)
    mean = force[..., 0] / values.area
    return mean + bending, mean - bending


def fibre_stress(values: SectionValues, force: Any, moment: Any, y: Any, z: Any) -> Any:
    """Normal stress N/A + M_y z/I_y − M_z y/I_z at places (y, z) m in sections (s,), (..., s) Pa."""
    along_z, along_y = moment[..., 1] * z / values.inertia_y, moment[..., 2] * y / values.inertia_z
    return force[..., 0] / values.area + along_z - along_y


def worst_fibres(values: SectionValues, force: Any, moment: Any) -> Any:
    """Normal stress (t, s), Pa, of the fibre of every section whose stress ranges most; force and moment (t, s, 3).

    It is N/A + M_y z/I_y − M_z y/I_z, compared at the corners of a section, or at 24 points around a round one.
    """
    points = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    if values.round:
        points = [(np.cos(a), np.sin(a)) for a in 2 * np.pi * np.arange(_ROUND) / _ROUND]
    fibres = [(y * values.extreme_fibre_y, z * values.extreme_fibre_z) for y, z in points]
    worst_stress = fibre_stress(values, force, moment, *fibres[0])
    for y, z in fibres[1:]:
        stress = fibre_stress(values, force, moment, y, z)
        worst_stress = np.where(np.ptp(stress, axis=0) > np.ptp(worst_stress, axis=0), stress, worst_stress)
    return worst_stress
