"""Studies of systems: made in Python as in a file, and histories of what sensors of a system read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.questions import QUESTIONS, Needs

from ..scenarios import FLIGHT, SPECIMEN, model, response

SATELLITE = "examples/satellite_two_panels.toml"
SHORT = ["response.duration=0.5 s", "response.step=5 ms", "response.estimate=false"]
SWING = gb.SmoothStep(0.1, 0.5)


def satellite() -> gb.Case:
    """The example as if it were made in Python."""
    return replace(gb.read_scenario(SATELLITE, SHORT), title="made")


@pytest.mark.parametrize(
    "over",
    [
        "joints.hinge_right.stiffness=50 N m/rad, 100 N m/rad",
        "bodies.bus.mass=40 kg, 60 kg",
        "bodies.right.section.thickness=20 mm, 30 mm",
        "bodies.left.length=2.5 m, 3 m",
    ],
)
def test_a_sweep_of_a_case_is_that_of_its_file(over: str) -> None:
    options: dict[str, Any] = {"verb": "modes"}
    name = "modes[0].frequency"
    of_case, of_file = (gb.sweep(each, [over], [name], **options) for each in (satellite(), SATELLITE))
    np.testing.assert_allclose(of_case.measures[name], of_file.measures[name], rtol=1e-9)
    assert np.ptp(of_case.measures[name]) > 0 and of_case.parameters[0].unit == of_file.parameters[0].unit


def test_other_studies_of_a_case() -> None:
    measure, path = "modes[0].frequency", "joints.hinge_right.stiffness"
    sensitivity = gb.sensitivity(satellite(), [measure], [path], verb="modes")
    up, down = (
        gb.sweep(satellite(), [f"{path}={value}"], [measure], verb="modes").measures[measure][0]
        for value in (101.0, 99.0)
    )
    assert sensitivity.derivatives[0, 0] == pytest.approx((up - down) / 2, rel=1e-3)
    optimum = gb.optimise(satellite(), measure, [path], bounds={path: (50.0, 150.0)}, verb="modes")
    assert optimum.values[0] == pytest.approx(50.0, rel=1e-3)
    with pytest.raises(gb.InputError, match="is no value that the case gives"):
        gb.sweep(satellite(), ["bodies.bus.weight=1, 2"], [measure], verb="modes")


def test_histories_are_what_sensors_read() -> None:
    names = ["right.tip.place_z", "hinge_right.angle", "right.root_moment.y", "ground.bus.root.spin_y"]
    swept = gb.sweep(SATELLITE, ["bodies.bus.mass=40 kg, 60 kg"], histories=names, times=21, overrides=SHORT)
    case = gb.read_scenario(SATELLITE, [*SHORT, "bodies.bus.mass=60 kg"])
    response = gb.simulate(case.system, settings=case.response)
    for name in names:
        signal = response.signal(name.removeprefix("ground."))
        expected = np.interp(swept.time, response.time, signal)
        np.testing.assert_allclose(swept.histories[name][1], expected, atol=1e-4 * np.abs(signal).max())
    assert [swept.units[name] for name in names] == ["m", "rad", "N m", "rad/s"]
    with pytest.raises(gb.InputError, match="did you mean"):
        gb.sweep(SATELLITE, ["bodies.bus.mass=40 kg"], histories=["right.tip.plase_z"], overrides=SHORT)


@pytest.mark.parametrize("modal", [True, False])
def test_a_fit_finds_what_was_measured(modal: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stiffness of a hinge by frequencies and damping, and by what two sensors read over time; without errors of
    answers, of which nothing is read.
    """
    path, true = "joints.hinge_right.stiffness", 90.0
    case, data = gb.read_scenario(SATELLITE, [*SHORT, f"{path}={true} N m/rad"]), tmp_path / "data.csv"
    if modal:
        modes = gb.modes(case.system)
        table, head = (
            np.stack([np.arange(1, 5), modes.frequency[:4], modes.damping_ratio[:4]], 1),
            "mode,frequency,damping_ratio",
        )
    else:
        response = gb.simulate(case.system, settings=case.response)
        signals = [response.signal(name) for name in ("right.tip.place_z", "hinge_right.angle")]
        table = np.stack([response.time, 1e3 * signals[0], signals[1]], axis=1)[::10]
        head = "time,right.tip.place_z [mm],hinge_right.angle"
    np.savetxt(data, table, delimiter=",", header=head, comments="")
    for judge in ("analysis.steady.frequency_errors.RicherModels.errors", "analysis.response.run.system_errors"):
        monkeypatch.setattr(f"gbeam.{judge}", None)
    fit = gb.fit(gb.read_scenario(SATELLITE, SHORT), data, [path])
    assert fit.values[0] == pytest.approx(true, rel=1e-4) and fit.before[0] == 100.0


