"""Files of a few bytes that end the libraries that read them, keep them busy for ever, or fill the memory."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

TIME = np.arange(240) / 100
RECORD = 'record = { file = "FILE", time = "t", x = "0", y = "0", z = "az", unit = "g" }'


def crashing_mat(path: Path) -> None:
    """A structure whose last field has no data: SciPy's reader takes its pointer all the same."""
    from scipy.io import savemat

    file = io.BytesIO()
    savemat(file, {"rec": {"t": TIME[:6], "az": np.ones(6)}})
    data = file.getvalue()
    tag = np.array([9, 48], dtype="<u4").tobytes()  # doubles, and how many bytes of them
    i = data.rindex(tag)
    path.write_bytes(data[:i] + bytes(8) + data[i + 8 :])


def endless_hdf5(path: Path) -> None:
    """Text in a heap whose free space has no size: HDF5 looks for its end for ever."""
    import h5py

    file = io.BytesIO()
    with h5py.File(file, "w") as opened:
        opened.attrs["outcome"] = "done"
        for name, values in (("t", TIME), ("az", np.ones(len(TIME)))):
            opened.create_dataset(name, data=values).attrs["units"] = "s" if name == "t" else "g"
    path.write_bytes(_endless(file.getvalue()))


def _endless(content: bytes) -> bytes:
    data = bytearray(content)
    start = place = data.index(b"GCOL")
    end = start + int.from_bytes(data[start + 8 : start + 16], "little")
    place += 16
    while int.from_bytes(data[place : place + 2], "little"):  # 0 is the free space
        size = int.from_bytes(data[place + 8 : place + 16], "little")
        place += 16 + -(-size // 8) * 8
    assert place < end
    data[place + 8 : place + 16] = bytes(8)
    return bytes(data)


def large_mat(path: Path) -> None:
    """A small record beside a structure of 320 MB, in 0.3 MB: zeros compress well."""
    from scipy.io import savemat

    whole = {"t": TIME, "az": np.ones(len(TIME)), "rec": {"t": TIME, "log": np.zeros(40_000_000)}}
    savemat(path, whole, do_compression=True)


def endless_exodus(path: Path) -> None:
    """A mesh of Exodus whose type of elements is such a text."""
    import h5py

    file = io.BytesIO()
    with h5py.File(file, "w") as opened:
        for axis in "xyz":
            opened[f"coord{axis}"] = np.zeros(8)
        opened["connect1"] = np.arange(8)[None] + 1
        opened["connect1"].attrs["elem_type"] = "HEX8"
    path.write_bytes(_endless(file.getvalue()))


def large_med(folder: Path) -> Path:
    """A mesh of MED of 25 million nodes, all in one place that is not written, in 5 kB."""
    import h5py

    count, path = 25_000_000, folder / "large.med"
    with h5py.File(path, "w") as file:
        mesh = file.create_group("ENS_MAA/mesh")
        mesh.attrs["ESP"] = 3
        step = mesh.create_group("-0000000000000000001-0000000000000000001")
        places = step.create_dataset("NOE/COO", (3 * count,), "f8", chunks=(2**21,), compression="gzip")
        places.attrs["NBR"] = count
        step.create_group("MAI")
    return path


def large_vtu(folder: Path) -> Path:
    """A mesh of VTK with as many nodes, in 0.7 MB: zeros compress well."""
    import zlib
    from base64 import b64encode

    size, blocks = 2**24, 36
    zeros = zlib.compress(bytes(size), 9)
    head = np.array([blocks, size, 0, *[len(zeros)] * blocks], dtype="<u4").tobytes()
    text = b64encode(head) + b64encode(zeros * blocks)
    path, count = folder / "large.vtu", size * blocks // 24
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" header_type="UInt32" '
        f'compressor="vtkZLibDataCompressor"><UnstructuredGrid><Piece NumberOfPoints="{count}" NumberOfCells="0">'
        '<Points><DataArray type="Float64" Name="Points" NumberOfComponents="3" format="binary">'
        f"{text.decode()}</DataArray></Points></Piece></UnstructuredGrid></VTKFile>"
    )
    return path
