"""Templates of studies: a scenario, or a case made in Python, of which cases with other values are made.

A change is the text ``PATH=VALUE`` for both. Of a case the path leads through the arguments that its objects are made
with, which have the names of a scenario's keys: ``beam.section.width``, ``motion.hub.radius``.
"""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.analysis.case import AnyCase, Case, SpecimenCase, SystemCase
from gbeam.analysis.system.histories import beams_of
from gbeam.arrays.tree import altered, arguments_of
from gbeam.errors import InputError, placing_within
from gbeam.guards.kinds import KINDS, Kinds, below, kind_of_argument, only
from gbeam.guards.units import read_quantity
from gbeam.mechanics.assembly import assemble, model_of
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import GROUND
from gbeam.mechanics.tree.system import RigidBody, System
from gbeam.printable import advise
from gbeam.results.provenance import Provenance
from gbeam.scenario.bodies.beam import BeamBody
from gbeam.scenario.build import build, scenario_of
from gbeam.scenario.load import change, provenance
from gbeam.scenario.schema import Centrifuge
from gbeam.scenario.schema.fields import kind_of, quantities
from gbeam.scenario.schema.scenario import Sweep as SweepTable
from gbeam.scenario.values import Distribution, Path, parse_path, path_text
from gbeam.structure.beam import Beam

if TYPE_CHECKING:
    from gbeam.scenario.load import AnyScenario

_KINDS: Kinds = {"system": {"gravity": "acceleration"}}  # of what is no argument of an object of a case
_LONGEST = 100  # numbers of a list that are values of a study; more are a record


@dataclass(frozen=True)
class ScenarioTemplate:
    """A validated scenario that was read from a file."""

    scenario: AnyScenario

    @property
    def title(self) -> str:
        """Title of all cases."""
        return self.scenario.title

    @property
    def of_system(self) -> bool:
        """True if the cases are systems of bodies."""
        return "joints" in type(self.scenario).model_fields

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions, or of the ground at rest where there is none."""
        return tuple(self.scenario.motion) or (GROUND,)

    @property
    def beams(self) -> tuple[str, ...]:
        """Names of the bodies of a system that are beams."""
        bodies = getattr(self.scenario, "bodies", {})
        return tuple(name for name, body in bodies.items() if isinstance(body, BeamBody))

    @property
    def imitations(self) -> dict[str, bool]:
        """Centrifuges that track a flight, by name, each with whether limits of acceptance are set."""
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
        """Words by which a store of cases knows the template."""
        source = self.scenario.source
        assert source is not None
        digest = hashlib.sha256(source.text.encode()).hexdigest()
        return {"scenario": digest, "changes": [each.text for each in source.overrides]}

    def changed(self, changes: Sequence[str]) -> ScenarioTemplate:
        """The template with changes PATH=VALUE; GbeamError if one is impossible."""
        assert self.scenario.source is not None
        return ScenarioTemplate(change(self.scenario.source, changes)) if changes else self

    def built(self) -> AnyCase:
        """Its objects."""
        return build(self.scenario)

    def quantities(self) -> dict[str, tuple[float, str]]:
        """Value in SI and kind of every quantity, by path."""
        return quantities(self.scenario)

    def unit(self, path: str) -> str:
        """SI unit of the quantity at a path; empty where it has none."""
        node: Any = self.scenario
        kind = ""
        for step in parse_path(path) or ():
            if isinstance(step, str) and hasattr(type(node), "model_fields"):
                kind = kind_of(node, step)  # a number of a list has that of the list
            entry = isinstance(node, (Mapping, tuple, list))
            node = node[step] if entry else getattr(node, str(step), None)
        return KINDS[kind].unit if kind else ""


class _BeamBody:
    """A beam in its model, as a body of a system: varied by the arguments of the beam, and `model`."""

    owner = "Beam"

    def __init__(self, structure: Structure, beam: Beam) -> None:
        self.structure = structure
        self.arguments = (arguments_of(beam) or {}) | {"model": model_of(structure)}

    def altered(self, **changes: Any) -> Structure:
        """The structure of other arguments; its stations stay those within the beam."""
        arguments = self.arguments | changes
        model, beam = arguments.pop("model"), Beam(**arguments)
        return assemble(beam, model, [at for at in self.structure.stations[:-1] if at < beam.length])


@dataclass(frozen=True)
class CaseTemplate:
    """A case made in Python, with the members of a ScenarioTemplate; its values are arguments of its objects, in SI."""

    case: AnyCase

    table = None

    @property
    def of_system(self) -> bool:
        return isinstance(self.case, SystemCase)

    @property
    def title(self) -> str:
        return self.case.title

    @property
    def motions(self) -> tuple[str, ...]:
        return tuple(self.case.environments)

    @property
    def beams(self) -> tuple[str, ...]:
        return tuple(beams_of(self.case.system)) if isinstance(self.case, SystemCase) else ()

    @property
    def imitations(self) -> dict[str, bool]:
        return {name: bool(self.case.accept.get(name)) for name in self.case.tracks}

    @property
    def distributions(self) -> Mapping[str, Distribution]:
        return {}

    @property
    def provenance(self) -> Provenance | None:
        return self.case.provenance

    @property
    def identity(self) -> dict[str, Any]:
        try:
            content = pickle.dumps(self.case)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            fix = "define its classes at the top level of a module, or leave the store out"
            raise InputError("store", f"cannot know the case again, which cannot be pickled ({error})", fix) from None
        return {"scenario": hashlib.sha256(content).hexdigest(), "changes": []}

    @property
    def _tree(self) -> dict[str, Any]:
        case = self.case
        of_all = {"motion": case.motions, "response": case.response}
        if isinstance(case, Case):
            return {"beam": case.beam, "model": case.model} | of_all
        if isinstance(case, SpecimenCase):  # which does not hold what its structure was reduced from
            return of_all
        system = case.system
        bodies: dict[str, Any] = {}
        for name, body in system.bodies.items():
            if isinstance(body, RigidBody):
                bodies[name] = body
            elif body.source is not None:  # of particles no value is known
                bodies[name] = _BeamBody(body, body.source.beam)
        gravity = {} if system.gravity is None else {"gravity": system.gravity}
        parts = {name: getattr(system, name) for name in ("joints", "forces", "controllers")}
        return {"bodies": bodies} | parts | {"system": gravity} | of_all

    def changed(self, changes: Sequence[str]) -> CaseTemplate:
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
                if not isinstance(node.get(step), dict):  # the last of several changes of one place counts
                    node[step] = {}
                node = node[step]
            node[steps[-1]] = value.strip()
        parts = _with(self._tree, _KINDS, wanted, ())
        motions: dict[str, Any] = parts.pop("motion")
        for machine, flight in self.case.tracks.items():
            if motions.get(flight) is not self.case.motions.get(flight):
                motions[machine] = motions[machine].altered(flight=motions[flight])
        if isinstance(self.case, SystemCase):
            system = self.case.system
            changed = {name: getattr(each, "structure", each) for name, each in parts.pop("bodies").items()}
            gravity = parts.pop("system").get("gravity")
            others = {name: parts.pop(name) for name in ("joints", "forces", "controllers")}
            parts["system"] = System({**system.bodies, **changed}, gravity=gravity, **others)
        return CaseTemplate(replace(self.case, **parts, motions=motions))

    def built(self) -> AnyCase:
        return self.case

    def quantities(self) -> dict[str, tuple[float, str]]:
        every = {path_text(path): (value, kind) for path, value, kind in _numbers(self._tree, _KINDS, ())}
        # A machine that tracks a flight of the case has it from there.
        copies = tuple(f"motion.{machine}.flight." for machine in self.case.tracks)
        return {path: each for path, each in every.items() if not path.startswith(copies)}

    def unit(self, path: str) -> str:
        node: Any = self._tree
        kinds = _KINDS
        for step in parse_path(path) or ():
            node, kinds = _below(node, kinds).get(step, (None, ""))
        return KINDS[kind].unit if (kind := only(kinds)) else ""


Template = ScenarioTemplate | CaseTemplate


def template_of(
    scenario: str | os.PathLike[str] | AnyCase, overrides: Sequence[str] = (), *, distributions: bool = False
) -> Template:
    """Return the template that a scenario's file or a case is, with changes."""
    if isinstance(scenario, AnyCase) and scenario.scenario is None:
        return CaseTemplate(scenario).changed(tuple(overrides))
    return ScenarioTemplate(scenario_of(scenario, overrides, distributions=distributions))


