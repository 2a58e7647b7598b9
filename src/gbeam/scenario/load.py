"""From a file, or text, to a validated scenario, with its origin and errors at their places in it."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterable, Iterator
from copy import deepcopy
from dataclasses import replace
from functools import lru_cache
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from pydantic import ValidationError

from gbeam.errors import InputError
from gbeam.guards.limits import EMBEDDED, PROBLEMS
from gbeam.scenario.schema import Environments, Flight, Scenario, kind_of_scenario
from gbeam.scenario.schema.fields import files, former_defaults
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import Source, parse, read_text
from gbeam.scenario.values import Distribution, find_distributions, from_table, parse_path, path_text

if TYPE_CHECKING:
    from gbeam.results.provenance import Provenance, RecordFile
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario
    from gbeam.scenario.text.source import Mark

    AnyScenario: TypeAlias = Scenario | SpecimenScenario | SystemScenario


def provenance(scenario: Environments, command: str = "") -> Provenance:
    """Provenance of the results of a scenario."""
    from gbeam.results.provenance import Provenance  # and with it NumPy, which checking a text needs not

    source = scenario.source
    if source is None:
        return Provenance(command=command)
    records = tuple(_record(name, file) for name, file in _files(scenario))
    changes = tuple(change.text for change in source.overrides)
    data = source.data
    if source.distributions:  # which have their centres there
        data, _ = override(_parsed(source.name, source.text), source.name, changes)
    return Provenance(source.text, changes, fingerprint(data), records, command)


def _files(scenario: Environments) -> Iterator[tuple[str, str]]:
    """Files that a scenario reads: records by their motion's name, others by their keys' paths."""
    for name, motion in scenario.motion.items():
        if isinstance(motion, Flight) and motion.record is not None:
            yield name, motion.record.file
    for key in ("beam", "controllers", "bodies"):
        yield from files(getattr(scenario, key, None), (key,))


# A sweep's cases are of one text; `override` copies it.
_parsed = lru_cache(maxsize=4)(parse)


def fingerprint(data: dict[str, Any]) -> str:
    """SHA-256 of what a scenario says, however it is written and in whatever order."""
    text = json.dumps(data, sort_keys=True, ensure_ascii=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _record(motion: str, file: str) -> RecordFile:
    from gbeam.results.provenance import RecordFile

    content = Path(file).read_bytes()
    small = len(content) <= EMBEDDED
    return RecordFile(motion, os.fspath(file), hashlib.sha256(content).hexdigest(), content if small else None)


Built = TypeVar("Built")


class Collector:
    """Collects the InputErrors of what it attempts, in `errors`."""

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def attempt(self, where: str, make: Callable[..., Built], *args: Any, **options: Any) -> Built | None:
        """Return ``make(*args, **options)``; None, with its error kept as one of `where`, if it refuses."""
        try:
            return make(*args, **options)
        except InputError as error:
            self.errors.append(error.within(where))
            return None


def placed(scenario: Environments, errors: Iterable[InputError]) -> ScenarioError:
    """Return the ScenarioError of what the objects of the core refused."""
    each = (
        error.diagnostics if isinstance(error, ScenarioError) else [_diagnostic(scenario.source, error)]
        for error in errors
    )
    return ScenarioError(chain.from_iterable(each))


def _diagnostic(source: Source | None, error: InputError) -> Diagnostic:
    if source is None:  # a scenario made without a text
        return Diagnostic("scenario", error.where, error.problem, error.fix)
    # "is given beside rate" is about the key, everything else about the value.
    mark: Mark = "key" if error.problem.startswith("is given") else "value"
    return source.diagnostic(parse_path(error.where) or (), error.problem, error.fix, mark)


T = TypeVar("T", bound=Environments)


def load(path: str | os.PathLike[str], overrides: Iterable[str] = (), *, distributions: bool = False) -> AnyScenario:
    """Read and validate a scenario file."""
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
    """Validate the text of a scenario."""
    source = _source(text, name, overrides, folder, distributions=distributions)
    return _validated(kind_of_scenario(source.data), source)


def change(source: Source, overrides: Iterable[str]) -> AnyScenario:
    """Validate a scenario that is parsed already, with more changes: what differs between the cases of a sweep."""
    data, done = override(source.data, source.name, overrides)
    return _validated(kind_of_scenario(data), replace(source, data=data, overrides=source.overrides + done))


def load_environments(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Environments:
    """Read a scenario file that may lack the beam, for questions about the machine alone."""
    file = Path(path)
    return _environments(_source(read_text(file), os.fspath(path), overrides, file.parent))


def _environments(source: Source) -> Environments:
    kind = kind_of_scenario(source.data)
    return _validated(Environments if kind is Scenario and not {"beam", "model"} & source.data.keys() else kind, source)


def defaults_of(
    version: str, text: str, name: str, overrides: Iterable[str], folder: str | os.PathLike[str]
) -> dict[str, str]:
    """Defaults that a version of gbeam had for keys that a scenario leaves out, where today's are others."""
    release = tuple(int(number) for number in re.findall(r"\d+", version))
    if len(release) < 2:  # nothing that gbeam wrote
        return {}
    source = _source(text, name, overrides, folder, distributions=True)
    return dict(former_defaults(_environments(source), release))


def _source(
    text: str,
    name: str,
    overrides: Iterable[str],
    folder: str | os.PathLike[str],
    *,
    distributions: bool = False,
) -> Source:
    data, done = override(parse(name, text), name, overrides)
    source = Source(name, text, Path(folder), data, done)
    distributed = list(find_distributions(data))
    if not distributed:
        return source
    drawn: dict[str, Distribution] = {}
    problems: list[Diagnostic] = []
    for path, family, parameters in distributed:
        try:
            drawn[path_text(path)] = each = from_table(family, parameters)
        except InputError as error:
            problems.append(source.diagnostic(path, error.problem, error.fix))
            continue
        if not distributions:
            one = f"`gbeam sweep` draws from it; for one value: --set {path_text(path)}={each.centre!r}"
            problems.append(source.diagnostic(path, f"is a distribution, {each}, and this needs one value", one))
    if problems:
        raise ScenarioError(problems[:PROBLEMS])
    centred = deepcopy(data)
    for path, *_ in distributed:
        node: Any = centred
        for step in path[:-1]:
            node = node[step]
        node[path[-1]] = drawn[path_text(path)].centre
    return replace(source, data=centred, distributions=drawn)


def _validated(kind: type[T], source: Source) -> T:
    try:
        return kind.model_validate(source.data, context={"folder": source.folder, "source": source})
    except ValidationError as error:
        from gbeam.scenario.explain import explain  # needed only where something is wrong

        details = error.errors(include_url=False, include_input=False)
        # Of a list with a wrong entry only those before it are counted.
        places = [each["loc"] for each in details]
        inside = {each[:k] for each in places for k in range(len(each))}
        details = [each for each in details if each["type"] != "too_short" or each["loc"] not in inside]
        problems = [explain(source, detail) for detail in details[:PROBLEMS]]
        if len(details) > PROBLEMS:
            more = f"has {len(details)} errors, of which {PROBLEMS} are listed"
            problems.append(Diagnostic(source.name, "", more, "correct these first"))
        raise ScenarioError(problems) from None
