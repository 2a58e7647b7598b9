"""Tables in words: side by side where there is room, else folded."""

from __future__ import annotations

import pytest

from gbeam.report.words import columns

HEADS = ["value", "was", "is", "unit"]
ROWS = [["beam.material.youngs_modulus", "7e+10", "6.9e+10", "Pa"], ["beam.length", "0.3", "0.31", "m"]]


def test_a_table_folds_on_a_narrow_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    wide = columns(HEADS, ROWS)
    assert len(wide) == 3 and len({len(line) for line in wide[1:]}) <= 2
    monkeypatch.setenv("COLUMNS", "40")
    folded = columns(HEADS, ROWS)
    assert max(map(len, folded)) <= 40
    assert folded[:4] == ["beam.material.youngs_modulus", "  was    7e+10", "  is     6.9e+10", "  unit   Pa"]
    words = " ".join(folded)
    assert all(cell in words for row in ROWS for cell in row)
