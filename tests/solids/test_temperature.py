"""Solids and shells that are heated, against closed forms and beams: expansion, stress, reactions, buckling."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb

from .bodies import block

pytestmark = pytest.mark.usefixtures("reading_in_process")

LENGTH, WIDTH, HEIGHT, MODULUS, EXPANSION, COLD, RISE = 0.3, 0.02, 0.01, 70e9, 23e-6, 293.15, 40.0
EA = MODULUS * WIDTH * HEIGHT
METAL = gb.Material(2700.0, MODULUS, poissons_ratio=0.33, expansion=EXPANSION)
STRAIGHT = gb.Material(2700.0, MODULUS, poissons_ratio=0.0, expansion=EXPANSION)  # ends that are clamped do not press
GROUPS = {
    "end": lambda x: x[:, 0] == LENGTH,
    "below": lambda x: x[:, 2] == -HEIGHT / 2,
    "beside": lambda x: x[:, 1] == -WIDTH / 2,
}
PLANES = [gb.Support("wall", ["x"]), gb.Support("below", ["z"]), gb.Support("beside", ["y"])]


def warm(rise: Any = RISE) -> gb.Temperature:
    """A temperature above the reference by a rise, K."""
    return gb.Temperature(COLD + rise, reference=COLD)


def read(mesh: Any, *supports: gb.Support, metal: Any = METAL, rise: Any = RISE, **keys: Any) -> gb.SolidMesh:
    temperature = None if rise is None else warm(rise)
    keys = {"clamp": (), "unit": "m", "temperature": temperature} | keys
    return gb.SolidMesh.read(mesh, materials=metal, supports=supports, **keys)


def bar(*supports: gb.Support, kind: str = "hexahedron20", **keys: Any) -> Any:
    """A bar on its planes of symmetry, or on other supports, reduced to four modes."""
    mesh = block(kind, keys.pop("cells", (6, 1, 1)), (LENGTH, WIDTH, HEIGHT), groups=GROUPS)
    return read(mesh, *(supports or PLANES), **keys).reduced(modes=4, damping_ratio=0.02)


@pytest.mark.parametrize("kind", ["hexahedron20", "hexahedron", "wedge15", "tetra10", "tetra"])
def test_what_is_free_grows_without_stress_or_reactions_and_keeps_its_frequencies(kind: str) -> None:
    heated, cold = bar(kind=kind, cells=(4, 2, 2)), bar(kind=kind, cells=(4, 2, 2), rise=None)
    rest = gb.static(heated.structure)
    scale = MODULUS * EXPANSION * RISE
    assert rest.displacement[-1] == pytest.approx(EXPANSION * RISE * np.array([LENGTH, WIDTH, HEIGHT]), rel=1e-6)
    stress = heated.stress(rest)
    assert stress.node_von_mises.max() < 1e-6 * scale and np.abs(stress.point_stress).max() < 1e-6 * scale
    assert np.abs(rest.loads.support_force).max() < 1e-9 * scale * WIDTH * HEIGHT
    lowest = (gb.modes(each.structure).frequency[:4] for each in (heated, cold))
    np.testing.assert_allclose(*lowest, rtol=1e-9)


def test_a_material_with_directions_grows_by_its_own_in_each() -> None:
    """Turned in the mesh; three points hold it as a tripod does, so that it turns. Stress is of second order then."""
    axes, expansions, slight = ((1.0, 2.0, 0.5), (-2.0, 1.0, 0.0)), (4e-6, 16e-6, 55e-6), 1e-2
    moduli, ratios, shear = (22e9, 18e9, 9e9), (0.15, 0.3, 0.28), (5e9, 3e9, 2.5e9)
    board = gb.Orthotropic(1900.0, moduli, ratios, shear, axes, expansions)
    corners = np.array([(0, 0, 0), (LENGTH, 0, 0), (0, WIDTH, 0)]) - (0, WIDTH / 2, HEIGHT / 2)
    mesh = block("hexahedron20", (4, 2, 2), (LENGTH, WIDTH, HEIGHT))
    for name, at in zip("abc", corners, strict=True):
        mesh.point_sets[name] = np.flatnonzero((np.abs(mesh.points - at) < 1e-9).all(axis=1))
    legs = [gb.Support("a", ["x", "y", "z"]), gb.Support("b", ["y", "z"]), gb.Support("c", ["z"])]
    model = read(mesh, *legs, metal=board, rise=slight).reduced(modes=2, damping_ratio=0.0)
    rest = gb.static(model.structure)
    strained = 55e-6 * slight
    assert model.stress(rest).node_von_mises.max() < strained * (22e9 * strained)
    first, second = (np.array(axis) / np.linalg.norm(axis) for axis in axes)
    columns = np.stack([first, second, np.cross(first, second)], axis=1)
    strain = columns * expansions @ columns.T
    diagonal = model.mesh.points[model.mesh.stations["tip"]] - corners[0]
    longer = diagonal @ rest.displacement[-1] / (diagonal @ diagonal)
    assert longer == pytest.approx(slight * diagonal @ strain @ diagonal / (diagonal @ diagonal), rel=1e-5)


def test_two_ends_that_are_held_are_pushed_by_what_the_expansion_would_be() -> None:
    """σ = −E α ΔT, R = E A α ΔT, and across it grows by (1 + ν) α ΔT."""
    model = bar(*PLANES, gb.Support("end", ["x"]))
    rest = gb.static(model.structure)
    scale = EA * EXPANSION * RISE
    ends = [[scale, 0, 0], [0, 0, 0], [0, 0, 0], [-scale, 0, 0]]
    assert rest.loads.support_force[0] == pytest.approx(np.array(ends), rel=1e-9, abs=1e-9 * scale)
    stress = model.stress(rest)
    assert stress.node_von_mises == pytest.approx(np.full_like(stress.node_von_mises, scale / (WIDTH * HEIGHT)))
    assert stress.point_stress[0, -1] == pytest.approx([-scale / (WIDTH * HEIGHT), *[0] * 5], abs=1e-6 * scale)
    strain = stress.point_strain[0, -1]  # that of the stress, which a gauge matched to the material reads
    assert strain[:3] == pytest.approx(EXPANSION * RISE * np.array([-1, 0.33, 0.33]))
    moved = EXPANSION * RISE * 1.33 * np.array([0, WIDTH, HEIGHT])
    assert rest.displacement[-1] == pytest.approx(moved, abs=1e-15)


def test_supports_and_root_of_what_is_clamped_balance_and_springs_share() -> None:
    """A clamp, and a spring k at the end: R = E A α ΔT k/(k + EA/L)."""
    stiffness = 3e7
    model = bar(gb.Support("end", stiffness={"x": stiffness}), metal=STRAIGHT, clamp="wall", kind="hexahedron27")
    loads = gb.static(model.structure).loads
    push = EA * EXPANSION * RISE * stiffness / (stiffness + EA / LENGTH)
    assert loads.support_force[0, 0, 0] == pytest.approx(-push, rel=1e-2)  # at the clamp it cannot grow across
    assert loads.root_force[0] + loads.support_force[0, 0] == pytest.approx(np.zeros(3), abs=1e-9 * push)
    model = bar(gb.Support("end", ["x", "y", "z"]), clamp="wall")
    loads = gb.static(model.structure).loads
    assert loads.root_force[0] + loads.support_force[0, 0] == pytest.approx(np.zeros(3), abs=1e-9 * push)


def test_two_metals_bend_as_timoshenko_says() -> None:
    """Two layers of the thicknesses a and h − a, one three times as stiff; a plane of symmetry holds the strip."""
    a, h, stiff = 0.4 * HEIGHT, HEIGHT, 3.0
    mesh = block("hexahedron20", (24, 1, 10), (LENGTH, WIDTH, HEIGHT), groups=GROUPS)
    cells = mesh.cells[0]
    upper = mesh.points[cells.data].mean(axis=1)[:, 2] > HEIGHT / 2 - a
    parts = {"upper": [np.flatnonzero(upper)], "lower": [np.flatnonzero(~upper)]}
    groups = mesh.point_sets | {"edge": np.flatnonzero((mesh.points[:, 0] == 0) & (mesh.points[:, 2] == -HEIGHT / 2))}
    mesh = meshio.Mesh(mesh.points, mesh.cells, point_sets=groups, cell_sets=parts)
    metals = {
        "upper": gb.Material(2700.0, stiff * MODULUS, poissons_ratio=0.0, expansion=12e-6),
        "lower": STRAIGHT,
    }
    held = [gb.Support("wall", ["x"]), gb.Support("beside", ["y"]), gb.Support("edge", ["z"])]
    rest = gb.static(read(mesh, *held, metal=metals).reduced(modes=2, damping_ratio=0.0).structure)
    m, n = a / (h - a), stiff
    shared = 3 * (1 + m) ** 2 + (1 + m * n) * (m**2 + 1 / (m * n))
    curvature = 6 * (EXPANSION - 12e-6) * RISE * (1 + m) ** 2 / (h * shared)
    assert rest.displacement[-1, 2] == pytest.approx(curvature * LENGTH**2 / 2, rel=2e-2)


def strip(rise: Any, count: int = 24, **keys: Any) -> Any:
    """A thin strip of solid elements between two clamps."""
    mesh = block("hexahedron27", (count, 1, 1), (LENGTH, WIDTH, 0.002), groups={"end": lambda x: x[:, 0] == LENGTH})
    clamp = gb.Support("end", ["x", "y", "z"])
    return read(mesh, clamp, metal=STRAIGHT, rise=rise, clamp="wall").reduced(modes=6, damping_ratio=0.02, **keys)


BUCKLES = 4 * np.pi**2 * 0.002**2 / 12 / LENGTH**2 / EXPANSION  # K, where α ΔT EA = 4 π² EI/L²


def test_it_buckles_between_clamps_at_the_temperature_of_the_closed_form_and_says_its_error() -> None:
    critical = gb.critical_load(strip(1.0, coarser=strip(1.0, 12)).structure)
    assert critical.value == pytest.approx(BUCKLES, rel=5e-3)
    assert critical.errors is not None
    assert abs(critical.value / BUCKLES - 1) < 3 * critical.errors.total


@pytest.mark.parametrize("share", [-1.0, 0.0, 0.5, 0.9])
def test_its_frequency_falls_as_that_of_the_exact_beam(share: float) -> None:
    """Heated towards buckling, and cooled."""
    rise = share * BUCKLES
    section, clamp = gb.Section.rectangle(WIDTH, 0.002), gb.Support(LENGTH, ["x", "z", "ry"])
    beam = gb.Beam(LENGTH, section, STRAIGHT, supports=[clamp], temperature=warm(rise))
    theirs = gb.modes(gb.assemble(beam, "exact", axial=1, z=5)).frequency[0]
    assert gb.modes(strip(rise).structure).frequency[0] == pytest.approx(theirs, rel=5e-3 / (1 - share))


def test_a_history_heats_in_a_run_and_stress_and_reactions_follow() -> None:
    """Slowly: quasi-static closed forms at each time, and of a static answer at one."""
    profile = gb.tabulated([0.0, 0.5, 1.0], [COLD, COLD + RISE, COLD + RISE])
    temperature = gb.Temperature(profile, reference=COLD)
    model = bar(*PLANES, gb.Support("end", ["x"]), temperature=temperature)
    run = gb.simulate(model.structure, gb.Flight(z=0.0), duration=1.0, step=5e-3)
    share = np.interp(run.time, [0.0, 0.5], [0.0, 1.0])
    scale = EXPANSION * RISE
    assert -run.loads.support_force[:, 3, 0] / (EA * scale) == pytest.approx(share, abs=2e-3)
    stress = model.stress(run)
    assert stress.point_stress[:, -1, 0] / (MODULUS * scale) == pytest.approx(-share, abs=2e-3)
    assert run.body.solid.von_mises / (MODULUS * scale) == pytest.approx(share, abs=2e-3)
    rest = gb.static(model.structure, time=0.25)
    assert rest.loads.support_force[0, 3, 0] == pytest.approx(-0.5 * EA * scale, rel=1e-9)
    assert model.stress(rest).worst.von_mises == pytest.approx(0.5 * MODULUS * scale, rel=1e-9)


def test_a_linear_model_has_the_temperature_as_an_input_and_gauges_read_the_stress() -> None:
    """Free, it grows and gauges read nothing; held, they read −α."""
    for supports, moved, read_off in (
        (PLANES, EXPANSION * LENGTH, 0.0),
        ([*PLANES, gb.Support("end", ["x"])], 0, -EXPANSION),
    ):
        linear = gb.linearize(bar(*supports).structure, gb.Flight(z=0.0), gauges=[gb.Gauge("tip")])
        gain = linear.d - linear.c @ np.linalg.solve(linear.a, linear.b)
        names = [signal.name for signal in linear.outputs]
        assert (linear.inputs[-1].name, linear.inputs[-1].unit) == ("temperature", "K")
        assert gain[names.index("tip_x"), -1] == pytest.approx(moved, rel=1e-6, abs=1e-12)
        assert gain[names.index("strain_1"), -1] == pytest.approx(read_off, rel=1e-6, abs=1e-6 * EXPANSION)


def pipe(thick: float, radius: float, count: int, supports: Any, **keys: Any) -> Any:
    """Half of a ring of shells in the plane of x and z, its ends in planes of symmetry, ten times as long as wide."""
    angle, y = np.linspace(0, np.pi, 2 * count + 1), np.array([0.0, 0.5, 1.0]) * WIDTH
    grid = np.array([(radius * np.sin(t), j, radius * np.cos(t)) for t in angle for j in y])
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    nodes = np.stack([6 * np.arange(count) + 3 * i + j for i, j in corners], axis=1)
    sets = {"top": np.arange(3), "bottom": len(grid) - 3 + np.arange(3), "beside": np.arange(0, len(grid), 3)}
    sets["edge"] = sets["bottom"][:1]
    mesh = meshio.Mesh(grid, [("quad8", nodes)], point_sets=sets)
    return read(mesh, *supports, thickness=thick, **keys).reduced(modes=4, damping_ratio=0.02)


def test_a_ring_of_shells_grows_without_stress_with_its_thickness_too() -> None:
    """Where it is as thick as a fifth of its radius, the faces' own lengths need the thickness to grow."""
    turning = ["x", "ry", "rz"]
    held = [gb.Support("top", turning), gb.Support("bottom", turning), gb.Support("edge", ["z"])]
    held.append(gb.Support("beside", ["y"]))
    model = pipe(0.01, 0.05, 8, held)
    rest = gb.static(model.structure)
    assert model.stress(rest).node_von_mises.max() < 1e-8 * MODULUS * EXPANSION * RISE
    middle = model.mesh.points[model.mesh.stations["tip"], 2] * 0.05 / 0.055  # faces move as the middle does
    assert rest.displacement[-1, 2] == pytest.approx((middle + 0.05) * EXPANSION * RISE, rel=1e-3)
    free = gb.modes(pipe(0.01, 0.05, 8, held, rise=None).structure).frequency[:3]
    np.testing.assert_allclose(gb.modes(model.structure).frequency[:3], free, rtol=1e-9)


