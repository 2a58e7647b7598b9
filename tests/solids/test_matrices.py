"""Matrices of other programs: beams of nodes with rotations, solids written out, files, and what they cannot be."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from scipy import sparse

import gbeam as gb
from gbeam.solids import mass_matrix, stiffness_matrix

from .bodies import block, solid

pytestmark = pytest.mark.usefixtures("reading_in_process")

L, E, RHO, B, H = 0.5, 70e9, 2700.0, 0.02, 0.01
EI_Y, EI_Z, EA, GJ, MU = E * B * H**3 / 12, E * H * B**3 / 12, E * B * H, 1e3, RHO * B * H  # about y: bending along z


def frame(elements: int, rotary: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass and stiffness of a beam along x by Hermite's elements with lumped masses, six unknowns a node, and nodes."""
    h, count = L / elements, elements + 1
    k = np.zeros((6 * count, 6 * count))
    for e in range(elements):
        i, j = 6 * e, 6 * e + 6
        for unknown, stiffness in ((0, EA), (3, GJ)):
            pair = [i + unknown, j + unknown]
            k[np.ix_(pair, pair)] += stiffness / h * np.array([[1, -1], [-1, 1]])
        for way, turn, sign, stiffness in ((1, 5, 1, EI_Z), (2, 4, -1, EI_Y)):
            four, s = [i + way, i + turn, j + way, j + turn], sign
            k[np.ix_(four, four)] += stiffness / h**3 * np.array(
                [[12, 6 * h * s, -12, 6 * h * s], [6 * h * s, 4 * h * h, -6 * h * s, 2 * h * h],
                 [-12, -6 * h * s, 12, -6 * h * s], [6 * h * s, 2 * h * h, -6 * h * s, 4 * h * h]]
            )  # fmt: skip
    lumps = np.full(count, MU * h)
    lumps[[0, -1]] /= 2
    m = np.diag(np.kron(lumps, [1, 1, 1, rotary, rotary, rotary]))
    return m, k, np.stack([np.linspace(0, L, count), *np.zeros((2, count))], axis=1)


# First roots β L of the frequency equations, and forces of supports over the weight.
HELD: dict[str, tuple[list[gb.Support], list[int], list[float], list[float]]] = {
    "clamped": ([gb.Support("tip", ["z", "ry"])], [0], [4.73004074, 7.85320462], [1 / 2]),
    "pinned": ([gb.Support("tip", ["z"])], [0], [3.92660231, 7.06858275], [3 / 8]),
    "hinged": (
        [gb.Support("foot", ["x", "y", "z", "rx", "rz"]), gb.Support("tip", ["z"])],
        [],
        [np.pi, 2 * np.pi],
        [1 / 2, 1 / 2],
    ),
}


@pytest.mark.parametrize("name", HELD)
def test_a_beam_of_nodes_is_held_at_its_points(name: str) -> None:
    supports, clamp, roots, forces = HELD[name]
    model = gb.ImportedModel(*frame(40, rotary=1e-9))
    held = model.reduced(modes=8, damping_ratio=0.01, clamp=clamp, points={"foot": 0}, supports=supports)
    modes = gb.modes(held)
    flap = np.array([f for f, way in zip(modes.frequency, modes.direction, strict=True) if way == "z"][:2])
    np.testing.assert_allclose(np.sqrt(2 * np.pi * flap) * (MU / EI_Y) ** 0.25 * L, roots, rtol=1e-3)
    loads = gb.static(held, acceleration=(0.0, 0.0, 5.0)).loads
    assert loads is not None and loads.support_force is not None
    np.testing.assert_allclose(loads.support_force[0, :, 2] / (5 * MU * L), forces, rtol=1e-3)
    whole = loads.root_force[0] + loads.support_force[0].sum(axis=0)
    np.testing.assert_allclose(whole, [0, 0, 5 * MU * L], atol=1e-9)


