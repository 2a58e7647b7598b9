"""A portal frame of hexahedra of 20 nodes on supports in CalculiX (*BOUNDARY, *SPRING) and in gbeam: two columns of
steel and a beam between them, clamped at one foot. The other foot is fixed, slides, or stands on springs that its nodes
share. Modes, displacements and reactions under gravity along each axis, and a pull in flight, which CalculiX integrates
with all unknowns at once. The forces that it prints of held nodes are those of the elements; the inertia of these nodes
themselves, by the rows of the mass matrix, is added.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import meshio
import numpy as np

import gbeam as gb
from gbeam.constants import STANDARD_GRAVITY as G
from gbeam.solids import mass_matrix
from validation.codes.calculix_solid import Specimen, printed_frequencies, run
from validation.codes.calculix_specimens import STEEL, grid
from validation.table import Row

TITLE = "CalculiX: a portal frame on supports"
NEEDS = ("calculix-ccx", "numpy", "scipy", "meshio")
COUNT, CLOSE, STATIC, MOVED = 8, 1e-6, 2e-5, 2e-3
SPAN, HEIGHT, SIDE = 200.0, 120.0, 20.0  # mm
FAR, CHANGED, PRINTED = 2000.0, 0.1, "*NODE PRINT, NSET=RIGHT, TOTALS=ONLY\nRF\n"
SMALL = 1e-3  # of 1 g: gbeam's static answer has the stiffness of the load in it
SPRINGS = {"x": 4e6, "z": 9e6}  # N/m
FIRST = 900_000  # number of the first element that is no solid
DURATION, SAMPLE = 0.006, 2e-5  # s
RISE = gb.SmoothStep(level=400.0, duration=0.003)
WORDS = {
    "fixed": "the other foot fixed",
    "sliding": "the other foot slides along x",
    "springs": "the other foot on springs along x and z, held along y",
}
SUPPORTS = {
    "fixed": gb.Support("right", ["x", "y", "z"]),
    "sliding": gb.Support("right", ["y", "z"]),
    "springs": gb.Support("right", ["y"], stiffness=SPRINGS),
}


@cache
def portal() -> meshio.Mesh:
    """Mesh of the frame in the plane of x and z, its feet on z = 0, mm."""
    counts = round(SPAN / 10), 2, round(HEIGHT / 10)
    points, cells = grid(counts, (SPAN, SIDE, HEIGHT))
    points[:, 2] += HEIGHT / 2
    middle = points[cells].mean(axis=1)
    inside = (np.abs(middle[:, 0] - SPAN / 2) < SPAN / 2 - SIDE) & (middle[:, 2] < HEIGHT - SIDE)
    used, nodes = np.unique(cells[~inside], return_inverse=True)
    points = points[used]
    below = np.isclose(points[:, 2], 0)
    sets = {"left": np.flatnonzero(below & (points[:, 0] < SPAN / 2))}
    sets["right"] = np.flatnonzero(below & (points[:, 0] > SPAN / 2))
    sets["corner"] = np.flatnonzero(np.isclose(points, (SPAN, SIDE / 2, HEIGHT)).all(axis=1))
    return meshio.Mesh(points, {"hexahedron20": nodes.reshape(-1, 20)}, point_sets=sets)


@cache
def frame(name: str) -> gb.SolidMesh:
    """The frame on its supports."""
    return gb.SolidMesh.read(
        portal(), materials=STEEL, clamp="left", unit="mm", supports=[SUPPORTS[name]], points={"corner": "corner"}
    )


@cache
def model(name: str) -> gb.Structure:
    """The frame in twenty modes and its static shapes."""
    return frame(name).reduced(modes=20, damping_ratio=0.0).structure


def held(name: str) -> str:
    """Lines of CalculiX for what holds the other foot."""
    (place,), support = frame(name).supports, SUPPORTS[name]
    corner = frame(name).stations["corner"] + 1
    lines = ["*NSET, NSET=RIGHT", *(f"{node + 1}" for node in place.points), "*NSET, NSET=CORNER", f"{corner}"]
    for way in support.rigid:
        lines += ["*BOUNDARY", f"RIGHT, {'xyz'.index(way) + 1}"]
    for way, stiffness in support.stiffness.items():
        lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=S{way}")
        first = FIRST + 10_000 * "xyz".index(way)
        lines += [f"{first + i}, {node + 1}" for i, node in enumerate(place.points)]
        lines += [f"*SPRING, ELSET=S{way}", f"{'xyz'.index(way) + 1}", f"{stiffness / len(place.points):.12g}"]
    return "\n".join([*lines, ""])


def computed(name: str, steps: str) -> str:
    """Print of CalculiX."""
    return run(held(name) + steps, "dat", Specimen(lambda: frame(name), {"": STEEL}))


def reaction(name: str, text: str, where: str, acceleration: np.ndarray) -> np.ndarray:
    """Total forces (t, 3) that hold a set of nodes, N, which accelerate by (t, 3), m/s²."""
    printed = re.findall(rf"total force.*set {where} .*\n\n +(\S+) +(\S+) +(\S+)", text)
    return np.array(printed, dtype=float) + weight(name, where) * acceleration


def weight(name: str, where: str) -> float:
    """Mass of the held nodes' rows of the mass matrix, kg."""
    mesh = frame(name)
    nodes = mesh.supports[0].points if where == "RIGHT" else np.flatnonzero(mesh.clamped)
    return float(np.asarray(mass_matrix(mesh.points, mesh.blocks).sum(axis=1))[nodes].sum())


