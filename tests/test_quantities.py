"""Every public function and method reads quantities, of text or of pint, and none loses its unit."""

from __future__ import annotations

import functools
import inspect
import re
import types
from collections.abc import Callable
from dataclasses import dataclass
from inspect import signature
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest

import gbeam as gb
from gbeam.arrays import Value
from gbeam.guards import (
    KINDS,
    PLAIN,
    USUAL,
    WRITTEN,
    Kinds,
    common_kind,
    element_kinds,
    kind_of_argument,
    typed,
    unit_of,
)
from gbeam.mechanics import OF_COORDINATES
from gbeam.results import Errors, LoadDifference

from .test_arguments import PUBLIC, Samples, called

pytestmark = pytest.mark.filterwarnings("error::pint.UnitStrippedWarning")


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


def kinds_in(value: Any, kinds: Kinds) -> set[str]:
    """Kinds of the numbers in a value."""
    if isinstance(value, (list, tuple, dict)):
        entries = value.items() if isinstance(value, dict) else enumerate(value)
        return set().union(*(kinds_in(each, element_kinds(kinds, key)) for key, each in entries))
    return {common_kind(kinds)} if numbers(value) or value is None else set()


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
        said["array of objects"] = np.fromiter((number * UNITS.mm for number in value), dtype=object)
        said["the last alone"] = [*value[:-1], value[-1] * UNITS.mm]
        said["the last alone a text"] = [*value[:-1], f"{value[-1]} mm"]
    return said


SHAPES: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {
    "Section.of": (("tube",), {"stations": (0.0, 0.3), "diameter": (0.02, 0.01), "wall": 1e-3}),
    "Section.rectangle": (([0.02, 0.02], [0.004, 0.002], (0.0, 0.3)), {}),
    "Section.circle": ((0.01,), {}),
    "Section.tube": ((0.01, 1e-3), {}),
    "Line.of_pieces": (([0.1, 0.2],), {"twist": 0.1, "turn_y": [0.0, 0.2], "turn_z": 0.3}),
    "Line.of_points": (([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.2, 0.1, 0.0)],), {"twist": 0.1}),
    "RigidSpecimen.box": ((1.0, (0.1, 0.2, 0.3)), {"centre": (0.1, 0.0, 0.0)}),
    "Section.general": (
        (8e-5, 1e-10, 1e-10, (), 0.01, 0.002),
        {"torsion_constant": 1e-10, "shear_coefficient_y": 0.8, "shear_coefficient_z": 0.8},
    ),
}


SLIDE = gb.System({"bar": gb.RigidBody(1.0, (1.0, 1.0, 1.0))}, {"s": gb.Joint("prismatic", "bar", axes=[(1, 0, 0)])})
INSTEAD: dict[str, dict[str, Any]] = {  # of what stands in the calls of above
    "Feedback": {
        "law": lambda t, y: np.zeros(2),
        "sample": 0.01,
        "measure": ["a.angle_rate", "b.tip.place_x", "b.root.force_x"],
        "drive": ["a.displacement", "a.moment_x"],
        "limit": [5.0, 3.0],
        "reference": (0.1, 0.2, 0.3),
    },
    "Joint": {
        "kind": "cylindrical",
        "body": "bar",
        "axes": [(1.0, 0.0, 0.0)],
        "coupling": {"displacement-angle": 0.5},
        "stops": {"displacement": (-0.1, 0.1), "angle": (-1.0, 1.0)},
        **{key: {"displacement": 2.0, "angle": 3.0} for key in OF_COORDINATES if key not in ("stops", "rate")},
    },
    "Load": {"distributed": (0.0, 0.0, 2.0), "distributed_moment": (0.0, 1.0, 0.0)},
    "optimise": {"bounds": {"beam.length": (0.1, 0.5)}, "options": {"to": 3.0}},
    "shape_command": {"structure": SLIDE, "hub": "s.displacement", "rate": 0.1, "duration": 1.0, "limit": 3.0},
    "Hub": {"radius": 0.5, "inertia": 2.0, "torque": 1.0},
    "Initial": {"tip_displacement": {"z": 0.1}},
    "Flight": {"z": 1.0, "rates": (0.1, 0.2, 0.3)},
    "vector": {"x": 1.0},
}


