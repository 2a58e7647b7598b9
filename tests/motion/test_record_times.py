"""The times of a record: a part of it, times of day, and clocks that jitter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from gbeam import Flight, InputError, read_record, smoothed, trapezoid
from gbeam.io import read_clock
from gbeam.motion import Conditioning, FlightRecord, Rates, read_flight

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
    assert record is not None and (record.span, record.whole, record.read.samples) == ((2.0, 6.0), (0.0, 15.99), 401)
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
    assert fly(path, span=(4.0, 8.0)).summary.notes == ()


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
        assert (
            read.summary.done[0].startswith("times up to 3.1")
            and "a spline through the samples is flown" in read.summary.done[0]
        )
        true = 9.80665 * (1 + 3 * np.sin(2 * np.pi * 0.5 * times) ** 2)
        # At its labels the load would be off by 3 ms of its slope, 0.3 m/s².
        assert np.abs(read.acceleration.values[:, 2] - true)[50:-50].max() < 5e-3
    missing = np.delete(np.column_stack([even, 0 * load, 0 * load, load]), 800, axis=0)
    np.savetxt(path, missing, delimiter=",", header="t,x,y,z", comments="")
    with pytest.raises(InputError, match=r"has 1 gap, where the interval is 0.01 s: 0.02 s from 7.99 s to 8.01 s"):
        read_flight(path, *names, conditioning=Conditioning(resample=100.0))


WAVE = np.column_stack([0.01 * np.arange(1600), *np.zeros((2, 1600)), 1 + np.sin(0.05 * np.arange(1600)) ** 2])


def saved(folder: Path, rows: np.ndarray, stamps: Sequence[object] | None = None) -> Path:
    """A table of t, x, y, z, with other texts for the times."""
    path = folder / "wave.csv"
    times = rows[:, 0] if stamps is None else stamps
    lines = [",".join([f"{t:.9g}" if isinstance(t, float) else str(t), *(f"{v:.9g}" for v in row[1:])]) for t, row in
             zip(times, rows, strict=True)]  # fmt: skip
    path.write_text("\n".join(["t,x,y,z", *lines]), encoding="utf-8")
    return path


def wave(path: Path, time: str | None = "t", **options: object) -> FlightRecord:
    return read_flight(path, time, "x", "y", "z", "g", **options)  # type: ignore[arg-type]


def test_lost_samples_are_bridged_and_each_gap_is_told(tmp_path: Path) -> None:
    """Of three gaps all are told, and those up to the stated length are put on straight lines, where a slow wave is."""
    path = saved(tmp_path, np.delete(WAVE, [100, 101, 102, 500, *range(900, 912)], axis=0))
    told = (
        r"has 3 gaps, where the interval is 0.01 s: 0.04 s from 0.99 s to 1.03 s \(after row 101\), "
        r"0.02 s from 4.99 s to 5.01 s \(after row 498\), 0.13 s from 8.99 s to 9.12 s \(after row 897\); "
    )
    with pytest.raises(InputError, match=told + r'add bridge = "130 ms" and resample = "100 Hz": lost samples are put'):
        wave(path)
    for other in ({"resample": 100.0}, {"cutoff": 20.0}, {"resample": 100.0, "bridge": 0.04}):
        with pytest.raises(InputError, match=told + r'(add|write) bridge = "130 ms": lost'):
            wave(path, conditioning=Conditioning(**other))
    record = wave(path, conditioning=Conditioning(resample=100.0, bridge=0.13))
    gaps = record.summary.gaps
    assert [(each.start, each.end, each.lost, each.after) for each in gaps] == [
        (0.99, 1.03, 3, "row 101"),
        (4.99, 5.01, 1, "row 498"),
        (8.99, 9.12, 12, "row 897"),
    ]
    assert (record.summary.read.samples, record.summary.flown.samples) == (1584, 1600)
    np.testing.assert_allclose(record.acceleration.times, WAVE[:, 0], atol=1e-12)
    off = record.acceleration.values[:, 2] / 9.80665 - WAVE[:, 3]
    assert np.abs(off).max() < 0.13**2 / 8 * 2 * 5**2  # curvature of sin², over a straight line of 0.13 s
    assert np.abs(np.delete(off, np.r_[99:104, 499:502, 899:913])).max() < 1e-3


def test_long_gaps_are_no_detail(tmp_path: Path) -> None:
    """A part between them is offered, which the next call takes."""
    path = saved(tmp_path, np.delete(WAVE, np.r_[300:330, 1200:1300], axis=0))
    with pytest.raises(InputError, match=r'write from = "3.3 s", to = "11.99 s", .*; add bridge = "1010 ms"'):
        wave(path)
    assert wave(path, span=(3.3, 11.99)).summary.read.samples == 870


def test_a_bridge_that_is_offered_reaches_over_its_gap(tmp_path: Path) -> None:
    """A clock of minutes rounds: a gap of 1010.00001 ms is not bridged by 1010 ms, and 1020 ms are offered."""
    lost = np.delete(WAVE, np.s_[1200:1300], axis=0)
    path = saved(tmp_path, lost, [f"{t:.12g}" for t in lost[:, 0] + np.where(lost[:, 0] > 12, 1e-8, 0.0)])
    with pytest.raises(InputError, match=r'add bridge = "1020 ms"'):
        wave(path, conditioning=Conditioning(resample=100.0))
    assert len(wave(path, conditioning=Conditioning(resample=100.0, bridge=1.02)).summary.gaps) == 1


def test_late_and_repeated_samples_are_put_in_order(tmp_path: Path) -> None:
    """Two that changed places and one that repeats a time; a time with two samples has their mean."""
    order = np.arange(1600)
    order[[200, 201]] = 201, 200
    rows = WAVE[order]
    rows = np.insert(rows, 801, rows[800] + [0, 0, 0, 0.1], axis=0)
    path = saved(tmp_path, rows)
    with pytest.raises(
        InputError, match=r'goes back to 2 s at row 203, repeats 8 s at row 803; add resample = "100 Hz"'
    ):
        wave(path)
    record = wave(path, conditioning=Conditioning(resample=100.0))
    right = WAVE[:, 3].copy()
    right[800] += 0.05
    np.testing.assert_allclose(record.acceleration.values[:, 2], 9.80665 * right, rtol=1e-8)
    assert record.summary.done[:2] == (
        "times go back 1 times: the samples are put in order",
        "1 samples repeat a time: the mean of its samples is flown",
    )


def test_a_clock_that_was_set_is_two_records(tmp_path: Path) -> None:
    """A part alone at its times is offered; where two overlap, the file is to be split."""
    alone = WAVE.copy()
    alone[:600, 0] += 100
    with pytest.raises(InputError, match=r'goes back by 99.99 s at row 602: .* write from = "6 s", to = "15.99 s"'):
        wave(saved(tmp_path, alone))
    assert wave(saved(tmp_path, alone), span=(6.0, 15.99)).summary.read.samples == 1000
    both = np.concatenate([WAVE, WAVE])
    with pytest.raises(InputError, match=r"goes back by 15.99 s at row 1602: .*split the file at row 1602"):
        wave(saved(tmp_path, both), conditioning=Conditioning(resample=100.0))


@pytest.mark.parametrize(
    "stamps",
    [
        [f"12:34:{i // 100:02d}" for i in range(1600)],
        [float(i // 100) for i in range(1600)],
        ["7"] * 1600,
    ],
)
def test_a_clock_of_whole_seconds_is_replaced_by_the_sample_rate(tmp_path: Path, stamps: list[object]) -> None:
    path = saved(tmp_path, WAVE, stamps)
    with pytest.raises(InputError, match=r'record.time repeats .*write sample_rate = "100 Hz" in place of time'):
        wave(path)
    record = wave(path, None, sample_rate=100.0)
    np.testing.assert_allclose(record.acceleration.times, WAVE[:, 0], atol=1e-12)
    with pytest.raises(InputError, match=r"record.sample_rate is given beside time"):
        wave(path, sample_rate=100.0)
    with pytest.raises(InputError, match="has neither time nor sample_rate"):
        wave(path, None)


def test_rows_that_are_written_twice_are_no_coarse_clock(tmp_path: Path) -> None:
    path = saved(tmp_path, WAVE.repeat(3, axis=0))
    with pytest.raises(InputError, match=r'repeats 0 s at row 3, .* and 3180 more; add resample = "100 Hz"'):
        wave(path)
    record = wave(path, conditioning=Conditioning(resample=100.0))
    np.testing.assert_allclose(record.acceleration.values[:, 2], 9.80665 * WAVE[:, 3], rtol=1e-8)


def test_times_since_1970_count_from_the_first(tmp_path: Path) -> None:
    """In ns a float has steps of 256: the times are those of the record, not those of the clock's numbers."""
    path = saved(tmp_path, WAVE, [1637290175093369303 + 10_000_000 * i for i in range(1600)])
    record = wave(path, time_unit="ns")
    np.testing.assert_allclose(record.acceleration.times, WAVE[:, 0], atol=3e-7)
    assert record.summary.clock == "1637290175093369303 ns"
    part = wave(path, time_unit="ns", span=(2.0, 6.0)).summary
    assert part.read.samples == pytest.approx(401, abs=1)


