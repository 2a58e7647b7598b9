"""Templates of studies: a scenario, or a case made in Python, of which cases with other values are made.

A change is the text ``PATH=VALUE`` for both. Of a case the path leads through the arguments that its objects are made
with, which have the names of a scenario's keys: ``beam.section.width``, ``motion.hub.radius``.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import pickle
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from typing import Any, get_args

import numpy as np
from pydantic import BaseModel

from gbeam.analysis.case import Case
from gbeam.errors import InputError
from gbeam.guards.kinds import KINDS
from gbeam.guards.names import advise
from gbeam.guards.units import UnitError, argument
from gbeam.results.provenance import Provenance
from gbeam.scenario.build import build, scenario_of
from gbeam.scenario.load import change
from gbeam.scenario.origin import provenance
from gbeam.scenario.schema import Centrifuge, Scenario
from gbeam.scenario.schema.fields import fields_of, kind_in, kind_of, quantities
from gbeam.scenario.schema.scenario import Sweep as SweepTable
from gbeam.scenario.values.distributions import Distribution
from gbeam.scenario.values.paths import Path, parse_path, path_text

_LONGEST = 100  # numbers of a list that are values of a study; more are a record


@dataclass(frozen=True)
class ScenarioTemplate:
    """A validated scenario that was read from a file."""

    scenario: Scenario

    @property
    def title(self) -> str:
        """Title of all cases."""
        return self.scenario.title

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions."""
        return tuple(self.scenario.motion)

    @property
    def imitations(self) -> dict[str, bool]:
        """Whether limits of acceptance are set, by the name of each centrifuge that tracks a flight."""
        machines = {name: each for name, each in self.scenario.motion.items() if isinstance(each, Centrifuge)}
        return {name: bool(each.limits_of_acceptance) for name, each in machines.items() if each.tracks}

    @property
    def table(self) -> SweepTable | None:
        """The scenario's own sweep."""
        return self.scenario.sweep

    @property
    def distributions(self) -> Mapping[str, Distribution]:
        """Distributions in place of values, by path."""
        assert self.scenario.source is not None  # it was read from a file
        return self.scenario.source.distributions

    @property
    def provenance(self) -> Provenance:
        """Origin of results."""
        return provenance(self.scenario)

    @property
    def identity(self) -> dict[str, Any]:
        """What a store of cases knows it by."""
        source = self.scenario.source
        assert source is not None
        digest = hashlib.sha256(source.text.encode()).hexdigest()
        return {"scenario": digest, "changes": [each.text for each in source.overrides]}

    def changed(self, changes: Sequence[str]) -> ScenarioTemplate:
        """The template with changes PATH=VALUE; GbeamError if one is impossible."""
        assert self.scenario.source is not None
        return ScenarioTemplate(change(self.scenario.source, changes)) if changes else self

    def built(self) -> Case:
        """Its objects."""
        return build(self.scenario)

    def quantities(self) -> dict[str, tuple[float, str]]:
        """Value in SI and kind of every quantity, by path."""
        return quantities(self.scenario)

    def unit(self, path: str) -> str:
        """SI unit of the quantity at a path; empty where it has none."""
        *above, key = parse_path(path) or ("",)
        node: Any = self.scenario
        for step in above:
            node = node[step] if isinstance(step, int) or isinstance(node, Mapping) else getattr(node, step, None)
        kind = kind_of(node, key) if isinstance(key, str) and hasattr(type(node), "model_fields") else ""
        return KINDS[kind].unit if kind else ""


@dataclass(frozen=True)
class CaseTemplate:
    """A case made in Python: its values are the arguments of its objects, in SI."""

    case: Case

    table = None

    @property
    def title(self) -> str:
        """Title of all cases."""
        return self.case.title

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions."""
        return tuple(self.case.motions)

    @property
    def imitations(self) -> dict[str, bool]:
        """Whether limits of acceptance are set, by the name of each centrifuge that tracks a flight."""
        return {name: bool(self.case.accept.get(name)) for name in self.case.tracks}

    @property
    def distributions(self) -> Mapping[str, Distribution]:
        """Distributions in place of values, by path."""
        return {}

    @property
    def provenance(self) -> Provenance | None:
        """Origin of results."""
        return self.case.provenance

    @property
    def identity(self) -> dict[str, Any]:
        """What a store of cases knows it by."""
        return {"scenario": hashlib.sha256(pickle.dumps(self.case)).hexdigest(), "changes": []}

    @property
    def _tree(self) -> dict[str, Any]:
        return {name: getattr(self.case, name) for name in ("beam", "model", "response")} | {
            "motion": self.case.motions
        }

    def changed(self, changes: Sequence[str]) -> CaseTemplate:
        """The template with changes PATH=VALUE; GbeamError if one is impossible."""
        if not changes:
            return self
        wanted: dict[Any, Any] = {}  # all of one object at once: a mass at the tip moves with the length
        for text in changes:
            name, equals, value = text.partition("=")
            steps = parse_path(name.strip())
            if not equals or steps is None:
                raise InputError(text, "is not PATH=VALUE", 'write it such as "beam.length=250 mm"')
            node = wanted
            for step in steps[:-1]:
                node = node.setdefault(step, {})
            node[steps[-1]] = value.strip()
        parts = _with(self._tree, wanted, ())
        motions: dict[str, Any] = parts.pop("motion")
        for machine, flight in self.case.tracks.items():
            if motions.get(flight) is not self.case.motions.get(flight):
                motions[machine] = motions[machine].altered(flight=motions[flight])
        return CaseTemplate(replace(self.case, **parts, motions=motions))

    def built(self) -> Case:
        """Its objects."""
        return self.case

    def quantities(self) -> dict[str, tuple[float, str]]:
        """Value in SI and kind of every quantity, by path."""
        every = {path_text(path): (value, kind) for path, value, kind in _numbers(self._tree, ())}
        # A machine that tracks a flight of the case has it from there.
        copies = tuple(f"motion.{machine}.flight." for machine in self.case.tracks)
        return {path: each for path, each in every.items() if not path.startswith(copies)}

    def unit(self, path: str) -> str:
        """SI unit of the quantity at a path; empty where it has none."""
        return KINDS[_kind(parse_path(path) or ())].unit


Template = ScenarioTemplate | CaseTemplate


def template_of(
    given: str | os.PathLike[str] | Case, overrides: Sequence[str] = (), *, distributions: bool = False
) -> Template:
    """Return the template that a scenario's file or a case is, with changes."""
    if isinstance(given, Case) and given.scenario is None:
        return CaseTemplate(given).changed(tuple(overrides))
    return ScenarioTemplate(scenario_of(given, overrides, distributions=distributions))


