"""The pages of studies: a fit, an optimum, sensitivities, a shaped command, a sweep."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.figures.description import raised
from gbeam.report.page.parts import Cell, Value, heading, known, listed, paragraph, section, table
from gbeam.report.words import number, percent
from gbeam.results.cases import BOUNDS
from gbeam.results.searches import COMMANDS, GOALS

Facts = Mapping[str, Any]


def fit_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Values with their intervals, what the data leave, and both over time or the modes."""

    def row(path: str, each: Facts) -> list[Value]:
        interval = Cell("on its bound", "bad") if each["at_bound"] else Cell(_between(each["interval"]))
        return [path, _six(each["before"]), _six(each["value"]), each["error"], interval, Cell(raised(each["unit"]))]

    paths, columns = list(facts["parameters"]), facts["columns"]
    pairs = [[f"{paths[j]} and {path}", facts["correlation"][k][j]] for k, path in enumerate(paths) for j in range(k)]
    left = [[name, each["noise"], Cell(raised(each["unit"]))] for name, each in columns.items()]
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
            section("Data and fit", drawn),
        ]
    )


def optimum_body(facts: Facts, viewer: str, drawn: str) -> str:
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
    return "".join([*parts, section("Way to the optimum", drawn)])


def sensitivity_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Values that each figure depends on, the strongest first."""
    parts = []
    for name, each in facts["measures"].items():
        value = f"{number(known(each['value']))} {raised(each['unit'])}".rstrip()
        rows: list[list[Value]] = [
            [
                one["path"],
                Cell(f"{known(one['value']):.6g} {raised(one['unit'])}".rstrip()),
                Cell(_change(0.01 * known(one["derivative"]) * known(one["value"]), each)),
                one["derivative"],
                one["error"],
                Cell(" ".join([one["method"], "kink" if one["kink"] else ""]).strip()),
            ]
            for one in each["parameters"]
        ]
        head = ("of", "value", "+1 % changes the figure by", "derivative, SI", "±", "by")
        parts += [heading(f"{name} = {value}"), table(head, rows, words=(0, 1, 5))]
    error = known(facts["run_error"])
    if np.isfinite(error):
        parts.append(paragraph(f"the run's own estimated error is {percent(error)}"))
    return "".join([*parts, drawn, listed(f"not varied: {each}" for each in facts["not_varied"])])


def shaping_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Vibration that each command leaves, also where the frequencies are others, the commands, and the tip."""
    ((goal, size),) = facts["goal"].items()
    span = f", for frequencies wrong by up to {percent(facts['robust'])}" if facts["robust"] else ""
    unit = raised(COMMANDS[facts["kind"]][1])
    rows = [
        [name, 1e3 * known(each["residual_amplitude"]), each["largest"], Cell(each["outcome"])]
        for name, each in facts["commands"].items()
    ]
    words = f"{facts['kind']} {GOALS[goal].format(size)} in {number(facts['duration'])} s"
    parts = [
        paragraph(f"{words}, designed on {facts['design']}, run on {facts['check']}{span}"),
        heading("Commands"),
        table(("command", "leaves, mm", f"largest, {unit}", "run"), rows, words=(0, 3)),
    ]
    return "".join([*parts, drawn])


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


_CASES = 400  # listed


def sweep_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Counts of outcomes, a plot or a map of each measure, and every case."""
    counts = ", ".join(f"{count} {name}" for name, count in facts["counts"].items())
    outcomes = np.array(facts["outcomes"], dtype=object)
    kind = "" if facts["outcome"] == "done" else "bad"
    parts = [paragraph(f"figures of gbeam {facts['verb']}: {outcomes.size} cases: {counts}", kind), _varied(facts)]
    parts += [_estimates(facts)]
    values = {name: np.array(each["values"], dtype=float) for name, each in facts["measures"].items()}
    return "".join(
        [
            *parts,
            section("Figures", drawn),
            heading("Cases"),
            _cases(facts, values, outcomes),
            _failures(facts, outcomes),
        ]
    )


def _estimates(facts: Facts) -> str:
    """Statistics of each measure, where no grid makes many of it, with bounds of 95 % confidence."""
    rows: list[list[Value]] = []
    for name, estimates in facts["statistics"].items():
        if name in facts["measures"] and isinstance(estimates["draws"], int):
            label = _labelled(name, facts["measures"][name]["unit"])
            named = {each: bounds for each, bounds in estimates.items() if each != "draws"}
            rows += [[label, each, *(bounds[bound] for bound in BOUNDS)] for each, bounds in named.items()]
            shares = facts["indices"].get(name, {})
            rows += [
                [label, f"share of the variance, {order}: {path}", *(each[order][bound] for bound in BOUNDS)]
                for path, each in shares.items()
                for order in each
            ]
    return table(("measure", "estimate of", *BOUNDS), rows, "bounds of 95 % confidence", words=(0, 1)) if rows else ""


def _varied(facts: Facts) -> str:
    rows = [
        [each["path"], each["unit"], each["distribution"] or f"{len(each['values'])} values, {_ends(each['values'])}"]
        for each in facts["parameters"]
    ]
    return table(("varies", "unit", "values"), rows, words=(0, 1, 2))


def _cases(facts: Facts, values: Mapping[str, Any], outcomes: Any) -> str:
    parameters, dimensions = facts["parameters"], facts["dimensions"]
    rows: list[list[Value]] = []
    for at in np.ndindex(outcomes.shape):
        place = dict(zip(dimensions, at, strict=True))
        coordinates = [each["values"][place["sample" if each["distribution"] else each["path"]]] for each in parameters]
        done = outcomes[at] == "done"
        figures = [float(each[at]) for each in values.values()]
        rows.append([*map(_tick, coordinates), *figures, Cell(str(outcomes[at]), "" if done else "bad")])
        if len(rows) == _CASES:
            break
    head = [_labelled(each["path"], each["unit"]) for each in parameters]
    head += [_labelled(name, facts["measures"][name]["unit"]) for name in values]
    more = f"the first {_CASES} of {outcomes.size}" if outcomes.size > _CASES else ""
    return table([*head, "outcome"], rows, more, words=(len(head),))


def _failures(facts: Facts, outcomes: Any) -> str:
    messages = np.array(facts["messages"], dtype=object).ravel()
    lost = {f"{outcome}: {said}": None for outcome, said in zip(outcomes.ravel(), messages, strict=True) if said}
    return listed(list(lost)[:10], "bad")


def _labelled(name: str, unit: str) -> str:
    return f"{name}, {unit}" if unit else name


def _tick(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (int, float)) else str(value)


def _ends(values: list[Any]) -> str:
    return f"{_tick(values[0])} to {_tick(values[-1])}" if len(values) > 3 else ", ".join(map(_tick, values))
