"""A beam of gbeam's own as standard input data, written as Wallrapp's standard says, and with its indices swapped."""

from __future__ import annotations

import re
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb
from gbeam import constant

OE = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def beam(axial: int = 1, y: int = 2, z: int = 2) -> gb.Structure:
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    whole = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    return gb.assemble(whole, "FOAM", axial=axial, y=y, z=z)


def block(name: str, constant: np.ndarray, slope: np.ndarray | None = None, *, swap: bool = False) -> list[str]:
    """A polynomial, m0(row, column) and m1(row, coordinate, column)."""
    rows, columns = constant.shape
    count = 0 if slope is None else slope.shape[1]
    lines = [name, f"order = {int(slope is not None)}", f"nrow = {rows}", f"ncol = {columns}", f"nq = {count}"]
    lines += ["nqn = 0", "structure = 3"]
    lines += [f"m0( {i + 1}, {j + 1}) = {constant[i, j]:.17E}" for i in range(rows) for j in range(columns)]
    for i, j, k in np.ndindex(*(slope.shape if slope is not None else (0, 0, 0))):
        at = (i, k, j) if swap else (i, j, k)
        lines.append(f"m1( {', '.join(str(each + 1) for each in at)}) = {slope[i, j, k]:.17E}")
    return [*lines, f"end {name}"]


def written(structure: gb.Structure, *, order: tuple[tuple[int, int], ...] = OE, swap: bool = False) -> str:
    """Text of standard input data of a structure's coefficients."""
    c, tip = structure.coefficients, structure.station_places[-1:]
    n = c.size

    def columns(tensor: np.ndarray) -> np.ndarray:
        return np.stack([tensor[i, j] * (1 if i == j else 2) for i, j in order], axis=-1)

    slopes = {"Ct": np.moveaxis(c.k_a, 0, -1), "Cr": np.moveaxis(c.k_al, 0, -1), "Oe": columns(c.k_ww)}
    lines = ["part", "new modal", "refmod", f"mass = {c.rigid[0]:.17E}", f"nelastq = {n}", "end refmod", "new frame"]
    for number, (r0, first, second) in enumerate(((np.zeros(3), np.zeros((3, n)), np.zeros((3, n, n))),
                                                  (tip.r0[0], tip.first[0], tip.second[0])), 1):  # fmt: skip
        lines += [f"new node = {number}", "rframe = body ref"]
        lines += block("origin", r0[:, None], first[:, :, None], swap=swap)
        lines += block("phi", first, np.moveaxis(second, 1, 1), swap=swap)
        lines += [*block("psi", np.zeros((3, n))), *block("AP", np.eye(3)), "end node"]
    lines += ["end frame", *block("mdCM", c.rigid[1:4, None], -c.f_a[:, :, None], swap=swap)]
    lines += block("J", c.second_moment, np.moveaxis(2 * c.f_ww, -1, 1), swap=swap)
    lines += [*block("Ct", -c.f_a.T, slopes["Ct"], swap=swap), *block("Cr", -c.f_al.T, slopes["Cr"], swap=swap)]
    lines += [*block("Me", c.mass), *block("Gr", np.zeros((3, 3 * n)))]
    lines += block("Ge", np.moveaxis(c.gyroscopic, 0, -1).reshape(n, 3 * n))
    lines += [*block("Oe", -columns(c.f_ww), slopes["Oe"], swap=swap), *block("ksigma", np.zeros((n, 1)))]
    lines += [*block("Ke", c.stiffness), *block("De", c.damping), "end modal", "end part"]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("how", [{}, {"swap": True}, {"order": ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))}])
def test_a_beam_comes_back_with_all_coefficients(tmp_path: Path, how: dict[str, object]) -> None:
    """To the last digits; swapped indices and columns are seen by what the file says twice."""
    path = tmp_path / "strip.sid"
    path.write_text(written(beam(), **how), encoding="ascii")
    read, whole = gb.read_sid(path), beam()
    for each in fields(type(whole.coefficients)):
        mine, theirs = (getattr(s.coefficients, each.name) for s in (read, whole))
        if theirs is not None:
            np.testing.assert_allclose(mine, theirs, atol=1e-13 * max(np.abs(theirs).max(), 1e-300), err_msg=each.name)
    hub = gb.Hub(radius=0.2, rate=gb.SmoothStep(level=8.0, duration=0.1), setting_angle=0.3)
    flight = gb.Flight(acceleration=constant(np.array([3.0, -2.0, 8.0])))
    for motion in (hub, flight):
        mine, theirs = (gb.simulate(s, motion, duration=0.2, step=1e-3, estimate=False) for s in (read, whole))
        np.testing.assert_allclose(mine.displacement, theirs.displacement[:, -1:], rtol=1e-9, atol=1e-13)
    # In a tree as well, where the wrench on the root comes back from the same coefficients.
    joints = {"free": gb.Joint("free", "bus"), "root": gb.Joint("fixed", "arm", on="bus.root")}
    bus = gb.RigidBody(1.0, (1e-3, 1e-3, 1e-3))
    mine, theirs = (gb.modes(gb.System({"arm": s, "bus": bus}, joints), errors=False).frequency for s in (read, whole))
    np.testing.assert_allclose(mine, theirs, rtol=1e-9)


