"""Largest Euclidean norms of linear maps of coordinates over time, without the norms that cannot be the largest."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices

DIRECTIONS = 8  # of coordinates, those in which they move most, that tell which norms could be the largest
WIDTH = 0.005  # of cells along these, of the largest coordinate: one bound holds for the times in one
FOREMOST, GROUP, TOGETHER = 64, 4096, 128  # maps whose norms are computed at all times; that are sorted; asked at once
SINGLE = 4e-6  # of a largest square: rounding of sums of 36 products in single precision
ROUNDING = 1e-12  # by which norms that are equal differ


class LargestNorms:
    """Largest norms of maps (m, p, n) of coordinates q (t, n): of each map over time, `size` (p,), the first time at
    which, `when` (p,), and over all maps at each time, `over` (t,).

    Along the few directions in which coordinates move most, squares of all norms are one product of two matrices, of
    quadratic forms and of products of coordinates. The other directions change a norm by no more than the sum of the
    norms of their columns, each times its largest coordinate. By these bounds cells of times are left out that hold the
    largest norm neither of a map nor of a time, then single times. For the remaining times norms are computed.
    """

    def __init__(self, maps: Floats, q: Floats) -> None:
        """Compute the norms of the foremost maps, then those of the others at the times that the bounds leave."""
        self.maps, self.q = maps, q
        count = maps.shape[1]
        self.size, self.when, self.over = np.zeros(count), np.zeros(count, dtype=int), np.zeros(len(q))
        columns = np.sqrt(np.einsum("mpn,mpn->pn", maps, maps))
        scale = columns.max(axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        directions = np.linalg.svd(q * scale, full_matrices=False)[2][:DIRECTIONS]
        along, maps_along = q * scale @ directions.T, maps @ (directions / scale).T
        rest = columns @ np.abs(q - along @ directions / scale).max(axis=0)
        forms = np.einsum("mpi,mpj->pij", maps_along, maps_along)
        columns = np.sqrt(np.einsum("pii->pi", forms))
        reach = columns @ np.abs(along).max(axis=0)
        order = np.argsort(-reach)
        self._compute(np.arange(len(q)), order[:FOREMOST])
        if count <= FOREMOST or not reach.any():
            return

        unit = np.abs(along).max()
        along, rest, reach = along / unit, (1 + SINGLE) * rest / unit, reach / unit
        i, j = np.triu_indices(len(directions))
        forms, products = _single(forms[:, i, j]), _single(np.where(i == j, 1, 2) * along[:, i] * along[:, j]).T
        columns, rest, rounding = map(_single, (columns, rest[:, None], SINGLE * np.square(reach)[:, None]))
        middle, spread, cell = _cells(along)
        hindmost = order[FOREMOST:]
        for group in np.array_split(hindmost, -(-len(hindmost) // GROUP)):
            # Maps that are largest in the same cell are likely to be so at the same times.
            group = group[np.argsort((forms[group] @ products[:, middle]).argmax(axis=1), kind="stable")]
            over, over_cells = self.over / unit, np.full(len(middle), np.inf)
            np.minimum.at(over_cells, cell, over)
            for which in np.array_split(group, -(-len(group) // TOGETHER)):
                bounds = rounding[which], rest[which]
                between = columns[which] @ spread
                kept = _could_be_largest(forms[which] @ products[:, middle], *bounds, over_cells, between)
                times = np.flatnonzero(kept[cell])
                kept = _could_be_largest(forms[which] @ products[:, times], *bounds, over[times])
                self._compute(times[kept], which)

    def _compute(self, times: Indices, which: Indices) -> None:
        """Compute the norms of some maps at ascending times, among which they are largest, and record the largest."""
        norms = np.sqrt(np.square(self.maps[:, which] @ self.q[times].T).sum(axis=0))
        self.size[which] = size = norms.max(axis=1)
        self.when[which] = times[(norms >= (1 - ROUNDING) * size[:, None]).argmax(axis=1)]
        self.over[times] = np.maximum(self.over[times], norms.max(axis=0))


def _could_be_largest(squares: Any, rounding: Any, rest: Any, over: Floats, spread: Any = 0.0) -> Any:
    """Flags of times (t,) at which a norm could be the largest of its map, or could exceed `over` (t,), the largest of
    all maps so far.

    A norm lies between bounds about the root of its square (p, t): it differs by `rounding`, by the `rest` of the
    coordinates (p, 1), and by the `spread` (p, t) of times in a cell.
    """
    upper = np.sqrt(np.maximum(squares + rounding, 0)) + rest + spread
    lower = np.sqrt(np.maximum(squares.max(axis=1, keepdims=True) - rounding, 0)) - rest
    return (upper >= lower).any(axis=0) | (upper.max(axis=0) >= over)


def _cells(q: Floats) -> tuple[Indices, Any, Indices]:
    """Divide the times of coordinates q (t, n) into cells of nearly equal coordinates.

    Returns the time (c,) in the middle of each cell, how far others in the cell are apart from it, (n, c), and the cell
    (t,) of each time.
    """
    scaled = (q - q.min(axis=0)) / WIDTH
    grid = np.floor(scaled)
    cell = np.unique(grid, axis=0, return_inverse=True)[1].ravel()
    distance = np.abs(scaled - grid - 0.5).sum(axis=1)
    order = np.lexsort((distance, cell))
    middle = order[np.unique(cell[order], return_index=True)[1]]
    spread = np.zeros((len(middle), q.shape[1]))
    np.maximum.at(spread, cell, np.abs(q - q[middle[cell]]))
    return middle, _single(spread.T), cell


def _single(values: Floats) -> Any:
    """Values in single precision."""
    return np.asarray(values, dtype=np.float32)
