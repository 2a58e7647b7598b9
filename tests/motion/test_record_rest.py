"""Offsets of a record's sensors, found where the load is known: against drifts that are put in, and in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gbeam import Flight, InputError, read_record
from gbeam.arrays import Floats
from gbeam.motion import Conditioning, FlightRecord, Instrument, Rates, Rest, notes_on, read_flight

G = 9.80665
TIME = np.arange(1201) / 100  # s
RATES = Rates("p", "q", "r", "deg/s")
ENDS = Rest(0.0, 1.5), Rest(10.5, 12.0)


def written(path: Path, load: Floats, rates: Floats | None = None) -> Path:
    """A file of a load (t, 3), in g, and of rates (t, 3), in deg/s, from m/s² and rad/s."""
    columns = [TIME[:, None], load / G, *([] if rates is None else [np.degrees(rates)])]
    names = "time,ax,ay,az" + ("" if rates is None else ",p,q,r")
    np.savetxt(path, np.concatenate(columns, axis=1), delimiter=",", header=names, comments="", fmt="%.17g")
    return path


def read(path: Path, *rests: Rest, rates: Rates | None = RATES, **options: Any) -> FlightRecord:
    instrument = Instrument(rest=rests, **{key: options.pop(key) for key in ("turn", "level", "arm") if key in options})
    columns = {"x": "ax", "y": "ay", "z": "az"} | {key: options.pop(key) for key in ("x", "y", "z") if key in options}
    return read_flight(path, "time", **columns, unit="g", rates=rates, instrument=instrument, **options)


def manoeuvre(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Specific force and rates (t, 3) at random, at rest for two seconds at either end."""
    load, rates = np.tile([0.0, 0.0, G], (len(TIME), 1)), np.zeros((len(TIME), 3))
    bump = np.where((TIME > 2) & (TIME < 10), np.sin(np.pi * (TIME - 2) / 8) ** 2, 0.0)[:, None]
    turns = np.sin(rng.uniform(0.5, 2, 3) * TIME[:, None])
    return load + rng.uniform(-8, 8, 3) * bump * turns, rates + rng.uniform(-0.5, 0.5, 3) * bump * turns


