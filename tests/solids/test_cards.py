"""Masses, rigid links and springs in files of Nastran and Abaqus: the same as written for gbeam, and closed forms."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.linalg import eigh

import gbeam as gb
from gbeam.solids import coupling

from .bodies import STEEL, block
from .test_shells import sheet

pytestmark = pytest.mark.usefixtures("reading_in_process")

# In mm, t, N and s. Node 901 is at 900, beside the middle of the end, and 902 in the air.
PLACES = {900: (205.0, 4.0, 0.0), 901: (205.0, 4.0, 0.0), 902: (0.0, 0.0, 300.0)}
MASS, OFFSET, INERTIA = 1e-3, (3.0, 0.0, 5.0), np.array([[0.4, -0.05, 0.02], [-0.05, 0.5, 0.01], [0.02, 0.01, 0.6]])
SPRING, LUMP = 900.0, 2e-4  # N/mm and t


def written(folder: Path, ending: str) -> tuple[Path, list[int]]:
    """A block in a file, held at its wall, and the numbers of the corners of its end."""
    mesh = block("hexahedron20", (2, 1, 1), (200.0, 50.0, 30.0))
    used, cells = np.unique(mesh.cells[0].data, return_inverse=True)
    points, cells = mesh.points[used], cells.reshape(-1, 20)
    end, wall = cells[-1, [1, 2, 6, 5]], cells[0, [0, 3, 7, 4]]
    file = folder / f"part{ending}"
    if ending == ".inp":
        meshio.write(file, meshio.Mesh(points, {"hexahedron20": cells}, point_sets={"wall": wall, "end": end}))
    else:
        parts = [("hexahedron20", cells), ("quad", wall[None]), ("quad", end[None])]
        refs = {"nastran:ref": [np.array([1, 2]), np.array([7]), np.array([8])]}
        meshio.write(file, meshio.Mesh(points, parts, cell_data=refs))
    return file, [int(each) + 1 for each in end]


def nastran(folder: Path, *cards: str) -> Path:
    file, end = written(folder, ".bdf")
    grids = [f"GRID,{n},,{x},{y},{z}" for n, (x, y, z) in PLACES.items()]
    rigid = f"RBE2,91,900,123456,{','.join(map(str, end))}"
    text = "\n".join([*grids, rigid, *cards, "ENDDATA"])
    file.write_text(file.read_text().replace("ENDDATA", text))
    return file


def conm2(node: int, mass: float = MASS) -> str:
    i = INERTIA
    fields = [mass, *OFFSET, "", i[0, 0], -i[1, 0], i[1, 1], -i[2, 0], -i[2, 1], i[2, 2]]
    return f"CONM2,92,{node},,{','.join(map(str, fields[:5]))}\n+,{','.join(map(str, fields[5:]))}"


def read(file: Path, **more: Any) -> gb.SolidMesh:
    clamp = "7" if file.suffix == ".bdf" else "wall"
    return gb.SolidMesh.read(file, materials=STEEL, clamp=clamp, unit="mm", **more)


def frequencies(mesh: gb.SolidMesh, count: int = 6) -> np.ndarray:
    return mesh.reduced(modes=count, damping_ratio=0.01).frequency


def test_a_mass_with_offset_and_inertia_on_a_rigid_element(tmp_path: Path) -> None:
    """The body that the same link carries, its place from the middle of the link's nodes, in kg and m."""
    plain, _ = written(tmp_path, ".bdf")
    centre = 1e-3 * (np.array(PLACES[900]) + OFFSET - (200.0, 0.0, 0.0))
    body = gb.RigidBody(1e3 * MASS, 1e-3 * INERTIA, centre=tuple(centre))
    wanted = read(plain, links={"end": "8"}, carried={"end": body})
    mesh = read(nastran(tmp_path, conm2(900)), mass_unit="Mg")
    assert mesh.warnings == () and mesh.mass == pytest.approx(wanted.mass, rel=1e-12)
    np.testing.assert_allclose(frequencies(mesh), frequencies(wanted), rtol=1e-8)
    two = read(nastran(tmp_path, conm2(900, 0.4 * MASS).replace("92", "93"), conm2(900, 0.6 * MASS)), mass_unit="Mg")
    assert two.links.bodies["RBE2 91"].mass == pytest.approx(1.0)
    np.testing.assert_allclose(two.links.bodies["RBE2 91"].tensor, 2 * body.tensor, rtol=1e-9)


