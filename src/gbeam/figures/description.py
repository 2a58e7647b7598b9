"""Descriptions of figures: panels of lines, areas, levels and bars, in the units in which they are drawn."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.printable import percent, raised
from gbeam.results.accounting import Accounting
from gbeam.results.declared import declarations
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Loads, Supports
from gbeam.results.result import Flags, Floats

REFERENCE, GREY = 6, 7  # numbers of colours: what others are compared with, what was before
ROUNDING = 1e-9  # of the largest: what is smaller is rounding
SMALL = 0.01  # of the largest: a smaller component is named and not drawn
NEAR = 5.0  # times what is used: a limit beyond would press the lines to the ground, and is named only
_SPAN = 1e-6  # s: shorter is rounding
_DASHES: tuple[Dash, ...] = ("dotted", "dashed", "solid")  # of x, y and z

Dash = Literal["solid", "dashed", "dotted"]
Marks = Literal["", "joined", "dots", "rings", "supports"]
Span = tuple[float, float, str]  # start, end s, reason


@dataclass(frozen=True, eq=False)
class Line:
    """Values over a quantity, (n,) each. Broad is flight, below what imitates it: where they agree both are seen."""

    x: Floats
    y: Floats
    label: str = ""
    colour: int = 0
    dash: Dash = "solid"
    broad: bool = False
    marks: Marks = ""


@dataclass(frozen=True, eq=False)
class Area:
    """Area between two lines, (n,) each."""

    x: Floats
    low: Floats
    high: Floats
    label: str
    colour: int = 0


@dataclass(frozen=True)
class Level:
    """One value of the vertical quantity."""

    value: float
    label: str
    dash: Dash = "dashed"


@dataclass(frozen=True)
class Mark:
    """One value of the horizontal quantity."""

    value: float
    label: str


@dataclass(frozen=True, eq=False)
class Bars:
    """Groups of horizontal bars beside the same names, (n,) each, with intervals where these are known."""

    names: tuple[str, ...]
    values: Mapping[str, Floats]
    low: Mapping[str, Floats] = field(default_factory=dict)
    high: Mapping[str, Floats] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Map:
    """Values (n, m) over two quantities, with how the case of each ended."""

    x: Sequence[Any]
    y: Sequence[Any]
    values: Floats
    label: str
    outcome: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes."""

    y: str
    lines: tuple[Line, ...] = ()
    title: str = ""
    x: str = "time, s"  # of lines over time
    areas: tuple[Area, ...] = ()
    levels: tuple[Level, ...] = ()
    marks: tuple[Mark, ...] = ()
    spans: tuple[Span, ...] = ()
    bars: Bars | None = None
    map: Map | None = None
    texts: tuple[tuple[float, float, str], ...] = ()
    ticks: tuple[str, ...] = ()  # words at 0, 1, 2 … along x
    limits: tuple[float, float] | None = None  # ends of the vertical axis where the data do not say them
    logarithmic: bool = False
    zero: bool = False
    named: bool = True  # whether a legend names the lines
    height: float = 1.0  # share of the usual


@dataclass(frozen=True, eq=False)
class Figure:
    """Panels one above the other over one quantity, with what is to be said above them."""

    title: str
    subject: str
    panels: tuple[Panel, ...]
    notes: tuple[str, ...] = ()
    outcomes: tuple[str, ...] = ("done",)

    @property
    def heading(self) -> str:
        """Title, in capitals what must not be overlooked, the subject, and the notes, on lines of their own."""
        failed = sorted({outcome.upper() for outcome in self.outcomes if outcome != "done"})
        lines = [text for text in (self.title, self.subject) if text]
        lines[0] = " – ".join([*failed, lines[0]])
        return "\n".join([*lines, *self.notes])


def words_and_unit(kind: type, name: str) -> tuple[str, str]:
    """Words and unit of a field of a result, as they are declared."""
    declaration = dict(declarations(kind))[name]
    return declaration.words.partition(";")[0], declaration.unit if isinstance(declaration.unit, str) else ""