@pytest.mark.parametrize("seed", range(4))
def test_offsets_and_drifts_that_are_put_in_are_taken_out(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    load, rates = manoeuvre(rng)
    block = Rotation.from_rotvec(rng.uniform(-0.4, 0.4, 3))
    start, slope = rng.uniform(-0.03, 0.03, (2, 6)) * [G, G, G, 0.3, 0.3, 0.3]
    off = start + slope * TIME[:, None] / 12
    path = written(tmp_path / "x.csv", block.inv().apply(load) + off[:, :3], block.inv().apply(rates) + off[:, 3:])
    record = read(path, *ENDS, turn=tuple(block.as_rotvec()))
    np.testing.assert_allclose(record.acceleration.values, load, atol=1e-12)
    assert record.rates is not None
    np.testing.assert_allclose(record.rates.values, rates, atol=1e-14)
    one, other = record.summary.offsets
    assert (one.start, one.end, other.start, other.end) == pytest.approx((0, 1.5, 10.5, 12.0))
    np.testing.assert_allclose([*one.load, *(one.rates or ())], start + slope * 0.75 / 12, atol=1e-14)
    np.testing.assert_allclose([*other.load, *(other.rates or ())], start + slope * 11.25 / 12, atol=1e-14)
    assert record.summary.read.largest == pytest.approx((block.inv().apply(load) + off[:, :3]).max(axis=0))
    assert record.summary.flown.largest == pytest.approx(load.max(axis=0))


def test_one_stretch_finds_a_constant_offset_and_says_it(tmp_path: Path) -> None:
    load, rates = manoeuvre(np.random.default_rng(0))
    off = np.array([0.02 * G, -0.01 * G, 0.03 * G])
    path = written(tmp_path / "x.csv", load + off, rates + np.radians([0.1, -0.2, 0.3]))
    record = read(path, ENDS[0])
    np.testing.assert_allclose(record.acceleration.values, load, atol=1e-12)
    said = (
        "offsets at rest (0 to 1.5 s) are subtracted: x 0.02 g, y -0.01 g, z 0.03 g, "
        "p 0.1 deg/s, q -0.2 deg/s, r 0.3 deg/s"
    )
    assert record.summary.words == said
    flight = Flight(acceleration=record.acceleration)
    assert notes_on({"turn": flight, "again": flight}) == (f"done to the record: {said}",)
    options: Any = {"time": "time", "x": "ax", "y": "ay", "z": "az", "unit": "g"}
    np.testing.assert_array_equal(read_record(path, **options, rest=ENDS[:1]).values, record.acceleration.values)


def test_the_drift_of_several_stretches_lies_on_straight_lines(tmp_path: Path) -> None:
    """Of three, a bend at the middle one: np.interp says what lies between, and the lines go on beyond."""
    knots, values = np.array([1.0, 5.0, 11.0]), np.array([0.01, 0.04, -0.02]) * G
    off = np.interp(TIME, knots, values)
    off[TIME < 1] = values[0] + (TIME[TIME < 1] - 1) * (values[1] - values[0]) / 4
    off[TIME > 11] = values[2] + (TIME[TIME > 11] - 11) * (values[2] - values[1]) / 6
    load = np.tile([0.0, 0.0, G], (len(TIME), 1))
    path = written(tmp_path / "x.csv", load + off[:, None] * [1, 0, 0])
    # Means of a bend are off it by a little: the middle stretch is short.
    rests = Rest(10.5, 11.5), Rest(0.5, 1.5), Rest(4.95, 5.05)
    record = read(path, *rests, rates=None)
    np.testing.assert_allclose(record.acceleration.values, load, atol=3e-3)


@pytest.mark.parametrize("turned", [False, True])
def test_a_rate_table_gives_the_load_that_is_known(tmp_path: Path, turned: bool) -> None:
    """At ω on an arm: ω²r inwards and 1 g upwards, in closed form, and ω about z."""
    spin, arm = np.radians(120.0), 0.5
    block = Rotation.from_rotvec([0.0, 0.0, np.pi / 2] if turned else [0.0, 0.0, 0.0])
    load, rates = np.tile([-(spin**2) * arm, 0.0, G], (len(TIME), 1)), np.tile([0.0, 0.0, spin], (len(TIME), 1))
    off, gyro = np.array([0.05, -0.02, 0.01]) * G, np.radians([0.5, 0.0, -1.0])
    path = written(tmp_path / "x.csv", block.inv().apply(load) + off, block.inv().apply(rates) + gyro)
    known = Rest(2.0, 4.0, (-(spin**2) * arm, 0.0, G), (0.0, 0.0, float(spin)))
    record = read(path, known, turn=tuple(block.as_rotvec()))
    np.testing.assert_allclose(record.acceleration.values, load, atol=1e-12)
    (offset,) = record.summary.offsets
    np.testing.assert_allclose([*offset.load, *(offset.rates or ())], [*off, *gyro], atol=1e-13)


def test_acceleration_is_none_at_rest_and_what_has_no_column_has_no_offset(tmp_path: Path) -> None:
    load, rates = manoeuvre(np.random.default_rng(5))
    path = written(tmp_path / "x.csv", load - [0, 0, G] + [0.3, 0.2, 0.1], rates)
    options: dict[str, Any] = {"rates": None, "quantity": "acceleration", "vehicle": "other"}
    record = read(path, ENDS[0], y="0", **options)
    assert record.summary.offsets[0].load == pytest.approx([0.3, 0.0, 0.1])
    np.testing.assert_allclose(record.acceleration.values, (load - [0, 0, G]) * [1, 0, 1], atol=1e-12)
    assert record.summary.words == "offsets at rest (0 to 1.5 s) are subtracted: x 0.03059 g, z 0.0102 g"
    specific = read(written(path, load, rates), ENDS[0], z="0", rates=None, vehicle="other")
    assert specific.summary.offsets[0].load == pytest.approx([0, 0, 0])


def test_a_level_takes_the_tilt_and_a_rest_what_is_left(tmp_path: Path) -> None:
    """Over the same stretch: of a load at rest its direction is the block's, its size the sensor's."""
    load, rates = manoeuvre(np.random.default_rng(6))
    tilt = Rotation.from_rotvec([0.05, 0.0, 0.0])
    drift = 0.02 * G * (TIME / 12)[:, None] * [1, 0, 0]
    path = written(tmp_path / "x.csv", tilt.inv().apply(1.01 * load) + drift, rates)
    record = read(path, *ENDS, level=(0.0, 1.5), rates=None)
    one, other = record.summary.offsets
    assert np.linalg.norm(one.load) == pytest.approx(0.01 * G, rel=1e-3)
    assert other.load[0] - one.load[0] == pytest.approx(0.02 * G * 10.5 / 12, rel=1e-6)
    at_rest = (TIME < 1.5) | (TIME > 10.5)
    np.testing.assert_allclose(record.acceleration.values[at_rest], load[at_rest], atol=2e-4 * G)


def test_the_stretches_of_a_part_may_be_outside_it(tmp_path: Path) -> None:
    load, rates = manoeuvre(np.random.default_rng(3))
    off = 0.03 * G * (1 + TIME / 12)[:, None]
    path = written(tmp_path / "x.csv", load + off, rates)
    record = read(path, *ENDS, rates=None, span=(3.0, 9.0), conditioning=Conditioning(resample=200.0, cutoff=20.0))
    inside = (record.acceleration.times > 4) & (record.acceleration.times < 8)
    smooth = np.stack([np.interp(record.acceleration.times, TIME, each) for each in load.T], axis=1)
    np.testing.assert_allclose(record.acceleration.values[inside], smooth[inside], atol=0.02)
    assert record.summary.notes == ()


def test_a_drift_that_is_carried_on_far_is_warned_of(tmp_path: Path) -> None:
    load = np.tile([0.0, 0.0, G], (len(TIME), 1))
    path = written(tmp_path / "x.csv", load)
    rests = Rest(0.0, 1.0), Rest(2.0, 3.0)
    (note,) = read(path, *rests, rates=None).summary.notes
    assert note.startswith("the offsets' drift, found within 2 s, is carried on for 9.5 s")
    assert not read(path, *rests, rates=None, span=(0.0, 4.0)).summary.notes


def _moving(load: Floats) -> Floats:
    return load + 0.8 * np.sin(9 * TIME)[:, None]


def _missing(load: Floats) -> Floats:
    holed = load.copy()
    holed[50, 1] = np.nan
    return holed


@pytest.mark.parametrize(
    ("change", "rests", "where", "words"),
    [
        (_moving, ENDS[:1], "rest", "is no stretch at rest: the load spreads by 0.0"),
        (lambda f: f + [0.4, 0, 0] * (TIME > 0.75)[:, None], ENDS[:1], "rest", "drifts by 0.0403 g from 0 to 1.5 s"),
        (lambda f: f + np.array([0, 0, 0.3 * G]), ENDS, "rest[0]", "z = 'az' is 0.3 g off what is known from 0 to"),
        (_missing, ENDS, "rest[0]", "has cells from 0 to 1.5 s that hold no number"),
        (lambda f: f, (Rest(0.0, 1.5), Rest(1.0, 1.8)), "rest", "overlap: 0 to 1.5 s, 1 to 1.8 s"),
        (lambda f: f, (Rest(0.0, 30.0),), "rest[0].to", "is 30 s, and the record lasts 0 to 12 s"),
        (lambda f: f, (ENDS[0], Rest(11.99, 12.0)), "rest[1].to", "leaves 2 row"),
        (lambda f: f, (Rest(3.0, 9.0),), "rest", "is no stretch at rest: the load spreads by "),
        (lambda f: f, (Rest(0.0, 1.5, rates=(0.0, 0.0, 1.0)),), "rest.rates", "the record has no rates"),
    ],
)
def test_what_is_no_rest_is_refused_at_its_place(
    tmp_path: Path, change: Any, rests: tuple[Rest, ...], where: str, words: str
) -> None:
    load, _ = manoeuvre(np.random.default_rng(8))
    path = written(tmp_path / "x.csv", change(load))
    with pytest.raises(InputError) as caught:
        read(path, *rests, rates=None, vehicle="other", span=(2.0, 12.0))
    assert caught.value.where == f"record.{where}" and words in caught.value.problem and caught.value.fix


def test_a_body_that_turns_is_not_at_rest(tmp_path: Path) -> None:
    load, rates = manoeuvre(np.random.default_rng(9))
    path = written(tmp_path / "x.csv", load, rates + np.array([0, 0, 0.1]))
    with pytest.raises(InputError, match=r"the body turns at 5\.73 deg/s from 0 to 1\.5 s"):
        read(path, ENDS[0])
    path = written(path, load, rates + 0.2 * np.sin(20 * TIME)[:, None])
    with pytest.raises(InputError, match="the body turns at "):
        read(path, ENDS[0])


def test_a_known_load_is_of_numbers() -> None:
    with pytest.raises(InputError, match=r"load\[1\] is nan"):
        Rest(0.0, 1.5, (0.0, np.nan, 1.0))


def test_both_fixes_of_an_offset_that_is_too_large_work(tmp_path: Path) -> None:
    load, rates = manoeuvre(np.random.default_rng(10))
    path = written(tmp_path / "x.csv", load + np.array([0, 0, 0.3 * G]), rates)
    with pytest.raises(InputError) as caught:
        read(path, ENDS[0], rates=None)
    assert 'load = ["0 g", "0 g", "1.3 g"]; if sensors are that far off' in caught.value.fix
    trusted = read(path, ENDS[0], rates=None, conditioning=Conditioning(skip_checks=("rest",)))
    np.testing.assert_allclose(trusted.acceleration.values, load, atol=1e-12)
    known = read(path, Rest(0.0, 1.5, (0.0, 0.0, 1.3 * G)), rates=None)
    np.testing.assert_allclose(known.acceleration.values, load + np.array([0, 0, 0.3 * G]), atol=1e-12)
