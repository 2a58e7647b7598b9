"""Parts of the results about systems: places, coordinates, largest values, invariants and controllers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gbeam.guards.checks import index_of
from gbeam.results.declared import declared, fact, labels, part, quantity
from gbeam.results.parts import VectorPeaks
from gbeam.results.result import Floats, Part

EULER, TURNS, SPINS = ("e0", "e1", "e2", "e3"), ("rx", "ry", "rz"), ("wx", "wy", "wz")  # of balls
ENERGIES = ("kinetic", "elastic", "gravity")


@dataclass(frozen=True, repr=False, eq=False)
class Invariants(Part):
    """Momentum and energy over time: where nothing acts from outside they stay what they were."""

    momentum: Floats = quantity("N s", "momentum", "time axis", frame="ground")
    angular_momentum: Floats = quantity(
        "N m s", "angular momentum about the ground's origin", "time axis", frame="ground"
    )
    energy: Floats = quantity("J", "energy: kinetic, elastic and of gravity", "time form")

    momentum_change: float = fact(
        "largest change of the momentum at any step, over its largest size", note="NaN where a run is traced",
        default=math.nan,
    )  # fmt: skip
    angular_momentum_change: float = fact(
        "largest change of the angular momentum at any step, over its largest size", default=math.nan
    )
    energy_change: float = fact(
        "largest change of the energy at any step, over the largest of its parts", default=math.nan
    )


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
class Closures(Part):
    """Joints that close loops over time: the gap that is left in each, and its loads."""

    json_rows: ClassVar[dict[str, str]] = {"closure": "joints"}

    joints: tuple[str, ...] = labels("name of the joint that closes a loop", "closure")
    gap: Floats = quantity("m", "distance of the joint's end from the point that it closes on", "time closure")
    gap_angle: Floats = quantity("rad", "angle between the joint's end and that point", "time closure")
    force: Floats = quantity(
        "N", "force of the point on the joint", "time closure axis", frame="axes of the point",
        note="NaN along a direction in which other joints hold as well: a rigid mechanism does not determine it",
    )  # fmt: skip
    moment: Floats = quantity(
        "N m", "moment of the point on the joint", "time closure axis", frame="axes of the point",
        note="NaN about such a direction",
    )  # fmt: skip

    @declared("m", "distance of the joint's end from its point, the largest", "closure", key="gap_max", name=None)
    def largest_gap(self) -> Floats:
        """Largest gap of each joint, (c,) m."""
        return self.gap.max(axis=0)

    @declared("rad", "angle between them, the largest", "closure", key="gap_angle_max", name=None)
    def largest_gap_angle(self) -> Floats:
        """Largest angle of each joint's gap, (c,) rad."""
        return self.gap_angle.max(axis=0)


@dataclass(frozen=True, repr=False, eq=False)
class Maxima(Part):
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
    bodies: Mapping[str, Any]
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

    def point(self, where: str, name: str) -> int:
        """Return the number of a named point.

        Parameters
        ----------
        where : str
            Keyword that an error names.
        name : str
            ``body.point``, without the body's name where one alone deforms.

        Raises
        ------
        InputError
            If there is no such point.
        """
        if len(self.bodies) == 1:
            full_name = f"{next(iter(self.bodies))}.{name}"
            if full_name in self.points:
                name = full_name
        return index_of(where, name, self.points)

    @property
    def several(self) -> bool:
        """True if points are on other bodies than one that deforms."""
        return len(self.bodies) != 1 or {point.partition(".")[0] for point in self.points} != {*self.bodies}

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


def joint_histories(result: Placed) -> Mapping[str, tuple[Floats, str, Floats]]:
    """Coordinates of joints by name: history, unit and drive's effort; of a ball its rotation vector, ``joint.rx``."""
    histories: dict[str, tuple[Floats, str, Floats]] = {}
    q, effort = np.atleast_2d(result.q), np.atleast_2d(result.effort)
    for k, name in enumerate(result.coordinates):
        joint, _, tail = name.rpartition(".")
        if tail == EULER[0]:
            turns, efforts = rotation_vectors(q[:, k : k + 4]), effort[:, k + 1 : k + 4]
            for i, axis in enumerate("xyz"):
                histories[f"{joint}.r{axis}"] = turns[:, i], "rad", efforts[:, i]
        elif result.units[k]:
            histories[name] = q[:, k], result.units[k], effort[:, k]
    return histories


def most_moved(result: Placed, sizes: Floats, qualifier: str = "") -> str:
    """Words for the point with the largest of `sizes` (p,) m; where none moves, for the largest coordinate."""
    index = int(sizes.argmax())
    coordinates = {name: (history, unit) for name, (history, unit, _) in joint_histories(result).items()}
    if sizes[index] or not coordinates:
        return f"{result.points[index]} moves by {qualifier}{sizes[index]:.4g} m"
    name, (history, unit) = max(coordinates.items(), key=lambda item: np.abs(item[1][0]).max())
    return f"no point moves; {name} reaches {history[np.abs(history).argmax()]:.4g} {unit}"


def rotation_vectors(e: Floats) -> Floats:
    """Rotation vectors (t, 3) rad, of half a turn at most, of Euler parameters (t, 4) of any size."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(e, scalar_first=True).as_rotvec()


def angular_velocities(e: Floats, rate: Floats) -> Floats:
    """Angular velocities (t, 3) rad/s, turned axes, of Euler parameters (t, 4) and their rates."""
    square = (e * e).sum(axis=1, keepdims=True)
    vector = e[:, :1] * rate[:, 1:] - rate[:, :1] * e[:, 1:] - np.cross(e[:, 1:], rate[:, 1:])
    return np.asarray(2 * vector / square)
