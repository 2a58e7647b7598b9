"""A scenario that is right, and the helper that all tests of wrong ones share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from gbeam.scenario import Diagnostic, ScenarioError, build, loads

FLIGHT = """\
title = "test"
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
masses = [ { at = "200 mm", mass = "0.1 kg" } ]
[model]
kind = "FOAM"
modes = { axial = 1, y = 1, z = 1 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "6 g" } }
[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "150 mm"
inverse = "flat"
gravity = false
[motion.slew]
kind = "hub"
radius = "0.5 m"
rate = { profile = "smooth-step", level = "60 rpm", duration = "2 s" }
[response]
duration = "4 s"
"""


@pytest.fixture
def text() -> str:
    """The text of a scenario that is right, with all three kinds of motion."""
    return FLIGHT


@pytest.fixture
def errors(tmp_path: Path) -> Callable[..., tuple[Diagnostic, ...]]:
    """Return what is wrong with a text; `building` if only the objects of the core notice."""

    def find(text: str, *, building: bool = False) -> tuple[Diagnostic, ...]:
        with pytest.raises(ScenarioError) as caught:
            scenario = loads(text, "s.toml", folder=tmp_path)
            assert building, "loads without an error"
            build(scenario)
        assert str(caught.value) == "\n".join(map(str, caught.value.diagnostics))
        return caught.value.diagnostics

    return find


@pytest.fixture
def refused(errors: Callable[..., tuple[Diagnostic, ...]]) -> Callable[..., None]:
    """Assert that a scenario with one thing changed is refused, once, at its place."""

    def check(old: str, new: str, path: str, message: str, hint: str, caret: str, *, building: bool = False) -> None:
        """`old` is replaced by `new`; the carets are to stand under `caret`."""
        assert FLIGHT.count(old) == 1, f"{old!r} is not in the scenario once"
        text = FLIGHT.replace(old, new)
        found = errors(text, building=building)
        assert len(found) == 1, "\n".join(map(str, found))
        (it,) = found
        assert it.path == path
        # The core's words are tested where they are said.
        assert it.message.startswith(message) if building else it.message == message
        assert hint in it.hint
        _assert_place(it, text, caret)

    return check


def _assert_place(it: Diagnostic, text: str, caret: str) -> None:
    assert it.line is not None and it.column is not None and it.end is not None
    line = text.split("\n")[it.line - 1]
    assert it.source_line == line
    assert line[it.column - 1 : it.end - 1] == caret
    head, excerpt, carets, *hint = str(it).split("\n")
    assert head == f"s.toml:{it.line}:{it.column}: {it.path}: {it.message}"
    margin = excerpt.index("|") + 2
    assert excerpt[margin:] == line
    assert carets[margin:] == " " * (it.column - 1) + "^" * len(caret)
    assert hint == [" " * (margin - 2) + f"= {it.hint}"]