def swung(clamp: float = 900.0, rate: Any = SWING) -> gb.Case:
    """A panel in a springy clamp on a wheel that is brought to a rate."""
    section, metal = gb.Section.rectangle(width=0.004, thickness=0.03), gb.Material(2700.0, 70e9)
    panel = gb.assemble(gb.Beam(1.0, section, metal, damping_ratio=0.001), "FOAM", y=2)
    joints = {
        "axis": gb.Joint("revolute", "wheel", axes=[(0, 0, 1)], rate=rate),
        "clamp": gb.Joint("fixed", "panel", on="wheel.root", stiffness={"rz": clamp}),
    }
    system = gb.System({"wheel": gb.RigidBody(1.0, (1.0, 1.0, 1.0)), "panel": panel}, joints)
    return gb.Case("swung", system, {}, gb.ResponseSettings(1.5))


def test_a_fit_takes_a_system_made_in_python(tmp_path: Path) -> None:
    taps, frequency = tmp_path / "taps.csv", gb.modes(swung(900.0).system).frequency[:2]
    np.savetxt(taps, np.stack([[1, 2], frequency], 1), delimiter=",", header="mode,frequency", comments="")
    fit = gb.fit(swung(1000.0), taps, ["joints.clamp.stiffness.rz"])
    assert fit.before == (1000.0,) and fit.values[0] == pytest.approx(900.0, rel=1e-6)
    with pytest.raises(gb.InputError, match="names 2 values for 2 data"):
        gb.fit(swung(), taps, ["joints.clamp.stiffness.rz", "bodies.panel.length"])


def test_a_command_is_shaped_for_a_joint_of_a_system_made_in_python() -> None:
    command = gb.shape_hub_command(swung())
    assert (command.motion, command.goal, command.duration) == ("axis.angle", SWING.level, 0.5)
    profile = gb.SplineProfile(command.duration, command.coefficients)
    turned = [gb.study(swung(rate=rate)).responses["ground"] for rate in (SWING, profile)]
    plain, shaped = (np.ptp(each.signal("clamp.rz")[each.time > 0.5]) for each in turned)
    assert shaped < 0.01 * plain
    with pytest.raises(gb.InputError, match=r"joint is .axis.; choose one of axis\.angle"):
        gb.shape_hub_command(swung(), angle=0.1, joint="axis")


def test_errors_that_no_figure_needs_are_not_computed() -> None:
    case = satellite()
    judged, plain = (QUESTIONS["modes"].answer(case, needs=Needs(errors=each)) for each in (True, False))
    np.testing.assert_array_equal(judged.frequency, plain.frequency)
    assert np.isfinite(judged.error_estimate).all() and np.isnan(plain.error_estimate).all()
    beam = gb.read_scenario("examples/hubbeam2009_slew_2p8.toml", ["model.modes={ axial = 1, y = 2, z = 0 }"]).subject
    assert gb.modes(beam, errors=False).errors is None and gb.modes(beam).errors is not None