def called_with(samples: Samples, name: str, instead: str = "") -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments of a public function, or of a method that builds an object."""
    if instead or name in OF_FILES:
        return (), (INSTEAD if instead else OF_FILES)[name]
    return SHAPES[name] if name in SHAPES else samples.calls()[name]


@pytest.mark.parametrize("name", [*PUBLIC, *SHAPES, *(f"{name} instead" for name in INSTEAD)])
def test_no_number_loses_its_unit(samples: Samples, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 20 mm NumPy takes 20, and texts of numbers are read as metres."""
    monkeypatch.chdir(tmp_path)
    name, _, instead = name.partition(" ")
    args, keywords = called_with(samples, name, instead)
    function = attrgetter(name)(gb)
    names = [*signature(function).parameters]
    values = dict(zip(names, args, strict=False)) | keywords
    problems = []
    for at, value in [*enumerate(args), *keywords.items()]:
        said = with_units(value) if numbers(value) else {"quantity": 1 * UNITS.mm} if value is None else {}
        for how, wrong in said.items():
            changed = list(args), dict(keywords)
            changed[isinstance(at, str)][at] = wrong  # type: ignore[index]
            argument = at if isinstance(at, str) else names[at]
            kinds = kinds_in(value, kind_of_argument(function, argument, values))
            fitting = {WRITTEN, "angle" if how == "without dimension" else "length"}
            if kinds <= fitting and how not in ("unit", "array of objects"):
                continue  # it is read: see below
            try:
                called(function, *changed[0], **changed[1])
            except gb.InputError as error:
                said_so = BARE in error.fix or (any(kinds) and "expected" in error.fix)
                if not ("text" in how or (argument in error.where and said_so)):
                    problems.append(f"{argument}, {how}: {error}")
            except Exception as error:
                problems.append(f"{argument}, {how}: {type(error).__name__}: {error}")
            else:
                problems.append(f"{argument}, {how}: nothing is refused")
    assert not problems, "\n".join(problems)


@dataclass(eq=False)
class Held(Value):
    """Compares its content number by number."""

    content: Any


def written(value: Any, kinds: Kinds, how: str) -> Any:
    """The value with its numbers in another unit than that of SI, exactly as large, as texts or as quantities."""
    if isinstance(value, (dict, list, tuple)):
        entries = value.items() if isinstance(value, dict) else enumerate(value)
        changed = {key: written(each, element_kinds(kinds, key), how) for key, each in entries}
        return changed if isinstance(value, dict) else type(value)(changed.values())
    kind = common_kind(kinds)
    if not numbers(value) or kind in ("", PLAIN) or not np.isfinite(value):
        return value
    si = "mm" if kind == WRITTEN else KINDS[kind].unit
    other = si if kind == WRITTEN or si[:1] == "k" else next(iter(USUAL.get(kind, [f"k{si}"])))
    factor = 1.0 if kind == WRITTEN else unit_of(f"1 {other}", kind)[1]
    near = value / factor
    exact = [float(each) for each in (near, *np.nextafter(near, (-np.inf, np.inf))) if each * factor == value]
    number, unit = (exact[0], other) if exact else (float(value), si)
    if how == "text":
        return f"{number!r} {unit}" if unit else number
    return number * UNITS(unit.replace("g", "g_0", kind in ("acceleration", "jerk")) or "dimensionless")


OF_FILES: dict[str, dict[str, Any]] = {  # methods of what is read from files
    "ImportedModel.reduced": {"total_mass": 1.0, "centre": (0.1, 0.0, 0.0), "inertia": np.eye(3).tolist()},
    "ModalTest.structure": {"mass": [0.1, 0.2]},
    "Section.drawn": {"outline": [(0.0, 0.1)], "holes": [[(0.0, 0.1)]], "axis": (0.0, 0.1), "element_size": 0.1},
    "Section.read": {"stations": (0.0, 0.1)},
    "SolidMesh.read": {
        "thickness": {"skin": 1e-3}, "element_size": 0.1, "points": {"lid": (0.1, 0.2, 0.0), "foot": "12"},
        "point_masses": {"lid": 0.1}, "origin": (0.1, 0.0, 0.0), "turn": (0.0, 0.0, 0.1),
        "springs": {"mount": {"between": ["a", "b"], "stiffness": {"x": 2.0, "rz": 3.0}}},
    },
    "SolidMesh.reduced": {"modes": 5, "damping_ratio": [0.1, 0.2]},
    "Structure.of_particles": {"mass": [1.0], "r0": [(0.1, 0.0, 0.0)], "damping_ratio": [0.1], "stations": [0]},
}  # fmt: skip


