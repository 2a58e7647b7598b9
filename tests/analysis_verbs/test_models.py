"""`gbeam models`: every model has a row; what fails or may be doubted says why, and the study goes on."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gbeam import Hub, ResponseSettings, SmoothStep, simulate
from gbeam.analysis.model_study import SHAPES_FINE, shape_tail
from gbeam.cli import main

from ..scenarios import APPENDAGE, SLEW, model, response
from .beams import structure_2009

SCENARIO = (
    APPENDAGE
    + model("FOAM", 1, 2, 0)
    + SLEW.replace("60 rpm", "6 rad/s").replace("2 s", "4 s")
    + response("6 s", residual_from="5 s")
    + "tolerance = 1e-3\n"
)


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """Call the verb with changes: exit status, JSON, stderr."""
    monkeypatch.chdir(tmp_path)
    Path("slew.toml").write_text(SCENARIO, encoding="utf-8")

    def run(*changes):
        status = main(["models", "slew.toml", "--json", *(word for it in changes for word in ("--set", it))])
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        told = json.loads(said.out)
        return status, {it["model"]: it for it in told.get("rows", ())}, said.err

    return run


def test_tlam_beyond_its_critical_speed_says_so_in_its_row(call):
    status, rows, _ = call()
    assert status == 0 and set(rows) == {"TLAM", "FOAM", "SFOAM", "CFOAM", "exact"}
    assert rows["TLAM"]["outcome"] == "diverged" and "2.91" in rows["TLAM"]["message"]
    assert rows["TLAM"]["peak"] is None is rows["TLAM"]["peak_error"]
    assert abs(rows["FOAM"]["peak_error"]) < 0.1 and rows["exact"]["difference"] == 0.0
    assert not rows["exact"]["warnings"] and rows["exact"]["error_estimate"] < 1e-3


def test_a_step_too_coarse_is_said_of_exact(call):
    status, rows, _ = call("response.step=0.2 s")
    assert status == 0
    assert any("above the tolerance" in it for it in rows["exact"]["warnings"])


def test_models_that_do_not_fit_the_scenario_do_not_end_the_study(call):
    """A damping ratio for each of the three modes: SFOAM has two, exact nine."""
    status, rows, said = call("beam.damping_ratio=[0.01, 0.01, 0.01]")
    assert status == 1 and "nothing to compare with, exact cannot" in said
    for kind in ("SFOAM", "exact"):
        assert rows[kind]["outcome"] == "cannot" and "damping_ratio lists 3" in rows[kind]["message"]
    assert rows["FOAM"]["outcome"] == "done" and rows["FOAM"]["peak"] > 0.5
    assert rows["FOAM"]["peak_error"] is None


@pytest.mark.parametrize(("rotations", "fine"), [(3, False), (6, True)])
def test_too_few_shapes_show_in_the_last(rotations, fine):
    structure = structure_2009("exact", 3, rotations)
    hub = Hub(radius=0.5, rate=SmoothStep(6.0, 4.0))
    response = simulate(structure, hub, ResponseSettings(duration=5.0, step=0.04))
    assert (shape_tail(structure, response) < SHAPES_FINE) == fine
