"""Scenarios to start from: those of `gbeam new`, and a flight with its record."""

from __future__ import annotations

from importlib.resources import files as resources
from importlib.resources.abc import Traversable
from pathlib import Path

from gbeam.app.files import regular, store
from gbeam.errors import InputError
from gbeam.scenario.template import template
from gbeam.scenario.text.revise import with_entry

_TEMPLATES = {"Flight and centrifuge": "flight", "Hub": "hub"}
_FLOWN = "F-16 turn of 8 g, with its record"
_SCENARIO, _RECORD = "f16_8g_turn.toml", "f16_8g_turn.csv"
NAMES = ("Flight and centrifuge", _FLOWN, "Hub")


def example(name: str, records: Path) -> str:
    """Return the text of an example; its record is put among those of a folder.

    Raises
    ------
    InputError
        If there is no such example, or no room for its record.
    """
    if name in _TEMPLATES:
        return template(_TEMPLATES[name])
    if name != _FLOWN:
        raise InputError("example", f"is {name[:100]!r}", f"choose of {', '.join(NAMES)}")
    record = _kept(_shipped(_RECORD).read_bytes(), records)
    return with_entry(_shipped(_SCENARIO).read_text(encoding="utf-8"), ("motion", "flight", "record", "file"), record)


def _shipped(name: str) -> Traversable:
    """A file of the examples: where the package is installed, or in the tree that it runs from."""
    packed = resources("gbeam.app") / "shipped" / name
    tree = Path(__file__).parents[3] / "examples"
    return packed if packed.is_file() else next(tree.rglob(name))


def _kept(content: bytes, records: Path) -> str:
    """Store a record, beside another of its name; return its name there."""
    for name in (_RECORD, f"example {_RECORD}"):
        try:
            if regular(records, name).read_bytes() == content:
                return name
        except InputError:  # is not there
            return store(records, name, content).name
    raise InputError(_RECORD, "is there already, and is another record", f"rename it in {records}")
