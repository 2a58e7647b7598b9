"""Records of flights: sound files of every kind, with bytes, columns, cells, sizes or names changed."""

from __future__ import annotations

import io
from functools import cache
from typing import Any

import numpy as np

from fuzz.cases import Case, Random
from fuzz.damage import damaged
from fuzz.scenarios import corrupted

ROWS = 200
TEXTS = (".csv", ".csv", ".txt")
# Each suffix with the kinds of files that have it.
BINARIES = {
    ".mat": ("structure", "plain", "nested", "cells", "version 4", "version 7.3"),
    ".h5": ("hdf5", "hdf5 of words"),
    ".nc": ("netcdf 3", "netcdf 4"),
    ".uff": ("uff", "uff in binary"),
}
CELLS = [
    "", "nan", "inf", "-inf", "1e999", "1,5", "1;5", '"', '"1', "x", "٣", "\x1b[31m", "0x10", "1_0", "--1",
    "9" * 500, " ", "12:34:56.7", "2024-02-30T25:00:00", "2024-3-23--13-41-38-830", "1.5D+02", "1.5-103",
]  # fmt: skip
KEYS = [
    "time", "x", "y", "z", "unit", "time_unit", "cutoff", "resample", "despike", "skip_checks", "quantity", "p",
    "rate_unit", "from", "to", "bridge", "sample_rate", "vehicle", "level", "rest", "sections", "section", "of",
]  # fmt: skip
VALUES = [
    '"0"', '"-"', '""', '"none"', '"-t"', '"ms"', '"s"', '"g"', '"m/s^2"', '"0.1 Hz"', '"3 Hz"', '"1e9 Hz"',
    '"1e-9 Hz"', "true", '["spikes"]', '["unit", "sign", "sampling"]', '"acceleration"', '"ax"', '"rad/s"', "-1",
    '"\\u001b"', '"1 s"', '"1 g / 2048"', '"50 ms"', '"rocket"', '"mm/s^2"', '"ns"',
    '"99:12:34:56"', "12:34:56.5", "2024-05-03T12:34:56Z", '["columns"]', '["0 s", "1 s"]', "3",
    '[{ to = "1 s" }]', '[{ to = "1 s" }, { from = "1 s", load = [0, 0, "1 g"] }]', "[{}]", '["rest"]',
]  # fmt: skip


def columns(rows: int = ROWS) -> dict[str, Any]:
    """A gentle turn."""
    t = np.arange(rows) / 50.0
    return {"t": t, "ax": 0.1 * np.sin(t), "ay": 0.05 * np.cos(3 * t), "az": 1 + np.sin(0.7 * t) ** 2}


def record(chosen: Random) -> Case:
    """A scenario with a record that is malformed, or with a wrong word about a sound one."""
    suffix = chosen.choice((*TEXTS, *BINARIES))
    data = text(chosen) if suffix in TEXTS else binary(chosen.choice(BINARIES[suffix]))
    for _ in range(chosen.choice((0, 1, 1, 2, 4, 20))):
        data = corrupted(chosen, data) if suffix in TEXTS else damaged(chosen, data)
    entry = {"file": f'"r{suffix}"', "time": '"t"', "x": '"ax"', "y": '"ay"', "z": '"az"', "unit": '"g"'}
    if suffix == ".uff":
        entry |= {"time": '"time"'}
    if chosen.random() < 0.4:
        entry[chosen.choice(KEYS)] = chosen.choice(VALUES)
    if chosen.random() < 0.3:
        entry |= {"cutoff": chosen.choice(VALUES), "resample": chosen.choice(VALUES)}
    if chosen.random() < 0.05:
        entry["file"] = chosen.choice(
            ('"/dev/zero"', '"."', '""', '"a\\u0000"', '"' + "a" * 300 + '"', '"~"', '"missing.csv"')
        )
    table = ", ".join(f"{key} = {value}" for key, value in entry.items())
    return Case(
        "record", ["check", "s.toml"], {"s.toml": SCENARIO.replace("RECORD", table).encode(), f"r{suffix}": data}
    )


