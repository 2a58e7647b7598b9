"""Scenarios that compute in a second, in the current folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..calling import gbeam, with_figures
from ..scenarios import FREE_HUB, UNJUDGED

__all__ = ["gbeam", "with_figures"]


@pytest.fixture
def fast(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A flight and a centrifuge."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "fast.toml"
    file.write_text(UNJUDGED)
    return file


@pytest.fixture
def hub(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A free hub."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "hub.toml"
    file.write_text(FREE_HUB)
    return file
