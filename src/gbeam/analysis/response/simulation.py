"""Response over time in one environment: posed as equations, initial state and steps, and run."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Unpack, overload

import numpy as np

from gbeam.analysis.response.problem import Problem, problem_of
from gbeam.analysis.response.record import moving, response_of
from gbeam.analysis.response.settings import ResponseSettings, Settings
from gbeam.analysis.response.step_errors import Readings, Run
from gbeam.analysis.response.stepping import (
    Plan,
    answered,
    corners,
    enough,
    first_steps,
    going_on,
    integrated,
    once,
    planned,
    ramp,
    scheme_of,
    split,
    steps_beyond,
)
from gbeam.analysis.response.systems import simulate_system
from gbeam.arrays.namespace import holds_jax
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.guards.limits import BOUNDLESS, HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.equations import Trajectory
from gbeam.integrate.steps import Corners, Steps, fitted
from gbeam.mechanics.section_forces import root_loads, section_forces
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import Body
from gbeam.mechanics.tree.system import System, terms_of
from gbeam.motion.protocol import Motion
from gbeam.progress import Progress, tell
from gbeam.results.errors import StepErrors
from gbeam.results.response import Response
from gbeam.results.system import SystemResponse

UNMOVED = 1e-14  # of the length
NOTHING = 1e-7  # of the other load, over a length of the beam: a force or moment that is less is rounding


@dataclass(frozen=True, eq=False)
class Posed:
    """A run at the flight's times from a problem's state, ready for any step; `kept` is that of the results, s."""

    structure: Structure
    motion: Motion
    settings: ResponseSettings
    problem: Problem
    kept: float
    limit: int  # of steps of a run

    @cached_property
    def felt(self) -> Corners:
        """Corners and jumps of what drives the run."""
        times = corners(self.structure, self.motion, self.kept)
        start, end = self.settings.start, self.settings.start + self.settings.duration
        return Corners.of(times, self.problem.equations.drive, start, end)

    def plan(self) -> Plan:
        """Plan the runs that the settings need."""
        if not self.structure.size:  # nothing is integrated
            return once(self.kept, StepErrors(0.0, 0.0, 0.0))
        return planned(self.settings, self.kept, self.limit)

    def steps(self, step: float) -> Steps:
        """Steps of about a length, s; one that does not divide the duration goes beyond the end."""
        count = math.ceil(self.settings.duration / step - 1e-6)
        return fitted(self.settings.start, step, count, self.felt.felt_by(scheme_of(self.settings)))

    def run(self, step: float, **how: Any) -> Run:
        """The run with such steps."""
        return self.read(integrated(self.problem, self.settings, step, corners=self.felt, **how), step)

    def read(self, trajectory: Trajectory, step: float) -> Run:
        """A trajectory of such steps, with what is read from it."""
        return Run(trajectory, step, self._readings)

    def stride(self, step: float) -> int:
        """Number of steps of a length in one of the results, whose times all motions of a study share."""
        return 1 if self.settings.step is not None else round(self.kept / step)

    def too_far(self, y: Floats) -> int | None:
        """After how many steps a projected field moved by the beam's length, and means nothing; None if it did not."""
        return steps_within(self.structure, y[:, self.problem.first :])

    @cached_property
    def _terms(self) -> Body:
        return terms_of(self.structure)

    @cached_property
    def _readings(self) -> Readings:
        return Readings(self._tip, self._moment, self._loads)

    def _tip(self, y: Floats) -> Floats:
        """Displacement of the tip, zero where it is the rounding of places: a torque alone does not move it."""
        tip = np.asarray(self.structure.tip(y[..., self.problem.first :]))
        return np.where(np.abs(tip) > UNMOVED * self.structure.length, tip, 0.0)

    def _moment(self, y: Floats) -> Floats:
        """Root moment by the elastic forces K q, which the coordinates' inertia balances, of the straight beam."""
        c = self.structure.coefficients
        return np.asarray(y[..., self.problem.first :] @ (c.f_al @ np.linalg.solve(c.mass, c.stiffness)).T)

    def _loads(self, trajectory: Trajectory, stride: int) -> list[Floats]:
        """Force and moment at the root and, where errors are estimated, both sides' stress at every section."""
        at = trajectory.at(slice(None, None, stride))
        state = at.q, at.qd, at.qdd
        base, _ = moving(self.motion, at.time, *state)
        q, qd, qdd = (x[:, self.problem.first :] for x in state)
        force, moment = root_loads(self.structure, self._terms, base, q, qd, qdd, at.time)
        largest = np.abs(force).max() * self.structure.length, np.abs(moment).max()
        felt = [force * (largest[0] > NOTHING * largest[1]), moment * (largest[1] > NOTHING * largest[0])]
        if not self.settings.estimate:
            return felt
        forces = section_forces(self.structure, base, q, qd, qdd, at.time, motion=self.motion)
        sides = [forces.stress_tension, forces.stress_compression]
        if forces.von_mises is not None and np.isfinite(forces.von_mises).all():
            sides.append(forces.von_mises)  # of what is only twisted the others are rounding
        stress = np.concatenate(sides, axis=1)[..., None]
        if self.structure.recovery is not None:
            stress = np.asarray(self.structure.recovery.felt(q))
        return [*felt, stress]


