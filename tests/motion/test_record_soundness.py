"""Records judged by physics: true flights pass in every unit, wrong units, signs, times and spikes are refused."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.constants import g as STANDARD_GRAVITY

import gbeam as gb
from gbeam.motion import Conditioning, FlightRecord, read_flight

DATA = Path(__file__).parents[2] / "examples" / "data"
STEP = 0.02
UNITS = {"g": 1.0, "m/s^2": STANDARD_GRAVITY, "ft/s^2": STANDARD_GRAVITY / 0.3048}
Floats = NDArray[np.float64]


def along(*corners: tuple[float, float], x: float = 0.0, y: float = 0.0) -> Floats:
    """A load through corners (s, g) in z, with some turbulence."""
    time = np.arange(0, corners[-1][0], STEP)
    noise = 0.01 * np.random.default_rng(1).normal(size=(len(time), 3))
    return np.stack([0 * time + x, 0 * time + y, np.interp(time, *np.transpose(corners))], axis=1) + noise


def recorded(name: str) -> Floats:
    table = np.genfromtxt(DATA / name, delimiter=",", names=True)[::2]
    return np.stack([table["n_x_g"], -table["n_y_g"], -table["n_z_g"]], axis=1)


# Specific force, g, in base axes, every 0.02 s.
FLIGHTS: dict[str, Floats] = {
    "F-16, 8 g turn": recorded("f16_8g_turn.csv"),
    "F-16, pulls and push": recorded("f16_pulls_and_push.csv"),
    "10 g pull, then 3.55 g": along((0, 1), (3, 1), (4.3, 10), (6, 10), (8, 1), (10, 3.55), (12, 1), (15, 1)),
    "6 g turn": along((0, 1), (2, 1), (4, 6), (12, 6), (14, 1), (16, 1), x=0.3),
    "level cruise": along((0, 1), (20, 1)),
    "9 g from the third to the last second": along((0, 1.2), (1, 1.2), (3, 9), (20, 9), (21, 2)),
    "rocket from its pad to 6 g": along((0, 1), (2, 1), (2.1, 1.4), (40, 6), (40.2, 0), (60, 0))[:, [2, 1, 0]],
    "rocket ascent, 0 to 6 g": along((0, 0), (20, 6))[:, [2, 1, 0]],
    "parabolic flight": along((0, 1), (5, 1), (8, 1.8), (25, 1.8), (28, 0), (50, 0), (53, 1.8), (70, 1.8), (75, 1)),
    "push to -2.2 g": along((0, 1), (5, 1), (7, -2.2), (9, 1), (12, 1)),
    "inverted for a while": along((0, 1), (10, 1), (11, -1), (15, -1), (16, 1), (20, 1)),
    "helicopter in turbulence": along((0, 1), (30, 1)) + 0.15 * np.sin(np.arange(1500)[:, None] * [1.0, 1.3, 0.7]),
}


def write(folder: Path, load: Floats, unit: str = "g", step: float = STEP) -> Path:
    path = folder / "record.csv"
    rows = np.column_stack([step * np.arange(len(load)), UNITS[unit] * load])
    np.savetxt(path, rows, delimiter=",", header="t,x,y,z", comments="", fmt="%.8g")
    return path


def fly(path: Path, unit: str, z: str = "z", **options: object) -> FlightRecord:
    return read_flight(path, "t", "x", "y", z, unit, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("name", FLIGHTS)
def test_true_flights_pass_in_every_unit(tmp_path: Path, name: str, unit: str) -> None:
    record = fly(write(tmp_path, FLIGHTS[name], unit), unit)
    np.testing.assert_allclose(record.acceleration.values, STANDARD_GRAVITY * FLIGHTS[name], rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize(("unit", "declared"), [*permutations(UNITS, 2)])
@pytest.mark.parametrize("name", FLIGHTS)
def test_the_wrong_unit_is_refused(tmp_path: Path, name: str, unit: str, declared: str) -> None:
    if name == "rocket ascent, 0 to 6 g" and unit == "m/s^2" and declared == "g":
        return  # 0 to 59 g looks like a rocket's too
    if "rocket" in name and {unit, declared} == {"m/s^2", "ft/s^2"}:
        return  # as a third of a rocket's load, or three times as much, does
    path = write(tmp_path, FLIGHTS[name], unit)
    with pytest.raises(gb.InputError) as caught:
        fly(path, declared)
    assert caught.value.where == "record.unit"
    assert f'unit = "{unit}"' in caught.value.fix and 'skip_checks = ["unit"]' in caught.value.fix
    kept = fly(path, declared, conditioning=Conditioning(skip_checks=("unit",)))
    wrong = UNITS[unit] * FLIGHTS[name] * STANDARD_GRAVITY / UNITS[declared]
    np.testing.assert_allclose(kept.acceleration.values, wrong, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", [name for name in FLIGHTS if "rocket" not in name and "last" not in name])
def test_level_flight_downwards_is_the_wrong_sign(tmp_path: Path, name: str) -> None:
    path = write(tmp_path, FLIGHTS[name])
    with pytest.raises(gb.InputError, match=r'record.z is -.* of level flight, .* write z = "z".*\["sign"\]'):
        fly(path, "g", z="-z")
    fly(path, "g", z="-z", conditioning=Conditioning(skip_checks=("sign",)))


# On its pad, a boost along z, a fall, and a descent under a parachute, tail first.
BOOSTED = along((0, 1), (2, 1), (2.1, 6), (5, 6), (5.1, 0), (12, 0), (13, -1), (40, -1))


@pytest.mark.parametrize(
    ("load", "advised"),
    [
        (BOOSTED, False),
        (BOOSTED[103:], False),  # from its pad to 3 g is left out
        (along((0, 1), (2, 1), (2.1, 2.5), (5, 2.5), (5.1, 0), (12, 0), (13, -1), (40, -1)), False),
        (-BOOSTED[:600], True),
        (-FLIGHTS["6 g turn"], True),
    ],
)
def test_no_advice_turns_a_boost_upside_down(tmp_path: Path, load: Floats, advised: bool) -> None:
    """A record that begins upright, or is pushed upwards by more than downwards, is not told to turn z over, but to say
    what it is of; the next call takes that.
    """
    path = write(tmp_path, load)
    with pytest.raises(gb.InputError, match=r"record.(z|unit) is ") as caught:
        fly(path, "g")
    assert ('z = "-z"' in caught.value.fix) is advised
    for vehicle in ("rocket", "other"):
        assert f'add vehicle = "{vehicle}"' in caught.value.fix
        kept = fly(path, "g", vehicle=vehicle)
        np.testing.assert_allclose(kept.acceleration.values, STANDARD_GRAVITY * load, rtol=1e-6, atol=1e-7)
        assert kept.summary.level is None and kept.summary.vehicle == vehicle


def test_z_is_turned_over_with_y(tmp_path: Path) -> None:
    """A half turn about x keeps axes right-handed: aircraft axes as they are want both signs."""
    load = FLIGHTS["6 g turn"] * [1, -1, -1]
    np.savetxt(path := tmp_path / "r.csv", np.column_stack([STEP * np.arange(len(load)), load]), delimiter=",",
               header="t,ax,ay,az", comments="")  # fmt: skip
    with pytest.raises(gb.InputError, match=r'record.z is .*write y = "-ay", z = "-az"; '):
        read_flight(path, "t", "ax", "ay", "az", "g")
    assert read_flight(path, "t", "ax", "-ay", "-az", "g").summary.notes == ()


def test_of_another_vehicle_nothing_is_asked_but_its_size(tmp_path: Path) -> None:
    """A machine's axis, at 3200 Hz for a second, and a sledge in fractions of g; never 500 g."""
    quick = write(tmp_path, FLIGHTS["level cruise"] * 0.05, step=1 / 3200)
    with pytest.raises(gb.InputError, match=r'record.time lasts 0.312 s .*add vehicle = "other"'):
        fly(quick, "g")
    assert fly(quick, "g", vehicle="other").summary.read.samples == 1000
    slow = write(tmp_path, FLIGHTS["level cruise"] * 0.05, "m/s^2")
    with pytest.raises(gb.InputError, match=r'record.unit is m/s\^2, .* add vehicle = "other"'):
        fly(slow, "m/s^2")
    fly(slow, "m/s^2", vehicle="other")
    with pytest.raises(gb.InputError, match=r"record.unit is g, which makes 5.. g of"):
        fly(write(tmp_path, FLIGHTS["level cruise"] * 500), "g", vehicle="other")