def rows() -> Iterator[Row]:
    """Modes, rest and a pull."""
    for name, words in WORDS.items():
        count = sum(len(block.nodes) for block in frame(name).blocks)
        source = f"{count} C3D20"
        theirs = printed_frequencies(computed(name, f"*STEP\n*FREQUENCY\n{COUNT}\n*END STEP\n"))
        ours = gb.modes(model(name)).frequency
        for n in range(COUNT):
            yield Row(words, f"mode {n + 1}", theirs[n], float(ours[n]), "Hz", CLOSE, source)
        for axis, load in zip("xyz", np.eye(3), strict=True):
            yield from at_rest(name, f"{words}, 1 g along {axis}", load, source)
    yield from far("fixed", source)
    yield from pulled("sliding", source)


def at_rest(name: str, words: str, load: np.ndarray, source: str) -> Iterator[Row]:
    """Displacement of a corner, and reactions, under gravity."""
    force = f"*DLOAD\nEALL, GRAV, {G}, {load[0]}, {load[1]}, {load[2]}\n"
    printed = "*NODE PRINT, NSET=CORNER\nU\n*NODE PRINT, NSET=RIGHT, TOTALS=ONLY\nRF\n"
    text = computed(name, f"*STEP\n*STATIC\n{force}{printed}*NODE PRINT, NSET=FOOT, TOTALS=ONLY\nRF\n*END STEP\n")
    rest = gb.static(model(name), acceleration=tuple(-SMALL * G * load))
    assert rest.loads is not None and rest.loads.support_force is not None
    moved = np.array(re.findall(r"displ.*\n\n +\d+ +(\S+) +(\S+) +(\S+)", text)[0], dtype=float)
    largest = np.abs(reaction(name, text, "FOOT", -G * load)).max()
    reactions = {"support": (reaction(name, text, "RIGHT", -G * load)[0], rest.loads.support_force[0, 0] / SMALL)}
    reactions["clamp"] = (reaction(name, text, "FOOT", -G * load)[0], rest.loads.root_force[0] / SMALL)
    for i, axis in enumerate("xyz"):
        if abs(moved[i]) > 0.01 * np.abs(moved).max():
            at = rest.displacement[frame(name).named_points.index("corner"), i]
            theirs, mine = 1e6 * moved[i], 1e6 * at / SMALL
            yield Row(words, f"displacement {axis} of the corner", theirs, mine, "µm", STATIC, source)
        for where, (held_by, mine) in reactions.items():
            known = where == "clamp" or axis not in SUPPORTS[name].stiffness
            if known and abs(held_by[i]) > 0.01 * largest:
                yield Row(words, f"force {axis} of the {where}", held_by[i], mine[i], "N", STATIC, source)


