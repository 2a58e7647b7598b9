"""Modes of a beam as if they had been measured: by arrays, and by universal files that pyuff writes."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff

import gbeam as gb


@cache
def beam() -> gb.Structure:
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    whole = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    return gb.assemble(whole, "TLAM", axial=0, y=2, z=3)


def measured() -> dict[str, Any]:
    """Modes at all particles of the beam, of unit modal mass."""
    frequency, modes = beam().rest
    shapes = beam().places.first @ modes
    return {
        "frequency": frequency / (2 * np.pi),
        "damping_ratio": np.full(5, 0.01),
        "shapes": shapes,
        "nodes": beam().places.r0,
        "modal_mass": np.ones(5),
    }


def moved(structure: gb.Structure) -> np.ndarray:
    flight = gb.Flight(acceleration=gb.constant(np.array([0.0, -2.0, 8.0])))
    return gb.simulate(structure, flight, duration=0.05, step=1e-3).displacement[:, -1]


def test_measured_modes_move_as_the_beam() -> None:
    """To the last digits without stress in the stiffness, which an even acceleration across it does not bring."""
    test = gb.ModalTest(**measured())
    structure = test.structure(beam().mass)
    np.testing.assert_allclose(structure.rest[0], beam().rest[0], rtol=1e-12)
    last = structure.station_places.first[-1]
    at_end = beam().places.first[np.argmax(beam().places.r0[:, 0])] @ beam().rest[1]
    np.testing.assert_allclose(last, at_end)
    c, whole, modes = structure.coefficients, beam().coefficients, beam().rest[1]
    for name in ("f_a", "f_al", "f_ww"):
        np.testing.assert_allclose(getattr(c, name), getattr(whole, name) @ modes, atol=1e-12)
    np.testing.assert_allclose(c.damping, modes.T @ whole.damping @ modes, atol=1e-10)
    assert any("no geometric stiffness is given" in each for each in structure.warnings)
    assert moved(structure).shape[1] == 3


def test_modes_may_come_in_any_order() -> None:
    """Frequencies, dampings, masses and shapes go together, so that the structure moves as it did."""
    modes, order = measured(), [3, 0, 4, 1, 2]
    modes["damping_ratio"] = np.array([0.01, 0.02, 0.03, 0.04, 0.05])
    mixed = {name: modes[name][..., order] for name in ("frequency", "damping_ratio", "shapes", "modal_mass")}
    mine, theirs = (gb.ModalTest(**each).structure(beam().mass) for each in (modes, modes | mixed))
    assert mine.damping_ratio == theirs.damping_ratio
    np.testing.assert_array_equal(mine.station_places.first, theirs.station_places.first)
    np.testing.assert_array_equal(moved(mine), moved(theirs))


def written(path: Path, kind: str, system: int = 1) -> np.ndarray:
    """Write the modes as a laboratory does that measures `kind`; returns the numbers of the nodes."""
    each, numbers = measured(), np.arange(101, 101 + 3 * len(measured()["nodes"]), 3)
    ends = [slice(None, None, -1)] if kind != "in two sets" else [slice(9), slice(6, None)]
    length = 1000.0 if kind == "in mm, t and N" else 1.0
    units = {"type": 164, "units_code": 9, "length": length, "force": 1.0, "temp": 1.0, "temp_offset": 273.15}
    sets: list[dict[str, Any]] = [units] if length > 1 else []
    for some in ends:
        none = 0 * numbers[some]
        grid = {"type": 2411, "node_nums": numbers[some], "def_cs": none, "disp_cs": none + system, "color": none}
        sets.append(grid | dict(zip("xyz", length * each["nodes"][some].T, strict=True)))
    for i, frequency in enumerate(each["frequency"]):
        w, shape = 2 * np.pi * frequency, each["shapes"][:, :, i]
        common = {"type": 55, "model_type": 1, "node_nums": numbers, "data_ch": 2, "load_case": 0, "mode_n": i + 1,
                  "spec_data_type": 12 if kind == "accelerations" else 8, "n_data_per_node": 3,
                  **{f"id{k}": "strip" for k in range(1, 6)}}  # fmt: skip
        if not kind.startswith("complex"):
            shape = -(w**2) * shape if kind == "accelerations" else shape
            r = dict(zip(("r1", "r2", "r3"), shape.T, strict=True))
            sets.append(common | r | {"analysis_type": 2, "data_type": 2, "freq": frequency, "modal_m": 1 / length,
                                      "modal_damp_vis": 0.01, "modal_damp_his": 0.0})  # fmt: skip
            continue
        root, turned = w * complex(-0.01, np.sqrt(1 - 1e-4)), shape * np.exp(0.7j)
        pair = [(root, turned, 2j * root.imag * np.exp(1.4j))]
        pair += [tuple(np.conj(value) for value in pair[0])] if kind == "complex, in pairs" else []
        for value, part, a in pair:
            r = dict(zip(("r1", "r2", "r3"), part.T, strict=True))
            sets.append(common | r | {"analysis_type": 3, "data_type": 5, "eig": value, "modal_a": a, "modal_b": 0j})
    if kind.endswith("results"):
        sets = [as_results(each) if each["type"] == 55 else each for each in sets]
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")
    if kind == "complex results":  # pyuff writes no negative numbers there: their column is one too wide
        text = path.read_text(encoding="ascii")
        path.write_text(re.sub(r"(?<=e\+00\n)(  \S+){6}(?=\n)", as_decaying, text), encoding="ascii")
    return numbers


def as_results(each: dict[str, Any]) -> dict[str, Any]:
    """A data set 55 as one of analysis data, 2414, with rotations that are nought."""
    a, root = complex(each.get("modal_a", 0)), complex(each.get("eig", 0))
    rows = np.column_stack([each["r1"], each["r2"], each["r3"], np.zeros((len(each["r1"]), 3))])
    if "eig" in each:
        rows = rows[:, :3].astype(complex).view(float)
    real = [0, each.get("freq", 0), 0, each.get("modal_m", 0), each.get("modal_damp_vis", 0), 0]
    eigen = [-root.real, root.imag, a.real, a.imag, 0, 0]
    names = {f"record12_field{i + 1}": value for i, value in enumerate(real)}
    names |= {f"record13_field{i + 1}": value for i, value in enumerate(eigen)}
    return names | {
        "type": 2414, "analysis_dataset_label": each["mode_n"], "analysis_dataset_name": "mode", "dataset_location": 1,
        "model_type": 1, "analysis_type": each["analysis_type"], "data_characteristic": 2 if "eig" in each else 3,
        "result_type": 8, "data_type": 5 if "eig" in each else 2, "number_of_data_values_for_the_data_component": 6,
        "record10_field6": each["mode_n"], "node_nums": each["node_nums"], "data_at_node": rows,
        **{f"id{k}": "strip" for k in range(1, 6)},
    }  # fmt: skip


def as_decaying(match: re.Match[str]) -> str:
    """A line of numbers with the first one's sign changed, in columns of thirteen."""
    first, *others = map(float, match[0].split())
    return "".join(f"{value:13.5e}" for value in (-first, *others))


