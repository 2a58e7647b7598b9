"""Description of a case: frozen records of its bodies and joints, its motions, flights' records and settings before any
run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

from gbeam.constants import DEGREE, STANDARD_GRAVITY
from gbeam.results.declared import declared, fact, internal, part, rows
from gbeam.results.declared import quantity as entry  # a record has a field of that name
from gbeam.results.machine import ArmLevel
from gbeam.results.result import Floats, Part

Vector = tuple[float, float, float]


@dataclass(frozen=True, repr=False, eq=False)
class Level(Part):
    """The longest stretch of a record in which the load is near 1 g."""

    start: float = entry("s", "start")
    end: float = entry("s", "end")
    load: Vector = entry("m/s^2", "its mean, base axes", "axis")


@dataclass(frozen=True, repr=False, eq=False)
class BodyRates(Part):
    """Ranges of the body's rates, about base axes."""

    smallest: Vector = entry("rad/s", "smallest rate", "axis")
    largest: Vector = entry("rad/s", "largest rate", "axis")


@dataclass(frozen=True, repr=False, eq=False)
class Curves(Part):
    """Samples of a record, in base axes."""

    samples: int = fact("their number")
    rate: float = fact("sample rate", "Hz")
    smallest: Vector = entry("m/s^2", "smallest load", "axis")
    largest: Vector = entry("m/s^2", "largest load", "axis")
    peak: Vector = entry("m/s^2", "the load where it is largest in size", "axis")
    time_of_peak: float = entry("s", "its time")
    rates: BodyRates | None = part("of the body; None where it is flown without", default=None)


@dataclass(frozen=True, repr=False, eq=False)
class Gap(Part):
    """Samples that a record has lost, and that were put on a straight line."""

    start: float = entry("s", "the sample before them")
    end: float = entry("s", "the sample behind them")
    lost: int = fact("their number")
    after: str = fact("place of the sample before them in the file")


@dataclass(frozen=True, repr=False, eq=False)
class Offset(Part):
    """Readings of a record's sensors in a stretch, at rest or of another known load, less what is known."""

    start: float = entry("s", "first time of the stretch")
    end: float = entry("s", "its last time")
    load: Vector = entry("m/s^2", "offsets of the columns x, y and z, with their signs", "axis")
    rates: Vector | None = entry("rad/s", "offsets of the columns p, q and r", "axis", default=None)


@dataclass(frozen=True, repr=False, eq=False)
class Section(Part):
    """A section of a record's file, which a column numbers or names."""

    value: str = fact("what the column holds through it")
    start: float = entry("s", "its first time")
    end: float = entry("s", "its last time")


@dataclass(frozen=True, repr=False, eq=False)
class Channels(Part):
    """Samples of some channels over time."""

    names: tuple[str, ...] = internal("", "names of the channels")
    units: tuple[str, ...] = internal("", "their units")
    time: Floats = internal("s", "their times")
    values: Floats = internal("", "their values (time, channel)")


