"""Controllers of a system as an integration takes them, and what they did over time."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.analysis.system.gauges import read_signals
from gbeam.arrays.namespace import Array, as_array, holds_jax, looks_at_traced, namespace
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.integrate.sampled import NEAR
from gbeam.mechanics.tree.control import (
    Feedback,
    answer_of,
    clip_efforts,
    naming_controller,
    refuse_memory,
    signal_names,
)
from gbeam.mechanics.tree.signals import carried_of, drives_of, measurable
from gbeam.mechanics.tree.system import System
from gbeam.results.system import Loop

if TYPE_CHECKING:
    from gbeam.integrate.traced import TracedLaw


class SystemControllers:
    """The controllers of a system: see :class:`gbeam.integrate.sampled.Controllers`."""

    def __init__(self, system: System, tree: Any = None, laws: list[TracedLaw] | None = None) -> None:
        """Prepare the parts of the commands that belong to each controller, and where each command acts."""
        self.system, self.tree, self.traced_laws = system, system.tree if tree is None else tree, laws
        self.names, self.every = list[str](system.controllers), list[Feedback](system.controllers.values())
        ends = [0, *accumulate(len(controller.drive) for controller in self.every)]
        self.drives = [slice(*pair) for pair in pairwise(ends)]
        drives = drives_of(system)
        driven = [drives[name] for controller in self.every for name in controller.drive]
        # Efforts and wrenches by unit commands: each command adds to one of their entries.
        self.efforts = np.zeros((ends[-1], system.tree.size))
        self.wrenches = np.zeros((ends[-1], len(system.forces), 6))
        for k, drive in enumerate(driven):
            if drive.way == "effort":
                self.efforts[k, drive.at] = 1.0
            else:
                self.wrenches[k, drive.force, drive.at] = 1.0

    @property
    def timing(self) -> list[tuple[float, float]]:
        """Time between samples and delay of each controller, s."""
        return [(controller.sample, controller.delay) for controller in self.every]

    def corners(self, start: float, end: float) -> Floats:
        """Times, s, of samples and of commands that begin to act."""
        changes = [start + delay + np.arange(0.0, end - start, period) for period, delay in self.timing]
        samples = [start + np.arange(0.0, end - start, period) for period, _ in self.timing]
        return np.concatenate([*changes, *samples]) if changes else np.zeros(0)

    def measure(self, controller: int, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Return the measurements (t, k) of one controller."""
        return read_signals(self.system, self.tree, self.every[controller].measure, q, qd, qdd, inputs)

    def measures_accelerations(self, controller: int) -> bool:
        """True if one controller measures accelerations, or loads of sections, which follow from accelerations."""
        section_loads = carried_of(self.system)
        return any(".acceleration_" in name or name in section_loads for name in self.every[controller].measure)

    def initial_state(self, controller: int) -> Any:
        """Return the state of one controller at the start."""
        return self.every[controller].start if self.traced_laws is None else self.traced_laws[controller].start

    def command(self, controller: int, t: float, measured: Array, state: Any) -> tuple[Array, Array, Any]:
        """Return the command that a controller's law asks for, this command within its limits, and the next state."""
        if self.traced_laws is not None:
            law = self.traced_laws[controller]
            k = int(np.abs(law.times - t).argmin())
            values = law.function(law.parameters, law.references[k], t, measured, state)
            return tuple(map(np.asarray, values))  # type: ignore[return-value]
        feedback = self.every[controller]
        with naming_controller(self.names[controller]):
            asked, state = feedback.effort(t, measured, state)
        return asked, feedback.limited(asked), state

    def refuse_memory(self, controller: int, t: float, measured: Array, state: Any, answer: Any) -> None:
        """Raise InputError if a law that is a function does not repeat its answer to a sample."""
        if self.traced_laws is None:
            with naming_controller(self.names[controller]):
                refuse_memory(self.every[controller], t, measured, state, answer)

    def add_commands(self, inputs: Any, held: Array) -> Any:
        """Return the inputs with commands (t, m) added."""
        efforts = held @ self.efforts
        changes: dict[str, Any] = {"efforts": efforts if inputs.efforts is None else inputs.efforts + efforts}
        if inputs.wrenches is not None:
            wrenches = self.wrenches.reshape(len(self.wrenches), -1)
            changes["wrenches"] = inputs.wrenches + (held @ wrenches).reshape(
                *held.shape[:-1], *self.wrenches.shape[1:]
            )
        return replace(inputs, **changes)

    @cached_property
    def traced(self) -> bool:
        """True if JAX traces a controller."""
        return any(controller.traced for controller in self.every)

    def rebuild(self, residual: Any, laws: list[TracedLaw] | None = None) -> SystemControllers:
        """The controllers with measurements by the values of another tree, and commands by other laws."""
        return SystemControllers(self.system, residual, laws)

    def laws(self, times: list[Floats]) -> list[TracedLaw]:
        """Laws of the controllers as functions that JAX traces, each at the times (s,) of its samples, s."""
        for name, controller in self.system.controllers.items():
            for signal in {*controller.measure} & carried_of(self.system).keys():
                if holds_jax(self.system.bodies[signal.partition(".")[0]]):
                    fix = "trace what else there is, or measure acceleration"
                    raise InputError(f"controllers.{name}.measure", f"has {signal!r} of a beam that JAX traces", fix)
        return [_traced_law(*law) for law in zip(self.system.controllers, self.every, times, strict=True)]


