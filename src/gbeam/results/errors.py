"""Estimated errors of a result by their causes: time steps, too few shapes, the model, the beam theory, the mesh."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

import numpy as np

from gbeam.arrays.tree import assign
from gbeam.guards.arguments import typed_methods
from gbeam.printable import percent
from gbeam.results.declared import declared, fact, internal, labels, part, quantity, rows
from gbeam.results.result import Complex, Floats, Part

PARTS = ("shapes", "model", "beam_theory", "mesh", "total")
SHAPES, MODEL = "estimated error from too few shapes", "estimated error of the model against exact"
PEAK = "estimated error of the largest values in all"
WHENEVER = "of loads and stress over time, whenever they are reached; the others are of the same instants"
WHOLE = ("slender", "total", "peak")  # errors of several causes together
THEORY, TOTAL = "estimated error of the theory of slender beams", "estimated error in all"
AGAINST_SLENDER = "estimated error against an exact slender beam"
FRICTION, SMOOTH = "estimated error of the smooth law of friction", "of systems, by another rate below which it is so"
MESH, COARSER = "estimated error of a solid's mesh", "by the difference to a coarser one"
UNKNOWN = "what is not estimated, and why"
FRAME = "frame of the frequencies: ground, or turning with what turns"
IN_GROUND = "frequency in the ground frame, of rotors alike about their axis"
SEVERAL = "NaN of a mode that has several there"
SLENDER = "against one with shear, rotary inertia and twist, and by plate action"


class Lacking(Protocol):
    """Errors that say whether a model has enough shapes, and the strains that matter,
    or zero where they are not known.
    """

    @property
    def few_shapes(self) -> float:
        """Largest error by too few shapes."""
        ...

    @property
    def few_strains(self) -> float:
        """Largest error by twist, shear and rotary inertia, which a slender beam lacks, and by plate action."""
        ...


def largest_known(*values: float) -> float:
    """Largest of the values that are known, or zero if none is."""
    return max((float(value) for value in values if math.isfinite(value)), default=0.0)


@dataclass(frozen=True, repr=False, eq=False)
class ErrorEstimate(Lacking, Part):
    """Estimated errors of a quantity, or a vector's length, as fractions of its largest, or NaN where there is none.

    Of several quantities each is the largest: causes, `slender` and `total` may be of different ones.
    """

    step: float = quantity("", "estimated error of the time steps", default=math.nan)
    shapes: float = quantity("", SHAPES, note="against the same model with more", default=math.nan)
    model: float = quantity("", MODEL, default=math.nan)
    beam_theory: float = quantity("", THEORY, note=SLENDER, default=math.nan)
    mesh: float = quantity("", MESH, note=COARSER, default=math.nan)
    friction: float = quantity("", FRICTION, note=SMOOTH, default=math.nan)
    slender: float = quantity("", AGAINST_SLENDER, note="all but that of the beam theory", default=math.nan)
    total: float = quantity("", TOTAL, note="the largest of all together, maybe less than their sum", default=math.nan)
    peak: float = quantity("", PEAK, note=WHENEVER, optional=True, default=math.nan)

    def __post_init__(self) -> None:
        if math.isnan(self.slender):
            theory = 0.0 if math.isnan(self.beam_theory) else self.beam_theory
            assign(self, slender=self.total - theory)

    @property
    def causes(self) -> dict[str, float]:
        """Errors by their causes, in words."""
        names = [field.name for field in fields(self) if field.name not in WHOLE]
        return {name.replace("_", " "): getattr(self, name) for name in names}

    @property
    def few_shapes(self) -> float:
        """Error by too few shapes, or zero where it is not known."""
        return largest_known(self.shapes)

    @property
    def few_strains(self) -> float:
        """Error of the theory of slender beams, or zero where it is not known."""
        return largest_known(self.beam_theory)

    def adding(self, **parts: float) -> ErrorEstimate:
        """Return the errors with others added to the total: `beam_theory`, `mesh`, `friction`; NaN adds nothing."""
        added = {name: share for name, share in parts.items() if not math.isnan(share)}
        addition = sum(added.values())
        slender = self.slender + addition - added.get("beam_theory", 0.0)
        return replace(self, slender=slender, total=self.total + addition, **added)

    @classmethod
    def from_largest(cls, errors: Iterable[ErrorEstimate]) -> ErrorEstimate:
        """Return the largest error of several quantities by each cause, and in all; unknown if there are none."""
        estimates = list(errors)
        maxima = {}
        for field in fields(cls):
            values = [getattr(estimate, field.name) for estimate in estimates]
            maxima[field.name] = float(np.fmax.reduce(values or [math.nan]))
        return cls(**maxima)

    def __repr__(self) -> str:
        parts = self.causes | {"total": self.total, "of the peak": self.peak}
        # A static deflection has no steps.
        shown = [f"{k} {percent(x)}" for k, x in parts.items() if math.isfinite(x) and (x or k != "step")]
        return ", ".join(shown) or "not known"


@typed_methods
@dataclass(frozen=True, repr=False, eq=False)
class Errors(Part):
    """Estimated errors of a response, or of a state of rest, which takes no time steps: in all, and as each of the
    bodies that are judged brings them.
    """

    displacement: ErrorEstimate = part(
        "of the displacement of a body's points relative to its root, over its largest, the largest of all bodies; of "
        "places where no body deforms",
        name="displacement_",
        default_factory=ErrorEstimate,
    )
    place: ErrorEstimate = part(
        "of the points' places in axes of the ground, over the largest displacement",
        name="place_",
        default_factory=ErrorEstimate,
    )
    loads: ErrorEstimate = part(
        "of the force and moment at the root of a beam, the largest of all",
        name="loads_",
        default_factory=ErrorEstimate,
    )
    stress: ErrorEstimate = part(
        "of the largest size of the normal stress over a beam's sections, the largest of all",
        name="stress_",
        default_factory=ErrorEstimate,
    )
    beams: tuple[str, ...] = labels("beam that is judged", "judged", key="", default=())
    by_beam: Floats = quantity(
        "",
        "estimated error of places that the beam's shapes and model bring",
        "judged",
        note="alone; together they may be more or less",
        empty=True,
    )
    displacement_by_beam: Floats = quantity(
        "", "estimated error of the displacement of the beam's points relative to its root, of its largest", "judged",
        empty=True,
    )  # fmt: skip
    loads_by_beam: Floats = quantity(
        "",
        "estimated error of the force and moment at the beam's root, the larger of both, of the largest there",
        "judged",
        empty=True,
    )
    load_peaks_by_beam: Floats = quantity(
        "", "estimated error of the largest force and moment at the beam's root, the larger of both", "judged",
        optional=True, empty=True,
    )  # fmt: skip
    stress_by_beam: Floats = quantity("", "estimated error of the beam's stress, of its largest", "judged", empty=True)
    stress_peaks_by_beam: Floats = quantity(
        "", "estimated error of the beam's largest stress", "judged", optional=True, empty=True
    )
    theory: tuple[str, ...] = quantity(
        "",
        "causes of the error of the beam theory, and what it assumes",
        "judged",
        note="such as plate action; assumed: Poisson's ratio 0.3",
        default=(),
    )
    note: str = fact(UNKNOWN, default="")

    @property
    def causes(self) -> str:
        """Causes of the error of the beam theory and what it assumes, of one body or each behind its name."""
        named = [(name, words) for name, words in zip(self.beams, self.theory, strict=True) if words]
        return "; ".join(words if len(self.beams) == 1 else f"{name}: {words}" for name, words in named)

    @property
    def few_shapes(self) -> float:
        """Largest error by too few shapes, of displacement and loads."""
        return largest_known(self.displacement.shapes, self.loads.shapes)

    @property
    def few_strains(self) -> float:
        """Largest error of the theory of slender beams, of displacement, loads and stress."""
        return largest_known(*(part.beam_theory for part in (self.displacement, self.loads, self.stress)))

    def __repr__(self) -> str:
        lines = [f"displacement: {self.displacement}"]
        if repr(self.place) not in (repr(self.displacement), repr(ErrorEstimate())):
            errors = zip(self.beams, self.by_beam, strict=True)
            by_beam = (f"{name} {percent(error)}" for name, error in errors if not math.isnan(error))
            lines += [f"place: {self.place}", ", ".join(by_beam)]
        lines += [f"{name}: {getattr(self, name)}" for name in ("loads", "stress") if self.beams]
        lines += [f"beam theory: {self.causes}"] if self.causes else []
        lines.append(self.note)
        return "\n  ".join(["Errors", *filter(None, lines)])


@dataclass(frozen=True, repr=False, eq=False)
class FrequencyErrors(Part):
    """Estimated errors of frequencies, as fractions, (k,) each, or NaN where there is no estimate."""

    shapes: Floats = quantity("", SHAPES, note="against the same model with more")
    model: Floats = quantity("", MODEL, note="with enough shapes")
    beam_theory: Floats = quantity("", THEORY, note=SLENDER)
    mesh: Floats = quantity("", MESH, note=COARSER)
    total: Floats = quantity(
        "", TOTAL, note="against the exact model with more shapes, of the beam theory and of the mesh"
    )
    theory: str = internal("", "causes of the error of the beam theory, and what it assumes", default="")
    unseen: tuple[float, ...] = internal(
        "Hz",
        "frequencies below the highest of these that bend the beam and twist it, and that no model has",
        default=(),
    )
    note: str = internal("", UNKNOWN, default="")
    growth: float = internal(
        "1/s",
        "rate at which a motion grows in the exact model with more shapes, where none grows in this one",
        default=0.0,
    )

    @property
    def few_shapes(self) -> float:
        """Largest error by too few shapes."""
        return largest_known(*self.shapes)

    @property
    def few_strains(self) -> float:
        """Largest error of the theory of slender beams, or infinite where frequencies are unseen."""
        return math.inf if self.unseen else largest_known(*self.beam_theory)

    @property
    def slender(self) -> Floats:
        """Total errors but for those of the beam theory: against an exact slender beam."""
        return self.total - np.nan_to_num(self.beam_theory)

    @property
    def parts(self) -> dict[str, Floats]:
        """The errors by name."""
        return {name: getattr(self, name) for name in PARTS}

    def __getitem__(self, chosen: Any) -> FrequencyErrors:
        return replace(self, **{name: errors[chosen] for name, errors in self.parts.items()})

    def count_within(self, share: float) -> int:
        """Number of frequencies, counted from the first, whose total errors are known and at most `share`."""
        return int(np.append(np.flatnonzero(~(self.total <= share)), len(self.total))[0])

    @property
    def largest(self) -> float:
        """Largest of the totals that are known, or NaN where none is."""
        finite = self.total[np.isfinite(self.total)]
        return float(finite.max()) if finite.size else math.nan


def totals(errors: FrequencyErrors | None, count: int) -> Floats:
    """Return total errors of frequencies, (k,), or NaN where there is no estimate."""
    return np.full(count, np.nan) if errors is None else errors.total


class Noted:
    """A result with errors of frequencies, which may leave something out."""

    errors: FrequencyErrors | None

    @declared("", UNKNOWN, role="fact", optional=True)
    def error_note(self) -> str:
        """Part of the errors of frequencies that is not estimated, and why, or empty where all is."""
        return "" if self.errors is None else self.errors.note


def direction_words(direction: str) -> str:
    """Words for the direction of a mode: along z, in twist, or of a system's body along or about its z."""
    body, _, direction = direction.rpartition(" ")
    if body:
        return f"of {body} {'about' if direction.startswith('r') else 'along'} its {direction[-1]}"
    return f"in {direction}" if direction == "twist" else f"along {direction}"


