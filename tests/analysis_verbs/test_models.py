"""`gbeam models`: every model has a row; what fails or may be doubted says why, and the study goes on."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb
from gbeam import Hub, ResponseSettings, SmoothStep, simulate
from gbeam.analysis import SHAPES_FINE, shape_tail

from ..calling import main
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
        status = main(["models", "slew.toml", "--json", *(word for row in changes for word in ("--set", row))])
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        told = json.loads(said.out)
        return status, {row["model"]: row for row in told.get("rows", ())}, said.err

    return run


def test_tlam_beyond_its_critical_speed_says_so_in_its_row(call):
    status, rows, _ = call()
    assert status == 0 and set(rows) == {"TLAM", "FOAM", "SFOAM", "CFOAM", "fourth-order", "exact"}
    assert rows["TLAM"]["outcome"] == "diverged" and "2.91" in rows["TLAM"]["message"]
    assert rows["TLAM"]["peak"] is None is rows["TLAM"]["peak_error"]
    assert abs(rows["FOAM"]["peak_error"]) < 0.1 and rows["exact"]["difference"] == 0.0
    assert not rows["exact"]["warnings"] and rows["exact"]["error_estimate"] < 1e-3


def test_a_step_too_coarse_is_said_of_exact(call):
    status, rows, _ = call("response.step=0.2 s")
    assert status == 0
    assert any("wrong by an estimated" in warning for warning in rows["exact"]["warnings"])


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
    assert (shape_tail(structure, response.q) < SHAPES_FINE) == fine


def test_a_system_of_one_beam_has_the_rows_of_the_beam_on_a_hub() -> None:
    """The beam turns on a joint as on a hub: exact is the same equations, FOAM keeps terms of third order in a tree."""
    beam = gb.Beam(2.0, gb.Section.rectangle(0.03, 0.01), gb.Material(2700, 70e9), damping_ratio=0.01)
    rate = SmoothStep(4.0, 2.0)
    settings = ResponseSettings(3.0, step=0.01, integrator="gauss", estimate=False, residual_from=2.0)
    alone = gb.Case.of_beam("alone", beam, gb.Model("FOAM", 1, 2, 0), {"slew": Hub(radius=0.0, rate=rate)}, settings)
    structure = gb.assemble(beam, "FOAM", axial=1, y=2)
    axis = gb.Joint("revolute", "beam", axes=[(0, 0, 1)], rate=rate)
    held = gb.Case("held", gb.System({"beam": structure}, {"axis": axis}), {}, settings)
    one, other = (gb.compare_models(case, ["FOAM", "SFOAM"]) for case in (alone, held))
    (foam, short, exact), (its, shorter, same) = one.rows, other.rows
    assert other.direction == {"ground": "y"} and one.direction == {"slew": "y"}
    assert shorter.outcome == short.outcome == "done"
    assert shorter.difference == pytest.approx(short.difference, abs=2e-3)
    pushed = replace(held, system=gb.System({"beam": structure}, {"axis": replace(axis, rate=None, effort=1.0)}))
    (none, _) = gb.compare_models(pushed, ["SFOAM"]).rows
    assert none.outcome == "cannot" and "does not feel the beam" in none.message
    np.testing.assert_allclose(same.history, exact.history, atol=1e-9 * exact.peak)
    assert same.peak == pytest.approx(exact.peak, rel=1e-5)  # between steps, by the model or by samples
    assert its.difference == pytest.approx(foam.difference, abs=2e-3)
    assert its.residual == pytest.approx(foam.residual, rel=0.02) and its.phase == pytest.approx(foam.phase, abs=0.02)


def test_points_of_a_system_are_compared() -> None:
    quick = ["response.step=10 ms", "response.estimate=false"]
    case = gb.read_scenario("examples/robot_arm.toml", ["response.duration=0.5 s", *quick])
    study = gb.compare_models(case, ["FOAM"], point="forearm.root")
    assert study.direction["ground"].startswith("forearm.root") and study.rows[0].peak > 0
    with pytest.raises(gb.InputError, match="no such point"):
        gb.compare_models(case, ["FOAM"], point="forearm.top")
    rod = gb.System({"rod": gb.RigidBody(1.0, (1.0, 1.0, 1.0))}, {"axis": gb.Joint("free", "rod")})
    with pytest.raises(gb.InputError, match="have no beam"):
        gb.compare_models(gb.Case("rigid", rod, {}, ResponseSettings(1.0)))
    beam = gb.read_scenario("examples/f16_8g_turn.toml")
    with pytest.raises(gb.InputError, match="point is no point: 'top'; did you mean 'tip'"):
        gb.compare_models(beam, ["FOAM"], point="top")
    slew = gb.read_scenario(
        "examples/hubbeam2009_slew_2p8.toml", ["response.duration=2 s", "response.residual_from=1 s", *quick]
    )
    named, plain = (gb.compare_models(slew, ["TLAM"], point=point) for point in ("tip", None))
    assert [row.peak for row in named.rows] == [row.peak for row in plain.rows] and named.direction == {"slew": "tip y"}
