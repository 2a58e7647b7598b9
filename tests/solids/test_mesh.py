"""Solids of finite elements: closed forms, published frequencies, theorems on random meshes, and files."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.report import number, response_lines, text
from gbeam.solids import KINDS, STRAIN, chunks, mass_matrix, read_mesh, stiffness_matrix

from .bodies import PAIRS, STEEL, STIFF, Block, block, solid

pytestmark = pytest.mark.usefixtures("reading_in_process")

L, B, H = 1.0, 0.02, 0.01
STRIP = STIFF.density * B * H, STIFF.youngs_modulus * B * H**3 / 12  # kg/m, N m²
SOLIDS = [kind for kind, each in KINDS.items() if not each.shell]
QUADRATIC = [kind for kind in SOLIDS if not KINDS[kind].linear]


@cache
def strip(kind: str = "hexahedron20", cells: tuple[int, int, int] = (40, 1, 1)) -> gb.SolidModel:
    return solid(block(kind, cells, (L, B, H)), STIFF).reduced(modes=8, damping_ratio=0.01)


# Wright et al. (1982), J. Appl. Mech. 49, 197: flap against the speed of a thin beam, which shear and rotary
# inertia change by less than 3e-4 in the second mode.
FLAP = {2: (4.13732, 22.6149), 4: (5.58500, 24.2734), 12: (13.1702, 37.6031)}


@pytest.mark.parametrize("rate", FLAP)
def test_a_spinning_strip_has_the_published_frequencies(rate: float) -> None:
    """Geometric stiffness, centrifugal force and its growth with the displacement; in forty elements."""
    unit = np.sqrt(STRIP[0] * L**4 / STRIP[1])
    modes = gb.modes(strip().structure, gb.Hub(radius=0.0, rate=rate / unit))
    flap = [2 * np.pi * unit * f for f, way in zip(modes.frequency, modes.direction, strict=True) if way == "z"]
    np.testing.assert_allclose(flap[:2], FLAP[rate], rtol=3e-4)


@pytest.mark.parametrize("kind", QUADRATIC)
def test_a_cantilever_bends_as_in_closed_form(kind: str) -> None:
    """w L⁴/8EI and, by shear, w L²/(2 κGA), κ = 5/6 without Poisson's ratio; the root's moment; stretch by x."""
    model = strip(kind)
    rest = gb.static(model.structure, acceleration=(0.0, 0.0, 10.0))
    shear = 10 * STRIP[0] * L**2 / 2 / (5 / 6 * STIFF.rigidity * B * H)
    np.testing.assert_allclose(-rest.tip[2], 10 * STRIP[0] * L**4 / 8 / STRIP[1] + shear, rtol=3e-4)
    pulled = gb.static(model.structure, acceleration=(-10.0, 0.0, 0.0))
    assert pulled.tip[0] == pytest.approx(10 * STIFF.density * L**2 / 2 / STIFF.youngs_modulus, rel=1e-6)
    system = gb.linearize(model.structure, gb.Flight(z=gb.constant(10.0)))
    moment = [each.name for each in system.outputs].index("root_moment_y")
    push = [each.name for each in system.inputs].index("base_acceleration_z")
    # Of the tip's place the root's moment knows the first order: an acceleration of 1 m/s² along z turns about −y.
    gain = system.d[moment, push] - system.c[moment] @ np.linalg.solve(system.a, system.b[:, push])
    assert abs(gain) == pytest.approx(STRIP[0] * L**2 / 2, rel=1e-3)


def test_a_bar_has_the_frequencies_of_closed_form() -> None:
    """c/4L along, and the torsion of a square, whose constant is 0.1406 a⁴."""
    bar = solid(block("hexahedron27", (6, 4, 4), (1.0, 0.05, 0.05)), STIFF).reduced(modes=12, damping_ratio=0)
    speed = np.sqrt(STIFF.youngs_modulus / STIFF.density)
    along = 2 * np.pi * bar.frequency - np.pi / 2 * speed
    assert np.abs(along).min() < 1e-3 * speed
    torsion = np.pi / 2 * speed * np.sqrt(0.5 * 0.1406 / (1 / 6))
    assert np.abs(2 * np.pi * bar.frequency / torsion - 1).min() < 5e-3  # the wall keeps its section plane


@pytest.mark.parametrize("kind", SOLIDS)
def test_any_block_weighs_what_it_is(kind: str) -> None:
    """Mass, centre and moments of a box whose inside is meshed at random, also of its particles."""
    rng = np.random.default_rng(len(kind))
    size = np.array([0.3, 0.2, 0.1])

    steps = [np.linspace(0, 1, 3), *[np.linspace(-0.5, 0.5, 3)] * 2]
    moved = np.zeros((3, 3, 3, 3))
    moved[1, 1, 1] = 0.2 * (rng.random(3) - 0.5) * size
    mesh = block(kind, (2, 2, 2), tuple(size), lambda x: x + RegularGridInterpolator(steps, moved)(x / size))
    if kind == "tetra10":  # straight edges
        mesh.points[mesh.cells[0].data[:, 4:]] = mesh.points[mesh.cells[0].data[:, np.array(PAIRS)]].mean(axis=2)
    model = solid(mesh).reduced(modes=3, damping_ratio=0)
    mass = STEEL.density * size.prod()
    squares = mass * np.array([size[0] ** 2 / 3, size[1] ** 2 / 12, size[2] ** 2 / 12])
    wanted = [mass, mass * size[0] / 2, 0, 0, *squares, 0, 0, 0]
    np.testing.assert_allclose(model.structure.coefficients.rigid, wanted, atol=1e-12 * mass)
    assert model.mesh.mass == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(model.structure.coefficients.mass, np.eye(model.structure.size), atol=1e-10)


def test_nothing_depends_on_the_axes() -> None:
    """A mesh that is turned with its base, material and motion moves as it did, turned."""
    turn = Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()
    board = gb.Orthotropic(1900, (22e9, 18e9, 9e9), (0.15, 0.3, 0.28), (5e9, 3e9, 2.5e9), ((1, 0, 0), (0, 1, 0)))
    turned = replace(board, axes=tuple(map(tuple, turn.T[:2])))
    at, rates = np.array([3.0, -40.0, 60.0]), np.array([9.0, -14.0, 21.0])
    answer = []
    for R, material in ((np.eye(3), board), (turn, turned)):
        bent = block("tetra10", (3, 1, 1), (0.2, 0.05, 0.02), lambda x, R=R: x @ R.T)
        model = solid(bent, material, point_masses={"tip": 0.2}).reduced(modes=4, damping_ratio=0.02)
        flight = gb.Flight(acceleration=gb.constant(R @ at), rates=gb.constant(R @ rates))
        answer.append((gb.modes(model.structure, flight), gb.static(model.structure, flight).tip @ R))
    np.testing.assert_allclose(answer[1][0].eigenvalue, answer[0][0].eigenvalue, rtol=1e-7)
    np.testing.assert_allclose(answer[1][1], answer[0][1], rtol=1e-7, atol=1e-12)


def test_an_isotropic_material_is_an_orthotropic_one() -> None:
    e, g, v = STEEL.youngs_modulus, STEEL.rigidity, 0.3
    same = gb.Orthotropic(7850, (e,) * 3, (v,) * 3, (g,) * 3, ((1, 2, 0.5), (-2, 1, 0)))
    np.testing.assert_allclose(same.elasticity, STEEL.elasticity, atol=1e-9 * e)


# NAFEMS, The Standard NAFEMS Benchmarks (TNSB, rev. 3, 1990), FV32: a tapered membrane, 10 m long and 5 to 1 m wide, in
# its plane.
FV32 = [44.623, 130.03, 162.70, 246.05, 379.90, 391.44]


def test_nafems_fv32_tapered_membrane() -> None:
    """Plane stress: the middle plane stays where it is, the faces are free."""
    mesh = solid(
        block(
            "hexahedron20",
            (12, 6, 2),
            (10.0, 5.0, 0.05),
            lambda x: np.stack([x[:, 0], x[:, 1] * (1 - 0.08 * x[:, 0]), x[:, 2]], axis=1),
        ),
        gb.Material(density=8000, youngs_modulus=200e9, poissons_ratio=0.3),
    )
    held = np.repeat(mesh.clamped, 3)
    held[2::3] |= np.abs(mesh.points[:, 2]) < 1e-9
    np.testing.assert_allclose(frequencies(mesh, held, 6), FV32, rtol=4e-3)


def frequencies(mesh: gb.SolidMesh, held: np.ndarray, count: int, shift: float = 0.0) -> np.ndarray:
    """Lowest natural frequencies of a mesh held otherwise than at its clamp, Hz."""
    from scipy.sparse import csc_matrix, eye_array, kron
    from scipy.sparse.linalg import eigsh

    free = ~held
    k = csc_matrix(stiffness_matrix(mesh.points, mesh.blocks))[free][:, free]
    m = csc_matrix(kron(mass_matrix(mesh.points, mesh.blocks), eye_array(3)))[free][:, free]
    square = np.sort(eigsh(k, k=count, M=m, sigma=shift, v0=np.ones(k.shape[0]), return_eigenvectors=False))
    return np.sqrt(np.maximum(square, 0)) / (2 * np.pi)


# FV52: a square plate of 10 m, 1 m thick, held along z on the four edges of its lower face; its target is the closed
# form of a thick plate, and the answer of the benchmark's own elements, 4 × 4 × 1 of 20 nodes, is the second row.
FV52 = [45.897, 109.44, 109.44, 167.89, 193.59, 206.19, 206.19]
FV52_ELEMENTS = [44.762, 110.52, 110.52, 169.08, 193.93, 206.64, 206.64]


def test_nafems_fv52_square_plate() -> None:
    """Three rigid motions, then seven modes: the target's elements within 0.4 %, its closed form within 3 %."""
    material = gb.Material(density=8000, youngs_modulus=200e9, poissons_ratio=0.3)
    mesh = solid(block("hexahedron20", (4, 4, 1), (10.0, 10.0, 1.0)), material)
    x, y, z = mesh.points.T
    held = np.zeros(3 * len(x), dtype=bool)
    held[2::3] = (z < -0.49) & ((np.abs(x - 5) > 4.99) | (np.abs(y) > 4.99))
    computed = frequencies(mesh, held, 10, shift=-1.0)
    assert (computed[:3] < 0.1).all()
    np.testing.assert_allclose(computed[3:], FV52_ELEMENTS, rtol=4e-3)
    np.testing.assert_allclose(computed[3:], FV52, rtol=3e-2)


