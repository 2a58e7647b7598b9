"""Which figures a result has, by name, and the files of a whole study's."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from gbeam.errors import InputError
from gbeam.plots.comparison import plot_comparison, plot_shock
from gbeam.plots.environment import plot_axes, plot_base, plot_hub
from gbeam.plots.files import save
from gbeam.plots.loads import plot_loads, plot_loads_along
from gbeam.plots.steady import plot_campbell, plot_critical_map, plot_modes, plot_static
from gbeam.plots.tip import plot_tip
from gbeam.results.comparison import Comparison
from gbeam.results.machine import MachinePlan
from gbeam.results.response import Response
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.steady.modal import Campbell, Modes
from gbeam.results.steady.stability import CriticalMap
from gbeam.results.study import Study

Draw = Callable[[], Figure]


def plot(result: Any, what: str = "", title: str = "") -> Figure:
    """Draw one figure of a result: the first that it has, or the one of that name.

    Raises
    ------
    InputError
        If it has no such figure.
    """
    every = figures(result, title)
    if what and what not in every:
        raise InputError("what", f"is {what!r}, which this result does not have", f"choose from {', '.join(every)}")
    return every[what or next(iter(every))]()


def figures(result: Any, title: str = "") -> dict[str, Draw]:
    """Return what draws each figure of a result, by name.

    Parameters
    ----------
    result : Response, Study, Comparison, Modes, Campbell, Deflection, CriticalMap or MachinePlan
    title : str
        First line above each; a study has its own.
    """
    match result:
        case Study():
            return _of_study(result, title or result.title)
        case Response():
            tip = partial(plot_tip, Study(title, {result.name or result.environment: result}, ()))
            return {"tip": tip, **_of_response(result, title)}
        case Comparison():
            shock = {} if result.shock is None else {"shock": partial(plot_shock, result, result.shock, title)}
            return {"parts": partial(plot_comparison, result, title), **shock}
        case Deflection():
            along = {} if result.loads is None else {"loads": partial(plot_loads_along, result, result.loads, title)}
            return {"shape": partial(plot_static, [result], title), **along}
        case MachinePlan():
            return {"axes": partial(plot_axes, result, result.axes, title)}
        case Modes():
            return {"modes": partial(plot_modes, result, title)}
        case Campbell():
            return {"campbell": partial(plot_campbell, result, title)}
        case CriticalMap():
            return {"critical": partial(plot_critical_map, result, title)}
    raise TypeError(f"{type(result).__name__} has no figures")


def _of_response(response: Response, title: str) -> dict[str, Draw]:
    every: dict[str, Draw] = {"base": partial(plot_base, response, title)}
    if response.loads is not None:
        every["loads"] = partial(plot_loads, response, response.loads, title)
    if response.axes is not None:
        every["axes"] = partial(plot_axes, response, response.axes, title)
    if response.hub is not None:
        every["hub"] = partial(plot_hub, response, response.hub, title)
    return every


def _of_study(study: Study, title: str) -> dict[str, Draw]:
    every: dict[str, Draw] = {"tip": partial(plot_tip, study)}
    for name, response in study.responses.items():
        every |= {f"{kind} {name}": draw for kind, draw in _of_response(response, title).items()}
    for compared in study.comparisons:
        name = compared.centrifuge
        if compared.root or compared.stations or compared.mismatch:
            every[f"comparison {name}"] = partial(plot_comparison, compared, title)
        if compared.shock:
            every[f"shock {name}"] = partial(plot_shock, compared, compared.shock, title)
    return every


def write_plots(study: Study, folder: Path) -> list[Path]:
    """Write all plots of a study.

    Parameters
    ----------
    study : Study
    folder : Path
        Which exists.

    Returns
    -------
    list of Path
        The files: ``tip``, and per environment ``base_NAME``, ``loads_NAME``, ``axes_NAME`` (centrifuges),
        ``hub_NAME`` (hubs); per comparison ``comparison_NAME`` and ``shock_NAME``, NAME being the centrifuge's.
    """
    files: list[Path] = []
    for name, draw in figures(study).items():
        files += save(draw(), folder, name.replace(" ", "_", 1))
    return files
