"""A run that is posed: its equations, initial state, corners and steps, and what its runs are judged by."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gbeam.analysis.response.problem import Problem, problem_of
from gbeam.analysis.response.record import moving
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.step_errors import Readings, Run
from gbeam.analysis.response.stepping import (
    Plan,
    corners,
    first_step,
    integrated,
    once,
    planned,
    scheme_of,
    steps_beyond,
)
from gbeam.guards.limits import BOUNDLESS, HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.equations import Trajectory
from gbeam.integrate.steps import Corners, Steps, fitted
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.errors import StepErrors
from gbeam.results.result import Floats

UNMOVED = 1e-14  # of the length
NOTHING = 1e-7  # of the other load, over a length of the beam: a force or moment that is less is rounding


@dataclass(frozen=True, eq=False)
class Posed:
    """A run at the flight's times from a problem's state, ready to be integrated with any step; `coarse` and `given` in
    s.
    """

    structure: Structure
    motion: Motion
    settings: ResponseSettings
    problem: Problem
    coarse: float
    given: float | None

    @property
    def kept(self) -> float:
        """Step of the results, s."""
        return self.given or self.coarse

    @cached_property
    def felt(self) -> Corners:
        """Corners and jumps of what drives the run."""
        times = corners(self.structure, self.motion, self.coarse)
        start, end = self.settings.start, self.settings.start + self.settings.duration
        return Corners.of(times, self.problem.equations.drive, start, end)

    def plan(self) -> Plan:
        """Plan the runs that the settings need."""
        if not self.structure.size:  # nothing is integrated
            return once(self.kept, StepErrors(0.0, 0.0, 0.0))
        return planned(self.settings, self.coarse, self.given)

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
        return 1 if self.settings.step is not None else round(self.coarse / step)

    def too_far(self, y: Floats) -> int | None:
        """After how many steps a projected field moved by the beam's length, and means nothing; None if it did not."""
        return steps_within(self.structure, self.structure.displacement(y[:, self.problem.first :]))

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
        """Force and moment at the root, and both sides' stress at every section; none where the settings have none."""
        if not self.settings.loads:
            return []
        some = slice(None, None, stride)
        time, q, qd, qdd = (x[some] for x in (trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd))
        base, _ = moving(self.motion, time, q, qd, qdd)
        q, qd, qdd = (x[:, self.problem.first :] for x in (q, qd, qdd))
        forces = section_forces(self.structure, base, q, qd, qdd, time, motion=self.motion)
        sides = [forces.stress_tension, forces.stress_compression]
        if forces.von_mises is not None and np.isfinite(forces.von_mises).all():
            sides.append(forces.von_mises)  # of what is only twisted the others are rounding
        stress = np.concatenate(sides, axis=1)[..., None]
        force, moment = forces.section_force[:, 0], forces.section_moment[:, 0]
        largest = np.abs(force).max() * self.structure.length, np.abs(moment).max()
        return [
            force * (largest[0] > NOTHING * largest[1]),
            moment * (largest[1] > NOTHING * largest[0]),
            stress,
        ]


def pose(structure: Structure, motion: Motion, settings: ResponseSettings) -> tuple[Posed, int, int]:
    """Pose a run, from a machine's start if that comes before; and how many steps it takes before and after."""
    coarse = first_step(structure, motion, settings)
    step = None if settings.step is None else settings.duration / max(1, round(settings.duration / settings.step))
    kept = step or coarse
    each = 8.0 * (3 * structure.size + 9 * len(structure.stations))
    most = min(STEPS, int(HISTORY_BYTES / each))
    fix = f"give {most * kept:.3g} s or less, or fewer stations"
    refuse_more("response.duration", "steps", settings.duration / kept, most, each, fix)
    before, after = steps_beyond(motion, settings, kept)
    problem = problem_of(structure, motion, settings.start - before * kept, settings.begin)
    return Posed(structure, motion, settings, problem, coarse, step), before, after


def steps_within(structure: Structure, displacement: Floats) -> int | None:
    """Steps until stations (t, s, 3) of a projected field moved by the beam's length, or particles without bound."""
    if structure.kind == "exact":
        return None
    limit = BOUNDLESS if structure.field is None else structure.length
    far = np.abs(displacement).max(axis=(1, 2)) > limit
    return int(np.argmax(far)) + 1 if far.any() else None