KINDS = (
    "normal", "in mm, t and N", "in two sets", "accelerations", "complex", "complex, in pairs",
    "results", "complex results",
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_modes_come_from_universal_files(tmp_path: Path, kind: str) -> None:
    each, path = measured(), tmp_path / "test.uff"
    numbers = written(path, kind)
    read = gb.ModalTest.read(path)
    assert list(read.numbers) == list(numbers)
    np.testing.assert_allclose(read.nodes, each["nodes"], atol=1e-12)
    for name in ("frequency", "damping_ratio", "modal_mass"):
        np.testing.assert_allclose(getattr(read, name), each[name], rtol=2e-5)  # six digits
    sign = np.sign((read.shapes * each["shapes"]).sum(axis=(0, 1)))
    np.testing.assert_allclose(read.shapes * sign, each["shapes"], atol=1e-4 * np.abs(each["shapes"]).max())
    structure = read.structure(beam().mass, points={"first": 101})
    assert structure.points == ("first", "tip")
    np.testing.assert_allclose(structure.rest[0], beam().rest[0], rtol=2e-5)


def test_a_universal_file_of_something_else_is_refused(tmp_path: Path) -> None:
    """Cut off, in local coordinates, and of strains."""
    path = tmp_path / "test.uff"
    written(path, "normal", system=7)
    with pytest.raises(gb.InputError, match=r"has nodes in coordinate system 7; export them in the global one"):
        gb.ModalTest.read(path)
    written(path, "normal")
    text = path.read_text(encoding="ascii")
    for other, words in (
        (text[: len(text) // 2], "ends within a data set; export it again: it was cut off"),
        (text.replace(f"{2:10d}{8:10d}{2:10d}{3:10d}", f"{2:10d}{3:10d}{2:10d}{3:10d}"), "mode 1 in data of type 3"),
    ):
        path.write_text(other, encoding="ascii")
        with pytest.raises(gb.InputError, match=words):
            gb.ModalTest.read(path)


def test_what_cannot_be_measured_so_is_refused(tmp_path: Path) -> None:
    each = measured()
    test = gb.ModalTest(**each)
    with pytest.raises(gb.InputError, match=r"gives a mode a mass that is \d+ % away from its modal mass"):
        test.structure(beam().mass / 5)
    with pytest.raises(gb.InputError, match=r"points\.lens is 999, which is no node"):
        test.structure(beam().mass, points={"lens": 999})
    with pytest.raises(gb.InputError, match=r"modal_mass\[0\] is nan; give a positive one; a file may lack it"):
        gb.ModalTest(**(each | {"modal_mass": np.nan}))
    wild = each["shapes"] * np.exp(1j * np.linspace(0, 2, len(each["nodes"])))[:, None, None]
    with pytest.raises(gb.InputError, match=r"shapes\[\d\] moves out of phase by \d+ %; give normal modes"):
        gb.ModalTest(**(each | {"shapes": wild}))
    with pytest.raises(gb.InputError, match=r"shapes are \(2, 3, 5\), of"):
        gb.ModalTest(**(each | {"shapes": each["shapes"][:2]}))
    (tmp_path / "empty.unv").write_text("    -1\n    -1\n", encoding="ascii")
    with pytest.raises(gb.InputError, match=r"has no modes|cannot be read"):
        gb.ModalTest.read(tmp_path / "empty.unv")