@pytest.mark.parametrize("way", [1, 3, 5])
def test_springs_of_a_rigid_element(tmp_path: Path, way: int) -> None:
    """Scalar and bush elements to the base, the bush at a node of its own in the same place."""
    plain, _ = written(tmp_path, ".bdf")
    names, value = ("x", "y", "z", "rx", "ry", "rz"), SPRING * (1e4 if way > 3 else 100.0)
    stiffness = {names[way - 1]: value * (1e-3 if way > 3 else 1e3)}
    mesh = read(nastran(tmp_path, f"CELAS2,5,{value},900,{way}"), mass_unit="Mg")
    if way > 3:  # wherever it is
        wanted = read(plain, links={"end": "8"}, springs={"s": {"between": ["end"], "stiffness": stiffness}})
        np.testing.assert_allclose(frequencies(mesh), frequencies(wanted), rtol=1e-8)
    k = [value if i == way else 0.0 for i in range(1, 7)]
    for cards in (
        (f"CBUSH,5,6,900,,,,,0\nPBUSH,6,K,{','.join(map(str, k))}",),
        (f"CELAS1,5,6,900,{way}\nPELAS,6,{value}",),
    ):
        np.testing.assert_allclose(
            frequencies(read(nastran(tmp_path, *cards), mass_unit="Mg")), frequencies(mesh), rtol=1e-10
        )


def test_a_mass_on_springs_has_its_frequencies(tmp_path: Path) -> None:
    """On no node of the solid: √(k/m) along three axes, beside the modes of the block."""
    k = [SPRING, 2 * SPRING, 3 * SPRING, 0.0, 0.0, 0.0]
    cards = f"CBUSH,5,6,902,,,,,0\nPBUSH,6,K,{','.join(map(str, k))}", f"CONM2,7,902,,{LUMP}"
    computed = frequencies(read(nastran(tmp_path, *cards), mass_unit="Mg"), 9)
    for each in np.sqrt(np.array(k[:3]) * 1e3 / (1e3 * LUMP)) / (2 * np.pi):
        assert np.abs(computed / each - 1).min() < 1e-6
    with pytest.raises(gb.InputError, match=r"node 902, which is on no node of the solid, and its springs leave it"):
        read(nastran(tmp_path, f"CONM2,7,902,,{LUMP}"), mass_unit="Mg")


