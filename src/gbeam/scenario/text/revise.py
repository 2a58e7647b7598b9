"""Changes to the text of a scenario that keep its comments."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from dataclasses import replace
from functools import partial
from typing import Any

from gbeam.errors import InputError
from gbeam.guards.units import unit_of
from gbeam.scenario.text.diagnostics import ScenarioError
from gbeam.scenario.text.source import Source, is_json, parse
from gbeam.scenario.values import Path, parse_path, path_text, written_at


def edited(source: Source, table: Path, changes: Mapping[str, str | float | list[str]]) -> str:
    """Return the text with other values of some keys of one table; InputError if that cannot be done."""
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
    """Return the text with other values (SI, and kind) of quantities by path, each in the unit it was written in."""
    text, data = source.text, parse(source.name, source.text)
    for path_words, (value, kind) in changes.items():
        *table, key = parse_path(path_words) or ("",)
        if not isinstance(key, str):
            raise InputError(source.name, f"has {path_words} in a list", f"write it yourself: {value:.8g}")
        value_before = replace(source, text=text, data=data, overrides=()).raw((*table, key))
        unit, size = unit_of(value_before, kind) if isinstance(value_before, str) else ("", 1.0)
        number = f"{value / size:.8g}"
        text_value: str | float = f"{number} {unit}" if unit else float(number)
        text = edited(replace(source, text=text, overrides=()), tuple(table), {key: text_value})
    return text


_BARE = re.compile(r"[A-Za-z0-9_-]+")


def with_entry(text: str, path: Path, value: Any) -> str:
    """Return the text with an entry at `path`: its value replaced, or added with the tables around it."""
    expected = parse("", text)
    try:
        _put(expected, path, value)
    except (LookupError, TypeError, AttributeError):
        raise _refusal(path) from None
    # A new table is tried under a header first; where dotted keys open its parent, it can only stand on one line.
    changes = (partial(_put, path=path, value=value, style=style) for style in (_block, _line))
    return _checked(text, [expected], path, *changes)


def without_entry(text: str, path: Path) -> str:
    """Return the text without the entry at `path`, a value, a table or an element of a list."""
    expected = parse("", text)
    try:
        _delete(expected, path)
    except (LookupError, TypeError):
        raise InputError(path_text(path), "is not written in the scenario", "choose what is written") from None
    accepted = [deepcopy(expected)]
    # A table without a header of its own disappears with the last table inside it.
    for end in range(len(path) - 1, 0, -1):
        if written_at(expected, path[:end]) != {}:
            break
        _delete(expected, path[:end])
        accepted.append(deepcopy(expected))
    return _checked(text, accepted, path, partial(_delete, path=path))


def toml(value: Any) -> str:
    """Return a value as TOML on one line."""
    if isinstance(value, dict):
        pairs = ", ".join(f"{_key(key)} = {toml(entry)}" for key, entry in value.items())
        return f"{{ {pairs} }}" if pairs else "{}"
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value, ensure_ascii=False)  # TOML reads strings of JSON


def _checked(text: str, accepted: Sequence[Any], path: Path, *changes: Callable[[Any], None]) -> str:
    """Return the text after the first of `changes` that makes it read as one of `accepted`, or raise InputError."""
    if is_json(text):
        return json.dumps(accepted[0], indent=2, ensure_ascii=False) + "\n"
    from tomlkit.exceptions import TOMLKitError

    for change in changes:
        with suppress(ScenarioError, TOMLKitError, LookupError, TypeError, ValueError, AttributeError):
            changed = _changed(text, change)
            if parse("", changed) in accepted:
                return changed
    raise _refusal(path)


def _refusal(path: Path) -> InputError:
    return InputError(path_text(path), "is written in a way that cannot be changed here", "change the text")


def _changed(text: str, change: Callable[[Any], None]) -> str:
    """Return the text after a change of its document. Comments before a table's header stay before it."""
    import tomlkit
    from tomlkit.items import Comment, Table, Whitespace

    document = tomlkit.parse(text.replace("\r\n", "\n") + "\n" * (not text.endswith("\n")))
    leads: list[tuple[Any, str]] = []  # every table, and None for the end, with the comments and empty lines before it
    gap: list[tuple[list[Any], int]] = []  # places of the comments and empty lines since the last entry
    for body, i, item in [*_items(document), ([], 0, None)]:
        if isinstance(item, (Comment, Whitespace)):
            gap.append((body, i))
            continue
        if item is None or isinstance(item, Table):
            # tomlkit keeps them in the table above, and would put its new entries after them.
            leads.append((item, "".join(body[i][1].as_string() for body, i in gap)))
            for body, i in gap:
                body[i] = (None, Whitespace(""))
        gap = []
    change(document)
    items = {id(item) for *_, item in _items(document)}
    lead = ""  # comments before removed tables go to the next one
    for table, comments in leads[:-1]:
        lead += comments if id(table) in items or "#" in comments else ""
        if id(table) in items:
            table.trivia.indent, lead = lead + table.trivia.indent, ""
    changed = tomlkit.dumps(document) + lead + leads[-1][1]
    changed = changed if text.endswith("\n") else changed.removesuffix("\n")
    return changed.replace("\n", "\r\n") if "\r\n" in text else changed


