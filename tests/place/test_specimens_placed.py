"""Systems, solids and rigid boxes find their place by the same answers as a beam does."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam import place
from gbeam.analysis import Specimen, gradients
from gbeam.questions import QUESTIONS
from gbeam.report import text as describe

from ..calling import main
from ..scenarios import FLIGHT, SPIN, response
from ..solids.bodies import STIFF, block, solid

METAL = gb.Material(STIFF.density, STIFF.youngs_modulus)
STRIP = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), METAL, damping_ratio=0.01)
CLAMP = {"clamp": gb.Joint("fixed", "strip")}
NOW = np.linspace(0.0, 1.0, 3)


def placed(structure: Any, flight: Any, spin: Any, settings: Any, measure: str) -> Any:
    choice = gb.Choice(lambda mounting, w: spin(w), ("upright",), (0.0596,), refined=False)
    return place(structure, flight, choice, settings, {measure: 1.0}, current=spin())


@pytest.mark.parametrize("measure", ["root-moment", "tip", "vibration", "load"])
def test_a_system_of_one_beam_is_placed_as_the_beam(flight: Any, spin: Any, settings: Any, measure: str) -> None:
    structure = gb.assemble(STRIP, "exact", axial=0, y=1, z=2)
    system = gb.System({"strip": structure}, CLAMP)
    one, other = (placed(each, flight, spin, settings, measure) for each in (structure, system))
    assert other.best.control_point == pytest.approx(one.best.control_point, abs=1e-9)
    assert other.values["current"] == pytest.approx(one.values["current"], rel=1e-9)
    assert other.point == one.point == "" and other.fraction == one.fraction


@pytest.mark.parametrize("measure", ["root-moment", "tip", "load"])
def test_a_bracket_with_a_corner_is_placed_as_two_beams(flight: Any, spin: Any, settings: Any, measure: str) -> None:
    leg = 0.15
    line = gb.Line.of_points([[0, 0, 0], [leg, 0, 0], [leg, 0, leg]], smooth=False)
    strip = replace(STRIP, material=gb.Material(2700.0, 70e9, poissons_ratio=0.33))
    bent = gb.assemble(replace(strip, line=line), "FOAM", [leg], axial=0, y=3, z=4, twist=3)
    straight = gb.assemble(replace(strip, length=leg), "exact", axial=0, y=3, z=4, twist=3)
    joints = {
        "clamp": gb.Joint("fixed", "foot"),
        "corner": gb.Joint("fixed", "arm", "foot.tip", turn=(0, -np.pi / 2, 0)),
    }
    tree = gb.System({"foot": straight, "arm": straight}, joints)
    one, other = (placed(each, flight, spin, settings, measure) for each in (bent, tree))
    assert one.best.control_point == pytest.approx(other.best.control_point, abs=1e-4 * leg)
    assert one.values["best"][measure] == pytest.approx(other.values["best"][measure], rel=1e-3)


def test_a_beam_meshed_as_a_solid_is_placed_as_the_beam(flight: Any, spin: Any, settings: Any) -> None:
    mesh = solid(block("hexahedron20", (40, 1, 1), (0.3, 0.02, 0.004)), STIFF)
    structure = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=3)
    specimens = [mesh.reduced(modes=6, damping_ratio=0.01).structure, structure]
    for measure in ("root-moment", "tip", "vibration"):
        one, other = (placed(each, flight, spin, settings, measure) for each in specimens)
        assert one.best.control_point == pytest.approx(other.best.control_point, abs=1e-3 * 0.3), measure


def test_the_force_of_a_rigid_body_is_the_flights_where_its_centre_of_mass_is_the_control_point(
    flight: Any, spin: Any, settings: Any
) -> None:
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.18, 0.0, 0.0))
    answer = placed(box.structure, flight, spin, settings, "root-shear")
    assert answer.best.control_point == pytest.approx(0.18, abs=1e-6)
    assert answer.values["best"]["root-shear"] < 1e-5 and answer.values["current"]["root-shear"] > 1e-2
    assert answer.values["best"].keys() == {"root-shear", "root-moment", "load"}
    # Two equal halves of the box, joined rigidly, are the box.
    half = gb.RigidBody(1.5, np.diag([0.0] * 3), (0.1, 0, 0))
    far = gb.RigidBody(1.5, np.diag([0.0] * 3), (0.26, 0, 0), points={"end": (0.3, 0, 0)})
    joints = {"one": gb.Joint("fixed", "near"), "two": gb.Joint("fixed", "far")}
    halves = placed(gb.System({"near": half, "far": far}, joints), flight, spin, settings, "root-shear")
    assert halves.best.control_point == pytest.approx(0.18, abs=1e-6)


def test_static_answers_are_those_of_equilibrium() -> None:
    """Against the equilibrium of a beam with a body beside its axis on a slightly turning base, which knows no G."""
    beam = gb.Beam(
        0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9, poissons_ratio=0.33), damping_ratio=0.01,
        masses=[gb.PointMass(0.02, 0.2, offset=(0.0, 0.03, 0.01))],
    )  # fmt: skip
    structure = gb.assemble(beam, "exact", axial=1, y=2, z=2, twist=2)
    specimen = Specimen.from_system(gb.System.of(structure), NOW)
    from gbeam.analysis import gradients
    from gbeam.results import Base

    rng = np.random.default_rng(26)
    for _ in range(3):
        a, w, alpha = 1e-3 * rng.normal(size=3), 3e-2 * rng.normal(size=3), 1e-3 * rng.normal(size=3)
        rest = gb.solve_equilibrium(structure, Base(a, w, alpha))
        answer = specimen.displacement["body.tip"].evaluate(a, gradients(w, alpha))
        np.testing.assert_allclose(answer, structure.tip(np.asarray(rest.q)), atol=1e-4 * np.abs(answer).max())


def test_what_does_not_rest_is_refused(flight: Any, spin: Any, settings: Any) -> None:
    structure = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=2)
    hinge = {"kind": "revolute", "body": "strip", "axes": [(0, 1, 0)]}
    loose = gb.System({"strip": structure}, {"hinge": gb.Joint(**hinge)})
    with pytest.raises(gb.InputError, match=r"hinge\.angle held by nothing"):
        placed(loose, flight, spin, settings, "tip")
    moved = gb.System({"strip": structure}, {"hinge": gb.Joint(**hinge, rate=0.5)})
    with pytest.raises(gb.InputError, match=r"move hinge\.angle"):
        placed(moved, flight, spin, settings, "tip")
    held = gb.Joint(**hinge, rate=0.0)
    best = placed(gb.System({"strip": structure}, {"hinge": held}), flight, spin, settings, "tip")
    assert best.best.difference < 1e-3 and not best.warnings
    rubbed = gb.Joint(**hinge, stiffness=100.0, friction=0.1)
    assert (
        "friction of hinge.angle is left out: its joint moves freely"
        in placed(gb.System({"strip": structure}, {"hinge": rubbed}), flight, spin, settings, "tip").warnings
    )
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.18, 0.0, 0.0)).structure
    with pytest.raises(gb.InputError, match="is tip, of which the flight makes none; choose of root-shear"):
        placed(box, flight, spin, settings, "tip")


BOX = """\
[bodies.box]
kind = "rigid"
mass = "6.5 kg"
size = ["320 mm", "200 mm", "120 mm"]
middle = ["160 mm", 0, 0]
centre = ["172 mm", 0, 0]
inertia = ["0.030 kg m^2", "0.063 kg m^2", "0.076 kg m^2"]
"""
SYSTEM = """\
[bodies.box]
kind = "rigid"
mass = "6.5 kg"
centre = ["172 mm", 0, 0]
inertia = ["0.030 kg m^2", "0.063 kg m^2", "0.076 kg m^2"]
points.end = { at = ["320 mm", 0, 0] }

