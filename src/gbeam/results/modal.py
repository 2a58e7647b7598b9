"""Small vibrations about a relative equilibrium: modes at one instant, and frequencies against a hub's speed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from gbeam.results.declared import INSIDE, declared, fact, internal, labels, part, quantity, rows
from gbeam.results.equilibrium import Critical
from gbeam.results.errors import (
    FRAME,
    IN_GROUND,
    SEVERAL,
    Accelerated,
    ErrorEstimate,
    FrequencyErrors,
    Instability,
    Noted,
    Oscillating,
    accelerated,
    acceleration_lines,
    totals,
)
from gbeam.results.one_body import ShapedBody
from gbeam.results.parts import Base, Outline, Supports
from gbeam.results.result import Complex, Decided, Figured, Floats, Part
from gbeam.results.solids import SurfaceModes
from gbeam.results.system import Assembly

SHOWN = 6  # frequencies in a short description
FAR = 2.0  # times the highest multiple of the speed: a mode above would press the others to the ground
FEW = 2  # modes drawn in any case


@dataclass(frozen=True, repr=False, eq=False)
class BodyModes(Part):
    """One body that deforms in the modes of its system, in axes of its root and in the size of the modes' shapes."""

    json_rows: ClassVar[dict[str, str]] = {"mode": "modes"}

    model: str = fact("kind of the model")
    base: Base = part("motion of its root at that time")
    damping_given: bool = fact("whether the body has a damping ratio, be it zero", note="without one it is undamped")
    direction: tuple[str, ...] = quantity(
        "", "direction in which the body moves most", "mode", note="x, y, z or twist; empty where it does not"
    )
    coordinates: Complex = internal("", "generalised coordinates of the body", "mode coordinate")
    stations: Floats = quantity("m", "position along the body from the root", "station", role="coordinate")
    shape: Complex = quantity("", "displacement of the station relative to the root", "mode station axis")
    equilibrium: Floats = quantity("m", "displacement about which the body vibrates", "station axis", key=None)
    twist: Complex | None = quantity(
        "rad/m",
        "angle of the section about the beam's axis, for shapes in m",
        "mode station",
        optional=True,
        note="None of a model without twist",
        default=None,
    )
    outline: Outline | None = part("shape of a beam at rest, for pictures", key=None, name=INSIDE, default=None)
    outline_shape: Complex | None = quantity(
        "", "displacement of the beam's axis relative to the root", "mode point axis", key=None, default=None
    )
    outline_twist: Complex | None = quantity(
        "rad/m", "angle of the beam's section about its axis, for shapes in m", "mode point", key=None, default=None,
        note="None of a model without twist",
    )  # fmt: skip
    supports: Supports | None = part(
        "places at which the body is held, for pictures", name="holder_", key=None, note="None without supports",
        default=None,
    )  # fmt: skip
    support_shape: Complex | None = quantity(
        "", "displacement of the place that is held", "mode holder axis", name="holder_shape", key=None, default=None
    )
    surface: SurfaceModes | None = part("surface of a solid, for pictures", name="surface_", key=None, default=None)

    def moved(self, k: int) -> tuple[Floats, Complex]:
        """Positions along the body, (p,) m, and how far they move in the direction of the mode k, (p,): of one in the
        direction twist its sections' outermost fibres.
        """
        section, way = self.outline, self.direction[k]
        if way == "twist" and section is not None and self.outline_twist is not None:
            fibre = outermost(section.width, section.thickness, is_round=section.round)
            return section.points, self.outline_twist[k] * fibre
        if way == "twist":
            return self.stations, np.full(len(self.stations), np.nan + 0j)
        if section is None or self.outline_shape is None or len(self.stations) >= len(section.points):
            return self.stations, self.shape[k, :, "xyz".index(way)]
        return section.points, self.outline_shape[k, :, "xyz".index(way)]


