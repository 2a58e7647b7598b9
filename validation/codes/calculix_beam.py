"""A clamped strip of solid elements in CalculiX: stressed and stretched by its rotation, then vibrating about that.

*STATIC with NLGEOM under *DLOAD CENTRIF, then *FREQUENCY with PERTURBATION, which adds the stress and takes off the
spin's softening, and *COMPLEX FREQUENCY, CORIOLIS.
"""

from __future__ import annotations

import itertools
import os
import re
import subprocess
import tempfile
from collections import Counter
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

# Corners, then middles of edges, of a twenty-node brick, in half elements along x, y and z, in CalculiX's order.
_BRICK = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2), (1, 0, 0), (2, 1, 0),
          (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2), (0, 0, 1), (2, 0, 1), (2, 2, 1),
          (0, 2, 1)]  # fmt: skip


@dataclass(frozen=True)
class Strip:
    """Length along x, width along y, thickness along z, m; kg/m³, Pa; elements along each. A `gripped` root moves
    nowhere; one that is not does not move along x, nor on average across or about x: its width is free.
    """

    length: float
    width: float
    thickness: float
    density: float
    modulus: float
    poisson: float
    elements: tuple[int, int, int] = (80, 4, 2)
    gripped: bool = True


@dataclass(frozen=True)
class Spin:
    """Steady rotation at `rate` rad/s about the line through `centre` m along `axis`."""

    rate: float
    centre: tuple[float, float, float]
    axis: tuple[float, float, float]


@dataclass(frozen=True)
class Answer:
    """Stretch of the tip, m, and frequencies, Hz, with the direction in which each mode takes part, "" for torsion."""

    stretch: float
    frequency: np.ndarray
    direction: tuple[str, ...]


