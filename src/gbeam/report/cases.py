"""Report of a sweep: its cases, or their statistics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from gbeam.printable import raised
from gbeam.report.blocks import (
    FIGURES,
    Block,
    Blocks,
    Cell,
    Columns,
    Facts,
    Items,
    Section,
    Sentence,
    name_rows,
    six,
    table,
)
from gbeam.report.words import float_of, number
from gbeam.results.cases import ANSWERED, BOUNDS, PROBABILITY

_FEW = 40  # cases that are all listed at once
_LISTED = 400  # on a page
_FAILURES = 5  # that are named


def sweep(facts: Facts) -> Blocks:
    """Report of a sweep: few cases one by one, else quantiles; statistics of random draws; and how cases ended."""
    outcomes = np.array(facts["outcomes"], dtype=object)
    few = not facts["statistics"] and outcomes.size <= _FEW
    yield table(
        facts["parameters"],
        {
            "varies": "path",
            "unit": lambda parameter: raised(parameter["unit"]),
            "values": lambda parameter: parameter["distribution"] or _ends(parameter["values"]),
        },
        f"figures of gbeam {facts['verb']}",
        detail=True,
    )
    if facts["statistics"]:
        blocks: list[Block] = []
        for name in facts["statistics"]:
            blocks += _estimates(facts, name)
        yield Section("", tuple(blocks))
    elif facts["measures"]:
        yield Section("", (_cases(facts, outcomes) if few else _quantiles(facts["measures"]),))
    yield Section("", tuple(_outcome_blocks(facts, outcomes)))
    yield Section("Figures", (FIGURES,))
    if not few:
        yield Section("Cases", (_cases(facts, outcomes),))


def _outcome_blocks(facts: Facts, outcomes: Any) -> Blocks:
    """Number of cases by outcome, and the messages of cases that are not done, each with the number of its cases."""
    failed = int((~np.isin(outcomes.astype(str), ("done", *ANSWERED))).sum())
    if facts["statistics"] and failed:
        yield Sentence(f"{failed} of {outcomes.size} cases are not done: the estimates are of the others")
    counts = ", ".join(f"{count} {name}" for name, count in facts["counts"].items())
    yield Sentence(f"{outcomes.size} cases: {counts}", "bad" if failed else "")
    counts_of: dict[str, int] = {}
    for outcome, message in zip(outcomes.ravel(), np.array(facts["messages"], dtype=object).ravel(), strict=True):
        if outcome != "done":
            words = f"{outcome}: {message}" if message else outcome
            counts_of[words] = counts_of.get(words, 0) + 1
    lines = [f"{count} × {words}" for words, count in list(counts_of.items())[:_FAILURES]]
    yield Items((*lines, *(["…"] if len(counts_of) > _FAILURES else [])), "bad")


def _with_unit(name: str, unit: str) -> str:
    return f"{name}, {raised(unit)}" if unit else name


def _ends(values: list[Any]) -> str:
    texts = [six(value).text for value in values]
    words = f"{texts[0]} to {texts[-1]}" if len(values) > 3 else ", ".join(texts)
    return f"{len(values)} values, {words}"


def _cases(facts: Facts, outcomes: Any) -> Block:
    """Table of the parameters and figures of every case, with its outcome unless all are done."""

    parameters, measures = facts["parameters"], facts["measures"]
    # The dimension along which each parameter varies: random ones vary together.
    axes = [facts["dimensions"].index("sample" if row["distribution"] else row["path"]) for row in parameters]
    figures = [np.array(measure["values"], dtype=float) for measure in measures.values()]

    def case(place: tuple[int, ...]) -> list[Cell]:
        outcome = Cell(outcomes[place], "" if outcomes[place] == "done" else "bad")
        values = (row["values"][place[axis]] for row, axis in zip(parameters, axes, strict=True))
        return [*map(six, values), *(Cell(number(figure[place])) for figure in figures), outcome]

    heads = [_with_unit(row["path"], row["unit"]) for row in parameters]
    heads += [_with_unit(name, measure["unit"]) for name, measure in measures.items()]
    heads += [] if facts["outcome"] == "done" else ["outcome"]
    places = list(np.ndindex(outcomes.shape))
    caption = f"the first {_LISTED} of {len(places)}" if len(places) > _LISTED else ""
    detail = len(places) > _FEW or bool(facts["statistics"])
    return table(map(case, places[:_LISTED]), {head: str(k) for k, head in enumerate(heads)}, caption, detail=detail)


def _quantiles(measures: Facts) -> Block:
    """Table of the extremes, mean, quantiles and standard deviation of each measure, over the cases that have it."""
    summaries: dict[str, Any] = {
        "least": np.min,
        "5 %": lambda v: np.quantile(v, 0.05),
        "median": np.median,
        "mean": np.mean,
        "95 %": lambda v: np.quantile(v, 0.95),
        "largest": np.max,
        "standard deviation": lambda v: np.std(v, ddof=1) if len(v) > 1 else np.nan,
    }

    values = [np.array(measure["values"], dtype=float) for measure in measures.values()]
    finite = [array[np.isfinite(array)] for array in values]
    rows = []
    for name, summary in summaries.items():
        rows.append([name, *(number(summary(array)) if len(array) else "–" for array in finite)])
    heads = ["", *(_with_unit(name, measure["unit"]) for name, measure in measures.items())]
    return table(rows, {head: str(k) for k, head in enumerate(heads)})


def _estimates(facts: Facts, name: str) -> Blocks:
    """Tables of the statistics of one measure or history, with their intervals of 95 % confidence."""
    estimates, history = facts["statistics"][name], name in facts["histories"]
    title = _with_unit(name, facts["histories" if history else "measures"][name]["unit"])
    if history:
        yield _history(facts["time"], estimates, title)
    elif isinstance(estimates["draws"], int):
        rows = [
            (statistic, number(float_of(bounds["estimate"])), _interval_words(bounds))
            for statistic, bounds in estimates.items()
            if statistic != "draws"
        ]
        columns = {"": "0", " ": "1", "  ": "2"}
        yield table(rows, columns, f"{title}, of {estimates['draws']} draws, with 95 % confidence")
        if name in facts["indices"]:
            yield _sobol_table(facts["indices"][name])
    else:
        yield _over_grid(facts, estimates, title)


def _interval_words(bounds: Facts) -> str:
    """Interval in words, ``0.1 to 0.2``; one-sided where an end is not known."""
    low, high = (float_of(bounds[end]) for end in ("low", "high"))
    if math.isnan(low) and math.isnan(high):
        return "too few draws for a bound"
    if math.isnan(low):
        return f"below {number(high)}"
    return f"above {number(low)}" if math.isnan(high) else f"{number(low)} to {number(high)}"


def _sobol_table(indices: Facts) -> Block:
    """Table of Sobol indices, the largest in total first."""

    def bounded(bounds: Facts) -> str:
        return f"{float_of(bounds['estimate']):.3f} ± {float_of(bounds['high']) - float_of(bounds['estimate']):.3f}"

    columns: Columns = {
        "share of the variance": "name",
        "by itself": lambda row: bounded(row["first"]),
        "in total": lambda row: bounded(row["total"]),
    }
    return table(sorted(name_rows(indices), key=lambda row: -float_of(row["total"]["estimate"])), columns)


def _over_grid(facts: Facts, estimates: Facts, title: str) -> Block:
    """Table with a row for each point of the grid: the first statistic with its 95 % interval, then the others."""
    grid = [parameter for parameter in facts["parameters"] if not parameter["distribution"]]
    names = [name for name in estimates if name in ("mean", "5 %", "95 %", PROBABILITY)]
    values = [np.array(estimates[name]["estimate"], dtype=float) for name in names]
    bounds = {bound: np.array(estimates[names[0]][bound], dtype=float) for bound in BOUNDS}

    def row(place: tuple[int, ...]) -> list[Cell]:
        point = [six(parameter["values"][k]) for parameter, k in zip(grid, place, strict=True)]
        first, *further_cells = [Cell(number(array[place])) for array in values]
        interval = _interval_words({bound: array[place] for bound, array in bounds.items()})
        return [*point, first, Cell(interval), *further_cells]

    point_heads = [_with_unit(parameter["path"], parameter["unit"]) for parameter in grid]
    heads = [*point_heads, names[0], "95 % confidence", *names[1:]]
    places = np.ndindex(values[0].shape)
    return table(map(row, places), {head: str(k) for k, head in enumerate(heads)}, title)


def _history(time: list[float], estimates: Facts, title: str) -> Block:
    """Quantiles of a history at the time when its median is largest in size, at the first point of the grid."""

    def over_time(name: str, bound: str) -> Any:
        values = np.array(estimates[name][bound], dtype=float)
        return values[(0,) * (values.ndim - 1)]

    median = over_time("median", "estimate")
    k = int(np.abs(np.nan_to_num(median)).argmax())
    low, high = (number(float(over_time(name, "estimate")[k])) for name in ("5 %", "95 %"))
    least, most = float(over_time("5 %", "low")[k]), float(over_time("95 %", "high")[k])
    lines = [f"5 % to 95 % of the cases there: {low} to {high}"]
    if math.isfinite(least) and math.isfinite(most):
        lines.append(f"nine tenths of all lie there, with 95 % confidence, within {number(least)} to {number(most)}")
    words = f"{title}, over time: the median is largest at {time[k]:.4g} s, {number(float(median[k]))}"
    return Section(words, (Items(tuple(lines)),), titled=True)
