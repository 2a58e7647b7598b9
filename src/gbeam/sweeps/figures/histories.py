"""A history as a measure: displacement of the tip or load of the root over the response, at times that cases share."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gbeam.errors import InputError
from gbeam.results.result import Floats
from gbeam.scenario.values.suggest import advise

if TYPE_CHECKING:
    from gbeam.results.study import Study

OPTION = "--history"
TIMES = 501  # by default
UNITS = {"tip": "m", "root_force": "N", "root_moment": "N m"}


@dataclass(frozen=True)
class History:
    """One component over time: of `quantity` along `axis` (0, 1, 2) of base axes, in the motion of that name."""

    name: str
    motion: str
    quantity: str
    axis: int

    @property
    def unit(self) -> str:
        """SI."""
        return UNITS[self.quantity]

    def at(self, study: Study, times: Floats) -> Floats:
        """Values at times (t,); NaN where the response has none."""
        response = study.responses.get(self.motion)
        nothing = np.full(len(times), math.nan)
        if response is None:
            return nothing
        loads = response.loads
        if self.quantity == "tip":
            values = response.tip
        elif loads is None:
            return nothing
        else:
            values = (loads.force if self.quantity == "root_force" else loads.moment)[:, 0]
        from scipy.interpolate import CubicSpline

        # Twenty steps to the shortest period: straight lines between them would be off by 1 % of a vibration.
        spline = CubicSpline(response.time, values[:, self.axis])
        slack = 1e-9 * float(response.time[-1] - response.time[0])
        inside = (times >= response.time[0] - slack) & (times <= response.time[-1] + slack)
        return np.where(inside, spline(times), math.nan)


def read_history(text: str, motions: Collection[str]) -> History:
    """Read ``flight.tip.z``; the motion may be left out where there is one.

    Raises
    ------
    InputError
        If it is none.
    """
    *before, quantity, axis = ["", "", *text.split(".")]
    motion = ".".join(part for part in before if part)
    if axis not in ("x", "y", "z") or quantity not in UNITS:
        raise InputError(OPTION, f"{text!r} is no history", f"write MOTION.QUANTITY.AXIS of {', '.join(UNITS)}")
    if not motion:
        if len(motions) > 1:
            raise InputError(OPTION, f"{text!r} leaves the motion out", f"write {next(iter(motions))}.{text}")
        motion = next(iter(motions))
    if motion not in motions:
        raise InputError(OPTION, f"{text!r} names no motion", advise(motion, motions))
    return History(text, motion, quantity, "xyz".index(axis))
