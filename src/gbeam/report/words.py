"""Numbers, vectors and JSON as all reports write them."""

from __future__ import annotations

import json
import math
import shutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.printable import json_printable

if TYPE_CHECKING:
    from gbeam.results.errors import ErrorEstimate, SystemErrors
    from gbeam.results.parts import LoadPeaks, Loads
    from gbeam.results.result import Result


def as_json(value: Any) -> str:
    """Write a value as JSON, with null for what is not finite, which JSON has no word for."""
    return json_printable(json.dumps(_plain(value), indent=2, ensure_ascii=False, allow_nan=False))


def _plain(value: Any) -> Any:
    if callable(value):  # what takes time to find, and is not always printed
        return _plain(value())
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    if isinstance(value, float):  # numpy's float64 is one
        return float(value) if math.isfinite(value) else None
    return value


def terminal_width() -> int:
    """Columns of the terminal that is printed to; zero of a file, which takes any width."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else 0


def columns(heads: list[str], rows: list[list[str]]) -> list[str]:
    """Lines of a table, flush right but for its first column; on a narrower terminal each row in lines of its own."""
    widths = [max(len(row[k]) for row in [heads, *rows]) for k in range(len(heads))]
    room = terminal_width()
    if 0 < room < sum(widths) + 2 * len(widths):
        beside = max(map(len, heads))
        folded: list[str] = []
        for first, *others in rows:
            named = zip(heads[1:], others, strict=True)
            folded += [first, *(f"  {head:<{beside}}  {cell}" for head, cell in named if cell)]
        return folded
    cells = [
        [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        for row in [heads, *rows]
    ]
    return ["  ".join(row).rstrip() for row in cells]


def number(value: float, digits: int = 4) -> str:
    """Write a number with significant digits; a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    return "0" if value == 0 else f"{value:#.{digits}g}".rstrip(".")


def percent(share: float) -> str:
    """Write a share in percent; a dash where it is not known."""
    if not math.isfinite(share):
        return "–"
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{number(100 * share, 2)} %"


def error_words(errors: ErrorEstimate) -> str:
    """An error with what it is made of, the largest first: ``0.29 % (model 0.27, shapes 0.01, step 0.002)``."""
    known = sorted(((size, name) for name, size in errors.causes.items() if size > 0), reverse=True)
    shares = ", ".join(f"{name} {number(100 * size, 2)}" for size, name in known)
    return f"{percent(errors.total)}{f' ({shares})' if len(known) > 1 else ''}"


def tidy(values: Iterable[float], size: float) -> list[float]:
    """Values without the rounding errors of what is `size` large, or of nothing at all."""
    return [float(value) if abs(value) > max(1e-10 * size, 1e-20) else 0.0 for value in values]


def stress_words(stations: Any, tension: Any, compression: Any, yield_strength: float | None) -> str:
    """The extreme normal stresses (s,) Pa at stations (s,) m, where the larger is, and the margin on yield if known."""
    sizes = [max(high, -low) for high, low in zip(tension, compression, strict=True)]
    stress = float(max(sizes))
    worst = sizes.index(stress)
    sign = "tension" if tension[worst] >= -compression[worst] else "compression"
    low, high = (number(1e-6 * each) for each in tidy((min(compression), max(tension)), 0.0))
    if low == high == "0":
        return "no stress"
    words = f"stress {low} to {high} MPa, largest in {sign} at {number(float(stations[worst]))} m"
    if yield_strength is None:
        return words
    from gbeam.results.parts import margin_words, yield_margin

    return f"{words}, {margin_words(float(yield_margin(yield_strength, np.array(stress))))}"


def resting_loads(loads: Loads) -> str:
    """Force and moment of the base on the root, and the stress, at rest."""
    largest = float(np.abs(loads.force).max())
    lever = max(float(np.abs(loads.moment).max()), largest * float(loads.stations[-1]))
    force, moment = (
        ", ".join(f"{value:.5g}" for value in tidy(vector[0], size))
        for vector, size in ((loads.root_force, largest), (loads.root_moment, lever))
    )
    words = f"base on root: force ({force}) N, moment ({moment}) N m"
    if np.isfinite(loads.stress).all():
        extremes = loads.stress_tension[0], loads.stress_compression[0]
        words += f"; {stress_words(loads.stations, *extremes, loads.yield_strength)}"
    if loads.beam_torque is not None:
        words += f"; torque from the hub {tidy(loads.beam_torque, lever)[0]:.5g} N m"
    return words


def largest_loads(peaks: LoadPeaks) -> str:
    """Largest sizes over time: at the root, of the stress, and of the torque about a hub's axis."""
    force, moment = (float(each[0].size.value) for each in (peaks.force, peaks.moment))
    words = f"root: largest force {number(force)} N, moment {number(moment)} N m"
    if np.isfinite(peaks.tension.value).all():
        extremes = peaks.tension.value, peaks.compression.value
        words += f"; {stress_words(peaks.stations, *extremes, peaks.yield_strength)}"
    if peaks.beam_torque is not None:
        words += f"; torque from the hub {number(float(peaks.beam_torque.value))} N m"
    return words


def warning_lines(result: Result) -> list[str]:
    """A line for each warning of a result."""
    return [f"  warning: {each}" for each in result.warnings]


def sentence(text: str) -> str:
    """Words with a capital letter in front."""
    return text[:1].upper() + text[1:]


def by_beam(errors: SystemErrors) -> Iterator[str]:
    """Lines on a system's errors, beam by beam."""
    if len(errors.by_beam):
        alone = zip(errors.beams, errors.by_beam, strict=True)
        yield f"errors by shapes and model of {', '.join(f'{name} {percent(float(each))}' for name, each in alone)}"
    if len(errors.loads_by_beam):
        each = zip(errors.beams, errors.loads_by_beam, errors.stress_by_beam, strict=True)
        listed = ", ".join(
            f"{name} {percent(float(loads))} and {percent(float(stress)) if math.isfinite(stress) else 'unknown'}"
            for name, loads, stress in each
        )
        yield f"errors of root loads and of stress of {listed}"
    if math.isfinite(errors.displacement.beam_theory):
        yield f"errors by the theory of slender beams {percent(errors.displacement.beam_theory)}"
    if math.isfinite(errors.displacement.mesh):
        yield f"errors of the meshes {percent(errors.displacement.mesh)}"
