"""Errors of a system's answers from too few shapes of its beams and from their models, of every beam and of all.

What is computed is put into the exact model of the same system with more shapes. The residual that it leaves there is
answered by that system's small departures, over time or at rest; in the new coordinates alone it is what shapes lack.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import ComputationError
from gbeam.integrate.derivatives import slopes
from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import LinearEquations, Trajectory
from gbeam.integrate.schemes import generalized_alpha
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.system import System
from gbeam.motion.bases.base import Base
from gbeam.results.errors import ErrorEstimate, SystemErrors

if TYPE_CHECKING:
    from gbeam.analysis.system.point import Point

Array = Any
Floats = NDArray[np.float64]
IntArray = NDArray[np.int_]
FEWEST = 3  # times of a response that is judged
LOOKED = 61  # times at which M, C and K are found; between them they are straight lines
AT_ONCE = 20_000  # numbers of a state's frames computed together, times coordinates
NOT_ALL = "shapes and model are not judged of {}, which is made of no beam"
FAR = "shapes and models are not judged: a system with more shapes does not follow"

InputsOf = Callable[[System, Any], Inputs]  # of a system with the same joints, at some (index) of the times


class Richer(NamedTuple):
    """A system with more shapes, which of its unknown coordinates are those of the system that lacks them, and that."""

    system: System
    own: IntArray
    of: System
    renamed: Mapping[str, str]  # names there of those of its coordinates that are called otherwise

    def lifted(self, y: Floats) -> Floats:
        """Coordinates (..., n) of the system as those of the richer one."""
        out = np.zeros((*y.shape[:-1], len(self.system.tree.free)))
        out[..., self.own] = y
        return out


def judged_beams(system: System) -> dict[str, Structure]:
    """Bodies whose shapes and model can be judged, by name."""
    return {
        name: body
        for name, body in system.bodies.items()
        if isinstance(body, Structure) and body.source is not None and not body.traced
    }


def richer(system: System, bases: Mapping[str, Base], *, exact: bool) -> Richer:
    """More shapes in the beams that are named, whose roots move as bases do, of exact models or of their own."""
    beams, own = dict[str, Structure](), dict[str, IntArray]()
    for name, base in bases.items():
        body = judged_beams(system)[name]
        rich, own[name] = enrichment(body, base).model("exact" if exact else body.kind)
        beams[name] = replace(rich, load_values=body.load_values)
    other = replace(system, bodies={**system.bodies, **beams})
    renamed = {f"{name}.q{k + 1}": f"{name}.q{at + 1}" for name, index in own.items() for k, at in enumerate(index)}
    at = {name: k for k, name in enumerate(other.coordinates)}
    every = np.array([at[renamed.get(name, name)] for name in system.coordinates], dtype=int)
    return Richer(other, np.searchsorted(other.tree.free, every[system.tree.free]), system, renamed)


def pieces(count: int, size: int) -> list[slice]:
    """Stretches of so many times of which all frames are held in memory at once."""
    step = max(1, AT_ONCE // max(size, 1))
    return [slice(first, first + step) for first in range(0, count, step)]


class Answered(NamedTuple):
    """A solution (t, n) in a richer system, and what is driven there."""

    rich: Richer
    y: Floats
    yd: Floats
    ydd: Floats
    inputs: InputsOf

    def residual(self) -> Floats:
        """Residual (t, n) of the richer system's equations, less that of the one that lacks the shapes."""
        rich, own = self.rich.system, self.rich.own
        out = []
        for s in pieces(len(self.y), rich.tree.size):
            y, yd, ydd = self.y[s], self.yd[s], self.ydd[s]
            left = rich.tree(y, yd, ydd, self.inputs(rich, s))
            # At a jump of what drives it a solution leaves something of its own.
            left[:, own] -= self.rich.of.tree(y[:, own], yd[:, own], ydd[:, own], self.inputs(self.rich.of, s))
            out.append(left)
        return np.concatenate(out)

    def places(self, moved: Floats | float = 0.0) -> Floats:
        """Places of all points (t, p, 3) m, with corrections (t, n) added."""
        y, system = self.y + moved, self.rich.system
        states = (
            system.tree.motion(y[s], self.yd[s], self.ydd[s], self.inputs(system, s))
            for s in pieces(len(y), system.tree.size)
        )
        return np.concatenate([np.stack([frame.p for frame in state.every_point], axis=1) for state in states])


