"""Every kind of result has every output, and every number in them a declaration."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import gbeam as gb
from gbeam.figures import figure_names, figures_of
from gbeam.report import VERBS, as_json, facts, json_schema_of_results, reference_of_results, report_of_file
from gbeam.results import KINDS, Figured, paths_of, tree_of

PAGE = Path(__file__).parents[2] / "docs" / "results.md"


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_every_output(matrix: dict[str, Any], kind: str, tmp_path: Path) -> None:
    result = matrix[kind]
    assert type(result).__name__ == kind
    known = json.loads(as_json(facts(result)))
    # A response alone is a study of one.
    assert known["form"] == {"kind": "Study" if kind == "Response" else kind, "version": 1} and known["outcome"]
    assert result.to_xarray().attrs is not None
    result.save(tmp_path / "x.nc")
    with xr.open_dataset(tmp_path / "x.nc") as saved:
        assert json.loads(str(saved["facts"].values))["form"] == known["form"]
    result.report(tmp_path / "x.html")
    page = (tmp_path / "x.html").read_text(encoding="utf-8")
    again = report_of_file(tmp_path / "x.nc")
    assert "<table>" in page and f"gbeam {kind}" not in page  # but the verb that answers so
    shown = re.sub("<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"[a-z]\^[0-9]", shown)  # units as they are printed
    assert again == page or kind == "ModelStudy"  # whose histories no file keeps
    (tmp_path / "x.json").write_text(as_json(known), encoding="utf-8")
    assert "<table>" in report_of_file(tmp_path / "x.json")
    assert result._repr_html_() and repr(result)
    assert isinstance(result, Figured) and figures_of(result)


WRONG = ("nonsense", 3, 1.5, ("a",), ["a"], {"a": 1}, object())


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_result_is_asked_wrongly_is_refused_by_name(matrix: dict[str, Any], kind: str, tmp_path: Path) -> None:
    """Never what Python says of an attribute, a type or a place that is not there."""
    result = matrix[kind]
    named = ("plot", "ranked", "signal", "coordinate", "at")
    for wrong in WRONG:
        for name in named:
            if callable(getattr(result, name, None)):  # the times of a fit have such a name too
                with pytest.raises(gb.InputError):
                    getattr(result, name)(wrong)
        if not isinstance(wrong, str):
            for name in ("save", "report", "to_mat"):
                if hasattr(result, name):
                    with pytest.raises(gb.InputError, match="path"):
                        getattr(result, name)(wrong)
            with pytest.raises(gb.InputError, match="title"):
                result.plot(title=wrong)
    for name in ("save", "report"):  # of the disk, as documented
        with pytest.raises(OSError):
            getattr(result, name)(tmp_path / "none" / "x")


def test_files_of_another_type_or_that_are_missing_are_refused_by_name(tmp_path: Path) -> None:
    for read in (gb.Section.read, gb.ImportedModel.read):
        for wrong in (3, None, [], b"a"):
            with pytest.raises(gb.InputError, match="paths"):
                read(wrong)  # type: ignore[arg-type]
    with pytest.raises(gb.InputError, match="is no file"):
        gb.Section.read(tmp_path / "none.K")


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_json_is_declared(matrix: dict[str, Any], kind: str) -> None:
    known = json.loads(as_json(facts(matrix[kind])))
    schemas = json.loads(json_schema_of_results())["$defs"]
    _held(known, schemas["Study" if kind == "Response" else kind], kind)
    if kind == "Response":
        for each in known["motions"].values():
            _held(each, schemas[kind], kind)
    assert dict(paths_of(tree_of(KINDS[kind])))


def _held(value: Any, schema: dict[str, Any], place: str) -> None:
    """Everything in a value is what the schema says; else an error names the place."""
    types = schema.get("type", [])
    words = {dict: "object", list: "array", str: "string", bool: "boolean", type(None): "null"}
    word = words.get(type(value), "number")
    assert word in types or value == schema.get("const") or value in schema.get("enum", ()), f"{place} is {word}"
    if isinstance(value, dict) and "properties" in schema:
        for key, each in value.items():
            inner = schema["properties"].get(key, schema.get("additionalProperties"))
            assert inner is not None or key == "lines", f"{place}.{key} is not declared"
            if inner is not None:
                _held(each, inner, f"{place}.{key}")
    if isinstance(value, list) and "items" in schema:
        for each in value:
            _held(each, schema["items"], f"{place}[i]")


def test_every_kind_of_json_has_a_page() -> None:
    assert {*VERBS} == {*KINDS} - {"Response"}  # which is a study of one


def test_the_page_of_results_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == reference_of_results()


def test_what_may_be_measured_is_known_before_anything_is_computed() -> None:
    slew = "examples/hubbeam2009_slew_2p8.toml"
    with pytest.raises(gb.InputError, match=r"'tip\.w\.maximum' is no figure of run; did you mean"):
        gb.sweep(slew, ["beam.length=7 m, 8 m"], ["tip.w.maximum"])
    with pytest.raises(gb.InputError, match="is no figure of modes; did you mean"):
        gb.sensitivity(slew, ["modes[0].frequenzy"], verb="modes")


def test_figures_have_the_names_that_type_checkers_know(matrix: dict[str, Any]) -> None:
    """All that there are, and no other, of every kind whose figures have fixed names."""
    comparison, plan = (matrix[kind] for kind in ("Comparison", "MachinePlan"))
    axes = replace(plan.axes, jerk=plan.axes.rate)
    wide = [replace(comparison, shock=True, peak_flight=1.0 + np.eye(3)[i]) for i in range(3)]
    several = {
        "MachinePlan": [replace(plan, axes=axes)],
        "Comparison": [replace(each, peak_centrifuge=np.ones(3)) for each in wide],
    }
    named = {kind: figure_names(type(each)) for kind, each in matrix.items() if isinstance(each, Figured)}
    open_names = {"Study", "Response", "Rest", "Sweep", "Sensitivity"}
    assert {kind for kind, names in named.items() if not names} == open_names
    for kind, names in named.items():
        if names:
            drawn = [what for each in several.get(kind, [matrix[kind]]) for what in figures_of(each)]
            assert sorted(set(drawn)) == sorted(names), kind
