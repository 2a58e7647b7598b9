"""What a text must keep to before it is parsed: the parsers recurse, and read any number of digits."""

from __future__ import annotations

import re
from typing import Any

from gbeam.guards.limits import KEYS, NESTING, NUMBER, SCENARIO_BYTES, in_bytes
from gbeam.printable import printable
from gbeam.scenario.values.paths import Path, Span

# Strings and comments are passed over; a key with more parts than tables may be nested is one token. Possessive
# quantifiers: no text takes longer than its length.
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
    """Say where a text is more than is parsed, what it has, and the fix; None where it keeps to the limits."""
    if len(text) > SCENARIO_BYTES:
        most = in_bytes(SCENARIO_BYTES)
        return Span(1, 1, 2), f"has {in_bytes(len(text))}, and {most} are read at most", "give long tables as a record"
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
    """Say where a text has half of a character, which no file holds; None where it has none."""
    half = _HALF.search(text)
    if half is None:
        return None
    return _span(text, half), f"holds {printable(half[0])}, half a character", "leave it out"


def crowded(data: dict[str, Any]) -> tuple[Path, str] | None:
    """Return the path of what has more keys, or more tables, than anything has, and what it has; None if nothing is."""
    left: list[tuple[Path, Any]] = [((), data)]
    for path, node in left:
        steps = [*node.items()] if isinstance(node, dict) else [*enumerate(node)]
        inside = [((*path, key), each) for key, each in steps if isinstance(each, (dict, list))]
        counts = {"keys": len(steps) if isinstance(node, dict) else 0, "tables or lists": len(inside)}
        for what, count in counts.items():
            if count > KEYS:
                return path, f"has {count} {what}, and nothing has more than {KEYS}"
        left += inside
    return None


def _span(text: str, token: re.Match[str]) -> Span:
    line = text.count("\n", 0, token.start()) + 1
    column = token.start() - (text.rfind("\n", 0, token.start()) + 1) + 1
    return Span(line, column, column + 1)
