"""Results read back from JSON and the variables of a file, as far as their figures and the viewer need them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from typing import Any, TypeVar

import numpy as np

from gbeam.figures import Describe, figures_of
from gbeam.results import measures
from gbeam.results.cases import BOUNDS, ORDERS, Indices, Parameter, Sensitivity, Statistics, Sweep
from gbeam.results.comparison import Comparison, MachinePlan
from gbeam.results.declared import INSIDE, NAMES, Declaration, annotation, declarations, record_in
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.machine import AxesResult
from gbeam.results.modal import Campbell, Modes
from gbeam.results.parts import Base, Loads
from gbeam.results.response import HubResult, Response
from gbeam.results.result import Floats
from gbeam.results.searches import CommandRun, Fit, FittedColumn, Optimum, ShapedCommand
from gbeam.results.solids import SolidStress, SpecimenLoads
from gbeam.results.study import Study, SystemStudy
from gbeam.results.system import BeamResponse, Invariants, Loop, SystemModes, SystemResponse, SystemRest

Facts = Mapping[str, Any]
_NONE = np.empty(0)
_R = TypeVar("_R")
_S = TypeVar("_S", Study, SystemStudy)


def figures_in(kind: str, facts: Facts, variables: Facts) -> dict[str, Describe]:
    """Return what describes the figures of a result of a kind, from its JSON and, of histories, its variables."""
    match kind:
        case "Study":
            study = _study(Study, _response, facts, variables)
            return figures_of(study) if study.responses else {}
        case "SystemStudy":
            return figures_of(_study(SystemStudy, _system_response, facts, variables))
        case "SystemRest":
            return figures_of(tuple(_rest(name, each) for name, each in facts["motions"].items()))
        case "MachinePlan":
            return figures_of(_plans(facts, variables))
        case "Deflection":
            return figures_of(tuple(_deflection(name, each) for name, each in facts["motions"].items()))
    if kind not in _ALONE:
        return {}
    needed, read = _ALONE[kind]
    return figures_of(read(facts, variables)) if not needed or needed in variables else {}


def _read(kind: type[_R], facts: Facts, v: Facts | None = None, /, **more: Any) -> _R:
    """A record of `more`, of variables of a file and of its JSON; what none has, which no figure reads, is empty."""
    every = {field.name: field for field in fields(kind)}  # type: ignore[arg-type]
    for name, each in declarations(kind):
        stored = (v or {}).get(each.dims[-1] if each.role == "coordinate" else each.name or name)
        if name in more or name not in every:
            continue
        if stored is not None and each.name is not None and each.role in ("variable", "coordinate"):
            more[name] = stored.astype(bool) if each.flags else stored if stored.ndim else stored.item()
        elif (value := _value(kind, name, each, facts)) is not None:
            more[name] = value
    needed = {name for name, each in every.items() if each.default is MISSING and each.default_factory is MISSING}
    return kind(**dict.fromkeys(needed - more.keys(), _NONE), **more)


def _value(kind: type, name: str, each: Declaration, facts: Facts) -> Any:
    """A field, which JSON has in the rows of a dimension or at its key; None where it is not there."""
    key, written = each.key or name, annotation(kind, name)
    lists: dict[str, str] = {} if key.startswith("/") else getattr(kind, "json_rows", {})
    along = next((dim for dim in each.dims if dim in lists), None)
    rows: Any = [] if along is None else facts.get(lists[along], [])
    if each.role == "labels" and along is not None:
        return tuple(rows) if isinstance(rows, dict) else _words(rows, key)
    if each.key is None or (key == INSIDE and "None" in written):
        return None
    inside = record_in(kind, name) if each.role in ("part", "rows") else None
    if along is not None:
        listed = rows if isinstance(rows, list) else [rows[place] for place in NAMES.get(along, rows)]
        shares = [_at(row, key) for row in listed]
        if inside is not None:  # such as errors: of a record of arrays, what the rows have
            names: Facts = next((share for share in shares if share), {})
            return _read(inside, {one: [share[one] for share in shares] for one in names}) if names else None
        across = [_bare(np.nan if share is None else share, written, each) for share in shares]
        return tuple(shares) if "tuple" in written else np.stack(across, each.dims.index(along)) if across else None
    value = facts if key == INSIDE else _at(facts, key)
    if inside is None or value is None:
        return _bare(value, written, each)
    if each.role == "part":
        return _read(inside, value)
    return tuple(_read(inside, row) for row in value) if isinstance(value, list) else None


def _at(facts: Any, key: str) -> Any:
    for word in key.removeprefix("/").split("."):
        facts = facts.get(word) if isinstance(facts, dict) else None
    return facts


def _bare(value: Any, written: str, each: Declaration) -> Any:
    """A value of JSON as a record has it: arrays for lists, vectors for components, NaN for null."""
    if isinstance(value, dict) and each.dims[-1:] and each.dims[-1] in NAMES:
        return _vectors(value)
    if value is not None and ("Floats" in written or "Complex" in written):
        return _array(value)
    if isinstance(value, list):
        return tuple(value)
    return np.nan if value is None and written == "float" else value


def _under(place: str, variables: Facts) -> dict[str, Any]:
    return {name.removeprefix(place): each for name, each in variables.items() if name.startswith(place)}


def _array(values: Any) -> Floats:
    """Numbers of JSON, NaN for null."""
    return np.array(values, dtype=float)


def _column(rows: Any, key: str) -> Floats:
    return _array([each.get(key) for each in rows])


def _words(rows: Any, key: str) -> tuple[str, ...]:
    return tuple(each[key] for each in rows)


def _vectors(values: Facts) -> Floats:
    return np.stack([_array(each) for each in values.values()], axis=-1)


def _study(kind: type[_S], read: Callable[..., Any], facts: Facts, variables: Facts) -> _S:
    """The responses in all environments that have one, and their comparisons."""
    responses, comparisons = {}, []
    for name, each in facts["motions"].items():
        v = _under(f"motions/{name}/", variables)
        if "time" in v:
            responses[name] = read(each, v, name=name)
    for each in facts["comparisons"]:
        v = _under(f"comparisons/{each['centrifuge']}/", variables)
        if "time" in v and each["flight"] in responses:
            comparisons.append(_comparison(each, v, getattr(responses[each["flight"]], "stations", _NONE)))
    return kind("", responses, tuple(comparisons))


def _system_response(facts: Facts, v: Facts, **more: Any) -> SystemResponse:
    invariants = _read(Invariants, {}, v) if "energy" in v else None
    beams = {
        body: _read(BeamResponse, {}, loads=_loads(each, _under(f"{body}_", v)))
        for body, each in facts.get("beams", {}).items()
        if f"{body}_section_force" in v
    }
    solids = {
        body: _read(SolidStress, each, {**v, **_under(f"{body}_", v)}) for body, each in facts.get("solids", {}).items()
    }
    axes = _axes(facts, v) if "axis_rate" in v else None
    loop = _read(Loop, facts["loop"], v) if "measured" in v else None
    more |= {"invariants": invariants, "beams": beams, "solids": solids, "axes": axes, "loop": loop}
    return _read(SystemResponse, facts, v, base=None, **more)


def _response(facts: Facts, v: Facts, name: str) -> Response:
    return _read(
        Response, facts, v, name=name, base=_read(Base, {}, v),
        hub=_read(HubResult, {}, v) if "hub_angle" in v else None,
        axes=_axes(facts, v) if "axis_rate" in v else None,
        loads=_loads(facts.get("loads", {}), v) if "section_force" in v else None,
        solid=_inside_of(SolidStress, facts.get("solid"), v, "solid_"),
        specimen=_inside_of(SpecimenLoads, facts.get("specimen"), v, "specimen_"),
    )  # fmt: skip


def _inside_of(kind: type[_R], facts: Facts | None, v: Facts, before: str) -> _R | None:
    """A record within a response, whose variables have its name before their own."""
    return None if facts is None else _read(kind, facts, {**v, **_under(before, v)})


def _loads(facts: Facts, v: Facts) -> Loads:
    unknown = np.full(v["section_force"].shape[:-1], np.nan)
    return _read(Loads, facts, {"stress_tension": unknown, "stress_compression": unknown, **v})


def _axes(facts: Facts, v: Facts) -> AxesResult:
    episodes = tuple((each["start"], each["end"], each["reason"]) for each in facts["not_followed"])
    limits = [each | {"allowed": np.inf} if each["allowed"] is None else each for each in facts["limits"]]
    span = float(v["flight_from"]), float(v["flight_to"])
    return _read(AxesResult, {"limits": limits}, v, episodes=episodes, span=span)


def _comparison(facts: Facts, v: Facts, stations: Floats) -> Comparison:
    parts = dict[str, Any](stations=None, mismatch=None, root=None)
    if "trend_flight" in v:
        parts["stations"] = _read(measures.Statistics, {"cutoff": facts["cutoff"]}, v)
    if "mismatch_gradient" in v:
        length = float(stations[-1])
        parts["mismatch"] = _read(measures.Mismatch, facts["mismatch"], _under("mismatch_", v), length=length)
    if "root_force_history_flight" in v:  # which files of 0.2 lack
        parts["root"] = _read(measures.RootLoads, {}, history=_read(measures.RootHistory, {}, _under("root_", v)))
    if facts.get("shock"):
        spectra = {key: _array(facts["shock"][key]) for key in ("frequency", "flight", "centrifuge")}
        parts["shock"] = measures.Shock(
            facts["shock"]["quality"], **spectra, control=facts["shock"].get("control", "the tip")
        )
    return _read(Comparison, facts, v, **parts)


def _plans(facts: Facts, variables: Facts) -> tuple[MachinePlan, ...]:
    """The machines' plans."""
    every = []
    for name, each in facts["motions"].items():
        v = _under(f"motions/{name}/", variables)
        if "time" in v:
            every.append(_read(MachinePlan, each, v, name=name, axes=_axes(each, v)))
    return tuple(every)


