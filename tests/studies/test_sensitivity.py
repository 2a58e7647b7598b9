"""Sensitivities against closed forms and finite differences, and what they refuse."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.report import text
from gbeam.scenario import loads
from gbeam.studies import Inquiry, Neighbourhood, ScenarioTemplate

from ..scenarios import FLIGHT, FREE_HUB, SLEWING, SPECIMEN, model, response

Call = Callable[..., Any]
E, DENSITY, LENGTH = "beam.material.youngs_modulus", "beam.material.density", "beam.length"
LEVEL, ARM = "motion.flight.acceleration.z.level", "motion.spin.arm"
AGREES = 1e-5


def relative(sensitivity: gb.Sensitivity, measure: str) -> dict[str, float]:
    """p/f ∂f/∂p by parameter."""
    return dict(zip(sensitivity.parameters, sensitivity.relative[sensitivity.measures.index(measure)], strict=True))


def test_powers_of_a_static_deflection_and_of_a_frequency(fast: Path) -> None:
    parameters = [E, DENSITY, LENGTH, "beam.section.thickness", "beam.section.width", LEVEL]
    tip = gb.sensitivity(fast, ["flight.tip.z"], parameters, verb="static")
    # w = ρ A a L⁴ / 8 E I, I = b h³ / 12: the shapes scale with the length, so that few of them change no power.
    assert list(relative(tip, "flight.tip.z").values()) == pytest.approx([-1, 1, 4, -2, 0, 1], abs=1e-9)
    assert set(tip.methods) == {"difference"} and (tip.errors < 1e-4 * np.abs(tip.derivatives) + 1e-12).all()
    slender = {"verb": "modes", "motion": "flight", "overrides": ["beam.rotary_inertia=false"]}
    modes = gb.sensitivity(fast, ["modes[0].frequency"], parameters[:4], **slender)
    assert list(relative(modes, "modes[0].frequency").values()) == pytest.approx([0.5, -0.5, -2, 1], abs=1e-9)
    rows = {line.split()[0]: line.split() for line in text(modes).splitlines() if line.strip()}
    slope = modes.derivatives[0, modes.parameters.index(E)]
    assert f"{slope:.4g}"[:4] in " ".join(rows[E])  # beside those of lengths, 1e12 times as large, it is no rounding
    assert "youngs_modulus" not in repr(modes).split("by")[1].split(",")[0]  # the length matters most


@pytest.mark.parametrize("integrator", ["newmark", "gauss"])
def test_exact_derivatives_are_those_of_runs_by_the_same_steps(fast: Path, integrator: str) -> None:
    measures = ["flight.tip.z.max_abs", "spin.tip.z.max_abs", "spin.loads.root_moment.y.max_abs", "verdict.tip"]
    parameters = [E, LENGTH, "beam.damping_ratio", LEVEL, ARM, "motion.spin.control_point"]
    ends = ["response.initial.state=undeformed", f"response.integrator={integrator}", "response.step=4 ms"]
    slopes = gb.sensitivity(fast, measures, parameters, overrides=ends)
    assert set(slopes.methods) == {"exact"} and not slopes.kinks.any() and np.isnan(slopes.errors).all()
    for j, path in enumerate(parameters):
        h = 1e-5 * slopes.values[j]
        figures = np.array([_figures(fast, [*ends, f"{path}={float(slopes.values[j] + s * h)!r}"]) for s in (1, -1)])
        difference = (figures[0] - figures[1]) / (2 * h)
        scale = [*np.abs(slopes.figures[:3]), 1.0]  # a verdict is a ratio less one
        error = np.abs(slopes.derivatives[:, j] - difference) * slopes.values[j] / scale
        assert (error <= AGREES * np.maximum(1e-2, np.abs(difference * slopes.values[j] / scale))).all(), path


def _figures(file: Path, overrides: list[str]) -> list[float]:
    case = gb.read_scenario(file, overrides)
    structure, settings = case.subject, replace(case.response, estimate=False)
    flight, spin = (gb.simulate(structure, case.motions[name], settings, name=name) for name in ("flight", "spin"))
    loads = spin.peaks.loads
    assert loads is not None
    moment = float(loads.moment.components.value[0, 1])
    return [flight.peaks.max_abs[2], spin.peaks.max_abs[2], moment, gb.compare(flight, spin).peaks["tip"].ratio - 1]


@pytest.mark.parametrize("tolerance", ["1 %", "0.01 %"])
def test_derivatives_are_of_as_many_shapes_as_their_run_needs(tolerance: str) -> None:
    text = f'title = "shapes"\n{SPECIMEN}[model]\nkind = "SFOAM"\n{FLIGHT}{response("0.1 s", tolerance=tolerance)}'
    base = loads(text, "scenario.toml")
    inquiry = Inquiry(ScenarioTemplate(base), "run", None, None)
    about = Neighbourhood(inquiry, [])
    shapes = about.answer.responses["flight"].q.shape[1]
    assert about.case.subject.size == shapes
    assert (shapes > inquiry.case(()).subject.size) == (tolerance == "0.01 %")


def test_what_tracks_another_motion_feels_its_values_and_only_that(fast: Path) -> None:
    slopes = gb.sensitivity(fast, ["flight.tip.z.max_abs", "spin.tip.z.max_abs"], [LEVEL, ARM])
    assert slopes.derivatives[0, 1] == 0 and (slopes.derivatives[[0, 1, 1], [0, 0, 1]] != 0).all()


def test_a_free_hub_is_differentiated_through_its_nonlinear_equations(tmp_path: Path) -> None:
    file = tmp_path / "hub.toml"
    file.write_text(FREE_HUB, encoding="utf-8")
    step = ["response.step=20 ms"]
    slopes = gb.sensitivity(
        file, ["hub.angle_end"], ["motion.slew.inertia", "motion.slew.torque.amplitude"], overrides=step
    )
    assert set(slopes.methods) == {"exact"}
    for j, path in enumerate(slopes.parameters):
        h = 1e-4 * slopes.values[j]
        cases = [
            gb.read_scenario(file, [*step, "response.estimate=false", f"{path}={float(slopes.values[j] + s * h)!r}"])
            for s in (1, -1)
        ]
        angles = []
        for case in cases:
            hub = gb.simulate(case.subject, case.motions["slew"], case.response).hub
            assert hub is not None
            angles.append(float(hub.angle[-1]))
        assert slopes.derivatives[0, j] == pytest.approx((angles[0] - angles[1]) / (2 * h), rel=AGREES)


SWINGING = """
title = "A rod on a bus"
[bodies.bus]
kind = "rigid"
mass = "5 kg"
inertia = [0.4, 0.5, 0.6]
points.side = { at = [0.3, 0, 0] }
[bodies.panel]
kind = "beam"
length = "1 m"
section = { shape = "rectangle", width = "0.2 m", thickness = "10 mm" }
material = { density = "300 kg/m^3", youngs_modulus = "1 GPa" }
damping_ratio = 0.01
model = { kind = "FOAM", modes = { axial = 0, y = 1, z = 2 } }
[joints.orbit]
kind = "free"
body = "bus"
[joints.hinge]
kind = "revolute"
body = "panel"
on = "bus.side"
axes = [[0, 1, 0]]
stiffness = 20.0
damping = 0.1
[forces.wheel]
on = "bus.root"
moment = { y = { profile = "sine", amplitude = "0.3 N m", duration = "1 s" } }
follower = true
[response]
duration = "1 s"
step = "10 ms"
estimate = false
"""


def test_a_run_of_several_bodies_is_differentiated_exactly(tmp_path: Path) -> None:
    """By a value of a beam, of a joint, of a rigid body's points and of a force."""
    file = tmp_path / "swinging.toml"
    file.write_text(SWINGING, encoding="utf-8")
    paths = ["bodies.panel.section.thickness", "joints.hinge.stiffness", "bodies.bus.points.side.at[0]",
             "forces.wheel.moment.y.amplitude"]  # fmt: skip
    slopes = gb.sensitivity(file, ["coordinates.hinge.angle.max", "coordinates.hinge.angle.rate_max"], paths)
    assert set(slopes.methods) == {"exact"} and np.isnan(slopes.errors).all()
    for j, path in enumerate(slopes.parameters):
        h, ends = 1e-5 * slopes.values[j], []
        for sign in (1, -1):
            case = gb.read_scenario(file, [f"{path}={float(slopes.values[j] + sign * h)!r}"])
            run = gb.simulate(case.system, None, case.response)
            k = run.coordinates.index("hinge.angle")
            ends.append(np.array([run.maxima.highest[k], run.maxima.rate[k]]))
        difference = (ends[0] - ends[1]) / (2 * h)
        assert slopes.derivatives[:, j] == pytest.approx(difference, rel=1e-5), path


