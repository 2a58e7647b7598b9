"""Classes of records, and the fields of each, which wait here until JAX is imported."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache

_records: list[type] = []
_make: list[Callable[[type], None]] = []  # what JAX does with each, once it is imported


def register(cls: type) -> None:
    """Add a class of records, which is a pytree as soon as JAX is imported."""
    _records.append(cls)
    for make in _make:
        make(cls)


def register_all(make: Callable[[type], None]) -> None:
    """Call `make` with every class of records, present and future; called once, when JAX is imported."""
    _make.append(make)
    for cls in _records:
        make(cls)


@cache
def leaves_and_statics(cls: type) -> tuple[list[str], list[str]]:
    """Names of a record's fields: those that are leaves, and those that are static."""
    fields = dataclasses.fields(cls)
    fixed = [f.name for f in fields if f.metadata.get("static")]
    return [f.name for f in fields if f.name not in fixed], fixed