def test_the_mesh_converges_and_says_by_how_much() -> None:
    """The stated error is the difference to the coarser mesh's own answer, and more than the error against one twice as
    fine again; at the clamp's edges the stress is singular, and the order lower than four.
    """
    meshes = [solid(block("tetra10", (n, 1, 1), (0.4, 0.05, 0.05))) for n in (4, 8, 16)]
    coarse, middle, fine = (each.reduced(modes=4, damping_ratio=0.01) for each in meshes)
    judged = meshes[1].reduced(modes=4, damping_ratio=0.01, coarser=coarse)
    assert np.isnan(middle.mesh_error).all() and "unknown" in repr(middle) and "error of the mesh up to" in repr(judged)
    np.testing.assert_allclose(judged.mesh_error, np.abs(coarse.frequency / judged.frequency - 1))
    stated = gb.modes(judged.structure).errors
    assert stated is not None and stated.note == "" and np.isfinite(stated.mesh).all()
    np.testing.assert_allclose(stated.mesh, judged.mesh_error, rtol=1e-6)
    spin = gb.Hub(radius=0.1, rate=200.0)
    for hub in (spin, gb.Hub(radius=0.1, inertia=1e3)):
        of, rough, truth = (gb.modes(each.structure, hub) for each in (judged, coarse, fine))
        assert of.errors is not None
        np.testing.assert_allclose(of.errors.mesh, np.abs(rough.frequency / of.frequency - 1), rtol=1e-4)
        np.testing.assert_allclose(of.errors.total, of.errors.shapes + of.errors.mesh)
        assert_stated(of.errors.mesh, np.abs(truth.frequency / of.frequency - 1))
    push = gb.Flight(z=gb.SmoothStep(50.0, 0.005), y=gb.SmoothStep(20.0, 0.005))
    for ask in (
        lambda of: gb.static(of, acceleration=(0.0, 0.0, 9.81)),
        lambda of: gb.static(of, spin),
        lambda of: gb.simulate(of, push, duration=0.02, step=1e-4, integrator="gauss", name="push"),
    ):
        of, rough, truth = (ask(each.structure) for each in (judged, coarse, fine))
        assert of.errors.note == "" and of.errors.displacement.total >= of.errors.displacement.mesh
        tips, loads = ([changed(of, other, k) for other in (rough, truth)] for k in ("tip", "loads"))
        assert of.errors.displacement.mesh == pytest.approx(tips[0], rel=1e-2)
        assert of.errors.loads.mesh == pytest.approx(loads[0], rel=2e-2, abs=1e-9)
        assert_stated(tips[0], tips[1])
        assert 0.01 < of.errors.stress.mesh < 0.5
    said = " ".join(response_lines(of))
    assert "mesh" in said and "not judged" not in said and any("mesh it finer" in each for each in of.warnings)
    lost, rough = (
        gb.critical_speed(each.structure, gb.Hub(radius=0.1, pointing="inward")) for each in (judged, coarse)
    )
    assert lost.value is not None and rough.value is not None and lost.error_note == ""
    assert lost.errors.mesh == pytest.approx(abs(rough.value / lost.value - 1), rel=1e-3)
    without = gb.static(middle.structure, acceleration=(0.0, 0.0, 9.81)).errors
    assert without.note == "the mesh is not judged" and np.isnan(without.displacement.mesh)


