"""Shells beside closed forms of plates, beams and bodies; what they cannot be is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb
from gbeam.solids import KINDS as ELEMENTS
from gbeam.solids import Linked, chunks, shape_functions, stiffness_matrix
from validation.codes.calculix_specimens import example as board

from .bodies import STEEL, STIFF, block

KINDS = ("quad", "quad8", "triangle", "triangle6")
EDGE = 0.2
SQUARE = 35.985  # Leissa (1969), NASA SP-160, table 4.26: ω a² √(ρh/D) of a square plate clamped all round
Bent = Callable[[np.ndarray], np.ndarray]


def sheet(kind: str, cells: tuple[int, int], size: tuple[float, float], seed: int | None = None) -> meshio.Mesh:
    """Mesh of a rectangle from the origin along x and y, about x where it is a strip; inside at random by a seed."""
    step = 2 if kind in ("quad8", "quad9", "triangle6") else 1
    counts = [step * n + 1 for n in cells]
    corners = np.stack(np.meshgrid(*(np.linspace(0, 1, n + 1) for n in cells), indexing="ij"), axis=-1)
    if seed is not None:
        shape = (*(n - 1 for n in cells), 2)
        corners[1:-1, 1:-1] += np.random.default_rng(seed).uniform(-0.3, 0.3, shape) / cells
    grid = np.zeros((*counts, 2))
    grid[::step, ::step] = corners
    if step == 2:
        grid[1::2, ::2], grid[::2, 1::2] = (corners[1:] + corners[:-1]) / 2, (corners[:, 1:] + corners[:, :-1]) / 2
        grid[1::2, 1::2] = (corners[1:, 1:] + corners[:-1, :-1]) / 2  # of the diagonal by which a cell is two triangles
    square = [(0, 0), (step, 0), (step, step), (0, step)]
    forms: list[Any] = [square] if kind.startswith("quad") else [square[:3], [square[0], *square[2:]]]
    if step == 2:
        forms = [[*e, *(tuple(np.add(a, b) // 2) for a, b in zip(e, e[1:] + e[:1], strict=True))] for e in forms]
    if kind == "quad9":
        forms = [[*forms[0], (1, 1)]]
    first = np.stack(np.meshgrid(*(np.arange(n) * step for n in cells), indexing="ij"), axis=-1).reshape(-1, 2)
    nodes = [np.ravel_multi_index(np.moveaxis(first[:, None] + each, -1, 0), counts) for each in forms]
    places = np.insert(grid.reshape(-1, 2) * size, 2, 0.0, axis=1)
    return meshio.Mesh(places, {kind: np.concatenate(nodes)}, point_sets={"wall": np.flatnonzero(places[:, 0] == 0)})


def read(mesh: Any, thickness: Any, material: Any = STEEL, **more: Any) -> gb.SolidMesh:
    return gb.SolidMesh.read(mesh, materials=material, clamp="wall", unit="m", thickness=thickness, **more)


def strip(kind: str, material: gb.Material = STIFF, **more: Any) -> gb.SolidModel:
    """A cantilever of 0.5 x 0.05 x 0.003 m."""
    mesh = sheet(kind, (16, 2), (0.5, 0.05))
    mesh.points[:, 1] -= 0.025
    return read(mesh, 0.003, material, **more).reduced(modes=8, damping_ratio=0.01)


@pytest.mark.parametrize("thickness", [0.002, 0.0005])
@pytest.mark.parametrize("seed", [None, 1])
@pytest.mark.parametrize(
    ("kind", "most"), [("quad", 0.065), ("quad8", 0.03), ("triangle", 0.075), ("triangle6", 0.025)]
)
def test_a_thin_plate_does_not_lock(kind: str, most: float, seed: int | None, thickness: float) -> None:
    """Eight elements across Kirchhoff's plate that is clamped all round, of h/a = 1/100 and 1/400."""
    mesh = sheet(kind, (8, 8), (EDGE, EDGE), seed)
    rim = (np.abs(mesh.points[:, :2] - EDGE / 2) > EDGE / 2 - 1e-9).any(axis=1)
    mesh.point_sets["wall"] = np.flatnonzero(rim)
    frequency = read(mesh, thickness).reduced(modes=1, damping_ratio=0).frequency[0]
    stiffness = STEEL.youngs_modulus * thickness**3 / 12 / (1 - 0.3**2)
    thin = SQUARE / EDGE**2 * np.sqrt(stiffness / STEEL.density / thickness) / 2 / np.pi
    assert -0.01 < frequency / thin - 1 < most