def test_a_strip_of_shells_between_clamps_has_the_reactions_and_the_buckling_of_the_closed_form() -> None:
    thick, count = 0.002, 12
    x, y = np.linspace(0, LENGTH, 2 * count + 1), np.array([-1, 0, 1]) * WIDTH / 2
    grid = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), 3))], axis=-1).reshape(-1, 3)
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    nodes = np.stack([6 * np.arange(count) + 3 * i + j for i, j in corners], axis=1)
    sets = {"wall": np.arange(3), "end": len(grid) - 3 + np.arange(3)}
    mesh = meshio.Mesh(grid, [("quad8", nodes)], point_sets=sets)
    fixed = gb.Support("end", ["x", "y", "z", "rx", "ry"])
    model = read(mesh, fixed, metal=STRAIGHT, rise=1.0, clamp="wall", thickness=thick).reduced(
        modes=4, damping_ratio=0.0
    )
    push = gb.static(model.structure).loads.support_force[0, 0, 0]
    assert push == pytest.approx(-MODULUS * WIDTH * thick * EXPANSION, rel=1e-3)
    assert gb.critical_load(model.structure).value == pytest.approx(BUCKLES, rel=1e-2)


def test_a_heated_mesh_in_a_system_has_the_same_answers_as_alone() -> None:
    """On a joint, beside a body that hangs on it."""
    model = bar(gb.Support("end", ["x", "z"]), clamp="wall", interfaces={"seat": "beside"})
    joints = {"wall": gb.Joint("fixed", "bar"), "weld": gb.Joint("fixed", "box", on="bar.seat")}
    box = gb.RigidBody(1e-9, (1e-15, 1e-15, 1e-15))
    rest = gb.static(gb.System({"bar": model.structure, "box": box}, joints))
    alone = gb.static(model.structure)
    ours, theirs = rest.bodies["bar"], alone.body
    assert ours.loads.support_force == pytest.approx(theirs.loads.support_force, rel=1e-6)
    assert ours.solid.node_von_mises == pytest.approx(theirs.solid.node_von_mises, rel=1e-6)