def changed(of: Any, other: Any, what: str) -> float:
    """Largest difference of the tip's displacement, or the root's loads, as a share of the largest."""
    if what == "tip":
        pairs = [[each.displacement.reshape(-1, len(each.stations), 3)[:, -1] for each in (of, other)]]
    else:
        pairs = [[getattr(each.loads, k)[:, 0] for each in (of, other)] for k in ("force", "moment")]
    sizes = ((np.linalg.norm(a - b, axis=1).max(), np.linalg.norm(a, axis=1).max()) for a, b in pairs)
    return float(max(away / size for away, size in sizes))


def assert_stated(stated: Any, true: Any) -> None:
    """A mesh's share bounds its error, and is no more than so many times that."""
    assert (np.asarray(stated) > 0.9 * np.asarray(true)).all() and (np.asarray(stated) < 8 * np.asarray(true)).all()


@pytest.fixture(scope="module")
def two_meshes() -> tuple[gb.Structure, gb.Structure]:
    """A bar that is judged by a coarser mesh, and that mesh's own."""
    meshes = [solid(block("tetra10", (n, 1, 1), (0.4, 0.05, 0.05))) for n in (4, 8)]
    coarse = meshes[0].reduced(modes=4, damping_ratio=0.01)
    return meshes[1].reduced(modes=4, damping_ratio=0.01, coarser=coarse).structure, coarse.structure