@dataclass(frozen=True, repr=False, eq=False)
class Instability(Part):
    """An eigenvalue with a positive real part: ``divergence`` without oscillation, ``flutter`` with."""

    kind: str = fact("divergence or flutter")
    growth_rate: float = fact("real part of the eigenvalue", "1/s")
    frequency: float = fact("frequency", "Hz", note="zero for divergence")
    direction: str = fact(
        "direction of the largest motion", note="x, y or z; of a system its body and an axis of its root"
    )

    def __str__(self) -> str:
        return f"{self.kind} {direction_words(self.direction)}, growing with {self.growth_rate:.4g} 1/s"


@dataclass(frozen=True, repr=False, eq=False)
class Accelerated(Part):
    """A coordinate that a steady state accelerates evenly: the strains are constant in axes that move with it.

    Of a body that is turned ever faster they are those of the instant at which it begins to turn.
    """

    coordinate: str = labels("name of the coordinate", key="")
    acceleration: float = quantity(
        "m/s^2", "acceleration, of a free joint in axes of the ground", optional=True, default=math.nan
    )
    angular_acceleration: float = quantity(
        "rad/s^2", "angular acceleration about an axis of the body's root", optional=True, default=math.nan
    )

    def __str__(self) -> str:
        if math.isnan(self.acceleration):
            return f"{self.coordinate} by {self.angular_acceleration:.4g} rad/s²"
        return f"{self.coordinate} by {self.acceleration:.4g} m/s²"


