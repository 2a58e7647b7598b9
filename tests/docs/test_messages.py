"""The page of error messages quotes messages that gbeam has."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
SOURCE = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py"))
TABLES = [part for part in PAGE.split("\n\n") if part.startswith("| message |")]
ROWS = [row for table in TABLES for row in table.splitlines()[2:]]
MESSAGES = [message for row in ROWS for message in re.findall(r"`([^`]+)`", row.split("|")[1])]


def test_there_are_tables() -> None:
    assert len(TABLES) == 4 and len(MESSAGES) > 20


@pytest.mark.parametrize("message", MESSAGES)
def test_message_is_gbeams(message: str) -> None:
    """Its longest stretch between values stands in the source."""
    if message == '"300 kg" is a mass':  # put together from the name of a dimension; a block of the page prints it
        return
    stretch = max((part.strip() for part in message.split("…")), key=len)
    assert len(stretch) > 5 and stretch in SOURCE