HALF: dict[str, Any] = {"duration": 0.002, "step": 1e-5, "integrator": "gauss"}  # half a period


@pytest.mark.parametrize(
    "initial", ["undeformed", gb.Initial(tip_displacement={"z": 1e-3}), gb.Initial(tip_velocity={"z": 1.0})]
)
def test_a_coarser_mesh_begins_as_the_run_does(initial: Any, two_meshes: tuple[gb.Structure, gb.Structure]) -> None:
    """Not in equilibrium: the stated share is the difference to its own run from that state, in half a period."""
    lift = gb.Flight(z=gb.constant(200.0))
    of, rough = (gb.simulate(each, lift, initial=initial, **HALF) for each in two_meshes)
    assert of.errors.displacement.mesh == pytest.approx(changed(of, rough, "tip"), rel=2e-3)
    assert of.errors.loads.mesh == pytest.approx(changed(of, rough, "loads"), rel=1e-2)


def test_a_coarser_mesh_in_a_system_begins_as_the_run_does(two_meshes: tuple[gb.Structure, gb.Structure]) -> None:
    held = [gb.System({"a": each}, {"a": gb.Joint("fixed", "a")}, gravity=(0.0, 0.0, -200.0)) for each in two_meshes]
    of, rough = (gb.simulate(each, initial="undeformed", **HALF) for each in held)
    moved = [each.place - each.place[0] for each in (of, rough)]
    sizes = [np.linalg.norm(each, axis=-1).max() for each in (moved[0] - moved[1], moved[0])]
    assert of.errors.displacement.mesh == pytest.approx(sizes[0] / sizes[1], rel=2e-3)


