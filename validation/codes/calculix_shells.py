"""A plate and a bracket of shells in CalculiX and in gbeam, of steel, 2 mm thick: 200 by 100 mm, clamped along its
short edge, and three plates of 60, 80 and 40 mm along, 60 mm across, that meet at right angles. Displacements of the
middle under 1 g along every axis, ten modes at rest, and ten in a spin about an axis along z, 0.1 m before the clamp.
Then a board like the plate, of woven glass and epoxy whose warp lies 30 degrees off its length: ten modes at rest.

CalculiX makes of a shell a layer of solid elements, and ties its points to a knot, a rigid body of the whole thickness,
where rotations are held or plates meet at an angle. There the thickness does not change, as it would where a plate
bends: the elements beside are too stiff, and frequencies differ from their limit in proportion to the size of the
elements. gbeam assumes plane stress, and is near its limit with the first mesh. So the reference is CalculiX's limit,
twice what 5 mm give less what 10 mm give, beside gbeam's answer with 10 mm; the remark says how far both are apart with
elements of one size. CalculiX has no shear factor, gbeam Reissner's 5/6: the third number is what gbeam's answer would
change by without, and it leaves little else.

Of four nodes S4 is beside gbeam's with 5 mm, and both are compared with the limit of S8R. S4R has no row: its one point
does not resist hourglasses in this version of CalculiX, and the plate's first mode is at 13 Hz with 5 mm.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from unittest.mock import patch

import meshio
import numpy as np

import gbeam as gb
from gbeam.constants import STANDARD_GRAVITY as G
from gbeam.solids import elements
from validation.codes.calculix_solid import SMALL, Specimen, frequencies, static
from validation.codes.calculix_specimens import STEEL, grid
from validation.table import Row

TITLE = "CalculiX: a plate and a bracket of shells"
NEEDS = ("calculix-ccx", "numpy", "scipy", "scikit-fem", "meshio")
CLOSE, COUNT = 2e-3, 10
THICKNESS, RADIUS = 2e-3, 0.1  # m
# Woven glass and epoxy.
LAMINATE = gb.Orthotropic(
    1900.0,
    (22e9, 12e9, 8e9),
    (0.15, 0.3, 0.3),
    (4e9, 2.5e9, 2.5e9),
    ((np.cos(np.pi / 6), 0.5, 0.0), (-0.5, np.cos(np.pi / 6), 0.0)),
)
SIZES = 10.0, 5.0  # mm, of elements
KINDS = {"S8R": "quad8", "S4": "quad"}
# Of a profile: lengths along it and places along x and z of its folds, mm, width, mm, and rate of a spin, rad/s.
CASES = {
    "plate": (((0, 200), (0, 200), (0, 0)), 100.0, 60.0),
    "board": (((0, 200), (0, 200), (0, 0)), 100.0, 0.0),
    "bracket": (((0, 60, 140, 180), (0, 60, 60, 100), (0, 0, 80, 80)), 60.0, 40.0),
}


@cache
def shell(name: str, size: float, element: str = "S8R") -> gb.SolidMesh:
    """The plate or the bracket of elements of a size."""
    (along, x, z), width, _ = CASES[name]
    points, cells = grid((round(along[-1] / size), round(width / size), 1), (along[-1], width, 1.0))
    below = cells[:, [0, 1, 2, 3, 8, 9, 10, 11]][:, : 4 if element == "S4" else 8]
    used, nodes = np.unique(below, return_inverse=True)
    s, y, _ = points[used].T
    places = np.stack([np.interp(s, along, x), y, np.interp(s, along, z)], axis=1)
    mesh = meshio.Mesh(
        places, {KINDS[element]: nodes.reshape(below.shape)}, point_sets={"wall": np.flatnonzero(s == 0)}
    )
    tip = {"tip": 1e-3 * np.array([x[-1], width / 2, z[-1]])}
    return gb.SolidMesh.read(mesh, materials=material(name), clamp="wall", unit="mm", thickness=THICKNESS, points=tip)


def material(name: str) -> gb.Material | gb.Orthotropic:
    """Of one of them."""
    return LAMINATE if name == "board" else STEEL


def tip(mesh: gb.SolidMesh) -> int:
    """Node in the file at the tip."""
    return int(mesh.numbers[mesh.stations["tip"]])


def specimen(name: str, size: float, element: str = "S8R") -> Specimen:
    """One of them in CalculiX."""
    return Specimen(lambda: shell(name, size, element), {"": material(name)}, element, THICKNESS)


@cache
def model(name: str, size: float, element: str = "S8R", factor: float = elements.FACTOR) -> gb.SolidModel:
    """One of them in sixteen modes and its static shapes, with a factor of transverse shear."""
    with patch.object(elements, "FACTOR", factor):
        return shell(name, size, element).reduced(modes=16, damping_ratio=0.0)


def modes(rate: float, of: gb.SolidModel) -> np.ndarray:
    """Ten frequencies in a spin, without Coriolis' force, Hz."""
    hub = gb.Hub(radius=RADIUS, rate=rate)
    return np.asarray(gb.modes(of.structure, hub, gyroscopic=False).frequency[:COUNT])