[joints.bolts]
kind = "fixed"
body = "box"
"""


@pytest.mark.parametrize("bodies", [BOX, SYSTEM])
def test_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], bodies: str) -> None:
    file, turning = tmp_path / "s.toml", '"table", times = [0, 0.5, 1], values = ["5 g", "5 g", "7 g"]'
    flight = FLIGHT.replace('"constant", level = "6 g"', turning)
    file.write_text(bodies + flight + SPIN + 'smoothing = "60 ms"\n' + response("1.2 s"), encoding="utf-8")
    assert main(["place", str(file), "--measure", "root-shear", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["control_point"] == pytest.approx(0.172, abs=1e-6) and facts["fraction_of_length"] is None
    checked = facts["verifications"]
    assert checked["best"]["force_difference"] < 0.1 * checked["current"]["force_difference"]
    assert main(["place", str(file), "--no-proof", "--report", "--out", str(tmp_path / "out")]) == 0
    assert "least load" in capsys.readouterr().out and (tmp_path / "out" / "place.html").is_file()
    assert main(["place", str(file), "--measure", "tip"]) == 2
    assert "--measure is tip" in capsys.readouterr().err
    assert QUESTIONS["place"].answer(gb.read_scenario(file)).weights == {"load": 1.0}


PULL = gb.Sum((gb.constant(25.0), gb.trapezoid(30.0, jerk=40.0, start=0.5, hold=1.0)))
ROUND = gb.Flight(x=gb.trapezoid(12.0, jerk=30.0, start=0.4, hold=0.8), y=gb.constant(14.0), z=PULL)
SPELL = gb.ResponseSettings(start=0.0, duration=3.5, step=2e-3, integrator="gauss", estimate=False)
# A box of instruments whose root is a corner of its base.
CASE = gb.RigidSpecimen(
    6.5, (0.17, 0.09, 0.05), np.diag([0.030, 0.063, 0.076]),
    corners=[(x, y, z) for x in (0, 0.32) for y in (0, 0.2) for z in (0, 0.12)],
)  # fmt: skip


def spun(flight: gb.Flight = ROUND, **more: Any) -> gb.Centrifuge:
    options = {"control_point": (0.1, 0.0, 0.0), "arm": 3.3, "inverse": "flat", "gravity": True, "smoothing": 0.1}
    return gb.Centrifuge(flight, **{**options, "span": (0.0, 3.5), **more})


def test_a_rigid_bodys_force_is_the_flights_at_its_centre_of_mass_whichever_way_round() -> None:
    machine = spun()
    placement = place(CASE.structure, ROUND, gb.choice_of(machine, [0.1]), SPELL, {"root-shear": 1.0}, current=machine)
    np.testing.assert_allclose(placement.best.place, CASE.centre, atol=1e-5)
    turned = replace(gb.choice_of(machine, [0.1]), turns=((0.3, -0.5, 0.8),))
    for each in place(CASE.structure, ROUND, turned, SPELL, {"root-shear": 1.0}, current=machine).options:
        np.testing.assert_allclose(each.place, CASE.centre, atol=1e-5)
    # Where nothing may be moved but along x, the rest of the way to the centre of mass stays.
    along = place(
        CASE.structure, ROUND, gb.choice_of(machine, [0.1]), SPELL, {"root-shear": 1.0}, current=machine, along="x"
    )
    assert along.best.place[1:] == (0.0, 0.0) and along.best.difference > 100 * placement.best.difference
    with pytest.raises(gb.InputError, match="along is 'q'"):
        place(CASE.structure, ROUND, gb.choice_of(machine), SPELL, {"load": 1.0}, current=machine, along="q")


@pytest.mark.parametrize("turning", [False, True])
def test_the_loads_difference_is_that_of_running(turning: bool) -> None:
    """In flights in translation and in rotation, of which the load at the root alone is tracked."""
    rates = gb.smoothed(gb.vector(x=gb.trapezoid(0.8, jerk=2.0, start=0.4, hold=0.8), y=gb.constant(0.5)), 0.4)
    flight = gb.Flight(acceleration=ROUND.acceleration, rates=rates if turning else None)
    machine = spun(flight)
    placement = place(CASE.structure, flight, gb.choice_of(machine, [0.1]), SPELL, {"load": 1.0}, current=machine)
    best = spun(flight, control_point=placement.best.place, mounting=placement.best.mounting)
    for each, of in ((machine, "current"), (best, "best")):
        apart = largest_difference(each, np.linspace(0.1, 3.4, 1651))
        assert placement.totals[of]["load"] == pytest.approx(apart, rel=5e-3)


def largest_difference(machine: gb.Centrifuge, times: np.ndarray) -> float:
    """Largest difference of the loads at the box's corners from those in flight, over the largest of these, as run."""
    loads = [CASE.loads(each, 3.5, sample=2e-3) for each in (machine.flight, machine)]
    felt = [
        np.stack([np.interp(times, each.time, column) for column in each.acceleration.reshape(len(each.time), -1).T])
        for each in loads
    ]
    apart = (felt[1] - felt[0]).reshape(8, 3, -1)
    return float(np.linalg.norm(apart, axis=1).max() / np.linalg.norm(felt[0].reshape(8, 3, -1), axis=1).max())