def test_bodies_of_a_system_state_their_meshes_share() -> None:
    """At rest and in motion as the coarser meshes' system has it; of one without a coarser mesh it is not judged."""
    meshes = [solid(block("tetra10", (n, 1, 1), (0.4, 0.05, 0.05))) for n in (4, 8)]
    coarse = meshes[0].reduced(modes=4, damping_ratio=0.01)
    middle = meshes[1].reduced(modes=4, damping_ratio=0.01, coarser=coarse).structure

    def held(of: gb.Structure, **more: gb.Structure) -> gb.System:
        bodies = {"a": of} | more
        return gb.System(bodies, {name: gb.Joint("fixed", name) for name in bodies}, gravity=(0.0, 0.0, -9.81))

    for ask in (gb.static, partial(gb.simulate, duration=0.01, step=1e-4, initial="undeformed")):
        alone, rough = (ask(held(each)) for each in (middle, coarse.structure))
        runs = ask is not gb.static
        moved = [each.place - each.place[0] if runs else each.point_displacement for each in (alone, rough)]
        sizes = [np.linalg.norm(each, axis=-1).max() for each in (moved[0] - moved[1], moved[0])]
        assert alone.errors.note == ""
        assert alone.errors.displacement.mesh == pytest.approx(sizes[0] / sizes[1], rel=0.02)
        assert alone.errors.loads.mesh < 1 and 0.01 < alone.errors.stress.mesh < 0.5
    modes, rough = (gb.modes(held(each)) for each in (middle, coarse.structure))
    assert modes.errors is not None
    np.testing.assert_allclose(modes.errors.mesh[:4], np.abs(rough.frequency / modes.frequency - 1)[:4])
    both = gb.static(held(middle, b=replace(middle, coarser=None)))
    assert both.errors.note == "the mesh of b is not judged" and both.errors.displacement.mesh > 0
    assert f"{number(100 * both.errors.displacement.mesh, 2)} %" in text(both)


def test_few_modes_answer_steady_loads_as_all_do() -> None:
    """The static shapes: with one mode a steady acceleration and rotation deform the solid as with sixty."""
    mesh = solid(block("hexahedron20", (4, 1, 1), (0.2, 0.05, 0.03)))
    few, many = (mesh.reduced(modes=n, damping_ratio=0) for n in (1, 60))
    assert few.structure.size <= 13
    spin = gb.Flight(acceleration=gb.constant([1.0, 2.0, 3.0]), rates=gb.constant([1.0, 2.0, 3.0]))
    tips = [gb.static(each.structure, spin).tip for each in (few, many)]
    np.testing.assert_allclose(tips[0], tips[1], rtol=1e-6)