def loop_of(controllers: SystemControllers, sampling: Any, time: Floats) -> Loop:
    """Record of the controllers at times (t,) s: samples, and commands asked for and acting, as held between
    samples.
    """
    start, slack = sampling.steps.begin[0], NEAR * float(sampling.steps.length.min())
    measured, asked, acting, saturated = [], [], [], []
    largest: list[list[Floats]] = [[], [], []]
    for c, (period, delay) in enumerate(controllers.timing):
        sample_counts = np.floor((time + slack - start) / period).astype(int)
        active = np.floor((time + slack - start - delay) / period).astype(int)
        values, wanted, commands = sampling.sample_arrays(c)
        # The last time may be that of a sample which no step has taken.
        sample_counts, last = np.minimum(sample_counts, len(values) - 1), np.clip(active, 0, len(values) - 1)
        measured.append(values[sample_counts])
        asked.append(wanted[sample_counts])
        saturated.append((wanted != commands).mean(axis=0))
        for sizes, of_samples in zip(largest, (values, wanted, commands), strict=True):
            sizes.append(abs(of_samples).max(axis=0))
        acting.append(namespace(commands).where(active[:, None] >= 0, commands[last], 0.0))
    xp, units = namespace(*asked), measurable(controllers.system)
    drives = drives_of(controllers.system)
    return Loop(
        measurements=signal_names(controllers.system.controllers, "measure"),
        units=tuple(units[name] for controller in controllers.every for name in controller.measure),
        drives=signal_names(controllers.system.controllers, "drive"),
        drive_units=tuple(drives[name].unit for controller in controllers.every for name in controller.drive),
        measured=xp.concatenate(measured, axis=1),
        asked=xp.concatenate(asked, axis=1),
        applied=xp.concatenate(acting, axis=1),
        saturated=xp.concatenate(saturated),
        measured_max=xp.concatenate(largest[0]),
        asked_max=xp.concatenate(largest[1]),
        applied_max=xp.concatenate(largest[2]),
    )


def _traced_law(name: str, controller: Feedback, times: Floats) -> TracedLaw:
    """Express a controller's law at its samples' times (s,) s as a function of parameters and references for JAX."""
    from jax.flatten_util import ravel_pytree

    from gbeam.integrate.traced import TracedLaw

    sign, values = 1.0, [np.zeros(len(times)) for _ in controller.measure]
    if controller.reference is not None:
        sign, values = -1.0, [profile(times) for profile in controller.reference]
    references = namespace(*values).stack(values, axis=-1)
    if isinstance(controller.law, tuple):
        law, parameters, start = _linear, controller.law, controller.start
    else:
        start, restored = ravel_pytree(controller.state)
        with naming_controller(name):
            law, parameters = _compile_function(controller, start, restored)

    def command(parameters: Any, references: Array, t: Any, y: Array, state: Array) -> tuple[Array, ...]:
        """Command as the law asks for it, the command within its limit, and the next state."""
        parts, limit = parameters
        asked, next_state = law(parts, t, references + sign * y, state)
        if limit is None:
            return asked, asked, next_state
        return asked, clip_efforts(namespace(asked, limit), as_array(limit), asked), next_state

    return TracedLaw(times, command, (parameters, controller.limit), references, start)


def _linear(parts: Any, _: Any, error: Array, state: Array) -> tuple[Array, Array]:
    """Commands and next state of a law by matrices."""
    a, b, c, d = parts
    return c @ state + d @ error, a @ state + b @ error


def _compile_function(controller: Feedback, start: Array, restored: Any) -> tuple[Any, Any]:
    """Compile a law that is a function, with the values that it refers to as its first argument. Returns the compiled
    function and these values.
    """
    import jax
    import jax.numpy as jnp
    from jax.flatten_util import ravel_pytree

    count = len(controller.drive)

    def plain(t: Any, error: Array, state: Array) -> tuple[Array, Array]:
        """Efforts and next state as flat arrays."""
        if controller.stateful:
            efforts, next_state = answer_of(controller, t, error, restored(state))
            return jnp.asarray(efforts, dtype=float).reshape(-1), ravel_pytree(next_state)[0].astype(float)
        return jnp.asarray(answer_of(controller, t, error, state), dtype=float).reshape(-1), state

    example = 0.0, jnp.zeros(len(controller.measure)), start
    try:
        law, parts = jax.closure_convert(plain, *example)
        efforts, after = jax.eval_shape(plain, *example)
    except Exception as error:
        if not looks_at_traced(error):
            raise
        fix = "write it with jax.numpy, and jax.numpy.where in place of if"
        raise InputError("law", "looks at numbers that JAX traces", fix) from error
    if efforts.shape != (count,) or after.shape != start.shape:
        problem = f"gives {efforts.shape[0]} efforts and a state of {after.shape[0]} numbers"
        raise InputError("law", problem, f"give {count}, and {start.shape[0]}")
    compiled = jax.jit(lambda parts, t, error, state: law(t, error, state, *parts))
    return compiled, parts
