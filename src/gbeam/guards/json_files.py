"""JSON from outside: of a size that is read, and nested no deeper than what is done with it recurses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from gbeam.errors import InputError
from gbeam.guards.limits import NESTING, TEXT_BYTES, refuse_large_file


def read_json(file: Path, fix: str) -> dict[str, Any]:
    """Return the object that a file holds."""
    try:
        refuse_large_file("", file, TEXT_BYTES, fix)
        value = parse_json(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(str(file), f"cannot be read ({error.strerror})", fix) from None
    except InputError:
        raise
    except ValueError:
        raise InputError(str(file), "is no JSON of a result", fix) from None
    if not isinstance(value, dict):
        raise InputError(str(file), "is not the JSON of a result", fix)
    return value


def parse_json(text: str) -> Any:
    """Return what a text holds."""
    try:
        value = json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    level = [value]
    for _ in range(NESTING):
        level = [each for one in level if isinstance(one, (dict, list)) for each in _inside(one)]
        if not level:
            return value
    raise ValueError("nested too deeply")


def _inside(one: dict[str, Any] | list[Any]) -> Any:
    return one.values() if isinstance(one, dict) else one