@dataclass(frozen=True, repr=False, eq=False)
class Modes(ShapedBody, Oscillating, Decided, Figured[Literal["modes"]]):
    """Small vibrations of a system about a steady state, in which it rests or is accelerated evenly, by frequency.

    Examples
    --------
    >>> rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
    >>> hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], initial=1.0)
    >>> pendulum = gb.System({"rod": rod}, {"hinge": hinge}, gravity=(0, 0, -9.81))
    >>> print(gb.modes(pendulum).frequency.round(4))
    [0.6105]
    """

    json_rows: ClassVar[dict[str, str]] = {"mode": "modes"}

    motion: str = fact("name of the motion", note="empty where there is none")
    time: float = fact("time at which drives and motion are frozen", "s")
    base: Base | None = part(
        "motion of the ground at that time", name="ground_", optional=True, note="None where it rests"
    )
    gyroscopic: bool = fact("whether Coriolis coupling is in")
    eigenvalue: Complex = internal(
        "1/s", "eigenvalues of the oscillating modes", "mode", note="one of each pair, with the positive imaginary part"
    )
    direction: tuple[str, ...] = quantity(
        "", "what moves most", "mode",
        note="of a body alone x, y, z or twist; else the body with most kinetic energy, and an axis of its root along "
        "or, as in arm rx, about which it moves",
    )  # fmt: skip
    points: tuple[str, ...] = labels("name of the point", "point", key="point_names")
    body_names: tuple[str, ...] = labels("name of the body", "body", key="")
    point_shape: Complex = quantity(
        "", "displacement of the point; of all points and stations the largest component is 1", "mode point axis",
        frame="ground",
    )  # fmt: skip
    point_turn: Complex = quantity(
        "rad/m", "rotation of the point's axes, for shapes in m", "mode point axis", key=None, frame="ground"
    )
    share: Floats = quantity("", "share of the body in the kinetic energy", "mode body")
    place: Floats = quantity("m", "place of the point at rest", "point axis", key=None, frame="ground")
    attitude: Floats = quantity(
        "", "Euler parameters of the point's axes at rest in those of the ground", "point euler", key=None
    )
    bodies: Mapping[str, BodyModes] = rows("bodies that deform, by name", "body", optional=True, name="")
    instabilities: tuple[Instability, ...] = rows("eigenvalues that grow", "instability", name=None)
    rigid: int = fact("number of motions of zero frequency, left out", note="such as the turning of a free hub")
    overdamped: Floats = quantity(
        "1/s",
        "negative real eigenvalues, of decay without oscillation",
        "eigenvalue",
        name=None,
        note="a divergence comes with one",
    )
    accelerated: tuple[Accelerated, ...] = accelerated()
    errors: FrequencyErrors | None = part(
        "errors of the frequencies",
        "mode",
        name="frequency_error_",
        note="None where there is no estimate",
        default=None,
    )
    reached: float = fact(
        "frequency to which the modes of meshes and matrices among the bodies reach, at rest: those above are upper "
        "bounds", "Hz", note="NaN where there are none", default=math.nan,
    )  # fmt: skip
    assembly: Assembly | None = part(
        "how the bodies hang together", key=None, name=INSIDE, note="None where nothing is to be drawn", default=None
    )
    frame: str = fact(FRAME, default="ground")
    ground_frequency: Floats = quantity("Hz", IN_GROUND, "mode", optional=True, note=SEVERAL, empty=True)

    @declared("", "whether every body has a damping ratio, be it zero", role="fact")
    def damping_given(self) -> bool:
        """True if every body that deforms has a damping ratio, be it zero; others are undamped."""
        return all(body.damping_given for body in self.bodies.values())

    @declared("", "body that moves most", "mode", name=None)
    def foremost(self) -> tuple[str, ...]:
        """Name of the body with the most kinetic energy in each mode."""
        return tuple(self.body_names[k] for k in self.share.argmax(axis=1)) if len(self.share) else ()

    def __repr__(self) -> str:
        motion = f" {self.motion!r}" if self.motion else ""
        kinds = dict.fromkeys(body.model for body in self.bodies.values())
        models = f" ({', '.join(kinds)})" if kinds else ""
        modes = [f"{f:.4g} Hz {way}" for f, way in zip(self.frequency, self.direction, strict=True)]
        remainder = f" and {len(modes) - SHOWN} more" if len(modes) > SHOWN else ""
        lines = [f"Modes{motion}{models} at {self.time:.4g} s: {', '.join(modes[:SHOWN])}{remainder}"]
        if self.rigid == 1:
            lines.append("one motion of zero frequency is left out")
        elif self.rigid:
            lines.append(f"{self.rigid} motions of zero frequency are left out")
        lines += [*acceleration_lines(self.accelerated), *map(str, self.instabilities)]
        if self.message:
            lines.append(self.message)
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
        """Estimated errors of the frequencies, (k,), fractions, or NaN where there is no estimate."""
        return totals(self.errors, len(self.direction))

    @declared("rad/s", "critical speed", role="fact", name=None)
    def critical_speed(self) -> float | None:
        """Speed at which the equilibrium is lost, rad/s, or None where it is not."""
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
    limit = FAR * max(orders, default=0) * speed[-1] / (2 * np.pi) if len(orders) else np.inf
    return [k for k, history in enumerate(frequency) if k < FEW or not np.nanmin(history, initial=np.inf) > limit]