def _deflection(name: str, facts: Facts) -> Deflection:
    loads = facts.get("loads")
    of: dict[str, Any] = {"solid": SolidStress, "specimen": SpecimenLoads}
    more: dict[str, Any] = {key: _read(kind, facts[key]) for key, kind in of.items() if facts.get(key)}
    return _read(Deflection, facts, motion=name, loads=loads and _at_rest(loads), **more)


def _rest(name: str, facts: Facts) -> SystemRest:
    loads = {body: _at_rest(each) for body, each in facts.get("beams", {}).items()}
    return _read(SystemRest, facts, name=name, loads=loads)


def _at_rest(loads: Facts) -> Loads:
    """Loads of one time, from their JSON."""
    v: dict[str, Any] = {key: _vectors(loads[key])[None] for key in ("section_force", "section_moment")}
    v |= {key: _array(loads[key])[None] for key in ("stress_tension", "stress_compression")}
    return _loads(loads, v)


def _eigenvalues(rows: Any) -> Any:
    """Eigenvalues of modes, by their frequencies and damping ratios."""
    ratio, size = _column(rows, "damping_ratio"), 2 * np.pi * _column(rows, "frequency")
    return size * (-ratio + 1j * np.sqrt(1 - ratio**2))


def modes_in(facts: Facts, _: Facts | None = None) -> Modes:
    """Modes from their JSON."""
    rows = facts["modes"]
    real, imaginary = (
        np.array([_vectors(each[key]) for each in rows]).reshape(len(rows), -1, 3)
        for key in ("shape", "shape_imaginary")
    )
    twist = None
    if rows and "twist" in rows[0]:
        twist = _column(rows, "twist") + 1j * _column(rows, "twist_imaginary")
    return _read(Modes, facts, eigenvalue=_eigenvalues(rows), shape=real + 1j * imaginary, twist=twist)


