"""The page of how fast gbeam is: as the record of the measurements is now."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_the_committed_page_is_that_of_the_record() -> None:
    pytest.importorskip("exudyn")
    words = [sys.executable, str(ROOT / "benchmarks" / "reach.py"), "--markdown"]
    page = subprocess.run(words, check=True, capture_output=True, encoding="utf-8").stdout
    assert (ROOT / "docs" / "speed.md").read_text(encoding="utf-8") == page, "make docs writes it"
