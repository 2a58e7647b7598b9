"""Response of a system over time, with the error of its steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.response.outcome import yielding
from gbeam.analysis.response.peaks import load_peaks
from gbeam.analysis.response.problem import Problem
from gbeam.analysis.response.record import outline_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.step_errors import Run, difference, of_histories, ratio, share
from gbeam.analysis.response.stepping import LOADS_STEPS, even_steps, finer_by, integrated, scheme_of, steps_beyond
from gbeam.analysis.system.accuracy import doubts, system_errors
from gbeam.analysis.system.assembly import assembly_of
from gbeam.analysis.system.feedback import SystemControllers, loop_of
from gbeam.analysis.system.histories import Carried, beams_of, histories, loads_of
from gbeam.analysis.system.point import Point, started, started_traced
from gbeam.analysis.system.richer import PLACE, Answered, InputsOf, Quantity, itself, judged_beams, pieces
from gbeam.arrays.namespace import holds_jax, namespace
from gbeam.errors import InputError
from gbeam.guards.limits import HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.equations import NonlinearEquations, Trajectory
from gbeam.integrate.steps import Corners
from gbeam.mechanics.tree.steps import continuous
from gbeam.mechanics.tree.system import System
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.history import axes_result
from gbeam.motion.protocol import Motion
from gbeam.progress import Progress, tell
from gbeam.results.errors import ErrorEstimate, SystemErrors
from gbeam.results.parts import Loads
from gbeam.results.response import BaseMotion
from gbeam.results.system import BeamResponse, Invariants, Loop, SystemResponse
from gbeam.structure.beam import names_at

Array = Any
Floats = NDArray[np.float64]
LEAST = 500  # steps of the results at least
BENT = 4  # into how many a step is divided at most where a law bends, for errors to be seen to fall
BEYOND = 1e-8  # of a coordinate's range: less beyond a stop is no contact


@dataclass(frozen=True)
class Ran(Run):
    """A run of a system, with what drives it and the displacements of all points, side by side, (t, 3 p) m."""

    inputs: InputsOf
    moved: Floats

    @staticmethod
    def of(system: System, trajectory: Trajectory, step: float, inputs: InputsOf) -> Ran:
        """Read a run."""
        places = Answered(itself(system), trajectory, inputs).places()
        return Ran(trajectory, step, None, inputs, (places - places[0]).reshape(len(places), -1))  # type: ignore[arg-type]


def _driving(motion: Motion | None, of: Trajectory, equations: NonlinearEquations) -> InputsOf:
    """Inputs of the latest run of some equations, controllers included, and of richer systems at its times."""
    acting = None
    if equations.controllers is not None:
        acting = loop_of(equations.controllers, equations.samplings[-1], of.time)[1]

    def inputs(system: System, some: Any) -> Any:
        plain = system.inputs(of.time[some], motion)
        return plain if acting is None else SystemControllers(system).driven(plain, acting[some])

    return inputs


def _pieces(trajectory: Trajectory, system: System) -> list[Trajectory]:
    """A trajectory in pieces of which all frames are held in memory at once."""
    return [trajectory.at(some) for some in pieces(len(trajectory.time), system.tree.size)]


def simulate_system(
    system: System, motion: Motion | None, settings: ResponseSettings, name: str, progress: Progress = None
) -> SystemResponse:
    """Compute the response of a system on the ground or on a moving base."""
    if motion is not None:
        if motion.free:
            raise InputError("motion", "is a hub that turns freely", "give it as a body on a revolute joint")
        if system.gravity is not None:
            fix = "leave one out: a motion carries its own, as specific force"
            raise InputError("gravity", "is given beside a motion of the base", fix)
        motion = motion.over(settings.start, settings.start + settings.duration)
    begin = settings.begin
    if begin != type(begin)(begin.state):
        raise InputError("initial", "displaces a tip", 'give "equilibrium" or "undeformed"; joints have initial values')
    equations = NonlinearEquations(system.tree, lambda t: system.inputs(t, motion))
    if system.holds_jax or holds_jax(motion):
        return _traced(system, motion, settings, name, equations)
    point = started(system, motion, settings.start, begin.state)
    coarse = _first_step(system, motion, point, settings)
    flight, settings = settings, _with_ends(motion, settings, settings.step or coarse)
    if settings.start < flight.start:
        point = started(system, motion, settings.start, begin.state)
    for key, controller in system.controllers.items():
        fix = f"give {settings.duration / LOADS_STEPS:.3g} s or more, or a shorter run"
        samples = settings.duration / controller.sample
        refuse_more(f"controllers.{key}.sample", "samples", samples, STEPS, 8.0 * 3 * system.tree.size, fix)
    if system.controllers and not len(system.tree.free):
        raise InputError("controllers", "have nothing to move: all motion is prescribed", "leave them out, or a rate")
    if system.controllers:
        if settings.integrator != "gauss":
            fix = "leave it out: controllers are sampled by Gauss's method"
            raise InputError("integrator", f"is {settings.integrator!r}", fix)
        equations = replace(equations, controllers=SystemControllers(system), samplings=[])
    each = 8.0 * (3 * system.tree.size + 16 * len(system.points))
    most, step = int(HISTORY_BYTES / each), settings.step or coarse
    fix = f"give {most * step:.3g} s or less, or longer steps"
    refuse_more("response.duration", "steps", settings.duration / step, most, each, fix)
    end = settings.start + settings.duration
    times = _corners(system, motion, coarse)
    felt = Corners.of(times, equations.drive, settings.start, end)
    if system.controllers:
        commands = np.unique(np.round(equations.controllers.corners(settings.start, end), 12))
        commands = commands[np.abs(commands[:, None] - felt.time).min(axis=1, initial=np.inf) > 1e-9]
        both, jumps = np.append(felt.time, commands), np.append(felt.jump, np.ones(len(commands), dtype=bool))
        felt = Corners(np.sort(both), jumps[np.argsort(both)])
    order = scheme_of(settings).order

    def through(of: NonlinearEquations, begun: Point, step: float, what: str) -> Trajectory:
        how = {"corners": felt, "progress": lambda done: tell(progress, what, done)}
        return integrated(Problem(of, begun.y, begun.yd, 0, True), settings, step, **how)

    def run(step: float, what: str) -> Ran:
        trajectory = through(equations, point, step, what)
        return Ran.of(system, trajectory, step, _driving(motion, trajectory, equations))

    runs, error = [run(settings.step or 2 * coarse, "integrating")], math.nan
    missed = _missed_stop(system, runs[-1].trajectory)
    bends = any(joint.holder.bends for joint in system.joints.values())
    if settings.step is None:
        runs.append(run(coarse, "refining"))
        while True:
            error = _step_error(runs, order, bends)
            whole, missed = runs[-1].whole, _missed_stop(system, runs[-1].trajectory)
            most = int(LOADS_STEPS * runs[-1].step / settings.duration)
            few = bends and len(runs) < 3
            needed = few or bool(missed)
            finer = max(finer_by(error / settings.aim if whole else math.nan, order), 2 if needed else 0)
            finer = min(finer, BENT if bends else finer, most)
            if (error <= settings.aim and whole and not needed) or finer < 2:
                break
            if not (whole or runs[-2].whole) and len(runs) > 3:
                break
            step = runs[-1].step / finer
            runs.append(run(step, f"refining the step to {1e3 * step:.3g} ms"))
    elif settings.estimate:
        coarser = (4, 2) if bends else (2,)
        runs[:0] = [run(k * settings.step, f"checking with {k} times the step") for k in coarser]
        error = _step_error(runs, order, bends)
    error = math.nan if missed else error
    chosen = runs[-1]
    stride = 1 if settings.step is not None else round(coarse / chosen.step)
    kept = chosen.trajectory.at(slice(None, None, stride))
    if not settings.estimate or not chosen.whole:
        errors = SystemErrors(ErrorEstimate(error))
        return _described(system, motion, settings, chosen, stride, errors, name, equations, missed)

    def again(of: System) -> tuple[Trajectory, InputsOf]:
        control = SystemControllers(of) if system.controllers else None
        own = NonlinearEquations(of.tree, lambda t: of.inputs(t, motion), control, None if control is None else [])
        trajectory = through(
            own, started(of, motion, settings.start, begin.state), chosen.step, "errors of shapes and models"
        )
        ran = trajectory.at(slice(None, None, stride))
        return ran, _driving(motion, ran, own)

    def inputs(of: System, some: Any) -> Any:
        return chosen.inputs(of, np.arange(len(chosen.trajectory.time))[::stride][some])

    steps = {PLACE: error} | _load_errors(system, runs, order, bends)
    steps = dict.fromkeys(steps, math.nan) if missed else steps
    settled, closed = begin.state == "equilibrium", again if system.controllers else None
    errors = system_errors(system, kept, inputs, closed, steps, settled=settled)
    return _described(system, motion, settings, chosen, stride, errors, name, equations, missed)


def _traced(
    system: System, motion: Motion | None, settings: ResponseSettings, name: str, equations: NonlinearEquations
) -> SystemResponse:
    """A run whose values JAX traces: of a given step, without a look at them."""
    if settings.step is None:
        raise InputError("step", "is automatic, and a traced run has no numbers to choose it by", "give a step, s")
    if system.controllers:
        fix = "trace the system without them: a law that is sampled is no part of a compiled program"
        raise InputError("controllers", "are in the loop of a traced run", fix)
    step = settings.duration / max(1, round(settings.duration / settings.step))
    settings = _with_ends(motion, settings, step)
    start = started_traced(system, motion, settings.start, settings.begin.state)
    run = Run(integrated(Problem(equations, *start, 0, True), settings, step), step, None)  # type: ignore[arg-type]
    return _described(system, motion, replace(settings, loads=False), run, 1, SystemErrors(), name, equations)


def _with_ends(motion: Motion | None, settings: ResponseSettings, step: float) -> ResponseSettings:
    """Settings of a run from a machine's standstill to its standstill, in whole steps beyond the flight's times."""
    if motion is None:
        return settings
    before, after = (step * count for count in steps_beyond(motion, settings, step))
    return replace(settings, start=settings.start - before, duration=settings.duration + before + after)


def _step_error(runs: list[Ran], order: int, bends: bool) -> float:
    """Error of the last of two or more runs' places."""
    last = runs[-3:]
    return _left(last, [difference(x.moved, y.moved, ratio(x, y)) for x, y in pairwise(last)], min(order, 2.0), bends)


