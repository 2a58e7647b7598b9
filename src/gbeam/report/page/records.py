"""Results read back from JSON and the variables of a file, as far as their figures and the viewer need them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from types import NoneType
from typing import Any, TypeVar, get_origin

import numpy as np

from gbeam.figures.registry import Describe, figures_of
from gbeam.io.layout import SHARED, name_of, pattern_of
from gbeam.report.page.parts import variables_under
from gbeam.results.cases import BOUNDS, ORDERS, Indices, Parameter, Sensitivity, Statistics, Sweep
from gbeam.results.comparison import Comparison, MachinePlan
from gbeam.results.declared import INSIDE, NAMES, Declaration, annotation, declarations, record_in, types_in
from gbeam.results.equilibrium import BodyRest, Critical
from gbeam.results.machine import AxesResult
from gbeam.results.measures import Shock
from gbeam.results.modal import Campbell, Modes
from gbeam.results.parts import Loads
from gbeam.results.response import Response
from gbeam.results.result import Figured, Floats, Result
from gbeam.results.searches import CommandRun, Fit, FittedColumn, ShapedCommand
from gbeam.results.study import KINDS, Study

Facts = Mapping[str, Any]
_NONE = np.empty(0)
_R = TypeVar("_R")
# By kind: a variable without which there are no histories.
_NEEDED = {
    "Comparison": "time",
    "Fit": "measured",
    "MachinePlan": "time",
    "Optimum": "history",
    "ShapedCommand": "command",
    "SolidStress": "von_mises",
    "SpecimenLoads": "acceleration",
}


def figures_in(kind: str, facts: Facts, variables: Facts) -> dict[str, Describe]:
    """Return the functions that describe the figures of a stored result, by the figures' names.

    `variables` are those of its file. There are none if the file lacks a variable that the figures need.
    """
    record, needed = KINDS.get(kind, Result), _NEEDED.get(kind)
    if not issubclass(record, Figured):
        return {}
    if record is Study:
        study = _study(facts, variables)
        return figures_of(study) if study.responses else {}
    if record.listed_by:
        answers = []
        for name, answer in facts["motions"].items():
            v = variables_under(f"motions/{name}/", variables)
            if needed is None or needed in v:
                answers.append(read(record, answer, v, **{record.listed_by: name}))
        return figures_of(tuple(answers))
    if needed is not None and needed not in variables:
        return {}
    return figures_of(read(record, facts, variables))


def read(kind: type[_R], facts: Facts, v: Facts | None = None, pattern: str = "*", /, **more: Any) -> _R:
    """Return a record. Each field is taken from `more`, else from the variables `v` of a file, else from JSON.

    Only fields that no figure reads may be missing in all of these. They are left empty. Variables of a record within
    another have the `pattern` of :func:`gbeam.io.layout.group_of`.
    """
    by_name = {field.name: field for field in fields(kind)}  # type: ignore[arg-type]
    more = {**_APART.get(kind, _plainly)(facts, v or {}), **more}
    sizes: dict[str, int] = {}
    for name, declaration in declarations(kind):
        if name in more or name not in by_name:
            continue
        value = None if declaration.name is None or not v else _stored_value(kind, name, declaration, facts, v, pattern)
        if value is not None and declaration.role == "variable":
            sizes |= dict(zip(declaration.dims, np.shape(value), strict=False))
        if value is None:
            value = _value(kind, name, declaration, facts)
        if value is not None:
            more[name] = value
    for name, declaration in declarations(kind):
        if name in by_name and name not in more and _is_needed(by_name[name]):
            # A file has no variable of which no value is known.
            sized = declaration.role == "variable" and declaration.dims and set(declaration.dims) <= sizes.keys()
            more[name] = np.full([sizes[dim] for dim in declaration.dims], np.nan) if sized else _NONE
    return kind(**more)


def _plainly(facts: Facts, v: Facts) -> Facts:
    """Return no fields: all are read by their declarations."""
    return {}


def _is_needed(field: Any) -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _stored_value(kind: type, name: str, declaration: Declaration, facts: Facts, v: Facts, pattern: str) -> Any:
    """Value of a field from the variables of a file, or None if the file does not have it.

    A field may be a record or rows of records, a complex variable stored in two parts, a plain variable or coordinate,
    or two ends.
    """
    variable, key = name_of(name, declaration, pattern), declaration.key
    inner = record_in(kind, name) if declaration.role in ("part", "rows") else None
    if inner is not None:
        inner_facts: Any = None
        if key is not None:
            inner_facts = facts if key == INSIDE else _lookup(facts, key or name)
        inner_pattern = pattern_of(declaration, pattern)
        if declaration.role == "part" and _has(inner, v, inner_pattern):
            return read(inner, inner_facts or {}, v, inner_pattern)
        if declaration.role == "rows" and isinstance(inner_facts, dict):
            shared = {name: v[name] for name in SHARED if name in v}
            rows = inner_facts.items()
            return {row: read(inner, row_facts, shared | variables_under(f"{row}_", v)) for row, row_facts in rows}
    elif f"{variable}_real" in v:
        return v[f"{variable}_real"] + 1j * v[f"{variable}_imag"]
    elif declaration.role == "coordinate" or (declaration.role == "variable" and variable in v):
        value = v.get(declaration.dims[-1] if declaration.role == "coordinate" else variable)
        if value is None or isinstance(value, str):
            return value
        value = value.astype(bool) if declaration.flags else value
        return value if value.ndim else value.item()
    elif declaration.dims[-1:] == ("ends",) and f"{variable}_from" in v:
        return float(v[f"{variable}_from"]), float(v[f"{variable}_to"])
    return None


def _has(kind: type, v: Facts, pattern: str) -> bool:
    """True if a file has any of the variables that a record needs."""
    by_name = {field.name: field for field in fields(kind)}
    for name, declaration in declarations(kind):
        if name not in by_name or not _is_needed(by_name[name]) or declaration.name is None:
            continue
        inner = record_in(kind, name) if declaration.role == "part" else None
        if _has(inner, v, pattern_of(declaration, pattern)) if inner else name_of(name, declaration, pattern) in v:
            return True
    return False


def _value(kind: type, name: str, declaration: Declaration, facts: Facts) -> Any:
    """Value of a field in JSON, in the rows of a dimension or at its key, or None where it is not there."""
    value = _at_key(kind, name, declaration, facts, declaration.key or name)
    if value is None or np.complex128 not in types_in(annotation(kind, name)):
        return value
    return value + 1j * _at_key(kind, name, declaration, facts, f"{declaration.key or name}_imaginary")


def _at_key(kind: type, name: str, declaration: Declaration, facts: Facts, key: str) -> Any:
    """Value of a field from JSON, at a key. A complex field has one key each for its real and imaginary parts.

    A field whose dimension is that of rows in JSON is gathered from these rows.
    """
    hint = annotation(kind, name)
    row_keys: dict[str, str] = {} if key.startswith("/") else getattr(kind, "json_rows", {})
    row_dim = next((dim for dim in declaration.dims if dim in row_keys), None)
    rows: Any = [] if row_dim is None else facts.get(row_keys[row_dim], [])
    if declaration.role == "labels" and row_dim is not None:
        rows = rows if row_keys[row_dim] else facts
        return tuple(rows) if isinstance(rows, dict) else _words(rows, key)
    if declaration.key is None or (key == INSIDE and NoneType in types_in(hint)):
        return None
    inner = record_in(kind, name) if declaration.role in ("part", "rows") else None
    if row_dim is not None:
        row_list = rows if isinstance(rows, list) else [rows[place] for place in NAMES.get(row_dim, rows)]
        cells = [_lookup(row, key) for row in row_list]
        if inner is not None:  # such as errors: of a record of arrays, what the rows have
            names: Facts = next((cell for cell in cells if cell), {})
            return read(inner, {part: [cell[part] for cell in cells] for part in names}) if names else None
        if any(get_origin(kind_of_value) is tuple for kind_of_value in types_in(hint)):
            return tuple(cells)
        if len(declaration.dims) > 1 and all(cell is None for cell in cells):
            return None
        arrays = [_record_value(np.nan if cell is None else cell, hint, declaration) for cell in cells]
        return np.stack(arrays, declaration.dims.index(row_dim)) if arrays else None
    value: Any = facts if key == INSIDE else _lookup(facts, key)
    if inner is None or value is None:
        return _record_value(value, hint, declaration)
    if declaration.role == "part":
        return read(inner, value)
    if isinstance(value, dict):
        return {str(row): read(inner, row_facts) for row, row_facts in value.items()}
    return tuple(read(inner, row) for row in value)


def _lookup(facts: Any, key: str) -> Any:
    for word in key.removeprefix("/").split("."):
        facts = facts.get(word) if isinstance(facts, dict) else None
    return facts


def _record_value(value: Any, hint: Any, declaration: Declaration) -> Any:
    """Value of JSON in the form that a record has: arrays for lists, vectors for components, NaN for null."""
    if isinstance(value, dict) and declaration.dims[-1:] and declaration.dims[-1] in NAMES:
        return _vectors(value)
    if value is not None and not {np.float64, np.complex128}.isdisjoint(types_in(hint)):
        return _array(value)
    if isinstance(value, list):
        return tuple(value)
    return np.nan if value is None and hint is float else value


def _array(values: Any) -> Floats:
    """Numbers of JSON, NaN for null."""
    return np.array(values, dtype=float)


def _column(rows: Any, key: str) -> Floats:
    return _array([row.get(key) for row in rows])


def _words(rows: Any, key: str) -> tuple[str, ...]:
    return tuple(row[key] for row in rows)


def _vectors(values: Facts) -> Floats:
    return np.stack([_array(component) for component in values.values()], axis=-1)


def _study(facts: Facts, variables: Facts) -> Study:
    """Study of the responses in all motions that the file has, and their comparisons."""
    responses: dict[str, Any] = {}
    comparisons = []
    for name, entry in facts["motions"].items():
        v = variables_under(f"motions/{name}/", variables)
        if "time" in v:
            responses[name] = read(Response, entry, v)
    for entry in facts["comparisons"]:
        v = variables_under(f"comparisons/{entry['centrifuge']}/", variables)
        if "time" in v and entry["flight"] in responses:
            comparisons.append(read(Comparison, entry, v))
    return Study("", responses, tuple(comparisons))


def _at_rest(loads: Facts) -> Loads:
    """Loads of one time, from their JSON."""
    v: dict[str, Any] = {key: _vectors(loads[key])[None] for key in ("section_force", "section_moment")}
    v |= {key: _array(loads[key])[None] for key in ("stress_tension", "stress_compression")}
    return read(Loads, loads, v)


def _axes(facts: Facts, _: Facts) -> Facts:
    return {
        "episodes": tuple((episode["start"], episode["end"], episode["reason"]) for episode in facts["not_followed"])
    }


def _eigenvalues(facts: Facts, _: Facts) -> Facts:
    """Eigenvalues of modes, by their frequencies and damping ratios."""
    ratio, size = (_column(facts["modes"], key) for key in ("damping_ratio", "frequency"))
    return {"eigenvalue": 2 * np.pi * size * (-ratio + 1j * np.sqrt(1 - ratio**2))}


def _campbell(facts: Facts, _: Facts) -> Facts:
    value = facts["critical_speed"]
    return {"critical": None if value is None else read(Critical, {"kind": "equilibrium lost"}, value=value)}


def _sensitivity(facts: Facts, _: Facts) -> Facts:
    """Fields of a Sensitivity: derivatives (measures, parameters), parameters as in the first measure."""
    measures = facts["measures"].values()
    rows = {row["path"]: row for row in next(iter(measures))["parameters"]}
    derivatives = []
    for measure in measures:
        by_path = {row["path"]: row["derivative"] for row in measure["parameters"]}
        derivatives.append([by_path[path] for path in rows])
    return {
        "measures": tuple(facts["measures"]), "units": _words(measures, "unit"), "figures": _column(measures, "value"),
        "parameters": tuple(rows), "parameter_units": _words(rows.values(), "unit"),
        "values": _column(rows.values(), "value"), "derivatives": _array(derivatives),
    }  # fmt: skip


def _sweep(facts: Facts, variables: Facts) -> Facts:
    """Fields of a Sweep. Its histories come from the file's variables, all others from JSON."""
    measures, histories = facts.get("measures", {}), facts.get("histories", {})
    quantities = {**measures, **histories}
    parameters = [
        Parameter(row["path"], np.array(row["values"]), row["unit"], row["distribution"] or "")
        for row in facts["parameters"]
    ]
    return {
        "parameters": tuple(parameters), "outcome": np.array(facts["outcomes"], dtype=object),
        "message": np.array(facts["messages"], dtype=object), "time": _array(facts.get("time", [])),
        "measures": {name: _array(measure["values"]) for name, measure in measures.items()},
        "units": {name: quantity["unit"] for name, quantity in quantities.items()},
        "histories": {name: variables[f"{name} history"] for name in histories if f"{name} history" in variables},
        "statistics": {name: _statistics(bounds) for name, bounds in facts["statistics"].items()},
        "indices": {name: _indices(shares) for name, shares in facts["indices"].items()},
    }  # fmt: skip


