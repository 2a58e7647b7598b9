"""A beam of gbeam's own by its matrices, with the tip as an interface, written by the libraries of their formats and
read back; CalculiX's and Nastran's own files; what is missing from a file.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
from scipy import sparse

import gbeam as gb
from gbeam.io import model_of

pytestmark = pytest.mark.usefixtures("reading_in_process")

ROOT, TIP = 7, 12  # numbers of nodes


@dataclass(frozen=True)
class Reduced:
    """A Craig-Bampton model: matrices, what their rows are, and nodes; stiffness by the stress of the base's motion."""

    mass: np.ndarray
    stiffness: np.ndarray
    unknowns: np.ndarray
    nodes: np.ndarray
    geometric: dict[str, np.ndarray]

    @property
    def named(self) -> np.ndarray:
        """Numbers of the nodes and directions, as files have them."""
        numbers = np.where(self.unknowns[:, 1] == 0, 100 + np.arange(len(self.unknowns)), 0)
        nodes = np.array([ROOT, TIP])[self.unknowns[:, 0]]
        return np.stack([np.where(self.unknowns[:, 1] == 0, numbers, nodes), self.unknowns[:, 1]], axis=1)


def beam() -> gb.Structure:
    """A strip in space with five shapes."""
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    return gb.assemble(gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01), "FOAM", axial=1, y=2, z=2)


def with_root(basis: np.ndarray) -> np.ndarray:
    """Mass matrix of the root's six unknowns and of coordinates in another basis."""
    c = beam().coefficients
    f = -np.stack([*c.f_a, *c.f_al]) @ basis
    xx, yy, zz, xy, yz, zx = c.rigid[4:]
    second = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    x, y, z = c.rigid[1:4]
    cross = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    body = np.block([[c.rigid[0] * np.eye(3), cross], [cross.T, np.trace(second) * np.eye(3) - second]])
    return np.block([[body, f], [f.T, basis.T @ c.mass @ basis]])


def reduced() -> Reduced:
    """Its root with six unknowns, its tip with three in place of three coordinates, and the other two coordinates."""
    c, tip = beam().coefficients, beam().station_places.first[-1]
    turn = np.linalg.inv(np.stack([*tip, *np.eye(5)[[1, 3]]]))  # one shape along y and one along z go
    # The tip's displacement is absolute: it moves with the root as well, by e_c x r.
    length = 0.3
    follow = np.zeros((5, 6))
    follow[:3, :3], follow[1, 5], follow[2, 4] = np.eye(3), length, -length
    to = np.block([[np.eye(6), np.zeros((6, 5))], [-follow, np.eye(5)]])
    unknowns = [(0, way) for way in range(1, 7)] + [(1, way) for way in (1, 2, 3)] + [(0, 0)] * 2

    def spread(inner: np.ndarray) -> np.ndarray:
        return to.T @ np.block([[np.zeros((6, 6)), np.zeros((6, 5))], [np.zeros((5, 6)), turn.T @ inner @ turn]]) @ to

    stress = {f"a_{way}": spread(each) for way, each in zip("xyz", c.k_a, strict=True)}
    at = np.array([(0, 0, 0), (length, 0, 0)])
    return Reduced(to.T @ with_root(turn) @ to, spread(c.stiffness), np.array(unknowns), at, stress)


def compare(read: Any, rtol: float) -> None:
    """The imported beam's frequencies, equilibrium and flight are the beam's."""
    root, tip = read.numbers[0], read.numbers[-1]
    at = {"tip": int(tip)} if len(read.numbers) > 1 else None
    model = read.reduced(modes=5, damping_ratio=0.01, clamp=[int(root)], points=at)
    np.testing.assert_allclose(model.rest[0], beam().rest[0], rtol=rtol)
    whole = beam().coefficients
    np.testing.assert_allclose(model.coefficients.rigid, whole.rigid, atol=rtol * np.abs(whole.rigid).max())
    if at is not None:
        load = np.array([3.0, -2.0, 8.0])
        still = np.linalg.solve(whole.stiffness, load @ whole.f_a)
        mine = np.linalg.solve(model.coefficients.stiffness, load @ model.coefficients.f_a)
        tips = (s.station_places.first[-1] @ q for s, q in ((model, mine), (beam(), still)))
        np.testing.assert_allclose(*tips, rtol=10 * rtol)


