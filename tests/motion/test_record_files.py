"""One table of numbers in every dialect and kind of file that is read: the same record comes out of each."""

from __future__ import annotations

import struct
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.motion import Conditioning, FlightRecord, Rates, read_flight

NAMES = ("t", "a_x", "a_y", "a_z")
T = np.arange(240) / 100
_DRIFT = np.random.default_rng(9).normal(0, 0.002, (240, 3)).cumsum(axis=0) + np.array([0.1, -0.05, 1.0])
NUMBERS = np.column_stack([T, np.round(_DRIFT, 5)])


def lines(
    delimiter: str = ",",
    decimal: str = ".",
    header: tuple[str, ...] = NAMES,
    before: tuple[str, ...] = (),
    units: str = "",
    clock: float = 1.0,
    after: str = "",
) -> str:
    """The table as text; `clock` is the unit of time in seconds, `after` ends every row of numbers."""
    numbers = NUMBERS / [clock, 1, 1, 1]
    rows = [delimiter.join(f"{x:.16g}".replace(".", decimal) for x in row) + after for row in numbers]
    return "\n".join([*before, delimiter.join(header), *([units] if units else []), *rows, ""])


TEXT: dict[str, str | bytes] = {
    "commas": lines(),
    "commas and spaces": lines(", "),
    "semicolons": lines(";"),
    "semicolons, decimal commas": lines(";", ","),
    "tabs": lines("\t"),
    "tabs, decimal commas": lines("\t", ","),
    "white space": lines("   "),
    "white space, decimal commas": lines("  ", ","),
    "white space, units in the names": lines("  ", ",", ("t [s]", "a_x [g]", "a_y [g]", "a_z [g]")),
    "quoted decimal commas": "\n".join(f'"{line}"' for line in lines('","', ",").splitlines()),
    "trailing delimiters": lines(";", ",", after=";"),
    "Windows line ends": lines().replace("\n", "\r\n"),
    "blank lines": lines().replace("\n", "\n\n"),
    "empty rows of a spreadsheet": lines(";", ",", before=(";;;",)) + ";;;\n;;;\n",
    "comments": lines(before=("# Flight 12; 3 May", "% 100 Hz", "// body, axes, of the, aircraft", "; x forward", "")),
    "comments, semicolons": lines(";", ",", before=("#a;b;c;d", "; Flight 12", "% 1,5 g")),
    "preamble without marks": lines(";", ",", before=("Flight 12", "Pilot: N.N.; 100 Hz")),
    "header in a comment, as savetxt": lines(header=("# t", *NAMES[1:])),
    "header in a comment of semicolons": lines(header=("; t", *NAMES[1:])),
    "comments between rows": lines().replace("\n0.5,", "\n# event 3\n0.5,"),
    "row of units": lines(";", ",", units="s;g;g;g"),
    "row of units in brackets": lines("\t", units="[s]\t[g]\t[g]\t[g]"),
    "row of units below a header in a comment": lines(header=("# t", *NAMES[1:]), units="s,g,g,g"),
    "units in the names": lines(header=("t [s]", "a_x [g]", "a_y (g)", "a_z [-]")),
    "Fortran's exponents": "\n".join(
        [",".join(NAMES), *(",".join(f"{x:.15E}".replace("E", "D") for x in row) for row in NUMBERS)]
    ),
    "a last column of remarks": lines("\t", header=(*NAMES, "Comment")),
    "index without a name": ";" + lines(";", ",").replace("\n", "\n1;")[:-2],
    "milliseconds": lines(header=("t [ms]", *NAMES[1:]), clock=1e-3),
    "milliseconds in a row of units": lines(";", ",", units="ms;g;g;g", clock=1e-3),
    "Latin-1": lines(before=("# Höhe über Grund, 20 °C",)).encode("latin-1"),
    "UTF-8 with its mark": lines(before=("# Höhe",)).encode("utf-8-sig"),
    "UTF-16": lines(";", ",").encode("utf-16"),
    "UTF-16, big-endian": lines("\t").encode("utf-16-be"),
    "UTF-16, little-endian with its mark": b"\xff\xfe" + lines().encode("utf-16-le"),
}