def test_masses_of_nastran_need_no_pyyeti(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pyyeti changed how NumPy prints when it was imported; nor does the mesh need meshio."""
    file = nastran(tmp_path, conm2(900))
    for name in ("pyyeti", "meshio"):
        monkeypatch.setitem(sys.modules, name, None)
    assert read(file, mass_unit="Mg").links.bodies["RBE2 91"].mass == pytest.approx(1e3 * MASS)


def test_abaqus_says_the_same(tmp_path: Path) -> None:
    """Masses on the nodes of a set, springs from nodes to the base and between a rigid body's node and another."""
    file, end = written(tmp_path, ".inp")
    plain = file.read_text()
    masses = "".join(f"{500 + i}, {node}\n" for i, node in enumerate(end))
    file.write_text(
        f"{plain}*Element, type=MASS, elset=lumps\n{masses}*MASS, ELSET=lumps\n{LUMP}\n"
        f"*ELEMENT, TYPE=SPRING1, ELSET=props\n600, {end[0]}\n601, {end[1]}\n*Spring, elset=props\n3\n{SPRING}\n"
    )
    (words,) = read(file).warnings
    assert words.startswith("the mesh: MASS (1), SPRING (1) in part.inp are not read")
    mesh = read(file, mass_unit="Mg")
    assert mesh.warnings == () and mesh.mass == pytest.approx(read_plain(tmp_path, plain).mass + 4e3 * LUMP)
    other = nastran(tmp_path, *(f"CONM2,{80 + i},{n},,{LUMP}" for i, n in enumerate(end)),
                    *(f"CELAS2,{70 + i},{SPRING},{n},3" for i, n in enumerate(end[:2])))  # fmt: skip
    other.write_text("\n".join(line for line in other.read_text().splitlines() if "RBE2" not in line))
    np.testing.assert_allclose(frequencies(mesh), frequencies(read(other, mass_unit="Mg")), rtol=1e-9)
    assert frequencies(mesh)[0] != pytest.approx(frequencies(read_plain(tmp_path, plain))[0], rel=1e-3)
    rigid = "*NSET, NSET=face\n" + ", ".join(map(str, end)) + f"\n*RIGID BODY, NSET=face, REF NODE={end[0]}\n"
    file.write_text(plain + rigid)
    wanted = read_plain(tmp_path, plain, links={"end": "end"})
    np.testing.assert_allclose(frequencies(read(file, mass_unit="Mg")), frequencies(wanted), rtol=1e-9)


def test_rigid_bars_that_meet_are_one_rigid_element(tmp_path: Path) -> None:
    """Four from a node to the corners of the end, and one that hangs a mass on it."""
    card = conm2(902)
    wanted = frequencies(read(nastran(tmp_path, card, "RBE2,95,902,123456,900"), mass_unit="Mg"))
    file = nastran(tmp_path, card, "RBAR,95,900,902,123456")
    np.testing.assert_allclose(frequencies(read(file, mass_unit="Mg")), wanted, rtol=1e-10)
    text = file.read_text()
    (rigid,) = (line for line in text.splitlines() if line.startswith("RBE2"))
    ends = rigid.split(",")[4:]
    bars = "\n".join(f"RBAR,{i},900,{node},,123456" for i, node in enumerate(ends, 300))
    file.write_text(text.replace(rigid, bars))
    mesh = read(file, mass_unit="Mg")
    assert mesh.warnings == ()
    np.testing.assert_allclose(frequencies(mesh), wanted, rtol=1e-10)


def averaged(folder: Path, weights: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0), card: str = "") -> gb.SolidMesh:
    """A mass with offset and inertia on node 900, which moves as the corners of the end do on average."""
    file = nastran(folder, card or conm2(900))
    text = file.read_text()
    (rigid,) = (line for line in text.splitlines() if line.startswith("RBE2"))
    pairs = zip(weights, rigid.split(",")[4:], strict=True)
    fields = ["RBE3", "91", "", "900", "123456", *(str(x) for w, node in pairs for x in (w, 123, node))]
    lines = [",".join(fields[:9]), *("+," + ",".join(fields[i : i + 8]) for i in range(9, len(fields), 8))]
    file.write_text(text.replace(rigid, "\n".join(lines)))
    return read(file, mass_unit="Mg")


def test_an_rbe3_moves_as_its_nodes_do_on_average(tmp_path: Path) -> None:
    """Beside a body on an interface of a system, whose reduction has modes and answers to forces there."""
    mesh = averaged(tmp_path)
    assert mesh.warnings == ()
    computed = frequencies(mesh)
    np.testing.assert_allclose(frequencies(averaged(tmp_path, (2.0, 2.0, 2.0, 2.0))), computed, rtol=1e-10)
    plain, _ = written(tmp_path, ".bdf")
    bar = read(plain, interfaces={"end": "8"}).reduced(modes=30, damping_ratio=0)
    centre = 1e-3 * (np.array(PLACES[900]) + OFFSET - (200.0, 0.0, 0.0))
    body = gb.RigidBody(1e3 * MASS, 1e-3 * INERTIA, centre=tuple(centre))
    joints = {"wall": gb.Joint("fixed", "bar"), "mount": gb.Joint("fixed", "body", on="bar.end")}
    system = gb.System({"bar": bar.structure, "body": body}, joints)
    np.testing.assert_allclose(computed[:4], gb.modes(system).frequency[:4], rtol=1e-4)
    rigid = frequencies(read(nastran(tmp_path, conm2(900)), mass_unit="Mg"))
    assert (computed < rigid).all() and computed[3] < 0.997 * rigid[3]