def flown(structure: gb.Structure) -> np.ndarray:
    flight = gb.Flight(acceleration=gb.constant(np.array([3.0, -2.0, 8.0])))
    return gb.simulate(structure, flight, duration=0.05, step=1e-3).displacement[:, -1]


def test_matrices_of_a_beam_fly_as_the_beam() -> None:
    """To the last digits, with its stiffness under acceleration; without it the size of what is left out is said."""
    each = reduced()
    model = gb.ImportedModel(each.mass, each.stiffness, each.nodes, each.unknowns)
    how = dict(modes=5, damping_ratio=0.01, clamp=[0], points={"tip": 1})
    stiffened = model.reduced(**how, geometric=each.geometric)
    assert any("of alpha_x, alpha_y" in said and "a_x" not in said.split("of ")[0] for said in stiffened.warnings)
    flight = gb.Flight(acceleration=gb.constant(np.array([3.0, -2.0, 8.0])))
    mine, theirs = (gb.static(s, flight).tip for s in (stiffened, beam()))
    np.testing.assert_allclose(mine[1:], theirs[1:], rtol=1e-9)  # along x the beam's tip moves to second order as well
    mine, theirs = (flown(s)[:, 1:] for s in (stiffened, beam()))
    np.testing.assert_allclose(mine, theirs, rtol=1e-8, atol=1e-12)
    plain = model.reduced(**how)
    push = gb.Flight(acceleration=gb.constant(np.array([50.0, 0, 0])))  # compresses it
    said = [line for line in gb.modes(plain, push).warnings if "the order of" in line]
    stated = float(said[0].split("order of ")[1].split(" %")[0]) / 100
    # Of the same order: of an even cantilever 1.6 times a / (w² L).
    true = 1 - (gb.modes(beam(), push).frequency[0] / gb.modes(plain, push).frequency[0]) ** 2
    assert 1 / 3 < true / stated < 3
    mass = float(beam().coefficients.rigid[0])
    plain = model.reduced(**how, total_mass=mass, centre=(0.15, 0, 0))
    with pytest.raises(gb.InputError, match=r"centre is not that of the matrix, \(0\.15, 0, 0\) m"):
        model.reduced(**how, centre=(0.1, 0, 0))


def test_a_system_says_how_large_the_stiffness_is_that_matrices_lack() -> None:
    """On a body that turns, in every answer, as alone on a hub: of the order of what the beam of them stiffens by."""
    rate, radius = 20.0, 0.1
    strip = read_whole().reduced(modes=5, damping_ratio=0.01, clamp=[0])
    hub = gb.RigidBody(1.0, (0.1, 0.1, 0.1), points={"rim": (radius, 0, 0)})
    spin = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=rate)
    clamp = gb.Joint("fixed", "strip", on="hub.rim")
    system = gb.System({"hub": hub, "strip": strip}, {"spin": spin, "clamp": clamp})
    alone = gb.modes(strip, gb.Hub(radius=radius, rate=rate))
    shares = []
    for answer in (alone, gb.modes(system), gb.static(system), gb.simulate(system, duration=0.05, step=1e-3)):
        said = [line for line in answer.warnings if "the order of" in line]
        assert [line.startswith("strip: its motion loads") for line in said] == [answer is not alone]
        shares.append(float(said[0].split("order of ")[1].split(" %")[0]) / 100)
    assert shares == [shares[0]] * 4
    frequency = [gb.modes(beam(), gb.Hub(radius=radius, rate=each)).frequency[0] for each in (0.0, rate)]
    assert 1 / 3 < ((frequency[1] / frequency[0]) ** 2 - 1) / shares[0] < 3
    still = gb.System({"hub": hub, "strip": strip}, {"spin": replace(spin, rate=0.0), "clamp": clamp})
    assert not any("the order of" in line for line in gb.modes(still).warnings)


def write_mtx(folder: Path, each: Reduced) -> list[Path]:
    paths = []
    for name, matrix in (("M", each.mass), ("K", each.stiffness)):
        lines = ["** MATRIX INPUT"]
        for i, j in zip(*np.tril_indices(len(matrix)), strict=True):
            pairs = (",".join(map(str, (-node if way == 0 else node, way))) for node, way in each.named[[i, j]])
            lines.append(f"{','.join(pairs)}, {matrix[i, j]!r}".replace("np.float64(", "").replace(")", ""))
        paths.append(folder / f"{name}.mtx")
        paths[-1].write_text("\n".join(lines), encoding="ascii")
    return [*paths, nodes_inp(folder, each)]


