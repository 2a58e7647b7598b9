"""A structure in an environment posed as a problem, ready for runs by any step."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.estimate import UNMOVED
from gbeam.analysis.response.problem import Problem, problem_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import (
    MAX_STEPS,
    Plan,
    corners,
    once,
    planned,
    scheme_of,
    steps_beyond,
)
from gbeam.arrays.namespace import Array
from gbeam.arrays.types import Floats
from gbeam.guards.limits import BOUNDLESS, HISTORY_BYTES, STEPS, refuse_more
from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import Trajectory
from gbeam.integrate.steps import Corners, Steps, fitted
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import Body
from gbeam.mechanics.tree.system import terms_of
from gbeam.motion.protocol import Motion
from gbeam.progress import Progress, tell
from gbeam.results.errors import StepErrors
from gbeam.results.parts import Base
from gbeam.results.response import HubResult


@dataclass(frozen=True, eq=False)
class Posed:
    """A structure in an environment posed as a problem, to be run by any step; `kept`, s, is that of the results."""

    structure: Structure
    motion: Motion
    settings: ResponseSettings
    problem: Problem
    kept: float
    limit: int = MAX_STEPS  # steps of a run at most
    before: int = 0  # steps of the results in which a machine spins up
    after: int = 0  # steps of the results in which it spins down
    up: Trajectory | None = None  # the spin-up, once it is run

    @property
    def beam(self) -> slice:
        """The structure's coordinates among the unknowns."""
        return slice(self.problem.first, None)

    @property
    def drive(self) -> Any:
        """Function that returns the inputs of the equations at times (t,) s."""
        return self.problem.equations.drive

    def driven_as(self, other: Posed) -> bool:
        """True if motion and loads are the same objects as those of another."""
        return self.motion is other.motion and self.structure.history is other.structure.history

    @cached_property
    def felt(self) -> Corners:
        """Corners and jumps of motion and loads within the flight's times."""
        times = corners(self.structure, self.motion, self.kept)
        start, end = self.settings.start, self.settings.start + self.settings.duration
        return Corners.of(times, self.drive, start, end)

    def moving(
        self, time: Floats, y: Array, yd: Array, ydd: Array, base: Base | None = None
    ) -> tuple[Base, HubResult | None]:
        """Motion of the root at times (t,) and unknowns (t, n), or the `base` if known; and of the hub, or None."""
        motion: Any = self.motion
        hub = None
        if motion.free:
            angle, rate, acceleration = y[:, 0], yd[:, 0], ydd[:, 0]
            base = motion.mount.base(angle, rate, acceleration)
            hub = HubResult(angle, rate, acceleration, motion.torque(time), free=True)
        else:
            base = motion.base(time) if base is None else base
            if motion.kind == "hub":
                axis = motion.mount.R_HB[2]
                hub = HubResult(motion.angle(time), base.w_WB_B @ axis, base.alpha_WB_B @ axis)
        return base, hub

    @property
    def stuck(self) -> bool:
        """True if the spin-up failed before its end."""
        return self.up is not None and not self.up.whole

    def plan(self) -> Plan[Any]:
        """Plan the runs that the settings need."""
        if self.stuck:
            return once(self.kept, StepErrors())
        if not self.structure.size:  # nothing is integrated
            return once(self.kept, StepErrors(0.0, 0.0, 0.0))
        return planned(self.settings, self.kept, self.limit)

    def steps(self, step: float) -> Steps:
        """Steps of a length, s, cut at corners; a length that does not divide the duration goes beyond the end."""
        count = math.ceil(self.settings.duration / step - 1e-6)
        return fitted(self.settings.start, step, count, self.felt.felt_by(scheme_of(self.settings)))

    def begun(self, progress: Progress) -> Posed:
        """Run a machine's spin-up, if there is any; return the problem that starts from its end."""
        up = self._ramp(-self.before, self.before, partial(tell, progress, "spinning up"))
        return self if up is None else replace(self, up=up, problem=self._after(up))

    def spun_down(self, run: Trajectory, progress: Progress) -> Trajectory | None:
        """Run a machine's spin-down from the last state of a run; None if there is no spin-down."""
        first = round(self.settings.duration / self.kept)
        ended = replace(self, problem=self._after(run))
        return ended._ramp(first, self.after, partial(tell, progress, "spinning down"))

    def _after(self, run: Trajectory) -> Problem:
        """The problem from the last state of a run."""
        return replace(self.problem, q=run.q[-1], qd=run.qd[-1])

    def _ramp(self, first: int, count: int, progress: Any) -> Trajectory | None:
        """Run `count` steps of the results from the one numbered `first`, counted from the flight's start."""
        if not count:
            return None
        start, scheme, problem = self.settings.start, scheme_of(self.settings), self.problem
        how: Any = {"step": self.kept, "count": count, "start": start + self.kept * first, "progress": progress}
        run = integrate(problem.equations, scheme, problem.q, problem.qd, stop=self.too_far, **how)
        # The times of the flight's grid, to the last digit.
        time = start + self.kept * (first + np.arange(len(run.time)))
        return replace(run, time=np.asarray(time, dtype=np.float64))

    def too_far(self, y: Floats, moved: Floats | None = None) -> int | None:
        """Number of steps until a displacement exceeds the beam's length, or the bound of particles, where the model
        ceases to hold; None if none does. `moved` (t, s, 3) m are the displacements at unknowns y (t, n), if known.
        """
        if self.structure.kind == "exact":
            return None
        moved = self.structure.displacement(y[:, self.beam]) if moved is None else moved
        limit = BOUNDLESS if self.structure.field is None else self.structure.length
        far = np.abs(moved).max(axis=(1, 2)) > limit
        return int(np.argmax(far)) + 1 if far.any() else None

    def tip(self, y: Floats) -> Floats:
        """Displacement (..., 3) m of the tip; components that are rounding, as under a torque alone, are zero."""
        tip = np.asarray(self.structure.tip(y[..., self.beam]))
        return np.where(np.abs(tip) > UNMOVED * self.structure.length, tip, 0.0)

    def moment(self, y: Floats) -> Floats:
        """Root moment (..., 3) N m of the straight beam by the inertia that balances the elastic forces K q."""
        c = self.structure.coefficients
        return np.asarray(y[..., self.beam] @ (c.f_al @ np.linalg.solve(c.mass, c.stiffness)).T)

    @cached_property
    def terms(self) -> Body:
        """Terms of the structure's equations from which the loads at its root are computed."""
        return terms_of(self.structure)


def pose(structure: Structure, motion: Motion, settings: ResponseSettings, kept: float, limit: int) -> Posed:
    """Pose a problem with a step of the results, s, from the start of a machine's spin-up; InputError if too long."""
    size = 8.0 * (3 * structure.size + 9 * len(structure.stations))  # bytes of a step
    most = min(STEPS, int(HISTORY_BYTES / size))
    fix = f"give {most * kept:.3g} s or less, or fewer stations"
    refuse_more("response.duration", "steps", settings.duration / kept, most, size, fix)
    before, after = steps_beyond(motion, settings, kept)
    problem = problem_of(structure, motion, settings.start - before * kept, settings.begin)
    return Posed(structure, motion, settings, problem, kept, limit, before, after)
