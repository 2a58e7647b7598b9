"""Wrong input is named once, on stderr, with its place; status 2, and JSON with --json."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Call = Callable[..., Any]


@pytest.mark.parametrize(
    "arguments",
    [
        ["run"],
        ["rnu", "a.toml"],
        ["run", "a.toml", "--bogus"],
        ["run", "a.toml", "--out"],
        ["new", "a.toml", "--kind", "x"],
    ],
    ids=" ".join,
)
def test_wrong_command_line(arguments: list[str], gbeam: Call) -> None:
    answer = gbeam(*arguments)
    assert answer.status == 2 and answer.out == ""
    assert answer.err.startswith("gbeam: ") and answer.err.count("\n") == 1
    repeated = gbeam(*arguments, "--json")
    assert repeated.status == 2
    assert repeated.json["error"][0]["message"] in repeated.err


@pytest.mark.parametrize("verb", ["run", "check"])
def test_wrong_scenario(verb: str, fast: Path, gbeam: Call) -> None:
    fast.write_text(fast.read_text(encoding="utf-8").replace('"300 mm"', '"300 mn"'), encoding="utf-8")
    answer = gbeam(verb, fast.name)
    assert answer.status == 2 and answer.out == ""
    assert answer.err.startswith("fast.toml:3:10: beam.length:")
    (error,) = gbeam(verb, fast.name, "--json").json["error"]
    assert (error["path"], error["line"], error["column"]) == ("beam.length", 3, 10)


def test_wrong_override(fast: Path, gbeam: Call) -> None:
    answer = gbeam("run", fast, "--set", "beam.lenght=1 m")
    assert answer.status == 2 and "--set beam.lenght=1 m" in answer.err


def test_no_such_file(gbeam: Call) -> None:
    assert gbeam("run", "none.toml", "--json").json["error"][0]["message"] == "there is no such file"


def test_what_the_core_refuses_has_its_place(fast: Path, gbeam: Call) -> None:
    """Only assembling the model can tell that two damping ratios do not fit its modes."""
    answer = gbeam("check", fast.name, "--set", "beam.damping_ratio=[0.01, 0.01, 0.01]")
    assert answer.status == 2
    assert "beam.damping_ratio" in answer.err


@pytest.mark.parametrize("verb", ["run", "check"])
def test_folder_that_cannot_be_made(verb: str, fast: Path, gbeam: Call) -> None:
    answer = gbeam(verb, fast, "--out", fast / "below")
    assert answer.status == 2 and answer.out == ""
    assert answer.err.startswith("gbeam: --out ") and "is not a folder" in answer.err
    assert gbeam(verb, fast, "--json", "--out", fast / "below").json["error"][0]["path"] == "--out"