SCENARIO = """
[bodies.bar]
mesh = "bar.msh"
unit = "m"
clamp = "wall"
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.33, expansion = "23e-6 1/K" }
supports = [ { at = "end", holds = ["x", "z"] } ]
temperature = { value = "60 degC", reference = "20 °C" }
modes = 4
damping_ratio = "2 %"
"""


def scenario(folder: Path, *changes: tuple[str, str]) -> Path:
    mesh = block("hexahedron20", (6, 1, 1), (LENGTH, WIDTH, HEIGHT), groups=GROUPS)
    sets = {name: list(nodes) for name, nodes in mesh.point_sets.items()}
    cells = [("hexahedron20", mesh.cells[0].data)]
    used = np.unique(mesh.cells[0].data)
    numbers = np.full(len(mesh.points), -1)
    numbers[used] = np.arange(len(used))
    cells = [("hexahedron20", numbers[mesh.cells[0].data])]
    sets = {name: numbers[nodes][numbers[nodes] >= 0] for name, nodes in mesh.point_sets.items()}
    meshio.Mesh(mesh.points[used], cells, point_sets=sets).write(folder / "bar.inp")
    text = SCENARIO.replace("bar.msh", "bar.inp")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "warm.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_scenario_says_temperatures_as_people_do_and_varies_them(tmp_path: Path) -> None:
    path = scenario(tmp_path)
    ours = gb.static(gb.read_scenario(path).system)
    same = gb.static(bar(gb.Support("end", ["x", "z"]), clamp="wall").structure)
    assert ours.bodies["bar"].loads.support_force == pytest.approx(same.loads.support_force, rel=1e-9)


