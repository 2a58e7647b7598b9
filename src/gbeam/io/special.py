"""Files of kinds that hold more than their declared fields: responses, deflections, plans and sweeps."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from gbeam.io.groups import Group, Variable, coordinate, known, known_attrs, labels, variable
from gbeam.io.layout import completed, group_of, in_files, whole_group
from gbeam.results.cases import BOUNDS, ORDERS, PROBABILITY, SAMPLE, Parameter, Sweep
from gbeam.results.equilibrium import Deflection
from gbeam.results.errors import Errors
from gbeam.results.imitation.plan import MachinePlan
from gbeam.results.machine import LimitUse
from gbeam.results.response import Response


def response_group(response: Response) -> Group:
    """Return what a file holds of a response."""
    group = whole_group(response)
    limits = {} if response.axes is None else limits_variables(response.axes.limits)
    return Group(known(group.variables) | limits, group.coordinates, group.attrs | _errors(response.errors))


def deflection_group(deflection: Deflection) -> Group:
    """Return what a file holds of a static deflection."""
    group = whole_group(deflection)
    if deflection.loads is not None:  # of one time
        loads = group_of(deflection.loads)
        carried = {name: Variable(each.dims[1:], each.values[0], each.attrs) for name, each in loads.variables.items()}
        group.variables.update(carried)
        group.coordinates.update(loads.coordinates)
    return Group(group.variables, group.coordinates, group.attrs | _errors(deflection.errors))


def _errors(errors: Errors) -> dict[str, float | str]:
    """Estimated errors, fractions."""
    named = {name: asdict(getattr(errors, name)) for name in ("displacement", "loads", "stress")}
    values = {f"error_{name}_{part}": value for name, parts in named.items() for part, value in parts.items()}
    return known_attrs({**values, "error_note": errors.note, "error_theory": errors.theory})


def plan_group(plan: MachinePlan) -> Group:
    """Return what a file holds of a plan."""
    axes, load, group = group_of(plan.axes), group_of(plan.accounting), whole_group(plan)
    # Where the target is held, and where the load is not the flight's, are two things.
    judged = {f"load_{name}" if name in axes.variables else name: each for name, each in load.variables.items()}
    variables = axes.variables | limits_variables(plan.axes.limits) | known(judged) | group.variables
    return completed(Group(variables, group.coordinates, group.attrs))


def limits_variables(uses: tuple[LimitUse, ...]) -> dict[str, Variable]:
    """Used, allowed and when, per quantity: of the three axes, and of the arm its power."""
    variables = {}
    for quantity in dict.fromkeys(use.quantity for use in uses):
        rows = [use for use in uses if use.quantity == quantity]
        unit = in_files(rows[0].unit)
        whose, dims = ("of the arm", ()) if quantity == "power" else ("of each axis of the machine", ("machine_axis",))
        columns = (np.array([getattr(use, name) for use in rows]) for name in ("used", "allowed", "time"))
        used, allowed, time = (column if dims else column[0] for column in columns)
        limit = f"limit of that {quantity}; infinite where none is given"
        variables[f"{quantity}_used"] = variable(dims, used, unit, f"largest {quantity} {whose}, without sign")
        variables[f"{quantity}_allowed"] = variable(dims, allowed, unit, limit)
        variables[f"{quantity}_time"] = variable(dims, time, "s", f"when the largest {quantity} is used")
    return variables


def sweep_group(sweep: Sweep) -> Group:
    """Return what a file holds of a sweep; what is drawn is a coordinate along ``sample``."""
    dims = sweep.dimensions
    data = {
        name: variable(dims, values, sweep.units[name] or "1", f"{sweep.verb}: {name}")
        for name, values in sweep.measures.items()
    }
    outcome = {
        "outcome": Variable(dims, sweep.outcome, {"long_name": "how the case ended"}),
        "message": Variable(dims, sweep.message, {"long_name": "why the case is not done"}),
    }
    if sweep.histories:
        along = (*dims, "time")
        data |= {
            f"{name} history": variable(along, values, sweep.units[name], f"{name} over time")
            for name, values in sweep.histories.items()
        }
    data |= _statistics(sweep)
    coordinates = {each.path: _coordinate(each) for each in sweep.parameters}
    if SAMPLE in dims:
        count = sweep.outcome.shape[-1]
        coordinates[SAMPLE] = variable((SAMPLE,), np.arange(count), "1", "number of the sample")
    if sweep.histories:
        coordinates |= coordinate("time", sweep.time, "s", "time")
    if sweep.statistics:
        coordinates |= labels("bound", BOUNDS)
    for each in sweep.statistics.values():
        if PROBABILITY not in each.names:
            coordinates |= labels("statistic", each.names)
    for shares in sweep.indices.values():
        coordinates |= labels("parameter", shares.parameters) | labels("order", ORDERS)
    return Group(data | outcome, coordinates, {"title": sweep.title, "verb": sweep.verb, "outcome": sweep.state})


def _statistics(sweep: Sweep) -> dict[str, Variable]:
    """Statistics at every point of the grid."""
    grid = tuple(name for name in sweep.dimensions if name != SAMPLE)
    variables = {}
    for name, each in sweep.statistics.items():
        dims = (*grid, "time") if name in sweep.histories else grid
        words = f"{name}: estimates with bounds of 95 % confidence"
        if PROBABILITY in each.names:
            variables[f"{name} probability"] = variable((*dims, "bound"), each[PROBABILITY], "1", words)
        else:
            unit = sweep.units[name] or "1"
            variables[f"{name} statistics"] = variable((*dims, "statistic", "bound"), each.values, unit, words)
        variables[f"{name} count"] = variable(dims, each.count, "1", f"{name}: draws that the estimates come from")
    for name, shares in sweep.indices.items():
        dims = (*grid, "parameter", "order", "bound")
        variables[f"{name} indices"] = variable(dims, shares.values, "1", f"{name}: Sobol indices")
    return variables


def _coordinate(parameter: Parameter) -> Variable:
    attrs = {"units": parameter.unit or "1"} if parameter.numeric else {}
    drawn = {"distribution": parameter.drawn} if parameter.drawn else {}
    return Variable((parameter.dimension,), parameter.values, attrs | {"long_name": parameter.path} | drawn)