def test_where_and_which_way_round_beats_a_grid_of_both() -> None:
    """The search beside every place of a grid in the box and 98 directions of axis 3, and beside running them."""
    machine, weights = spun(), {"load": 1.0}
    choice = gb.choice_of(machine, [0.1], turns="any")
    assert len(choice.turns) == 13
    placement = place(CASE.structure, ROUND, choice, SPELL, weights, current=machine)
    rng = np.random.default_rng(26)
    times = np.linspace(0.1, 3.4, 331)
    grid = [np.linspace(0, edge, 4) for edge in (0.32, 0.2, 0.12)]
    places = np.stack(np.meshgrid(*grid), axis=-1).reshape(-1, 3)
    # Values at the corners, from the motion alone: what the search has not been told.
    in_flight = np.linalg.norm(ROUND.base(times).a_WO_B, axis=1).max()
    least = np.inf
    for turn in [(0.0, 0.0, 0.0), *(rng.normal(size=(60, 3)) * [0, 1, 1])]:
        for mounting in ("upright", "inverted"):
            try:
                at_c = spun(turn=tuple(turn), mounting=mounting).at_control_point(times[::3])
            except gb.InputError:
                continue  # out of the gimbals' reach
            growth = gradients(at_c.w_WB_B, at_c.alpha_WB_B)
            away = np.asarray(CASE.corners)[None] - places[:, None]
            apart = np.einsum("tij,pcj->tpci", growth, away)
            least = min(least, float(np.linalg.norm(apart, axis=-1).max(axis=(0, 2)).min() / in_flight))
    assert placement.best.difference < least
    best = spun(control_point=placement.best.place, turn=placement.best.turn, mounting=placement.best.mounting)
    assert largest_difference(best, times) == pytest.approx(placement.totals["best"]["load"], rel=0.05)
    assert largest_difference(best, times) < 0.6 * largest_difference(machine, times)
    assert placement.changes.keys() >= {"control_point", "turn"}