def test_a_spring_of_a_node_is_that_of_a_beam() -> None:
    section, metal = gb.Section.rectangle(B, H), gb.Material(RHO, E)
    stay = {"z": 3e3, "ry": 20.0}
    beam = gb.Beam(L, section, metal, damping_ratio=0.0, rotary_inertia=False, supports=[gb.Support(L, stiffness=stay)])
    true = gb.assemble(beam, "FOAM", z=6)
    spring = gb.Support("tip", stiffness=stay)
    ours = gb.ImportedModel(*frame(40, rotary=1e-9)).reduced(modes=6, damping_ratio=0.0, clamp=[0], supports=[spring])
    modes = gb.modes(ours)
    flap = [f for f, way in zip(modes.frequency, modes.direction, strict=True) if way == "z"][:2]
    np.testing.assert_allclose(flap, gb.modes(true).frequency[:2], rtol=1e-3)
    loads = [gb.static(each, acceleration=(0.0, 0.0, 5.0)).loads for each in (ours, true)]
    for name in ("support_force", "support_moment"):
        mine, theirs = (getattr(each, name)[0, 0] for each in loads)
        np.testing.assert_allclose(mine, theirs, rtol=1e-3, atol=1e-6)


def test_what_matrices_cannot_hold_is_refused() -> None:
    m, k, nodes = frame(8)
    whole, plain = gb.ImportedModel(m, k, nodes), gb.ImportedModel(np.eye(27), np.eye(27), nodes)
    how = dict(modes=2, damping_ratio=0.0)
    for model, supports, keys, words in (
        (whole, [gb.Support("lid", ["z"])], {"clamp": [0]}, r"supports\[0\]\.at is 'lid'; choose one of tip"),
        (
            plain,
            [gb.Support("tip", ["ry"])],
            {},
            r"supports\[0\] holds ry at tip, whose node has no such unknown",
        ),
        (whole, [gb.Support("tip", ["z"])], {}, r"supports leave the body free to move along x and along y"),
        (
            whole,
            2 * [gb.Support("tip", ["z"])],
            {"clamp": [0]},
            r"supports\[1\] holds z at tip, where it is held",
        ),
    ):
        with pytest.raises(gb.InputError, match=words):
            model.reduced(**how, supports=supports, **keys)


def test_a_beam_of_nodes_is_the_beam() -> None:
    """Euler and Bernoulli's frequencies and deflection; the base's acceleration reaches all nodes."""
    m, k, nodes = frame(40)
    model = gb.ImportedModel(m, k, nodes).reduced(modes=6, damping_ratio=0.01, clamp=[0], points={"middle": 20})
    unit = np.sqrt(EI_Y / MU / L**4)
    flap = [f for f, way in zip(gb.modes(model).frequency, gb.modes(model).direction, strict=True) if way == "z"]
    np.testing.assert_allclose(2 * np.pi * np.array(flap[:2]) / unit, [3.51602, 22.0345], rtol=2e-3)
    far = gb.ImportedModel(m, k, nodes).reduced(modes=1, damping_ratio=0.01, clamp=[40])
    assert far.station_places.r0[-1, 0] == pytest.approx(39 / 40 * L)  # the tip is free
    rest = gb.static(model, acceleration=(0.0, 0.0, 5.0))
    assert -rest.tip[2] == pytest.approx(5 * MU * L**4 / 8 / EI_Y, rel=1e-3)
    np.testing.assert_allclose(rest.displacement[0, 2] / rest.tip[2], 17 / 48, rtol=1e-3)
    rigid = model.coefficients.rigid
    np.testing.assert_allclose(rigid[[0, 1, 4]], [MU * L, MU * L**2 / 2, MU * L**3 / 3], rtol=1e-3)
    flown = gb.simulate(model, gb.Flight(z=gb.constant(5.0)), duration=0.05, step=1e-3)
    assert flown.body.points == ("middle", "tip") and flown.outcome == "done"
    assert any("no geometric stiffness is given" in each for each in flown.warnings)


def test_matrices_of_a_solid_are_the_solid_without_its_geometric_stiffness() -> None:
    """To the last digits, sparse; what is left out is what a spin shows."""
    mesh = solid(block("hexahedron20", (3, 1, 1), (0.3, 0.03, 0.02)))
    m = sparse.kron(mass_matrix(mesh.points, mesh.blocks), sparse.eye_array(3))
    k = stiffness_matrix(mesh.points, mesh.blocks)
    whole = mesh.reduced(modes=5, damping_ratio=0.02).structure
    ours = gb.ImportedModel(m, k, mesh.points).reduced(
        modes=5, damping_ratio=0.02, clamp=np.flatnonzero(mesh.clamped).tolist(),
        total_mass=7850 * 0.3 * 0.03 * 0.02, centre=(0.15, 0, 0),
    )  # fmt: skip
    assert ours.size == whole.size
    for name in ("mass", "damping", "stiffness", "rigid"):
        theirs = getattr(whole.coefficients, name)
        np.testing.assert_allclose(getattr(ours.coefficients, name), theirs, atol=1e-7 * np.abs(theirs).max())
    at = dict(acceleration=(3.0, -20.0, 40.0))
    flight = gb.Flight(acceleration=gb.constant(np.array(at["acceleration"])))
    tips = [gb.static(each, flight).tip for each in (ours, whole)]
    np.testing.assert_allclose(tips[0], tips[1], rtol=1e-4)
    spun = [gb.modes(each, gb.Hub(radius=0.0, rate=300.0)).frequency[0] for each in (ours, whole)]
    assert spun[0] < spun[1]


