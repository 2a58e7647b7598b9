"""Functions of time over many times, in blocks of one shape: compiled once, whatever the record's length."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

_BLOCK = 1000  # as long as an integrator's chunk, so that both run the same program


def in_blocks(function: Callable[..., Any], it: Any, *columns: NDArray[np.float64]) -> Any:
    """Return ``function(it, *columns)``, arrays of numpy in the function's own structure.

    Parameters
    ----------
    function : callable
        Compiled, elementwise along the first axis of the columns.
    it : pytree
        Its first argument.
    columns : arrays, shape (n, ...)
        Times, s, and what belongs to them.
    """
    count = len(columns[0])
    padded = [np.concatenate([x, np.repeat(x[-1:], -count % _BLOCK, axis=0)]) for x in columns]
    blocks = zip(*(np.split(x, len(x) // _BLOCK) for x in padded), strict=True)
    parts = [function(it, *(jnp.asarray(x) for x in block)) for block in blocks]
    return jax.tree.map(lambda *each: np.concatenate([np.asarray(x) for x in each])[:count], *parts)
