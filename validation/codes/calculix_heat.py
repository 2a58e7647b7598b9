"""A heated portal frame of hexahedra of 20 nodes in CalculiX (*EXPANSION, *TEMPERATURE) and in gbeam: columns of steel
and a beam of aluminium, clamped at one foot, the other fixed or sliding; and a laminate whose axes are turned, clamped
at its wall. Displacements, reactions and the largest von Mises stress by a rise of 1 K. Then the modes of a strip
between two clamps, heated halfway to buckling: CalculiX's prestressed modes come after a static step with large
deformations, gbeam's coefficients are of first order in the rise.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import meshio
import numpy as np

import gbeam as gb
from gbeam.results import von_mises
from gbeam.solids import chunks
from validation.codes.calculix_frames import CASES, HEIGHT, SIDE, portal
from validation.codes.calculix_solid import Specimen, printed_frequencies, run
from validation.codes.calculix_specimens import ALUMINIUM, STEEL, grid
from validation.table import Row

TITLE = "CalculiX: a heated frame on supports, and a laminate"
NEEDS = ("calculix-ccx", "numpy", "scipy", "meshio")
STATIC, STRESS, CLOSE, HEATED, COUNT = 2e-5, 1e-5, 1e-6, 2e-4, 4
COLD, SMALL, HOT = 293.15, 1e-3, 3.0  # K; gbeam's static answer has the stiffness of the rise in it
METALS = {
    "steel": gb.Material(STEEL.density, STEEL.youngs_modulus, poissons_ratio=STEEL.poissons_ratio, expansion=12e-6),
    "aluminium": gb.Material(
        ALUMINIUM.density, ALUMINIUM.youngs_modulus, poissons_ratio=ALUMINIUM.poissons_ratio, expansion=23e-6
    ),
}
BOARD = gb.Orthotropic(
    1900.0, (22e9, 19e9, 8e9), (0.15, 0.3, 0.3), (4e9, 2.5e9, 2.5e9), ((2, 1, 0), (-1, 2, 0)), (14e-6, 17e-6, 60e-6)
)
WORDS = {name: CASES[name].words for name in ("fixed", "sliding")}


def heated(rise: float) -> gb.Temperature:
    """A temperature above that without strain by a rise, K."""
    return gb.Temperature(COLD + rise, reference=COLD)


@cache
def frame(name: str, rise: float) -> gb.SolidMesh:
    """The frame of two metals on its supports, warmer by a rise, K."""
    mesh = portal()
    above = mesh.points[mesh.cells[0].data].mean(axis=1)[:, 2] > HEIGHT - SIDE
    parts = {"aluminium": [np.flatnonzero(above)], "steel": [np.flatnonzero(~above)]}
    mesh = meshio.Mesh(mesh.points, mesh.cells, point_sets=mesh.point_sets, cell_sets=parts)
    return gb.SolidMesh.read(
        mesh, materials=METALS, clamp="left", unit="mm", supports=[CASES[name].support], points={"corner": "corner"},
        temperature=heated(rise),
    )  # fmt: skip


@cache
def laminate(rise: float) -> gb.SolidMesh:
    """A thick laminate, 60 × 40 × 8 mm, clamped at its wall."""
    points, cells = grid((6, 4, 2), (60.0, 40.0, 8.0))
    walls = {"wall": np.flatnonzero(np.isclose(points[:, 0], 0))}
    corner = {"corner": np.flatnonzero(np.isclose(points, (60.0, 20.0, 4.0)).all(axis=1))}
    mesh = meshio.Mesh(points, {"hexahedron20": cells}, point_sets=walls | corner)
    keys: dict[str, Any] = {"clamp": "wall", "unit": "mm", "points": {"corner": "corner"}}
    return gb.SolidMesh.read(mesh, materials=BOARD, temperature=heated(rise), **keys)


@cache
def strip(rise: float) -> gb.SolidMesh:
    """A strip of aluminium between two clamps, 300 × 20 × 2 mm."""
    points, cells = grid((30, 2, 1), (300.0, 20.0, 2.0))
    sets = {name: np.flatnonzero(np.isclose(points[:, 0], x)) for name, x in (("wall", 0.0), ("end", 300.0))}
    sets["corner"] = np.flatnonzero(np.isclose(points, (150.0, 10.0, 1.0)).all(axis=1))
    mesh = meshio.Mesh(points, {"hexahedron20": cells}, point_sets=sets)
    clamp = gb.Support("end", ["x", "y", "z"])
    keys: dict[str, Any] = {"clamp": "wall", "unit": "mm", "points": {"corner": "corner"}, "supports": [clamp]}
    return gb.SolidMesh.read(mesh, materials=METALS["aluminium"], temperature=heated(rise), **keys)


def computed(mesh: gb.SolidMesh, metals: Any, steps: str) -> str:
    """Print of CalculiX, with the corner and what a support holds as sets of nodes, all of them at zero."""
    lines = ["*NSET, NSET=CORNER", f"{mesh.stations['corner'] + 1}"]
    for place in mesh.supports:
        lines += ["*NSET, NSET=RIGHT", *(f"{node + 1}" for node in place.points)]
        for way in place.support.rigid:
            lines += ["*BOUNDARY", f"RIGHT, {'xyz'.index(way) + 1}"]
    lines += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "NALL, 0."]
    return run("\n".join([*lines, steps, ""]), "dat", Specimen(lambda: mesh, metals))


def rows() -> Iterator[Row]:
    """Displacements, reactions and stress by 1 K, and modes after 100 K."""
    for name, words in WORDS.items():
        mesh = frame(name, SMALL)
        source = f"{sum(len(block.nodes) for block in mesh.blocks)} C3D20"
        yield from by_one_kelvin(mesh, METALS, words, source)
    yield from by_one_kelvin(laminate(SMALL), {"": BOARD}, "a laminate at its wall", "48 C3D20")
    yield from modes()


def by_one_kelvin(mesh: gb.SolidMesh, metals: Any, words: str, source: str) -> Iterator[Row]:
    """Displacements of the corner, forces of support and clamp, and the largest stress."""
    sets = ["RIGHT"] * bool(mesh.supports) + ["FOOT"]
    printed = [f"*NODE PRINT, NSET={name}, TOTALS=ONLY\nRF" for name in sets]
    heat = ["*STEP", "*STATIC", "*TEMPERATURE", "NALL, 1.", "*NODE PRINT, NSET=CORNER", "U"]
    text = computed(mesh, metals, "\n".join([*heat, *printed, "*EL PRINT, ELSET=SOLID", "S", "*END STEP"]))
    model = mesh.reduced(modes=20, damping_ratio=0.0)
    rest = gb.static(model.structure)
    loads: Any = rest.loads
    moved = np.array(re.findall(r"displ.*\n\n +\d+ +(\S+) +(\S+) +(\S+)", text)[0], dtype=float)
    ours = rest.displacement[mesh.named_points.index("corner")] / SMALL
    for i, axis in enumerate("xyz"):
        if abs(moved[i]) > 0.01 * np.abs(moved).max():
            name = f"displacement {axis} of the corner"
            yield Row(f"{words}, 1 K", name, 1e6 * moved[i], 1e6 * ours[i], "µm", STATIC, source)
    mine = {"FOOT": loads.root_force[0]}
    if mesh.supports:
        mine["RIGHT"] = loads.support_force[0, 0]
        forces = {key: re.findall(rf"total force.*set {key} .*\n\n +(\S+) +(\S+) +(\S+)", text)[0] for key in mine}
        theirs = {key: np.array(value, dtype=float) for key, value in forces.items()}
        largest = max(np.abs(force).max() for force in theirs.values())
        for key, where in (("RIGHT", "support"), ("FOOT", "clamp")):
            for i, axis in enumerate("xyz"):
                if largest > 1e-6 and abs(theirs[key][i]) > 0.01 * largest:
                    values = theirs[key][i], mine[key][i] / SMALL
                    yield Row(f"{words}, 1 K", f"force {axis} of the {where}", *values, "N", STATIC, source)
    table = [
        line.split()[2:8] for line in text.partition(" stresses ")[2].splitlines() if re.match(r" +\d+ +\d+ ", line)
    ]
    stress = float(von_mises(np.array(table, dtype=float)[:, [0, 1, 2, 5, 4, 3]]).max())  # xy, xz, yz there
    pulled = (model.shapes @ rest.q)[..., None] / SMALL
    parts = [
        von_mises(part.stress(pulled, rise=np.ones(1))[..., 0]).max()
        for part in chunks(mesh.points, mesh.blocks, "stiffness")
    ]
    yield Row(f"{words}, 1 K", "largest von Mises stress", 1e-3 * stress, 1e-3 * max(parts), "kPa", STRESS, source)


def modes() -> Iterator[Row]:
    """Modes of a strip between clamps, cold and heated halfway to buckling, where they are lower by a third at most."""
    mesh, ask = strip(HOT), f"*FREQUENCY\n{COUNT}\n*END STEP"
    source = f"{len(mesh.blocks[0].nodes)} C3D20"
    heat = f"*STEP, NLGEOM\n*STATIC\n1., 1.\n*TEMPERATURE\nNALL, {HOT}\n*END STEP\n"
    metals = {"": METALS["aluminium"]}
    for rise, steps in ((0.0, f"*STEP\n{ask}"), (HOT, f"{heat}*STEP, PERTURBATION\n{ask}")):
        theirs = printed_frequencies(computed(mesh, metals, steps))
        ours = gb.modes(strip(rise).reduced(modes=20, damping_ratio=0.0).structure).frequency
        for n in range(COUNT):
            words = f"a strip between clamps, {rise:g} K"
            yield Row(words, f"mode {n + 1}", theirs[n], float(ours[n]), "Hz", HEATED if rise else CLOSE, source)
