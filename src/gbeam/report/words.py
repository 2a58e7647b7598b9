"""Numbers, vectors and JSON as all reports write them."""

from __future__ import annotations

import json
import math
import shutil
import sys
from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.printable import LEAST_SHARE, MOST_TURNS, json_printable
from gbeam.printable import percent as percent_of
from gbeam.results.errors import WHOLE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from gbeam.results.parts import LoadPeaks

ALONG = 1e-9  # of a direction along an axis
LARGEST_WRITTEN = 1e6  # from here on numbers have an exponent


def as_json(value: Any) -> str:
    """Write a value as JSON, with null for what is not finite, which JSON has no word for."""
    return json_printable(json.dumps(json_value(value), indent=2, ensure_ascii=False, allow_nan=False))


def json_value(value: Any) -> Any:
    """Return a value as JSON has it: None for what is not finite, and functions called for their value."""
    if callable(value):  # what takes time to find, and is not always printed
        return json_value(value())
    if isinstance(value, Mapping):
        return {key: json_value(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [json_value(entry) for entry in value]
    if isinstance(value, float):  # numpy's float64 is one
        return float(value) if math.isfinite(value) else None
    return value


def terminal_width() -> int:
    """Columns of the terminal that is printed to, or zero of a file, which takes any width."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else 0


def float_of(value: float | None) -> float:
    """Return a number of JSON as a float: NaN for null."""
    return math.nan if value is None else float(value)


def columns(heads: list[str], rows: list[list[str]], flush_left: Collection[int] = (0,)) -> list[str]:
    """Return the lines of a table. Columns are flush right, except those of the indices `flush_left`.

    If the terminal is narrow, each cell has a line of its own.
    """
    widths = [max(len(row[k]) for row in [heads, *rows]) for k in range(len(heads))]
    room = terminal_width()
    if 0 < room < sum(widths) + 2 * len(widths):
        head_width = max(map(len, heads))
        folded: list[str] = []
        for first, *further_cells in rows:
            cells = zip(heads[1:], further_cells, strict=True)
            folded += [first, *(f"  {head:<{head_width}}  {cell}" for head, cell in cells if cell)]
        return folded
    forms = [f"{'<' if k in flush_left else '>'}{width}" for k, width in enumerate(widths)]
    lines = []
    for row in [heads, *rows]:
        lines.append("  ".join(f"{cell:{form}}" for cell, form in zip(row, forms, strict=True)).rstrip())
    return lines


def number(value: float, digits: int = 4) -> str:
    """Write a number with significant digits; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    text = "0" if value == 0 else f"{value:#.{digits}g}".rstrip(".").replace(".e", "e")
    return f"{float(text):.0f}" if 1 <= abs(value) < LARGEST_WRITTEN and "e" in text else text


def percent(share: float) -> str:
    """Write a share in percent; a dash where it is not known."""
    (share,) = tidy((share,), 0.0, 1.0) if math.isfinite(share) else (share,)
    return f"{number(100 * share, 2)} %" if LEAST_SHARE <= share < 0.1 else percent_of(share)


def errors_in_words(errors: Mapping[str, float | None]) -> str:
    """An error with what it is made of, the largest first: ``0.29 % (model 0.27, shapes 0.01, step 0.002)``."""
    parts = {name.replace("_", " "): float_of(size) for name, size in errors.items() if name not in WHOLE}
    ranked = sorted(((size, name) for name, size in parts.items() if size > rounding(0.0, 1.0)), reverse=True)
    shares = ", ".join(f"{name} {percent(size).removesuffix(' %')}" for size, name in ranked)
    total = percent(float_of(errors["total"]))
    return f"{total} ({shares})" if len(ranked) > 1 else total


def rounding(size: float, scale: float = 0.0) -> float:
    """Return the largest rounding error of numbers of a `size`, and of differences of numbers of a `scale`."""
    return max(1e-8 * size, 1e-14 * scale, 1e-20)


def angle_words(angle: float) -> str:
    """An angle, rad, in degrees, or of more than :data:`MOST_TURNS` in turns."""
    turns = angle / (2 * math.pi)
    return f"{number(turns)} turns" if abs(turns) > MOST_TURNS else f"{number(math.degrees(angle))} deg"


def tidy(values: Iterable[float], size: float, scale: float = 0.0) -> list[float]:
    """Return values with zero for what is a rounding error beside `size`, or `scale`: :func:`rounding`."""
    return [float(value) if abs(value) > rounding(size, scale) else 0.0 for value in values]


def stress_words(stations: Any, tension: Any, compression: Any, yield_strength: float | None) -> str:
    """Words for the extreme normal stresses (s,), Pa, at stations (s,), m: range, place of the largest, and margin."""
    sizes = [max(high, -low) for high, low in zip(tension, compression, strict=True)]
    stress = float(max(sizes))
    largest = sizes.index(stress)
    sign = "tension" if tension[largest] >= -compression[largest] else "compression"
    low, high = (number(1e-6 * extreme) for extreme in tidy((min(compression), max(tension)), 0.0))
    if low == high == "0":
        return "no stress"
    words = f"stress {low} to {high} MPa, largest in {sign} at {number(float(stations[largest]))} m"
    if yield_strength is None:
        return words
    from gbeam.results.parts import margin_words, yield_margin

    return f"{words}, {margin_words(float(yield_margin(yield_strength, np.array(stress))))}"


def largest_loads(peaks: LoadPeaks) -> str:
    """Words for the largest sizes over time: at root and supports, of the stress, of the torque about an axis."""
    force, moment = float(peaks.force[0].size.value), float(peaks.moment[0].size.value)
    words = f"root: largest force {number(force)} N, moment {number(moment)} N m"
    if peaks.supports is not None and peaks.support_force is not None and peaks.support_moment is not None:
        sizes = peaks.support_force.size.value, peaks.support_moment.size.value
        names = peaks.support_names or [f"{number(1e3 * place)} mm" for place in peaks.supports]
        for name, force, moment in zip(names, *sizes, strict=True):
            words += f"; support at {name}: {number(force)} N, {number(moment)} N m"
    if np.isfinite(peaks.tension.value).all():
        extremes = peaks.tension.value, peaks.compression.value
        words += f"; {stress_words(peaks.stations, *extremes, peaks.yield_strength)}"
    if peaks.beam_torque is not None:
        words += f"; torque about the axis {number(float(peaks.beam_torque.value))} N m"
    return words


def sentence(text: str) -> str:
    """Words with a capital letter in front."""
    return text[:1].upper() + text[1:]


def axis_words(direction: ArrayLike) -> str:
    """Return the word for a direction (3,): +x where it lies along an axis, else its components."""
    components = np.asarray(direction, dtype=float)
    largest = int(np.abs(components).argmax())
    if abs(abs(components[largest]) - 1) < ALONG:
        return f"{'-' if components[largest] < 0 else '+'}{'xyz'[largest]}"
    return f"({', '.join(f'{component:.3g}' for component in tidy(components.tolist(), 1.0))})"
