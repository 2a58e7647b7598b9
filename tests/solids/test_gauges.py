"""Strain and stress at points of a solid as gauges read them, beside a beam's gauges."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.scenario import ScenarioError
from gbeam.structure import fibre_strain

from ..calling import main
from .bodies import STEEL, STIFF, block, solid
from .test_damage_at_points import HALF, B, H, L, beam, runs

pytestmark = pytest.mark.usefixtures("reading_in_process")

TURN = (0.0, 0.0, np.pi / 6)


@cache
def model() -> gb.SolidModel:
    points: dict[str, Any] = {
        "half": (HALF, 0.0, 0.5 * H),
        "askew": gb.Place((HALF, 0.0, 0.5 * H), TURN),
    }
    metal = gb.Material(2700, 70e9, poissons_ratio=0.0, fatigue_exponent=4.0)
    mesh = block("hexahedron20", (12, 2, 1), (L, B, H))
    return solid(mesh, metal, points=points).reduced(modes=4, damping_ratio=0.02)


@cache
def flown() -> tuple[gb.Response, gb.Response]:
    return runs(model().structure)


def test_a_gauge_on_a_solid_beam_reads_the_beams_strain() -> None:
    """Over time, in flight and on the machine: M z/EI half-way on the face towards +z."""
    for ours, theirs in zip(flown(), runs(beam()), strict=True):
        k = theirs.body.points.index("half") + 1
        assert theirs.loads is not None
        carried = theirs.loads.section_force[:, k], theirs.loads.section_moment[:, k]
        source = beam().source
        assert source is not None
        wanted = fibre_strain(source.beam, HALF, *carried, 0.0, H / 2)
        read = ours.strain_at("half")
        assert np.abs(read - wanted).max() < 6e-3 * np.abs(wanted).max() and np.abs(wanted).max() > 1e-5


def test_axes_of_a_gauge_are_those_of_its_point() -> None:
    """Mohr's circle: 30 degrees off a pull, with ν = 0, cos² of the strain, and half of the sine of twice the angle."""
    flight, _ = flown()
    along = flight.strain_at("half")
    size = np.abs(along).max()
    np.testing.assert_allclose(flight.strain_at("askew"), 0.75 * along, atol=5e-3 * size)
    undone = (np.cos(np.pi / 6), -np.sin(np.pi / 6), 0.0)  # x in axes of the point
    np.testing.assert_allclose(flight.strain_at("askew", undone), along, atol=1e-12)
    assert flight.solid is not None
    strain, stress = flight.solid.point_strain[:, 1], flight.solid.point_stress[:, 1]
    np.testing.assert_allclose(strain[:, 5], -np.sin(np.pi / 3) * along, atol=5e-3 * size)
    np.testing.assert_allclose(stress[:, 0], 70e9 * strain[:, 0], atol=1e-9 * 70e9)
    for point, words in (("nose", "point is 'nose'; choose from half, askew, tip"), ("half", "along is zero")):
        with pytest.raises(gb.InputError, match=words):
            flight.strain_at(point, (0.0, 0.0, 0.0) if point == "half" else (1.0, 0.0, 0.0))


def test_strain_is_that_of_hookes_law() -> None:
    """A pull by inertia of steel: ρ a (L − x)/E along, −ν of it across, both halves of a rosette at 45 degrees."""
    mesh = block("hexahedron20", (12, 1, 1), (L, B, H))
    bar = solid(mesh, STEEL, points={"half": (HALF, 0.0, H / 2)}).reduced(modes=2, damping_ratio=0.0)
    stress = bar.stress(gb.static(bar.structure, acceleration=(-0.5, 0.0, 0.0)))
    pull = STEEL.density * 0.5 * HALF / STEEL.youngs_modulus
    for way, share in (((1, 0, 0), 1.0), ((0, 2, 0), -0.3), ((1, 1, 0), 0.35), ((-1, 1, 0), 0.35)):
        assert stress.strain_at("half", way)[0] == pytest.approx(share * pull, rel=1e-3)