def accelerated() -> Any:
    """Declare the field of a result about a steady state that says what is accelerated."""
    words = "coordinates that are accelerated evenly, where all else rests"
    return rows(words, "accelerated", name="accelerated_", optional=True, default=())


def acceleration_lines(coordinates: tuple[Accelerated, ...]) -> list[str]:
    """Return a line on the coordinates that are accelerated; no line where all rest."""
    return [f"accelerated evenly: {', '.join(map(str, coordinates))}"] if coordinates else []


class Oscillating(Noted):
    """A result with eigenvalues that oscillate and errors of their frequencies, and what grows."""

    eigenvalue: Complex
    instabilities: tuple[Instability, ...]
    outcome: str

    @declared("", "whether nothing grows; None where that is not known", role="fact")
    def stable(self) -> bool | None:
        return None if self.outcome != "done" else not self.instabilities

    @declared("Hz", "natural frequency", "mode")
    def frequency(self) -> Floats:
        """Natural frequencies |λ|/2π, (k,) Hz."""
        return np.abs(self.eigenvalue) / (2 * np.pi)

    @declared("", "ratio of critical damping; negative for flutter", "mode")
    def damping_ratio(self) -> Floats:
        """Ratios of critical damping −Re λ/|λ|, (k,); negative for flutter."""
        return -self.eigenvalue.real / np.abs(self.eigenvalue)

    @declared("", "estimated error of the frequency in all", "mode", name=None)
    def error_estimate(self) -> Floats:
        """Estimated errors of the frequencies, (k,), fractions, or NaN where there is no estimate."""
        return totals(self.errors, len(self.eigenvalue))


@dataclass(frozen=True)
class StepErrors:
    """Estimated errors of the time steps as fractions of the largest size, or NaN where there is no estimate."""

    displacement: float = math.nan  # of the tip, or the largest of `moved`
    loads: float = math.nan  # of the root's force and moment, the larger of both
    stress: float = math.nan
    each: tuple[float, ...] = ()  # of force, moment and stress of every beam
    peaks: tuple[float, ...] = ()  # of the largest values of these
    moved: tuple[float, ...] = ()  # of the histories of displacements of a run