SLANTED = """\
[motion.flight]
kind = "flight"

[motion.flight.acceleration]
x = { profile = "constant", level = "3 m/s^2" }
y = { profile = "constant", level = "12 m/s^2" }
z = { profile = "table", times = [0, 0.5, 1], values = ["5 g", "5 g", "7 g"] }
"""


def test_a_place_in_space_is_written_and_read_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, box = tmp_path / "s.toml", BOX.replace('["160 mm", 0, 0]', '["160 mm", "100 mm", "60 mm"]')
    machine = SPIN.replace("false", "true") + 'smoothing = "60 ms"  # kept\n'
    file.write_text(box + SLANTED + machine + response("1.2 s"), encoding="utf-8")
    command = ["place", str(file), "--no-proof", "--smoothing", "60 ms"]
    assert main([*command, "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    place, turn = ([first[key][axis] for axis in "xyz"] for key in ("place", "turn"))
    assert len(first["options"]) == 6 and any(turn) and place[0] == pytest.approx(0.15) and all(place[1:])
    settings = [part for each in first["set"] for part in ("--set", each)]
    assert main([*command, *settings, "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["set"] == []
    assert again["before"]["difference"] == pytest.approx(first["options"][0]["difference"], rel=1e-4)
    assert main([*command, "--write", "--out", str(tmp_path / "out"), "--report"]) == 0
    assert "turned by (" in capsys.readouterr().out and "# kept" in file.read_text(encoding="utf-8")
    assert "turned by (" in (tmp_path / "out" / "place.html").read_text(encoding="utf-8")
    assert main([*command, "--write"]) == 0 and "already" in capsys.readouterr().out
    np.testing.assert_allclose(gb.read_scenario(file).motions["spin"].place, place, atol=1e-7)  # type: ignore[union-attr]
    assert main(["plan", str(file), "--out", str(tmp_path / "out")]) == 0
    head = (tmp_path / "out" / "commands_spin.csv").read_text(encoding="utf-8")
    assert "Control point (" in head and "rotation vector (" in head


def test_a_camera_beside_a_boom_bends_it_less_where_it_is_placed() -> None:
    """A system that is run in flight, as it is mounted, and where the search puts it, off the boom."""
    boom = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=2)
    camera = gb.RigidBody(0.05, (2e-5, 2e-5, 2e-5), (0.0, 0.03, 0.05))
    joints = CLAMP | {"screws": gb.Joint("fixed", "camera", "strip.tip")}
    system = gb.System({"strip": boom, "camera": camera}, joints)
    machine, weights = spun(control_point=0.15), {"tip": 1.0}
    choice = gb.choice_of(machine, [0.1], turns="right-angles")
    placement = place(system, ROUND, choice, SPELL, weights, current=machine, check=True)
    run = {each.name: each for each in placement.verifications}
    assert placement.best.place[2] > 0.01 and placement.point.startswith(("strip", "camera"))
    assert run["best"].tip_difference < 0.2 * run["current"].tip_difference
    assert run["best"].tip_difference < run["middle"].tip_difference
    words = describe(placement)
    assert "in the middle of the specimen" in words and "mid-way" in words and "root force" in words


def test_vibration_is_of_the_mode_that_the_flight_calls_on() -> None:
    """Along the strip's width it is five times as stiff as through its thickness, and the second mode is as quick."""
    modes = Specimen.from_system(gb.System.of(gb.assemble(STRIP, "FOAM", axial=0, y=1, z=2)), NOW).modes
    assert modes is not None
    for axis, ratio in ((2, 1.0), (1, 5.0)):
        along = modes.foremost(0, 9.81 * np.eye(3)[[axis]], np.zeros((1, 3, 3)))
        assert along.frequency == pytest.approx(ratio * modes.frequency[0], rel=1e-2)
        assert np.argmax(np.abs(along.shape[0])) == axis


def test_bare_matrices_are_placed_by_their_points() -> None:
    first = np.zeros((2, 3, 2))
    first[0, 2, 0] = first[1, 1, 1] = 1.0
    structure = gb.Structure.of_particles(
        np.array([1.0, 2.0]), np.array([[0.0, 0.3, 0.1], [0.0, 0.4, -0.1]]), first, np.diag([1e4, 2e4]),
        second=np.zeros((2, 3, 2, 2)), damping_ratio=0.02, stations=np.array([0, 1]), points=("a", "tip"),
    )  # fmt: skip
    specimen = Specimen.from_system(gb.System.of(structure), NOW)
    assert list(specimen.ends) == ["the root", "a", "tip"]
    np.testing.assert_allclose(specimen.extent, [[0, 0, -0.1], [0, 0.4, 0.1]])
    # A particle of 2 kg on a spring along y, at its place: the force of its load over the spring.
    load, growth = np.array([1.0, 2.0, 3.0]), np.arange(9.0).reshape(3, 3)
    felt = load + growth @ [0.0, 0.4, -0.1]
    np.testing.assert_allclose(
        specimen.displacement["body.tip"].evaluate(load, growth), [0.0, -2 * felt[1] / 2e4, 0.0], atol=1e-15
    )
