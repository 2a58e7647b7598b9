"""Beams that are not straight at rest: their lines, and what a curved beam must have in common with straight ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gbeam as gb

ALUMINIUM = gb.Material(2700.0, 70e9, poissons_ratio=0.33)
SECTION = gb.Section.rectangle(0.03, 0.02)
LENGTH = 0.5
FLIGHT = gb.Flight(z=gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=100.0, start=0.1, hold=0.2))))
MACHINE = gb.Centrifuge(FLIGHT, arm=3.3, control_point=0.1, gravity=True, smoothing=0.1, span=(0.0, 1.4))


def beam(line: gb.Line | None = None, **changes: Any) -> gb.Beam:
    length = LENGTH if line is None else line.length
    built = gb.Beam(length, SECTION, ALUMINIUM, damping_ratio=0.01, rotary_inertia=True, line=line)
    return replace(built, **changes)


def straight(x: np.ndarray) -> np.ndarray:
    return np.zeros((len(x), 3))


def test_a_helix_lies_where_it_should() -> None:
    radius, pitch, turns = 0.05, 0.02, 3.0
    size = np.hypot(radius, pitch)  # per radian about the helix' axis
    angle = 2 * np.pi * turns
    line = gb.Line(size * angle, lambda x: np.stack([pitch + 0 * x, 0 * x, radius + 0 * x], axis=1) / size**2)
    at = np.linspace(0, angle, 7)
    # In axes along the first tangent and the first normal.
    tangent = np.array([radius, 0.0, pitch]) / size
    other = np.array([-pitch, 0.0, radius]) / size
    across = radius * np.stack([np.sin(at), 1 - np.cos(at), 0 * at], axis=1) + pitch * at[:, None] * [0, 0, 1]
    expected = np.stack([across @ tangent, across[:, 1], across @ other], axis=1)
    np.testing.assert_allclose(line.places(size * at)[0], expected, atol=1e-10)


@pytest.mark.parametrize("smooth", [True, False])
def test_a_line_goes_through_its_points_with_its_twist(smooth: bool) -> None:
    u = np.linspace(0, 1, 7)
    points = np.stack([np.sin(u), 1 - np.cos(u), 0.3 * u**2], axis=1)
    plain, twisted = (gb.Line.of_points(points, twist, smooth=smooth) for twist in (0.0, 0.3 + u))
    at = np.linspace(0, plain.length, 5)
    (place, axes), (_, turned) = plain.places(at), twisted.places(at)
    ends = np.unique([0.0, *plain.breaks, plain.length])
    np.testing.assert_allclose(plain.places(ends)[0], points, atol=1e-9)
    along = np.interp(at, ends, 0.3 + u)
    about = np.einsum("pba,pbc->pac", axes, turned)
    np.testing.assert_allclose(about, Rotation.from_rotvec(along[:, None] * [1, 0, 0]).as_matrix(), atol=1e-9)
    assert place[-1] == pytest.approx(points[-1], abs=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: gb.Line.of_points([[0, 0, 0]]), "points are an array"),
        (lambda: gb.Line.of_points([[0.1, 0, 0], [1, 0, 0]]), r"points\[0\] is \[0.1, 0.0, 0.0\] m"),
        (lambda: gb.Line.of_points([[0, 0, 0], [1, 0, 0], [1, 0, 0]]), r"points\[2\] is where points\[1\] is"),
        (lambda: gb.Line.of_points([[0, 0, 0], [1, 0, 0], [0, 0, 0]], smooth=False), "back onto itself"),
        (lambda: gb.Line.of_points([[0, 0, 0], [1, 0, 0]], twist=[1, 2, 3]), "twist is an array"),
        (lambda: gb.Line.of_pieces([0.0, 0.0]), "lengths are all zero"),
        (lambda: gb.Line.of_pieces([1.0], turn_y=[1, 2]), "one for each piece"),
        (lambda: gb.Line.of_pieces([1.0], turn_z=1e4), "turns the line by 1e"),
        (lambda: gb.Line(1.0, lambda x: 0 * x), r"gives an array \(64,\)"),
        (lambda: gb.Line(1.0, straight, breaks=[2.0]), "breaks reach"),
        (lambda: gb.Line(1.0, straight, corners=[1.0], turns=[[0, 0, 1]]), r"corners\[0\] is at 1 m"),
        (lambda: gb.Line(1.0, straight, corners=[0.5], turns=[0, 0, 1]), r"turns are an array \(3,\)"),
        (lambda: beam(gb.Line.of_pieces([1.0]), length=0.9), "length is 0.9 m, and the line is 1 m long"),
        (lambda: gb.assemble(beam(gb.Line.of_pieces([1.0])), "FOAM", z=1, shapes="adapted"), "shapes are adapted"),
    ],
)
def test_what_makes_no_line_is_refused(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(gb.InputError, match=message):
        make()


def flown_and_spun(specimen: Any, point: str | None = None) -> tuple[Any, Any, gb.Comparison]:
    options: dict[str, Any] = {"duration": 1.4, "step": 4e-3, "integrator": "gauss", "estimate": False}
    flight, spun = (gb.simulate(specimen, motion, **options) for motion in (FLIGHT, MACHINE))
    return flight, spun, gb.compare(flight, spun, point=point)


def test_a_line_without_curvature_is_flown_and_spun_as_the_straight_beam() -> None:
    (_, one, of_one), (_, two, of_two) = (
        flown_and_spun(gb.assemble(each, "exact", axial=0, y=0, z=2))
        for each in (beam(), beam(gb.Line.of_pieces([LENGTH])))
    )
    np.testing.assert_array_equal(one.q, two.q)
    assert {name: each.machine for name, each in of_one.peaks.items()} == pytest.approx(
        {name: each.machine for name, each in of_two.peaks.items()}, rel=1e-12
    )


def test_a_bracket_with_a_corner_is_flown_and_spun_as_two_beams_at_right_angles() -> None:
    leg, thin = 0.12, gb.Section.rectangle(0.03, 0.004)
    line = gb.Line.of_points([[0, 0, 0], [leg, 0, 0], [leg, 0, leg]], smooth=False)
    bracket = beam(line, section=thin, damping_ratio=0.0)
    flight, spun, compared = flown_and_spun(gb.assemble(bracket, "exact", [leg], axial=0, y=3, z=4, twist=3))
    each = gb.assemble(beam(section=thin, length=leg, damping_ratio=0.0), "exact", axial=0, y=2, z=3, twist=1)
    joints = {
        "clamp": gb.Joint("fixed", "foot"),
        "corner": gb.Joint("fixed", "arm", "foot.tip", turn=(0, -np.pi / 2, 0)),
    }
    *_, of_tree = flown_and_spun(gb.System({"foot": each, "arm": each}, joints), "arm.tip")
    for name in ("tip", "root_force", "root_moment"):
        one, other = compared.peaks[name], of_tree.peaks[name]
        assert (one.flight, one.machine) == pytest.approx((other.flight, other.machine), rel=5e-4), name
    np.testing.assert_allclose(compared.difference, of_tree.difference, atol=2e-3 * compared.peaks["tip"].flight)
    largest = compared.peaks["largest_load"]
    growth = gb.plan("spun", MACHINE, specimen=gb.assemble(bracket, "FOAM", axial=0, y=1, z=1, twist=1)).peaks[
        "largest_load"
    ]
    assert (
        compared.load_difference is None
        and spun.body.influence is None
        and growth.machine == pytest.approx(largest.machine, rel=1e-3)
    )
    outline = spun.body.outline
    assert outline is not None and outline.place is not None and outline.across is not None
    np.testing.assert_allclose(outline.place[[0, -1]], [[0, 0, 0], [leg, 0, leg]], atol=1e-12)
    np.testing.assert_allclose(outline.across, np.tile([0.0, 1.0, 0.0], (len(outline.points), 1)), atol=1e-12)
    np.testing.assert_allclose(outline.displacement[-1, -1], spun.tip[-1], atol=1e-6 * np.abs(spun.tip).max())
    assert flight.body.outline is not None and not len(beam().envelope)


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "CFOAM", "exact"])
def test_a_root_that_is_turned_is_a_base_that_is_turned(kind: str) -> None:
    turn = Rotation.from_rotvec([0.4, -0.3, 0.8])
    turned = beam(gb.Line.of_pieces([0.0, LENGTH], twist=[0.4, 0], turn_y=[-0.3, 0], turn_z=[0.8, 0]))
    # Both by the exact field's polynomials: a line without curvature is straight.
    straight = beam(gb.Line.of_pieces([LENGTH]))
    load = np.array([30.0, 20.0, -80.0])
    one, two = (gb.assemble(each, kind, axial=1, y=2, z=3, twist=1, shear_z=1) for each in (straight, turned))
    expected = gb.static(one, acceleration=tuple(load))
    rest = gb.static(two, acceleration=tuple(turn.apply(load)))
    np.testing.assert_allclose(rest.q, expected.q, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(rest.tip, turn.apply(expected.tip), rtol=1e-9, atol=1e-12)
    assert rest.loads is not None and expected.loads is not None
    np.testing.assert_allclose(rest.loads.section_moment, expected.loads.section_moment, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(gb.modes(two, errors=False).frequency, gb.modes(one, errors=False).frequency, rtol=1e-9)


def test_a_straight_line_is_the_straight_beam() -> None:
    one, two = (
        gb.static(gb.assemble(each, "exact", axial=1, y=2, z=3), acceleration=(30.0, 2000.0, -800.0))
        for each in (beam(), beam(gb.Line.of_pieces([LENGTH])))
    )
    np.testing.assert_array_equal(one.q, two.q)


def test_a_frame_with_a_corner_bends_and_twists_by_its_closed_form() -> None:
    """A right-angle frame of two equal legs under a force out of its plane: 2 P L³/3EI + P L³/GJ."""
    leg, force = 0.4, 1e-3
    line = gb.Line.of_points([[0, 0, 0], [leg, 0, 0], [leg, leg, 0]], smooth=False)
    of = beam(line, loads=[gb.Load(2 * leg, force=(0.0, 0.0, force))])
    tip = gb.static(gb.assemble(of, "exact", [leg], z=4, twist=2)).tip[2]
    _, _, _, torsion, bending, _ = of.stiffnesses(0.0)
    exact = force * leg**3 * (2 / (3 * bending) + 1 / torsion)
    assert tip == pytest.approx(exact, rel=1e-8)  # a constant and a linear moment in each leg


def test_the_error_of_shapes_of_a_curved_beam_is_what_more_shapes_move() -> None:
    bow = beam(
        gb.Line.of_pieces([LENGTH], turn_z=1.5, turn_y=0.4),
        masses=[gb.PointMass(LENGTH, 0.5, offset=(0.0, 0.02, 0.05))],
        loads=[gb.Load(LENGTH, force=(-20.0, 0.0, 10.0))],
    )
    few, many = (gb.assemble(bow, "exact", axial=n // 2, y=n, z=n, twist=n) for n in (3, 12))
    (coarse, fine), (lowest, truth) = ([each(s) for s in (few, many)] for each in (gb.static, gb.modes))
    moved = np.linalg.norm(coarse.tip - fine.tip) / np.linalg.norm(fine.tip)
    assert coarse.errors is not None and lowest.errors is not None
    assert coarse.errors.displacement.shapes == pytest.approx(moved, rel=0.1)
    above = lowest.frequency[:3] / truth.frequency[:3] - 1
    np.testing.assert_allclose(lowest.errors.shapes[:3], above, rtol=0.1, atol=1e-6)


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "CFOAM"])
def test_the_polynomials_begin_at_the_exact_places(kind: str) -> None:
    """And with their slopes, bodies beside the line too; to second order but for TLAM."""
    bow = beam(
        gb.Line.of_pieces([0.2, 0.0, 0.3], turn_z=[1.2, 0.5, 0.0], twist=[0.0, 0.0, 0.6]),
        masses=[gb.PointMass(0.4, 0.5, offset=(0.01, 0.02, 0.05))],
    )
    one, two = (gb.assemble(bow, each, axial=1, y=2, z=2, twist=1) for each in (kind, "exact"))
    body, exact = (structure.places[-1:] for structure in (one, two))
    np.testing.assert_allclose(body.r0, exact.r0, atol=1e-9)
    np.testing.assert_allclose(body.first, exact.first, atol=1e-9)
    q = 1e-2 * np.arange(1.0, one.size + 1)
    away = np.abs(one.particles.positions(q)[-1] - two.particles.positions(q)[-1]).max()
    assert away < (1e-3 if kind == "TLAM" else 3e-5) and (kind != "TLAM" or away > 1e-4)


def test_a_curved_beam_responds_alike_in_foam_and_in_the_exact_model() -> None:
    bow = beam(gb.Line.of_pieces([LENGTH], turn_z=1.2))
    turn = gb.Flight(z=gb.trapezoid(2.0, jerk=40.0, start=0.02, hold=0.2))
    one, two = (
        gb.simulate(gb.assemble(bow, kind, axial=1, y=3, z=3, twist=2), turn, duration=0.1, estimate=False)
        for kind in ("FOAM", "exact")
    )
    np.testing.assert_allclose(one.tip, two.tip, atol=2e-3 * np.abs(two.tip).max())
    assert one.outcome == two.outcome == "done"


def test_a_scenario_has_a_line() -> None:
    text = """
