"""Linear filters of second order run over samples, many at a time: a recurrence, in blocks that are products.

Within a block of samples the output is a triangular matrix times the samples, and two columns times the state that the
block before leaves; only those states follow one another. The products are kept small: a BLAS would put threads to
larger ones, which cost more than they save.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_BLOCK = 32  # samples: longer blocks multiply more, shorter ones turn the loop more often
_WIDTH = 128  # columns of one product
_TOGETHER = 12  # filters whose outputs fit a processor's cache


class Filters(NamedTuple):
    """x[n+1] = A x[n] + B u[n], y[n] = C x[n] + D u[n]: A (f, 2, 2), B and C (f, 2), D (f,), one for each filter."""

    a: Floats
    b: Floats
    c: Floats
    d: Floats


def run(filters: Filters, values: Floats) -> Floats:
    """Return every filter's output for every column, from rest.

    `values` (t, k); returns (f, t, k).
    """
    y = _in_blocks(filters, values)
    return y.swapaxes(2, 3).reshape(len(y), -1, values.shape[1])[:, : len(values)]


def largest(filters: Filters, values: Floats, offset: Floats, covered: NDArray[np.bool_]) -> Floats:
    """Return the largest size of every filter's output, from rest, plus an offset.

    `values` (t, k), `offset` (k,), `covered` (t,); returns (f, k).
    """
    sizes = []
    for i in range(0, len(filters.d), _TOGETHER):
        y = _in_blocks(Filters(*(each[i : i + _TOGETHER] for each in filters)), values)
        y += offset
        side = y.shape[3]
        y *= _arranged(covered[:, None], side)
        # First over what keeps the rows long: a reduction over short ones takes ten times as long.
        rows = y.reshape(len(y), -1, side * values.shape[1])
        size = np.maximum(rows.max(axis=1), -rows.min(axis=1))
        sizes.append(size.reshape(len(y), side, -1).max(axis=1))
    return np.concatenate(sizes)


def _arranged(values: Floats | NDArray[np.bool_], side: int) -> Floats:
    """Samples (t, k) as (segments, block, blocks of a segment, k), zeros at the end; `side` blocks to a segment."""
    samples, columns = values.shape
    segments = -(-samples // (side * _BLOCK))
    padded = np.zeros((segments * side * _BLOCK, columns))
    padded[:samples] = values
    return np.ascontiguousarray(padded.reshape(segments, side, _BLOCK, columns).swapaxes(1, 2))


def _in_blocks(filters: Filters, values: Floats) -> Floats:
    """Outputs (f, segments, block, blocks of a segment, k)."""
    a, b, c, d = filters
    count, columns = len(d), values.shape[1]
    side = min(max(1, _WIDTH // columns), -(-len(values) // _BLOCK))
    u = _arranged(values, side).reshape(-1, _BLOCK, side * columns)
    powers = [np.broadcast_to(np.eye(2), a.shape)]
    for _ in range(_BLOCK):
        powers.append(a @ powers[-1])
    from_state = np.stack([(c[:, None] @ p)[:, 0] for p in powers[:-1]], axis=1)  # C Aⁿ, (f, block, 2)
    to_state = np.stack([(p @ b[:, :, None])[:, :, 0] for p in powers[-2::-1]], axis=2)  # Aⁿ B, (f, 2, block)
    impulse = np.concatenate([d[:, None], (from_state[:, :-1] @ b[:, :, None])[:, :, 0]], axis=1)
    lag = np.subtract.outer(np.arange(_BLOCK), np.arange(_BLOCK))
    own = np.where(lag >= 0, impulse[:, np.maximum(lag, 0)], 0.0)

    gained = (to_state[:, None] @ u).reshape(count, -1, 2, side, columns)
    gained = np.ascontiguousarray(gained.transpose(1, 3, 0, 2, 4)).reshape(-1, count, 2, columns)
    state = np.zeros_like(gained)  # at the start of each block
    for n in range(1, len(state)):
        np.matmul(powers[-1], state[n - 1], out=state[n])
        state[n] += gained[n - 1]
    state = state.reshape(-1, side, count, 2, columns).transpose(2, 0, 3, 1, 4).reshape(count, -1, 2, side * columns)
    y = own[:, None] @ u
    y += from_state[:, None] @ state
    return y.reshape(count, -1, _BLOCK, side, columns)
