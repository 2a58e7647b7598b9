"""Sampled controllers in the windows of an integration: commands that are held from sample to sample.

A command depends on the state at its sample, and the recurrence over a window's steps corrects that state. So each
sample is taken within the recurrence, of the corrected state. The solution satisfies a law of any kind as it satisfies
the equations. Measurements are linear about the last iterate.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Protocol

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.errors import ComputationError
from gbeam.integrate.equations import NonlinearEquations, accelerations, slopes, solve_systems
from gbeam.integrate.steps import Steps
from gbeam.numerics.series import STEP

NEAR = 1e-6  # of a step: nearer to its beginning a sample is taken there


class Controllers(Protocol):
    """Controllers of some equations, by number: what each measures, at which times, and what it commands."""

    @property
    def timing(self) -> list[tuple[float, float]]:
        """Time between samples and delay of each, s."""
        ...

    @property
    def drives(self) -> list[slice]:
        """Part of the commands (m,) of all that belongs to each controller."""
        ...

    def measure(self, controller: int, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Return the measurements (t, k) of a controller at states and inputs with a leading axis t."""
        ...

    def measures_accelerations(self, controller: int) -> bool:
        """True if a controller measures accelerations."""
        ...

    def initial_state(self, controller: int) -> Any:
        """Return the state of a controller's law at the start of a run."""
        ...

    def command(self, controller: int, t: float, measured: Array, state: Any) -> tuple[Array, Array, Any]:
        """Return a controller's command at time t, s, as its law asks for it and within its limits, and the next state.

        Raises ComputationError if its law gives no command.
        """
        ...

    def refuse_memory(self, controller: int, t: float, measured: Array, state: Any, answer: Any) -> None:
        """Raise InputError if a law does not answer a sample as it did, with command and next state."""
        ...

    def add_commands(self, inputs: Any, commands: Array) -> Any:
        """Return the inputs with the `commands` (t, m) added."""
        ...

    @property
    def traced(self) -> bool:
        """True if JAX traces values of a controller."""
        ...


class Uncontrolled:
    """Controllers of a run that has none."""

    timing: tuple[()] = ()
    drives: tuple[()] = ()

    def laws(self, times: Any) -> list[Any]:
        """Return no laws."""
        return []

    def add_commands(self, inputs: Any, commands: Array) -> Any:
        """Return the inputs themselves."""
        return inputs


