"""From a file, or text, to a validated scenario."""

from __future__ import annotations

import os
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationError

from gbeam.errors import InputError
from gbeam.guards.limits import PROBLEMS
from gbeam.scenario.schema import Environments, Scenario, kind_of_scenario
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import Source, parse, read_text
from gbeam.scenario.values import Distribution, find_distributions, from_table, path_text

if TYPE_CHECKING:
    from gbeam.scenario.schema.system import SpecimenScenario, SystemScenario

    AnyScenario = Scenario | SpecimenScenario | SystemScenario
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
    source = _source(read_text(file), os.fspath(path), overrides, file.parent)
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
    data, done = override(parse(name, text), name, overrides)
    source = Source(name, text, Path(folder), data, done)
    distributed = list(find_distributions(data))
    if not distributed:
        return source
    drawn: dict[str, Distribution] = {}
    problems: list[Diagnostic] = []
    for path, family, given in distributed:
        try:
            drawn[path_text(path)] = each = from_table(family, given)
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
        problems = [explain(source, detail) for detail in details[:PROBLEMS]]
        if len(details) > PROBLEMS:
            more = f"has {len(details)} errors, of which {PROBLEMS} are listed"
            problems.append(Diagnostic(source.name, "", more, "correct these first"))
        raise ScenarioError(problems) from None
