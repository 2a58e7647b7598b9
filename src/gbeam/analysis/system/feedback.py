"""Controllers of a system as an integration takes them, and what they did over time."""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.integrate.sampled import NEAR, Sampling
from gbeam.mechanics.tree.control import Feedback, signal_names
from gbeam.mechanics.tree.signals import drives_of, measurements, signals_of
from gbeam.mechanics.tree.system import System
from gbeam.results.system import Loop

Array = Any
Floats = NDArray[np.float64]


class SystemControllers:
    """The controllers of a system: see :class:`gbeam.integrate.sampled.Controllers`."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.every: list[Feedback] = list(system.controllers.values())
        ends = [0, *accumulate(len(each.drive) for each in self.every)]
        self.drives = [slice(*pair) for pair in pairwise(ends)]
        drives = drives_of(system)
        driven = [drives[name] for each in self.every for name in each.drive]
        # Of every command the effort or the component of a wrench that it adds to.
        self.efforts, self.wrenches = (
            np.zeros((ends[-1], system.tree.size)),
            np.zeros((ends[-1], len(system.forces), 6)),
        )
        for k, each in enumerate(driven):
            if each.way == "effort":
                self.efforts[k, each.at] = 1.0
            else:
                self.wrenches[k, each.force, each.at] = 1.0

    @property
    def timing(self) -> list[tuple[float, float]]:
        """Time between samples and delay of each, s."""
        return [(each.sample, each.delay) for each in self.every]

    def corners(self, start: float, end: float) -> Floats:
        """Times at which commands change, s."""
        times = [start + delay + np.arange(0.0, end - start, period) for period, delay in self.timing]
        samples = [start + np.arange(0.0, end - start, period) for period, _ in self.timing]
        return np.concatenate([*times, *samples]) if times else np.zeros(0)

    def measured(self, controller: int, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Measurements (t, k) of one controller."""
        return measurements(self.system, self.system.tree, q, qd, qdd, inputs, self.every[controller].measure)

    def accelerates(self, controller: int) -> bool:
        """Return whether one measures accelerations."""
        return any(".acceleration_" in each for each in self.every[controller].measure)

    def started(self, controller: int) -> Any:
        """State of one at the start."""
        return self.every[controller].start

    def commanded(self, controller: int, t: float, measured: Array, state: Any) -> tuple[Array, Array, Any]:
        """Command of one as its law has it and within its limits, and its next state."""
        each = self.every[controller]
        asked, state = each.effort(t, measured, state)
        return asked, each.limited(asked), state

    def driven(self, inputs: Any, held: Array) -> Any:
        """Inputs with commands (t, m) added."""
        efforts = held @ self.efforts
        changes: dict[str, Any] = {"efforts": efforts if inputs.efforts is None else inputs.efforts + efforts}
        if inputs.wrenches is not None:
            changes["wrenches"] = inputs.wrenches + np.tensordot(held, self.wrenches, 1)
        return replace(inputs, **changes)


def loop_of(controllers: SystemControllers, sampling: Sampling, time: Floats) -> Loop:
    """Samples and commands of the controllers, held at times (t,) s."""
    start, slack = sampling.steps.begin[0], NEAR * float(sampling.steps.length.min())
    measured, asked, acting, beyond = [], [], [], []
    for c, (period, delay) in enumerate(controllers.timing):
        taken = np.floor((time + slack - start) / period).astype(int)
        active = np.floor((time + slack - start - delay) / period).astype(int)
        values, wanted, commands = (np.stack(each) for each in list(zip(*sampling.samples[c], strict=True))[:3])
        # The last time may be that of a sample which no step has taken.
        taken, last = np.minimum(taken, len(values) - 1), np.clip(active, 0, len(values) - 1)
        measured.append(values[taken])
        asked.append(wanted[taken])
        beyond.append(np.mean(wanted != commands, axis=0))
        acting.append(np.where(active[:, None] >= 0, commands[last], 0.0))
    return Loop(
        measurements=signal_names(controllers.system.controllers, "measure"),
        units=tuple(signals_of(controllers.system)[each] for one in controllers.every for each in one.measure),
        drives=signal_names(controllers.system.controllers, "drive"),
        measured=np.concatenate(measured, axis=1),
        asked=np.concatenate(asked, axis=1),
        applied=np.concatenate(acting, axis=1),
        saturated=np.concatenate(beyond),
    )
