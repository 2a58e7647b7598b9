"""Solids that supports hold: against all unknowns at once, closed forms, beams, and what cannot be held."""

from __future__ import annotations

from typing import Any

import meshio
import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import eigh

import gbeam as gb
from gbeam.solids import mass_matrix, stiffness_matrix

from .bodies import STEEL, STIFF, block

pytestmark = pytest.mark.usefixtures("reading_in_process")

LENGTH, WIDTH, HEIGHT = 0.3, 0.02, 0.01
GROUPS = {
    "end": lambda x: x[:, 0] == LENGTH,
    "foot": lambda x: (x[:, 2] == -HEIGHT / 2) & (x[:, 0] > 0.5 * LENGTH),
    "below": lambda x: x[:, 2] == -HEIGHT / 2,
    "beside": lambda x: x[:, 1] == -WIDTH / 2,
    "corner": lambda x: (x[:, 0] == LENGTH) & (x[:, 1] == WIDTH / 2) & (x[:, 2] == HEIGHT / 2),
}
AREA = WIDTH * HEIGHT


def solid(*supports: gb.Support, cells: tuple[int, int, int] = (6, 1, 1), metal: Any = STIFF, **keys: Any) -> Any:
    kind, size = keys.pop("element", "hexahedron20"), keys.pop("size", (LENGTH, WIDTH, HEIGHT))
    mesh = block(kind, cells, size, groups=keys.pop("groups", GROUPS))
    keys = {"clamp": "wall", "unit": "m"} | keys
    return gb.SolidMesh.read(mesh, materials=metal, supports=supports, **keys)


def model(*supports: gb.Support, modes: int = 6, damping_ratio: float = 0.0, **keys: Any) -> gb.Structure:
    return solid(*supports, **keys).reduced(modes=modes, damping_ratio=damping_ratio).structure


def static(structure: gb.Structure, *acceleration: float) -> Any:
    return gb.static(structure, acceleration=acceleration).loads


def test_it_is_held_as_all_unknowns_at_once_are() -> None:
    """A face held along two axes, a foot that slides on springs, and a point: modes, displacements and reactions."""
    rng = np.random.default_rng(3)
    supports = [
        gb.Support("end", ["x", "y"]),
        gb.Support("foot", ["z"], stiffness={"x": 1e6, "y": 3e5}),
        gb.Support("corner", ["z"]),
    ]
    mesh = solid(*supports, metal=STEEL)
    structure = mesh.reduced(modes=4, damping_ratio=0.0).structure
    k = stiffness_matrix(mesh.points, mesh.blocks).toarray()
    m = sparse.kron(mass_matrix(mesh.points, mesh.blocks), np.eye(3)).toarray()
    held, drawn = np.repeat(mesh.clamped, 3), np.zeros(len(k))
    rows = []
    for place in mesh.supports:
        rows.append({way: 3 * place.points + "xyz".index(way) for way in "xyz"})
        held[np.concatenate([rows[-1][way] for way in place.support.rigid])] = True
        for way, stiffness in place.support.stiffness.items():
            drawn[rows[-1][way]] += stiffness / len(place.points)
    k += np.diag(drawn)
    free = ~held
    squares = eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], eigvals_only=True, subset_by_index=[0, 3])
    np.testing.assert_allclose(gb.modes(structure).frequency[:4], np.sqrt(squares) / (2 * np.pi), rtol=1e-6)
    acceleration = 1e-3 * rng.standard_normal(3)
    inertia = m @ np.tile(acceleration, len(mesh.points))
    moved = np.zeros(len(k))
    moved[free] = -np.linalg.solve(k[np.ix_(free, free)], inertia[free])
    needed = k @ moved + inertia
    loads = static(structure, *acceleration)
    assert loads.support_names == ("end", "foot", "corner")
    for i, (place, row) in enumerate(zip(mesh.supports, rows, strict=True)):
        forces = np.zeros((len(place.points), 3))
        for way in place.support.rigid:
            forces[:, "xyz".index(way)] = needed[row[way]]
        for way, stiffness in place.support.stiffness.items():
            forces[:, "xyz".index(way)] = -stiffness / len(place.points) * moved[row[way]]
        moment = np.cross(mesh.points[place.points] - place.centre, forces).sum(axis=0)
        size = 1e-6 * np.abs(needed).sum()
        np.testing.assert_allclose(loads.support_force[0, i], forces.sum(axis=0), rtol=1e-5, atol=size)
        np.testing.assert_allclose(loads.support_moment[0, i], moment, rtol=1e-5, atol=1e-2 * size)
    root = needed.reshape(-1, 3)[mesh.clamped].sum(axis=0)
    np.testing.assert_allclose(loads.root_force[0], root, rtol=1e-5)


