"""The beam: its section and material along the length, what it carries and how it is held. SI; checked where built."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import holds_jax, is_jax, namespace
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError, placing_within
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, damping_ratios
from gbeam.guards.quantities import OneOrSome, Positions, Quantity
from gbeam.structure.attachments import TIP, Load, Point, PointMass, Root
from gbeam.structure.line import Line
from gbeam.structure.material import ASSUMED_RATIO, Material
from gbeam.structure.section import Section
from gbeam.structure.shapes import ASSUMED_SHEAR, MATRICES
from gbeam.structure.supports import ROOT, Support, root_held
from gbeam.structure.temperature import Temperature

_ON_HULL = 33  # places on a line: chords of a quarter of a circle are off by 3e-4 of its radius
# Springs of the root by the motions that they yield to: along x, in the planes of y and z, about x; what holds these.
_PLANES = (
    (("translation_x",), "x", ""),
    (("translation_y", "rotation_z"), "y", "rz"),
    (("translation_z", "rotation_y"), "z", "ry"),
    (("rotation_x",), "rx", ""),
)
NO_TWIST = "no twist (section.torsion_constant is not given)"


@typed
@dataclass(frozen=True, eq=False)
class Beam(Value):
    """A beam, held at its root by the moving base: straight along x, or along a line.

    Raises
    ------
    InputError
        If a value is impossible, a mass, a load or a point lies off the beam, a name is no word or stands twice, the
        section's stations do not cover the beam, or its line has another length.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> beam.length
    0.3
    """

    length: Annotated[
        Annotated[float, Quantity("length", "positive", "length")],
        "length from root to tip, along the line",
    ]
    section: Annotated[Section, "cross-section, by shape or by properties: { area, inertia_y, inertia_z }"]
    material: Annotated[
        Material | None,
        "linear elastic material: { density, youngs_modulus, yield_strength }; none beside matrices, which have its "
        "stiffness and mass",
    ] = None
    masses: Annotated[Sequence[PointMass], "masses fixed to the beam: [ { at, mass } ]"] = ()
    damping_ratio: Annotated[
        Annotated[float | Numbers, Quantity("ratio"), OneOrSome()] | None,
        "modal damping ratio: one for all modes, or a list with one per mode, ascending in frequency; of the modes of "
        "the beam on a base at rest, with its root springs and bodies, also where the hub is free. run, place, models "
        "and linearize need it, 0 for none; the rest take none where it is left out",
    ] = None
    root: Annotated[Root, "springs that hold the root, which is rigid where left out"] = field(default_factory=Root)
    loads: Annotated[
        Sequence[Load], "forces and moments on the beam: [ { at, force, moment, distributed, follower } ]"
    ] = ()
    points: Annotated[
        Sequence[Point], "points of output beside the tip: [ { name, at } ]; a mass with a name is one at its place"
    ] = ()
    supports: Annotated[
        Sequence[Support],
        "places that the base holds besides the root: [ { at, holds, stiffness, damping } ]; one at 0 says what the "
        "root holds, which is all where there is none",
    ] = ()
    temperature: Annotated[
        Temperature | None,
        "temperature, the same in all of the beam: { value, reference }; it needs material.expansion",
    ] = None
    rotary_inertia: Annotated[
        bool,
        "false for sections that do not resist turning by their own second moments, each a point on the axis: the "
        "theory of Euler and Bernoulli, and the papers'",
    ] = True
    line: Annotated[
        Line | None,
        "reference line at rest, where it is not straight along x: { points, pieces, twist }; positions are lengths of "
        "arc",
    ] = None

    def __post_init__(self) -> None:
        """Refuse positions beyond the tip, and section, material and damping that do not fit one another."""
        object.__setattr__(self, "masses", tuple(self.masses))
        object.__setattr__(self, "loads", tuple(self.loads))
        object.__setattr__(self, "points", tuple(self.points))
        object.__setattr__(self, "supports", tuple(self.supports))
        self._place_by_names()
        positions = [(f"masses[{i}].at", mass.at) for i, mass in enumerate(self.masses)]
        positions += [(f"loads[{i}].at", load.place) for i, load in enumerate(self.loads) if load.at is not None]
        positions += [(f"points[{i}].at", point.at) for i, point in enumerate(self.points)]
        positions += [(f"supports[{i}].at", support.place) for i, support in enumerate(self.supports)]
        if self.line is not None and not abs(self.line.length - self.length) <= 1e-9 * self.line.length:
            fix = f"give length = {self.line.length!r}"
            raise InputError("length", f"is {self.length:g} m, and the line is {self.line.length:g} m long", fix)
        for key, position in positions:
            if position > self.length * (1 + 1e-12):
                raise InputError(
                    key,
                    f"is {position:g} m, beyond the tip",
                    f"give 0 to {self.length:g} m from the root",
                )
        stations = self.section.stations
        if stations and (abs(stations[0]) > 1e-9 * self.length or abs(stations[-1] / self.length - 1) > 1e-9):
            raise InputError(
                "section.stations",
                f"cover {stations[0]:g} to {stations[-1]:g} m",
                f"start at the root, 0 m, and end at the tip, {self.length:g} m",
            )
        if (self.material is None) != (self.section.shape == MATRICES):
            if self.material is None:
                raise InputError("material", "is missing", "give density and youngs_modulus")
            raise InputError("material", "is given beside a section by matrices, which have it", "leave it out")
        if self.section.plate and self.metal.poissons_ratio is None:
            raise InputError("material.poissons_ratio", "is missing, and a plate bends by it", "give it, such as 0.3")
        if self.temperature is not None:
            if self.material is None:
                raise InputError("temperature", "is given beside a section by matrices", "leave it out")
            with placing_within("material"):
                _ = self.material.thermal_strain
        self._hold()
        ratios = self.damping_ratio
        if ratios is None or holds_jax(ratios):
            return
        if isinstance(ratios, str):
            raise InputError("damping_ratio", f"is {ratios!r}", "give a number, or one for each mode")
        if not isinstance(ratios, (int, float)):
            object.__setattr__(self, "damping_ratio", tuple(float(z) for z in ratios))
        damping_ratios("damping_ratio", ratios)

    def _hold(self) -> None:
        """Let a support at 0 say what the root holds. Raise InputError if two say it, or something is free to move as
        a rigid body.
        """
        for i, support in enumerate(self.supports):
            if is_jax(support.place):
                problem = "is traced by JAX, and the shapes are placed by its number"
                raise InputError(f"supports[{i}].at", problem, "give a number")
        at_root = [i for i, support in enumerate(self.supports) if support.place == 0]
        if len(at_root) > 1:
            raise InputError(f"supports[{at_root[1]}].at", "is 0 a second time", "say in one what the root holds")
        place = "root"
        if at_root:
            place = f"supports[{at_root[0]}]"
            with placing_within(place):
                root = root_held(self.supports[at_root[0]])
            if self.root.springs not in ({}, root.springs):
                raise InputError("root", "and a support at 0 both say what the root holds", "keep one of them")
            object.__setattr__(self, "root", root)
        springs = self.root.springs
        for names, slides, turns in _PLANES:
            loose = [name for name in names if name in springs and not is_jax(springs[name]) and springs[name] == 0]
            held_motions = list[list[float]]()  # displacements of rigid motions of what is loose, along what is held
            for support in self.held_places.values():
                grip = {*support.rigid, *support.stiffness}
                motion = {names[0]: 1.0, names[-1]: support.place if turns else 1.0}
                if slides in grip:
                    held_motions.append([motion[name] for name in loose])
                if turns in grip:
                    held_motions.append([float(name == names[-1]) for name in loose])
            if loose and (not held_motions or np.linalg.matrix_rank(held_motions) < len(loose)):
                words = " and ".join(_adrift(loose, np.array(held_motions).reshape(-1, len(loose))))
                fix = f"give the root a stiffness, or hold {slides}{f' or {turns}' if turns else ''} at one more place"
                raise InputError(place, f"leaves the beam free to {words}, as a whole", fix)

    def _place_by_names(self) -> None:
        """Put loads and supports that name a point where it is. Raise InputError if there is no such point."""
        self._refuse_names_twice()
        named = self._points | {TIP: self.length}
        for kind in ("loads", "supports"):
            placed = list[Any]()
            for i, attachment in enumerate(getattr(self, kind)):
                if isinstance(attachment.at, str):
                    choice(f"{kind}[{i}].at", attachment.at, named)
                    attachment = replace(attachment, at=named[attachment.at])
                placed.append(attachment)
            object.__setattr__(self, kind, tuple(placed))

    @property
    def held_places(self) -> dict[int, Support]:
        """Supports beyond the root, by their indices."""
        return {i: support for i, support in enumerate(self.supports) if support.place > 0}

    def _refuse_names_twice(self) -> None:
        """Raise InputError if two points, or masses with a name, have the same one."""
        named = [(f"points[{i}].name", point.name) for i, point in enumerate(self.points)]
        named += [(f"masses[{i}].name", mass.name) for i, mass in enumerate(self.masses) if mass.name]
        for k, (place, name) in enumerate(named):
            if any(name == other for _, other in named[:k]):
                raise InputError(place, f"is {name!r} a second time", "give every point its own")

    @property
    def named_points(self) -> dict[str, float]:
        """Positions of the named points, bodies and middles of spans among them, and of the tip, from the root, m."""
        named = self._points
        spans = {name: position for name, position in self._spans.items() if name not in named}
        return named | spans | {TIP: self.length}

    @property
    def _points(self) -> dict[str, float]:
        """Positions of the points and masses that have a name, m."""
        bodies = {mass.name: mass.at for mass in self.masses if mass.name}
        return {point.name: point.at for point in self.points} | bodies

    @property
    def _spans(self) -> dict[str, float]:
        """Middles of the spans between root and supports, by name: `span`, or `span_1` and so on of several."""
        ends = [0.0, *sorted({support.place for support in self.held_places.values()})]
        names = ["span"] if len(ends) == 2 else [f"span_{k}" for k in range(1, len(ends))]
        return {name: (a + b) / 2 for name, (a, b) in zip(names, pairwise(ends), strict=True)}

    @property
    def root_dampers(self) -> list[Any]:
        """Dampers beside the root's springs, N s/m or N m s/rad, in their order."""
        at_root = [support.damping for support in self.supports if support.place == 0]
        dampers: Mapping[str, Any] = {ROOT[key]: value for damping in at_root for key, value in damping.items()}
        return [dampers.get(name, 0.0) for name in self.root.springs]

    @property
    def body_centres(self) -> Floats:
        """Centres of mass of the bodies on the undeformed beam, from the root, base axes, (b, 3) m."""
        offset = np.array([m.offset for m in self.masses], dtype=float).reshape(-1, 3)
        place, axes = self.at_rest([m.at for m in self.masses])
        return np.asarray(place + np.einsum("pab,pb->pa", axes, offset))

    def at_rest(self, x: Positions) -> tuple[Floats, Floats]:
        """Places (p, 3) m and axes of the sections in columns (p, 3, 3) at positions `x` (p,) m, base axes."""
        if self.line is not None:
            return self.line.places(x)
        at = np.asarray(x, dtype=float)
        return at[:, None] * np.eye(3)[0], np.broadcast_to(np.eye(3), (len(at), 3, 3))

    @property
    def envelope(self) -> Floats:
        """Places (c, 3) m at rest along the line and of the bodies' centres; (0, 3) of a straight beam."""
        if self.line is None:
            return np.empty((0, 3))
        edges = {0.0, *self.line.breaks, self.length}
        x = np.unique([*edges, *np.linspace(0, self.length, _ON_HULL)])
        return np.concatenate([self.at_rest(x)[0], self.body_centres])

    @property
    def coupled(self) -> bool:
        """True if it moves in several directions at once: by its line, or by a section's matrices."""
        return self.line is not None or self.material is None

    @property
    def metal(self) -> Material:
        """The material, of a section that is not given by matrices."""
        assert self.material is not None
        return self.material

    @property
    def density(self) -> Any:
        """Mass per volume, kg/m³; 1 of a section by matrices, whose area is its mass per length."""
        return 1.0 if self.material is None else self.material.density

    def rigidities(self, x: Positions) -> tuple[Any, Any, Any]:
        """EA, N, EI_y and EI_z, N m², at positions `x`, m: against stretching, bending along z and bending along y."""
        if self.material is None:
            axial, *_, about_y, about_z = self.stiffnesses(x)
            return axial, about_y, about_z
        section, modulus = self.section.at(x), self.material.youngs_modulus
        plate_factor = 1 / (1 - self.material.ratio**2) if self.section.plate else 1.0
        return modulus * section.area, modulus * section.inertia_y * plate_factor, modulus * section.inertia_z

    def stiffnesses(self, x: Positions) -> tuple[Any, ...]:
        """EA, kGA along y and z, N, GJ, EI_y and EI_z, N m², at positions `x`, m.

        They act against stretch, shears, twist and curvatures about y and z. GJ is NaN where the torsion constant is
        not known. Of a section by matrices these are the diagonal of its stiffness.
        """
        if self.material is None:
            stiffness = self.section.matrices(x)[0]
            return tuple(stiffness[..., k, k] for k in range(6))
        axial, about_y, about_z = self.rigidities(x)
        shear, area, ratio = self.material.rigidity, self.section.at(x).area, self.material.ratio
        in_shear = (shear * area * k for k in self.section.shear_coefficients(x, ratio))
        return axial, *in_shear, shear * self.section.torsion_constant(x), about_y, about_z


