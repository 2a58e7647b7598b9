"""Quantities as text."""

from __future__ import annotations

import math
import time

import pytest
import scipy.constants as si
from hypothesis import given
from hypothesis import strategies as st

import gbeam as gb
from gbeam.guards import KINDS, NUMBER, USUAL, UnitError, argument, parsed_factor, quantity

G0 = 9.80665


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("300 mm", "length", 0.3),
        ("1e-3 km", "length", 1.0),
        ("3 µm", "length", 3e-6),
        ("3 in", "length", 0.0762),
        ("1 ft", "length", 0.3048),
        ("1 lb", "mass", 0.45359237),
        ("1 lbf", "force", 4.4482216152605),
        ("1 psi", "pressure", 4.4482216152605 / 0.0254**2),
        ("6 g", "acceleration", 6 * G0),
        ("1.4g", "acceleration", 1.4 * G0),
        ("1 g0", "acceleration", G0),
        ("15 g/s", "jerk", 15 * G0),
        ("3 m/s^3", "jerk", 3.0),
        ("6 g", "mass", 0.006),
        ("25 kg", "mass", 25.0),
        ("2.7 g/cm^3", "density", 2700.0),
        ("2700 kg/m³", "density", 2700.0),
        ("200 kg m^2", "moment of inertia", 200.0),
        ("5 g m^2", "moment of inertia", 0.005),
        ("70 GPa", "pressure", 70e9),
        ("7e4 N/mm^2", "pressure", 70e9),
        ("200 N m", "torque", 200.0),
        ("0.2 kN·m", "torque", 200.0),
        ("16 s", "time", 16.0),
        ("60 ms", "time", 0.06),
        ("2 min", "time", 120.0),
        ("30 deg", "angle", math.pi / 6),
        ("3 rad/s", "angular rate", 3.0),
        ("60 rpm", "angular rate", 2 * math.pi),
        ("20 Hz", "angular rate", 40 * math.pi),
        ("180 °/s", "angular rate", math.pi),
        ("20 Hz", "frequency", 20.0),
        ("20 1/s", "frequency", 20.0),
        ("60 rpm", "frequency", 1.0),
        ("1 %", "ratio", 0.01),
        ("8219 mm^4", "second moment of area", 8.219e-9),
        (3, "length", 3.0),
        (2.5, "angular rate", 2.5),
        (0, "ratio", 0.0),
    ],
)
def test_value(text: object, kind: str, value: float) -> None:
    assert quantity(text, kind) == pytest.approx(value, rel=1e-14)


# Sizes of units by scipy.constants, which has them from CODATA and from their definitions.
INDEPENDENT = {
    "length": {"in": si.inch, "ft": si.foot, "mm": si.milli, "um": si.micro, "km": si.kilo},
    "mass": {"lb": si.lb, "g": si.gram},
    "time": {"min": si.minute, "h": si.hour, "ms": si.milli, "us": si.micro},
    "force": {"lbf": si.lbf, "kN": si.kilo, "MN": si.mega},
    "pressure": {
        "psi": si.psi,
        "kPa": si.kilo,
        "MPa": si.mega,
        "GPa": si.giga,
        "lbf/in^2": si.psi,
        "ksi": 1e3 * si.psi,
        "Msi": 1e6 * si.psi,
    },
    "torque": {"lbf ft": si.lbf * si.foot, "lbf in": si.lbf * si.inch, "kN m": si.kilo},
    "density": {"lb/ft^3": si.lb / si.foot**3, "g/cm^3": si.gram / si.centi**3},
    "acceleration": {"g": si.g, "g0": si.g, "ft/s^2": si.foot, "in/s^2": si.inch},
    "angle": {"deg": si.degree, "rev": 2 * si.pi, "mrad": si.milli},
    "angular rate": {"rpm": 2 * si.pi / si.minute, "deg/s": si.degree, "Hz": 2 * si.pi},
    "power": {"kW": si.kilo, "MW": si.mega},
    "rotational stiffness": {"lbf in/deg": si.lbf * si.inch / si.degree},
}


@pytest.mark.parametrize("kind", INDEPENDENT)
def test_every_unit_has_its_size(kind: str) -> None:
    """Against a table that nobody here wrote, through both doors: the quick one, and the parser."""
    for unit, size in INDEPENDENT[kind].items():
        assert quantity(f"1 {unit}", kind) == pytest.approx(size, rel=1e-15, abs=0), unit
        assert parsed_factor(unit, kind) == pytest.approx(size, rel=1e-15, abs=0), unit


@pytest.mark.parametrize("kind", KINDS)
def test_the_usual_units_are_those_of_the_parser(kind: str) -> None:
    for unit, factor in {KINDS[kind].unit or "dimensionless": 1.0, **USUAL.get(kind, {})}.items():
        assert parsed_factor(unit, kind) == pytest.approx(factor, rel=1e-15, abs=0)


def test_argument_takes_bare_numbers() -> None:
    assert argument(" 2.5 ", "time") == 2.5
    assert argument("60 rpm", "angular rate") == pytest.approx(2 * math.pi)
    with pytest.raises(UnitError, match="is a mass"):
        argument("2 kg", "time")
    with pytest.raises(UnitError, match="not a number with a unit"):
        argument("nan", "time")