def pose(
    structure: Structure, motion: Motion, settings: ResponseSettings, kept: float, limit: int
) -> tuple[Posed, int, int]:
    """Pose a run, from a machine's start if that comes before; and how many steps it takes before and after."""
    each = 8.0 * (3 * structure.size + 9 * len(structure.stations))
    most = min(STEPS, int(HISTORY_BYTES / each))
    fix = f"give {most * kept:.3g} s or less, or fewer stations"
    refuse_more("response.duration", "steps", settings.duration / kept, most, each, fix)
    before, after = steps_beyond(motion, settings, kept)
    problem = problem_of(structure, motion, settings.start - before * kept, settings.begin)
    return Posed(structure, motion, settings, problem, kept, limit), before, after


def steps_within(structure: Structure, q: Floats, displacement: Floats | None = None) -> int | None:
    """Steps until stations of a projected field moved by the beam's length, or particles without bound, at coordinates
    (t, n), by `displacement` (t, s, 3) where it is known.
    """
    if structure.kind == "exact":
        return None
    displacement = structure.displacement(q) if displacement is None else displacement
    limit = BOUNDLESS if structure.field is None else structure.length
    far = np.abs(displacement).max(axis=(1, 2)) > limit
    return int(np.argmax(far)) + 1 if far.any() else None


