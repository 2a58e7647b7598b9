"""Attitude from angular velocity: the turns of many small intervals, one after the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def attitude(time: Floats, w_WB_B: Floats) -> Floats:
    """Return the attitude that body rates lead to, from that at the first time on.

    `time` (t,) s, `w_WB_B` (t, 3); returns (t, 4).
    """
    turn = 0.5 * (w_WB_B[1:] + w_WB_B[:-1]) * np.diff(time)[:, None]
    half = 0.5 * np.linalg.norm(turn, axis=1, keepdims=True)
    steps = np.concatenate([np.cos(half), 0.5 * turn * np.sinc(half / np.pi)], axis=1)
    made = np.concatenate([[[1.0, 0.0, 0.0, 0.0]], steps])
    # Products of 2, 4, 8, ... intervals at once.
    reach = 1
    while reach < len(made):
        made[reach:] = _product(made[:-reach], made[reach:])
        reach *= 2
    return made / np.linalg.norm(made, axis=1, keepdims=True)


def _product(first: Floats, second: Floats) -> Floats:
    """Of quaternions (..., 4)."""
    a, b, u, v = first[..., :1], second[..., :1], first[..., 1:], second[..., 1:]
    scalar = a * b - (u * v).sum(axis=-1, keepdims=True)
    return np.concatenate([scalar, a * v + b * u + np.cross(u, v)], axis=-1)
