"""The response of a beam in one environment: what moved, how well it is known, and what the base did meanwhile."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol

import numpy as np

from gbeam.arrays.namespace import is_traced
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Numbers
from gbeam.constants import BY_STRAINS
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, index_of, positive
from gbeam.numerics.samples import displacement
from gbeam.printable import percent
from gbeam.results.accounting import seconds
from gbeam.results.declared import INSIDE, declared, fact, internal, labels, part, quantity
from gbeam.results.errors import Errors
from gbeam.results.machine import AxesFigure, AxesResult, Driven
from gbeam.results.parts import Base, Influence, Loads, Outline, Peaks, VectorPeaks
from gbeam.results.result import Figured, Floats, Part, brief
from gbeam.results.solids import SolidStress, SpecimenLoads, Surface

ResponseFigure = Literal["tip", "specimen", "base", "sensors", "loads", AxesFigure, "hub", "stress"]
RESOLVED = 4.0  # samples to a period of the sensor


@typed
@dataclass(frozen=True, eq=False)
class Sensor(Value):
    """An accelerometer of three axes: a mass on a spring along each, of which the deflection is read.

    Parameters
    ----------
    turn : (3,)
        Rotation vector of its axes in the base axes, rad.
    frequency : float, optional
        Natural frequency of the spring, or the cut-off of a filter of second order, Hz; without one it reads the
        acceleration itself.
    damping_ratio : float
        Of the spring; 0.7 gives the widest flat range.
    sensitivity : (3, 3), optional
        Reading of each axis for a unit along each: one on the diagonal, and beside it what leaks from the others.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> gb.Sensor(turn=(0, 0, 1.5708), frequency=200.0).damping_ratio
    0.7
    """

    turn: Numbers = (0.0, 0.0, 0.0)
    frequency: float | None = None
    damping_ratio: float = 0.7
    sensitivity: Any = None

    def __post_init__(self) -> None:
        turn = np.asarray(array("turn", self.turn), dtype=float)
        if turn.shape != (3,) or not np.isfinite(turn).all():
            raise InputError("turn", f"is {self.turn!r}", "give three components in rad")
        if self.frequency is not None:
            positive("frequency", self.frequency, "Hz")
        positive("damping_ratio", self.damping_ratio, "(a share)")
        if self.sensitivity is not None:
            matrix = np.asarray(array("sensitivity", self.sensitivity), dtype=float)
            if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
                raise InputError("sensitivity", f"has the shape {matrix.shape}", "give 3 × 3 numbers")

    @typed
    def reads(self, acceleration: Any, step: float) -> Floats:
        """Return what it reads of an acceleration over time, after having settled in the first.

        Parameters
        ----------
        acceleration : (t, 3)
            Base axes, m/s²; specific force where gravity acts, as sensors feel it.
        step : float
            Between the samples, s.

        Raises
        ------
        InputError
            If the samples do not resolve its frequency.

        Examples
        --------
        >>> import numpy as np
        >>> still = np.tile([0.0, 0.0, 9.81], (50, 1))
        >>> print(gb.Sensor(frequency=50.0).reads(still, step=1e-3)[-1])
        [0.   0.   9.81]
        """
        from scipy.spatial.transform import Rotation

        felt = np.asarray(array("acceleration", acceleration), dtype=float)
        if felt.ndim != 2 or felt.shape[1] != 3:
            raise InputError("acceleration", f"has the shape {felt.shape}", "give three components at each time")
        felt = felt @ Rotation.from_rotvec(self.turn).as_matrix()
        if self.frequency is not None:
            omega = 2 * np.pi * self.frequency
            if RESOLVED * self.frequency * positive("step", step, "s") > 1:
                problem = f"is {self.frequency:g} Hz, with samples {step:g} s apart"
                raise InputError("frequency", problem, f"simulate in steps of {1 / (RESOLVED * self.frequency):.2g} s")
            felt = omega**2 * displacement(felt, omega, self.damping_ratio, step)
        return felt if self.sensitivity is None else felt @ np.asarray(self.sensitivity, dtype=float).T


@dataclass(frozen=True, repr=False, eq=False)
class Readings(Part):
    """Readings of accelerometers at points over time, along their own axes."""

    json_rows: ClassVar[dict[str, str]] = {"sensor": ""}

    points: tuple[str, ...] = labels("name of the point at which the sensor is", "sensor")
    acceleration: Floats = quantity("m/s^2", "reading of the sensor", "time sensor axis", frame="axes of the sensor")
    peaks: VectorPeaks = part("largest readings", "sensor", unit="m/s^2", name="max_", key=INSIDE)


@dataclass(frozen=True, repr=False, eq=False)
class HubResult(Part):
    """A hub turning about z."""

    angle: Floats = quantity("rad", "hub angle about z", "time", name="hub_angle")
    rate: Floats = quantity("rad/s", "hub rate about z", "time", name="hub_rate")
    acceleration: Floats = quantity("rad/s^2", "hub acceleration about z", "time", name="hub_acceleration")
    drive_torque: Floats | None = quantity(
        "N m",
        "torque of the hub's drive about z",
        "time",
        note="None where the rate is prescribed and the hub's inertia not known",
        default=None,
    )
    free: bool = internal("", "whether the hub's motion is a result, not prescribed", default=False)
    fastest: float = internal("rad/s", "largest size of the rate at all steps", default=0.0)

    @declared("rad", "angle at the end", name=None)
    def angle_end(self) -> float:
        return float(self.angle[-1])

    @declared("rad/s", "largest size of the rate", name=None)
    def rate_max(self) -> float:
        return max(float(abs(self.rate).max()), self.fastest)

    @declared("rad/s", "rate at the end", name=None)
    def rate_end(self) -> float:
        return float(self.rate[-1])


class PlotHeading(Protocol):
    """Parts of a result that a plot's title names: the motion's name and how its computation ended."""

    @property
    def name(self) -> str: ...
    @property
    def outcome(self) -> str: ...
    @property
    def time(self) -> Floats: ...


@dataclass(frozen=True, repr=False, eq=False)
class Response(Driven, Figured[ResponseFigure]):
    """Response of the beam in one environment.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> response = gb.simulate(structure, turn, duration=6.0)
    >>> response.outcome, response.displacement.shape[1:]
    ('done', (1, 3))
    >>> print(f"{1e3 * response.peaks.max_abs[2]:.3f} mm at {response.peaks.time_of_max[2]:.1f} s")
    2.302 mm at 2.5 s
    """

    json_rows: ClassVar[dict[str, str]] = {"station": "stations"}

    name: str = internal("", "name of the motion")
    environment: str = fact("flight, centrifuge or hub")
    model: str = fact("kind of the model")
    outcome: str = fact(
        "how it ended",
        note="done, diverged (the displacement left what the model can mean, or the beam lost its stability for so "
        "long that whatever deviates grows a thousandfold) or not converged",
    )
    message: str = fact("what happened and what to try, where the outcome is not done")
    time: Floats = quantity("s", "time", "time", role="coordinate")
    stations: Floats = quantity(
        "m", "position along the beam from the root", "station", role="coordinate", key="at", note="the last is the tip"
    )
    displacement: Floats = quantity("m", "displacement relative to the base axes", "time station axis")
    q: Floats = quantity(
        lambda self: "" if self.model in BY_STRAINS else "m",
        "generalised coordinates of the beam",
        "time coordinate",
        name="coordinates",
        note="of the exact model and that of fourth order angles and strains",
    )
    qd: Floats = quantity(
        lambda self: "1/s" if self.model in BY_STRAINS else "m/s",
        "rates of the generalised coordinates",
        "time coordinate",
        name="coordinate_rates",
    )
    base: Base = part("motion of the base", "time")
    peaks: Peaks = part("largest values between all steps", key=INSIDE)
    integrator: str = fact("integrator")
    step: float = fact("time step", "s")
    steps: int = fact("number of steps")
    error_estimate: float = fact(
        "total error of the tip's displacement, as a fraction of its largest size",
        note="that of `errors`; NaN where there is no estimate",
    )
    residual_from: float = fact("start of the residual", "s", key=None, note="NaN where not given")
    qdd: Floats = internal("", "accelerations of the coordinates", "time coordinate", empty=True)
    frequencies: Floats = internal("rad/s", "natural frequencies at rest", "mode", note="ascending", empty=True)
    loads: Loads | None = part("internal loads at the root and the stations", key=None, default=None)
    hub: HubResult | None = part("motion of a hub", optional=True, default=None)
    axes: AxesResult | None = part("motion of a centrifuge", key=INSIDE, optional=True, default=None)
    influence: Influence | None = internal("", "static answer of the beam to acceleration fields", default=None)
    errors: Errors = part(
        "of displacement, loads and stress, with what they are made of", name=None, default_factory=Errors
    )
    damping_ratio: float | tuple[float, ...] = fact(
        "modal damping ratio", note="of the modes of the beam on a base at rest", default=math.nan
    )
    initial: str = fact("how it begins, in words", default="")
    outline: Outline | None = part(
        "the beam's shape at some of the times, and what carries it",
        key=None,
        note="None where there is no beam",
        default=None,
    )
    bodies: Floats = internal(
        "m", "centres of mass of the bodies on the undeformed beam, from the root", "body axis", empty=True
    )
    whole: tuple[float, float] | None = quantity(
        "s",
        "time of the whole flight",
        "ends",
        optional=True,
        note="of which this is a part; None where it is all of it",
        default=None,
    )
    points: tuple[str, ...] = quantity(
        "",
        "name of the station",
        "station",
        name="station_name",
        key="name",
        optional=True,
        note="tip, that of a point of the beam, or its position",
        default=(),
    )
    point_acceleration: Floats | None = quantity(
        "m/s^2",
        "absolute acceleration of the stations",
        "time station axis",
        note="specific force where gravity acts; None of a beam, whose loads have it",
        default=None,
    )
    kept_every: int = internal("", "how many samples of the histories make one in a file", default=1)
    felt_at_steps: tuple[Floats, Floats] | None = internal(
        "", "times (t,) s of all steps of the flight, and accelerations (t, s, 3) m/s² of the stations there; None "
        "where these are the samples", default=None,
    )  # fmt: skip
    envelope: Floats = internal(
        "m",
        "corners of the convex hull of a solid, rigid or curved specimen, undeformed, from the root",
        "corner axis",
        empty=True,
    )
    solid: SolidStress | None = part("stress of a solid", name="solid_", key="solid", optional=True, default=None)
    surface: Surface | None = part("surface of a solid, for pictures", name="surface_", key=None, default=None)
    specimen: SpecimenLoads | None = part(
        "loads of a rigid specimen", name="specimen_", key="specimen", optional=True, default=None
    )
    readings: Readings | None = part("of accelerometers", name="sensor_", key="sensors", optional=True, default=None)
    scale: float | None = fact("level factor of the flight's loads; None of 1", optional=True, default=None)
    shapes: Mapping[str, int] | None = fact(
        "numbers of shapes of a beam's model, by strain", optional=True, note="None of other bodies", default=None
    )

    @declared("s", "time of the part of the flight", "ends", name=None, key="span", optional=True)
    def part_span(self) -> tuple[float, float] | None:
        """First and last time of the part of a flight, s; None where it is all of it."""
        return None if self.whole is None else self.flight_span

    @declared("", "samples of the histories, and those in files", role="fact", name=None)
    def histories(self) -> dict[str, int]:
        return {"samples": len(self.time), "written": len(self.time[:: self.kept_every])}

    @declared(
        "m", "largest displacement of every named point", "point", role="rows", name=None, key="points", optional=True
    )
    def point_peaks(self) -> Mapping[str, VectorPeaks]:
        peaks = self.peaks.displacement
        if peaks is None:
            return {}
        named = [(k, name) for k, name in enumerate(self.points) if name.isidentifier() and name != "tip"]
        return {name: peaks[k] for k, name in named}

    def at(self, point: str) -> Floats:
        """Return the displacement of a named point relative to the base axes, (t, 3) m.

        Parameters
        ----------
        point : str
            tip, or the name of another point of the beam.

        Raises
        ------
        InputError
            If there is no such point.
        """
        return self.displacement[:, index_of("point", point, self.points)]

    @property
    def accelerations(self) -> Floats | None:
        """Absolute accelerations of the stations, (t, s, 3) m/s²; None where the run has none."""
        if self.point_acceleration is not None or self.loads is None:
            return self.point_acceleration
        return self.loads.acceleration[:, 1:]

    def reading_at(self, point: str, sensor: Sensor | None = None) -> Floats:
        """Return what an accelerometer at a named point reads, (t, 3) m/s².

        Parameters
        ----------
        point : str
            tip, or the name of another point.
        sensor : Sensor, optional
            Its axes, which do not turn with the deformation, frequency and sensitivity; the absolute acceleration along
            the base axes (specific force where gravity acts) without one.

        Raises
        ------
        InputError
            If there is no such point, the run has no accelerations, or its samples do not resolve the sensor.
        """
        station, accelerations = index_of("point", point, self.points), self.accelerations
        if accelerations is None:
            raise InputError("response", "has no accelerations", "leave loads = true in its settings")
        felt = accelerations[:, station]
        return felt if sensor is None else sensor.reads(felt, float(self.time[1] - self.time[0]))

    @typed
    def signal(self, name: str) -> Floats:
        """Return a component over time by its name, (t,) SI.

        Parameters
        ----------
        name : str
            ``tip.x`` or that of another named point, of its displacement relative to the base axes;
            ``root_force.x``, ``root_moment.x``, NaN where the run has no loads; ``hub.angle``, ``hub.rate``.

        Raises
        ------
        InputError
            If there is no such signal.
        """
        owner, _, component = name.rpartition(".")
        if self.hub is not None and name in ("hub.angle", "hub.rate"):
            return np.asarray(getattr(self.hub, component))
        axis = index_of("name", component, ("x", "y", "z"))
        if owner not in ("root_force", "root_moment"):
            return self.at(owner)[:, axis]
        return np.full(len(self.time), np.nan) if self.loads is None else getattr(self.loads, owner)[:, axis]

    def strain_at(self, point: str, along: Numbers = (1.0, 0.0, 0.0)) -> Floats:
        """Return what a strain gauge at a named point of a solid reads, (t,).

        Parameters
        ----------
        point : str
            A node with a name, or an interface, whose strain is the mean of its nodes'.
        along : (3,)
            Direction of its grid, in axes of the point.

        Raises
        ------
        InputError
            If it is no solid with loads, or has no such point.
        """
        if self.solid is None:
            raise InputError("response", "has no stress of a solid", "simulate a mesh, with loads = true")
        return self.solid.strain_at(point, along)

    @property
    def tip(self) -> Floats:
        """Displacement of the tip relative to the base axes, (t, 3) m."""
        return self.displacement[:, -1]

    @property
    def flight_span(self) -> tuple[float, float]:
        """First and last time of the flight, s: without the spin-up and the spin-down of a machine."""
        first, last = float(self.time[0]), float(self.time[-1])
        return (first, last) if self.axes is None else (max(first, self.axes.span[0]), min(last, self.axes.span[1]))

    @property
    def steps_in_words(self) -> str:
        """Numbers of steps and their lengths: those of the flight, and others of a machine from and to standstill."""
        first, last = self.flight_span
        length, middle = np.diff(self.time), (self.time[1:] + self.time[:-1]) / 2
        between = length[(middle < first) | (middle > last)]  # which every step of these ways is
        if not between.size or math.isclose(between.max(), self.step, rel_tol=1e-6):
            return f"{self.steps} steps of {seconds(self.step)}"
        way = f"{between.size} of {seconds(float(between.max()))} from and to standstill"
        return f"{self.steps - between.size} steps of {seconds(self.step)}, {way}"

    def __repr__(self) -> str:
        if is_traced(self.peaks.max_abs):
            return brief(self)
        name = f" {self.name!r}" if self.name else ""
        axis = int(np.argmax(self.peaks.max_abs))
        unknown = math.isnan(self.error_estimate)
        error = "no error estimate" if unknown else f"estimated error {percent(self.error_estimate)} of the peak"
        moved = [
            f"tip up to {1e3 * self.peaks.max_abs[axis]:.4g} mm along {'xyz'[axis]}, "
            f"at {self.peaks.time_of_max[axis]:.4g} s of {self.time[0]:.4g} to {self.time[-1]:.4g} s",
            f"{self.integrator}, {self.steps_in_words}; {error}",
        ]
        lines = [
            f"Response{name} ({self.environment}, {self.model}): {self.outcome}",
            *filter(None, (self.message, self.initial)),
            *(moved if self.specimen is None else self.specimen.lines),
        ]
        return self._with_warnings(*lines)