def test_three_planes_of_symmetry_hold_a_bar_without_a_clamp() -> None:
    """u = ρ a (L x − x²/2)/E along the bar, and (2 k − 1) π/2 √(E/ρ)/L; the planes' edges do not hide its stress."""
    planes = [gb.Support("wall", ["x"]), gb.Support("below", ["z"]), gb.Support("beside", ["y"])]
    bar = model(*planes, clamp=(), modes=3)
    first = np.sqrt(STIFF.youngs_modulus / STIFF.density) / (4 * LENGTH)
    assert gb.modes(bar).frequency[0] == pytest.approx(first, rel=1e-5)
    rest = gb.static(bar, acceleration=(-1e-3, 0.0, 0.0))
    weight = STIFF.density * AREA * LENGTH * 1e-3
    assert rest.displacement[-1, 0] == pytest.approx(weight * LENGTH / (2 * STIFF.youngs_modulus * AREA), rel=1e-6)
    assert rest.loads.support_force[0] == pytest.approx(np.array([[-weight, 0, 0], [0, 0, 0], [0, 0, 0]]), abs=1e-9)
    assert np.abs(rest.loads.root_force).max() < 1e-9 * weight
    coarse = solid(*planes, clamp=(), cells=(2, 1, 1)).reduced(modes=1, damping_ratio=0.0)
    fine = solid(*planes, clamp=(), cells=(6, 1, 1)).reduced(modes=1, damping_ratio=0.0, coarser=coarse)
    worst = fine.stress(gb.static(fine.structure, acceleration=(-1.0, 0.0, 0.0))).worst
    assert worst.place[0] == 0.0 and worst.von_mises == pytest.approx(STIFF.density * LENGTH, rel=1e-3)


# By the mean motion of the ends' faces, which leaves them free to warp, as a beam's sections are.
@pytest.mark.parametrize(
    ("end", "root"),
    [(["z"], 3.92660231), (["z", "ry"], 4.73004074), (["ry"], 2.36502037), ([], 1.87510407)],
    ids=["pinned", "clamped", "guided", "free"],
)
def test_a_slender_bar_has_a_beams_frequencies(end: list[Any], root: float) -> None:
    size = (LENGTH, WIDTH, 0.004)
    groups = {"end": lambda x: x[:, 0] == LENGTH}
    supports = [gb.Support("seat", end)] if end else []
    keys: dict[str, Any] = dict(size=size, groups=groups, cells=(16, 1, 1), element="hexahedron27")
    bar = model(*supports, interfaces={"seat": "end"}, **keys)
    across = gb.modes(bar)
    beta = root / LENGTH
    theirs = beta**2 * np.sqrt(STIFF.youngs_modulus * 0.004**2 / 12 / STIFF.density) / (2 * np.pi)
    assert np.abs(across.frequency / theirs - 1).min() < 6e-3  # a third of the thickness over the length


