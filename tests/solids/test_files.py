"""Files of meshes are read in a process of their own, alone, and no other file with them."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np
import pytest
import scipy.io

import gbeam as gb
from gbeam.guards import processes
from gbeam.scenario import ScenarioError
from gbeam.solids import parts_of, read_mesh

from ..guards.damaged import endless_exodus, large_med, large_vtu
from .bodies import STEEL, block

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="limits of processes are POSIX's")
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="other systems limit no address space")
CUBE = block("hexahedron", (1, 1, 1), (1.0, 1.0, 1.0))
READ: dict[str, Any] = {"materials": STEEL, "clamp": "1", "unit": "m"}


def cube(path: Path, **options: Any) -> Path:
    """A cube of one element, which is the group 1, in a file."""
    used, cells = np.unique(CUBE.cells[0].data, return_inverse=True)
    cells = cells.reshape(1, -1)
    data = {} if path.suffix == ".inp" else {"part": [np.array([1])]}
    sets = {"cell_sets": {"1": [np.array([0])]}} if path.suffix == ".inp" else {}
    meshio.write(path, meshio.Mesh(CUBE.points[used], {"hexahedron": cells}, cell_data=data, **sets), **options)
    return path


@pytest.mark.parametrize("name", ["a.vtu", "a.inp", "a.xdmf"])
def test_a_mesh_is_opened_in_no_process_but_the_reader_s(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    path = cube(tmp_path / name, **({"data_format": "XML"} if name == "a.xdmf" else {}))
    whole = parts_of(str(path), False)

    def opened(*_: Any, **__: Any) -> None:
        raise AssertionError("opened in this process")

    for module, function in ((h5py, "File"), (scipy.io, "netcdf_file"), (meshio, "read"), (Path, "read_text")):
        monkeypatch.setattr(module, function, opened)
    read = read_mesh(path)
    np.testing.assert_array_equal(read.points, whole["points"])
    assert [cells.type for cells in read.cells] == ["hexahedron"] and read.numbers.tolist() == [*range(1, 9)]


@POSIX
def test_a_mesh_that_is_read_for_ever_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An Exodus file of 6.6 kB, which froze whoever read it: the app's server, too."""
    monkeypatch.setattr(processes, "READER_SECONDS", 1)
    monkeypatch.setattr(processes, "_PATIENCE", 60)  # a busy machine is no error
    endless_exodus(tmp_path / "a.exo")
    with pytest.raises(gb.InputError, match=r"mesh .*a\.exo takes more than 1 s of processor time"):
        gb.SolidMesh.read(tmp_path / "a.exo", **READ)


@LINUX
@pytest.mark.parametrize("large", [large_med, large_vtu])
def test_a_small_file_of_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, large: Any) -> None:
    """Files of 5 kB and 0.7 MB that unpack to 0.6 GB."""
    monkeypatch.setattr(processes, "READER_BYTES", 400 * 2**20)
    path = large(tmp_path)
    assert path.stat().st_size < 1e6
    with pytest.raises(gb.InputError, match=r"mesh .*takes more than 4\d\d MB of memory to read; mesh it more"):
        gb.SolidMesh.read(path, **READ)