def _left(runs: Sequence[Run], apart: Sequence[float], order: float, bends: bool) -> float:
    """Error that differences of two or three runs leave in the last, by the order observed. A law that bends within a
    step leaves one that depends on where: no order is observed, and two runs may agree by chance.
    """
    if bends and len(runs) > 2:
        return max(apart[-1], apart[-2] / ratio(runs[-2], runs[-1]))
    return apart[-1] * share(runs, apart, order)


def _load_errors(system: System, runs: list[Ran], order: int, bends: bool) -> dict[Quantity, float]:
    """Errors of the steps in the loads at the beams' roots and in their stress."""
    beams = judged_beams(system)
    last = runs[-3:] if runs[-3:][0].whole else runs[-2:]
    keys = [(name, each) for name in beams for each in ("force", "moment", "stress")]
    if not keys or len(last) < 2 or not all(run.whole for run in last):
        return {}

    def read(k: int, stride: int) -> list[Floats]:
        run = last[k]
        steps = np.arange(len(run.trajectory.time))[::stride]
        at = Answered(itself(system), run.trajectory.at(steps), lambda of, some: run.inputs(of, steps[some]))
        values = at.read(beams)
        return [values[key] for key in keys]

    return dict(zip(keys, of_histories(last, read, lambda apart: _left(last, apart, 4 / order, bends)), strict=True))