def test_rotations_with_mass_feel_the_base() -> None:
    """The frequencies are those of the whole matrix, and so are the forces of the base's angular acceleration."""
    m, k, nodes = frame(20, rotary=1e-5)
    model = gb.ImportedModel(m, k, nodes).reduced(modes=4, damping_ratio=0, clamp=[0])
    assert any("of a mode's mass does not feel Coriolis" in each for each in model.warnings)
    kf, mf = k[6:, 6:], m[6:, 6:]
    square = np.sort(np.linalg.eigvals(np.linalg.solve(mf, kf)).real)
    np.testing.assert_allclose(model.rest[0][:4] ** 2, square[:4], rtol=1e-8)
    # About its own axis the beam has the nodes' inertia alone.
    rigid = np.kron(np.ones(21), [0, 0, 0, 1, 0, 0])
    twist = np.linalg.solve(kf, -(m @ rigid)[6:])
    c = model.coefficients
    answer = np.linalg.solve(c.stiffness, c.f_al[0])
    assert answer @ c.f_al[0] == pytest.approx(twist @ -(m @ rigid)[6:], rel=1e-9)
    assert c.rigid[5] + c.rigid[6] == pytest.approx(MU * L * 1e-5, rel=1e-9)


SPRINGS = np.diag([100.0, 200.0, 300.0])


def skewed() -> np.ndarray:
    each = SPRINGS.copy()
    each[0, 1] = 50.0
    return each


BAD: list[tuple[dict[str, Any], str]] = [
    ({"stiffness": skewed()}, r"stiffness is not symmetric: 50 in row 0, column 1, and 0 across"),
    ({"stiffness": -SPRINGS}, r"stiffness is not positive: -100 on the diagonal in row 0"),
    ({"stiffness": np.array([[1, 2, 0], [2, 1, 0], [0, 0, 1.0]])}, r"stiffness is not positive definite; hold"),
    ({"mass": np.array([[1, 2, 0], [2, 1, 0], [0, 0, 1.0]])}, r"modes is 2, and only|mass"),
    ({"stiffness": np.zeros((3, 3))}, r"stiffness is not positive definite; hold|stiffness is singular"),
    ({"stiffness": np.eye(2)}, r"stiffness has 2 rows; give 3, as the other matrix has"),
    ({"mass": np.ones((3, 2))}, r"mass has the shape \(3, 2\); give a square matrix"),
    ({"mass": np.full((3, 3), np.nan)}, r"mass has values that are not finite"),
    ({"mass": "M.mtx"}, r"mass is no matrix of numbers"),
    ({"nodes": np.full((1, 3), 3e200)}, r"nodes has a node at 3e\+200 in a unit of 1 m"),
    ({"nodes": np.zeros((2, 3))}, r"nodes has the shape \(2, 3\), and the matrices 3 rows"),
    ({"total_mass": 2e-3}, r"total_mass is 0\.002 kg, and the matrix has 2 kg; are the units those of SI"),
    ({"centre": (0.4, 0, 0), "nodes": [(0.1, 0, 0)]}, r"centre is not that of the matrix, \(0\.1, 0, 0\) m"),
    ({"inertia": np.eye(3)}, r"inertia is not that of the matrix, 0, 0, 0 kg m² on the diagonal"),
    ({"points": {"camera": 1}}, r"points\.camera is 1, which is no node; give the number of one, from 0 to 0"),
    ({"clamp": [-1]}, r"clamp\[0\] is -1, which is no node; give"),
    ({"modes": 4}, r"modes is 4, of 3 unknowns"),
]


