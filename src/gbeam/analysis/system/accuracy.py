"""Errors of a system's answers from too few shapes of its beams, from their models and from the theory of slender
beams, of every beam and of all: of places, of the loads at the beams' roots and of their stress.

What is computed is put into the exact model of the same system with more shapes. The residual that it leaves there is
answered by that system's small departures, over time or at rest; in the new coordinates alone it is what shapes lack.
Put into systems of thick and of slender beams, bent as they are, it leaves what that theory lacks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.accuracy.beam_theory import causes, described
from gbeam.analysis.accuracy.estimate import UNMOVED, cause_and_cure, negligible, percent
from gbeam.analysis.system.richer import (
    PLACE,
    Answered,
    InputsOf,
    Quantity,
    Richer,
    answered,
    bases_of,
    follower,
    itself,
    judged_beams,
    judged_bodies,
    left_unjudged,
    richer,
    theories_of,
    with_beams,
)
from gbeam.errors import ComputationError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.tree.signals import deforming
from gbeam.mechanics.tree.system import System
from gbeam.motion.bases.base import Base
from gbeam.results.errors import ErrorEstimate, SystemErrors

Floats = NDArray[np.float64]
Reading = dict[Quantity, Floats]
Again = Callable[[System], tuple[Trajectory, InputsOf]]
FEWEST = 3  # times of a response that is judged
FAR = "shapes and models are not judged: a system with more shapes does not follow"

UNKNOWN = "errors by the theory of slender beams are not known: "
BENT_FAR = UNKNOWN + "thick beams do not follow"
LOOP_LOST = UNKNOWN + "controllers do not hold the system with more shapes in its beams"
LOST = 10.0  # times the motion, or the extent of the system: a larger answer of linear equations is none


def _extent(place: Floats) -> float:
    """Largest distance between points (t, p, 3) of a system, m."""
    return float(np.ptp(place, axis=(0, 1)).max(initial=0.0))


def unmoved(size: float, place: Floats) -> bool:
    """True if a displacement is rounding of places (t, p, 3), as where a system rests."""
    return size <= UNMOVED * np.abs(place).max(initial=0.0)


class Lacking(NamedTuple):
    """Largest differences of quantities to the theory of thick beams, and their causes in words, by beam."""

    sizes: Mapping[Quantity, float]
    words: Mapping[str, str]


def system_errors(
    system: System,
    of: Trajectory,
    inputs: InputsOf,
    again: Again | None,
    steps: Mapping[Quantity, float],
    *,
    settled: bool,
    start: Floats | None = None,
) -> SystemErrors:
    """Errors of the places of all points, as fractions of the largest displacement, from the first of them or a `start`
    (p, 3), and of the beams' root loads and stress, beside those of the steps; bodies begin `settled` or undeformed.
    Richer systems are run `again` if it is given: where controllers answer what is lacking, and at rest.
    """
    judged = judged_bodies(system)
    note = left_unjudged(system)
    step = steps.get(PLACE, math.nan)
    if not judged or (again is None and len(of.time) < FEWEST):
        none = math.nan if note or judged else 0.0
        return SystemErrors(ErrorEstimate(step, none, none, total=step + none), note=note)
    computed = answered(itself(system), of, inputs).read(judged)
    place = computed[PLACE]
    sizes = {key: float(np.linalg.norm(each, axis=-1).max()) for key, each in computed.items()}
    sizes[PLACE] = float(np.linalg.norm(place - (place[0] if start is None else start), axis=-1).max())
    nothing = {
        (name, each)
        for name, beam in judged.items()
        for each in negligible({key: sizes[name, key] for key in ("force", "moment", "stress", "sheared")}, beam.length)
    }
    if unmoved(sizes[PLACE], place):
        nothing.add(PLACE)
    bases, every_exact = (
        bases_of(system, of, inputs),
        all(body.richer or body.kind == "exact" for body in judged.values()),
    )
    with np.errstate(all="ignore"):
        try:
            if again is None:
                truth, same, *alone = _departing(richer(system, bases, exact=True), of, inputs, bases, settled=settled)
            else:
                some = [bases, *({name: bases[name]} for name in bases if len(bases) > 1)]
                truth, *alone = (
                    _run(richer(system, each, exact=True), again, len(of.time)).read(judged) for each in some
                )
                same = truth
                if not every_exact:
                    same = _run(richer(system, bases, exact=False), again, len(of.time)).read(judged)
        except (ComputationError, np.linalg.LinAlgError):
            return SystemErrors(ErrorEstimate(step), note=FAR)
        if not np.isfinite(truth[PLACE]).all():
            return SystemErrors(ErrorEstimate(step), note=FAR)
        # Without a loop, and at rest, what is computed is put into the equations: it may bend farther than they know.
        loop = again if len(of.time) > 1 else None
        beams = judged_beams(system)
        beyond = _beyond(system, of, inputs, loop, settled=settled) if beams else Lacking({}, {})
    if beams and not beyond.sizes.get(PLACE, math.nan) <= LOST * max(sizes[PLACE], _extent(place)):
        beyond, note = Lacking({}, {}), "; ".join(filter(None, (note, LOOP_LOST if loop else BENT_FAR)))

    def apart(key: Quantity, a: Reading, b: Reading) -> float:
        size = 0.0 if key in nothing else sizes[key] or float(np.linalg.norm(truth[key], axis=-1).max())
        return float(np.linalg.norm(a[key] - b[key], axis=-1).max()) / size if size else 0.0

    def estimate(key: Quantity) -> ErrorEstimate:
        if math.isnan(sizes[key]):  # of the stress of matrices
            return ErrorEstimate()
        total, step = apart(key, truth, computed), 0.0 if key in nothing else steps.get(key, math.nan)
        # Between a system with more shapes of the same models and the exact one there is what the models leave out.
        shapes, model = (total, 0.0) if every_exact else (apart(key, same, computed), apart(key, truth, same))
        away = ErrorEstimate(step, shapes, model, total=total + (0.0 if math.isnan(step) else step))
        theory, size = beyond.sizes.get(key, math.nan), sizes[key]
        return away.with_theory(0.0 if key in nothing or size == 0 else theory / size)

    def worst(each: Iterable[ErrorEstimate]) -> ErrorEstimate:
        return max(
            (one for one in each if not math.isnan(one.total)), key=lambda one: one.total, default=ErrorEstimate()
        )

    loads = [worst(estimate((name, each)) for each in ("force", "moment")) for name in judged]
    stress = [estimate((name, "stress")) for name in judged]
    return SystemErrors(
        displacement=estimate(PLACE),
        loads=worst(loads),
        stress=worst(stress),
        beams=tuple(judged),
        by_beam=np.array([apart(PLACE, each, computed) for each in alone] or [apart(PLACE, truth, computed)]),
        loads_by_beam=np.array([each.total for each in loads]),
        stress_by_beam=np.array([each.total for each in stress]),
        theory=tuple(beyond.words.get(name, "") for name in judged),
        note=note,
    )


def doubts(errors: SystemErrors, tolerance: float) -> tuple[str, ...]:
    """Warnings of what is wrong by more than a tolerance, but for the steps, and of what is not judged."""
    said = [errors.note] if errors.note else []
    for what, size, each, by_beam in (
        ("places", "displacement", errors.displacement, errors.by_beam),
        ("loads", "of them", errors.loads, errors.loads_by_beam),
    ):
        parts = each.shapes, each.model, each.beam_theory
        if not any(part > tolerance for part in parts):
            continue
        which = int(np.argmax(by_beam))
        cause, cure = cause_and_cure(*parts, errors.theory[which])
        if parts[0] == max(parts):
            cure = "raise its model.modes, of a mesh its modes"  # which are given in a system
        share = percent(each.total)
        said.append(
            f"{what} are wrong by an estimated {share} of the largest {size}: {cause}, most of {errors.beams[which]}; "
            f"{cure}"
        )
    return tuple(said)


def _run(rich: Richer, again: Again, count: int) -> Answered:
    """A richer system that is really run."""
    ran, inputs = again(rich.system)
    if len(ran.time) < count:
        raise ComputationError("not converged", "the richer system has no response")
    return Answered(rich, ran, inputs)


def _departing(
    exact: Richer, of: Trajectory, inputs: InputsOf, bases: Mapping[str, Base], *, settled: bool
) -> Iterator[Reading]:
    """Readings with all that is lacking, with more shapes only, and, of places, with each of several beams' lack."""
    at = answered(exact, of, inputs)
    respond, residual = follower(at, settled=settled), at.residual()
    yield at.moved(respond(residual, 0.0)).read(bases)
    # In the new coordinates it leaves what its shapes do, in its own what its models leave out.
    new = np.ones(residual.shape[1], dtype=bool)
    new[exact.shared] = False
    yield at.moved(respond(np.where(new, residual, 0.0), 0.0)).read(bases)
    theirs = [exact.system.coordinates[k] for k in exact.system.tree.free]
    for name in bases if len(bases) > 1 else ():
        # A system in which it alone is exact leaves what it lacks; the others feel it only through the joints.
        one = richer(exact.of, {name: bases[name]}, exact=True)
        names = [one.system.coordinates[k] for k in one.system.tree.free]
        its = deforming(names, name)
        kept = [k for k, each in enumerate(names) if k in its or each.partition(".")[0] not in bases]
        alone = np.zeros_like(residual)
        alone[:, [theirs.index(names[k]) for k in kept]] = answered(one, of, inputs).residual()[:, kept]
        yield at.moved(respond(alone, 0.0)).read(())


