"""Bodies and laws of other programs: sound files of meshes, matrices and controllers in every form, then damaged."""

from __future__ import annotations

import json
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from io import BytesIO, StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fuzz.cases import ROOT, Case, Random
from fuzz.damage import damaged
from fuzz.grown import METAL, block, chain
from fuzz.scenarios import change, corrupted, toml

# Forms of files, and in each the name of the group at the block's end.
MESHES = {
    "gmsh 2": "wall", "gmsh 2 in binary": "wall", "gmsh 4": "wall", "gmsh 4 in binary": "wall", "nastran": "2",
    "abaqus": "wall", "vtk": "wall", "vtk in binary": "wall", "vtu": "wall", "vtu in binary": "wall", "xdmf": "wall",
    "med": "wall", "medit": "2", "medit in binary": "2", "exodus": "wall", "exodus of netCDF 4": "wall",
}  # fmt: skip
MATRICES = (
    "npz", "npy", "mat", "mat of version 4", "mat of version 7.3", "matrix market", "abaqus", "storage", "op4",
    "op4 in binary", "punch", "standard input",
)  # fmt: skip
LAWS = ("npz", "mat", "json")
ENDINGS = (".msh", ".bdf", ".inp", ".vtk", ".vtu", ".xdmf", ".med", ".mesh", ".meshb", ".e", ".npz", ".mat", ".mtx")
FILES = ("mesh", "matrices", "standard_input_data", "file")  # keys
VERBS = ("check", "check", "check", "modes", "static", "run")


def body(chosen: Random) -> Case:
    """A scenario of a body, or a controller, whose file is malformed, or with a wrong word about a sound one."""
    match chosen.choice(("mesh", "mesh", "matrices", "matrices", "law")):
        case "mesh":
            form = chosen.choice(list(MESHES))
            files, scenario = mesh(form), _meshed(chosen, MESHES[form])
        case "matrices":
            form = chosen.choice(MATRICES)
            files, scenario = matrices(form), _reduced(form)
        case _:
            files, scenario = law(chosen.choice(LAWS)), _steered()
    files = dict(files)
    place = next(
        each for each in _tables(scenario) if each.keys() & {"mesh", "matrices", "standard_input_data", "file"}
    )
    key = next(each for each in ("mesh", "matrices", "standard_input_data", "file") if each in place)
    named = [each for each in files if not each.endswith(".dof")]  # which lies beside another
    place[key] = named if key == "matrices" else named[0]
    for _ in range(chosen.choice((0, 1, 1, 1, 2, 4, 20))):
        name = chosen.choice(list(files))
        text = b"\0" not in files[name][:4096]
        files[name] = (corrupted if text and chosen.random() < 0.8 else damaged)(chosen, files[name])
    if chosen.random() < 0.05:  # of another kind than its name says
        name = chosen.choice(list(files))
        files[other := Path(name).stem + chosen.choice(ENDINGS)] = files.pop(name)
        place[key] = [other if each == name else each for each in place[key]] if key == "matrices" else other
    for _ in range(chosen.choice((0, 0, 0, 1, 2))):
        change(chosen, scenario)
    verb = chosen.choice(VERBS)
    words = [verb, "s.toml", *(["--set", "response.duration=0.05 s", "--out", "out"] if verb == "run" else [])]
    return Case("body", words, {"s.toml": toml(scenario).encode("utf-8", "surrogatepass"), **files})


def _tables(node: Any) -> list[dict[str, Any]]:
    """All tables of a scenario."""
    inner = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return [*([node] if isinstance(node, dict) else []), *(table for each in inner for table in _tables(each))]


def _flown(name: str, of: dict[str, Any]) -> dict[str, Any]:
    """A scenario of one body on a base that is pushed."""
    push = {"profile": "smooth-step", "level": "2 g", "duration": "0.1 s"}
    return {
        "bodies": {name: of | {"damping_ratio": 0.01}},
        "motion": {"flight": {"kind": "flight", "acceleration": {"z": push}}},
        "response": {"duration": "0.2 s"},
    }


def _meshed(chosen: Random, wall: str) -> dict[str, Any]:
    table: dict[str, Any] = {"mesh": "", "unit": "m", "clamp": wall, "modes": 3, "material": METAL}
    more = {
        "points": {"end": ["0.2 m", 0, 0]}, "interfaces": {"face": ["0.2 m", "20 mm", 0]}, "thickness": "2 mm",
        "scale": [1, -1, 1], "point_masses": [{"on": "face", "mass": "0.1 kg"}],
    }  # fmt: skip
    if chosen.random() < 0.3:
        key = chosen.choice(list(more))
        table[key] = more[key]
    return _flown("part", table)


def _reduced(form: str) -> dict[str, Any]:
    if form == "standard input":
        return _flown("part", {"standard_input_data": ""})
    return _flown("part", {"matrices": "", "modes": 3, "clamp": [0 if form == "npz" else 1]})


