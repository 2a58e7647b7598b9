"""The response of a system: a tree of bodies with named points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gbeam.guards.arguments import typed
from gbeam.guards.checks import index_of
from gbeam.printable import percent
from gbeam.results.declared import INSIDE, declared, fact, internal, labels, part, quantity, rows
from gbeam.results.errors import Errors
from gbeam.results.machine import AxesResult, Driven
from gbeam.results.parts import Base, LoadPeaks, Loads, Outline, VectorPeaks
from gbeam.results.response import Readings, Sensor
from gbeam.results.result import Figured, Floats, Part
from gbeam.results.solids import SolidStress, Surface

_EULER, _TURNS, _SPINS = ("e0", "e1", "e2", "e3"), ("rx", "ry", "rz"), ("wx", "wy", "wz")  # of balls
ENERGIES = ("kinetic", "elastic", "gravity")
_OF_POINTS = {each: each for each in ("place", "velocity", "attitude", "acceleration")} | {"spin": "angular_velocity"}


@dataclass(frozen=True, repr=False, eq=False)
class Invariants(Part):
    """Momentum and energy over time: where nothing acts from outside they stay what they were."""

    momentum: Floats = quantity("N s", "momentum", "time axis", frame="ground")
    angular_momentum: Floats = quantity(
        "N m s", "angular momentum about the ground's origin", "time axis", frame="ground"
    )
    energy: Floats = quantity("J", "energy: kinetic, elastic and of gravity", "time form")

    def _drift(self, history: Floats) -> float:
        size = np.abs(history).max(initial=0.0)
        return float(np.abs(history - history[0]).max(initial=0.0) / size) if size > 0 else 0.0

    @declared("", "largest change of the momentum, over its largest size", role="fact")
    def momentum_change(self) -> float:
        return self._drift(self.momentum)

    @declared("", "largest change of the angular momentum, over its largest size", role="fact")
    def angular_momentum_change(self) -> float:
        return self._drift(self.angular_momentum)

    @declared("", "largest change of the energy, over the largest of its parts", role="fact")
    def energy_change(self) -> float:
        total, size = self.energy.sum(axis=1), np.abs(self.energy).max(initial=0.0)
        return float(np.abs(total - total[0]).max(initial=0.0) / size) if size > 0 else 0.0


@dataclass(frozen=True, repr=False, eq=False)
class Loop(Part):
    """Controllers over time: what they sampled, asked for and applied, each held until the next."""

    json_rows: ClassVar[dict[str, str]] = {"drive": "drives"}

    measurements: tuple[str, ...] = labels("name of the measurement", "measurement", key="/measurements")
    units: tuple[str, ...] = quantity(
        "", "SI unit of the measurement", "measurement", name="measurement_unit", key=None
    )
    drives: tuple[str, ...] = labels("name of the drive", "drive", key="name")
    drive_units: tuple[str, ...] = quantity("", "SI unit of the drive", "drive", name="drive_unit", key="unit")
    measured: Floats = quantity("", "measurement, held from its sample", "time measurement", note="SI")
    asked: Floats = quantity("", "effort that the law asks for, held from its sample", "time drive")
    applied: Floats = quantity("", "effort that acts, limited and delayed", "time drive")
    saturated: Floats = quantity("", "share of the samples that were limited", "drive")
    measured_max: Floats = quantity(
        "", "size of the measurement, the largest of all samples", "measurement", key="/measured_max"
    )
    asked_max: Floats = quantity("", "size of the effort that the law asks for, the largest of all samples", "drive")
    applied_max: Floats = quantity("", "size of the effort that acts, the largest of all samples", "drive")


@dataclass(frozen=True, repr=False, eq=False)
class BeamResponse(Part):
    """One beam of a system over time: what its sections carry, in axes of its root, and the largest of it."""

    loads: Loads = part("internal loads at the root and the stations", key=None, name=INSIDE)
    peaks: LoadPeaks | None = part(
        "largest values between all steps", key=INSIDE, name=INSIDE, note="None where a run is traced"
    )
    outline: Outline | None = part(
        "its shape at some of the times, axes of its root", key=None, name=INSIDE, default=None
    )
    points: tuple[str, ...] = internal(
        "", "name of the station, or its position", "station", note="the sections after the root", default=()
    )


@dataclass(frozen=True, repr=False, eq=False)
class SystemPeaks(Part):
    """Largest values of a system's points, coordinates and ground at all steps and between them.

    Near the largest steps a history is the polynomial of sixth degree through seven of them.
    """

    json_rows: ClassVar[dict[str, str]] = {"point": "points", "coordinate": "coordinates"}

    points: tuple[str, ...] = labels("name of the point", "point")
    coordinates: tuple[str, ...] = labels("name of the coordinate", "coordinate")
    displacement: Floats = quantity(
        "m", "displacement of the point from its place at the start, the largest", "point",
        name="displacement_max", key="displacement_max",
    )  # fmt: skip
    displacement_time: Floats = quantity(
        "s", "time of that", "point", name="displacement_time_of_max", key="displacement_time_of_max"
    )
    velocity: Floats = quantity("m/s", "speed, the largest", "point", name="velocity_max", key="velocity_max")
    velocity_time: Floats = quantity(
        "s", "time of that", "point", name="velocity_time_of_max", key="velocity_time_of_max"
    )
    acceleration: Floats = quantity(
        "m/s^2", "acceleration, the largest", "point", name="acceleration_max", key="acceleration_max"
    )
    acceleration_time: Floats = quantity(
        "s", "time of that", "point", name="acceleration_time_of_max", key="acceleration_time_of_max"
    )
    lowest: Floats = quantity("", "coordinate, the lowest", "coordinate", name="lowest", key="min")
    lowest_time: Floats = quantity("s", "time of that", "coordinate", name="lowest_time", key="time_of_min")
    highest: Floats = quantity("", "coordinate, the highest", "coordinate", name="highest", key="max")
    highest_time: Floats = quantity("s", "time of that", "coordinate", name="highest_time", key="time_of_max")
    rate: Floats = quantity(
        "", "size of the coordinate's rate, the largest", "coordinate", name="rate_max", key="rate_max"
    )
    rate_time: Floats = quantity("s", "time of that", "coordinate", name="rate_time_of_max", key="rate_time_of_max")
    effort: Floats = quantity("", "size of the effort, the largest", "coordinate", name="effort_max", key="effort_max")
    effort_time: Floats = quantity(
        "s", "time of that", "coordinate", name="effort_time_of_max", key="effort_time_of_max"
    )
    ground_force: VectorPeaks = part("largest force on the ground", unit="N", name="ground_force_max_")
    ground_moment: VectorPeaks = part(
        "largest moment on the ground about its origin", unit="N m", name="ground_moment_max_"
    )


@dataclass(frozen=True, repr=False, eq=False)
class Assembly(Part):
    """Parents of bodies, and the size of rigid ones, for pictures."""

    bodies: tuple[str, ...] = labels("name of the body", "body")
    hangs_on: tuple[str, ...] = quantity("", "point that the body hangs on", "body", note="ground, or body.point")
    joint: tuple[str, ...] = quantity("", "kind of the joint that holds it", "body", name="joint_kind")
    place_at_rest: Floats = quantity(
        "m", "place of that point, its body undeformed", "body axis", frame="axes of its body's root"
    )
    undeformed: Floats = quantity(
        "m", "place of the point, joints at the start and bodies undeformed", "point axis", frame="ground"
    )
    box: Floats = quantity(
        "m", "extents of an even box of the same mass and inertia", "body axis", note="NaN of flexible bodies",
        frame="principal axes",
    )  # fmt: skip
    box_centre: Floats = quantity("m", "centre of that box from the root", "body axis", frame="axes of the root")
    box_rotation: Floats = quantity("", "rotation from principal axes to axes of the root", "body row axis")


class Placed:
    """Places of points and coordinates, at one time or over time."""

    points: tuple[str, ...]
    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    place: Floats
    q: Floats
    effort: Floats

    def at(self, point: str) -> Floats:
        """Return the place of a named point in axes of the ground, (3,) m, or over time (t, 3).

        Parameters
        ----------
        point : str
            ``body.point``; a body's root is its point ``root``.

        Raises
        ------
        InputError
            If there is no such point.
        """
        return self.place[..., index_of("point", point, self.points), :]

    def coordinate(self, name: str) -> Any:
        """Return a coordinate, m or rad, or over time (t,): ``joint.angle``.

        Parameters
        ----------
        name : str
            ``joint.coordinate``, or ``body.q1`` and so on of a flexible body.

        Raises
        ------
        InputError
            If there is no such coordinate.
        """
        return self.q[..., index_of("name", name, self.coordinates)]


@dataclass(frozen=True, repr=False, eq=False)
class SystemResponse(Placed, Driven, Figured[str]):
    """Response of a system over time, at its named points and coordinates.

    Examples
    --------
    >>> rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
    >>> hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], initial=0.1)
    >>> pendulum = gb.System({"rod": rod}, {"hinge": hinge}, gravity=(0, 0, -9.81))
    >>> response = gb.simulate(pendulum, duration=2.0)
    >>> response.outcome, response.points
    ('done', ('rod.end', 'rod.root'))
    >>> response.at("rod.end").shape[1:]
    (3,)
    """

    json_rows: ClassVar[dict[str, str]] = {"point": "points", "coordinate": "coordinates"}

    name: str = fact("name of the motion of the ground", note="empty where it rests")
    environment: str = fact("kind of the motion of the ground", note="ground where it rests")
    outcome: str = fact(
        "how it ended", note="done, diverged, not converged, or law failed: a controller's, where the response ends"
    )
    message: str = fact("what happened and what to try, where the outcome is not done")
    time: Floats = quantity("s", "time", "time", role="coordinate")
    points: tuple[str, ...] = labels("name of the point", "point")
    coordinates: tuple[str, ...] = labels("name of the coordinate", "coordinate")
    units: tuple[str, ...] = quantity(
        "", "SI unit of the coordinate", "coordinate", name="coordinate_unit", key="unit",
        note="empty of Euler parameters and of a flexible body's own",
    )  # fmt: skip
    place: Floats = quantity("m", "place of the point", "time point axis", frame="ground")
    velocity: Floats = quantity("m/s", "velocity of the point", "time point axis", frame="ground")
    acceleration: Floats = quantity(
        "m/s^2",
        "acceleration of the point; specific force where gravity acts",
        "time point axis",
        frame="axes of the point",
    )
    attitude: Floats = quantity("", "Euler parameters of the point's axes in those of the ground", "time point euler")
    angular_velocity: Floats = quantity(
        "rad/s", "angular velocity of the point", "time point axis", frame="axes of the point"
    )
    q: Floats = quantity("", "coordinates: m and rad of joints, their own of flexible bodies", "time coordinate")
    qd: Floats = quantity("", "rates of the coordinates", "time coordinate", name="rates")
    effort: Floats = quantity(
        "",
        "force N or torque N m of the drive on each coordinate",
        "time coordinate",
        note="of prescribed coordinates what the motion needs; e1, e2 and e3 have torques in axes of the body",
    )
    ground_force: Floats = quantity("N", "force on the ground", "time axis", frame="ground")
    ground_moment: Floats = quantity("N m", "moment on the ground about its origin", "time axis", frame="ground")
    invariants: Invariants | None = part(
        "momentum and energy", key="invariants", name=INSIDE, note="None on a base that moves", default=None
    )
    loop: Loop | None = part("controllers", key="loop", name=INSIDE, note="None without any", default=None)
    base: Base | None = part("motion of the ground", "time", name="ground_", note="None where it rests", default=None)
    axes: AxesResult | None = part("motion of a centrifuge", key=INSIDE, optional=True, default=None)
    assembly: Assembly | None = part(
        "how the bodies hang together", key=None, name=INSIDE, note="None where nothing is to be drawn", default=None
    )
    beams: Mapping[str, BeamResponse] = rows(
        "beams, by the name of the body", "body", optional=True, name="", default_factory=dict
    )
    solids: Mapping[str, SolidStress] = rows(
        "stress of meshes, by the name of the body", "body", optional=True, name="", default_factory=dict
    )
    surfaces: Mapping[str, Surface] = rows(
        "surfaces of meshes for pictures, by the name of the body", "body", optional=True, name="surface_", key=None,
        default_factory=dict,
    )  # fmt: skip
    readings: Readings | None = part("of accelerometers", name="sensor_", key="sensors", optional=True, default=None)
    initial: str = fact("how it begins, in words", default="")
    integrator: str = fact("integrator", default="gauss")
    step: float = fact("time step", "s", default=math.nan)
    steps: int = fact("number of steps", default=0)
    errors: Errors = part(
        "of deflections, places, root loads and stress, as fractions of the largest", name="error_",
        default_factory=Errors,
    )  # fmt: skip
    residual_from: float = fact(
        "start of the residual", "s", optional=True, note="NaN where not given", default=math.nan
    )
    residual_amplitude: Floats | None = quantity(
        "m", "half peak-to-peak after residual_from, of a flexible body's points relative to its root, else of places",
        "point axis", frame="axes of the body's root, else of the ground", optional=True, default=None,
    )  # fmt: skip
    kept_every: int = internal("", "how many samples of the histories make one in a file", default=1)
    peaks: SystemPeaks | None = part(
        "largest values between all steps", key=INSIDE, name=INSIDE, optional=True, note="None where a run is traced",
        default=None,
    )  # fmt: skip
    scale: float | None = fact("level factor of the flight's loads; None of 1", optional=True, default=None)

    @declared("m", "length of the vector of half peak-to-peak from residual_from on", "point", optional=True, name=None)
    def residual_size(self) -> Floats | None:
        """Length of the vector of half peak-to-peak of every point, (p,) m; None where there is no residual."""
        return None if self.residual_amplitude is None else np.linalg.norm(self.residual_amplitude, axis=-1)

    @declared(
        "", "estimated error in all of a body's displacement relative to its root, as a fraction of its largest, the "
        "largest of all bodies; of places where no body deforms", role="fact",
    )  # fmt: skip
    def error_estimate(self) -> float:
        """Estimated error in all of deflections, or of places where no body deforms; that of the steps alone where no
        more is known, NaN where there is none.
        """
        total, step = self.errors.displacement.total, self.errors.displacement.step
        return step if math.isnan(total) else total

    @property
    def largest(self) -> Floats:
        """Largest displacement of every point from its place at the start, (p,) m."""
        if self.peaks is not None:
            return self.peaks.displacement
        return np.linalg.norm(self.place - self.place[0], axis=-1).max(axis=0)

    @property
    def largest_acceleration(self) -> Floats:
        """Largest acceleration of every point, (p,) m/s²."""
        if self.peaks is not None:
            return self.peaks.acceleration
        return np.linalg.norm(self.acceleration, axis=-1).max(axis=0)

    @declared("", "coordinate at the end", "coordinate", name="last", key="end")
    def last(self) -> Floats:
        return self.q[-1]

    def reading_at(self, point: str, sensor: Sensor | None = None) -> Floats:
        """Return what an accelerometer at a point reads, (t, 3) m/s².

        Parameters
        ----------
        point : str
            ``body.point``.
        sensor : Sensor, optional
            Its axes in those of the point, with which they turn, frequency and sensitivity; the acceleration along
            the axes of the point (specific force where gravity acts) without one.

        Raises
        ------
        InputError
            If there is no such point, or the samples do not resolve the sensor.
        """
        felt = self.acceleration[:, index_of("point", point, self.points)]
        return felt if sensor is None else sensor.reads(felt, float(self.time[1] - self.time[0]))

    @typed
    def signal(self, name: str) -> Floats:
        """Return what a sensor would read, by the name of an output of :func:`gbeam.linearize`, (t,) SI.

        Parameters
        ----------
        name : str
            ``joint.angle``, ``joint.angle_rate``, of a ball ``joint.rx`` and ``joint.wx``; ``body.point.place_x``,
            ``velocity_x``, ``attitude_x`` (axes of the ground), ``acceleration_x`` or ``spin_x`` (axes of the point);
            of a beam ``body.root_force.x``, ``root_moment.x``.

        Raises
        ------
        InputError
            If there is no such signal.
        """
        owner, _, kind = name.rpartition(".")
        quantity, _, axis = kind.rpartition("_")
        if owner in self.points and quantity in _OF_POINTS and axis in tuple("xyz"):
            k = "xyz".index(axis)
            values = getattr(self, _OF_POINTS[quantity])[:, self.points.index(owner)]
            return np.asarray((_turned(values) if quantity == "attitude" else values)[:, k])
        body, _, load = owner.rpartition(".")
        if body in self.beams and load in ("root_force", "root_moment") and kind in tuple("xyz"):
            return np.asarray(getattr(self.beams[body].loads, load)[:, "xyz".index(kind)])
        if f"{owner}.{_EULER[0]}" in self.coordinates and kind in (*_TURNS, *_SPINS):
            start = self.coordinates.index(f"{owner}.{_EULER[0]}")
            e, rate = (each[:, start : start + 4] for each in (self.q, self.qd))
            return _turned(e)[:, _TURNS.index(kind)] if kind in _TURNS else _spun(e, rate)[:, _SPINS.index(kind)]
        if name.endswith("_rate") and name.removesuffix("_rate") in self.coordinates:
            return self.qd[:, self.coordinates.index(name.removesuffix("_rate"))]
        return self.q[:, index_of("name", name, self.coordinates)]

    def __repr__(self) -> str:
        of = f" {self.name!r}" if self.name else ""
        unknown = math.isnan(self.error_estimate)
        error = "no error estimate" if unknown else f"estimated error {percent(self.error_estimate)}"
        lines = [
            f"SystemResponse{of} ({self.environment}): {self.outcome}",
            *filter(None, (self.message, self.initial)),
            f"{most_moved(self, self.largest, 'up to ')} in {self.time[0]:.4g} to {self.time[-1]:.4g} s",
            f"{self.integrator}, {self.steps} steps of {1e3 * self.step:.4g} ms; {error}",
        ]
        if self.invariants is not None:
            first, last = self.invariants.energy[[0, -1]].sum(axis=1)
            lines.append(f"energy {first:.4g} J at the start, {last:.4g} J at the end")
        return self._with_warnings(*lines)


def named(result: Placed) -> Mapping[str, tuple[Floats, str, Floats]]:
    """Coordinates of joints by name: history, unit and drive's effort; of a ball its rotation vector, ``joint.rx``."""
    histories: dict[str, tuple[Floats, str, Floats]] = {}
    q, effort = np.atleast_2d(result.q), np.atleast_2d(result.effort)
    for k, name in enumerate(result.coordinates):
        joint, _, tail = name.rpartition(".")
        if tail == _EULER[0]:
            turns, efforts = _turned(q[:, k : k + 4]), effort[:, k + 1 : k + 4]
            for i, axis in enumerate("xyz"):
                histories[f"{joint}.r{axis}"] = turns[:, i], "rad", efforts[:, i]
        elif result.units[k]:
            histories[name] = q[:, k], result.units[k], effort[:, k]
    return histories


def most_moved(result: Placed, sizes: Floats, up: str = "") -> str:
    """Words for the point with the largest of `sizes` (p,) m; where none moves, for the largest coordinate."""
    most = int(sizes.argmax())
    coordinates = {name: (history, unit) for name, (history, unit, _) in named(result).items()}
    if sizes[most] or not coordinates:
        return f"{result.points[most]} moves by {up}{sizes[most]:.4g} m"
    name, (history, unit) = max(coordinates.items(), key=lambda each: np.abs(each[1][0]).max())
    return f"no point moves; {name} reaches {history[np.abs(history).argmax()]:.4g} {unit}"


def _turned(e: Floats) -> Floats:
    """Rotation vectors (t, 3) rad, of half a turn at most, of Euler parameters (t, 4) of any size."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(e, scalar_first=True).as_rotvec()


def _spun(e: Floats, rate: Floats) -> Floats:
    """Angular velocities (t, 3) rad/s, turned axes, of Euler parameters (t, 4) and their rates."""
    square = (e * e).sum(axis=1, keepdims=True)
    along = e[:, :1] * rate[:, 1:] - rate[:, :1] * e[:, 1:] - np.cross(e[:, 1:], rate[:, 1:])
    return np.asarray(2 * along / square)
