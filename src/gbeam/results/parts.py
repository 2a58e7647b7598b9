"""Parts of a response: the outline for pictures, peaks, and what the sections carry; frozen records of arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gbeam.arrays.tree import record
from gbeam.results.declared import BESIDE, INSIDE, declared, fact, internal, part, quantity
from gbeam.results.result import Floats, Part

_SECTION_AXES = "S: axes of the deformed section"
_BASE_AXES = "B: axes of the root"
HELD = 0.1  # of the largest displacement of a body's points: a tip that moves by less beside supports is held
UNSTRESSED = 1e-12  # of the strength: a smaller stress is rounding


@record
class Base(Part):
    """Motion of the base axes B at one time or many, (..., 3): x along the beam, z through its thickness."""

    a_WO_B: Floats = quantity(
        "m/s^2", "acceleration of the root; specific force where gravity acts", "axis", name="root_acceleration",
        key="acceleration",
    )  # fmt: skip
    w_WB_B: Floats = quantity(
        "rad/s", "angular velocity of the base", "axis", name="angular_velocity", key="angular_velocity"
    )
    alpha_WB_B: Floats = quantity(
        "rad/s^2", "angular acceleration of the base", "axis", name="angular_acceleration", key="angular_acceleration"
    )
    __repr__ = Part.__repr__


@dataclass(frozen=True, repr=False, eq=False)
class Outline(Part):
    """The beam's axis from root to tip over time, its size, and that of the machine or hub that carries it.

    The attitude at the first time, heading too, is not known.
    """

    points: Floats = quantity(
        "m",
        "position of the point along the beam from the root",
        "point",
        role="coordinate",
        note="the first 0, the last the tip",
    )
    width: Floats = quantity("m", "extent of the section along y", "point", name="outline_width")
    thickness: Floats = quantity("m", "extent of the section along z", "point", name="outline_thickness")
    round: bool = quantity("", "whether the section is round", name="outline_round")
    bodies: Floats = quantity("", "position, m, and mass, kg, of each body", "body of", name=None)
    time: Floats = quantity("s", "some of the times", "outline_time", role="coordinate")
    displacement: Floats = quantity("m", "displacement of the beam's axis", "outline_time point axis", name="outline")
    place: Floats | None = quantity(
        "m",
        "place of the point at rest, base axes",
        "point axis",
        name="outline_place",
        note="None of a straight beam",
        default=None,
    )
    across: Floats | None = quantity(
        "", "direction of the section's width at rest", "point axis", name="outline_across", default=None
    )
    radius: float = quantity("m", "from the hub's axis to the root", name="hub_radius", optional=True, default=math.nan)
    arm_root: Floats | None = quantity(
        "m", "place of the root on an arm, hub axes", "hub_axis", note="None without an arm", default=None
    )
    R_HB: Floats = quantity(
        "", "rotation from base axes to hub axes", "hub_axis axis", name=None, default_factory=lambda: np.eye(3)
    )
    attitude: Floats | None = quantity(
        "",
        "rotation (w, x, y, z) of the base axes since the first time, by the angular velocity given",
        "outline_time quaternion",
        note="None without rates",
        default=None,
    )

    @declared("m", "position of the body from the root", "body")
    def body_position(self) -> Floats:
        return self.bodies[:, 0]

    @declared("kg", "mass of the body", "body")
    def body_mass(self) -> Floats:
        return self.bodies[:, 1]

    @declared("", "rotation from base axes (columns) to hub axes (rows)", "hub_axis axis")
    def hub_mounting(self) -> Floats | None:
        """Rotation from base to hub axes, (3, 3), or None without a hub."""
        return self.R_HB if np.isfinite(self.radius) else None


@dataclass(frozen=True, repr=False, eq=False)
class Supports(Part):
    """Places at which a body is held, for pictures: their names, what they hold, and how they move over time."""

    name: tuple[str, ...] = quantity("", "name of the place that is held, or its position along a beam", "holder")
    position: Floats = quantity("m", "position of the place along the body, from the root", "holder")
    place: Floats = quantity(
        "m", "the place at rest, base axes", "holder axis", note="the middle of the nodes that are held"
    )
    extents: Floats = quantity("m", "extents of a beam's section there", "holder axis", note="0 of other bodies")
    words: tuple[str, ...] = quantity("", "directions that are held, and by what", "holder")
    rigid: tuple[str, ...] = quantity("", "directions that are held rigidly", "holder")
    yielding: tuple[str, ...] = quantity("", "directions that springs and dampers hold", "holder")
    time: Floats = quantity("s", "some of the times", "holder_time", role="coordinate")
    displacement: Floats = quantity("m", "displacement of the place", "holder_time holder axis")

    def positions(self, direction: str = "") -> Floats:
        """Positions, m, ascending, of all supports, or of those that hold a direction."""
        ways = [f"{rigid} {yielding}".split() for rigid, yielding in zip(self.rigid, self.yielding, strict=True)]
        return np.sort(self.position[[not direction or direction in held for held in ways]])


@dataclass(frozen=True, repr=False, eq=False)
class Extremes(Part):
    """Extreme values of histories and their times."""

    value: Floats = quantity(BESIDE, "largest size, between steps", name=".", key="max_abs")
    time: Floats = quantity("s", "time of that", name="time", key="time_of_max")


@dataclass(frozen=True, repr=False, eq=False)
class VectorPeaks(Part):
    """Largest sizes of histories of vectors."""

    json_rows: ClassVar[dict[str, str]] = {"axis": ""}

    components: Extremes = part("of each component", "axis", name=None, key=INSIDE)
    size: Extremes = part("of the vector")

    def __getitem__(self, place: int | slice) -> VectorPeaks:
        """The peaks at one place, or at some."""
        components, size = self.components, self.size
        return VectorPeaks(
            Extremes(components.value[place], components.time[place]), Extremes(size.value[place], size.time[place])
        )


@dataclass(frozen=True, repr=False, eq=False)
class Highest(Part):
    """Largest value along the beam."""

    value: float = quantity(BESIDE, "largest value", key="max")
    time: float = quantity("s", "its time", key="time_of_max")
    station: float = quantity("m", "its place, from the root")


@dataclass(frozen=True, repr=False, eq=False)
class Lowest(Part):
    """Smallest value along the beam."""

    value: float = quantity(BESIDE, "smallest value", key="min")
    time: float = quantity("s", "its time", key="time_of_min")
    station: float = quantity("m", "its place, from the root")


@dataclass(frozen=True, repr=False, eq=False)
class StressPeak(Highest):
    """Largest size of the normal stress along the beam, and its extremes."""

    tension: Highest = part("largest normal stress", unit="Pa")
    compression: Lowest = part("smallest normal stress", unit="Pa")


@dataclass(frozen=True, repr=False, eq=False)
class LoadPeaks(Part):
    """Peaks of what the sections of the beam carry, at the root (first) and the stations.

    At the root the sizes of force and moment are those of the base's force and moment on the beam.
    """

    json_rows: ClassVar[dict[str, str]] = {"section": "sections", "support": "supports"}

    force: VectorPeaks = part(
        "N, V_y, V_z, axes of the sections", "section", unit="N", name="section_force_max_", key="force"
    )
    moment: VectorPeaks = part(
        "torque, M_y, M_z, axes of the sections", "section", unit="N m", name="section_moment_max_", key="moment"
    )
    tension: Extremes = part(
        "largest normal stress over the section", "section", unit="Pa", name="stress_tension_max_", key=None,
        note="NaN where fibres are unknown",
    )  # fmt: skip
    compression: Extremes = part(
        "smallest normal stress over the section", "section", unit="Pa", name="stress_compression_min_", key=None
    )
    von_mises: Extremes | None = part(
        "largest von Mises stress over the section", "section", unit="Pa", name="von_mises_max_", key=None,
        optional=True, default=None,
    )  # fmt: skip
    beam_torque: Extremes | None = part(
        "largest size of the torque that the beam takes from a hub", unit="N m", name=None, optional=True, default=None
    )
    supports: Floats | None = quantity(
        "m", "position of the support along x from the root", "support", name=None, key="at", optional=True,
        default=None,
    )  # fmt: skip
    support_names: tuple[str, ...] | None = quantity(
        "", "name of the support", "support", name=None, key="name", note="None of a beam", optional=True,
        default=None,
    )  # fmt: skip
    support_force: VectorPeaks | None = part(
        "of the support on the body, axes of the root", "support", unit="N", name="support_force_max_", key="force",
        optional=True, default=None,
    )  # fmt: skip
    support_moment: VectorPeaks | None = part(
        "of the support on the body about its own place, axes of the root", "support", unit="N m",
        name="support_moment_max_", key="moment", optional=True, default=None,
    )  # fmt: skip
    stations: Floats = quantity(
        "m", "position of the section along the beam from the root", "section", name=None, key="at", empty=True
    )
    yield_strength: float | None = fact("yield strength of the material", "Pa", name=None, optional=True, default=None)

    @declared("N", "largest force that the base gives the root", role="part", name=None)
    def root_force(self) -> VectorPeaks:
        return self.force[0]

    @declared("N m", "largest moment that the base gives the root", role="part", name=None)
    def root_moment(self) -> VectorPeaks:
        return self.moment[0]

    @declared("Pa", "largest normal stress of the section", "section", name=None, key="tension", optional=True)
    def section_tension(self) -> Floats:
        return self.tension.value

    @declared("Pa", "smallest normal stress of the section", "section", name=None, key="compression", optional=True)
    def section_compression(self) -> Floats:
        return self.compression.value

    @declared("", "least margin on yield of the section", "section", name=None, key="margin", optional=True)
    def section_margin(self) -> Floats | None:
        """Least margin on yield of each section, (s,), or None where the strength is not known."""
        return None if self.yield_strength is None else yield_margin(self.yield_strength, self.equivalent.value)

    @declared("Pa", "largest size of the normal stress", role="part", name=None, key="stress", optional=True)
    def largest_stress(self) -> StressPeak | None:
        """Largest size of the normal stress along the beam, or None where fibres are unknown."""
        if not np.isfinite(self.tension.value).all():
            return None
        highest, lowest = self.tension.value.argmax(), self.compression.value.argmin()
        largest = int(self.stress.value.argmax())
        return StressPeak(
            *self._place(self.stress, largest),
            Highest(*self._place(self.tension, int(highest))),
            Lowest(*self._place(self.compression, int(lowest))),
        )

    @declared("1", "least margin on yield", role="part", name=None, key="margin", optional=True)
    def least_margin(self) -> Lowest | None:
        """Least margin on yield, where the stress is largest, or None where the strength or fibres are unknown."""
        margin, equivalent = self.section_margin, self.equivalent
        if margin is None or not np.isfinite(self.tension.value).all():
            return None
        k = int(equivalent.value.argmax())
        return Lowest(float(margin[k]), float(equivalent.time[k]), float(self.stations[k]))

    @property
    def equivalent(self) -> Extremes:
        """Largest von Mises stress over each section, (s,) Pa; of the normal stress where that is not known."""
        return self.stress if self.von_mises is None else self.von_mises

    @declared("Pa", "largest von Mises stress", role="part", name=None, key="von_mises", optional=True)
    def largest_von_mises(self) -> Highest | None:
        """Largest von Mises stress along the beam, or None where it is not known."""
        if self.von_mises is None:
            return None
        return Highest(*self._place(self.von_mises, int(self.von_mises.value.argmax())))

    def _place(self, extremes: Extremes, k: int) -> tuple[float, float, float]:
        """Value, time, s, and station, m, of the section k."""
        return float(extremes.value[k]), float(extremes.time[k]), float(self.stations[k])

    @property
    def stress(self) -> Extremes:
        """Largest size of the normal stress over each section, (s,) Pa."""
        pulled = self.tension.value >= -self.compression.value
        return Extremes(
            np.where(pulled, self.tension.value, -self.compression.value),
            np.where(pulled, self.tension.time, self.compression.time),
        )


@dataclass(frozen=True, repr=False, eq=False)
class Peaks(Part):
    """Largest values of a response between all steps computed, and their times.

    They are of the flight's own times, without a machine's spin-up and spin-down.
    The coordinates between steps are the polynomials of fifth degree that have both ends' values, rates and
    accelerations, and the displacement is that of the model there. Loads and stress have no derivatives: near a peak
    they are the polynomial of sixth degree through seven steps. Where JAX traces a run, its peaks are the tip's
    largest samples.
    """

    json_rows: ClassVar[dict[str, str]] = {"axis": "tip", "station": "stations"}

    max_abs: Floats = quantity("m", "largest displacement of the tip, between steps", "axis", name="tip_max_abs")
    time_of_max: Floats = quantity("s", "time of that displacement", "axis", name="tip_time_of_max")
    residual_amplitude: Floats = quantity(
        "m",
        "half peak-to-peak of the tip from residual_from on",
        "axis",
        name="tip_residual_amplitude",
        note="NaN where there is no such time",
    )
    max_size: float = quantity(
        "m", "largest length of the tip's displacement", name="tip_max_size", key="tip.size.max_abs", default=math.nan
    )
    time_of_max_size: float = quantity(
        "s", "time of that displacement", name="tip_time_of_max_size", key="tip.size.time_of_max", default=math.nan
    )
    displacement: VectorPeaks | None = part(
        "of all stations", "station", unit="m", name=None, key=INSIDE, optional=True, default=None
    )
    loads: LoadPeaks | None = part("of the sections", name=".", optional=True, default=None)

    @declared("m", "largest length of the displacement", "station", key=None)
    def station_max_size(self) -> Floats | None:
        return None if self.displacement is None else self.displacement.size.value

    @declared("s", "time of that displacement", "station", key=None)
    def station_time_of_max_size(self) -> Floats | None:
        return None if self.displacement is None else self.displacement.size.time


def judged_point(sizes: Floats) -> int:
    """Index of the point of a body under supports by which it is judged, from the displacements (p,) of its points.

    It is the tip, the last point, unless supports hold the tip. Then it is the point that moves farthest.
    """
    return int(sizes.argmax()) if sizes[-1] < HELD * sizes.max() else len(sizes) - 1


def yield_margin(yield_strength: float, stress: Floats) -> Floats:
    """Margin on yield, yield strength over the size of the stress less one: negative beyond yield, inf unstressed."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.where(stress < UNSTRESSED * yield_strength, math.inf, yield_strength / stress - 1))


