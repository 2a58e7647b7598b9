"""The command line called as a user does, in this process."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import entry_points
from typing import Any

import pytest

from gbeam.cli import FIGURES
from gbeam.progress import INTERVAL

(COMMAND,) = entry_points(group="console_scripts", name="gbeam")
main: Callable[[list[str]], int] = COMMAND.load()


@dataclass(frozen=True)
class Answer:
    """Answer of a call of the command line."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """Stdout as the one JSON object that it has to be."""
        return json.loads(self.out)


def spent() -> float:
    """Processor time of the processes that this one has run, s."""
    times = os.times()
    return times.children_user + times.children_system


@pytest.fixture
def gbeam(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Answer]:
    """Call the command line with its arguments; of progress, which there is on slow machines only, it says nothing."""
    monkeypatch.setenv(INTERVAL, "100000")

    def call(*arguments: object) -> Answer:
        status = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err
        return Answer(status, captured.out, captured.err)

    return call


@pytest.fixture
def with_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write files of figures, where a test is about them."""
    monkeypatch.delenv(FIGURES)