@dataclass(frozen=True, repr=False, eq=False)
class RecordSummary(Part):
    """A flight's record, as its file has it and as it is flown."""

    file: str = fact("the file")
    columns: tuple[str, str, str] = entry("", "columns of x, y and z, with their signs", "axis")
    quantity: str = fact("specific-force or acceleration")
    vehicle: str = fact("aircraft, rocket or other")
    span: tuple[float, float] = entry("s", "first and last time of the part that is flown", "ends")
    whole: tuple[float, float] = entry("s", "first and last time of the file, or of the section", "ends")
    read: Curves = part("the part, as the file has it")
    flown: Curves = part("the part, as it is flown: without spikes, filtered, resampled")
    level: Level | None = part(
        "longest stretch near 1 g, of a second or more; None without, or of what is no aircraft's specific force",
        default=None,
    )
    rate_columns: tuple[str, str, str] | None = entry(
        "", "columns of p, q and r, with their signs", "axis", default=None
    )
    gaps: tuple[Gap, ...] = rows("gaps that were bridged", "gap", default=())
    offsets: tuple[Offset, ...] = rows("offsets that were subtracted, found at rest", "offset", default=())
    clock: str = fact("what the clock of the file shows at zero seconds; empty where that is zero", default="")
    sections_by: str = fact("column that says the sections of the file; empty without", default="")
    section: str = fact("section that is flown; empty where the part is given by times", default="")
    sections: tuple[Section, ...] = rows("sections of the file, where a column says them", "section", default=())
    levelled: tuple[float, float] | None = entry(
        "s", "first and last time of the stretch that the instrument was levelled by", "ends", default=None
    )
    done: tuple[str, ...] = fact("what was done to it, as asked", default=())
    notes: tuple[str, ...] = fact("what looks odd", default=())
    as_read: Channels | None = internal("", "the whole file, in its own axes and units", default=None)
    as_flown: Channels | None = internal("", "the part that is flown, in base axes, m/s² and rad/s", default=None)

    @property
    def channels(self) -> dict[str, str]:
        """Columns with their signs, by axis. "0" stands for none."""
        return dict(zip("xyzpqr", (*self.columns, *(self.rate_columns or ())), strict=False))

    @property
    def is_part(self) -> bool:
        """True if the file holds samples that are not flown."""
        assert self.as_read is not None
        return self.span != (float(self.as_read.time.min()), float(self.as_read.time.max()))

    @property
    def words(self) -> str:
        """Sentence on what was done to it, or empty where nothing was."""
        return "; ".join([*self.done, *([self._offset_words] if self.offsets else [])])

    @property
    def _offset_words(self) -> str:
        """Words on the offsets that were subtracted."""
        stretches = ", ".join(f"{stretch.start:.6g} to {stretch.end:.6g} s" for stretch in self.offsets)
        sizes = [f"{axis} {' to '.join(values)} {unit}" for axis, unit, values in self.offsets_of_columns]
        drifting = ", and their drift on straight lines between," if len(self.offsets) > 1 else ""
        return f"offsets at rest ({stretches}){drifting} are subtracted: {', '.join(sizes)}"

    @property
    def offsets_of_columns(self) -> list[tuple[str, str, list[str]]]:
        """Axis, unit, and the offset in each stretch in words, of every column that the file has."""
        by_stretch = [(*stretch.load, *(stretch.rates or ())) for stretch in self.offsets]
        rows = []
        for k, (axis, column) in enumerate(self.channels.items()):
            if column == "0":
                continue
            size, unit = (STANDARD_GRAVITY, "g") if axis in "xyz" else (DEGREE, "deg/s")
            rows.append((axis, unit, [f"{offsets[k] / size:.4g}" for offsets in by_stretch]))
        return rows

    def scaled(self, scale: float) -> RecordSummary:
        """The record, flown with accelerations times a level factor."""
        smallest, largest, peak = (
            (scale * x, scale * y, scale * z) for x, y, z in (self.flown.smallest, self.flown.largest, self.flown.peak)
        )
        rates = "" if self.rate_columns is None else ", rates as they are recorded"
        flown, curves = replace(self.flown, smallest=smallest, largest=largest, peak=peak), self.as_flown
        if curves is not None:
            sizes = [scale if unit == "m/s^2" else 1.0 for unit in curves.units]
            curves = replace(curves, values=curves.values * sizes)
        return replace(self, flown=flown, as_flown=curves, done=(*self.done, f"accelerations × {scale:.6g}{rates}"))


@dataclass(frozen=True, repr=False, eq=False)
class MassOnBeam(Part):
    """A mass on a beam."""

    at: float = entry("m", "position from the root")
    mass: float = entry("kg", "mass")


@dataclass(frozen=True, repr=False, eq=False, kw_only=True)
class BodyDescription(Part):
    """A body, its root held."""

    json_rows: ClassVar[dict[str, str]] = {"mode": "modes"}

    kind: str = fact("rigid, solid, matrices, or the kind of a beam's model")
    mass: float = fact("mass, of a beam with what it carries", "kg")
    centre: Floats = entry("m", "centre of mass from the root, undeformed", "axis", frame="body")
    coordinates: int = fact("number of its own coordinates: none of a rigid body")
    points: tuple[str, ...] = fact("names of its points")
    clamps: Mapping[str, str] = fact("nodes that each group of a mesh's clamp holds, by name", default_factory=dict)
    supports: Mapping[str, str] = fact("what supports hold, by their positions or names", default_factory=dict)
    length: float | None = fact("length of a beam", "m", optional=True, default=None)
    masses: tuple[MassOnBeam, ...] = rows("masses on a beam", "mass", default=())
    counts: Mapping[str, int] = fact(
        "numbers of a beam's shapes: axial, along y and along z, and those of twist and shear that the model has",
        key="shapes",
        default_factory=dict,
    )
    frequency: Floats = entry("Hz", "lowest natural frequencies on a base at rest", "mode", empty=True)
    direction: tuple[str, ...] | None = entry(
        "", "of a beam's frequencies: axial, y, z, twist or shear", "mode", optional=True, default=None
    )

    @property
    def bare_mass(self) -> float:
        """Mass of a beam without what it carries, kg."""
        return self.mass - sum(mass.mass for mass in self.masses)


