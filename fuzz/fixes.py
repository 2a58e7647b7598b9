"""Fixes that a message offers about a record, tried: each is taken by the next call, or leads to another message."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from fuzz.cases import Case
from fuzz.judge import judge
from fuzz.worker import Answer
from gbeam.scenario import Record, fields_of, with_entry, without_entry

CALLS = 16  # of a case: a few mistakes have dozens of orders in which they can be mended
RECORD = ("motion", "flight", "record")
KEYS = tuple(fields_of(Record))
_REFUSED = re.compile(r"^s\.toml(?::\d+:\d+)?: motion\.flight\.record(?:\.(\w+))?[^:\n]*: (.*)$", re.MULTILINE)
_HINT = re.compile(r"^ +=? ?= (.*)$", re.MULTILINE)  # below the line of the scenario
_WRITTEN = re.compile(rf"\b({'|'.join(KEYS)}) = (\"[^\"]*\"|\[[^\]]*\]|true|false)")
_MEANT = re.compile(r"did you mean '([^']*)'|name a column of \w+(?: \w+)*, such as '([^']*)'")
Edit = dict[str, Any]  # values by key; None takes one away


def circle(case: Case, call: Callable[[Case], Answer], calls: int = CALLS) -> str:
    """Name the fault of the fixes that follow from a case, one after the other; empty where there is none."""
    stack: list[tuple[str, tuple[str, ...], str]] = [(case.files["s.toml"].decode(), (), "")]
    asked = set[str]()
    while stack and calls:
        text, before, last = stack.pop()
        state = _state(text)
        if state in before:
            return f"circle: {last}"
        if state in asked:
            continue
        asked.add(state)
        calls -= 1
        tried = replace(case, files=case.files | {"s.toml": text.encode()})
        answer = call(tried)
        if fault := judge(tried, answer):
            return f"{fault} after {last}" if last else fault
        said = _REFUSED.search(answer.err) if answer.status == 2 else None
        if said is None:
            continue
        if last.endswith(f"of: {said[2]}"):
            return f"a fix that mends nothing: {last}"
        hint = _HINT.search(answer.err, said.end())
        for edit in edits(hint[1] if hint else "", said[1] or ""):
            stack.append((_edited(text, edit), (*before, state), f"{edit} of: {said[2]}"))
    return ""


def edits(hint: str, key: str) -> Iterator[Edit]:
    """Yield the changes of a record that a hint offers, alternatives one by one; `key` is that of the message."""
    for offer in hint.split("; "):
        edit: Edit = {name: tomllib.loads(f"x = {value}")["x"] for name, value in _WRITTEN.findall(offer)}
        if meant := _MEANT.search(offer):
            edit |= {key: meant[1] or meant[2]}
        if edit and "in place of time" in offer:
            edit |= {"time": None, "time_unit": None}
        if offer == "leave it out":
            edit |= {key: None}
        if edit:
            yield edit


def _edited(text: str, edit: Edit) -> str:
    written = tomllib.loads(text)["motion"]["flight"]["record"]
    for key, value in edit.items():
        if value is None:
            text = without_entry(text, (*RECORD, key)) if key in written else text
            continue
        before = written.get(key)
        if key == "skip_checks" and isinstance(before, list) and isinstance(value, list):
            value = [*before, *(each for each in value if each not in before)]
        text = with_entry(text, (*RECORD, key), value)
    return text


def _state(text: str) -> str:
    return repr(sorted(tomllib.loads(text)["motion"]["flight"]["record"].items()))
