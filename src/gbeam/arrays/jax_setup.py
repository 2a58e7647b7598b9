"""JAX as gbeam needs it: double precision, programs kept on disk, records as pytrees, values with their slopes.

Import this module before the first use of JAX; every module that needs JAX does.
"""

import os
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any

import jax
from platformdirs import user_cache_path

from gbeam.arrays.registry import leaves_and_statics, register_all

jax.config.update("jax_enable_x64", True)
if not os.environ.get("JAX_COMPILATION_CACHE_DIR"):
    jax.config.update("jax_compilation_cache_dir", os.fspath(user_cache_path("gbeam") / "jax"))
# By default JAX keeps only what took a second to compile: here a hundred programs take a tenth each.
if not os.environ.get("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"):
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.05)


def _values_of(names: Sequence[str]) -> Callable[[Any], tuple[Any, ...]]:
    """Values of a record's fields: by attrgetter, which is quicker but takes two names at least for a tuple."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda record: tuple(getattr(record, name) for name in names)


def _register(cls: type) -> None:
    """Make a record's class a pytree: its leaves are children, its static fields belong to the structure."""
    leaves, fixed = leaves_and_statics(cls)
    leaves_of, fixed_of = _values_of(leaves), _values_of(fixed)

    def flatten(record: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        return leaves_of(record), fixed_of(record)

    def unflatten(aux: tuple[Any, ...], children: Any) -> Any:
        # Not by __init__, which may check or compute: what JAX passes here need not be arrays.
        instance: Any = object.__new__(cls)
        for name, value in (*zip(leaves, children, strict=True), *zip(fixed, aux, strict=True)):
            object.__setattr__(instance, name, value)
        return instance

    jax.tree_util.register_pytree_node(cls, flatten, unflatten)


register_all(_register)


def with_slope(function: Callable[[Any], Any]) -> Callable[[Any], tuple[Any, Any]]:
    """A function's values and their derivatives with respect to its vector: traced, and compiled, once for both."""

    def twice(x: Any) -> tuple[Any, Any]:
        values = function(x)
        return values, values

    def value_and_slope(x: Any) -> tuple[Any, Any]:
        slope, values = jax.jacfwd(twice, has_aux=True)(x)
        return values, slope

    return value_and_slope


def linear_root(function: Callable[[Any], Any], right: Any) -> Any:
    """Solve g(x) = right for a linear function g, as :func:`jax.lax.custom_root` needs it for derivatives."""
    return jax.numpy.linalg.solve(jax.jacfwd(function)(right), right)
