"""Responses with a little less and a little more of a parameter, by the derivative of one run.

The derivative of every step is exact. The two responses are made of q ± ½ w ∂q/∂p, as any response is. The difference
of any figure between them, over the width w, is therefore its derivative, but for terms of second order in w. A peak
needs no rule of its own, since to first order it does not matter when it occurs.

The equations of motion are linearised about the run. A parameter enters by pairs of problems, a little less and a
little more of it, whose residuals are evaluated at the run's states.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.analysis.response.posed import Posed, begun, first_step, pose, prepared
from gbeam.analysis.response.record import response_of
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import scheme_of
from gbeam.arrays.types import Floats
from gbeam.integrate.driver import integrate_steps
from gbeam.integrate.equations import LinearEquations, Trajectory, accelerations, slopes
from gbeam.integrate.schemes import Scheme, fitted_residual, fitting_terms
from gbeam.integrate.steps import Steps
from gbeam.integrate.tangent import System as Tangent
from gbeam.integrate.tangent import tangent
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.centrifuge.histories import axes_result
from gbeam.motion.protocol import Motion
from gbeam.results.errors import StepErrors
from gbeam.results.machine import AxesResult

Pair = tuple[Posed, Posed]  # the problems with less and with more of a parameter
Fitted = tuple[Scheme, Steps]  # a scheme and its fitted steps


@dataclass(frozen=True, eq=False)
class _Linear:
    """Residual of linear equations, with terms added to their M and C (n, n)."""

    equations: LinearEquations
    mass: Floats | float = 0.0
    damping: Floats | float = 0.0

    def slopes(self, inputs: Any) -> tuple[Floats, Floats, Floats, Floats]:
        """M, C, K (t, n, n) and F (t, n) at inputs (t, ...)."""
        c, k, f = self.equations.matrices(inputs)
        return np.broadcast_to(self.equations.mass + self.mass, k.shape), c + self.damping, k, f

    def __call__(self, q: Floats, qd: Floats, qdd: Floats, inputs: Any) -> Floats:
        mass, c, k, f = self.slopes(inputs)
        forces = mass @ qdd[..., None] + c @ qd[..., None] + k @ q[..., None]
        return np.asarray(forces[..., 0] - f)


def _residual(posed: Posed, fitted: Fitted | None) -> Any:
    """The residual of a problem or, `fitted` fitted steps, that of the modified equations which these solve."""
    equations: Any = posed.equations
    if not isinstance(equations, LinearEquations):
        return equations.residual if fitted is None else fitted_residual(equations, *fitted, len(posed.start.y))
    return _Linear(equations, *(() if fitted is None else fitting_terms(equations, fitted[0], fitted[1].longest)))


def linearised(nominal: Posed, pairs: Sequence[Pair], width: Floats, fitted: Fitted | None = None) -> Tangent:
    """Return a function of times and states of the nominal problem that gives M, C, K (t, n, n) and forces (t, n, p).

    Forces are those by p parameters, each of which differs by its `width` (p,) in a pair. `fitted` are the fitted steps
    as in `_residual`.
    """
    residual = _residual(nominal, fitted)
    residuals = [[_residual(posed, fitted) for posed in pair] for pair in pairs]

    def system(time: Floats, q: Floats, qd: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        inputs = nominal.equations.drive(time)
        if isinstance(residual, _Linear):
            mass, c, k, f = residual.slopes(inputs)
            qdd = np.linalg.solve(mass[0], (f - (k @ q[..., None] + c @ qd[..., None])[..., 0]).T).T
        else:
            qdd = accelerations(residual, q, qd, inputs)
            k, c, mass = slopes(residual, q, qd, qdd, inputs)
        forces = np.empty((*q.shape, len(pairs)))
        for j, pair in enumerate(pairs):
            remaining = []
            for pair_residual, posed in zip(residuals[j], pair, strict=True):
                # A parameter of the bodies alone leaves the motion as it is.
                driven = inputs if posed.driven_as(nominal) else posed.equations.drive(time)
                remaining.append(pair_residual(q, qd, qdd, driven))
            forces[..., j] = -(remaining[1] - remaining[0]) / width[j]
        return mass, c, k, forces

    return system


Variant = tuple[Structure | System | None, Motion | None]  # None: that of the nominal problem
_BYTES = 256 * 2**20  # of derivatives in memory at once
_SAME_TIME = 1e-9  # of the duration


@dataclass(frozen=True)
class Grid:
    """The step of a run, s, and how many steps of the flight's times make one of the response's."""

    step: float
    stride: int

    @staticmethod
    def from_run(structure: Structure | System, motion: Motion | None, settings: ResponseSettings, done: Any) -> Grid:
        """Grid of the run that a response comes from."""
        if settings.step is not None:
            return Grid(done.step, 1)
        subject = prepared(structure, motion, settings)
        result_step = first_step(subject, begun(subject, settings, settings.start), settings)
        return Grid(done.step, max(1, round(result_step / done.step)))


class Differentiated:
    """A run by given steps, and the responses beside it for other parameters, with `loads` and `axes` if wanted."""

    def __init__(
        self,
        structure: Structure | System,
        motion: Motion | None,
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
        self.scheme = scheme_of(settings)
        subject = prepared(structure, motion, self.settings)
        self.given: tuple[Structure | System, Motion | None] = structure, subject.motion
        self.nominal = pose(subject, self.settings, grid.stride * grid.step)
        self.jumps = self._jumps(self.nominal)
        self.steps = self.nominal.steps(grid.step)
        # Derivatives need the states at all ends of split steps, too.
        every_step = replace(self.steps, kept=np.ones(len(self.steps), dtype=bool))
        start = self.nominal.start
        self.run = integrate_steps(self.nominal.equations, self.scheme, start.y, start.yd, every_step)

    def pair(self, lower: Variant, upper: Variant) -> Pair:
        """Pose the problems with a little less and a little more of a parameter."""
        return self._varied(lower), self._varied(upper)

    def jumps_move(self, pair: Pair) -> bool:
        """True if the jumps of either problem are not at the nominal times: steps fixed at those would miss them."""
        for posed in pair:
            jumps = self._jumps(posed)
            if len(jumps) != len(self.jumps):
                return True
            if len(jumps) and np.abs(jumps - self.jumps).max() > _SAME_TIME * self.settings.duration:
                return True
        return False

    def unvaried(self) -> Any:
        """Response of the run itself; diverged where a displacement is not finite, or the model ceases to hold."""
        response = self._response(self.nominal, None)
        if np.isfinite(self.run.q).all() and self.nominal.steps_in_bounds(self.run.q) is None:
            return response
        return replace(response, outcome="diverged", message="a displacement exceeded the length of its body")

    def responses(self, pairs: Sequence[Pair], width: Floats) -> Iterator[tuple[Any, Any]]:
        """Responses with less and with more of each parameter, which differ by its `width` (p,)."""
        size = 24 * self.nominal.start.y.size * (len(self.steps) + 1)  # bytes of one parameter
        count = max(1, _BYTES // size)
        for first in range(0, len(pairs), count):
            chosen, widths = pairs[first : first + count], width[first : first + count]
            slopes = self._slopes(chosen, widths)
            for k, (pair, w) in enumerate(zip(chosen, widths, strict=True)):
                moves = tuple(x[..., k] * w / 2 for x in slopes)
                yield self._response(pair[0], tuple(-x for x in moves)), self._response(pair[1], moves)

    def _slopes(self, pairs: Sequence[Pair], width: Floats) -> tuple[Floats, ...]:
        """Derivatives of q, q̇, q̈ (t, n, p) at the ends of kept steps."""
        lower, upper = zip(*pairs, strict=True)
        q, qd = (
            np.stack([getattr(b.start, x) - getattr(a.start, x) for a, b in zip(lower, upper, strict=True)], 1) / width
            for x in ("y", "yd")
        )
        system = linearised(self.nominal, pairs, width)
        variation = linearised(self.nominal, pairs, width, (self.scheme, self.steps))
        histories = tangent(system, self.scheme, self.steps, self.run, q, qd, linear_system=variation)
        is_recorded = np.append(True, self.steps.kept)
        return tuple(x[is_recorded] for x in histories)

    def _response(self, posed: Posed, slopes: tuple[Floats, ...] | None) -> Any:
        """Response of a problem by the nominal run's histories at the ends of recorded steps.

        These are changed by the `slopes` of q, q̇ and q̈, if there are any.
        """
        is_recorded = np.append(True, self.steps.kept)
        histories = [x[is_recorded] for x in (self.run.q, self.run.qd, self.run.qdd)]
        if slopes is not None:
            histories = [x + dx for x, dx in zip(histories, slopes, strict=True)]
        moved = Trajectory(self.run.time[is_recorded], *histories)
        return response_of(Run(moved, self.grid.step, posed), StepErrors(), self.name, axes_of=self._axes)

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

    def _varied(self, variant: Variant) -> Posed:
        """Pose the problem of a variant from the start of the nominal run, with its spin-up and spin-down."""
        (structure, motion), (structure_now, motion_now) = variant, self.given
        structure, motion = structure or structure_now, motion or motion_now
        subject, nominal = prepared(structure, motion, self.settings), self.nominal
        return replace(nominal, subject=subject, start=begun(subject, self.settings, nominal.begin))

    def _jumps(self, posed: Posed) -> Floats:
        """Times at which something jumps."""
        return posed.felt.time[posed.felt.jump]