def test_a_rosette_at_45_degrees_reads_half_of_the_shear() -> None:
    """On the neutral axis of the side of a bar under its own weight: V Q/(I b G)/2, 1.5 V/A/(2 G), and no pull."""
    depth, wide = 0.04, 0.004  # upright, so that the shear does not vary across
    mesh = block("hexahedron20", (12, 1, 6), (L, wide, depth))
    side = solid(mesh, STEEL, points={"side": (HALF, wide / 2, 0.0)}).reduced(modes=2, damping_ratio=0.0)
    weight = 10.0
    stress = side.stress(gb.static(side.structure, acceleration=(0.0, 0.0, weight)))
    rigidity = STEEL.youngs_modulus / (2 * (1 + 0.3))
    shear = -1.5 * STEEL.density * weight * (L - HALF) / rigidity  # inertia acts along -z
    plant = gb.linearize(side.structure, gauges=[gb.Gauge("side", along=(1.0, 0.0, 1.0))])
    chosen = plant.select(inputs=["base_acceleration_z"], outputs=["strain_1"])
    gain = float((chosen.d - chosen.c @ np.linalg.solve(chosen.a, chosen.b))[0, 0])
    assert stress.strain_at("side", (1, 0, 1))[0] == pytest.approx(shear / 2, rel=0.03)
    assert stress.strain_at("side", (1, 0, -1))[0] == pytest.approx(-shear / 2, rel=0.03)
    assert weight * gain == pytest.approx(shear / 2, rel=0.03)
    assert abs(stress.strain_at("side", (1, 0, 0))[0]) < 0.02 * abs(shear)


def test_gauges_of_a_linear_model_are_those_of_the_beam() -> None:
    """Of the static gain of the acceleration to the strain; and of the run at rest."""
    solid_gauge, beam_gauge = gb.Gauge("half"), gb.Gauge(HALF, z=H / 2)
    ours = gb.linearize(model().structure, gb.Flight(z=0.0), gauges=[solid_gauge])
    theirs = gb.linearize(beam(), gb.Flight(z=0.0), gauges=[beam_gauge])
    gains = []
    for plant in (ours, theirs):
        chosen = plant.select(inputs=["base_acceleration_z"], outputs=["strain_1"])
        gains.append(float((chosen.d - chosen.c @ np.linalg.solve(chosen.a, chosen.b))[0, 0]))
    assert gains[0] == pytest.approx(gains[1], rel=5e-3)
    rest = model().stress(gb.static(model().structure, acceleration=(0.0, 0.0, 1.0)))
    assert rest.strain_at("half")[0] == pytest.approx(gains[0], rel=1e-4)


def gain(plant: gb.StateSpace, name: str, rate: float) -> complex:
    """From the acceleration of the base along z, at an angular frequency in rad/s."""
    one = plant.select(inputs=["base_acceleration_z"], outputs=[name])
    return complex((one.c @ np.linalg.solve(1j * rate * np.eye(len(one.a)) - one.a, one.b) + one.d)[0, 0])


