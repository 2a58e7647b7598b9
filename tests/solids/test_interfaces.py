"""Bodies on solids and on imported matrices: against all unknowns at once, against beams, and what cannot hold one."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import eigh

import gbeam as gb
from gbeam.mechanics import Frame, body_of, momentum
from gbeam.numerics import positive_definite
from gbeam.solids import attached, mass_matrix, stiffness_matrix

from .bodies import STIFF, block, solid
from .test_matrices import frame

pytestmark = pytest.mark.usefixtures("reading_in_process")

LENGTH, WIDTH, HEIGHT = 0.3, 0.02, 0.01
STRAIGHT = gb.Material(7850.0, 210e9, poissons_ratio=0.0)
BODY = gb.RigidBody(0.1, (2e-5, 4e-5, 3e-5), centre=(0.02, 0, 0.01))


@cache
def strip(cells: tuple[int, int, int] = (8, 1, 1)) -> gb.SolidMesh:
    """A straight block whose end is an interface."""
    groups = {"end": lambda x: x[:, 0] == LENGTH}
    mesh = block("hexahedron20", cells, (LENGTH, WIDTH, HEIGHT), groups=groups)
    return solid(mesh, STIFF, interfaces={"seat": "end"})


@cache
def reduced(modes: int) -> gb.Structure:
    return strip().reduced(modes=modes, damping_ratio=0.0).structure


@cache
def beam() -> gb.Structure:
    """The strip as a beam."""
    section = gb.Section.rectangle(WIDTH, HEIGHT)
    whole = gb.Beam(
        LENGTH, section, gb.Material(2700, 70e9, poissons_ratio=0.0), damping_ratio=0.0, rotary_inertia=True
    )
    return gb.assemble(whole, "exact", axial=2, y=4, z=4, twist=2, shear_y=2, shear_z=2)


def with_body(model: gb.Structure, on: str, body: gb.RigidBody = BODY, gravity: Any = None, **joint: Any) -> gb.System:
    hung = gb.Joint(joint.pop("kind", "fixed"), "box", on=f"strip.{on}", **joint)
    return gb.System({"strip": model, "box": body}, {"wall": gb.Joint("fixed", "strip"), "weld": hung}, gravity=gravity)


def of_body() -> np.ndarray:
    """Mass matrix of the body by the motion of its root."""
    x, y, z = BODY.centre
    turn = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    move = np.block([[np.eye(3), turn], [np.zeros((3, 3)), np.eye(3)]])
    inside = np.block([[BODY.mass * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), BODY.tensor]])
    return np.asarray(move.T @ inside @ move)


def test_a_body_on_a_solid_converges_to_all_unknowns() -> None:
    """With six attachment shapes the lowest frequency is there at once; more modes bring the others."""
    mesh = strip()
    mass = sparse.kron(mass_matrix(mesh.points, mesh.blocks), sparse.eye_array(3)).toarray()
    _, forces = attached(mesh.points, mesh.interfaces)
    mass = mass + forces @ of_body() @ forces.T
    free = np.repeat(~mesh.clamped, 3)
    stiffness = stiffness_matrix(mesh.points, mesh.blocks).toarray()
    squares = eigh(stiffness[free][:, free], mass[free][:, free], eigvals_only=True, subset_by_index=[0, 5])
    apart = [gb.modes(with_body(reduced(n), "seat")).frequency[:6] / np.sqrt(squares) * 2 * np.pi - 1 for n in (2, 8)]
    np.testing.assert_allclose(apart[0][:2], 0, atol=2e-8)
    assert (apart[0][2:] > 0).all() and np.abs(apart[1]).max() < 5e-6
    assert (np.abs(apart[1][2:]) < apart[0][2:] / 50).all()


@pytest.mark.parametrize(
    "joint", [{}, {"kind": "revolute", "axes": [(0, 1, 0)], "stiffness": 20.0}], ids=["weld", "hinge"]
)
def test_a_body_on_a_solid_is_that_on_a_beam(joint: dict[str, Any]) -> None:
    """Bending of the lowest two within what eight elements leave."""
    of_solid, of_beam = (
        gb.modes(with_body(*each, **joint), errors=False) for each in ((reduced(8), "seat"), (beam(), "tip"))
    )
    np.testing.assert_allclose(of_solid.frequency[:2], of_beam.frequency[:2], rtol=1.5e-3)


@pytest.mark.parametrize("way", [20.0, -20.0])
def test_what_hangs_on_a_solid_stiffens_it(way: float) -> None:
    """The weight of a heavy body pulls or presses: the change of both bending frequencies is that of an exact beam."""
    heavy = gb.RigidBody(2.0, (2e-3, 2e-3, 2e-3))
    changes = []
    for model, on in ((reduced(8), "seat"), (beam(), "tip")):
        loaded, free = (gb.modes(with_body(model, on, heavy, gravity), errors=False) for gravity in ((way, 0, 0), None))
        changes.append(loaded.frequency[:2] - free.frequency[:2])
    assert np.sign(changes[0][0]) == np.sign(way)
    np.testing.assert_allclose(changes[0], changes[1], rtol=3e-3)


def test_a_body_on_imported_matrices() -> None:
    """On a node with rotations, as in the whole matrices."""
    m, k, nodes = frame(12, rotary=1e-5)
    model = gb.ImportedModel(m.copy(), k, nodes)
    how = dict(modes=6, damping_ratio=0.0, clamp=[0], points={"seat": 12}, interfaces=["seat"])
    system = with_body(model.reduced(**how), "seat")
    m[-6:, -6:] += of_body()
    squares = eigh(k[6:, 6:], m[6:, 6:], eigvals_only=True)[:4]
    np.testing.assert_allclose(gb.modes(system).frequency[:4] * 2 * np.pi, np.sqrt(squares), rtol=1e-5)
    with pytest.raises(gb.InputError, match=r"mass leaves a static answer without mass, or with next to none .*; give"):
        gb.ImportedModel(*frame(12)).reduced(**how)
    plain = gb.ImportedModel(np.eye(39), np.eye(39), nodes)
    with pytest.raises(gb.InputError, match=r"interfaces\[0\] is 'seat', which does not turn in the matrices; name"):
        plain.reduced(**(how | {"clamp": []}))


def test_what_holds_no_body_is_refused() -> None:
    groups = {"edge": lambda x: (x[:, 0] == LENGTH) & (x[:, 2] == 0)}
    mesh = block("hexahedron20", (2, 1, 1), (LENGTH, WIDTH, HEIGHT), groups=groups)
    edge = solid(mesh, STIFF, interfaces={"seat": "edge"})
    with pytest.raises(gb.InputError, match=r"interfaces\.seat has \d nodes on a line, which do not say how it turns"):
        edge.reduced(modes=1, damping_ratio=0.0)
    with pytest.raises(gb.InputError, match=r"interfaces\.seat is the name of a point too"):
        solid(mesh, STIFF, interfaces={"seat": "edge"}, points={"seat": (LENGTH, 0, 0)})
    with pytest.raises(gb.InputError, match=r"interfaces\.seat is 'lid', which is no group"):
        solid(mesh, STIFF, interfaces={"seat": "lid"})
    with pytest.raises(gb.InputError, match=r"joints\.weld\.on is a point of particles, which do not say how it turns"):
        with_body(reduced(8), "tip")


def test_an_interface_has_the_stress_and_strain_of_its_section() -> None:
    """Half-way along a bar that hangs and carries a body: (ρ A (L - x) + m) g / A, the mean over the section."""
    g, half = 50.0, LENGTH / 2
    groups = {"end": lambda x: x[:, 0] == LENGTH, "middle": lambda x: np.isclose(x[:, 0], half)}
    mesh = block("hexahedron20", (8, 1, 1), (LENGTH, WIDTH, HEIGHT), groups=groups)
    bar = solid(mesh, STIFF, interfaces={"seat": "end", "cut": "middle"}).reduced(modes=4, damping_ratio=0.0).structure
    rest = gb.static(with_body(bar, "seat", gb.RigidBody(0.1, (2e-5, 4e-5, 3e-5)), gravity=(g, 0.0, 0.0)))
    area = WIDTH * HEIGHT
    pull = (STIFF.density * area * half + 0.1) * g / area
    carried = rest.bodies["strip"].solid
    assert carried.points == ("seat", "cut", "tip") and {"strip.cut", "strip.seat"} <= set(rest.points)
    assert carried.point_stress[0, 1, 0] == pytest.approx(pull, rel=1e-3)
    assert carried.strain_at("cut")[0] == pytest.approx(pull / STIFF.youngs_modulus, rel=1e-3)
    plant = gb.linearize(bar, gb.Flight(x=gb.constant(1.0)), gauges=[gb.Gauge("cut")])
    gain = plant.d - plant.c @ np.linalg.solve(plant.a, plant.b)
    (row,) = (k for k, each in enumerate(plant.outputs) if "strain" in each.name)
    column = [each.name for each in plant.inputs].index("base_acceleration_x")
    assert gain[row, column] == pytest.approx(-STIFF.density * half / STIFF.youngs_modulus, rel=1e-3)


def test_a_coarser_mesh_under_a_body_answers_as_its_own_system() -> None:
    """Its coordinates are turned into those like the finer mesh's, and soft ones take nothing of stiff ones there: with
    some, the answer by small departures was far off.
    """
    coarse = strip((2, 1, 1)).reduced(modes=4, damping_ratio=0.02)
    fine = strip((4, 2, 2)).reduced(modes=4, damping_ratio=0.02, coarser=coarse).structure
    assert fine.coarser is not None
    softest = np.sqrt(np.diagonal(fine.coarser.coefficients.stiffness)[:4]) / (2 * np.pi)
    np.testing.assert_allclose(softest, coarse.frequency, rtol=0.01)
    shock = gb.Flight(z=gb.Sine(50.0, duration=0.01), y=gb.Sine(20.0, duration=0.01))
    ran, rough = (
        gb.simulate(with_body(each, "seat"), shock, duration=0.03, step=1e-4) for each in (fine, coarse.structure)
    )
    sizes = [np.linalg.norm(each, axis=-1).max() for each in (ran.place - rough.place, ran.place - ran.place[0])]
    assert ran.errors.place.mesh == pytest.approx(sizes[0] / sizes[1], rel=0.02)
    force = [np.linalg.norm(each, axis=-1).max() for each in (ran.ground_force - rough.ground_force, ran.ground_force)]
    assert 0.5 < ran.errors.loads.mesh * force[1] / force[0] < 3
    assert any(": the mesh; mesh it finer" in each for each in ran.warnings)


def test_a_solid_straight_on_a_hinge_swings_as_an_exact_beam() -> None:
    """Shapes and modes take all but 3e-4 of the moment of inertia about a root; to second order in what bends they took
    more at 1 g, and the run grew without bound. Let go under gravity against a spring, it keeps its energy.
    """
    arm = solid(block("hexahedron27", (8, 1, 1), (0.4, 0.05, 0.004)), STRAIGHT, points={"end": (0.4, 0, 0)})
    rod = gb.Beam(0.4, gb.Section.rectangle(0.05, 0.004), STRAIGHT, damping_ratio=0.0)
    mesh = arm.reduced(modes=4, damping_ratio=0.0).structure
    beam = gb.assemble(rod, "exact", axial=0, y=0, z=5)
    runs = []
    for body in (beam, mesh):
        hinge = gb.Joint("revolute", "arm", axes=[(0, 1, 0)], stiffness=20.0, initial=0.3)
        system = gb.System({"arm": body}, {"axis": hinge}, gravity=(0, 0, -9.81))
        runs.append(gb.simulate(system, duration=0.2, step=2e-4, estimate=False))
    true, ran = runs
    tip, end = (run.place[:, run.points.index(name)] for run, name in ((true, "arm.tip"), (ran, "arm.end")))
    np.testing.assert_allclose(end[:, [0, 2]], tip[:, [0, 2]], atol=3e-4 * np.ptp(tip[:, 2]))
    np.testing.assert_allclose(ran.ground_force, true.ground_force, atol=3e-3 * np.abs(true.ground_force).max())
    assert ran.invariants is not None
    assert np.ptp(ran.invariants.energy.sum(axis=-1)) < 1e-6 * np.ptp(ran.invariants.energy[:, 2])


@pytest.mark.parametrize("size", [0.01, 0.3, 3.0])
def test_a_solid_on_a_free_root_has_positive_mass(size: float) -> None:
    """Bent at random, up to three times the strain energy of 1/2 J in every coordinate."""
    structure = strip((2, 1, 1)).reduced(modes=4, damping_ratio=0.0).structure
    body, rng = body_of("strip", structure, free=True), np.random.default_rng(0)
    stiffness = np.diag(structure.coefficients.stiffness)
    n, still = body.size, np.zeros(3)
    q = rng.normal(size=n) * size / np.sqrt(stiffness)
    rates = np.concatenate([np.eye(6 + n), (np.eye(6 + n)[:, None] + np.eye(6 + n)).reshape(-1, 6 + n)])
    root = Frame(np.eye(3), still, rates[:, :3], rates[:, 3:6], still, still)
    energy, _ = momentum(body, q, rates[:, 6:], root)
    one, two = energy[: 6 + n], energy[6 + n :].reshape(6 + n, 6 + n)
    mass = two - one - one[:, None]
    np.testing.assert_allclose(np.diag(mass), 2 * one)
    assert positive_definite(mass)


def test_errors_of_a_system_are_those_of_more_modes() -> None:
    """Under a body on its end: places and root loads of a strip of one mode, beside one of ten, in a shock."""
    runs = [
        gb.simulate(
            with_body(strip().reduced(modes=modes, damping_ratio=0.02).structure, "seat"),
            gb.Flight(z=gb.Sine(100.0, duration=0.003), y=gb.Sine(50.0, duration=0.002)),
            duration=0.01,
            step=2e-5,
        )
        for modes in (1, 10)
    ]
    few, many = runs
    size = np.linalg.norm(many.place - many.place[0], axis=-1).max()
    place = np.linalg.norm(few.place - many.place, axis=-1).max() / size
    force, moment = (
        np.linalg.norm(a - b, axis=-1).max() / np.linalg.norm(b, axis=-1).max()
        for a, b in ((few.ground_force, many.ground_force), (few.ground_moment, many.ground_moment))
    )
    assert place > 1e-4 and place / 2 < few.errors.place.shapes < 2 * place
    assert force > 0.01 and max(force, moment) / 2 < few.errors.loads.shapes < 2 * max(force, moment)
    stress = [np.abs(each.bodies["strip"].solid.von_mises).max() for each in runs]
    assert few.errors.stress.shapes > abs(stress[0] / stress[1] - 1) / 2
    assert many.errors.place.shapes < place / 10
    assert few.errors.beams == ("strip",) and "the mesh of strip is not judged" in few.errors.note
