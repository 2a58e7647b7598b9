"""Values that a search may change, between which bounds, and the scenario with those that it found."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from gbeam.errors import InputError
from gbeam.scenario.load import load
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.text.edit import with_quantities
from gbeam.scenario.values.units import UnitError, argument
from gbeam.studies.parameters import PhysicalValue, physical_values

Bounds = Mapping[str, tuple[float | str, float | str]]  # by path, SI or text with a unit
_NEAR, _FAR = 0.1, 10.0  # times the scenario's value: bounds where none are given


def named(base: Scenario, names: Sequence[str], option: str) -> list[PhysicalValue]:
    """Values by their paths; InputError, of an option of the command line, if one is none."""
    try:
        return physical_values(base, names)
    except InputError as error:
        raise InputError(option, error.problem, error.fix) from None


def bounds_of(each: PhysicalValue, given: Bounds, option: str) -> tuple[float, float]:
    """Bounds of a value: those given, or a tenth to ten times the scenario's value.

    Raises
    ------
    InputError
        If they do not hold the scenario's value, with which a search begins.
    """
    if each.path in given:
        low, high = (_quantity(each, end) for end in given[each.path])
        if not low < high:
            raise InputError("--bounds", f"of {each.path} go from {low:g} to {high:g}", "give the smaller one first")
        if not low <= each.value <= high:
            fix = f"begin between them: --set {each.path}={(low + high) / 2:g}"
            raise InputError("--bounds", f"of {each.path} leave out the scenario's value, {each.value:g}", fix)
        return low, high
    if each.value == 0:
        fix = f"give a value to begin with (--set {each.path}=...), or bounds"
        raise InputError(option, f"names {each.path}, which is zero", fix)
    ends = sorted((_NEAR * each.value, _FAR * each.value))
    return ends[0], ends[1]


def with_values(
    paths: Sequence[str], values: Sequence[float], scenario: str | os.PathLike[str], folder: str | os.PathLike[str]
) -> str:
    """The scenario's text with other values, each in its own unit; all else stays, comments too.

    Parameters
    ----------
    paths : sequence of str
    values : sequence of float
        SI.
    scenario : path
        Without overrides.
    folder : path
        In which the text is to be saved.

    Raises
    ------
    InputError
        If the text is written in a way that cannot be changed, or names records that lie in another folder.
    """
    base = load(scenario)
    assert base.source is not None  # it was read from a file
    recorded = any(getattr(motion, "record", None) is not None for motion in base.motion.values())
    if recorded and Path(folder).resolve() != base.source.folder.resolve():
        fix = f"write it beside {os.fspath(scenario)}"
        raise InputError(os.fspath(folder), "is not the folder that the scenario's records are named from", fix)
    found = zip(physical_values(base, paths), values, strict=True)
    changes = {path: (value, each.kind) for each, value in found for path in (each.path, *each.followers)}
    return with_quantities(base.source, changes)


def _quantity(each: PhysicalValue, text: float | str) -> float:
    try:
        return argument(text, each.kind) if isinstance(text, str) else float(text)
    except UnitError as error:
        raise InputError("--bounds", f"of {each.path}: {error.problem}", error.hint) from None