@pytest.mark.parametrize(
    ("stamp", "first"),
    [
        (lambda i: f"2024-3-23--13-41-{38 + i // 100}-{10 * (i % 100)}", "2024-3-23--13-41-38-0"),
        (lambda i: f"2024/03/23 13:41:{38 + i // 100}.{i % 100:02d}", "2024/03/23 13:41:38.00"),
        (lambda i: f"23.3.2024 13:41:{38 + i // 100}.{i % 100:02d}", "23.3.2024 13:41:38.00"),
        (lambda i: f"3/23/2024 1:41:{38 + i // 100}.{i % 100:02d} PM", "3/23/2024 1:41:38.00 PM"),
        (lambda i: f"2024-03-23 13:41:{38 + i // 100}:{10 * (i % 100):03d}", "2024-03-23 13:41:38:000"),
    ],
)
def test_dates_as_loggers_write_them(tmp_path: Path, stamp: Callable[[int], str], first: str) -> None:
    record = wave(saved(tmp_path, WAVE, [stamp(i) for i in range(1600)]))
    np.testing.assert_allclose(record.acceleration.times, WAVE[:, 0], atol=1e-9)
    assert record.summary.clock == first


def test_what_is_no_date_of_a_logger() -> None:
    assert read_clock(["2024-2-28--23-59-59-500", "2024-2-29--0-0-0-25"])[1].tolist() == [0, 0.525]  # type: ignore[index]
    assert read_clock(["3/4/2024 11:59:59 PM", "3/5/2024 12:00:01 AM"])[1].tolist() == [0, 2]  # type: ignore[index]
    assert read_clock(["12:34:57", "12:34:56.9"])[1].tolist() == pytest.approx([0, -0.1])  # type: ignore[index]
    for text in ("12-34-56", "2024-2-30--1-1-1", "2024-2-3--24-1-1", "13:41:38 PM", "2024-3-23"):
        assert read_clock([text]) is None


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
