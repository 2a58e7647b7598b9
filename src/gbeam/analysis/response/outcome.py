"""The outcome of a run and warnings of its result, in words."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from gbeam.analysis.response.loss import holds, worst_loss
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.system.accuracy import doubts
from gbeam.analysis.system.steady import MASSLESS, bent_most, massless
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.guards.limits import BOUNDLESS
from gbeam.mechanics.plausibility import bent_far, elastic_bend, first_order_clause, stretched
from gbeam.mechanics.structure import Structure
from gbeam.results.body_response import BodyResponse
from gbeam.results.errors import ErrorEstimate, Errors
from gbeam.results.parts import Base, LoadPeaks
from gbeam.results.result import NOT_KNOWN

MANY = 100  # steps between two of the results' times, above which a warning advises another integrator
GROWN = math.log(1e3)  # growth of a crookedness of a thousandth of the beam's length to all of it
NOTICED = math.log(2)  # growth below this is not warned of


@dataclass(frozen=True)
class Ending:
    """Outcome and message of a run, and warnings of what is doubtful where it is done."""

    outcome: str = "done"
    message: str = ""
    warnings: tuple[str, ...] = ()

    @property
    def done(self) -> bool:
        """True if the run is done."""
        return self.outcome == "done"

    def name_body(self, body: str) -> Ending:
        """Name a body in the message and the warnings. They stay as they are where the name is empty."""
        if not body:
            return self
        message = f"{body}: {self.message}" if self.message else ""
        return Ending(self.outcome, message, tuple(f"{body}: {warning}" for warning in self.warnings))


def ending_of(run: Run, bodies: Mapping[str, tuple[Base, Floats]], time: Floats) -> Ending:
    """Describe how a run ended.

    `bodies` are those on which nothing hangs or acts but their loads. Each has the motion of its root (t, 3) and its
    coordinates (t, n) at times (t,) s, which tell when it loses its stability.
    """
    trajectory, system = run.trajectory, run.posed.system
    end = trajectory.time[-1]
    if trajectory.failure is not None:
        return Ending(trajectory.failure.outcome, str(trajectory.failure))
    doubts = tuple[str, ...]()
    if (step := run.without_mass) is not None:
        free = system.unknown_coordinates
        words = f"at {trajectory.time[step]:.4g} s, {massless(system, free, trajectory.q[step])}"
        if not trajectory.reached_end or bent_most(system, free, trajectory.q)[1] > 1:
            return Ending(MASSLESS, words)
        doubts = (f"{words}; what moves so grows without bound where steps resolve it",)
    if not (trajectory.stopped or trajectory.converged):
        alternative = "" if system.controllers else ', or response.integrator = "generalized-alpha" with rho_inf = 0.8'
        problem = f"no acceleration satisfies the equations in the step after t = {end:.4g} s"
        return Ending("not converged", f"{problem}; try a smaller response.step{alternative}")
    named = len(run.deforming) > 1
    endings = [
        _ending_of(run, body, name, bodies.get(name), time).name_body(name if named else "")
        for name, body in run.deforming.items()
    ]
    failed = [ending for ending in endings if not ending.done]
    doubts += tuple(warning for ending in endings for warning in ending.warnings)
    return failed[0] if failed else Ending(warnings=doubts)


def _ending_of(run: Run, structure: Structure, name: str, states: tuple[Base, Floats] | None, time: Floats) -> Ending:
    """Outcome of a run for one body, by its states at times (t,) s, if what they would tell is all that it feels."""
    end, q_end = run.trajectory.time[-1], run.trajectory.q[-1:, run.posed.columns(name)]
    stopped = run.trajectory.stopped and run.posed.far(structure, structure.displacement(q_end)).any()
    loss, instability, bent = None, "", ""
    if states is not None:
        base, q = states
        begun = each_leaf(lambda values: values[0], base), q[0]
        loss, first = worst_loss(structure, time, base, q), 0
        if loss is not None:
            first = int(np.searchsorted(time, loss.start))
            state = "equilibrium is not stable" if loss.flutter else "stiffness is not positive definite"
            instability = f"{structure.kind}'s {state} from t = {loss.start:.4g} s, where {' and '.join(loss.causes)}"
        bent = first_order_clause(elastic_bend(structure, each_leaf(lambda values: values[first], base)))
    if bent and loss is not None and (stopped or loss.growth > GROWN):
        return Ending(NOT_KNOWN, f"whether it diverges is not known: {instability}, but {bent}")
    particles = structure.field is None  # they have no other model, nor a length that bounds their displacement
    if stopped and particles:
        cause = f": {instability}" if instability else "; give a smaller response.step"
        return Ending("diverged", f"the displacement exceeded {BOUNDLESS:.0e} m at t = {end:.4g} s{cause}")
    if stopped:
        better_models = "FOAM or exact" if structure.kind == "TLAM" else "exact"
        why = f"use {better_models}"
        if instability:
            why = f"{instability}: the model is not valid beyond that; {why}"
            if structure.kind != "TLAM":
                why += ", and `gbeam critical-speed` to see whether the exact model loses its equilibrium as well"
        length = f"{structure.length:.4g} m"
        return Ending("diverged", f"the displacement exceeded the beam's length, {length}, at t = {end:.4g} s; {why}")
    if loss is not None and loss.growth > GROWN:
        cure = "add a small load across the beam, which decides which way it gives"
        if particles:
            cure = "stiffen the structure, or slow its motion"
        elif structure.linear:
            cure = f"use {'FOAM or ' if structure.kind == 'TLAM' else ''}exact, and {cure}"
        problem = (
            "whatever deviates grows more than a thousandfold meanwhile, and no real beam stays where this run has it"
        )
        return Ending("diverged", f"{instability}, to t = {loss.end:.4g} s: {problem}; {cure}")
    warnings, unknown = [], f"; that is not known, for {bent}" if bent else ""
    if loss is not None and loss.growth > NOTICED:
        grows = f"whatever deviates grows {math.exp(loss.growth):.2g}-fold meanwhile{unknown}"
        warnings.append(f"{instability}, to t = {loss.end:.4g} s: {grows}")
    elif states is not None and run.posed.settings.begin.settled and not holds(structure, time[0], *begun):
        warnings.append(
            "the run starts from an equilibrium that is not stable, which no beam would keep"
            f"{unknown or '; `gbeam critical-speed` finds where that begins'}"
        )
    return Ending(warnings=tuple(warnings))


def far_bent(structure: Structure, size: float) -> tuple[str, ...]:
    """Warn of a body of particles whose displacement, by its largest size, m, is too far for its model."""
    if structure.field is not None:
        return ()
    warnings = tuple(bent_far(structure, size / structure.length))
    if size <= structure.length:
        return warnings
    return (
        *warnings,
        f"the displacement reaches {size:.4g} m, and no particle rests farther than "
        f"{structure.length:.4g} m from the root: places to second order in the coordinates may not hold so far",
    )


def stressed_and_bent(run: Run, bodies: Mapping[str, BodyResponse]) -> tuple[str, ...]:
    """Warn of bodies that yield, bend too far for their models, or lack a stiffness by what loads them."""
    subject, warnings = run.posed.subject, list[str]()
    for body, body_response in bodies.items():
        warnings += yield_warnings(body_response.peaks.loads, "" if subject.body else f" of {body}")
        if body == subject.body:
            warnings += [
                *far_bent(subject.structure, body_response.peaks.max_size),
                *stretched(subject.structure, body_response.q),
            ]
    return (*warnings, *(() if subject.body else run.solution(1).stiffness_warnings))


def inaccuracies(run: Run, errors: Errors) -> tuple[str, ...]:
    """Warn of estimated errors above the tolerance, with causes and cures, or that no error could be estimated."""
    settings = run.posed.settings
    if not settings.estimate:
        return ()
    if math.isnan(errors.displacement.step) and not run.event_warnings:
        return ("no error could be estimated: the run with twice the step fails; give a smaller step",)
    if run.posed.system.only_structure is not None:  # all that its points move is its deflection
        errors = replace(errors, place=ErrorEstimate())
    return doubts(errors, settings.tolerance, _cure_of_step(settings))


def _cure_of_step(settings: ResponseSettings) -> str:
    """Advice against an error of the steps."""
    if settings.step is not None:
        return 'give a smaller step, or "auto"'
    if settings.integrator == "gauss":
        return "give a smaller step than automatic ones, or damp it"
    return 'response.integrator = "gauss" follows it in fewer steps, or damp it'


def integrator_advice(settings: ResponseSettings, steps: int, finer: int) -> tuple[str, ...]:
    """Advise another integrator if an automatic step is `finer` times finer than the results', and that is many."""
    if settings.step is not None or settings.integrator == "gauss" or finer < MANY:
        return ()
    return (
        f"{settings.integrator} took {steps} steps, {finer} to each of the results: its error, most of it a delay that "
        "grows with every cycle of a lightly damped vibration, falls as the square of the step only; "
        'response.integrator = "gauss" keeps the same accuracy in far fewer',
    )


def yield_warnings(peaks: LoadPeaks | None, of: str = "") -> list[str]:
    """Warn where the stress of a beam exceeds the yield strength."""
    strength = None if peaks is None else peaks.yield_strength
    if peaks is None or strength is None:
        return []
    stress = peaks.stress
    largest = int(np.argmax(stress.value))
    if not stress.value[largest] > strength:
        return []
    return [
        f"the stress reaches {1e-6 * stress.value[largest]:.4g} MPa at {peaks.stations[largest]:.4g} m{of}, t = "
        f"{stress.time[largest]:.4g} s, above the yield strength, {1e-6 * strength:.4g} MPa: the material yields, and "
        "the response, which is elastic, means nothing from there on"
    ]
