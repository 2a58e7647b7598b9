"""The times of a record: a part of it, times of day, and clocks that jitter."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gbeam import Flight, InputError, read_record, smoothed, trapezoid
from gbeam.io.table import read_clock
from gbeam.motion.records.record import Conditioning, FlightRecord, Rates, read_flight

F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
NAMES = ("n_x_g", "-n_y_g", "-n_z_g", "g")
HEADER, *ROWS = (line.split(",") for line in F16.read_text().splitlines())
BEGIN = 12 * 3600 + 34 * 60 + 56.789


def written(folder: Path, time: Callable[[int], str]) -> Path:
    """The F-16's record with other times."""
    path = folder / "times.csv"
    rows = [[time(i), *row[1:]] for i, row in enumerate(ROWS)]
    path.write_text("\n".join(",".join(row) for row in [HEADER, *rows]))
    return path


def fly(path: Path = F16, **options: object) -> FlightRecord:
    return read_flight(path, "time_s", *NAMES, **options)  # type: ignore[arg-type]


def of_day(i: int, begin: float = BEGIN) -> str:
    now = (begin + 0.01 * i) % 86400
    return f"{int(now // 3600):02d}:{int(now // 60 % 60):02d}:{now % 60:06.3f}"


def test_a_part_is_the_same_samples_on_the_same_clock() -> None:
    whole, part = fly(), fly(span=(2.0, 6.004))
    np.testing.assert_array_equal(part.acceleration.times, whole.acceleration.times[200:601])
    np.testing.assert_array_equal(part.acceleration.values, whole.acceleration.values[200:601])
    record = part.acceleration.record
    assert record is not None and (record.span, record.whole, record.samples) == ((2.0, 6.0), (0.0, 15.99), 401)
    rates = Rates("p_rad_s", "-q_rad_s", "-r_rad_s", "rad/s")
    turning, all_turning = fly(rates=rates, span=(2.0, 6.0)).rates, fly(rates=rates).rates
    assert turning is not None and all_turning is not None
    np.testing.assert_array_equal(turning.values, all_turning.values[200:601])


def test_what_is_outside_the_part_may_be_unsound(tmp_path: Path) -> None:
    """Level flight is looked for in the whole; what is no number, stands still or jumps there is nobody's concern."""
    path = tmp_path / "spoilt.csv"
    rows = [list(row) for row in ROWS]
    rows[10][3], rows[900][3] = "nan", "-40"
    for row in rows[1200:1300]:
        row[2] = "0.9"
    path.write_text("\n".join(",".join(row) for row in [HEADER, *rows]))
    with pytest.raises(InputError, match="row 12, column 'n_z_g' is nan"):
        fly(path)
    with pytest.raises(InputError, match="stands still"):
        fly(path, span=(4.0, None), conditioning=Conditioning(skip_checks=("spikes",)))
    # A part that begins at 5 g, in which nothing is level.
    assert fly(path, span=(4.0, 8.0)).notes == ()


