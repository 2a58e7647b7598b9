"""The figures of any result that has a report, as its verb prints them with ``--json``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from gbeam.report.machine import placement, plan
from gbeam.report.steady import critical, deflection
from gbeam.report.studies import fit, optimum, sensitivity, shaping, sweep
from gbeam.report.study import summary_json
from gbeam.report.words import as_json
from gbeam.results.cases import Sensitivity, Sweep
from gbeam.results.declared import json_of
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.imitation.placement import Placement
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.modal import Campbell, Modes
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.searches import Fit, Optimum, ShapedCommand
from gbeam.results.study import Study

_JSON: dict[type, Callable[[Any], dict[str, Any]]] = {
    Study: summary_json.to_json,
    Deflection: lambda result: deflection.to_json("", [result]),
    MachinePlan: lambda result: plan.to_json("", [result]),
    Critical: critical.to_json,
    CriticalMap: json_of,
    Modes: json_of,
    Campbell: json_of,
    Placement: placement.to_json,
    Sweep: sweep.to_json,
    Fit: fit.to_json,
    Optimum: optimum.to_json,
    Sensitivity: sensitivity.to_json,
    ShapedCommand: shaping.to_json,
}


def whole(result: Result) -> Result:
    """The same result, a response alone as a study of one; what is listed by its motion has a name."""
    match result:
        case Response():
            name = result.name or result.environment
            return Study("", {name: result}, (), warnings=(), provenance=result.provenance)
        case Deflection(motion=""):
            return replace(result, motion="beam")
        case MachinePlan(name=""):
            return replace(result, name="centrifuge")
        case _:
            return result


def facts(result: Result) -> dict[str, Any] | None:
    """Return the figures of a result; None where it is of a kind without a report."""
    result = whole(result)
    made = _JSON.get(type(result))
    return None if made is None else made(result)


def facts_text(result: Result) -> str:
    """Return the same as JSON; empty where there is none."""
    found = facts(result)
    return "" if found is None else as_json(found)
