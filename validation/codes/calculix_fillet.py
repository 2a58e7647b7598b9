"""Stress in the fillets of a shouldered steel bar, in CalculiX and in gbeam on the same mesh of hexahedra of 20 nodes,
the bar clamped at its wide end: under 1 g across, which bends it, in a slow spin about its clamp, which pulls it, and
in a fast one, CalculiX's by large deformations. Both solve the same equations.

In a fillet the stress is read on the surface, at nodes, where elements have no points of integration. CalculiX fits
the shape functions of the element to the stress at its 27 points, takes their values at the nodes, and averages over
the elements that share a node. gbeam fits a trilinear field to the eight points of the rule of a degree less
(Barlow's), and averages too. Between the two lies what the mesh does not resolve. With CalculiX's fit the stress of
gbeam's displacements is CalculiX's to its digits; with gbeam's own it is within 1 % where the mesh is fine. In the fast
spin CalculiX's stress is that per deformed area, after strains of 0.1 %, and gbeam's is of first order in the load.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache, partial
from itertools import product

import numpy as np

import gbeam as gb
from gbeam.constants import STANDARD_GRAVITY as G
from gbeam.results import von_mises
from gbeam.solids import KINDS, NodalStress, chunks, reference, shape_functions
from validation.codes.calculix_solid import SMALL, Specimen, run
from validation.codes.calculix_specimens import STEEL, grid, held
from validation.table import Row

TITLE = "CalculiX: stress in a fillet of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy", "scikit-fem", "meshio")
WIDE, NARROW, RADIUS, SHEET, LENGTHS = 15.0, 10.0, 5.0, 3.0, (30.0, 60.0)  # mm: halves of widths; of the two parts
COARSE, FINE = (6, 10, 10, 6, 2), (9, 15, 15, 9, 3)  # along wide part, fillet, narrow part, half across, through
NODES, SAME, STRAINED = 1e-2, 1e-4, 3e-3
SLOW, FAST = 1.0, 2000.0  # rad/s
ROUGH = "a coarse mesh, with another fit to the nodes: see above"


@cache
def bar(cells: tuple[int, ...]) -> gb.SolidMesh:
    """The bar along x, from its clamp: lines across go from the axis to its edge, evenly along the edge."""
    wide, arc, narrow, half, through = cells
    points, hexahedra = grid((wide + arc + narrow, 2 * half, through), (wide + arc + narrow, 2.0, SHEET))
    s, t, z = points.T
    first, last = LENGTHS
    turn = np.clip((s - wide) / arc, 0, 1)
    angle = np.pi / 2 * turn
    before, after = np.minimum(s / wide, 1), np.clip((s - wide - arc) / narrow, 0, 1)
    edge = np.where(s <= wide, first * before, first + RADIUS * (1 - np.cos(angle)) + (last - RADIUS) * after)
    height = np.where(s <= wide, WIDE, WIDE - RADIUS * np.sin(angle))
    # On the axis the fillet's lines are spread, so that its corner is shared by two cells.
    spread = (first - WIDE / 2) * before + (RADIUS + WIDE / 2) * turn + (last - RADIUS) * after
    across = np.sign(t) * (1 - (1 - np.abs(t)) ** 1.5)  # finer towards the edge
    share = np.abs(across)
    return held(np.stack([spread + share * (edge - spread), across * height, z], axis=1), hexahedra, s == 0, STEEL)


def nodal(load: str, specimen: Specimen, *, large: bool = False) -> np.ndarray:
    """CalculiX's stresses xx, yy, zz, yz, xz, xy (k, 6) at the nodes, Pa, averaged over elements."""
    step = "*STEP, NLGEOM\n*STATIC\n1., 1." if large else "*STEP\n*STATIC"
    text = run(f"{step}\n*DLOAD\n{load}\n*EL FILE\nS\n*END STEP\n", "frd", specimen)
    table = re.split(r" -4  STRESS.*\n(?: -5 .*\n)+", text)[-1].partition("\n -3")[0]
    rows = [[line[13 + 12 * k : 25 + 12 * k] for k in range(6)] for line in table.splitlines() if line[:3] == " -1"]
    return np.array(rows, dtype=float)[:, [0, 1, 2, 4, 5, 3]]  # xx, yy, zz, xy, yz, zx there


def fitted(model: gb.SolidModel, q: np.ndarray) -> np.ndarray:
    """Stresses (k, 6) at the nodes at coordinates (n,), as CalculiX takes them from the points of the stiffness."""
    mesh, moved = model.mesh, (model.shapes @ q)[..., None]
    total, shared = np.zeros((len(mesh.points), 6)), np.zeros(len(mesh.points))
    powers = np.array([each for each in product(range(3), repeat=3) if each.count(2) <= 1])  # of serendipity
    places = [shape_functions("hexahedron20", KINDS["hexahedron20"].stiffness)[0], reference("hexahedron20")]
    points, nodes = (np.prod(each[:, None] ** powers, axis=-1) for each in places)
    for part in chunks(mesh.points, mesh.blocks, "stiffness"):
        np.add.at(total, part.nodes, nodes @ np.linalg.pinv(points) @ part.stress(moved)[..., 0])
        np.add.at(shared, part.nodes, 1)
    return total / shared[:, None]


def rows() -> Iterator[Row]:
    """At the nodes of the fillets."""
    for cells in (COARSE, FINE):
        mesh, specimen = bar(cells), Specimen(partial(bar, cells), {"": STEEL})
        ours = mesh.reduced(modes=8, damping_ratio=0.0)
        recovery = ours.structure.recovery
        assert isinstance(recovery, NodalStress)
        source = f"{sum(len(block.nodes) for block in mesh.blocks)} C3D20"
        x, y, _ = mesh.points.T
        centre = 1e-3 * (LENGTHS[0] + RADIUS), 1e-3 * (NARROW + RADIUS)
        fillet = np.abs(np.hypot(x - centre[0], np.abs(y) - centre[1]) - 1e-3 * RADIUS) < 1e-9
        spins = [(f"spun at {rate:g} rad/s", f"CENTRIF, {rate**2}, 0., 0., 0., 0., 0., 1.",
                  gb.static(ours.structure, gb.Hub(radius=0.0, rate=rate)), 1.0) for rate in (SLOW, FAST)]  # fmt: skip
        bent = gb.static(ours.structure, acceleration=(0.0, -SMALL * G, 0.0))
        for case, load, rest, share in [("1 g across", f"GRAV, {G}, 0., 1., 0.", bent, SMALL), *spins]:
            large = case == spins[-1][0]
            if large and cells == COARSE:
                continue
            theirs = von_mises(nodal(f"EALL, {load}", specimen, large=large))[fillet]
            ours_alone, same = (
                von_mises(each)[fillet] / share for each in (recovery.table @ rest.q, fitted(ours, np.asarray(rest.q)))
            )
            largest = "largest von Mises stress in the fillets"
            unit, scale = ("Pa", 1.0) if theirs.max() < 1e5 else ("MPa", 1e-6)
            rough, close = ROUGH if cells == COARSE else "", STRAINED if large else SAME
            yield Row(case, largest, scale * theirs.max(), scale * ours_alone.max(), unit, NODES, source, rough)
            yield Row(case, f"{largest}, fitted as CalculiX does", scale * theirs.max(), scale * same.max(), unit,
                      close, source)  # fmt: skip
            away = 100 * np.abs(same - theirs).max() / theirs.max()
            yield Row(case, "largest difference at any node of the fillets, fitted so, over that", 0.0, away, "%",
                      100 * close, source)  # fmt: skip