@pytest.mark.parametrize(("old", "new", "problem"), [
    (', expansion = "23e-6 1/K"', "", "bodies.bar.material.expansion: is missing, and the body has a temperature"),
    ('"60 degC"', '"-300 degC"', "temperature.value"),
    ('"60 degC"', '"60 deg"', "temperature.value"),
])  # fmt: skip
def test_what_cannot_be_heated_is_refused(tmp_path: Path, old: str, new: str, problem: str) -> None:
    with pytest.raises(gb.InputError) as refusal:
        _ = gb.read_scenario(scenario(tmp_path, (old, new))).system
    assert problem in str(refusal.value)


def test_a_coarser_mesh_without_the_temperature_is_refused() -> None:
    coarse = bar(cells=(3, 1, 1), rise=None)
    mesh = block("hexahedron20", (6, 1, 1), (LENGTH, WIDTH, HEIGHT), groups=GROUPS)
    with pytest.raises(gb.InputError, match="has no temperature, and the mesh one; give it the same"):
        read(mesh, *PLANES).reduced(modes=4, damping_ratio=0.0, coarser=coarse)
    board = gb.Orthotropic(1900.0, (22e9,) * 3, (0.15,) * 3, (5e9,) * 3)
    with pytest.raises(gb.InputError, match=r"materials.expansions is missing, and the body has a temperature"):
        read(mesh, *PLANES, metal=board)
    assert replace(board, expansions=(1e-6, 2e-6, 3e-6)).thermal_strain == pytest.approx(np.diag([1e-6, 2e-6, 3e-6]))