def solve(strip: Strip, spin: Spin | None, *, coriolis: bool = False, modes: int = 10) -> Answer:
    """At rest, or about the stress of a spin."""
    lines = []
    if spin is not None:
        line = ", ".join(f"{value:.12g}" for value in (spin.rate**2, *spin.centre, *spin.axis))
        lines += ["*STEP, NLGEOM", "*STATIC", "1., 1.", "*DLOAD", f"STRIP, CENTRIF, {line}"]
        lines += ["*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    lines += ["*STEP" if spin is None else "*STEP, PERTURBATION", "*FREQUENCY, STORAGE=YES", f"{modes}", "*END STEP"]
    if coriolis:
        lines += ["*STEP, PERTURBATION", "*COMPLEX FREQUENCY, CORIOLIS", f"{modes}", "*END STEP"]
    return read(_run(strip, lines), coriolis)


def bent(strip: Strip, force: tuple[float, float]) -> np.ndarray:
    """Displacement (3,) m of the middle of the tip under a dead force along y and z, N, spread over the tip's face."""
    nx, ny, nz = strip.elements
    areas = _areas(strip)
    lines = ["*STEP, NLGEOM, INC=200", "*CONTROLS, PARAMETERS=FIELD", "1e-6, 1e-6, , , 1e-6, , ,", "*STATIC", "0.2, 1."]
    lines.append("*CLOAD")
    for (j, k), area in areas.items():
        node = _number(strip, 2 * nx, j, k)
        lines += [f"{node}, {axis}, {each * area / (ny * nz):.12g}" for axis, each in zip((2, 3), force, strict=True)]
    lines += ["*NSET, NSET=MIDDLE", f"{_number(strip, 2 * nx, ny, nz)}", "*NODE PRINT, NSET=MIDDLE", "U", "*END STEP"]
    printed = re.findall(r"^ +\d+ +(\S+) +(\S+) +(\S+)$", _run(strip, lines), re.MULTILINE)
    return np.array(printed[-1], dtype=float)


def _run(strip: Strip, steps: list[str]) -> str:
    """Run ccx in a folder of its own, and return its .dat file."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "strip.inp").write_text("\n".join([*_mesh(strip), *steps, ""]), encoding="ascii")
        subprocess.run(
            ["ccx", "strip"], cwd=folder, check=True, capture_output=True, env=os.environ | {"OMP_NUM_THREADS": "1"}
        )
        return (Path(folder) / "strip.dat").read_text(encoding="ascii")


def _number(strip: Strip, i: int, j: int, k: int) -> int:
    """Number of a node, by half elements along x, y and z."""
    nx, ny, _ = strip.elements
    return 1 + i + (2 * nx + 1) * (j + (2 * ny + 1) * k)


def _mesh(strip: Strip) -> list[str]:
    """Nodes, elements, the held root and the material."""
    nx, ny, nz = strip.elements
    sides = 2 * nx + 1, 2 * ny + 1, 2 * nz + 1
    number = partial(_number, strip)
    places = [at for at in itertools.product(*map(range, sides)) if sum(index % 2 for index in at) <= 1]
    lines = ["*NODE, NSET=ALL"]
    for i, j, k in places:
        x, y, z = (
            strip.length * i / (2 * nx),
            strip.width * (j / (2 * ny) - 0.5),
            strip.thickness * (k / (2 * nz) - 0.5),
        )
        lines.append(f"{number(i, j, k)}, {x:.12g}, {y:.12g}, {z:.12g}")
    lines.append("*ELEMENT, TYPE=C3D20R, ELSET=STRIP")
    for e, (i, j, k) in enumerate(itertools.product(range(nx), range(ny), range(nz)), 1):
        nodes = [number(2 * i + a, 2 * j + b, 2 * k + c) for a, b, c in _BRICK]
        lines += [", ".join(map(str, [e, *nodes[:10]])) + ",", ", ".join(map(str, nodes[10:]))]
    for name, end in (("ROOT", 0), ("TIP", 2 * nx)):
        lines += [f"*NSET, NSET={name}", *(f"{number(*at)}" for at in places if at[0] == end)]
    lines += ["*BOUNDARY", f"ROOT, 1, {3 if strip.gripped else 1}"]
    if not strip.gripped:
        lines += _still_on_average(strip)
    lines += ["*MATERIAL, NAME=METAL", "*ELASTIC", f"{strip.modulus}, {strip.poisson}"]
    lines += ["*DENSITY", f"{strip.density}", "*SOLID SECTION, ELSET=STRIP, MATERIAL=METAL"]
    return lines


def _areas(strip: Strip) -> dict[tuple[int, int], float]:
    """Forces of an even traction on an end on its nodes (j, k), eight to a face, in faces."""
    _, ny, nz = strip.elements
    areas: Counter[tuple[int, int]] = Counter()
    for cell in itertools.product(range(ny), range(nz)):
        for side in itertools.product(range(3), range(3)):
            if side != (1, 1):
                areas[2 * cell[0] + side[0], 2 * cell[1] + side[1]] += 1 / 3 if sum(side) % 2 else -1 / 12
    return areas


def _still_on_average(strip: Strip) -> list[str]:
    """Equations by which the root's mean displacements along y and z and its mean turning about x are zero."""
    _, ny, nz = strip.elements
    along, across, turned = [], [], []
    for (j, k), area in _areas(strip).items():
        node, y, z = _number(strip, 0, j, k), j / (2 * ny) - 0.5, (k / (2 * nz) - 0.5) * strip.thickness / strip.width
        along.append((area, node, 2))
        across.append((area, node, 3))
        turned += [(area * y, node, 3), (-area * z, node, 2)]
    lines, first = [], set()
    for terms in (along, across, turned):  # the first degree of freedom of each is that which it takes away
        terms = sorted((term for term in terms if term[0]), key=lambda term: (term[1:] in first, -abs(term[0])))
        first.add(terms[0][1:])
        lines += ["*EQUATION", f"{len(terms)}"]
        written = [f"{node}, {axis}, {share:.12g}" for share, node, axis in terms]
        lines += [", ".join(written[k : k + 4]) for k in range(0, len(written), 4)]
    return lines


def read(text: str, coriolis: bool) -> Answer:
    """Numbers of the .dat file."""
    before, *tables = re.split(r"E I G E N V A L U E   O U T P U T", text)
    printed = re.findall(r"^ +\d+ +(\S+) +\S+ +\S+$", before, re.MULTILINE)
    value = r"([-+]?\d\.\d+E[-+]\d+)"
    frequencies = re.findall(rf"^ +\d+ +{value} +{value} +{value} +{value}$", tables[0], re.MULTILINE)
    parts = re.findall(rf"^ +\d+ +{value} +{value} +{value} +{value} +{value} +{value}$", tables[0], re.MULTILINE)
    shares = np.abs(np.array(parts[: len(frequencies)], dtype=float)[:, :3])
    largest = shares.max()
    direction = tuple("xyz"[row.argmax()] if row.max() > 1e-6 * largest else "" for row in shares)
    hertz = np.array([row[2] for row in frequencies], dtype=float)
    if coriolis:
        pairs = re.findall(rf"^ +\d+ +{value} +{value} +{value}$", tables[1], re.MULTILINE)
        hertz, direction = np.array([row[1] for row in pairs], dtype=float), ("",) * len(pairs)
    return Answer(float(np.mean([float(x) for x in printed])) if printed else 0.0, hertz, direction)
