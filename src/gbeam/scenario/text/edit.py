"""Write what a verb has found into a scenario's text, and leave all else as it was, comments too."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from gbeam.errors import InputError
from gbeam.scenario.text.revise import with_entry
from gbeam.scenario.text.source import Source, parse
from gbeam.scenario.values.paths import Path, parse_path, path_text, written_at
from gbeam.scenario.values.units import unit_of


def edited(source: Source, table: Path, changes: Mapping[str, str | float]) -> str:
    """Return the text with some entries of one table set to other text."""
    text = source.text
    given = ", ".join(f"{path_text((*table, key))}={value}" for key, value in changes.items())
    refusal = InputError(source.name, "is written in a way that cannot be changed here", f"write it yourself: {given}")
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
