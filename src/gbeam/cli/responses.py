"""Verbs of responses: ``gbeam run`` and ``models``; and of results: ``gbeam report`` and ``rerun``."""

from __future__ import annotations

import io
import json
import math
import re
import shlex
from collections.abc import Iterator
from contextlib import redirect_stdout, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.failures import FAILED, complain
from gbeam.cli.options import IgnoreLimits, Json, Out, Output, ScenarioFile, read
from gbeam.cli.outputs import deliver, show
from gbeam.cli.process import Watch, figures_wanted
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.errors import InputError
from gbeam.printable import printable

if TYPE_CHECKING:
    from gbeam.results.provenance import Provenance
    from gbeam.results.study import Reproduction


def run(
    scenario: ScenarioFile,
    /,
    *,
    output: Output = Output(),
    ignore_limits: IgnoreLimits = False,
) -> int:
    """Compute the response in every environment of a scenario, and compare them.

    Writes result.nc, plots and with --report report.html into --out, by default out/ and the scenario's name; with
    --json only if --out or --report is given. Exit status: 0 done, 1 the computation failed, a machine's limit is
    exceeded or a [motion.NAME.accept] is not met or not decided, 2 the input is wrong.
    """
    folder = output.folder(scenario, always=True)
    loaded = read("run", scenario, output.overrides)
    if folder is not None:
        # A second of imports during the computation, which leaves a core idle.
        Thread(target=_import_leaves, daemon=True).start()

    from gbeam.analysis.environments import study
    from gbeam.results.criteria import NOT_ACCEPTED, NOT_DECIDED

    with Watch() as watch, loaded.placing():
        answer = study(loaded.case, watch)

    deliver(answer, "result", folder, output, verb="run", suffix=".nc", page="report")
    for name, failure in answer.unfinished.items():
        complain(f"motion.{name} {failure.outcome}: {failure.message}")
    for name, limits in answer.exceeding.items():
        complain(f"motion.{name} limits exceeded: {limits}" + (" (allowed)" if ignore_limits else ""))
    refused = {NOT_ACCEPTED: answer.not_accepted, NOT_DECIDED: answer.not_decided}
    for decision, reasons in refused.items():
        for name, reason in reasons.items():
            complain(f"motion.{name} {decision}: {reason}")
    accepted = not any(refused.values()) and (ignore_limits or not answer.exceeding)
    return 0 if answer.outcome == "done" and accepted else FAILED


def _import_leaves() -> None:
    with suppress(Exception):  # the import where it is needed raises it again
        if figures_wanted():
            import gbeam.plots.output
        import gbeam.io.netcdf  # noqa: F401


def models(
    scenario: ScenarioFile,
    /,
    *,
    point: Annotated[
        str | None, Parameter(help='Of a system, the point compared, "arm.tip"; else the tip that deflects most.')
    ] = None,
    output: Output = Output(),
) -> int:
    """Compute a scenario by every model, and compare them with the exact one.

    Peak, residual vibration, its phase and the cost. A model that diverges or cannot answer has a row that says why.
    The exact model in three dimensions takes minutes. With --out also writes models.json and a plot, with --report
    models.html. Exit status: 0 done, 1 exact has no answer to compare with, 2 the input is wrong.
    """
    folder = output.folder(scenario)
    loaded = read("models", scenario, output.overrides)

    from gbeam.analysis.model_study import compare_models

    with Watch() as watch, loaded.placing(point="--point"):
        study = compare_models(loaded.case, progress=watch, point=point)
    deliver(study, "models", folder, output, listed=False)
    for row in study.rows:
        if row.model == study.reference and row.outcome != "done":
            complain(f"motion.{row.motion}: nothing to compare with, {row.model} {row.outcome}: {row.message}")
    return 0 if study.compared else FAILED


_NAMES = {"result": "report", "sweep": "report"}  # of pages; all others have the name of their file


