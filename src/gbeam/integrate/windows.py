"""Nonlinear equations in time without compiling: windows of many steps solved together.

One call of the residual evaluates all stages of a window, and one correction of Newton's method all its unknowns. The
window slides. Steps that have converged leave it at its beginning. Where its last step is near, further ones follow,
each at first like the last: the next correction makes the linear response about that state. Steps that stay far are
taken out. Where the first one does, the window begins anew and shorter, with a single step at last, which takes
Newton's method proper. Interpolated derivatives may be wrong. With them a step is left only if the residual is small
beside its forces, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.integrate.derivatives import Derivatives
from gbeam.integrate.equations import NonlinearEquations, accelerations, exact_residual
from gbeam.integrate.sampled import Sampling
from gbeam.integrate.schemes import Scheme, fitted_residual
from gbeam.integrate.steps import Steps
from gbeam.integrate.verdict import ROUNDING, Judgement, Verdict, balanced_steps
from gbeam.integrate.window import Window

Piece = tuple[Any, ...]
ENOUGH = 100  # steps whose ends are found together, at least; it changes no correction and no answer


def windows(
    equations: NonlinearEquations, scheme: Scheme, q: Array, qd: Array, steps: Steps, samples: Sampling | None = None
) -> Iterator[Piece]:
    """Integrate nonlinear equations, and take the `samples` of controllers.

    Yields pieces of q, q̇, q̈ (k, n) at the ends of kept steps, with flags (k,) of those solved. The first piece is the
    initial state. q̈ is missing unless the scheme's last stage is the end of the step.
    """
    if not q.size:  # all motion is prescribed
        empty = np.zeros((1 + np.count_nonzero(steps.kept), 0))
        yield from ((piece, piece, piece, np.ones(len(piece), dtype=bool)) for piece in (empty[:1], empty[1:]))
        return
    drive, residual = equations.drive, fitted_residual(equations, scheme, steps, len(q))

    def acceleration(t: Any, q: Array, qd: Array) -> Array:
        return accelerations(exact_residual(residual), q[None], qd[None], drive(np.array([t])))[0]

    with np.errstate(all="ignore"):  # of iterates that diverge
        qdd = acceleration(steps.drive_begin[0], q, qd)
    yield *(x[None] for x in (q, qd, qdd)[: 2 + scheme.ends]), np.array([True])
    window, begin = Window(residual, drive, scheme, steps, samples), 0
    solver = _Solver(window, Derivatives(residual, samples), Verdict())
    # A scheme whose last stage is the end of a step begins anew after a jump: no window goes beyond one.
    for end in np.append(np.flatnonzero(steps.anew[:-1]) + 1 if scheme.ends else [], len(steps)).astype(int):
        solver.begin(scheme.tableau(steps.length[begin]).initial @ np.stack([q, qd, qdd]), qdd)
        while begin < end:
            with np.errstate(all="ignore"):
                solved = solver.solve(end, min(end, begin + ENOUGH))
                if window.first > begin:
                    ended = window.take_ends()
                    q, qd = ended[0][-1], ended[1][-1]
                    if scheme.ends and window.first == end and steps.anew[end - 1]:
                        qdd, ended[2][-1] = (acceleration(time[end - 1], q, qd) for time in (steps.resume, steps.end))
                    is_recorded = steps.kept[begin : window.first]
                    yield *(ends[is_recorded] for ends in ended), np.ones(np.count_nonzero(is_recorded), dtype=bool)
            if not solved:
                if samples is not None:
                    samples.forget_failure(window.first)
                yield *np.full((2 + scheme.ends, 1, len(qdd)), np.nan), np.array([False])
                return
            begin = window.first


class _Solver:
    """Newton's method for a window, by its derivatives, as far as the verdict on its corrections lets it go."""

    def __init__(self, window: Window, derivatives: Derivatives, verdict: Verdict) -> None:
        self.parts = self.window, self.derivatives, self.verdict = window, derivatives, verdict

    def begin(self, z: Array, x: Array) -> None:
        """Begin with no step, from a state z (m, n) and accelerations (n,)."""
        self.window.begin(z, x)
        self.derivatives.begin()
        self.verdict.begin()

    def solve(self, end: int, enough: int) -> bool:
        """Correct the steps of the window, all before `end`, until the first `enough` steps of the run have converged
        and left. Return False if a single step fails.
        """
        while self.window.first < enough:
            self._follow(end)
            judgement = self._correct()
            converged_steps, lost_steps = judgement.converged_steps, judgement.lost_steps
            done = len(converged_steps) if converged_steps.all() else int(np.argmin(converged_steps))
            if done and (self.window.sampling is None or done == len(converged_steps)):
                for part in self.parts:
                    part.leave(done)
                lost_steps = lost_steps[done:]
            if lost_steps.any() and not self._withdraw(int(np.argmax(lost_steps))):
                return False
        return True

    def _follow(self, end: int) -> None:
        """Append steps before `end`, if the last one is near its solution."""
        if len(self.window) and not self.verdict.last_is_near:
            return
        added = self.window.room(end, single=self.derivatives.has_one_set)
        if added:
            for part in self.parts:
                part.extend(added)

    def _correct(self) -> Judgement:
        """Make one correction of all steps, by derivatives that are renewed where they are old, and judge it."""
        window, derivatives, verdict = self.parts
        stages = window.stages()
        derivatives.renew(stages)
        derivatives.factor(stages, window.tableau, window.held)
        forces, fresh, trusted = derivatives.forces(stages.states), derivatives.fresh_steps, derivatives.trusted_steps
        if verdict.has_begun:  # a first correction is far larger than rounding
            verdict.set_rounding(derivatives.accelerations(forces))
        verdict.record(window.correct(stages, derivatives.maps), window.x)
        if verdict.arrived:
            window.grow()
        if window.held is not None:
            window.held.is_settled = verdict.commands_settle
        # The rounding of loads is computed only where corrections do not shrink: it costs three more residuals.
        loads, by_loads = 0 * forces, np.float64(0.0)
        if verdict.stuck_steps.any():
            loads, within_bodies = window.loads(stages)
            near = (verdict.shares <= ROUNDING)[:, None]  # elsewhere the second difference is no rounding
            by_loads = derivatives.accelerations(loads + np.where(near, within_bodies, 0.0))
        in_balance = balanced_steps(window.residuals, forces, loads)
        judgement = verdict.judge(by_loads, in_balance, fresh=fresh, trusted=trusted)
        derivatives.grow_old(verdict.shares, judgement.slow_steps, fast=verdict.shrinks_fast)
        return judgement

    def _withdraw(self, first: int) -> bool:
        """Take out the steps from `first` on, which are lost. If that is the window's own first step, begin again with
        fewer; return False if the window is a single step.
        """
        if first:
            for part in self.parts:
                part.cut(first)
            return True
        if not self.window.shrink():
            return False
        self.derivatives.begin()
        self.verdict.begin()
        return True
