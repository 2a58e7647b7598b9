"""A flight and a centrifuge that are computed in a moment, and the command line."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..calling import gbeam, with_figures
from ..scenarios import UNJUDGED

__all__ = ["gbeam", "with_figures"]


@pytest.fixture
def fast(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The scenario, in the current folder."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "fast.toml"
    file.write_text(UNJUDGED, encoding="utf-8")
    return file
