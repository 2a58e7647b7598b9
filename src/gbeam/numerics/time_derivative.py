"""A function of time with its rate, by forward differentiation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


def with_rate(function: Callable[[Array], Any], t: Float[Array, "*t"]) -> tuple[Any, Any]:
    """Return `function(t)` and its derivative with respect to time, both of the function's own structure.

    Parameters
    ----------
    function : callable
        Elementwise in time: entry i of what it returns depends on entry i of `t` only.
    t : array, any shape
        s.
    """
    t = jnp.asarray(t, dtype=float)
    return jax.jvp(function, (t,), (jnp.ones_like(t),))
