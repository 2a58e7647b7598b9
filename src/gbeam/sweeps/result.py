"""From the rows of the cases to arrays along the parameters."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.results.studies.sweep import Sweep
from gbeam.scenario.schema.common.fields import kind_of
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.values.kinds import KINDS
from gbeam.scenario.values.paths import parse_path
from gbeam.sweeps.cases import Cases
from gbeam.sweeps.computing.evaluate import Row
from gbeam.sweeps.figures.statistics import indices, statistics
from gbeam.sweeps.start import Start


def assembled(title: str, cases: Cases, names: Sequence[str], begun: Start, rows: Iterable[Row], seed: int) -> Sweep:
    """Return the result of a sweep.

    Parameters
    ----------
    title : str
    cases : Cases
    names : sequence of str
        Of the measures, in the order of a row's values.
    begun : Start
        With a scenario whose schema knows the SI units of what varies.
    rows : iterable of Row
        In any order; the cases without one are pending.
    seed : int
        Of what is drawn, and of the bootstrap of Sobol indices.
    """
    question = begun.question
    values = np.full((question.width, len(cases)), math.nan)
    outcome = np.full(len(cases), "pending", dtype=object)
    message = np.full(len(cases), "", dtype=object)
    for row in rows:
        values[:, row.case] = row.values
        outcome[row.case], message[row.case] = row.outcome, row.message
    shape, times = cases.shape, len(question.times)
    measures = {name: values[k].reshape(shape) for k, name in enumerate(names)}
    over_time = values[len(names) :].reshape(len(question.histories), times, *shape)
    histories = {each.name: np.moveaxis(over_time[k], 0, -1) for k, each in enumerate(question.histories)}
    found = Sweep(
        title=title,
        verb=question.verb,
        parameters=tuple(each.parameter(_unit(begun.example, each.path)) for each in cases.variations),
        measures=measures,
        units=dict(zip(names, begun.units, strict=True)) | {each.name: each.unit for each in question.histories},
        outcome=outcome.reshape(shape),
        message=message.reshape(shape),
        histories=histories,
        time=question.times,
    )
    return with_statistics(found, cases, dict(zip(names, begun.truths, strict=True)), seed) if cases.drawn else found


def with_statistics(sweep: Sweep, cases: Cases, truths: Mapping[str, bool], seed: int) -> Sweep:
    """The same with what its samples say; they are the last dimension of the measures."""
    first = slice(cases.independent)
    # A figure of a case that was cut off, such as the peak until it diverged, is none of the answer.
    done = sweep.computed
    measures = {name: np.where(done, values, math.nan) for name, values in sweep.measures.items()}
    histories = {name: np.where(done[..., None], values, math.nan) for name, values in sweep.histories.items()}
    known = {name: statistics(values[..., first], truth=truths[name]) for name, values in measures.items()}
    known |= {name: statistics(np.swapaxes(values[..., first, :], -1, -2)) for name, values in histories.items()}
    shares = {}
    if cases.sampler == "saltelli":
        paths = [each.path for each in cases.drawn]
        shares = {name: indices(values, paths, seed) for name, values in measures.items()}
    return replace(sweep, statistics=known, indices=shares)


def _unit(scenario: Scenario, path: str) -> str:
    """SI unit of what stands at a path; empty for what has none."""
    *above, key = parse_path(path) or ("",)
    node: Any = scenario
    for step in above:
        node = node[step] if isinstance(step, int) or isinstance(node, Mapping) else getattr(node, step, None)
    kind = kind_of(node, key) if isinstance(key, str) and hasattr(type(node), "model_fields") else ""
    return KINDS[kind].unit if kind else ""
