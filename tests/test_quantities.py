"""Every public function and method reads quantities, of text or of pint, and none loses its unit."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from inspect import signature
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest

import gbeam as gb
from gbeam.guards.kinds import KINDS, kind_of_argument

from .test_arguments import PUBLIC, Samples, called


@pytest.fixture(scope="module")
def samples(tmp_path_factory: pytest.TempPathFactory) -> Samples:
    return Samples(tmp_path_factory.mktemp("samples"))


UNITS = pint.UnitRegistry()


def numbers(value: Any) -> int:
    """Count of the numbers in a value, or in what it holds."""
    if isinstance(value, (list, tuple, dict)):
        return sum(map(numbers, value.values() if isinstance(value, dict) else value))
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def with_numbers(value: Any, change: Callable[[float], Any]) -> Any:
    """The value with each of its numbers changed."""
    if isinstance(value, dict):
        return {key: with_numbers(each, change) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(with_numbers(each, change) for each in value)
    return change(value) if numbers(value) else value


def with_units(value: Any) -> dict[str, Any]:
    """The value with its numbers as quantities, or as texts."""
    said = {
        "quantity": with_numbers(value, lambda number: number * UNITS.mm),
        "unit": with_numbers(value, lambda number: UNITS.mm),
        "without dimension": with_numbers(value, lambda number: number * UNITS.deg),
        "text with a unit": with_numbers(value, lambda number: f"{number} mm"),
        "text": with_numbers(value, str),
    }
    if isinstance(value, (list, tuple)) and all(map(numbers, value)):
        said["array"] = np.array(value, dtype=float) * UNITS.mm
        said["array of objects"] = np.array([number * UNITS.mm for number in value] + [None], dtype=object)[:-1]
        said["the last alone"] = [*value[:-1], value[-1] * UNITS.mm]
        said["the last alone a text"] = [*value[:-1], f"{value[-1]} mm"]
    return said


SHAPES: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {
    "Section.of": (("tube",), {"stations": (0.0, 0.3), "diameter": (0.02, 0.01), "wall": 1e-3}),
    "Section.rectangle": (([0.02, 0.02], [0.004, 0.002], (0.0, 0.3)), {}),
    "Section.circle": ((0.01,), {}),
    "Section.tube": ((0.01, 1e-3), {}),
    "Section.general": (
        (8e-5, 1e-10, 1e-10, (), 0.01, 0.002),
        {"torsion_constant": 1e-10, "shear_coefficient_y": 0.8, "shear_coefficient_z": 0.8},
    ),
}


INSTEAD: dict[str, dict[str, Any]] = {  # of what stands in the calls of above
    "Hub": {"radius": 0.5, "inertia": 2.0, "torque": 1.0},
    "Initial": {"tip_displacement": {"z": 0.1}},
    "Flight": {"z": 1.0, "rates": (0.1, 0.2, 0.3)},
    "vector": {"x": 1.0},
}


@pytest.mark.parametrize("name", [*PUBLIC, *SHAPES, *(f"{name} instead" for name in INSTEAD)])
def test_no_number_loses_its_unit(samples: Samples, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 20 mm NumPy takes 20, and texts of numbers are read as metres."""
    monkeypatch.chdir(tmp_path)
    name, _, instead = name.partition(" ")
    args, keywords = SHAPES[name] if name in SHAPES else ((), INSTEAD[name]) if instead else samples.calls()[name]
    function = attrgetter(name)(gb)
    names = [*signature(function).parameters]
    problems = []
    for at, value in [*enumerate(args), *keywords.items()]:
        said = with_units(value) if numbers(value) else {"quantity": 1 * UNITS.mm} if value is None else {}
        for how, wrong in said.items():
            changed = list(args), dict(keywords)
            changed[isinstance(at, str)][at] = wrong  # type: ignore[index]
            argument = at if isinstance(at, str) else names[at]
            if argument == "over" and "text" in how:
                continue  # a sweep's values are the scenario's, which has units
            kind = kind_of_argument(name.rpartition(".")[2] if name.startswith("Section.") else name, argument)
            if kind == ("angle" if how == "without dimension" else "length") and how not in (
                "unit",
                "array of objects",
            ):
                continue  # it is read: see below
            try:
                called(function, *changed[0], **changed[1])
            except gb.InputError as error:
                said_so = BARE in error.fix or (kind and "expected" in error.fix)
                if not ("text" in how or (argument in error.where and said_so)):
                    problems.append(f"{argument}, {how}: {error}")
            except Exception as error:
                problems.append(f"{argument}, {how}: {type(error).__name__}: {error}")
            else:
                problems.append(f"{argument}, {how}: nothing is refused")
    assert not problems, "\n".join(problems)


MADE = [*SHAPES, *(name for name in PUBLIC if isinstance(getattr(gb, name), type))]