def _items(container: Any) -> Iterator[tuple[list[Any], int, Any]]:
    """Yield list, index and item of every entry, comment and table with a header, in the order of the text."""
    from tomlkit.items import AoT, Table

    for i, (_, item) in enumerate(container.body):
        if not isinstance(item, (AoT, Table)):
            yield container.body, i, item
            continue
        for table in item.body if isinstance(item, AoT) else [item]:
            if not table.is_super_table():
                yield container.body, i, table
            yield from _items(table.value)


def _put(data: Any, path: Path, value: Any, style: Callable[[Any, Any], Any] = lambda _, value: value) -> None:
    """Write a value at a path of data, or of a document as `style(parent, value)`, with missing tables around it."""
    parent: Any = None  # of `data`
    for i, step in enumerate(path[:-1]):
        if step == len(data) if isinstance(step, int) else step not in data:
            for inner in reversed(path[i + 1 :]):
                value = {inner: value} if isinstance(inner, str) else [value]
            path = path[: i + 1]
            break
        parent, data = data, data[step]
    if _braced(data) and path[-1] not in data:
        # The whole table is written anew: tomlkit would put a new entry without regard to the blanks around others.
        parent[path[-2]] = style(parent, {**data.unwrap(), path[-1]: value})
    elif path[-1] == len(data):
        data.append(style(data, value))
    else:
        data[path[-1]] = style(data, value)


def _braced(data: Any) -> bool:
    """True for an inline table of a document, which stands in braces; False for plain data."""
    if type(data) in (dict, list):
        return False
    from tomlkit.items import InlineTable

    return isinstance(data, InlineTable)


def _line(parent: Any, value: Any) -> Any:
    """Return a value as an item on one line."""
    import tomlkit

    return tomlkit.value(toml(value))


def _block(parent: Any, value: Any) -> Any:
    """Return a value as an item: a table under a header if its parent has only such tables, else on one line."""
    import tomlkit
    from tomlkit.items import AoT, Table

    headed = isinstance(parent, (AoT, tomlkit.TOMLDocument)) or (isinstance(parent, Table) and parent.is_super_table())
    if not (headed and isinstance(value, dict)):
        return _line(parent, value)
    table = tomlkit.table()
    table.trivia.indent = "\n"
    for key, entry in value.items():
        table.add(key, _line(table, entry))
    return table


def _delete(data: Any, path: Path) -> None:
    for step in path[:-1]:
        data = data[step]
    del data[path[-1]]


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key, ensure_ascii=False)