def test_a_pulse_is_balanced_by_root_and_supports_and_told_with_its_error() -> None:
    """Force and moment of root and supports are those that the same solid's inertia demands; those of a
    model of few modes lie within the stated error of those of a rich one.
    """
    supports = [gb.Support("seat", ["z"]), gb.Support("corner", stiffness={"y": 2e6}, damping={"y": 40.0})]
    keys: dict[str, Any] = dict(interfaces={"seat": "end"}, points={"corner": "corner"})
    pulse = gb.Flight(z=gb.Sine(800.0, duration=0.004), y=gb.Sine(500.0, duration=0.004))
    few, many = (
        gb.simulate(model(*supports, modes=count, damping_ratio=0.02, **keys), pulse, duration=0.006, step=2e-5)
        for count in (1, 12)
    )
    loads = many.body.loads
    whole = loads.root_force + loads.support_force.sum(axis=1)
    np.testing.assert_allclose(whole, -many.ground_force, atol=1e-9 * np.abs(whole).max())
    order = [many.body.points.index(name) for name in ("seat", "corner")]
    x = np.array([[LENGTH, 0, 0], [LENGTH, WIDTH / 2, HEIGHT / 2]]) + many.body.displacement[:, order]
    moment = loads.root_moment + (loads.support_moment + np.cross(x, loads.support_force)).sum(axis=1)
    # The places of supports move to first order, that of the interface to second.
    np.testing.assert_allclose(moment, -many.ground_moment, atol=1e-5 * np.abs(moment).max())
    largest = max(np.abs(loads.support_force).max(), np.abs(loads.root_force).max())
    apart = np.abs(few.body.loads.support_force - loads.support_force).max() / largest
    assert apart / 5 < few.errors.loads.total and apart < 3 * few.errors.loads.total
    assert few.errors.loads.total < 0.2


def test_what_hangs_on_a_held_interface_is_carried_by_its_support() -> None:
    """A body on the end of a bar that a support holds along z: the whole of its weight beyond the bar's share."""
    held = solid(gb.Support("seat", ["z"]), interfaces={"seat": "end"}).reduced(modes=4, damping_ratio=0.0).structure
    box = gb.RigidBody(2.0, (1e-3, 1e-3, 1e-3))
    joints = {"wall": gb.Joint("fixed", "bar"), "weld": gb.Joint("fixed", "box", on="bar.seat")}
    rest = gb.static(gb.System({"bar": held, "box": box}, joints, gravity=(0, 0, -9.81)))
    alone = static(held, 0.0, 0.0, 9.81)
    loads = rest.bodies["bar"].loads
    assert loads.support_force[0, 0, 2] == pytest.approx(2.0 * 9.81 + alone.support_force[0, 0, 2], rel=1e-3)
    assert (loads.root_force + loads.support_force[:, 0])[0, 2] == pytest.approx(9.81 * (2 + 2700 * AREA * LENGTH))


def test_a_plant_has_the_roots_moment_beside_its_supports() -> None:
    """The gain at rest of the base's acceleration on the moment of the root alone is the static one."""
    held = model(gb.Support("end", ["z"]), gb.Support("foot", stiffness={"y": 2e6}), damping_ratio=0.02)
    plant = gb.linearize(held, gb.Flight(z=gb.constant(1.0)))
    gain = plant.d - plant.c @ np.linalg.solve(plant.a, plant.b)
    names = [each.name for each in plant.outputs], [each.name for each in plant.inputs]
    for axis, turned in (("z", 1), ("y", 2)):
        acceleration = np.where(np.array(list("xyz")) == axis, 1e-2, 0.0)
        moment = static(held, *acceleration).root_moment[0, turned] / 1e-2
        row, column = names[0].index(f"root_moment_{'xyz'[turned]}"), names[1].index(f"base_acceleration_{axis}")
        assert gain[row, column] == pytest.approx(moment, rel=1e-4)