@pytest.mark.parametrize(("changed", "words"), BAD)
def test_matrices_that_cannot_be_are_refused(changed: dict[str, Any], words: str) -> None:
    model = {"mass": 2 * np.eye(3), "stiffness": SPRINGS, "nodes": [(0.1, 0.0, 0.0)]}
    how = {"modes": 2, "damping_ratio": 0.0}
    gb.ImportedModel(**model).reduced(**how)
    of_model = {name: changed[name] for name in model if name in changed}
    with pytest.raises(gb.InputError, match=words):
        gb.ImportedModel(**(model | of_model)).reduced(
            **(how | {name: each for name, each in changed.items() if name not in model})
        )


WRITERS: dict[str, Callable[[Path], Any]] = {
    "k.mtx": lambda path: scipy.io.mmwrite(path, sparse.coo_array(SPRINGS), symmetry="symmetric"),
    "k.npz": lambda path: sparse.save_npz(path, sparse.csr_array(SPRINGS)),
    "k.npy": lambda path: np.save(path, SPRINGS),
    "both.npz": lambda path: np.savez(path, K=SPRINGS, M=np.eye(3), name=np.array("model")),
    "both.mat": lambda path: scipy.io.savemat(path, {"K": sparse.csc_array(SPRINGS), "M": np.eye(3), "count": 3}),
}


