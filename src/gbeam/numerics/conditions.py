"""Linear conditions on many unknowns: which of them say something new, and the motions that they leave."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.types import Flags, Floats, Indices

ALIKE = 1e-9  # of a condition's length: less of it is nothing that the other conditions do not say


def free_motions(rows: Any) -> tuple[Any, Flags]:
    """Sparse basis (u, f) of the unknowns that conditions with sparse rows (m, u) leave free, q = N p with rows N = 0.

    Flags (m,) tell the conditions that say something that those before do not.

    A condition on one unknown takes it. Each of the others takes the unknown on which it acts most.
    """
    from scipy.sparse import coo_array, csr_array, diags_array

    rows = csr_array(rows)
    unknowns, is_held, is_new = rows.shape[1], np.zeros(rows.shape[1], dtype=bool), np.zeros(rows.shape[0], dtype=bool)
    size = np.sqrt(rows.power(2).sum(axis=1))
    rows = (diags_array(1 / np.where(size > 0, size, np.inf)) @ rows).tocsr()
    remaining = np.arange(len(is_new))
    while True:
        rows.data[np.abs(rows.data) < ALIKE] = 0.0
        rows.eliminate_zeros()
        acting = np.diff(rows.indptr)
        rows, remaining, acting = rows[acting > 0], remaining[acting > 0], acting[acting > 0]
        single = np.flatnonzero(acting == 1)
        if not len(single):
            break
        columns, first = np.unique(rows.indices[rows.indptr[single]], return_index=True)
        is_new[remaining[single[first]]], is_held[columns] = True, True
        rows = (rows @ diags_array(np.where(is_held, 0.0, 1.0))).tocsr()
    entries: list[tuple[Indices, Indices, Floats]] = []
    for rows_together in _parts(rows):
        columns = np.unique(rows[rows_together].indices)
        block = rows[rows_together][:, columns].toarray()
        told = _independent(block)
        is_new[remaining[rows_together[told]]] = True
        followers, independent, factors = _dependents(block[told])
        is_held[columns[followers]] = True
        shape = factors.shape
        row, column = np.broadcast_to(columns[followers][:, None], shape), np.broadcast_to(columns[independent], shape)
        entries.append((row.ravel(), column.ravel(), factors.ravel()))
    free = np.flatnonzero(~is_held)
    number = np.cumsum(~is_held) - 1
    row, column, value = (np.concatenate(part) for part in zip((free, free, np.ones(len(free))), *entries, strict=True))
    return coo_array((value, (row, number[column])), shape=(unknowns, len(free))).tocsr(), is_new


def least_motions(rows: Any, values: Floats) -> Floats:
    """Smallest motions (u, k) for which independent conditions with sparse rows (m, u) have values (m, k)."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    return np.asarray(rows.T @ splu(csc_array(rows @ rows.T)).solve(values))


def _parts(rows: Any) -> list[Indices]:
    """Groups of rows (m, u) that share unknowns, directly or by others."""
    from scipy.sparse.csgraph import connected_components

    _, part = connected_components(abs(rows) @ abs(rows).T, directed=False)
    order = np.argsort(part, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(part[order])) + 1) if len(order) else []


def _independent(rows: Floats) -> Indices:
    """Indices of the rows (m, n) of about unit length that those before do not contain."""
    known, told = np.zeros((0, rows.shape[1])), list[int]()
    for k, row in enumerate(rows):
        rest = row - known.T @ (known @ row)
        rest = rest - known.T @ (known @ rest)
        if np.linalg.norm(rest) > ALIKE * np.linalg.norm(row):
            known = np.concatenate([known, rest[None] / np.linalg.norm(rest)])
            told.append(k)
    return np.array(told, dtype=int)


def _dependents(rows: Floats) -> tuple[Indices, Indices, Floats]:
    """Columns of independent rows (m, n) that follow the others, these others, and the factors (m, n - m) by which."""
    from scipy.linalg import qr, solve_triangular

    upper, order = qr(rows, mode="r", pivoting=True)
    count = len(rows)
    return order[:count], order[count:], -solve_triangular(upper[:count, :count], upper[:count, count:])
