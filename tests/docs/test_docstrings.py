"""Public docstrings have an example that runs as it is printed; all begin, and all names are, as a colleague would."""

from __future__ import annotations

import ast
import doctest
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import gbeam

ROOT = Path(__file__).parents[2]
FOLDERS = ("src", "tests", "examples", "benchmarks", "validation", "fuzz", "mutants", "docs", ".ci")
SOURCES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
VAGUE = {"it", "found", "made", "own", "given", "here", "there"}
OPENER = re.compile("(?:What|Those of|The same of|Whether|How|Why) ")
DESCRIBED = [name for name in gbeam.__all__ if callable(getattr(gbeam, name))]


@pytest.mark.parametrize("name", DESCRIBED)
def test_its_example_runs(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)  # where the examples lie
    text = inspect.getdoc(getattr(gbeam, name)) or ""
    test = doctest.DocTestParser().get_doctest(text, {"gb": gbeam}, name, None, None)
    assert test.examples, f"gb.{name} has no example"
    printed: list[str] = []
    failed, _ = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test, out=printed.append)
    assert not failed, "".join(printed)


def vague(source: str) -> Iterator[str]:
    """Names that say nothing, and docstrings that begin with neither a verb nor a thing, each with its line."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and OPENER.match(
            ast.get_docstring(node) or ""
        ):
            yield f"{getattr(node, 'lineno', 1)}: {(ast.get_docstring(node) or '').splitlines()[0]}"
        bound = isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id
        named = bound or getattr(node, "arg", "") or (isinstance(node, ast.FunctionDef) and node.name)
        if named in VAGUE and not isinstance(node, ast.keyword):
            yield f"{node.lineno}: {named}"  # type: ignore[attr-defined]


def test_names_and_docstrings_say_what_of() -> None:
    assert [f"{path}:{line}" for path in SOURCES for line in vague(path.read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize(
    "source",
    [
        "it = 1",
        "def f(given): 0",
        "def made(): 0",
        "class A:\n  'What it is.'",
        "'Whether so.'",
        "[here for here in x]",
    ],
)
def test_a_vague_one_is_seen(source: str) -> None:
    assert len([*vague(source)]) == 1 and not [*vague("'A thing.'\nf(given=found)")]
