"""The reference page of the scenario file, docs/scenario.md, from the schema: every key with its unit and default."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from gbeam.guards.kinds import KINDS
from gbeam.scenario.schema.fields import TAGS
from gbeam.scenario.template import json_schema

_INTRODUCTION = """\
# The scenario file, key by key

This page is written by `gbeam schema --markdown`; `gbeam schema` prints the same as a JSON schema for editors, and
`gbeam new` a commented scenario to start from. A scenario is TOML, or JSON. "–" is the default of a key that may be
left out and has no value then. `--set KEY=VALUE` of the command line names a key by its path, such as
`motion.centrifuge.arm="3.3 m"` or `beam.masses[0].mass="0.1 kg"`.

## Quantities

A quantity is text with a unit, or a number in the SI unit. Any unit of the right dimension is read: `g` is
9.80665 m/s² where an acceleration is expected and a gram where a mass is; 1 Hz is 2π rad/s where a rate of turning is
expected. In a scenario for `gbeam sweep` a distribution may stand in place of any number: `{ normal = ["70 GPa",
"2 GPa"] }`, lognormal, uniform or triangular; the other verbs need one value.

A scenario has one `[beam]` with its `[model]` and what its base does, `[motion.NAME]`; or `[bodies.NAME]` and the
`[joints.NAME]` that make a system of them, whose ground rests where there is no motion:
[systems of bodies](howto/systems.md). One `[bodies.NAME]` without joints is a specimen on the moving base in place of
the beam: a [solid by its mesh, matrices, or a rigid box](howto/solid.md).

| quantity | SI unit | for example |
|---|---|---|
"""
_PROFILES = """\
## Profiles

How a quantity changes over time, such as `{ profile = "constant", level = "6 g" }`. Where a profile of acceleration is
expected its values are accelerations and its rates are jerks; likewise for the other quantities:

| quantity | its rate of change |
|---|---|
"""
_OF = "-of-"  # in the schema, between the names of a profile and of its quantity


def reference() -> str:
    """Return the page: Markdown, one table of keys for every table of a scenario."""
    return _Page(json.loads(json_schema(distributions=False))).text()


class _Page:
    """Text of the page from the schema, whose tables it visits from the top to collect their places in a scenario."""

    def __init__(self, schema: dict[str, Any]) -> None:
        self.tables: dict[str, dict[str, Any]] = schema["$defs"]
        self.top = schema
        self.places: dict[str, list[str]] = {}  # headers such as [motion.NAME], by the table's name
        self.profiles: dict[str, None] = {}  # an ordered set of names
        self._visit(schema, "")

    def text(self) -> str:
        """The page."""
        quantities = "".join(f'| {name} | {kind.unit or "–"} | `"{kind.example}"` |\n' for name, kind in KINDS.items())
        top = "## The file\n\n" + self._keys(self.top)
        tables = [self._table(name) for name in self.places]
        return _INTRODUCTION + "\n".join([quantities, top, *tables, self._profiles()])

    def _visit(self, table: dict[str, Any], path: str) -> None:
        """Collect the places of all tables below a table at `path`."""
        for key, schema in table["properties"].items():
            inner = f"{path}.{key}" if path else key
            if "additionalProperties" in schema:  # tables by any name
                schema, inner = schema["additionalProperties"], f"{inner}.NAME"
            for name, listed in _table_names(schema):
                if self.tables[name].get("x-coordinates"):  # written in the row of its key, without a table of its own
                    self._visit(self.tables[name], inner)
                    continue
                if _OF in name:
                    self.profiles[name] = None
                    continue
                place = f"[[{inner}]]" if listed else f"[{inner}]"
                places = self.places.setdefault(name, [])
                if place not in places:
                    places.append(place)
                    self._visit(self.tables[name], inner)

    def _heading(self, name: str) -> str:
        place, *other_places = self.places[name]
        key, word = tag_of(self.tables[name])
        return ", ".join([place, *([f'{key} = "{word}"'] if key else []), *other_places])

    def _table(self, name: str) -> str:
        table = self.tables[name]
        return f"### {self._heading(name)}\n\n{table['description']}\n\n{self._keys(table)}"

    def _keys(self, table: dict[str, Any], quantity: str = "") -> str:
        """Markdown table of the keys of a table; in that of a profile `quantity` is called the quantity."""
        alternatives = [table, *table.get("anyOf", ())]
        required = {key for alternative in alternatives for key in alternative.get("required", ())}
        rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
        for key, schema in table["properties"].items():
            value = self._value(schema.get("additionalProperties", schema), quantity)
            default = "required" if key in required else _default(schema.get("default"))
            words = schema["description"].replace("|", "\\|")
            rows.append(" | ".join([f"| `{key}`", value, default, f"{words} |"]))
        return "\n".join(rows) + "\n"

    def _value(self, schema: dict[str, Any], profile_quantity: str) -> str:
        """Possible values of a schema, in words; of a key of a profile with the profile's quantity, else empty."""
        if "x-quantity" in schema:
            return self._quantity(schema, profile_quantity)
        if "$ref" in schema:
            name = _target(schema)
            if self.tables[name].get("x-coordinates"):
                return self._by_coordinate(name, profile_quantity)
            quantity = name.partition(_OF)[2].replace("-", " ")
            if quantity:
                return f"[profile](#profiles) of {quantity}"
            anchor = re.sub(r"[^\w\- ]", "", self._heading(name).lower()).replace(" ", "-")  # as GitHub makes it
            return f"[{tag_of(self.tables[name])[1] or 'table'}](#{anchor})"
        if "enum" in schema or "const" in schema:
            return ", ".join(f'`"{word}"`' for word in schema.get("enum", [schema.get("const")]))
        choices = [choice for choice in schema.get("anyOf", schema.get("oneOf", [])) if choice.get("type") != "null"]
        if choices:
            words = list(dict.fromkeys(self._value(choice, profile_quantity) for choice in choices))
            return f"{words[0]}; or a list" if words[1:] == [f"list of: {words[0]}"] else " or ".join(words)
        if "prefixItems" in schema:
            return f"list of {len(schema['prefixItems'])}: {self._value(schema['prefixItems'][0], profile_quantity)}"
        if schema["type"] == "array":
            return f"list of: {self._value(schema['items'], profile_quantity)}"
        bound = f", {schema['minimum']} or more" if "minimum" in schema else ""
        names = {"string": "text", "boolean": "`true` or `false`", "integer": "whole number", "number": "number"}
        return names[schema["type"]] + bound

    def _by_coordinate(self, name: str, profile_quantity: str) -> str:
        """Keys of a table by a joint's coordinates and their possible values; keys with the same ones together."""
        keys_by_value: dict[str, list[str]] = {}
        for key, schema in self.tables[name]["properties"].items():
            keys_by_value.setdefault(self._value(schema, profile_quantity), []).append(f"`{key}`")
        return "; ".join(f"{', '.join(keys)}: {value}" for value, keys in keys_by_value.items())

    def _quantity(self, schema: dict[str, Any], profile_quantity: str) -> str:
        """Name of a quantity with its unit, sign and the words accepted instead of it."""
        name, (number, _, *accepted) = schema["x-quantity"], schema["anyOf"]
        words = "".join(f", or {_accepted(text)}" for text in accepted)
        if profile_quantity and name == profile_quantity:
            return f"the quantity{words}"
        if "exclusiveMinimum" in number:
            sign = ", positive"
        else:
            sign = ", 0 or more" if "minimum" in number else ""
        if profile_quantity and name == self._rate_of(profile_quantity):
            return f"its rate of change{sign}{words}"
        unit = f" in {KINDS[name].unit}" if KINDS[name].unit else ""
        return f"{name}{unit}{sign}{words}"

    def _profiles(self) -> str:
        """Section on profiles, with the tables of one quantity: those of others differ only in its name."""
        quantities = list(dict.fromkeys(name.partition(_OF)[2] for name in self.profiles))
        spoken = [name.replace("-", " ") for name in quantities]
        parts = [_PROFILES + "".join(f"| {name} | {self._rate_of(name)} |\n" for name in spoken)]
        for name in self.profiles:
            if name.endswith(f"{_OF}{quantities[0]}"):
                heading, table = f'profile = "{tag_of(self.tables[name])[1]}"', self.tables[name]
                parts.append(f"### {heading}\n\n{table['description']}\n\n{self._keys(table, spoken[0])}")
        return "\n".join(parts).replace(f"[profile](#profiles) of {spoken[0]}", "[profile](#profiles)")

    def _rate_of(self, quantity: str) -> str:
        """Name of a quantity's rate of change, by the schema of a trapezoid's ``jerk``."""
        trapezoid = self.tables[f"Trapezoid{_OF}{quantity.replace(' ', '-')}"]
        return str(trapezoid["properties"]["jerk"]["x-quantity"])


def _accepted(text: dict[str, Any]) -> str:
    """A text that is accepted in place of a quantity: itself, or what it is."""
    return f'`"{text["const"]}"`' if "const" in text else str(text["description"])


def tag_of(table: dict[str, Any]) -> tuple[str, str]:
    """Key and word that tell a table from others at the same place, such as kind and hub, or two empty texts."""
    properties = table["properties"]
    words = ((key, properties.get(key, {}).get("const")) for key in TAGS)
    return next(((key, word) for key, word in words if word), ("", ""))


def _table_names(schema: dict[str, Any], listed: bool = False) -> Iterator[tuple[str, bool]]:
    """Names of the tables that a schema allows, each with True if in a list."""
    if "$ref" in schema:
        yield _target(schema), listed
    for part in schema.get("anyOf", schema.get("oneOf", [])):
        yield from _table_names(part, listed)
    if "items" in schema:
        yield from _table_names(schema["items"], True)


def _target(schema: dict[str, Any]) -> str:
    return str(schema["$ref"]).rpartition("/")[2]


def _default(value: Any) -> str:
    if value is None or value in ("", [], {}):
        return "–"
    return f"`{json.dumps(value)}`" if not isinstance(value, dict) else "–"