def of_motion(name: str, subject: str) -> str:
    """Subject of a figure, after the motion's name if it has one."""
    return f"{name}: {subject}" if name else subject


def error_note(errors: Mapping[str, float]) -> tuple[str, ...]:
    """Note on the estimated errors that are known, fractions by name; none where none is."""
    words = [f"{name} {percent(error)}".strip() for name, error in errors.items() if math.isfinite(error)]
    return (f"estimated error: {', '.join(words)}",) if words else ()


def moving_axes(*values: Floats) -> list[int]:
    """Indices of components (last axis) larger than a hundredth of the largest; that one alone where none moves."""
    sizes = []
    for array in values:
        finite = np.nan_to_num(array, nan=0.0, posinf=0.0, neginf=0.0)
        sizes.append(np.abs(finite).reshape(-1, array.shape[-1]).max(axis=0))
    size = np.max(sizes, axis=0)
    return [i for i in range(len(size)) if size[i] > SMALL * size.max()] or [int(size.argmax())]


def not_drawn(axes: Sequence[int], *lengths: Floats) -> tuple[str, ...]:
    """Note on the largest sizes of the components (last axis) of lengths, m, that are not `axes`; none of rounding."""
    sizes = [max(largest_size(array[..., i]) for array in lengths) for i in range(3)]
    words = []
    for i, size in enumerate(sizes):
        if i not in axes and size > ROUNDING * max(sizes):
            scale, unit = scale_of("m", size)
            words.append(f"{'xyz'[i]} by {scale * size:.2g} {unit}")
    return (f"(not drawn: {' and '.join(words)} at most)",) if words else ()


def components(x: Floats, values: Floats, names: Sequence[str], panel: Panel) -> Panel:
    """Put components (n, 3) into a panel. Those below a hundredth of the largest are named and not drawn."""
    drawn_axes, sizes = moving_axes(values), np.abs(values).max(axis=0)
    omitted = [names[i] for i in range(3) if i not in drawn_axes and sizes[i] > ROUNDING * sizes.max()]
    lines = tuple(Line(x, values[:, i], names[i], colour=i, dash=_DASHES[i]) for i in drawn_axes)
    return replace(
        panel, lines=lines, title=f"{' and '.join(omitted)}: below 1 %, not drawn" if omitted else panel.title
    )


def imitation_look(index: int) -> dict[str, Any]:
    """Look of the `index`-th line that is compared with flight's; from the second on dashed, on top of the first."""
    return {"colour": (index + 1) % 6, "dash": ("solid", "dashed", "dotted")[min(index, 2)]}


FLIGHT: dict[str, Any] = {"colour": 5, "broad": True}


def support_lines(supports: Supports | None, scale: float, direction: str = "") -> tuple[Line, ...]:
    """Symbols, along a body's axis in a unit of `scale` a metre, of its supports: of all, or of those that hold a
    direction.
    """
    positions = np.zeros(0) if supports is None else scale * supports.positions(direction)
    if not len(positions):
        return ()
    return (Line(positions, np.zeros(len(positions)), "supports", colour=REFERENCE, marks="supports"),)


def support_note(supports: Supports | None, name: str = "") -> tuple[str, ...]:
    """Note on what the supports of a body hold; none without supports."""
    if supports is None:
        return ()
    words = [f"at {place} {held}" for place, held in zip(supports.name, supports.words, strict=True)]
    return (f"supports{f' of {name}' if name else ''}: {'; '.join(words)}",)


def support_names(loads: Loads) -> Sequence[str]:
    """Names of the supports whose loads these are, or their positions along a beam; none without supports."""
    positions = () if loads.supports is None else loads.supports
    scale, unit = scale_of("m", loads.stations)
    return loads.support_names or [f"{scale * position:.4g} {unit}" for position in positions]


