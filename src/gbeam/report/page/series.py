"""The numbers that a page draws: one array of 32-bit floats that everything points into, and lines thinned for it."""

from __future__ import annotations

import base64
import hashlib
from typing import Any

import numpy as np

from gbeam.results.result import Floats

INTERVALS = 1200  # of a line with more samples than twice as many: least and largest of each are kept
Ref = dict[str, Any]  # where an array begins, and its shape


class Numbers:
    """Arrays one after the other."""

    def __init__(self) -> None:
        self._parts: list[np.ndarray[Any, np.dtype[np.float32]]] = []
        self._known: dict[tuple[bytes, tuple[int, ...]], Ref] = {}
        self._size = 0

    def add(self, values: Any) -> Ref:
        """Add an array and return where it is; equal ones stand once."""
        part = np.ascontiguousarray(values, dtype="<f4")
        key = hashlib.sha256(part.tobytes()).digest(), part.shape
        if key not in self._known:
            self._known[key] = {"at": self._size, "shape": list(part.shape)}
            self._parts.append(part.ravel())
            self._size += part.size
        return self._known[key]

    @property
    def array(self) -> np.ndarray[Any, np.dtype[np.float32]]:
        """All of them."""
        return np.concatenate(self._parts) if self._parts else np.empty(0, dtype="<f4")

    def encoded(self) -> str:
        """All of them in base64."""
        return base64.b64encode(self.array.tobytes()).decode("ascii")


def thinned(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Values (t, ...) with the least and the largest of every interval, in the order in which they come.

    Each pair is put to a quarter and three quarters of its interval; short histories stay as they are.
    """
    count = len(time)
    if count <= 2 * INTERVALS:
        return time, values
    each = -(-count // INTERVALS)
    whole = -(-count // each)
    index = np.minimum(np.arange(whole * each), count - 1).reshape(whole, each)
    parts = values[index]  # (whole, each, ...)
    low, high = parts.argmin(axis=1), parts.argmax(axis=1)
    pair = np.stack([np.minimum(low, high), np.maximum(low, high)], axis=1)
    kept = np.take_along_axis(parts, pair, axis=1)
    begin, end = time[index[:, 0]], time[index[:, -1]]
    places = np.stack([begin + 0.25 * (end - begin), begin + 0.75 * (end - begin)], axis=1)
    return places.ravel(), kept.reshape(2 * whole, *values.shape[1:])
