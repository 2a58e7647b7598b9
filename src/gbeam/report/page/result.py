"""The page of a result, of one in memory or of a file that a verb wrote, and the viewer in a notebook."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.figures.registry import Describe, figures_of
from gbeam.guards.limits import parse_json, read_json
from gbeam.io.netcdf import FACTS, groups_of, read_stored
from gbeam.report.facts import facts, json_form, origin_json
from gbeam.report.page.document import html, viewer
from gbeam.report.page.parts import Numbers
from gbeam.results.equilibrium import Rest
from gbeam.results.modal import Modes
from gbeam.results.provenance import Provenance
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.study import Study

# In motion, or in three dimensions.
SHOWN = Study, Response, Rest, Modes
_FIX = "give the result.nc of `gbeam run`, its folder, or the JSON of another verb"


def report_of(
    result: Any, facts_json: Mapping[str, Any] | None = None, figures: Mapping[str, Describe] | None = None
) -> str:
    """Return the page of a result, or of several of one kind.

    Its JSON and its figures are computed unless they are given.
    """
    if facts_json is None:
        facts_json = facts(result) | {"provenance": origin_json(result.provenance or Provenance())}
        figures = figures_of(json_form(result))
    variables: dict[str, Any] = {}
    for answer in result if isinstance(result, tuple) else (result,):
        if isinstance(answer, SHOWN):
            variables |= variables_of(answer)
    return html(facts_json, variables, figures=figures)


def variables_of(result: Result) -> dict[str, Any]:
    """Return the arrays of a result's file by path. Those of a result listed by motion stand under that motion."""
    record = json_form(result)
    folder = f"motions/{getattr(record, record.listed_by)}" if record.listed_by else ""
    arrays = {}
    for path, group in groups_of(record).items():
        prefix = f"{path or folder}/" if path or folder else ""
        for name, variable in (group.variables | group.coordinates).items():
            arrays[f"{prefix}{name}"] = variable.values
    return arrays


def viewer_data(result: Result) -> tuple[dict[str, Any], Numbers]:
    """Header and numbers of a result in the viewer; InputError if it has nothing to show."""
    numbers, facts_json = Numbers(), facts(result)
    view = viewer(
        facts_json["form"]["kind"], facts_json, variables_of(result) if isinstance(result, SHOWN) else {}, numbers
    )
    if not view:
        kind = type(result).__name__
        problem = (
            f"{kind} is of nodes, with no surface to show" if isinstance(result, SHOWN) else f"{kind} has no motion"
        )
        raise InputError("result", problem, "print it, or plot it")
    return {"plots": [], "maps": [], **view}, numbers


def write_report(result: Result, path: str | os.PathLike[str]) -> None:
    """Write the page of a result into a file."""
    page = report_of(result)  # first: what fails leaves the file as it is
    Path(path).write_text(page, encoding="utf-8")


def report_of_file(path: Path) -> str:
    """Return the page of a result that a verb wrote: a netCDF file, JSON, or a folder with one of them."""
    file = file_in(path) if path.is_dir() else path
    try:
        with np.errstate(all="ignore"):  # what a damaged file holds beyond all bounds is drawn as a gap
            return _page_of(file)
    except InputError as error:
        raise error.at(str(file)) from None
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError):  # no figures of a result
        raise InputError(str(file), "holds no whole result: it was changed or is damaged", _FIX) from None


def _page_of(file: Path) -> str:
    """Page of a JSON or netCDF file, as HTML."""
    if file.suffix == ".json":
        return html(read_json(file, _FIX))
    stored = read_stored(file)
    text = stored.variables.get(FACTS)
    if not isinstance(text, str):
        raise InputError(str(file), "holds no figures of a result that has a report", _FIX)
    facts, variables = parse_json(text), stored.variables
    if variables.keys() & {"time", "hangs_on"} and len(facts.get("motions", ())) == 1:  # the root is the motion
        (name,) = facts["motions"]
        variables = {f"motions/{name}/{key}": values for key, values in variables.items()}
    return html(facts, variables, origin_json(stored.provenance))


def file_in(folder: Path) -> Path:
    """Return the file of the only result in a folder; InputError if there is none, or several."""
    if (folder / "result.nc").is_file():
        return folder / "result.nc"
    files = sorted(folder.glob("*.json"))
    if not files:
        raise InputError(str(folder), "holds no result", _FIX)
    if len(files) > 1:
        names = ", ".join(file.name for file in files[:4])
        raise InputError(str(folder), f"holds several results, {names}", _FIX)
    return files[0]


def widget(result: Result) -> Any:
    """Return the viewer of a result as a widget of Jupyter."""
    header, numbers = viewer_data(result)
    try:
        import anywidget
        import traitlets
    except ModuleNotFoundError:
        fix = "pip install 'gbeam[notebook]'; report(path) needs nothing"
        raise InputError("view", "needs the package anywidget, which is not installed", fix) from None
    assets = files("gbeam.report.page") / "assets"

    class Viewer(anywidget.AnyWidget):
        """The structure in motion."""

        _esm = (assets / "gbeam.js").read_text(encoding="utf-8")
        _css = (assets / "gbeam.css").read_text(encoding="utf-8")
        header = traitlets.Unicode().tag(sync=True)
        numbers = traitlets.Bytes().tag(sync=True)

    return Viewer(header=json.dumps(header, allow_nan=False), numbers=numbers.array.tobytes())
