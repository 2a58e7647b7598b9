"""Prescribed attitudes: Euler parameters of an angular velocity that is given over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, as_array, is_traced, namespace
from gbeam.mechanics.fields.products import cross
from gbeam.mechanics.tree.steps import composed_parameters, parameter_rates, parameters_of_vector
from gbeam.motion.profiles.profile import Profile

STRIDE, PIECES, HALVINGS = 1e-3, 2000, 8  # s, and pieces of the whole, between knots; and how often these are halved
EXACT = 1e-12  # rad, by which halves of a piece may differ from the whole
_ROOT = 15**0.5


class Course:
    """Euler parameters over time, called as ``course(t)``: `start` at time zero, turning on at the angular velocity,
    rad/s, whose components in the turned axes are three profiles. They are kept at knots and continued from these.
    """

    def __init__(self, rates: Sequence[Profile], start: Array) -> None:
        """Integrate the `rates`, rad/s, in the ball's own axes, to attitudes at knots, from the Euler parameters
        `start` at time zero.
        """
        self.rates = rates
        marks = np.append(np.concatenate([np.asarray(rate.breaks) for rate in rates]), 0.0)
        traced = is_traced(start, *(rate(marks) for rate in rates))
        step = STRIDE if traced else max(STRIDE, np.ptp(marks) / PIECES)
        times = np.unique(np.concatenate([*(rate.knots(step) for rate in rates), marks]))
        turns = self._turned(times[:-1], times[1:])
        # Pieces are halved until their halves agree with them.
        for _ in range(0 if traced else HALVINGS):
            middle = (times[1:] + times[:-1]) / 2
            halves = composed_parameters(self._turned(times[:-1], middle), self._turned(middle, times[1:]))
            coarse = np.abs(halves - turns).max(axis=-1) > EXACT
            if not coarse.any():
                break
            times = np.sort(np.append(times, middle[coarse]))
            turns = self._turned(times[:-1], times[1:])
        xp, zero = namespace(turns, start), int(np.searchsorted(times, 0.0))
        # Turn of every knot since the first one.
        turn_since_start = xp.concatenate([np.array([[1.0, 0.0, 0.0, 0.0]]), turns])
        reach = 1
        while reach < len(turn_since_start):  # products of 2, 4, 8, ... pieces at once
            turn_since_start = xp.concatenate(
                [turn_since_start[:reach], composed_parameters(turn_since_start[:-reach], turn_since_start[reach:])]
            )
            reach *= 2
        inverse = turn_since_start[zero] * np.array([1.0, -1.0, -1.0, -1.0])
        self.times, self.attitudes = (
            times,
            composed_parameters(composed_parameters(as_array(start), inverse), turn_since_start),
        )

    def __call__(self, t: Any) -> tuple[Array, Array, Array]:
        """Euler parameters (..., 4), and their first and second derivatives by time, at times `t` (...), s."""
        derivatives = zip(*(rate.derivatives(t) for rate in self.rates), strict=True)
        w, change = (namespace(*components).stack(components, axis=-1) for components in derivatives)
        times = as_array(t)
        xp = namespace(times, self.attitudes)
        last = xp.maximum(xp.searchsorted(xp.asarray(self.times), times, side="right") - 1, 0)
        turn = self._turned(xp.asarray(self.times)[last], times)
        e = composed_parameters(xp.asarray(self.attitudes)[last], turn)
        rate = parameter_rates(e, w)
        return e, rate, parameter_rates(rate, w) + parameter_rates(e, change)

    def _turned(self, start: Array, end: Array) -> Array:
        """Euler parameters (..., 4) of the turn from one time to another, by Magnus's series to sixth order."""
        h = end - start
        times = start[..., None] + h[..., None] / 2 * (1 + np.array([-1, 0, 1]) * _ROOT / 5)
        components = [rate(times) for rate in self.rates]
        w = namespace(*components).stack(components, axis=-1)
        first, middle, last = (h[..., None] * w[..., k, :] for k in range(3))
        a, b, c = middle, _ROOT / 3 * (last - first), 10 / 3 * (last - 2 * middle + first)
        bracket = cross(b, a)  # of rates in turned axes
        nested = cross(a, 2 * c + bracket) / 60
        return parameters_of_vector(a + c / 12 + cross(b + nested, bracket - 20 * a - c) / 240)
