"""What a scenario's results say of where they come from."""

from __future__ import annotations

import hashlib
import json
import os
from functools import lru_cache
from pathlib import Path
from typing import Any

from gbeam.guards.limits import EMBEDDED
from gbeam.results.provenance import Provenance, RecordFile
from gbeam.scenario.schema import Environments, Flight
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import parse


def provenance(scenario: Environments, command: str = "") -> Provenance:
    """Where results of a scenario come from."""
    source = scenario.source
    if source is None:
        return Provenance(command=command)
    records = tuple(
        _record(name, table.record.file)
        for name, table in scenario.motion.items()
        if isinstance(table, Flight) and table.record is not None
    )
    changes = tuple(change.text for change in source.overrides)
    data = source.data
    if source.distributions:  # which have their centres there
        data, _ = override(_parsed(source.name, source.text), source.name, changes)
    return Provenance(source.text, changes, fingerprint(data), records, command)


# A sweep's cases are of one text; `override` copies it.
_parsed = lru_cache(maxsize=4)(parse)


def fingerprint(data: dict[str, Any]) -> str:
    """SHA-256 of what a scenario says, however it is written and in whatever order."""
    text = json.dumps(data, sort_keys=True, ensure_ascii=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()


def _record(motion: str, file: str) -> RecordFile:
    content = Path(file).read_bytes()
    small = len(content) <= EMBEDDED
    return RecordFile(motion, os.fspath(file), hashlib.sha256(content).hexdigest(), content if small else None)