def _campbell(facts: Facts, _: Facts) -> Campbell:
    value = facts["critical_speed"]
    critical = None if value is None else _read(Critical, {"kind": "equilibrium lost"}, value=value)
    return _read(Campbell, facts, critical=critical)


def _sensitivity(facts: Facts, _: Facts) -> Sensitivity:
    every = facts["measures"].values()
    rows = {each["path"]: each for each in next(iter(every))["parameters"]}
    by_path = [{one["path"]: one["derivative"] for one in each["parameters"]} for each in every]
    return _read(
        Sensitivity, facts, measures=tuple(facts["measures"]), units=_words(every, "unit"),
        figures=_column(every, "value"), parameters=tuple(rows), parameter_units=_words(rows.values(), "unit"),
        values=_column(rows.values(), "value"), derivatives=_array([[one[path] for path in rows] for one in by_path]),
    )  # fmt: skip


def _sweep(facts: Facts, variables: Facts) -> Sweep:
    named = {key: facts.get(key, {}) for key in ("measures", "histories")}
    parameters = [
        Parameter(each["path"], np.array(each["values"]), each["unit"], each["distribution"] or "")
        for each in facts["parameters"]
    ]
    return _read(
        Sweep, facts, parameters=tuple(parameters), outcome=np.array(facts["outcomes"], dtype=object),
        message=np.array(facts["messages"], dtype=object), time=_array(facts.get("time", [])),
        measures={name: _array(each["values"]) for name, each in named["measures"].items()},
        units={name: each["unit"] for key in named for name, each in named[key].items()},
        histories={name: variables[f"{name} history"] for name in named["histories"] if f"{name} history" in variables},
        statistics={name: _statistics(each) for name, each in facts["statistics"].items()},
        indices={name: _indices(each) for name, each in facts["indices"].items()},
    )  # fmt: skip


