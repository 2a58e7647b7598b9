"""The how-to page's commands exist and its quick ones run."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from gbeam.cli import main

ROOT = Path(__file__).parents[2]
BLOCKS = re.findall(
    r"```sh\n(.*?)```", (ROOT / "docs" / "howto_flight_record.md").read_text(encoding="utf-8"), re.DOTALL
)
COMMANDS = [shlex.split(line)[1:] for block in BLOCKS for line in block.splitlines() if line.startswith("gbeam")]
SLOW = {"run", "plan", "place"}


CASES = [pytest.param(each, marks=[pytest.mark.slow] if each[0] in SLOW else [], id=each[0]) for each in COMMANDS]


@pytest.mark.parametrize("command", CASES)
def test_commands_run(command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = [str(ROOT / word) if word.startswith("examples/") else word for word in command]
    monkeypatch.chdir(tmp_path)
    assert main(given) == 0
