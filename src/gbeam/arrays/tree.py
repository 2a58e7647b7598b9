"""Frozen records that JAX can trace, map and differentiate, defined without importing JAX.

A record is a pytree: its fields are leaves, but for those marked :func:`static`, which belong to the compiled program.
Records wait in the `registry` until JAX is imported (`gbeam.arrays.jax_setup` then registers them all), so that what
needs no JAX never pays for the import.
"""

from __future__ import annotations

import dataclasses
import inspect
import sys
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, dataclass_transform

import numpy as np

from gbeam.arrays.namespace import is_traced
from gbeam.arrays.registry import leaves_and_statics, register

_T = TypeVar("_T")
_FEW, _WIDEST = 6, 60  # numbers of an array that are printed; letters of an argument


def static(**options: Any) -> Any:
    """Return a field that belongs to the compiled program: hashable, such as a name, a flag or a count."""
    return dataclasses.field(metadata={"static": True}, **options)


def follows() -> Any:
    """Return a field that follows from the others, set where the object is made."""
    return dataclasses.field(init=False, repr=False, compare=False)


class Value:
    """A dataclass, with ``eq=False``, that compares by its fields, arrays number by number, and prints on one line."""

    __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.__repr__ = cls.__repr__  # type: ignore[method-assign]  # else a dataclass gets one of all its numbers

    def __repr__(self) -> str:
        return one_line(self)

    def __eq__(self, other: object) -> bool:
        return _are_alike(self, other) if type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        # Words alone: 1 equals 1.0 and an array of it, whose hashes differ.
        return hash((type(self), *(value for value in vars(self).values() if isinstance(value, str))))


@dataclass_transform(frozen_default=True, field_specifiers=(static, dataclasses.field))
def record(cls: type[_T]) -> type[_T]:
    """Make a class a frozen dataclass, a pytree, equal by its fields; an own ``__init__`` uses :func:`assign`."""
    own_methods = {name: name in cls.__dict__ for name in ("__init__", "__repr__")}
    record_type = dataclasses.dataclass(frozen=True, eq=False, init=not own_methods["__init__"], repr=False)(cls)
    for method in (Value.__eq__, __hash__, *(() if own_methods["__repr__"] else (Value.__repr__,))):
        setattr(record_type, method.__name__, method)
    register(record_type)
    if "jax" in sys.modules:  # whoever imported it may hand records to it before any array
        import gbeam.arrays.jax_setup  # noqa: F401
    return record_type


def __hash__(self: Any) -> int:
    return hash((type(self), *(getattr(self, name) for name in leaves_and_statics(type(self))[1])))  # type: ignore[arg-type]


def _are_alike(one: Any, other: Any) -> bool:
    """True if two values are alike.

    NaN is like NaN. A list, a tuple and an array of the same numbers are alike. What JAX traces is only like itself.
    """
    if one is other:
        return True
    if isinstance(one, (tuple, list)) or isinstance(other, (tuple, list)):
        both_ordered = all(isinstance(value, (tuple, list)) or np.ndim(value) for value in (one, other))
        return both_ordered and len(one) == len(other) and all(map(_are_alike, one, other))
    if isinstance(one, dict):
        if type(one) is not type(other) or one.keys() != other.keys():
            return False
        return all(_are_alike(one[key], other[key]) for key in one)
    if dataclasses.is_dataclass(one):
        compared = [field.name for field in dataclasses.fields(one) if field.compare]
        return type(one) is type(other) and all(
            _are_alike(getattr(one, name), getattr(other, name)) for name in compared
        )
    if is_traced(one, other):
        return False
    if hasattr(one, "tocsr") and hasattr(other, "tocsr"):
        return one.shape == other.shape and not (one != other).nnz
    if hasattr(one, "shape") or hasattr(other, "shape"):
        return np.shape(one) == np.shape(other) and bool(np.all((one == other) | ((one != one) & (other != other))))
    return bool(one == other or (one != one and other != other))


