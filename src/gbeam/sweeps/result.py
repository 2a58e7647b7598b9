"""From the rows of the cases to arrays along the parameters."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from gbeam.results.sweep import Sweep
from gbeam.scenario.schema.fields import kind_of
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.text.kinds import KINDS
from gbeam.scenario.text.paths import parse_path
from gbeam.sweeps.cases import Cases
from gbeam.sweeps.evaluate import Row


def assembled(
    title: str, verb: str, cases: Cases, example: Scenario, units: Mapping[str, str], rows: Iterable[Row]
) -> Sweep:
    """Return the result of a sweep.

    Parameters
    ----------
    title, verb : str
    cases : Cases
    example : Scenario
        Of one case, whose schema knows the SI units of what varies.
    units : mapping of str to str
        Of the measures, in the order of a row's values.
    rows : iterable of Row
        In any order; the cases without one are pending.
    """
    values = np.full((len(units), len(cases)), math.nan)
    outcome = np.full(len(cases), "pending", dtype=object)
    message = np.full(len(cases), "", dtype=object)
    for row in rows:
        values[:, row.case] = row.values
        outcome[row.case], message[row.case] = row.outcome, row.message
    shape = cases.shape
    return Sweep(
        title=title,
        verb=verb,
        parameters=tuple(each.parameter(_unit(example, each.path)) for each in cases.variations),
        measures={name: values[k].reshape(shape) for k, name in enumerate(units)},
        units=dict(units),
        outcome=outcome.reshape(shape),
        message=message.reshape(shape),
    )


def _unit(scenario: Scenario, path: str) -> str:
    """SI unit of what stands at a path; empty for what has none."""
    *above, key = parse_path(path) or ("",)
    node: Any = scenario
    for step in above:
        node = node[step] if isinstance(step, int) or isinstance(node, Mapping) else getattr(node, step, None)
    kind = kind_of(node, key) if isinstance(key, str) and hasattr(type(node), "model_fields") else ""
    return KINDS[kind].unit if kind else ""
