"""A board on rails by the command line: reactions by their names, and what it cannot stand on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import gbeam as gb

from ..files import opened

Call = Callable[..., Any]
BOARD = "examples/board_on_rails.toml"
SHORT = "--set", "motion.flight.record.to=0.2 s", "--set", "response.estimate=false"


def test_reactions_are_results_by_their_names(gbeam: Call, tmp_path: Path) -> None:
    answer = gbeam("run", BOARD, *SHORT, "--out", tmp_path, "--json")
    assert answer.status == 0
    loads = answer.json["motions"]["flight"]["bodies"]["board"]["loads"]
    assert [each["name"] for each in loads["supports"]] == ["plug", "left_rail", "right_rail"]
    assert [each["at"] for each in loads["supports"]] == pytest.approx([0.0, 0.08, 0.08])
    result = opened(tmp_path / "result.nc")["motions/flight"]
    largest = abs(result["board_support_force"].values[..., 2]).max(axis=0)
    told = [each["force"]["z"]["max_abs"] for each in loads["supports"]]
    assert told == pytest.approx(largest, rel=1e-2) and min(told) > 0.1
    assert [str(name) for name in result["board_support_names"].values] == ["plug", "left_rail", "right_rail"]
    assert "support at left_rail: " in gbeam("run", BOARD, *SHORT).out
    table = gbeam("static", BOARD, "--at", "0.1 s").out
    assert "Of the supports on the body, axes of the root" in table and "  right_rail  " in table


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ('bodies.board.supports[0].at="socket"', "is 'socket', which is no group of the mesh"),
        ('bodies.board.supports[0].holds=["x", "rz"]', "holds rz at plug, where nothing moves so"),
        ('bodies.board.supports[1].holds=["z"]', ""),
        ('bodies.board.supports[1].at=["0 mm"]', "bodies.board.supports[1].at"),
    ],
)
def test_what_a_board_cannot_stand_on_is_told_at_its_place(change: str, words: str, gbeam: Call) -> None:
    answer = gbeam("check", BOARD, "--set", change)
    assert (answer.status == 0) == (not words) and words in answer.err
    assert not words or "bodies.board.supports" in answer.err


def test_what_supports_of_a_mesh_hold_is_said_before_a_run() -> None:
    described = gb.describe(gb.read_scenario(BOARD))
    assert described.bodies["board"].supports == {
        "plug": "holds x z",
        "left_rail": "holds y z",
        "right_rail": "holds z, spring y",
    }
