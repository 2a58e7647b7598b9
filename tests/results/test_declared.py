"""A field declared once: JSON, units, a file's variables and the docstring follow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gbeam.io import in_files, whole_group
from gbeam.results import Part, Result, fact, facts_of, json_of, part, quantity, rows, units_of

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False, repr=False)
class Doubt(Part):
    """Errors of peaks."""

    total: Floats = quantity("", "estimated error")


@dataclass(frozen=True, eq=False, repr=False)
class Gust(Part):
    """A gust."""

    speed: float = quantity("m/s", "speed")


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Flutter(Result):
    """Flutter of a toy."""

    json_rows: ClassVar = {"peak": "peaks"}

    time: Floats = quantity("s", "time", "peak", role="coordinate", key=None)
    load: Floats = quantity("m/s^2", "load factor", "peak", "axis", note="base axes")
    root: Complex = quantity("1/s", "root of the characteristic equation", "peak")
    doubt: Doubt | None = part("errors of the peaks", "peak", name="load_error_", default=None)
    gusts: tuple[Gust, ...] = rows("gusts", "gust", name="gust_", default=())
    word: str = fact("how it ends", default="calm")
    hidden: float = fact("nothing to read", key=None, name=None, default=0.0)


def _flutter(doubt: Doubt | None) -> Flutter:
    load = np.arange(6.0).reshape(2, 3)
    gusts = (Gust(speed=3.0), Gust(speed=4.0))
    root = np.array([1 + 2j, 3 - 4j])
    return Flutter(time=np.array([0.0, 1.0]), load=load, root=root, doubt=doubt, gusts=gusts, warnings=("toy",),
                   notes=("a toy",))  # fmt: skip


def test_json_follows() -> None:
    assert json_of(_flutter(Doubt(total=np.array([0.1, 0.2])))) == {
        "outcome": "done",
        "peaks": [
            {"load": {"x": 0.0, "y": 1.0, "z": 2.0}, "root": 1.0, "root_imaginary": 2.0, "doubt": {"total": 0.1}},
            {"load": {"x": 3.0, "y": 4.0, "z": 5.0}, "root": 3.0, "root_imaginary": -4.0, "doubt": {"total": 0.2}},
        ],
        "gusts": [{"speed": 3.0}, {"speed": 4.0}],
        "word": "calm",
        "warnings": ["toy"],
        "notes": ["a toy"],
    }


def test_a_part_that_is_not_estimated_has_no_numbers_in_any_row() -> None:
    first, second = facts_of(_flutter(None))["peaks"]
    assert all(math.isnan(row["doubt"]["total"]) for row in (first, second))


def test_units_follow_at_the_same_places() -> None:
    units = units_of(Flutter)
    assert units["peaks"] == {"load": "m/s^2", "root": "1/s", "root_imaginary": "1/s", "doubt": {"total": ""}}
    assert units["gusts"] == {"speed": "m/s"} and "hidden" not in units
    assert set(units) == set(facts_of(_flutter(None)))


def test_files_follow() -> None:
    group = whole_group(_flutter(Doubt(total=np.array([0.1, 0.2]))))
    shapes = {name: (each.dims, each.attrs["units"]) for name, each in group.variables.items()}
    assert shapes == {
        "load": (("peak", "axis"), "m s-2"),
        "root_real": (("peak",), "s-1"),
        "root_imag": (("peak",), "s-1"),
        "load_error_total": (("peak",), "1"),
        "gust_speed": (("gust",), "m s-1"),
    }
    assert set(group.coordinates) == {"peak", "axis"} and group.attrs["word"] == "calm"
    assert in_files("rad/s") == "rad s-1" and in_files("1/s^2") == "s-2" and in_files("") == "1"


def test_the_docstring_follows() -> None:
    text = Flutter.__doc__ or ""
    assert text.startswith("Flutter of a toy.\n\n    Parameters\n    ----------\n    time : (peak,), s\n        Time.")
    assert "load : (peak, axis), m/s^2\n        Load factor; base axes.\n" in text
    assert "root : (peak,) complex, 1/s" in text and "gusts : tuple of Gust" in text
