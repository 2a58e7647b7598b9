"""Conditioning of a record, and refusals: each refusal tested on the F-16 record, spoilt in one way."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from gbeam import Flight, InputError
from gbeam.motion import Conditioning, FlightRecord, Rates, body_rates, dropout, flat_tops, read_flight, spikes

F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
NAMES = ("time_s", "n_x_g", "-n_y_g", "-n_z_g")
Rows = list[list[str]]


def spoilt(tmp_path: Path, change: Callable[[Rows], Rows]) -> Path:
    with F16.open(newline="") as file:
        rows = list(csv.reader(file))
    path = tmp_path / "spoilt.csv"
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([rows[0], *change(rows[1:])])
    return path


def fly(path: Path, unit: str = "g", rates: Rates | None = None, **conditioning: object) -> FlightRecord:
    return read_flight(path, *NAMES, unit, rates=rates, conditioning=Conditioning(**conditioning))  # type: ignore[arg-type]


def column(rows: Rows, index: int, at: slice, value: str | Callable[[str], str]) -> Rows:
    for row in rows[at]:
        row[index] = value if isinstance(value, str) else value(row[index])
    return rows


def stuck(rows: Rows) -> Rows:
    return column(rows, 3, slice(400, 460), rows[400][3])


REFUSED: dict[str, tuple[Callable[[Rows], Rows], str, list[str]]] = {
    "m/s^2 declared as g": (
        lambda rows: column(rows, 3, slice(None), lambda cell: str(9.80665 * float(cell))),
        "record.unit",
        ["m/s^2", "g of row"],
    ),
    "1 Hz": (lambda rows: rows[::100], "record.time", ["1 Hz", "20 Hz"]),
    "too short": (lambda rows: rows[:5], "record.file", ["5 row(s)", "6 samples"]),
    "zeros": (
        lambda rows: column(rows, 3, slice(700, 720), "0"),
        "record.z",
        ["n_z_g", "7 s to 7.19 s", "rows 702 to 721"],
    ),
    "stuck": (stuck, "record.z", ["n_z_g", "stands still", "from 4 s to 4.59 s"]),
    "dead to the end": (lambda rows: column(rows, 3, slice(900, None), rows[900][3]), "record.z", ["stands still"]),
    "NaN": (lambda rows: column(rows, 3, slice(700, 701), "nan"), "record.z", ["row 702", "nan"]),
    "not monotonic": (lambda rows: rows[:500] + rows[400:], "record.time", ["goes back", "row 502"]),
}


@pytest.mark.parametrize("name", REFUSED)
def test_unsound_records_are_refused_with_place_and_fix(tmp_path: Path, name: str) -> None:
    change, where, words = REFUSED[name]
    with pytest.raises(InputError) as caught:
        fly(spoilt(tmp_path, change))
    assert caught.value.where == where
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(("level", "declared", "right"), [(9.80665, "g", "m/s^2"), (6.0, "g", ""), (1.0, "m/s^2", "g")])
def test_a_start_far_from_level_flight_is_the_wrong_unit(
    tmp_path: Path, level: float, declared: str, right: str
) -> None:
    calm = spoilt(
        tmp_path,
        lambda rows: [[row[0], "0", "0", f"{-level - 1e-5 * i % 0.001:.5f}", *row[4:]] for i, row in enumerate(rows)],
    )
    # By their names these columns are in g.
    calm.write_text(calm.read_text().replace("_g,", ","))
    names = ("time_s", "n_x", "-n_y", "-n_z")
    with pytest.raises(InputError, match=r"record.unit is .* begins at ") as caught:
        read_flight(calm, *names, declared)
    assert (f'if it is in {right}, write unit = "{right}"' in caught.value.fix) is bool(right)
    trusted = Conditioning(skip_checks=True)
    assert read_flight(calm, *names, declared, conditioning=trusted).acceleration.times.size == 1600
    if right:
        assert read_flight(calm, *names, right).acceleration.times.size == 1600


def test_plateaus_are_no_dropouts() -> None:
    ramp = np.concatenate(
        [np.zeros(50), np.linspace(0, 60, 101), np.full(200, 60.0), np.linspace(60, 0, 101), np.zeros(50)]
    )
    assert dropout(ramp, 0.01) is None
    assert dropout(ramp[50:], 0.01) is None
    ramp[200:210] = 0
    assert dropout(ramp, 0.01) == (200, 209)


def test_spikes_go_only_when_asked(tmp_path: Path) -> None:
    path = spoilt(tmp_path, lambda rows: column(rows, 3, slice(800, 801), "-11"))
    kept, mended = fly(path), fly(path, despike=True)
    assert float(kept.acceleration.values[800, 2]) == pytest.approx(11 * 9.80665)
    assert (
        "row 802" in kept.summary.notes[0]
        and "despike = true replaces them: z is -0.4157 g to 11 g, then" in kept.summary.notes[0]
    )
    clean = fly(F16).acceleration.values
    assert float(jnp.abs(mended.acceleration.values - clean).max()) < 0.05
    assert "were replaced" in mended.summary.done[0]


def test_cutoff_and_resampling() -> None:
    plain, slow = fly(F16), fly(F16, cutoff=5.0, resample=200.0)
    assert slow.acceleration.times.size == 3199
    assert slow.summary.done == ("low-pass at 5 Hz, zero phase", "resampled at 200 Hz")
    inside = slow.acceleration(plain.acceleration.times[200:-200]) - plain.acceleration.values[200:-200]
    assert float(jnp.sqrt(jnp.mean(inside**2))) < 0.5
    with pytest.raises(InputError, match=r"record.resample is 20 Hz, below the record's 100 Hz, with no cut-off"):
        fly(F16, resample=20.0)
    for cutoff in (60.0, 0.06, 1e-9):  # the record has 100 Hz and 15.99 s
        with pytest.raises(
            InputError, match=r"record\.cutoff is .* over 15.99 s; give 0.0625391 Hz or more, below 50 Hz"
        ):
            fly(F16, cutoff=cutoff)
    assert fly(F16, cutoff=0.0625391).summary.done == ("low-pass at 0.0625391 Hz, zero phase",)
    assert fly(F16, resample=20.0, cutoff=5.0).acceleration.times.size == 320
    with pytest.raises(InputError, match=r"resample is 0.3 Hz, which leaves fewer than 6 samples of 15.99 s"):
        fly(F16, resample=0.3, cutoff=0.1)


def test_body_rates_turn_the_base() -> None:
    """x forward, y right, z down of the aircraft are x forward, y left, z up of the beam: q and r change sign."""
    record = fly(F16, rates=Rates("p_rad_s", "-q_rad_s", "-r_rad_s", "rad/s"))
    assert record.rates is not None
    flight = Flight(acceleration=record.acceleration, rates=body_rates(record.rates))
    t = np.linspace(1.2, 15.0, 200)
    base, h = flight.base(t), 1e-4
    np.testing.assert_allclose(base.w_WB_B, record.rates(t), atol=0.05)
    slope = (flight.base(t + h).w_WB_B - flight.base(t - h).w_WB_B) / (2 * h)
    np.testing.assert_allclose(base.alpha_WB_B, slope, atol=1e-4)
    # A pull-up turns the nose up: about −y of a y axis that points left, while the load is upwards.
    pull = np.argmax(base.a_WO_B[:, 2])
    assert base.w_WB_B[pull, 1] < 0 < base.a_WO_B[pull, 2]
    with pytest.raises(InputError, match=r"record.rate_unit is deg/s, and the file gives column 'p_rad_s' in rad/s"):
        fly(F16, rates=Rates("p_rad_s", "-q_rad_s", "0", "deg/s"))
    degrees = fly(F16, rates=Rates("p_rad_s", "-q_rad_s", "0", "deg/s"), skip_checks=("unit",))
    assert degrees.rates is not None
    np.testing.assert_allclose(degrees.rates.values[:, 1], record.rates.values[:, 1] * np.pi / 180)
    np.testing.assert_array_equal(degrees.rates.values[:, 2], 0)


@pytest.mark.parametrize("length", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("record", ["f16_8g_turn.csv", "f16_pulls_and_push.csv"])
def test_a_run_of_samples_off_is_found_whole_on_a_flank_and_at_a_peak(record: str, length: int) -> None:
    """All of it and nothing else, of 0.5 to 2 g: on a flank the samples around it are as far from their median."""
    table = np.genfromtxt(F16.parent / record, delimiter=",", names=True)
    load = 9.80665 * np.stack([table[name] for name in ("n_x_g", "n_y_g", "n_z_g")], axis=1)
    assert not spikes(load).any()
    for i in np.flatnonzero(load[:, 2] < -5 * 9.80665)[::40]:
        for size in (0.5, 1.0, 2.0):
            around = load[i - 300 : i + 300].copy()
            around[300 : 300 + length, 2] -= size * 9.80665
            assert np.argwhere(spikes(around)).tolist() == [[300 + k, 2] for k in range(length)]


@pytest.mark.parametrize(
    "off",
    [
        {0: 13.0, 1: 14.0, 2: 13.0},  # of three, two were replaced
        {0: 5.0, 1: 40.0, 2: 38.0, 3: 6.0},
        {0: 12.0, 2: 12.0},
        {0: 12.0, 1: -9.0},
        {0: 12.0, 1: 12.0, 4: 12.0, 5: 12.0},
        {-199: 12.0},  # the second sample
    ],
)
def test_runs_beside_one_another_and_of_any_shape(off: dict[int, float]) -> None:
    """In waves with noise, ten times each: exactly those samples are spikes, and nothing is where there are none."""
    random = np.random.default_rng(2)
    for _ in range(10):
        z = 9.80665 * (1 + 0.3 * np.sin(np.arange(400) / 15) + random.normal(0, 0.1 * random.random(), 400))
        load = np.stack([0 * z, 0 * z, z], axis=1)
        assert not spikes(load).any()
        for k, size in off.items():
            load[200 + k, 2] += 9.80665 * size
        assert np.argwhere(spikes(load)).tolist() == [[200 + k, 2] for k in off]


def test_three_bad_samples_are_replaced_and_the_ranges_said(tmp_path: Path) -> None:
    """Of 13 g in three samples nothing is left; rates of the body are mended too."""
    path = spoilt(
        tmp_path,
        lambda rows: column(column(rows, 3, slice(800, 803), "-13"), 5, slice(300, 302), "-2.5"),
    )
    rates = Rates("p_rad_s", "-q_rad_s", "-r_rad_s", "rad/s")
    with pytest.raises(
        InputError, match=r"column 'n_z_g' has 3 sample\(s\) that look like spikes: the load is 13.03 g"
    ):
        fly(path)
    mended, whole = fly(path, rates=rates, despike=True), fly(F16, rates=rates)
    assert np.abs(mended.acceleration.values - whole.acceleration.values).max() < 0.05
    assert mended.rates is not None and whole.rates is not None
    assert np.abs(mended.rates.values - whole.rates.values).max() < 0.02
    (note,) = mended.summary.done
    assert note == (
        "5 sample(s) that look like spikes, in 2 run(s), the first at 3 s (row 302), were replaced: "
        "z was -0.4157 g to 13 g, is -0.4157 g to 8.059 g; "
        "q was -18.86 deg/s to 143.2 deg/s, is -18.86 deg/s to 2.37 deg/s"
    )


def test_noise_is_no_spike() -> None:
    """Of seven samples of noise one was found far off in a hundred."""
    noise = np.random.default_rng(0).normal(0, 0.98, (50_000, 3))
    assert spikes(noise).sum() <= 2
    assert spikes(noise.cumsum(axis=0) / 10).sum() <= 2


def test_a_sensor_at_the_end_of_its_range_is_named(tmp_path: Path) -> None:
    def clipped(rows: Rows) -> Rows:
        return column(rows, 3, slice(None), lambda cell: f"{max(float(cell), -7.98):g}")

    (note,) = fly(spoilt(tmp_path, clipped)).summary.notes
    assert note == (
        "z, column 'n_z_g', stands at its extreme, 7.98 g, from 4.43 to 6.59 s (rows 445 to 661): "
        "its sensor seems to be at the end of its range, and what is beyond is lost"
    )
    assert fly(F16).summary.notes == ()


def test_flat_tops_are_those_of_curves_that_are_cut_off() -> None:
    t = np.arange(0, 10, 0.01)
    wave = 60 * np.sin(2 * np.pi * 0.3 * t)
    assert list(flat_tops(wave)) == []
    (top,) = flat_tops(np.minimum(wave, 50.0))
    assert top[0] == 50.0 and [round(t[run.start], 2) for run in top[1]] == [0.53, 3.86, 7.19]
    assert [value for value, _ in flat_tops(np.clip(wave, -50.0, 50.0))] == [50.0, -50.0]
    # A coarse sensor, level flight before the first manoeuvre, a channel that is zero for a while, and a dead one.
    assert list(flat_tops(np.round(wave))) == []
    assert list(flat_tops(np.where(t < 1, 9.80665, 9.80665 + np.abs(wave)))) == []
    assert list(flat_tops(np.where((t > 2) & (t < 4), 0.0, np.abs(wave)))) == []
    assert list(flat_tops(np.full(100, 60.0))) == []