@overload
def simulate(
    structure: System,
    motion: Motion | None = None,
    settings: ResponseSettings | None = None,
    *,
    name: str = "",
    progress: Progress = None,
    **options: Unpack[Settings],
) -> SystemResponse: ...
@overload
def simulate(
    structure: Structure,
    motion: Motion,
    settings: ResponseSettings | None = None,
    *,
    name: str = "",
    progress: Progress = None,
    **options: Unpack[Settings],
) -> Response: ...
@typed
def simulate(
    structure: Structure | System,
    motion: Motion | None = None,
    settings: ResponseSettings | None = None,
    *,
    name: str = "",
    progress: Progress = None,
    **options: Unpack[Settings],
) -> Response | SystemResponse:
    """Compute the response of a beam in one environment, or of a system of bodies.

    It starts in relative equilibrium with the base's motion at the start (a free hub at rest), without vibration,
    unless ``initial`` of the settings says otherwise: ``"undeformed"``, or an :class:`Initial` state. A
    machine's run covers its whole motion on the flight's clock: spin-up comes before `start`, and spin-down after the
    duration, in whole steps of the results' grid. The step is chosen, and error and peaks are, for the flight's times.

    Parameters
    ----------
    structure : Structure or System
        From :func:`gbeam.assemble`, or a tree of bodies.
    motion : Flight, Centrifuge or Hub
        Of the root of a structure; of the ground of a system, which rests without one.
    settings : ResponseSettings, optional
        Or what it is made of, by keyword: ``simulate(structure, motion, duration=10.0)``.
    name : str
        For the result.
    progress : callable or bool, optional
        Called with what is being done and the fraction done; True shows a bar.

    Returns
    -------
    Response or SystemResponse
        Of a structure, with the loads along the beam; of a system with momentum and
        energy, its flexible bodies at first at rest relative to their roots. The outcome is ``done``, ``diverged`` (the
        displacement left what the model can mean, or the beam lost its stability) or ``not converged`` (Newton's method
        failed). Where JAX traces the structure or the motion, its arrays are traced: their derivatives are those of the
        discrete solution; there is no error estimate, a step that fails leaves NaN, and gauss fits no steps to modes
        that are traced.

    Raises
    ------
    InputError
        If the integrator cannot run this model, the beam has no damping ratio, settings are given twice, there are too
        many steps, or a traced run has no step.
    ComputationError
        If there is no relative equilibrium to start from.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> response = gb.simulate(structure, turn, duration=6.0)
    >>> response.outcome
    'done'
    >>> print(f"{1e3 * response.peaks.max_abs[2]:.3f} mm, error {response.error_estimate:.0e}")
    2.302 mm, error 1e-02
    """
    if isinstance(structure, System):
        return simulate_system(structure, motion, settings_of(settings, options), name, progress)
    settings = settings_of(settings, options)
    if motion is None:
        raise InputError("motion", "is missing", "give a Flight, a Hub or a Centrifuge; Flight(z=0.0) is at rest")
    settings = settings.chosen(free=motion.free)
    structure.require_damping("the response")
    motion = motion.over(settings.start, settings.start + settings.duration)
    if structure.holds_jax or holds_jax(motion):
        return _traced(structure, motion, settings, name)
    for kept, limit in first_steps(structure, motion, settings):
        posed, before, after = pose(structure, motion, settings, kept, limit)
        up = _ramp(posed, -before, before, progress, "spinning up")
        if up is not None and not up.whole:
            step, errors = posed.kept, StepErrors()
            return response_of(structure, motion, settings, posed.problem, (None, up, None), name, step, errors, 1)
        if up is not None:
            posed = replace(posed, problem=going_on(posed.problem, up))
        run, errors = answered(posed.plan(), partial(_run, posed, progress))
        if enough(run, errors, settings):
            break
    down = None
    if run.whole:
        ended = replace(posed, problem=going_on(posed.problem, run.trajectory))
        down = _ramp(ended, round(settings.duration / posed.kept), after, progress, "spinning down")
    runs = up, run.trajectory, down
    return response_of(structure, motion, settings, posed.problem, runs, name, run.step, errors, posed.stride(run.step))


def _ramp(posed: Posed, first: int, count: int, progress: Progress, what: str) -> Trajectory | None:
    """Spin-up or spin-down of so many steps, if there are any."""
    if not count:
        return None
    how = {"stop": posed.too_far, "progress": partial(tell, progress, what)}
    return ramp(posed.problem, posed.settings, posed.kept, first, count, **how)


def _run(posed: Posed, progress: Progress, step: float, what: str) -> Run:
    return posed.run(step, stop=posed.too_far, progress=partial(tell, progress, what))


def _traced(structure: Structure, motion: Motion, settings: ResponseSettings, name: str) -> Response:
    """A run whose values JAX traces: of a given step, without a look at them."""
    if settings.step is None:
        raise InputError("step", "is automatic, and a traced run has no numbers to choose it by", "give a step, s")
    step = settings.duration / max(1, round(settings.duration / settings.step))
    before, after = steps_beyond(motion, settings, step)
    start, count = settings.start - before * step, round(settings.duration / step)
    problem = problem_of(structure, motion, start, settings.begin)
    # One program for all of it, which is then taken apart.
    entire = integrated(problem, replace(settings, start=start, duration=(before + count + after) * step), step)
    up, trajectory, down = split(entire, before, count, after)
    assert trajectory is not None
    return response_of(structure, motion, settings, problem, (up, trajectory, down), name, step, StepErrors(), 1)


def settings_of(settings: ResponseSettings | None, options: Settings) -> ResponseSettings:
    """The settings that a function is given, as such or by keyword; InputError if both or neither are."""
    for name in options:
        choice("keyword", name, Settings.__annotations__)
    if settings is not None:
        if options:
            raise InputError(next(iter(options)), "is given beside settings", "give one of them")
        return settings
    if "duration" not in options:
        raise InputError("duration", "is missing", "give the response's, s, or settings")
    return ResponseSettings(**options)