def _below(node: Any, kinds: Kinds) -> dict[Any, tuple[Any, Kinds]]:
    """Children of a node by name or number, of their own kind of quantity or of that which they are arguments of."""
    if isinstance(node, (tuple, list)) or np.ndim(node):
        return {k: (each, only(kinds)) for k, each in enumerate(node)}
    if isinstance(node, Mapping):
        return {name: (each, below(kinds, name)) for name, each in node.items()}
    owner, arguments = getattr(node, "owner", type(node).__name__), arguments_of(node) or {}
    return {name: (each, kind_of_argument(owner, name, arguments) or kinds) for name, each in arguments.items()}


def _with(node: Any, kinds: Kinds, wanted: Any, path: Path) -> Any:
    """The node with other values, SI or text with a unit, at some places below it."""
    if isinstance(wanted, str):
        return _read(node, only(kinds), wanted, path)
    known = _below(node, kinds)
    for step in wanted:
        if step not in known:
            below = [
                str(name) for name, (each, _) in known.items() if isinstance(each, str) or any(_numbers(each, "", ()))
            ]
            fix = advise(str(step), below) if below else "vary one of its numbers"
            raise InputError(path_text((*path, step)), "is no value that the case gives", fix)
    changed = {step: _with(*known[step], each, (*path, step)) for step, each in wanted.items()}
    every = {step: each for step, (each, _) in known.items()} | changed
    if isinstance(node, Mapping):
        return every
    if isinstance(node, (tuple, list)):
        return type(node)(every.values())
    if np.ndim(node):
        return np.array([*every.values()])
    with placing_within(path_text(path)):
        return altered(node, **changed)


def _read(current: Any, kind: str, text: str, path: Path) -> Any:
    """A value of what stands at a place: a word, a truth, a number in SI or with a unit."""
    if isinstance(current, bool):
        if text not in ("true", "false"):
            raise InputError(path_text(path), f"is {text!r}", "write true or false")
        return text == "true"
    if isinstance(current, str):
        return text.strip('"')
    value = read_quantity(path_text(path), text, kind or "ratio")
    return int(value) if isinstance(current, int) and value == int(value) else value


def _numbers(node: Any, kinds: Kinds, path: Path) -> Iterator[tuple[Path, float, str]]:
    """Every number below a node, with its path and kind; counts are none."""
    if isinstance(node, (bool, str, int)) or np.size(node) > _LONGEST:
        return
    if isinstance(node, float) or (hasattr(node, "dtype") and np.ndim(node) == 0):
        yield path, float(node), only(kinds) or "ratio"
        return
    for step, (value, of) in _below(node, kinds).items():
        yield from _numbers(value, of, (*path, step))
