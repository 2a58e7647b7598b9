"""Places in a scenario as text, ``beam.masses[0].at``, and as tuples."""

from __future__ import annotations

import re

from gbeam.scenario.text.place import Path

_STEP = re.compile(r"([^.\[\]=\s]+)((?:\[\d+\])*)")


def path_text(path: Path) -> str:
    """Write a path: ``("beam", "masses", 0, "at")`` is ``beam.masses[0].at``."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)
    return text.removeprefix(".")


def parse_path(text: str) -> Path | None:
    """Read a path; None if `text` is not one."""
    path: Path = ()
    for part in text.split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            return None
        path += (match[1], *(int(index) for index in re.findall(r"\d+", match[2])))
    return path
