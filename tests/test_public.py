"""One list of public names: what runs, what type checkers see, and what is documented."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

import gbeam
from gbeam import constants
from gbeam.constants import Verb
from gbeam.integrate import SCHEMES
from gbeam.mechanics import JOINT_KINDS as JOINTS
from gbeam.mechanics import MODEL_KINDS as MODELS
from gbeam.motion import INVERSES, MOUNTINGS, UNITS
from gbeam.questions import QUESTIONS, Options
from gbeam.results import Result
from gbeam.scenario import PARAMETERS
from gbeam.structure import SHAPES, Dimensions

SOURCE = Path(gbeam.__file__)
STUB = ast.parse(SOURCE.with_suffix(".pyi").read_text(encoding="utf-8")).body
IMPORTS = [(node.module, alias) for node in STUB if isinstance(node, ast.ImportFrom) for alias in node.names]
HOMES = {alias.name: f"gbeam.{module}" for module, alias in IMPORTS}


def test_the_stub_has_every_public_name() -> None:
    assert all(alias.asname == alias.name for _, alias in IMPORTS)  # what is not imported as itself is private
    assert dir(gbeam) == gbeam.__all__ == sorted(HOMES)
    assert SOURCE.with_name("py.typed").exists()


@pytest.mark.parametrize("name", gbeam._FORMER)
def test_former_names_warn_and_are_the_new_ones(name: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"gbeam.{name} is now gbeam.{gbeam._FORMER[name]}"):
        assert getattr(gbeam, name) is getattr(gbeam, gbeam._FORMER[name])
    assert name not in gbeam.__all__


@pytest.mark.parametrize("name", gbeam.__all__)
def test_every_name_is_documented(name: str) -> None:
    value = getattr(gbeam, name)
    if not callable(value):
        assert name == "machines" and set(value) >= {"human-7.6m", "specimen-3.3m", "large-15m"}
        return
    assert value.__module__ == HOMES[name]
    text = inspect.getdoc(value)
    assert text and text.splitlines()[0].partition("  #")[0].endswith((".", ":"))  # a citation may follow
    if not (isinstance(value, type) and issubclass(value, Exception)):
        signature = inspect.signature(value)
        named = [each for each in signature.parameters.values() if each.kind is not each.VAR_KEYWORD]
        assert not named or "Parameters\n----------" in text, name
        # What every result has is documented once.
        documented = _documented(text) | (_documented(inspect.getdoc(Result) or "") if _is_result(value) else set())
        assert [each.name for each in named if each.name not in documented] == [], name


@pytest.mark.parametrize("name", [name for name in gbeam.__all__ if isinstance(getattr(gbeam, name), type)])
def test_every_argument_of_every_method_is_documented(name: str) -> None:
    """Among its parameters, or in its one line: there or where the method is declared."""
    kind = getattr(gbeam, name)
    for method, function in inspect.getmembers(kind, callable):
        if method.startswith("_") or not str(getattr(function, "__module__", "")).startswith("gbeam"):
            continue
        declared = [inspect.getdoc(vars(base)[method]) or "" for base in kind.__mro__ if method in vars(base)]
        text = "\n\n".join(declared)
        named = [
            each.name for each in inspect.signature(function).parameters.values() if each.kind is not each.VAR_KEYWORD
        ]
        known = set().union(*map(_documented, declared), re.findall(r"`(\w+)`", text), ("self", "cls"))
        assert text and [each for each in named if each not in known] == [], f"{name}.{method}"


def _is_result(value: object) -> bool:
    return isinstance(value, type) and issubclass(value, Result)


def _documented(text: str) -> set[str]:
    section = text.partition("Parameters\n----------\n")[2].split("\n\n")
    lines = [line for part in section for line in part.splitlines() if line and not line.startswith(" ")]
    return {name.strip(" *") for line in lines for name in line.partition(":")[0].split(",")}


def test_words_to_choose_from_are_those_that_are_registered() -> None:
    """Type checkers know the names that run: of every registry that says more of each name than that it is one."""
    options: dict[str, Any] = {}
    for question in QUESTIONS.values():
        for name, each in question.options.items():
            kind = each.type | str if each.kind else each.type
            options[name] = options[name] | kind if name in options else kind
    dimensions = [name for shape in SHAPES.values() for name in shape.required + shape.optional]
    assert get_type_hints(Options) == options
    assert list(Dimensions.__annotations__) == list(dict.fromkeys(dimensions))
    assert {quantity: tuple(units) for quantity, units in UNITS.items()} == {
        "acceleration": get_args(constants.AccelerationUnit),
        "rate": get_args(constants.RateUnit),
        "time": get_args(constants.TimeUnit),
    }
    for names, registry in {
        Verb: QUESTIONS,
        constants.JointKind: JOINTS,
        constants.Coordinate: {name for kind in JOINTS.values() for name in kind.value_names},
        constants.Rate: {name for kind in JOINTS.values() for name in (*kind.value_names, *kind.names_in("rate"))},
        constants.SectionShape: SHAPES,
        constants.Integrator: SCHEMES,
        constants.Mounting: MOUNTINGS,
        constants.InverseName: INVERSES,
        constants.MachineName: gbeam.machines,
        constants.ModelKind: MODELS,
        constants.Parameter: dict.fromkeys(name for takes in PARAMETERS.values() for name in takes),
    }.items():
        assert sorted(get_args(names)) == sorted(registry)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = gbeam.nothing


def test_importing_is_light() -> None:
    heavy = ("jax", "numpy", "scipy", "matplotlib")
    code = f"import sys, gbeam; dir(gbeam); print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
