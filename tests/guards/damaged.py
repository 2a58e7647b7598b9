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
    data = bytearray(file.getvalue())
    start = place = data.index(b"GCOL")
    end = start + int.from_bytes(data[start + 8 : start + 16], "little")
    place += 16
    while int.from_bytes(data[place : place + 2], "little"):  # 0 is the free space
        size = int.from_bytes(data[place + 8 : place + 16], "little")
        place += 16 + -(-size // 8) * 8
    assert place < end
    data[place + 8 : place + 16] = bytes(8)
    path.write_bytes(data)


def large_mat(path: Path) -> None:
    """A small record beside a structure of 320 MB, in 0.3 MB: zeros compress well."""
    from scipy.io import savemat

    whole = {"t": TIME, "az": np.ones(len(TIME)), "rec": {"t": TIME, "log": np.zeros(40_000_000)}}
    savemat(path, whole, do_compression=True)