def _missed_stop(system: System, run: Trajectory) -> tuple[str, ...]:
    """Warn of a stop that a coordinate meets and leaves between two of a run's times, of which the steps may know
    nothing.
    """
    from scipy.interpolate import CubicHermiteSpline  # which takes a while to import

    holders = [(link.holder, np.full(link.body.size, np.inf)) for link in system.tree.links]
    low, high = (
        np.concatenate([np.append(sign * getattr(of, side), off) for of, off in holders])[system.tree.free]
        for side, sign in (("low", -1.0), ("high", 1.0))
    )
    for sign, ends in ((1.0, high), (-1.0, low)):
        for k in np.flatnonzero(np.isfinite(ends)):
            q = sign * run.q[:, k]
            between = CubicHermiteSpline(run.time, q, sign * run.qd[:, k])
            turns = between.derivative().roots(extrapolate=False)
            step = np.clip(np.searchsorted(run.time, turns, side="right") - 1, 0, len(q) - 2)
            beyond = between(turns) > ends[k] + BEYOND * np.ptp(q)
            missed = turns[beyond & (np.minimum(q[step], q[step + 1]) <= ends[k])]
            if missed.size:
                name = system.coordinates[system.tree.free[k]]
                words = f"{name} meets a stop and leaves it within one step, at {missed[0]:.4g} s"
                return (f"{words}: the steps may miss it, and their error is not known; give a smaller step",)
    return ()


def _corners(system: System, motion: Motion | None, step: float) -> Floats:
    moved = [] if motion is None else [motion.corners(step)]
    return np.concatenate([system.corners(step), *moved])