@pytest.mark.parametrize("words", ["*KINEMATIC\n1, 3\n", "*DISTRIBUTING\n"])
def test_a_coupling_of_a_surface_that_is_not_there_is_refused(tmp_path: Path, words: str) -> None:
    file, _ = written(tmp_path, ".inp")
    plain = file.read_text()
    for first, name in (("", ""), ("*COUPLING, REF NODE=1, SURFACE=seat\n", "seat")):
        file.write_text(plain + first + words)
        with pytest.raises(
            gb.InputError, match=rf"^mesh has a coupling of surface '{name}', which is not there; export"
        ):
            read(file, mass_unit="Mg")


def test_distributing_couplings_are_an_rbe3(tmp_path: Path) -> None:
    """With the weights of their nodes, or with even ones of a surface of nodes."""
    wanted = frequencies(averaged(tmp_path, card="CONM2,92,900,,1e-3,0.,0.,0.,\n+,0.2,0.,2.,0.,0.,2."))
    file, end = written(tmp_path, ".inp")
    plain = file.read_text() + f"*NODE\n900, {', '.join(map(str, PLACES[900]))}\n" + BODY.format(node=900)
    even = "*SURFACE, NAME=seat, TYPE=NODE\nend\n*COUPLING, REF NODE=900, SURFACE=seat\n*DISTRIBUTING\n1, 6\n"
    old = "*ELEMENT, TYPE=DCOUP3D, ELSET=dc\n905, 900\n*DISTRIBUTING COUPLING, ELSET=dc\n"
    for words in (even, old + "".join(f"{each}, 0.5\n" for each in end)):
        file.write_text(plain + words)
        mesh = read(file, mass_unit="Mg")
        assert mesh.warnings == ()
        np.testing.assert_allclose(frequencies(mesh), wanted, rtol=1e-9)


def test_what_an_rbe3_carries_stiffens_the_solid_as_on_a_rigid_element(tmp_path: Path) -> None:
    """By nearly as much, where the end hardly bends."""
    rates, models = (0.0, 30.0), (averaged(tmp_path), read(nastran(tmp_path, conm2(900)), mass_unit="Mg"))
    shifts = []
    for each in models:
        structure = each.reduced(modes=6, damping_ratio=0).structure
        rest, spun = (gb.modes(structure, gb.Hub(radius=0.5, rate=rate)).frequency[:2] for rate in rates)
        shifts.append(spun**2 - rest**2)
    np.testing.assert_allclose(shifts[0], shifts[1], rtol=3e-3)


def test_weights_leave_rigid_motions_what_they_are() -> None:
    """Of unlike weights the mean of a rigid motion is that motion, and the force is shared out by them."""
    generator = np.random.default_rng(3)
    points, weights = generator.normal(size=(7, 3)), generator.uniform(0.2, 2.0, 7)
    centre, mean = coupling("", points, weights)
    shift, turn = generator.normal(size=(2, 3))
    moved = np.einsum("akc,kc->a", mean, shift + np.cross(turn, points))
    np.testing.assert_allclose(moved, [*(shift + np.cross(turn, centre)), *turn], atol=1e-12)
    np.testing.assert_allclose(mean[0, :, 0], weights / weights.sum())


