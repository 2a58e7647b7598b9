"""Cases made in Python, and those of files, are the same to every study."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest

import gbeam as gb
from gbeam.arrays import altered, arguments_of
from gbeam.motion import PiecewiseLinear
from gbeam.studies import CaseTemplate, ScenarioTemplate, template_of

from ..solids.bodies import block, solid

STEP = gb.SmoothStep(3.0, 2.0)
FLIGHT = gb.Flight(z=gb.SmoothStep(20.0, 0.1), rates=gb.constant([0.0, 0.0, 0.1]))
FIXED = ("response.step=2 ms", "response.estimate=false")


@pytest.mark.parametrize(
    "value",
    [
        gb.Hub(radius=0.5, rate=STEP),
        gb.Hub(radius=0.5, rate=STEP, inertia=3.0, pointing="inward", setting_angle=0.3, gravity=[0.0, -9.81, 0.0]),
        gb.Hub(radius=0.0, inertia=3.0, torque=STEP, stiffness=2.0, damping=0.1),
        gb.Hub(radius=0.5),
        FLIGHT,
        gb.Centrifuge(FLIGHT, arm=3.3, control_point=0.1, gravity=True, smoothing=0.1, mounting="inverted", idle=12.0),
        gb.Section.rectangle(0.02, 0.004, plate=True),
        gb.Section.tube([0.05, 0.03], [0.002, 0.002], stations=[0.0, 1.0]),
        gb.Section.general(1e-4, 1e-9, 2e-9),
        PiecewiseLinear([0.0, 1.0, 2.0], [0.0, 5.0, 1.0]),
    ],
    ids=lambda value: type(value).__name__,
)
def test_an_object_is_made_again_from_its_arguments(value: Any) -> None:
    arguments = arguments_of(value)
    assert arguments is not None
    assert altered(value) == value


def by_hand(file: Path, *changes: str) -> gb.Case:
    """Objects of a scenario, without the file that they came from."""
    return replace(gb.read_scenario(file, changes), provenance=None)


def test_both_templates_say_the_same_of_a_case(fast: Path) -> None:
    of_file, of_case = template_of(gb.read_scenario(fast)), template_of(by_hand(fast))
    assert isinstance(of_file, ScenarioTemplate) and isinstance(of_case, CaseTemplate)
    assert of_file.title() == of_case.title()
    read, built = of_file.quantities(), of_case.quantities()
    shared = {path for path in read.keys() & built.keys() if path.startswith(("beam.", "motion."))}
    assert {"beam.length", "beam.section.thickness", "beam.material.youngs_modulus", "motion.spin.arm"} <= shared
    assert {path: read[path] for path in shared} == {path: built[path] for path in shared}
    assert {path: of_file.unit(path) for path in shared} == {path: of_case.unit(path) for path in shared}


def test_a_change_of_a_case_is_that_of_its_file(fast: Path) -> None:
    for changes in (
        ("beam.length=150 mm", "beam.section.thickness=3 mm", "beam.material.youngs_modulus=68 GPa"),
        ("motion.spin.arm=3.1 m", "motion.spin.control_point=90 mm"),
        ("model.kind=SFOAM", "response.duration=0.2"),
    ):
        changed = template_of(by_hand(fast), changes).built()
        read = gb.read_scenario(fast, changes)
        assert changed.beam == read.beam and changed.model.kind == read.model.kind
        t = np.linspace(0.0, 0.2, 9)
        for name, motion in read.motions.items():
            assert changed.motions[name].over(0.0, 0.2).base(t) == motion.over(0.0, 0.2).base(t)
        assert changed.response.duration == read.response.duration


def test_a_sweep_of_a_case_is_that_of_its_file(fast: Path, tmp_path: Path) -> None:
    over = {"beam.section.thickness": ["2 mm", "2.5 mm"], "motion.spin.arm": [3.0, 3.3, -1.0]}
    read = gb.sweep(fast, over, overrides=FIXED)
    case = by_hand(fast, *FIXED)
    swept = gb.sweep(case, over)
    several = gb.sweep(case, over, workers=2, store=tmp_path / "store")
    again = gb.sweep(case, over, store=tmp_path / "store", resume=True)
    for other in (swept, several, again):
        assert list(other.measures) == list(read.measures) and other.units == read.units
        assert (other.outcome == read.outcome).all() and set(read.outcome[:, 2]) == {"refused"}
        for name in read.measures:
            np.testing.assert_array_equal(other.measures[name], read.measures[name])
        assert [each.unit for each in other.parameters] == [each.unit for each in read.parameters]


def test_searches_of_a_case_are_those_of_its_file(fast: Path, tmp_path: Path) -> None:
    case = by_hand(fast, *FIXED)
    of, values = ["spin.tip.z.max_abs", "flight.loads.root_moment.size.max_abs"], ["beam.length", "motion.spin.arm"]
    read, built = (gb.sensitivity(each, of, values) for each in (gb.read_scenario(fast, FIXED), case))
    np.testing.assert_array_equal(built.derivatives, read.derivatives)
    over, fewer = ["motion.spin.control_point"], {"bounds": {"motion.spin.control_point": ("50 mm", "200 mm")}}
    best = [gb.optimise(each, "verdict.tip", over, **fewer) for each in (gb.read_scenario(fast, FIXED), case)]
    assert best[0].values == best[1].values and best[0].figure == best[1].figure
    taps = tmp_path / "taps.csv"
    taps.write_text("mode,frequency\n1,40.0\n2,250.0\n")
    fits = [
        gb.fit(each, taps, ["beam.material.youngs_modulus"], motion="flight")
        for each in (gb.read_scenario(fast, FIXED), case)
    ]
    assert fits[0].values == fits[1].values


def test_a_command_is_shaped_for_a_case_made_in_python() -> None:
    beam = gb.Beam(8.0, gb.Section.rectangle(0.02, 0.02), gb.Material(2766.67, 6.8952e10), damping_ratio=0.0)
    hub, settings = gb.Hub(radius=0.5, rate=gb.SmoothStep(0.3, 15.0)), gb.ResponseSettings(20.0)
    case = gb.Case.of_beam("slew", beam, gb.Model("FOAM", axial=1, y=2), {"hub": hub}, settings)
    shaped = gb.shape_hub_command(case, duration=15.0)
    assert shaped.motion == "hub" and shaped.outcome == "done"
    longer = gb.shape_hub_command(case, duration=15.0, overrides=["beam.length=7 m"])
    assert longer.frequency[0] > 1.2 * shaped.frequency[0]


def test_a_machine_follows_the_flight_that_is_changed() -> None:
    beam = gb.Beam(0.2, gb.Section.rectangle(0.02, 0.002), gb.Material(2700.0, 70e9))
    machine = gb.Centrifuge(FLIGHT, arm=3.3, control_point=0.1, gravity=True, smoothing=0.1)
    motions = {"flight": FLIGHT, "machine": machine}
    case = gb.Case.of_beam(
        "", beam, gb.Model("TLAM", y=1, z=1), motions, gb.ResponseSettings(0.2), {"machine": "flight"}
    )
    (path,) = (each for each in template_of(case).quantities() if each.endswith(".level"))
    changed = template_of(case, [f"{path}=25"]).built().motions
    assert changed["flight"].acceleration(0.1)[2] == 25.0
    assert changed["machine"].flight == changed["flight"] and machine.flight.acceleration(0.1)[2] == 20.0


def test_a_motion_of_ones_own_is_swept_and_kept_in_no_store(fast: Path, tmp_path: Path) -> None:
    class Level(gb.Flight):
        """No other process, nor another day, has this class."""

    case = replace(by_hand(fast, *FIXED), motions={"flight": Level(z=9.81)}, tracks={}, accept={})
    over = {"beam.section.thickness": ["2 mm", "3 mm"]}
    assert gb.sweep(case, over, ["tip.z"], verb="static").outcome.tolist() == ["done", "done"]
    with pytest.raises(gb.InputError, match="store cannot know the case again"):
        gb.sweep(case, over, ["tip.z"], verb="static", store=tmp_path / "store")


def test_values_whose_unit_is_that_of_a_name_are_read_in_it() -> None:
    slide = gb.Joint("cylindrical", "bar", axes=[(1, 0, 0)], stiffness={"displacement": 2.0, "angle": 3.0})
    system = gb.System({"bar": gb.RigidBody(1.0, (1.0, 1.0, 1.0))}, {"j": slide})
    template = CaseTemplate(gb.Case("slide", system, {}, gb.ResponseSettings(1.0)))
    place = "joints.j.stiffness.displacement"
    assert template.quantities()[place] == (2.0, "stiffness")
    assert template.unit("joints.j.stiffness.angle") == "N m/rad"
    assert template.changed([f"{place}=3 N/mm"]).case.system.joints["j"].stiffness == {
        "displacement": 3e3,
        "angle": 3.0,
    }
    with pytest.raises(gb.InputError, match=f'{place} "3 N m/rad" is a rotational stiffness'):
        template.changed([f"{place}=3 N m/rad"])


def test_quantities_of_pint_are_varied_and_bound(fast: Path) -> None:
    mm = pint.UnitRegistry().mm
    static: Any = {"verb": "static", "motion": "flight", "at": 0.5}
    of_text, of_pint, of_arrays = (
        gb.sweep(fast, {"beam.length": lengths}, ["flight.tip.z"], **static)
        for lengths in (["280 mm", "290 mm"], [280 * mm, 290 * mm], np.array([280.0, 290.0]) * mm)
    )
    assert of_text == of_pint == of_arrays and of_pint.parameters[0].unit == "mm"
    width = "beam.section.width"
    best = [
        gb.optimise(fast, "flight.tip.z", [width], bounds={width: bounds}, **static)
        for bounds in ((0.01, 0.03), (10 * mm, 30 * mm))
    ]
    assert np.array_equal(best[0].bounds, best[1].bounds)


def test_what_a_case_cannot_vary_is_refused_at_its_place(fast: Path) -> None:
    case = by_hand(fast, *FIXED)
    for change, words in {
        "beam.lenght=1 m": "beam.lenght is no value that the case gives; did you mean 'length'",
        "beam.length=3 kg": "beam.length",
        "beam.length=-3 m": "beam.length is -3 m",
        "beam.section.thickness.x=3": "beam.section.thickness.x is no value that the case gives",
        "motion.nothing.arm=3": "motion.nothing is no value",
        "beam.length": "is not PATH=VALUE",
        "beam=3": "beam",
    }.items():
        with pytest.raises(gb.InputError) as refused:
            template_of(case, [change])
        assert words in str(refused.value), change


def test_a_solid_made_in_python_varies_by_its_motions() -> None:
    """Its mesh was reduced before, so that no value of it is known; it bends in proportion to the level of a flight."""
    mesh = solid(block("hexahedron20", (3, 1, 1), (0.1, 0.01, 0.01)))
    model = mesh.reduced(modes=1, damping_ratio=0.01)
    motions: dict[str, Any] = {"flight": gb.Flight(z=gb.SmoothStep(20.0, 0.01)), "hub": gb.Hub(radius=0.5, rate=3.0)}
    case = gb.Case("bar", gb.System.of(model.structure, "bar"), motions, gb.ResponseSettings(0.02))
    (level,) = (each for each in template_of(case).quantities() if each.endswith("parts[2].level"))
    swept = gb.sweep(case, {level: [20.0, 40.0]}, ["tip.z"], verb="static", motion="flight", at=0.02)
    rest = gb.static(model.structure, motions["flight"], 0.02).tip[2]
    np.testing.assert_allclose(swept.measures["tip.z"], [rest, 2 * rest], rtol=1e-6)  # loads stiffen it
    slope = gb.sensitivity(case, ["tip.z"], [level], verb="static", motion="flight", at=0.02)
    assert slope.derivatives[0, 0] == pytest.approx(rest / 20.0, rel=1e-6)
    limits: dict[str, Any] = {"subject_to": ["tip.z >= -4 um"], "bounds": {level: (1.0, 50.0)}}
    best = gb.optimise(case, "tip.z", [level], **limits, verb="static", motion="flight", at=0.02)
    assert best.figure == pytest.approx(50.0 / 20.0 * rest, rel=1e-6)
    with pytest.raises(gb.InputError, match="bodies is no value that the case gives; choose one of motion, response"):
        gb.sweep(case, {"bodies.bar.modes": [1.0]}, ["tip.z"], verb="static", motion="flight")
