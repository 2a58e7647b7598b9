"""Places of keys and values in the text."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path as File

import pytest

from gbeam.scenario import Path, Span, locate, template, walk

EXAMPLES = sorted((File(__file__).parents[2] / "examples").glob("*.toml"))

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


def _cut(text: str, path: Path) -> tuple[str, str]:
    """Text at the key and at the value of `path`."""
    place = locate(text)[path]
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
    assert locate(TOML)["list", "of", 1].key.line == 9
    assert locate(TOML)["beam",].key.line == 2


def test_json() -> None:
    text = json.dumps({"a b": [1, {"c\n": True}], "é": {"d": None}}, indent=1)
    assert _cut(text, ("a b", 0)) == ("1", "1")
    assert _cut(text, ("a b",)) == ('"a b"', "[")
    assert _cut(text, ("a b", 1, "c\n")) == ('"c\\n"', "true")
    assert _cut(text, ("é", "d")) == ('"d"', "null")


def test_json_on_one_line() -> None:
    text = '{"a": [[], {}, 1e+16, NaN], "b": {"c": "x\\"]}"}, "d": [ ]}'
    for path, cut in {
        ("a",): "[[], {}, 1e+16, NaN]",
        ("a", 3): "NaN",
        ("b", "c"): '"x\\"]}"',
        ("d",): "[ ]",
    }.items():
        assert _cut(text, path)[1] == cut


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


TEXTS = [
    TOML,
    *(path.read_text(encoding="utf-8") for path in EXAMPLES),
    template("flight"),
    template("hub"),
]


@pytest.mark.parametrize("text", TEXTS)
def test_text_at_every_place_reads_as_what_is_there(text: str) -> None:
    data = tomllib.loads(text)
    for written, read in [(text, tomllib.loads), (json.dumps(data), None), (json.dumps(data, indent=2), None)]:
        for path, value in walk(data, lambda node: node in ([], {})):
            key, cut = _cut(written, path)
            if isinstance(path[-1], str):
                name = next(iter(read(f"{key} = 1"))) if read else json.loads(key)
                assert name == path[-1]
            if not cut.startswith('"""'):
                assert (read(f"value = {cut}")["value"] if read else json.loads(cut)) == value


def test_inline_tables_of_several_lines() -> None:
    places = locate("a = 1\nb = { c = 1, # TOML 1.1\n\n d = 2, }\n")
    assert places["a",].value.line == 1
    assert places["b", "d"].value == Span(4, 6, 7)