def report(
    result: Annotated[Path, Parameter(help="A result.nc of `gbeam run`, its folder, or the JSON of another verb.")],
    /,
    *,
    out: Out = None,
) -> int:
    """Write a result as one page of HTML that opens without a network: tables, plots that zoom, the motion in 3-D.

    Nothing is computed: what the page says is in the file. It goes beside the file, or into --out. Exit status: 0 done,
    2 the file cannot be read or holds no result that has a report.
    """
    from gbeam.report.page.result import file_in, report_of_file

    file = file_in(result) if result.is_dir() else result
    folder = file.parent if out is None else out
    refuse_unwritable(folder)
    with Watch(f"reading {file}"):
        page = report_of_file(file)
    name = f"{_NAMES.get(file.stem, file.stem)}.html"
    (file_written,) = publish(folder, lambda hidden: (hidden / name).write_text(page, encoding="utf-8"))
    print(printable(str(file_written)))
    return 0


def rerun(
    result: Annotated[Path, Parameter(help="A result.nc of `gbeam run`, or the file of another verb.")],
    /,
    *,
    json: Json = False,
) -> int:
    """Compute a result again, from the scenario and the records that its file holds, and compare every number.

    Of verbs other than run the command is run again, on that scenario. Their JSON, such as modes.json, holds no
    records: these are read from where they were.

    It is reproduced where nothing differs in the last digit; with other versions, or on another platform, where nothing
    differs by more than rounding: 1e-12 of the largest value of its unit, or 1e-9 of its own. Says what differs, and
    what has changed since. Writes nothing. Exit
    status: 0 reproduced, 1 not, 2 the file cannot be read or holds no scenario.
    """
    from gbeam.report.facts import reproduction_json, reproduction_text

    reproduction = answer_again(result) if result.suffix == ".json" else _of_netcdf(result)
    show(reproduction_text(reproduction), reproduction_json(reproduction), json)
    if not reproduction.reproduced:
        complain(f"not reproduced: {reproduction.excess_count} of {reproduction.compared} differ")
        return FAILED
    return 0


# Keys that are not compared: about the computation or the form, or figures in words.
_LONGEST = 1000  # characters of a path with a unit: its patterns take the third power of it
_ABOUT = {"provenance", "files", "seconds", "written", "lines", "messages", "units", "form"}


def _of_netcdf(file: Path) -> Reproduction:
    """Compute the responses of a netCDF file, or run its verb, again, and compare every value."""
    from gbeam.io.netcdf import read_stored
    from gbeam.scenario.rerun import facts_of, is_run, origin_of, run_again

    with Watch(f"reading {file} and computing it again") as watch:
        stored = read_stored(file)
        if is_run(stored):
            return run_again(file, stored, watch)
    origin = origin_of(file, stored)
    facts = facts_of(stored)
    if not facts:
        raise InputError(str(file), "holds no figures to compare", "give the JSON of its verb")
    return _compared(file, facts, origin)


def answer_again(file: Path) -> Reproduction:
    """Run the command of a verb's JSON again, on the scenario that the JSON holds, and compare every value."""
    from gbeam.scenario.rerun import check_origin

    facts, origin = _read(file)
    check_origin(str(file), origin)
    return _compared(file, facts, origin)


def _compared(file: Path, facts: dict[str, Any], origin: Provenance) -> Reproduction:
    """Run the command of a file again, and compare its facts with those that the file holds."""
    from gbeam.results.facts import ANY, paths_of
    from gbeam.results.study import KINDS, tree_of_answers
    from gbeam.scenario.rerun import record_changes, reproduction

    with TemporaryDirectory(prefix="gbeam-") as folder:
        facts_now = _answered(file, origin, Path(folder), tuple(record_changes(origin, Path(folder))))
    kind = facts_now.get("form", {}).get("kind")
    declared = paths_of(tree_of_answers(KINDS[kind])) if kind in KINDS else ()
    units = {re.compile(re.escape(form).replace(re.escape(ANY), ".+")): entry.unit or "1" for form, entry in declared}
    forms = {name: form for tree in (facts, facts_now) for name, form, _ in _leaves(tree)}

    def unit_of(name: str) -> str:
        possible = [form for form in (forms[name], forms[name].removesuffix("[i]")) if len(form) <= _LONGEST]
        unit = next((unit for pattern, unit in units.items() if any(map(pattern.fullmatch, possible))), "")
        if unit == "mixed":
            return _unit_of_row(facts, name)
        return "" if unit == "unit" else unit  # a unit that another key says

    values_before = {name: value for name, _, value in _leaves(facts)}
    values_now = {name: value for name, _, value in _leaves(facts_now)}
    return reproduction(str(file), values_before, values_now, origin, unit_of)


