"""Systems with more shapes in their beams: solutions put into them, what these leave there, and small departures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.accuracy.correction import RESOLVED, Correction
from gbeam.analysis.system.histories import Carried, carried, loads_of
from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import LinearEquations, Trajectory, slopes
from gbeam.integrate.schemes import generalized_alpha
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory, theory_of
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.system import System, stations_of
from gbeam.motion.bases.base import Base
from gbeam.numerics.eigen import symmetric, symmetric_modes

Array = Any
Floats = NDArray[np.float64]
IntArray = NDArray[np.int_]
LOOKED = 61  # times at which M, C and K are found; between them they are straight lines
AT_ONCE = 20_000  # numbers of a state's frames computed together, times coordinates
NOT_ALL = "shapes and model are not judged of {}: neither a beam, a mesh nor matrices"
NO_MESH = "the mesh of {} is not judged"

InputsOf = Callable[[System, Any], Inputs]  # of a system with the same joints, at some (index) of the times
Quantity = tuple[str, str]  # a beam, or none, and what is read of it
PLACE: Quantity = ("", "place")


class Richer(NamedTuple):
    """A system with more shapes, which of its unknown coordinates are those of the system that lacks them, and that."""

    system: System
    shared: IntArray
    of: System
    renamed: Mapping[str, str]  # names there of those of its coordinates that are called otherwise

    def lifted(self, y: Floats) -> Floats:
        """Coordinates (..., n) of the system as those of the richer one."""
        out = np.zeros((*y.shape[:-1], len(self.system.tree.free)))
        out[..., self.shared] = y
        return out


def judged_bodies(system: System) -> dict[str, Structure]:
    """Beams and solids of which it is known what they lack, by name."""
    return {name: body for name, body in system.bodies.items() if isinstance(body, Structure) and body.judged}


def judged_beams(system: System) -> dict[str, Structure]:
    """Beams of which that is known, by name."""
    return {name: body for name, body in judged_bodies(system).items() if body.source is not None}


def left_unjudged(system: System) -> str:
    """The bodies of which nothing, or not the mesh, is judged, in words."""
    judged = judged_bodies(system)
    others = [name for name, body in system.bodies.items() if isinstance(body, Structure) and name not in judged]
    meshes = [name for name, body in judged.items() if body.source is None]
    pairs = (NOT_ALL, others), (NO_MESH, meshes)
    return "; ".join(words.format(", ".join(names)) for words, names in pairs if names)


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


def pieces(count: int, size: int) -> list[slice]:
    """Stretches of so many times of which all frames are held in memory at once."""
    step = max(1, AT_ONCE // max(size, 1))
    return [slice(first, first + step) for first in range(0, count, step)]


class Answered(NamedTuple):
    """A solution in a richer system, and what is driven there."""

    rich: Richer
    of: Trajectory
    inputs: InputsOf

    def residual(self) -> Floats:
        """Residual (t, n) of the richer system's equations, less that of the one that lacks the shapes."""
        rich, original = self.rich.system, self.rich.shared
        out = []
        for s in pieces(len(self.of.time), rich.tree.size):
            y, yd, ydd = self.of.q[s], self.of.qd[s], self.of.qdd[s]
            left = rich.tree(y, yd, ydd, self.inputs(rich, s))
            # At a jump of what drives it a solution leaves something of its own.
            left[:, original] -= self.rich.of.tree(
                y[:, original], yd[:, original], ydd[:, original], self.inputs(self.rich.of, s)
            )
            out.append(left)
        return np.concatenate(out)

    def moved(self, by: Correction) -> Answered:
        """The solution with a correction added."""
        of = self.of
        return self._replace(of=replace(of, q=of.q + by.value, qd=of.qd + by.rate, qdd=of.qdd + by.acceleration))

    def places(self) -> Floats:
        """Places of all points, (t, p, 3) m."""
        return self.read(())[PLACE]

    def read(self, beams: Iterable[str]) -> dict[Quantity, Floats]:
        """Places (t, p, 3) m of all points, and of some bodies the force and moment (t, 3) at the root and the largest
        size of the normal stress, and that of von Mises, over the sections (t, 1), or a solid's stress (t, c).
        """
        system, places, pieces_of = self.rich.system, [], {name: list[Carried]() for name in beams}
        for s in pieces(len(self.of.time), system.tree.size):
            inputs = self.inputs(system, s)
            state = system.tree.motion(self.of.q[s], self.of.qd[s], self.of.qdd[s], inputs)
            places.append(np.stack([frame.p for frame in state.every_point], axis=1))
            if pieces_of:
                acting = system.tree.demanded(state, inputs)[2]
                for name, each in pieces_of.items():
                    each.append(carried(system, state, name, acting))
        out = {PLACE: np.concatenate(places)}
        for name, each in pieces_of.items():
            loads = loads_of(system.bodies[name], each, self.of.time)  # type: ignore[arg-type]
            sheared = loads.stress if loads.von_mises is None else np.nan_to_num(loads.von_mises)
            stress, recovery = loads.stress.max(axis=1)[:, None], system.bodies[name].recovery  # type: ignore[union-attr]
            if recovery is not None:
                stress = recovery.felt(np.concatenate([part.q for part in each]))
            out |= {(name, "force"): loads.root_force, (name, "moment"): loads.root_moment}
            out |= {
                (name, "stress"): stress,
                (name, "sheared"): sheared.max(axis=1)[:, None],
            }
        return out


