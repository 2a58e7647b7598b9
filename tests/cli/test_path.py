"""gbeam path: a strip that snaps in a turn, in words, JSON, files and on a page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ..files import opened

Call = Callable[..., Any]
STRIP = "examples/snapping_strip.toml"
GROWN = "--vary", "motion", "--at", "0.5 s", "--to", "1.2"


def test_a_strip_that_snaps_is_told_drawn_and_kept(gbeam: Call, tmp_path: Path) -> None:
    """The numbers that docs/howto/held_at_both_ends.md states."""
    answer = gbeam("path", STRIP, *GROWN, "--out", tmp_path, "--report", "--json")
    assert answer.status == 0
    snaps, back = answer.json["critical"]
    assert [snaps["kind"], back["kind"]] == ["limit point"] * 2
    assert snaps["factor"] == pytest.approx(1.096, abs=5e-4) and back["factor"] == pytest.approx(0.1357, abs=5e-5)
    assert max(snaps["errors"]["total"], back["errors"]["total"], answer.json["errors"]["total"]) < 0.01
    page = (tmp_path / "path.html").read_text(encoding="utf-8")
    assert "limit point at 1.096 times the motion" in page
    again = gbeam("report", tmp_path / "path.json", "--out", tmp_path / "again.html")
    assert again.status == 0


def test_its_path_is_a_file(tmp_path: Path) -> None:
    import gbeam as gb

    case = gb.read_scenario(STRIP)
    path = gb.equilibrium_path(case.subject, case.motions["turn"], 0.5, vary="motion", upper=1.5, errors=False)
    path.save(tmp_path / "path.nc")
    kept = opened(tmp_path / "path.nc")
    assert kept["step"].values == pytest.approx(path.factor)
    assert kept["displacement"].values == pytest.approx(path.displacement)
    assert np.array_equal(kept["stable"].values.astype(bool), path.stable)
    assert not path.stable.all() and path.stable[[0, -1]].all()


def test_what_has_no_path_is_told(gbeam: Call) -> None:
    answer = gbeam("path", STRIP)
    assert answer.status == 2
    assert "has no load that acts" in answer.err and "vary the motion" in answer.err
    answer = gbeam("path", STRIP, "--to", "-1")
    assert answer.status == 2 and "give a value above zero" in answer.err
    answer = gbeam("path", STRIP, "--vary", "acceleration")
    assert answer.status == 2 and "motion" in answer.err
    answer = gbeam("path", "examples/swing_platform.toml", "--vary", "motion")
    assert answer.status == 1 and "something is free to move: hold it" in answer.err
    answer = gbeam("path", STRIP, "--vary", "motion", "--at", "0 s")
    assert answer.status == 2 and "does nothing at 0 s" in answer.err
