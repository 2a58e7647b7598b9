"""Every public function and class has an example that runs as it is printed."""

from __future__ import annotations

import doctest
import inspect
from pathlib import Path

import pytest

import gbeam

ROOT = Path(__file__).parents[2]
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