def test_point_masses_points_and_origin() -> None:
    """A mass on the tip's node: massless cantilever, (3EI/mL³)^½; the root elsewhere is a longer lever."""
    light = replace(STIFF, density=1e-3)
    mesh = block("hexahedron20", (20, 1, 1), (L, B, H), groups={"end": lambda x: x[:, 0] == L})
    held = solid(mesh, light, point_masses={"end": 0.1}, points={"middle": (1.5, 0.0, 0.005)}, origin=(-1.0, 0, 0))
    model = held.reduced(modes=2, damping_ratio=0.01)
    assert model.frequency[0] == pytest.approx(np.sqrt(3 * STRIP[1] / (0.1 * L**3)) / (2 * np.pi), rel=1e-3)
    np.testing.assert_allclose(
        model.structure.coefficients.rigid[1] / model.structure.coefficients.rigid[0], 2.0, rtol=1e-3
    )
    turn = gb.Flight(acceleration=gb.constant([0.0, 0.0, 0.0]), rates=gb.constant([0.0, 0.0, 2.0]))
    pulled = gb.static(model.structure, turn).tip[0]
    # The corner's own place is a little off that of the section, on whose nodes the mass is spread evenly.
    assert pulled == pytest.approx(0.1 * 2.0**2 * 2.0 * L / (STIFF.youngs_modulus * B * H), rel=1e-2)
    flown = gb.simulate(model.structure, gb.Flight(z=gb.constant(1.0)), duration=0.1, step=0.01)
    assert flown.body.points == ("middle", "tip") and flown.body.at("middle").shape == flown.tip.shape
    # (3 x²L − x³)/6EI of the force at the end.
    assert flown.body.at("middle")[-1, 2] / flown.tip[-1, 2] == pytest.approx(5 / 16, rel=2e-3)
    system = gb.linearize(model.structure, gb.Flight(z=gb.constant(1.0)))
    assert "middle_z" in [each.name for each in system.outputs]


def test_the_tip_is_free() -> None:
    """Of a bar that is held at its far end; and a place of zero is not said by its rounding."""
    mesh = block("hexahedron20", (4, 1, 1), (L, B, H), groups={"end": lambda x: x[:, 0] == L})
    held = gb.SolidMesh.read(mesh, materials=STIFF, clamp="end", unit="m", turn=(0.0, 0.0, np.pi))
    assert held.points[held.stations["tip"]][0] == pytest.approx(-0.875 * L)  # in the middle of an edge
    model = held.reduced(modes=2, damping_ratio=0.01)
    pulled = model.stress(gb.static(model.structure, acceleration=(1.0, 0.0, 0.0)))
    assert "e-1" not in str(pulled)


@pytest.mark.parametrize("name", ["solid.msh", "solid.vtu", "solid.bdf", "solid.inp", "solid.vtk", "solid.med"])
def test_a_mesh_comes_back_from_files(tmp_path: Path, name: str) -> None:
    """Gmsh, VTK, Nastran and Abaqus: two materials by groups of elements, the clamp by nodes or by elements."""
    mesh = block("hexahedron20", (2, 1, 1), (200.0, 50.0, 30.0))
    mesh.points = np.asarray(mesh.points)[np.unique(mesh.cells[0].data)]  # Nastran and Abaqus number what they use
    cells = np.unique(mesh.cells[0].data, return_inverse=True)[1].reshape(-1, 20)
    wall = np.flatnonzero(mesh.points[:, 0] == 0)
    skin = cells[:1, [0, 3, 7, 4]]
    parts = [("hexahedron20", cells), ("quad", skin)]
    tags = [np.array([1, 2]), np.array([7])]
    materials: dict[str, gb.Material] = {"1": STEEL, "2": STIFF}
    clamp = "7"
    if name.endswith(".inp"):
        parts, clamp, materials = parts[:1], "wall", {"root_half": STEEL, "tip_half": STIFF}
        whole = meshio.Mesh(
            mesh.points, parts, point_sets={"wall": wall}, cell_sets={"root_half": [[0]], "tip_half": [[1]]}
        )
    else:
        key = {".msh": "gmsh:physical", ".bdf": "nastran:ref"}.get(name[-4:], "part")
        whole = meshio.Mesh(mesh.points, parts, cell_data={key: tags})
        if name.endswith(".msh"):
            whole.cell_data["gmsh:geometrical"] = [np.array([11, 11]), np.array([12])]
    options = {"file_format": "gmsh22"} if name.endswith(".msh") else {}
    meshio.write(tmp_path / name, whole, **options)
    held = gb.SolidMesh.read(tmp_path / name, materials=materials, clamp=clamp, unit="mm")
    # A wall by its corners alone holds as well.
    assert held.clamped.sum() == (8 if name.endswith(".inp") else 4)
    assert held.mass == pytest.approx((STEEL.density + STIFF.density) * 0.1 * 0.05 * 0.03)