SIZES = {"g": 1.0, "m/s^2": 9.80665, "mm/s^2": 9806.65, "mg": 1000.0, "ft/s^2": 32.174, "in/s^2": 386.09, "": 2048.0}
STAMPS = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9, "min": 1 / 60}
NAMES = ("a{0}", "n_{0}", "n_{0}_{u}", "acc_{0} [{u}]", "acc[{k}]", "accelerometer_m_s2[{k}]", "{0}HighG", "a{0}_mV")


def measured(chosen: Random) -> Case:
    """A sound record as loggers write it, with a fault of a clock or a sensor, and a wrong word or two about it."""
    count, rate = chosen.choice((150, 400, 1600)), chosen.choice((20, 50, 100, 100, 400, 3200))
    t, random = np.arange(count) / rate, np.random.default_rng(chosen.randrange(2**32))
    share = t / t[-1]
    upwards = {
        "turn": 1 + 5 * np.exp(-(((share - 0.5) / 0.1) ** 2)),
        "rocket": np.interp(share, (0, 0.1, 0.12, 0.2, 0.22, 0.4, 0.42, 1), (1, 1, 6, 8, 0, 0, -1, -1)),
        "boost": np.interp(share, (0, 0.3, 0.32, 1), (7, 9, 0, 0)),
        "cruise": np.ones(count),
        "sledge": 0.2 * np.sin(20 * share),
    }[chosen.choice(("turn", "turn", "rocket", "boost", "cruise", "sledge"))]
    load = random.normal(0, 0.01, (count, 3)) + np.stack([0.1 * share, 0.05 * share, upwards], axis=1)
    unit, stamp = chosen.choice([*SIZES, "g"]), chosen.choice([*STAMPS, "s", "s"])
    signs = [chosen.choice((1, -1)) for _ in range(3)]
    table = {}
    style = chosen.choice(NAMES)
    names = [style.format(axis, u=unit.replace("/", "_").replace("^", ""), k=k) for k, axis in enumerate("xyz")]
    for k, name in enumerate(names):
        table[name] = signs[k] * SIZES[unit] * load[:, k]
    if chosen.random() < 0.3:
        table |= {each: random.normal(0, 0.1, count) for each in ("p_rad_s", "q_rad_s", "r_rad_s")}
    rows = np.column_stack([*table.values()])
    kept, clock = np.arange(count), t + chosen.choice((0.0, 0.0, 1.7e9))
    match chosen.randrange(9):
        case 0:
            kept = np.delete(kept, np.r_[chosen.randrange(20, 60) : 70, 90:91])
        case 1:
            kept = np.delete(kept, np.r_[60 : min(60 + rate, count - 60)])
        case 2:
            kept[[40, 41]] = 41, 40
        case 3:
            clock[50] = clock[49]
        case 4:
            clock = np.floor(clock)
        case 5:
            clock = clock + random.uniform(-0.3, 0.3, count) / rate
        case 6:
            clock[count // 2 :] -= 0.4 * t[-1]
        case 7:
            rows[chosen.randrange(10, 100) :][: chosen.randrange(1, 5), 2] += 15 * SIZES[unit]
        case _:
            pass
    if chosen.random() < 0.15:
        day = [
            f"2024-3-23--{int(v // 3600)}-{int(v // 60 % 60)}-{int(v % 60)}-{int(1000 * v % 1000)}"
            for v in clock % 86400
        ]
        stamps = day
    else:
        stamps = [f"{v * STAMPS[stamp]:.9g}" if v < 1e6 else f"{v * STAMPS[stamp]:.3f}" for v in clock]
    lines = [",".join(["t", *table]), *(",".join([stamps[i], *(f"{v:.7g}" for v in rows[i])]) for i in kept)]
    wrong = chosen.random
    entry = {"file": '"r.csv"', "time": '"t"'}
    for k, axis in enumerate("xyz"):
        minus = (signs[k] < 0) != (wrong() < 0.25)
        entry[axis] = f'"{"-" if minus else ""}{names[k]}"'
    entry["unit"] = f'"{unit or "1 g / 2048"}"' if wrong() < 0.6 else f'"{chosen.choice(list(SIZES)) or "1 g / 98 mV"}"'
    if wrong() < 0.5:
        entry["time_unit"] = f'"{stamp if wrong() < 0.6 else chosen.choice(list(STAMPS))}"'
    if "p_rad_s" in table and wrong() < 0.8:
        entry |= {each[0]: f'"{chosen.choice(("", "-"))}{each}"' for each in table if each.endswith("_rad_s")}
        entry["rate_unit"] = chosen.choice(('"rad/s"', '"rad/s"', '"deg/s"'))
    asked = [("vehicle", '"rocket"'), ("vehicle", '"other"'), ("resample", f'"{rate} Hz"'), ("despike", "true")]
    for key, value in (
        *asked,
        ("quantity", '"acceleration"'),
        ("cutoff", f'"{rate / 4} Hz"'),
        ("rest", '[{ to = "1 s" }]'),
        ("sections", f'"{names[0]}"'),
        ("section", "3"),
    ):
        if wrong() < 0.1:
            entry[key] = value
    record = ", ".join(f"{key} = {value}" for key, value in entry.items())
    files = {"s.toml": SCENARIO.replace("RECORD", record).encode(), "r.csv": "\n".join(lines).encode()}
    return Case("fixes", ["check", "s.toml"], files)


def text(chosen: Random) -> bytes:
    """A table of text with cells, rows, a delimiter, an encoding or times that are not sound."""
    table = columns(chosen.choice((0, 1, 2, 5, 6, ROWS, ROWS)))
    rows = [[f"{value:.6g}" for value in row] for row in zip(*table.values(), strict=True)]
    delimiter = chosen.choice((",", ",", ";", "\t", " ", "|"))
    header = list(table)
    for _ in range(chosen.choice((0, 0, 1, 1, 3))):
        i = chosen.randrange(len(rows)) if rows else 0
        match chosen.randrange(7):
            case 0 if rows and rows[i]:
                rows[i][chosen.randrange(len(rows[i]))] = chosen.choice(CELLS)
            case 1 if rows:
                rows[i] = rows[i][: chosen.randrange(4)]
            case 2 if rows:
                rows[i] = rows[chosen.randrange(len(rows))]
            case 3:
                header[chosen.randrange(len(header))] = chosen.choice(CELLS)
            case 4:
                header = header * chosen.choice((1, 2, 500))
            case 5 if rows:
                rows[i] = rows[i] * chosen.choice((2, 5000))
            case _:
                column, factor = chosen.randrange(4), chosen.choice((-1.0, 0.0, 1e-6, 1e6, 1e300))
                rows = [[*row[:column], f"{factor * number(row, column):g}", *row[column + 1 :]] for row in rows]
    lines = [delimiter.join(header), *(delimiter.join(row) for row in rows)]
    if chosen.random() < 0.2:
        lines.insert(
            chosen.randrange(len(lines) + 1), chosen.choice(("# note", "[s],[g],[g],[g]", ";;;", "", '"', "\x00"))
        )
    end = chosen.choice(("\n", "\r\n", "\r"))
    return end.join(lines).encode(chosen.choice(("utf-8", "utf-8", "utf-16", "latin-1")), "replace")


def number(row: list[str], column: int) -> float:
    """A cell as a number; 1 where it is none."""
    try:
        return float(row[column])
    except (IndexError, ValueError):
        return 1.0


@cache
def binary(kind: str) -> bytes:
    """A sound file of a kind."""
    table, file = columns(), io.BytesIO()
    match kind:
        case "structure" | "plain" | "nested" | "cells" | "version 4":
            from scipy.io import savemat

            cells = np.array([*table.values(), "words", {"deep": table}], dtype=object)
            content = {
                "structure": {"rec": table, **table}, "nested": {"a": {"b": {"c": {"d": table}}}, **table},
                "cells": {"rec": cells, **table},
            }.get(kind, table)  # fmt: skip
            savemat(file, content, do_compression=kind == "structure", format="4" if kind == "version 4" else "5")
        case "version 7.3" | "hdf5" | "hdf5 of words":
            import h5py

            with h5py.File(file, "w", userblock_size=512 if kind == "version 7.3" else 0) as opened:
                for name, values in table.items():
                    each = opened.create_dataset(name, data=values, compression="gzip", chunks=True)
                    each.attrs["units"] = "s" if name == "t" else "g"
                opened["matrix"] = np.zeros((ROWS, 3))
                if kind == "hdf5 of words":
                    opened["words"] = np.array(["a", "bc"], dtype=h5py.string_dtype())
                    opened["rows"] = np.zeros(5, dtype=[("t", "f8"), ("name", "S5")])
                    opened["again"] = h5py.SoftLink("/t")
        case "netcdf 3":
            from scipy.io import netcdf_file

            opened = netcdf_file(file, "w")
            opened.createDimension("t", ROWS)
            for name, values in table.items():
                opened.createVariable(name, "f8", ("t",))[:] = values
            opened.flush()
        case "netcdf 4":
            import h5netcdf

            with h5netcdf.File(file, "w") as opened:
                opened.dimensions = {"t": ROWS}
                for name, values in table.items():
                    opened.create_variable(name, ("t",), data=values).attrs["units"] = "s" if name == "t" else "g"
        case _:
            sets = (_set_58(name, table["t"], each) for name, each in table.items() if name != "t")
            return b"".join(map(_as_58b, sets) if kind == "uff in binary" else sets)
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" if kind == "version 7.3" else b""
    return head + file.getvalue()[len(head) :]


def _as_58b(text: bytes) -> bytes:
    """Universal data set 58 with its values as numbers of eight bytes."""
    lines = text.split(b"\n")
    numbers = np.array(b" ".join(lines[13:-2]).split(), dtype="<f8")
    lines[1] = f"{58:6d}b{1:6d}{2:6d}{11:12d}{8 * len(numbers):12d}{0:6d}{0:6d}{0:12d}{0:12d}".encode()
    return b"\n".join([*lines[:13], numbers.tobytes() + lines[-2], b""])


def _set_58(name: str, t: Any, values: Any) -> bytes:
    """Universal data set 58: a real, even time response."""
    lines = [
        f"{'':4}-1", f"{58:6d}", name, "NONE", "01-Jan-26 00:00:00", "NONE", "NONE",
        f"{1:5d}{0:10d}{1:5d}{0:10d} {'NONE':10}{1:10d}{3:4d} {'NONE':10}{1:10d}{0:4d}",
        f"{4:10d}{len(t):10d}{1:10d}{t[0]:13.5e}{t[1] - t[0]:13.5e}{0.0:13.5e}",
        f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':20} {'s':20}",
        f"{12:10d}{0:5d}{0:5d}{0:5d} {'Acceleration':20} {'g':20}",
        *[f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20} {'NONE':20}"] * 2,
    ]  # fmt: skip
    lines += ["".join(f"{value:20.11e}" for value in values[i : i + 4]) for i in range(0, len(values), 4)]
    return "\n".join([*lines, f"{'':4}-1", ""]).encode()


SCENARIO = """\
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
[model]
kind = "FOAM"
modes = { axial = 0, y = 1, z = 1 }
[motion.flight]
kind = "flight"
record = { RECORD }
"""
