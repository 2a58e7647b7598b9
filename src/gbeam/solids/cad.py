"""Meshes in files, and of the solids in STEP files, which Gmsh meshes."""

from __future__ import annotations

import os
import re
import tempfile
from pathlib import Path
from typing import Any

from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.guards.limits import BINARY_BYTES, MESHER_BYTES, MESHER_SECONDS, refuse_large_file
from gbeam.guards.processes import read_confined
from gbeam.numerics.sparse import refuse_cost
from gbeam.progress import PATIENCE, Bar
from gbeam.solids.files import FileMesh, parts_of, read_mesh
from gbeam.solids.foreign import unit_size

ENDINGS = (".step", ".stp")
AROUND = 12  # elements around a full circle at least
UNNAMED = "Open CASCADE"  # begins the names that nobody gave
# Entity of STEP by which Open CASCADE opens another file, by its long and its short name.
_ELSEWHERE = re.compile(rb"\b(APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT|AEIA)\b", re.IGNORECASE)
DENSE = 5  # nodes in a cube of the size: fewer than Gmsh makes, 8 to 12 where a part is several elements thick
FINEST = 10  # how much shorter than the given size edges may be there


def mesh_of(source: Any, unit: str | None, element_size: float | None, *, cards: bool = False) -> tuple[Any, float]:
    """Return a mesh with meshio's fields and the size of its unit, m. The source is a file, read with its `cards` or
    without, or the mesh itself. A file of STEP is meshed by elements of a size.
    """
    path = Path(source) if isinstance(source, (str, os.PathLike)) else None
    if path is not None and path.suffix.lower() in ENDINGS:
        if unit is not None:
            raise InputError("unit", f"is {unit!r} beside a file that says its own", "leave it out")
        if element_size is None:
            raise InputError("element_size", "is missing", f"give the one to mesh {path} by, such as 3 mm")
        return meshed(path, positive("element_size", element_size, "m")), 1.0
    if element_size is not None:
        raise InputError("element_size", "is given beside a mesh", "leave it out: it is for STEP files")
    mesh = read_mesh(source, cards=cards)
    if unit is None:
        raise InputError("unit", "is missing", 'give the one that the coordinates are in, such as "mm"')
    return mesh, unit_size("unit", unit, "length")


def meshed(path: Path, size: float) -> FileMesh:
    """Mesh the solids of a STEP file by tetrahedra of 10 nodes with edges of a size (m), finer where surfaces are
    curved.

    Places are in m. Solids and surfaces are groups by their names, or by their numbers in the file, and `info` says
    where they are.
    """

    def refuse(problem: str) -> InputError:
        return InputError("mesh", f"{path} {problem}", "give a larger element_size, or a mesh")

    with tempfile.TemporaryDirectory() as folder, Bar(f"meshing {path.name}", patience=PATIENCE):
        out = os.path.join(folder, "solid.msh")
        limits = {"memory": MESHER_BYTES, "seconds": MESHER_SECONDS}
        return FileMesh.from_parts(read_confined(_mesh_into, path, size, out, refuse=refuse, **limits))


def _mesh_into(path: str, size: float, out: str) -> dict[str, Any]:
    """Mesh the solids of a file into another one, `out`. Return its parts, and the places of its groups in words."""
    try:
        import gmsh
    except ModuleNotFoundError:
        raise InputError("", "Gmsh is not installed", 'install it with: pip install "gbeam[gmsh]"') from None
    except OSError as error:  # a library of the system that its wheel does not bring
        raise InputError("", f"Gmsh cannot be loaded: {error}", "install that library, or give a mesh") from None
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    options = {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Mesh.MeshSizeMax": size,
        "Mesh.MeshSizeMin": size / FINEST,
        "Mesh.MeshSizeFromCurvature": AROUND,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 2,
    }
    for name, value in options.items():
        gmsh.option.setNumber(name, value)
    gmsh.option.setString("Geometry.OCCTargetUnit", "M")
    model, places = gmsh.model, dict[str, str]()
    try:
        refuse_large_file("mesh", path, BINARY_BYTES, "export fewer parts")
        if _ELSEWHERE.search(Path(path).read_bytes()):
            problem = f"{path} refers to other files, which a result would not hold"
            raise InputError("mesh", problem, "export the assembly as one file")
        model.occ.importShapes(path)
        model.occ.removeAllDuplicates()  # parts that touch share their nodes
        model.occ.synchronize()
        for dim, noun in ((3, "solid"), (2, "surface")):
            for _, tag in model.getEntities(dim):
                label = model.getEntityName(dim, tag).rpartition("/")[2]
                name = label if label and label not in places and not label.startswith(UNNAMED) else f"{noun} {tag}"
                model.addPhysicalGroup(dim, [tag], name=name)
                x, y, z = (1e3 * metres for metres in model.occ.getCenterOfMass(dim, tag))
                area = f", {1e6 * model.occ.getMass(dim, tag):.4g} mm²" if dim == 2 else ""
                places[name] = f"at ({x:.4g}, {y:.4g}, {z:.4g}) mm{area}"
        if not model.getEntities(3):
            raise InputError("mesh", f"{path} has no solids", "export the part as a solid, not its surfaces")
        volume = sum(model.occ.getMass(dim, tag) for dim, tag in model.getEntities(3))
        refuse_cost("element_size", round(3 * DENSE * volume / size**3))
        model.mesh.generate(3)
        gmsh.write(out)
    except InputError:
        raise
    except Exception as error:  # Gmsh raises no narrower one
        problem = f"{path} is not meshed by Gmsh: {' '.join(str(error).split())}"
        raise InputError("mesh", problem, "give another element_size, or repair the shape") from None
    return parts_of(out, False) | {"info": places}
