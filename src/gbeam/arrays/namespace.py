"""The array library of the values at hand: NumPy, or JAX where one of them is traced or lives there."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

Array = Any  # of NumPy or of JAX
_PLAIN = frozenset({"numpy", "builtins"})  # modules whose types JAX has no part in: most values, known at once


def is_jax(value: Any) -> bool:
    """True if a value is a JAX array or a tracer; never imports JAX."""
    if type(value).__module__ in _PLAIN:
        return False
    jax = sys.modules.get("jax")
    return jax is not None and isinstance(value, jax.Array)


def namespace(*values: Any) -> Any:
    """Return ``jax.numpy`` if one of the values is a JAX array, else ``numpy``."""
    for value in values:
        if is_jax(value):
            import jax.numpy as jnp

            import gbeam.arrays.jax_setup  # noqa: F401

            return jnp
    import numpy as np

    return np


def concatenated(parts: Sequence[Any]) -> Any:
    """Concatenate arrays (..., n) along their last axis, the others broadcast."""
    xp = namespace(*parts)
    shapes = {part.shape[:-1] for part in parts}
    if len(shapes) > 1:
        shape = xp.broadcast_shapes(*shapes)
        parts = [xp.broadcast_to(part, (*shape, part.shape[-1])) for part in parts]
    return xp.concatenate(parts, axis=-1)


def has_unit(value: Any) -> bool:
    """True if a value is a quantity of pint, astropy or unyt, whose unit NumPy would drop."""
    if type(value).__module__ in _PLAIN:
        return False
    of_pint = hasattr(value, "dimensionality")  # a unit alone as well
    return of_pint or (hasattr(value, "to") and (hasattr(value, "units") or hasattr(value, "unit")))


def as_array(value: Any) -> Any:
    """A value, or list of values, as a float64 array of NumPy or JAX; TypeError of text and quantities with a unit."""
    listed = value if isinstance(value, (tuple, list)) else (value,)
    for entry in listed:
        if isinstance(entry, str) or has_unit(entry):
            raise TypeError(f"{entry!s:.60} is not a bare number in SI")
    return namespace(*listed).asarray(value, dtype=float)


def is_traced(*values: Any) -> bool:
    """True if one of the values is a JAX tracer, which has no numbers to look at."""
    jax = sys.modules.get("jax")
    return jax is not None and any(isinstance(value, jax.core.Tracer) for value in values)


def holds_jax(*records: Any) -> bool:
    """True if an array anywhere in some records is JAX's, or traced by it."""
    jax = sys.modules.get("jax")
    return jax is not None and any(is_jax(leaf) for leaf in jax.tree.leaves(records))


def holds_tracer(*records: Any) -> bool:
    """True if an array anywhere in some records is traced by JAX."""
    jax = sys.modules.get("jax")
    return jax is not None and any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(records))


def looks_at_traced(error: BaseException) -> bool:
    """True if JAX raised an error because code needed the numbers of a value that it traces."""
    jax = sys.modules.get("jax")
    if jax is None:
        return False
    kinds = jax.errors
    numbers = kinds.ConcretizationTypeError, kinds.TracerArrayConversionError, kinds.TracerIntegerConversionError
    return isinstance(error, (*numbers, kinds.NonConcreteBooleanIndexError))