title = "a bow"
[beam]
length = "500 mm"
section = { shape = "rectangle", width = "30 mm", thickness = "20 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.33 }
damping_ratio = "1 %"
LINE
[model]
kind = "FOAM"
modes = { axial = 1, y = 2, z = 2 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "2 g" } }
[response]
duration = "1 s"
"""
    from gbeam.scenario import build, loads

    def line(written: str, length: bool = False) -> gb.Line:
        arguments = text.replace("LINE", written)
        if not length:
            arguments = arguments.replace('length = "500 mm"\n', "")
        case = build(loads(arguments))
        assert case.beam.line is not None
        return case.beam.line

    by_points = line('line = { points = [["0 mm", 0, 0], ["300 mm", 0, 0], ["300 mm", "200 mm", 0]], smooth = false }')
    np.testing.assert_allclose(by_points.places([by_points.length])[0], [[0.3, 0.2, 0.0]], atol=1e-12)
    bent = line('line = { pieces = [ { length = "100 mm" }, { turn_z = "30 deg" }, { length = "400 mm" } ] }')
    assert bent.length == pytest.approx(0.5) and bent.corners == (0.1,)
    twisted = line('line = { stations = [0, "500 mm"], twist = ["5 deg", "25 deg"] }', length=True)
    turned = Rotation.from_matrix(twisted.places([0.25])[1][0]).as_rotvec()
    np.testing.assert_allclose(turned, [np.radians(15), 0, 0], atol=1e-9)
    assert line('line = { stations = [0, "500 mm"], twist = ["5 deg", "25 deg"] }').length == pytest.approx(0.5)
    for written, message in (
        ('line = { pieces = [ { length = "1 m" } ], points = [] }', "pieces is given beside points"),
        ("line = { smooth = true }", "the line is missing"),
        ('line = { stations = [0, "500 mm"] }', "twist is missing beside stations"),
        ('line = { points = [[0, 0, 0], ["1 m", 0, 0]], twist = ["1 deg"] }', "1 values for 2 points"),
    ):
        with pytest.raises(gb.GbeamError, match=message):
            line(written)