@pytest.mark.parametrize("kind", KINDS)
def test_constant_strain_and_constant_curvature_are_exact(kind: str) -> None:
    """Distorted elements: no force on the nodes inside (eight nodes follow a curvature to 3e-4 only)."""
    mesh = read(sheet(kind, (3, 3), (1.0, 1.0), 5), 0.02)
    linked = Linked(mesh)
    x, y, z = mesh.points.T
    stiffness = stiffness_matrix(mesh.points, mesh.blocks)
    pulled = np.stack([x + 0.5 * y, 0.3 * x - 0.2 * y, 0 * x], axis=1)
    bent = np.stack([-z * (2 * x + 0.5 * y), -z * (0.5 * x + 1.2 * y), x**2 + 0.5 * x * y + 0.6 * y**2], axis=1)
    within = ((mesh.points[:, :2] > 1e-9) & (mesh.points[:, :2] < 1 - 1e-9)).all(axis=1)
    inside = np.abs(linked.condensed(np.repeat(within, 3)[:, None] * 1.0)).ravel() > 0
    for moved, close in ((pulled, 1e-13), (bent, 5e-4 if kind == "quad8" else 1e-13)):
        force = linked.condensed((stiffness @ moved.ravel())[:, None])[inside]
        assert inside.sum() > 8 and np.abs(force).max() < close * (abs(stiffness) @ np.abs(moved).ravel()).max()
    for part in chunks(mesh.points, mesh.blocks, "stress"):
        stress = part.stress(bent[..., None])[..., 0]
        values = shape_functions(part.block.kind, ELEMENTS[part.block.kind].stress)[2]
        height = np.einsum("qk,ekc->eqc", values, mesh.points[part.nodes])[..., 2]
        modulus = STEEL.youngs_modulus / (1 - 0.3**2)
        if kind != "quad8":
            np.testing.assert_allclose(stress[..., 0], -height * modulus * (2 + 0.3 * 1.2), rtol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_moving_as_a_rigid_body_strains_nothing(kind: str) -> None:
    mesh = sheet(kind, (4, 4), (1.0, 1.0), 3)
    x, y, _ = mesh.points.T
    mesh.points[:] = np.stack([x, y + 0.2 * x**2, 0.3 * np.sin(3 * x) * np.cos(2 * y)], axis=1)
    shell = read(mesh, 0.02)
    stiffness = stiffness_matrix(shell.points, shell.blocks)
    turns = np.stack([np.cross(axis, shell.points) for axis in np.eye(3)], axis=2)
    rigid = np.concatenate([np.tile(np.eye(3), (len(shell.points), 1, 1)), turns], axis=2).reshape(-1, 6)
    assert np.abs(stiffness @ rigid).max() < 1e-14 * (abs(stiffness) @ np.abs(rigid)).max()


@pytest.mark.parametrize("kind", ["quad8", "triangle6"])
def test_a_curved_panel_weighs_what_it_is(kind: str) -> None:
    """Mass, first and second moments of a sector of a tube, with its thickness."""
    mesh = sheet(kind, (16, 2), (1.2, 0.3), None)
    angle, width, _ = mesh.points.T.copy()
    mesh.points[:] = np.stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), width], axis=1)
    mesh.point_sets["wall"] = np.flatnonzero(angle == 0)
    turned = [0.3, -0.2, 0.9]
    structure = read(mesh, 0.04, turn=turned).reduced(modes=2, damping_ratio=0).structure
    inner, outer = 0.48, 0.52
    flat, sweep = STEEL.density * 0.3, 1.2
    mass = flat * sweep * (outer**2 - inner**2) / 2
    first = flat * (outer**3 - inner**3) / 3 * np.array([np.sin(sweep), 1 - np.cos(sweep)])
    across = flat * (outer**4 - inner**4) / 4 / 2
    second = np.diag([across * (sweep + np.sin(2 * sweep) / 2), across * (sweep - np.sin(2 * sweep) / 2), mass * 0.03])
    second[0, 1] = second[1, 0] = across * np.sin(sweep) ** 2
    second[:2, 2] = second[2, :2] = first * 0.15
    from scipy.spatial.transform import Rotation

    axes = Rotation.from_rotvec(turned).as_matrix()
    second, centre = axes @ second @ axes.T, axes @ np.array([*first, mass * 0.15])
    wanted = [mass, *centre, *np.diag(second), second[0, 1], second[1, 2], second[2, 0]]
    np.testing.assert_allclose(structure.coefficients.rigid, wanted, atol=1e-5 * mass)


