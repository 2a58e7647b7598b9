"""Instruments whose block sits askew, and elsewhere than the specimen: against rigid bodies in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gbeam import InputError, read_record
from gbeam.arrays import Floats
from gbeam.motion import FlightRecord, Instrument, Rates, read_flight

G = 9.80665
TIME = np.arange(1201) / 100  # s
RATES = Rates("p", "q", "r", "rad/s")


def written(path: Path, load: Floats, rates: Floats | None = None) -> Path:
    """A file of a load (t, 3), m/s², and of rates (t, 3), rad/s, in axes of the instrument."""
    columns = [TIME[:, None], load, *([] if rates is None else [rates])]
    names = "time,ax,ay,az" + ("" if rates is None else ",p,q,r")
    np.savetxt(path, np.concatenate(columns, axis=1), delimiter=",", header=names, comments="", fmt="%.17g")
    return path


def read(path: Path, instrument: Instrument, rates: Rates | None = RATES, **options: Any) -> FlightRecord:
    return read_flight(path, "time", "ax", "ay", "az", "m/s^2", rates=rates, instrument=instrument, **options)


def manoeuvre(rng: np.random.Generator, *, rest: float = 0.0) -> tuple[Floats, Floats, Floats]:
    """Specific force, ω and α (t, 3) of one point of a rigid body, at random; level and at rest until a time."""
    t = np.maximum(TIME - rest, 0.0)[:, None]
    w, alpha, load = np.zeros((3, len(TIME), 3))
    load[:, 2] = G
    for _ in range(3):
        size, frequency = rng.uniform(-0.3, 0.3, 3), rng.uniform(0.2, 0.5)
        # 1 − cos and its derivatives begin at zero.
        w += size * (1 - np.cos(2 * np.pi * frequency * t))
        alpha += size * 2 * np.pi * frequency * np.sin(2 * np.pi * frequency * t)
        load += rng.uniform(-3, 3, 3) * (1 - np.cos(2 * np.pi * frequency * t))
    return load, w, alpha


@pytest.mark.parametrize("seed", range(3))
def test_a_turned_block_gives_loads_and_rates_in_base_axes(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    load, w, *_ = manoeuvre(rng)
    turn = Rotation.from_rotvec(rng.uniform(-0.5, 0.5, 3))
    path = written(tmp_path / "askew.csv", turn.inv().apply(load), turn.inv().apply(w))
    record = read(path, Instrument(tuple(turn.as_rotvec())))
    np.testing.assert_allclose(record.acceleration.values, load, atol=1e-11)
    assert record.rates is not None
    np.testing.assert_allclose(record.rates.values, w, atol=1e-14)
    assert record.summary.flown.peak == pytest.approx(load[np.linalg.norm(load, axis=1).argmax()])
    angle = np.degrees(turn.magnitude())
    assert record.summary.done[0].startswith(f"the block's axes are turned by {angle:.4g} deg about (")


@pytest.mark.parametrize("coarse", [None, (0.0, 0.0, 1.5), (np.pi / 2, 0.0, 0.0)])
def test_a_tilt_is_found_where_all_stands_level(tmp_path: Path, coarse: Any) -> None:
    """The tilt is about a horizontal axis: one about the vertical leaves no trace in the load at rest."""
    rng = np.random.default_rng(7)
    load, w, *_ = manoeuvre(rng, rest=2.5)
    tilt = Rotation.from_rotvec(np.radians(4.0) * np.array([0.6, -0.8, 0.0]))
    block = tilt if coarse is None else tilt * Rotation.from_rotvec(coarse)
    noise = rng.normal(0, 0.01, load.shape)
    path = written(tmp_path / "askew.csv", block.inv().apply(load) + noise, block.inv().apply(w))
    instrument = Instrument((0.0, 0.0, 0.0) if coarse is None else coarse, (0.0, 2.0))
    record = read(path, instrument)
    # 200 samples at rest give the direction to 0.01 m/s² / 14.
    np.testing.assert_allclose(record.acceleration.values - block.apply(noise), load, atol=0.02)
    assert record.rates is not None
    np.testing.assert_allclose(record.rates.values, w, atol=2e-3)
    said = record.summary.done[-1]
    assert said.startswith("levelled by the rest from 0 to 2 s: turned by ") and "about (" in said
    assert float(said.split("by ")[2].split(" deg")[0]) == pytest.approx(4.0, abs=0.02)
    if coarse is None:
        options = {"time": "time", "x": "ax", "y": "ay", "z": "az", "unit": "m/s^2"}
        same = read_record(path, **options, level=(0.0, 2.0))  # type: ignore[arg-type]
        np.testing.assert_array_equal(same.values, record.acceleration.values)


def test_the_level_of_a_part_may_be_before_it(tmp_path: Path) -> None:
    load, w, *_ = manoeuvre(np.random.default_rng(3), rest=2.5)
    tilt = Rotation.from_rotvec([0.0, 0.1, 0.0])
    path = written(tmp_path / "askew.csv", tilt.inv().apply(load), tilt.inv().apply(w))
    record = read(path, Instrument(level=(0.0, 2.0)), span=(4.0, 12.0))
    np.testing.assert_allclose(record.acceleration.values, load[400:], atol=1e-12)


@pytest.mark.parametrize(
    ("change", "level", "words"),
    [
        (lambda f: f, (3.0, 6.0), "is no stretch at rest: the load spreads by "),
        (lambda f: f + [0.4, 0, 0] * (TIME > 1.0)[:, None], (0.0, 2.0), "is no stretch at rest: the load drifts by "),
        (lambda f: 1.1 * f, (0.0, 2.0), "is no stretch at rest: the load is 1.1 g from 0 to 2 s, and at rest 1 g"),
        (lambda f: f[:, [2, 1, 0]], (0.0, 2.0), "turns the block by 90 deg: the load from 0 to 2 s is \\(1, 0, 0\\) g"),
    ],
)
def test_what_is_no_rest_is_no_level(tmp_path: Path, change: Any, level: tuple[float, float], words: str) -> None:
    load, *_ = manoeuvre(np.random.default_rng(3), rest=2.5)
    path = written(tmp_path / "askew.csv", change(load))
    with pytest.raises(InputError, match=words) as caught:
        read(path, Instrument(level=level), None)
    assert caught.value.where == "record.level"


def test_a_level_needs_gravity_and_a_body_that_does_not_turn(tmp_path: Path) -> None:
    load, w, *_ = manoeuvre(np.random.default_rng(3), rest=2.5)
    path = written(tmp_path / "askew.csv", load, w + np.array([0.0, 0.0, 0.05]))
    with pytest.raises(InputError, match=r"the body turns at 2\.86 deg/s from 0 to 2 s"):
        read(path, Instrument(level=(0.0, 2.0)))
    with pytest.raises(InputError, match="holds acceleration, which is none at rest"):
        read(path, Instrument(level=(0.0, 2.0)), quantity="acceleration")


def test_in_a_steady_turn_the_arm_adds_the_centripetal_acceleration(tmp_path: Path) -> None:
    """ω²r towards the axis: 1.5² · 0.4 m/s² from 0.4 m outwards; along the axis nothing."""
    load, w = np.tile([1.0, 0.0, G], (len(TIME), 1)), np.tile([0.0, 0.0, 1.5], (len(TIME), 1))
    record = read(written(tmp_path / "turn.csv", load, w), Instrument(arm=(0.4, 0.0, -0.2)))
    np.testing.assert_allclose(record.acceleration.values, load - [1.5**2 * 0.4, 0, 0], atol=1e-12)
    assert record.summary.done[-1] == "at the root, (400, 0, -200) mm from the instrument: turning adds up to 0.09177 g"


def test_a_pendulum_is_felt_at_its_bob_from_its_pivot(tmp_path: Path) -> None:
    """Swing θ(t) about y; at L below the pivot: Lθ'' across and Lθ'² towards the pivot, besides gravity."""
    length, omega, swing = 0.8, 2.0, 0.5
    angle = swing * np.cos(omega * TIME)
    rate, slope = -swing * omega * np.sin(omega * TIME), -swing * omega**2 * np.cos(omega * TIME)
    zero = np.zeros_like(TIME)
    gravity = G * np.stack([-np.sin(angle), zero, np.cos(angle)], axis=1)  # upwards, in axes of the pendulum
    w = np.stack([zero, rate, zero], axis=1)
    record = read(written(tmp_path / "swing.csv", gravity, w), Instrument(arm=(0.0, 0.0, -length)))
    bob = gravity + np.stack([-length * slope, zero, length * rate**2], axis=1)
    inside = slice(3, -3)  # the kernel that makes α reaches beyond the ends
    np.testing.assert_allclose(record.acceleration.values[inside], bob[inside], atol=2e-3)