def test_options_of_a_question_are_those_of_its_sweeps_and_searches() -> None:
    """The joint that turns, and the end of the search, as options say."""
    strip = gb.Beam(
        0.3, gb.Section.rectangle(width=0.02, thickness=0.004), gb.Material(2700.0, 70e9), damping_ratio=0.0
    )
    joints = {
        "spin": gb.Joint("revolute", "bus", axes=[(0, 0, 1)]),
        "hinge": gb.Joint("revolute", "panel", on="bus.root", axes=[(0, 1, 0)], stiffness=5.0),
    }
    panel = gb.assemble(strip, "FOAM", axial=1, y=2, z=2)
    case = replace(satellite(), system=gb.System({"bus": gb.RigidBody(1.0, (1.0, 1.0, 1.0)), "panel": panel}, joints))
    by, options = "joints.hinge.stiffness", {"turning": "spin.angle", "to": "60 rpm"}
    with pytest.raises(gb.InputError, match="turning is missing"):
        gb.sweep(case, [f"{by}=5"], ["speed[1]"], verb="campbell", options={"to": "60 rpm"})
    swept = gb.sweep(case, [f"{by}=5"], ["searched_to"], verb="critical-speed", options=options)
    assert swept.state == "done" and swept.measures["searched_to"][0] == pytest.approx(2 * np.pi)
    slopes = [
        gb.sensitivity(case, parameters=[by], verb="modes", options={"gyroscopic": each}) for each in (True, False)
    ]
    assert slopes[0].measures == ("modes[0].frequency",) and slopes[0].derivatives == slopes[1].derivatives > 0
    for wrong, message in (
        ({"turnin": "spin.angle"}, "--turnin is no option of critical-speed; did you mean 'turning'"),
        ({"to": "30 m"}, "--to .*angular rate"),
        ({"to": "30 m", "vary": "loads"}, "--to .*ratio"),
        ({"vary": "speed"}, "--vary is 'speed'; choose one of rate, loads, acceleration"),
    ):
        with pytest.raises(gb.InputError, match=message):
            gb.sweep(case, [f"{by}=5"], ["searched_to"], verb="critical-speed", options=wrong)
    with pytest.raises(gb.InputError, match="--turning is no option of run; leave it out"):
        gb.sweep(case, [f"{by}=5"], options={"turning": "spin.angle"})


def test_a_system_has_figures_that_are_meant_where_none_is_named() -> None:
    by = ["joints.hinge_right.stiffness"]
    of_file = gb.sensitivity(SATELLITE, parameters=by, overrides=SHORT)
    of_case = gb.sweep(satellite(), [f"{by[0]}=100"])
    assert tuple(of_case.measures) == of_file.measures and np.isfinite(of_file.figures).all()
    assert of_file.measures[:2] == (
        "motions.ground.bodies.right.tip.size.max_abs",
        "motions.ground.bodies.left.tip.size.max_abs",
    )
    assert of_file.units == ("m", "m", "N m", "N m")


def test_a_strip_on_a_fixed_joint_is_the_beam_and_has_its_slopes(tmp_path: Path) -> None:
    """By derivatives of the runs themselves, exact, of the strip as of the motion that it feels."""
    more = FLIGHT + response("0.2 s", step="2 ms")
    alone, held = tmp_path / "alone.toml", tmp_path / "held.toml"
    alone.write_text(SPECIMEN + model("FOAM", 0, 1, 2) + more, encoding="utf-8")
    strip = SPECIMEN.replace("[beam]\n", '[bodies.strip]\nkind = "beam"\n')
    table = model("FOAM", 0, 1, 2).replace("[model]", "[bodies.strip.model]")
    joint = '[joints.clamp]\nkind = "fixed"\nbody = "strip"\n'
    held.write_text(strip + table + joint + more, encoding="utf-8")
    cases = [gb.read_scenario(each) for each in (alone, held)]
    assert cases[0].subject == cases[1].subject and cases[1].points == ("tip",)
    slopes = [
        gb.sensitivity(
            file, ["tip.z.max_abs"], [f"{table}.length", f"{table}.section.width", "motion.flight.acceleration.z.level"]
        )
        for file, table in ((alone, "beam"), (held, "bodies.strip"))
    ]
    assert set(slopes[1].methods) == {"exact"} and (slopes[0].derivatives[0, [0, 2]] != 0).all()
    np.testing.assert_array_equal(slopes[0].derivatives, slopes[1].derivatives)
    swept = gb.sweep(replace(cases[1], title="made"), {"bodies.strip.length": ["250 mm", "300 mm"]}, ["tip.z.max_abs"])
    shorter, same = swept.measures["tip.z.max_abs"]
    assert same == pytest.approx(slopes[0].figures[0], rel=1e-12) and shorter < 0.6 * same
    turned = gb.read_scenario(held, ["joints.clamp.turn=[0, 0, '10 deg']"])
    assert turned.subject is turned.system and turned.points == ("strip.tip", "strip.root")
    with pytest.raises(gb.InputError, match="case needs a beam that the base holds by its root, and it is of strip on"):
        turned.beam  # noqa: B018
