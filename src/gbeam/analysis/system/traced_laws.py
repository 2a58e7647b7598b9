"""Laws of controllers as functions that JAX traces, of all that they are made of."""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree
from numpy.typing import NDArray

from gbeam.arrays.namespace import looks_at_traced, namespace
from gbeam.errors import InputError
from gbeam.integrate.traced_loop import TracedLaw
from gbeam.mechanics.tree.control import Feedback

Array = Any


def traced_law(named: tuple[str, Feedback], times: NDArray[np.float64]) -> TracedLaw:
    """A controller's law at the times of its samples (s,) s."""
    name, each = named
    limit = () if each.limit is None else (each.limit,)
    sign, values = 1.0, [np.zeros(len(times)) for _ in each.measure]
    if each.reference is not None:
        sign, values = -1.0, [profile(times) for profile in each.reference]
    references = namespace(*values).stack(values, axis=-1)
    if isinstance(each.law, tuple):
        law, parameters, start = _linear, each.law, each.start
    else:
        start, restored = ravel_pytree(each.state)
        law, parameters = _of_function(f"controllers.{name}.law", each, start, restored)
    return TracedLaw(times, partial(_commanded, law, sign), (parameters, limit), references, start)


def _commanded(
    law: Any, sign: float, parameters: Any, references: Array, t: Any, y: Array, state: Array
) -> tuple[Array, ...]:
    """The command as asked and as limited, and the next state."""
    parts, limit = parameters
    asked, after = law(parts, t, references + sign * y, state)
    limited = asked
    if limit:
        xp = namespace(asked, limit[0])
        limited = xp.where(xp.abs(asked) <= limit[0], asked, xp.sign(asked) * limit[0])
    return asked, limited, after


def _linear(parts: Any, _: Any, error: Array, state: Array) -> tuple[Array, Array]:
    a, b, c, d = parts
    return c @ state + d @ error, a @ state + b @ error


def _of_function(where: str, each: Feedback, start: Array, restored: Any) -> tuple[Any, Any]:
    """A function of what a controller's own refers to, and these values, from wherever it has them."""
    count = len(each.drive)

    def plain(t: Any, error: Array, state: Array) -> tuple[Array, Array]:
        if each.stateful:
            efforts, after = each.law(t, error, restored(state))
            return jnp.asarray(efforts, dtype=float).reshape(-1), ravel_pytree(after)[0].astype(float)
        return jnp.asarray(each.law(t, error), dtype=float).reshape(-1), state

    example = 0.0, jnp.zeros(len(each.measure)), start
    try:
        law, parts = jax.closure_convert(plain, *example)
        efforts, after = jax.eval_shape(plain, *example)
    except Exception as error:
        if not looks_at_traced(error):
            raise
        fix = "write it with jax.numpy, and jax.numpy.where in place of if"
        raise InputError(where, "looks at numbers that JAX traces", fix) from error
    if efforts.shape != (count,) or after.shape != start.shape:
        problem = f"gives {efforts.shape[0]} efforts and a state of {after.shape[0]} numbers"
        raise InputError(where, problem, f"give {count}, and {start.shape[0]}")
    compiled = jax.jit(lambda parts, t, error, state: law(t, error, state, *parts))
    return compiled, parts