@pytest.mark.parametrize("name", ["solid.vtk", "solid.vtu"])
def test_a_selection_of_paraview_is_a_group(tmp_path: Path, name: str) -> None:
    """Arrays of 0 and 1, of nodes and of elements; whole numbers of nodes, as their own, are none."""
    mesh = block("hexahedron", (2, 1, 1), (200.0, 50.0, 30.0))
    x = mesh.points[:, 0]
    mesh.point_data = {"wall": (x == 0).astype(np.int8), "GlobalPointIds": np.arange(len(x))}
    mesh.cell_data = {"root_half": [np.array([1, 0])], "tip_half": [np.array([0, 1])]}
    meshio.write(tmp_path / name, meshio.Mesh(mesh.points, mesh.cells, mesh.point_data, mesh.cell_data))
    materials: dict[str, Any] = {"root_half": STEEL, "tip_half": STIFF}
    held = gb.SolidMesh.read(tmp_path / name, materials=materials, clamp="wall", unit="mm")
    assert (held.points[held.clamped, 0] == 0).all() and held.clamped.sum() == 4
    assert held.mass == pytest.approx((STEEL.density + STIFF.density) * 0.1 * 0.05 * 0.03)
    with pytest.raises(gb.InputError, match=r"clamp is 'floor', .*; choose from wall, root_half, tip_half, 0, 1$"):
        gb.SolidMesh.read(tmp_path / name, materials=materials, clamp="floor", unit="mm")


def energy(mesh: gb.SolidMesh, moved: np.ndarray) -> float:
    """Strain energy of displacements (k, 3) with Green's strain."""
    total = 0.0
    for part in chunks(mesh.points, mesh.blocks, "stiffness"):
        slopes = np.einsum("eqkd,ekc->eqcd", part.gradients, moved[part.nodes])
        green = slopes + np.einsum("eqca,eqcd->eqad", slopes, slopes) / 2
        strain = np.einsum("vcd,eqcd->eqv", STRAIN, green)
        total += 0.5 * np.einsum("eq,eqv,vw,eqw->", part.volume, strain, part.elasticity, strain)
    return total


@pytest.mark.parametrize("angle", [0.0, 1.2])
def test_loads_stiffen_as_the_energy_of_greens_strain_says(angle: float) -> None:
    """Of a strip and of one bent about y: the mixed third derivative of its energy, by a load and twice by a mode."""

    def bent(x: np.ndarray) -> np.ndarray:
        turn = angle * x[:, 0] / 0.3
        radius = 0.3 / max(angle, 1e-9) - x[:, 2]
        return np.stack([radius * np.sin(turn), x[:, 1], radius * (1 - np.cos(turn)) + x[:, 2]], axis=1) if angle else x

    mesh = solid(block("hexahedron20", (6, 1, 1), (0.3, 0.05, 0.01), bent))
    model = mesh.reduced(modes=3, damping_ratio=0)
    c = model.structure.coefficients
    for load in (np.array([1.0, 0, 0]), np.array([0, 0, 1.0])):
        pushed = model.shapes @ np.linalg.solve(c.stiffness, c.f_a.T @ load)
        added = np.tensordot(load, c.k_a, axes=1)
        for mode in range(3):
            shape = model.shapes[:, :, mode]
            a, b = 1e-3 / np.abs(pushed).max(), 1e-3 / np.abs(shape).max()
            odd = sum(
                i * (energy(mesh, i * a * pushed + j * b * shape) - energy(mesh, i * a * pushed))
                for i in (1, -1)
                for j in (1, -1)
            )
            scale = max(abs(added[mode, mode]), 1e-6 * c.stiffness[mode, mode])
            assert odd / (2 * a * b**2) == pytest.approx(added[mode, mode], abs=1e-3 * scale)


