"""Scenarios of systems: what they build, and every error at its place."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics import JOINT_KINDS as KINDS
from gbeam.questions import QUESTIONS, Needs
from gbeam.report import text
from gbeam.scenario import Diagnostic, ScenarioError, build, load, loads

from ..scenarios import SLEW, SPECIMEN, model, response

SATELLITE = (Path(__file__).parents[2] / "examples" / "satellite_two_panels.toml").read_text(encoding="utf-8")
FLIGHT = """
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "1 g" } }
"""
EVERY_JOINT = """
[joints.a]
kind = "fixed"
body = "b"
stiffness = { y = "900 N/m", rx = "30 N m/rad" }
damping = { y = "9 N s/m", rx = "3 N m s/rad" }
initial = { rx = "10 deg" }
[joints.b]
kind = "prismatic"
body = "c"
on = "b.root"
axes = [[1, 0, 0]]
rate = "20 mm/s"
[joints.c]
kind = "cylindrical"
body = "d"
on = "c.root"
axes = [[0, 0, 1]]
friction = { displacement = "1 N", angle = "2 N m" }
effort = { displacement = { profile = "sine", amplitude = "1 kN", duration = "1 s" } }
[joints.d]
kind = "universal"
body = "e"
on = "d.root"
axes = [[0, 1, 0], [0, 0, 1]]
stops = { angle_2 = ["-30 deg", "30 deg"] }
stop_stiffness = { angle_2 = "1 kN m/rad" }
[joints.e]
kind = "spherical"
body = "f"
on = "e.root"
initial_rate = { wz = "60 rpm" }
[joints.f]
kind = "free"
body = "g"
initial_rate = { x = "1 m/s", wy = "1 deg/s" }
[joints.g]
kind = "revolute"
body = "h"
on = "g.root"
axes = [[0, 2, 0]]
at = ["100 mm", 0, 0]
turn = [0, 0, "90 deg"]
ease = "5 deg"
stiffness = "5 N m/rad"
[response]
duration = "1 s"
"""


def test_every_kind_of_joint_is_read() -> None:
    bodies = "".join(f'[bodies.{name}]\nkind = "rigid"\nmass = "1 kg"\ninertia = [1, 1, 1]\n' for name in "bcdefgh")
    scenario = loads(bodies + EVERY_JOINT)
    assert {each.kind for each in scenario.joints.values()} == set(KINDS)
    assert pickle.loads(pickle.dumps(scenario)) == scenario
    joints = build(scenario).system.joints
    rad = np.pi / 180
    assert joints["a"] == gb.Joint(
        "fixed", "b", stiffness={"y": 900.0, "rx": 30.0}, damping={"y": 9.0, "rx": 3.0}, initial={"rx": 10 * rad}
    )
    assert joints["b"] == gb.Joint("prismatic", "c", "b.root", axes=[(1, 0, 0)], rate=0.02)
    drive = {"displacement": gb.Sine(1000.0, 1.0)}
    friction = {"displacement": 1.0, "angle": 2.0}
    assert joints["c"] == gb.Joint("cylindrical", "d", "c.root", axes=[(0, 0, 1)], friction=friction, effort=drive)
    stops = {"angle_2": (-30 * rad, 30 * rad)}
    stiff = {"angle_2": 1000.0}
    assert joints["d"] == gb.Joint(
        "universal", "e", "d.root", axes=[(0, 1, 0), (0, 0, 1)], stops=stops, stop_stiffness=stiff
    )
    assert joints["e"] == gb.Joint("spherical", "f", "e.root", initial_rate={"wz": 2 * np.pi})
    assert joints["f"] == gb.Joint("free", "g", initial_rate={"x": 1.0, "wy": rad})
    assert joints["g"] == gb.Joint(
        "revolute", "h", "g.root", axes=[(0, 2, 0)], at=(0.1, 0.0, 0.0), turn=(0.0, 0.0, np.pi / 2),
        ease=5 * rad, stiffness=5.0,
    )  # fmt: skip


def test_a_system_is_that_of_python() -> None:
    case = build(loads(SATELLITE))
    assert case.response.integrator == "gauss"
    bus = gb.RigidBody(
        50.0, (8.0, 10.0, 12.0),
        points={"right": (0.5, 0.0, 0.0), "left": gb.Place((-0.5, 0.0, 0.0), (0.0, 0.0, np.pi))},
    )  # fmt: skip
    assert case.system.bodies["bus"] == bus
    beam = gb.Beam(
        3.0, gb.Section.rectangle(0.5, 0.02), gb.Material(100.0, 1e9), damping_ratio=0.005,
        points=[gb.Point("middle", 1.5)],
    )  # fmt: skip
    structure = gb.assemble(beam, "FOAM", axial=0, y=1, z=2)
    system = gb.System(
        {"bus": bus, "right": structure, "left": structure},
        case.system.joints,
        {"wheel": gb.PointForce("bus.root", moment=gb.vector(y=gb.Sine(0.5, 20.0)), follower=True)},
    )
    np.testing.assert_allclose(gb.modes(case.system).frequency, gb.modes(system).frequency, rtol=1e-12)
    assert case.system == system


def test_changes_by_path_and_tensor(tmp_path: Path) -> None:
    file = tmp_path / "satellite.toml"
    file.write_text(SATELLITE, encoding="utf-8")
    tensor = "bodies.bus.inertia=[[8, 1, 0], [1, 10, 0], [0, 0, 12]]"
    case = gb.read_scenario(file, ["bodies.bus.mass=60 kg", "joints.hinge_left.stiffness=1 kN m/rad", tensor])
    bus = case.system.bodies["bus"]
    assert bus.mass == 60.0 and bus.tensor[0, 1] == 1.0
    assert case.system.joints["hinge_left"].stiffness == 1000.0
    with pytest.raises(ScenarioError, match="expected a rotational stiffness"):
        gb.read_scenario(file, ["joints.hinge_left.stiffness=1 N/m"])


def test_a_motion_carries_a_system() -> None:
    text = SATELLITE.replace('kind = "free"', 'kind = "fixed"')
    case = build(loads(text.replace("[response]", FLIGHT + "[response]")))
    weighed = build(loads(text.replace("[response]", '[system]\ngravity = [0, 0, "-1 g"]\n[response]')))
    rest = gb.static(case.system, case.motions["flight"]), gb.static(weighed.system)
    np.testing.assert_allclose(rest[0].place, rest[1].place, rtol=1e-12)
    assert rest[0].point_displacement[:, 2].min() < -0.1


WRONG = {
    "a loop": ('on = "bus.left"', 'on = "left.tip"', "joints.hinge_left.on", "makes a loop", '"left.tip"'),
    "on nothing": ('body = "bus"', 'body = "left"', "joints.hinge_left.body|bodies.bus", "", ""),
    "no such point": ('on = "bus.left"', 'on = "bus.lef"', "joints.hinge_left.on", "no such point", '"bus.lef"'),
    "no such body": ('body = "right"', 'body = "rigth"', "joints.hinge_right.body", "no such body", '"rigth"'),
    "no point of a force": ('on = "bus.root"', 'on = "bus.jet"', "forces.wheel.on", "no such point", '"bus.jet"'),
    "beam beside": ("[response]", "[beam]\n[response]", "beam", "is given beside bodies", "beam"),
    "model beside": ("[response]", "[model]\n[response]", "model", "is given beside bodies", "model"),
    "kind": ('kind = "free"', 'kind = "fre"', "joints.orbit.kind", "unknown choice", '"fre"'),
    "inertia": ('"12 kg m^2"]', '"120 kg m^2"]', "bodies.bus.inertia", "has the principal moments", None),
    "two moments": (', "12 kg m^2"]', "]", "bodies.bus.inertia", "has 2 entries", None),
    "station": ('duration = "20 s"\n', 'duration = "20 s"\nstations = [1]\n', "response.stations",
                "is given beside bodies", "stations"),
    "stops": ('axes = [[0, 1, 0]]', 'axes = [[0, 1, 0]]\nstops = ["30 deg", "-10 deg"]\nstop_stiffness = "1 kN m/rad"',
              "joints.hinge_left.stops.angle", "is 30 deg, -10 deg", "stops"),
    "gravity": ("[response]", '[system]\ngravity = [0, 0, "-1 g"]' + FLIGHT + "[response]", "system.gravity",
                "is given beside a motion", "gravity"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_wrong_systems_are_refused_at_their_place(name: str) -> None:
    old, new, path, message, caret = WRONG[name]
    at = SATELLITE.rindex(old)
    text = SATELLITE[:at] + new + SATELLITE[at + len(old) :]
    diagnostics = _refused(text)
    assert len(diagnostics) == 1, "\n".join(map(str, diagnostics))
    (diagnostic,) = diagnostics
    assert diagnostic.path in path.split("|") and message in diagnostic.message and diagnostic.hint
    assert diagnostic.line is not None and diagnostic.column is not None and diagnostic.end is not None
    marked = text.split("\n")[diagnostic.line - 1][diagnostic.column - 1 : diagnostic.end - 1]
    assert marked == caret or not caret


def _refused(text: str) -> tuple[Diagnostic, ...]:
    with pytest.raises(ScenarioError) as caught:
        build(loads(text, "s.toml"))
    return caught.value.diagnostics


MISSING = {
    'kind = "free"\nbody = "bus"\n': ("joints.orbit", "kind is missing"),
    "axes = [[0, 1, 0]]\n": ("joints.hinge_left", "axes is missing"),
    'mass = "50 kg"\n': ("bodies.bus", "mass is missing"),
}


@pytest.mark.parametrize("left_out", MISSING)
def test_what_is_missing_is_said(left_out: str) -> None:
    at = SATELLITE.rindex(left_out)
    first, *_ = _refused(SATELLITE[:at] + SATELLITE[at + len(left_out) :])
    assert (first.path, first.message) == MISSING[left_out] and first.line is not None


def test_a_damping_that_is_not_given_is_missed_by_answers_that_depend_on_it() -> None:
    line = "damping_ratio = 0.005\n"
    at = SATELLITE.rindex(line)
    case = build(loads(SATELLITE[:at] + SATELLITE[at + len(line) :], "s.toml"))
    for ask, answer in (
        (gb.study, "the response"),
        (lambda case: gb.linearize(case.subject), "the state-space model"),
    ):
        with pytest.raises(gb.InputError, match=f"bodies.left.damping_ratio is missing, and {answer} depends on it"):
            ask(case)
    (rest,) = QUESTIONS["static"].answer(case, needs=Needs(errors=False))
    assert rest.point_displacement.shape[1] == 3
    modes = QUESTIONS["modes"].answer(case, needs=Needs(errors=False))
    assert not modes.damping_given and "undamped: left.damping_ratio is not given" in text(modes)
    assert not modes.bodies["left"].damping_given and modes.bodies["right"].damping_given


def test_a_body_that_hangs_on_nothing() -> None:
    start, end = SATELLITE.index("[joints.orbit]"), SATELLITE.index("[joints.hinge_right]")
    (diagnostic,) = _refused(SATELLITE[:start] + SATELLITE[end:])
    assert (diagnostic.path, diagnostic.message, diagnostic.line) == ("bodies.bus", "hangs on nothing", 5)


def test_a_scenario_without_a_motion_rests_and_a_beam_is_not_run_there() -> None:
    assert not load("examples/robot_arm.toml").motion
    text = SPECIMEN + model("FOAM", 1, 1, 1)
    case, moved = build(loads(text)), build(loads(text + SLEW + response("4 s")))
    assert case.response is None and list(case.environments) == ["ground"]
    at_rest, on_hub = (gb.modes(each.subject).frequency for each in (case, moved))
    assert QUESTIONS["modes"].answer(case).frequency == pytest.approx(at_rest, rel=1e-12)
    assert at_rest == pytest.approx(on_hub, rel=1e-12)
    assert gb.describe(case).duration is None and gb.describe(moved).duration == 4.0
    for refused in (gb.study, QUESTIONS["static"].answer, gb.compare_models):
        with pytest.raises(gb.InputError, match="motion is missing; add what the base does"):
            refused(case)
    with pytest.raises(gb.InputError, match="response duration is missing; no record gives one"):
        gb.study(build(loads(text + SLEW)))


def test_a_drive_beside_a_free_joint_changes_no_mode() -> None:
    """The local coordinates of a free joint are fewer than its own: drives are counted with them."""
    driven = SATELLITE.replace('damping = "2 N m s/rad"', 'damping = "2 N m s/rad"\neffort = "0 N m"')
    one, other = (gb.modes(build(loads(text)).system) for text in (SATELLITE, driven))
    np.testing.assert_allclose(one.eigenvalue, other.eigenvalue, rtol=1e-12)


def test_sweeps_and_sensitivities_read_the_same_paths() -> None:
    file = "examples/satellite_two_panels.toml"
    over = {"joints.hinge_right.stiffness": [100.0, 400.0]}
    swept = gb.sweep(file, over, ["modes[0].frequency"], verb="modes")
    case = build(loads(SATELLITE))
    first = swept.measures["modes[0].frequency"][0]
    assert first == gb.modes(case.system).frequency[0] and swept.measures["modes[0].frequency"][1] > first
    slope = gb.sensitivity(file, ["modes[0].frequency"], ["joints.hinge_right.stiffness"], verb="modes")
    assert 0 < slope.relative[0, 0] < 0.5
    shorter = ["response.duration=2 s", "response.residual_from=1 s", "response.estimate=false"]
    swept = gb.sweep(file, over, ["points.right.tip.residual_amplitude.z"], verb="run", overrides=shorter)
    hinge = ["joints.hinge_right.stiffness=100 N m/rad"]
    ran = gb.study(gb.read_scenario(file, [*shorter, *hinge])).responses["ground"]
    left = ran.residual_amplitude[ran.points.index("right.tip")]
    assert swept.measures["points.right.tip.residual_amplitude.z"][0] == left[2] > 1e-4
    with pytest.raises(ScenarioError, match=r"residual_from: is 3 s"):
        gb.read_scenario(file, ["response.duration=2 s", "response.residual_from=3 s"])
    with pytest.raises(gb.InputError, match=r"points\.right\.tipp"):
        gb.sweep(file, over, ["points.right.tipp.displacement_maxx"], verb="run")
    with pytest.raises(gb.InputError, match="motion is missing"):
        gb.sweep(file, over, ["best"], verb="place")
