"""Files of Nastran and Abaqus that say more than a mesh: what is not read is said, or refused."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

import gbeam as gb

from .bodies import STEEL, block

pytestmark = pytest.mark.usefixtures("reading_in_process")

NASTRAN = "CONM2          90       1      0.250\nRBE2,91,1,123,2,3\nCELAS2,7,1.0,1,1\nCONM2,92,1,,0.1\n$ CBAR\n"
ABAQUS = "*Mass, elset=m\n0.25\n*RIGID BODY, NSET=wall, REF NODE=1\n*Distributing  coupling\n*mass scaling\n**Spring\n"


def written(folder: Path, ending: str) -> Path:
    """A block in a file, held at property 7 or at its wall."""
    mesh = block("hexahedron20", (2, 1, 1), (0.2, 0.05, 0.03))
    points = mesh.points[np.unique(mesh.cells[0].data)]
    cells = np.unique(mesh.cells[0].data, return_inverse=True)[1].reshape(-1, 20)
    if ending == ".inp":
        whole = meshio.Mesh(points, {"hexahedron20": cells}, point_sets={"wall": np.flatnonzero(points[:, 0] == 0)})
    else:
        parts = [("hexahedron20", cells), ("quad", cells[:1, [0, 3, 7, 4]])]
        whole = meshio.Mesh(points, parts, cell_data={"nastran:ref": [np.array([1, 2]), np.array([7])]})
    meshio.write(folder / f"part{ending}", whole)
    return folder / f"part{ending}"


@pytest.mark.parametrize(
    ("ending", "more", "said"),
    [
        (".bdf", NASTRAN, "CONM2 (2), RBE2 (1), CELAS2 (1)"),
        (".inp", ABAQUS, "MASS (1), RIGID BODY (1), DISTRIBUTING COUPLING (1)"),
    ],
)
def test_what_a_file_says_besides_is_not_passed_over(tmp_path: Path, ending: str, more: str, said: str) -> None:
    file = written(tmp_path, ending)
    clamp = {".bdf": "7", ".inp": "wall"}[ending]
    assert gb.SolidMesh.read(file, materials=STEEL, clamp=clamp, unit="m").warnings == ()
    text = file.read_text()
    file.write_text(text.replace("ENDDATA", f"{more}ENDDATA") if ending == ".bdf" else text + more)
    (words,) = gb.SolidMesh.read(file, materials=STEEL, clamp=clamp, unit="m").warnings
    assert words == f"the mesh: {said} in part{ending} are not read: their masses, stiffness and constraints lack"


@pytest.mark.parametrize(
    "form",
    [
        "GRID,1,{},0.,-.025,-.015",
        "GRID           1{:8d}      0.  -0.025  -0.015",
        "GRID*{:19d}{:16d}{:>16}{:>16}\n*{:>23}",
    ],
)
def test_places_in_a_coordinate_system_are_refused(tmp_path: Path, form: str) -> None:
    file = written(tmp_path, ".bdf")
    lines = file.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("GRID"))
    last = first + 1 + lines[first + 1].startswith("*")
    for system in (0, 4):
        values = (1, system, "0.", "-.025", "-.015") if "*" in form else (system,)
        file.write_text("\n".join([*lines[:first], form.format(*values), *lines[last:]]) + "\n")
        if system:
            with pytest.raises(gb.InputError, match="has nodes in coordinate system 4, which is not read; export them"):
                gb.SolidMesh.read(file, materials=STEEL, clamp="7", unit="m")
        else:
            assert len(gb.SolidMesh.read(file, materials=STEEL, clamp="7", unit="m").points) == 32
