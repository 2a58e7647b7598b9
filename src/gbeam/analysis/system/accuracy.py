"""Errors of a system's answers from too few shapes of its beams, from their models and from the theory of slender
beams, of every beam and of all: of deflections relative to the beams' roots, of the loads there and of stress, each
over the beam's own largest; and of places.

What is computed is put into the exact model of the same system with more shapes. The residual that it leaves there is
answered by that system's small departures, over time or at rest; in the new coordinates alone it is what shapes lack.
Put into systems of thick and of slender beams, bent as they are, it leaves what that theory lacks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import Lacking, beyond, described, largest
from gbeam.analysis.accuracy.correction import (
    DEFLECTION,
    PLACE,
    RESOLVED,
    Correction,
    Departures,
    Quantity,
    Reading,
    State,
    Within,
)
from gbeam.analysis.accuracy.estimate import (
    UNMOVED,
    Judgement,
    causes,
    causes_in_words,
    negligible,
    percent,
    twist_warnings,
)
from gbeam.analysis.accuracy.looks import Looks, times_of_peaks
from gbeam.analysis.system.richer import (
    coarser,
    judged_bodies,
    left_unjudged,
    linear_about_rest,
    richer,
    theories_of,
    with_beams,
)
from gbeam.analysis.system.solution import Solution, elastic_accelerations, first_order_sizes
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import ComputationError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.equations import SLIPS
from gbeam.mechanics.tree.system import System
from gbeam.results.errors import ErrorEstimate, Errors, largest_known
from gbeam.results.parts import Base

Again = Callable[[System], Solution]  # solution of another system, at the results' times
Sampled = Callable[[int], Solution]  # solution at every so many-th step
Rerun = Callable[[System, Iterable[str]], Reading]  # runs another system, and reads some of its bodies
FEWEST = 3  # times of a response that is judged
BENT = 0.1  # of the length: bodies that bend by less are straight for small departures
MANY, PER_PERIOD = 500, 6  # samples looked at, in all and in a period of the lowest mode of a body held at its root
MOST = 20_000  # samples where fast modes may ring
LARGEST = 2.0  # times (v/L)²: error of a second-order model, up to what a beam that points inward on a hub has
TOO_FAR = "the solution is too far from the exact model's for an estimate; it is the bound 2 (v/L)² of its class"
ALIKE = 1e-6  # of errors that are the same, one by the other
FAR = "shapes and models are not judged: a system with more shapes does not follow"

TOGETHER = "with more shapes of the same models the system does not follow: too few shapes count as the models' error"
UNKNOWN = "errors by the theory of slender beams are not known: "
BENT_FAR = UNKNOWN + "thick beams do not follow"
LOOP_LOST = UNKNOWN + "controllers do not hold the system with more shapes in its beams"
CREEPS = f"friction, smooth below {' and '.join(SLIPS)}, so that what it holds creeps", "rate = 0 holds a joint"
UNSMOOTHED = (
    "the error of the smooth law of friction is not known: runs with half and twice its rate fail; give a smaller step"
)
STEPS, SMALLER = "steps that do not resolve what vibrates", "give a smaller step, or damp it"
SHARE = 0.1  # of an error: causes of less are not named
LOST = 10.0  # times the motion, or the extent of the system: a larger answer of linear equations is none


@dataclass(frozen=True)
class Starting:
    """Starts of richer systems: flags of what is bent and accelerated, see :func:`unknown_at_start`, or the coordinates
    and rates at which they begin, or the last of these.
    """

    flags: Callable[[System], tuple[Flags, Flags]]
    state: Callable[[System], State] | None = None


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
) -> Errors:
    """Errors by the time steps and the law of friction; `rest` is that of all other causes."""

    def error(key: Quantity) -> ErrorEstimate:
        step = steps.get(key, math.nan)
        return ErrorEstimate(step, rest, rest, total=step + rest).adding(friction=friction.get(key, math.nan))

    place, bent = error(PLACE), [error((name, DEFLECTION)) for name in system.flexible]
    deflected = ErrorEstimate.largest(bent)
    loads, stress = (
        ErrorEstimate.largest(error(key) for key in steps if key[1] in of) for of in (("force", "moment"), ("stress",))
    )
    return Errors(deflected if deflected.step > 0 else place, place, loads=loads, stress=stress, note=note)


def system_errors(
    every: Sampled,
    again: Again | None,
    steps: Mapping[Quantity, float],
    *,
    stride: int = 1,
    peaks_by_step: Mapping[Quantity, float] = MappingProxyType({}),
    starting: Starting | None = None,
    start: Floats | None = None,
    friction: Mapping[Quantity, float] = MappingProxyType({}),
    tolerance: float = math.inf,
    computed: Reading | None = None,
) -> tuple[Errors, tuple[str, ...]]:
    """Errors of the places of all points, over the largest displacement from the first places or a `start` (p, 3), and
    of the beams' deflections, root loads and stress; and warnings of masses that a twist, which the model lacks, moves
    by more than a `tolerance`.

    `every` returns the solution at every so many steps, of which results have every `stride`-th, `computed` if they are
    read already; `steps` has the errors of the time steps, `peaks_by_step` of their peaks, and `friction` those of its
    law. Richer systems are linearised, beginning as `starting` says, or run by `again` if given (with controllers, at
    rest). A solution that does not resolve a mode that rings is judged at more steps.
    """
    solution = every(stride)
    system, count = solution.system, len(solution.of.time)
    judged, note = judged_bodies(system), left_unjudged(system)
    by_steps = partial(unjudged, system, steps, friction)
    if not judged or (again is None and count < FEWEST):
        return by_steps(rest=math.nan if note or judged else 0.0, note=note), ()
    computed = solution.read(judged) if computed is None else computed
    place = computed[PLACE]
    sizes = {quantity: largest(values) for quantity, values in computed.items()}
    sizes[PLACE] = float(np.linalg.norm(place - (place[0] if start is None else start), axis=-1).max())
    bases = solution.bases(judged)
    known = _Known(steps, sizes, _negligible(judged, bases, sizes, place), peaks_by_step, friction, note)
    straight = all(sizes[name, DEFLECTION] <= BENT * body.length for name, body in judged.items())
    extent = float(np.ptp(place, axis=(0, 1)).max(initial=0.0))
    interval = float(solution.of.time[-1] - solution.of.time[0]) / max(count - 1, 1) / stride  # of two steps, s
    period = min(2 * math.pi / float(body.rest[0][0]) for body in judged.values())
    least = max(1, math.ceil(count * stride / MOST))  # steps from one that is looked at to the next
    skipped = max(1, min(int(period / PER_PERIOD / (stride * interval)), count // MANY)) if again is None else 1

    near = times_of_peaks(solution.of.time, computed)

    def judge(solution: Solution) -> tuple[Errors, float, Lacking]:
        """Errors by a solution at some of the steps, the frequency, rad/s, of a mode that these do not resolve, and
        what the theory of slender beams lacks.
        """
        rerun = None if again is None else _rerun(again, len(solution.of.time))
        look = partial(Looks.chosen, solution.of.time, near, stride * interval)
        with np.errstate(all="ignore"):
            try:
                if rerun is None:
                    apart = _departing(solution, bases, look, starting, straight=straight)
                else:
                    apart = _rerunning(solution, rerun, bases, computed)
            except (ComputationError, np.linalg.LinAlgError):
                return by_steps(note=FAR), 0.0, Lacking()
            if not np.isfinite(apart.truth[PLACE]).all():
                return _bounded(judged, known) or by_steps(note=FAR), 0.0, Lacking()
            lacking, lost = _beyond(solution, rerun, known, extent, look, starting)
        errors = _judged(system, known, apart, lacking, lost)
        missed = 0.0 if apart.rings is None else _missed(apart.rings, known, errors, RESOLVED / (least * interval))
        return errors, missed, lacking

    errors, rate, lacking = judge(solution if skipped == 1 else every(stride * skipped))
    finer = max(least, int(RESOLVED / (rate * interval))) if rate else stride * skipped
    if finer < stride * skipped:
        errors, _, lacking = judge(every(finer))
    moved = list[str]()
    for name, body in judged.items():
        causes, distances = lacking.causes.get(name, {}), lacking.bodies.get(name, np.zeros(0))
        named = name if len(judged) > 1 else ""
        moved += twist_warnings(body, named, causes, distances, sizes[name, DEFLECTION], tolerance)
    return errors, tuple(moved)


class _Known(NamedTuple):
    """Facts known before richer systems are asked: errors by the steps, sizes of quantities and those that are
    rounding, errors of peaks by the steps and of the law of friction, and a note.
    """

    steps: Mapping[Quantity, float]
    sizes: Mapping[Quantity, float]
    nothing: set[Quantity]
    peaks_by_step: Mapping[Quantity, float]
    friction: Mapping[Quantity, float]
    note: str


class _Rings(NamedTuple):
    """Bounds (k,) of the ringing of modes that the samples do not resolve: rad/s, and of quantities."""

    rate: Floats
    sizes: Mapping[Quantity, Floats]


class _Apart(NamedTuple):
    """Readings, at the times of the `looks`, of what is computed and of exact models with more shapes; pairs that
    differ by too few shapes and by the models; readings of systems in which one body alone is richer, and of one with
    coarser meshes; bounds of ringing, and why models are not judged apart.
    """

    looks: Looks
    computed: Reading
    truth: Reading
    shapes: tuple[Reading, Reading]
    model: tuple[Reading, Reading]
    alone: list[Reading]
    mesh: Reading | None
    rings: _Rings | None = None
    note: str = ""


def _negligible(
    judged: Mapping[str, Structure], bases: Mapping[str, Base], sizes: Mapping[Quantity, float], place: Floats
) -> set[Quantity]:
    """Quantities that are rounding."""
    nothing = set[Quantity]()
    for name, body in judged.items():
        inertia = body.coefficients.rigid[0] * largest(bases[name].a_WO_B)
        nothing |= negligible(sizes, name, body.length, inertia)
    return nothing | ({PLACE} if unmoved(sizes[PLACE], place) else set())


def _rerunning(solution: Solution, rerun: Rerun, bases: Mapping[str, Base], computed: Reading) -> _Apart:
    """Readings of richer systems, by running them, beside those `computed`."""
    judged = judged_bodies(solution.system)
    exact = all(body.exact for body in judged.values())
    note, same = "", None
    truth = rerun(richer(solution.system, bases, exact=True).system, judged)
    alone = [
        _alone(rerun, richer(solution.system, {name: base}, exact=True).system, truth)
        for name, base in bases.items()
        if len(bases) > 1
    ]
    if not exact:
        try:
            same = rerun(richer(solution.system, bases, exact=False).system, judged)
        except ComputationError:
            same, note = computed, TOGETHER
    same = truth if same is None else same
    rough, looks = coarser(solution.system), Looks.at_all(solution.of.time)
    mesh = None if rough is None else rerun(rough, judged)
    # The errors of models lie between the system with more shapes of the same models and the exact one.
    return _Apart(looks, computed, truth, (computed, same), (same, truth), alone, mesh, note=note)


def _judged(system: System, known: _Known, apart: _Apart, lacking: Lacking, lost: str) -> Errors:
    """Errors by what richer systems, thick beams and coarser meshes make of what is computed."""
    judged, computed = judged_bodies(system), apart.computed
    judgement = Judgement(
        apart.shapes, apart.model, lacking, dict(known.steps), known.sizes, known.nothing,
        None if apart.mesh is None else (apart.mesh, computed), apart.looks if len(apart.looks.at) > 1 else None,
        known.peaks_by_step, known.friction,
    )  # fmt: skip

    def by_body(error: Callable[[str], ErrorEstimate]) -> list[ErrorEstimate]:
        """Errors of each body; the model is unknown of one that has no other."""
        without = [body.source is None and body.exact for body in judged.values()]
        errors = zip(map(error, judged), without, strict=True)
        return [replace(each, model=math.nan) if alone else each for each, alone in errors]

    of_places = judgement.error(PLACE)
    bent = by_body(lambda name: judgement.error((name, DEFLECTION)))
    loads, stress = by_body(judgement.loads), by_body(lambda name: judgement.error((name, "stress")))
    deforms = any((name, DEFLECTION) not in known.nothing for name in judged)
    return Errors(
        displacement=ErrorEstimate.largest(bent) if deforms else of_places,
        place=of_places,
        loads=ErrorEstimate.largest(loads),
        stress=ErrorEstimate.largest(stress),
        beams=tuple(judged),
        by_beam=np.array([judgement.difference(PLACE, (computed, better)) for better in apart.alone or [apart.truth]]),
        displacement_by_beam=np.array([each.total for each in bent]),
        loads_by_beam=np.array([each.total for each in loads]),
        load_peaks_by_beam=np.array([each.peak for each in loads]),
        stress_by_beam=np.array([each.total for each in stress]),
        stress_peaks_by_beam=np.array([each.peak for each in stress]),
        theory=tuple(described(judged[name], lacking.causes.get(name, {})) for name in judged),
        note="; ".join(filter(None, (known.note, apart.note, lost))),
    )


def _bounded(judged: Mapping[str, Structure], known: _Known) -> Errors | None:
    """Errors too far from the exact model's for an estimate, by a bound on the largest deflection of beams; None of
    other bodies.
    """
    if not all(body.source is not None for body in judged.values()):
        return None
    bounds = dict[str, ErrorEstimate]()
    for name, body in judged.items():
        size, step = known.sizes[name, DEFLECTION], known.steps.get((name, DEFLECTION), math.nan)
        model = LARGEST * (size / body.length) ** 2
        bounds[name] = ErrorEstimate(step, math.nan, model, total=step + model)
    return Errors(ErrorEstimate.largest(bounds.values()), note=TOO_FAR)


def _missed(rings: _Rings, known: _Known, errors: Errors, fastest: float) -> float:
    """Frequency, rad/s, of the fastest mode, below `fastest`, whose ringing may exceed the stated errors; 0 if none."""
    visible = np.zeros(len(rings.rate), dtype=bool)
    for quantity, amplitude in rings.sizes.items():
        error = errors.displacement if quantity[1] == DEFLECTION else errors.loads
        visible |= amplitude > error.slender * known.sizes[quantity]
    return float(rings.rate[visible & (rings.rate < fastest)].max(initial=0.0))


def doubts(errors: Errors, tolerance: float, cure_of_steps: str = SMALLER) -> tuple[str, ...]:
    """Warnings of errors above a tolerance, with causes and cures, and of answers that are not judged."""
    warnings = [errors.note] if errors.note else []
    for what, size, error, by_beam in (
        ("deflections are", "a body's largest", errors.displacement, errors.displacement_by_beam),
        ("places are", "the largest displacement", errors.place, errors.by_beam),
        ("loads are", "the largest of them", errors.loads, errors.loads_by_beam),
        ("stress is", "its largest", errors.stress, errors.stress_by_beam),
    ):
        one, other = errors.displacement, errors.place
        if what == "deflections are" and one is other:
            continue
        if what == "places are" and one is not other and math.isclose(one.total, other.total, rel_tol=ALIKE):
            continue  # of one body on the ground
        stated = largest_known(error.total, error.step)
        if not stated > tolerance:
            continue
        if not math.isnan(error.peak):
            size += f" at an instant, and in the peak by {percent(error.peak)}"
        worst_beam, several = int(np.nan_to_num(by_beam).argmax()) if len(by_beam) else 0, len(errors.beams) > 1
        every = causes(error, errors.theory[worst_beam] if errors.theory else "", several=several)
        of_body = f", most of {errors.beams[worst_beam]}" if every and several else ""
        every += [(error.step, STEPS, cure_of_steps), (error.friction, *CREEPS)]
        every = sorted((each for each in every if each[0] > SHARE * stated), key=itemgetter(0), reverse=True)
        share = percent(stated)
        warnings.append(f"{what} wrong by an estimated {share} of {size}: {causes_in_words(every, of_body)}")
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


def _departing(
    solution: Solution,
    bases: Mapping[str, Base],
    look: Callable[[Floats], Looks],
    starting: Starting | None,
    *,
    straight: bool,
) -> _Apart:
    """Readings of linearised richer systems: exact models with more shapes, exact models with the same shapes and, of
    several bodies, each alone richer, and of the system with coarser meshes; `straight` if departures are from
    undeformed bodies.
    """
    along = solution.along(bases)
    rich = richer(solution.system, bases, exact=True, along=along)
    within = solution.within(rich.system, bases, rich.shared)
    linear = solution.posed(bases, linear_about_rest(rich.system, bases)) if straight else None
    departures, residual = within.departures(linear), within.residual()
    if linear is not None and not departures.inert:  # light arms on hinges that follow one another
        departures = within.departures()
    begun = _begun(starting, rich.system, within, departures)
    total, of_model = departures.answer(residual, begun), None
    if not all(solution.system.flexible[name].exact for name in bases):
        same = richer(solution.system, bases, exact=False, along=along).system
        start = _begun(starting, rich.system, within, departures, within.of_new, like=same)
        of_model = total.minus(departures.answer(within.of_new(residual), start))
    alone = list[Correction]()
    for name in bases if len(bases) > 1 else ():
        # The residual of a system in which it alone is exact; the others feel it only through the joints.
        one_richer = richer(solution.system, {name: bases[name]}, exact=True, along=along)
        one = solution.within(one_richer.system, (), one_richer.shared)
        kept = [k for k, body in enumerate(one.richer.bodies) if body == name or body not in bases]
        onto = np.zeros((len(one.richer.names), residual.shape[1]))
        onto[kept, [within.richer.names.index(one.richer.names[k]) for k in kept]] = 1.0
        start = _begun(starting, one_richer.system, one, departures, lambda left: left @ onto, rich.system)  # noqa: B023
        alone.append(departures.answer(one.residual() @ onto, start))
    rough = _rougher(solution, bases, starting)
    parts = [total, *([] if of_model is None else [of_model, total.minus(of_model)]), *alone]
    sizes = [within.richer.sizes(part) for part in parts]
    sizes += [] if rough is None else [rough[0].richer.sizes(rough[1])]
    looks = look(np.concatenate(sizes, axis=1))
    computed, truth = solution.at(looks.at).read(bases), within.moved(total, looks.at)
    few_shapes = computed if of_model is None else within.moved(of_model, looks.at)
    return _Apart(
        looks, computed, truth, (few_shapes, truth), (computed, few_shapes),
        [within.moved(each, looks.at) for each in alone],
        None if rough is None else rough[0].moved(rough[1], looks.at),
        _rings(rich.system, bases, within, *departures.ringing(residual, begun)),
    )  # fmt: skip


def _rougher(solution: Solution, bodies: Iterable[str], starting: Starting | None) -> tuple[Within, Correction] | None:
    """The solution in the system with coarser meshes of its solids, and its departure; None if no solid has one."""
    rough = coarser(solution.system)
    if rough is None:
        return None
    within = solution.within(rough, bodies)
    departures = within.departures()
    return within, departures.answer(within.residual(), _begun(starting, rough, within, departures))


def _rings(system: System, bodies: Iterable[str], within: Within, rate: Floats, amplitude: Floats) -> _Rings:
    """Bounds of ringing of deflections and, by the elastic forces, of root loads, by amplitudes (n, k) of modes."""
    sizes = dict[Quantity, Floats]()
    for name in bodies:
        body, columns = system.flexible[name], [k for k, of in enumerate(within.richer.bodies) if of == name]
        q = amplitude[columns].T
        lengths = first_order_sizes(body, q, elastic_accelerations(body, q))
        sizes |= {(name, what): each for what, each in zip((DEFLECTION, "force", "moment"), lengths, strict=True)}
    return _Rings(rate, sizes)


def _beyond(
    solution: Solution,
    rerun: Rerun | None,
    known: _Known,
    extent: float,
    look: Callable[[Floats], Looks],
    starting: Starting | None,
) -> tuple[Lacking, str]:
    """Differences to thick beams: by runs of these in a loop, else by the residual in their equations, bent as the
    solution is, for a bend couples to twist; and why they are not known.
    """
    theories = theories_of(solution.system)
    if not theories:
        return Lacking(), ""
    loop = rerun if len(solution.of.time) > 1 else None
    bent = partial(with_beams, solution.system)
    thick = bent({name: theory.thick for name, theory in theories.items()})

    def begun(departures: Departures, within: Within, plate: Floats) -> State | None:
        if starting is None or starting.state is None:
            return _begun(starting, thick, within, departures, lambda left: left + within.of.q[0] @ plate)
        departure = np.zeros((2, len(within.richer.names)))
        for sign, other in ((-1, bent({name: theory.slender for name, theory in theories.items()})), (1, thick)):
            names, values = other.unknown_coordinates, np.array(starting.state(other))
            departure[:, [within.richer.names.index(name) for name in names[-values.shape[1] :]]] += sign * values
        return departure[0], departure[1]

    lacking = beyond(
        solution.posed(theories),
        solution.of,
        theories,
        lambda beams: solution.posed(theories, bent(beams)),
        begun,
        look,
        None if loop is None else lambda beams: loop(bent(beams), theories),
    )
    if lacking.sizes.get(PLACE, math.nan) <= LOST * max(known.sizes[PLACE], extent):
        return lacking, ""
    return Lacking(), BENT_FAR if loop is None else LOOP_LOST


def _begun(
    starting: Starting | None,
    system: System,
    within: Within,
    departures: Departures,
    part: Callable[[Floats], Floats] = np.asarray,
    departing: System | None = None,
    like: System | None = None,
) -> State | None:
    """Initial departure by a `part` of the residual that a solution within another `system` leaves at the start, or to
    the state in which this begins, or one `like` it; the `departing` system is the same unless given. None in
    equilibrium.
    """
    if starting is None:
        return None
    if starting.state is not None:
        return _departure(starting.state, system if like is None else like, within.of)
    flags = starting.flags(system)
    left = part(within.held_residual(flags[1]))
    return departures.settled(left, *(flags if departing is None else starting.flags(departing)))


def _departure(state: Callable[[System], State], system: System, of: Trajectory) -> State:
    """Initial state of a system, or of its last coordinates, minus that of a trajectory; NaN if there is none."""
    departure = np.zeros((2, of.q.shape[1]))
    try:
        begun = state(system)
    except ComputationError:
        departure[:] = np.nan
        return departure[0], departure[1]
    for row, values, coordinates in zip(departure, begun, (of.q[0], of.qd[0]), strict=True):
        size = len(values)
        row[-size:] = values - coordinates[-size:]  # the axial shapes, which SFOAM lacks, come first
    return departure[0], departure[1]
