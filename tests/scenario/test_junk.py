"""Whatever is put in the place of whatever: a scenario loads, or is refused with places that exist."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from gbeam.scenario import ScenarioError, loads

from ..scenarios import MANY_KINDS

Path = tuple[str | int, ...]


def _paths(node: Any, path: Path = ()) -> Iterator[Path]:
    yield path
    for key, value in node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ():
        yield from _paths(value, (*path, key))


PATHS = list(_paths(tomllib.loads(MANY_KINDS)))[1:]
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


@settings(max_examples=200)
@given(st.lists(st.tuples(st.sampled_from(PATHS), JUNK, st.booleans()), min_size=1, max_size=2))
def test_junk(changes: list[tuple[Path, Any, bool]]) -> None:
    data = tomllib.loads(MANY_KINDS)
    for path, junk, beside in changes:
        node: Any = data
        try:
            for step in path[:-1]:
                node = node[step]
            node["unknown" if beside and isinstance(node, dict) else path[-1]] = junk
        except (KeyError, IndexError, TypeError):
            continue  # the first change took the second one's place away
    try:
        loads(json.dumps(data, indent=1))
    except ScenarioError as error:
        assert error.diagnostics
        assert all(d.line and d.column and d.message and "{" not in d.path for d in error.diagnostics)
        assert "{value}" not in str(error) and "Input should" not in str(error)