def assign(instance: Any, **fields: Any) -> None:
    """Set the fields of a record in its own ``__init__`` or ``__post_init__``."""
    for name, value in fields.items():
        object.__setattr__(instance, name, value)


def arguments_of(value: Any) -> dict[str, Any] | None:
    """Return the arguments by which an object is made again, or its fields or attributes,
    or None where it is unknown.
    """
    if hasattr(value, "arguments"):
        return dict(value.arguments)
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return None
    if type(value).__dataclass_params__.init:  # type: ignore[attr-defined]
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value) if field.init}
    names = list(inspect.signature(type(value)).parameters)
    return {name: getattr(value, name) for name in names} if all(hasattr(value, name) for name in names) else None


def altered(value: Any, **changes: Any) -> Any:
    """Return an object made again with other arguments."""
    if hasattr(value, "altered"):
        return value.altered(**changes)
    return type(value)(**{**(arguments_of(value) or {}), **changes})


def one_line(value: Any) -> str:
    """An object on one line: the name of its class, and the arguments that differ from their defaults."""
    arguments = arguments_of(value)
    if arguments is None:
        return f"{type(value).__name__}(…)"
    parameters = inspect.signature(type(value)).parameters
    defaults = {name: parameter.default for name, parameter in parameters.items()}
    for field in dataclasses.fields(value):
        if field.default_factory is not dataclasses.MISSING:
            defaults[field.name] = field.default_factory()
    unequal = object()  # to anything
    words = [
        f"{name}={_shorten(argument)}"
        for name, argument in arguments.items()
        if not _are_alike(argument, defaults.get(name, unequal))
    ]
    return f"{type(value).__name__}({', '.join(words)})"


def _shorten(value: Any) -> str:
    """A value as short text: many numbers by their count, what is longer than a line's share by its class."""
    if is_traced(value):
        return "traced"
    if hasattr(value, "dtype"):
        short_list = hasattr(value, "tolist") and np.size(value) <= _FEW  # a sparse matrix has none
        return _shorten(value.tolist()) if short_list else f"<{' x '.join(map(str, value.shape))} numbers>"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        comma = "," if len(value) == 1 else ""
        text, shorter = f"({', '.join(map(_shorten, value))}{comma})", f"<{len(value)}>"
    elif isinstance(value, dict):
        entries = ", ".join(f"{key}: {_shorten(entry)}" for key, entry in value.items())
        text, shorter = f"{{{entries}}}", f"{{{', '.join(map(str, value))}}}"
    else:
        text, shorter = repr(value), f"{type(value).__name__}(…)"
    return text if len(text) <= _WIDEST else shorter


def each_leaf(function: Callable[[Any], Any], tree: Any) -> Any:
    """Apply a function to every array of records, tuples, lists and None. JAX's `tree.map` without JAX."""
    if tree is None:
        return None
    if dataclasses.is_dataclass(tree):
        leaves, fixed = leaves_and_statics(type(tree))  # type: ignore[arg-type]
        changed: Any = object.__new__(type(tree))
        values = {name: each_leaf(function, getattr(tree, name)) for name in leaves}
        assign(changed, **values, **{name: getattr(tree, name) for name in fixed})
        return changed
    if isinstance(tree, list | tuple):
        return type(tree)([each_leaf(function, part) for part in tree])
    return function(tree)


def leaves_of(tree: Any) -> list[Any]:
    """The arrays of records, tuples, lists and None, in order."""
    leaves = list[Any]()
    each_leaf(leaves.append, tree)
    return leaves


def stack_trees(trees: Sequence[Any]) -> Any:
    """Stack the arrays of equally built records, tuples, lists and None along a new first axis."""
    stacked = iter([np.stack(leaves) for leaves in zip(*map(leaves_of, trees), strict=True)])
    return each_leaf(lambda _: next(stacked), trees[0])
