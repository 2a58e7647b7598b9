"""Errors of a system's answers from too few shapes of its beams, from their models and from the theory of slender
beams, of every beam and of all: of deflections relative to the beams' roots, of the loads there and of stress, each
over the beam's own largest; and of places.

What is computed is put into the exact model of the same system with more shapes. The residual that it leaves there is
answered by that system's small departures, over time or at rest; in the new coordinates alone it is what shapes lack.
Put into systems of thick and of slender beams, bent as they are, it leaves what that theory lacks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from gbeam.analysis.accuracy.beam_theory import Lacking, beyond, described, largest
from gbeam.analysis.accuracy.correction import DEFLECTION, PLACE, Departures, Quantity, Reading, State, Within
from gbeam.analysis.accuracy.estimate import MORE_SHAPES, UNMOVED, Judgement, cause_and_cure, negligible, percent, worst
from gbeam.analysis.system.richer import coarser, judged_bodies, left_unjudged, richer, theories_of, with_beams
from gbeam.analysis.system.solution import Solution
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import ComputationError
from gbeam.mechanics.theory import Theory
from gbeam.mechanics.tree.equations import SLIPS
from gbeam.mechanics.tree.system import System
from gbeam.results.errors import ErrorEstimate, SystemErrors
from gbeam.results.parts import Base

Again = Callable[[System], Solution]
Starting = Callable[[System], tuple[Flags, Flags]]  # flags of what a start bends and accelerates: `unknown_at_start`
Rerun = Callable[[System, Iterable[str]], Reading]  # runs another system, and reads some of its bodies
FEWEST = 3  # times of a response that is judged
FAR = "shapes and models are not judged: a system with more shapes does not follow"

TOGETHER = "with more shapes of the same models the system does not follow: too few shapes count as the models' error"
UNKNOWN = "errors by the theory of slender beams are not known: "
BENT_FAR = UNKNOWN + "thick beams do not follow"
LOOP_LOST = UNKNOWN + "controllers do not hold the system with more shapes in its beams"
CREEPS = f"friction is smooth below {' and '.join(SLIPS)}, so that what it holds creeps; rate = 0 holds a joint"
UNSMOOTHED = (
    "the error of the smooth law of friction is not known: runs with half and twice its rate fail; give a smaller step"
)
STEPS = "the steps do not resolve what vibrates; give a smaller step, or damp it"
LOST = 10.0  # times the motion, or the extent of the system: a larger answer of linear equations is none


def unmoved(size: float, place: Floats) -> bool:
    """True if a displacement is rounding of places (t, p, 3), as where a system rests."""
    return size <= UNMOVED * np.abs(place).max(initial=0.0)


def unjudged(
    system: System,
    steps: Mapping[Quantity, float],
    friction: Mapping[Quantity, float] = MappingProxyType({}),
    *,
    rest: float = math.nan,
    note: str = "",
) -> SystemErrors:
    """Errors by the time steps and the law of friction; `rest` is that of all other causes."""

    def error(key: Quantity) -> ErrorEstimate:
        step = steps.get(key, math.nan)
        return ErrorEstimate(step, rest, rest, total=step + rest).adding(friction=friction.get(key, math.nan))

    place, bent = error(PLACE), [error((name, DEFLECTION)) for name in system.flexible]
    worst_bent = max(bent, key=lambda each: each.step, default=place)
    return SystemErrors(worst_bent if worst_bent.step > 0 else place, place, note=note)


def system_errors(
    solution: Solution,
    again: Again | None,
    steps: Mapping[Quantity, float],
    *,
    peaks_by_step: Mapping[Quantity, float] = MappingProxyType({}),
    starting: Starting | None = None,
    start: Floats | None = None,
    friction: Mapping[Quantity, float] = MappingProxyType({}),
) -> SystemErrors:
    """Errors of the places of all points, over the largest displacement from the first places or a `start` (p, 3), and
    of the beams' deflections, root loads and stress; `steps` has the errors of the time steps, and `peaks_by_step` of
    their peaks. Richer systems are linearised, beginning as `starting` says, or run by `again` if given (with
    controllers, at rest). `friction` has the errors of its law.
    """
    judged, note, count = judged_bodies(solution.system), left_unjudged(solution.system), len(solution.of.time)
    by_steps = partial(unjudged, solution.system, steps, friction)
    if not judged or (again is None and count < FEWEST):
        return by_steps(rest=math.nan if note or judged else 0.0, note=note)
    computed = solution.read(judged)
    place = computed[PLACE]
    sizes = {quantity: largest(values) for quantity, values in computed.items()}
    sizes[PLACE] = float(np.linalg.norm(place - (place[0] if start is None else start), axis=-1).max())
    bases, nothing = solution.bases(judged), set[Quantity]()
    for name, body in judged.items():
        inertia = body.coefficients.rigid[0] * largest(bases[name].a_WO_B)
        nothing |= negligible(sizes, name, body.length, inertia)
    if unmoved(sizes[PLACE], place):
        nothing.add(PLACE)
    exact = all(body.exact for body in judged.values())
    rerun = None if again is None else _rerun(again, count)

    with np.errstate(all="ignore"):
        try:
            if rerun is None:
                truth, few_shapes, *alone = _departing(solution, bases, computed, starting, exact=exact)
                shapes, model = (few_shapes, truth), (computed, few_shapes)
            else:
                same = truth = rerun(richer(solution.system, bases, exact=True).system, judged)
                alone = [
                    _alone(rerun, richer(solution.system, {name: base}, exact=True).system, truth)
                    for name, base in bases.items()
                    if len(bases) > 1
                ]
                if not exact:
                    try:
                        same = rerun(richer(solution.system, bases, exact=False).system, judged)
                    except ComputationError:
                        same, note = computed, "; ".join(filter(None, (note, TOGETHER)))
                # The errors of models lie between the system with more shapes of the same models and the exact one.
                shapes, model = (computed, same), (same, truth)
        except (ComputationError, np.linalg.LinAlgError):
            return by_steps(note=FAR)
        if not np.isfinite(truth[PLACE]).all():
            return by_steps(note=FAR)
        mesh = _by_mesh(solution, rerun, judged, starting)
        theories = theories_of(solution.system)
        loop = rerun if count > 1 else None
        lacking = _beyond(solution, theories, loop, starting) if theories else Lacking()
    extent = float(np.ptp(place, axis=(0, 1)).max(initial=0.0))
    if theories and not lacking.sizes.get(PLACE, math.nan) <= LOST * max(sizes[PLACE], extent):
        lacking = Lacking()
        note = "; ".join(filter(None, (note, BENT_FAR if loop is None else LOOP_LOST)))
    by_mesh = None if mesh is None else (mesh, computed)
    time = solution.of.time if count > 1 else None
    judgement = Judgement(shapes, model, lacking, dict(steps), sizes, nothing, by_mesh, time, peaks_by_step, friction)
    of_places, bent = judgement.error(PLACE), [judgement.error((name, DEFLECTION)) for name in judged]
    deforms = any((name, DEFLECTION) not in nothing for name in judged)
    loads, stress = [judgement.loads(name) for name in judged], [judgement.error((name, "stress")) for name in judged]
    return SystemErrors(
        displacement=worst(bent) if deforms else of_places,
        place=of_places,
        loads=worst(loads),
        stress=worst(stress),
        beams=tuple(judged),
        by_beam=np.array([judgement.apart(PLACE, (computed, better)) for better in alone or [truth]]),
        displacement_by_beam=np.array([each.total for each in bent]),
        loads_by_beam=np.array([each.total for each in loads]),
        load_peaks_by_beam=np.array([each.peak for each in loads]),
        stress_by_beam=np.array([each.total for each in stress]),
        stress_peaks_by_beam=np.array([each.peak for each in stress]),
        theory=tuple(described(judged[name], lacking.causes.get(name, {})) for name in judged),
        note=note,
    )


def doubts(errors: SystemErrors, tolerance: float) -> tuple[str, ...]:
    """Warnings of errors above a tolerance, with cause and cure, and of answers that are not judged."""
    warnings = [errors.note] if errors.note else []
    for what, size, error, by_beam in (
        ("deflections are", "a body's largest", errors.displacement, errors.displacement_by_beam),
        ("places are", "the largest displacement", errors.place, errors.by_beam),
        ("loads are", "the largest of them", errors.loads, errors.loads_by_beam),
        ("stress is", "its largest", errors.stress, errors.stress_by_beam),
    ):
        parts = error.step, error.shapes, error.model, error.beam_theory, error.mesh, error.friction
        if what == "deflections are" and error is errors.place:
            continue
        stated = max(filter(math.isfinite, (error.total, error.step)), default=0.0)
        if not stated > tolerance:
            continue
        share = percent(stated)
        if not math.isnan(error.peak):
            size += f" at an instant, and in the peak by {percent(error.peak)}"
        if error.step == np.nanmax(parts):
            warnings.append(f"{what} wrong by an estimated {share} of {size}: {STEPS}")
            continue
        if error.friction == np.nanmax(parts):
            warnings.append(f"{what} wrong by an estimated {share} of {size}: {CREEPS}")
            continue
        worst_beam = int(np.nan_to_num(by_beam).argmax())
        cause, cure = cause_and_cure(error, errors.theory[worst_beam])
        if error.shapes == np.nanmax(parts):
            cure = MORE_SHAPES
        most_of = errors.beams[worst_beam]
        warnings.append(f"{what} wrong by an estimated {share} of {size}: {cause}, most of {most_of}; {cure}")
    return tuple(warnings)


def _rerun(again: Again, count: int) -> Rerun:
    """Function that runs a system and reads it; ComputationError where a run has fewer than `count` times."""

    def rerun(system: System, bodies: Iterable[str]) -> Reading:
        solution = again(system)
        if len(solution.of.time) < count:
            raise ComputationError("not converged", "the richer system has no response")
        return solution.read(bodies)

    return rerun


def _alone(rerun: Rerun, system: System, truth: Reading) -> Reading:
    """Readings, of the same quantities as `truth`, of a system in which one body alone is richer; NaN where its run
    fails, as of a craft that the other bodies, richer too, keep in balance.
    """
    try:
        return rerun(system, [name for name, _ in truth if name])
    except ComputationError:
        return {quantity: np.nan * values for quantity, values in truth.items()}


def _by_mesh(
    solution: Solution, rerun: Rerun | None, bodies: Iterable[str], starting: Starting | None
) -> Reading | None:
    """Readings of the system with coarser meshes of its solids; None if no solid has one."""
    rough = coarser(solution.system)
    if rough is None:
        return None
    if rerun is not None:
        return rerun(rough, bodies)
    within = solution.within(rough, bodies)
    departures = within.departures()
    return within.moved(departures.answer(within.residual(), _begun(starting, rough, within, departures)))


def _departing(
    solution: Solution, bases: Mapping[str, Base], computed: Reading, starting: Starting | None, *, exact: bool
) -> Iterator[Reading]:
    """Readings of linearised richer systems: exact models with more shapes, exact models with the same shapes and, of
    several bodies, each alone richer.
    """
    rich = richer(solution.system, bases, exact=True)
    within = solution.within(rich.system, bases, rich.shared)
    departures, residual = within.departures(), within.residual()
    total = departures.answer(residual, _begun(starting, rich.system, within, departures))
    yield within.moved(total)
    if exact:
        yield computed
    else:
        start = _begun(starting, rich.system, within, departures, within.of_new)
        yield within.moved(total.less(departures.answer(within.of_new(residual), start)))
    for name in bases if len(bases) > 1 else ():
        # The residual of a system in which it alone is exact; the others feel it only through the joints.
        one_richer = richer(solution.system, {name: bases[name]}, exact=True)
        alone = solution.within(one_richer.system, (), one_richer.shared)
        kept = [k for k, body in enumerate(alone.more.bodies) if body == name or body not in bases]
        onto = np.zeros((len(alone.more.names), residual.shape[1]))
        onto[kept, [within.more.names.index(alone.more.names[k]) for k in kept]] = 1.0
        start = _begun(starting, one_richer.system, alone, departures, lambda left: left @ onto, rich.system)  # noqa: B023
        yield within.moved(departures.answer(alone.residual() @ onto, start))


def _beyond(
    solution: Solution, theories: Mapping[str, Theory], loop: Rerun | None, starting: Starting | None
) -> Lacking:
    """Differences to thick beams: by runs of these in a `loop`, else by the residual in their equations."""
    bent = partial(with_beams, solution.system)
    thick = bent({name: theory.thick for name, theory in theories.items()})

    def begun(departures: Departures, within: Within, plate: Floats) -> State | None:
        return _begun(starting, thick, within, departures, lambda left: left + within.of.q[0] @ plate)

    return beyond(
        solution.posed(theories),
        solution.of,
        theories,
        lambda beams: solution.posed(theories, bent(beams)),
        begun,
        None if loop is None else lambda beams: loop(bent(beams), theories),
    )


def _begun(
    starting: Starting | None,
    system: System,
    within: Within,
    departures: Departures,
    part: Callable[[Floats], Floats] = np.asarray,
    departing: System | None = None,
) -> State | None:
    """Initial departure by a `part` of the residual that a solution within another `system` leaves at the start; the
    `departing` system is the same unless given. None in equilibrium.
    """
    if starting is None:
        return None
    flags = starting(system)
    left = part(within.held_residual(flags[1]))
    return departures.settled(left, *(flags if departing is None else starting(departing)))