@pytest.mark.parametrize("kind", KINDS)
def test_a_strip_is_the_beam_that_it_is(kind: str) -> None:
    """Frequencies at rest and spinning beside the exact beam, the tip at rest, and Greenhill's heavy column."""
    model = strip(kind)
    beam = gb.assemble(gb.Beam(0.5, gb.Section.rectangle(0.05, 0.003), STIFF), "exact", z=4, y=2, twist=2)
    for rate in (0.0, 60.0):
        hub = gb.Hub(radius=0.1, rate=rate)
        one, other = (gb.modes(each, hub, errors=False).frequency for each in (model.structure, beam))
        np.testing.assert_allclose(one[:2], other[:2], rtol=8e-3)
        assert one[0] == pytest.approx(other[0], rel=1e-3)
        if kind == "quad8":
            np.testing.assert_allclose(one[:4], other[:4], rtol=0.03)  # the second of bending out of the beam's four
    moved = -STIFF.density * 0.05 * 0.003 * 5 * 0.5**4 / 8 / (STIFF.youngs_modulus * 0.05 * 0.003**3 / 12)
    assert gb.static(model.structure, acceleration=(0, 0, 5.0)).tip[2] == pytest.approx(moved, rel=1e-3)
    weight = STIFF.youngs_modulus * 0.003**2 / 12 / STIFF.density / 0.5**3
    assert gb.buckling_acceleration(model.structure).value == pytest.approx(7.8373 * weight, rel=2e-3)


def test_a_gauge_reads_the_face_on_which_it_is() -> None:
    """Half-way along a strip under its weight, on both faces and in the middle, which is the upper one."""
    points = {"above": (0.25, 0.0, 0.0015), "below": (0.25, 0.0, -0.0015), "middle": (0.25, 0.0, 0.0)}
    model = strip("quad8", points=points)
    stress = model.stress(gb.static(model.structure, acceleration=(0, 0, 5.0)))
    wanted = 6 * STIFF.density * 5 * 0.25**2 / 2 / 0.003
    along = dict(zip(stress.points, stress.point_stress[0, :, 0], strict=True))
    assert along["above"] == pytest.approx(wanted, rel=5e-3) and along["below"] == pytest.approx(-wanted, rel=5e-3)
    assert along["middle"] == along["above"]
    (part,) = chunks(model.mesh.points, model.mesh.blocks, "stress")
    (block,) = model.mesh.blocks
    (one,) = chunks(model.mesh.points, [replace(block, nodes=block.nodes[3:4])], "stress")
    both = one.stress(model.shapes)[0], part.stress(model.shapes)[3]
    np.testing.assert_allclose(*both, atol=1e-10 * np.abs(both).max())
    assert stress.worst.von_mises == pytest.approx(4 * wanted, rel=5e-3) and stress.worst.place[0] == 0


def tube(kind: str, cells: int) -> meshio.Mesh:
    """A square tube of 1 x 0.06 x 0.06 m along x; two of its sides number their nodes the other way round."""
    parts, sides = [], []
    for i in range(4):
        part = sheet(kind, (20, cells), (1.0, 0.06))
        x, y, _ = part.points.T
        s, h = y - 0.03, np.full_like(y, 0.03)
        parts.append(np.stack([x, *((s, -h), (h, s), (-s, h), (-h, -s))[i]], axis=1))
        nodes = part.cells[0].data
        sides.append((nodes if i % 2 else nodes[:, [0, 3, 2, 1, 7, 6, 5, 4]]) + i * len(x))
    places = np.concatenate(parts)
    _, first, number = np.unique(places.round(9), axis=0, return_index=True, return_inverse=True)
    nodes = number.ravel()[np.concatenate(sides)]
    return meshio.Mesh(places[first], {kind: nodes}, point_sets={"wall": np.flatnonzero(places[first][:, 0] == 0)})


