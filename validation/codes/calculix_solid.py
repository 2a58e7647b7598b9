"""A solid in CalculiX and in gbeam on the same mesh: the bracket of examples/bracket.py, hexahedra of 20 nodes with 27
points each, C3D20 there. Displacements under a small acceleration, the largest von Mises stress at those points, ten
modes at rest, a pulse in flight and a spin-up over time, and what a spin changes in the modes: CalculiX's prestressed
modes come after a static step with large deformations, gbeam's coefficients are of first order in the load. What a spin
changes says more than the frequency itself: with the static stress alone, without the turning of what is bent, the
second would be a fifth and the fourth of the wrong sign. Over time CalculiX sums 120 modes exactly, without the stress
of the load in the stiffness and without Coriolis forces.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import gbeam as gb
from gbeam.constants import STANDARD_GRAVITY as G
from gbeam.results import von_mises
from gbeam.solids import KINDS, chunks, mass_matrix
from validation.table import Row

sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))
import bracket as example

TITLE = "CalculiX: a bracket of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy", "scikit-fem", "meshio")
STATIC, MODES, STRESS, SHIFT, MOVED = 1e-4, 1e-5, 1e-4, 2e-2, 1e-2
RATE, RADIUS = 10.0, 0.3  # rad/s about z, m from the axis to the root
COUNT, SHIFTED = 10, 6
SMALL = 1e-3  # of 1 g: gbeam's static answer has the stiffness of the load in it
DAMPING, DURATION, SAMPLE, DYNAMIC = 0.02, 0.12, 1e-4, 120  # s, s, and modes of CalculiX's modal dynamics
PULSE = gb.trapezoid(20.0, jerk=2000.0, start=0.005, hold=0.03)
SPIN_UP = gb.SmoothStep(level=5.0, duration=0.05)


@cache
def solid() -> gb.SolidMesh:
    """The bracket with its camera."""
    return gb.SolidMesh.read(example.mesh(), materials=example.MATERIALS, clamp="screwed", unit="mm")


class Specimen(NamedTuple):
    """A mesh, its materials by name, CalculiX's elements, and the thickness of those that are shells, m."""

    mesh: Callable[[], gb.SolidMesh]
    materials: Mapping[str, gb.Material]
    element: str = "C3D20"
    thickness: float | None = None


BRACKET = Specimen(solid, example.MATERIALS)


@cache
def model() -> gb.SolidModel:
    """The bracket in twenty modes and its static shapes."""
    return solid().reduced(modes=20, damping_ratio=0.0)


def rows() -> Iterator[Row]:
    """Under accelerations, at rest and spinning."""
    mesh, ours = solid(), model()
    source = f"{sum(len(block.nodes) for block in mesh.blocks)} C3D20"
    tip = next(iter(mesh.stations.values()))
    for way, load in zip("xyz", np.eye(3), strict=True):
        moved, stress = static(f"EALL, GRAV, {G}, {load[0]}, {load[1]}, {load[2]}")
        rest = gb.static(ours.structure, acceleration=tuple(-SMALL * G * load))
        for i, axis in enumerate("xyz"):
            if abs(moved[tip, i]) > 0.01 * np.abs(moved[tip]).max():
                name = f"displacement {axis} of the camera's edge"
                yield Row(
                    f"1 g along {way}", name, 1e6 * moved[tip, i], 1e6 * rest.tip[i] / SMALL, "µm", STATIC, source
                )
        pulled = (ours.shapes @ rest.q)[..., None] / SMALL
        parts = [von_mises(part.stress(pulled)[..., 0]).max() for part in chunks(mesh.points, mesh.blocks, "stiffness")]
        yield Row(
            f"1 g along {way}", "largest von Mises stress", 1e-6 * stress, 1e-6 * max(parts), "MPa", STRESS, source
        )
    still = frequencies(0.0), gb.modes(ours.structure, gb.Hub(radius=RADIUS, rate=0.0)).frequency
    for n in range(COUNT):
        yield Row("at rest", f"mode {n + 1}", still[0][n], still[1][n], "Hz", MODES, source)
    yield from histories(tip, source)
    spun = frequencies(RATE), gb.modes(ours.structure, gb.Hub(radius=RADIUS, rate=RATE), gyroscopic=False).frequency
    for n in range(SHIFTED):
        theirs, mine = (1e3 * (spinning[n] - resting[n]) for spinning, resting in zip(spun, still, strict=True))
        yield Row(f"{RATE:g} rad/s", f"change of mode {n + 1}", theirs, mine, "mHz", SHIFT, source)


