"""Errors as words and an exit status."""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.printable import json_printable, on_one_line, printable, shortened

if TYPE_CHECKING:
    from gbeam.results.result import Result
if sys.platform != "win32":
    import resource  # now, as nothing can be imported once memory is used up

FAILED = 1
WRONG_INPUT = 2
DEFECT = 3
# Words of dlopen(3) and of Python for a lack of memory.
_NO_ROOM = re.compile("failed to map segment|cannot allocate memory|can't start new thread", re.IGNORECASE)
LONGEST = 1000  # characters of a message


def report(error: GbeamError, as_json: bool) -> int:
    """Print an error on stderr and, with `as_json`, also as JSON on stdout; return the exit status."""
    if isinstance(error, ComputationError):
        complain(f"{error.outcome}: {error}")
        if as_json:
            _print({"outcome": error.outcome, "message": str(error), "motions": {}})
        return FAILED
    from gbeam.scenario.text.diagnostics import ScenarioError  # not needed, nor imported, for help

    # A scenario's diagnostics begin with file:line, which editors open: nothing may stand before it.
    placed = isinstance(error, ScenarioError)
    mark, words = ("", str(error)) if placed else ("gbeam: ", on_one_line(shortened(str(error), LONGEST)))
    return _refuse(f"{mark}{words}", _diagnostics(error), as_json)


def report_outcomes(*answers: Result) -> int:
    """Print on stderr why answers are not known, and return the exit status."""
    from gbeam.results.result import Decided

    failed = [answer for answer in answers if isinstance(answer, Decided) and answer.outcome != "done"]
    for answer in failed:
        complain(answer.message)
    return FAILED if failed else 0


def report_syntax(message: str, as_json: bool) -> int:
    """Print that the command line is wrong; return the exit status."""
    problem = {"path": "", "message": message, "hint": "see gbeam --help"}
    words = on_one_line(shortened(message, LONGEST))
    return _refuse(f"gbeam: {words} (see gbeam --help)", [problem], as_json)


def lacks_memory(error: BaseException | None) -> bool:
    """True if an error, or one that caused it, is a lack of memory, by its type or by a loader's or thread's words."""
    while error is not None:
        if isinstance(error, MemoryError) or (
            isinstance(error, (ImportError, RuntimeError)) and _NO_ROOM.search(str(error))
        ):
            return True
        if isinstance(error, SystemError) and _limited():
            return True
        error = error.__cause__ or error.__context__
    return False


def _limited() -> bool:
    """True if the memory of this process is limited, as by ulimit."""
    if sys.platform == "win32":
        return False
    return resource.getrlimit(resource.RLIMIT_AS)[0] != resource.RLIM_INFINITY


def report_memory(error: Exception, as_json: bool) -> int:
    """Print that the memory did not suffice; return the exit status."""
    reason = f" ({error})" if str(error) else ""
    return report(ComputationError("out of memory", f"the computation needs more than there is{reason}"), as_json)


def report_defect(error: Exception, arguments: Sequence[str], as_json: bool) -> int:
    """Print that gbeam itself is wrong, where to report it, and where the traceback is; return the exit status."""
    import platform
    from importlib.metadata import PackageNotFoundError, metadata, version
    from traceback import format_exception

    try:
        links = dict(link.split(", ", 1) for link in metadata("gbeam").get_all("Project-URL") or ())
        gbeam = version("gbeam")
    except PackageNotFoundError:
        links, gbeam = {}, "unknown"
    tracker = links.get("Issues", "the project's issue tracker")
    program = f"gbeam {gbeam}, Python {platform.python_version()}, {platform.platform()}"
    text = "".join([f"{program}\n{shlex.join(['gbeam', *arguments])}\n\n", *format_exception(error)])
    file = _save_traceback(text)
    message = printable(f"{type(error).__name__}: {error}".split("\n")[0])
    complain(f"defect: {message}")
    place = "the traceback above" if file is None else f"{file}, which has the traceback,"
    lines = [
        f"This is a mistake in {program}, not in your input.",
        f"Please report {place} and the scenario to {tracker}.",
    ]
    print(*(f"    {line}" for line in lines), sep="\n", file=sys.stderr)
    if as_json:
        _print({"outcome": "defect", "message": message, "traceback": file, "motions": {}})
    return DEFECT


def _save_traceback(text: str) -> str | None:
    """Write a traceback into a new temporary file and return its name. Else print it on stderr and return None."""
    from tempfile import NamedTemporaryFile

    try:
        with NamedTemporaryFile(
            "w", encoding="utf-8", errors="replace", prefix="gbeam-defect-", suffix=".txt", delete=False
        ) as file:
            file.write(text)
    except OSError:
        print(printable(text), file=sys.stderr)
        return None
    return os.fspath(file.name)


def complain(message: str) -> None:
    """Print on stderr that a computation failed."""
    print(f"gbeam: {printable(message)}", file=sys.stderr)


def _refuse(text: str, diagnostics: list[dict[str, Any]], as_json: bool) -> int:
    """Print what is wrong with the input; return the exit status."""
    print(printable(text), file=sys.stderr)
    if as_json:
        _print({"error": diagnostics})
    return WRONG_INPUT


def _diagnostics(error: GbeamError) -> list[dict[str, Any]]:
    """Diagnostics of an error for JSON: path, message and hint of each."""
    from gbeam.scenario.text.diagnostics import ScenarioError

    if isinstance(error, ScenarioError):
        return [dict(diagnostic) for diagnostic in error.as_json()]
    if isinstance(error, InputError):
        return [{"path": error.where, "message": error.problem, "hint": error.fix}]
    return [{"path": "", "message": str(error), "hint": ""}]


def _print(value: dict[str, Any]) -> None:
    print(json_printable(json.dumps(value, indent=2, ensure_ascii=False)))