@pytest.mark.parametrize("surface", ["NODE\nend", "ELEMENT\n2, S4", "ELEMENT\nlast, S4"])
def test_a_kinematic_coupling_is_a_rigid_link(tmp_path: Path, surface: str) -> None:
    """Of a surface of nodes or of a face, whose nodes are eight; its node in a second list of nodes."""
    file, end = written(tmp_path, ".inp")
    plain, mesh = file.read_text(), meshio.read(file)
    face = np.flatnonzero(mesh.points[:, 0] == 200.0) + 1 if "S4" in surface else end
    rest = "*NODE\n900, 205., 4., 0.\n" + BODY.format(node=900) + "*ELSET, ELSET=last\n2\n"
    coupled = f"*SURFACE, NAME=seat, TYPE={surface}\n*COUPLING, REF NODE=900, SURFACE=seat, CONSTRAINT NAME=c\n"
    file.write_text(f"{plain}{rest}{coupled}*KINEMATIC\n1, 3\n")
    read_back = read(file, mass_unit="Mg")
    assert read_back.warnings == () and list(read_back.links.nodes) == ["*COUPLING c"]
    nodes = f"*NSET, NSET=face\n{', '.join(map(str, face))}\n*RIGID BODY, NSET=face, REF NODE=900\n"
    (tmp_path / "rigid.inp").write_text(plain + rest + nodes)
    wanted = read(tmp_path / "rigid.inp", mass_unit="Mg")
    np.testing.assert_allclose(frequencies(read_back), frequencies(wanted), rtol=1e-9)
    file.write_text(f"{plain}{rest}{coupled}*KINEMATIC\n1, 2\n")
    with pytest.raises(gb.InputError, match="COUPLING c, which holds the components 1, 2 alone"):
        read(file, mass_unit="Mg")


# CalculiX 2.20's corner of the end of a bar of 200 mm, whose width grows from 50 to 54 mm, under -10, -20 and -30 N at
# the node of a distributing coupling of its two end faces, mm.
SHARED = [-5.543532e-4, -8.298605e-4, -3.400788e-3]


def test_a_distributing_coupling_shares_out_by_the_areas_of_faces(tmp_path: Path) -> None:
    """Of quadratic faces minus a twelfth for corners, a third for middles; of a mass on a light bar."""
    mesh = block("hexahedron20", (4, 2, 1), (200.0, 50.0, 30.0), lambda x: x * (1 + 4e-4 * x[:, :1] * [[0, 1, 0]]))
    used, cells = np.unique(mesh.cells[0].data, return_inverse=True)
    points, cells = mesh.points[used], cells.reshape(-1, 20)
    wall, end = (np.flatnonzero(points[:, 0] == x) for x in (0.0, 200.0))
    last = ", ".join(str(i + 1) for i, each in enumerate(cells) if np.isin(each, end).any())
    file = tmp_path / "bar.inp"
    meshio.write(file, meshio.Mesh(points, {"hexahedron20": cells}, point_sets={"wall": wall}))
    coupled = f"*NODE\n900, 210., 4., 3.\n*ELSET, ELSET=last\n{last}\n*SURFACE, NAME=seat, TYPE=ELEMENT\nlast, S4\n"
    coupled += "*COUPLING, REF NODE=900, SURFACE=seat, CONSTRAINT NAME=c\n*DISTRIBUTING\n1, 6\n"
    file.write_text(f"{file.read_text()}{coupled}*ELEMENT, TYPE=MASS, ELSET=m\n900, 900\n*MASS, ELSET=m\n0.01\n")
    light = gb.Material(0.1, 210e9, poissons_ratio=0.3)
    corner = {"tip": tuple(1e-3 * points[end[0]])}
    solid = gb.SolidMesh.read(file, materials=light, clamp="wall", unit="mm", mass_unit="Mg", points=corner)
    structure = solid.reduced(modes=3, damping_ratio=0).structure
    tip = 1e3 * np.asarray(gb.static(structure, acceleration=(1.0, 2.0, 3.0)).tip)
    np.testing.assert_allclose(tip, SHARED, rtol=2e-5)
    (weights,) = solid.links.weights.values()
    np.testing.assert_allclose(np.sort(weights)[[0, -1]], [-2 * 27.0 * 30.0 / 12, 2 * 27.0 * 30.0 / 3], rtol=1e-12)
    file.write_text(file.read_text().replace("last, S4", "last, S9"))
    with pytest.raises(gb.InputError, match="masses, links or springs that cannot be read"):
        read(file, mass_unit="Mg")


