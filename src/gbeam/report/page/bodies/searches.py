"""The pages of studies: a fit, an optimum, sensitivities, a shaped command."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from gbeam.report.page.parts import Cell, Value, heading, known, listed, paragraph, plot_places, raised, table
from gbeam.report.page.series import Numbers, Plots
from gbeam.report.words import number, percent
from gbeam.results.result import Floats

Facts = Mapping[str, Any]
_REFERENCE = 6  # the colour of data


def fit_body(facts: Facts, variables: Facts, _: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """Values with their intervals, what the data leave, and both over time or the modes."""

    def row(path: str, each: Facts) -> list[Value]:
        interval = Cell("on its bound", "bad") if each["at_bound"] else Cell(_between(each["interval"]))
        return [path, _six(each["before"]), _six(each["value"]), each["error"], interval, Cell(raised(each["unit"]))]

    paths, columns = list(facts["parameters"]), facts["columns"]
    pairs = [[f"{paths[j]} and {path}", facts["correlation"][k][j]] for k, path in enumerate(paths) for j in range(k)]
    left = [[name, each["noise"], Cell(raised(each["unit"]))] for name, each in columns.items()]
    drawn = _data(columns, variables, plots)
    return "".join(
        [
            heading("Values"),
            table(
                ("value", "was", "is", "one sigma", "95 %", "unit"),
                (row(*each) for each in facts["parameters"].items()),
                f"fitted to {facts['data']}",
                words=(0, 4, 5),
            ),
            table(("correlation of the errors of", ""), pairs),
            table(("column", "standard deviation of the residual", "unit"), left, words=(0, 2)),
            _searches(facts),
            heading("Data and fit") + plot_places(drawn) if drawn else "",
        ]
    )


def _data(columns: Facts, variables: Facts, plots: Plots) -> list[tuple[str, str]]:
    """Plots of each column and of its residual; none without the arrays of a file."""
    if "measured" not in variables:
        return []
    axis = "time, s" if "time" in variables else "mode"
    at = variables[axis.partition(",")[0]]
    drawn = []
    for k, (name, each) in enumerate(columns.items()):
        before, fitted, measured = (variables[key][k] for key in ("computed_before", "fitted", "measured"))
        label = _labelled(name, each["unit"])
        lines = [
            {"label": "scenario as it was", "x": at, "y": before, "colour": 5},
            {"label": "measured", "x": at, "y": measured, "colour": _REFERENCE, "points": True},
            {"label": "fitted", "x": at, "y": fitted, "colour": 0},
        ]
        rest = {"label": "measured less fitted", "x": at, "y": measured - fitted, "colour": _REFERENCE, "points": True}
        drawn.append((plots.add(name, label, lines, x=axis), name))
        drawn.append((plots.add(f"{name}: residual", label, [rest], x=axis), f"{name}: measured less fitted"))
    return drawn


def optimum_body(facts: Facts, variables: Facts, _: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """The figure before and after, the values, the requirements, and the way to them."""
    goal = facts["minimise"]
    unit = raised(goal["unit"])
    headline = f"least {goal['name']}: {number(known(goal['value']))} {unit}".rstrip()

    def row(path: str, each: Facts) -> list[Value]:
        bound = Cell("on its bound", "bad") if each["at_bound"] else Cell(_between(each["bounds"]))
        return [path, _six(each["before"]), _six(each["value"]), bound, Cell(raised(each["unit"]))]

    def requirement(each: Facts) -> list[Value]:
        state = "decides" if each["active"] else "kept"
        words = Cell(state if each["kept"] else "not kept", "good" if each["kept"] else "bad")
        return [
            each["name"],
            each["low"],
            each["high"],
            each["before"],
            each["value"],
            Cell(raised(each["unit"])),
            words,
        ]

    parts = [
        paragraph(f"{headline}, was {number(known(goal['before']))}", "verdict"),
        heading("Values"),
        table(
            ("value", "was", "is", "bounds", "unit"),
            (row(*each) for each in facts["parameters"].items()),
            words=(0, 3, 4),
        ),
        table(
            ("requirement", "at least", "at most", "was", "is", "unit", ""),
            map(requirement, facts["subject_to"]),
            words=(0, 5, 6),
        ),
        _searches(facts),
    ]
    if "history" in variables:
        line = {"label": goal["name"], "x": np.arange(len(variables["history"])), "y": variables["history"]}
        place = plots.add(goal["name"], _labelled(goal["name"], goal["unit"]), [line | {"colour": 0}], x="better try")
        parts.append(heading("Way to the optimum") + plot_places([(place, goal["name"])]))
    return "".join(parts)


def sensitivity_body(facts: Facts, variables: Facts, _: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """Of each figure the values that it depends on, those that matter most first."""
    parts = []
    for name, each in facts["measures"].items():
        value = f"{number(known(each['value']))} {raised(each['unit'])}".rstrip()
        changes = [0.01 * known(one["derivative"]) * known(one["value"]) for one in each["parameters"]]
        largest = max(map(abs, changes), default=0.0) or 1.0
        rows: list[list[Value]] = [
            [
                one["path"],
                Cell(f"{known(one['value']):.6g} {raised(one['unit'])}".rstrip()),
                Cell(_change(change, each), share=abs(change) / largest),
                one["derivative"],
                one["error"],
                Cell(" ".join([one["method"], "kink" if one["kink"] else ""]).strip()),
            ]
            for one, change in zip(each["parameters"], changes, strict=True)
        ]
        head = ("of", "value", "+1 % changes the figure by", "derivative, SI", "±", "by")
        parts += [heading(f"{name} = {value}"), table(head, rows, words=(0, 1, 5))]
    error = known(facts["run_error"])
    if np.isfinite(error):
        parts.append(paragraph(f"the run's own estimated error is {percent(error)}"))
    return "".join([*parts, listed(f"not varied: {each}" for each in facts["not_varied"])])


def shaping_body(facts: Facts, variables: Facts, _: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """What each command leaves, the commands, the tip, and what is left where the frequencies are others."""
    ((goal, size),) = facts["goal"].items()
    aim = f"to {number(size)} rad/s" if goal == "rate" else f"by {number(size)} rad"
    span = f", for frequencies wrong by up to {percent(facts['robust'])}" if facts["robust"] else ""
    unit = "N m" if facts["kind"] == "torque" else "rad/s²"
    rows = [
        [name, 1e3 * known(each["residual_amplitude"]), each["largest"], Cell(each["outcome"])]
        for name, each in facts["commands"].items()
    ]
    words = f"{facts['kind']} {aim} in {number(facts['duration'])} s, designed on {facts['design']}, run on "
    parts = [
        paragraph(f"{words}{facts['check']}{span}"),
        heading("Commands"),
        table(("command", "leaves, mm", f"largest, {unit}", "run"), rows, words=(0, 3)),
    ]
    if "command" in variables:
        parts.append(plot_places(_commands(list(facts["commands"]), facts, variables, plots)))
    return "".join(parts)


def _commands(names: list[str], facts: Facts, variables: Facts, plots: Plots) -> Iterable[tuple[str, str]]:
    def add(title: str, y: str, over: str, values: Floats, x: str) -> tuple[str, str]:
        lines = [
            {"label": name, "x": variables[over], "y": each, "colour": k}
            for k, (name, each) in enumerate(zip(names, values, strict=True))
        ]
        return plots.add(title, y, lines, x=x), title

    tip = 1e3 * variables["tip"]
    axis = int(np.nan_to_num(np.abs(tip[-1])).max(axis=0).argmax())
    yield add("Commands", f"{facts['kind']}, {raised(facts['unit'])}", "time", variables["command"], "time, s")
    yield add(f"Tip along {'xyz'[axis]}", "displacement, mm", "run_time", tip[:, :, axis], "time, s")
    robust = 1e3 * variables["by_ratio"]
    yield add("Left if all frequencies were others", "amplitude, mm", "ratio", robust, "frequencies over the design's")


def _searches(facts: Facts) -> str:
    tried, agreed = facts["starts"]["tried"], facts["starts"]["agreed"]
    words = f"{agreed} of {tried} searches end at these values; " if tried > 1 else ""
    return paragraph(f"{words}{facts['evaluations']} evaluations of the scenario")


def _change(change: float, figure: Facts) -> str:
    """The change of a figure, as a share of it where it has a unit and a size."""
    unit, size = figure["unit"], known(figure["value"])
    return percent(change / size) if unit and size else f"{number(change)} {raised(unit)}".rstrip()


def _between(ends: tuple[float, float]) -> str:
    return " to ".join(_six(each).text for each in ends)


def _six(value: float | None) -> Cell:
    """A value that is to be copied, with six digits."""
    return Cell("–" if value is None else f"{value:.6g}")


def _labelled(name: str, unit: str) -> str:
    return f"{name}, {raised(unit)}" if unit else name