def test_a_rocket_may_begin_in_its_boost(tmp_path: Path) -> None:
    load = along((0, 5), (4, 9), (4.1, 0), (20, 0))
    with pytest.raises(gb.InputError, match=r"begins at 5.*g"):
        fly(write(tmp_path, load), "g")
    fly(write(tmp_path, load), "g", vehicle="rocket")
    with pytest.raises(gb.InputError, match=r'if it is in m/s\^2, write unit = "m/s\^2"'):
        fly(write(tmp_path, BOOSTED, "m/s^2"), "g", vehicle="rocket")


def test_a_vehicle_is_advised_only_if_it_is_taken(tmp_path: Path) -> None:
    """In too small a unit it is no rocket's either."""
    path = write(tmp_path, FLIGHTS["6 g turn"])
    with pytest.raises(gb.InputError, match=r"record.unit is in/s\^2") as caught:
        fly(path, "in/s^2")
    assert 'rocket"' not in caught.value.fix and 'add vehicle = "other"' in caught.value.fix
    fly(path, "in/s^2", vehicle="other")


def test_the_unit_of_time_is_judged_before_its_jitter(tmp_path: Path) -> None:
    """Of ns read as s, with a sample late, a new rate of 1e-7 Hz would be no fix."""
    load = FLIGHTS["6 g turn"]
    stamps = np.round(1e9 * STEP * np.arange(len(load)))
    stamps[40] += 4e6
    rows = np.column_stack([stamps, load])
    np.savetxt(path := tmp_path / "r.csv", rows, delimiter=",", header="t,x,y,z", comments="", fmt="%.12g")
    with pytest.raises(gb.InputError, match=r'record.time has a sample every .* write time_unit = "ns"'):
        fly(path, "g")