def test_gauges_in_a_system_are_those_of_the_structure_alone() -> None:
    """A solid on a fixed joint, and a bent beam with a mass that hangs on its tip in place of one that is its own."""
    section, lump = gb.Section.rectangle(width=B, thickness=H), gb.RigidBody(0.1, (2e-6, 3e-6, 4e-6))
    kept = gb.Model("exact", axial=1, y=2, z=3, shapes="clamped-free")
    bare, laden = (
        gb.assemble(gb.Beam(L, section, STIFF, damping_ratio=0.0, masses=masses), kept)
        for masses in ([], [gb.PointMass(L, lump.mass, inertia=(2e-6, 3e-6, 4e-6))])
    )
    hung = {"lump": lump}, {"end": gb.Joint("fixed", "lump", on="bar.tip")}
    solid_gauges = [gb.Gauge("half"), gb.Gauge("askew")]
    fibres = [gb.Gauge(x, y=0.3 * B, z=0.5 * H) for x in (0.1, 0.0, HALF)]
    for one, bar, gauges, (bodies, joints) in (
        (model().structure, model().structure, solid_gauges, ({}, {})),
        (laden, bare, fibres, hung),
    ):
        base = gb.Flight(x=-2.0, y=10.0, z=30.0)
        alone = gb.linearize(one, base, gauges=gauges)
        system = gb.System({"bar": bar, **bodies}, {"wall": gb.Joint("fixed", "bar"), **joints})
        tree = gb.linearize(system, base, gauges=[replace(each, body="bar") for each in gauges])
        for k, _ in enumerate(gauges):
            name = f"strain_{k + 1}"
            read = (each.output[[signal.name for signal in each.outputs].index(name)] for each in (alone, tree))
            assert next(read) == pytest.approx(next(read), rel=1e-9) and gain(alone, name, 0.0) != 0
            assert gain(tree, name, 200.0) == pytest.approx(gain(alone, name, 200.0), rel=1e-9)
        first = gb.linearize(
            system, base, gauges=[replace(gauges[0], body="bar")], outputs=["bar.tip.place_z", "strain_1"]
        )
        assert [each.name for each in first.outputs] == ["bar.tip.place_z", "strain_1"]
        assert gain(first, "strain_1", 200.0) == gain(tree, "strain_1", 200.0)
        with pytest.raises(gb.InputError, match=r"gauges\[0\].body is 'lump'; choose one of bar"):
            gb.linearize(system, gauges=[replace(gauges[0], body="lump")])
        with pytest.raises(gb.InputError, match=r"gauges\[0\].body is 'bar', and there is one structure; leave it out"):
            gb.linearize(one, base, gauges=[replace(gauges[0], body="bar")])


@pytest.mark.parametrize(
    ("structure", "gauge", "words"),
    [
        ("solid", gb.Gauge("nose"), r"gauges\[0\].at is 'nose'; choose from half, askew, tip"),
        ("solid", gb.Gauge(0.1), r"gauges\[0\].at is '0.1'; choose from"),
        ("beam", gb.Gauge("half"), r"gauges\[0\].at is 'half', on a beam; give the position along it, m"),
        ("box", gb.Gauge("tip"), "structure is rigid, and this is of what deforms"),
    ],
)
def test_gauges_that_read_nothing_are_refused(structure: str, gauge: gb.Gauge, words: str) -> None:
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.0, 0.0, 0.05))
    chosen = {"solid": model().structure, "beam": beam(), "box": box.structure}[structure]
    with pytest.raises(gb.InputError, match=words):
        gb.linearize(chosen, gb.Flight(z=0.0), gauges=[gauge])


