"""Templates of studies: a scenario, or a case made in Python, from which cases with other values are made.

A change is the text ``PATH=VALUE`` for both. The path of a case leads through the arguments that its objects were made
with, which have the names of a scenario's keys: ``beam.section.width``, ``motion.hub.radius``.
"""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.analysis.case import BEAM, Case
from gbeam.arrays.tree import altered, arguments_of
from gbeam.errors import InputError, placing_within
from gbeam.guards.kinds import KINDS, Kinds, common_kind, element_kinds
from gbeam.guards.parameters import kind_of_argument
from gbeam.guards.units import read_quantity
from gbeam.mechanics.assembly import assemble, model_of
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import notes_on
from gbeam.printable import advise
from gbeam.results.provenance import Provenance
from gbeam.results.result import Part
from gbeam.scenario.build import build, scenario_of
from gbeam.scenario.collector import Collector
from gbeam.scenario.load import change, provenance
from gbeam.scenario.schema.declared import object_of
from gbeam.scenario.schema.fields import kind_of, quantities
from gbeam.scenario.values import Distribution, Path, parse_path, path_text
from gbeam.structure.beam import Beam
from gbeam.sweeps import SweepSettings

if TYPE_CHECKING:
    from gbeam.scenario.load import AnyScenario

_KINDS: Kinds = {"system": {"gravity": "acceleration"}}  # of values that are no argument of an object of a case
_LONGEST = 100  # numbers of a list that a study may vary; a longer one is a record


@dataclass(frozen=True)
class ScenarioTemplate:
    """A validated scenario that was read from a file."""

    scenario: AnyScenario

    def title(self, varied: Collection[str] = ()) -> str:
        """Title of all cases, between which the values at some paths are `varied`."""
        return self.scenario.heading(varied)

    @property
    def sweep(self) -> SweepSettings:
        """Sweep that the scenario asks for."""
        table = self.scenario.sweep
        return SweepSettings() if table is None else object_of(Collector(), "sweep", table)

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
    def notes(self) -> tuple[str, ...]:
        """Notes on the motions of all cases."""
        return notes_on(self.scenario.motion)

    @property
    def identity(self) -> dict[str, Any]:
        """Digest and changes, for JSON, by which a store of cases knows the template again."""
        source = self.scenario.source
        assert source is not None
        digest = hashlib.sha256(source.text.encode()).hexdigest()
        return {"scenario": digest, "changes": [change.text for change in source.overrides]}

    def changed(self, changes: Sequence[str]) -> ScenarioTemplate:
        """The template with changes PATH=VALUE; GbeamError if one is impossible."""
        assert self.scenario.source is not None
        return ScenarioTemplate(change(self.scenario.source, changes)) if changes else self

    def built(self, system: System | None = None) -> Case:
        """The case, with its objects; with a `system` that was built from the same tables in place of its own."""
        return build(self.scenario, system=system)

    def quantities(self) -> dict[str, tuple[float, str]]:
        """Value in SI and kind (a key of KINDS) of every quantity, by path."""
        return quantities(self.scenario)

    def unit(self, path: str) -> str:
        """SI unit of the quantity at a path, or empty if it has none."""
        node: Any = self.scenario
        kind = ""
        for step in parse_path(path) or ():
            if isinstance(step, str) and hasattr(type(node), "model_fields"):
                kind = kind_of(node, step)  # a number in a list has the kind of the list
            container = isinstance(node, (Mapping, tuple, list))
            node = node[step] if container else getattr(node, str(step), None)
        return KINDS[kind].unit if kind else ""


class _BeamBody:
    """A beam in its model, as a body of a system, whose values are the arguments of the beam, and `model`."""

    maker = Beam

    def __init__(self, structure: Structure, beam: Beam) -> None:
        self.structure = structure
        self.arguments = (arguments_of(beam) or {}) | {"model": model_of(structure)}

    def altered(self, **changes: Any) -> Structure:
        """The structure with some arguments changed, at those of its stations that lie within the beam."""
        arguments = self.arguments | changes
        model, beam = arguments.pop("model"), Beam(**arguments)
        return assemble(beam, model, [station for station in self.structure.stations[:-1] if station < beam.length])