def _steered() -> dict[str, Any]:
    """A body that a law turns about an axis."""
    rigid = {"kind": "rigid", "mass": "2 kg", "inertia": ["0.1 kg m^2", "0.1 kg m^2", "0.1 kg m^2"]}
    loop = {
        "measure": ["axis.angle", "axis.angle_rate"], "drive": ["axis.angle"], "sample": "5 ms",
        "law": [{"kind": "state-space", "file": ""}], "reference": [0.1, 0],
    }  # fmt: skip
    return {
        "bodies": {"wheel": rigid},
        "joints": {"axis": {"kind": "revolute", "body": "wheel", "axes": [[0, 0, 1]], "damping": "0.1 N m s/rad"}},
        "controllers": {"loop": loop},
        "response": {"duration": "0.2 s"},
    }


@cache
def mesh(form: str) -> dict[str, bytes]:
    """A sound mesh of a form, by the name of its file."""
    import meshio

    whole = block()
    wall, walls = whole.point_sets["wall"], _wall_faces(whole)
    blocks = [*whole.cells, meshio.CellBlock("quad", walls)]
    tags = [np.ones(len(whole.cells[0].data), dtype=int), np.full(len(walls), 2)]
    marked = {"wall": np.isin(np.arange(len(whole.points)), wall).astype(np.int32)}
    kind, binary = form.partition(" in ")[0], "in binary" in form
    with TemporaryDirectory() as folder, redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        match kind:
            case "gmsh 2":
                cell_data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
                named = {"part": np.array([1, 3]), "wall": np.array([2, 2])}
                file = Path(folder, "part.msh")
                tagged = meshio.Mesh(whole.points, blocks, cell_data=cell_data, field_data=named)
                meshio.write(file, tagged, file_format="gmsh22", binary=binary)
            case "gmsh 4" if binary:  # of which meshio writes no groups
                file = Path(folder, "part.msh")
                meshio.write(file, meshio.Mesh(whole.points, whole.cells), file_format="gmsh", binary=True)
            case "gmsh 4":
                file = Path(folder, "part.msh")
                file.write_text(_of_gmsh_4(whole.points, blocks), encoding="ascii")
            case "nastran" | "medit":
                key, ending = ("nastran:ref", ".bdf") if kind == "nastran" else ("medit:ref", ".mesh")
                file = Path(folder, f"part{ending}{'b' if binary else ''}")
                meshio.write(file, meshio.Mesh(whole.points, blocks, cell_data={key: tags}))
            case "abaqus":
                file = Path(folder, "part.inp")
                meshio.write(file, whole)
            case "vtk" | "vtu":
                file = Path(folder, f"part.{kind}")
                meshio.write(file, meshio.Mesh(whole.points, whole.cells, point_data=marked), binary=binary)
            case "xdmf":
                file = Path(folder, "part.xdmf")
                meshio.write(file, meshio.Mesh(whole.points, whole.cells, point_data=marked), data_format="XML")
            case "med":
                file = Path(folder, "part.med")
                family = meshio.Mesh(whole.points, whole.cells, point_data={"point_tags": 2 * marked["wall"]})
                family.point_tags = {2: ["wall"]}
                meshio.write(file, family)
            case _:
                file = Path(folder, "part.e")
                _write_exodus(file, whole, classic=form == "exodus")
        return {file.name: file.read_bytes()}


def _of_gmsh_4(points: Any, blocks: Any) -> str:
    """A mesh of hexahedra in a volume and of faces on the wall."""
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '3 1 "part"', '2 2 "wall"']
    lines += ["$EndPhysicalNames", "$Entities", "0 0 1 1", "2 0 0 0 0 1 1 1 2 0", "1 0 0 0 1 1 1 1 1 1 2"]
    lines += ["$EndEntities", "$Nodes", f"1 {len(points)} 1 {len(points)}", f"3 1 0 {len(points)}"]
    lines += [*map(str, range(1, len(points) + 1)), *(f"{x!r} {y!r} {z!r}" for x, y, z in points.tolist()), "$EndNodes"]
    count = sum(len(each.data) for each in blocks)
    lines += ["$Elements", f"2 {count} 1 {count}"]
    for number, (each, head) in enumerate(zip(blocks, ("3 1 5", "2 2 3"), strict=True)):
        lines.append(f"{head} {len(each.data)}")
        first = 1 + number * len(blocks[0].data)
        lines += (" ".join(map(str, [k, *nodes])) for k, nodes in enumerate((each.data + 1).tolist(), first))
    return "\n".join([*lines, "$EndElements", ""])


def _wall_faces(whole: Any) -> Any:
    cells, wall = whole.cells[0].data, whole.point_sets["wall"]
    faces = cells[:, [0, 3, 7, 4]]  # across the first axis
    return faces[np.isin(faces, wall).all(axis=1)]


