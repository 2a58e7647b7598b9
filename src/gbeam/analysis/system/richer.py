"""Systems with more shapes, other theories or coarser meshes in the bodies of which it is known what they lack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gbeam.analysis.accuracy.correction import IntArray
from gbeam.analysis.accuracy.estimate import NO_MESH
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory, theory_of
from gbeam.mechanics.tree.system import System, stations_of
from gbeam.results.parts import Base

NOT_ALL = "shapes and model are not judged of {}: neither a beam, a mesh nor matrices"


class Richer(NamedTuple):
    """A system with more shapes, which of its unknown coordinates are those of the system that lacks them, and that."""

    system: System
    shared: IntArray
    of: System
    renamed: Mapping[str, str]  # names there of those of its coordinates that are called otherwise


def judged_bodies(system: System) -> dict[str, Structure]:
    """Beams and solids of which it is known what they lack, by name."""
    return {name: body for name, body in system.flexible.items() if body.judged}


def judged_beams(system: System) -> dict[str, Structure]:
    """Beams of which that is known, by name."""
    return {name: body for name, body in judged_bodies(system).items() if body.source is not None}


def left_unjudged(system: System) -> str:
    """The bodies of which nothing, or not the mesh, is judged, in words."""
    judged = judged_bodies(system)
    others = [name for name in system.flexible if name not in judged]
    said = [NOT_ALL.format(", ".join(others))] if others else []
    meshes = [name for name, body in judged.items() if body.source is None and body.coarser is None]
    return "; ".join(said + ([NO_MESH.replace("mesh", f"mesh of {', '.join(meshes)}")] if meshes else []))


def coarser(system: System) -> System | None:
    """The system with coarser meshes of its solids, in the same coordinates; None where none has one."""
    rough = {
        name: replace(body.coarser, load_values=body.load_values)
        for name, body in system.flexible.items()
        if body.coarser is not None
    }
    return replace(system, bodies={**system.bodies, **rough}) if rough else None


def richer(system: System, bases: Mapping[str, Base], *, exact: bool) -> Richer:
    """More shapes in the bodies that are named, whose roots move as bases do, of exact models or of their own."""
    beams, original = dict[str, Structure](), dict[str, IntArray]()
    for name, base in bases.items():
        body = judged_bodies(system)[name]
        rich, original[name] = enrichment(body, base).model("exact" if exact else body.kind)
        beams[name] = replace(rich, load_values=body.load_values)
    other = replace(system, bodies={**system.bodies, **beams})
    renamed = {
        f"{name}.q{k + 1}": f"{name}.q{at + 1}" for name, index in original.items() for k, at in enumerate(index)
    }
    at = {name: k for k, name in enumerate(other.coordinates)}
    every = np.array([at[renamed.get(name, name)] for name in system.coordinates], dtype=int)
    return Richer(other, np.searchsorted(other.tree.free, every[system.tree.free]), system, renamed)


def theories_of(system: System) -> dict[str, Theory]:
    """The beams that can be judged by two theories, by name, with what hangs and acts on their stations."""
    tree, out = system.tree, dict[str, Theory]()
    loaded = [(each.parent, each.on) for each in tree.links] + [(each.body, each.on) for each in tree.forces]
    for name, body in judged_beams(system).items():
        at, stations = system.order.index(name), [*stations_of(body).values()]
        hung = {stations[on] for of, on in loaded if of == at and on < len(stations)}
        out[name] = theory_of(body, tuple(sorted(hung))).exact
    return out


def with_beams(system: System, beams: Mapping[str, Structure]) -> System:
    """A system with other structures of some beams, under the same loads."""
    judged = judged_beams(system)
    kept = {
        name: replace(each, source=judged[name].source, load_values=judged[name].load_values)
        for name, each in beams.items()
    }
    return replace(system, bodies={**system.bodies, **kept})