def test_where_a_jump_moves_the_derivative_is_a_difference(tmp_path: Path) -> None:
    file = tmp_path / "slewing.toml"
    trapezoid = '"trapezoid", level = "1 rad/s", jerk = "0.5 rad/s^2", start = "2.03 s", hold = "1 s"'
    file.write_text(
        SLEWING.replace('"smooth-step", level = "2 rad/s", duration = "30 s"', trapezoid).replace("35 s", "5 s"),
        encoding="utf-8",
    )
    start, radius = "motion.slew.rate.start", "motion.slew.radius"
    slopes = gb.sensitivity(file, ["tip.y.time_of_max", "tip.y.max_abs"], [start, radius])
    assert slopes.methods == ("difference", "exact")
    # A hub that stands still until it starts moves the whole response with its start.
    assert slopes.derivatives[0, 0] == pytest.approx(1, abs=1e-3)
    assert abs(slopes.derivatives[1, 0]) < 1e-4 * slopes.figures[1]


def test_values_of_a_loads_profile_are_values_like_others(tmp_path: Path) -> None:
    """They were no values to a sensitivity, and missing without a word where it chose."""
    profile = 'profile = "trapezoid", level = "3 N", jerk = "30 N/s", start = "50 ms", hold = "0.1 s"'
    summed = '{ profile = "sum", terms = [{ profile = "sine", amplitude = "-0.1 N m", duration = "0.2 s" }] }'
    loads = f'loads = [{{ at = "300 mm", force = {{ z = {{ {profile} }} }}, moment = {{ y = {summed} }} }}]\n'
    file = tmp_path / "loaded.toml"
    file.write_text(SPECIMEN + loads + model("FOAM", 0, 1, 1) + FLIGHT + response("0.5 s"), encoding="utf-8")
    step = ["response.integrator=gauss", "response.step=1 ms"]
    slopes = gb.sensitivity(file, ["tip.z.max_abs", "tip.z.time_of_max"], overrides=step)
    paths = [f"beam.loads[0].force.z.{key}" for key in ("level", "jerk", "start", "hold")]
    paths += [f"beam.loads[0].moment.y.terms[0].{key}" for key in ("amplitude", "duration")]
    assert [each for each in slopes.parameters if each.startswith("beam.loads[0].")] == paths
    assert dict(zip(slopes.parameters, slopes.parameter_units, strict=True))[paths[1]] == "N/s"
    for path in paths:
        j = slopes.parameters.index(path)
        h = 1e-4 * abs(slopes.values[j])
        ends = []
        for sign in (1, -1):
            case = gb.read_scenario(
                file, [*step, "response.estimate=false", f"{path}={float(slopes.values[j] + sign * h)!r}"]
            )
            peaks = gb.simulate(case.subject, case.motions["flight"], case.response).peaks
            ends.append(np.array([peaks.max_abs[2], peaks.time_of_max[2]]))
        difference = (ends[0] - ends[1]) / (2 * h)
        assert slopes.methods[j] == "exact"
        assert slopes.derivatives[:, j] == pytest.approx(difference, rel=1e-4, abs=1e-6 * slopes.figures.max())