def nodes_inp(folder: Path, each: Reduced) -> Path:
    rows = [
        f"{number}, {x!r}, {y!r}, {z!r}" for number, (x, y, z) in zip((ROOT, TIP), each.nodes.tolist(), strict=True)
    ]
    path = folder / "nodes.inp"
    path.write_text("*HEADING\n** a beam\n*NODE, NSET=ALL\n" + "\n".join(rows) + "\n*STEP\n", encoding="ascii")
    return path


def write_substructure(folder: Path, each: Reduced) -> list[Path]:
    named = each.named
    lines = [f"*USER ELEMENT,NODES={len(named)},LINEAR", "** ELEMENT NODES"]
    lines.append("** " + ",".join(str(node) for node, _ in named))
    lines += [f"{place},{way}" if place > 1 else f"{way}" for place, (_, way) in enumerate(named, 1)]
    for kind, matrix in (("STIFFNESS", each.stiffness), ("MASS", each.mass)):
        lines.append(f"*MATRIX,TYPE={kind}")
        lines += [",".join(f"{value:.17E}" for value in matrix[i, : i + 1]) + "," for i in range(len(matrix))]
    (folder / "sub.mtx").write_text("\n".join(lines), encoding="ascii")
    return [folder / "sub.mtx", nodes_inp(folder, each)]


def write_storage(folder: Path, each: Reduced) -> list[Path]:
    for ending, matrix in (("sti", each.stiffness), ("mas", each.mass)):
        lines = [f"{j + 1} {i + 1} {matrix[i, j]:.17e}" for i, j in zip(*np.tril_indices(len(matrix)), strict=True)]
        (folder / f"beam.{ending}").write_text("\n".join(lines), encoding="ascii")
    (folder / "beam.dof").write_text("\n".join(f"{node}.{way}" for node, way in each.named), encoding="ascii")
    return [*(folder / f"beam.{ending}" for ending in ("sti", "mas", "dof")), nodes_inp(folder, each)]


def write_grids(folder: Path, each: Reduced) -> Path:
    bulk = pytest.importorskip("pyyeti.nastran.bulk")
    bulk.wtgrids(str(folder / "grids.bdf"), [ROOT, TIP], xyz=each.nodes, form="{:16.9E}")
    return folder / "grids.bdf"


def write_punch(folder: Path, each: Reduced) -> list[Path]:
    pytest.importorskip("pyyeti")
    import pandas as pd
    from pyyeti.nastran import bulk

    index = pd.MultiIndex.from_arrays(each.named.T, names=["id", "dof"])
    matrices = {"KAAX": each.stiffness, "MAAX": each.mass}
    frames = {name: pd.DataFrame(matrix, index=index, columns=index) for name, matrix in matrices.items()}
    bulk.wtdmig(str(folder / "beam.pch"), frames)
    return [folder / "beam.pch", write_grids(folder, each)]


