"""Entries of a scenario's text written, added and removed: the data change so, and every other line stays."""

from __future__ import annotations

import json
import tomllib
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gbeam import InputError
from gbeam.scenario import Path, template, with_entry, without_entry

LAYOUT = """\
# of the file
title = "µ"  # of the title

[beam]  # of the beam
section.width = "20 mm" # dotted
masses = [
  { at = 1, mass = "1 kg" },  # the first
  { at = 2 },
]
empty = {}
# below the beam

# of the flight
[motion.flight]
kind = "flight"
[motion.flight.acceleration.z]
terms = [ { profile = "constant" }, { profile = "sine" } ]

[[beam.loads]]
at = 1
[beam.loads.force]
z = 1
[[beam.loads]] # the second
at = 2 # end"""
TEXTS = {
    "layout": LAYOUT,
    "windows": LAYOUT.replace("\n", "\r\n"),
    "flight": template("flight"),
    "hub": template("hub"),
}


def _paths(node: Any, path: Path = ()) -> list[Path]:
    """Every entry, and one more of each table and list."""
    if isinstance(node, dict):
        inside = [each for key, value in node.items() for each in _paths(value, (*path, key))]
        deep = [(*path, "new", "deep.key")] if isinstance(node.get("new", {}), dict) else []
        return [path, *inside, (*path, "new"), *deep]
    if isinstance(node, list) and all(isinstance(each, dict) for each in node):
        return [path, *(each for i, value in enumerate(node) for each in _paths(value, (*path, i))), (*path, len(node))]
    return [path]


def _missing(node: Any, path: Path) -> bool:
    for step in path:
        if not (step < len(node) if isinstance(step, int) else isinstance(node, dict) and step in node):
            return True
        node = node[step]
    return False


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_every_entry_is_written_and_removed(text: str) -> None:
    data, comments = tomllib.loads(text), [part for line in text.splitlines() for part in line.split("#")[1:]]
    for path in _paths(data)[1:]:
        value = {"at": 3} if isinstance(path[-1], int) else 'with "quotes"'
        changed = with_entry(text, path, value)  # which reads back: it is refused otherwise
        assert changed.count("\r") in (0, changed.count("\n"))
        if _missing(data, path):
            assert all(comment in changed for comment in comments)
            assert len(set(text.splitlines()) - set(changed.splitlines())) <= 1
            back = tomllib.loads(without_entry(changed, path[:-1] if "deep.key" in path else path))
            assert back == data
        else:
            assert _missing(tomllib.loads(without_entry(text, path)), path) or isinstance(path[-1], int)


@given(st.data())
@settings(max_examples=30)
def test_edits_one_after_the_other(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from([LAYOUT, template("hub")]))
    for _ in range(3):
        written = tomllib.loads(text)
        path = data.draw(st.sampled_from(_paths(written)[1:]))
        if _missing(written, path) or data.draw(st.booleans()):
            value = {"at": 1} if isinstance(path[-1], int) else data.draw(st.sampled_from([1, "x", {"a": "1"}, {}]))
            text = with_entry(text, path, value)
        else:
            text = without_entry(text, path)


def test_comments_stay_where_they_are() -> None:
    changed = with_entry(LAYOUT, ("beam", "length"), "1 m")
    assert changed == LAYOUT.replace("empty = {}\n", 'empty = {}\nlength = "1 m"\n')
    changed = with_entry(LAYOUT, ("beam", "masses", 2), {"at": 3})
    assert changed == LAYOUT.replace("  { at = 2 },\n", "  { at = 2 },\n  { at = 3 },\n")
    changed = without_entry(LAYOUT, ("motion", "flight"))
    assert "# of the flight" in changed and "kind" not in changed and "terms" not in changed
    changed = without_entry(LAYOUT, ("beam", "loads", 1))
    assert changed == LAYOUT.split("\n[[beam.loads]] # the second")[0]
    changed = with_entry(LAYOUT, ("motion", "slew"), {"kind": "hub"})
    assert changed == LAYOUT.replace("[[beam.loads]]\n", '[motion.slew]\nkind = "hub"\n\n[[beam.loads]]\n', 1)


def test_json_is_laid_out_anew() -> None:
    text = json.dumps({"beam": {"length": 1}})
    assert json.loads(with_entry(text, ("beam", "masses", 0), {"at": 1})) == {
        "beam": {"length": 1, "masses": [{"at": 1}]}
    }
    assert json.loads(without_entry(text, ("beam", "length"))) == {"beam": {}}


@pytest.mark.parametrize("path", [("beam", "nothing"), ("nothing",), ("beam", "masses", 7), ("title", "x")])
def test_what_is_not_there_is_not_removed(path: Path) -> None:
    with pytest.raises(InputError, match="is not written in the scenario"):
        without_entry(LAYOUT, path)


@pytest.mark.parametrize("path", [("title", "x"), ("beam", "masses", 9), ("beam", 0)])
def test_what_has_no_place_is_refused(path: Path) -> None:
    with pytest.raises(InputError, match="cannot be changed here; change the text"):
        with_entry(LAYOUT, path, 1)