def test_a_tube_of_folded_plates_is_the_beam_that_it_is() -> None:
    """Bending and Bredt's torsion of a thin square tube: the plates meet at right angles, and turn together there."""
    model = read(tube("quad8", 2), 0.004, STIFF).reduced(modes=8, damping_ratio=0)
    e, density, side, t = STIFF.youngs_modulus, STIFF.density, 0.06, 0.004
    bending = 1.8751**2 * np.sqrt(e * (2 / 3 * side**3 * t) / (density * 4 * side * t)) / 2 / np.pi
    shear = 1 + (e * 2 / 3 * side**3 * t) * 1.8751**4 / (0.44 * e / 2 * 4 * side * t) * 0.3  # Timoshenko's, about
    assert model.frequency[0] == pytest.approx(bending / np.sqrt(shear), rel=0.02)
    assert model.frequency[1] == pytest.approx(model.frequency[0], rel=1e-6)
    twist = np.sqrt(e / 2 * side**3 * t / (density * 4 * side * t * (side**2 / 12 + side**2 / 4))) / 4
    assert np.abs(model.frequency / twist - 1).min() < 4e-3


def test_solids_and_shells_share_nodes() -> None:
    """A block on the end of a strip, whose lower face is in the strip's middle, beside the rigid body that it is."""
    mesh = sheet("quad", (20, 4), (0.5, 0.1))
    x = mesh.points[:, 0]
    cube = block("hexahedron", (4, 4, 2), (0.1, 0.1, 0.05))
    cube.points += (0.4, 0.05, 0.025)
    lower = np.flatnonzero(np.abs(cube.points[:, 2]) < 1e-12)
    number = np.arange(len(cube.points)) + len(x)
    for i in lower:
        near = np.linalg.norm(mesh.points - cube.points[i], axis=1)
        if near.min() < 1e-9:
            number[i] = near.argmin()
    tags = [np.full(80, 1), np.full(32, 2)]
    cells = [("quad", mesh.cells[0].data), ("hexahedron", number[cube.cells[0].data])]
    places = np.concatenate([mesh.points, cube.points])
    both = meshio.Mesh(
        places,
        cells,
        point_sets={"wall": mesh.point_sets["wall"]},
        cell_data={"gmsh:physical": tags},
        field_data={"strip": np.array([1, 2]), "block": np.array([2, 3])},
    )
    hard = gb.Material(20000, 1e14, poissons_ratio=0.3)
    solid = read(both, {"strip": 0.003}, {"strip": STEEL, "block": hard})
    assert solid.mass == pytest.approx(7850 * 0.5 * 0.1 * 0.003 + 20000 * 0.1 * 0.1 * 0.05)
    mesh.point_sets["seat"] = np.flatnonzero(x > 0.4 - 1e-9)
    mass = 20000 * 0.1 * 0.1 * 0.05
    square, upright = mass * (0.1**2 + 0.05**2) / 12, mass * 0.1**2 / 6
    body = gb.RigidBody(mass, (square, square, upright), centre=(0, 0, 0.025))
    alone = read(mesh, 0.003, links={"seat": "seat"}, carried={"seat": body})
    one, other = (each.reduced(modes=4, damping_ratio=0) for each in (solid, alone))
    np.testing.assert_allclose(one.frequency, other.frequency, rtol=1e-2)  # the edge of the seat turns
    spun = [gb.modes(each.structure, gb.Hub(radius=0.2, rate=2.0)).frequency[:4] ** 2 for each in (one, other)]
    shift = [each - model.frequency**2 for each, model in zip(spun, (one, other), strict=True)]
    np.testing.assert_allclose(shift[0], shift[1], rtol=0.03)


def test_nine_nodes_are_eight() -> None:
    """The middle of a quadrilateral of nine nodes is left out."""
    nine, eight = (read(sheet(kind, (4, 1), (0.5, 0.05)), 0.003) for kind in ("quad9", "quad8"))
    np.testing.assert_array_equal(nine.points, eight.points)
    assert str(nine) == "SolidMesh(23 nodes, 4 quad8, 0.5888 kg, wall holds 3)"


def test_groups_have_their_own_thickness_and_material() -> None:
    mesh = sheet("quad", (4, 1), (0.4, 0.1))
    mesh.cell_sets = {"thin": [np.array([0, 1])], "thick": [np.array([2, 3])]}
    light = gb.Material(1000, 70e9, poissons_ratio=0.3)
    shell = read(mesh, {"thin": "1 mm", "thick": 0.002}, {"thin": light, "thick": STEEL})
    assert shell.mass == pytest.approx(0.2 * 0.1 * (0.001 * 1000 + 0.002 * 7850))
    assert np.ptp(shell.points[shell.points[:, 0] > 0.21][:, 2]) == pytest.approx(0.002)


