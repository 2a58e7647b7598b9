"""Reduced solids kept on disk: the second reading assembles nothing, and what differs or is damaged is made again."""

from __future__ import annotations

import hashlib
import io
import os
import pickle
import sys
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb
from gbeam.guards import write_packed
from gbeam.io import kept
from gbeam.solids import mesh as solids
from gbeam.solids import reading

from ..solids.bodies import block
from .test_specimens import BODY, FLIGHT

pytestmark = pytest.mark.usefixtures("reading_in_process")


@pytest.fixture
def assembled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the matrices that were assembled."""
    meshio.write(tmp_path / "arm.inp", block("hexahedron20", (4, 1, 1), (0.2, 0.02, 0.01)))
    monkeypatch.setenv(kept.FOLDER, str(tmp_path / "cache"))
    monkeypatch.setattr(kept, "WORTH", -1.0)
    sizes: list[int] = []

    def counted(points: Any, blocks: Any) -> Any:
        sizes.append(3 * len(points))
        return original(points, blocks)

    original = solids.stiffness_matrix
    monkeypatch.setattr(solids, "stiffness_matrix", counted)
    return sizes


def read(folder: Path, text: str = BODY) -> Any:
    (folder / "scenario.toml").write_text(text + FLIGHT, encoding="utf-8")
    return gb.read_scenario(folder / "scenario.toml").subject


def files(folder: Path) -> list[Path]:
    return sorted((folder / "cache").glob("*"))


def test_a_second_reading_assembles_nothing(
    tmp_path: Path, assembled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And reads no mesh: what is kept goes by the content of its file."""
    first = read(tmp_path)
    with monkeypatch.context() as without:
        without.setattr(reading, "mesh_of", None)
        second = read(tmp_path)
    assert len(assembled) == 1 and first == second and len(files(tmp_path)) == 1
    assert second.recovery is not None and second.recovery.envelope.shape == first.recovery.envelope.shape
    softer = read(tmp_path, BODY.replace("210 GPa", "105 GPa"))
    assert len(assembled) == 2
    np.testing.assert_allclose(softer.rest[0][:4], first.rest[0][:4] / np.sqrt(2), rtol=1e-9)
    meshio.write(tmp_path / "arm.inp", block("hexahedron20", (4, 1, 1), (0.2, 0.02, 0.011)))
    assert read(tmp_path) != first and len(assembled) == 3


def test_a_coarser_mesh_is_read_where_its_own_file_changes(tmp_path: Path, assembled: list[int]) -> None:
    text = BODY.replace('mesh = "arm.inp"', 'mesh = "arm.inp"\ncoarser = "rough.inp"')
    meshio.write(tmp_path / "rough.inp", block("hexahedron20", (2, 1, 1), (0.2, 0.02, 0.01)))
    first = read(tmp_path, text)
    assert len(assembled) == 2 and read(tmp_path, text) == first and len(assembled) == 2
    assert read(tmp_path).coarser is None and len(assembled) == 3
    meshio.write(tmp_path / "rough.inp", block("hexahedron20", (3, 1, 1), (0.2, 0.02, 0.01)))
    assert read(tmp_path, text) != first and len(assembled) == 5


@pytest.mark.parametrize("damage", ["cut", "changed", "empty"])
def test_a_damaged_file_is_made_again(tmp_path: Path, assembled: list[int], damage: str) -> None:
    first = read(tmp_path)
    (file,) = files(tmp_path)
    content = file.read_bytes()
    other = bytes([content[-100] ^ 1])
    file.write_bytes({"cut": content[:-9], "changed": content[:-100] + other + content[-99:], "empty": b""}[damage])
    assert read(tmp_path) == first and len(assembled) == 2
    assert file.read_bytes() == content and files(tmp_path) == [file]
    assert read(tmp_path) == first and len(assembled) == 2


def test_nothing_is_kept_where_it_is_off_or_quick(
    tmp_path: Path, assembled: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(kept.FOLDER, "off")
    assert read(tmp_path) == read(tmp_path) and len(assembled) == 2 and not files(tmp_path)
    monkeypatch.setenv(kept.FOLDER, str(tmp_path / "cache"))
    monkeypatch.setattr(kept, "WORTH", 1e3)
    read(tmp_path)
    assert len(assembled) == 3 and not files(tmp_path)


def test_what_was_not_used_for_longest_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(kept.FOLDER, str(tmp_path / "cache"))
    monkeypatch.setattr(kept, "WORTH", -1.0)
    monkeypatch.setattr(kept, "MOST", 3500)

    def keep(number: int) -> None:
        array = kept.kept("", np.ndarray, lambda: number, lambda: np.full(1000, number, np.uint8))
        np.testing.assert_array_equal(array, number)

    for i in range(2):
        keep(i)
        for age, file in enumerate(files(tmp_path)):
            os.utime(file, (1000.0 + age, 1000.0 + age))
    oldest = min(files(tmp_path), key=lambda each: each.stat().st_mtime)
    keep(2)
    assert len(files(tmp_path)) == 2 and oldest not in files(tmp_path)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(kept.FOLDER, str(tmp_path / "file" / "below"))  # where nothing can be written
    keep(3)


POSIX = pytest.mark.skipif(sys.platform == "win32", reason="Windows does not say who may write")
OTHERS = "reduced solids are not kept: others may write in .*cache; let only you write there, or name another folder"


@POSIX
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o702, 0o1777])
def test_a_folder_that_others_may_write_is_not_used(tmp_path: Path, assembled: list[int], mode: int) -> None:
    """It is warned of: neither what they put there is read, nor is anything put there."""
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache").chmod(mode)
    for count in (1, 2):
        with pytest.warns(UserWarning, match=OTHERS):
            read(tmp_path)
        assert len(assembled) == count and not files(tmp_path)