class Sampling:
    """Samples of controllers, taken at the beginnings of steps, and the commands `held` (t, m) in every step.

    Where no sample is known yet, the last commands are held. A sample is the measurements, the command as asked and as
    limited, and the next state. A `failure` is the step at whose beginning a law gave no command, and the error.
    """

    failure: tuple[int, ComputationError] | None = None

    def __init__(self, controllers: Controllers, residual: Any, drive: Any, steps: Steps) -> None:
        """Plan the samples: at which steps' beginnings they are taken, and from which on their commands act."""
        self.controllers, self.residual, self.drive, self.steps = controllers, residual, drive, steps
        self.held = np.zeros((len(steps), max((part.stop for part in controllers.drives), default=0)))
        start, begun = steps.begin[0], steps.begin + NEAR * steps.length
        # For each controller: of each step the number of the sample taken at its beginning, −1 if none is; of each
        # sample the first step in which its command acts.
        self.sample_numbers, self.acting_from = [], []
        for period, delay in controllers.timing:
            number = np.floor((begun - start) / period).astype(int)
            self.sample_numbers.append(np.where(np.diff(number, prepend=-1) > 0, number, -1))
            acting = np.floor((begun - start - delay) / period)
            self.acting_from.append(np.searchsorted(acting, np.arange(number[-1] + 2)).tolist())
        self.initial_states = [controllers.initial_state(c) for c in range(len(self.sample_numbers))]
        self.samples: list[list[tuple[Array, Array, Array, Any]]] = [[] for _ in self.sample_numbers]
        self.repeated = set[tuple[int, int]]()

    @property
    def has_begun(self) -> bool:
        """True if a sample of every controller is taken."""
        return all(self.samples)

    def hold(self, end: int) -> None:
        """Hold the last commands until step `end`."""
        for part, first_steps, samples in zip(self.controllers.drives, self.acting_from, self.samples, strict=True):
            if samples:
                self.held[first_steps[len(samples)] : end, part] = samples[-1][2]

    def take(self, c: int, s: int, step: int, measured: Array) -> bool:
        """Take sample number `s` of controller `c`, measured at the beginning of a step; return False if its law fails.

        Later samples are forgotten: they were those of an earlier iterate. An error at the first sample is raised.
        """
        samples, first_steps = self.samples[c], self.acting_from[c]
        del samples[s:]
        try:
            asked, limited, next_state = self.controllers.command(c, *self._sample(c, s, step, measured))
        except ComputationError as error:
            if not s:
                raise
            self.failure = step, error
            return False
        self.failure = None
        samples.append((measured, asked, limited, next_state))
        self.held[first_steps[s] : first_steps[s + 1], self.controllers.drives[c]] = limited
        power_of_two = s & (s - 1) == 0  # at these samples the law is asked twice: it may not remember calls
        if power_of_two and (c, s) not in self.repeated:
            self._repeat(c, s)
        return True

    def _sample(self, c: int, s: int, step: int, measured: Array) -> tuple[float, Array, Any]:
        """Time, measurements and state that the law of controller `c` receives at sample `s`."""
        return float(self.steps.begin[step]), measured, self.samples[c][s - 1][3] if s else self.initial_states[c]

    def _repeat(self, c: int, s: int) -> None:
        """Ask a law again for the sample before number `s`, or for the first one.

        A law that answers otherwise keeps a state of its own, and is refused.
        """
        self.repeated.add((c, s))
        previous = max(s - 1, 0)
        measured, asked, _, next_state = self.samples[c][previous]
        sample = self._sample(c, previous, int(np.argmax(self.sample_numbers[c] == previous)), measured)
        self.controllers.refuse_memory(c, *sample, (asked, next_state))

    def forget_failure(self, step: int) -> None:
        """Forget a failure that is not of the step where the run ended: an earlier iterate may have caused it."""
        if self.failure is not None and self.failure[0] != step:
            self.failure = None

    def sample_arrays(self, c: int) -> tuple[Array, ...]:
        """Return all measurements (s, k) of a controller, and its commands (s, m) as asked and as limited."""
        return tuple(map(np.stack, tuple(zip(*self.samples[c], strict=True))[:3]))

    def residual_slopes(self, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Derivatives ∂r/∂u (t, n, m) of the residual with respect to the commands, at states and inputs (t, ...)."""
        return self._command_slopes(self.residual, q, qd, qdd, inputs)

    def _command_slopes(self, function: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Derivatives (t, k, m), by complex steps, of a function (t, k) of states and inputs by the commands."""
        count = self.held.shape[1]
        units = np.broadcast_to(1j * STEP * np.eye(count)[:, None], (count, len(q), count))
        values = function(q, qd, qdd, self.controllers.add_commands(inputs, units))
        return np.moveaxis(np.broadcast_to(values, (count, *values.shape[-2:])).imag, 0, -1) / STEP

    def measure(self, c: int, q: Array, qd: Array, inputs: Any) -> Array:
        """Return the measurements (t, k) of controller `c` at states and inputs.

        The inputs include the commands that were held until then.
        """
        qdd = accelerations(self.residual, q, qd, inputs) if self.controllers.measures_accelerations(c) else 0 * q
        return self.controllers.measure(c, q, qd, qdd, inputs)

    def measurement_slopes(self, c: int, q: Array, qd: Array, inputs: Any) -> tuple[Array, Array | None]:
        """Return the derivatives of measurements with respect to (q, q̇) and to the commands that acted before.

        They are (t, k, 2 n) and (t, k, m). The latter are None unless accelerations are measured: positions and rates
        do not follow a command at once.
        """
        has_accelerations = self.controllers.measures_accelerations(c)
        qdd = accelerations(self.residual, q, qd, inputs) if has_accelerations else 0 * q
        measure = partial(self.controllers.measure, c)
        by_place, by_rate, by_change = slopes(measure, q, qd, qdd, inputs)
        slope = np.concatenate([by_place, by_rate], axis=-1)
        if not has_accelerations:
            return slope, None
        # M δq̈ = −(K δq + C δq̇ + the derivatives by what is commanded).
        k, damping, mass = slopes(self.residual, q, qd, qdd, inputs)
        rest = np.concatenate([k, damping, self.residual_slopes(q, qd, qdd, inputs)], axis=-1)
        by_state, by_command = np.split(by_change @ solve_systems(mass, -rest), [slope.shape[-1]], axis=-1)
        direct = self._command_slopes(measure, q, qd, qdd, inputs)
        return slope + by_state, by_command + direct


def sampling_of(equations: NonlinearEquations, steps: Steps) -> Sampling | None:
    """Return the samples that controllers of equations have to take at some steps, or None without controllers."""
    if equations.controllers is None:
        return None
    return Sampling(equations.controllers, equations.residual, equations.drive, steps)


class HeldCommands:
    """The commands that act in the steps of a window, `u` (t, m), corrected with its states."""

    def __init__(self, sampling: Sampling, first: int, count: int) -> None:
        """Take over the commands that act in a window's steps so far, and list the samples due in each step."""
        self.sampling, self.first = sampling, first
        sampling.hold(first + count)
        self.u = sampling.held[first : first + count].copy()
        self.previous_commands = sampling.held[first - 1] if first else 0 * self.u[0]
        self.change = np.zeros_like(self.u)
        self.is_settled = False
        # Samples due in each step: controller, number in the window, number in the run.
        self.due: list[list[tuple[int, int, int]]] = [[] for _ in self.u]
        # By controllers: steps of the window with a sample, and the inputs there without commands.
        self.samples, self.inputs = {}, {}
        for c, sample_numbers in enumerate(sampling.sample_numbers):
            steps = np.flatnonzero(sample_numbers[first : first + count] >= 0)
            if len(steps):
                self.samples[c], self.inputs[c] = steps, sampling.drive(sampling.steps.begin[first + steps])
            for i, k in enumerate(steps):
                self.due[k].append((c, i, int(sample_numbers[first + k])))

    def begin(self, z: Array) -> None:
        """Linearise the measurements about the states z (t, m, n) at the beginnings of steps."""
        self.slope = self._evaluate_samples(self.sampling.measurement_slopes, z)

    def measure(self, z: Array) -> None:
        """Measure at the states z (t, m, n) of the iterate."""
        self.values = self._evaluate_samples(self.sampling.measure, z)

    def _evaluate_samples(self, function: Any, z: Array) -> dict[int, Any]:
        """Evaluate a function of a controller, q, q̇ and inputs at the samples of each controller.

        The commands are those that acted before a sample. The values are returned by the controllers' numbers.
        """
        earlier = np.concatenate([self.previous_commands[None], self.u])
        values = {}
        for c, steps in self.samples.items():
            inputs = self.sampling.controllers.add_commands(self.inputs[c], earlier[steps])
            values[c] = function(c, z[steps, 0], z[steps, 1], inputs)
        return values

    def push(self, inverse: Array, t: Any, by_wrench: Array) -> None:
        """Compute the effect of a change of commands: −J⁻¹ ∂r/∂u on accelerations, and −d J⁻¹ ∂r/∂u on the next z.

        `inverse` is J⁻¹, d that of the tableau `t`, and `by_wrench` ∂r/∂u (t s, n, m).
        """
        count, n = len(self.u), by_wrench.shape[1]
        self.answer = inverse @ by_wrench.reshape(count, -1, by_wrench.shape[-1])
        by_stages = t.d @ self.answer.reshape(count, -1, n * by_wrench.shape[-1])
        self.step = -by_stages.reshape(count, -1, by_wrench.shape[-1])

    def take_samples(self, k: int, moved: Array) -> Array:
        """Take the samples at the beginning of step `k` of the window, whose state is to change by `moved` (m n,).

        Returns the change (m n,) of the next state by the change of the commands. A sample is measured to first order
        about the last iterate.
        """
        step = self.first + k
        for c, i, s in self.due[k]:  # controller, number in the window, number in the run
            by_state, by_command = self.slope[c]
            value = self.values[c][i] + by_state[i].dot(moved)
            if k and by_command is not None:
                value += by_command[i].dot(self.change[k - 1])
            if not (np.isfinite(value).all() and self.sampling.take(c, s, step, value)):
                self.change[k] = np.nan  # which ends the window before this step
                break
        else:
            self.change[k] = self.sampling.held[step] - self.u[k]
        return self.step[k].dot(self.change[k])

    def apply_change(self, shape: tuple[int, ...]) -> Array:
        """Hold the new commands, and return the change of the stages' accelerations, to be subtracted from these."""
        self.u = self.u + self.change
        return (self.answer @ self.change[..., None]).reshape(shape)

    def add_commands(self, inputs: Any, stages: int) -> Any:
        """Return the inputs (t s, ...) at all stages with the commands added."""
        return self.sampling.controllers.add_commands(inputs, np.repeat(self.u, stages, axis=0))