def fly(path: Path, names: tuple[str, ...] = NAMES, unit: str = "g", **options: object) -> FlightRecord:
    return read_flight(path, *names, unit, **options)  # type: ignore[arg-type,misc]


def check(record: FlightRecord) -> None:
    np.testing.assert_allclose(record.acceleration.times, NUMBERS[:, 0], rtol=1e-13, atol=1e-15)
    np.testing.assert_array_equal(record.acceleration.values, STANDARD_GRAVITY * NUMBERS[:, 1:])


@pytest.mark.parametrize("dialect", TEXT)
def test_every_dialect_is_read_to_the_same_numbers(tmp_path: Path, dialect: str) -> None:
    text = TEXT[dialect]
    path = tmp_path / "record.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    record = fly(path)
    check(record)
    assert record.summary.done == (("time in ms, as the file says",) if "milliseconds" in dialect else ())


@pytest.mark.parametrize(
    ("unit", "clock"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0), ("h", 3600.0)]
)
def test_time_in_the_unit_that_the_scenario_names(tmp_path: Path, unit: str, clock: float) -> None:
    path = tmp_path / "record.txt"
    path.write_text(lines("\t", ",", clock=clock))
    check(fly(path, time_unit=unit))


def v7_mat(path: Path) -> tuple[str, ...]:
    import scipy.io

    t, x, y, z = NUMBERS.T
    scipy.io.savemat(path, {"t": t, "rec": {"a_x": x, "body": {"a_y": y}}, "acc": np.stack([x, z], 1), "word": "F-16"})
    return "t", "rec.a_x", "a_y", "acc(:,2)"


def v73_mat(path: Path) -> tuple[str, ...]:
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:  # MATLAB stores matrices transposed
        file["t"], file["rec/a_x"] = NUMBERS[:, :1].T, NUMBERS[:, 1:2].T
        file["acc"] = NUMBERS[:, 2:].T
        file["#refs#/a"] = NUMBERS
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return "t", "rec.a_x", "acc(:,1)", "acc(:,2)"


def hdf5(path: Path) -> tuple[str, ...]:
    import h5py

    with h5py.File(path, "w") as file:
        file["t"], file["imu/a_x"], file["imu/raw/y"] = NUMBERS[:, 0], NUMBERS[:, 1], -NUMBERS[:, 2:3]
        file["all"] = NUMBERS.T  # channels along the first axis
        file["imu/a_x"].attrs["units"] = np.bytes_("g")
        file["serial"] = 12
    return "t", "a_x", "-imu/raw/y", "all[3,:]"


def netcdf_4(path: Path) -> tuple[str, ...]:
    import xarray as xr

    t, x, y, z = NUMBERS.T
    data = xr.Dataset({"x": ("time", x, {"units": "g"}), "y": ("time", y), "z": ("time", z)}, {"time": t})
    data["time"].attrs["units"] = "seconds since 2024-05-03"
    data.to_netcdf(path, engine="h5netcdf")
    return "time", "x", "y", "z"


def netcdf_3(path: Path) -> tuple[str, ...]:
    from scipy.io import netcdf_file

    with netcdf_file(path, "w") as file:
        file.createDimension("time", len(T))
        for name, values in zip(NAMES, NUMBERS.T, strict=True):
            file.createVariable(name, "d", ("time",))[:] = values
        file.variables["a_z"].units = "g"
    return NAMES