def _adrift(loose: Sequence[str], held_motions: Floats) -> Iterator[str]:
    """Yield words for the rigid motions that `held_motions` leave, rows of the `loose` ones of a root's motions."""
    if not held_motions.any():
        for motion, axis in (name.split("_") for name in loose):
            yield f"move along {axis}" if motion == "translation" else f"turn about {axis}"
        return
    slide, turn = np.linalg.svd(held_motions)[2][-1]  # of two: one is held
    axis = loose[-1][-1]
    yield f"turn about {axis} at {-1e3 * slide / turn:.4g} mm" if abs(turn) > 1e-9 else f"move along {loose[0][-1]}"


def assumptions(beam: Beam) -> tuple[str, ...]:
    """Assumptions of the beam theory's stated error where the beam gives no value, such as ``Poisson's ratio 0.3``."""
    words = []
    if beam.material is None:
        return ()
    if beam.material.poissons_ratio is None:
        words.append(f"Poisson's ratio {ASSUMED_RATIO:g}")
    if beam.section.shape == "general":
        if not {"shear_coefficient_y", "shear_coefficient_z"} <= beam.section.dimensions.keys():
            words.append(f"shear coefficients of {ASSUMED_SHEAR:g}")
        if np.isnan(beam.section.torsion_constant(np.zeros(1))).any():
            words.append(NO_TWIST)
    return tuple(words)


def fibre_strain(beam: Beam, at: Any, force: Any, moment: Any, y: Any, z: Any) -> Any:
    """Normal strain (..., s) at places (y, z), m, in sections `at` (s,), m, from the force and moment they carry."""
    if beam.material is None:
        carried = namespace(force, moment).concatenate([force, moment], axis=-1)[..., None]
        stiffness = beam.section.matrices(at)[0]
        strain = namespace(stiffness).linalg.inv(stiffness) @ carried
        return strain[..., 0, 0] + strain[..., 4, 0] * z - strain[..., 5, 0] * y
    axial, bending_z, bending_y = beam.rigidities(at)
    return force[..., 0] / axial + moment[..., 1] * z / bending_z - moment[..., 2] * y / bending_y


def names_at(beam: Beam, stations: ArrayLike) -> tuple[str, ...]:
    """Names of the points at positions (s,), m; a position without a point is named by itself, such as 100 mm."""
    slack, names = 1e-9 * beam.length, []
    for x in np.asarray(stations, dtype=float):
        point_names = (name for name, position in beam.named_points.items() if abs(position - x) <= slack)
        names.append(next(point_names, f"{1e3 * x:g} mm"))
    return tuple(names)
