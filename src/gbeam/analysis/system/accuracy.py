"""Errors of a system's answers from too few shapes of its beams, from their models and from the theory of slender
beams.

They are told of every beam and of all: errors of places, of deflections relative to the beams' roots, of the loads
there and of stress. Each is over the beam's own largest value.

What is computed is put into the exact model of the same system with more shapes. The residual that it leaves there is
answered by that system's small departures, over time or at rest. In the new coordinates alone it is what shapes lack.
Put into systems of thick and of slender beams, bent as they are, it leaves what that theory lacks.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from operator import itemgetter
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import Lacking, described, largest
from gbeam.analysis.accuracy.correction import (
    DEFLECTION,
    PLACE,
    RESOLVED,
    Quantity,
    Reading,
)
from gbeam.analysis.accuracy.estimate import (
    NO_MESH,
    UNMOVED,
    Judgement,
    causes,
    causes_in_words,
    negligible,
    percent,
    twist_warnings,
)
from gbeam.analysis.accuracy.looks import Looks, times_of_peaks
from gbeam.analysis.system.richer import judged_bodies, left_unjudged
from gbeam.analysis.system.richer_readings import (
    Recompute,
    RicherReadings,
    Ringing,
    Starting,
    depart_to_richer,
    differences_to_thick_beams,
    reader_of_runs,
    run_richer,
)
from gbeam.analysis.system.solution import Solution
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.links import SLIPS
from gbeam.mechanics.tree.system import System
from gbeam.results.errors import ErrorEstimate, Errors, largest_known
from gbeam.results.parts import Base

Sampled = Callable[[int], Solution]  # solution at every so many-th step
FEWEST = 3  # times of a response that is judged
BENT = 0.1  # of the length: bodies that bend by less are straight for small departures
MANY, PER_PERIOD = 500, 6  # samples looked at, in all and in a period of the lowest mode of a body held at its root
MOST = 20_000  # samples where fast modes may ring
LARGEST = 2.0  # times (v/L)²: error of a second-order model, up to what a beam that points inward on a hub has
TOO_FAR = "the solution is too far from the exact model's for an estimate; it is the bound 2 (v/L)² of its class"
ALIKE = 1e-6  # of errors that are the same, one by the other
FAR = "shapes and models are not judged: a system with more shapes does not follow"

CREEPS = f"friction, smooth below {' and '.join(SLIPS)}, so that what it holds creeps", "rate = 0 holds a joint"
UNSMOOTHED = (
    "the error of the smooth law of friction is not known: runs with half and twice its rate fail; give a smaller step"
)
STEPS, SMALLER = "steps that do not resolve what vibrates", "give a smaller step, or damp it"
SHARE = 0.1  # of an error: causes of less are not named


def unmoved(size: float, place: Floats) -> bool:
    """True if a displacement is only rounding beside places (t, p, 3), as where a system rests."""
    return size <= UNMOVED * np.abs(place).max(initial=0.0)


def unjudged(
    system: System,
    steps: Mapping[Quantity, float],
    friction: Mapping[Quantity, float] = MappingProxyType({}),
    *,
    rest: float = math.nan,
    note: str = "",
) -> Errors:
    """Errors by the time steps and the law of friction alone. `rest` is that of all other causes."""

    def error(key: Quantity) -> ErrorEstimate:
        step = steps.get(key, math.nan)
        return ErrorEstimate(step, rest, rest, total=step + rest).adding(friction=friction.get(key, math.nan))

    place, bent = error(PLACE), [error((name, DEFLECTION)) for name in system.flexible]
    deflected = ErrorEstimate.from_largest(bent)
    loads = ErrorEstimate.from_largest(error(key) for key in steps if key[1] in ("force", "moment"))
    stress = ErrorEstimate.from_largest(error(key) for key in steps if key[1] == "stress")
    return Errors(deflected if deflected.step > 0 else place, place, loads=loads, stress=stress, note=note)


def system_errors(
    every: Sampled,
    rerun_system: Recompute | None,
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
    """Estimate the errors of the places of all points and of the beams' deflections, root loads and stress.

    Those of places are over the largest displacement from the first places, or from a `start` (p, 3). Warnings tell of
    masses that a twist, which the model lacks, moves by more than a `tolerance`.

    `every` returns the solution at every so many steps, of which results have every `stride`-th, `computed` if they are
    read already. `steps` has the errors of the time steps, `peaks_by_step` those of their peaks, and `friction` those
    of its law. Richer systems are linearised, beginning as `starting` says, or run by `rerun_system` if it is passed
    (with controllers, and at rest). A solution that does not resolve a mode that rings is judged at more steps.
    """
    solution = every(stride)
    system, count = solution.system, len(solution.trajectory.time)
    judged, note = judged_bodies(system), left_unjudged(system)
    by_steps = partial(unjudged, system, steps, friction)
    if not judged or (rerun_system is None and count < FEWEST):
        return by_steps(rest=math.nan if note or judged else 0.0, note=note), ()
    computed = solution.read(judged) if computed is None else computed
    place = computed[PLACE]
    sizes = {quantity: largest(values) for quantity, values in computed.items()}
    sizes[PLACE] = float(np.linalg.norm(place - (place[0] if start is None else start), axis=-1).max())
    bases = solution.bases(judged)
    findings = _Findings(steps, sizes, _negligible(judged, bases, sizes, place), peaks_by_step, friction, note)
    straight = all(sizes[name, DEFLECTION] <= BENT * body.length for name, body in judged.items())
    extent = float(np.ptp(place, axis=(0, 1)).max(initial=0.0))
    interval = (
        float(solution.trajectory.time[-1] - solution.trajectory.time[0]) / max(count - 1, 1) / stride
    )  # of two steps, s
    period = min(2 * math.pi / float(body.rest[0][0]) for body in judged.values())
    spacing = max(1, math.ceil(count * stride / MOST))  # steps from one that is looked at to the next
    skipped = max(1, min(int(period / PER_PERIOD / (stride * interval)), count // MANY)) if rerun_system is None else 1

    peaks = times_of_peaks(solution.trajectory.time, computed)

    def judge(solution: Solution) -> tuple[Errors, float, Lacking]:
        """Judge a solution at some of the steps.

        Returns its errors, the frequency, rad/s, of a mode that these steps do not resolve, and what the theory of
        slender beams lacks.
        """
        rerun = None if rerun_system is None else reader_of_runs(rerun_system, len(solution.trajectory.time))
        look = partial(Looks.chosen, solution.trajectory.time, peaks, stride * interval)
        with np.errstate(all="ignore"):
            try:
                if rerun is None:
                    readings = depart_to_richer(solution, bases, look, starting, straight=straight)
                else:
                    readings = run_richer(solution, rerun, bases, computed)
            except (ComputationError, np.linalg.LinAlgError):
                return by_steps(note=FAR), 0.0, Lacking()
            if not np.isfinite(readings.truth[PLACE]).all():
                return _bounded(judged, findings) or by_steps(note=FAR), 0.0, Lacking()
            lacking, reason = differences_to_thick_beams(solution, rerun, max(sizes[PLACE], extent), look, starting)
        errors = _judged(system, findings, readings, lacking, reason)
        missed = 0.0
        if readings.rings is not None:
            missed = _missed(readings.rings, findings, errors, RESOLVED / (spacing * interval))
        return errors, missed, lacking

    errors, rate, lacking = judge(solution if skipped == 1 else every(stride * skipped))
    finer = max(spacing, int(RESOLVED / (rate * interval))) if rate else stride * skipped
    if finer < stride * skipped:
        errors, _, lacking = judge(every(finer))
    moved = list[str]()
    for name, body in judged.items():
        causes, distances = lacking.causes.get(name, {}), lacking.bodies.get(name, np.zeros(0))
        named = name if len(judged) > 1 else ""
        moved += twist_warnings(body, named, causes, distances, sizes[name, DEFLECTION], tolerance)
    return errors, tuple(moved)


class _Findings(NamedTuple):
    """Facts known before richer systems are asked: errors by the steps, sizes of quantities and those that are only
    rounding (`nothing`), errors of peaks by the steps and of the law of friction, and a note.
    """

    steps: Mapping[Quantity, float]
    sizes: Mapping[Quantity, float]
    nothing: set[Quantity]
    peaks_by_step: Mapping[Quantity, float]
    friction: Mapping[Quantity, float]
    note: str


def _negligible(
    judged: Mapping[str, Structure], bases: Mapping[str, Base], sizes: Mapping[Quantity, float], place: Floats
) -> set[Quantity]:
    """Quantities that are only rounding."""
    rounding = {PLACE} if unmoved(sizes[PLACE], place) else set[Quantity]()
    for name, body in judged.items():
        inertia = body.coefficients.rigid[0] * largest(bases[name].a_WO_B)
        rounding |= negligible(sizes, name, body.length, inertia)
    return rounding


def _judged(system: System, findings: _Findings, readings: RicherReadings, lacking: Lacking, reason: str) -> Errors:
    """Errors from the differences that richer systems, thick beams and coarser meshes make."""
    judged, computed = judged_bodies(system), readings.computed
    judgement = Judgement(
        readings.shapes, readings.model, lacking, dict(findings.steps), findings.sizes, findings.nothing,
        None if readings.mesh is None else (readings.mesh, computed),
        readings.looks if len(readings.looks.at) > 1 else None, findings.peaks_by_step, findings.friction,
    )  # fmt: skip

    def by_body(error: Callable[[str], ErrorEstimate]) -> list[ErrorEstimate]:
        """Errors of each body. That of the model is unknown for a body without another model."""
        errors = list[ErrorEstimate]()
        for name, body in judged.items():
            one_model = body.source is None and body.exact
            errors.append(replace(error(name), model=math.nan) if one_model else error(name))
        return errors

    of_places = judgement.error(PLACE)
    bent = by_body(lambda name: judgement.error((name, DEFLECTION)))
    loads, stress = by_body(judgement.loads), by_body(lambda name: judgement.error((name, "stress")))
    deforms = any((name, DEFLECTION) not in findings.nothing for name in judged)
    places = [judgement.difference(PLACE, (computed, reading)) for reading in readings.alone or [readings.truth]]
    return Errors(
        displacement=ErrorEstimate.from_largest(bent) if deforms else of_places,
        place=of_places,
        loads=ErrorEstimate.from_largest(loads),
        stress=ErrorEstimate.from_largest(stress),
        beams=tuple(judged),
        by_beam=np.array(places),
        displacement_by_beam=np.array([error.total for error in bent]),
        loads_by_beam=np.array([error.total for error in loads]),
        load_peaks_by_beam=np.array([error.peak for error in loads]),
        stress_by_beam=np.array([error.total for error in stress]),
        stress_peaks_by_beam=np.array([error.peak for error in stress]),
        theory=tuple(described(judged[name], lacking.causes.get(name, {})) for name in judged),
        note="; ".join(filter(None, (findings.note, readings.note, reason))),
    )


def _bounded(judged: Mapping[str, Structure], findings: _Findings) -> Errors | None:
    """Errors of a solution that is too far from the exact model's for an estimate: a bound by the largest deflection of
    each beam. None if some body is no beam.
    """
    if not all(body.source is not None for body in judged.values()):
        return None
    bounds = dict[str, ErrorEstimate]()
    for name, body in judged.items():
        size, step = findings.sizes[name, DEFLECTION], findings.steps.get((name, DEFLECTION), math.nan)
        model = LARGEST * (size / body.length) ** 2
        bounds[name] = ErrorEstimate(step, math.nan, model, total=step + model)
    return Errors(ErrorEstimate.from_largest(bounds.values()), note=TOO_FAR)


def _missed(rings: Ringing, findings: _Findings, errors: Errors, fastest: float) -> float:
    """Frequency, rad/s, of the fastest mode below `fastest` whose ringing may exceed the stated errors; else 0."""
    visible = np.zeros(len(rings.rate), dtype=bool)
    for quantity, amplitude in rings.sizes.items():
        error = errors.displacement if quantity[1] == DEFLECTION else errors.loads
        visible |= amplitude > error.slender * findings.sizes[quantity]
    return float(rings.rate[visible & (rings.rate < fastest)].max(initial=0.0))


def doubts(errors: Errors, tolerance: float, cure_of_steps: str = SMALLER) -> tuple[str, ...]:
    """Warn of errors above a tolerance, with causes and advice, and of answers that are not judged.

    That a mesh is not judged is said of the error itself, and is no warning.
    """
    warnings = [errors.note] if errors.note not in ("", NO_MESH) else []
    deflection, place = errors.displacement, errors.place
    quantities = [("loads are", "the largest of them", errors.loads, errors.loads_by_beam)]
    quantities += [("stress is", "its largest", errors.stress, errors.stress_by_beam)]
    one_body = deflection is not place and math.isclose(deflection.total, place.total, rel_tol=ALIKE)  # on the ground
    if not one_body:
        quantities.insert(0, ("places are", "the largest displacement", place, errors.by_beam))
    if deflection is not place:
        quantities.insert(0, ("deflections are", "a body's largest", deflection, errors.displacement_by_beam))
    for quantity, size, error, by_beam in quantities:
        stated = largest_known(error.total, error.step)
        if not stated > tolerance:
            continue
        if not math.isnan(error.peak):
            size += f" at an instant, and in the peak by {percent(error.peak)}"
        several = len(errors.beams) > 1
        worst_beam = int(np.nan_to_num(by_beam).argmax()) if len(by_beam) else 0
        sources = causes(error, errors.theory[worst_beam] if errors.theory else "", several=several)
        worst_body = f", most of {errors.beams[worst_beam]}" if sources and several else ""
        sources += [(error.step, STEPS, cure_of_steps), (error.friction, *CREEPS)]
        large = [cause for cause in sources if cause[0] > SHARE * stated]
        words = causes_in_words(sorted(large, key=itemgetter(0), reverse=True), worst_body)
        warnings.append(f"{quantity} wrong by an estimated {percent(stated)} of {size}: {words}")
    return tuple(warnings)
