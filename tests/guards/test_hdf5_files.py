"""A file of HDF5 whose links or numbers lead into another one is refused by every reader of HDF5."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

import gbeam as gb
from gbeam.guards import open_hdf5
from gbeam.io import contents

pytestmark = pytest.mark.usefixtures("reading_in_process")

SECRET = np.arange(240.0)


def linked(file: h5py.File, other: Path) -> None:
    file["az"] = h5py.ExternalLink(str(other), "secret")


def nested(file: h5py.File, other: Path) -> None:
    file.create_group("a/b")["az"] = h5py.ExternalLink(other.name, "/secret")


def raw(file: h5py.File, other: Path) -> None:
    file.create_dataset("az", SECRET.shape, "f8", external=[(str(other), 2048, SECRET.nbytes)])


def virtual(file: h5py.File, other: Path) -> None:
    layout = h5py.VirtualLayout(SECRET.shape, "f8")
    layout[:] = h5py.VirtualSource(other, "secret", SECRET.shape)
    file.create_virtual_dataset("az", layout)


WAYS = [linked, nested, raw, virtual]


@pytest.fixture
def other(tmp_path: Path) -> Path:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = SECRET
    return tmp_path / "other.h5"


def write(path: Path, way: Callable[[h5py.File, Path], None], other: Path) -> Path:
    matlab = path.suffix == ".mat"
    with h5py.File(path, "w", userblock_size=512 if matlab else 0) as file:
        file["t"] = np.arange(240) / 100
        way(file, other)
    if matlab:
        with path.open("r+b") as head:
            head.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return path


@pytest.mark.parametrize("way", WAYS)
def test_what_lies_elsewhere_is_refused(tmp_path: Path, other: Path, way: Callable[[h5py.File, Path], None]) -> None:
    path = write(tmp_path / "r.h5", way, other)
    with (
        pytest.raises(ValueError, match=r"az lies in another file, .*other\.h5: copy it into this one"),
        open_hdf5(path),
    ):
        pass
    with pytest.raises(gb.InputError, match=r"r\.h5 cannot be read \((a/b/)?az lies in another file"):
        gb.read_record(path, time="t", x="0", y="0", z="az", unit="g")
    with pytest.raises(gb.InputError, match="is not a netCDF-4 file that can be read"):
        contents(str(path))
    matlab = write(tmp_path / "m.mat", way, other)
    with pytest.raises(gb.InputError, match="az lies in another file"):
        gb.read_matrix(matlab, "az")
    for name in ("a.exo", "a.med"):
        with pytest.raises(gb.InputError, match=r"a\.\w+ cannot be read: (a/b/)?az lies in another file"):
            gb.SolidMesh.read(write(tmp_path / name, way, other), materials=gb.Material(1, 1, 0.3), clamp="a", unit="m")


def test_links_within_a_file_are_followed(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["data/az"], file["t"] = SECRET, np.arange(240) / 100
        file["soft"], file["hard"] = h5py.SoftLink("/data/az"), file["data/az"]
        file["type"] = np.dtype("f8")
        layout = h5py.VirtualLayout(SECRET.shape, "f8")
        layout[:] = h5py.VirtualSource(".", "data/az", SECRET.shape)
        file.create_virtual_dataset("copied", layout)
    with open_hdf5(tmp_path / "r.h5") as file:
        for name in ("soft", "hard", "copied"):
            np.testing.assert_array_equal(file[name], SECRET)
