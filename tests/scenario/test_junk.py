"""Whatever is put in the place of whatever: a scenario loads, or is refused with places that exist."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from gbeam.scenario import ScenarioError, loads

FULL = """\
title = "test"
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = ["4 mm", "3 mm"], stations = [0, "300 mm"] }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = [0.01]
masses = [ { at = 0.2, mass = "0.1 kg", inertia = { x = 1, y = 1, z = 1 }, offset = [0, 0, 0] } ]
[model]
kind = "FOAM"
modes = { axial = 1, y = 1, z = 1 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "sum", terms = [ { profile = "table", times = [0, 1], values = [1, 2] } ] } }
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
inertia = 1
torque = { profile = "sine", amplitude = "6 N m", duration = "2 s" }
[response]
duration = "4 s"
"""
Path = tuple[str | int, ...]


def _paths(node: Any, path: Path = ()) -> Iterator[Path]:
    yield path
    for key, value in node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ():
        yield from _paths(value, (*path, key))


PATHS = list(_paths(tomllib.loads(FULL)))[1:]
WORDS = [
    "sum",
    "table",
    "flight",
    "hub",
    "general",
    "tube",
    "list",
    "one",
    "exact",
    "SFOAM",
    "[key]",
    "kind",
    "3 m",
    "",
]
JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.sampled_from(WORDS) | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(WORDS), inner, max_size=3),
    max_leaves=4,
)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(PATHS), JUNK, st.booleans()), min_size=1, max_size=2))
def test_junk(changes: list[tuple[Path, Any, bool]]) -> None:
    data = tomllib.loads(FULL)
    for path, junk, beside in changes:
        here: Any = data
        try:
            for step in path[:-1]:
                here = here[step]
            here["unknown" if beside and isinstance(here, dict) else path[-1]] = junk
        except (KeyError, IndexError, TypeError):
            continue  # the first change took the second one's place away
    try:
        loads(json.dumps(data, indent=1))
    except ScenarioError as error:
        assert error.diagnostics
        assert all(it.line and it.column and it.message and "{" not in it.path for it in error.diagnostics)
        assert "{value}" not in str(error) and "Input should" not in str(error)
