"""Systems, solids and rigid boxes find their place by the same answers as a beam does."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis.imitation.place import place
from gbeam.analysis.imitation.place_measures import Choice
from gbeam.analysis.imitation.specimen import Specimen
from gbeam.cli import main
from gbeam.questions import QUESTIONS

from ..scenarios import FLIGHT, SPIN, response
from ..solids.bodies import STIFF, block, solid

METAL = gb.Material(STIFF.density, STIFF.youngs_modulus)
STRIP = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), METAL, damping_ratio=0.01)
CLAMP = {"clamp": gb.Joint("fixed", "strip")}
NOW = np.linspace(0.0, 1.0, 3)


def placed(structure: Any, flight: Any, spin: Any, settings: Any, measure: str) -> Any:
    choice = Choice(lambda mounting, w: spin(w), ("upright",), (0.0596,), refined=False)
    return place(structure, flight, choice, settings, {measure: 1.0}, current=spin())


@pytest.mark.parametrize("measure", ["root-moment", "tip", "vibration", "load"])
def test_a_system_of_one_beam_is_placed_as_the_beam(flight: Any, spin: Any, settings: Any, measure: str) -> None:
    structure = gb.assemble(STRIP, "exact", axial=0, y=1, z=2)
    system = gb.System({"strip": structure}, CLAMP)
    one, other = (placed(each, flight, spin, settings, measure) for each in (structure, system))
    assert other.best.control_point == pytest.approx(one.best.control_point, abs=1e-9)
    for name, share in one.values["current"].items():
        # Along its axis too: of the force, which for a beam is the shear.
        assert other.values["current"][name] == pytest.approx(share, rel=2e-2 if name == "root-shear" else 1e-4), name
    assert other.point == "strip.tip" and np.isnan(other.fraction) and one.point == ""


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
    found = placed(box.structure, flight, spin, settings, "root-shear")
    assert found.best.control_point == pytest.approx(0.18, abs=1e-6)
    assert found.values["best"]["root-shear"] < 1e-5 and found.values["current"]["root-shear"] > 1e-2
    assert found.values["best"].keys() == {"root-shear", "root-moment", "load"}
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
    specimen = Specimen.of(structure, NOW)
    from gbeam.analysis.steady.equilibrium import solve_equilibrium
    from gbeam.motion.bases.base import Base, gradients

    rng = np.random.default_rng(26)
    for _ in range(3):
        a, w, alpha = 1e-3 * rng.normal(size=3), 3e-2 * rng.normal(size=3), 1e-3 * rng.normal(size=3)
        rest = solve_equilibrium(structure, Base(a, w, alpha))
        answer = specimen.displacement["tip"].at(a, gradients(w, alpha))
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
    assert placed(gb.System({"strip": structure}, {"hinge": held}), flight, spin, settings, "tip").best.mismatch < 1e-3
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
