"""Relative equilibria, and where they are lost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np

from gbeam.constants import BY_STRAINS
from gbeam.printable import percent
from gbeam.results.declared import INSIDE, declared, fact, internal, labels, part, quantity, rows
from gbeam.results.declared import quantity as entry  # a critical value has a field of that name
from gbeam.results.errors import (
    FRAME,
    MODEL,
    SHAPES,
    THEORY,
    TOTAL,
    UNKNOWN,
    Accelerated,
    ErrorEstimate,
    Errors,
    accelerated,
    acceleration_lines,
)
from gbeam.results.facts import at_place
from gbeam.results.one_body import RestingBody
from gbeam.results.parts import Base, Loads, Outline, Supports
from gbeam.results.result import Decided, Figured, Flags, Floats, Part, brief
from gbeam.results.solids import SolidStress, SpecimenLoads, Surface
from gbeam.results.system import Assembly, Placed, most_moved


@dataclass(frozen=True, repr=False, eq=False)
class BodyRest(Part):
    """One body that deforms, or a rigid specimen, at rest in its system, in axes of its root."""

    model: str = fact("kind of the model")
    base: Base = part("motion of its root at that time")
    stations: Floats = quantity(
        "m", "position along the body from the root", "station", role="coordinate", note="the last is the tip"
    )
    displacement: Floats = quantity("m", "displacement relative to the root", "station axis")
    q: Floats = internal(
        lambda self: "" if self.model in BY_STRAINS else "m",
        "generalised coordinates of the body",
        "coordinate",
        note="in files they are the system's",
    )
    strain_energy: float = quantity("J", "strain energy")
    loads: Loads | None = internal("", "forces, moments and stresses of the sections, of one time", default=None)
    solid: SolidStress | None = part("stress of a solid, of one time", name=None, optional=True, default=None)
    surface: Surface | None = part("surface of a solid, for pictures", name="surface_", key=None, default=None)
    specimen: SpecimenLoads | None = part(
        "loads of a rigid specimen, of one time", name=None, optional=True, default=None
    )
    outline: Outline | None = part("shape of a beam, for pictures", name=INSIDE, key=None, default=None)
    supports: Supports | None = part(
        "places at which the body is held, for pictures", name="holder_", key=None, note="None without supports",
        default=None,
    )  # fmt: skip

    @declared("", "forces, moments and stresses of the sections", role="part", key="loads", optional=True)
    def carried(self) -> Loads | None:
        if self.loads is None:
            return None
        return replace(at_place(self.loads, 0), stations=self.loads.stations, supports=self.loads.supports)

    @declared("m", "displacement of the tip relative to the root", "axis", name=None)
    def tip(self) -> Floats:
        return self.displacement[-1]

    @property
    def bends(self) -> bool:
        """True of a body that is drawn along its length: it is neither a mesh nor a rigid specimen."""
        return self.solid is None and self.specimen is None

    @property
    def lines(self) -> tuple[str, ...]:
        """Displacement of the tip and stress, or the loads of a rigid specimen, in words."""
        if self.specimen is not None:
            return tuple(self.specimen.lines)
        tip = ", ".join(f"{1e3 * component:.4g}" for component in self.tip)
        return f"tip ({tip}) mm", *(() if self.solid is None else self.solid.lines)


@dataclass(frozen=True, repr=False, eq=False)
class Rest(RestingBody, Placed, Decided, Figured[str]):
    """Relative equilibrium of a system at a frozen motion of its ground.

    Examples
    --------
    >>> rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
    >>> hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], stiffness=10.0)
    >>> held = gb.System({"rod": rod}, {"hinge": hinge}, gravity=(0, 0, -9.81))
    >>> rest = gb.static(held)
    >>> print(f"{rest.coordinate('hinge.angle'):.4f} rad, {rest.ground_force[2]:.2f} N")
    0.4431 rad, -9.81 N
    """

    listed_by, unnamed = "motion", "ground"
    json_rows: ClassVar[dict[str, str]] = {"point": "points", "coordinate": "coordinates"}

    motion: str = fact("name of the motion", key=None, note="empty where there is none")
    time: float = fact("time at which drives and motion are frozen", "s")
    base: Base | None = part(
        "motion of the ground at that time", name="ground_", optional=True, note="None where it rests"
    )
    points: tuple[str, ...] = labels("name of the point", "point")
    coordinates: tuple[str, ...] = labels("name of the coordinate", "coordinate")
    units: tuple[str, ...] = quantity(
        "", "SI unit of the coordinate", "coordinate", name="coordinate_unit", key="unit",
        note="empty of Euler parameters and of a flexible body's own",
    )  # fmt: skip
    place: Floats = quantity("m", "place of the point", "point axis", frame="ground")
    point_displacement: Floats = quantity(
        "m", "displacement of the point from the start", "point axis", key="displacement", frame="ground"
    )
    attitude: Floats = quantity("", "Euler parameters of the point's axes in those of the ground", "point euler")
    q: Floats = quantity("", "coordinates: m and rad of joints, their own of flexible bodies", "coordinate")
    effort: Floats = quantity("", "force N or torque N m of the drive on each coordinate", "coordinate")
    stable: bool | None = fact(
        "whether it comes back after any small disturbance, or stays near",
        note="not by gyroscopic coupling alone, which any damping would spoil; None where that is not known",
    )
    ground_force: Floats = quantity("N", "force on the ground", "axis", frame="ground")
    ground_moment: Floats = quantity("N m", "moment on the ground about its origin", "axis", frame="ground")
    bodies: Mapping[str, BodyRest] = rows(
        "bodies that deform, and rigid specimens, by name", "body", optional=True, name="", default_factory=dict
    )
    accelerated: tuple[Accelerated, ...] = accelerated()
    errors: Errors = part(
        "of deflections, places, root loads and stress, as fractions of the largest", name="error_",
        default_factory=Errors,
    )  # fmt: skip
    assembly: Assembly | None = part(
        "how the bodies hang together", key=None, name=INSIDE, note="None where nothing is to be drawn", default=None
    )

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        kinds = dict.fromkeys(body.model for body in self.bodies.values())
        models = f" ({', '.join(kinds)})" if kinds else ""
        sentences = []
        for name, body in self.bodies.items():
            start = f"{name}: " if len(self.bodies) > 1 else ""
            sentences += [f"{start}{line}" for line in body.lines]
        if self.several:
            sentences.insert(0, most_moved(self, np.linalg.norm(self.point_displacement, axis=-1)))
        force = ", ".join(f"{component:.4g}" for component in self.ground_force)
        lines = [f"Rest{motion}{models} at {self.time:.4g} s: {sentences[0]}", *sentences[1:]]
        lines += [f"force on the ground ({force}) N", *acceleration_lines(self.accelerated)]
        total = self.errors.displacement.total
        if self.errors.beams and math.isfinite(total):
            lines.append(f"estimated error {percent(total)}")
        if self.message:
            lines.append(self.message)
        return self._with_warnings(*lines)


LOST = {"critical_speed": "rad/s", "critical_acceleration": "m/s^2", "critical_load_factor": ""}


@dataclass(frozen=True, repr=False, eq=False)
class Critical(Decided, Figured[Literal["critical"]]):
    """Point at which the stiffness about the relative equilibrium stops being positive definite, or something grows."""

    quantity: str = fact("quantity that is raised", note="hub rate or rate, acceleration along x, or load factor")
    unit: str = fact("unit of the quantity", note="rad/s, m/s^2, or none of a factor of the loads", name=None)
    value: float | None = entry(lambda self: self.unit, "critical value; missing where it is not reached", key=None)
    searched_to: float = entry(lambda self: self.unit, "end of the search")
    kind: str = fact("how it is lost", note="divergence, flutter, no equilibrium, none or not known")
    direction: str = fact("direction of the mode that is lost", note="empty where there is none")
    reason: str = fact("the answer as a sentence")
    model: str = fact("kind of the model")
    motion: str = fact("name of the motion, where one is meant", name=None, default="")
    errors: ErrorEstimate = part(
        "errors of the value",
        name="error_",
        default_factory=ErrorEstimate,
        note="that of the model is infinite where the exact one keeps its equilibrium to three times the value",
    )
    error_note: str = fact(UNKNOWN, optional=True, default="")
    followed: Floats = entry(
        lambda self: self.unit,
        "values of the quantity from none to the critical one",
        "followed",
        role="coordinate",
        note="to the end of the search where nothing is lost",
        empty=True,
    )
    frequency: Floats = entry(
        "Hz", "lowest frequencies about the equilibrium there, undamped", "followed lowest", empty=True
    )
    frame: str = fact(FRAME, default="ground")

    @declared(LOST, "critical value by what is raised", role="fact", name=None, key=INSIDE)
    def by_name(self) -> dict[str, float | None]:
        names = dict(zip(("rate", "acceleration along x", "load factor"), LOST, strict=True))
        return {names[self.quantity.removeprefix("hub ")]: self.value}

    @declared("", "estimated error from too few shapes", name=None)
    def error_estimate(self) -> float:
        """Error of the value from too few shapes, a fraction, or NaN where there is no estimate."""
        return self.errors.shapes

    def __repr__(self) -> str:
        value = f"none up to {self.searched_to:.6g}" if self.value is None else f"{self.value:.6g}"
        return self._with_warnings(f"Critical {self.quantity} ({self.model}): {value} {self.unit}", self.reason)


LIMIT_POINT, BRANCH_POINT = "limit point", "branch point"


@dataclass(frozen=True, repr=False, eq=False)
class CriticalPoint(Part):
    """Point of an equilibrium path at which stability is lost, or regained."""

    kind: str = fact("limit point, at which it snaps under dead loads, or branch point, at which it buckles")
    factor: float = fact("factor of the loads or the motion")
    displacement: Floats = entry("m", "displacement of the point", "point axis", frame="ground")
    errors: ErrorEstimate = part("errors of the factor", name="error_", default_factory=ErrorEstimate)

    def __repr__(self) -> str:
        known = math.isfinite(self.errors.total)
        error = f", estimated error {percent(self.errors.total)}" if known else ""
        return f"{self.kind} at a factor of {self.factor:.4g}{error}"


@dataclass(frozen=True, repr=False, eq=False)
class EquilibriumPath(Decided, Figured[Literal["path"]]):
    """Equilibria of a system under its loads, or a motion, times a factor, also those that it leaves by a snap."""

    json_rows: ClassVar[dict[str, str]] = {"step": "path"}

    motion: str = fact("name of the motion", note="empty where there is none")
    time: float = fact("time at which loads, drives and motion are frozen", "s")
    model: str = fact("kind of the model")
    quantity: str = fact("quantity that is multiplied by the factor", note="loads or motion")
    searched_to: float = fact("factor that was asked for")
    points: tuple[str, ...] = labels("name of the point", "point", key="points")
    factor: Floats = entry("", "factor of the quantity along the path", "step", role="coordinate")
    displacement: Floats = entry(
        "m", "displacement of the point from where the factor is zero", "step point axis", frame="ground"
    )
    q: Floats = internal("", "coordinates: m and rad of joints, their own of flexible bodies", "step coordinate")
    stable: Flags = entry("", "whether it would stay there", "step", flags=("unstable", "stable"))
    critical: tuple[CriticalPoint, ...] = rows(
        "points at which stability is lost, or regained", "critical_point", name="critical_", default=()
    )
    errors: ErrorEstimate = part(
        "largest distance from richer models' paths, in factor and displacement, as a fraction of their largest",
        name="error_",
        default_factory=ErrorEstimate,
    )
    error_note: str = fact(UNKNOWN, optional=True, default="")

    @property
    def most_moved(self) -> tuple[int, int]:
        """Number of the point and of the axis along which it moves farthest."""
        point, axis = np.unravel_index(np.abs(self.displacement).max(axis=0).argmax(), self.displacement.shape[1:])
        return int(point), int(axis)

    def __repr__(self) -> str:
        lost = [str(point) for point in self.critical] or [f"no critical point up to {self.factor[-1]:.4g}"]
        lines = [f"EquilibriumPath ({self.model}): {len(self.factor)} equilibria under growing {self.quantity}", *lost]
        if math.isfinite(self.errors.total):
            lines.append(f"estimated error of the path {percent(self.errors.total)}")
        return self._with_warnings(*lines, *filter(None, [self.message]))


@dataclass(frozen=True, repr=False, eq=False)
class MapErrors(Part):
    """Estimated errors of the speeds of a map, as fractions, (m, p) each, or NaN where there is none.

    Infinite where the exact model keeps its equilibrium to three times the speed.
    """

    shapes: Floats = entry("", SHAPES)
    model: Floats = entry("", MODEL)
    beam_theory: Floats = entry("", THEORY)
    total: Floats = entry("", TOTAL)


@dataclass(frozen=True, repr=False, eq=False)
class CriticalMap(Figured[Literal["critical"]]):
    """Critical hub rates against a mass on the beam and its position."""

    motion: str = fact("name of the motion")
    model: str = fact("kind of the model")
    mass: Floats = entry("kg", "mass on the beam", "mass", role="coordinate")
    position: Floats = entry("m", "its position from the root", "position", role="coordinate")
    speed: Floats = entry(
        "rad/s", "critical hub rate; missing where it is not reached", "mass position", key="critical_speed"
    )
    searched_to: float = fact("end of the search", "rad/s")
    errors: MapErrors | None = part(
        "errors of the speeds",
        "mass position",
        name="speed_error_",
        note="None where there is no estimate",
        default=None,
    )

    def __repr__(self) -> str:
        return brief(self)
