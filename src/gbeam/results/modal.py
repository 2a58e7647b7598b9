"""Small vibrations about a relative equilibrium: modes at one instant, and frequencies against a hub's speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from gbeam.results.declared import declared, fact, internal, part, quantity, rows
from gbeam.results.equilibrium import Critical
from gbeam.results.errors import (
    FRAME,
    IN_GROUND,
    SEVERAL,
    ErrorEstimate,
    FrequencyErrors,
    Instability,
    Noted,
    Oscillating,
    totals,
)
from gbeam.results.parts import Base
from gbeam.results.result import Complex, Decided, Figured, Floats, Part
from gbeam.results.solids import SurfaceModes

SHOWN = 6  # frequencies in a short description
FAR = 2.0  # times the highest multiple of the speed: a mode above would press the others to the ground
FEW = 2  # modes drawn in any case


@dataclass(frozen=True, repr=False, eq=False)
class Modes(Oscillating, Decided, Figured[Literal["modes"]]):
    """Small vibrations about a relative equilibrium, ascending in frequency."""

    json_rows: ClassVar[dict[str, str]] = {"mode": "modes"}

    motion: str = fact("name of the motion")
    model: str = fact("kind of the model")
    time: float = fact("time at which the motion is frozen", "s")
    base: Base = part("motion of the base at that time")
    gyroscopic: bool = fact("whether Coriolis coupling is in")
    eigenvalue: Complex = internal(
        "1/s", "eigenvalues of the oscillating modes", "mode", note="one of each pair, with the positive imaginary part"
    )
    direction: tuple[str, ...] = quantity("", "direction in which the beam moves most", "mode", note="x, y, z or twist")
    coordinates: Complex = internal("", "generalised coordinates, of unit mass-weighted length", "mode coordinate")
    stations: Floats = quantity("m", "position along the beam from the root", "station", role="coordinate")
    shape: Complex = quantity("", "displacement, largest component 1", "mode station axis")
    equilibrium: Floats = quantity("m", "displacement about which the beam vibrates", "station axis", key=None)
    instabilities: tuple[Instability, ...] = rows("eigenvalues that grow", "instability", name=None)
    rigid: int = fact("number of modes of zero frequency, left out", note="the turning of a free hub")
    overdamped: Floats = quantity(
        "1/s",
        "negative real eigenvalues, of decay without oscillation",
        "eigenvalue",
        name=None,
        note="a divergence comes with one",
    )
    damping_given: bool = fact(
        "whether the beam has a damping ratio, be it zero", note="without one it is undamped", default=True
    )
    errors: FrequencyErrors | None = part(
        "errors of the frequencies",
        "mode",
        name="frequency_error_",
        note="None where there is no estimate",
        default=None,
    )
    width: Floats = quantity(
        "m",
        "extent of the section along y",
        "station",
        name="section_width",
        key="section.width",
        note="for pictures; empty without a beam",
        empty=True,
    )
    thickness: Floats = quantity(
        "m",
        "extent of the section along z",
        "station",
        name="section_thickness",
        key="section.thickness",
        note="empty without a beam",
        empty=True,
    )
    round: bool = quantity("", "whether the section is round", name="section_round", key="section.round", default=False)
    twist: Complex | None = quantity(
        "rad/m",
        "angle of the section about the beam's axis, for shapes in m",
        "mode station",
        optional=True,
        note="of a mode in the direction twist the section's edge has the largest displacement, 1; None of a model "
        "without twist",
        default=None,
    )

    place: Floats | None = quantity(
        "m",
        "place of the station at rest, base axes",
        "station axis",
        name="section_place",
        key="section.place",
        optional=True,
        note="for pictures; None of a straight beam",
        default=None,
    )
    across: Floats | None = quantity(
        "", "direction of the section's width at rest", "station axis", name="section_across", key="section.across",
        optional=True, default=None,
    )  # fmt: skip

    surface: SurfaceModes | None = part("surface of a solid, for pictures", name="surface_", key=None, default=None)
    frame: str = fact(FRAME, default="ground")
    ground_frequency: Floats = quantity("Hz", IN_GROUND, "mode", optional=True, note=SEVERAL, empty=True)

    @property
    def edge(self) -> Complex:
        """Displacement of the section's outermost fibre by twist, in the size of the shape, (k, s)."""
        if self.twist is None:
            return np.zeros(self.shape.shape[:2], dtype=complex)
        return self.twist * outermost(self.width, self.thickness, is_round=self.round)

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        listed = [f"{f:.4g} Hz {way}" for f, way in zip(self.frequency, self.direction, strict=True)]
        others = f" and {len(listed) - SHOWN} more" if len(listed) > SHOWN else ""
        lines = [f"Modes{motion} ({self.model}) at {self.time:.4g} s: {', '.join(listed[:SHOWN])}{others}"]
        lines += [*map(str, self.instabilities), *filter(None, [self.message])]
        return self._with_warnings(*lines)