WRITERS: dict[str, tuple[Callable[..., list[Path]], float]] = {
    "Abaqus's matrix input": (write_mtx, 1e-11),
    "a substructure": (write_substructure, 1e-11),
    "CalculiX's matrix storage": (write_storage, 1e-11),
    "direct matrix input": (write_punch, 1e-7),  # ten digits
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_beam_comes_back_from_files(tmp_path: Path, name: str) -> None:
    write, rtol = WRITERS[name]
    compare(gb.ImportedModel.read(*write(tmp_path, reduced())), rtol)


def read_whole() -> gb.ImportedModel:
    """The beam with its tip."""
    each = reduced()
    return gb.ImportedModel(each.mass, each.stiffness, each.nodes, each.unknowns)


def test_fields_of_simscape_are_read(tmp_path: Path) -> None:
    """One interface frame, the root, and modes, which do not say where their mass is; a structure of MATLAB's too."""
    stiffness = np.pad(beam().coefficients.stiffness, ((6, 0), (6, 0)))
    fields = {"M": with_root(np.eye(5)), "K": stiffness, "P": np.zeros((1, 3))}
    np.savez(tmp_path / "rom.npz", **fields)
    scipy.io.savemat(tmp_path / "rom.mat", {"rom": fields})
    for name in ("rom.npz", "rom.mat"):
        read = gb.ImportedModel.read(tmp_path / name)
        assert str(read) == "ImportedModel(1 nodes, 11 unknowns, 5 of them modes)"
        compare(read, 1e-11)
        model = read.reduced(modes=5, damping_ratio=0, clamp=[1])
        assert any("do not say where the mass of their modes is" in said for said in model.warnings)
        # Its only node is at the root: the even beam's length is that of its mass.
        assert model.length == pytest.approx(0.3, rel=1e-3)
        assert "the tip, node 1, is clamped and stays at 0" in model.warnings
        push = gb.Flight(acceleration=gb.constant(np.array([50.0, 0, 0])))
        stated = [line for line in gb.modes(model, push).warnings if "the order of" in line]
        whole = read_whole().reduced(modes=5, damping_ratio=0, clamp=[0], points={"tip": 1})
        assert stated == [line for line in gb.modes(whole, push).warnings if "the order of" in line]


def test_units_of_length_and_mass(tmp_path: Path) -> None:
    """In millimetres and tonnes the same beam."""
    each = reduced()
    length = np.where((each.unknowns[:, 1] > 0) & (each.unknowns[:, 1] < 4), 1.0, 1e3)
    scale = 1e-3 * np.outer(length, length)
    other = Reduced(each.mass * scale, each.stiffness * scale, each.unknowns, 1e3 * each.nodes, {})
    compare(gb.ImportedModel.read(*write_storage(tmp_path, other), length_unit="mm", mass_unit="Mg"), 1e-11)


TOWER = """*NODE
1,0,0,0
2,1,0,0
3,1,1,0
4,0,1,0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
9,0,0,2
10,1,0,2
11,1,1,2
12,0,1,2
*ELEMENT, TYPE=C3D8, ELSET=EALL
1,1,2,3,4,5,6,7,8
2,5,6,7,8,9,10,11,12
*MATERIAL, NAME=METAL
*ELASTIC
70e9,0.3
*DENSITY
2700
*SOLID SECTION, ELSET=EALL, MATERIAL=METAL
*BOUNDARY
1,1,3
2,1,3
3,1,3
4,1,3
"""


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_calculix_writes_what_is_read(tmp_path: Path) -> None:
    """Matrix storage and a substructure of two cubes; its frequencies are those that CalculiX prints."""
    for name, step in (
        ("modes", "*STEP\n*FREQUENCY\n4\n*END STEP\n"),
        ("tower", "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n4\n*END STEP\n"),
        (
            "part",
            "*STEP\n*SUBSTRUCTURE GENERATE\n*RETAINED NODAL DOFS, SORTED=NO\n5,1,3\n6,1,3\n"
            "*SUBSTRUCTURE MATRIX OUTPUT, FILE NAME=sub, OUTPUT FILE=USER DEFINED, STIFFNESS=YES\n*END STEP\n",
        ),
    ):
        (tmp_path / f"{name}.inp").write_text(TOWER + step, encoding="ascii")
        subprocess.run(["ccx", name], cwd=tmp_path, check=True, capture_output=True)
    read = gb.ImportedModel.read(*(tmp_path / f"tower.{ending}" for ending in ("sti", "mas", "dof", "inp")))
    model = read.reduced(modes=4, damping_ratio=0)
    lines = (tmp_path / "modes.dat").read_text(encoding="ascii").splitlines()
    first = next(i for i, line in enumerate(lines) if "CYCLES/TIME" in line) + 1
    printed = [float(line.split()[3]) for line in lines[first : first + 20] if len(line.split()) == 5][:4]
    np.testing.assert_allclose(model.rest[0][:4] / (2 * np.pi), printed, rtol=1e-6)
    part, k = gb.read_matrix(tmp_path / "sub.mtx", "K").toarray(), read.stiffness.toarray()
    # CalculiX 2.20 holds what is not retained in place, where it should let it follow: these are the rows as they are.
    np.testing.assert_allclose(part, k[:6, :6], atol=1e-12 * k.max())


def nastran_file(name: str) -> str:
    """A file of Nastran's that comes with pyyeti (BSD-3-Clause)."""
    package = pytest.importorskip("pyyeti")
    path = Path(package.__file__).parent / "tests" / "nas2cam_extseout" / name
    if not path.exists():
        pytest.skip("pyyeti came without its tests")
    return str(path)


def test_an_external_superelement_has_the_frequencies_of_its_f06() -> None:
    """NX Nastran's outboard.out prints them, and the mass that the grid point weight generator finds."""
    read = gb.ImportedModel.read(*(nastran_file(f"outboard.{ending}") for ending in ("asm", "pch", "op4")))
    printed = {"total_mass": 1.590384, "centre": (184.6398, 150, 150)}
    model = read.reduced(modes=22, damping_ratio=0.02, clamp=read.numbers.tolist(), **printed)
    printed = [1.650001, 1.650249, 1.674265, 1.674687, 7.025350, 7.025411]
    np.testing.assert_allclose(model.rest[0][:6] / (2 * np.pi), printed, rtol=5e-7)


def test_files_are_named_and_not_looked_for(tmp_path: Path) -> None:
    """Beside another, or in one that it includes: a result would not hold them."""
    lacking = r"beam\.sti is given without beam\.dof, which says what its rows are; name that file too"
    with pytest.raises(gb.InputError, match=lacking):
        gb.ImportedModel.read(*(path for path in write_storage(tmp_path, reduced()) if path.suffix != ".dof"))
    with pytest.raises(gb.InputError, match=r"outboard\.asm is given without outboard\.pch"):
        gb.ImportedModel.read(nastran_file("outboard.asm"), nastran_file("outboard.op4"))
    grids = write_grids(tmp_path, reduced())
    for including in (f"INCLUDE '{grids}'", f"  include '{grids}'"):
        (tmp_path / "whole.bdf").write_text(f"{including}\n", encoding="ascii")
        with pytest.raises(gb.InputError, match=r"whole\.bdf includes other files; delete those lines, and name the"):
            gb.ImportedModel.read(tmp_path / "whole.bdf", *write_mtx(tmp_path, reduced()))


def test_an_op2_file_has_the_eigenvalues_of_its_f06() -> None:
    """The modal stiffness in NX Nastran's assemble.op2, and the cycles that assemble.out prints for modes 7 to 12."""
    stiffness = gb.read_matrix(nastran_file("assemble.op2"), "KHH")
    stiffness = stiffness.toarray() if sparse.issparse(stiffness) else stiffness
    printed = [1.698800, 1.767487, 1.857720, 3.419612, 7.024210, 7.025409]
    np.testing.assert_allclose(np.sqrt(np.diag(stiffness)[6:12]) / (2 * np.pi), printed, rtol=5e-7)
    assert not (stiffness - np.diag(np.diag(stiffness))).any()


def test_op4_is_read_in_every_form(tmp_path: Path) -> None:
    op4 = pytest.importorskip("pyyeti.nastran.op4")
    matrix = reduced().stiffness
    for binary in (True, False):
        for form in ("dense", "bigmat", "nonbigmat"):
            path = tmp_path / f"{binary}{form}.op4"
            op4.write(str(path), {"kaa": matrix}, binary=binary, sparse=form)
            read = gb.read_matrix(path, "KAA")
            np.testing.assert_allclose(read.toarray() if sparse.issparse(read) else read, matrix, rtol=1e-15)


@pytest.mark.parametrize("order", [("nodes.inp", "grids.bdf"), ("grids.bdf", "nodes.inp")])
def test_a_node_has_its_axes_whichever_of_two_files_comes_first(tmp_path: Path, order: tuple[str, str]) -> None:
    """Axes of node 2 by CORD2R (x along y, y against x); node 1 is in the other file only, whose nodes have none."""
    pytest.importorskip("pyyeti")
    (tmp_path / "nodes.inp").write_text("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n", encoding="ascii")
    cards = ["CORD2R,7,0,0.,0.,0.,0.,0.,1.", ",0.,1.,0.", "GRID,2,0,1.,0.,0.,7", "GRID,3,0,2.,0.,0.,0"]
    (tmp_path / "grids.bdf").write_text("\n".join(["BEGIN BULK", *cards, "ENDDATA", ""]), encoding="ascii")
    model = model_of([tmp_path / name for name in order])
    unknowns = np.array([(node, way) for node in (1, 2, 3) for way in range(1, 7)])
    places, numbers, _, axes = model.nodes_of(None, unknowns)
    np.testing.assert_array_equal(numbers, [1, 2, 3])
    np.testing.assert_array_equal(places, [[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    np.testing.assert_allclose(axes, [np.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], np.eye(3)], atol=1e-12)