def test_a_strip_that_is_held_at_both_ends_pulls_on_them_as_a_beam_does() -> None:
    """The tension of a bend, which the linear deflection has not yet, is a reaction, and the model's error tells what
    it changes in the deflection.
    """
    size, groups = (LENGTH, WIDTH, 0.002), {"end": lambda x: x[:, 0] == LENGTH}
    keys: dict[str, Any] = dict(size=size, groups=groups, cells=(16, 1, 1), element="hexahedron27")
    strip = model(gb.Support("end", ["x", "y", "z"]), points={"middle": (LENGTH / 2, 0, 0)}, **keys)
    clamp = gb.Support(LENGTH, ["x", "z", "ry"])
    section = gb.Section.rectangle(WIDTH, 0.002)
    middle = [gb.Point("middle", LENGTH / 2)]
    whole = gb.Beam(LENGTH, section, STIFF, damping_ratio=0.0, supports=[clamp], points=middle)
    beam = gb.assemble(whole, "exact", axial=2, z=6)
    small, large = (static(each, 0.0, 0.0, 10.0).support_force[0, 0] for each in (strip, beam))
    assert small[[0, 2]] == pytest.approx(large[[0, 2]], rel=0.03)
    bent, true = (gb.static(each, acceleration=(0.0, 0.0, 300.0)) for each in (strip, beam))
    forces = [each.loads.support_force[0, 0, 0] for each in (bent, true)]
    assert bent.errors is not None
    assert abs(forces[0] / forces[1] - 1) < 3 * bent.errors.loads.total and bent.errors.loads.total > 0.05
    (warning,) = (each for each in bent.warnings if "its supports stretch it" in each)
    stiffer = float(warning.partition("order of ")[2].partition(" %")[0]) / 100
    linear = STIFF.density * 300.0 * LENGTH**4 / (32 * STIFF.youngs_modulus * 0.002**2)
    assert stiffer == pytest.approx(linear / abs(true.at("beam.middle")[2]) - 1, rel=0.15)
    assert "stated as error of the model" in warning


def test_shells_that_are_held_at_both_ends_say_that_they_stretch() -> None:
    """Their bend of higher order is not computed: the tension is that of the exact beam, and the rest not known."""
    thick, count = 0.002, 12
    x, y = np.linspace(0, LENGTH, 2 * count + 1), np.array([-1, 0, 1]) * WIDTH / 2
    grid = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), 3))], axis=-1).reshape(-1, 3)
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    nodes = np.stack([6 * np.arange(count) + 3 * i + j for i, j in corners], axis=1)
    last = len(grid) - 3
    sets = {"wall": np.arange(3), "end": last + np.arange(3)}
    mesh = meshio.Mesh(grid, [("quad8", nodes)], point_sets=sets)
    keys: dict[str, Any] = dict(materials=STIFF, clamp="wall", unit="m", thickness=thick)
    fixed = gb.Support("end", ["x", "y", "z", "rx", "ry"])
    strip = gb.SolidMesh.read(mesh, supports=[fixed], **keys).reduced(modes=6, damping_ratio=0.01).structure
    small = static(strip, 0.0, 0.0, 10.0)
    deflection, weight = STIFF.density * 10.0 * LENGTH**4 / (32 * STIFF.youngs_modulus * thick**2), STIFF.density * 10.0
    # w = 16 d x²(L − x)²/L⁴ with d in the middle: T = EA/2L ∫ w'² = EA (d/L)² 256/105.
    tension = STIFF.youngs_modulus * WIDTH * thick * (deflection / LENGTH) ** 2 * 256 / 105
    half = weight * WIDTH * thick * LENGTH / 2
    assert small.support_force[0, 0] == pytest.approx([tension, 0, half], rel=5e-3, abs=1e-6)
    far = gb.static(strip, acceleration=(0.0, 0.0, 300.0))
    assert any("its supports stretch it" in each and each.endswith("not known") for each in far.warnings)
    with pytest.raises(gb.InputError, match=r"supports\[0\] holds rz at end, where nothing moves so; leave rz out"):
        gb.SolidMesh.read(mesh, supports=[gb.Support("end", ["rz"])], **keys).reduced(modes=1, damping_ratio=0.0)