def limit_levels(allowed: float, values: Floats, label: str = "limit") -> tuple[Level, ...]:
    """A limit on the size of some values, on the sides to which they go; none where it is far beyond."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    used = max(-low, high)
    sides = [(1.0, high), (-1.0, -low)] if allowed <= NEAR * used else []
    return tuple(Level(side * allowed, label) for side, reached in sides if reached > SMALL * used)


def ends_of(covered: Flags, *values: Floats) -> tuple[float, float] | None:
    """Return the ends of an axis for values at the covered times, with zero and a margin.

    None if all times are covered, or none: the axis then fits all values.
    """
    if covered.all() or not covered.any():
        return None
    low = min(0.0, *(float(array[covered].min()) for array in values))
    high = max(0.0, *(float(array[covered].max()) for array in values))
    margin = 0.05 * (high - low) or 1.0
    return low - margin, high + margin


def stretches(axes: AxesResult | None, time: Floats, accounting: Accounting | None = None) -> tuple[Span, ...]:
    """Return the spans of a run to shade: spin-up, stretches that are not followed, with reasons, and spin-down."""
    if axes is None and accounting is None:
        return ()
    not_followed: Iterable[Span] = axes.episodes if axes is not None else ()
    if accounting is not None:
        not_followed = [(stretch.start, stretch.end, stretch.reason) for stretch in accounting.not_followed]
    first, last = (float(time[0]), float(time[-1])) if axes is None else axes.span
    ends = [(float(time[0]), first, "spin-up"), *not_followed, (last, float(time[-1]), "spin-down")]
    return tuple((start, end, _shorten(reason)) for start, end, reason in ends if end - start > _SPAN)


def _shorten(reason: str) -> str:
    """A reason as a legend has it: of several limits that are used up, ``axis 2 jerk, axis 3 jerk``, the axes only."""
    limits = reason.split(", ")
    if len(limits) == 1:
        return reason
    axes = sorted({limit.rpartition(" ")[0] for limit in limits})
    return f"limits of {' and '.join(axes)}"


# By the SI unit: size from which on, factor, name; ascending, and the second is for what is zero.
_UNITS = {
    "m": ((0.0, 1e6, "µm"), (1e-4, 1e3, "mm"), (1.0, 1.0, "m")),
    "N": ((0.0, 1e3, "mN"), (0.1, 1.0, "N"), (1e4, 1e-3, "kN")),
    "N m": ((0.0, 1e3, "mN m"), (0.01, 1.0, "N m"), (1e4, 1e-3, "kN m")),
    "Pa": ((0.0, 1e-3, "kPa"), (1e5, 1e-6, "MPa")),
    "m/s^2": ((0.0, 1.0, "m/s²"), (0.5 * STANDARD_GRAVITY, 1 / STANDARD_GRAVITY, "g")),
}
_READABLE = (0.01, 1e4)  # beyond it a power of ten goes to the axis


def scale_of(si: str, *values: Floats | float) -> tuple[float, str]:
    """Factor and name of the unit in which the largest of some values in an SI unit reads well."""
    units = _UNITS[si]
    size = max((largest_size(np.asarray(array)) for array in values), default=0.0)
    chosen = units[1] if size == 0 else [unit for unit in units if size >= unit[0]][-1]
    return chosen[1:]


def largest_size(values: Floats) -> float:
    """Return the largest finite size, or zero where there is none."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def readable_scale(name: str, unit: str, values: Floats) -> tuple[float, str]:
    """Return a factor 1000^n that makes values readable, and the label of an axis in the scaled unit."""
    low, high = _READABLE
    size, unit = largest_size(values), raised(unit)
    power = 0 if size == 0 or low <= size < high else 3 * math.floor(math.log10(size) / 3)
    prefix = {-9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G"}.get(power)
    if power and unit and prefix and not unit.startswith(("k", "m/")):
        return 10.0**-power, ", ".join(filter(None, (name, f"{prefix}{unit}")))
    return 10.0**-power, ", ".join(filter(None, (name, unit))) + (f" × 10^{power}" if power else "")