_ROWS = {"A": "states", "B": "states", "C": "outputs", "D": "outputs"}  # of a state-space model, with their units


def _unit_of_row(facts: dict[str, Any], name: str) -> str:
    """Unit of a row of a state-space model's matrix, over those of its columns, or empty of all else."""
    matrix, _, row = name.partition(".")
    try:
        return f"{facts[_ROWS[matrix]][int(row)]['unit']} of {matrix}"
    except (KeyError, IndexError, TypeError, ValueError):  # also of a damaged file
        return ""


def _read(file: Path) -> tuple[dict[str, Any], Provenance]:
    """Facts of a verb's JSON and their provenance. InputError if it has none."""
    from pydantic import TypeAdapter, ValidationError

    from gbeam.guards.limits import read_json
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


def _answered(file: Path, origin: Provenance, folder: Path, changes: tuple[str, ...]) -> dict[str, Any]:
    """Run the command of a provenance again, on its scenario with changes, and return the JSON that it prints."""
    from gbeam.cli.program import parsed

    scenario = folder / "scenario.toml"
    scenario.write_text(origin.scenario, encoding="utf-8")

    try:
        verb, bound = parsed(shlex.split(origin.command)[1:])
    except ValueError as error:
        raise InputError(str(file), f"names a command that cannot be run ({error})", "run the verb again") from None
    arguments = bound.arguments
    if "scenario" not in arguments:
        raise InputError(str(file), "is of no verb that reads a scenario", "give the result of another")
    parameters, output_before = bound.signature.parameters, arguments.get("output", Output())
    unwritten = {"write": None, "write_back": False}  # no scenario is written
    arguments |= {"scenario": scenario} | {name: value for name, value in unwritten.items() if name in parameters}
    store = None
    if "resume" in parameters:  # a sweep always has a store; its cluster may be gone
        store = folder / "out"
        arguments |= {"resume": False, "scheduler": None}
    new_output = Output((*output_before.overrides, *changes), store, json=True)
    if "output" in parameters:
        arguments["output"] = new_output
    else:  # of check
        arguments |= {"overrides": (*arguments.get("overrides", ()), *changes), "out": None, "json": True}
    printed = io.StringIO()
    with redirect_stdout(printed):
        verb(*bound.args, **bound.kwargs)
    return dict(json.loads(printed.getvalue()))


def _leaves(node: Any, name: str = "", form: str = "") -> Iterator[tuple[str, str, Any]]:
    """Yield the name, form and value of every number, text and list of numbers in facts.

    Units are declared by the form, in which rows of lists are ``[i]``.
    """
    if isinstance(node, dict):
        for key, value in node.items():
            if key not in _ABOUT:
                dot = "." if name else ""
                yield from _leaves(value, f"{name}{dot}{key}", f"{form}{dot}{key}")
    elif not isinstance(node, list):
        yield name, form, _number(node) if isinstance(node, (int, float)) else str(node)
    elif _is_array(node):
        yield name, f"{form}[i]", [math.nan if entry is None else _number(entry) for entry in node]
    else:
        for row, value in zip(_row_names(node), node, strict=True):
            yield from _leaves(value, f"{name}.{row}", f"{form}[i]")


def _row_names(rows: list[Any]) -> list[Any]:
    """Names of the rows of a table, which further rows do not change; their indices if they have no unique names."""
    names = []
    for row in rows:
        keys = ("motion", "model", "path", "name") if isinstance(row, dict) else ()
        names.append(" ".join(str(row[key]) for key in keys if key in row))
    unique = len(set(names)) == len(names)
    return names if all(names) and unique else list(range(len(rows)))


def _is_array(node: Any) -> bool:
    return isinstance(node, list) and all(isinstance(entry, (int, float)) or entry is None for entry in node)


def _number(value: float) -> float:
    """Return a number as a float; infinity for a whole number that is too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