def uff(path: Path) -> tuple[str, ...]:
    """Data sets 58 laid out by hand after their definition (Format lines of SDRC): x and y as text, z binary."""

    def header(name: str, direction: int, kind: str) -> str:
        axis = f"{0:5d}{0:5d}{0:5d} {'NONE':20s} "
        return "\n".join(
            [
                f"{-1:6d}", kind, name, "NONE", "03-May-24 12:00:00", "NONE", "NONE",
                f"{1:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{12:10d}{direction:4d} {'NONE':10s}{0:10d}{0:4d}",
                f"{4:10d}{len(T):10d}{1:10d}{0:13.5e}{0.01:13.5e}{0:13.5e}",
                *(f"{code:10d}{axis}{unit:20s}" for code, unit in ((17, "s"), (12, "g"), (0, "NONE"), (0, "NONE"))), "",
            ]
        )  # fmt: skip

    with path.open("wb") as file:
        for name, direction, values in (("Nose", 1, NUMBERS[:, 1]), ("NONE", -2, NUMBERS[:, 2])):
            rows = ["".join(f"{x:20.12e}" for x in row) for row in values.reshape(-1, 4)]
            file.write("\n".join([header(name, direction, f"{58:6d}") + rows[0], *rows[1:], f"{-1:6d}\n"]).encode())
        raw = NUMBERS[:, 3].astype("<f8").tobytes()
        kind = f"{58:6d}b{1:6d}{2:6d}{11:12d}{len(raw):12d}{0:6d}{0:6d}{0:12d}{0:12d}"
        file.write(header("NONE", 3, kind).encode() + raw + f"\n{-1:6d}\n".encode())
    return "time", "Nose", "12-Y", "12+Z"


BINARY: dict[str, tuple[str, Callable[[Path], tuple[str, ...]]]] = {
    "MAT": ("r.mat", v7_mat),
    "MAT 7.3": ("r.MAT", v73_mat),
    "HDF5": ("r.h5", hdf5),
    "netCDF-4": ("r.nc", netcdf_4),
    "netCDF-3": ("r.nc", netcdf_3),
}


@pytest.mark.parametrize("kind", BINARY)
def test_every_kind_of_file_is_read_to_the_same_numbers(tmp_path: Path, kind: str) -> None:
    name, write = BINARY[kind]
    names = write(tmp_path / name)
    check(fly(tmp_path / name, names))
    with pytest.raises(gb.InputError, match=r"record.z names no column 'a_q'; .*the columns are"):
        fly(tmp_path / name, (*names[:3], "a_q"))


