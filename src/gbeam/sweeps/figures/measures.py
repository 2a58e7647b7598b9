"""A measure of a case: one figure of its verb's JSON, named by the end of its path."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from gbeam.errors import InputError
from gbeam.scenario.values.paths import path_text
from gbeam.scenario.values.suggest import closest
from gbeam.sweeps.figures.answers import Facts
from gbeam.sweeps.figures.units import declared

OPTION = "--measure"
Keys = tuple[str | int, ...]
_MANY = 12  # figures that a message lists


def find(facts: Facts, name: str) -> Keys:
    """Find the figure that a measure means.

    Parameters
    ----------
    facts : mapping
        Of a case that is done.
    name : str
        The end of a path, such as ``tip.z.max_abs``; more of the path where several end so.

    Returns
    -------
    tuple of str or int
        The keys that lead to the figure.

    Raises
    ------
    InputError
        If no figure's path ends so, or several do.
    """
    every = {path_text(keys): keys for keys, _ in _figures(facts)}
    wanted = f".{name}"
    fits = [path for path in every if f".{path}".endswith(wanted)]
    if not fits:
        ends = {path[at:] for path in every for at in _starts(path)}
        near = closest(name, sorted(ends, key=lambda end: (abs(end.count(".") - name.count(".")), end)))
        fix = f"did you mean {near!r}?" if near else "take one from what the verb prints with --json"
        if name.endswith("verdict.accepted"):
            fix = "a verdict is accepted or not by limits: set them in [motion.NAME.accept]"
        raise InputError(OPTION, f"{name!r} is no figure of this", fix)
    if len(fits) > 1 and name not in fits:
        shown = ", ".join(fits[:_MANY]) + (", …" if len(fits) > _MANY else "")
        raise InputError(OPTION, f"{name!r} could be any of {len(fits)} figures", f"name one of {shown}")
    return every[name if name in fits else fits[0]]


def value_at(facts: Facts, keys: Keys) -> float:
    """The figure there; NaN where this case has none."""
    node: Any = facts
    for key in keys:
        try:
            node = node[key]
        except (KeyError, IndexError, TypeError):
            return math.nan
    return float(node) if _is_figure(node) else math.nan


def is_truth(facts: Facts, keys: Keys) -> bool:
    """Whether the figure there is true or false."""
    node: Any = facts
    for key in keys:
        node = node[key]
    return isinstance(node, bool)


def unit_at(facts: Facts, keys: Keys) -> str:
    """SI unit of the figure there; empty where it has none."""
    return declared(facts, keys) or ""


def own_keys(keys: Keys) -> Keys:
    """Keys of a figure without the name of a motion, which the scenario chose."""
    return keys[:1] + keys[2:] if keys[0] in ("motions", "comparisons") else keys


def _figures(node: Any, keys: Keys = ()) -> Iterator[tuple[Keys, float]]:
    """Every number in the facts, with its keys."""
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _figures(value, (*keys, str(key)))
    elif isinstance(node, (list, tuple)):
        for index, value in enumerate(node):
            yield from _figures(value, (*keys, index))
    elif _is_figure(node) or node is None:
        yield keys, node


def _is_figure(value: Any) -> bool:
    # A truth is a figure too: 1 where accepted.
    return isinstance(value, (int, float)) or (hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0)


def _starts(path: str) -> list[int]:
    return [0, *(match.end() for match in re.finditer(r"\.", path))]
