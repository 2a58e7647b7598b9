"""A scenario as text and as a form, with the command line's messages, and a preview of its records."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from gbeam.app.files import check_kind, regular
from gbeam.app.form import file_keys, form, known_at, new_table, value_at
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import GbeamError, InputError
from gbeam.guards.processes import read_cached
from gbeam.io.binary import is_binary
from gbeam.io.models.registry import contents_of
from gbeam.motion.flight import Flight
from gbeam.motion.records.record import columns_of_text, read_table
from gbeam.motion.records.units import UNITS, bracketed, spelled
from gbeam.scenario.build import build
from gbeam.scenario.load import loads
from gbeam.scenario.schema import kind_of_scenario
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.revise import toml, with_entry, without_entry
from gbeam.scenario.text.source import parse
from gbeam.scenario.values import Path as Place
from gbeam.scenario.values import parse_path, path_text, walk, written_at
from gbeam.solids.files import skin
from gbeam.solids.foreign import is_mesh
from gbeam.structure.matrices import read_matrices

NAME = "scenario.toml"
# Keys of a record that say what its columns are.
COLUMNS = (
    *("file", "time", "time_unit", "sample_rate", "x", "y", "z", "unit", "quantity", "vehicle"),
    *("p", "q", "r", "rate_unit"),
)
CHANGES = 3  # between two scenarios, at most, that are listed
_LONG = 40  # characters of a value in that list
_DURATION: Place = ("response", "duration")
_MISSING = re.compile(r"(\w+) is missing")  # a message about a table, whose field that is


class Unfit(GbeamError):
    """Raised for a wrong scenario, with its `problems` as :func:`problems` lists them."""

    def __init__(self, problems: list[dict[str, Any]]) -> None:
        self.problems = problems
        super().__init__("; ".join(str(problem["message"]) for problem in problems))


def described(text: str, folder: Path, *, distributions: bool = True) -> dict[str, Any]:
    """Return text, form, errors and, without errors, meaning of a document."""
    document: dict[str, Any] = {"text": text, "form": [], "errors": [], "meaning": ""}
    try:
        data = parse(NAME, text)
        document["form"] = form(data)
        records(data, folder)
        from gbeam.analysis.describe import describe
        from gbeam.report.description import description_text

        case = build(loads(text, NAME, folder=folder, distributions=distributions))
        document["meaning"] = description_text(describe(case))
    except GbeamError as error:
        document["errors"] = problems(error)
    return document


def edited(text: str, path: str, value: str) -> str:
    """Return the text with another value at a path, or without the entry if the value is empty; comments stay."""
    data, place = parse(NAME, text), _place(path)
    if not value.strip():
        return without_entry(text, place) if written_at(data, place) is not None else text
    if not known_at(place, data) and isinstance(written_at(data, place), (dict, list, type(None))):
        raise InputError(path[:100], "is no value of a scenario", "choose one of the form")
    return with_entry(text, place, value_at(place, data, value))


def added(text: str, path: str, choice: str) -> str:
    """Return the text with a new table at a path, or with a table of another kind, `choice`, in place of one."""
    data, place = parse(NAME, text), _place(path)
    try:
        table = new_table(place, data, choice)
    except KeyError:
        raise InputError(path[:100], f"is no place for {choice[:100] or 'a table'}", "choose one of the form") from None
    return with_entry(text, place, table)


def removed(text: str, path: str) -> str:
    """Return the text without what is written at a path."""
    return without_entry(text, _place(path))


def with_record(text: str, motion: str, record: dict[str, str]) -> str:
    """Return the text with a record in place of a flight's acceleration or record, and without the response's duration,
    so that the record is flown to its end. Other keys of a record of the same file stay.
    """
    place: Place = ("motion", motion)
    data = parse(NAME, text)
    if written_at(data, place) is None:
        raise InputError(f"motion.{motion}"[:100], "is no flight of the scenario", "add a motion of kind flight")
    if written_at(data, (*place, "acceleration")) is not None:
        text = without_entry(text, (*place, "acceleration"))
    record_before = written_at(data, (*place, "record"))
    same_file = isinstance(record_before, dict) and record_before.get("file") == record.get("file")
    other_keys = {key: value for key, value in record_before.items() if key not in COLUMNS} if same_file else {}
    if written_at(data, _DURATION) is not None:
        text = without_entry(text, _DURATION)
    return with_entry(text, (*place, "record"), record | other_keys)


def with_mesh(text: str, body: str, mesh: Mapping[str, Any]) -> str:
    """Return the text with the keys `mesh` in the body of that name, if it is a solid, or as another body of a system;
    else a new scenario of the mesh alone, with the motions and response of this one.
    """
    from gbeam.scenario.schema.system import SystemScenario  # takes time to import

    place, data = ("bodies", body), parse(NAME, text)
    body_before = written_at(data, place)
    if isinstance(body_before, dict) and "mesh" in body_before:
        for key, value in mesh.items():
            text = with_entry(text, (*place, key), value)
        return text
    if issubclass(kind_of_scenario(data), SystemScenario):
        return with_entry(text, place, mesh)
    tables = {key: data[key] for key in ("motion", "response") if key in data}
    if isinstance(tables.get("response"), dict):
        tables["response"].pop("stations", None)  # of a beam
    return tomlkit.dumps({"title": body, "bodies": {body: mesh}} | tables)


def _place(path: str) -> Place:
    place = parse_path(path)
    if place is None:
        raise InputError(path[:100] or "path", "is no path of a scenario", "write it such as beam.masses[0].at")
    return place


def _leaves(scenario: dict[str, Any]) -> Iterator[tuple[Place, Any]]:
    """Path and value of every entry but tables and lists with tables or lists in them."""
    return walk(scenario, lambda node: isinstance(node, list) and not any(isinstance(x, (dict, list)) for x in node))


def changes(old_text: str, new_text: str) -> str:
    """Return the changes from one scenario to another in a line, or empty if one of them cannot be parsed."""
    try:
        values_before, values_now = _values(old_text), _values(new_text)
    except GbeamError:
        return ""
    lines = [f"{path} = {_shorten(value)}" for path, value in values_now.items() if values_before.get(path) != value]
    lines += [f"no {path}" for path in values_before if path not in values_now]
    remark = f", and {len(lines) - CHANGES} more" if len(lines) > CHANGES else ""
    return ", ".join(lines[:CHANGES]) + remark if lines else "as before"


def _values(text: str) -> dict[str, Any]:
    return {path_text(path): value for path, value in _leaves(parse(NAME, text))}


def _shorten(value: Any) -> str:
    text = value if isinstance(value, str) else toml(value)
    return text if len(text) <= _LONG else f"{text[:_LONG]}…"


def records(data: Any, folder: Path) -> list[Path]:
    """Return the files that a scenario names; InputError unless all of them are in the folder."""
    files = []
    for path, value in _leaves(data):
        names = value if isinstance(value, list) else [value]
        for name in names if path[-1] in file_keys() else ():
            if not isinstance(name, str):
                continue  # numbers in place of a file; anything else the schema refuses
            try:
                files.append(regular(folder, check_kind(name)))
            except InputError as error:
                raise InputError(path_text(path), f"{name[:100]!r} {error.problem}", error.fix) from None
    return files


def problems(error: GbeamError) -> list[dict[str, Any]]:
    """Return the problems of a document for JSON: path, field, message, hint, and line or None of each."""
    if isinstance(error, Unfit):
        return error.problems
    if isinstance(error, ScenarioError):
        return [_problem(diagnostic) for diagnostic in error.diagnostics]
    if isinstance(error, InputError):
        return [{"path": error.where, "field": error.where, "message": error.problem, "hint": error.fix, "line": None}]
    return [{"path": "", "field": "", "message": str(error), "hint": "", "line": None}]


def _problem(wrong: Diagnostic) -> dict[str, Any]:
    match = _MISSING.fullmatch(wrong.message)
    field = f"{wrong.path}.{match[1]}".removeprefix(".") if match else wrong.path
    return {"path": wrong.path, "field": field, "message": wrong.message, "hint": wrong.hint, "line": wrong.line}


SAMPLES = 1500
MOST = 500  # columns


def head(file: Path) -> dict[str, Any]:
    """Return the name of a file, with the columns of a record and the keys that they suggest, or the skin of a mesh, or
    neither of another file that a body or a section of a scenario may be made of.
    """
    columns, rates = list[tuple[str, str]](), set[float]()
    try:
        if is_mesh(file.name):
            return {"name": file.name, "columns": [], "suggested": {}, "skin": _skin(file)}
        columns, rates = _columns(file)
    except InputError:
        if not _is_model(file):
            raise
    keys = suggested(columns)
    keys |= {"sample_rate": f"{rates.pop():g} Hz"} if "time" not in keys and len(rates) == 1 else {}
    return {"name": file.name, "columns": [name for name, _ in columns], "suggested": keys}


def _is_model(file: Path) -> bool:
    """True if a file holds matrices, nodes, modes or a body of another program, or the matrices of a section."""
    with suppress(InputError):
        contents: Any = contents_of(file)
        return any(map(len, contents.values()))
    with suppress(InputError):
        return bool(read_matrices(file, "m", "kg"))
    return False


def _columns(file: Path) -> tuple[list[tuple[str, str]], set[float]]:
    """Names and units of the columns of a record, and the sample rates, Hz, that it states.

    A record of text is read in a process of its own, too, as it is sent.
    """

    def refuse(problem: str) -> InputError:
        return InputError("record.file", f"{file.name} {problem}", "cut or resample the record")

    if is_binary(file):
        table = read_table(file)
        return [(column.name, column.unit) for column in table.columns[:MOST]], {rate.rate for rate in table.stated}
    columns, rates = read_cached(columns_of_text, file, MOST, refuse=refuse)
    return [tuple(column) for column in columns], {*rates}


def _skin(file: Path) -> dict[str, Any]:
    """Skin of a mesh for JSON."""

    def refuse(problem: str) -> InputError:
        return InputError("mesh", f"{file.name} {problem}", "mesh it more coarsely, or write it again")

    read = read_cached(skin, file, refuse=refuse)
    return {
        "vertices": [float(f"{coordinate:.6g}") for coordinate in read["vertices"].flat],
        "triangles": read["triangles"].ravel().tolist(),
        "groups": [group | {"vertices": group["vertices"].tolist()} for group in read["groups"]],
    }


def load_curves(text: str, folder: Path) -> dict[str, Any]:
    """Return the acceleration (or specific force) of every flight over the response's time, s, in g, base axes."""
    case = build(loads(text, folder=folder))
    flights = {name: motion for name, motion in case.motions.items() if isinstance(motion, Flight)}
    spans: dict[str, tuple[float, float]] = {}
    if case.response is not None:
        for name in flights:
            settings = case.settings_of(name)
            spans[name] = settings.start, settings.start + settings.duration
    start = min((first for first, _ in spans.values()), default=0.0)
    end = max((last for _, last in spans.values()), default=0.0)
    time = np.linspace(start, end, SAMPLES)

    def load(name: str, flight: Flight) -> list[list[float | None]]:
        """Components over time, None where the flight is not flown."""
        first, last = spans.get(name, (-np.inf, np.inf))
        flown = (time >= first) & (time <= last)
        in_g = np.asarray(flight.over(first, last).base(time).a_WO_B) / STANDARD_GRAVITY
        components = []
        for component in in_g.T.tolist():
            components.append([value if is_flown else None for value, is_flown in zip(component, flown, strict=True)])
        return components

    return {"time": time.tolist(), "flights": {name: load(name, flight) for name, flight in flights.items()}}


