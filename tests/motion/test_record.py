"""Flight records: the example file, and every way in which a file can be wrong."""

from pathlib import Path

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb

F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
HEADER = "t,ax,ay,az"
ROWS = [f"{0.1 * i:.1f},{i / 10:g},{i / 5:g},{-3 * i / 10:g}" for i in range(12)]


def read(tmp_path: Path, lines: list[str], time: str = "t", z: str = "az", unit: str = "m/s^2"):  # type: ignore[no-untyped-def]
    path = tmp_path / "record.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return gb.read_record(path, time, "ax", "-ay", z, unit)


def test_columns_signs_and_units(tmp_path: Path) -> None:
    i = np.arange(12) / 10
    np.testing.assert_allclose(read(tmp_path, [HEADER, *ROWS]).values, np.stack([i, -2 * i, -3 * i], axis=1))
    in_g = read(tmp_path, ["\ufefft , ax,ay,-az", *ROWS, ""], z="-az", unit="g")  # a dash in the header is a name
    np.testing.assert_allclose(in_g.values, STANDARD_GRAVITY * np.stack([i, -2 * i, -3 * i], axis=1))
    np.testing.assert_array_equal(read(tmp_path, [HEADER, *ROWS], z="0").values[:, 2], 0)


def test_a_record_of_zeros_alone_is_none(tmp_path: Path) -> None:
    (tmp_path / "record.csv").write_text("\n".join([HEADER, *ROWS]), encoding="utf-8")
    with pytest.raises(gb.InputError, match=r'takes nothing of the file: x, y and z are "0".*name a column'):
        gb.read_record(tmp_path / "record.csv", "t", "0", "0", "0", "g", quantity="acceleration")


def test_f16_record() -> None:
    record = gb.read_record(F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
    assert record.times.shape == (1600,) and record.values.shape == (1600, 3)
    assert float(record.times[-1]) == 15.99
    assert 8.0 < float(np.max(record.values[:, 2])) / STANDARD_GRAVITY < 8.3  # level flight loads +z once mapped


def replaced(row: int, text: str) -> list[str]:
    return [text if i == row - 1 else line for i, line in enumerate([HEADER, *ROWS])]


@pytest.mark.parametrize(
    ("lines", "options", "where", "words"),
    [
        ([HEADER, *ROWS], {"z": "-azz"}, "record.z", ["'azz'", "did you mean 'az'", "t, ax, ay, az"]),
        ([HEADER, *ROWS], {"time": "time"}, "record.time", ["'time'"]),
        ([HEADER, *ROWS], {"unit": "furlong"}, "record.unit", ["'furlong'", "m/s^2"]),
        ([HEADER + ",az", *[row + ",0" for row in ROWS]], {}, "record.z", ["2 times"]),
        (replaced(4, "0.2,2,4,six"), {}, "record.z", ["row 4", "'six'"]),
        (replaced(4, "0.2,2,,-6"), {}, "record.y", ["row 4", "empty"]),
        (replaced(3, "0.1,nan,2,-3"), {}, "record.x", ["row 3", "nan"]),
        (replaced(3, "inf,1,2,-3"), {}, "record.time", ["row 3", "inf"]),
        (replaced(5, "0.2,3,6,-9"), {}, "record.time", ["repeats", "row 5"]),
        (replaced(5, "0.05,3,6,-9"), {}, "record.time", ["goes back", "row 5"]),
        (
            [*[HEADER, *ROWS][:6], *ROWS[8:], "1.2,5,10,-15", "1.3,5,10,-15", "1.4,5,10,-15"],
            {},
            "record.time",
            ["1 gap", "0.4 s to 0.8 s", "after row 6"],
        ),
        (replaced(7, "0.502,5,10,-15"), {}, "record.time", ["unevenly", "row 7"]),
        (replaced(6, "0.4,4,8"), {}, "record.file", ["row 6", "3 cells", "4"]),
        ([HEADER, *ROWS[:3]], {}, "record.file", ["3 row(s)", "6 samples"]),
        ([line.split(",")[0] for line in [HEADER, *ROWS]], {}, "record.file", ["one column"]),
    ],
)
def test_refusals_name_the_row_and_the_fix(
    tmp_path: Path, lines: list[str], options: dict[str, str], where: str, words: list[str]
) -> None:
    with pytest.raises(gb.InputError) as caught:
        read(tmp_path, lines, **options)
    assert caught.value.where == where
    for word in words:
        assert word in str(caught.value)


def test_slight_unevenness_of_a_clock_is_accepted(tmp_path: Path) -> None:
    assert read(tmp_path, replaced(7, "0.5004,5,10,-15")).times.size == 12


def test_missing_empty_and_binary_files(tmp_path: Path) -> None:
    empty, binary = tmp_path / "empty.csv", tmp_path / "binary.csv"
    empty.write_text("")
    binary.write_bytes(b"\xff\xfe\x00\x81")
    for path, words in ((tmp_path / "none.csv", "cannot be read"), (empty, "empty"), (binary, "not CSV")):
        with pytest.raises(gb.InputError, match=words):
            gb.read_record(path, "t", "x", "y", "z", "g")
