"""Theorems on solids with random meshes: mass properties, and no change by where they lie and how they are turned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import gbeam as gb
from tests.solids.bodies import STEEL, block, solid

SIZE = (0.12, 0.03, 0.02)
KINDS = ("tetra10", "hexahedron20", "hexahedron27")
seeds = st.integers(0, 2**16)
vectors = st.tuples(*[st.floats(-2.0, 2.0)] * 3)


def moved_inside(seed: int):
    """A map of a block that leaves its faces and bends what is inside, smoothly."""
    size = np.random.default_rng(seed).uniform(-0.15, 0.15, 3)

    def bent(x: np.ndarray) -> np.ndarray:
        share = x / SIZE + (0, 0.5, 0.5)
        bubble = np.prod(share * (1 - share), axis=1) * 64
        return x + bubble[:, None] * size * SIZE

    return bent


@settings(max_examples=15)
@given(st.sampled_from(KINDS), seeds, vectors)
def test_mass_properties_are_those_of_the_block(kind: str, seed: int, origin: tuple[float, float, float]) -> None:
    """However its inside is meshed: mass, first moment and inertia about the root."""
    mesh = solid(block(kind, (3, 1, 1), SIZE, moved_inside(seed)), origin=origin)
    mass, first, inertia = properties(mesh)
    length = np.array(SIZE)
    assert mass == pytest.approx(7850 * length.prod(), rel=1e-9)
    centre = np.array([SIZE[0] / 2, 0, 0]) - origin
    assert first == pytest.approx(mass * centre, rel=1e-8, abs=1e-9 * mass)
    about = mass / 12 * np.diag((length @ length) - length**2) + mass * (
        centre @ centre * np.eye(3) - np.outer(centre, centre)
    )
    # The mass matrix of quadratic elements has products of places to fourth degree in straight elements only.
    assert inertia == pytest.approx(about, rel=2e-3, abs=2e-3 * np.trace(about))


def properties(mesh: gb.SolidMesh) -> tuple[float, np.ndarray, np.ndarray]:
    from gbeam.solids import mass_matrix

    matrix = mass_matrix(mesh.points, mesh.blocks)
    weight = np.asarray(matrix.sum(axis=0)).ravel()
    second = mesh.points.T @ (matrix @ mesh.points)
    return float(weight.sum()), weight @ mesh.points, np.trace(second) * np.eye(3) - second


@settings(max_examples=8)
@given(st.sampled_from(KINDS), seeds, vectors, vectors)
def test_a_turned_solid_is_the_same_solid(
    kind: str, seed: int, turn: tuple[float, float, float], origin: tuple[float, float, float]
) -> None:
    """Frequencies, and the answer to an acceleration that is turned with it, in base axes."""
    mesh = block(kind, (2, 1, 1), SIZE, moved_inside(seed))
    plain = solid(mesh).reduced(modes=3, damping_ratio=0.01)
    turned = solid(mesh, turn=turn, origin=origin).reduced(modes=3, damping_ratio=0.01)
    assert turned.frequency == pytest.approx(plain.frequency, rel=1e-7)
    rotation = Rotation.from_rotvec(turn)
    tips = []
    for model, acceleration in ((plain, np.array([3.0, 5.0, 7.0])), (turned, rotation.apply([3.0, 5.0, 7.0]))):
        rest = gb.static(model.structure, acceleration=tuple(acceleration))
        stress = model.stress(rest)
        assert rest.loads is not None
        tips.append((stress.worst.von_mises, rest.loads.root_force[0]))
    # The static shapes of the turned one are about another root, so that its coordinates are others.
    assert tips[1][0] == pytest.approx(tips[0][0], rel=1e-5)
    assert tips[1][1] == pytest.approx(rotation.apply(tips[0][1]), rel=1e-6, abs=1e-9)


@settings(max_examples=6)
@given(vectors)
def test_an_orthotropic_material_turns_with_its_mesh(turn: tuple[float, float, float]) -> None:
    wood = gb.Orthotropic(500, (10e9, 1e9, 0.5e9), (0.4, 0.3, 0.35), (0.7e9, 0.1e9, 0.6e9), ((1, 0, 0), (0, 1, 0)))
    mesh = block("hexahedron20", (2, 1, 1), SIZE)
    frequencies = [
        solid(mesh, wood, turn=each).reduced(modes=3, damping_ratio=0.0).frequency for each in ((0, 0, 0), turn)
    ]
    assert frequencies[1] == pytest.approx(frequencies[0], rel=1e-7)


def test_scale_is_a_mesh_of_that_size() -> None:
    scaled = solid(block("hexahedron20", (2, 1, 1), SIZE), STEEL, scale=(2.0, 1.0, 0.5))
    built = solid(block("hexahedron20", (2, 1, 1), (2 * SIZE[0], SIZE[1], SIZE[2] / 2)), STEEL)
    assert scaled.points == pytest.approx(built.points, abs=1e-15)
