"""The reference page of the scenario file: as the schema is now, and with every key."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from gbeam.cli import main
from gbeam.guards import KINDS
from gbeam.scenario import Coordinates, Environments, Table, fields_of, reference

PAGE = Path(__file__).parents[2] / "docs" / "scenario.md"


def tables(of: type[Table] = Table) -> Iterator[type[Table]]:
    """Every table that a scenario may hold and that has a section: not classes that others only build on, nor tables
    of a joint's coordinates, which stand in one line.
    """
    if issubclass(of, (Environments, Coordinates)):
        return
    inner = [table for table in of.__subclasses__() if not table.__pydantic_generic_metadata__["args"]]
    for table in inner:
        yield from tables(table)
    if not inner:  # a profile of one quantity is that of any
        yield of


@pytest.fixture(scope="module")
def page() -> str:
    return reference()


def test_the_committed_page_is_that_of_the_schema(capsys: pytest.CaptureFixture[str], page: str) -> None:
    assert main(["schema", "--markdown"]) == 0
    assert capsys.readouterr().out == page
    assert PAGE.read_text(encoding="utf-8") == page, "make docs writes it"


@pytest.mark.parametrize("table", list(tables()), ids=lambda table: table.__name__)
def test_every_key_is_there(table: type[Table], page: str) -> None:
    words = table.__doc__ or ""
    section = next(part for part in page.split("\n### ") if f"\n\n{words}\n" in part)
    for key, field in fields_of(table).items():
        (row,) = [line for line in section.splitlines() if line.startswith(f"| `{key}` | ")]
        assert row.endswith(f" | {field.description} |")
        assert ("| required |" in row) is field.is_required()


def test_quantities_have_units_and_signs(page: str) -> None:
    for name, kind in KINDS.items():
        assert f'| {name} | {kind.unit or "–"} | `"{kind.example}"` |' in page
    assert "| `arm` | length in m, positive | – |" in page
    assert '| `step` | time in s, positive, or `"auto"` | `"auto"` |' in page
    assert "| `jerk` | its rate of change, positive | required |" in page
    assert "| `gravity` | list of 3: acceleration in m/s^2 | – |" in page
