"""Symmetric positive definite systems with few diagonals, by cyclic reduction of blocks: NumPy alone.

scipy.linalg.solveh_banded and scipy.sparse do the same, and take longer to import than a whole target takes to build.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def solve_banded(band: Floats, right: Floats) -> Floats:
    """Solve A x = b.

    `band` (w + 1, n), `right` (n, k); returns (n, k).
    """
    width, n = band.shape[0] - 1, band.shape[1]
    blocks = -(-n // width)
    lower = np.zeros((width + 1, (blocks + 1) * width))
    for d in range(width + 1):
        lower[d, : n - d] = band[d, : n - d]
    lower[0, n:] = 1.0
    first = width * np.arange(blocks)
    diagonal, below = np.zeros((2, blocks, width, width))
    for column in range(width):
        for d in range(width + 1):
            row = column + d
            if row < width:
                diagonal[:, row, column] = diagonal[:, column, row] = lower[d, first + column]
            else:
                below[:, row - width, column] = lower[d, first + column]
    padded = np.zeros((blocks * width, right.shape[1]))
    padded[:n] = right
    return _reduced(diagonal, below[:-1], padded.reshape(blocks, width, -1)).reshape(blocks * width, -1)[:n]


def _reduced(diagonal: Floats, below: Floats, right: Floats) -> Floats:
    """Solve a block tridiagonal system: eliminate every other block, solve for the rest, substitute back."""
    if len(diagonal) == 1:
        return np.asarray(np.linalg.solve(diagonal, right), dtype=np.float64)
    odd = diagonal[1::2]
    before = below[::2]  # of each odd block, to the even one before it
    after = below[1::2]  # of the even block after it, to the odd one; the last odd block may have none
    inverse = np.linalg.solve(odd, np.concatenate([before, right[1::2]], axis=2))
    to_before, alone = inverse[..., : odd.shape[1]], inverse[..., odd.shape[1] :]
    to_after = np.linalg.solve(odd[: len(after)], after.transpose(0, 2, 1))
    even, side = diagonal[::2].copy(), right[::2].copy()
    even[: len(odd)] -= before.transpose(0, 2, 1) @ to_before
    side[: len(odd)] -= before.transpose(0, 2, 1) @ alone
    even[1 : len(after) + 1] -= after @ to_after
    side[1 : len(after) + 1] -= after @ alone[: len(after)]
    kept = _reduced(even, -after @ to_before[: len(after)], side)
    solution = np.empty_like(right)
    solution[::2] = kept
    solution[1::2] = alone - to_before @ kept[: len(odd)]
    solution[1 : 2 * len(after) : 2] -= to_after @ kept[1 : len(after) + 1]
    return solution