def _bounds(facts: Facts) -> Floats:
    """Estimate, low and high along the last dimension."""
    return np.stack([_array(facts[bound]) for bound in BOUNDS], axis=-1)


def _statistics(facts: Facts) -> Statistics:
    names = tuple(name for name in facts if name != "draws")
    values = np.stack([_bounds(facts[name]) for name in names], axis=-2)
    return _read(Statistics, {}, names=names, values=values)


def _indices(facts: Facts) -> Indices:
    values = np.stack([np.stack([_bounds(each[order]) for order in ORDERS], axis=-2) for each in facts.values()], -3)
    return _read(Indices, {}, parameters=tuple(facts), values=values)


def _fit(facts: Facts, v: Facts) -> Fit:
    at, data = "time" if "time" in v else "mode", ("measured", "fitted", "computed_before")
    columns = [
        _read(FittedColumn, each, {key: v[key][k] for key in data}, name=name)
        for k, (name, each) in enumerate(facts["columns"].items())
    ]
    return _read(Fit, facts, columns=tuple(columns), at=v[at], modal=at == "mode")


def _shaped(facts: Facts, v: Facts) -> ShapedCommand:
    ((goal, size),) = facts["goal"].items()
    runs = [
        _read(
            CommandRun,
            each,
            name=name,
            time=v["run_time"],
            **{key: v[key][k] for key in ("command", "by_ratio", "tip")},
        )
        for k, (name, each) in enumerate(facts["commands"].items())
    ]
    return _read(ShapedCommand, facts, v, goal=size, to_rate=goal in ("rate", "speed"), runs=tuple(runs))


# By verb: a variable without which there are no histories, and what reads the record.
_ALONE: dict[str, tuple[str, Callable[[Facts, Facts], Any]]] = {
    "Modes": ("", modes_in),
    "SystemModes": ("", lambda facts, _: _read(SystemModes, facts, eigenvalue=_eigenvalues(facts["modes"]))),
    "SystemResponse": ("time", _system_response),
    "Campbell": ("", _campbell),
    "CriticalMap": ("", lambda facts, _: _read(CriticalMap, facts)),
    "Comparison": ("time", lambda facts, v: _comparison(facts, v, v.get("station", np.array([np.nan])))),
    "Sensitivity": ("", _sensitivity),
    "Sweep": ("", _sweep),
    "Fit": ("measured", _fit),
    "Optimum": ("history", lambda facts, v: _read(Optimum, facts, v)),
    "ShapedCommand": ("command", _shaped),
    "SolidStress": ("von_mises", lambda facts, v: _read(SolidStress, facts, v)),
    "SpecimenLoads": ("acceleration", lambda facts, v: _read(SpecimenLoads, facts, v)),
}