def margin_words(margin: float) -> str:
    """Write a margin on yield, in capitals where it is negative."""
    if margin == math.inf:
        return "no stress to yield by"
    return f"margin on yield {margin:.3g}" if margin >= 0 else f"ABOVE YIELD: margin {margin:.3g}"


@dataclass(frozen=True, repr=False, eq=False)
class Loads(Part):
    """Loads of the sections of the beam, and those that its base must supply.

    The outboard part of the beam acts on the inboard part with `force` and `moment` at the section's deformed
    position: a positive axial force is tension, a positive M_z bends towards +y, a positive M_y towards −z. A body
    fixed to the beam at a station counts as outboard of it. The first of the sections is the root, the last the tip.

    Stresses over the section are N/A ± (|M_y| c_z/I_y + |M_z| c_y/I_z), of a round section N/A ± √(M_y² + M_z²) c/I,
    with the section's extreme fibres c_y and c_z, or NaN where these are unknown. Von Mises' has Saint-Venant's torsion
    and the shear forces' parabola besides, at 37 points of a rectangle and 24 around a circle or a tube; it is NaN of
    sections by properties or matrices, whose shear stress is not known. The margin on yield is by it where it is known.
    """

    stations: Floats = quantity(
        "m", "position of the section along the beam from the root", "section", role="coordinate", key="stations"
    )
    force: Floats = internal("N", "force, base axes", "time section axis")
    moment: Floats = internal("N m", "moment, base axes", "time section axis")
    section_force: Floats = quantity("N", "axial force and shear", "time section axis", frame=_SECTION_AXES, key="")
    section_moment: Floats = quantity(
        "N m", "torque and bending moments", "time section axis", frame=_SECTION_AXES, key=""
    )
    stress_tension: Floats = quantity("Pa", "largest normal stress over the section", "time section", key="")
    stress_compression: Floats = quantity("Pa", "smallest normal stress over the section", "time section", key="")
    acceleration: Floats = internal(
        "m/s^2",
        "acceleration in the world, base axes; specific force with gravity",
        "time section axis",
        note="files have those of the root and of the stations",
    )
    beam_torque: Floats | None = quantity(
        "N m", "torque about the hub's axis that the beam takes", "time", optional=True, default=None, key=""
    )
    drive_torque: Floats | None = quantity(
        "N m",
        "the same with the hub's own inertia: the drive's",
        "time",
        note="None where the inertia is unknown",
        default=None,
    )
    fibre: Floats | None = quantity(
        "Pa",
        "normal stress at the extreme fibre of the section where it ranges most",
        "time section",
        name="fibre_stress",
        note="None where a run is traced",
        default=None,
    )
    von_mises: Floats | None = quantity(
        "Pa",
        "largest von Mises stress over the section",
        "time section",
        optional=True,
        default=None,
        note="NaN of sections by properties or matrices",
        key="",
    )
    supports: Floats | None = quantity(
        "m", "position of the support along x from the root", "support", role="coordinate", key="supports",
        optional=True, default=None,
    )  # fmt: skip
    support_names: tuple[str, ...] | None = quantity(
        "", "name of the support", "support", note="None of a beam", optional=True, default=None, key="support_names"
    )
    support_force: Floats | None = quantity(
        "N", "force of the support on the body", "time support axis", frame=_BASE_AXES, optional=True, default=None,
        key="support_force",
    )  # fmt: skip
    support_moment: Floats | None = quantity(
        "N m", "moment of the support on the body about its own place", "time support axis", frame=_BASE_AXES,
        optional=True, default=None, key="support_moment",
    )  # fmt: skip
    base_force: Floats | None = internal("N", "force of root and supports on the body", "time axis", default=None)
    base_moment: Floats | None = internal(
        "N m", "moment of root and supports on the body about the root", "time axis", default=None
    )
    yield_strength: float | None = fact("yield strength of the material", "Pa", name=None, optional=True, default=None)
    fatigue_exponent: float = internal("", "exponent of the material's Wöhler curve", default=math.nan)

    @declared("Pa", "largest size of the normal stress over the section", "time section", key="")
    def stress(self) -> Floats:
        """Largest size of the normal stress over the section, in tension or compression, (t, s) Pa."""
        # They are N/A ± the bending stress: the larger size without a choice, and with NumPy's or JAX's arrays.
        middle = (self.stress_tension + self.stress_compression) / 2
        return abs(middle) + (self.stress_tension - self.stress_compression) / 2

    @declared("", "yield strength over stress less one", "time section", name="yield_margin", optional=True, key="")
    def margin(self) -> Floats | None:
        """Margin on yield, yield strength over stress less one, (t, s), or None where the strength is not given."""
        if self.yield_strength is None:
            return None
        is_known = self.von_mises is not None and np.isfinite(self.von_mises).all()
        return yield_margin(self.yield_strength, np.asarray(self.von_mises) if is_known else self.stress)

    @declared("N", "force of the base on the beam", "time axis", name=None, key="")
    def root_force(self) -> Floats:
        return -self.force[..., 0, :]

    @declared("N m", "moment of the base on the beam about the root", "time axis", name=None, key="")
    def root_moment(self) -> Floats:
        return -self.moment[..., 0, :]


@dataclass(frozen=True, repr=False, eq=False)
class Influence(Part):
    """Static answer of the beam, straight and at rest, to acceleration fields of its base: e and g·x, base axes.

    Column i is the answer to the field along axis i: a uniform acceleration of 1 m/s² (`*_uniform`), or one that
    grows by 1 m/s² for every metre from the root (`*_linear`).
    """

    tip_uniform: Floats = quantity("s^2", "displacement of the tip along the field", "axis")
    tip_linear: Floats = quantity("m s^2", "displacement of the tip along the field", "axis")
    force_uniform: Floats = quantity("kg", "inertia force at the root along the field: minus the mass", "axis")
    force_linear: Floats = quantity("kg m", "the same: minus the first moment of the mass", "axis")
    moment_uniform: Floats = quantity(
        "kg m", "its moment about the root, in the plane of x and the field: minus the first moment of the mass", "axis"
    )
    moment_linear: Floats = quantity("kg m^2", "the same: minus the second moment of the mass", "axis")
    station: int = internal("", "number of the station that is displaced, the last unless supports hold it", default=-1)