def test_particles_that_stand_in_have_the_moments_of_the_beams(tmp_path: Path) -> None:
    """Σ m ∂r/∂q and Σ m r ∂r/∂q, by which a body's momentum and its energy of turning move with its coordinates."""
    path = tmp_path / "strip.sid"
    path.write_text(written(beam()), encoding="ascii")
    mine, theirs = gb.read_sid(path), beam()
    for subscripts in ("k,kan->an", "k,kb,kan->abn"):
        sums = []
        for structure in (mine, theirs):
            mass, places = np.asarray(structure.mass), structure.places
            operands = (mass, places.first) if "kb" not in subscripts else (mass, places.r0, places.first)
            sums.append(np.einsum(subscripts, *operands))
        np.testing.assert_allclose(*sums, atol=1e-12 * np.abs(sums[1]).max())


@pytest.mark.parametrize("stiffness", [{}, {"z": 500.0}], ids=["rigid", "spring"])
def test_a_support_holds_it_in_the_shapes_of_its_file(tmp_path: Path, stiffness: dict[str, float]) -> None:
    """As the beam with a support, whose shapes suit it: six of a cantilever are 0.1 % too high in frequency."""
    path = tmp_path / "strip.sid"
    path.write_text(written(beam(1, 1, 6)), encoding="ascii")
    support = gb.Support("tip", [] if stiffness else ["z"], stiffness=stiffness)  # type: ignore[arg-type]
    read = gb.read_sid(path, supports=[support])
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    at_tip = gb.Support(0.3, [] if stiffness else ["z"], stiffness=stiffness)  # type: ignore[arg-type]
    whole = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01, supports=[at_tip])
    true = gb.assemble(whole, "FOAM", axial=1, y=1, z=6)
    assert read.size == 8 - (not stiffness) and "what shapes it lacks there is not known" in read.warnings[-1]
    assert gb.modes(read).frequency[0] == pytest.approx(gb.modes(true).frequency[0], rel=2e-3)
    pulse = gb.Flight(z=gb.Sine(20.0, duration=0.05), y=gb.Sine(10.0, duration=0.05))
    mine, theirs = (gb.simulate(each, pulse, duration=0.1, step=5e-4, estimate=False) for each in (read, true))
    loads, others = mine.body.loads, theirs.body.loads
    whole_force = loads.root_force + loads.support_force.sum(axis=1)
    np.testing.assert_allclose(whole_force, -mine.ground_force, atol=1e-9 * np.abs(whole_force).max())
    force, other = loads.support_force[:, 0, 2], others.support_force[:, 0, 2]
    np.testing.assert_allclose(force, other, atol=0.05 * np.abs(other).max())
    with pytest.raises(gb.InputError, match=r"supports\[0\]\.at is 'lid'; choose one of tip"):
        gb.read_sid(path, supports=[gb.Support("lid", ["z"])])


def test_the_example_is_the_strip() -> None:
    """To the digits in which processors differ."""
    number = re.compile(r"[-+]?\d\.\d+E[-+]\d+")
    kept, new = Path("examples/data/strip.sid").read_text(encoding="ascii"), written(beam(0, 1, 1))
    assert number.sub("0", kept) == number.sub("0", new)
    digits = ([float(each) for each in number.findall(text)] for text in (kept, new))
    np.testing.assert_allclose(*digits, rtol=1e-9, atol=1e-12)


def test_data_that_contradict_one_another_are_refused(tmp_path: Path) -> None:
    text = written(beam())
    path = tmp_path / "strip.sid"

    def refused(changed: str, words: str, **how: object) -> None:
        path.write_text(changed, encoding="ascii")
        with pytest.raises(gb.InputError, match=words):
            gb.read_sid(path, **how)

    def put(name: str, at: str, value: str) -> str:
        return re.sub(rf"(\n{name}\n(?:.*\n)*?m{at}) = .*", rf"\1 = {value}", text, count=1)

    refused(put("Oe", r"0\( 1, 2\)", "7.0"), "centrifugal terms Oe that its inertia J contradicts")
    refused(put("ksigma", r"0\( 1, 1\)", "1.0"), "has stress at rest")
    refused(text.replace("\nMe\n", "\nXe\n"), "lacks Me|cannot be read")
    refused(text, r"points\.camera is 9, which is no node of the file; choose from 1, 2", points={"camera": 9})
    refused("part\nend part\n", "lacks mdCM, J, Ct")
    flat = beam()
    flat = replace(flat, coefficients=replace(flat.coefficients, k_a=0 * flat.coefficients.k_a))
    path.write_text(written(flat), encoding="ascii")
    said = gb.modes(gb.read_sid(path), gb.Hub(radius=0.2, rate=8.0)).warnings
    assert any("Ct has no geometric stiffness" in each for each in said) and any(
        "the order of" in each for each in said
    )