def test_the_bracket_of_the_examples_is_what_its_script_makes() -> None:
    """With its mass in closed form: a sheet about its middle line, and a box."""
    import bracket

    solids = [
        gb.SolidMesh.read(source, materials=bracket.MATERIALS, clamp="screwed", unit="mm")
        for source in (bracket.HERE / "data" / "bracket.msh", bracket.mesh())
    ]
    np.testing.assert_allclose(solids[0].points, solids[1].points, atol=1e-12)
    sheet = (bracket.FOOT + bracket.RADIUS * np.pi / 2 + bracket.ARM) * bracket.WIDTH * bracket.THICKNESS
    box = bracket.CAMERA[0] * bracket.CAMERA[1] * bracket.WIDTH
    assert solids[0].mass == pytest.approx(1e-9 * (2700 * sheet + 3300 * box), rel=1e-5)


def test_a_beam_meshed_as_a_solid_gives_what_the_beam_gives() -> None:
    """A strip that slews while its base accelerates, by 40 hexahedra and by FOAM: within 0.3 % of the largest."""
    length, width, thickness = 0.3, 0.02, 0.004
    mesh = solid(block("hexahedron20", (40, 1, 1), (length, width, thickness)), STIFF)
    metal = gb.Material(STIFF.density, STIFF.youngs_modulus)
    beam = gb.Beam(length, gb.Section.rectangle(width, thickness), metal, damping_ratio=0.02)
    slew = gb.Hub(radius=0.1, rate=gb.SmoothStep(100.0, 0.3), gravity=(0.0, 0.0, -9.81), setting_angle=np.pi / 4)
    runs = [
        gb.simulate(structure, slew, duration=0.4, step=5e-4, integrator="gauss", estimate=False)
        for structure in (mesh.reduced(modes=6, damping_ratio=0.02).structure, gb.assemble(beam, "FOAM", y=3, z=4))
    ]
    # The mesh's tip is a corner, which bending takes along x; across, it goes with the section.
    tips = [each.tip[:, 1:] for each in runs]
    largest = np.abs(tips[1]).max()
    assert largest > 2e-3
    np.testing.assert_allclose(tips[0], tips[1], atol=3e-3 * largest)


# CalculiX 2.20's frequencies of a steel bar of 200 x 20 x 10 mm, 20 x 2 x 1 cells of two C3D15, clamped at one end, Hz.
C3D15 = [210.3198, 416.6794, 1304.513, 2500.825, 3078.834, 3595.691, 6483.083]


def test_wedges_of_fifteen_nodes_are_those_of_calculix(tmp_path: Path) -> None:
    """Read from a file of Abaqus, and in the numbering of Nastran and Gmsh, which differ."""
    bar = block("wedge15", (20, 2, 1), (0.2, 0.02, 0.01))
    used, cells = np.unique(bar.cells[0].data, return_inverse=True)
    wall = np.flatnonzero(bar.points[used][:, 0] == 0)
    part = meshio.Mesh(bar.points[used], [Block("wedge15", cells.reshape(-1, 15))], point_sets={"wall": wall})
    meshio.write(tmp_path / "bar.inp", part)
    mesh = gb.SolidMesh.read(tmp_path / "bar.inp", materials=STEEL, clamp="wall", unit="m")
    assert mesh.mass == pytest.approx(7850 * 0.2 * 0.02 * 0.01, rel=1e-12)
    np.testing.assert_allclose(mesh.reduced(modes=7, damping_ratio=0).frequency, C3D15, rtol=1.5e-5)
    places = bar.points[bar.cells[0].data]
    formats: tuple[tuple[str, dict[str, Any]], ...] = (
        ("bar.bdf", {}),
        ("bar.msh", {"file_format": "gmsh22", "binary": False}),
    )
    for name, options in formats:
        meshio.write(tmp_path / name, part, **options)
        again = read_mesh(tmp_path / name)
        np.testing.assert_allclose(again.points[again.cells[0].data], places, atol=1e-12)