def _bounds(facts: Facts) -> Floats:
    """Estimate, low and high along the last dimension."""
    return np.stack([_array(facts[bound]) for bound in BOUNDS], axis=-1)


def _statistics(facts: Facts) -> Statistics:
    names = tuple(name for name in facts if name != "draws")
    values = np.stack([_bounds(facts[name]) for name in names], axis=-2)
    return read(Statistics, {}, names=names, values=values)


def _indices(facts: Facts) -> Indices:
    values = []
    for shares in facts.values():
        values.append(np.stack([_bounds(shares[order]) for order in ORDERS], axis=-2))
    return read(Indices, {}, parameters=tuple(facts), values=np.stack(values, axis=-3))


def _fit(facts: Facts, v: Facts) -> Facts:
    """Fields of a Fit. The columns' values and their abscissa, time or mode, come from the file's variables."""
    abscissa = "time" if "time" in v else "mode"
    names = ("measured", "fitted", "computed_before")
    columns = []
    for k, (name, column) in enumerate(facts["columns"].items()):
        histories = {key: v[key][k] for key in names}
        columns.append(read(FittedColumn, column, histories, name=name))
    return {"columns": tuple(columns), "at": v[abscissa], "modal": abscissa == "mode"}


def _shaped(facts: Facts, v: Facts) -> Facts:
    """Fields of a ShapedCommand: its goal and its runs."""
    ((goal, size),) = facts["goal"].items()
    runs = []
    for k, (name, command) in enumerate(facts["commands"].items()):
        histories = {key: v[key][k] for key in ("command", "by_ratio", "tip")}
        runs.append(read(CommandRun, command, name=name, time=v["run_time"], **histories))
    return {"goal": size, "to_rate": goal in ("rate", "speed"), "runs": tuple(runs)}


# By kind: fields that JSON and variables have in another form.
_APART: dict[type, Callable[[Facts, Facts], Facts]] = {
    AxesResult: _axes,
    Campbell: _campbell,
    Critical: lambda facts, _: {"value": next((facts[key] for key in facts if key.startswith("critical_")), None)},
    BodyRest: lambda facts, _: {"loads": _at_rest(facts["loads"])} if facts.get("loads") else {},
    Fit: _fit,
    MachinePlan: lambda facts, v: {"axes": read(AxesResult, facts, v)},
    Modes: _eigenvalues,
    Sensitivity: _sensitivity,
    ShapedCommand: _shaped,
    Shock: lambda facts, _: {key: _array(facts[key]) for key in ("flight", "centrifuge")},
    Sweep: _sweep,
}