@dataclass(frozen=True)
class CaseTemplate:
    """A case made in Python, with the members of a ScenarioTemplate. Its values are arguments of its objects, in SI."""

    case: Case

    sweep = SweepSettings()

    def title(self, varied: Collection[str] = ()) -> str:
        return self.case.title

    @property
    def distributions(self) -> Mapping[str, Distribution]:
        return {}

    @property
    def provenance(self) -> Provenance | None:
        return self.case.provenance

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the motions of all cases."""
        return notes_on(self.case.motions)

    @property
    def identity(self) -> dict[str, Any]:
        """Identity of the case for the store of a sweep: a digest of what it is made of."""
        case = self.case
        # Of a beam what its structure is made of: numbers that are computed may differ on another machine.
        system: Any = case.system if case.only_beam is None else case.stations
        other_parts = case.title, case.tracks, case.accept, case.sensors
        try:
            content = pickle.dumps((system, self._tree, *other_parts))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            fix = "define its classes at the top level of a module, or leave the store out"
            raise InputError("store", f"cannot know the case again, which cannot be pickled ({error})", fix) from None
        return {"scenario": hashlib.sha256(content).hexdigest(), "changes": []}

    @property
    def _tree(self) -> dict[str, Any]:
        """Objects of the case, by the tables of a scenario in which paths are looked up."""
        case, system = self.case, self.case.system
        common = {"motion": case.motions, "response": case.response}
        if case.only_beam is not None and system.order == (BEAM,):
            return {BEAM: case.beam, "model": case.model} | common
        bodies: dict[str, Any] = {}
        for name, body in system.bodies.items():
            if isinstance(body, RigidBody):
                bodies[name] = body
            elif body.source is not None:  # None: made of particles, without values to vary
                bodies[name] = _BeamBody(body, body.source.beam)
        if system.only_structure is not None:  # a body on the base, without joints to vary
            return ({"bodies": bodies} if bodies else {}) | common
        gravity = {} if system.gravity is None else {"gravity": system.gravity}
        parts = {name: getattr(system, name) for name in ("joints", "forces", "controllers")}
        return {"bodies": bodies} | parts | {"system": gravity} | common

    def changed(self, changes: Sequence[str]) -> CaseTemplate:
        """Template of the case with other values, from texts such as "beam.length=250 mm"."""
        if not changes:
            return self
        tree: dict[Any, Any] = {}  # a tree: all of one object at once, as a mass at the tip moves with the length
        for text in changes:
            name, equals, value = text.partition("=")
            steps = parse_path(name.strip())
            if not equals or steps is None:
                raise InputError(text, "is not PATH=VALUE", 'write it such as "beam.length=250 mm"')
            node = tree
            for step in steps[:-1]:
                if not isinstance(node.get(step), dict):  # of several changes of one place the last counts
                    node[step] = {}
                node = node[step]
            node[steps[-1]] = value.strip()
        parts = _replace_values(self._tree, _KINDS, tree, ())
        motions: dict[str, Any] = parts.pop("motion")
        for machine, flight in self.case.tracks.items():
            if motions.get(flight) is not self.case.motions.get(flight):
                motions[machine] = motions[machine].altered(flight=motions[flight])
        case = replace(self.case, response=parts.pop("response"), motions=motions)
        if not parts.keys() & tree.keys():
            return CaseTemplate(case)
        if BEAM in parts:
            return CaseTemplate(case.remade(**parts))
        return CaseTemplate(replace(case, system=_joined(case.system, parts)))

    def built(self, system: System | None = None) -> Case:
        return self.case

    def quantities(self) -> dict[str, tuple[float, str]]:
        numbers = {path_text(path): (value, kind) for path, value, kind in _numbers(self._tree, _KINDS, ())}
        # The flight that a machine tracks is a motion of the case already.
        copies = tuple(f"motion.{machine}.flight." for machine in self.case.tracks)
        return {path: number for path, number in numbers.items() if not path.startswith(copies)}

    def unit(self, path: str) -> str:
        node: Any = self._tree
        kinds = _KINDS
        for step in parse_path(path) or ():
            node, kinds = _children(node, kinds).get(step, (None, ""))
        kind = common_kind(kinds)
        return KINDS[kind].unit if kind else ""


def _joined(system: System, parts: dict[str, Any]) -> System:
    """The system with other bodies and, where these can be changed, gravity, joints, forces and controllers."""
    bodies = {name: getattr(body, "structure", body) for name, body in parts.pop("bodies").items()}
    gravity = parts.pop("system", {}).get("gravity")
    return replace(system, bodies={**system.bodies, **bodies}, gravity=gravity, **parts)


Template = ScenarioTemplate | CaseTemplate


def template_of(
    scenario: str | os.PathLike[str] | Case, overrides: Sequence[str] = (), *, distributions: bool = False
) -> Template:
    """Return the template of a scenario's file, or of a case, after the changes `overrides`."""
    if isinstance(scenario, Case) and scenario.scenario is None:
        return CaseTemplate(scenario).changed(tuple(overrides))
    return ScenarioTemplate(scenario_of(scenario, overrides, distributions=distributions))