@POSIX
@pytest.mark.skipif(os.name == "posix" and os.geteuid() != 0, reason="only root gives files away")
def test_a_folder_or_a_file_of_another_user_is_not_used(tmp_path: Path, assembled: list[int]) -> None:
    """As of one who makes it first where all may, such as in /tmp."""
    read(tmp_path)
    (file,) = files(tmp_path)
    os.chown(file, 12345, 12345)
    assert read(tmp_path) == read(tmp_path) and len(assembled) == 2  # made again, and then one's own
    os.chown(tmp_path / "cache", 12345, 12345)
    with pytest.warns(UserWarning, match=OTHERS):
        read(tmp_path)
    assert len(assembled) == 3


@POSIX
def test_a_file_that_others_may_write_is_made_again(tmp_path: Path, assembled: list[int]) -> None:
    read(tmp_path)
    (file,) = files(tmp_path)
    assert file.stat().st_mode & 0o777 == 0o600 and file.parent.stat().st_mode & 0o777 == 0o700
    file.chmod(0o620)
    read(tmp_path)
    assert len(assembled) == 2 and file.stat().st_mode & 0o777 == 0o600


class Attack:
    """An object whose pickle runs code."""

    def __reduce__(self) -> Any:
        return exec, ("raise SystemExit('a pickle was read')",)


@pytest.mark.parametrize("value", ["of another kind", "of another source", "a pickle"])
def test_a_file_of_anything_else_is_made_again(tmp_path: Path, assembled: list[int], value: str) -> None:
    """Though its own hash is right, as of one who knows the form."""
    first = read(tmp_path)
    (file,) = files(tmp_path)
    content = io.BytesIO()
    if value == "of another kind":
        write_packed(content, [file.stem, {"structure": 1.0}])
    elif value == "of another source":
        read(tmp_path, BODY.replace("210 GPa", "105 GPa"))
        (other,) = (each for each in files(tmp_path) if each != file)
        content.write(other.read_bytes()[32:])
        assembled.clear()
        assembled.append(0)
    else:
        pickle.dump(Attack(), content)
    file.write_bytes(hashlib.sha256(content.getvalue()).digest() + content.getvalue())
    assert read(tmp_path) == first and len(assembled) == 2
    assert read(tmp_path) == first and len(assembled) == 2


def test_what_changes_while_it_is_reduced_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(kept.FOLDER, str(tmp_path / "cache"))
    monkeypatch.setattr(kept, "WORTH", -1.0)
    contents = iter("abbbb")
    for count in (0, 1, 1):  # of the first what was read is b, and its key would be that of a
        np.testing.assert_array_equal(kept.kept("", np.ndarray, lambda: next(contents), lambda: np.ones(2)), 1.0)
        assert len(files(tmp_path)) == count


def test_every_part_of_a_model_is_kept(tmp_path: Path, assembled: list[int]) -> None:
    """Masses, links with bodies and springs, interfaces, points with axes, and a coarser mesh."""
    more = """coarser = "rough.inp"
interfaces = { end = "end" }
masses = { wall = "1 g" }
links = { plate = "end" }
carried = { plate = { mass = "20 g", inertia = ["1 g m^2", "1 g m^2", "1 g m^2"] } }
springs = { prop = { between = ["plate"], stiffness = { z = "1 N/mm" } } }
points = { middle = { at = ["100 mm", 0, 0], turn = [0, 0, "10 deg"] } }
"""
    ends = {"end": lambda x: x[:, 0] == x[:, 0].max()}
    for name, cells in (("arm.inp", 6), ("rough.inp", 3)):
        meshio.write(tmp_path / name, block("hexahedron20", (cells, 1, 1), (0.2, 0.02, 0.01), groups=ends))
    text = BODY.replace('mesh = "arm.inp"\n', f'mesh = "arm.inp"\n{more}')
    first = read(tmp_path, text)
    assert len(assembled) == 2 and first.coarser is not None
    assert read(tmp_path, text) == first and len(assembled) == 2


def test_a_fit_keeps_none_of_its_trials(tmp_path: Path, assembled: list[int]) -> None:
    """The reduction of the scenario stays, where each trial would take its room."""
    frequency = read(tmp_path).rest[0][:3] / (2 * np.pi)
    taps = tmp_path / "taps.csv"
    rows = [f"{k},{1.01 * each},0.01" for k, each in enumerate(frequency, 1)]
    taps.write_text("\n".join(["mode,frequency,damping_ratio", *rows]), encoding="utf-8")
    fitted = gb.fit(tmp_path / "scenario.toml", taps, ["bodies.arm.material.youngs_modulus"])
    assert fitted.values[0] == pytest.approx(1.01**2 * 210e9, rel=1e-6)
    assert len(assembled) > 3 and len(files(tmp_path)) == 1