def histories(tip: int, source: str) -> Iterator[Row]:
    """A pulse and a spin-up over time."""
    bracket = solid().reduced(modes=40, damping_ratio=DAMPING).structure
    time = np.linspace(0.0, DURATION, round(DURATION / SAMPLE) + 1)
    pushed = np.asarray(PULSE(time))
    rate, growth = (np.asarray(each) for each in SPIN_UP.derivatives(time))
    # Inertial loads -a, ω²r outwards and -α × r, the last on nodes by the mass matrix.
    mass = mass_matrix(solid().points, solid().blocks)
    x, y, _ = solid().points.T
    turned = np.stack([mass @ y, -(mass @ x), 0 * x], axis=1)  # -α × r of unit α about z
    even = [f"EALL, GRAV, 1., {way}" for way in ("0., -1., 0.", "-1., 0., 0.")]
    spun = [(f"EALL, CENTRIF, 1., {-RADIUS}, 0., 0., 0., 0., 1.", rate**2), (even[0], RADIUS * growth)]
    cases = (
        ("a pulse of 20 m/s² along x", gb.Flight(x=PULSE), [(even[1], pushed)]),
        (f"spun up to {5:g} rad/s", gb.Hub(radius=RADIUS, rate=SPIN_UP), [*spun, (turned, growth)]),
    )
    for name, motion, loads in cases:
        theirs, _ = moved(tip, time, loads)
        ours = gb.simulate(
            bracket, motion, duration=DURATION, step=SAMPLE, integrator="gauss", initial="undeformed", estimate=False
        )
        mine = np.stack([np.interp(time, ours.time, each) for each in ours.displacement[:, -1].T], axis=1)
        largest = np.abs(theirs).max()
        for i, axis in enumerate("xyz"):
            if np.abs(theirs[:, i]).max() > 0.05 * largest:
                most = int(np.abs(theirs[:, i]).argmax())
                yield Row(name, f"displacement {axis} at its largest", 1e6 * theirs[most, i], 1e6 * mine[most, i],
                          "µm", MOVED, source)  # fmt: skip
                away = 100 * np.abs(mine[:, i] - theirs[:, i]).max() / np.abs(theirs[:, i]).max()
                name_of = f"displacement {axis}, largest difference over its size"
                yield Row(name, name_of, 0.0, away, "%", 100 * MOVED, source)


