"""Presets of acceleration tests by standards: files of TOML that ship, each figure with its source and clause.

``[arm]`` has keys of ``[motion.NAME]``, kind = "arm". ``[source]`` says of each where it is from; ``[asked]`` says of
each key that the standard fixes, and whose text could not be read, where in the standard it stands: the scenario has to
give it.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, get_args

from gbeam.constants import PresetName
from gbeam.errors import InputError
from gbeam.printable import advise

PRESETS: tuple[PresetName, ...] = get_args(PresetName)


@dataclass(frozen=True)
class Preset:
    """A test of a standard."""

    title: str
    standard: str  # with its edition
    arm: Mapping[str, Any]  # keys of the motion's table, as a scenario writes them
    source: Mapping[str, str]  # of each of them: clause, and the text that was read
    asked: Mapping[str, str]  # of each key that the scenario has to give: its clause

    @property
    def directions(self) -> Mapping[str, Any]:
        """Directions of the load by name, or empty where the scenario has to give them."""
        return self.arm.get("directions", {})

    def words(self, name: str, keys: Iterable[str]) -> str:
        """Words for results on the standard, the clauses of the keys that are `keys` from the preset, at second hand
        where they are, and where the standard has those that a scenario gives.
        """
        sources = {key: clause.partition(":")[0] for key, clause in self.source.items() if key in keys}
        parts = [f"{self.standard}, {self.title[:1].lower()}{self.title[1:]} (preset {name})"]
        taken_from = ", ".join(f"{key} by {clause}" for key, clause in sources.items())
        unread = ", ".join(f"{key} ({clause})" for key, clause in self.asked.items())
        parts += [taken_from, f"from the scenario, and not checked against the standard: {unread}"]
        return "; ".join(filter(None, parts))

    def advice(self, key: str) -> str:
        """Words on where the standard has what a scenario leaves out at a key, or empty of what it does not fix."""
        if key not in self.asked:
            return ""
        return f"{self.standard}, {self.asked[key]}: gbeam could not read that text, and has no figure of it"


def text_of(name: str) -> str:
    """Text of a preset's file; InputError if there is none of this name."""
    if name not in PRESETS:
        raise InputError("preset", f"is {name!r}, of which there is none", advise(name, PRESETS))
    return (files("gbeam.scenario.presets") / f"{name}.toml").read_text(encoding="utf-8")


@cache
def preset_of(name: str) -> Preset:
    """Preset by its name; InputError if there is none."""
    tables = tomllib.loads(text_of(name))
    return Preset(tables["title"], tables["standard"], tables["arm"], tables["source"], tables["asked"])