def read_plain(folder: Path, text: str, **more: Any) -> gb.SolidMesh:
    file = folder / "plain.inp"
    file.write_text(text)
    return read(file, **more)


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("CONM2,92,900,3,0.1", "has CONM2 92, which is in coordinate system 3; export it in the basic system"),
        ("CONM2,92,2,,0.1,5.", "has CONM2 92, which has an offset or inertia on node 2, which does not turn"),
        ("RBE2,95,902,3,1,2", "has RBE2 95, which holds the components 3 alone"),
        ("RBE2,95,902,123,900,901", "has RBE2 91, which shares nodes with RBE2 95; make them one"),
        ("RBAR,95,902,900,123,456", "has RBAR 95, which holds the components 123 and 456 of its ends"),
        ("RBE3,95,,902,123456,1.0,3,1,2", "has RBE3 95, which holds the components 123456 by the components 3"),
        ("RBE3,95,,900,123456,1.0,123,1,2,4", "has RBE3 95, which moves node 900, which the solid or a rigid link"),
        ("CELAS2,5,1.0,900,1,902,1", r"has CELAS2 5, which joins nodes 0.363 m apart"),
        ("CELAS2,5,1.0,900,1,901,2", "has CELAS2 5, which joins unlike components"),
        ("CELAS1,5,6,900,1", "has CELAS1 5, which names PELAS 6, which is not there"),
        ("CBUSH,5,6,900,,1.0,0.,0.", "has CBUSH 5, which has axes of its own"),
        ("CELAS2,5,1.0,2,4", "has CELAS2 5, which turns node 2 of the solid, which does not"),
        ("CELAS2,5,1.0,77777,1", "names node 77777, which is not there"),
    ],
)  # fmt: skip
def test_what_cannot_be_said_is_refused_by_name(tmp_path: Path, card: str, words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        read(nastran(tmp_path, card), mass_unit="Mg")


def test_a_unit_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(gb.InputError, match=r"mass_unit is 'mm'.*"):
        read(nastran(tmp_path, conm2(900)), mass_unit="mm")


def test_a_damaged_card_is_placed(tmp_path: Path) -> None:
    with pytest.raises(gb.InputError, match=r"part.bdf has masses, links or springs that cannot be read: .*mend"):
        read(nastran(tmp_path, "CONM2,92,x,,0.1"), mass_unit="Mg")


def tipped(folder: Path, words: str, **more: Any) -> gb.SolidMesh:
    """A strip of shells, 200 x 10 x 2 mm, its tip in the middle at node 900, read with statements besides its mesh."""
    mesh = sheet("quad8", (8, 1), (200.0, 10.0))
    used, cells = np.unique(mesh.cells[0].data, return_inverse=True)
    places = mesh.points[used] - (0, 5.0, 0)
    ends = {name: np.flatnonzero(places[:, 0] == x) for name, x in (("wall", 0.0), ("end", 200.0))}
    file = folder / "strip.inp"
    meshio.write(file, meshio.Mesh(places, {"quad8": cells.reshape(-1, 8)}, point_sets=ends))
    tip = int(ends["end"][places[ends["end"], 1] == 0][0]) + 1
    section = "*SHELL SECTION, ELSET=ALL, MATERIAL=STEEL\n2.\n"
    file.write_text(file.read_text() + section + words.format(tip=tip))
    unit = {"mass_unit": "Mg"} if words else {}
    return gb.SolidMesh.read(file, materials=STEEL, clamp="wall", unit="mm", thickness="2 mm", **unit, **more)


BODY = """*ELEMENT, TYPE=MASS, ELSET=m
900, {node}
*MASS, ELSET=M
1e-3
*ELEMENT, TYPE=ROTARYI, ELSET=j
901, {node}
*ROTARY INERTIA, ELSET=j
0.2, 2., 2.
"""


def test_a_body_on_shells(tmp_path: Path) -> None:
    """On an edge that is rigid, or on its middle alone, beside a body on the end of a beam without mass."""
    edge = "*RIGID BODY, NSET=end, REF NODE={tip}\n" + BODY.replace("node", "tip")
    body = gb.RigidBody(1.0, np.diag([2e-4, 2e-3, 2e-3]))
    rigid = tipped(tmp_path, edge)
    wanted = tipped(tmp_path, "", links={"end": "end"}, carried={"end": body})
    assert rigid.warnings == ()
    np.testing.assert_allclose(frequencies(rigid, 4), frequencies(wanted, 4), rtol=1e-8)
    length, bent = 0.2, STEEL.youngs_modulus * 0.01 * 0.002**3 / 12
    stiffness = bent * np.array([[12 / length**3, -6 / length**2], [-6 / length**2, 4 / length]])
    closed = np.sqrt(eigh(stiffness, np.diag([1.0, 2e-3]), eigvals_only=True)) / 2 / np.pi
    for mesh, close in ((rigid, 2e-3), (tipped(tmp_path, BODY.replace("node", "tip")), 0.015)):
        computed = frequencies(mesh, 3)
        for each in closed:
            assert np.abs(computed / each - 1).min() < close


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (
            "*SURFACE, NAME=seat\n1, S3\n*COUPLING, REF NODE=900, SURFACE=seat\n*KINEMATIC\n1, 3\n",
            "has the edge S3 of a",
        ),
        (
            "*ELEMENT, TYPE=SPRING1, ELSET=s\n902, {tip}\n*SPRING, ELSET=S, NONLINEAR\n3\n1., 0.\n9., 1.\n",
            "is not linear",
        ),
        ("*ELEMENT, TYPE=SPRINGA, ELSET=s\n902, {tip}, 1\n*SPRING, ELSET=s\n0\n9.\n", "joins unlike components"),
        ("*MASS, ELSET=n\n1e-3\n", "masses, links or springs that cannot be read: 'n'"),
    ],
)
def test_what_abaqus_says_otherwise_is_refused_by_name(tmp_path: Path, words: str, problem: str) -> None:
    with pytest.raises(gb.InputError, match=rf"^mesh .*{problem}"):
        tipped(tmp_path, words)


