"""Sampled controllers in the windows of an integration: commands that are held from sample to sample.

A command depends on the state at its sample, and what moves this state is what the recurrence over a window's steps
corrects: so each sample is taken there, of the corrected state, and a law of any kind is satisfied by the solution as
the equations are. Measurements are linear about the last iterate.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Protocol

import numpy as np

from gbeam.integrate.equations import NonlinearEquations, accelerations, slopes, solved
from gbeam.integrate.steps import Steps
from gbeam.numerics.series import STEP

Array = Any
NEAR = 1e-6  # of a step: nearer to its beginning a sample is taken there


class Controllers(Protocol):
    """Controllers of some equations: what each measures, at which times, and what it commands."""

    @property
    def timing(self) -> list[tuple[float, float]]:
        """Time between samples and delay of each, s."""
        ...

    @property
    def drives(self) -> list[slice]:
        """Numbers that each commands among those of all."""
        ...

    def measured(self, controller: int, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Measurements (t, k) of one at states and inputs with a leading axis t."""
        ...

    def accelerates(self, controller: int) -> bool:
        """Return whether one measures accelerations."""
        ...

    def started(self, controller: int) -> Any:
        """State of one at the start."""
        ...

    def commanded(self, controller: int, t: float, measured: Array, state: Any) -> tuple[Array, Array, Any]:
        """Command of one, as its law has it and as its limits leave it, and its next state."""
        ...

    def driven(self, inputs: Any, held: Array) -> Any:
        """Inputs with what is commanded (t, m) added."""
        ...