ONE = '<DataItem DataType="Float" Dimensions="8 3" Format="XML" Precision="8">'
NUMBERS = "".join(f"{x} {y} {z} " for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
FORM = f"""<?xml version="1.0"?>
DOCTYPE<Xdmf Version="3.0"><Domain><Grid Name="Grid"><Geometry GeometryType="XYZ">{ONE}{NUMBERS}</DataItem></Geometry>
<Topology TopologyType="Hexahedron" NumberOfElements="1"><DataItem DataType="Int" Dimensions="1 8" Format="XML"
Precision="8">0 1 2 3 4 5 6 7</DataItem></Topology><Attribute Name="part" AttributeType="Scalar" Center="Cell">
<DataItem DataType="Int" Dimensions="1" Format="XML" Precision="8">1</DataItem></Attribute></Grid></Domain></Xdmf>
"""


def xdmf(path: Path, item: str = f"{ONE}{NUMBERS}</DataItem>", doctype: str = "") -> Path:
    """A cube whose places are an item's, which may lie beside it, in four files of different forms."""
    places = np.array(NUMBERS.split(), dtype=float)
    places.tofile(path.with_name("places.bin"))
    path.with_name("places.txt").write_text(NUMBERS)
    path.with_name("item.xml").write_text(f"{ONE}{NUMBERS}</DataItem>")
    with h5py.File(path.with_name("places.h5"), "w") as file:
        file["places"] = places.reshape(8, 3)
    text = FORM.replace("DOCTYPE", doctype).replace(f"{ONE}{NUMBERS}</DataItem>", item)
    path.write_text(text.replace("FOLDER", str(path.parent)), encoding="utf-8")
    return path


def test_xdmf_with_its_numbers_is_read_whatever_it_says_its_type_is_in(tmp_path: Path) -> None:
    for name, doctype in (("a.xdmf", ""), ("b.xmf", '<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>')):
        read = read_mesh(xdmf(tmp_path / name, doctype=doctype))
        np.testing.assert_array_equal(read.points, np.array(NUMBERS.split(), dtype=float).reshape(8, 3))


ITEMS = {
    "HDF": '<DataItem Dimensions="8 3" Precision="8" Format="HDF">places.h5:/places</DataItem>',
    "single quotes": "<DataItem Dimensions='8 3' Precision='8' Format='HDF'>places.h5:/places</DataItem>",
    "spaces": '<DataItem Dimensions="8 3" Precision="8" Format\n = "HDF" >places.h5:places</DataItem>',
    "absolute": '<DataItem Dimensions="8 3" Precision="8" Format="HDF">FOLDER/places.h5:/places</DataItem>',
    "binary": '<DataItem Dimensions="8 3" Precision="8" Format="Binary">FOLDER/places.bin</DataItem>',
    "escaped": '<DataItem Dimensions="8 3" Precision="8" Format="&#72;DF">places.h5:/places</DataItem>',
    "another tag": '<Numbers Dimensions="8 3" Precision="8" Format="HDF">places.h5:/places</Numbers>',
    "within": '<DataItem Dimensions="8 3" Precision="8" Format="HDF">places.h5:/places<More/></DataItem>',
    "small letters": '<DataItem Dimensions="8 3" Precision="8" Format="hdf">places.h5:/places</DataItem>',
}


@pytest.mark.usefixtures("reading_in_process")
@pytest.mark.parametrize("way", ITEMS)
@pytest.mark.parametrize("ending", ["xdmf", "xmf"])
def test_numbers_beside_xdmf_are_refused(tmp_path: Path, way: str, ending: str) -> None:
    """They were read, by the key of the file alone: 212.98 Hz as long as it was kept, for 416.08 when they changed."""
    with pytest.raises(gb.InputError, match=r"keeps its numbers in .*places\.(h5|bin); write one file: VTU, or XDMF"):
        gb.SolidMesh.read(xdmf(tmp_path / f"a.{ending}", ITEMS[way]), **READ)


@pytest.mark.usefixtures("reading_in_process")
@pytest.mark.parametrize(
    ("doctype", "item", "said"),
    [
        ('<!DOCTYPE Xdmf [<!ENTITY x SYSTEM "FOLDER/places.txt">]>', f"{ONE}&x;</DataItem>", "defines entities"),
        ('<!DOCTYPE Xdmf [<!ENTITY % x SYSTEM "FOLDER/item.xml">%x;]>', f"{ONE}</DataItem>", "defines entities"),
        (f'<!DOCTYPE Xdmf [<!ENTITY x "{NUMBERS}">]>', f"{ONE}&x;</DataItem>", "defines entities"),
        (
            "",
            f'{ONE}<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="places.txt" parse="text"/></DataItem>',
            "cannot be read",
        ),
        ("", '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="item.xml"/>', "cannot be read"),
    ],
)
def test_text_of_other_files_is_not_taken_into_xdmf(tmp_path: Path, doctype: str, item: str, said: str) -> None:
    with pytest.raises(gb.InputError, match=said):
        gb.SolidMesh.read(xdmf(tmp_path / "a.xdmf", item, doctype), **READ)


@pytest.mark.usefixtures("reading_in_process")
def test_a_scenario_says_at_which_key(tmp_path: Path) -> None:
    xdmf(tmp_path / "a.xdmf", ITEMS["single quotes"])
    text = '[bodies.arm]\nmesh = "a.xdmf"\nunit = "m"\nclamp = "1"\ndamping_ratio = 0.01\n'
    metal = 'material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poissons_ratio = 0.3 }\n'
    (tmp_path / "a.toml").write_text(text + metal, encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"bodies\.arm\.mesh: .*keeps its numbers in places\.h5"):
        gb.read_scenario(tmp_path / "a.toml")


@pytest.mark.parametrize("name", ["a.node", "a.ele", "a.xml", "a.cgns"])
def test_meshes_in_several_files_are_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("8 3 0 0\n")
    with pytest.raises(gb.InputError, match=rf"{name} is .*; write it for Gmsh"):
        gb.SolidMesh.read(tmp_path / name, **READ)


@pytest.mark.usefixtures("reading_in_process")
def test_what_is_read_goes_by_the_content_of_its_file(tmp_path: Path) -> None:
    """Not by its time, which two writings within a few milliseconds share."""
    path = cube(tmp_path / "a.inp")
    status, length = path.stat(), np.ptp(read_mesh(path).points[:, 0])
    path.write_bytes(path.read_bytes().replace(b"1.0", b"2.0"))
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert path.stat().st_size == status.st_size and np.ptp(read_mesh(path).points[:, 0]) == 2 * length
