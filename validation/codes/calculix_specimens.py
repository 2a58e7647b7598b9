"""Three more solids in CalculiX and in gbeam on the same mesh, hexahedra of 20 nodes: the board of examples/board.py on
its screws, with its components as masses of their nodes, a sector of a steel disc clamped at its bore, and a strip.
Under 1 g along every axis, ten modes at rest, and ten in a spin about an axis along z, the root on its radius:
CalculiX's after a static step with large deformations, gbeam's by coefficients of first order in the load.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import meshio
import numpy as np

import gbeam as gb
from gbeam.constants import STANDARD_GRAVITY as G
from validation.codes.calculix_solid import SMALL, Specimen, frequencies, static
from validation.table import Row

sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))
import board as example
from bracket import divided, hexahedra

TITLE = "CalculiX: a board, a spinning disc sector and a strip of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy", "scikit-fem", "meshio")
STATIC, MODES, SPUN = 1e-4, 1e-5, 1e-4
COUNT = 10
STEEL = gb.Material(density=7850, youngs_modulus=210e9, poissons_ratio=0.3)
ALUMINIUM = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
EPOXY = gb.Material(density=1850, youngs_modulus=22e9, poissons_ratio=0.15)
MASSES = {"transformer": 0.12, "connector": 0.03, "processor": 0.025}
BORE, RIM, ANGLE, SHEET = 50.0, 200.0, np.pi / 3, 4.0  # mm; of the disc


@cache
def board() -> gb.SolidMesh:
    """The board with its components."""
    return gb.SolidMesh.read(
        example.solids(), materials=EPOXY, clamp="screws", unit="mm", point_masses=MASSES,
        points={"tip": (0.08, 0.05, 0.0008)},
    )  # fmt: skip


def grid(counts: tuple[int, int, int], ends: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points and hexahedra of 20 nodes of a block, mm, about the x-axis."""
    x, y, z = ends
    points, cells = hexahedra(
        divided(0, x, counts[0]), divided(-y / 2, y / 2, counts[1]), divided(-z / 2, z / 2, counts[2])
    )
    used, number = np.unique(cells, return_inverse=True)
    return points[used], number.reshape(-1, 20)


def held(points: np.ndarray, cells: np.ndarray, wall: np.ndarray, material: gb.Material) -> gb.SolidMesh:
    """A mesh of points, mm, held at its wall."""
    mesh = meshio.Mesh(points, {"hexahedron20": cells}, point_sets={"wall": np.flatnonzero(wall)})
    return gb.SolidMesh.read(mesh, materials=material, clamp="wall", unit="mm")


@cache
def sector() -> gb.SolidMesh:
    """The disc's sector, its root in the middle of the bore."""
    points, cells = grid((8, 8, 1), (RIM - BORE, 1.0, SHEET))
    r, turn = BORE + points[:, 0], ANGLE * points[:, 1]
    bent = np.stack([r * np.cos(turn) - BORE, r * np.sin(turn), points[:, 2]], axis=1)
    return held(bent, cells, points[:, 0] == 0, STEEL)


@cache
def strip() -> gb.SolidMesh:
    """The strip of 2020, along x."""
    points, cells = grid((30, 2, 1), (300.0, 20.0, 4.0))
    return held(points, cells, points[:, 0] == 0, ALUMINIUM)


# Rates of a spin about z, rad/s, and how far its axis lies from the root, m.
CASES = {
    "board": (Specimen(board, {"": EPOXY}), 5.0, 1.0),
    "disc sector": (Specimen(sector, {"": STEEL}), 600.0, 1e-3 * BORE),
    "strip": (Specimen(strip, {"": ALUMINIUM}), 60.0, 0.1),
}


@cache
def structure(name: str) -> gb.Structure:
    """A specimen in sixteen modes and its static shapes."""
    return CASES[name][0].mesh().reduced(modes=16, damping_ratio=0.0).structure


def rows() -> Iterator[Row]:
    """Under accelerations, at rest and spinning."""
    for name, (specimen, rate, radius) in CASES.items():
        mesh, ours = specimen.mesh(), structure(name)
        source = f"{sum(len(block.nodes) for block in mesh.blocks)} C3D20"
        tip = list(mesh.stations.values())[-1]
        for way, load in zip("xyz", np.eye(3), strict=True):
            moved, _ = static(f"EALL, GRAV, {G}, {load[0]}, {load[1]}, {load[2]}", specimen)
            rest = gb.static(ours, acceleration=tuple(-SMALL * G * load)).tip / SMALL
            largest = np.abs(moved[tip]).max()
            for i, axis in enumerate("xyz"):
                if abs(moved[tip, i]) > 0.01 * largest:
                    yield Row(f"{name}, 1 g along {way}", f"displacement {axis} of the tip", 1e6 * moved[tip, i],
                              1e6 * rest[i], "µm", STATIC, source)  # fmt: skip
        for spin, tolerance in ((0.0, MODES), (rate, SPUN)):
            theirs = frequencies(spin, specimen, radius)
            mine = gb.modes(ours, gb.Hub(radius=radius, rate=spin), gyroscopic=False).frequency
            case = f"{name}, {spin:g} rad/s" if spin else f"{name}, at rest"
            for n in range(COUNT):
                yield Row(case, f"mode {n + 1}", theirs[n], mine[n], "Hz", tolerance, source)