def test_an_edge_of_shells_is_hinged_or_clamped_by_what_is_held() -> None:
    """A square plate: k = 19.74 hinged, 35.99 clamped, of k/a² √(D/ρ h)/2π."""
    side, thick, count = 0.2, 0.002, 8
    x = np.linspace(0, side, 2 * count + 1)
    grid = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((len(x), len(x)))], axis=-1).reshape(-1, 3)
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    first = np.stack(np.meshgrid(np.arange(count) * 2, np.arange(count) * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    nodes = np.stack([(first + each) @ (len(x), 1) for each in corners], axis=1)
    edges = np.flatnonzero((np.isclose(grid[:, :2], 0) | np.isclose(grid[:, :2], side)).any(axis=1))
    mesh = meshio.Mesh(grid, [("quad8", nodes)], point_sets={"edges": edges, "corner": np.array([0])})
    rigidity = STEEL.youngs_modulus * thick**3 / 12 / (1 - 0.3**2)
    unit = np.sqrt(rigidity / (STEEL.density * thick)) / (2 * np.pi * side**2)
    hinge, clamp = ["x", "y", "z"], ["x", "y", "z", "rx", "ry"]
    for holds, factor in ((hinge, 2 * np.pi**2), (clamp, 35.99)):
        plate = gb.SolidMesh.read(
            mesh, materials=STEEL, unit="m", thickness=thick, supports=[gb.Support("edges", holds)]
        ).reduced(modes=2, damping_ratio=0.0)
        assert plate.frequency[0] == pytest.approx(factor * unit, rel=1e-2)
        load = static(plate.structure, 0.0, 0.0, 2.0)
        assert load.support_force[0, 0, 2] == pytest.approx(2.0 * STEEL.density * thick * side**2)


def test_springs_and_dampers_carry_a_block_as_one_mass() -> None:
    """Stiff against its springs: f = √(k/m)/2π, and the ratio c/2√(k m) of the decay."""
    mass, stiffness, damping = 2700 * AREA * LENGTH, 2000.0, 0.3
    rails = gb.Support("below", ["x", "y"], stiffness={"z": stiffness}, damping={"z": damping})
    block_on_springs = model(rails, clamp=(), modes=2)
    result = gb.modes(block_on_springs)
    assert result.frequency[0] == pytest.approx(np.sqrt(stiffness / mass) / (2 * np.pi), rel=1e-3)
    assert result.damping_ratio[0] == pytest.approx(damping / 2 / np.sqrt(stiffness * mass), rel=1e-3)
    loads = static(block_on_springs, 0.0, 0.0, 1.0)
    assert loads.support_force[0, 0, 2] == pytest.approx(mass)


BAD: list[tuple[list[gb.Support], dict[str, Any], str]] = [
    ([gb.Support("lid", ["z"])], {}, r"supports\[0\]\.at is 'lid', which is no group .*end.*; or a point: seat"),
    (
        [gb.Support(0.3, ["z"])],
        {},
        r"supports\[0\]\.at is 0\.3, and a mesh is held at groups and points; give",
    ),
    ([gb.Support("wall", ["z"])], {}, r"supports\[0\]\.at is 'wall', which the clamp holds already; leave it out"),
    ([gb.Support("end", ["z", "ry"])], {}, r"supports\[0\] holds ry at end, where nodes of solid elements have no rot"),
    (
        [gb.Support("end", ["z"]), gb.Support("corner", ["z"])],
        {},
        r"supports\[1\] holds z at corner, where it is held",
    ),
    (
        [gb.Support("end", ["z"]), gb.Support("seat", ["z"])],
        {},
        r"supports\[1\] holds z at seat, where it is held",
    ),
    (
        [gb.Support("end", ["z"])],
        {"clamp": ()},
        r"supports leave the body free to move along x and along y and",
    ),
    ([gb.Support("below", ["z"], damping={"x": 1.0})], {"clamp": ()}, r"supports leave the body free to move along x"),
    (
        [gb.Support("corner", ["z"])],
        {"links": {"plate": "end"}, "interfaces": {}},
        r"with 1 nodes of the rigid link",
    ),
]


@pytest.mark.parametrize(("supports", "keys", "words"), BAD)
def test_what_supports_cannot_hold_is_refused(supports: list[gb.Support], keys: dict[str, Any], words: str) -> None:
    keys = {"interfaces": {"seat": "end"}} | keys
    with pytest.raises(gb.InputError, match=words):
        model(*supports, **keys)


def test_a_beam_is_held_at_its_points() -> None:
    section, foot = gb.Section.rectangle(WIDTH, HEIGHT), gb.Support("foot", ["z"])
    with pytest.raises(gb.InputError, match=r"supports\[0\]\.at is 'foot'; choose one of tip"):
        gb.Beam(LENGTH, section, STIFF, supports=[foot])
