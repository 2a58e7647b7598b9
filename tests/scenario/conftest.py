"""A scenario that is right, and the helper that all tests of wrong ones share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from gbeam import InputError
from gbeam.scenario import Diagnostic, ScenarioError, build, loads, placed

from ..scenarios import EVERY_MOTION


@pytest.fixture
def text() -> str:
    """The text of a scenario that is right, with all three kinds of motion."""
    return EVERY_MOTION


@pytest.fixture
def errors(tmp_path: Path) -> Callable[..., tuple[Diagnostic, ...]]:
    """Return the errors in a text; `building` if only the objects of the core notice."""

    def collect(text: str, *, building: bool = False) -> tuple[Diagnostic, ...]:
        with pytest.raises(ScenarioError) as caught:
            scenario = loads(text, "s.toml", folder=tmp_path)
            assert building, "loads without an error"
            try:
                build(scenario)
            except InputError as error:
                raise placed(scenario, [error]) from None
        assert str(caught.value) == "\n".join(map(str, caught.value.diagnostics))
        return caught.value.diagnostics

    return collect


@pytest.fixture
def refused(errors: Callable[..., tuple[Diagnostic, ...]]) -> Callable[..., None]:
    """Assert that a scenario with one thing changed is refused, once, at its place."""

    def check(old: str, new: str, path: str, message: str, hint: str, caret: str, *, building: bool = False) -> None:
        """`old` is replaced by `new`; the carets are to stand under `caret`."""
        assert EVERY_MOTION.count(old) == 1, f"{old!r} is not in the scenario once"
        text = EVERY_MOTION.replace(old, new)
        diagnostics = errors(text, building=building)
        assert len(diagnostics) == 1, "\n".join(map(str, diagnostics))
        (diagnostic,) = diagnostics
        assert diagnostic.path == path
        # The core's words are tested where they are written.
        assert diagnostic.message.startswith(message) if building else diagnostic.message == message
        assert hint in diagnostic.hint
        _assert_place(diagnostic, text, caret)

    return check


def _assert_place(diagnostic: Diagnostic, text: str, caret: str) -> None:
    assert diagnostic.line is not None and diagnostic.column is not None and diagnostic.end is not None
    line = text.split("\n")[diagnostic.line - 1]
    assert diagnostic.source_line == line
    assert line[diagnostic.column - 1 : diagnostic.end - 1] == caret
    head, excerpt, carets, *hint = str(diagnostic).split("\n")
    assert head == f"s.toml:{diagnostic.line}:{diagnostic.column}: {diagnostic.path}: {diagnostic.message}"
    margin = excerpt.index("|") + 2
    assert excerpt[margin:] == line
    assert carets[margin:] == " " * (diagnostic.column - 1) + "^" * len(caret)
    assert hint == [" " * (margin - 2) + f"= {diagnostic.hint}"]