def test_a_node_of_a_shell_turns_about_axes_across_its_normal(tmp_path: Path) -> None:
    """Whichever way round the mesh is; about the normal nothing holds it, and a spring there does nothing."""
    words = BODY.replace("node", "tip")
    alone = frequencies(tipped(tmp_path, words), 5)
    np.testing.assert_allclose(frequencies(tipped(tmp_path, words, turn=(0.3, -0.2, 0.9)), 5), alone, rtol=1e-8)
    spring = "*ELEMENT, TYPE=SPRING1, ELSET=s\n902, {tip}\n*SPRING, ELSET=s\n"
    about = [frequencies(tipped(tmp_path, f"{words}{spring}{way}\n1e6\n"), 5) for way in (5, 6)]
    np.testing.assert_allclose(about[1], alone, rtol=1e-9)
    clamped = np.sqrt(12 * STEEL.youngs_modulus * 0.01 * 0.002**3 / 12 / 0.2**3) / 2 / np.pi
    assert about[0][0] == pytest.approx(clamped, rel=0.025)
    heavier = tipped(tmp_path, "*ELEMENT, TYPE=MASS, ELSET=m\n900, {tip}\n*MASS, ELSET=m\n1e-3\n")
    assert heavier.mass == pytest.approx(tipped(tmp_path, "").mass + 1.0)