def write_mat_7_3(path: Path, fields: dict[str, Any]) -> None:
    """A structure as MATLAB saves it with -v7.3, which stores matrices by columns."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in fields.items():
            if sparse.issparse(value):
                columns = sparse.csc_array(value)
                group = file.create_group(f"rom/{name}")
                group.attrs["MATLAB_sparse"] = np.uint64(columns.shape[0])
                group["data"], group["ir"], group["jc"] = columns.data, columns.indices, columns.indptr
            else:
                file[f"rom/{name}"] = value.T
        file["rom/about"] = np.array([[109]], dtype=np.uint16)
        file["#refs#/a"] = np.eye(2)
    with open(path, "r+b") as head:
        head.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\0\2IM")


def test_matrices_come_from_mat_files_of_version_7_3(tmp_path: Path) -> None:
    """As from those of version 5, sparse and full, in a structure."""
    m, k, nodes = frame(4)
    k[0, 1] = 2e-9 * k.max()  # tells rows from columns, and is no more than rounding
    fields = {"M": sparse.csc_array(m), "K": k, "nodes": nodes}
    write_mat_7_3(tmp_path / "new.mat", fields)
    scipy.io.savemat(tmp_path / "old.mat", {"rom": fields})
    np.testing.assert_array_equal(gb.read_matrix(tmp_path / "new.mat", "K"), k)
    new, old = (
        gb.ImportedModel.read(tmp_path / f"{age}.mat").reduced(modes=3, damping_ratio=0.01, clamp=[0])
        for age in ("new", "old")
    )
    np.testing.assert_array_equal(new.rest[0], old.rest[0])


@pytest.mark.parametrize("nodes", [0, 2, 5])
def test_files_with_other_nodes_than_rows_are_refused(tmp_path: Path, nodes: int) -> None:
    np.savez(tmp_path / "m.npz", K=SPRINGS, M=np.eye(3))
    lines = [f"{k}, 0.{k}, 0., 0." for k in range(1, nodes + 1)]
    (tmp_path / "n.inp").write_text("\n".join(["*NODE", *lines, ""]), encoding="ascii")
    with pytest.raises(
        gb.InputError, match=rf"^nodes has the shape \({nodes}, 3\), and the matrices 3 rows; give a row"
    ):
        gb.ImportedModel.read(tmp_path / "m.npz", tmp_path / "n.inp")


@pytest.mark.parametrize(("machine", "name"), [(2, "VAX D-float"), (3, "VAX G-float"), (4, "Cray")])
def test_numbers_of_machines_that_scipy_misreads_are_refused(tmp_path: Path, machine: int, name: str) -> None:
    scipy.io.savemat(tmp_path / "k.mat", {"K": SPRINGS}, format="4")
    data = (tmp_path / "k.mat").read_bytes()
    assert data[:4] == bytes(4)
    (tmp_path / "k.mat").write_bytes((1000 * machine).to_bytes(4, "little") + data[4:])
    with pytest.raises(gb.InputError, match=rf"k\.mat cannot be read: .*'{name}'; returned data may be corrupt"):
        gb.read_matrix(tmp_path / "k.mat")


@pytest.mark.parametrize("name", WRITERS)
def test_matrices_come_from_files(tmp_path: Path, name: str) -> None:
    WRITERS[name](tmp_path / name)
    which = "K" if name.startswith("both") else ""
    answer = gb.read_matrix(tmp_path / name, which)
    np.testing.assert_array_equal(answer.toarray() if sparse.issparse(answer) else answer, SPRINGS)
    if which:
        with pytest.raises(gb.InputError, match="name is missing; choose from"):
            gb.read_matrix(tmp_path / name)
        with pytest.raises(gb.InputError, match=r"name is 'C', which is no matrix of .*; choose from"):
            gb.read_matrix(tmp_path / name, "C")


def test_files_without_matrices_are_refused(tmp_path: Path) -> None:
    for name in ("a.mtx", "a.npz", "a.mat", "a.npy"):
        (tmp_path / name).write_text("garbage", encoding="utf-8")
        with pytest.raises(gb.InputError, match=r"path .* cannot be read"):
            gb.read_matrix(tmp_path / name)
    (tmp_path / "a.csv").write_text("1,2", encoding="utf-8")
    with pytest.raises(gb.InputError, match=r"path .*a\.csv ends in \.csv; give one of \.npz"):
        gb.read_matrix(tmp_path / "a.csv")
    np.savez(tmp_path / "b.npz", name=np.array("model"))
    with pytest.raises(gb.InputError, match=r"path .*b\.npz holds no matrix"):
        gb.read_matrix(tmp_path / "b.npz")


def test_a_file_of_one_node_is_a_matrix(tmp_path: Path) -> None:
    np.save(tmp_path / "nodes.npy", [[0.1, 0.0, 0.0]])
    np.testing.assert_array_equal(gb.read_matrix(tmp_path / "nodes.npy"), [[0.1, 0.0, 0.0]])


def test_nodes_lie_beside_their_matrices(tmp_path: Path) -> None:
    """As an array of that name in NPZ and MAT files; given twice, or with matrices of two sizes, they are refused."""
    m, k, nodes = frame(3)
    arrays = {"M": m, "K": k, "nodes": nodes}
    np.savez(tmp_path / "model.npz", **arrays)
    scipy.io.savemat(tmp_path / "model.mat", arrays)
    for name in ("model.npz", "model.mat"):
        read = gb.ImportedModel.read(tmp_path / name, length_unit="m")
        np.testing.assert_array_equal(read.nodes, nodes)
        assert read.stiffness.shape == (24, 24)
    with pytest.raises(gb.InputError, match="nodes are in two of the files; give them once"):
        gb.ImportedModel.read(tmp_path / "model.npz", tmp_path / "model.mat")
    np.savez(tmp_path / "unlike.npz", **(arrays | {"M": m[:18, :18]}))
    with pytest.raises(gb.InputError, match=r"stiffness has the shape \(24, 24\); give \(18, 18\), as the mass"):
        gb.ImportedModel.read(tmp_path / "unlike.npz")


def test_a_campbell_diagram_says_what_it_leaves_out_at_its_fastest() -> None:
    """Of the order of Ω²/ω², of which a beam's own stiffening is 1.2; at rest there is nothing to say."""
    m, k, nodes = frame(4)
    model = gb.ImportedModel(m, k, nodes).reduced(modes=2, damping_ratio=0.01, clamp=[0])
    said = [
        each
        for each in gb.campbell(model, gb.Hub(radius=0.0), end=20.0, count=2).warnings
        if "left out changes" in each
    ]
    share = 100 * (20.0 / (2 * np.pi * gb.modes(model).frequency[0])) ** 2
    assert len(said) == 1 and f"by the order of {share:.2g} %" in said[0]
    assert not any("left out changes" in each for each in gb.modes(model, gb.Hub(radius=0.5)).warnings)


def test_matrices_that_are_not_positive_definite_are_refused() -> None:
    """With positive diagonals: a motion with less than no stiffness, or with less than no mass."""
    chain = np.kron(2 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1), np.eye(3))
    nodes = [(0.02 * i, 0.0, 0.0) for i in range(1, 6)]
    mixed = np.eye(5)
    mixed[0, 1] = mixed[1, 0] = 2.0
    for name, m, k in (("stiffness", np.eye(15), chain - 0.5 * np.eye(15)), ("mass", np.kron(mixed, np.eye(3)), chain)):
        with pytest.raises(gb.InputError, match=f"{name} is not positive definite"):
            gb.ImportedModel(m, 1e5 * k, nodes).reduced(modes=4, damping_ratio=0.01)