@pytest.mark.parametrize("name", [*MADE, *(f"{name} instead" for name in INSTEAD if name != "vector")])
@pytest.mark.parametrize("how", ["text", "pint"])
def test_a_quantity_is_read_as_scenarios_read_it(samples: Samples, name: str, how: str) -> None:
    """Texts with a unit and pint's quantities make what the numbers in SI make."""
    name, _, instead = name.partition(" ")
    args, keywords = SHAPES[name] if name in SHAPES else ((), INSTEAD[name]) if instead else samples.calls()[name]
    function = attrgetter(name)(gb)
    places = [*zip(signature(function).parameters, args, strict=False), *keywords.items()]

    def said(argument: str, value: Any) -> Any:
        kind = kind_of_argument(name.rpartition(".")[2], argument)
        if not kind or not numbers(value):
            return value
        unit = KINDS[kind].unit
        if how == "text":
            return with_numbers(value, lambda number: f"{number!r} {unit}" if unit else number)
        return with_numbers(value, lambda number: number * UNITS(unit or "dimensionless"))

    in_si, read = (
        function(*[change(*each) for each in places[: len(args)]], **{k: change(k, v) for k, v in keywords.items()})
        for change in (lambda _, value: value, said)
    )
    assert read == in_si


ANY_UNIT = {"over", "amplitude", "level"}  # of the scenario's values, and of profiles of whatever quantity


def test_units_of_arguments_are_those_of_the_documents(samples: Samples) -> None:
    """Where a public docstring says one unit of a number, the argument is read as a quantity that has it."""
    problems, read = [], 0
    for name, (args, keywords) in samples.calls().items():
        values = {**dict(zip(signature(getattr(gb, name)).parameters, args, strict=False)), **keywords}
        for argument, words in documented(getattr(gb, name)).items():
            kind = kind_of_argument(name, argument)
            units = set(SAID.findall(words))
            if not kind and len(units) == 1 and numbers(values.get(argument)) and argument not in ANY_UNIT:
                problems.append(f"{name}: {argument} is in {units}, and not read as a quantity")
            if not kind or not units:
                continue
            read += 1
            unit = KINDS[kind].unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴").replace("1/s", "Hz")
            if unit and unit not in units:
                problems.append(f"{name}: {argument} is read in {unit}, and said to be in {units}")
    assert not problems and read > 60, "\n".join(problems)


SAID = re.compile(
    r"(?<![\w/'`])(kg m²|N m s/rad|N m/rad|N m|N/m|kg/m³|rad/s[²³]|rad/s|m/s[²³]|m/s|m²|m⁴|Hz|Pa|rad|kg|N|s|m|W)"
    r"(?![\w/²³⁴'])"
)


def documented(thing: Any) -> dict[str, str]:
    """Words of every parameter in a docstring."""
    text = inspect.getdoc(thing) or ""
    section = re.search(r"Parameters\n-+\n(.*?)(?:\n\n[A-Z]\w+\n---|\Z)", text, re.DOTALL)
    words: dict[str, str] = {}
    names: list[str] = []
    for line in section[1].splitlines() if section else ():
        if line and not line.startswith(" "):
            head, _, _ = line.partition(" : ")
            names = [each.strip() for each in head.split(",")]
        else:
            words |= {each: f"{words.get(each, '')} {line.strip()}" for each in names}
    return words


@pytest.mark.parametrize("name", ["flight", "hub", "centrifuge", "profile", "section", "beam", "particles"])
def test_nor_do_those_that_methods_are_given(samples: Samples, name: str) -> None:
    mass, time = np.ones(1), 0.5
    places: tuple[Any, ...] = (np.zeros((1, 3)), np.ones((1, 3, 1)), np.eye(1))
    call: Callable[[Any], Any] = {
        "flight": lambda unit: samples.flight.over(0.0, time * unit),
        "hub": lambda unit: samples.hub.over(0.0, time * unit),
        "centrifuge": lambda unit: samples.centrifuge.over(0.0, time * unit),
        "profile": lambda unit: gb.constant(1.0)(time * unit),
        "section": lambda unit: samples.beam.section.at(np.array([time]) * unit),
        "beam": lambda unit: samples.beam.rigidities(np.array([time]) * unit),
        "particles": lambda unit: gb.Structure.of_particles(mass * unit, *places, second=np.zeros((1, 3, 1, 1))),
    }[name]
    call(1)
    with pytest.raises(gb.InputError):
        call(UNITS.mm)


BARE = "give numbers without a unit, in SI"


class Metres(float):
    """A quantity of another library."""

    unit, to = "m", float


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gb.constant(20 * UNITS.mm), f'value is 20 millimeter; {BARE}: .to("m").magnitude'),
        (lambda: gb.constant(60 * UNITS.Hz), f'value is 60 hertz; {BARE}: .to("1 / s").magnitude; '
         "1 Hz is 6.2832 rad/s as an angular rate"),
        (lambda: gb.PointMass(0.1, 0.1, offset=(0, Metres(1), 0)), f"offset[1] is 1.0; {BARE}"),
        (lambda: gb.constant("20 mm"), "value is '20 mm'; give numbers in SI"),
        (lambda: gb.Material(2700, "70"), 'youngs_modulus "70" has no unit; '
         'add a unit, such as "70 GPa", or write the bare number 70 for Pa'),
        (lambda: gb.Hub(radius=0.5, rate="60 mm"), 'rate "60 mm" is a length; '
         'expected an angular rate, such as "3 rad/s"'),
        (lambda: gb.Hub(radius=0.5, rate=60 * UNITS.mm), 'rate "60.0 mm" is a length; '
         'expected an angular rate, such as "3 rad/s"'),
    ],
)  # fmt: skip
def test_how_a_unit_is_refused(call: Callable[[], Any], words: str) -> None:
    with pytest.raises(gb.InputError) as refused:
        call()
    assert str(refused.value) == words