def test_a_frame_that_turns_where_it_is_heated_keeps_its_reaction_in_proportion() -> None:
    """A knee between two feet: what expansion alone strains presses on no foot, however far the knee turns."""
    pushes = []
    for rise in (1e-3, 50.0):
        keys: dict[str, Any] = dict(rise=rise, clamp="left")
        mesh = block("hexahedron20", (6, 1, 6), (0.12, WIDTH, 0.12))
        nodes, middle = mesh.cells[0].data, mesh.points[mesh.cells[0].data].mean(axis=1)
        knee = nodes[(middle[:, 0] < 0.02) | (middle[:, 2] > 0.04)]
        sets = {"left": np.flatnonzero(mesh.points[:, 2] == -0.06), "right": np.flatnonzero(mesh.points[:, 0] == 0.12)}
        used = np.isin(np.arange(len(mesh.points)), knee)
        sets = {name: points[used[points]] for name, points in sets.items()}
        bent = meshio.Mesh(mesh.points, [("hexahedron20", knee)], point_sets=sets)
        model = read(bent, gb.Support("right", ["x", "y", "z"]), **keys).reduced(modes=4, damping_ratio=0.0)
        pushes.append(gb.static(model.structure).loads.support_force[0, 0] / rise)
    assert pushes[1] == pytest.approx(pushes[0], rel=5e-3, abs=1e-6 * np.abs(pushes[0]).max())


def test_the_board_of_the_example_presses_on_its_lock_as_two_springs_say() -> None:
    """α ΔT b / (1/k + b/EA): its stiffness across and that of the wedge lock."""
    scenario = gb.read_scenario("examples/board_warms_up.toml")
    rest = gb.static(scenario.system, time=15.0)
    across, lock = 19e9 * 0.16 * 0.0016 / 0.1, 2e6
    push = 17e-6 * 35.0 * 0.1 / (1 / lock + 1 / across)
    assert rest.bodies["board"].loads.support_force[0, 2, 1] == pytest.approx(-push, rel=5e-3)