def answered(rich: Richer, of: Trajectory, inputs: InputsOf) -> Answered:
    """A trajectory in a richer system."""
    q, qd, qdd = (rich.lifted(np.asarray(each)) for each in (of.q, of.qd, of.qdd))
    return Answered(rich, replace(of, q=q, qd=qd, qdd=qdd), inputs)


def itself(system: System) -> Richer:
    """A system that lacks nothing of itself."""
    return Richer(system, np.arange(len(system.tree.free)), system, {})


def follower(at: Answered, *, settled: bool) -> Callable[[Floats, Floats | float], Correction]:
    """Departures (t, n) of the richer system, stiffer by so much (n, n), by a residual (t, n), over time or, of one
    time, at rest; bodies begin where they rest or as they are. Modes that are too fast for the steps follow statically,
    by a scheme that damps them out.
    """
    of, tree, time = at.of, at.rich.system.tree, at.of.time
    count = len(time)
    chosen = np.unique(np.linspace(0, count - 1, min(count, LOOKED)).astype(int))
    linear = [slopes(tree, of.q[[i]], of.qd[[i]], of.qdd[[i]], at.inputs(at.rich.system, [i])) for i in chosen]
    k, c, m = (np.concatenate(each) for each in zip(*linear, strict=True))
    if count == 1:
        still = np.zeros_like(of.q)
        return lambda residual, stiffer: Correction(
            np.linalg.lstsq(k[0] + stiffer, -residual[0], rcond=1e-12)[0][None], still, still
        )
    back = np.linalg.inv(m)
    c = back @ c
    n, step = m.shape[-1], float(time[-1] - time[0]) / (count - 1)

    def between(values: Floats, place: Floats) -> Floats:
        low = np.clip(np.searchsorted(chosen, place, side="right") - 1, 0, len(chosen) - 2)
        share = ((place - chosen[low]) / (chosen[low + 1] - chosen[low])).reshape(-1, *[1] * (values.ndim - 1))
        return np.asarray(values[low] * (1 - share) + values[low + 1] * share)

    def respond(residual: Floats, stiffer: Floats | float) -> Correction:
        stiffness = k + stiffer
        shapes, resting = _resting(at, stiffness[0], m[0], settled=settled)
        # Unknown are how far some modes are away, and the accelerations of the others and of the joints.
        unknown = np.where(resting, stiffness[0] @ shapes, m[0] @ shapes)
        start = shapes @ np.where(resting, np.linalg.solve(unknown, -residual[0]), 0.0)
        stiffness = back @ stiffness
        force = -(between(back, np.arange(float(count))) @ residual[..., None])[..., 0]

        def matrices(place: Any) -> tuple[Floats, Floats, Floats]:
            low = np.minimum(place.astype(int), count - 2)
            share = (place - low)[:, None]
            return between(c, place), between(stiffness, place), force[low] * (1 - share) + force[low + 1] * share

        def drive(t: Any) -> Any:
            return np.clip((np.asarray(t) - time[0]) / step, 0, count - 1)

        equations = LinearEquations(np.eye(n), matrices, drive)
        moved = integrate(
            equations, generalized_alpha(0.0), start, 0 * start, step=step, count=count - 1, start=float(time[0])
        )
        if not moved.whole:
            return Correction(*np.full((3, count, n), np.nan))
        return Correction(np.asarray(moved.q), np.asarray(moved.qd), np.asarray(moved.qdd))

    return respond


def _resting(at: Answered, k: Floats, m: Floats, *, settled: bool) -> tuple[Floats, NDArray[np.bool_]]:
    """Modes of the bodies (n, n) at the first time, joints held, and which begin at rest: too fast ones, or all."""
    system, time = at.rich.system, at.of.time
    elastic = np.array([".q" in system.coordinates[each] for each in system.tree.free], dtype=bool)
    shapes, inside = np.eye(len(elastic)), np.ix_(elastic, elastic)
    square, shapes[inside] = symmetric_modes(*(symmetric(each[inside]) for each in (k, m)))
    resting = np.zeros(len(elastic), dtype=bool)
    resting[elastic] = settled | (np.sqrt(np.maximum(square, 0.0)) * (time[1] - time[0]) > RESOLVED)
    return shapes, resting


def bases_of(system: System, of: Trajectory, inputs: InputsOf) -> dict[str, Base]:
    """Motions of the roots of the bodies that can be judged, at some of the times (t, 3)."""
    some = np.unique(np.linspace(0, len(of.time) - 1, min(len(of.time), LOOKED)).astype(int))
    state = system.tree.motion(of.q[some], of.qd[some], of.qdd[some], inputs(system, some))
    roots = {name: state.roots[k] for k, name in enumerate(system.order)}
    return {name: Base(roots[name].a, roots[name].w, roots[name].alpha) for name in judged_bodies(system)}