@pytest.mark.parametrize("kind", KINDS)
def test_every_example_is_one_of_its_kind(kind: str) -> None:
    assert quantity(KINDS[kind].example, kind) > 0
    assert KINDS[kind].phrase.split(" ", 1)[1]


@pytest.mark.parametrize(
    ("text", "kind", "problem", "hint"),
    [
        ("20 kg", "length", '"20 kg" is a mass', 'expected a length, such as "20 mm"'),
        ("3 1/s", "angular rate", '"3 1/s" is a frequency', 'expected an angular rate, such as "3 rad/s"'),
        ("3 rad/s^2", "frequency", '"3 rad/s^2" is an angular acceleration', "expected a frequency"),
        ("3 rad", "ratio", '"3 rad" is an angle', "expected a ratio"),
        ("3 mg", "acceleration", '"3 mg" is a mass', "expected an acceleration"),
        ("3 m s", "length", '"3 m s" has the dimension', "expected a length"),
        ("10", "length", '"10" has no unit', "or write the bare number 10 for m"),
        ("0.01", "ratio", '"0.01" has no unit', "write the bare number 0.01, without quotes"),
        ("3 MM", "length", "\"3 MM\" has the unknown unit 'MM'", "did you mean 'mm'?"),
        ("3 mpa", "pressure", "\"3 mpa\" has the unknown unit 'mpa'", "did you mean 'MPa'?"),
        ("600 mn", "length", "\"600 mn\" has the unknown unit 'mn'", "did you mean 'mm'?"),
        ("600 mn", "force", "\"600 mn\" has the unknown unit 'mn'", "did you mean 'MN'?"),
        ("3 mn/s", "speed", "\"3 mn/s\" has the unknown unit 'mn'", "did you mean 'mm'?"),
        ("3 kgf", "force", "\"3 kgf\" has the unknown unit 'kgf'", "expected a force"),
        ("5 khz", "frequency", "\"5 khz\" has the unknown unit 'khz'", "did you mean 'kHz'?"),
        ("80 mm2", "area", "\"80 mm2\" has the unknown unit 'mm2'", "did you mean 'mm^2'?"),
        ("5 kNm", "torque", "\"5 kNm\" has the unknown unit 'kNm'", "did you mean 'kN m'?"),
        ("3 qqq", "length", "\"3 qqq\" has the unknown unit 'qqq'", "expected a length"),
        ("3 (m", "length", "\"3 (m\" has the unreadable unit '(m'", 'write it such as "20 mm"'),
        ("3 mm + 2 m", "length", '"3 mm + 2 m" has the unreadable unit', "write it such as"),
        ("1,5 mm", "length", '"1,5 mm" has the unreadable unit', "write it such as"),
        ("5 m # note", "length", '"5 m # note" has the unreadable unit', "write it such as"),
        ("3 m/0", "length", '"3 m/0" has the unreadable unit', "write it such as"),
        ("mm", "length", '"mm" is not a number with a unit', "expected a length"),
        ("inf m", "length", '"inf m" is not a number with a unit', "expected a length"),
        ("1e999 m", "length", '"1e999 m" is not finite', "expected a length"),
        (math.inf, "length", "inf is not finite", "expected a length"),
        (math.nan, "length", "nan is not finite", "expected a length"),
        (10**400, "length", "1000", "expected a length"),
        (True, "length", "true is not a number", "expected a length"),
        (None, "length", "null is not a number", "expected a length"),
        ([1], "length", "a list is not a number", "expected a length"),
        ({}, "length", "a table is not a number", "expected a length"),
    ],
)
def test_refused(text: object, kind: str, problem: str, hint: str) -> None:
    with pytest.raises(UnitError) as caught:
        quantity(text, kind)
    assert caught.value.problem.startswith(problem)
    assert caught.value.hint.endswith(hint) or caught.value.hint.startswith(hint)


@given(
    st.floats(-1e12, 1e12),
    st.sampled_from([("length", "m"), ("mass", "kg"), ("time", "s"), ("jerk", "m/s^3")]),
)
def test_a_number_and_its_text_are_the_same(number: float, kind_and_unit: tuple[str, str]) -> None:
    kind, unit = kind_and_unit
    assert quantity(f"{number!r} {unit}", kind) == quantity(number, kind) == number


@given(st.floats(-1e6, 1e6))
def test_a_prefix_only_scales(number: float) -> None:
    assert quantity(f"{number!r} mm", "length") == pytest.approx(number / 1000, rel=1e-14, abs=1e-300)
    assert quantity(f"{number!r} g", "acceleration") == pytest.approx(number * G0, rel=1e-14, abs=1e-300)


@given(st.text(max_size=20))
def test_no_text_breaks_the_parser(text: str) -> None:
    try:
        assert math.isfinite(quantity(f"1 {text}", "length"))
    except UnitError as error:
        assert error.problem


@pytest.mark.parametrize(
    "text", [" " * 20_000 + "x", "+" + " " * 20_000, "1" + " " * 20_000 + "x" + " " * 20_000 + "y"]
)
def test_a_long_text_takes_no_more_than_its_length(text: str) -> None:
    """White space of 20 kB took seconds, in the square of its length."""
    begin = time.process_time()
    with pytest.raises(gb.InputError, match="radius"):
        gb.Hub(radius=text, rate=1.0)
    parts = NUMBER.fullmatch(text)
    assert (parts is not None) == text.startswith("1") and (parts is None or parts[2] == text[1:].strip())
    assert time.process_time() - begin < 0.5