class Sampling:
    """Samples of a run's controllers, taken at the beginnings of steps: commands, measurements and states so far."""

    def __init__(self, controllers: Controllers, residual: Any, drive: Any, steps: Steps) -> None:
        self.controllers, self.residual, self.drive, self.steps = controllers, residual, drive, steps
        self.count = max(part.stop for part in controllers.drives)
        start, slack = steps.begin[0], NEAR * steps.length
        self.taken, self.acting = [], []
        for period, delay in controllers.timing:
            number = np.floor((steps.begin + slack - start) / period).astype(int)
            before = np.concatenate([[-1], number[:-1]])
            self.taken.append(np.where(number > before, number, -1))
            self.acting.append(np.floor((steps.begin + slack - start - delay) / period).astype(int))
        kinds = range(len(self.taken))
        self.states: list[list[Any]] = [[controllers.started(c)] for c in kinds]
        self.asked: list[list[Array]] = [[] for _ in kinds]
        self.commands: list[list[Array]] = [[] for _ in kinds]
        self.measurements: list[list[Array]] = [[] for _ in kinds]

    def held(self, step: int) -> Array:
        """Commands (m,) that act in a step; the latest where they are not known yet."""
        out = np.zeros(self.count)
        for part, acting, commands in zip(self.controllers.drives, self.acting, self.commands, strict=True):
            if acting[step] >= 0 and commands:
                out[part] = commands[min(acting[step], len(commands) - 1)]
        return out

    def sampled(self, step: int, measure: Any) -> None:
        """Take the samples at the beginning of a step, of measurements that a function gives by controller."""
        for c, taken in enumerate(self.taken):
            if taken[step] < 0:
                continue
            s, value = int(taken[step]), measure(c)
            time, state = float(self.steps.begin[step]), self.states[c][s]
            asked, limited, after = self.controllers.commanded(c, time, value, state)
            # What was sampled of earlier iterates from here on goes.
            self.measurements[c][s:], self.asked[c][s:], self.commands[c][s:] = [value], [asked], [limited]
            self.states[c][s + 1 :] = [after]

    def onto(self, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Derivatives (t, n, m) of the residual with respect to what is commanded, at states and inputs (t, ...)."""
        units = np.broadcast_to(1j * STEP * np.eye(self.count)[:, None], (self.count, len(q), self.count))
        values = self.residual(q, qd, qdd, self.controllers.driven(inputs, units))
        return np.moveaxis(values.imag, 0, -1) / STEP

    def measured(self, c: int, at: Array, q: Array, qd: Array, held: Array) -> Array:
        """Measurements (t, k) of a controller at beginnings `at` (t,) of steps, by states and commands before."""
        inputs = self.controllers.driven(self.drive(self.steps.begin[at]), held)
        qdd = accelerations(self.residual, q, qd, inputs) if self.controllers.accelerates(c) else 0 * q
        return self.controllers.measured(c, q, qd, qdd, inputs)

    def slopes(self, c: int, at: Array, q: Array, qd: Array, held: Array) -> tuple[Array, Array | None]:
        """Derivatives of measurements with respect to (q, q̇), (t, k, 2 n), and to the commands before (t, k, m); None
        of those where only accelerations would follow at once.
        """
        inputs = self.controllers.driven(self.drive(self.steps.begin[at]), held)
        accelerates = self.controllers.accelerates(c)
        qdd = accelerations(self.residual, q, qd, inputs) if accelerates else 0 * q
        by_place, by_rate, by_change = slopes(partial(self.controllers.measured, c), q, qd, qdd, inputs)
        slope = np.concatenate([by_place, by_rate], axis=-1)
        if not accelerates:
            return slope, None
        # M δq̈ = −(K δq + C δq̇ + the derivatives by what is commanded).
        k, damping, mass = slopes(self.residual, q, qd, qdd, inputs)
        rest = np.concatenate([k, damping, self.onto(q, qd, qdd, inputs)], axis=-1)
        change = by_change @ solved(mass, -rest)
        return slope + change[..., : slope.shape[-1]], change[..., slope.shape[-1] :]


def sampling_of(equations: NonlinearEquations, steps: Steps) -> Sampling | None:
    """Samples of the controllers of some equations at given steps; None without any."""
    if equations.controllers is None:
        return None
    sampling = Sampling(equations.controllers, equations.residual, equations.drive, steps)
    equations.samplings.append(sampling)
    return sampling


class Held:
    """The commands that act in the steps of a window, `u` (t, m), corrected with its states."""

    def __init__(self, sampling: Sampling, first: int, count: int) -> None:
        self.sampling, self.first = sampling, first
        self.u = np.stack([sampling.held(first + k) for k in range(count)])
        self.before = sampling.held(first - 1) if first else np.zeros(sampling.count)
        self.change = np.zeros_like(self.u)
        self.samples = [np.flatnonzero(taken[first : first + count] >= 0) for taken in sampling.taken]
        self.sample = [{int(k): i for i, k in enumerate(each)} for each in self.samples]
        self.values: list[Array] = []
        self.slope: list[tuple[Array, Array | None]] = []

    def begin(self, z: Array) -> None:
        """Find how measurements follow the states z (t, m, n) at the beginnings of steps."""
        self.slope = [
            self.sampling.slopes(c, self.first + at, z[at, 0], z[at, 1], self._before(at)) if len(at) else (0, 0)
            for c, at in enumerate(self.samples)
        ]

    def _before(self, at: Array) -> Array:
        """Commands that act before the beginnings of steps."""
        return np.concatenate([self.before[None], self.u])[at]

    def measure(self, z: Array) -> None:
        """Measure at the states of the iterate."""
        self.values = [
            self.sampling.measured(c, self.first + at, z[at, 0], z[at, 1], self._before(at)) if len(at) else at
            for c, at in enumerate(self.samples)
        ]

    def push(self, inverse: Array, t: Any, onto: Array) -> None:
        """Find how a step answers to its commands, J⁻¹ of their derivatives (t s, n, m)."""
        count, n = len(self.u), onto.shape[1]
        self.answer = inverse @ onto.reshape(count, -1, onto.shape[-1])
        through = t.d @ self.answer.reshape(count, -1, n * onto.shape[-1])
        self.step = -through.reshape(count, -1, onto.shape[-1])

    def sampled(self, k: int, moved: Array) -> Array:
        """Take the samples of a step whose state is to be moved (m n,), and return what its commands change."""

        def measured(c: int) -> Array:
            i, (by_state, by_command) = self.sample[c][k], self.slope[c]
            value = self.values[c][i] + by_state[i] @ moved
            return value + by_command[i] @ self.change[k - 1] if k and by_command is not None else value

        self.sampling.sampled(self.first + k, measured)
        self.change[k] = self.sampling.held(self.first + k) - self.u[k]
        return self.step[k] @ self.change[k]

    def changed(self, shape: tuple[int, ...]) -> Array:
        """Hold the new commands; returns what they change of the accelerations, to be taken away from these."""
        self.u = self.u + self.change
        return (self.answer @ self.change[..., None]).reshape(shape)

    def driven(self, inputs: Any, stages: int) -> Any:
        """Inputs at all stages with the commands."""
        return self.sampling.controllers.driven(inputs, np.repeat(self.u, stages, axis=0))