def received(function: Any) -> Any:
    """A class; or what a function is called with, which need not run to be asked how it reads its arguments."""
    if isinstance(function, type):
        return function

    @functools.wraps(function.__wrapped__)  # type: ignore[attr-defined]
    def call(*args: Any, **keywords: Any) -> Any:
        return args, keywords

    return types.MethodType(typed(call), function.__self__) if inspect.ismethod(function) else typed(call)


@pytest.mark.parametrize("name", [*PUBLIC, *SHAPES, *OF_FILES, *(f"{name} instead" for name in INSTEAD)])
@pytest.mark.parametrize("how", ["text", "pint"])
def test_a_quantity_is_read_as_scenarios_read_it(samples: Samples, name: str, how: str) -> None:
    """Texts with a unit and pint's quantities are what the numbers in SI are."""
    name, _, instead = name.partition(" ")
    args, keywords = called_with(samples, name, instead)
    function = received(attrgetter(name)(gb))
    values = dict(zip(signature(function).parameters, args, strict=False)) | keywords
    kinds = {each: kind_of_argument(attrgetter(name)(gb), each, values) for each in values}
    said = {each: written(value, kinds[each], how) for each, value in values.items()}
    for each, kind in kinds.items():
        if kind == WRITTEN:  # the scenario reads its texts
            values[each] = written(values[each], kind, "text")
    assert Held(function(**said)) == Held(function(**values))


# Of methods, by their names, or those of the method where they differ.
ARGUMENTS: dict[str, Any] = {
    "acceleration": np.ones((5, 3)), "ahead": True, "chosen": np.array([0]), "duration": 0.1, "end": 0.1,
    "measured": np.array([0.1]), "name": "flight", "order": 1, "poissons_ratio": 0.3, "q": np.full(2, 1e-4),
    "rate": "angle", "sample": 0.01,
    "samples": 100, "start": 0.0, "state": np.zeros(0), "stations": [0.1], "step": 0.01, "stride": 2, "t": 0.05,
    "time": 0.05, "tolerance": 0.05, "width": 0.05, "x": [0.1, 0.2],
}  # fmt: skip
OF_RESPONSES = {"RigidSpecimen.felt", "RigidSpecimen.parts"}  # which call them


def of_gbeam(method: Any) -> bool:
    """True of a public method that is gbeam's."""
    name = getattr(method, "__name__", "_")
    home = str(getattr(method, "__module__", ""))
    return inspect.isroutine(method) and (name == "__call__" or name[0] != "_") and home.startswith("gbeam.")


def methods() -> dict[str, Callable[..., Any]]:
    """Methods, of every class that users get hold of, that take quantities or plain numbers."""
    classes = [each for name in gb.__all__ if isinstance(each := getattr(gb, name), type)]
    taken = {}
    for kind in [*classes, LoadDifference, Errors]:
        for name, method in inspect.getmembers(kind, of_gbeam):
            names = signature(method).parameters if inspect.isfunction(method) else ()
            if any(kind_of_argument(method, each, {}) for each in names):
                taken[f"{kind.__name__}.{name}"] = method
    return taken


@pytest.mark.parametrize("name", sorted(methods().keys() - OF_RESPONSES - OF_FILES.keys()))
def test_methods_read_quantities_too(samples: Samples, name: str) -> None:
    owner, _, method = name.partition(".")
    call = getattr(samples.objects.get(name, samples.objects.get(owner)), method)
    values = {each: ARGUMENTS[each] for each in signature(call).parameters if each not in ("motion", "beam", "model")}
    if name == "RigidSpecimen.loads":
        values["motion"] = samples.flight
    kinds = {each: kind_of_argument(call, each, {}) for each in values}
    for how in ("text", "pint"):
        said = {each: written(value, kinds[each], how) for each, value in values.items()}
        assert Held(call(**said)) == Held(call(**values))
    for each in (each for each, kind in kinds.items() if kind):
        for wrong in ("5 W", 5 * UNITS.W, np.ones(2) * UNITS.W, object()):
            with pytest.raises(gb.InputError, match=f"^{each}"):
                call(**values | {each: wrong})


