"""Places of keys and values in the text."""

from __future__ import annotations

import json

from gbeam.scenario.text.locate import locate_json, locate_toml
from gbeam.scenario.values.paths import Path

TOML = """\
title = "é" # comment
[beam]
a.b = 1
"q é" = "x"
'lit' = [ { at = 1, deep.er = 2 }, # comment
  { at = [3, 4] } ]
[[list.of]]
y = 5
[[list.of]]
y = 6
[list.of.below]
z = 7
[beam."k k".c]
d = 8
multi = \"\"\"
text\"\"\"
"""


def _cut(text: str, path: Path, *, is_json: bool = False) -> tuple[str, str]:
    """Text at the key and at the value of `path`."""
    place = (locate_json if is_json else locate_toml)(text)[path]
    lines = text.split("\n")
    key, value = ((lines[s.line - 1])[s.column - 1 : s.end - 1] for s in (place.key, place.value))
    return key, value


def test_toml() -> None:
    expected: dict[Path, tuple[str, str]] = {
        ("title",): ("title", '"é"'),
        ("beam",): ("beam", "beam"),
        ("beam", "a"): ("a", "1"),
        ("beam", "a", "b"): ("b", "1"),
        ("beam", "q é"): ('"q é"', '"x"'),
        ("beam", "lit"): ("'lit'", "[ { at = 1, deep.er = 2 }, # comment"),
        ("beam", "lit", 0): ("{ at = 1, deep.er = 2 }", "{ at = 1, deep.er = 2 }"),
        ("beam", "lit", 0, "at"): ("at", "1"),
        ("beam", "lit", 0, "deep", "er"): ("er", "2"),
        ("beam", "lit", 1, "at"): ("at", "[3, 4]"),
        ("beam", "lit", 1, "at", 1): ("4", "4"),
        ("list", "of"): ("of", "of"),
        ("list", "of", 0, "y"): ("y", "5"),
        ("list", "of", 1, "y"): ("y", "6"),
        ("list", "of", 1, "below", "z"): ("z", "7"),
        ("beam", "k k"): ('"k k"', '"k k"'),
        ("beam", "k k", "c", "d"): ("d", "8"),
        ("beam", "k k", "c", "multi"): ("multi", '"""'),
    }
    for path, cut in expected.items():
        assert _cut(TOML, path) == cut, path
    assert locate_toml(TOML)["list", "of", 1].key.line == 9
    assert locate_toml(TOML)["beam",].key.line == 2


def test_json() -> None:
    text = json.dumps({"a b": [1, {"c\n": True}], "é": {"d": None}}, indent=1)
    assert _cut(text, ("a b", 0), is_json=True) == ("1", "1")
    assert _cut(text, ("a b",), is_json=True) == ('"a b"', "[")
    assert _cut(text, ("a b", 1, "c\n"), is_json=True) == ('"c\\n"', "true")
    assert _cut(text, ("é", "d"), is_json=True) == ('"d"', "null")


def test_json_on_one_line() -> None:
    text = '{"a": [[], {}, 1e+16, NaN], "b": {"c": "x\\"]}"}, "d": [ ]}'
    for path, cut in {
        ("a",): "[[], {}, 1e+16, NaN]",
        ("a", 3): "NaN",
        ("b", "c"): '"x\\"]}"',
        ("d",): "[ ]",
    }.items():
        assert _cut(text, path, is_json=True)[1] == cut


def test_toml_values_of_every_kind() -> None:
    values = [
        "1e+16",
        "-inf",
        "nan",
        "0xFF",
        "1_000",
        "2024-01-01",
        "07:32:00",
        "'a\\'",
        '"\\U0001F600"',
        "[]",
        "{}",
        "[1,]",
        "true",
    ]
    text = "\n".join(f"k{i} = {value}" for i, value in enumerate(values))
    for i, value in enumerate(values):
        assert _cut(text, (f"k{i}",)) == (f"k{i}", value)


def test_what_the_grammar_does_not_know_is_left_out() -> None:
    places = locate_toml("a = 1\nb = { c = 1,\n\n d = \\ }\n")
    assert places["a",].value.line == 1