def _children(node: Any, kinds: Kinds) -> dict[Any, tuple[Any, Kinds]]:
    """Children of a node by name or number. Each has the kinds of quantity of its own name, or else
    those of the node. What is computed from a case, such as the summary of its record, has none to vary.
    """
    if isinstance(node, Part):
        return {}
    if isinstance(node, (tuple, list)) or np.ndim(node):
        return {k: (child, common_kind(kinds)) for k, child in enumerate(node)}
    if isinstance(node, Mapping):
        return {name: (child, element_kinds(kinds, name)) for name, child in node.items()}
    maker = getattr(node, "maker", type(node))  # the class or function that takes them
    arguments = arguments_of(node) or {}
    return {name: (child, kind_of_argument(maker, name, arguments) or kinds) for name, child in arguments.items()}


def _replace_values(node: Any, kinds: Kinds, changes: Any, path: Path) -> Any:
    """The node with the values of `wanted`, a tree of texts in SI or with a unit, in place of its own values."""
    if isinstance(changes, str):
        return _read(node, common_kind(kinds), changes, path)
    children = _children(node, kinds)
    for step in changes:
        if step not in children:
            varied = []
            for name, (child, _) in children.items():
                if isinstance(child, str) or any(_numbers(child, "", ())):
                    varied.append(str(name))
            fix = advise(str(step), varied) if varied else "vary one of its numbers"
            raise InputError(path_text((*path, step)), "is no value that the case gives", fix)
    changed = {step: _replace_values(*children[step], texts, (*path, step)) for step, texts in changes.items()}
    values = {step: child for step, (child, _) in children.items()} | changed
    if isinstance(node, Mapping):
        return values
    if isinstance(node, (tuple, list)):
        return type(node)(values.values())
    if np.ndim(node):
        return np.array([*values.values()])
    with placing_within(path_text(path)):
        return altered(node, **changed)


def _read(current: Any, kind: str, text: str, path: Path) -> Any:
    """Value of a text, in the type of the current value: a truth value, a word, or a number in SI or with a unit."""
    if isinstance(current, bool):
        if text not in ("true", "false"):
            raise InputError(path_text(path), f"is {text!r}", "write true or false")
        return text == "true"
    if isinstance(current, str):
        return text.strip('"')
    value = read_quantity(path_text(path), text, kind or "ratio")
    return int(value) if isinstance(current, int) and value == int(value) else value


def _numbers(node: Any, kinds: Kinds, path: Path) -> Iterator[tuple[Path, float, str]]:
    """Path, value and kind of every real number below a node. Counts (int) and long arrays are left out."""
    if isinstance(node, (bool, str, int)) or np.size(node) > _LONGEST:
        return
    if isinstance(node, float) or (hasattr(node, "dtype") and np.ndim(node) == 0):
        yield path, float(node), common_kind(kinds) or "ratio"
        return
    for step, (child, its_kinds) in _children(node, kinds).items():
        yield from _numbers(child, its_kinds, (*path, step))
