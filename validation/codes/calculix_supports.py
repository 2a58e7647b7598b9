"""A portal frame and a bracket of steel, of hexahedra of 20 nodes, on supports in CalculiX (*BOUNDARY, *SPRING) and in
gbeam. The frame is two columns and a beam between them, clamped at one foot; the other foot is fixed, slides, or stands
on springs that its nodes share. The bracket is a sheet of 5 mm that is bent to a hat, its feet at two heights, with a
block on one side of its top; one foot is clamped, the other slides or is held along one line, a hinge. Modes,
displacements and reactions under gravity along each axis, and flights, which CalculiX integrates with all unknowns at
once, both codes by the trapezoidal rule in the same steps. Stress is that at the 27 points of the element that is
stressed most. CalculiX's flight is linear; gbeam has the stress of the load in the stiffness, by which the bracket on a
rail differs a thousandth. The forces that CalculiX prints of held nodes are those of the elements; the inertia of these
nodes themselves, by the rows of the mass matrix, is added.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

import gbeam as gb
from gbeam.constants import STANDARD_GRAVITY as G
from gbeam.results import von_mises
from gbeam.solids import mass_matrix
from validation.codes.calculix_flights import points_of
from validation.codes.calculix_frames import CASES, frame, model, reduced
from validation.codes.calculix_solid import Specimen, printed_frequencies, run, stresses
from validation.codes.calculix_specimens import STEEL
from validation.table import Row

TITLE = "CalculiX: a portal frame and a bracket on supports"
NEEDS = ("calculix-ccx", "numpy", "scipy", "meshio")
COUNT, CLOSE, STATIC, MOVED = 8, 1e-6, 2e-5, 2e-3
FAR, CHANGED, PRINTED = 2000.0, 0.1, "*NODE PRINT, NSET=RIGHT, TOTALS=ONLY\nRF\n"
SMALL = 1e-3  # of 1 g: gbeam's static answer has the stiffness of the load in it
FEET = "RIGHT", "FOOT"
FIRST = 900_000  # number of the first element that is no solid
RISE = gb.SmoothStep(level=400.0, duration=0.003)


class Flown(NamedTuple):
    """A flight of a case: its accelerations along axes, m/s², over a time in steps, s."""

    words: str
    along: dict[str, gb.Profile]
    duration: float
    step: float


FLIGHTS = {
    "sliding": Flown("pulled at 400 m/s² along x and z in 3 ms", {"x": RISE, "z": RISE}, 0.006, 2e-5),
    "bracket on a rail": Flown(
        "flight along x, y and z",
        {
            "x": gb.SmoothStep(level=150.0, duration=0.004),
            "y": gb.trapezoid(100.0, jerk=5e4, start=0.001, hold=0.003),
            "z": gb.SmoothStep(level=-200.0, duration=0.006),
        },
        0.01,
        4e-5,
    ),
}
FLIGHTS["bracket on a hinge"] = FLIGHTS["bracket on a rail"]


def held(name: str) -> str:
    """Lines of CalculiX for what holds the other foot."""
    (place,), support = frame(name).supports, CASES[name].support
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
    """Modes, rest and flights."""
    for name, case in CASES.items():
        words = case.words
        source = source_of(name)
        theirs = printed_frequencies(computed(name, f"*STEP\n*FREQUENCY\n{COUNT}\n*END STEP\n"))
        ours = gb.modes(model(name)).frequency
        for n in range(COUNT):
            yield Row(words, f"mode {n + 1}", theirs[n], float(ours[n]), "Hz", CLOSE, source)
        for axis, load in zip("xyz", np.eye(3), strict=True):
            yield from at_rest(name, f"{words}, 1 g along {axis}", load, source)
    yield from far("fixed")
    for name in FLIGHTS:
        yield from flown(name)


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
            known = where == "clamp" or axis not in CASES[name].support.stiffness
            if known and abs(held_by[i]) > 0.01 * largest:
                yield Row(words, f"force {axis} of the {where}", held_by[i], mine[i], "N", STATIC, source)


def source_of(name: str) -> str:
    """Elements of a case."""
    return f"{sum(len(block.nodes) for block in frame(name).blocks)} C3D20"


def far(name: str) -> Iterator[Row]:
    """Change of a reaction by the deformation, under so many g along x that it is not small."""
    steps = f"*STEP, NLGEOM\n*STATIC\n1., 1.\n*DLOAD\nEALL, GRAV, {{}}, 1., 0., 0.\n{PRINTED}*END STEP\n"
    load, changes = np.array([1.0, 0.0, 0.0]), []
    for times in (SMALL, FAR):
        theirs = reaction(name, computed(name, steps.format(times * G)), "RIGHT", -times * G * load)[0]
        loads: Any = gb.static(model(name), acceleration=tuple(-times * G * load)).loads
        changes.append(np.array([theirs[0], loads.support_force[0, 0, 0]]) / times)
    theirs, mine = FAR * (changes[1] - changes[0])
    words, source = f"{CASES[name].words}, {FAR:g} g along x", source_of(name)
    yield Row(words, "change of the force x of the support by the deformation", theirs, mine, "N", CHANGED, source)


def simulated(structure: gb.Structure, flight: Flown) -> gb.Response:
    """Response to a flight, by the trapezoidal rule."""
    motion: Any = gb.Flight(**flight.along)
    return gb.simulate(
        structure, motion, duration=flight.duration, step=flight.step, initial="undeformed", integrator="newmark",
        estimate=False,
    )  # fmt: skip


def most_stressed(solid: gb.SolidModel, response: gb.Response) -> int:
    """Element that is stressed most when the corner is farthest from its place."""
    corner = response.body.displacement[:, solid.mesh.named_points.index("corner")]
    farthest = int(np.linalg.norm(corner, axis=1).argmax())
    return int(points_of(solid, response.q[[farthest]]).max(axis=(1, 2)).argmax())


def flown(name: str) -> Iterator[Row]:
    """A flight: the corner, both feet and the stress over time."""
    flight, place = FLIGHTS[name], frame(name).named_points.index("corner")
    time = np.linspace(0.0, flight.duration, round(flight.duration / flight.step) + 1)
    ours = simulated(model(name), flight)
    most = most_stressed(reduced(name), ours)
    felt = np.stack([np.asarray(flight.along[way](time)) if way in flight.along else 0 * time for way in "xyz"], axis=1)
    lines = ["*ELSET, ELSET=GAUGE", f"{most + 1}"]
    for way, history in zip("xyz", felt.T, strict=True):
        lines += [f"*AMPLITUDE, NAME=A{way}", *(f"{t:.8g}, {a:.10g}" for t, a in zip(time, history, strict=True))]
    lines += ["*STEP, INC=100000", "*DYNAMIC, DIRECT, ALPHA=0", f"{flight.step:.8g}, {flight.duration:.8g}"]
    for way, axis in zip("xyz", np.eye(3), strict=True):
        lines += [f"*DLOAD, AMPLITUDE=A{way}", "EALL, GRAV, 1., {}, {}, {}".format(*-axis)]
    lines += ["*NODE PRINT, NSET=CORNER, FREQUENCY=1", "U", "*EL PRINT, ELSET=GAUGE, FREQUENCY=1", "S"]
    lines += [line for feet in FEET for line in (f"*NODE PRINT, NSET={feet}, TOTALS=ONLY, FREQUENCY=1", "RF")]
    text = computed(name, "\n".join([*lines, "*END STEP", ""]))
    moved = np.array(re.findall(r"displ.*\n\n +\d+ +(\S+) +(\S+) +(\S+)", text), dtype=float)
    loads: Any = ours.body.loads
    compared: list[tuple[str, np.ndarray, np.ndarray, str]] = [
        ("displacement {} of the corner", 1e6 * moved, 1e6 * ours.body.displacement[1:, place], "µm"),
        ("force {} of the support", reaction(name, text, "RIGHT", felt[1:]), loads.support_force[1:, 0], "N"),
        ("force {} of the clamp", reaction(name, text, "FOOT", felt[1:]), loads.root_force[1:], "N"),
    ]
    case, source = f"{CASES[name].words}, {flight.words}", source_of(name)
    histories = [
        (words.format(axis), one, other, unit)
        for words, theirs, mine, unit in compared
        for axis, one, other in zip("xyz", theirs.T, mine.T, strict=True)
        if np.abs(one).max() > 0.05 * np.abs(theirs).max()
    ]
    theirs = von_mises(stresses(text)).max(axis=1)
    mine = points_of(reduced(name), ours.q[1:], most)[0].max(axis=0)
    for words, one, other, unit in [*histories, ("von Mises stress", 1e-6 * theirs, 1e-6 * mine, "MPa")]:
        at = int(np.abs(one).argmax())
        yield Row(case, f"{words} at its largest", one[at], other[at], unit, MOVED, source)
        away = 100 * np.abs(other - one).max() / np.abs(one).max()
        yield Row(case, f"{words}, largest difference over its size", 0.0, away, "%", 100 * MOVED, source)
