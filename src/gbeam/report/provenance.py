"""Provenance of a result as JSON; and a result computed again."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from gbeam.results.facts import facts_of
from gbeam.results.provenance import Provenance
from gbeam.results.study import Reproduction

LISTED = 20  # differences in words


def to_json(provenance: Provenance) -> dict[str, Any]:
    """Provenance as JSON: the scenario's text, hashes and versions; of records not the bytes."""
    return facts_of(provenance.stated()[0])


def reproduction_json(again: Reproduction) -> dict[str, Any]:
    """Reproduction as JSON; a difference's size is null where the two cannot be compared."""
    return {
        "outcome": "reproduced" if again.reproduced else "not reproduced",
        "file": again.file,
        "compared": again.compared,
        "tolerance": again.tolerance,
        "differences": [asdict(each) for each in again.differences],
        "changed": {name: {"then": then, "now": now} for name, (then, now) in again.changed.items()},
    }


def reproduction_text(again: Reproduction) -> str:
    """Values compared, differences, and changes since."""
    if again.differences:
        extent = f"within {again.tolerance:g}" if again.reproduced else "NOT reproduced"
    else:
        extent = "the same to the last digit"
    lines = [f"{again.file}: {again.compared} values and arrays computed again: {extent}"]
    lines += [f"  {each}" for each in again.differences[:LISTED]]
    if len(again.differences) > LISTED:
        lines.append(f"  and {len(again.differences) - LISTED} more: see --json")
    lines += [f"  {name} was {then}, is {now}" for name, (then, now) in again.changed.items()]
    return "\n".join(lines)
