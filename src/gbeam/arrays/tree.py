"""Frozen records that JAX can trace, map and differentiate, defined without importing JAX.

A record is a pytree: its fields are leaves, but for those marked :func:`static`, which belong to the compiled program.
Records wait here until JAX is imported (`gbeam.arrays.jax_setup` then registers them all), so that what needs no JAX
never pays for the import.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform

_T = TypeVar("_T")
_records: list[type] = []
_register: Callable[[type], None] | None = None


def static(**options: Any) -> Any:
    """Return a field that belongs to the compiled program: hashable, such as a name, a flag or a count."""
    return dataclasses.field(metadata={"static": True}, **options)


@dataclass_transform(frozen_default=True, field_specifiers=(static, dataclasses.field))
def record(cls: type[_T]) -> type[_T]:
    """Make a class a frozen dataclass that is a pytree; it compares by identity, since arrays have no one truth.

    A class with an ``__init__`` of its own keeps it, and sets its fields by :func:`assign`.
    """
    made = dataclasses.dataclass(frozen=True, eq=False, init="__init__" not in cls.__dict__)(cls)
    _records.append(made)
    if _register is not None:
        _register(made)
    elif "jax" in sys.modules:  # whoever imported it may hand records to it before any array
        import gbeam.arrays.jax_setup  # noqa: F401
    return made


def assign(instance: Any, **fields: Any) -> None:
    """Set the fields of a record in its own ``__init__`` or ``__post_init__``."""
    for name, value in fields.items():
        object.__setattr__(instance, name, value)


def register_all(register: Callable[[type], None]) -> None:
    """Give every record, those so far and those to come, to `register`; called once, when JAX is imported."""
    global _register
    _register = register
    for cls in _records:
        register(cls)


def leaves_and_statics(cls: type) -> tuple[list[str], list[str]]:
    """Names of a record's fields: those that are leaves, and those that are static."""
    fields = dataclasses.fields(cls)
    fixed = [f.name for f in fields if f.metadata.get("static")]
    return [f.name for f in fields if f.name not in fixed], fixed
