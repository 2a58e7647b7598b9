"""Boards of one layer of solid elements: their error beside Kirchhoff's plate, and who is warned of it."""

from __future__ import annotations

import re

import numpy as np
import pytest

import gbeam as gb

from .bodies import STEEL, block, solid

EDGE = 0.2
SQUARE = 35.985  # Leissa (1969), NASA SP-160, table 4.26: ω a² √(ρh/D) of a square plate clamped all round


def rim(x: np.ndarray) -> np.ndarray:
    edge = np.minimum(np.minimum(x[:, 0], EDGE - x[:, 0]), EDGE / 2 - np.abs(x[:, 1]))
    return np.abs(edge) < 1e-9


def board(kind: str, across: int, thickness: float, layers: int = 1) -> tuple[float, tuple[str, ...]]:
    """Lowest frequency over that of the thin plate, and the warnings."""
    mesh = block(kind, (across, across, layers), (EDGE, EDGE, thickness), groups={"wall": rim})
    solid = gb.SolidMesh.read(mesh, materials=STEEL, clamp="wall", unit="m")
    frequency = solid.reduced(modes=1, damping_ratio=0).frequency[0]
    stiffness = STEEL.youngs_modulus * thickness**3 / 12 / (1 - 0.3**2)
    thin = SQUARE / EDGE**2 * np.sqrt(stiffness / STEEL.density / thickness) / 2 / np.pi
    return frequency / thin, solid.warnings


@pytest.mark.parametrize(
    ("kind", "across", "thickness", "least", "most", "warned"),
    [
        ("hexahedron27", 8, 0.002, 1.03, 1.045, False),
        ("hexahedron27", 8, 0.0005, 1.03, 1.045, False),
        ("hexahedron20", 8, 0.002, 1.06, 1.07, True),
        ("tetra10", 8, 0.002, 1.25, 1.32, True),
        ("tetra10", 8, 0.004, 1.11, 1.13, True),
        ("tetra10", 8, 0.01, 1.02, 1.04, False),
    ],
)
def test_a_board_that_locks_is_warned_of(
    kind: str, across: int, thickness: float, least: float, most: float, warned: bool
) -> None:
    ratio, warnings = board(kind, across, thickness)
    assert least < ratio < most
    assert (
        any("they may lock in bending; make them shorter, or use hexahedra of 27 nodes" in w for w in warnings)
        == warned
    )


def test_the_error_of_a_mesh_that_locks_is_not_known() -> None:
    """Of linear tetrahedra two meshes of a strip differ by less than half of what the finer one is wrong by."""
    strips = [solid(block("tetra", (12 * n, 2 * n, n), (0.3, 0.03, 0.01))) for n in (1, 2)]
    coarse = strips[0].reduced(modes=2, damping_ratio=0.01)
    fine = strips[1].reduced(modes=2, damping_ratio=0.01, coarser=coarse)
    slender = 1.8751**2 / (2 * np.pi) * np.sqrt(STEEL.youngs_modulus * 0.01**2 / 12 / STEEL.density) / 0.3**2
    apart, wrong = coarse.frequency[0] / fine.frequency[0] - 1, fine.frequency[0] / slender - 1
    assert wrong > 0.3 and apart < wrong
    assert np.isnan(fine.mesh_error).all() and "error of the mesh unknown, its elements lock" in repr(fine)
    rest, modes = gb.static(fine.structure, acceleration=(0, 0, 9.81)), gb.modes(fine.structure)
    assert np.isnan(rest.errors.displacement.mesh) and "the mesh is not judged" in rest.errors.note
    assert modes.errors is not None and np.isnan(modes.errors.mesh).all()
    for answer in (rest, modes):
        assert any("the error of the mesh is not known: meshes whose elements lock" in each for each in answer.warnings)
    # What its sharp edges are the geometry says all the same.
    assert rest.solid is not None and rest.solid.singular_nodes == 12


@pytest.mark.parametrize("modes", [2, 6, 10])
def test_a_strip_of_one_element_across_is_solved(modes: int) -> None:
    """Of 300 × 30 × 1 mm, whose stiffest static answer has next to no energy under any motion of its base."""
    strip = solid(block("hexahedron20", (15, 1, 1), (0.3, 0.03, 0.001))).reduced(modes=modes, damping_ratio=0.0)
    slender = 1.8751**2 / (2 * np.pi) * np.sqrt(STEEL.youngs_modulus * 0.001**2 / 12 / STEEL.density) / 0.3**2
    assert strip.frequency[0] == pytest.approx(slender, rel=0.03)
    pulled, spun = (
        gb.static(strip.structure, acceleration=(-9.81, 0, 0)),
        gb.static(strip.structure, gb.Hub(radius=0.0, rate=1.0)),
    )
    assert pulled.tip[0] == pytest.approx(STEEL.density * 9.81 * 0.3**2 / 2 / STEEL.youngs_modulus, rel=0.01)
    assert spun.tip[0] == pytest.approx(STEEL.density * 0.3**3 / 3 / STEEL.youngs_modulus, rel=0.01)


def test_a_foil_is_refused_with_a_message_of_its_own() -> None:
    foil = solid(block("hexahedron20", (30, 3, 1), (0.3, 0.03, 0.0001)))
    words = "mass is next to none in a static answer to the base's motion, .*; mesh a thin sheet by its middle surface"
    with pytest.raises(gb.InputError, match=words):
        foil.reduced(modes=6, damping_ratio=0.0)


@pytest.mark.parametrize("kind", ["hexahedron", "wedge", "tetra"])
@pytest.mark.parametrize("across", [8, 16])
def test_linear_elements_are_said_to_be_as_stiff_as_they_are(kind: str, across: int) -> None:
    """One layer of linear elements: the warning's factor, within a third."""
    ratio, (words,) = board(kind, across, 0.004)
    said = re.search(r"fill a thickness alone, whose frequencies of bending are about ([\d.]+) times", words)
    assert said and 0.7 < float(said[1]) / ratio < 1.35


def test_two_layers_do_not_fill_a_thickness_alone() -> None:
    assert "alone" not in " ".join(board("hexahedron", 4, 0.05, 2)[1])
    assert board("hexahedron20", 8, 0.002, 2)[1] == ()
