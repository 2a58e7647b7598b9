"""Change entries of a scenario's text and leave all else as it was, comments too."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from gbeam.errors import InputError
from gbeam.scenario.text.diagnostics import ScenarioError
from gbeam.scenario.text.source import Source, is_json, parse
from gbeam.scenario.values.paths import Path, Place, parse_path, path_text
from gbeam.scenario.values.units import unit_of

_OWN_LINE = re.compile(r"""\s*([\w"'-]+\s*\.\s*)*""")  # what stands before a key that has a line of its own


def edited(source: Source, table: Path, changes: Mapping[str, str | float]) -> str:
    """Return the text with some entries of one table set to other text.

    Parameters
    ----------
    source : Source
        As it stands in the file; its overrides are left out.
    table : tuple
        Path of the table, such as ``("motion", "centrifuge")``.
    changes : mapping of str to (str or float)
        By key. One that the table lacks is added after the first of the others, or else after its first entry.

    Raises
    ------
    InputError
        If the table is written in a way that this cannot follow, such as over several lines.
    """
    lines, expected = source.text.split("\n"), parse(source.name, source.text)
    node: Any = expected
    for step in table:
        node = node.setdefault(step, {})
    node |= changes
    inside = {path[-1]: place for path, place in source.places.items() if path[:-1] == table}
    edits = []  # line, first column, last column, what stands there then
    for key, value in changes.items():
        text = json.dumps(value, ensure_ascii=False)  # a string of TOML too
        if key in inside:
            span = inside[key].value
            edits.append((span.line, span.column, span.end, text))
        elif inside:
            anchor = next((inside[other] for other in changes if other in inside), next(iter(inside.values())))
            edits.append(_added(lines[anchor.value.line - 1], anchor, key, text, is_json(source.text)))
    for number, first, last, text in sorted(edits, reverse=True):
        line = lines[number - 1]
        lines[number - 1] = line[: first - 1] + text + line[last - 1 :]
    changed = "\n".join(lines)
    try:
        sound = parse(source.name, changed) == expected
    except ScenarioError:
        sound = False
    if not sound:
        given = ", ".join(f"{path_text((*table, key))}={value}" for key, value in changes.items())
        raise InputError(source.name, "is written in a way that cannot be changed here", f"write it yourself: {given}")
    return changed


def with_quantities(source: Source, changes: Mapping[str, tuple[float, str]]) -> str:
    """Return the text with some quantities set to other values, each in the unit that it was written in.

    Parameters
    ----------
    source : Source
    changes : mapping of str to (float, str)
        By path, ``beam.masses[0].mass``: the value in SI, and its kind, a key of ``KINDS``.

    Raises
    ------
    InputError
        As for :func:`edited`, and if the entry of a list is to be changed.
    """
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


def _added(line: str, anchor: Place, key: str, text: str, json: bool) -> tuple[int, int, int, str]:
    """The edit that writes an entry after another: on a line of its own if that has one."""
    before, span = line[: anchor.key.column - 1], anchor.value
    if json:
        return span.line, span.end, span.end, f', "{key}": {text}'
    if _OWN_LINE.fullmatch(before):
        end = len(line.rstrip("\r")) + 1
        return span.line, end, end, f"{line[end - 1 :]}\n{before}{key} = {text}"
    return span.line, span.end, span.end, f", {key} = {text}"