def arguments_of(node: Any) -> dict[str, Any] | None:
    """Return the arguments by which an object is made again; None of one that does not know them."""
    if isinstance(node, Mapping):
        return dict(node)
    if hasattr(node, "arguments"):
        return dict(node.arguments)
    if not is_dataclass(node) or isinstance(node, type):
        return None
    if type(node).__dataclass_params__.init:  # type: ignore[attr-defined]
        return {each.name: getattr(node, each.name) for each in fields(node) if each.init}
    names = [name for name in inspect.signature(type(node)).parameters]
    return {name: getattr(node, name) for name in names} if all(hasattr(node, name) for name in names) else None


def _with(node: Any, wanted: Any, path: Path) -> Any:
    """The node with other values, SI or text with a unit, at some places below it."""
    if isinstance(wanted, str):
        return _read(node, wanted, path)
    listed = list(node) if isinstance(node, (tuple, list)) or np.ndim(node) else None
    known: dict[Any, Any] | None = dict(enumerate(listed)) if listed is not None else arguments_of(node)
    for step in wanted:
        if known is None or step not in known:
            place = path_text((*path, step))
            below = [str(each) for each in known or () if known and _may_vary(known[each])]
            fix = advise(str(step), below) if below else "vary one of its numbers"
            raise InputError(place, "is no value that the case gives", fix)
    assert known is not None
    changed = {step: _with(known[step], each, (*path, step)) for step, each in wanted.items()}
    if listed is not None:
        values = [*(known | changed).values()]
        return type(node)(values) if isinstance(node, (tuple, list)) else np.array(values)
    if isinstance(node, Mapping):
        return known | changed
    try:
        return node.altered(**changed) if hasattr(node, "altered") else type(node)(**known | changed)
    except InputError as error:
        raise error.within(path_text(path)) from None


def _read(current: Any, text: str, path: Path) -> Any:
    """A value of the kind that stands at a place: a word, a truth, a number in SI or with a unit."""
    if isinstance(current, bool):
        if text not in ("true", "false"):
            raise InputError(path_text(path), f"is {text!r}", "write true or false")
        return text == "true"
    if isinstance(current, str):
        return text.strip('"')
    try:
        value = argument(text, _kind(path))
    except UnitError as error:
        raise InputError(path_text(path), error.problem, error.hint) from None
    if isinstance(current, int) and value == int(value):
        return int(value)
    return value


def _numbers(node: Any, path: Path) -> Iterator[tuple[Path, float, str]]:
    """Every number below a node, with its path and kind; counts are none."""
    if isinstance(node, (bool, str, int)):
        return
    if isinstance(node, float) or (hasattr(node, "dtype") and np.ndim(node) == 0):
        yield path, float(node), _kind(path)
        return
    if isinstance(node, (tuple, list, np.ndarray)):
        known: dict[Any, Any] | None = dict(enumerate(node)) if len(node) <= _LONGEST else None
    else:
        known = arguments_of(node)
    for step, value in (known or {}).items():
        yield from _numbers(value, (*path, step))


def _may_vary(node: Any) -> bool:
    return isinstance(node, str) or any(True for _ in _numbers(node, ()))


def _kind(path: Path) -> str:
    """Kind of quantity at a path: that which every key of that name in a scenario has; else a plain number."""
    key = next((step for step in reversed(path) if isinstance(step, str)), "")
    return _kinds().get(key, "ratio")


@cache
def _kinds() -> dict[str, str]:
    """Kinds of the keys that are the same quantity in every table of a scenario."""
    every: dict[str, set[str]] = {}
    for table in _tables(Scenario, set()):
        for key, field in fields_of(table).items():
            if kind := kind_in([*field.metadata, field.annotation]):
                every.setdefault(key, set()).add(kind)
    return {key: kinds.pop() for key, kinds in every.items() if len(kinds) == 1}


def _tables(part: Any, known: set[Any]) -> set[Any]:
    """The tables of a scenario's schema in a part of it, besides those that are known."""
    if isinstance(part, type) and issubclass(part, BaseModel) and part not in known:
        known.add(part)
        for field in part.model_fields.values():
            _tables(field.annotation, known)
    for each in get_args(part):
        _tables(each, known)
    return known
