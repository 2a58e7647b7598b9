"""Meshes that cannot be what they should: each error names the place, the value and the fix."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb

from .bodies import STEEL, block, solid

pytestmark = pytest.mark.usefixtures("reading_in_process")


def mesh(kind: str = "hexahedron20") -> meshio.Mesh:
    return block(kind, (2, 1, 1), (0.2, 0.05, 0.03), groups={"line": lambda x: (x[:, 0] == 0) & (x[:, 1] == 0)})


def triangles() -> meshio.Mesh:
    return meshio.Mesh(np.eye(3), {"triangle": np.array([[0, 1, 2]])})


def pyramids() -> meshio.Mesh:
    return meshio.Mesh(np.random.default_rng(1).random((5, 3)), {"pyramid": np.arange(5)[None]})


def inverted() -> meshio.Mesh:
    each = mesh()
    each.cells[0].data[1] = each.cells[0].data[1][
        [4, 5, 6, 7, 0, 1, 2, 3, *range(12, 16), *range(8, 12), *range(16, 20)]
    ]
    return each


def folded() -> meshio.Mesh:
    each = mesh("hexahedron")
    each.points[each.cells[0].data[1, 6]] -= (0.25, 0, 0)
    return each


def two_parts() -> meshio.Mesh:
    one, other = mesh("tetra10"), mesh("tetra10")
    count = len(one.points)
    cells = np.concatenate([one.cells[0].data, other.cells[0].data + count])
    points = np.concatenate([one.points, np.add(other.points, (0, 0.05, 0))])
    return meshio.Mesh(points, {"tetra10": cells}, point_sets=one.point_sets)


def far() -> meshio.Mesh:
    """Of a damaged file: the squares of such places are not finite."""
    each = mesh()
    each.points[0, 1] = -4.207e209
    return each


def endless() -> meshio.Mesh:
    each = mesh()
    each.points[0] = np.nan
    return each


BAD: list[tuple[Callable[[], Any], dict[str, Any], str]] = [
    (triangles, {}, r"mesh has no solid elements: 1 of kind triangle; give thickness, for shells, or mesh the volume"),
    (pyramids, {}, r"mesh has 1 elements of kind pyramid; use tetra, tetra10"),
    (inverted, {}, r"mesh has 1 element turned inside out or folded: 2; mesh it again"),
    (folded, {}, r"mesh has 1 element turned inside out or folded: 2;"),
    (endless, {}, r"mesh has points of shape .* or not finite"),
    (far, {}, r"mesh has a node at 4.207e\+209 in a unit of 1 m; write it again"),
    (
        two_parts,
        {},
        r"clamp holds a part of .* nodes about .* at 0 nodes, so that it moves without strain; clamp three",
    ),
    (mesh, {"clamp": "line"}, r"clamp holds the mesh at 2 nodes, so that it moves without strain"),
    (mesh, {"clamp": []}, r"clamp holds the mesh at 0 nodes"),
    (mesh, {"clamp": "wal"}, r"clamp is 'wal', which is no group of the mesh; choose from wall, line"),
    (mesh, {"materials": {"1": STEEL}}, r"materials\.1 is '1', which is no group of the mesh"),
    (mesh, {"materials": gb.Material(7850, 210e9)}, r"materials\.poissons_ratio is missing, and a solid needs it"),
    (mesh, {"materials": gb.Material(7850, 210e9, poissons_ratio=0.5)}, r"poissons_ratio is 0\.5; .* lock"),
    (mesh, {"materials": gb.Material(7850, 210e9, poissons_ratio=0.3, shear_modulus=1e9)}, r"give a gb\.Orthotropic"),
    (mesh, {"unit": "kg"}, r"unit is 'kg'"),
    (mesh, {"points": {"far": (9.0, 0, 0)}}, r"points\.far is .* m from the nearest node"),
    (mesh, {"points": {"all": "wall"}}, r"points\.all is the group 'wall' of 8 nodes; give one node"),
    (mesh, {"points": {"hub": (0, 0, 0)}}, r"points\.name is 'hub'"),
    (mesh, {"point_masses": {"wall": -1.0}}, r"point_masses\.wall is -1 kg"),
]


@pytest.mark.parametrize(("write", "arguments", "words"), BAD)
def test_bad_meshes_are_refused(write: Callable[[], Any], arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        gb.SolidMesh.read(write(), **({"materials": STEEL, "clamp": "wall", "unit": "m"} | arguments))


def test_materials_that_overlap_or_leave_out_are_refused() -> None:
    each = mesh()
    each.cell_sets = {"half": [np.array([0])], "whole": [np.array([0, 1])]}
    with pytest.raises(gb.InputError, match="materials give 1 elements none"):
        solid(each, {"half": STEEL})
    with pytest.raises(gb.InputError, match="materials give 1 elements two: 'half' and 'whole'"):
        solid(each, {"half": STEEL, "whole": STEEL})


def test_nodes_that_no_element_uses_are_left_out() -> None:
    """Nodes of a hexahedron of 27 nodes of which 20 are used; and a group that has only such nodes is refused."""
    each = mesh()
    assert len(solid(each).points) == 32 < len(each.points) == 45
    each.point_sets["middles"] = np.setdiff1d(np.arange(45), each.cells[0].data)
    with pytest.raises(gb.InputError, match="clamp is 'middles', which has no node of a solid element"):
        gb.SolidMesh.read(each, materials=STEEL, clamp="middles", unit="m")


def test_millimetres_by_mistake_are_warned_of() -> None:
    """With the mass, and in every result."""
    each = mesh()
    each.points = 1000 * np.asarray(each.points)
    model = solid(each).reduced(modes=2, damping_ratio=0.01)
    words = "the mesh is 208 m across and weighs 2.36e+09 kg with unit = 'm'; is it mm?"
    assert words in model.mesh.warnings
    assert words in gb.static(model.structure, acceleration=(0, 0, 1.0)).warnings
    right = gb.SolidMesh.read(each, materials=STEEL, clamp="wall", unit="mm")
    assert right.warnings == () and right.mass == pytest.approx(7850 * 0.2 * 0.05 * 0.03)


def test_linear_elements_are_said_to_lock() -> None:
    (words,) = solid(mesh("hexahedron")).warnings
    assert words.startswith(
        "2 linear elements bend too stiffly (shear locking): use quadratic ones; 2 fill a thickness"
    )


def test_a_file_that_is_too_large_says_what_its_mesh_would_cost(tmp_path: Path) -> None:
    """A file of 2 GB, all of it empty, is not read."""
    with (tmp_path / "large.inp").open("wb") as file:
        file.truncate(2 * 10**9)
    words = (
        r"mesh has 2 GB, as files of meshes have with some 5e\+07 unknowns, whose factors would take about .*B and .* h"
    )
    with pytest.raises(gb.InputError, match=words):
        solid(tmp_path / "large.inp")


def test_more_modes_than_unknowns() -> None:
    with pytest.raises(gb.InputError, match=r"modes is 100, of 72 unknowns; give 1 to 72"):
        solid(mesh()).reduced(modes=100, damping_ratio=0)


def test_what_is_no_mesh(tmp_path: Path) -> None:
    for text in (b"garbage", b"$MeshFormat\n4.1 1 8\n\1\0\0\0\n$EndMeshFormat\n$Nodes\n"):
        (tmp_path / "solid.msh").write_bytes(text)
        with pytest.raises(gb.InputError, match=r"mesh .*solid\.msh cannot be read: \w.+; give a file of Gmsh"):
            solid(tmp_path / "solid.msh")
    lacking = "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n"
    (tmp_path / "solid.inp").write_text(lacking, encoding="utf-8")
    with pytest.raises(gb.InputError, match=r"mesh has element 1 on node 2, which is not in solid\.inp"):
        solid(tmp_path / "solid.inp")
    (tmp_path / "solid.inp").write_text("*NODE\n1, 0, 0, 0\n*NSET, NSET=wall\n2\n", encoding="utf-8")
    with pytest.raises(gb.InputError, match=r"solid\.inp cannot be read: number 2 is named in it, and is not there"):
        solid(tmp_path / "solid.inp")
    with pytest.raises(gb.InputError, match=r"mesh .* is a folder"):
        solid(tmp_path)
    with pytest.raises(OSError):
        solid(tmp_path / "none.msh")


@pytest.mark.parametrize(
    ("name", "file_format"),
    [("a.inp", "abaqus"), ("a.bdf", "nastran"), ("a.msh", "gmsh22"), ("b.msh", "gmsh"), ("a.vtk", "vtk42")],
)
def test_an_element_on_a_node_that_is_not_there_is_named(tmp_path: Path, name: str, file_format: str) -> None:
    """By its number in the file, as is the node; of VTK, which has no numbers, by their places."""
    whole, file = mesh("hexahedron20"), tmp_path / name
    used, cells = np.unique(whole.cells[0].data, return_inverse=True)
    cells = cells.reshape(-1, 20)
    last = len(used) - 1
    where = int(np.argwhere((cells == last).any(axis=1))[0, 0]) + 1
    options = {} if name.endswith(("inp", "bdf")) else {"binary": False}
    if file_format == "vtk42":
        cells[cells == last] = 998
    meshio.write(file, meshio.Mesh(whole.points[used], {"hexahedron20": cells}), file_format=file_format, **options)
    head, word, tail = file.read_text().partition("$Elements" if name.endswith("msh") else "*ELEMENT")
    node = last + 1 if name.endswith("bdf") else 999
    renumbered = re.sub(rf"(?<=[\s,]){last + 1}\b", "999", tail)
    file.write_text(head.replace(f"GRID*   {node} ", f"GRID*   {node + 1} ") + word + renumbered)
    place = f"of {last + 1}; write it" if file_format == "vtk42" else f"which is not in {name}; write it again with all"
    with pytest.raises(gb.InputError, match=rf"mesh has element {where} on node {node},? {place}"):
        gb.SolidMesh.read(file, materials=STEEL, clamp="wall", unit="m")


def lines(start: str, *more: str) -> str:
    return "\n".join([start, *more, ""])


CUBE = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
NODES = lines("*NODE", *(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(CUBE, 11)))
INP = (
    NODES
    + lines("*ELEMENT, TYPE=C3D8, ELSET=all", "1, 11, 12, 13, 14,", "15, 16, 17, 18")
    + "*NSET, NSET=wall\n11, 12, 13, 14\n"
)
GRIDS = [f"GRID,{i},,{x}.,{y}.+0,{z}.0D0" for i, (x, y, z) in enumerate(CUBE, 11)]
BDF = lines("BEGIN BULK", *GRIDS, "CHEXA,5,1,11,12,13,14,15,16,+", "+,17,18", "CQUAD4,6,7,11,12,13,14", "ENDDATA")


def test_what_is_no_mesh_no_clamp_and_no_metal_is_said(tmp_path: Path) -> None:
    """An empty file, all nodes held, a coarser mesh that is the same, and 2.7 g/cm³ and 70 GPa without their units."""
    (tmp_path / "empty.msh").touch()
    with pytest.raises(gb.InputError, match=r"^mesh .*empty\.msh is empty; write it again"):
        gb.SolidMesh.read(tmp_path / "empty.msh", materials=STEEL, clamp="wall", unit="m")
    (tmp_path / "a.inp").write_text(INP + "*NSET, NSET=every\nwall\n15, 16, 17, 18\n")
    arguments: dict[str, Any] = {"materials": STEEL, "clamp": "wall", "unit": "m"}
    with pytest.raises(gb.InputError, match="clamp holds all 8 nodes; name the surface that is screwed on"):
        gb.SolidMesh.read(tmp_path / "a.inp", **(arguments | {"clamp": "every"}))
    cube = gb.SolidMesh.read(tmp_path / "a.inp", **arguments)
    same = cube.reduced(modes=1, damping_ratio=0.0)
    for ratio, place in (2.0, "damping_ratio"), ([0.02] * 9 + [1.5], r"damping_ratio\[9\]"):
        with pytest.raises(gb.InputError, match=f"{place} is .*; give a ratio of critical damping from 0 up to 1"):
            cube.reduced(modes=1, damping_ratio=ratio)
    (doubt,) = cube.reduced(modes=1, damping_ratio=0.5).structure.warnings[-1:]
    assert (
        doubt
        == "damping_ratio is 0.5, outside the plausible 0 to 0.3; did you mean 0.5 %?"
        not in same.structure.warnings
    )
    with pytest.raises(gb.InputError, match="coarser has 8 nodes, and the mesh 8; give one with larger elements"):
        cube.reduced(modes=1, damping_ratio=0.0, coarser=same)
    slips = gb.SolidMesh.read(
        tmp_path / "a.inp", **(arguments | {"materials": gb.Material(2.7, 70e3, poissons_ratio=0.3)})
    )
    said = " ".join(slips.warnings)
    assert "material.density is 2.7 kg/m^3, outside the plausible" in said and "did you mean 2.7 g/cm^3?" in said
    assert "material.youngs_modulus is 70000 Pa" in said and not [each for each in cube.warnings if "material" in each]


@pytest.mark.parametrize(
    "cards",
    [
        ("SPC1,3,123,11,12,13,14",),
        ("SPC1,3,123456,1,THRU,14",),
        ("SPC1*" + "".join(f"{each:>16}" for each in (3, 123, 11, 12))[3:] + "\n*" + f"{13:>23}{14:>16}",),
        ("SPC,3,11,123,,12,123456", "SPC,3,13,1234,0.,14,321"),
    ],
)  # fmt: skip
def test_what_a_nastran_file_holds_is_a_group(tmp_path: Path, cards: tuple[str, ...]) -> None:
    """Where no surface is in it; but not what leaves a way free."""
    surface = "CQUAD4,6,7,11,12,13,14"
    (tmp_path / "a.bdf").write_text(BDF.replace(surface, "\n".join(cards)))
    read = gb.SolidMesh.read(tmp_path / "a.bdf", materials=STEEL, clamp="SPC 3", unit="m")
    assert read.numbers[read.clamped].tolist() == [11, 12, 13, 14]
    (tmp_path / "a.bdf").write_text(BDF.replace(surface, "\n".join([*cards, "SPC1,3,12,15"])))
    with pytest.raises(gb.InputError, match="clamp is 'SPC 3', which is no group of the mesh; choose from 1"):
        gb.SolidMesh.read(tmp_path / "a.bdf", materials=STEEL, clamp="SPC 3", unit="m")


@pytest.mark.parametrize(("name", "text", "clamp"), [("a.inp", INP, "wall"), ("a.bdf", BDF, "7")])
def test_a_node_has_its_number_in_the_file(tmp_path: Path, name: str, text: str, clamp: str) -> None:
    """The node at which the stress is largest."""
    (tmp_path / name).write_text(text)
    cube = gb.SolidMesh.read(tmp_path / name, materials=STEEL, clamp=clamp, unit="m").reduced(
        modes=1, damping_ratio=0.0
    )
    worst = cube.stress(gb.static(cube.structure, acceleration=(3.0, 2.0, 1.0))).worst
    assert worst.place == pytest.approx(CUBE[worst.node - 11])


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("a.inp", "*ELEMENT", "*NODE\n12, 1., 1., 1.\n*ELEMENT", "has two of node 12; number them apart, in one part"),
        ("a.inp", "*NSET", "*ELEMENT, TYPE=C3D4\n1, 11, 12, 13, 15\n*NSET", "has two of element 1; number them apart"),
        ("a.inp", "*NODE", "*INCLUDE, INPUT=b.inp\n*NODE", "has places or nodes by INCLUDE, which is not read; .* one"),
        ("a.inp", "*NODE", "*SYSTEM\n1., 0., 0.\n*NODE", "has places or nodes by SYSTEM, which is not read"),
        ("a.inp", "*NODE", "*NODE, SYSTEM=C", "has places or nodes by NODE, which is not read; .* in the basic system"),
        ("a.inp", "*NODE", "*INSTANCE, NAME=a\n5., 0., 0.\n*NODE", "has places or nodes by INSTANCE, which"),
        ("a.inp", "C3D8,", "C3D20,", r"a\.inp cannot be read: elements of type C3D20 have not 20 nodes each; give"),
        ("a.inp", "*NODE", "*ELEMENT, TYPE=C3D8, INPUT=b.inp\n*NODE", "has places or nodes by ELEMENT, which is not"),
        ("a.inp", "*NSET", "*ELSET, ELSET=some\nothers\n*NSET", "cannot be read: set others is named in it, and"),
        ("a.inp", "C3D8,", "SC8R,", r"cannot be read: elements of type SC8R are not known"),
        ("a.bdf", "GRID,12,,", "GRID,11,,", "has two of node 11"),
        ("a.bdf", "CQUAD4", "INCLUDE 'b.bdf'\nCQUAD4", "has places or nodes by INCLUDE, which is not read"),
        ("a.bdf", "+,17,18", "+,17", "cannot be read: CHEXA 5 has 7 nodes"),
        ("a.bdf", "13,14\nEND", "13,14,,0.5\nEND", "has CQUAD4 6, which has an offset or thicknesses of its own"),
        ("a.bdf", "GRID,12", "= ,12", "cannot be read: '= ,12.*' is no card"),
    ],
)  # fmt: skip
def test_what_a_text_file_says_otherwise_is_refused(tmp_path: Path, name: str, old: str, new: str, words: str) -> None:
    """Of a cube that is read: places that are elsewhere, numbers that are twice, elements that lack nodes."""
    (tmp_path / name).write_text(BDF if name == "a.bdf" else INP)
    arguments = {"materials": STEEL, "clamp": "7" if name == "a.bdf" else "wall", "unit": "m"}
    whole = gb.SolidMesh.read(tmp_path / name, **arguments)
    assert (whole.mass, list(whole.blocks[0].numbers)) == (pytest.approx(7850.0), [5 if name == "a.bdf" else 1])
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new, 1))
    with pytest.raises(gb.InputError, match=rf"^mesh .*{words}"):
        gb.SolidMesh.read(tmp_path / name, **arguments)


@pytest.mark.parametrize(
    ("old", "new"),
    [("C3D8,", f"S{'1' * 20_000}-,"), ("*NSET", f"*CQUAD{'X' * 20_000}-\n*NSET"), ("C3D8,", f"C3D{'8' * 20_000}-,")],
)
def test_long_words_take_no_more_than_their_length(tmp_path: Path, old: str, new: str) -> None:
    """In the square of their 20 kB some took seconds."""
    (tmp_path / "a.inp").write_text(INP.replace(old, new, 1))
    begin = time.process_time()
    with suppress(gb.InputError):
        gb.SolidMesh.read(tmp_path / "a.inp", materials=STEEL, clamp="wall", unit="m")
    assert time.process_time() - begin < 1.5


def test_many_heads_of_gmsh_take_no_more_than_their_length(tmp_path: Path) -> None:
    (tmp_path / "a.msh").write_bytes(b"$MeshFormat 2 1 " * 20_000)
    begin = time.process_time()
    with pytest.raises(gb.InputError, match="mesh"):
        gb.SolidMesh.read(tmp_path / "a.msh", materials=STEEL, clamp="wall", unit="m")
    assert time.process_time() - begin < 1.5


# A cube in two groups, of which version 2 has its element twice, and a wall.
GROUPED = lines("$PhysicalNames", "3", '2 7 "wall"', '3 1 "a"', '3 2 "b"', "$EndPhysicalNames")
OF_GMSH = {
    "2.2": lines("$Nodes", "8", *(f"{{{i}}} {x} {y} {z}" for i, (x, y, z) in enumerate(CUBE)), "$EndNodes", "$Elements",
                 "3", "1 3 2 7 1 {0} {1} {2} {3}", "2 5 2 1 1 {0} {1} {2} {3} {4} {5} {6} {7}",
                 "3 5 2 2 1 {0} {1} {2} {3} {4} {5} {6} {7}", "$EndElements"),
    "4.1": lines("$Entities", "0 0 1 1", "1 0 0 0 1 1 0 1 -7 0", "1 0 0 0 1 1 1 2 1 2 0", "$EndEntities",
                 "$Nodes", "1 8 1 8", "3 1 0 8", *(f"{{{i}}}" for i in range(8)), *(f"{x} {y} {z}" for x, y, z in CUBE),
                 "$EndNodes", "$Elements", "2 2 1 2", "2 1 3 1", "1 {0} {1} {2} {3}", "3 1 5 1",
                 "2 {0} {1} {2} {3} {4} {5} {6} {7}", "$EndElements"),
}  # fmt: skip


@pytest.mark.parametrize("place", ["1", "1 1", "1 1 1 0"])
def test_a_node_of_gmsh_without_three_coordinates_is_named(tmp_path: Path, place: str) -> None:
    """Nodes of two coordinates each would come out as fewer nodes of three."""
    text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + GROUPED + OF_GMSH["2.2"].format(*range(77, 85))
    for number in (83, 77):
        text = re.sub(rf"\n{number} [01] [01] [01]\n", f"\n{number} {place}\n", text)
        (tmp_path / "a.msh").write_text(text)
        named = rf"^mesh has node {number} with {len(place.split())} coordinates; give x, y and z of each"
        with pytest.raises(gb.InputError, match=named):
            gb.SolidMesh.read(tmp_path / "a.msh", materials=STEEL, clamp="wall", unit="m")


def test_coordinates_that_nastran_leaves_out_are_zero(tmp_path: Path) -> None:
    """A card in fields of 16 without its second line."""
    (tmp_path / "a.bdf").write_text(BDF.replace(GRIDS[1], f"GRID*   {12:>16}{'':16}{'1.':>16}{'0.':>16}"))
    read = gb.SolidMesh.read(tmp_path / "a.bdf", materials=STEEL, clamp="7", unit="m")
    assert read.mass == pytest.approx(7850.0)


@pytest.mark.parametrize("version", OF_GMSH)
@pytest.mark.parametrize("first", [0, 77])
def test_nodes_of_gmsh_may_have_any_numbers_and_elements_two_groups(tmp_path: Path, version: str, first: int) -> None:
    text = GROUPED + OF_GMSH[version].format(first, *range(8, 1, -1))
    (tmp_path / "a.msh").write_text(f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n{text}")
    for material in ("a", "b", "2"):
        cube = gb.SolidMesh.read(tmp_path / "a.msh", materials={material: STEEL}, clamp="wall", unit="m")
        assert (cube.mass, int(cube.clamped.sum())) == (pytest.approx(7850.0), 4)


def test_a_binary_file_of_gmsh_with_a_node_0_is_refused(tmp_path: Path) -> None:
    """Meshio takes it for the last one."""
    meshio.write(tmp_path / "a.msh", meshio.Mesh(CUBE, {"hexahedron": [range(8)]}), file_format="gmsh22")
    content = (tmp_path / "a.msh").read_bytes()
    (tmp_path / "a.msh").write_bytes(content.replace(b"8\n\x01", b"8\n\x00"))
    with pytest.raises(gb.InputError, match="mesh has node 0; write it as text, or number its nodes from 1"):
        gb.SolidMesh.read(tmp_path / "a.msh", materials=STEEL, clamp="1", unit="m")


def test_wedges_of_15_nodes_that_meshio_lacks_are_said(tmp_path: Path) -> None:
    """Gmsh's in binary, as it writes them."""
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.option.setNumber("Mesh.Binary", 1)
        base = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.extrude([(2, base)], 0, 0, 1, numElements=[1], recombine=True)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "a.msh"))
    finally:
        gmsh.finalize()
    with pytest.raises(gb.InputError, match="has wedges of 15 nodes, which meshio lacks; write it for Gmsh as text"):
        gb.SolidMesh.read(tmp_path / "a.msh", materials=STEEL, clamp="1", unit="m")


def test_a_library_that_meshio_needs_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MED's."""
    monkeypatch.setitem(sys.modules, "h5py", None)
    (tmp_path / "a.med").write_bytes(b"HDF")
    with pytest.raises(gb.InputError, match='h5py is not installed; install it with: pip install "h5py"'):
        gb.SolidMesh.read(tmp_path / "a.med", materials=STEEL, clamp="wall", unit="m")
