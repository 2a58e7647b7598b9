"""Stress of meshes in a system: of one that is clamped the specimen's, beside a beam the larger, in every output."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.cli import main
from gbeam.report.study import system_response

from ..solids.test_damage_at_points import HALF, METAL, B, H, L, beam, block, runs, solid
from ..solids.test_gauges import MACHINE, scenario

__all__ = ["scenario"]  # a fixture


@cache
def strip() -> gb.Structure:
    mesh = block("hexahedron20", (12, 1, 1), (L, B, H))
    points = {"half": (HALF, 0.5 * B, 0.5 * H)}
    return solid(mesh, METAL, points=points).reduced(modes=4, damping_ratio=0.02).structure


@cache
def specimen() -> tuple[Any, Any]:
    return runs(strip())


@cache
def both() -> tuple[Any, Any]:
    """Flown and spun: the mesh, and the same as a beam."""
    joints = {name: gb.Joint("fixed", name) for name in ("strip", "rod")}
    return runs(gb.System({"strip": strip(), "rod": beam()}, joints))


def test_a_mesh_in_a_system_has_the_stress_of_the_specimen() -> None:
    for ours, theirs in zip(both(), specimen(), strict=True):
        stress, wanted = ours.solids["strip"], theirs.solid
        assert stress.worst.node == wanted.worst.node and stress.points == ("half", "tip")
        assert stress.worst.von_mises == pytest.approx(wanted.worst.von_mises, rel=2e-3)
        strain = wanted.strain_at("half")
        read = np.interp(wanted.time, ours.time, stress.strain_at("half"))
        np.testing.assert_allclose(read, strain, atol=2e-3 * np.abs(strain).max())


def test_limits_at_points_of_a_mesh_in_a_system_are_the_specimens() -> None:
    accept: dict[str, Any] = {"damage": 100.0, "srs": 100.0}
    wanted = gb.compare(*specimen(), accept=accept, damage_at="half", control={"half": 1.0})
    judged = gb.compare(*both(), accept=accept, damage_at="strip.half", control={"strip.half": 1.0}, point="strip.tip")
    for one, theirs in zip(judged.criteria, wanted.criteria, strict=True):
        assert one.name == theirs.name and np.isfinite(one.value)
        assert one.value == pytest.approx(theirs.value, rel=0.02), one.name


def test_the_larger_stress_of_a_mesh_and_a_beam_is_judged() -> None:
    flight, machine = both()
    compared = gb.compare(flight, machine, point="strip.tip", damage_at="rod.half")
    largest = max(flight.solids["strip"].worst.von_mises, flight.beams["rod"].peaks.largest_stress.value)
    assert compared.peaks["stress"].flight == pytest.approx(largest, rel=1e-3)
    assert compared.fatigue is not None and compared.fatigue.place == "at rod.half"
    alone = gb.compare(*runs(beam()), damage_at="half").fatigue
    assert alone is not None and compared.fatigue.damage_ratio == pytest.approx(alone.damage_ratio, rel=0.02)


def test_stress_of_a_mesh_in_a_system_stands_in_every_output(tmp_path: Path) -> None:
    import xarray as xr

    flight, _ = both()
    words = system_response(flight)
    assert "strip: von Mises" in words and "strip: margin on yield not known" in words
    flight.save(tmp_path / "flight.nc")
    with xr.open_datatree(tmp_path / "flight.nc") as tree:
        assert tree["strip_point_von_mises"].dims == ("time", "strip_point")
        np.testing.assert_allclose(tree["strip_von_mises"], flight.solids["strip"].von_mises, rtol=1e-6)


def test_a_scenario_of_a_mesh_on_a_plate_is_judged_by_its_stress(
    scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run, page and measures; a limit that is not kept is refused."""
    plate = '[bodies.plate]\nkind = "rigid"\nmass = "1 kg"\ninertia = ["0.01 kg m^2", "0.01 kg m^2", "0.01 kg m^2"]\n'
    joints = '[joints.base]\nkind = "fixed"\nbody = "plate"\n'
    joints += '[joints.screws]\nkind = "fixed"\nbody = "bar"\non = "plate.root"\n'
    text = scenario.read_text(encoding="utf-8").replace("[bodies.bar]", f"{plate}[bodies.bar]", 1)
    machine = MACHINE.replace("control = { gauge = 1, tip = 1 }", 'stress = "0.1 %", control = { "bar.gauge" = 1 }')
    machine = machine.replace('"gauge"', '"bar.gauge"')
    scenario.write_text(text.replace("[response]", joints + machine + "[response]"), encoding="utf-8")
    assert main(["run", str(scenario), "--out", str(tmp_path / "out"), "--report"]) == 1
    printed = capsys.readouterr()
    assert "bar: von Mises" in printed.out and "not accepted: stress" in printed.err
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "von Mises stress" in page and "margin" in page