def moved(
    tip: int, time: np.ndarray, loads: list[tuple[str | np.ndarray, np.ndarray]], element: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (t, 3) of the tip, m, and stresses xx, yy, zz, yz, xz, xy (t, 27, 6) at the points of an element,
    Pa, by CalculiX's modal dynamics, of distributed loads or nodal forces (k, 3) that grow in proportion to histories.
    """
    tables, lines = [], []
    for k, (load, history) in enumerate(loads):
        pairs = [f"{t:.8g}, {value:.10g}" for t, value in zip(time, history, strict=True)]
        tables += [f"*AMPLITUDE, NAME=A{k}", *pairs]
        if isinstance(load, str):
            lines += [f"*DLOAD, AMPLITUDE=A{k}", load]
            continue
        lines.append(f"*CLOAD, AMPLITUDE=A{k}")
        lines += [f"{n + 1}, {way + 1}, {load[n, way]:.10g}" for n, way in zip(*np.nonzero(load), strict=True)]
    steps = "\n".join([
        "*NSET, NSET=TIP", f"{tip + 1}", "*ELSET, ELSET=GAUGE", f"{element}", *tables, "*STEP",
        "*FREQUENCY, STORAGE=YES", f"{DYNAMIC}", "*END STEP", "*STEP, INC=100000", "*MODAL DYNAMIC",
        f"{time[1]:.8g}, {time[-1]:.8g}", "*MODAL DAMPING", f"1, {DYNAMIC}, {DAMPING}", *lines,
        "*NODE PRINT, NSET=TIP, FREQUENCY=1", "U", "*EL PRINT, ELSET=GAUGE, FREQUENCY=1", "S", "*END STEP", "",
    ])  # fmt: skip
    text = run(steps, "dat")
    rows = np.array(re.findall(r"displ.*time +(\S+)\s+\d+ +(\S+) +(\S+) +(\S+)", text), dtype=float)
    stress = stresses(text)
    rows = np.concatenate([rows, stress.reshape(len(rows), -1)], axis=1)
    rows = np.concatenate([np.zeros_like(rows[:1]), rows])
    over = np.stack([np.interp(time, rows[:, 0], each) for each in rows[:, 1:].T], axis=1)
    return over[:, :3], over[:, 3:].reshape(len(time), -1, 6)


def stresses(text: str) -> np.ndarray:
    """Stresses xx, yy, zz, yz, xz, xy (t, k, 6) at points of elements, Pa, that a .dat file has at every increment."""
    printed = re.findall(r"stresses.*time.*\n\n((?: +\d+ +\d+ .*\n)+)", text)
    points = np.array([[line.split()[2:] for line in table.splitlines()] for table in printed], dtype=float)
    return points[..., [0, 1, 2, 5, 4, 3]]  # xy, xz, yz there


def static(load: str, specimen: Specimen = BRACKET) -> tuple[np.ndarray, float]:
    """Displacements (k, 3) of the nodes, m, and the largest von Mises stress at the points of the elements, Pa."""
    steps = f"*STEP\n*STATIC\n*DLOAD\n{load}\n*NODE PRINT, NSET=NALL\nU\n*EL PRINT, ELSET=SOLID\nS\n*END STEP\n"
    moved, _, stress = run(steps, "dat", specimen).partition(" stresses ")
    rows = np.array([line.split() for line in moved.splitlines() if re.match(r" +\d+ +[-\d]", line)], dtype=float)
    printed = [line.split()[2:8] for line in stress.splitlines() if re.match(r" +\d+ +\d+ ", line)]
    points = np.array(printed, dtype=float)
    return rows[:, 1:], float(von_mises(points[:, [0, 1, 2, 5, 4, 3]]).max())  # xy, xz, yz there


def frequencies(rate: float, specimen: Specimen = BRACKET, radius: float = RADIUS) -> np.ndarray:
    """Natural frequencies at rest or about the stress of a spin, Hz."""
    steps = ""
    if rate:
        spin = f"EALL, CENTRIF, {rate**2}, {-radius}, 0., 0., 0., 0., 1."
        steps = f"*STEP, NLGEOM\n*STATIC\n1., 1.\n*DLOAD\n{spin}\n*END STEP\n"
    steps += f"*STEP{', PERTURBATION' if rate else ''}\n*FREQUENCY\n{COUNT}\n*END STEP\n"
    return printed_frequencies(run(steps, "dat", specimen))


def printed_frequencies(text: str) -> np.ndarray:
    """Natural frequencies of a .dat file, Hz."""
    value = r"([-+]?\d\.\d+E[-+]\d+)"
    table = re.split(r"E I G E N V A L U E   O U T P U T", text)[1]
    matches = re.findall(rf"^ +\d+ +{value} +{value} +{value} +{value}$", table, re.MULTILINE)
    return np.array([row[2] for row in matches], dtype=float)


def written(mesh: gb.SolidMesh, shell: bool) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """Places (k, 3) of the nodes of a file, of shells in the middle of their points on both faces, the nodes (e, n) of
    each block's elements, and those that are held.
    """
    if not shell:
        return mesh.points, [block.nodes for block in mesh.blocks], np.flatnonzero(mesh.clamped)
    _, node = np.unique(mesh.numbers, return_inverse=True)
    count, elements = np.bincount(node), []
    for block in mesh.blocks:
        corners, both = KINDS[block.kind].shell, node[block.nodes]
        elements.append(both[:, np.r_[:corners, 2 * corners : corners + both.shape[1] // 2]])
    places = np.stack([np.bincount(node, at) / count for at in mesh.points.T], axis=1)
    return places, elements, np.unique(node[mesh.clamped])


def deck(steps: str, specimen: Specimen = BRACKET) -> str:
    """Write a file of CalculiX."""
    mesh, shell = specimen.mesh(), specimen.thickness is not None
    places, elements, held = written(mesh, shell)
    lines = ["*NODE, NSET=NALL"]
    lines += [f"{i}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(places, 1)]
    number = 1
    for block, nodes_of in zip(mesh.blocks, elements, strict=True):
        lines.append(f"*ELEMENT, TYPE={specimen.element}, ELSET={block.material.upper() or 'ALONE'}")
        for nodes in nodes_of + 1:
            first, *rest = np.split(np.array([number, *nodes]), [11])
            lines += [", ".join(map(str, first)) + "," * (len(rest[0]) > 0)]
            lines += [", ".join(map(str, each)) for each in rest if len(each)]
            number += 1
    kinds = {name.upper() or "ALONE": metal for name, metal in specimen.materials.items()}
    lines += ["*ELSET, ELSET=SOLID", *kinds, "*ELSET, ELSET=EALL", "SOLID"]
    for node in np.flatnonzero(mesh.point_masses):
        name = f"M{node}"
        lines += [f"*ELEMENT, TYPE=MASS, ELSET={name}", f"{number}, {node + 1}"]
        lines += [f"*MASS, ELSET={name}", f"{mesh.point_masses[node]:.12g}", "*ELSET, ELSET=EALL", name]
        number += 1
    lines += ["*NSET, NSET=FOOT", *(f"{i}" for i in held + 1), "*BOUNDARY", f"FOOT, 1, {6 if shell else 3}"]
    for name, metal in kinds.items():
        lines += [f"*MATERIAL, NAME={name}", *elastic(metal), *expanding(metal), "*DENSITY", f"{metal.density}"]
        section = f"*{'SHELL' if shell else 'SOLID'} SECTION, ELSET={name}, MATERIAL={name}"
        if isinstance(metal, gb.Orthotropic):
            lines += [f"*ORIENTATION, NAME=O{name}", ", ".join(f"{each:.15g}" for each in np.ravel(metal.axes))]
            section += f", ORIENTATION=O{name}"
        lines.append(section)
        lines += [f"{specimen.thickness}"] * shell
    return "\n".join(lines) + "\n" + steps


def elastic(metal: gb.Material | gb.Orthotropic) -> list[str]:
    """Lines of a material's elasticity."""
    if isinstance(metal, gb.Material):
        return ["*ELASTIC", f"{metal.youngs_modulus}, {metal.poissons_ratio}"]
    (v12, v23, v13), (g12, g23, g13) = metal.poissons_ratios, metal.shear_moduli
    first = ", ".join(map(str, (*metal.youngs_moduli, v12, v13, v23, g12, g13)))
    return ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", first, f"{g23}"]


def expanding(metal: gb.Material | gb.Orthotropic) -> list[str]:
    """Lines of a material's expansion above a temperature of zero, if it has one."""
    if isinstance(metal, gb.Orthotropic):
        along = metal.expansions
        return [] if along is None else ["*EXPANSION, TYPE=ORTHO, ZERO=0.", ", ".join(map(str, along))]
    return [] if metal.expansion is None else ["*EXPANSION, ZERO=0.", f"{metal.expansion}"]


def run(steps: str, kind: str, specimen: Specimen = BRACKET) -> str:
    """Run ccx in a folder of its own, and return what it wrote."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "solid.inp").write_text(deck(steps, specimen), encoding="ascii")
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        subprocess.run(["ccx", "solid"], cwd=folder, check=True, capture_output=True, env=environment)
        return (Path(folder) / f"solid.{kind}").read_text(encoding="ascii")
