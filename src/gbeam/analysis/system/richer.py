"""Systems with more shapes in their beams: solutions put into them, what these leave there, and small departures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.accuracy.correction import PLACE, Posed, Quantity, looked, pieces
from gbeam.analysis.accuracy.estimate import NO_MESH
from gbeam.analysis.system.histories import Carried, carried, loads_of
from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.plausibility import unstiffened
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory, theory_of
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.system import RigidBody, System, stations_of
from gbeam.results.parts import Base

IntArray = NDArray[np.int_]
NOT_ALL = "shapes and model are not judged of {}: neither a beam, a mesh nor matrices"
InputsOf = Callable[[System, Any], Inputs]  # of a system with the same joints, at some (index) of the times


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


def posed(system: System, inputs: InputsOf, bodies: Iterable[str]) -> Posed:
    """The equations of a system at the times of a solution, and what is read of some of its bodies."""
    names = [system.coordinates[k] for k in system.tree.free]
    return Posed(system.tree, partial(inputs, system), names, lambda of: read(system, of, inputs, bodies))


def read(system: System, of: Trajectory, inputs: InputsOf, bodies: Iterable[str]) -> dict[Quantity, Floats]:
    """Places (t, p, 3) m of all points, and of some bodies the force and moment (t, 3) at the root and the largest
    size of the normal stress, and that of von Mises, over the sections (t,), or a solid's stress (t, c).
    """
    places, along = list[Floats](), {name: list[Carried]() for name in bodies}
    for some in pieces(len(of.time), system.tree.size):
        now, at = inputs(system, some), of.at(some)
        state = system.tree.motion(at.q, at.qd, at.qdd if along else 0 * at.q, now)
        places.append(np.stack([frame.p for frame in state.every_point], axis=1))
        if along:
            acting = system.tree.demanded(state, now)[2]
            for name, each in along.items():
                each.append(carried(system, state, name, acting))
    out = {PLACE: np.concatenate(places)}
    for name, each in along.items():
        loads = loads_of(system.bodies[name], each, of.time)  # type: ignore[arg-type]
        sheared = loads.stress if loads.von_mises is None else np.nan_to_num(loads.von_mises)
        stress, recovery = loads.stress.max(axis=1), system.bodies[name].recovery  # type: ignore[union-attr]
        if recovery is not None:
            stress = recovery.felt(np.concatenate([part.q for part in each]))
        out |= {(name, "force"): loads.root_force, (name, "moment"): loads.root_moment}
        out |= {(name, "stress"): stress, (name, "sheared"): sheared.max(axis=1)}
    return out


def turning(system: System, of: Trajectory, inputs: InputsOf) -> Floats:
    """Places (t, 3 k, 3) m from the root, ground's axes, of three points at the radius of gyration of each rigid body
    that has no points beside its root, which do not show how it turns.
    """
    radii = dict[int, float]()
    for k, name in enumerate(system.order):
        body = system.bodies[name]
        if isinstance(body, RigidBody) and not np.any(body.body.places) and body.mass > 0:
            about_root = np.trace(body.tensor) / (2 * body.mass) + np.square(body.centre).sum()
            radii[k] = float(np.sqrt(about_root))
    turned = list[Floats]()
    for some in pieces(len(of.time), system.tree.size) if radii else ():
        at = of.at(some)
        roots = system.tree.motion(at.q, at.qd, 0 * at.q, inputs(system, some)).roots
        axes = [radius * np.swapaxes(roots[k].R, -1, -2) for k, radius in radii.items()]
        turned.append(np.concatenate([np.broadcast_to(each, (len(at.q), 3, 3)) for each in axes], axis=1))
    return np.concatenate(turned) if turned else np.zeros((len(of.time), 0, 3))


def bases_of(system: System, of: Trajectory, inputs: InputsOf, bodies: Iterable[str]) -> dict[str, Base]:
    """Motions of the roots of some bodies, at some of the times (t, 3)."""
    some = looked(len(of.time))
    at = of.at(some)
    state = system.tree.motion(at.q, at.qd, at.qdd, inputs(system, some))
    roots = {name: state.roots[k] for k, name in enumerate(system.order)}
    return {name: Base(roots[name].a, roots[name].w, roots[name].alpha) for name in bodies}


def stiffness_left_out(system: System, of: Trajectory, inputs: InputsOf) -> tuple[str, ...]:
    """Warnings of how large the stiffness by loads is that bodies by matrices lack, in the motion of their roots."""
    lacking = [name for name, body in system.flexible.items() if body.unstiffened]
    bases = bases_of(system, of, inputs, lacking) if lacking else {}
    said = ((name, unstiffened(system.flexible[name], base, "its motion")) for name, base in bases.items())
    return tuple(f"{name}: {each}" for name, words in said for each in words)
