"""Every verb and every result warns of implausible input; the impossible is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.guards import RANGES, implausible
from gbeam.scenario import template

from . import scenarios, specimens
from .calling import Answer, gbeam

__all__ = ["gbeam"]


STRIP, METAL = specimens.STRIP, specimens.ALUMINIUM
FLIGHT = gb.Flight(z=9.81)


def beam(length: float = 0.3, section: gb.Section = STRIP, metal: gb.Material = METAL, **more: Any) -> gb.Beam:
    return gb.Beam(length, section, metal, damping_ratio=more.pop("damping_ratio", 0.01), **more)


def doubts(result: gb.Rest) -> list[str]:
    """Its warnings of its input; one shape is too few besides, and the exact beam may have no equilibrium."""
    of_error = "wrong by an estimated", "shapes and model are not judged", "a beam that twists would not stay"
    return [each for each in result.warnings if not any(words in each for words in (*of_error, "twists under it"))]


SLIPS = {
    "beam.length is 600 m": (beam(600.0), "did you mean 600 mm?"),
    "beam.material.youngs_modulus is 200 Pa": (beam(metal=gb.Material(2700.0, 200.0)), "did you mean 200 GPa?"),
    "beam.material.youngs_modulus is 70000 Pa": (beam(metal=gb.Material(2700.0, 7e4)), "did you mean 70000 MPa?"),
    "beam.material.density is 1.6 kg/m^3": (beam(metal=gb.Material(1.6, 7e10)), "did you mean 1.6 g/cm^3?"),
    "beam.material.yield_strength is 250 Pa": (
        beam(metal=gb.Material(2700.0, 7e10, yield_strength=250.0)),
        "did you mean 250 MPa?",
    ),
    "beam.section.width is 20 m": (beam(section=gb.Section.rectangle(20.0, 0.004)), "did you mean 20 mm?"),
    "beam.section.thickness is 4 m, more than the beam's length": (
        beam(section=gb.Section.rectangle(0.02, 4.0)),
        "did you mean 4 mm?",
    ),
    "beam.section.inertia_y is 100 m^4": (
        beam(section=gb.Section.general(8e-5, 100.0, 1e-9)),
        "did you mean 100 mm^4?",
    ),
    "beam.section.inertia_z and area make a radius of gyration of 11180.3 m": (
        beam(section=gb.Section.general(8e-8, 1e-16, 10.0)),
        "are their units right?",
    ),
    "beam.length, 0.3 m, is 4.16 times the section's radius of gyration along z": (
        beam(section=gb.Section.rectangle(0.02, 0.25)),
        "no beam is as stout",
    ),
    "beam.damping_ratio is 0.5": (beam(damping_ratio=0.5), "did you mean 0.5 %?"),
    "beam.masses[0].mass is 100 kg, 1.54e+03 times the beam's": (
        beam(masses=[gb.PointMass(0.3, 100.0)]),
        "did you mean 100 g?",
    ),
    "beam.material.youngs_modulus is 210 MPa, of 7850 kg/m^3": (
        beam(metal=gb.Material(7850, 210e6)),
        "so that sound travels at 164 m/s: nothing as dense is as soft; did you mean 210 GPa?",
    ),
    "beam.material.youngs_modulus is 70000 MPa, of 27 kg/m^3": (
        beam(metal=gb.Material(27, 70e9)),
        "nothing as light is as stiff; are their units right?",
    ),
    "beam.material.yield_strength is 0.35 MPa, 1.67e-06 times": (
        beam(metal=gb.Material(7850, 210e9, yield_strength=350e3)),
        "are their units right?",
    ),
    "beam.material.shear_modulus is 26 MPa, 0.000371 times": (
        beam(metal=gb.Material(2700, 70e9, shear_modulus=26e6)),
        "are their units right?",
    ),
    "beam.masses[0].inertia is up to 12 kg m^2": (
        beam(masses=[gb.PointMass(0.3, 10.0, inertia=(12.0, 12.0, 12.0))]),
        "did you mean 12 kg mm^2?",
    ),
    "beam.masses[0].offset is 20 m": (beam(masses=[gb.PointMass(0.3, 0.1, offset=(0.0, 20.0, 0.0))]), "its unit"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_named(slip: str) -> None:
    built, advice = SLIPS[slip]
    (warning,) = doubts(gb.static(gb.assemble(built, "FOAM", y=1, z=1), FLIGHT))
    assert warning.startswith(slip) and advice in warning


@pytest.mark.parametrize(
    ("density", "modulus", "strength", "shear"),
    [
        (7850, 210e9, 250e6, 81e9), (11340, 16e9, 5e6, 5.6e9), (19300, 78e9, 2e8, 27e9), (1850, 303e9, 3e8, 135e9),
        (2200, 900e9, 2e9, 6e9), (1600, 135e9, 1.5e9, 5e9), (1600, 17e9, 1e8, 33e9), (450, 11e9, 4e7, 0.7e9),
        (1100, 5e6, 2e7, 1.7e6), (60, 70e6, 1e6, 20e6), (1150, 2.7e9, 8e7, 1e9), (970, 100e9, 3e9, 1e9),
    ],
    ids=["steel", "lead", "gold", "beryllium", "pitch-fibre", "carbon-epoxy", "plies-at-45", "spruce", "rubber", "foam",
         "nylon", "polyethylene-fibre"],
)  # fmt: skip
def test_no_material_that_there_is_is_doubted(density: float, modulus: float, strength: float, shear: float) -> None:
    metal = gb.Material(density, modulus, yield_strength=strength, shear_modulus=shear)
    assert not [each for each in gb.assemble(beam(metal=metal), "FOAM", y=1, z=1).warnings if "material" in each]


MOTIONS = {
    "motion.radius is 500 m": (gb.Hub(radius=500.0, rate=1.0), "did you mean 500 mm?"),
    "motion.rate is 6000 rad/s": (gb.Hub(radius=0.5, rate=6000.0), "did you mean 6000 deg/s?"),
    "motion.gravity is 1 m/s^2": (gb.Hub(radius=0.5, gravity=(0.0, 0.0, -1.0)), "did you mean 1 g?"),
    "motion.acceleration is 200000 m/s^2": (gb.Flight(z=2e5), "did you mean 200000 mm/s^2?"),
}


@pytest.mark.parametrize("slip", MOTIONS)
def test_a_slip_of_a_motion_is_named(slip: str) -> None:
    motion, advice = MOTIONS[slip]
    (warning,) = doubts(gb.static(gb.assemble(beam(), "FOAM", y=1, z=1), motion))
    assert warning.startswith(slip) and advice in warning


def test_an_arm_in_millimetres_is_named_by_plan() -> None:
    machine = gb.Centrifuge(FLIGHT, arm=3300.0, control_point=0.15, inverse="flat", gravity=False).over(0.0, 0.5)
    from gbeam.motion import implausible_motion

    (warning,) = implausible_motion(machine, "motion.spin", (0.0, 0.5))
    assert warning.startswith("motion.spin.arm is 3300 m") and "3300 mm" in warning


ACROSS = {
    "motion accelerates the root, or gravity does, along y": (beam(), gb.Flight(y=1.0)),
    "motion.slew accelerates the root, or gravity does, along y": (beam(), gb.Hub(radius=0.5, gravity=(0, -9.81, 0))),
    "beam.loads[0].force bends the beam along y": (beam(loads=[gb.Load(0.3, force=(0, 1, 0))]), FLIGHT),
    "beam.loads[0].moment bends the beam along y": (beam(loads=[gb.Load(0.3, moment=(0, 0, 1))]), FLIGHT),
}


@pytest.mark.parametrize("words", ACROSS)
def test_a_direction_without_shapes_is_warned_of(words: str) -> None:
    laden, motion = ACROSS[words]
    name = "slew" if isinstance(motion, gb.Hub) else ""
    flat, full = (gb.assemble(laden, "FOAM", y=y, z=1) for y in (0, 1))
    (warning,) = doubts(gb.static(flat, motion, name=name))
    assert warning.startswith(words) and warning.endswith("give model.modes.y = 1 or more")
    assert gb.simulate(flat, motion, duration=0.05, step=1e-3, name=name).warnings[0] == warning
    assert not doubts(gb.static(full, motion))


PANEL = gb.Section.rectangle(0.5, 0.02)
SLEW, TORQUE = gb.SmoothStep(0.5, 2.0), gb.Sine(10.0, 2.0)


@pytest.mark.parametrize("drive", [{"rate": SLEW}, {"inertia": 50.0, "torque": TORQUE}], ids=["rate", "torque"])
def test_a_panel_that_a_hub_bends_on_edge_is_named(drive: dict[str, Any]) -> None:
    """It bent by 8e-5 mm in its stiff direction, without a word."""
    panel = gb.assemble(beam(2.0, PANEL), "FOAM", y=1, z=1)
    short: dict[str, Any] = {"duration": 0.5, "step": 5e-3, "estimate": False, "name": "slew"}
    on_edge = gb.simulate(panel, gb.Hub(radius=0.5, **drive), **short)
    (warning,) = (each for each in on_edge.warnings if "plane of rotation" in each)
    assert warning == (
        "motion.slew bends the beam along y, in its plane of rotation, where it is 625 times as stiff as along z; "
        'give motion.slew.setting_angle = "90 deg" to turn it, or "0 deg" if this is meant'
    )
    for angle in (0.0, np.pi / 2):
        meant = gb.simulate(panel, gb.Hub(radius=0.5, setting_angle=angle, **drive), **short)
        assert not any("plane of rotation" in each for each in meant.warnings)
    square = gb.assemble(beam(2.0, gb.Section.rectangle(0.06, 0.02)), "FOAM", y=1, z=1)
    assert not any(
        "plane of rotation" in each for each in gb.simulate(square, gb.Hub(radius=0.5, **drive), **short).warnings
    )
    assert not any("plane of rotation" in each for each in gb.modes(panel, gb.Hub(radius=0.5, rate=3.0)).warnings)


def test_results_print_their_warnings() -> None:
    long = gb.assemble(beam(600.0), "FOAM", y=1)
    hub = gb.Hub(radius=0.5, rate=1.0, gravity=(0, 0, 0))  # said, so that nothing is noted
    for result in (gb.static(long), gb.modes(long), gb.critical_speed(long, hub), gb.linearize(long, hub)):
        assert repr(result).endswith("warning: " + result.warnings[-1])


def test_a_root_spring_is_a_shape() -> None:
    sprung = gb.assemble(beam(root=gb.Root(rotation_z=100.0)), "FOAM", z=1)
    assert not doubts(gb.static(sprung, gb.Flight(y=1.0)))


def test_every_verb_warns(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    file = tmp_path / "metres.toml"
    file.write_text(scenarios.EVERY_MOTION.replace('"300 mm"', '"300 m"').replace("4 s", "1 s"))
    slip = "beam.length is 300 m, outside the plausible 0.001 to 200 m; did you mean 300 mm?"
    verbs = [
        ("check",),
        ("static", "--motion", "flight"),
        ("modes", "--motion", "flight"),
        ("campbell", "--motion", "slew", "--to", "1 rad/s", "--out", tmp_path),
        ("critical-speed", "--motion", "slew"),
        ("linearize", "--motion", "flight"),
        ("run", "--set", "response.step=0.1 s", "--out", tmp_path),
    ]
    for verb, *options in verbs:
        assert f"warning: {slip}" in gbeam(verb, file, *options).out, verb
        assert slip in str(gbeam(verb, file, *options, "--json").json), verb


def test_one_warning_of_the_beam_stands_once_in_the_summary(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    file = tmp_path / "light.toml"
    file.write_text(scenarios.FAST.replace("2700 kg/m^3", "1.6 kg/m^3"))
    assert gbeam("run", file, "--set", "response.step=1 ms", "--out", tmp_path).out.count("density is 1.6") == 1


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ("response.step=5e-324 s", "response.step: is 4.94066e-324 s"),
        ("beam.length=1e300 m", "beam.length: is 1e+300 m"),
        ("beam.material.density=1e-300", "beam.material.density: is 1e-300 kg/m^3"),
        ("response.duration=1e300 s", "response.duration: is 1e+300 s"),
    ],
)
def test_the_impossible_is_refused_at_its_place(
    gbeam: Callable[..., Answer], tmp_path: Path, change: str, place: str
) -> None:
    file = tmp_path / "s.toml"
    file.write_text(scenarios.FAST)
    answer = gbeam("check", file, "--set", change)
    assert answer.status == 2 and place in answer.err and "give " in answer.err


def test_specimens_and_templates_are_plausible() -> None:
    texts = [template("flight"), template("hub"), scenarios.EVERY_MOTION, scenarios.FREE_HUB, scenarios.SLEWING]
    for text in texts:
        level = text.replace("[motion.slew]\n", '[motion.slew]\nsetting_angle = "0 deg"\n')  # it is on edge
        assert not gb.describe(_case(level)).warnings
    for structure in (specimens.laden("FOAM"), specimens.strip(), specimens.hub_beam("FOAM")):
        assert not structure.warnings


def _case(text: str) -> gb.Case:
    from gbeam.scenario import build, loads

    return build(loads(text))


@pytest.mark.parametrize("kind", RANGES)
def test_the_table_is_ordered_and_warns_outside_it(kind: str) -> None:
    each = RANGES[kind]
    assert each.least <= each.low < each.high <= each.most
    assert not implausible("x", kind, each.low) and not implausible("x", kind, each.high)
    assert implausible("x", kind, np.nextafter(each.high, np.inf))
