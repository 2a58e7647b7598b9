"""Results made by hand."""

import pytest

from ..plots.conftest import study

__all__ = ["study"]


@pytest.fixture(autouse=True)
def one_date(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every result is written at the same time."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1750000000")