SCENARIO = """
[bodies.bar]
mesh = "bar.vtk"
unit = "m"
clamp = "wall"
modes = 2
damping_ratio = "2 %"
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.0 }
[bodies.bar.points]
gauge = { at = ["150 mm", 0, "5 mm"], turn = [0, 0, "30 deg"] }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "trapezoid", level = "8 g", jerk = "40 g/s", start = "0.1 s", hold = "0.3 s" } }
[response]
duration = "1 s"
step = "4 ms"
integrator = "gauss"
estimate = false
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    import meshio

    mesh = block("hexahedron20", (6, 1, 1), (L, B, H))
    wall = mesh.point_sets["wall"]
    cells = mesh.cells_dict["hexahedron20"]
    used, number = np.unique(cells, return_inverse=True)
    held = np.flatnonzero(np.isin(used, wall))
    end = np.flatnonzero(mesh.points[used][:, 0] > 0.99 * L)
    kept = meshio.Mesh(
        mesh.points[used], {"hexahedron20": number.reshape(-1, 20)}, point_sets={"wall": held, "end": end}
    )
    meshio.write(tmp_path / "bar.inp", kept)
    file = tmp_path / "bar.toml"
    file.write_text(SCENARIO.replace("bar.vtk", "bar.inp"), encoding="utf-8")
    return file


def test_the_stiffness_of_a_solid_is_fitted_to_a_gauge(scenario: Path) -> None:
    """A strain of a bar twice as soft is twice as large; the gauge's axis lies 30 degrees off."""
    case = gb.read_scenario(scenario)
    response = gb.study(case).responses["flight"]
    strain = response.strain_at("gauge")
    data = scenario.parent / "gauge.csv"
    np.savetxt(
        data, np.stack([response.time, 1e6 * strain], axis=1), delimiter=",", header="time,strain.x@gauge [µm/m]",
        comments="", encoding="utf-8",
    )  # fmt: skip
    path = "bodies.bar.material.youngs_modulus"
    fitted = gb.fit(scenario, data, [path], overrides=[f'{path}="60 GPa"'])
    assert fitted.values[0] == pytest.approx(70e9, rel=1e-4) and fitted.before[0] == 60e9
    wrong = scenario.parent / "wrong.csv"
    np.savetxt(
        wrong, np.stack([response.time, strain], axis=1), delimiter=",", header="time,strain.x@nose", comments=""
    )
    with pytest.raises(gb.InputError, match="has a gauge that is 'nose'; choose from gauge, tip"):
        gb.fit(scenario, wrong, [path])


def test_a_gauge_says_where_it_is() -> None:
    gauge = gb.Gauge("half", along=(0.0, 1.0, 0.0))
    assert asdict(gauge) == {"at": "half", "y": 0.0, "z": 0.0, "along": (0.0, 1.0, 0.0), "body": ""}
    with pytest.raises(gb.InputError, match="along is zero"):
        gb.Gauge("half", along=(0.0, 0.0, 0.0))
    assert all(a <= b for a, b in pairwise(flown()[0].time))


# A bar with another body; one that the ground holds alone is answered as [bodies.bar] without joints.
JOINED = """
[joints.wall]
kind = "fixed"
body = "bar"
[bodies.speck]
kind = "rigid"
mass = "1e-9 kg"
[joints.speck]
kind = "fixed"
body = "speck"
on = "bar.root"
"""


