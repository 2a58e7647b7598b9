"""Figures of any result: which there are, as axes or as files."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, cast

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.errors import InputError
from gbeam.plots.cases import plot_history, plot_indices, plot_probability, plot_sweep
from gbeam.plots.comparison import moved, plot_comparison, plot_shock
from gbeam.plots.machine import plot_axes, plot_base, plot_hub, plot_tracking
from gbeam.plots.response import plot_loads, plot_loads_along, plot_tip
from gbeam.plots.searches import plot_fit, plot_optimum, plot_robustness, plot_sensitivity, plot_shaping
from gbeam.plots.steady import plot_campbell, plot_critical_map, plot_modes, plot_static
from gbeam.plots.style import Shown, style
from gbeam.results.cases import PROBABILITY, Sensitivity, Sweep
from gbeam.results.equilibrium import CriticalMap, Deflection
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.machine import AxesResult
from gbeam.results.modal import Campbell, Modes
from gbeam.results.response import Response
from gbeam.results.searches import Fit, Optimum, ShapedCommand
from gbeam.results.study import Study

Draw = Callable[[], Figure]


class Panels(tuple[Axes, ...]):
    """The axes of one figure from top to bottom, a tuple also where there is one; a notebook shows the figure."""

    __slots__ = ()

    @property
    def figure(self) -> Shown:
        """The figure that they are in."""
        return cast(Shown, self[0].get_figure(root=True))

    def _repr_png_(self) -> bytes:
        return self.figure._repr_png_()


def plot(result: Any, what: str = "", title: str = "") -> Panels:
    """Draw one figure of a result, the first that it has or the one of that name, and return its axes."""
    every = figures(result, title)
    if what and what not in every:
        raise InputError("what", f"is {what!r}, which this result does not have", f"choose from {', '.join(every)}")
    return Panels(every[what or next(iter(every))]().axes)


def figures(result: Any, title: str = "") -> dict[str, Draw]:
    """Return what draws each figure of a result, by name."""
    match result:
        case Study():
            return _of_study(result, title or result.title)
        case Response():
            tip = partial(plot_tip, Study(title, {result.name or result.environment: result}, ()))
            return {"tip": tip, **_of_response(result, title)}
        case Comparison():
            shock = {} if result.shock is None else {"shock": partial(plot_shock, result, result.shock, title)}
            first, *others = moved(result)
            parts: dict[str, Draw] = {"parts": partial(plot_comparison, result, title, first)}
            return parts | {f"parts {'xyz'[i]}": partial(plot_comparison, result, title, i) for i in others} | shock
        case Deflection():
            along = {} if result.loads is None else {"loads": partial(plot_loads_along, result, result.loads, title)}
            return {"shape": partial(plot_static, [result], title), **along}
        case MachinePlan():
            return _of_machine(result, result.axes, title)
        case Modes():
            return {"modes": partial(plot_modes, result, title)}
        case Campbell():
            return {"campbell": partial(plot_campbell, result, title)}
        case CriticalMap():
            return {"critical": partial(plot_critical_map, result, title)}
        case Sweep():
            return _of_sweep(result, title)
        case Fit():
            return {"fit": partial(plot_fit, result, title)}
        case Optimum():
            return {"optimum": partial(plot_optimum, result, title)}
        case ShapedCommand():
            return {
                "shaping": partial(plot_shaping, result, title),
                "robustness": partial(plot_robustness, result, title),
            }
        case Sensitivity():
            return {name: partial(plot_sensitivity, result, name, title) for name in result.measures}
    raise TypeError(f"{type(result).__name__} has no figures")


def _of_sweep(result: Sweep, title: str) -> dict[str, Draw]:
    """What can be drawn: measures over two dimensions at most, a probability over one parameter."""
    every: dict[str, Draw] = {}
    few = len(result.dimensions) <= 2
    for name in result.measures:
        likely = name in result.statistics and PROBABILITY in result.statistics[name].names
        if likely and len(result.dimensions) == 2:
            every[name] = partial(plot_probability, result, name, title)
        elif few and not likely:
            every[name] = partial(plot_sweep, result, name, title)
    every |= {f"{name} indices": partial(plot_indices, result, name, title) for name in result.indices}
    return every | {f"{name} history": partial(plot_history, result, name, title) for name in result.histories}


def _of_machine(
    result: Response | MachinePlan, axes: AxesResult, title: str, flight: Response | None = None
) -> dict[str, Draw]:
    quantities = ("rate", "acceleration", *(["jerk"] if axes.jerk is not None else []))
    return {
        "tracking": partial(plot_tracking, result, axes, title, flight),
        **{f"axes_{each}": partial(plot_axes, result, axes, each, title) for each in quantities},
    }


def _of_response(response: Response, title: str, flight: Response | None = None) -> dict[str, Draw]:
    every: dict[str, Draw] = {"base": partial(plot_base, response, title)}
    if response.loads is not None:
        every["loads"] = partial(plot_loads, response, response.loads, title)
    if response.axes is not None:
        every |= _of_machine(response, response.axes, title, flight)
    if response.hub is not None:
        every["hub"] = partial(plot_hub, response, response.hub, title)
    return every


def _of_study(study: Study, title: str) -> dict[str, Draw]:
    every: dict[str, Draw] = {"tip": partial(plot_tip, study)}
    flights = {each.centrifuge: study.responses.get(each.flight) for each in study.comparisons}
    for name, response in study.responses.items():
        of = _of_response(response, title, flights.get(name))
        every |= {f"{kind} {name}": draw for kind, draw in of.items()}
    for compared in study.comparisons:
        name = compared.centrifuge
        if compared.root or compared.stations or compared.mismatch:
            first, *others = moved(compared)
            every[f"comparison {name}"] = partial(plot_comparison, compared, title, first)
            every |= {f"comparison_{'xyz'[i]} {name}": partial(plot_comparison, compared, title, i) for i in others}
        if compared.shock:
            every[f"shock {name}"] = partial(plot_shock, compared, compared.shock, title)
    return every


def write_plots(study: Study, folder: Path, source: str = "") -> list[Path]:
    """Write all plots of a study."""
    files: list[Path] = []
    with style():
        for name, draw in figures(study).items():
            files += save(draw(), folder, name.replace(" ", "_", 1), source)
    return files


DPI = 150
_LEVEL = 3  # of compression: more takes longer than it is worth
_BEGINNING = 2000  # bytes of a file that hold its signature
_ESCAPED = ("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")  # of XML; its own module imports what fetches from the net
_TEXT = re.compile(rb"(....)(tEXtSource\0|iTXtSource\0{5})", re.DOTALL)  # of PNG: length, kind and key
_ELEMENT = re.compile(rb"<dc:source>([^<]*)</dc:source>")  # of SVG


def save(figure: Figure, folder: Path, name: str, source: str = "") -> list[Path]:
    """Write a figure as PNG (150 dpi) and SVG; return the files."""
    compression = {"pil_kwargs": {"compress_level": _LEVEL}}
    files: dict[Path, dict[str, Any]] = {folder / f"{name}.png": compression, folder / f"{name}.svg": {}}
    with style():  # some settings are read only when a figure is drawn
        for file, options in files.items():
            signed = {"Source": f"{source}: {file.name}"} if source else None
            figure.savefig(file, dpi=DPI, metadata=signed, **options)
    return list(files)


def signature(file: Path) -> str:
    """Return the `source` that :func:`save` signed a file with; empty where there is none, or for another name."""
    with file.open("rb") as opened:
        beginning = opened.read(_BEGINNING)
    source, _, name = (_in_png if file.suffix == ".png" else _in_svg)(beginning).rpartition(": ")
    return source if name == file.name else ""


def _in_png(beginning: bytes) -> str:
    match = _TEXT.search(beginning)
    if match is None:
        return ""
    text = beginning[match.end() : match.start(2) + 4 + int.from_bytes(match[1])]
    # Version 0.2 ended it with a zero.
    return text.rstrip(b"\0").decode("latin-1" if match[2].startswith(b"tEXt") else "utf-8", errors="replace")


def _in_svg(beginning: bytes) -> str:
    match = _ELEMENT.search(beginning)
    text = match[1].decode(errors="replace") if match else ""
    for escaped, letter in _ESCAPED:
        text = text.replace(escaped, letter)
    return text
