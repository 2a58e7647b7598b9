"""Limits at a named point, of every kind of specimen, and damage by the material where the stress is."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import gbeam as gb

from .test_damage_at_points import METAL, B, H, L, beam, block, of_beam, of_solid, runs, solid

ACCEPT: dict[str, Any] = {"tip": 0.5, "srs": 100.0}


@cache
def of_system() -> tuple[Any, Any]:
    """The beam beside one of a metal whose damage grows with another power, twice as thick."""
    other = replace(METAL, fatigue_exponent=9.0)
    section = gb.Section.rectangle(width=B, thickness=2 * H)
    thick = gb.assemble(gb.Beam(L, section, other, damping_ratio=0.02), "FOAM", axial=1, y=2, z=2)
    joints = {name: gb.Joint("fixed", name) for name in ("strip", "thick")}
    return runs(gb.System({"strip": beam(), "thick": thick}, joints))


def test_a_point_of_a_beam_and_of_its_solid_is_judged_alike() -> None:
    """Half-way they move by a third of the tip, by 0.3 %, and shake alike below their modes."""
    ours, theirs = (gb.compare(*pair(), point="half", accept=ACCEPT) for pair in (of_solid, of_beam))
    whole = gb.compare(*of_beam(), accept=ACCEPT)
    for one, other in ((ours, theirs), (theirs, ours)):
        assert one.point == "half" and one.shock is not None and one.shock.control == "half"
        assert any(each.startswith("Half: ") for each in one.findings) and "Tip" not in str(one)
        assert one.peak_flight[2] == pytest.approx(other.peak_flight[2], rel=1e-2)
        assert one.max_difference[2] == pytest.approx(other.max_difference[2], rel=2e-2)
    station = of_beam()[0].body.points.index("half")
    assert theirs.peak_flight[2] == np.abs(of_beam()[0].displacement[:, station, 2])[theirs.covered].max()
    assert theirs.peaks["tip"].flight < 0.4 * whole.peaks["tip"].flight
    assert theirs.criteria[0].value == theirs.peaks["tip"].ratio - 1 != whole.criteria[0].value
    assert theirs.stations is not None and theirs.stations.tip == station and theirs.load_difference is not None
    moved, both = of_beam()[0].displacement[:, station], theirs.stations
    np.testing.assert_allclose(both.trend_flight + both.vibration_flight, moved, atol=1e-15)
    assert np.isnan(theirs.load_difference.tip_bound).all() and np.isfinite(whole.load_difference.tip_bound).any()  # type: ignore[union-attr]
    with pytest.raises(gb.InputError, match="point is 'nose'; choose from half, tip"):
        gb.compare(*of_beam(), point="nose")


def test_the_tip_by_its_name_is_the_tip() -> None:
    named, plain = gb.compare(*of_beam(), point="tip", accept=ACCEPT), gb.compare(*of_beam(), accept=ACCEPT)
    assert [each.value for each in named.criteria] == [each.value for each in plain.criteria]
    assert named.verdict == plain.verdict


def test_the_spectra_of_a_rigid_boxs_point() -> None:
    box = gb.RigidSpecimen(
        6.5, (0, 0, 0.05), np.diag([0.03, 0.06, 0.07]), [(0.1, 0.1, 0.1)], points={"lid": (0, 0, 0.1)}
    )
    pair = runs(box.structure)
    ours, theirs = gb.compare(*pair, point="lid").shock, gb.compare(*pair, control={"lid": 1.0}).shock
    assert ours is not None and theirs is not None and ours.control == "lid"
    np.testing.assert_array_equal(ours.centrifuge, theirs.centrifuge)


def test_damage_in_a_system_is_by_the_material_of_each_beam() -> None:
    alone = gb.compare(*of_beam()).fatigue
    ours = gb.compare(*of_system(), point="strip.tip", damage_at="strip.root").fatigue
    assert alone is not None and ours is not None and ours.exponent == 4.0
    assert ours.damage_ratio == pytest.approx(alone.damage_ratio, rel=5e-3)
    thick = gb.compare(*of_system(), damage_at="thick.root").fatigue
    assert thick is not None and thick.exponent == 9.0
    most = gb.compare(*of_system(), accept={"damage": 1e6})
    assert most.fatigue is not None and most.fatigue.place == "of the root of strip"  # the thinner is stressed more
    assert most.fatigue.damage_ratio == ours.damage_ratio and np.isfinite(most.criteria[0].value)


def test_damage_of_a_solid_is_by_the_material_that_ranges_most() -> None:
    """A bar whose outer half is of another metal: its own exponent at its points, the root's without one."""
    halves = {"near": lambda x: x[:, 0] <= 0.5 * L + 1e-9, "far": lambda x: x[:, 0] >= 0.5 * L - 1e-9}
    mesh = block("hexahedron20", (12, 1, 1), (L, B, H))
    middles = mesh.points[mesh.cells[0].data[:, :8]].mean(axis=1)
    mesh.cell_sets = {name: [np.flatnonzero(of(middles))] for name, of in halves.items()}
    materials = {"near": METAL, "far": replace(METAL, fatigue_exponent=9.0)}
    outer = solid(mesh, materials, points={"out": (0.75 * L, 0.5 * B, 0.5 * H)})
    pair = runs(outer.reduced(modes=4, damping_ratio=0.02).structure)
    usual, whole = gb.compare(*pair).fatigue, gb.compare(*of_solid()).fatigue
    assert usual is not None and usual.exponent == 4.0 and usual.place == "where near is stressed most"
    assert whole is not None and whole.place == "where it is stressed most"
    assert usual.damage_ratio == pytest.approx(whole.damage_ratio, rel=1e-3)
    at = gb.compare(*pair, damage_at="out").fatigue
    assert at is not None and at.exponent == 9.0