@pytest.mark.parametrize(
    ("span", "words"),
    [
        ((20.0, None), r"record.from is 20 s, and the record lasts 0 to 15.99 s; give a time of it"),
        ((None, -1.0), r"record.to is -1 s, and the record lasts"),
        ((6.0, 2.0), r"record.to leaves 0 row\(s\) from 6 to 2 s; give more of 0 to 15.99 s: 6 samples at least"),
        ((15.95, None), r"record.from leaves 5 row\(s\) from 15.95 to 15.99 s"),
        (("12:34:56", None), r"record.from is '12:34:56'; give a time of the record's own clock, 0 to 15.99 s"),
    ],
)
def test_a_part_that_is_none_is_refused(span: tuple[float, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        fly(span=span)


def test_times_of_day_count_from_the_first(tmp_path: Path) -> None:
    plain = fly().acceleration
    for before in ("", "2024-05-03T", "2024-05-03 ", "124:"):
        timed = fly(written(tmp_path, lambda i, before=before: before + of_day(i))).acceleration  # type: ignore[misc]
        np.testing.assert_array_equal(timed.values, plain.values)
        np.testing.assert_allclose(timed.times, plain.times, rtol=0, atol=1e-9)
        assert timed.record is not None and timed.record.clock == f"{before}12:34:56.789"
    assert fly(span=(3.211, 13.711)).acceleration.times.tolist() == pytest.approx(
        fly(written(tmp_path, of_day), span=("12:35:00", "12:35:10.5")).acceleration.times.tolist()
    )
    with pytest.raises(
        InputError, match=r"from is 12:34:50, and the record lasts 0 to 15.99 s, 0 s being 12:34:56.789"
    ):
        fly(written(tmp_path, of_day), span=("12:34:50", None))
    with pytest.raises(InputError, match=r"row 7, column 'time_s' is '12:34:99'"):
        fly(written(tmp_path, lambda i: "12:34:99" if i == 5 else of_day(i)))
    with pytest.raises(InputError, match=r"record.time_unit is ms, and the times are times of day"):
        fly(written(tmp_path, of_day), time_unit="ms")


def test_times_of_day_pass_midnight_and_zones(tmp_path: Path) -> None:
    over = fly(written(tmp_path, lambda i: of_day(i, 86395.0))).acceleration.times
    np.testing.assert_allclose(over, 0.01 * np.arange(1600), rtol=0, atol=1e-9)
    cells = ["2024-02-28T23:59:59.5Z", "2024-02-29 00:00:00,25+00:00", "2024-02-29T01:00:01+01", "2024-02-30T00:00:00"]
    clock = read_clock(cells)
    assert clock is not None
    np.testing.assert_array_equal(clock[1], [0, 0.75, 1.5, np.nan])
    assert read_clock(["1.5"]) is None and read_clock(["25:00:00"]) is None


def test_times_of_day_in_a_table_of_semicolons_and_commas(tmp_path: Path) -> None:
    path = tmp_path / "german.csv"
    rows = [
        ";".join([of_day(i).replace(".", ","), *(x.replace(".", ",") for x in row[1:])]) for i, row in enumerate(ROWS)
    ]
    path.write_text("\n".join([";".join(HEADER), *rows]))
    np.testing.assert_array_equal(fly(path).acceleration.values, fly().acceleration.values)


def test_a_clock_that_jitters_is_resampled(tmp_path: Path) -> None:
    """The load at uneven times, as it would be measured, comes back at even ones."""
    rng, even = np.random.default_rng(0), 0.01 * np.arange(1600)
    uneven = even + rng.uniform(-3e-3, 3e-3, 1600)
    load = 1 + 3 * np.sin(2 * np.pi * 0.5 * uneven) ** 2
    path = tmp_path / "jitter.csv"
    np.savetxt(path, np.column_stack([uneven, 0 * load, 0 * load, load]), delimiter=",", header="t,x,y,z", comments="")
    names = ("t", "x", "y", "z", "g")
    with pytest.raises(InputError, match=r'is sampled unevenly: .*add resample = "100 Hz": at equal intervals'):
        read_flight(path, *names)
    for options in ({}, {"cutoff": 20.0}):
        read = read_flight(path, *names, conditioning=Conditioning(resample=100.0, **options))
        times = np.asarray(read.acceleration.times)
        assert np.ptp(np.diff(times)) < 1e-12
        assert read.notes[0].startswith("times up to 3.1") and "a spline through the samples is flown" in read.notes[0]
        true = 9.80665 * (1 + 3 * np.sin(2 * np.pi * 0.5 * times) ** 2)
        # At its labels the load would be off by 3 ms of its slope, 0.3 m/s².
        assert np.abs(read.acceleration.values[:, 2] - true)[50:-50].max() < 5e-3
    missing = np.delete(np.column_stack([even, 0 * load, 0 * load, load]), 800, axis=0)
    np.savetxt(path, missing, delimiter=",", header="t,x,y,z", comments="")
    with pytest.raises(InputError, match=r"has a gap of 0.02 s from 7.99 s to 8.01 s"):
        read_flight(path, *names, conditioning=Conditioning(resample=100.0))


def test_a_flight_knows_of_what_it_is_a_part() -> None:
    record = read_record(F16, "time_s", *NAMES)
    flight = Flight(acceleration=smoothed(record, 0.1))
    assert flight.record is record.record and flight.part_of(0.0, 15.99) is flight.part_of(0.0, 16.0) is None
    assert flight.part_of(0.0, 6.0) == flight.part_of(2.0, 15.99) == (0.0, 15.99)
    cut = Flight(acceleration=read_record(F16, "time_s", *NAMES, span=(0.0, 6.0)))
    assert cut.part_of(0.0, 6.0) == (0.0, 15.99)
    pull = trapezoid(30.0, jerk=30.0, start=1.0, hold=2.0)
    for flight in (Flight(z=pull), Flight(z=smoothed(pull, 0.5)), Flight(x=9.8, z=pull), Flight(z=9.8, rates=record)):
        assert flight.part_of(0.0, 20.0) is None and flight.part_of(0.0, 4.0) is not None
    assert Flight(z=9.8).part_of(0.0, 1.0) is None
