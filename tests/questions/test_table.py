"""The table of questions by kinds of specimen is what asking gives, and a reason is one of physics."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from tests.questions.table import Table, asked_all, page_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "questions.md"
# Words of the reasons that are no fault of the program's: that nothing deforms, turns, is stressed, or is held.
PHYSICS = (
    "is rigid", "is of what deforms", "no beam, whose model could be another", "no angle that turns",
    "no body is a beam or a mesh", "held by nothing that resists a load", "a place is judged by what rests",
    "no surface to show", "no body deforms", "has no load that acts",
)  # fmt: skip
_table = cache(asked_all)
pytestmark = pytest.mark.slow


@pytest.fixture
def table(reading_in_process: None) -> Table:
    """Every question, asked once of every kind of specimen."""
    return _table()


def test_the_page_says_what_asking_gives(table: Table) -> None:
    assert PAGE.read_text(encoding="utf-8") == page_of(table), "python -m tests.questions.table > docs/questions.md"


def test_what_is_not_answered_has_a_reason_of_physics(table: Table) -> None:
    reasons = {
        (name, kind): each.reason for name, cells in table.items() for kind, each in cells.items() if each.reason
    }
    assert not {cell: reason for cell, reason in reasons.items() if not any(words in reason for words in PHYSICS)}
    for words in ("one beam", "needs a beam", "Error:", "System"):
        assert not [cell for cell, reason in reasons.items() if words in reason]
