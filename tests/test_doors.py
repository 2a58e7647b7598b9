"""Tests, validation and benchmarks read gbeam by its public names or by the doors of its rooms, never from inside."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

import gbeam

ROOT, PACKAGE = Path(__file__).parents[1], Path(gbeam.__file__).parent
SOURCES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for folder in ("tests", "validation", "benchmarks", "fuzz", "examples")
    for path in sorted((ROOT / folder).rglob("*.py"))
}
STUB = ast.parse((PACKAGE / "__init__.pyi").read_text(encoding="utf-8")).body
HOMES = {
    alias.name: f"gbeam.{node.module}" for node in STUB if isinstance(node, ast.ImportFrom) for alias in node.names
}
ROOMS = sorted(path.parent.name for path in PACKAGE.glob("*/__init__.pyi"))
MODULES = {
    ".".join(("gbeam", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
    for path in PACKAGE.rglob("*.py")
}
# Modules that are named from outside, and why: what is altered is an attribute of its module.
ALTERED = {
    "gbeam.analysis.accuracy.beam_theory": "its threshold is lowered",
    "gbeam.analysis.accuracy.looks": "its number of looks is raised",
    "gbeam.analysis.control.linearization": "the errors of poles are left out",
    "gbeam.analysis.describe": "fails on purpose",
    "gbeam.analysis.environments": "its runs fail on purpose",
    "gbeam.analysis.response.record": "its calls are counted",
    "gbeam.analysis.response.settings": "the number of kept steps is lowered",
    "gbeam.analysis.steady.static": "is broken on purpose",
    "gbeam.analysis.system.path": "must not be asked for a single state",
    "gbeam.app.access": "its limits are lowered",
    "gbeam.app.files": "its limits are lowered",
    "gbeam.app.jobs": "its command and its limits are replaced",
    "gbeam.app.server": "its server is replaced",
    "gbeam.arrays.jax_setup": "is imported for its effect: JAX with double precision and the records",
    "gbeam.cli.entry": "is replaced in a process of limited memory",
    "gbeam.cli.process": "its patience is shortened",
    "gbeam.guards.processes": "its limits are lowered, or its processes are replaced by calls",
    "gbeam.integrate.derivatives": "its tuned numbers are halved and doubled",
    "gbeam.integrate.linear": "its calls are counted",
    "gbeam.integrate.side_by_side": "its calls are counted",
    "gbeam.integrate.verdict": "its tuned numbers are halved and doubled",
    "gbeam.integrate.window": "its tuned numbers are halved and doubled",
    "gbeam.io.kept": "its limits are altered",
    "gbeam.motion.centrifuge.course": "its cache is emptied, and its coarse steps are left out",
    "gbeam.motion.records.record": "its readings of files are counted",
    "gbeam.numerics.minimise": "its solver is replaced",
    "gbeam.numerics.sparse": "its solver is replaced",
    "gbeam.plots.output": "figures are not written",
    "gbeam.scenario.load": "its limit of embedded files is lowered",
    "gbeam.solids.elements": "its shear factor is replaced",
    "gbeam.solids.mesh": "its calls are counted",
    "gbeam.solids.reading": "must not read a mesh that is kept",
    "gbeam.studies.evaluate": "its runs fail on purpose, or slowly",
    "gbeam.studies.journal": "its disk is full",
    "gbeam.studies.sweep": "its packets are made small",
    "gbeam.studies.workers": "its delays are shortened",
}
# Files whose texts are source of the package, or wrong on purpose.
WRITERS = {"tests/scenario/test_one_file.py", "tests/test_doors.py"}
IMPORT = re.compile(r"^\s*from (gbeam[\w.]*) import ([\w, ]+)|\bimport (gbeam\.[\w.]+)", re.MULTILINE)  # within a text


def references(source: str) -> Iterator[tuple[int, str]]:
    """Lines and full names of what a source, or code within its texts, imports from gbeam or alters by its path."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            for module, names, whole in IMPORT.findall(node.value.replace(";", "\n")):
                words = [name.split()[0] for name in names.split(",") if name.strip()]
                yield from ((node.lineno, f"{module}.{word}") for word in words)
                yield from [(node.lineno, whole)] * bool(whole)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if called in ("setattr", "import_module") and str(node.args[0].value).startswith("gbeam."):
                yield node.lineno, _module(node.args[0].value)


def _module(path: str) -> str:
    """Module that a dotted path begins with."""
    while path not in MODULES:
        path = path.rpartition(".")[0]
    return path


def door(room: str) -> dict[str, str]:
    """Names that the door of a room has, with the modules that they are in."""
    body = ast.parse((PACKAGE / room / "__init__.pyi").read_text(encoding="utf-8")).body
    return {alias.name: node.module or "" for node in body if isinstance(node, ast.ImportFrom) for alias in node.names}


DOORS = {room: door(room) for room in ROOMS}


def from_inside(source: str) -> Iterator[str]:
    """Names that a source reads from inside a room, and private ones, each with its line."""
    for line, name in references(source):
        if not name.startswith("gbeam.") or name in ALTERED:
            continue
        _, room, *inner = name.split(".")
        if any(word.startswith("_") for word in inner):
            yield f"{line}: {name} is private"
        elif room in DOORS and inner and (len(inner) > 1 or inner[0] not in DOORS[room]):
            yield f"{line}: {name} is inside a room: import it from gbeam.{room}, with a line in its __init__.pyi"


@pytest.mark.parametrize("file", sorted(SOURCES.keys() - WRITERS))
def test_nothing_is_read_from_inside_a_room(file: str) -> None:
    assert [f"{file}:{words}" for words in from_inside(SOURCES[file])] == []


@pytest.mark.parametrize(
    ("source", "word"),
    [
        ("from gbeam.results.parts import Base", "from gbeam.results,"),
        ("from gbeam.results import parts", "inside"),
        ("import gbeam.results.parts", "inside"),
        ("from gbeam.results import _hidden", "private"),
        ("code = 'import sys; from gbeam.results.parts import Base'", "inside"),
        ("patch.setattr('gbeam.results.parts.Base', None)", "inside"),
    ],
)
def test_what_is_read_from_inside_is_seen(source: str, word: str) -> None:
    (words,) = from_inside(source)
    assert word in words


@pytest.fixture(scope="module")
def named() -> set[str]:
    """Full names that all files read or alter."""
    return {name for source in SOURCES.values() for _, name in references(source)}


def test_what_is_altered_is_named(named: set[str]) -> None:
    assert ALTERED.keys() - named == set(), "leave them out of ALTERED"


@pytest.mark.parametrize("room", ROOMS)
def test_a_door_has_the_names_that_are_read(room: str, named: set[str]) -> None:
    """And each is what its module has, never a module of the same name, whatever was imported before."""
    unread = [name for name in DOORS[room] if f"gbeam.{room}.{name}" not in named]
    assert unread == [], f"leave them out of {room}/__init__.pyi"
    package = import_module(f"gbeam.{room}")
    assert dir(package) == sorted(DOORS[room])
    for name, module in DOORS[room].items():
        assert getattr(package, name) is getattr(import_module(f"gbeam.{room}.{module}"), name)
        assert HOMES.get(name) != f"gbeam.{room}.{module}", f"{name} is public: import it from gbeam"