def test_universal_files_are_read_to_their_digits(tmp_path: Path) -> None:
    names = uff(tmp_path / "r.unv")
    record = fly(tmp_path / "r.unv", names)
    np.testing.assert_allclose(record.acceleration.times, T, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(record.acceleration.values, STANDARD_GRAVITY * NUMBERS[:, 1:], rtol=1e-11)
    with pytest.raises(gb.InputError, match=r"columns are time, Nose, 12-Y, 12\+Z"):
        fly(tmp_path / "r.unv", ("t", *names[1:]))


def test_universal_files_hold_what_they_state(tmp_path: Path) -> None:
    """A file that ends early, of which 240 samples are stated and 180 left, was flown as 180."""
    names = uff(tmp_path / "r.unv")
    blocks = (tmp_path / "r.unv").read_bytes().split(b"    -1\n    58\n")
    first = blocks[1].split(b"\n")
    short = b"\n".join([*first[: -1 - 16], *first[-2:]])
    (tmp_path / "r.unv").write_bytes(b"    -1\n    58\n".join([blocks[0], short, *blocks[2:]]))
    with pytest.raises(
        gb.InputError, match=r"record.file .*states 240 samples of 'Nose' and holds 180; export it again"
    ):
        fly(tmp_path / "r.unv", names)


def test_arrays_that_were_not_written_to_their_end_are_refused(tmp_path: Path) -> None:
    """A recorder reserves 240 samples and stops at 180; HDF5 reads zeros beyond."""
    import h5py

    with h5py.File(tmp_path / "r.h5", "w") as file:
        for name, values in zip(NAMES, NUMBERS.T, strict=True):
            file.create_dataset(name, (240,), "f8", chunks=(60,))[: 240 if name == "t" else 180] = values[
                : 240 if name == "t" else 180
            ]
        file["nothing"] = h5py.Empty("f8")
    with pytest.raises(
        gb.InputError, match=r"record.x column 'a_x' has room for 240 numbers, of which 3 of 4 parts were"
    ):
        fly(tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        for name, values in zip(NAMES, NUMBERS.T, strict=True):
            file[name][:] = values
    check(fly(tmp_path / "r.h5"))


def test_fields_of_compounds_are_columns(tmp_path: Path) -> None:
    """As tables of PyTables and packet recorders have them, nested and with vectors; each by its path or last word."""
    import h5py

    kind = np.dtype([("t", "f8"), ("name", "S3"), ("acc", [("x", "f4"), ("yz", "f8", (2,))]), ("n_z", "f8")])
    rows = np.zeros(len(T), kind)
    rows["t"], rows["acc"]["yz"], rows["n_z"] = NUMBERS[:, 0], NUMBERS[:, 2:], 1
    rows["acc"]["x"] = NUMBERS[:, 1]
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["imu"] = rows
        file["imu"].attrs["units"] = ["s", "g", "g", "g"]  # of the fields of numbers
    record = fly(tmp_path / "r.h5", ("imu/t", "imu/acc/x", "imu/acc/yz[:,0]", "imu/acc/yz[:,1]"))
    np.testing.assert_allclose(record.acceleration.values, STANDARD_GRAVITY * NUMBERS[:, 1:], rtol=1e-7)
    with pytest.raises(
        gb.InputError, match=r"columns are imu/t, imu/acc/x, imu/acc/yz\[:,0\], imu/acc/yz\[:,1\], imu/n_z"
    ):
        fly(tmp_path / "r.h5", ("t", "x", "y", "n_z"))


DATED = Path(__file__).parents[1] / "data" / "records" / "datetime.mat"


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_a_variable_that_only_matlab_reads_leaves_the_others(version: str, tmp_path: Path) -> None:
    """`when` is a datetime, of which MATLAB writes an object: SciPy tells no shape of it and failed for all."""
    path = DATED
    if version == "7.3":
        import h5py

        path = tmp_path / "r.mat"
        v73_mat(path)
        with h5py.File(path, "r+") as file:
            for name, values in zip(("t", "ax", "ay", "az"), NUMBERS.T, strict=True):
                if name in file:
                    del file[name]
                file[name] = 9.80665 * values[None] if name != "t" else values[None]
            file["when"] = np.zeros((6, 1), dtype=np.uint32)
            file["when"].attrs.update(MATLAB_class=np.bytes_("datetime"), MATLAB_object_decode=np.int32(3))
    assert fly(path, ("t", "ax", "ay", "az"), "m/s^2").acceleration.times[-1] == pytest.approx(
        1.99 if path == DATED else 2.39
    )
    with pytest.raises(
        gb.InputError, match=r"record.time column 'when' is of MATLAB's class datetime.*seconds\(t - t\(1\)\)"
    ):
        fly(path, ("when", "ax", "ay", "az"), "m/s^2")


def test_packed_values_are_unpacked_and_missing_ones_refused(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "r.nc", "w") as file:
        file["t"] = T
        file["z"] = np.round(NUMBERS[:, 3] * 1e5 - 1000).astype(np.int32)
        file["z"].attrs.update(scale_factor=1e-5, add_offset=0.01, _FillValue=np.int32(-9999))
    values = fly(tmp_path / "r.nc", ("t", "0", "0", "z")).acceleration.values[:, 2]
    np.testing.assert_allclose(values, STANDARD_GRAVITY * NUMBERS[:, 3], rtol=1e-12)
    with h5py.File(tmp_path / "r.nc", "r+") as file:
        file["z"][7] = -9999
    with pytest.raises(gb.InputError, match=r"record.z sample 8, column 'z' is nan"):
        fly(tmp_path / "r.nc", ("t", "0", "0", "z"))
    with h5py.File(tmp_path / "r.nc", "r+") as file:
        file["z"][0] = 0
        file["z"].attrs["scale_factor"] = np.inf
    with warnings.catch_warnings(), pytest.raises(gb.InputError, match=r"record.z sample 1, column 'z' is nan"):
        warnings.simplefilter("error")
        fly(tmp_path / "r.nc", ("t", "0", "0", "z"))


@pytest.mark.parametrize(
    ("text", "where", "words"),
    [
        (lines(header=("t", "a_x", "a_y", "a_z [m/s²]")), "record.unit", ["is g", "'a_z' in m/s²", 'unit = "m/s^2"']),
        (lines(units="s,in/s^2,in/s^2,in/s^2"), "record.unit", ["in/s^2", 'write unit = "in/s^2"']),
        (lines(units="s,g,g,mV"), "record.unit", ["in mV, which is no unit", 'unit = "1 g / 100 mV"']),
        (lines(header=("t [GPS]", *NAMES[1:])), "record.time_unit", ["in GPS, which is no unit of time"]),
        (lines(";", ",").replace("\n0,5;", "\n0.5;"), "record.time", ["row 3", "'0,01'"]),
        (lines(header=("1", "2", "3", "4")), "record.file", ["no header line"]),
        (lines(decimal=","), "record.file", ["no header line with 8 names"]),
        (lines(units="-0.01,,,"), "record.z", ["row 2, column 'a_z' is empty"]),
        (lines(header=("t", "a_z [g]", "a_x", "a_z [m/s^2]")), "record.z", ["'a_z', given 2 times"]),
    ],
)
def test_files_that_disagree_are_refused(tmp_path: Path, text: str, where: str, words: list[str]) -> None:
    path = tmp_path / "record.csv"
    path.write_text(text)
    with pytest.raises(gb.InputError) as caught:
        fly(path, ("t", "0", "0", "a_z"))
    assert caught.value.where == where
    for word in words:
        assert word in str(caught.value)


def test_a_unit_stated_wrongly_by_the_file_can_be_overridden(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text(lines(header=("t [ms]", "a_x", "a_y", "a_z [m/s^2]")))
    with pytest.raises(gb.InputError, match=r'skip_checks = \["unit"\]'):
        fly(path)
    check(fly(path, time_unit="s", conditioning=Conditioning(skip_checks=("unit",))))


@pytest.mark.parametrize(
    ("header", "scale", "unit"),
    [
        (NAMES, 2048.0, "1 g / 2048"),
        (("t", "a_x [LSB]", "a_y [LSB]", "a_z [LSB]"), 2048.0, "9.80665 m/s^2 / 2048 LSB"),
        (("t", "a_x [mV]", "a_y [mV]", "a_z [mV]"), 98.0, "1 g / 98 mV"),
        (("t", "a_x_counts", "a_y_counts", "a_z_counts"), 1000 / 0.061, "0.061 mg"),
        (("t", "a_x [mm/s²]", "a_y_mm_s2", "a_z"), 9806.65, "mm/s^2"),
        (("t", "a_x [mm_s2]", "a_y [mm_s2]", "a_z [mm_s2]"), 9806.65, "mm/s^2"),
        (NAMES, 980.665, "Gal"),
        (("t", "a_x (cm/s2)", "a_y", "a_z"), 980.665, "cm/s^2"),
        (("t", "a_x [mg]", "a_y [mg]", "a_z_mg"), 1000.0, "mg"),
        (NAMES, 9.80665 / 0.0254, "in/s²"),
        (("t", "a_x [metres per second squared]", "a_y [m s-2]", "a_z [m*s**-2]"), 9.80665, "m/s^2"),
        (("t", "acc_m_s2[0]", "acc_m_s2[1]", "acc_m_s2[2]"), 9.80665, "m/s^2"),
        (("t", "xHighG", "yHighG", "z_high_g"), 9.80665, "m/s^2"),
        (("t", "n_x [1]", "n_y [1]", "n_z [1]"), 1.0, "g"),
        (("t", "n[1]", "n[2]", "n[3]"), 9.80665, "m/s^2"),
    ],
)
def test_every_unit_comes_to_the_same_load(tmp_path: Path, header: tuple[str, ...], scale: float, unit: str) -> None:
    """A unit of the scenario is the file's, or sizes its counts; an index in a name is none."""
    path = tmp_path / "record.csv"
    rows = NUMBERS * [1.0, scale, scale, scale]
    np.savetxt(path, rows, delimiter=",", header=",".join(header), comments="", fmt="%.12g")
    record = fly(path, header, unit)
    np.testing.assert_allclose(record.acceleration.values, STANDARD_GRAVITY * NUMBERS[:, 1:], rtol=1e-10, atol=1e-11)


@pytest.mark.parametrize(
    ("header", "unit", "words"),
    [
        (("t", "a_x [mV]", "a_y [mV]", "a_z [mV]"), "g", r'give its size, such as unit = "1 g / 100 mV"'),
        (("t", "a_x_mV", "a_y_mV", "a_z_mV"), "g", r"in mv, which is no unit of acceleration"),
        (("t", "a_x [V]", "a_y [V]", "a_z [V]"), "1 g / 98 mV", r"is '1 g / 98 mV', and .* in V; give the size of 1 V"),
        (("t", "a_x [g]", "a_y", "a_z"), "1 g / 2048", r'in g; write unit = "g"'),
        (("t", "a_x [g]", "a_y [m/s2]", "a_z"), "g", r"two units: the file gives 'a_x \[g\]' in g, 'a_y \[m/s2\]' in"),
        (NAMES, "1 g / 0", r"give a size above zero"),
        (NAMES, "1/2048 g", r'or the size of a count, such as "1 g / 2048"'),
        (NAMES, "m/s^3", r"did you mean 'm/s\^2'"),
    ],
)
def test_units_that_are_none_or_not_the_files_are_refused(
    tmp_path: Path, header: tuple[str, ...], unit: str, words: str
) -> None:
    path = tmp_path / "record.csv"
    np.savetxt(path, NUMBERS, delimiter=",", header=",".join(header), comments="", fmt="%.12g")
    with pytest.raises(gb.InputError, match=words) as caught:
        fly(path, header, unit)
    assert caught.value.where == "record.unit"


def labview(samples: int = 240, step: float = 0.01, unit: str = "g", end: str = "\t") -> str:
    """A measurement file of LabVIEW's, with its names one more than the rows have numbers."""
    channels = [
        ("Channels", "3", "", ""), ("Samples", *[samples] * 3), ("Y_Unit_Label", *[unit] * 3),
        ("X_Dimension", *["Time"] * 3), ("X0", *["0.0000000000000000E+0"] * 3), ("Delta_X", *[f"{step:f}"] * 3),
    ]  # fmt: skip
    head = ["LabVIEW Measurement", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t.", "X_Columns\tOne"]
    head += ["***End_of_Header***", "", *("\t".join(map(str, row)) + end for row in channels), "***End_of_Header***"]
    return "\r\n".join([*head, *lines("\t", header=(*NAMES, "Comment")).splitlines(), ""])


def test_labviews_header_says_units_rate_and_samples(tmp_path: Path) -> None:
    path = tmp_path / "r.lvm"
    for end in ("\t", ""):
        path.write_text(labview(end=end))
        check(fly(path))
        assert fly(path).summary.notes == ()
    path.write_text(labview(samples=800))
    assert fly(path).summary.notes == ("the file's header states 800 samples, and it holds 240",)
    path.write_text(labview(step=0.005))
    with pytest.raises(
        gb.InputError, match=r"record.time has 100 Hz, and the file states Delta_X, 200 Hz; if the file is"
    ):
        fly(path)
    check(fly(path, conditioning=Conditioning(skip_checks=("sampling",))))
    path.write_text(labview(unit="m/s^2"))
    with pytest.raises(gb.InputError, match=r'record.unit is g, .* in m/s\^2; write unit = "m/s\^2"'):
        fly(path)


def _matlab(path: Path) -> None:
    import scipy.io

    scipy.io.savemat(path, {"Fs": 100.0, "acc": NUMBERS[:, 1:], "other": {"fs": 7.0, "x": NUMBERS[:, 1]}})


def _matlab_73(path: Path) -> None:
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        file["Fs"], file["acc"], file["other/fs"] = np.array([[100.0]]), NUMBERS[:, 1:].T, np.array([[7.0]])
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize("write", [_matlab, _matlab_73])
def test_a_file_without_times_is_flown_at_its_sample_rate(tmp_path: Path, write: Callable[[Path], None]) -> None:
    """The file's own is offered, and another is refused; that of other columns says nothing."""
    path, names = tmp_path / "r.mat", ("acc(:,1)", "acc(:,2)", "acc(:,3)")
    write(path)
    with pytest.raises(
        gb.InputError, match=r'no column \'t\'; .* or write sample_rate = "100 Hz" in place of time, the Fs of'
    ):
        fly(path, ("t", *names))
    check(read_flight(path, None, *names, "g", sample_rate=100.0))
    with pytest.raises(
        gb.InputError, match=r'record.sample_rate is 200 Hz, and the file states Fs.* sample_rate = "100 Hz"'
    ):
        read_flight(path, None, *names, "g", sample_rate=200.0)


def test_sample_rates_of_hdf5_are_those_of_their_groups(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "r.h5", "w") as file:
        for name, values in zip(NAMES, NUMBERS.T, strict=True):
            file[f"imu/{name}"] = values
        file["imu/a_x"].attrs["sample_rate"] = 100
        file["gps/fs"], file["imu"].attrs["wf_increment"] = 5.0, 0.01
    check(fly(tmp_path / "r.h5"))
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        file["imu"].attrs["wf_increment"] = 0.02
    with pytest.raises(gb.InputError, match=r"has 100 Hz, and the file states imu/wf_increment, 50 Hz"):
        fly(tmp_path / "r.h5")


def test_rates_in_another_unit_than_the_file_states(tmp_path: Path) -> None:
    path = tmp_path / "record.csv"
    path.write_text(lines(header=("t", "a_x", "p [deg/s]", "a_z")))
    with pytest.raises(gb.InputError, match=r'record.rate_unit is rad/s, .* write rate_unit = "deg/s"'):
        fly(path, ("t", "a_x", "0", "a_z"), rates=Rates("p", "0", "0", "rad/s"))
    assert fly(path, ("t", "a_x", "0", "a_z"), rates=Rates("p", "0", "0", "deg/s")).rates is not None


@pytest.mark.parametrize("name", ["r.mat", "r.h5", "r.nc", "r.uff"])
def test_files_that_are_not_what_their_names_say(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(lines())
    for path in (tmp_path / name, tmp_path / f"none.{name}"):
        with pytest.raises(gb.InputError) as caught:
            fly(path)
        assert caught.value.where == "record.file"


def test_numbers_of_a_vax_are_refused(tmp_path: Path) -> None:
    header = struct.pack("<5i", 2000, 4, 1, 0, 2)  # version 4: VAX D-float, 4 by 1, real, a name of one letter
    (tmp_path / "r.mat").write_bytes(header + b"t\0" + np.arange(4.0).tobytes())
    with (
        warnings.catch_warnings(),
        pytest.raises(gb.InputError, match=r"VAX D-float.*may be corrupt.*save the record by"),
    ):
        warnings.simplefilter("error")
        fly(tmp_path / "r.mat", ("t", "0", "0", "t"))


LONG = 20_000
CELLS = ("1" * LONG + "x", "1." + "1" * LONG + "x", "1e" + "1" * LONG + "x", "1" * LONG, "1:" * LONG, "+" * LONG)
HEADERS = (
    "a" + " " * LONG + "x",
    "(" * LONG,
    "(" * LONG + ")x",
    ")" * LONG + "x",
    "a" + " " * LONG + "[g]",
    "[1" * LONG,
)


@pytest.mark.parametrize("delimiter", [",", "\t"])
@pytest.mark.parametrize("cell", [*CELLS, *HEADERS])
def test_a_long_cell_takes_no_more_than_its_length(tmp_path: Path, cell: str, delimiter: str) -> None:
    """20 kB: in the square of its length one cell of digits took minutes, now all of them milliseconds."""
    path, (first, row, rest) = tmp_path / "r.csv", lines(delimiter).split("\n", 2)
    long = delimiter.join([row.rpartition(delimiter)[0], cell]) if cell in CELLS else row
    named = delimiter.join((*NAMES[:3], cell)) if cell in HEADERS else first
    path.write_text("\n".join([named, *[long] * 10, rest]))
    begin = time.process_time()
    with pytest.raises(gb.InputError, match=r"record\."):
        fly(path)
    assert time.process_time() - begin < 1.0


@pytest.mark.parametrize(
    "text", ["1 g" + " " * LONG + "x", "1" * LONG + "x", "1 g / " + "1" * LONG + "!", "g /" * LONG]
)
def test_a_long_size_of_a_count_is_refused_at_once(text: str, tmp_path: Path) -> None:
    begin = time.process_time()
    (tmp_path / "r.csv").write_text(lines())
    with pytest.raises(gb.InputError, match=r"record\.unit"):
        read_flight(tmp_path / "r.csv", *NAMES, text)
    assert time.process_time() - begin < 1.0
