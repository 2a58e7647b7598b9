"""Boards of one layer of solid elements: their error beside Kirchhoff's plate, and who is warned of it."""

from __future__ import annotations

import re

import numpy as np
import pytest

import gbeam as gb

from .bodies import STEEL, block

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
