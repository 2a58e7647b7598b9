"""What a text must keep to before it is parsed: the parsers recurse, and read any number of digits."""

from __future__ import annotations

import re

from gbeam.guards.limits import NESTING, NUMBER, SCENARIO_BYTES, in_bytes
from gbeam.scenario.values.paths import Span

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


def _span(text: str, token: re.Match[str]) -> Span:
    line = text.count("\n", 0, token.start()) + 1
    column = token.start() - (text.rfind("\n", 0, token.start()) + 1) + 1
    return Span(line, column, column + 1)
