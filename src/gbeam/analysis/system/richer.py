"""Systems with more shapes, other theories or coarser meshes in the bodies that can be judged."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from gbeam.analysis.accuracy.correction import IntArray
from gbeam.analysis.accuracy.estimate import NO_MESH, unjudged
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory, theory_of
from gbeam.mechanics.tree.body_terms import stations_of
from gbeam.mechanics.tree.system import System
from gbeam.results.parts import Base

Directions = tuple[bool, bool, bool]  # flags of x, y and z
NOT_ALL = "shapes and model are not judged of {}: neither a beam, a mesh nor matrices"
IN_LOOPS = "shapes and models are not judged where joints close loops: compare with more shapes"


class Richer(NamedTuple):
    """A system with more shapes than the `original`, whose free coordinates have the indices `shared` among its own."""

    system: System
    shared: IntArray
    original: System
    renamed: Mapping[str, str]  # names in the richer system of coordinates whose numbers have changed


def judged_bodies(system: System) -> dict[str, Structure]:
    """Beams and solids whose shapes and models can be judged, by name: none where joints close loops."""
    return {name: body for name, body in system.flexible.items() if body.judged and not system.closing}


def judged_beams(system: System) -> dict[str, Structure]:
    """Beams among the bodies that can be judged, by name."""
    return {name: body for name, body in judged_bodies(system).items() if body.source is not None}


def left_unjudged(system: System) -> str:
    """Sentence about bodies, and about meshes, that are not judged, or empty if there are none."""
    if system.closing and any(body.size for body in system.flexible.values()):
        return IN_LOOPS
    heavy = [name for name, body in system.bodies.items() if name not in system.flexible and body.mass > 0]
    if len(system.flexible) == 1 and not heavy:  # beside a free hub at most
        return unjudged(*system.flexible.values())
    judged, sentences = judged_bodies(system), list[str]()
    remaining = [name for name, body in system.flexible.items() if body.size and name not in judged]
    if remaining:
        sentences.append(NOT_ALL.format(", ".join(remaining)))
    meshes = [name for name, body in judged.items() if body.source is None and body.coarser is None]
    if meshes:
        sentences.append(NO_MESH.replace("mesh", f"mesh of {', '.join(meshes)}"))
    return "; ".join(sentences)


def coarser(system: System) -> System | None:
    """Return the system with coarser meshes of its solids, in the same coordinates, or None if no solid has one."""
    rough = {
        name: replace(body.coarser, history=body.history, load_values=body.load_values)
        for name, body in system.flexible.items()
        if body.coarser is not None
    }
    return replace(system, bodies={**system.bodies, **rough}) if rough else None


def richer(
    system: System,
    bases: Mapping[str, Base],
    *,
    exact: bool,
    bent_directions: Mapping[str, Directions] = MappingProxyType({}),
) -> Richer:
    """Give more shapes to the bodies whose roots move as `bases`, in their own models or the exact one.

    Beams get new shapes `bent_directions` some of x, y and z, by default along all.
    """
    beams, original = dict[str, Structure](), dict[str, IntArray]()
    for name, base in bases.items():
        body = judged_bodies(system)[name]
        directions = bent_directions.get(name, (True, True, True))
        rich, original[name] = enrichment(body, base).model("exact" if exact else body.kind, directions=directions)
        beams[name] = replace(rich, history=body.history, load_values=body.load_values)
    richer_system = replace(system, bodies={**system.bodies, **beams})
    # Names of the bodies' coordinates in the richer system, where their numbers have changed.
    renamed = {
        f"{name}.q{k + 1}": f"{name}.q{place + 1}" for name, index in original.items() for k, place in enumerate(index)
    }
    numbers = {name: k for k, name in enumerate(richer_system.coordinates)}
    indices = np.array([numbers[renamed.get(name, name)] for name in system.coordinates], dtype=int)
    return Richer(
        richer_system, np.searchsorted(richer_system.tree.unknowns, indices[system.tree.unknowns]), system, renamed
    )


def linear_about_rest(system: System, bodies: Iterable[str]) -> System:
    """The system in which some `bodies` have equations that are linear about their undeformed shapes."""
    linear = {name: replace(system.flexible[name], linear=True) for name in bodies}
    return replace(system, bodies={**system.bodies, **linear})


def theories_of(system: System, *, straight: bool = False) -> dict[str, Theory]:
    """Slender and thick models of the judged beams, by name: exact ones, or linear ones about `straight` beams.

    Bodies and forces may act on the beams' stations.
    """
    tree, theories = system.tree, dict[str, Theory]()
    loaded = [(link.parent, link.on) for link in tree.links] + [(force.body, force.on) for force in tree.forces]
    for name, body in judged_beams(system).items():
        number, stations = system.order.index(name), [*stations_of(body).values()]
        hung = {stations[point] for owner, point in loaded if owner == number and point < len(stations)}
        theory = theory_of(body, tuple(sorted(hung)))
        theories[name] = theory if straight else theory.exact
    return theories


def with_beams(system: System, beams: Mapping[str, Structure]) -> System:
    """Return the system with other structures in place of some of its beams, under the same loads."""
    judged = judged_beams(system)
    bodies_kept = dict[str, Structure]()
    for name, beam in beams.items():
        body = judged[name]
        bodies_kept[name] = replace(beam, source=body.source, history=body.history, load_values=body.load_values)
    return replace(system, bodies={**system.bodies, **bodies_kept})