def answered(rich: Richer, of: Trajectory, inputs: InputsOf) -> Answered:
    """A trajectory in a richer system."""
    y, yd, ydd = (rich.lifted(np.asarray(each)) for each in (of.q, of.qd, of.qdd))
    return Answered(rich, y, yd, ydd, inputs)


def follower(at: Answered, time: Floats) -> Callable[[Floats, tuple[Floats, Floats]], Floats]:
    """Departures (t, n) of the richer system over time by a residual (t, n) and a first state; modes that are too fast
    for the steps follow statically, by a scheme that damps them out.
    """
    count = len(time)
    chosen = np.unique(np.linspace(0, count - 1, min(count, LOOKED)).astype(int))
    tree, system = at.rich.system.tree, at.rich.system
    found = [slopes(tree, at.y[[i]], at.yd[[i]], at.ydd[[i]], at.inputs(system, [i])) for i in chosen]
    k, c, m = (np.concatenate(each) for each in zip(*found, strict=True))
    back = np.linalg.inv(m)
    c, k = back @ c, back @ k
    n, step = m.shape[-1], float(time[-1] - time[0]) / (count - 1)

    def between(values: Floats, place: Floats) -> Floats:
        low = np.clip(np.searchsorted(chosen, place, side="right") - 1, 0, len(chosen) - 2)
        share = ((place - chosen[low]) / (chosen[low + 1] - chosen[low])).reshape(-1, *[1] * (values.ndim - 1))
        return np.asarray(values[low] * (1 - share) + values[low + 1] * share)

    def respond(residual: Floats, start: tuple[Floats, Floats]) -> Floats:
        force = -(between(back, np.arange(float(count))) @ residual[..., None])[..., 0]

        def matrices(place: Any) -> tuple[Floats, Floats, Floats]:
            low = np.minimum(place.astype(int), count - 2)
            share = (place - low)[:, None]
            return between(c, place), between(k, place), force[low] * (1 - share) + force[low + 1] * share

        def drive(t: Any) -> Any:
            return np.clip((np.asarray(t) - time[0]) / step, 0, count - 1)

        equations = LinearEquations(np.eye(n), matrices, drive)
        moved = integrate(equations, generalized_alpha(0.0), *start, step=step, count=count - 1, start=float(time[0]))
        return np.asarray(moved.q) if moved.whole else np.full((count, n), np.nan)

    return respond