def _first_step(system: System, motion: Motion | None, point: Point, settings: ResponseSettings) -> float:
    """Step of the results, s: 500 at least, twenty to the period of the slowest vibration of which the most steps are
    one to a period, and none over a corner, as far as there are not too many.
    """
    _, k, _, m = point.local.slopes()
    square = np.abs(np.linalg.eigvals(np.linalg.solve(m, k))) if len(k) else np.zeros(0)
    largest = settings.duration / LEAST
    oscillating = np.sqrt(square[square > 1e-9 * square.max(initial=0.0)])
    oscillating = oscillating[oscillating * settings.duration < 2 * math.pi * LOADS_STEPS]
    if oscillating.size:
        largest = min(largest, 2 * math.pi / float(oscillating.min()) / 20)
    return settings.duration / min(even_steps(largest, _corners(system, motion, largest), settings), LOADS_STEPS)


def _over_time(
    system: System, motion: Motion | None, equations: NonlinearEquations, of: Trajectory, *, loads: bool
) -> tuple[dict[str, Any], dict[str, Loads], Loop | None]:
    """Histories of a trajectory, loads along the beams by name, and what controllers did."""
    loop, acting, done = None, None, 0
    if equations.controllers is not None:
        loop, acting = loop_of(equations.controllers, equations.samplings[-1], of.time)
    columns, beams = dict[str, list[Floats]](), dict[str, list[Carried]]()
    for some in _pieces(of, system):
        inputs = system.inputs(some.time, motion)
        if acting is not None:
            inputs = equations.controllers.driven(inputs, acting[done : done + len(some.time)])
        done += len(some.time)
        values, carried = histories(system, some.q, some.qd, some.qdd, inputs, inertial=motion is None)
        for key, value in values.items():
            columns.setdefault(key, []).append(value)
        for name, each in carried.items():
            beams.setdefault(name, []).append(each)
    along = {name: loads_of(beams_of(system)[name], each, of.time) for name, each in beams.items() if loads}
    over_time = {key: namespace(*values).concatenate(values) for key, values in columns.items()}
    return over_time | {"attitude": continuous(over_time["attitude"])}, along, loop


def _described(
    system: System,
    motion: Motion | None,
    settings: ResponseSettings,
    run: Run,
    stride: int,
    errors: SystemErrors,
    name: str,
    equations: NonlinearEquations,
    warnings: tuple[str, ...] = (),
) -> SystemResponse:
    """Describe a run at every `stride`-th of its steps."""
    every = run.trajectory
    kept = every.at(slice(None, None, stride))
    over_time, along, loop = _over_time(system, motion, equations, kept, loads=settings.loads)
    beams, yielded = dict[str, BeamResponse](), []
    for body, loads in along.items():
        beam = beams_of(system)[body]

        def between(steps: Any, body: str = body) -> Loads:
            return _over_time(system, motion, equations, every.at(steps), loads=True)[1][body]

        peaks = load_peaks(loads, between, every.time, stride)
        first = system.coordinates.index(f"{body}.q1")
        q = over_time["q"][:, first : first + beam.size]
        names = () if beam.source is None else names_at(beam.source.beam, beam.stations)
        beams[body] = BeamResponse(loads, peaks, outline_of(beam, None, kept.time, q), names)
        yielded += yielding(beams[body].peaks, f" of {body}")
    invariants = None
    if motion is None:
        invariants = Invariants(*(over_time.pop(key) for key in ("momentum", "angular_momentum", "energy")))
    base: Any = None if motion is None else motion.base(kept.time)
    outcome, message = "done", ""
    if not every.whole:
        outcome = "not converged"
        message = (
            f"Newton's method failed at {every.time[-1]:.4g} s: give a smaller step, or look for what breaks there"
        )
    warnings += (*settings.warnings, *yielded)
    warnings += doubts(errors, settings.tolerance)
    step_error = errors.displacement.step
    if outcome == "done" and step_error > settings.tolerance:
        warnings += (f"the error of the steps is {100 * step_error:.2g} %: give a smaller step or tolerance",)
    return SystemResponse(
        name=name,
        environment="ground" if motion is None else motion.kind,
        outcome=outcome,
        message=message,
        time=kept.time,
        points=system.points,
        coordinates=system.coordinates,
        invariants=invariants,
        loop=loop,
        beams=beams,
        base=None if motion is None else BaseMotion(base.a_WO_B, base.w_WB_B, base.alpha_WB_B),
        axes=axes_result(motion, kept.time) if isinstance(motion, Centrifuge) else None,
        assembly=assembly_of(system) if settings.loads else None,
        integrator=scheme_of(settings).name,
        step=run.step,
        steps=len(every.time) - 1,
        errors=errors,
        kept_every=settings.kept_every(len(kept.time), run.step * stride),
        warnings=warnings + system.warnings,
        **over_time,
    )
