"""Quantities of a system read from its coordinates: motions of points, efforts of drives, momentum and energy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.frames import turned
from gbeam.mechanics.tree.steps import parameters_of_all
from gbeam.mechanics.tree.system import System

Array = Any
Floats = NDArray[np.float64]


def histories(system: System, y: Array, yd: Array, ydd: Array, inputs: Inputs, *, inertial: bool) -> dict[str, Floats]:
    """Motions of points, coordinates, drives and load on the ground at unknown coordinates (t, n) and their rates."""
    tree = system.tree
    state = tree.motion(y, yd, ydd, inputs)
    frames = state.every_point
    rows, ground = tree.rows(y, yd, ydd, inputs)
    whole = [y, yd]
    if inputs.prescribed is not None:
        whole = [tree.whole(each, inputs.prescribed[:, k]) for k, each in enumerate(whole)]
    effort = np.zeros_like(whole[0]) if inputs.efforts is None else np.array(inputs.efforts)
    fixed = list(tree.fixed)
    effort[:, fixed] = rows[:, fixed]
    out = {
        "place": np.stack([frame.p for frame in frames], axis=1),
        "velocity": np.stack([turned(frame.R, frame.v) for frame in frames], axis=1),
        "acceleration": np.stack([frame.a for frame in frames], axis=1),
        "attitude": np.stack([parameters_of_all(frame.R) for frame in frames], axis=1),
        "angular_velocity": np.stack([frame.w for frame in frames], axis=1),
        "q": whole[0],
        "qd": whole[1],
        "effort": effort,
        "ground_force": -ground.force,
        "ground_moment": -ground.moment,
    }
    if inertial:
        gravity = np.zeros(3) if system.gravity is None else np.asarray(system.gravity, dtype=float)
        momentum, spin, energy = tree.invariants(y, yd, inputs, gravity)
        out |= {"momentum": momentum, "angular_momentum": spin, "energy": energy}
    return out
