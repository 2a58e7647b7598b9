"""Values as data come back as they were, and nothing but data comes back."""

from __future__ import annotations

import io
import json
import pickle
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.guards import digest, read_packed, write_packed

METAL = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)


def again(value: Any, **options: Any) -> Any:
    file = io.BytesIO()
    write_packed(file, value)
    file.seek(0)
    return read_packed(file, **options)


def packed(form: Any, *arrays: Any) -> io.BytesIO:
    """A file whose JSON is a form, beside arrays."""
    file = io.BytesIO()
    np.savez(file, np.frombuffer(json.dumps(form).encode(), dtype=np.uint8), *arrays)
    file.seek(0)
    return file


def test_values_come_back_with_their_types() -> None:
    fortran = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    value = {"a": (1, [2.5, None, "µ\ud800"], True), "b": fortran, "n": np.int32(-7), "inf": float("inf"), "c": METAL}
    read = again(value, records=True)
    assert read["a"] == value["a"] and isinstance(read["a"], tuple) and read["inf"] == value["inf"]
    np.testing.assert_array_equal(read["b"], fortran)
    assert read["b"].flags.f_contiguous and read["n"] == -7 and read["n"].dtype == np.int32
    assert type(read["c"]) is gb.Material and read["c"] == METAL


def test_what_stands_twice_is_one_object() -> None:
    array = np.arange(3.0)
    (first, second), one, other = again([[METAL, METAL], array, array], records=True)
    assert first is second and one is other


def test_a_digest_tells_values_apart() -> None:
    values = [1, 1.0, "1", (1,), [1], {"a": 1}, np.array([1]), np.array([1.0]), np.array([[1.0]]), METAL, None]
    assert len({digest(value) for value in values}) == len(values)
    alike = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
    assert digest({"a": np.arange(3), "b": METAL}) == digest({"a": np.arange(3), "b": alike})


@dataclass
class Foreign:
    """A dataclass that is not gbeam's."""

    value: int = 0


def test_only_dataclasses_of_gbeam_with_their_own_fields_are_made() -> None:
    of = METAL.__class__
    fields = {name: getattr(METAL, name) for name in of.__dataclass_fields__}
    name = [of.__module__, of.__qualname__]
    assert read_packed(packed({"record": name, "fields": fields}), records=True) == METAL
    for form in (
        {"record": name, "fields": {"density": 1.0}},
        {"record": [__name__, "Foreign"], "fields": {"value": 1}},
        {"record": ["os", "system"], "fields": {}},
        {"record": ["gbeam.__main__", "main"], "fields": {}},  # which would run, were it imported
        {"record": ["gbeam.io.kept", "kept"], "fields": {}},
        {"again": 0},
        {"other": 0},
    ):
        with pytest.raises((ValueError, IndexError)):
            read_packed(packed(form), records=True)
    with pytest.raises(ValueError, match="record"):
        again(METAL)
    with pytest.raises(TypeError, match="is no data"):
        write_packed(io.BytesIO(), object())


def test_pickles_are_not_read() -> None:
    with pytest.raises(ValueError, match=r"pickle"):
        read_packed(packed({"array": 0}, np.array([METAL], dtype=object)))
    with pytest.raises(Exception, match=r"pickle|zip|magic"):
        read_packed(io.BytesIO(pickle.dumps(METAL)))