def test_positions_at_the_tip_move_with_the_length(fast: Path) -> None:
    massive = ['beam.masses=[{ at = "300 mm", mass = "0.1 kg" }]', f"{DENSITY}=1e-5"]
    slopes = gb.sensitivity(fast, ["flight.tip.z"], [LENGTH, E], verb="static", overrides=[*massive, "model.modes.z=6"])
    # m a L³ / 3 E I, of a beam that weighs nothing.
    assert list(relative(slopes, "flight.tip.z").values()) == pytest.approx([3, -1], abs=1e-6)
    with pytest.raises(gb.InputError, match=r"may not be a little less and a little more .*beyond the tip"):
        gb.sensitivity(fast, ["flight.tip.z"], ["beam.masses[0].at"], verb="static", overrides=massive)
    every = gb.sensitivity(fast, ["flight.tip.z"], verb="static", overrides=massive)
    assert "beam.masses[0].at" not in every.parameters
    (reason,) = every.not_varied
    assert reason.startswith("beam.masses[0].at: is ") and reason.endswith("beyond the tip")
    pieces, line = [f"beam.line.pieces[{k}].length" for k in (0, 1)], '[{ length = "100 mm" }, { length = "0.2 m" }]'
    slopes = gb.sensitivity(
        fast, ["flight.tip.z"], pieces, verb="static", overrides=[*massive, f"beam.line={{ pieces = {line} }}"]
    )
    assert list(relative(slopes, "flight.tip.z").values()) == pytest.approx([1, 2], abs=1e-3)


