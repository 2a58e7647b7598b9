"""Relative equilibria, and where they are lost."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from gbeam.constants import BY_STRAINS
from gbeam.printable import percent
from gbeam.results.declared import INSIDE, declared, fact, internal, part, quantity
from gbeam.results.declared import quantity as entry  # a critical value has a field of that name
from gbeam.results.errors import FRAME, MODEL, SHAPES, THEORY, TOTAL, UNKNOWN, ErrorEstimate, Errors
from gbeam.results.facts import at_place
from gbeam.results.parts import Base, Loads
from gbeam.results.result import Decided, Figured, Floats, Part, brief
from gbeam.results.solids import SolidStress, SpecimenLoads, Surface


@dataclass(frozen=True, repr=False, eq=False)
class Deflection(Decided, Figured[Literal["shape", "loads"]]):
    """Relative equilibrium at a frozen base motion."""

    listed_by, unnamed = "motion", "beam"
    motion: str = fact("name of the motion", key=None)
    model: str = fact("kind of the model")
    time: float = fact("time at which the motion is frozen", "s")
    base: Base = part("motion of the base at that time")
    stations: Floats = quantity(
        "m", "position along the beam from the root", "station", role="coordinate", note="the last is the tip"
    )
    displacement: Floats = quantity("m", "displacement relative to the base axes", "station axis")
    q: Floats = quantity(
        lambda self: "" if self.model in BY_STRAINS else "m",
        "generalised coordinates of the beam",
        "coordinate",
        name="coordinates",
        key=None,
    )
    strain_energy: float = quantity("J", "strain energy")
    stable: bool | None = fact(
        "whether the stiffness about the equilibrium is positive definite",
        note="under loads that follow the beam, whether no vibration about it grows; None where that is not known",
    )
    loads: Loads | None = internal("", "forces, moments and stresses of the sections, of one time", default=None)
    errors: Errors = part("of displacement, root loads and stress", name=None, default_factory=Errors)
    solid: SolidStress | None = part("stress of a solid, of one time", name=None, optional=True, default=None)
    surface: Surface | None = part("surface of a solid, for pictures", name="surface_", key=None, default=None)
    specimen: SpecimenLoads | None = part(
        "loads of a rigid specimen, of one time", name=None, optional=True, default=None
    )

    @declared("", "forces, moments and stresses of the sections", role="part", name=None, key="loads", optional=True)
    def carried(self) -> Loads | None:
        return None if self.loads is None else replace(at_place(self.loads, 0), stations=self.loads.stations)

    @declared("m", "displacement of the tip relative to the base axes", "axis", name=None)
    def tip(self) -> Floats:
        return self.displacement[-1]

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        tip = ", ".join(f"{1e3 * each:.4g}" for each in self.tip)
        stability = "stable" if self.stable else self.message or "NOT stable: no beam would stay there"
        total = self.errors.displacement.total
        error = f"; estimated error {percent(total)}" if math.isfinite(total) else ""
        head = f"Deflection{motion} ({self.model}) at {self.time:.4g} s:"
        if self.specimen is not None:
            first, *others = self.specimen.lines
            return self._with_warnings(f"{head} {first}", *others)
        lines = () if self.solid is None else self.solid.lines
        return self._with_warnings(f"{head} tip ({tip}) mm{error}; {stability}", *lines)


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
        """Error of the value from too few shapes, a fraction; NaN where there is no estimate."""
        return self.errors.shapes

    def __repr__(self) -> str:
        value = f"none up to {self.searched_to:.6g}" if self.value is None else f"{self.value:.6g}"
        return self._with_warnings(f"Critical {self.quantity} ({self.model}): {value} {self.unit}", self.reason)


@dataclass(frozen=True, repr=False, eq=False)
class MapErrors(Part):
    """Estimated errors of the speeds of a map, as fractions, (m, p) each; NaN where there is none.

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
