"""Validated scenarios from a file or a text, with their origin. Errors have their places in the text."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from copy import deepcopy
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from pydantic import ValidationError

from gbeam.errors import InputError
from gbeam.guards.limits import EMBEDDED, PROBLEMS
from gbeam.scenario.schema import Environments, Flight, Scenario, kind_of_scenario
from gbeam.scenario.schema.fields import files
from gbeam.scenario.schema.record import Record
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import Mark, Source, parse, read_text
from gbeam.scenario.values import Distribution, find_distributions, from_table, parse_path, path_text

if TYPE_CHECKING:
    from gbeam.results.provenance import Provenance, RecordFile, ScenarioText
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

    AnyScenario: TypeAlias = Scenario | SpecimenScenario | SystemScenario


def provenance(scenario: Environments, command: str = "") -> Provenance:
    """Provenance of the results of a scenario."""
    from gbeam.results.provenance import Provenance  # imports NumPy, which checking a text does not need

    source = scenario.source
    if source is None:
        return Provenance(command=command)
    records = tuple(_record(name, file) for name, file in _files(scenario))
    changes = tuple(change.text for change in source.overrides)
    data = source.data
    if source.distributions:  # in whose place `data` has their centres
        data, _ = override(_parsed(source.name, source.text), source.name, changes)
    return Provenance(source.text, changes, fingerprint(data), records, command)


def text_of(scenario: Environments) -> ScenarioText | None:
    """Text that a scenario was read from, by which it is read again, or None of one that was made without."""
    from gbeam.results.provenance import ScenarioText

    source = scenario.source
    if source is None:
        return None
    return ScenarioText(source.name, source.text, os.fspath(source.folder), tuple(c.text for c in source.overrides))


def _files(scenario: Environments) -> Iterator[tuple[str, str]]:
    """Yield name and path of files that a scenario reads. Records are named by their motion, others by their key."""
    for name, motion in scenario.motion.items():
        if isinstance(motion, Flight) and isinstance(motion.record, Record):
            yield name, motion.record.file
    for key in ("beam", "controllers", "bodies"):
        yield from files(getattr(scenario, key, None), (key,))


# All cases of a sweep parse one text; `override` copies the data.
_parsed = lru_cache(maxsize=4)(parse)


def fingerprint(data: dict[str, Any]) -> str:
    """SHA-256 of the data of a scenario, the same for any layout and order of its text."""
    text = json.dumps(data, sort_keys=True, ensure_ascii=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _record(motion: str, file: str) -> RecordFile:
    from gbeam.results.provenance import RecordFile

    content = Path(file).read_bytes()
    embedded = len(content) <= EMBEDDED
    return RecordFile(motion, os.fspath(file), hashlib.sha256(content).hexdigest(), content if embedded else None)


def placed(scenario: Environments, errors: Iterable[InputError]) -> ScenarioError:
    """Return one ScenarioError of all errors, each at its place in the scenario's text."""
    diagnostics: list[Diagnostic] = []
    for error in errors:
        if isinstance(error, ScenarioError):
            diagnostics += error.diagnostics
        else:
            diagnostics.append(_diagnostic(scenario.source, error))
    return ScenarioError(diagnostics)


def _diagnostic(source: Source | None, error: InputError) -> Diagnostic:
    if source is None:  # a scenario made without a text
        return Diagnostic("scenario", error.where, error.problem, error.fix)
    # "is given beside rate" is about the key, everything else about the value.
    mark: Mark = "key" if error.problem.startswith("is given") else "value"
    return source.diagnostic(parse_path(error.where) or (), error.problem, error.fix, mark)


T = TypeVar("T", bound=Environments)


def load(path: str | os.PathLike[str], overrides: Iterable[str] = (), *, distributions: bool = False) -> AnyScenario:
    """Read and validate a scenario file; with `distributions` these may stand in place of values."""
    file = Path(path)
    return loads(read_text(file), os.fspath(path), overrides, folder=file.parent, distributions=distributions)


def loads(
    text: str,
    name: str = "scenario",
    overrides: Iterable[str] = (),
    *,
    folder: str | os.PathLike[str] = ".",
    distributions: bool = False,
) -> AnyScenario:
    """Validate the text of a scenario, `name` in messages; with `distributions` these may stand in place of values."""
    source = _source(text, name, overrides, folder, distributions=distributions)
    return _validated(kind_of_scenario(source.data), source)


def change(source: Source, overrides: Iterable[str]) -> AnyScenario:
    """Validate a scenario that is parsed already, with further changes, such as those of a case of a sweep."""
    data, applied = override(source.data, source.name, overrides)
    return _validated(kind_of_scenario(data), replace(source, data=data, overrides=source.overrides + applied))


def load_environments(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Environments:
    """Read a scenario file that may lack a specimen, for questions about the machine only."""
    file = Path(path)
    return _environments(_source(read_text(file), os.fspath(path), overrides, file.parent))


def _environments(source: Source) -> Environments:
    kind = kind_of_scenario(source.data)
    return _validated(Environments if kind is Scenario and not {"beam", "model"} & source.data.keys() else kind, source)


def _source(
    text: str,
    name: str,
    overrides: Iterable[str],
    folder: str | os.PathLike[str],
    *,
    distributions: bool = False,
) -> Source:
    """Parsed text with its overrides. Distributions have their centres, or are errors unless `distributions`."""
    data, applied = override(parse(name, text), name, overrides)
    source = Source(name, text, Path(folder), data, applied)
    distributed = list(find_distributions(data))
    if not distributed:
        return source
    families: dict[str, Distribution] = {}
    problems: list[Diagnostic] = []
    for path, family, parameters in distributed:
        try:
            families[path_text(path)] = distribution = from_table(family, parameters)
        except InputError as error:
            problems.append(source.diagnostic(path, error.problem, error.fix))
            continue
        if not distributions:
            fix = f"`gbeam sweep` draws from it; for one value: --set {path_text(path)}={distribution.centre!r}"
            problem = f"is a distribution, {distribution}, and this needs one value"
            problems.append(source.diagnostic(path, problem, fix))
    if problems:
        raise ScenarioError(problems[:PROBLEMS])
    centred = deepcopy(data)
    for path, *_ in distributed:
        node: Any = centred
        for step in path[:-1]:
            node = node[step]
        node[path[-1]] = families[path_text(path)].centre
    return replace(source, data=centred, distributions=families)


def _validated(kind: type[T], source: Source) -> T:
    """Scenario of that kind; a ScenarioError lists what is wrong, each at its place in the text."""
    try:
        return kind.model_validate(source.data, context={"folder": source.folder, "source": source})
    except ValidationError as error:
        from gbeam.scenario.explain import explain  # needed only where something is wrong

        details = error.errors(include_url=False, include_input=False)
        # pydantic counts only the entries before a wrong one: such a list is not too short.
        parents = set()
        for detail in details:
            parents |= {detail["loc"][:k] for k in range(len(detail["loc"]))}
        details = [detail for detail in details if detail["type"] != "too_short" or detail["loc"] not in parents]
        problems = [explain(source, detail) for detail in details[:PROBLEMS]]
        if len(details) > PROBLEMS:
            remark = f"has {len(details)} errors, of which {PROBLEMS} are listed"
            problems.append(Diagnostic(source.name, "", remark, "correct these first"))
        raise ScenarioError(problems) from None