def test_level_is_level_for_a_second(tmp_path: Path) -> None:
    """A ramp through 1 g is level nowhere; the stretch that is said is the longest."""
    assert fly(write(tmp_path, along((0, 2), (2, 2), (3, 0.2), (4, 2), (20, 3))), "g").summary.level is None
    level = fly(write(tmp_path, along((0, 2), (2, 2), (3, 1), (4.5, 1), (5, 2), (20, 3))), "g").summary.level
    assert level is not None and 1.5 < level.end - level.start < 2.4 and level.start > 2.5


def test_a_beam_that_points_up_or_hangs_has_no_sign_to_check(tmp_path: Path) -> None:
    load = FLIGHTS["6 g turn"][:, [2, 1, 0]]
    fly(write(tmp_path, load), "g")
    fly(write(tmp_path, -load), "g")


def test_acceleration_has_no_level_flight(tmp_path: Path) -> None:
    turn = FLIGHTS["6 g turn"] - [0.3, 0, 1]
    for unit in UNITS:
        path = write(tmp_path, 0.1 * turn, unit)
        fly(path, unit, quantity="acceleration")
    with pytest.raises(gb.InputError, match='quantity = "acceleration"'):
        fly(path, "ft/s^2")


@pytest.mark.parametrize(
    ("declared", "true", "words"),
    [("s", 1e-3, "is the time in ms?"), ("s", 60.0, "is the time in min?"), ("ms", 1.0, "is the time in s?")],
)
def test_an_implausible_interval_asks_for_the_unit_of_time(
    tmp_path: Path, declared: str, true: float, words: str
) -> None:
    path = write(tmp_path, FLIGHTS["6 g turn"], step=STEP / true)
    with pytest.raises(gb.InputError, match=r"record\.time .*sampling") as caught:
        fly(path, "g", time_unit=declared)
    assert words in caught.value.fix
    unit = words.split()[-1].rstrip("?")
    assert fly(path, "g", time_unit=unit).acceleration.times[-1] == pytest.approx(16 - STEP)
    if declared == "s":
        fly(path, "g", conditioning=Conditioning(skip_checks=("sampling", "spikes")))


SPOILT: dict[str, Callable[[Floats], None]] = {
    "too large for any unit": lambda z: z.__setitem__(400, 500.0),
    "largest by far": lambda z: z.__setitem__(400, 20.0),
    "two": lambda z: z.__setitem__([100, 400], [-30.0, 900.0]),
    "in the first second, of the wrong sign": lambda z: z.__setitem__(slice(3, 4), -60.0),
}


@pytest.mark.parametrize("name", SPOILT)
def test_a_spike_is_offered_despike_before_anything_else(tmp_path: Path, name: str) -> None:
    load = FLIGHTS["6 g turn"].copy()
    SPOILT[name](load[:, 2])
    path = write(tmp_path, load)
    with pytest.raises(
        gb.InputError, match=r"record.z column 'z' has . sample\(s\) that look like spikes: .*despike = t"
    ):
        fly(path, "g", z="-z")  # a wrong sign besides
    mended = fly(path, "g", conditioning=Conditioning(despike=True))
    assert np.abs(mended.acceleration.values / STANDARD_GRAVITY - FLIGHTS["6 g turn"]).max() < 0.1
    kept = fly(path, "g", conditioning=Conditioning(skip_checks=("spikes", "unit")))
    np.testing.assert_allclose(kept.acceleration.values, STANDARD_GRAVITY * load, rtol=1e-6, atol=1e-7)


def test_the_unit_is_judged_without_small_spikes(tmp_path: Path) -> None:
    load = FLIGHTS["level cruise"].copy()
    load[500, 2] = 1.3
    assert "despike = true" in fly(write(tmp_path, load), "g").summary.notes[0]
    with pytest.raises(gb.InputError, match=r"record\.unit"):
        fly(write(tmp_path, load), "m/s^2")


def test_a_check_that_does_not_exist_cannot_be_skipped(tmp_path: Path) -> None:
    with pytest.raises(gb.InputError, match=r"record.skip_checks names no check 'units'; did you mean 'unit'"):
        fly(write(tmp_path, FLIGHTS["6 g turn"]), "g", conditioning=Conditioning(skip_checks=("units",)))
