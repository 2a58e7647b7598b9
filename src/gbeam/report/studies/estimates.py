"""Statistics of one figure, in words: estimates with their bounds."""

from __future__ import annotations

import math

import numpy as np

from gbeam.report.words import columns, number
from gbeam.results.cases import PROBABILITY, Indices, Statistics, Sweep
from gbeam.results.result import Floats


def estimates(sweep: Sweep, name: str, heads: list[str]) -> list[str]:
    """Lines on one measure or history."""
    statistics, unit = sweep.statistics[name], sweep.units[name]
    title = f"{name}{f', {unit}' if unit else ''}"
    if name in sweep.histories:
        return _history(sweep.time, statistics, title)
    if heads:
        return [f"{title}:", *_over_grid(sweep, statistics, heads)]
    draws = int(statistics.count)
    lines = [f"{title}, of {draws} draws, with 95 % confidence:"]
    rows = [[each, number(float(at[0])), between(at)] for each in statistics.names for at in [statistics[each]]]
    width = max(len(each) for each in statistics.names)
    lines += [f"  {row[0]:<{width}}  {row[1]:>11}  {row[2]}" for row in rows]
    return lines + (_shares(sweep.indices[name]) if name in sweep.indices else [])


def between(bounds: Floats) -> str:
    """An interval from an estimate and its bounds, (3,): ``0.1 to 0.2``; one-sided where an end is not known."""
    low, high = (float(each) for each in bounds[1:])
    if math.isnan(low) and math.isnan(high):
        return "too few draws for a bound"
    if math.isnan(low):
        return f"below {number(high)}"
    return f"above {number(low)}" if math.isnan(high) else f"{number(low)} to {number(high)}"


def _shares(indices: Indices) -> list[str]:
    """Sobol indices, the largest in total first."""
    order = np.argsort(-indices.values[:, 1, 0])
    width = max(len(each) for each in indices.parameters)
    lines = [f"  {'share of the variance':<{width}}  {'by itself':<20}  in total"]
    for k in order:
        cells = [f"{value:.3f} ± {high - value:.3f}" for value, _, high in indices.values[k]]
        lines.append(f"  {indices.parameters[k]:<{width}}  {cells[0]:<20}  {cells[1]}")
    return lines


def _over_grid(sweep: Sweep, statistics: Statistics, heads: list[str]) -> list[str]:
    """A line for every point of the grid: mean and quantiles, or the probability."""
    grid = [each for each in sweep.parameters if not each.drawn]
    names = [each for each in statistics.names if each in ("mean", "5 %", "95 %", PROBABILITY)]
    main = names[0]
    rows = []
    for at in np.ndindex(statistics.count.shape):
        places = [each.values[i] for each, i in zip(grid, at, strict=True)]
        row = [value if isinstance(value, str) else f"{value:.6g}" for value in places]
        row += [number(float(statistics[each][at][0])) for each in names]
        row.insert(len(places) + 1, between(statistics[main][at]))
        rows.append(row)
    return columns([*heads, main, "95 % confidence", *names[1:]], rows)


def _history(time: Floats, statistics: Statistics, title: str) -> list[str]:
    """Band over time at the time at which the median is largest, at the first point of the grid."""
    values = statistics.values[(0,) * (statistics.count.ndim - 1)]
    at = [statistics.names.index(each) for each in ("5 %", "median", "95 %")]
    median = np.abs(np.nan_to_num(values[:, at[1], 0]))
    k = int(median.argmax())
    low, middle, high = (number(float(values[k, each, 0])) for each in at)
    least, most = float(values[k, at[0], 1]), float(values[k, at[2], 2])
    lines = [
        f"{title}, over time: the median is largest at {time[k]:.4g} s, {middle}",
        f"  5 % to 95 % of the cases there: {low} to {high}",
    ]
    if math.isfinite(least) and math.isfinite(most):
        lines.append(f"  nine tenths of all lie there, with 95 % confidence, within {number(least)} to {number(most)}")
    return lines