def moved(way: int, of: gb.SolidModel) -> np.ndarray:
    """Displacement (3,) of the middle at the tip under 1 g along an axis, µm."""
    rest = gb.static(of.structure, acceleration=tuple(-SMALL * G * np.eye(3)[way])).q / SMALL
    return np.asarray(1e6 * of.shapes[of.mesh.numbers == tip(of.mesh)].mean(axis=0) @ rest)


def rows() -> Iterator[Row]:
    """Under accelerations, at rest and spinning; of four nodes at rest."""
    numbered = [f"mode {n + 1}" for n in range(COUNT)]
    for name, (_, _, rate) in CASES.items():
        for way, axis in enumerate("xyz" if rate else ""):
            load = f"EALL, GRAV, {G}, {', '.join(map(str, np.eye(3)[way]))}"
            theirs = [1e6 * static(load, specimen(name, size))[0][tip(shell(name, size)) - 1] for size in SIZES]
            words = [f"displacement {each} of the tip" for each in "xyz"]
            yield from limits(f"{name}, 1 g along {axis}", words, "µm", theirs, [moved(way, e) for e in models(name)])
        for spin in dict.fromkeys((rate, 0.0)):
            theirs = [frequencies(spin, specimen(name, size), RADIUS) for size in SIZES]
            case = f"{name}, {spin:g} rad/s" if spin else f"{name}, at rest"
            yield from limits(case, numbered, "Hz", theirs, [modes(spin, each) for each in models(name)])
        if not rate:
            continue
        limit, size = 2 * theirs[1] - theirs[0], SIZES[1]
        one, other = frequencies(0.0, specimen(name, size, "S4")), modes(0.0, model(name, size, "S4"))
        for n, words in enumerate(numbered):
            away = [f"{100 * (each[n] / limit[n] - 1):+.1g} %" for each in (one, other)]
            remark = f"{away[0]} and {away[1]} from the limit of S8R"
            yield Row(f"{name}, at rest, four nodes", words, one[n], other[n], "Hz", CLOSE, "S4, 5 mm", remark)


def models(name: str) -> tuple[gb.SolidModel, ...]:
    """gbeam's elements of both sizes, and those of the first with even shear."""
    return *(model(name, size) for size in SIZES), model(name, SIZES[0], factor=1.0)


def limits(case: str, words: list[str], unit: str, theirs: list[np.ndarray], ours: list[np.ndarray]) -> Iterator[Row]:
    """Rows of quantities by elements of both sizes, and gbeam's with even shear."""
    coarse, fine, even = ours
    for n, quantity in enumerate(words):
        limit = 2 * theirs[1][n] - theirs[0][n]
        if abs(limit) < 0.01 * np.abs(theirs[1]).max():
            continue
        away = [f"{100 * (mine[n] / other[n] - 1):+.2g} %" for mine, other in zip((coarse, fine), theirs, strict=True)]
        remark = f"10 mm {away[0]}, 5 mm {away[1]}; even shear {100 * (even[n] / coarse[n] - 1):+.1g} %"
        yield Row(case, quantity, limit, coarse[n], unit, CLOSE, "S8R, limit of 10 and 5 mm", remark)
