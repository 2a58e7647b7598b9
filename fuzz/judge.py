"""Judge an answer: what is wrong with it, if anything."""

from __future__ import annotations

import json
import re
import signal

from fuzz.cases import Case
from fuzz.worker import MEMORY, PATIENCE, SECONDS, Answer

LONGEST = 40_000  # characters of a message: a hundred problems at their lines
_TERMINAL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
# A scenario's problems begin with their place, all else with the program's name.
_PLACED = re.compile(r"(gbeam: \S|--set .|[^\n]+\.\w+(:\d+:\d+)?: .|\S[^\n]*: .)", re.DOTALL)
_SAID = re.compile(r"^gbeam: \S.*$", re.MULTILINE)  # what is under way, or a warning


def judge(case: Case, answer: Answer, memory: int = MEMORY) -> str:
    """Name the fault of an answer; empty where there is none."""
    everything = answer.out + answer.err
    if answer.status < 0:
        number = signal.Signals(-answer.status)
        if number in (signal.SIGXCPU, signal.SIGALRM) and _SAID.search(answer.err):
            return ""  # what is still valid may take long, and says so
        if number in (signal.SIGXCPU, signal.SIGALRM):
            return f"hang: more than {SECONDS} s of processor time, or {PATIENCE} s"
        return f"killed by {number.name}"
    if "Traceback (most recent call last)" in everything or answer.status not in (0, 1, 2):
        return f"defect: {_last_line(answer)}"
    if "out of memory" in answer.err or answer.memory > memory:
        return f"memory: {answer.memory / 1e9:.2g} GB {_first_line(answer.err)}"
    if _TERMINAL.search(everything):
        return "control characters on the terminal"
    if "Warning:" in answer.err:
        return f"warning: {next(line for line in answer.err.splitlines() if 'Warning:' in line).rpartition('/')[2]}"
    if answer.status == 2:
        return _of_refusal(case, answer)
    if answer.status == 0 and _SAID.sub("", answer.err).strip():
        return f"words on stderr of a success: {_first_line(answer.err)}"
    if answer.status == 1 and not answer.err.strip():
        return "failed without a word"
    return ""


def _of_refusal(case: Case, answer: Answer) -> str:
    if not _PLACED.match(answer.err):
        return f"no place: {_first_line(answer.err)!r}"
    if len(answer.err) > LONGEST:
        return f"message of {len(answer.err)} characters"
    if answer.files:
        return f"files of a refused input: {answer.files[:3]}"
    if "--json" in case.arguments:
        try:
            return "" if json.loads(answer.out)["error"] else "JSON without an error"
        except (ValueError, KeyError, TypeError):
            return "no JSON of a refused input"
    return "output of a refused input" if answer.out.strip() else ""


def _first_line(text: str) -> str:
    return next(iter(text.splitlines()), "")[:200]


def _last_line(answer: Answer) -> str:
    """Place of a failure, without what differs from case to case."""
    lines = [line for line in (answer.traceback or answer.err).splitlines() if line.strip()]
    frames = [line.strip() for line in lines if re.match(r'\s+File ".*gbeam/', line)]
    place = re.sub(r'File ".*?(gbeam/[^"]*)"', r"\1", frames[-1]) if frames else ""
    return f"{place} {lines[-1][:120] if lines else ''}"
