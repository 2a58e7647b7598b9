"""Laws of controllers as matrices in steps of their samples: functions by their slopes where they ask for nothing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.mechanics.tree.control import Feedback, Law
from gbeam.results.state_space import Signal

Floats = NDArray[np.float64]
STEPS = 1e-5, 1e-6  # of errors and states, by their size or one, both ways
AGREE = 1e-3  # of the largest slope of an effort or state, between the steps
NEAR = 1e-7  # of errors and states, by their size or one, within which the law is at rest


def linear_law(name: str, each: Feedback, t: float, measured: Floats, drives: tuple[Signal, ...]) -> Law:
    """A law as matrices; a function about what is measured where its system rests, or else about no error."""
    if isinstance(each.law, tuple):
        return each.law
    where, fix = f"controllers.{name}.law", "give matrices, or a system of python-control"
    try:
        begun = np.asarray(each.start if each.stateful else [], dtype=float)
    except (TypeError, ValueError):
        begun = np.array(np.nan)
    if not np.isfinite(begun).all():
        raise InputError(where, "is a function, whose state is no array of finite numbers", fix)
    aims, sign = np.zeros(len(measured)), 1.0
    if each.reference is not None:
        aims, sign = np.array([float(one(t)) for one in each.reference]), -1.0
    k, m, n = len(measured), len(drives), begun.size

    def stepped(at: Floats) -> Floats:
        """Efforts and next states, one after the other, from errors and states."""
        asked, after = each.effort(t, aims + sign * at[:k], at[k:].reshape(begun.shape) if each.stateful else None)
        values = np.concatenate([asked, np.asarray(after, dtype=float).ravel() if each.stateful else []])
        if len(values) != m + n:
            raise InputError(where, f"hands on a state of {len(values) - m} numbers, and starts with {n}", fix)
        return values

    rests = list[str]()
    for error in (sign * (measured - aims), np.zeros(k)):
        at = np.concatenate([error, begun.ravel()])
        size, value = np.maximum(1.0, np.abs(at)), stepped(at)
        # Slopes (output, input), forward and backward by each step.
        slopes = np.array(
            [
                np.stack([(stepped(at + h * part) - value) / (h * part.sum()) for part in np.diag(size)], axis=1)
                for step in STEPS
                for h in (step, -step)
            ]
        )
        slope = slopes[-2:].mean(axis=0)
        left = value - np.concatenate([np.zeros(m), begun.ravel()])
        if (np.abs(left) <= NEAR * np.abs(slope) @ size).all():
            largest = np.abs(slope).max(axis=1, keepdims=True)
            if not (np.abs(slopes - slope) <= AGREE * largest).all():
                problem = "is a function, which has no transfer function: it does not answer small errors in proportion"
                raise InputError(where, problem, fix)
            return slope[m:, k:], slope[m:, :k], slope[:m, k:], slope[:m, :k]
        rests += [f"{left[i]:.4g} {drive.unit} of {drive.name}" for i, drive in enumerate(drives) if left[i]]
    problem = f"is a function that asks for {rests[0]}" if rests else "is a function whose state changes"
    fix = "let the system rest where the law asks for nothing, by `initial` of joints and `state` of the law"
    raise InputError(where, f"{problem} where the system rests, and is not at rest without an error either", fix)
