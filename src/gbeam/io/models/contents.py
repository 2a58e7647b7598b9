"""Contents of a file, as readers return them: matrices by their names, what their rows are, and nodes."""

from __future__ import annotations

from typing import Any, TypedDict

import numpy as np

Matrices = dict[str, Any]


class Contents(TypedDict, total=False):
    """Parts of a model: matrices, sparse ones as :func:`sparse_parts`; unknowns (u, 2), number of the node and
    direction, 1 to 6, or 0 of a coordinate of its own, by the name of the matrix, or all under no name; numbers (k,),
    places (k, 3) and axes in columns (k, 3, 3) of nodes; modes by their parts; a body of standard input data.
    """

    matrices: Matrices
    unknowns: dict[str, Any]
    numbers: Any
    places: Any
    axes: Any
    modes: dict[str, Any]
    body: dict[str, Any]


def sparse_parts(matrix: Any) -> dict[str, Any]:
    """A sparse matrix in parts."""
    entries = matrix.tocoo()
    rows, columns = entries.coords
    return {"values": entries.data, "rows": rows, "columns": columns, "shape": list(matrix.shape)}


def mirrored(values: Any, rows: Any, columns: Any, size: int) -> dict[str, Any]:
    """A symmetric sparse matrix in parts, of which each entry is given once, or also the one across."""
    from scipy.sparse import coo_array, diags_array

    matrix = coo_array((np.asarray(values, dtype=float), (rows, columns)), shape=(size, size)).tocsr()
    diagonal = diags_array(matrix.diagonal()).tocsr()
    across = (matrix - diagonal).T
    once = not abs((matrix - diagonal).multiply(across)).max()
    return sparse_parts((matrix + across).tocsr() if once else matrix)
