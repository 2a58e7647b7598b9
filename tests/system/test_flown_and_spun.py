"""A system in flight and on the centrifuge that imitates it: compared as one beam is, with the numbers of one body."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.questions import QUESTIONS
from gbeam.report import report_of
from gbeam.scenario import ScenarioError

from ..calling import main

STRIP = gb.Beam(
    0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9, yield_strength=270e6), damping_ratio=0.01
)
LOAD = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
TURN = gb.Flight(z=LOAD)
MACHINE = gb.Centrifuge(TURN, arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0))
OPTIONS: dict[str, Any] = {"duration": 8.0, "step": 4e-3, "integrator": "gauss", "estimate": False}


def test_a_system_of_one_beam_compares_as_the_beam() -> None:
    structure = gb.assemble(STRIP, "exact", axial=0, y=1, z=2)
    system = gb.System({"strip": structure}, {"clamp": gb.Joint("fixed", "strip")})
    of_beam, of_system = (
        gb.compare(*(gb.simulate(each, motion, **OPTIONS) for motion in (TURN, MACHINE)), accept={"tip": 0.05})
        for each in (structure, system)
    )
    np.testing.assert_allclose(of_system.difference, of_beam.difference, atol=1e-9)
    assert of_system.root is not None and of_beam.root is not None
    for name in ("tip", "root_force", "root_moment", "stress"):
        one, other = of_system.peaks[name], of_beam.peaks[name]
        assert (one.flight, one.machine) == pytest.approx((other.flight, other.machine), rel=1e-4), name
    assert of_system.accepted is of_beam.accepted is True


def test_two_beams_on_a_rigid_body_are_flown_and_spun() -> None:
    """The root of all is the ground: its force is that of the whole mass, flown and spun."""
    structure = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=2)
    block = gb.RigidBody(0.5, (1e-3, 1e-3, 1e-3), points={"left": (0, 0.1, 0), "right": (0, -0.1, 0)})
    joints = {"bolts": gb.Joint("fixed", "block")} | {
        name: gb.Joint("fixed", name, f"block.{name}") for name in ("left", "right")
    }
    system = gb.System({"block": block, "left": structure, "right": structure}, joints)
    flight, spun = (gb.simulate(system, motion, **OPTIONS) for motion in (TURN, MACHINE))
    compared = gb.compare(flight, spun, point="left.tip")
    mass = 0.5 + 2 * 2700 * 0.3 * 0.02 * 0.004
    assert compared.peaks["root_force"].flight == pytest.approx(70.0 * mass, rel=0.02)
    assert 0 < compared.relative[2] < 0.1 and compared.root is not None
    largest = max(each.peaks.loads.largest_stress.value for each in flight.bodies.values())  # type: ignore[union-attr]
    assert compared.peaks["stress"].flight == pytest.approx(largest, rel=1e-3)
    assert compared.shock is not None
    control = gb.compare(flight, spun, point="left.tip", control={"left.tip": 1.0, "right.tip": 1.0}).shock
    assert control is not None and "right.tip" in control.control
    assert gb.compare(flight, spun).max_difference.shape == (3,)
    with pytest.raises(gb.InputError, match="choose from"):
        gb.compare(flight, spun, point="left.top")
    with pytest.raises(gb.InputError, match="of another specimen"):
        gb.compare(flight, gb.simulate(structure, MACHINE, **OPTIONS))


SCENARIO = """
{structure}
[motion.flight]
kind = "flight"
[motion.flight.acceleration.z]
profile = "sum"
terms = [
    { profile = "constant", level = "20 m/s^2" },
    { profile = "trapezoid", level = "50 m/s^2", jerk = "25 m/s^3", start = "1 s", hold = "2 s" },
]
[motion.centrifuge]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "220 mm"
gravity = true
smoothing = "0.1 s"
accept = { tip = "5 %", srs = "3 dB", damage = 1.5 }
[response]
duration = "8 s"
step = "4 ms"
integrator = "gauss"
estimate = false
"""
BEAM = """
length = "300 mm"
damping_ratio = "1 %"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", yield_strength = "270 MPa" }
"""
OF_BEAM = f'[beam]{BEAM}\n[model]\nkind = "FOAM"\nmodes = {{ axial = 0, y = 1, z = 2 }}'
OF_SYSTEM = (
    f'[bodies.strip]\nkind = "beam"{BEAM}\nmodel = {{ kind = "FOAM", modes = {{ axial = 0, y = 1, z = 2 }} }}\n'
    '[joints.clamp]\nkind = "fixed"\nbody = "strip"\n'
    # A strip alone would be the one body of a [beam].
    '[bodies.speck]\nkind = "rigid"\nmass = "1e-9 kg"\n'
    '[joints.speck]\nkind = "fixed"\nbody = "speck"\non = "strip.root"'
)


def read(structure: str, tmp_path: Path, *changes: str) -> Any:
    file = tmp_path / "scenario.toml"
    file.write_text(SCENARIO.replace("{structure}", structure), encoding="utf-8")
    return gb.read_scenario(file, changes)


def test_a_scenario_of_a_system_is_judged_as_one_of_a_beam(tmp_path: Path) -> None:
    beam, system = (gb.study(read(each, tmp_path)) for each in (OF_BEAM, OF_SYSTEM))
    assert isinstance(system, gb.Study) and system.state == beam.state == "NOT ACCEPTED"
    (one,), (other,) = beam.comparisons, system.comparisons
    for a, b in zip(one.criteria, other.criteria, strict=True):
        assert (a.name, a.passed) == (b.name, b.passed)
        assert b.value == pytest.approx(a.value, rel=1e-4, abs=1e-5), a.name
    spun = system.responses["centrifuge"]
    assert spun.spin_up == pytest.approx(beam.responses["centrifuge"].spin_up) and spun.spin_up > 5.0
    assert other.peaks["largest_load"].machine == pytest.approx(one.peaks["largest_load"].machine, rel=1e-9)
    np.testing.assert_allclose(other.difference, one.difference, atol=2e-7)  # of 2 mm, by the steps
    assert system.not_accepted == {"centrifuge": other.refusal} and "damage" in other.refusal
    page = report_of(system)
    assert page.count("Limits used") == report_of(beam).count("Limits used") > 0 and ">limits</h" not in page


def test_a_run_of_a_system_that_is_not_accepted_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(SCENARIO.replace("{structure}", OF_SYSTEM), encoding="utf-8")
    short = ["--set", "response.step=20 ms", "--out", str(tmp_path / "out"), "--report"]
    assert main(["run", str(file), *short, "--verbose"]) == 1
    printed = capsys.readouterr()
    assert "motion.centrifuge NOT ACCEPTED: damage" in printed.err
    assert "  limits missed: damage" in printed.out and "  limits kept: strip.tip" in printed.out
    assert "from standstill to standstill" in printed.out and "the tip is strip.tip" in printed.out
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "Verdict" in page and "NOT ACCEPTED: damage" in page
    assert main(["run", str(file), *short, "--set", "motion.centrifuge.accept.damage=5"]) == 0


def test_the_point_that_is_judged_is_one_of_the_system(tmp_path: Path) -> None:
    case = read(OF_SYSTEM, tmp_path, 'motion.centrifuge.accept.point="strip.tip"')
    assert case.accept["centrifuge"]["point"] == "strip.tip"
    with pytest.raises(ScenarioError, match="no such point") as caught:
        read(OF_SYSTEM, tmp_path, 'motion.centrifuge.accept.point="strip.top"')
    assert "motion.centrifuge.accept.point" in str(caught.value)
    with pytest.raises(ScenarioError, match="no such point") as caught:
        read(OF_SYSTEM, tmp_path, 'motion.centrifuge.accept.damage_at="strip.top"')
    assert "motion.centrifuge.accept.damage_at" in str(caught.value)
    sensors = 'sensors={"strip.%s"={frequency="90 Hz"}}'
    assert read(OF_SYSTEM, tmp_path, sensors % "tip").sensors["strip.tip"].frequency == 90.0
    with pytest.raises(ScenarioError, match="no such point") as caught:
        read(OF_SYSTEM, tmp_path, sensors % "top")
    assert "sensors.strip.top" in str(caught.value)
    with pytest.raises(ScenarioError, match=r"is no point: 'strip\.tip'"):
        read(OF_BEAM, tmp_path, 'motion.centrifuge.accept.point="strip.tip"')


def test_the_machine_of_a_system_is_planned_as_that_of_the_beam(tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    (one,), (other,) = (QUESTIONS["plan"].answer(read(each, tmp_path)) for each in (OF_BEAM, OF_SYSTEM))
    np.testing.assert_array_equal(one.axes.rate, other.axes.rate)
    pairs = [each.peaks["largest_load"] for each in (one, other)]
    assert (pairs[0].flight, pairs[0].machine) == pytest.approx((pairs[1].flight, pairs[1].machine), rel=1e-12)
    assert other.not_judged == ("tip", "srs", "damage")
    assert main(["plan", str(file)]) == 0


def test_a_sweep_of_a_case_made_in_python_is_judged() -> None:
    structure = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=2)
    bodies = {"strip": structure, "speck": gb.RigidBody(1e-9)}
    joints = {"clamp": gb.Joint("fixed", "strip"), "speck": gb.Joint("fixed", "speck", on="strip.root")}
    motions, settings = {"flight": TURN, "spun": MACHINE}, gb.ResponseSettings(**OPTIONS)
    more: Any = {"tracks": {"spun": "flight"}, "accept": {"spun": {"tip": 0.005}}}
    case = gb.Case("swept", gb.System(bodies, joints), motions, settings, **more)
    over = {"bodies.strip.length": [0.28, 0.3]}  # peaks differ by 0.9 and 0.0 %
    assert gb.sweep(case, over).measures["comparisons.spun.verdict.accepted"].tolist() == [0.0, 1.0]
    assert gb.sweep(replace(case, accept={}), over).measures["comparisons.spun.verdict.followed"].tolist() == [1.0, 1.0]
