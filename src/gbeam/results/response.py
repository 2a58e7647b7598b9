"""The response of a system over time: what moved, how well it is known, and what the base did meanwhile."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from gbeam.arrays.namespace import is_traced
from gbeam.guards.arguments import typed
from gbeam.guards.checks import index_of
from gbeam.printable import percent
from gbeam.results.accounting import seconds
from gbeam.results.body_response import BodyResponse
from gbeam.results.declared import INSIDE, declared, fact, internal, labels, part, quantity, rows
from gbeam.results.errors import Errors
from gbeam.results.machine import ArmLevel, AxesResult, Driven, Imbalance
from gbeam.results.one_body import MovedBody
from gbeam.results.parts import Base
from gbeam.results.result import Figured, Floats, Part, brief
from gbeam.results.sensors import Readings, Sensor
from gbeam.results.system import (
    EULER,
    SPINS,
    TURNS,
    Assembly,
    Closures,
    Invariants,
    Loop,
    Maxima,
    Placed,
    angular_velocities,
    most_moved,
    rotation_vectors,
)

_OF_POINTS = {kind: kind for kind in ("place", "velocity", "attitude", "acceleration")} | {"spin": "angular_velocity"}


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
    fastest: float = internal("rad/s", "largest size of the rate at all steps", default=0.0)
    level: ArmLevel | None = part(
        "level at the control point, where one is given", name="arm_", optional=True, default=None
    )
    imbalance: Imbalance | None = part(
        "imbalance at that level, about an axis that is upright", name="imbalance_", optional=True, default=None
    )

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
class Response(MovedBody, Placed, Driven, Figured[str]):
    """Response of a system over time, at its named points and coordinates, and of its bodies.

    Of a structure alone in a motion, the system is that structure on the ground, which moves as the motion says, or on
    a hub that turns freely.

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
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> response = gb.simulate(structure, turn, duration=6.0)
    >>> print(f"{1e3 * response.peaks.max_abs[2]:.3f} mm at {response.peaks.time_of_max[2]:.1f} s")
    2.302 mm at 2.5 s
    """

    json_rows: ClassVar[dict[str, str]] = {"point": "points", "coordinate": "coordinates"}

    name: str = fact("name of the motion", note="empty where the ground rests")
    environment: str = fact("flight, centrifuge, hub or arm; ground where it rests")
    outcome: str = fact(
        "how it ended",
        note="done, diverged (the displacement left what the model can mean, or a body lost its stability for so long "
        "that whatever deviates grows a thousandfold), not converged, or law failed: a controller's",
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
    bodies: Mapping[str, BodyResponse] = rows(
        "bodies that deform, and rigid specimens, by name", "body", optional=True, name="", default_factory=dict
    )
    base: Base | None = part("motion of the ground", "time", name="ground_", note="None where it rests", default=None)
    invariants: Invariants | None = part(
        "momentum and energy",
        key="invariants",
        name=INSIDE,
        optional=True,
        note="None on a base that moves",
        default=None,
    )
    loop: Loop | None = part(
        "controllers", key="loop", name=INSIDE, optional=True, note="None without any", default=None
    )
    closures: Closures | None = part(
        "joints that close loops", key="closures", name="closing_", optional=True, note="None without any", default=None
    )
    hub: HubResult | None = part("motion of a hub", optional=True, default=None)
    axes: AxesResult | None = part("motion of a centrifuge", key=INSIDE, optional=True, default=None)
    assembly: Assembly | None = part(
        "how the bodies hang together", key=None, name=INSIDE, note="None where nothing is to be drawn", default=None
    )
    readings: Readings | None = part("of accelerometers", name="sensor_", key="sensors", optional=True, default=None)
    initial: str = fact("how it begins, in words", default="")
    integrator: str = fact("integrator", default="gauss")
    step: float = fact("time step", "s", default=math.nan)
    steps: int = fact("number of steps", default=0)
    error_estimate: float = fact(
        "total error of a body's displacement relative to its root, as a fraction of its largest size",
        note="the largest of all bodies, of places where no body deforms; that of the steps alone where a body cannot "
        "be judged, NaN where there is no estimate",
        default=math.nan,
    )
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
    maxima: Maxima | None = part(
        "largest values between all steps", key=INSIDE, name=INSIDE, optional=True, note="None where a run is traced",
        default=None,
    )  # fmt: skip
    whole: tuple[float, float] | None = quantity(
        "s", "time of the whole flight", "ends", optional=True,
        note="of which this is a part; None where it is all of it", default=None,
    )  # fmt: skip
    scale: float | None = fact("level factor of the flight's loads; None of 1", optional=True, default=None)
    ends: Mapping[str, Floats] = internal(
        "m", "places on the undeformed bodies, by name, at one of which the load is largest", default_factory=dict
    )
    kept_every: int = internal("", "how many samples of the histories make one in a file", default=1)
    felt_at_steps: tuple[Floats, Floats] | None = internal(
        "", "times (t,) s of all steps of the flight, and accelerations (t, p, 3) m/s² of the points there; None "
        "where these are the samples", default=None,
    )  # fmt: skip

    @declared("s", "time of the part of the flight", "ends", name=None, key="span", optional=True)
    def part_span(self) -> tuple[float, float] | None:
        """First and last time of the part of a flight, s, or None where it is all of it."""
        return None if self.whole is None else self.flight_span

    @declared("", "samples of the histories, and those in files", role="fact", name=None)
    def histories(self) -> dict[str, int]:
        return {"samples": len(self.time), "written": len(self.time[:: self.kept_every])}

    @declared("m", "length of the vector of half peak-to-peak from residual_from on", "point", optional=True, name=None)
    def residual_size(self) -> Floats | None:
        """Length of the vector of half peak-to-peak of every point, (p,) m, or None where there is no residual."""
        return None if self.residual_amplitude is None else np.linalg.norm(self.residual_amplitude, axis=-1)

    @declared("", "coordinate at the end", "coordinate", name="last", key="end")
    def last(self) -> Floats:
        return self.q[-1]

    @property
    def largest(self) -> Floats:
        """Largest displacement of every point from its place at the start, (p,) m."""
        if self.maxima is not None:
            return self.maxima.displacement
        return np.linalg.norm(self.place - self.place[0], axis=-1).max(axis=0)

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
        outer = length[(middle < first) | (middle > last)]  # which every step of these ways is
        if not outer.size or math.isclose(outer.max(), self.step, rel_tol=1e-6):
            return f"{self.steps} steps of {seconds(self.step)}"
        way = f"{outer.size} of {seconds(float(outer.max()))} from and to standstill"
        return f"{self.steps - outer.size} steps of {seconds(self.step)}, {way}"

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
        felt = self.acceleration[:, self.point("point", point)]
        return felt if sensor is None else sensor.reads(felt, float(self.time[1] - self.time[0]))

    @typed
    def signal(self, name: str) -> Floats:
        """Return a quantity over time by its name, (t,) SI: an output of :func:`gbeam.linearize`, or of a body.

        Parameters
        ----------
        name : str
            ``joint.angle``, ``joint.angle_rate``, of a ball ``joint.rx`` and ``joint.wx``; ``body.point.place_x``,
            ``velocity_x``, ``attitude_x`` (axes of the ground), ``acceleration_x`` or ``spin_x`` (axes of the point);
            of a body that deforms ``body.point.x``, a displacement relative to its root, ``body.root_force.x`` and
            ``body.root_moment.x``, NaN without loads; ``hub.angle`` and ``hub.rate`` of a hub. The name of the only
            body that deforms may be left out: ``tip.x``.

        Raises
        ------
        InputError
            If there is no such signal.
        """
        if self.hub is not None and name in ("hub.angle", "hub.rate"):
            return np.asarray(getattr(self.hub, name.removeprefix("hub.")))
        alternatives = [f"{body}.{name}" for body in self.bodies] if len(self.bodies) == 1 else []
        for candidate in (name, *alternatives):
            history = self._signal(candidate)
            if history is not None:
                return history
        return self.q[:, index_of("name", name, self.coordinates)]

    def _signal(self, name: str) -> Floats | None:
        """Quantity over time by its whole name, or None if there is none."""
        owner, _, kind = name.rpartition(".")
        of_point, _, axis = kind.rpartition("_")
        if owner in self.points and of_point in _OF_POINTS and axis in tuple("xyz"):
            values = getattr(self, _OF_POINTS[of_point])[:, self.points.index(owner)]
            if of_point == "attitude":
                values = rotation_vectors(values)
            return np.asarray(values[:, "xyz".index(axis)])
        body, _, of_body = owner.partition(".")
        if body in self.bodies and of_body in self.bodies[body].signals and kind in tuple("xyz"):
            return self.bodies[body].signal(f"{of_body}.{kind}")
        if f"{owner}.{EULER[0]}" in self.coordinates and kind in (*TURNS, *SPINS):
            start = self.coordinates.index(f"{owner}.{EULER[0]}")
            e = self.q[:, start : start + 4]  # Euler parameters
            if kind in TURNS:
                return rotation_vectors(e)[:, TURNS.index(kind)]
            return angular_velocities(e, self.qd[:, start : start + 4])[:, SPINS.index(kind)]
        if name.endswith("_rate") and name.removesuffix("_rate") in self.coordinates:
            return self.qd[:, self.coordinates.index(name.removesuffix("_rate"))]
        return self.q[:, self.coordinates.index(name)] if name in self.coordinates else None

    def __repr__(self) -> str:
        if is_traced(self.q):
            return brief(self)
        name = f" {self.name!r}" if self.name else ""
        models = dict.fromkeys(body.model for body in self.bodies.values())
        lines = [f"Response{name} ({', '.join([self.environment, *models])}): {self.outcome}"]
        lines += [words for words in (self.message, self.initial) if words]
        if self.several:
            moved = most_moved(self, self.largest, "up to ")
            lines.append(f"{moved} in {self.time[0]:.4g} to {self.time[-1]:.4g} s")
        for body_name, body in self.bodies.items():
            start = f"{body_name}: " if len(self.bodies) > 1 else ""
            lines += [f"{start}{line}" for line in body.lines(self.time)]
        if math.isnan(self.error_estimate):
            error = "no error estimate"
        else:
            error = f"estimated error {percent(self.error_estimate)} of the peak"
        lines.append(f"{self.integrator}, {self.steps_in_words}; {error}")
        if self.invariants is not None:
            first, last = self.invariants.energy[[0, -1]].sum(axis=1)
            lines.append(f"energy {first:.4g} J at the start, {last:.4g} J at the end")
        return self._with_warnings(*lines)
