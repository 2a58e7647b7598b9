"""Responses with a little less and a little more of a parameter, by the derivative of one run.

The derivative of every step is exact. The two responses are made of q ± ½ w ∂q/∂p as any response is, so that the
difference of any figure between them, over the width w, is its derivative, but for terms of second order in w. A peak
needs no rule of its own, since to first order it does not matter when it occurs.

The equations of motion are linearised about the run. A parameter enters by pairs of problems, a little less and a
little more of it, whose residuals are evaluated at the run's states.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.analysis.response.posed import Posed
from gbeam.analysis.response.problem import problem_of
from gbeam.analysis.response.record import StructureRun, response_of
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import first_step, scheme_of, steps_beyond
from gbeam.arrays.types import Floats
from gbeam.integrate.driver import through
from gbeam.integrate.equations import LinearEquations, Trajectory, accelerations, slopes
from gbeam.integrate.schemes import Scheme, added, stepped
from gbeam.integrate.steps import Steps, fitted
from gbeam.integrate.tangent import System, tangent
from gbeam.mechanics.equations.dalembert import OnBase
from gbeam.mechanics.structure import Structure
from gbeam.motion.centrifuge.kinematics import axes_result
from gbeam.motion.protocol import Motion
from gbeam.results.errors import StepErrors
from gbeam.results.machine import AxesResult
from gbeam.results.response import Response

Pair = tuple[Posed, Posed]  # the problems with less and with more of a parameter
Within = tuple[Scheme, Steps]  # a scheme and its fitted steps


def _residual(posed: Posed, within: Within | None) -> Any:
    """The residual of a problem or, `within` fitted steps, that of the modified equations which these solve."""
    equations: Any = posed.problem.equations
    if not isinstance(equations, LinearEquations):
        return equations.residual if within is None else stepped(equations, *within, len(posed.problem.q))
    c = posed.structure.coefficients
    if within is not None:
        mass, damping = added(equations, within[0], within[1].longest)
        c = replace(c, mass=c.mass + mass, damping=c.damping + damping)
    return OnBase(c)


def linearised(nominal: Posed, pairs: Sequence[Pair], width: Floats, within: Within | None = None) -> System:
    """Function of times and states of the nominal problem that returns M, C, K (t, n, n) and the forces (t, n, p) by
    parameters, each of which differs by its `width` (p,) in a pair; `within` as in `_residual`.
    """
    residual = _residual(nominal, within)
    residuals = [[_residual(posed, within) for posed in pair] for pair in pairs]
    linear = isinstance(nominal.problem.equations, LinearEquations)

    def system(time: Floats, q: Floats, qd: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        inputs = nominal.drive(time)
        if linear:
            base, loads = inputs
            c, k, f = residual.equations.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads)
            mass = np.broadcast_to(residual.equations.mass, k.shape)
            qdd = np.linalg.solve(mass[0], (f - (k @ q[..., None] + c @ qd[..., None])[..., 0]).T).T
        else:
            qdd = accelerations(residual, q, qd, inputs)
            k, c, mass = slopes(residual, q, qd, qdd, inputs)
        forces = np.empty((*q.shape, len(pairs)))
        for j, pair in enumerate(pairs):
            # A parameter of the beam alone leaves the motion as it is.
            less, more = (
                residual_of(q, qd, qdd, inputs if posed.driven_as(nominal) else posed.drive(time))
                for residual_of, posed in zip(residuals[j], pair, strict=True)
            )
            forces[..., j] = -(more - less) / width[j]
        return mass, c, k, forces

    return system


Variant = tuple[Structure | None, Motion | None]  # None: that of the nominal problem
_BYTES = 256 * 2**20  # of derivatives in memory at once
_SAME_TIME = 1e-9  # of the duration


@dataclass(frozen=True)
class Grid:
    """The step of a run, s, and how many steps of the flight's times make one of the response's."""

    step: float
    stride: int

    @staticmethod
    def of(structure: Structure, motion: Motion, settings: ResponseSettings, done: Response) -> Grid:
        """Grid of the run that a response comes from."""
        if settings.step is not None:
            return Grid(done.step, 1)
        prepared = motion.over(settings.start, settings.start + settings.duration)
        return Grid(done.step, max(1, round(first_step(structure, prepared, settings) / done.step)))


class Differentiated:
    """A run by given steps, and the responses beside it for other parameters, with `loads` and `axes` if wanted."""

    def __init__(
        self,
        structure: Structure,
        motion: Motion,
        settings: ResponseSettings,
        grid: Grid,
        name: str,
        *,
        loads: bool = True,
        axes: bool = True,
    ) -> None:
        self.grid, self.name, self.axes = grid, name, axes
        self._own_axes: AxesResult | None = None
        self.settings = replace(settings, estimate=False, loads=loads)
        start, duration = settings.start, settings.duration
        motion = motion.over(start, start + duration)
        self.scheme = scheme_of(settings)
        kept = grid.stride * grid.step
        before, after = steps_beyond(motion, settings, kept)
        self.begin = start - before * kept
        self.nominal = self._posed((structure, motion))
        self.jumps = self._jumps(self.nominal)
        count = round(duration / grid.step)
        up, down = fitted(self.begin, kept, before), fitted(start + kept * (count // grid.stride), kept, after)
        felt = self.nominal.felt.felt_by(self.scheme)
        self.parts = up, fitted(start, grid.step, count, felt), down
        # Derivatives need the states at all ends of split steps, too.
        problem = self.nominal.problem
        q, qd = problem.q, problem.qd
        self.runs: list[Trajectory | None] = []
        for part in self.parts:
            run = None
            if len(part):
                run = through(problem.equations, self.scheme, q, qd, replace(part, kept=np.ones(len(part), dtype=bool)))
                q, qd = run.q[-1], run.qd[-1]
            self.runs.append(run)

    def pair(self, less: Variant, more: Variant) -> Pair:
        """Pose the problems with a little less and a little more of a parameter."""
        return self._posed(less), self._posed(more)

    def jumps_move(self, pair: Pair) -> bool:
        """True if the jumps of either problem are not at the nominal times: steps fixed at those would miss them."""
        for posed in pair:
            jumps = self._jumps(posed)
            if len(jumps) != len(self.jumps):
                return True
            if len(jumps) and np.abs(jumps - self.jumps).max() > _SAME_TIME * self.settings.duration:
                return True
        return False

    def unvaried(self) -> Response:
        """Response of the run itself."""
        return self._response(self.nominal, [None] * 3)

    def responses(self, pairs: Sequence[Pair], width: Floats) -> Iterator[tuple[Response, Response]]:
        """Responses with less and with more of each parameter, which differ by its `width` (p,)."""
        size = 24 * self.nominal.problem.q.size * sum(len(part) + 1 for part in self.parts)  # bytes of one parameter
        count = max(1, _BYTES // size)
        for first in range(0, len(pairs), count):
            chosen, widths = pairs[first : first + count], width[first : first + count]
            slopes = self._slopes(chosen, widths)
            for k, (pair, w) in enumerate(zip(chosen, widths, strict=True)):
                moves = [None if part is None else tuple(x[..., k] * w / 2 for x in part) for part in slopes]
                back = [None if part is None else tuple(-x for x in part) for part in moves]
                yield self._response(pair[0], back), self._response(pair[1], moves)

    def _slopes(self, pairs: Sequence[Pair], width: Floats) -> list[tuple[Floats, ...] | None]:
        """Derivatives of q, q̇, q̈ (t, n, p) at the ends of kept steps of spin-up, flight, spin-down; None without."""
        system = linearised(self.nominal, pairs, width)
        less, more = zip(*pairs, strict=True)
        q, qd = (
            np.stack([getattr(b.problem, x) - getattr(a.problem, x) for a, b in zip(less, more, strict=True)], 1)
            / width
            for x in ("q", "qd")
        )
        slopes: list[tuple[Floats, ...] | None] = []
        for steps, run in zip(self.parts, self.runs, strict=True):
            if run is None:
                slopes.append(None)
                continue
            within = linearised(self.nominal, pairs, width, (self.scheme, steps))
            histories = tangent(system, self.scheme, steps, run, q, qd, within=within)
            q, qd = histories[0][-1], histories[1][-1]
            kept = np.append(True, steps.kept)
            slopes.append(tuple(x[kept] for x in histories))
        return slopes

    def _response(self, posed: Posed, moves: Sequence[tuple[Floats, ...] | None]) -> Response:
        """Response of a problem by the nominal run's histories, changed by `moves` in each part."""
        up, flight, down = (
            None if run is None else _moved(run, steps, by)
            for run, steps, by in zip(self.runs, self.parts, moves, strict=True)
        )
        assert flight is not None
        run = StructureRun(flight, self.grid.step, posed, up, down)
        return response_of(run, StepErrors(), self.name, axes_of=self._axes)

    def _axes(self, motion: Any, time: Floats) -> AxesResult | None:
        """The machine's axes if wanted; those of the nominal motion are computed once."""
        if not self.axes:
            return None
        if self._own_axes is not None and motion is self.nominal.motion:
            return self._own_axes
        axes = axes_result(motion, time)
        if motion is self.nominal.motion:
            self._own_axes = axes
        return axes

    def _posed(self, variant: Variant) -> Posed:
        """Pose the problem of a variant from the start of the nominal run."""
        structure, motion = variant
        structure = structure or self.nominal.structure
        if motion is None:
            motion = self.nominal.motion
        else:
            motion = motion.over(self.settings.start, self.settings.start + self.settings.duration)
        problem = problem_of(structure, motion, self.begin, self.settings.begin)
        return Posed(structure, motion, self.settings, problem, self.grid.stride * self.grid.step)

    def _jumps(self, posed: Posed) -> Floats:
        """Times at which something jumps."""
        return posed.felt.time[posed.felt.jump]


def _moved(run: Trajectory, steps: Steps, by: tuple[Floats, ...] | None) -> Trajectory:
    """Trajectory at the ends of the kept steps, with `by` added to its q, q̇ and q̈ (t, n)."""
    kept = np.append(True, steps.kept)
    histories = [x[kept] for x in (run.q, run.qd, run.qdd)]
    if by is not None:
        histories = [x + dx for x, dx in zip(histories, by, strict=True)]
    return Trajectory(run.time[kept], *histories)