_WORDS = re.compile(r"[A-Za-z]+\d?|\d+")
_TIME = re.compile(r"t|time|timestamp|elapsed|elapsedtime|sec|seconds?|zeit|temps")
_LOADS = "n|a|acc|accel|acceleration|accelerometer|specificforce|loadfactor"  # fz may be a force in N
_LOAD = re.compile(rf"(?P<before>{_LOADS})(?P<axis>[xyz])|(?P<first>[xyz])(?P<after>acc|accel|acceleration|loadfactor)")
_RATE = re.compile(
    r"[pqr]|(?P<turn>roll|pitch|yaw)rate|(?:omega|w|gyro|rate|angularrate|angularvelocity)(?P<axis>[xyz])"
)
_RATES = {"roll": "p", "pitch": "q", "yaw": "r", "x": "p", "y": "q", "z": "r"}
_FACTORS = ("n", "loadfactor")  # load factors, without a unit, are in g
_LONGEST = 3  # words of a unit in a name, m_s_2


def suggested(columns: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return record keys that the (name, unit) of exactly one column each suggests. Signs are left to the user."""
    candidates: dict[str, list[tuple[str, str]]] = defaultdict(list)  # (column, unit) by key
    for name, unit in columns:
        for key, stated in _meanings(name, unit):
            candidates[key].append((name, stated))
    all_rates = all(key in candidates for key in "pqr")  # rates are suggested only together
    return {
        **_matching_columns(candidates, ("time",), "time_unit"),
        **_matching_columns(candidates, "xyz", "unit"),
        **(_matching_columns(candidates, "pqr", "rate_unit") if all_rates else {}),
    }


def _matching_columns(columns: Mapping[str, list[tuple[str, str]]], keys: Iterable[str], unit: str) -> dict[str, str]:
    """Column of each key, and their common unit at the key `unit`, or empty if a key has several, or units differ."""
    candidates = {key: columns[key] for key in keys if key in columns}
    if any(len(matches) > 1 for matches in candidates.values()):
        return {}
    units = {stated for ((_, stated),) in candidates.values()}
    if len(units) > 1:
        return {}
    stated = "".join(units)
    return {key: column for key, ((column, _),) in candidates.items()} | ({unit: stated} if stated else {})


def _meanings(name: str, unit: str) -> Iterable[tuple[str, str]]:
    """Key of a record that a column may be, and its unit as a scenario spells it,
    or empty if name or unit do not fit.
    """
    stem, _ = bracketed(name) or (name, "")
    for words, unit_text in (*_readings(stem, unit), *_readings(re.split(r"[./]", stem)[-1], unit)):
        for quantity, pattern in (("time", _TIME), ("acceleration", _LOAD), ("rate", _RATE)):
            match = pattern.fullmatch(words)
            spelling = spelled(unit_text, quantity) if unit_text else ""
            if match is None or spelling is None or (spelling and spelling not in UNITS[quantity]):
                continue
            groups = match.groupdict()
            if quantity == "acceleration":
                factor = (groups["before"] or groups["after"]) in _FACTORS
                return [(groups["axis"] or groups["first"], spelling or ("g" if factor else ""))]
            if quantity == "rate":
                return [(_RATES[groups["turn"] or groups["axis"]] if len(words) > 1 else words, spelling)]
            return [("time", spelling)]
    return []


def _readings(name: str, unit: str) -> Iterable[tuple[str, str]]:
    """Possible readings of a name: its letters, lower case, and its unit, which may be its last words, as in n_z_g."""
    words = [word.lower() for word in _WORDS.findall(name)]
    if unit:
        yield "".join(words), unit
        return
    for count in range(min(_LONGEST, len(words) - 1), 0, -1):
        tail = words[-count:]
        unit_text = "/".join(tail[:2]) + "^".join(["", *tail[2:]])  # m s 2: m/s^2
        if any(spelled(unit_text, quantity) is not None for quantity in UNITS):
            yield "".join(words[:-count]), unit_text
    yield "".join(words), ""