BOARD = gb.Orthotropic(1900, (22e9, 19e9, 8e9), (0.15, 0.3, 0.3), (4e9, 2.5e9, 2.5e9), ((1, 0, 0), (0, 1, 0)))


def test_a_laminate_is_its_plate() -> None:
    """A strip of it bends by its modulus along it, and is refused where its axes do not lie in it."""
    mesh = sheet("quad8", (16, 2), (0.5, 0.05))
    model = read(mesh, 0.003, BOARD).reduced(modes=1, damping_ratio=0)
    thin = 1.8751**2 / 0.5**2 * np.sqrt(22e9 * 0.003**2 / 12 / 1900) / 2 / np.pi
    assert model.frequency[0] == pytest.approx(thin, rel=3e-3)
    mesh.points[:] = mesh.points[:, [0, 2, 1]]
    with pytest.raises(gb.InputError, match=r"materials\.axes do not lie in 32 elements of shells; give the elements"):
        read(mesh, 0.003, BOARD)


def test_the_board_of_the_examples_is_that_of_hexahedra() -> None:
    """With elements of 10 mm shells are softer, by less than the mesh of hexahedra is too stiff."""
    groups = {"materials": board.LAMINATE, "clamp": "screws", "unit": "mm", "point_masses": board.MASSES}
    shells, solids = (
        gb.SolidMesh.read(mesh, **groups, **more).reduced(modes=4, damping_ratio=0).frequency
        for mesh, more in ((board.mesh(), {"thickness": "1.6 mm"}), (board.solids(), {}))
    )
    assert (shells < solids).all() and (shells > 0.96 * solids).all()
    file = gb.read_scenario("examples/board.toml")
    np.testing.assert_allclose(gb.modes(file.subject, errors=False).frequency[:4], shells, rtol=1e-9)


def pair(**more: Any) -> meshio.Mesh:
    return meshio.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], {"quad": [[0, 1, 2, 3]]}, **more)


def crossed() -> meshio.Mesh:
    return meshio.Mesh([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]], {"quad": [[0, 1, 2, 3]]})


@pytest.mark.parametrize(
    ("mesh", "thickness", "words"),
    [
        (pair(), None, "mesh has no solid elements: 1 of kind quad; give thickness, for shells, or mesh the volume"),
        (pair(), 0.0, "thickness is 0 m; give a positive, finite value"),
        (pair(), {"deck": 0.1}, "thickness.deck is 'deck', which is no group of the mesh"),
        (pair(cell_sets={"a": [[0]], "b": [[0]]}), {"a": 0.1, "b": 0.2}, "thickness gives 1 elements two: 'a' and 'b'"),
        (crossed(), 0.01, "mesh has 1 element turned inside out or folded: 1"),
        (block("hexahedron", (1, 1, 1), (1.0, 1.0, 1.0)), 0.1, "thickness is one, in a mesh that has solid elements"),
        (
            meshio.Mesh(np.zeros((10, 3)), {"triangle10": [range(10)]}),
            0.1,
            "mesh has 1 elements of kind triangle10; use triangle, triangle6, quad, quad8",
        ),
    ],
)
def test_what_is_no_shell_is_refused(mesh: meshio.Mesh, thickness: Any, words: str) -> None:
    mesh.point_sets = {"wall": np.array([0, 1, 3])}
    with pytest.raises(gb.InputError, match=words):
        read(mesh, thickness)


def test_elements_without_a_thickness_are_refused() -> None:
    mesh = sheet("quad", (4, 1), (0.4, 0.1))
    mesh.cell_sets = {"thin": [np.array([0, 1])]}
    with pytest.raises(gb.InputError, match="thickness gives 2 elements none; name the groups of all elements"):
        read(mesh, {"thin": 0.001})


def test_folded_triangles_of_three_nodes_are_warned_of() -> None:
    mesh = sheet("triangle", (4, 2), (0.4, 0.1))
    assert read(mesh, 0.001).warnings == ()
    mesh.points[:] = np.stack([mesh.points[:, 0], np.minimum(mesh.points[:, 1], 0.05), mesh.points[:, 1]], axis=1)
    mesh.points[:, 2] = np.maximum(mesh.points[:, 2] - 0.05, 0.0)
    assert "16 triangles of three nodes are too stiff in their own plane" in read(mesh, 0.001).warnings[0]
