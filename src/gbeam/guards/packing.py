"""Values as data: JSON beside arrays in NumPy's format, as processes send them and files keep them, without pickles."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import sys
from collections.abc import Sequence
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

_PLAIN = "biufcS"  # NumPy's kinds of arrays that are written as bytes; others hold text


def write_packed(file: IO[bytes], value: Any) -> None:
    """Write a value of text, numbers, None, lists, tuples, mappings by text, arrays and gbeam's dataclasses."""
    text, arrays = _packed(value)
    np.savez(file, np.frombuffer(text, dtype=np.uint8), *arrays)


def read_packed(file: IO[bytes], *, records: bool = False) -> Any:
    """Return the value in a file; ValueError or another error if it holds none, or a dataclass without `records`."""
    with np.load(file, allow_pickle=False) as stored:
        text, *arrays = (stored[f"arr_{i}"] for i in range(len(stored.files)))
    return _Unpacking(arrays, records).value(json.loads(text.tobytes()))


def digest(value: Any) -> str:
    """SHA-256 of a value of :func:`write_packed`, in hexadecimal digits."""
    text, arrays = _packed(value)
    hashed = hashlib.sha256(text)
    for array in arrays:
        hashed.update(f"{array.dtype.str}{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
    return hashed.hexdigest()


def _packed(value: Any) -> tuple[bytes, list[NDArray[Any]]]:
    packing = _Packing()
    return json.dumps(packing.form(value)).encode(), packing.arrays


class _Packing:
    """Arrays of a value, and how often what stands in it twice was met: it is written once."""

    def __init__(self) -> None:
        self.arrays: list[NDArray[Any]] = []
        self._met: dict[int, dict[str, Any]] = {}  # forms by the identities of arrays and dataclasses
        self._records = 0

    def form(self, value: Any) -> Any:
        """Return the value for JSON, with the places of its arrays for these."""
        if value is None or (isinstance(value, (str, int, float)) and not isinstance(value, np.generic)):
            return value
        if type(value) is list:
            return [self.form(entry) for entry in value]
        if type(value) is tuple:
            return {"tuple": [self.form(entry) for entry in value]}
        if isinstance(value, dict):
            return {"mapping": {str(key): self.form(entry) for key, entry in value.items()}}
        if id(value) in self._met:
            return self._met[id(value)]
        form = self._met[id(value)] = self._form(value)
        if "record" in form:  # a second time it is told by its number
            self._met[id(value)] = {"again": self._records}
            self._records += 1
        return form

    def _form(self, value: Any) -> dict[str, Any]:
        if isinstance(value, (np.ndarray, np.generic)):
            array = np.asarray(value)
            if array.dtype.kind not in _PLAIN:
                return {"texts": [str(entry) for entry in array.flat], "shape": list(array.shape)}
            self.arrays.append(array)
            return {"array" if isinstance(value, np.ndarray) else "number": len(self.arrays) - 1}
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            fields = {field.name: self.form(getattr(value, field.name)) for field in dataclasses.fields(value)}
            return {"record": [type(value).__module__, type(value).__qualname__], "fields": fields}
        raise TypeError(f"{type(value).__name__} is no data")


class _Unpacking:
    """Arrays of a file, and the dataclasses that were made of it."""

    def __init__(self, arrays: Sequence[Any], records: bool) -> None:
        self._arrays = arrays
        self._made: list[Any] | None = [] if records else None

    def value(self, form: Any) -> Any:
        """Return the value of a form in JSON."""
        if isinstance(form, list):
            return [self.value(entry) for entry in form]
        if not isinstance(form, dict):
            return form
        match form:
            case {"tuple": values}:
                return tuple(self.value(entry) for entry in values)
            case {"mapping": values}:
                return {key: self.value(entry) for key, entry in values.items()}
            case {"array": number}:
                return self._arrays[number]
            case {"number": number}:
                return self._arrays[number][()]
            case {"texts": texts, "shape": shape}:
                return np.array(texts, dtype=object).reshape(shape)
            case {"record": [module, name], "fields": fields} if self._made is not None:
                self._made.append(self._record(module, name, fields))
                return self._made[-1]
            case {"again": number} if self._made is not None:
                return self._made[number]
        raise ValueError(f"{list(form)} is no value")

    def _record(self, module: str, name: str, fields: dict[str, Any]) -> Any:
        """Make a loaded dataclass of gbeam, of exactly its fields; what it checks was checked before it was written."""
        record_class = getattr(sys.modules.get(module), name, None) if module.startswith("gbeam.") else None
        if not isinstance(record_class, type) or not dataclasses.is_dataclass(record_class):
            raise ValueError(f"{module}.{name} is no dataclass of gbeam")
        if [field.name for field in dataclasses.fields(record_class)] != list(fields):
            raise ValueError(f"{name} has other fields")
        record = object.__new__(record_class)
        for field, form in fields.items():
            object.__setattr__(record, field, self.value(form))
        return record
