"""The JSON of a verb computed again, by the command that it names."""

from __future__ import annotations

import io
import json
import math
import shlex
from collections.abc import Iterator
from contextlib import redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError
from gbeam.scenario.values.paths import walk

if TYPE_CHECKING:
    from gbeam.results.provenance import Provenance
    from gbeam.results.reproduction import Reproduction

_ABOUT = {"provenance", "files", "seconds", "written", "lines"}  # of the computation, or the figures in words


def answer_again(file: Path) -> Reproduction:
    """Run the command of a verb's JSON again, on the scenario that the JSON holds, and compare every value.

    Parameters
    ----------
    file : Path
        Such as modes.json.

    Raises
    ------
    InputError
        If it is no such file, or the scenario or a record is not the one that was run.
    """
    from gbeam.scenario.rerun import checked, records, reproduction

    facts, origin = _read(file)
    checked(str(file), origin)
    with TemporaryDirectory(prefix="gbeam-") as folder:
        scenario = Path(folder) / "scenario.toml"
        scenario.write_text(origin.scenario, encoding="utf-8")
        again = _answered(file, origin, scenario, tuple(records(origin, Path(folder))))
    return reproduction(str(file), dict(_leaves(facts)), dict(_leaves(again)), origin)


def _read(file: Path) -> tuple[dict[str, Any], Provenance]:
    from pydantic import TypeAdapter, ValidationError

    from gbeam.guards.json_files import read_json
    from gbeam.results.provenance import Environment, Provenance

    fix = "give the JSON that a verb of gbeam wrote into --out, or a result.nc"
    facts = read_json(file, fix)
    try:
        origin = facts["provenance"]
        environment = TypeAdapter(Environment).validate_python(origin)
        origin = origin | {"sha256": origin["scenario_sha256"], "environment": environment}
        return facts, TypeAdapter(Provenance).validate_python(origin)
    except (ValidationError, KeyError, TypeError):
        raise InputError(str(file), "is no JSON of gbeam with a provenance", fix) from None


def _answered(file: Path, origin: Provenance, scenario: Path, changes: tuple[str, ...]) -> dict[str, Any]:
    from gbeam.cli.program import parsed

    try:
        verb, bound = parsed(shlex.split(origin.command)[1:])
    except ValueError as error:
        raise InputError(str(file), f"names a command that cannot be run ({error})", "run the verb again") from None
    arguments = bound.arguments
    if "scenario" not in arguments:
        raise InputError(str(file), "is of no verb that reads a scenario", "give the result of another")
    arguments |= {"scenario": scenario, "overrides": (*arguments.get("overrides", ()), *changes), "json": True}
    written = {"out": None, "report": False, "write": None, "write_back": False}  # nothing is
    arguments |= {name: value for name, value in written.items() if name in bound.signature.parameters}
    if "resume" in bound.signature.parameters:  # a sweep has a store in any case; its cluster may be gone
        arguments |= {"out": scenario.parent / "out", "resume": False, "scheduler": None}
    printed = io.StringIO()
    with redirect_stdout(printed):
        verb(*bound.args, **bound.kwargs)
    return dict(json.loads(printed.getvalue()))


def _leaves(facts: Any) -> Iterator[tuple[str, Any]]:
    """Numbers, texts and lists of numbers by their places."""
    for path, value in walk(facts, _is_array):
        place = ".".join(map(str, path))
        if not _ABOUT.isdisjoint(path):
            continue
        if isinstance(value, list):
            yield place, [math.nan if each is None else _number(each) for each in value]
        else:
            yield place, _number(value) if isinstance(value, (int, float)) else str(value)


def _is_array(node: Any) -> bool:
    return isinstance(node, list) and all(isinstance(each, (int, float)) or each is None for each in node)


def _number(value: float) -> float:
    """A float, infinite where a JSON's whole number is beyond all of them."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