@dataclass(frozen=True, repr=False, eq=False)
class JointDescription(Part):
    """A joint."""

    kind: str = fact("kind of the joint")
    body: str = fact("name of the body that it holds")
    on: str = fact("what it hangs on: ground, or a point of a body")
    free: tuple[str, ...] = fact("coordinates that move freely")
    driven: tuple[str, ...] = fact("coordinates with a drive")
    prescribed: tuple[str, ...] = fact("coordinates whose rates are prescribed")


@dataclass(frozen=True, repr=False, eq=False)
class ForceDescription(Part):
    """A force and a moment on a point."""

    on: str = fact("the point")
    follower: bool = fact("whether the components turn with the point")


@dataclass(frozen=True, repr=False, eq=False)
class ControllerDescription(Part):
    """A controller in the loop."""

    measure: tuple[str, ...] = fact("what it samples")
    drive: tuple[str, ...] = fact("what it drives")
    sample: float = fact("time between samples", "s")
    delay: float = fact("time from a sample until its efforts act", "s")


@dataclass(frozen=True, repr=False, eq=False)
class Kind(Part):
    """Kind of a motion, and the flight that a centrifuge tracks."""

    kind: str = fact("kind of the motion")
    tracks: str = fact("name of the flight that it tracks", optional=True)
    scale: float | None = fact("level factor of its loads; None of 1", optional=True, default=None)
    level: ArmLevel | None = part("level that a plain arm holds", optional=True, default=None)
    span: tuple[float, float] | None = entry(
        "s", "first and last time of the response in it, where they differ", "ends", optional=True, default=None
    )


@dataclass(frozen=True, repr=False, eq=False, kw_only=True)
class Description(Part):
    """Meaning of a case. Where a value has a distribution, the rest is said of its centre."""

    title: str = fact("title of the scenario")
    mass: float = fact("mass of all bodies", "kg")
    centre: Floats = entry("m", "centre of mass of all bodies at the start, undeformed", "axis", frame="ground")
    bodies: Mapping[str, BodyDescription] = rows("bodies, by name", "body")
    loops: str = fact(
        "free motions that joints leave where they close loops, and loads that they do not determine",
        note="empty without loops",
    )
    joints: Mapping[str, JointDescription] = rows(
        "joints, by name, but those that hold a body's root on the ground as it is", "joint", default_factory=dict
    )
    forces: Mapping[str, ForceDescription] = rows("forces on points, by name", "force", default_factory=dict)
    controllers: Mapping[str, ControllerDescription] = rows(
        "controllers in the loop, by name", "controller", default_factory=dict
    )
    gravity: Floats | None = entry("m/s^2", "acceleration of free fall", "axis", frame="ground", default=None)
    motions: Mapping[str, str] = fact("kind of each motion, by name", key=None)
    start: float | None = fact(
        "start of the response; None where none is asked for", "s", key="response.start", optional=True, default=None
    )
    duration: float | None = fact("duration of the response", "s", key="response.duration", optional=True, default=None)
    step: float | None = fact("time step; None for an automatic one", "s", key=None, default=None)
    integrator: str | None = fact("integrator", key="response.integrator", optional=True, default=None)
    tracks: Mapping[str, str] = fact("name of the flight that each centrifuge tracks", key=None, default_factory=dict)
    spans: Mapping[str, tuple[float, float]] = internal(
        "s", "first and last time of the response in each motion, where these differ", default_factory=dict
    )
    scales: Mapping[str, float] = fact("level factors of flights but 1, by name", key=None, default_factory=dict)
    levels: Mapping[str, ArmLevel] = internal("", "levels of plain arms, by name", default_factory=dict)
    records: Mapping[str, RecordSummary] = rows("records of flights, by name", "motion", default_factory=dict)
    warnings: tuple[str, ...] = fact("what is implausible", default=())
    notes: tuple[str, ...] = fact("what may be meant so, and is easily overlooked", optional=True, default=())
    distributions: Mapping[str, str] = fact("distribution of each value that has one, by path", default_factory=dict)

    @declared("", "kinds of motions, by name", "motion", role="rows", key="motions")
    def kinds(self) -> Mapping[str, Kind]:
        return {
            name: Kind(
                kind, self.tracks.get(name, ""), self.scales.get(name), self.levels.get(name), self.spans.get(name)
            )
            for name, kind in self.motions.items()
        }

    @declared("s", "time step, or auto", role="fact", key="response.step", optional=True)
    def step_or_auto(self) -> float | str | None:
        return None if self.integrator is None else self.step or "auto"