@pytest.mark.parametrize("in_python", [False, True], ids=["of a file", "in Python"])
def test_positions_at_the_tip_of_a_body_move_with_its_length(in_python: bool) -> None:
    """A strip of line density ρ with a mass m has √(E I / ρ L⁴) times a function of m / ρ L."""
    arm: Any = "examples/robot_arm.toml"
    still = ["system.gravity=[0, 0, 0]"]
    if in_python:
        arm, still = replace(gb.read_scenario(arm, still), title="made"), []
    of, by = "modes[0].frequency", ["bodies.strip.length", "bodies.strip.material.density"]
    by_length, by_density = relative(gb.sensitivity(arm, [of], by, verb="modes", overrides=still), of).values()
    assert by_length - by_density == pytest.approx(-1.5, abs=1e-4) and -0.4 < by_density < -0.2


@pytest.mark.parametrize(
    ("of", "by", "more", "words"),
    [
        ("flight.steps", E, [], "--of 'flight.steps' is a count, a flag or an estimate"),
        ("flight.error_estimate", E, [], "is a count, a flag or an estimate"),
        ("flight.tip.z.max", E, [], "did you mean"),
        ("flight.tip.z.max_abs", "beam.lenght", [], "did you mean 'beam.length'"),
        ("flight.tip.z.max_abs", "model.modes.z", [], "is no physical value"),
        ("flight.tip.z.max_abs", "beam.length=1 m:2 m", [], "give beam.length alone; a range is one of the bounds"),
        ("flight.tip.z.max_abs", "response.duration", [], "a setting of the computation"),
    ],
)
def test_what_has_no_derivative_is_refused_by_name(fast: Path, of: str, by: str, more: list[str], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        gb.sensitivity(fast, [of], [by], overrides=more)


def test_a_run_that_is_not_done_has_no_derivative(fast: Path) -> None:
    with pytest.raises(gb.ComputationError, match=r"motion.flight: the displacement exceeded the beam's length"):
        gb.sensitivity(fast, ["flight.tip.z.max_abs"], [E], overrides=[f"{E}=1e6"])


def test_the_command_prints_a_table_and_writes_a_file_and_plots(fast: Path, gbeam: Call, with_figures: None) -> None:
    words = ("sensitivity", fast, "--verb", "static", "--of", "flight.tip.z", "--with", f"{E}, {LENGTH}")
    done = gbeam(*words, "--out", "found")
    assert done.status == 0 and done.out.index(LENGTH) < done.out.index(E)  # the more important first
    assert sorted(path.name for path in Path("found").iterdir()) == [
        "flight.tip.z.png", "flight.tip.z.svg", "sensitivity.nc",
    ]  # fmt: skip
    facts = json.loads(gbeam(*words, "--json").out)["measures"]["flight.tip.z"]
    assert [each["path"] for each in facts["parameters"]] == [LENGTH, E]
    assert facts["parameters"][0]["relative"] == pytest.approx(4)
    assert facts["unit"] == "m" and facts["parameters"][1]["unit"] == "Pa"


def test_values_may_be_others_than_the_scenarios(fast: Path) -> None:
    from gbeam.scenario import load
    from gbeam.studies import Inquiry, physical_values

    base = load(fast)
    about = Neighbourhood(
        Inquiry(ScenarioTemplate(base), "static", "flight"), physical_values(ScenarioTemplate(base), [LENGTH]), [0.2]
    )
    answer = about.slopes(lambda _, facts: np.array([facts["motions"]["flight"]["bodies"]["beam"]["tip"]["z"]]))
    assert answer.slopes[0, 0] * 0.2 / answer.values[0] == pytest.approx(4, abs=1e-9)


def test_a_case_stands_for_its_file_until_it_is_changed(fast: Path) -> None:
    case = gb.read_scenario(fast, ["beam.length=250 mm"])
    by_case = gb.sensitivity(case, ["flight.tip.z"], [E], verb="static", overrides=["model.modes.z=3"])
    changes = ["beam.length=250 mm", "model.modes.z=3"]
    by_file = gb.sensitivity(fast, ["flight.tip.z"], [E], verb="static", overrides=changes)
    assert by_case.figures == by_file.figures and by_case.derivatives == by_file.derivatives
    assert by_case.provenance is not None and by_case.provenance.overrides == tuple(changes)
    swept = gb.sweep(case, {"beam.material.density": [2700]}, ["flight.tip.z"], verb="static")
    assert swept.provenance is not None and swept.provenance.overrides == tuple(changes[:1])
    # The file of one that was changed since is not its own: its objects are.
    renamed = gb.sensitivity(replace(case, title="another"), ["flight.tip.z"], [E], verb="static")
    assert renamed.title == "another" and renamed.measures == ("flight.tip.z",)


def test_exact_derivatives_come_with_the_error_of_their_run(fast: Path) -> None:
    judged = ["response.estimate=true"]
    slopes = gb.sensitivity(fast, ["flight.tip.z.max_abs"], [E], overrides=judged)
    errors = gb.study(gb.read_scenario(fast, judged)).responses["flight"].errors
    assert slopes.methods == ("exact",) and slopes.run_error == max(errors.displacement.total, errors.loads.total) > 0
    assert np.isnan(gb.sensitivity(fast, ["flight.tip.z"], [E], verb="static").run_error)


def test_the_error_of_a_run_is_that_of_its_loads_where_that_is_larger(tmp_path: Path) -> None:
    file = tmp_path / "torque.toml"
    file.write_text(FREE_HUB, encoding="utf-8")
    step = ["response.step=20 ms", "model.modes.y=2"]
    errors = gb.study(gb.read_scenario(file, step)).responses["slew"].errors
    assert errors.loads.total > 1.2 * errors.displacement.total
    assert (
        gb.sensitivity(file, ["tip.y.max_abs"], ["motion.slew.radius"], overrides=step).run_error == errors.loads.total
    )
