"""The one place where an error becomes words and an exit status."""

from __future__ import annotations

import json
import sys
from typing import Any

from gbeam.errors import ComputationError, GbeamError, InputError

FAILED = 1
WRONG_INPUT = 2


def report(error: GbeamError, as_json: bool) -> int:
    """Print an error on stderr, with `as_json` also as JSON on stdout; return the exit status."""
    if isinstance(error, ComputationError):
        complain(f"{error.outcome}: {error}")
        if as_json:
            _print({"outcome": error.outcome, "message": str(error), "motions": {}})
        return FAILED
    # A scenario's diagnostics begin with file:line, which editors open: nothing may stand before it.
    mark = "gbeam: " if isinstance(error, InputError) else ""
    return _refuse(f"{mark}{error}", _diagnostics(error), as_json)


def report_syntax(message: str, as_json: bool) -> int:
    """Print that the command line is wrong; return the exit status."""
    problem = {"path": "", "message": message, "hint": "see gbeam --help"}
    return _refuse(f"gbeam: {message} (see gbeam --help)", [problem], as_json)


def complain(message: str) -> None:
    """Print on stderr that a computation failed."""
    print(f"gbeam: {message}", file=sys.stderr)


def _refuse(text: str, diagnostics: list[dict[str, Any]], as_json: bool) -> int:
    print(text, file=sys.stderr)
    if as_json:
        _print({"error": diagnostics})
    return WRONG_INPUT


def _diagnostics(error: GbeamError) -> list[dict[str, Any]]:
    from gbeam.scenario import ScenarioError  # not needed, nor imported, for help

    if isinstance(error, ScenarioError):
        return [dict(diagnostic) for diagnostic in error.as_json()]
    if isinstance(error, InputError):
        return [{"path": error.where, "message": error.problem, "hint": error.fix}]
    return [{"path": "", "message": str(error), "hint": ""}]


def _print(value: dict[str, Any]) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False))
