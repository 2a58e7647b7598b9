"""Changes to the text of a scenario that keep its comments."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError
from gbeam.guards.units import unit_of
from gbeam.scenario.text.diagnostics import ScenarioError
from gbeam.scenario.text.locate import BLOCKS, Layout, keys_of
from gbeam.scenario.text.source import Source, is_json, parse
from gbeam.scenario.values.paths import Path, parse_path, path_text, written_at

if TYPE_CHECKING:
    from tree_sitter import Node


def edited(source: Source, table: Path, changes: Mapping[str, str | float]) -> str:
    """Return the text with some entries of one table set to other text."""
    text = source.text
    lines = ", ".join(f"{path_text((*table, key))}={value}" for key, value in changes.items())
    refusal = InputError(source.name, "is written in a way that cannot be changed here", f"write it yourself: {lines}")
    if written_at(parse(source.name, text), table) is None:
        raise refusal
    for key, value in changes.items():
        try:
            text = with_entry(text, (*table, key), value)
        except InputError:
            raise refusal from None
    return text


def with_quantities(source: Source, changes: Mapping[str, tuple[float, str]]) -> str:
    """Return the text with some quantities set to other values, each in the unit that it was written in."""
    text, before = source.text, parse(source.name, source.text)
    for path_words, (value, kind) in changes.items():
        *table, key = parse_path(path_words) or ("",)
        if not isinstance(key, str):
            raise InputError(source.name, f"has {path_words} in a list", f"write it yourself: {value:.8g}")
        plain = replace(source, text=text, data=before, overrides=())
        old = plain.raw((*table, key))
        unit, size = unit_of(old, kind) if isinstance(old, str) else ("", 1.0)
        number = f"{value / size:.8g}"
        written: str | float = f"{number} {unit}" if unit else float(number)
        text = edited(replace(source, text=text, overrides=()), tuple(table), {key: written})
    return text


_BARE = re.compile(r"[A-Za-z0-9_-]+")
_COMMENTS = re.compile(rb"(?:\r?\n[ \t]*#[^\n]*?)*(?=\s*\r?\n[ \t]*\r?\n|\s*$)")


def with_entry(text: str, path: Path, value: Any) -> str:
    """Return the text with an entry at `path`: its value replaced, or added with the tables around it."""
    expected = parse("", text)
    try:
        _put(expected, path, value)
    except (LookupError, TypeError, AttributeError):
        raise _beyond(path) from None
    return _checked(text, [expected], path, lambda: _with(text, path, value))


def without_entry(text: str, path: Path) -> str:
    """Return the text without the entry at `path`, a value, a table or an element of a list."""
    expected = parse("", text)
    try:
        del _at(expected, path[:-1])[path[-1]]
    except (LookupError, TypeError):
        raise InputError(path_text(path), "is not written in the scenario", "choose what is written") from None
    sound = [deepcopy(expected)]
    # A table that only the headers of others open is gone with the last of them.
    for end in range(len(path) - 1, 0, -1):
        if _at(expected, path[:end]) != {}:
            break
        del _at(expected, path[: end - 1])[path[end - 1]]
        sound.append(deepcopy(expected))
    return _checked(text, sound, path, lambda: _without(text, path))


def toml(value: Any) -> str:
    """A value as TOML writes it on one line."""
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {toml(each)}' for key, each in value.items())} }}" if value else "{}"
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value, ensure_ascii=False)  # a string of TOML too


def _checked(text: str, expected: Sequence[Any], path: Path, edit: Callable[[], str]) -> str:
    """Text after an edit, if it reads as it must."""
    if is_json(text):
        return json.dumps(expected[0], indent=2, ensure_ascii=False) + "\n"
    changed = edit()
    try:
        sound = parse("", changed) in expected
    except ScenarioError:
        sound = False
    if not sound:
        raise _beyond(path)
    return changed


def _beyond(path: Path) -> InputError:
    return InputError(path_text(path), "is written in a way that cannot be changed here", "change the text")


def _at(node: Any, path: Path) -> Any:
    for step in path:
        node = node[step]
    return node


def _put(node: Any, path: Path, value: Any) -> None:
    for step, following in pairwise(path):
        inside: Any = [] if isinstance(following, int) else {}
        if isinstance(step, int):
            node.extend([inside] if step == len(node) else [])
            node = node[step]
        else:
            node = node.setdefault(step, inside)
    if isinstance(path[-1], int) and path[-1] == len(node):
        node.append(value)
    else:
        node[path[-1]] = value


def _with(text: str, path: Path, value: Any) -> str:
    code = text.encode()
    written = Layout(code)
    places = written.entries.get(path, [])
    if len(places) == 1 and (node := places[0][1]) is not None and node.type not in BLOCKS:
        return _spliced(code, node.start_byte, node.end_byte, toml(value))
    if places and isinstance(path[-1], int):  # [[parent]], and others may follow
        at = min(_cut(code, whole)[0] for whole, _ in places)
        block = _block(code, path[:-1], value, listed=True).removeprefix(_newline(code)) + _newline(code)
        return _spliced(_without(text, path).encode(), at, at, block)
    if places:
        return _with(_without(text, path), path, value)
    return _added(code, written, path, value)


def _without(text: str, path: Path) -> str:
    code = text.encode()
    for node in sorted((whole for whole, _ in Layout(code).entries[path]), key=lambda n: -n.start_byte):
        first, last = _cut(code, node)
        code = code[:first] + code[last:]
    return code.decode()


def _added(code: bytes, written: Layout, path: Path, value: Any) -> str:
    parent, key = path[:-1], path[-1]
    if not parent:
        return _added_on_top(code, written, str(key), value)
    places = written.entries.get(parent, [])
    if not places:
        return _added(code, written, parent, [value] if isinstance(key, int) else {key: value})
    home = next((node for _, node in places if node is not None), None)
    last = places[-1][0]
    if home is not None and home.type in BLOCKS:  # [table]
        return _spliced(code, *_after(code, home), _line(code, f"{_key(key)} = {toml(value)}"))
    if home is not None:
        return _added_inside(code, home, toml(value) if isinstance(key, int) else f"{_key(key)} = {toml(value)}")
    if last.type in BLOCKS:  # [[parent]], or [parent.other]
        at = _below(code, _after(code, last)[0])
        if isinstance(key, int):
            return _spliced(code, at, at, _block(code, parent, value, listed=True))
        if isinstance(value, dict):
            return _spliced(code, at, at, _block(code, path, value))
        return _spliced(code, at, at, _block(code, parent, {key: value}))
    depth = len(parent) - len(written.bases[last.id])  # parent.other = ..., a dotted key
    before = ".".join(_key(name) for name, _ in list(keys_of(last.named_children[0]))[:depth])
    entry = f"{before}.{_key(key)} = {toml(value)}"
    if last.parent is not None and last.parent.type == "inline_table":
        return _spliced(code, last.end_byte, last.end_byte, f", {entry}")
    return _spliced(code, *_after(code, last), _line(code, entry))


def _added_on_top(code: bytes, written: Layout, key: str, value: Any) -> str:
    if isinstance(value, dict):
        path: Path = (key,)
        while len(value) == 1 and isinstance(inside := next(iter(value.values())), dict):
            path, value = (*path, next(iter(value))), inside
        end = len(code.rstrip())
        return _spliced(code, end, end, _block(code, path, value))
    pairs = [node for node in written.root.named_children if node.type == "pair"]
    entry = f"{_key(key)} = {toml(value)}"
    if pairs:
        return _spliced(code, *_after(code, pairs[-1]), _line(code, entry))
    at = next((node.start_byte for node in written.root.named_children if node.type in BLOCKS), len(code))
    return _spliced(code, at, at, f"{entry}{_newline(code)}")


def _added_inside(code: bytes, home: Node, entry: str) -> str:
    """An entry at the end of an inline table or a list."""
    inside = [node for node in home.named_children if node.type != "comment"]
    if not inside:
        braces = "[]" if home.type == "array" else "{}"
        space = "" if home.type == "array" else " "
        return _spliced(code, home.start_byte, home.end_byte, f"{braces[0]}{space}{entry}{space}{braces[1]}")
    last = inside[-1]
    before = code[code.rfind(b"\n", 0, last.start_byte) + 1 : last.start_byte]
    gap = f",{_newline(code)}{before.decode()}" if not before.strip() else ", "
    return _spliced(code, last.end_byte, last.end_byte, gap + entry)


def _block(code: bytes, path: Path, value: dict[str, Any], *, listed: bool = False) -> str:
    name = ".".join(_key(step) for step in path if isinstance(step, str))
    newline = _newline(code)
    head = f"{newline}{newline}[[{name}]]" if listed else f"{newline}{newline}[{name}]"
    return "".join([head, *(f"{newline}{_key(key)} = {toml(each)}" for key, each in value.items())])


def _line(code: bytes, entry: str) -> str:
    return f"{_newline(code)}{entry}"


def _spliced(code: bytes, first: int, last: int, new: str) -> str:
    return (code[:first] + new.encode() + code[last:]).decode()


def _after(code: bytes, node: Node) -> tuple[int, int]:
    """The end of the last line of a pair, or of a [table] without the comments that lead to the next one."""
    if node.type in BLOCKS:
        pairs = [each for each in node.named_children if each.type == "pair"]
        node = pairs[-1] if pairs else node.named_children[0]
    end = code.find(b"\n", node.end_byte)
    end = len(code) if end < 0 else end - (code[end - 1 : end] == b"\r")
    return end, end


def _below(code: bytes, end: int) -> int:
    """The end of the comments right below a line, where an empty line parts them from what follows."""
    match = _COMMENTS.match(code, end)
    return match.end() if match else end


def _cut(code: bytes, node: Node) -> tuple[int, int]:
    """The bytes of a pair, an element or a [table], with its comma, or with its lines."""
    within = node.parent
    assert within is not None
    if within.type in ("inline_table", "array"):
        around = [each for each in within.children if each.type not in ("comment", "[", "]", "{", "}")]
        i = next(k for k, each in enumerate(around) if each.id == node.id)
        if i + 1 < len(around):  # with the comma and the space behind it
            end = around[i + 1].end_byte
            return node.start_byte, end + len(code[end:]) - len(code[end:].lstrip(b" "))
        return (around[i - 1].start_byte if i else node.start_byte), node.end_byte
    start = code.rfind(b"\n", 0, node.start_byte) + 1
    end = code.find(b"\n", _after(code, node)[0]) + 1
    if node.type in BLOCKS and not code[code.rfind(b"\n", 0, start - 1) + 1 : start].strip():
        start = code.rfind(b"\n", 0, start - 1) + 1  # with the empty line before it
    return start, end or len(code)


def _newline(code: bytes) -> str:
    return "\r\n" if b"\r\n" in code else "\n"


def _key(key: str | int) -> str:
    return str(key) if _BARE.fullmatch(str(key)) else json.dumps(key, ensure_ascii=False)