# Not read, though documents say a unit, and why.
NOT_READ = {
    "values of profiles, which do not know what they are of":
        "build_target.raw",
    "functions": "Choice.make Line.curvature",
    "times by the names of motions": "Case.spans",
    "words": "Feedback.measure SolidMesh.read.mass_unit read_record.time_unit read_record.unit read_scenario.overrides",
    "matrices whose entries have several units":
        "ImportedModel.reduced.geometric Section.of_matrices.mass Section.of_matrices.stiffness",
    "derivatives by coordinates, which have no unit": "Structure.of_particles.turns",
}  # fmt: skip


def test_units_of_arguments_are_those_of_the_documents(samples: Samples) -> None:
    """Where a public docstring says units of a number, the argument is read as a quantity that has one of them."""
    problems, read, plain = [], 0, set()
    classes = [name for name in gb.__all__ if isinstance(getattr(gb, name), type)]
    every = {*samples.calls(), *SHAPES, *OF_FILES}
    functions = {name: getattr(gb, name) for name in samples.calls()}
    for name in classes:
        functions |= {f"{name}.{key}": each for key, each in inspect.getmembers(getattr(gb, name), of_gbeam)}
    for name, function in functions.items():
        args, keywords = called_with(samples, name) if name in every else ((), {})
        words = documented(function)
        values = dict(zip(signature(function).parameters, args, strict=False)) | keywords
        values = dict.fromkeys(words) | values | INSTEAD.get(name, {})
        for argument in words.keys() & signature(function).parameters.keys():
            kinds = kind_of_argument(function, argument, values)
            units = set(SAID.findall(words[argument]))
            if units and not kinds:
                plain.add(f"{name}.{argument}")
            if not kinds or not units or kinds in (PLAIN, WRITTEN):
                continue
            read += 1
            for kind in kinds_in(values[argument], kinds) - {"", WRITTEN}:
                unit = KINDS[kind].unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴").replace("1/s", "Hz")
                if unit and unit not in units:
                    problems.append(f"{name}: {argument} is read in {unit}, and said to be in {units}")
    assert not problems and read > 240, "\n".join([*problems, str(read)])
    known = {*" ".join(NOT_READ.values()).split()}
    assert (sorted(plain - known), sorted(known - plain)) == ([], [])  # no other, and none of these is read by now


SAID = re.compile(
    r"(?<![\w/'`])(kg m²|N m s/rad|N s/m|N m/rad|N m|N/m|kg/m³|rad/s[²³]|rad/s|m/s[²³]|m/s|m²|m⁴|Hz|Pa|rad|kg|N|s|m|W)"
    r"(?![\w/²³⁴'])"
)


def documented(thing: Any) -> dict[str, str]:
    """Words of every parameter in a docstring: among its parameters, or after its name in a sentence."""
    text = inspect.getdoc(thing) or ""
    section = re.search(r"Parameters\n-+\n(.*?)(?:\n\n[A-Z]\w+\n---|\Z)", text, re.DOTALL)
    sentence = text.partition("\n\n")[0].replace("\n", " ")
    words = dict(re.findall(r"`(\w+)`((?: \(\w, ?\),?)?,? \(?[^\s),.:;]+)", sentence))
    names: list[str] = []
    for line in section[1].splitlines() if section else ():
        if line and not line.startswith(" "):
            head, _, kind = line.partition(" : ")
            names = [each.strip() for each in head.split(",")]
            parts = (unit for part in kind.split(", ")[1:] for unit in part.split(" or "))
            units = " ".join(unit for unit in parts if SAID.fullmatch(unit))
            words |= {each: f"{words.get(each, '')} {units}" for each in names}
        else:
            words |= {each: f"{words.get(each, '')} {line.strip()}" for each in names}
    return words


def sliding(**keywords: Any) -> Any:
    return gb.Joint("cylindrical", "bar", axes=[(1, 0, 0)], **keywords)


def law(**keywords: Any) -> Any:
    return gb.Feedback(lambda t, y: y, ["a.angle_rate"], ["a.displacement", "a.moment_x"], 0.01, **keywords)