def _write_exodus(file: Path, whole: Any, *, classic: bool) -> None:
    import h5py
    from scipy.io import netcdf_file

    variables: dict[str, Any] = {f"coord{axis}": whole.points[:, k] for k, axis in enumerate("xyz")}
    variables |= {
        "connect1": (whole.cells[0].data + 1).astype("i4"),
        "node_ns1": (whole.point_sets["wall"] + 1).astype("i4"),
        "ns_names": np.array([list(b"wall".ljust(33, b"\0"))], dtype=np.uint8).view("S1"),
    }
    with netcdf_file(file, "w") if classic else h5py.File(file, "w") as opened:
        for name, values in variables.items():
            if classic:
                dims = [f"{name}_{k}" for k in range(values.ndim)]
                for dim, size in zip(dims, values.shape, strict=True):
                    opened.createDimension(dim, size)
                kind = "c" if values.dtype.kind == "S" else values.dtype.char
                opened.createVariable(name, kind, dims)[:] = values
            else:
                opened[name] = values
        if classic:
            opened.variables["connect1"].elem_type = "HEX8"
        else:
            opened["connect1"].attrs["elem_type"] = np.bytes_("HEX8")


@cache
def matrices(form: str) -> dict[str, bytes]:
    """Sound matrices of a form, by the names of their files."""
    whole = np.load(BytesIO(chain()))
    both = {"K": whole["K"], "M": whole["M"]}
    rows = [(node, way) for node in (1, 2, 3) for way in range(1, 7)]
    lower = list(zip(*np.tril_indices(len(rows)), strict=True))
    with TemporaryDirectory() as name:
        folder = Path(name)
        nodes = "".join(f"{k}, {x!r}, 0., 0.\n" for k, x in enumerate((0.0, 0.2, 0.4), 1))
        (folder / "nodes.inp").write_text(f"*NODE, NSET=ALL\n{nodes}", encoding="ascii")
        match form:
            case "npz":
                return {"chain.npz": chain()}
            case "npy":
                for key, each in both.items():
                    np.save(folder / f"{key}.npy", each)
            case "mat" | "mat of version 4":
                from scipy.io import savemat

                savemat(folder / "chain.mat", both, format="4" if form != "mat" else "5")
            case "mat of version 7.3":
                import h5py

                with h5py.File(folder / "chain.mat", "w", userblock_size=512) as file:
                    for key, each in both.items():
                        file[key] = each
                data = (folder / "chain.mat").read_bytes()
                head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
                (folder / "chain.mat").write_bytes(head + data[len(head) :])
            case "matrix market":
                from scipy.io import mmwrite
                from scipy.sparse import coo_array

                for key, each in both.items():
                    mmwrite(folder / f"{key}.mtx", coo_array(each), symmetry="symmetric")
            case "abaqus":
                for key, each in both.items():
                    lines = (
                        f"{rows[i][0]},{rows[i][1]}, {rows[j][0]},{rows[j][1]}, {each[i, j]:.17e}" for i, j in lower
                    )
                    (folder / f"{key}.mtx").write_text("\n".join(["** MATRIX INPUT", *lines]), encoding="ascii")
            case "storage":
                for key, ending in (("K", "sti"), ("M", "mas")):
                    lines = (f"{j + 1} {i + 1} {both[key][i, j]:.17e}" for i, j in lower)
                    (folder / f"rod.{ending}").write_text("\n".join(lines), encoding="ascii")
                (folder / "rod.dof").write_text("\n".join(f"{node}.{way}" for node, way in rows), encoding="ascii")
            case "op4" | "op4 in binary":
                from pyyeti.nastran import op4

                op4.write(str(folder / "rod.op4"), {"kaa": both["K"], "maa": both["M"]}, binary=form != "op4")
            case "punch":
                import pandas as pd
                from pyyeti.nastran import bulk

                index = pd.MultiIndex.from_tuples(rows, names=["id", "dof"])
                frames = {f"{key}AAX": pd.DataFrame(each, index=index, columns=index) for key, each in both.items()}
                bulk.wtdmig(str(folder / "rod.pch"), frames)
                (folder / "nodes.inp").unlink()
                places = np.array([[0.0, 0, 0], [0.2, 0, 0], [0.4, 0, 0]])
                bulk.wtgrids(str(folder / "grids.bdf"), [1, 2, 3], xyz=places, form="{:16.9E}")
            case _:
                return {"strip.sid": (ROOT / "examples" / "data" / "strip.sid").read_bytes()}
        return {each.name: each.read_bytes() for each in sorted(folder.iterdir())}


@cache
def law(form: str) -> dict[str, bytes]:
    """A sound law of two inputs and one output, by the name of its file."""
    parts = {"A": [[-3.0, 0.2], [0.0, -5.0]], "B": [[1.0, 0.0], [0.0, 1.0]], "C": [[0.5, 0.1]], "D": [[1.0, 0.2]]}
    file = BytesIO()
    match form:
        case "npz":
            np.savez(file, **{name: np.array(each) for name, each in parts.items()})
        case "mat":
            from scipy.io import savemat

            savemat(file, parts)
        case _:
            file.write(json.dumps(parts).encode())
    return {f"law.{form}": file.getvalue()}
