"""Rigid links, a body on one and springs between them, in CalculiX (*RIGID BODY, *MASS, *SPRING) and in gbeam on the
same mesh of hexahedra of 20 nodes: a steel bar of 200 by 20 by 10 mm, clamped at one end, whose middle and other end
are faces that stay plane. The body is a mass beside the bar, so that the end bends and twists it. The last cases are
files that both read: *COUPLING with *KINEMATIC, and *DISTRIBUTING COUPLING, in the middle of its nodes, for CalculiX
leaves out that its node turns. *COUPLING with *DISTRIBUTING carries no inertia in CalculiX's modes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np

import gbeam as gb
from gbeam.solids import WAYS
from validation.codes.calculix_solid import Specimen, deck, printed_frequencies, run
from validation.codes.calculix_specimens import STEEL, grid
from validation.table import Row

TITLE = "CalculiX: rigid links, lumped masses and springs in a solid"
NEEDS = ("calculix-ccx", "numpy", "scipy", "scikit-fem", "meshio")
COUNT, CLOSE = 8, 1e-6
LENGTH, WIDTH, THICKNESS = 200.0, 20.0, 10.0  # mm
MASS, BESIDE = 0.4, np.array([0.05, 0.01, 0.02])  # kg, m from the middle of the end
STIFFNESS = dict(zip(WAYS, (2e6, 1e5, 3e5, 200.0, 300.0, 400.0), strict=True))  # N/m, N m/rad
INNER, END = np.array([LENGTH / 2, 0, 0]) / 1e3, np.array([LENGTH, 0, 0]) / 1e3
FIRST = 900_000  # number of the first node, and element, that is not of the mesh


def rows() -> Iterator[Row]:
    """The middle on springs to the ground and a mass at the end; springs between the middle and the end."""
    cases: Mapping[str, tuple[dict[str, Any], str]] = {
        "mass at the end, springs from the middle to the ground": (
            {"carried": {"end": gb.RigidBody(MASS, centre=BESIDE)}, "springs": _spring("inner")},
            _link(0, "INNER", INNER) + _link(1, "END", END + BESIDE) + _mass(1) + _springs(0),
        ),
        "springs between the middle and the end": (
            {"springs": _spring("inner", "end")},
            _link(0, "INNER", INNER) + _link(1, "END", INNER) + _springs(0, 1),
        ),
    }
    for words, (more, model) in cases.items():
        mesh = bar(**more)
        ours = mesh.reduced(modes=COUNT + 6, damping_ratio=0.0).frequency
        theirs = _frequencies(mesh, model)
        yield from _rows(words, theirs, ours)
    mesh, (last, other) = bar(), (20 * 2 - 1, 20 * 2)
    surface = f"*SURFACE, NAME=SEAT, TYPE=ELEMENT\n{last}, S4\n{other}, S4\n"
    coupled = f"*COUPLING, REF NODE={FIRST + 2}, SURFACE=SEAT, CONSTRAINT NAME=SEATED\n*KINEMATIC\n1, 3\n"
    mean = (
        f"*ELEMENT, TYPE=DCOUP3D, ELSET=MEAN\n{FIRST + 1}, {FIRST + 2}\n*DISTRIBUTING COUPLING, ELSET=MEAN\nEND, 1.\n"
    )
    end = "*NSET, NSET=END\n" + "".join(f"{n + 1}\n" for n in mesh.links.nodes["end"])
    for words, place, joint in (
        ("mass on a kinematic coupling of the end, in one file", END + BESIDE, surface + coupled),
        ("mass that moves as the end does on average, in one file", END, end + mean),
    ):
        model = f"*NODE\n{FIRST + 2}, {', '.join(f'{x:.12g}' for x in place)}\n{joint}{_mass(1)}"
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "bar.inp"
            file.write_text(deck(model, _specimen(mesh)), encoding="ascii")
            read = gb.SolidMesh.read(file, materials=STEEL, clamp="FOOT", unit="m", mass_unit="kg")
        ours = read.reduced(modes=COUNT + 6, damping_ratio=0.0).frequency
        yield from _rows(words, _frequencies(mesh, model), ours)


def _rows(words: str, theirs: np.ndarray, ours: np.ndarray) -> Iterator[Row]:
    for n in range(COUNT):
        yield Row(words, f"mode {n + 1}", theirs[n], float(ours[n]), "Hz", CLOSE, "20 × 2 × 1 C3D20")


def _specimen(mesh: gb.SolidMesh) -> Specimen:
    return Specimen(lambda: mesh, {"": STEEL})


def bar(**more: Any) -> gb.SolidMesh:
    """The bar with its two links."""
    points, cells = grid((20, 2, 1), (LENGTH, WIDTH, THICKNESS))
    sets = {
        name: np.flatnonzero(points[:, 0] == x) for name, x in (("wall", 0), ("inner", LENGTH / 2), ("end", LENGTH))
    }
    mesh = meshio.Mesh(points, {"hexahedron20": cells}, point_sets=sets)
    links = {"inner": "inner", "end": "end"}
    return gb.SolidMesh.read(mesh, materials=STEEL, clamp="wall", unit="mm", links=links, **more)


def _spring(*between: str) -> dict[str, Any]:
    return {"stay": {"between": list(between), "stiffness": STIFFNESS}}


def _link(k: int, name: str, place: np.ndarray) -> str:
    """A rigid body of a face, with the node that moves as it does at a place, and the node that turns."""
    nodes = [f"{FIRST + 2 * k + i}, {', '.join(f'{x:.12g}' for x in place)}" for i in (0, 1)]
    body = f"*RIGID BODY, NSET={name}, REF NODE={FIRST + 2 * k}, ROT NODE={FIRST + 2 * k + 1}"
    return "\n".join(["*NODE", *nodes, body, ""])


def _mass(k: int) -> str:
    return f"*ELEMENT, TYPE=MASS, ELSET=BODY\n{FIRST}, {FIRST + 2 * k}\n*MASS, ELSET=BODY\n{MASS}\n"


def _springs(*ends: int) -> str:
    """Springs along and about x, y and z, from one link to the ground or to another one."""
    lines = []
    for way, stiffness in enumerate(STIFFNESS.values()):
        turns, axis = divmod(way, 3)
        nodes = [f"{FIRST + 2 * k + turns}" for k in ends]
        lines += [f"*ELEMENT, TYPE=SPRING{len(ends)}, ELSET=S{way}", ", ".join([f"{FIRST + 1 + way}", *nodes])]
        lines += [f"*SPRING, ELSET=S{way}", ", ".join(f"{axis + 1}" for _ in ends), f"{stiffness}"]
    return "\n".join([*lines, ""])


def _frequencies(mesh: gb.SolidMesh, model: str) -> np.ndarray:
    """Natural frequencies, Hz."""
    faces = ""
    for name, nodes in mesh.links.nodes.items():
        faces += f"*NSET, NSET={name.upper()}\n" + "\n".join(f"{n + 1}" for n in nodes) + "\n"
    steps = f"{faces}{model}*STEP\n*FREQUENCY\n{COUNT}\n*END STEP\n"
    return printed_frequencies(run(steps, "dat", _specimen(mesh)))
