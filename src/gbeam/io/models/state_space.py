"""Laws of controllers in files: matrices A, B, C, D, and the step between samples."""

from __future__ import annotations

import math
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.confined import confined
from gbeam.guards.limits import BINARY_BYTES, read_json, refuse_large_file
from gbeam.io.models.arrays import everything
from gbeam.printable import shortened

NAMES = "abcd"
STEPS = "dt", "ts", "step"
FIX = "save A, B, C and D as numbers, with dt where they are of discrete time"


def read_state_space(path: str | os.PathLike[str]) -> SimpleNamespace:
    """Read matrices ``a``, ``b``, ``c``, ``d`` and the step ``dt``, s, which is zero in continuous time."""
    ending = Path(path).suffix.lower()
    if ending not in (".npz", ".mat", ".json"):
        raise InputError("file", f"ends in {ending or 'nothing'}", "give .npz, .mat or .json")

    def refuse(problem: str) -> InputError:
        return InputError("file", problem, FIX)

    if ending == ".json":
        every = read_json(Path(path), FIX)
    else:
        refuse_large_file("file", path, BINARY_BYTES, "reduce the law before it is saved")
        every = confined(_numbers, os.fspath(path), refuse=refuse)
    named = {key.lower(): each for key, each in every.items()}
    lacking = ", ".join(name.upper() for name in NAMES if name not in named)
    if lacking:
        raise refuse(f"holds no {lacking}")
    try:
        parts = {name: np.atleast_2d(np.asarray(named[name], dtype=float)) for name in NAMES}
        step = next((float(np.ravel(named[key])[0]) for key in STEPS if key in named), 0.0)
    except (TypeError, ValueError, IndexError):
        raise refuse("holds what are no numbers") from None
    if not all(np.isfinite(each).all() for each in parts.values()) or not 0 <= step < math.inf:
        raise refuse("holds numbers that are not finite, or a step below zero")
    return SimpleNamespace(**parts, dt=step)


def _numbers(path: str) -> dict[str, Any]:
    """Arrays of numbers in a file by their names."""
    try:
        every = everything(path)
    except MemoryError:
        raise
    except Exception as error:  # of many kinds
        raise InputError("file", f"cannot be read: {shortened(str(error), 100)}", FIX) from None
    arrays = {key: np.asarray(each) for key, each in every.items() if hasattr(each, "dtype")}
    return {key: each for key, each in arrays.items() if each.dtype.kind in "fiu"}