def system_errors(
    system: System,
    of: Trajectory,
    inputs: InputsOf,
    begun: Callable[[System], Point],
    again: Callable[[System], Trajectory] | None,
    step: float,
    start: Floats | None = None,
) -> SystemErrors:
    """Errors of the places of all points, as fractions of the largest displacement, from the first of them or a `start`
    (p, 3), of every beam and in all, beside that of the steps. Richer systems are run `again` if it is given: where
    controllers answer what is lacking, and at rest.
    """
    judged = judged_beams(system)
    others = [name for name, body in system.bodies.items() if isinstance(body, Structure) and name not in judged]
    note = NOT_ALL.format(", ".join(others)) if others else ""
    if not judged or (again is None and len(of.time) < FEWEST):
        none = math.nan if others or judged else 0.0
        return SystemErrors(ErrorEstimate(step, none, none, total=step + none), note=note)
    computed = answered(Richer(system, np.arange(len(system.tree.free)), system, {}), of, inputs).places()
    size = float(np.linalg.norm(computed - (computed[0] if start is None else start), axis=-1).max())

    def fraction(a: Floats, b: Floats) -> float:
        return float(np.linalg.norm(a - b, axis=-1).max()) / size if size > 0 else 0.0

    bases, every_exact = bases_of(system, of, inputs), all(body.kind == "exact" for body in judged.values())
    try:
        if again is None:
            truth, same, *alone = _departing(richer(system, bases, exact=True), of, inputs, begun, bases)
        else:
            some = [bases, *({name: bases[name]} for name in bases if len(bases) > 1)]
            ran = [_run(richer(system, each, exact=True), again, inputs, len(of.time)) for each in some]
            (truth, *alone), same = ran, ran[0]
            if not every_exact:
                same = _run(richer(system, bases, exact=False), again, inputs, len(of.time))
    except (ComputationError, np.linalg.LinAlgError):
        return SystemErrors(ErrorEstimate(step), note=FAR)
    total = fraction(truth, computed)
    if not np.isfinite(total):
        return SystemErrors(ErrorEstimate(step), note=FAR)
    # Between a system with more shapes of the same models and the exact one there is what the models leave out.
    shapes, model = (total, 0.0) if every_exact else (fraction(same, computed), fraction(truth, same))
    estimate = ErrorEstimate(step, shapes, model, total=total + (0.0 if math.isnan(step) else step))
    by_beam = [fraction(each, computed) for each in alone] or [total]
    return SystemErrors(estimate, tuple(judged), np.array(by_beam), note)


def _run(rich: Richer, again: Callable[[System], Trajectory], inputs: InputsOf, count: int) -> Floats:
    """Places (t, p, 3) m of a richer system that is really run."""
    ran = again(rich.system)
    if len(ran.time) < count:
        raise ComputationError("not converged", "the richer system has no response")
    return Answered(rich, np.asarray(ran.q), np.asarray(ran.qd), np.asarray(ran.qdd), inputs).places()


def _departing(
    exact: Richer, of: Trajectory, inputs: InputsOf, begun: Callable[[System], Point], bases: Mapping[str, Base]
) -> Iterator[Floats]:
    """Places (t, p, 3) m with all that is lacking, with more shapes of the same models, and with what each beam lacks
    where there are several.
    """
    at = answered(exact, of, inputs)
    respond, residual, first = follower(at, of.time), at.residual(), begun(exact.system)
    start = first.y - at.y[0], first.yd - at.yd[0]
    moved = respond(residual, start)
    yield at.places(moved)
    # In the new coordinates it leaves what its shapes do, in its own what its models leave out.
    new = np.ones(residual.shape[1], dtype=bool)
    new[exact.own] = False
    yield at.places(respond(np.where(new, residual, 0.0), (np.where(new, start[0], 0.0), np.where(new, start[1], 0.0))))
    theirs = [exact.system.coordinates[k] for k in exact.system.tree.free]
    for name in bases if len(bases) > 1 else ():
        # A system in which it alone is exact leaves what it lacks; the others feel it only through the joints.
        one = richer(exact.of, {name: bases[name]}, exact=True)
        names = [one.system.coordinates[k] for k in one.system.tree.free]
        its = [each.startswith(f"{name}.q") for each in theirs]
        kept = [k for k, each in enumerate(names) if its[theirs.index(each)] or each.partition(".")[0] not in bases]
        alone = np.zeros_like(residual)
        alone[:, [theirs.index(names[k]) for k in kept]] = answered(one, of, inputs).residual()[:, kept]
        yield at.places(respond(alone, (np.where(its, start[0], 0.0), np.where(its, start[1], 0.0))))


def bases_of(system: System, of: Trajectory, inputs: InputsOf) -> dict[str, Base]:
    """Motions of the roots of the beams that can be judged, at some of the times (t, 3)."""
    some = np.unique(np.linspace(0, len(of.time) - 1, min(len(of.time), LOOKED)).astype(int))
    state = system.tree.motion(of.q[some], of.qd[some], of.qdd[some], inputs(system, some))
    roots = {name: state.roots[k] for k, name in enumerate(system.order)}
    return {name: Base(roots[name].a, roots[name].w, roots[name].alpha) for name in judged_beams(system)}