def test_gauges_of_a_scenario_from_the_command_line(scenario: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Three at a point, along its axes; a point that is not there is named."""
    assert main(["linearize", str(scenario), "--strain-at", "gauge"]) == 0
    assert "strain_2 gauge (0, 1, 0)" in " ".join(capsys.readouterr().out.split())
    assert main(["linearize", str(scenario), "--strain-at", "nose"]) == 2
    assert "--strain-at is 'nose'; choose from gauge, tip" in capsys.readouterr().err
    text = scenario.read_text(encoding="utf-8")
    scenario.write_text(text.replace("[motion", f"{JOINED}[motion"), encoding="utf-8")
    assert main(["linearize", str(scenario), "--strain-at", "bar.gauge"]) == 0
    assert "strain_2 bar, gauge (0, 1, 0)" in " ".join(capsys.readouterr().out.split())
    assert main(["linearize", str(scenario), "--strain-at", "gauge"]) == 2
    assert "--strain-at is 'gauge'; choose one of bar" in capsys.readouterr().err


@pytest.mark.parametrize("system", [False, True])
def test_a_run_says_what_is_at_its_points(
    scenario: Path, system: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Displacement, what an accelerometer reads, stress and strain of a mesh, alone and in a system."""
    at = "bar.gauge" if system else "gauge"
    joint = JOINED if system else ""
    sensor = f'{joint}[sensors."{at}"]\nfrequency = "20 Hz"\n[motion'
    scenario.write_text(scenario.read_text(encoding="utf-8").replace("[motion", sensor), encoding="utf-8")
    run = gb.study(gb.read_scenario(scenario)).responses["flight"]
    stress = run.bodies["bar"].solid
    read, strain = run.readings.acceleration[:, 0] / 9.80665, 1e6 * np.abs(stress.strain_at("gauge")).max()
    assert main(["run", str(scenario), "--out", str(tmp_path / "out")]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    (row,) = [line for line in lines if at in line and len(line) > 4]
    assert float(row[-1]) == pytest.approx(strain, rel=1e-3) and strain > 10
    assert float(row[-3]) == pytest.approx(np.linalg.norm(read, axis=1).max(), rel=1e-3)


def test_a_bad_place_of_a_gauge_is_read_aloud(scenario: Path) -> None:
    text = scenario.read_text(encoding="utf-8")
    for before, after, place in (
        ('turn = [0, 0, "30 deg"]', 'turn = [0, "30 deg"]', "bodies.bar.points.gauge.turn"),
        ('"5 mm"], turn', '"5 mm"], turns', "bodies.bar.points.gauge.turns"),
        ('at = ["150 mm", 0, "5 mm"]', 'at = ["9 m", 0, "5 mm"]', "bodies.bar.points.gauge"),
    ):
        scenario.write_text(text.replace(before, after), encoding="utf-8")
        with pytest.raises(ScenarioError) as caught:
            gb.read_scenario(scenario)
        assert place in str(caught.value)


MACHINE = """
[motion.machine]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "220 mm"
gravity = true
idle = "1.3 g"
clip = true
smoothing = "50 ms"
accept = { srs = "40 dB", damage = 1000, damage_at = "gauge", control = { gauge = 1, tip = 1 } }
"""


def test_a_scenario_of_a_mesh_is_judged_at_its_points(scenario: Path) -> None:
    """Spectra and damage by names of points; an interface is one, and what is none is read aloud."""
    text = scenario.read_text(encoding="utf-8").replace("[response]", MACHINE + "[response]")
    scenario.write_text(text, encoding="utf-8")
    (compared,) = gb.study(gb.read_scenario(scenario)).comparisons
    srs, damage = compared.criteria
    assert (srs.name, damage.name, damage.where) == ("srs", "damage", "at gauge")
    assert np.isfinite(srs.value) and np.isfinite(damage.value) and compared.accepted
    assert compared.shock is not None and compared.shock.control == "gauge (50 %), tip (50 %)"
    for key in ("damage_at", "stress_at"):
        scenario.write_text(text.replace('damage_at = "gauge"', f'{key} = "gouge"'), encoding="utf-8")
        with pytest.raises(ScenarioError, match="did you mean 'gauge'"):
            gb.read_scenario(scenario)
    seated = text.replace("[bodies.bar.points]", '[bodies.bar.interfaces]\nseat = "end"\n[bodies.bar.points]')
    scenario.write_text(seated.replace('damage_at = "gauge"', 'damage_at = "seat"'), encoding="utf-8")
    (seat,) = (each for each in gb.study(gb.read_scenario(scenario)).comparisons[0].criteria if each.name == "damage")
    assert seat.where == "at seat" and np.isfinite(seat.value)


def test_limits_of_what_a_system_does_not_have_are_refused() -> None:
    rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
    bodies: dict[str, Any] = {"rod": rod}
    joints = {"clamp": gb.Joint("fixed", "rod")}
    for more, accept, words in (
        ({}, {"stress": 0.1}, "motion.spun.accept.stress is of a stress, and rod is rigid"),
        (
            {"strip": beam()},
            {"damage": 2.0, "damage_at": "rod.end"},
            "is on rod, which is no beam and no mesh; choose a point of strip",
        ),
    ):
        held = joints | {name: gb.Joint("fixed", name) for name in more}
        system = gb.System(bodies | more, held)
        with pytest.raises(gb.InputError, match=words):
            gb.Case("", system, {}, gb.ResponseSettings(duration=1.0), accept={"spun": accept})