@pytest.mark.parametrize("seed", range(3))
def test_any_two_points_of_a_rigid_body_agree(tmp_path: Path, seed: int) -> None:
    """By matrices of ω and α: a + (Ω' + Ω²) r, the second derivative of a place that is fixed in turning axes."""
    rng = np.random.default_rng(seed)
    load, w, alpha = manoeuvre(rng, rest=0.5)
    turn, arm = Rotation.from_rotvec(rng.uniform(-0.4, 0.4, 3)), rng.uniform(-1, 1, 3)
    spin, growth = (np.cross(each[:, None], np.eye(3)).transpose(0, 2, 1) for each in (w, alpha))
    root = load + (growth + spin @ spin) @ arm
    path = written(tmp_path / "body.csv", turn.inv().apply(load), turn.inv().apply(w))
    record = read(path, Instrument(tuple(turn.as_rotvec()), arm=tuple(arm)))
    inside = slice(3, -3)
    np.testing.assert_allclose(record.acceleration.values[inside], root[inside], atol=0.02)
    assert np.abs((growth @ arm)[inside]).max() > 0.5  # α × r is no trifle here
    assert np.abs((spin @ spin @ arm)[inside]).max() > 0.1


def test_an_arm_needs_the_rates(tmp_path: Path) -> None:
    load, *_ = manoeuvre(np.random.default_rng(3))
    path = written(tmp_path / "body.csv", load)
    with pytest.raises(InputError, match="rates") as caught:
        read(path, Instrument(arm=(0.1, 0.0, 0.0)), None)
    assert caught.value.where == "record.arm" and "rate_unit" in caught.value.fix
