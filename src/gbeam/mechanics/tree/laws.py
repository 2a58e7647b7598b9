"""Linear laws of controllers in continuous time, as (A, B, C, D), and laws in series."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Law = tuple[Floats, Floats, Floats, Floats]


def gains(matrix: Sequence[Sequence[float]]) -> Law:
    """Efforts K e, K (m, k)."""
    k = np.asarray(matrix, dtype=float)
    return np.zeros((0, 0)), np.zeros((0, k.shape[1])), np.zeros((k.shape[0], 0)), k


def pid(kp: float, ki: float, kd: float, smoothing: float) -> Law:
    """kp + ki/s + kd s/(1 + s T): a state for what is integrated, and one for what is differentiated."""
    parts = [gains([[kp]])]
    if ki:
        parts.append((np.zeros((1, 1)), np.ones((1, 1)), np.full((1, 1), ki), np.zeros((1, 1))))
    if kd:
        rate = 1 / smoothing
        parts.append(
            (np.full((1, 1), -rate), np.full((1, 1), rate), np.full((1, 1), -kd * rate), np.full((1, 1), kd * rate))
        )
    return reduce(_beside, parts)


def lead_lag(gain: float, zero: float, pole: float) -> Law:
    """Gain (1 + s/z)/(1 + s/p), zero and pole in rad/s: a lead where the zero is lower, a lag where the pole is."""
    through = gain * pole / zero
    return (
        np.full((1, 1), -pole),
        np.full((1, 1), pole),
        np.full((1, 1), gain - through),
        np.full((1, 1), through),
    )


def notch(frequency: float, depth: float, damping: float) -> Law:
    """(s² + 2 d ζ ω s + ω²)/(s² + 2 ζ ω s + ω²), ω in rad/s: a gain of the depth d at ω, one far from it."""
    w, fall = frequency, 2 * damping * frequency
    a = np.array([[0.0, 1.0], [-(w**2), -fall]])
    return a, np.array([[0.0], [1.0]]), np.array([[0.0, (depth - 1) * fall]]), np.ones((1, 1))


def in_series(laws: Sequence[Law]) -> Law:
    """Laws one after the other, the first the first to act."""
    return reduce(_after, laws)


def _beside(one: Law, other: Law) -> Law:
    """The sum of two laws."""
    (a, b, c, d), (e, f, g, h) = one, other
    zero = np.zeros((len(a), len(e)))
    return np.block([[a, zero], [zero.T, e]]), np.concatenate([b, f]), np.concatenate([c, g], axis=1), d + h


def _after(one: Law, other: Law) -> Law:
    """A law of what another gives."""
    (a, b, c, d), (e, f, g, h) = one, other
    zero = np.zeros((len(a), len(e)))
    return np.block([[a, zero], [f @ c, e]]), np.concatenate([b, f @ d]), np.concatenate([h @ c, g], axis=1), h @ d
