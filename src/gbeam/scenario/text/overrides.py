"""Changes KEY=VALUE of a scenario, and limits of its text."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from gbeam.guards.limits import KEYS, NESTING, NUMBER, SCENARIO_BYTES, in_bytes
from gbeam.printable import printable
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.values import Path, Span, parse_path, path_text

# Strings and comments are tokens, so that brackets in them do not count; so is a key with too many parts. Possessive
# quantifiers keep the time in proportion to the length of any text.
_TOKEN = re.compile(
    r'"""(?:[^\\]|\\.)*?"""(?!")|\'\'\'.*?\'\'\'(?!\')|'
    rf"(?P<path>(?:(?:[\w-]++|\"[^\"\n]*+\"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{NESTING},}})|"
    r'"(?:[^"\\\n]|\\.)*+"|'
    r"'[^'\n]*+'|"
    r"#[^\n]*+|"
    rf"(?P<number>[+-]?[0-9][0-9a-zA-Z_.]{{{NUMBER},}}+)|[\w-]++|"
    r"(?P<open>[\[{])|(?P<close>[\]}])",
    re.DOTALL,
)
_HALF = re.compile("[\ud800-\udfff]")


def excess(text: str) -> tuple[Span, str, str] | None:
    """Place, problem and fix where a text exceeds the limits of size, nesting or numbers, or None if it keeps them."""
    if len(text) > SCENARIO_BYTES:
        limit = in_bytes(SCENARIO_BYTES)
        return Span(1, 1, 2), f"has {in_bytes(len(text))}, and {limit} are read at most", "give long tables as a record"
    depth = 0
    for token in _TOKEN.finditer(text):
        kind = token.lastgroup
        if kind == "open":
            depth += 1
        elif kind == "close":
            depth = max(depth - 1, 0)
        if kind == "path" or depth > NESTING:
            return _span(text, token), f"has more than {NESTING} tables or lists in one another", "leave brackets out"
        if kind == "number":
            return _span(text, token), f"has a number of {len(token[0])} characters", "round it to 17 digits"
    return None


def no_text(text: str) -> tuple[Span, str, str] | None:
    """Place, problem and fix of the first lone surrogate, which no file can hold, in a text, or None without one."""
    half = _HALF.search(text)
    if half is None:
        return None
    return _span(text, half), f"holds {printable(half[0])}, half a character", "leave it out"


def crowded(data: dict[str, Any]) -> tuple[Path, str] | None:
    """Return the path of a table or list with too many keys, tables or lists, and the problem, or None without one."""
    nodes: list[tuple[Path, Any]] = [((), data)]
    for path, node in nodes:  # which grows
        steps = [*node.items()] if isinstance(node, dict) else [*enumerate(node)]
        children = [((*path, key), child) for key, child in steps if isinstance(child, (dict, list))]
        counts = {"keys": len(steps) if isinstance(node, dict) else 0, "tables or lists": len(children)}
        for noun, count in counts.items():
            if count > KEYS:
                return path, f"has {count} {noun}, and nothing has more than {KEYS}"
        nodes += children
    return None


def _span(text: str, token: re.Match[str]) -> Span:
    line = text.count("\n", 0, token.start()) + 1
    column = token.start() - (text.rfind("\n", 0, token.start()) + 1) + 1
    return Span(line, column, column + 1)


@dataclass(frozen=True)
class Override:
    """One ``key=value``: its `text`, the `path` of its key and its `value`."""

    text: str
    path: Path
    value: Any


class _Refused(ValueError):
    """Raised with message and hint for an override that cannot be applied."""


def override(data: dict[str, Any], name: str, texts: Iterable[str]) -> tuple[dict[str, Any], tuple[Override, ...]]:
    """Return a copy of `data` after the overrides `texts`, and these as read; ScenarioError lists refused ones."""
    changed = deepcopy(data)
    applied: list[Override] = []
    refused: list[Diagnostic] = []
    for text in texts:
        try:
            change = _read(text)
            _write(changed, change)
            applied.append(change)
        except _Refused as error:
            message, hint = error.args
            refused.append(Diagnostic(name, "", message, hint, override=text))
    if refused:
        raise ScenarioError(refused)
    return changed, tuple(applied)


def _read(text: str) -> Override:
    key, equals, value = text.partition("=")
    path = parse_path(key.strip())
    if path is not None and len(path) > NESTING:
        raise _Refused(f"has more than {NESTING} tables or lists in one another", "shorten the key")
    if not equals or path is None:
        raise _Refused("is not key=value", 'write it such as --set "beam.length=250 mm"')
    return Override(text, path, value_of(value.strip()))


def value_of(text: str) -> Any:
    """A TOML number, boolean, list or inline table where the text reads as one; else the text itself."""
    exceeded = excess(text)
    if exceeded is not None:
        _, problem, fix = exceeded
        raise _Refused(problem, fix)
    try:
        parsed = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    value = parsed.get("value")
    is_one_value = len(parsed) == 1 and isinstance(value, (bool, int, float, str, list, dict))  # not a date
    return value if is_one_value else text


def _write(data: dict[str, Any], change: Override) -> None:
    """Set a value in `data`, with missing tables around it; a list's missing entry is refused."""
    node: Any = data
    for i, step in enumerate(change.path):
        parent = path_text(change.path[:i])
        if isinstance(step, int):
            if not isinstance(node, list):
                raise _Refused(f"{parent} is not a list", "leave the index out")
            if step >= len(node):
                count = f"{len(node)} {'entry' if len(node) == 1 else 'entries'}"
                raise _Refused(f"{parent} has {count}", "the first is [0]; set the whole list to add to it")
        elif not isinstance(node, dict):
            raise _Refused(f"{parent} is {'a list' if isinstance(node, list) else 'not a table'}", "check the key")
        if i == len(change.path) - 1:
            node[step] = change.value
        elif isinstance(step, str):
            # A table that does not exist yet: the schema will say if it may not be.
            node = node.setdefault(step, [] if isinstance(change.path[i + 1], int) else {})
        else:
            node = node[step]
