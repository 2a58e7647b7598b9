"""Stress of meshes in a system: of one that is clamped the specimen's, beside a beam the larger, in every output."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.report import report_of, text, viewer_data

from ..calling import main
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
        stress, wanted = ours.bodies["strip"].solid, theirs.solid
        assert stress.worst.node == wanted.worst.node and stress.points == ("half", "tip")
        assert stress.worst.von_mises == pytest.approx(wanted.worst.von_mises, rel=2e-3)
        strain = wanted.strain_at("half")
        read = np.interp(wanted.time, ours.time, stress.strain_at("half"))
        np.testing.assert_allclose(read, strain, atol=2e-3 * np.abs(strain).max())


def test_limits_at_points_of_a_mesh_in_a_system_are_the_specimens() -> None:
    accept: dict[str, Any] = {"damage": 100.0, "srs": 100.0}
    wanted = gb.compare(*specimen(), accept=accept, damage_at="half", control={"half": 1.0})
    sensor = gb.Sensor(turn=(0.5, 0.0, 0.0), frequency=40.0)
    read, alone = both()[1].reading_at("strip.half", sensor), specimen()[1].reading_at("half", sensor)
    sensed = [
        gb.compare(*each, control={at: 1.0}, sensors={at: sensor}).shock
        for each, at in ((specimen(), "half"), (both(), "strip.half"))
    ]
    np.testing.assert_allclose(read, alone, atol=2e-3 * np.abs(alone).max())
    np.testing.assert_allclose(sensed[1].centrifuge, sensed[0].centrifuge, rtol=2e-3)
    assert sensed[1].control == "strip.half (100 %, as its sensor reads)"
    judged = gb.compare(*both(), accept=accept, damage_at="strip.half", control={"strip.half": 1.0}, point="strip.tip")
    for one, theirs in zip(judged.criteria, wanted.criteria, strict=True):
        assert one.name == theirs.name and np.isfinite(one.value)
        assert one.value == pytest.approx(theirs.value, rel=0.02), one.name


def test_the_larger_stress_of_a_mesh_and_a_beam_is_judged() -> None:
    flight, machine = both()
    compared = gb.compare(flight, machine, point="strip.tip", damage_at="rod.half")
    largest = max(flight.bodies["strip"].solid.worst.von_mises, flight.bodies["rod"].peaks.loads.largest_stress.value)
    assert compared.peaks["stress"].flight == pytest.approx(largest, rel=1e-3)
    assert compared.fatigue is not None and compared.fatigue.place == "at rod.half"
    alone = gb.compare(*runs(beam()), damage_at="half").fatigue
    assert alone is not None and compared.fatigue.damage_ratio == pytest.approx(alone.damage_ratio, rel=0.02)


def test_stress_of_a_mesh_in_a_system_stands_in_every_output(tmp_path: Path) -> None:
    import xarray as xr

    flight, _ = both()
    words = text(flight)
    assert "strip: von Mises" in words and "strip: margin on yield not known" in words
    flight.save(tmp_path / "flight.nc")
    with xr.open_datatree(tmp_path / "flight.nc") as tree:
        assert tree["strip_solid_point_von_mises"].dims == ("time", "strip_point")
        np.testing.assert_allclose(tree["strip_solid_von_mises"], flight.bodies["strip"].solid.von_mises, rtol=1e-6)


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
    assert main(["run", str(scenario), "--out", str(tmp_path / "out"), "--report", "--verbose"]) == 1
    printed = capsys.readouterr()
    assert "von Mises" in printed.out and "NOT ACCEPTED: stress" in printed.err
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "von Mises stress" in page and "margin" in page


def test_at_rest_a_mesh_has_the_stress_of_its_section() -> None:
    """Half-way along a bar under its own weight M c/I, alone and clamped in a system; the same place is the worst."""
    g, x = 78.5, L - HALF
    alone = gb.static(strip(), acceleration=(0.0, 0.0, g))
    held = gb.static(gb.System({"strip": strip()}, {"clamp": gb.Joint("fixed", "strip")}, gravity=(0.0, 0.0, -g)))
    bent = METAL.density * B * H * g * x**2 / 2 * (H / 2) / (B * H**3 / 12)
    assert alone.solid is not None
    for stress in (alone.solid, held.bodies["strip"].solid):
        assert stress.point_stress[0, 0, 0] == pytest.approx(bent, rel=5e-3)
        assert stress.worst.node == alone.solid.worst.node
        assert stress.worst.von_mises == pytest.approx(alone.solid.worst.von_mises, rel=1e-6)
    assert all("von Mises, MPa" in text(each) for each in (replace(alone, motion="push"), held))
    for result in (alone, held):
        page = report_of(result)
        assert "Largest stress, and where it is" in page and f"{1e-6 * alone.solid.worst.von_mises:.3g}"[:3] in page


def test_a_mesh_in_a_system_is_drawn_where_it_is() -> None:
    """Its surface moves about its root as that of the specimen alone does, in the machine that carries both."""
    alone, _ = viewer_data(gb.Study("", {"machine": specimen()[1]}, ()))
    among, _ = viewer_data(both()[1])
    (one,), (two,) = alone["scene"]["motions"], among["scene"]["motions"]
    ours = next(part for part in two["parts"] if "surface" in part)

    for part, motion in ((one["parts"][0], one), (ours, two)):
        assert part["surface"]["largest"] == pytest.approx(specimen()[1].solid.worst.von_mises, rel=2e-3)
        assert motion["arm"] == 3.3 and motion["controlPlace"] == [0.22, 0.0, 0.0]
        assert motion["extent"][1][0] == pytest.approx(L) and motion["axes"]["shape"][1] == 3
    assert "frame" not in ours  # its root rests on the base
    assert one["largest"] == pytest.approx(two["largest"], rel=2e-3)


def test_modes_of_a_mesh_are_drawn_by_its_surface() -> None:
    """Alone and in a system the same, 15 % of its size, coloured by stress; static shapes are no modes."""
    alone = gb.modes(strip())
    system = gb.System({"strip": strip()}, {"clamp": gb.Joint("fixed", "strip")})
    held = gb.modes(system)
    count = len(alone.frequency)
    np.testing.assert_allclose(held.frequency, alone.frequency, rtol=1e-6)
    assert count == strip().resolved < strip().size
    assert held.reached == pytest.approx(alone.frequency[-1], rel=1e-6)
    drawn = []
    for result in (alone, held):
        header, numbers = viewer_data(result)
        assert len(header["modes"]["motions"]) == len(result.frequency)
        motion = header["modes"]["motions"][1]
        (surface,) = (part["surface"] for part in motion["parts"] if "surface" in part)
        shapes, sizes = (
            numbers.array[ref["at"] :][: np.prod(ref["shape"])].reshape(ref["shape"])
            for ref in (surface["shapes"], surface["sizes"])
        )
        moved = np.einsum("ts,sva->tva", sizes, shapes)
        assert np.linalg.norm(moved, axis=-1).max() == pytest.approx(motion["largest"], rel=1e-4)
        np.testing.assert_allclose(moved[0], moved[-1], atol=1e-6 * motion["largest"])  # one period
        assert surface["largest"] > 0 and motion["period"] == 2.0
        drawn.append(np.abs(moved[0]) / np.abs(moved[0]).max())
    np.testing.assert_allclose(*drawn, atol=1e-4)
    (rest,) = viewer_data(gb.static(strip(), acceleration=(0.0, 0.0, 78.5)))[0]["scene"]["motions"]
    assert "surface" in rest["parts"][0] and rest["largest"] == pytest.approx(
        np.linalg.norm(gb.static(strip(), acceleration=(0.0, 0.0, 78.5)).tip), rel=0.02
    )