def outermost(width: Floats, thickness: Floats, *, is_round: bool) -> Floats:
    """Distance of the outermost fibre from the axis of sections with some extents, m."""
    return width / 2 if is_round else np.hypot(width, thickness) / 2


@dataclass(frozen=True, repr=False, eq=False)
class Crossing(Part):
    """A mode met by a multiple of the speed: frequency = order × speed."""

    track: int = fact("index of the mode", name=None)
    order: int = quantity("", "multiple of the speed at which a mode meets it")
    speed: float = quantity("rad/s", "speed at which a mode meets a multiple")
    frequency: float = quantity("Hz", "frequency at which a mode meets a multiple")
    direction: str = fact("direction in which the beam moves most", name=None)
    errors: ErrorEstimate = part(
        "errors of the speed",
        name="error_",
        default_factory=ErrorEstimate,
        note="infinite where the exact model has no such crossing",
    )

    @declared("", "number of the mode that meets a multiple", key=None)
    def mode(self) -> int:
        return self.track + 1

    @declared("", "estimated error of the speed in all", name=None)
    def error_estimate(self) -> float:
        return self.errors.total


@dataclass(frozen=True, repr=False, eq=False)
class Unstable(Part):
    """A stretch of speed in which something grows, or there is no equilibrium."""

    start: float = quantity("rad/s", "speed at which the stretch begins")
    end: float = quantity("rad/s", "speed at which the stretch ends, or the diagram does")
    growth: float = quantity("1/s", "rate at which a motion grows, the largest", note="NaN without an equilibrium")


@dataclass(frozen=True, repr=False, eq=False)
class Campbell(Noted, Figured[Literal["campbell"]]):
    """Frequencies against speed, each column one mode followed through crossings and veering."""

    json_rows: ClassVar[dict[str, str]] = {"mode": "tracks"}

    motion: str = fact("name of the motion")
    model: str = fact("kind of the model")
    speed: Floats = quantity("rad/s", "hub rate", "speed", role="coordinate")
    frequency: Floats = quantity("Hz", "natural frequency; missing where it does not oscillate", "speed mode")
    damping_ratio: Floats = quantity("", "ratio of critical damping", "speed mode")
    mac: Floats = quantity("", "modal assurance criterion to the speed before", "speed mode", note="1 at the first")
    direction: tuple[str, ...] = quantity("", "direction in which the beam moves most, at the first speed", "mode")
    orders: tuple[int, ...] = fact("multiples of the speed")
    crossings: tuple[Crossing, ...] = rows("modes met by multiples of the speed", "crossing", name="crossing_")
    critical: Critical | None = part("where the equilibrium is lost within the range", name="critical_", key=None)
    errors: FrequencyErrors | None = part(
        "errors of the frequencies",
        "mode",
        name="frequency_error_",
        note="the largest of those at the first, a middle and the last speed",
        default=None,
    )
    unstable: tuple[Unstable, ...] = rows(
        "stretches of speed in which the equilibrium is not stable", "stretch", name="unstable_", default=()
    )
    frame: str = fact(FRAME, default="ground")
    ground_frequency: Floats = quantity("Hz", IN_GROUND, "speed mode", optional=True, note=SEVERAL, empty=True)

    @declared("", "estimated error of the frequency in all", "mode", name=None)
    def error_estimate(self) -> Floats:
        """Estimated errors of the frequencies, (k,), fractions; NaN where there is no estimate."""
        return totals(self.errors, len(self.direction))

    @declared("rad/s", "critical speed", role="fact", name=None)
    def critical_speed(self) -> float | None:
        """Speed at which the equilibrium is lost, rad/s; None where it is not."""
        return None if self.critical is None else self.critical.value

    @declared("", "how the equilibrium is lost, as a sentence", role="fact", name=None)
    def critical_speed_reason(self) -> str | None:
        """Sentence on the loss of equilibrium, None where there is none."""
        return None if self.critical is None else self.critical.reason

    @declared("", "errors of the critical speed", role="part", name=None)
    def critical_speed_errors(self) -> ErrorEstimate | None:
        """Errors of the critical speed, None where there is none."""
        return None if self.critical is None else self.critical.errors

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        critical_reason = "" if self.critical is None or self.critical.value is None else f"\n  {self.critical.reason}"
        return (
            f"Campbell{motion} ({self.model}): {len(self.direction)} modes at {len(self.speed)} speeds, "
            f"{self.speed[0]:.4g} to {self.speed[-1]:.4g} rad/s; {len(self.crossings)} crossings with multiples "
            f"{', '.join(str(order) for order in self.orders) or 'none'} of the speed{critical_reason}"
        )


def near_multiples(frequency: Floats, speed: Floats, orders: Sequence[int]) -> list[int]:
    """Return the indices of the modes that a Campbell diagram draws, from frequencies (k, v), Hz, at speeds (v,),
    rad/s: the first two, and those that are not far above every multiple of the speed.
    """
    far = FAR * max(orders, default=0) * speed[-1] / (2 * np.pi) if len(orders) else np.inf
    return [k for k, history in enumerate(frequency) if k < FEW or not np.nanmin(history, initial=np.inf) > far]