def _beyond(system: System, of: Trajectory, inputs: InputsOf, again: Again | None, *, settled: bool) -> Lacking:
    """Find what the theory of slender beams lacks: in the equations of thick beams, without and with plate action, what
    is computed leaves more than in those of slender ones, which thick beams answer; or both are run `again`. NaN where
    thick beams have no answer.
    """
    judged = judged_beams(system)
    theories = theories_of(system)

    def within(more: System, less: System) -> Richer:
        names = [more.coordinates[k] for k in more.tree.free]
        return Richer(more, np.array([names.index(less.coordinates[k]) for k in less.tree.free], dtype=int), less, {})

    thin = with_beams(system, {name: each.slender for name, each in theories.items()})
    slender = answered(within(thin, system), of, inputs)
    thick = with_beams(system, {name: each.thick for name, each in theories.items()})
    full = answered(within(thick, thin), slender.of, inputs)
    names = [thick.coordinates[k].rpartition(".q")[0] for k in thick.tree.free]
    columns = {name: [k for k, each in enumerate(names) if each == name] for name in judged}
    bent = {name: full.of.q[:, columns[name]] for name in judged}
    plates = {name: each.plate(bent[name]) for name, each in theories.items()}
    words = dict[str, str]()
    try:
        residual = full.residual()
        for name, each in theories.items():
            by = causes(each, bent[name], residual[:, columns[name]], bent[name] @ plates[name])
            words[name] = described(judged[name], by)
        respond = follower(full, settled=settled) if again is None else None

        def answer(plates: Mapping[str, Floats]) -> Answered:
            """Answer of thick beams that are so much stiffer."""
            if again is not None:
                stiffer = {name: each.variants(plates[name])[1] for name, each in theories.items()}
                return _run(itself(with_beams(system, stiffer)), again, len(of.time))
            assert respond is not None
            added = np.zeros((residual.shape[1],) * 2)
            for name, plate in plates.items():
                added[np.ix_(columns[name], columns[name])] = plate
            return full.moved(respond(residual + full.of.q @ added, added))

        without = (slender if again is None else _run(itself(thin), again, len(of.time))).read(judged)
        beam, strip = {name: 0 * each for name, each in plates.items()}, plates
        flat = any(each.any() for each in plates.values())
        truths = [answer(each).read(judged) for each in ((beam, strip) if flat else (beam,))]
    except (ComputationError, np.linalg.LinAlgError):
        return Lacking({}, {})
    away = [{key: np.linalg.norm(each[key] - without[key], axis=-1).max() for key in without} for each in truths]
    return Lacking({key: float(np.maximum.reduce([each[key] for each in away])) for key in without}, words)
