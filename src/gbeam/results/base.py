"""Base of the parts of results, which print on one line."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any, Self

from gbeam.arrays.tree import Value
from gbeam.results.declared import along_time, document


def brief(record: Any) -> str:
    """A record on one line: numbers and words as they are, arrays by their shapes, other records by their names.

    What is None is left out.
    """
    shown = {f.name: getattr(record, f.name) for f in fields(record) if f.repr}
    values = ", ".join(f"{name}={_shorten(value)}" for name, value in shown.items() if value is not None)
    return f"{type(record).__name__}({values})"


def _shorten(value: Any) -> str:
    """A value on a line: arrays by their shapes, other records by their names, long tuples and mappings by length."""
    if isinstance(value, (str, bool, int)) or value is None:
        return repr(value)
    if isinstance(value, float):
        return f"{value:.4g}"
    if getattr(value, "shape", None) is not None:
        return str(tuple(value.shape))
    if isinstance(value, (tuple, dict)) and len(value) > 3:
        return f"<{len(value)}>"
    if isinstance(value, tuple):
        entries = ", ".join(_shorten(entry) for entry in value)
        return f"({entries},)" if len(value) == 1 else f"({entries})"
    if isinstance(value, dict):
        pairs = [f"{key}: {_shorten(entry)}" for key, entry in value.items()]
        return f"{{{', '.join(pairs)}}}"
    return f"<{type(value).__name__}>"


class Part(Value):
    """A part of a result: it prints on one line, arrays as their shapes."""

    __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        document(cls)

    def select_times(self, times: Any) -> Self:
        """Return the part at some of its `times`, an index or slice of them."""
        part: Any = self
        return replace(part, **{name: values[times] for name, values in along_time(self).items()})

    def __repr__(self) -> str:
        return brief(self)