def far(name: str, source: str) -> Iterator[Row]:
    """Change of a reaction by the deformation, under so many g along x that it is not small."""
    steps = f"*STEP, NLGEOM\n*STATIC\n1., 1.\n*DLOAD\nEALL, GRAV, {{}}, 1., 0., 0.\n{PRINTED}*END STEP\n"
    load, changes = np.array([1.0, 0.0, 0.0]), []
    for times in (SMALL, FAR):
        theirs = reaction(name, computed(name, steps.format(times * G)), "RIGHT", -times * G * load)[0]
        loads: Any = gb.static(model(name), acceleration=tuple(-times * G * load)).loads
        changes.append(np.array([theirs[0], loads.support_force[0, 0, 0]]) / times)
    theirs, mine = FAR * (changes[1] - changes[0])
    words = f"{WORDS[name]}, {FAR:g} g along x"
    yield Row(words, "change of the force x of the support by the deformation", theirs, mine, "N", CHANGED, source)


def pulled(name: str, source: str) -> Iterator[Row]:
    """A pull along x and z: the corner and the support over time."""
    time = np.linspace(0.0, DURATION, round(DURATION / SAMPLE) + 1)
    pairs = [f"{t:.8g}, {value:.10g}" for t, value in zip(time, np.asarray(RISE(time)), strict=True)]
    steps = "\n".join([
        "*AMPLITUDE, NAME=PULSE", *pairs, "*STEP, INC=100000", "*DYNAMIC, DIRECT, ALPHA=0",
        f"{SAMPLE:.8g}, {DURATION:.8g}", "*DLOAD, AMPLITUDE=PULSE", "EALL, GRAV, 1.4142135623730951, -1., 0., -1.",
        "*NODE PRINT, NSET=CORNER, FREQUENCY=1", "U", "*NODE PRINT, NSET=RIGHT, TOTALS=ONLY, FREQUENCY=1", "RF",
        "*END STEP", "",
    ])  # fmt: skip
    text = computed(name, steps)
    moved = np.array(re.findall(r"displ.*\n\n +\d+ +(\S+) +(\S+) +(\S+)", text), dtype=float)
    felt = np.asarray(RISE(time))[1:, None] * (1, 0, 1)
    forces = reaction(name, text, "RIGHT", felt)
    flight = gb.Flight(x=RISE, z=RISE)
    ours = gb.simulate(
        model(name), flight, duration=DURATION, step=SAMPLE, initial="undeformed", integrator="gauss", estimate=False
    )
    loads: Any = ours.body.loads
    answers = ours.body.displacement[1:, frame(name).named_points.index("corner")], loads.support_force[1:, 0]
    case = "the other foot slides along x, pulled at 400 m/s² along x and z in 3 ms"
    for quantity, theirs, mine, axes, unit in (
        ("displacement {} of the corner", 1e6 * moved, 1e6 * answers[0], "xz", "µm"),
        ("force {} of the support", forces, answers[1], "z", "N"),
    ):
        for axis in axes:
            i = "xyz".index(axis)
            most = int(np.abs(theirs[:, i]).argmax())
            words = quantity.format(axis)
            yield Row(case, f"{words} at its largest", theirs[most, i], mine[most, i], unit, MOVED, source)
            away = 100 * np.abs(mine[:, i] - theirs[:, i]).max() / np.abs(theirs[:, i]).max()
            yield Row(case, f"{words}, largest difference over its size", 0.0, away, "%", 100 * MOVED, source)