@pytest.mark.parametrize(
    ("read", "size"),
    [
        (lambda: gb.Load("0.1 m", force=(0, 0, "5 kN")).force[2], 5e3),
        (lambda: gb.Load("0.1 m", moment=(0, "5 kN m", 0)).moment[1], 5e3),
        (lambda: gb.Load(distributed=(0, 0, "5 N/mm")).distributed[2], 5e3),
        (lambda: gb.Load(distributed_moment=(0, 5 * UNITS.N, 0)).distributed_moment[1], 5.0),
        (lambda: gb.Joint("revolute", "bar", axes=[(0, 1, 0)], stops=("-90 deg", 1.0), stop_stiffness=9.0).stops[0],
         -np.pi / 2),
        (lambda: sliding(stiffness={"displacement": "2 N/mm", "angle": 3.0}).stiffness["displacement"], 2e3),
        (lambda: sliding(damping={"angle": "2 kN m s/rad"}).damping["angle"], 2e3),
        (lambda: sliding(friction={"displacement": "2 kN"}).friction["displacement"], 2e3),
        (lambda: sliding(effort={"angle": "2 kN m"}).effort["angle"], 2e3),
        (lambda: sliding(rate={"angle": "60 rpm"}).rate["angle"], 2 * np.pi),
        (lambda: gb.Joint("free", "bar", initial_rate={"wx": "60 rpm", "x": 1.0}).initial_rate["wx"], 2 * np.pi),
        (lambda: gb.Joint("fixed", "bar", stiffness={"y": 9e9, "rz": 9e9}, coupling={"y-rz": "2 kN"}).coupling["y-rz"],
         2e3),
        (lambda: law(limit=["3 kN", 2.0]).limit[0], 3e3),
        (lambda: law(limit=[2.0, "3 kN m"]).limit[1], 3e3),
        (lambda: law(reference="60 rpm").reference[0](0.0), 2 * np.pi),
        (lambda: gb.Section("general", {"area": ("80 mm^2",), "inertia_y": (1e-9,), "inertia_z": (1e-9,)}).at(0.0).area,
         8e-5),
    ],
)  # fmt: skip
def test_a_unit_may_be_that_of_a_name(read: Callable[[], float], size: float) -> None:
    assert read() == pytest.approx(size, rel=1e-15)


BARE = "give numbers without a unit, in SI"


class Metres(float):
    """A quantity of another library."""

    unit, to = "m", float


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: gb.constant(20 * UNITS.mm), f'level is 20 millimeter; {BARE}: .to("m").magnitude'),
        (lambda: gb.constant(60 * UNITS.Hz), f'level is 60 hertz; {BARE}: .to("1 / s").magnitude; '
         "1 Hz is 6.2832 rad/s as an angular rate"),
        (lambda: gb.PointMass(0.1, 0.1, offset=(0, Metres(1), 0)), f"offset[1] is 1.0; {BARE}"),
        (lambda: gb.constant("20 mm"), "level is '20 mm'; give numbers in SI"),
        (lambda: gb.Material(2700, "70"), 'youngs_modulus "70" has no unit; '
         'add a unit, such as "70 GPa", or write the bare number 70 for Pa'),
        (lambda: gb.Hub(radius=0.5, rate="60 mm"), 'rate "60 mm" is a length; '
         'expected an angular rate, such as "3 rad/s"'),
        (lambda: gb.Hub(radius=0.5, rate=60 * UNITS.mm), 'rate "60.0 mm" is a length; '
         'expected an angular rate, such as "3 rad/s"'),
        (lambda: gb.Load(distributed=(0, 0, "5 N")), 'distributed[2] "5 N" is a force; '
         'expected a force per length, such as "20 N/m"'),
        (lambda: sliding(stiffness={"displacement": "2 N m/rad"}), 'stiffness.displacement "2 N m/rad" is a rotational '
         'stiffness; expected a stiffness, such as "1e6 N/m"'),
        (lambda: law(limit=[2.0, "3 N"]), 'limit[1] "3 N" is a force; expected a torque, such as "200 N m"'),
        (lambda: gb.Flight(z=6 * UNITS.g), 'z "6.0 gram" is a mass; expected an acceleration, such as "6 g"'),
        (lambda: gb.Flight(z=6.0).base("noon"), "t is 'noon'; give numbers"),
        (lambda: gb.Flight(z=6.0).base(np.array(["5"])), 't[0] "5" has no unit; '
         'add a unit, such as "16 s", or write the bare number 5 for s'),
    ],
)  # fmt: skip
def test_how_a_unit_is_refused(call: Callable[[], Any], words: str) -> None:
    with pytest.raises(gb.InputError) as refused:
        call()
    assert str(refused.value) == words
