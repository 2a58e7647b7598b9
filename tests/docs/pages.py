"""The pages' code blocks, run as a reader would type them: in order, page by page.

- ``python``: executed, in one namespace per page; a ``text`` block right after it is what it prints.
- ``console``: lines after ``$ `` are commands, the other lines what they print; ``$ echo $?`` prints the exit status,
  which is 0 where it is not shown.
- ``sh``: commands whose output is not shown.
- ``toml``: a whole scenario, saved under the name in its first comment; or a part, checked beside the F-16 example,
  that of a system beside the pointing satellite.

An ellipsis in an expected output stands for anything.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest import mock

from gbeam.progress import INTERVAL
from gbeam.scenario import loads

from ..calling import main

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
RUN = ("python", "console", "sh", "toml")
OF_SYSTEMS = {"bodies", "joints", "forces", "controllers", "system"}
NOT_CODE = ("text", "{")  # expected output, and directives of the site
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass(frozen=True)
class Block:
    """A fenced block and its language."""

    language: str
    text: str
    line: int


def blocks(page: Path) -> list[Block]:
    """All fenced blocks of a page."""
    text = page.read_text(encoding="utf-8")
    answer = re.finditer(r"^```([^\n]*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    return [Block(each[1], each[2], text.count("\n", 0, each.start()) + 1) for each in answer]


@dataclass
class Reader:
    """Somebody who types what the pages say, in one folder; a command on an example's file is typed once only."""

    folder: Path
    answers: dict[str, tuple[int, str]] = field(default_factory=dict)
    status: int = 0
    services: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def read(self, page: Path) -> None:
        """Run a page's blocks; an AssertionError names the line. What it started ends with it."""
        try:
            self._read(page)
        finally:
            for service in self.services:
                service.kill()
                service.wait()
            self.services.clear()

    def _read(self, page: Path) -> None:
        names: dict[str, Any] = {}
        printed = ""
        for block in blocks(page):
            where = f"{page.relative_to(ROOT)}:{block.line}"
            if block.language == "python":
                printed = _executed(block.text, where, names)
            elif block.language == "text":
                check(block.text, printed, where)
            elif block.language in ("console", "sh"):
                for command, expected in commands(block):
                    self._type(command, expected, where)
            elif block.language == "toml":
                self._save(block.text, where)

    def _type(self, command: str, expected: str | None, where: str) -> None:
        if command == "echo $?":
            check(expected or "", str(self.status), where)
            self.status = 0
            return
        assert self.status == 0, f"{where}: the command before {command!r} ended in exit status {self.status}"
        words = shlex.split(command, comments=True)
        if words[0] == "dask":  # a scheduler or a worker, in a terminal of its own
            code = f"from distributed.cli.dask_{words[1]} import main; main()"
            quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
            self.services.append(subprocess.Popen([sys.executable, "-c", code, *words[2:]], cwd=self.folder, **quiet))
            return
        if words[0] != "gbeam":
            _exists(words, where)
            return
        if command not in self.answers or "examples/" not in command:
            self.answers[command] = _called(words[1:])
        self.status, printed = self.answers[command]
        if expected is None:
            assert self.status == 0, f"{where}: {command}\n{printed}"
        elif expected:
            check(expected, printed, f"{where}: {command}")

    def _save(self, text: str, where: str) -> None:
        name = re.match(r"# (\w+\.toml)\n", text)
        if name:
            (self.folder / name[1]).write_text(text, encoding="utf-8")
            loads(text, where, folder=self.folder, distributions=True)
        else:
            part = tomllib.loads(text)
            if {"bodies", "motion", "response"} <= part.keys():  # a whole scenario
                loads(text, where, folder=ROOT / "examples")
                return
            example = "pointing_satellite" if part.keys() & OF_SYSTEMS else "f16_8g_turn"
            base = tomllib.loads((ROOT / "examples" / f"{example}.toml").read_text(encoding="utf-8"))
            loads(json.dumps(_merged(base, part)), where, folder=ROOT / "examples")


def commands(block: Block) -> Iterator[tuple[str, str | None]]:
    """Commands of a block, each with what it prints; None where that is not shown."""
    if block.language == "sh":
        yield from ((line, None) for line in block.text.splitlines() if line.partition("#")[0].strip())
    else:
        parts = re.split(r"^\$ ", block.text, flags=re.MULTILINE)
        assert not parts[0].strip(), f"line {block.line}: begins without a command"
        for part in parts[1:]:
            command, _, printed = part.partition("\n")
            yield command, printed


def check(expected: str, printed: str, where: str) -> None:
    """Compare an output with the page's, whatever its white space."""
    if not doctest.OutputChecker().check_output(expected.strip(), printed.strip(), FLAGS):
        raise AssertionError(f"{where} expects\n{expected}\nbut gbeam prints\n{printed}")


def _executed(text: str, where: str, names: dict[str, Any]) -> str:
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(text, where, "exec"), names)
    return out.getvalue()


def _called(words: list[str]) -> tuple[int, str]:
    out = io.StringIO()
    # Progress, a line every few seconds, is there on slow machines only.
    silent = {INTERVAL: "100000"}
    with mock.patch.dict(os.environ, silent), contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = main(words)
    return status, out.getvalue()


def _exists(words: list[str], where: str) -> None:
    """True if a command that is not gbeam's is one that a reader has."""
    if words[0] == "make":
        targets = re.findall(r"^(\w[\w-]*):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
        assert set(words[1:]) <= set(targets), where
    elif words[0] == "python":
        assert (ROOT / words[1]).exists(), where
    else:
        assert words[0] in ("git", "cd", "export"), f"{where}: {words}"


def _merged(base: Any, part: Any) -> Any:
    if isinstance(base, dict) and isinstance(part, dict):
        return {**base, **{key: _merged(base.get(key), value) for key, value in part.items()}}
    return part
