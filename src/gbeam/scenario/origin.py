"""Origin of a scenario, and errors at their places in it."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from gbeam.errors import InputError
from gbeam.guards.limits import EMBEDDED
from gbeam.scenario.schema import Environments, Flight
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import parse
from gbeam.scenario.values import parse_path

if TYPE_CHECKING:
    from gbeam.results.provenance import Provenance, RecordFile
    from gbeam.scenario.text.source import Mark, Source


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
    yield from ((f"beam.{key}", file) for key, file in getattr(getattr(scenario, "beam", None), "files", ()))
    for name, controller in getattr(scenario, "controllers", {}).items():
        for k, law in enumerate(controller.law):
            if getattr(law, "file", None) is not None:
                yield f"controllers.{name}.law[{k}].file", law.file
    for name, body in getattr(scenario, "bodies", {}).items():
        yield from ((f"bodies.{name}.{key}", file) for key, file in getattr(body, "files", ()))


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


T = TypeVar("T")


class Collector:
    """Collects the InputErrors of what it attempts, in `errors`."""

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def attempt(self, where: str, make: Callable[..., T], *args: Any, **options: Any) -> T | None:
        """Return ``make(*args, **options)``; None, with its error kept as one of `where`, if it refuses."""
        try:
            return make(*args, **options)
        except InputError as error:
            self.errors.append(error.within(where))
            return None


def placed(scenario: Environments, errors: Iterable[InputError]) -> ScenarioError:
    """Return the ScenarioError of what the objects of the core refused."""
    return ScenarioError(_diagnostic(scenario.source, error) for error in errors)


def _diagnostic(source: Source | None, error: InputError) -> Diagnostic:
    if source is None:  # a scenario made without a text
        return Diagnostic("scenario", error.where, error.problem, error.fix)
    # "is given beside rate" is about the key, everything else about the value.
    mark: Mark = "key" if error.problem.startswith("is given") else "value"
    return source.diagnostic(parse_path(error.where) or (), error.problem, error.fix, mark)
