"""A flight made of known pieces: the accounting finds exactly those, and why the machine does not make some."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import find_peaks

from gbeam import Comparison, InputError, Response, compare
from gbeam.analysis import History, account
from gbeam.arrays import each_leaf
from gbeam.report import accounting_lines as lines
from gbeam.report import judged_lines
from gbeam.results import AxesResult, Base, LimitUse, facts_of

from .helpers import LENGTH, of_tip, with_body

DATA = Path(__file__).parents[2] / "examples" / "data"
G = 9.80665
STEP = 0.004
IDLE = 1.4
# Duration, s; flight's and machine's load, g; why it is not followed. The largest is 10 g, and 5 % of it 0.5 g.
PIECES = (
    (2.0, 0.5, 1.4, "below idle"),
    (1.0, 4.0, 4.1, ""),
    (1.0, 0.5, 1.4, "below idle"),
    (1.0, 10.0, 8.0, "axis 1 acceleration"),
    (1.0, 1.2, 1.4, ""),
    (0.5, 3.55, 1.4, "left out"),
    (1.5, 0.5, 3.16, "below idle"),
    (1.0, 5.0, 5.0, "gimbals"),
    (1.0, 1.3, 1.4, ""),
    (1.0, 6.0, 7.0, "corner"),
)
ENDS = np.cumsum([piece[0] for piece in PIECES])
TIME = STEP * (np.arange(round(ENDS[-1] / STEP)) + 0.5)
WHICH = np.searchsorted(ENDS, TIME)
ZERO = np.zeros((len(TIME), 3))


def along_z(sizes: np.ndarray) -> np.ndarray:
    return G * sizes[:, None] * [0.0, 0.0, 1.0]


def alike(load: np.ndarray) -> History:
    """One load all over a specimen."""
    return History(load, load, np.zeros((*load.shape, 3)), np.array([[0.3, 0.0, 0.0]]))


def flight_of(load: np.ndarray) -> Response:
    """A flight whose tip and root moment go with the load."""
    return replace(of_tip("flight", TIME, 1e-4 * load), base=Base(load, ZERO, ZERO))


@pytest.fixture(scope="module")
def pair() -> tuple[Response, Response]:
    flown, spun = (np.array([piece[k] for piece in PIECES])[WHICH] for k in (1, 2))
    load, actual = along_z(flown), along_z(spun)
    skew = WHICH == 7  # of the right size, and a third of a right angle off
    actual[skew] = 5 * G * np.array([0.0, np.sin(np.pi / 6), np.cos(np.pi / 6)])
    target = np.where((WHICH == 5)[:, None], along_z(np.full(len(TIME), IDLE)), load)
    acceleration = np.where(WHICH == 3, 20.0, 5.0)[:, None] * [1.0, 0.0, 0.0]
    limits = (LimitUse("axis 1", "acceleration", "rad/s^2", 20.0, 20.0, 5.0),)
    episodes = ((4.0, 7.0, "below idle"), (8.0, 9.0, "gimbals"), (5.9, 7.1, "below idle"))
    axes = AxesResult(
        ZERO, ZERO, acceleration, target, actual, np.isin(WHICH, (5, 7)), episodes, limits, control_point=0.0,
        idle=IDLE * G,
    )  # fmt: skip
    spin = replace(of_tip("arm", TIME, 1e-4 * actual), base=Base(actual, ZERO, ZERO), axes=axes)
    return flight_of(load), spin


@pytest.fixture(scope="module")
def compared(pair: tuple[Response, Response]) -> Comparison:
    return compare(*pair)


def test_every_peak_above_idle(compared: Comparison) -> None:
    high = [k for k, piece in enumerate(PIECES) if piece[1] > IDLE]
    peaks = compared.accounting.peaks
    assert [peak.time for peak in peaks] == pytest.approx([ENDS[k - 1] + STEP / 2 for k in high])
    assert [peak.load / G for peak in peaks] == pytest.approx([PIECES[k][1] for k in high])
    assert [peak.reproduced / G for peak in peaks] == pytest.approx([PIECES[k][2] for k in high])
    assert [peak.reason for peak in peaks] == [PIECES[k][3] for k in high]
    # The same size in another direction: the chord of 30°.
    errors = [abs(PIECES[k][2] / PIECES[k][1] - 1) if k != 7 else 2 * np.sin(np.pi / 12) for k in high]
    assert [peak.error for peak in peaks] == pytest.approx(errors)


def test_stretches_and_share(compared: Comparison) -> None:
    accounting, start = compared.accounting, np.append(0.0, ENDS)
    missed = [k for k, piece in enumerate(PIECES) if piece[3]]
    answer = [(each.reason, each.flight_peak / G) for each in accounting.not_followed]
    assert answer == [(PIECES[k][3], pytest.approx(PIECES[k][1])) for k in missed]
    edges = [(each.start, each.end) for each in accounting.not_followed]
    expected = np.clip([(start[k], ENDS[k]) for k in missed], *accounting.span)
    np.testing.assert_allclose(edges, expected, atol=1e-12)
    lost = sum(end - begin for begin, end in expected)
    assert accounting.followed_share == pytest.approx(1 - lost / (TIME[-1] - TIME[0]))
    assert sum(accounting.shares.values()) == pytest.approx(1 - accounting.followed_share)


def test_overload_is_what_exceeds_flight_and_idle(compared: Comparison) -> None:
    first, second = compared.accounting.overloads
    assert (first.load / G, first.flight / G) == pytest.approx((3.16, 0.5))
    assert (first.start, first.end) == pytest.approx((6.5, 8.0))
    assert second.load / G == pytest.approx(7.0)


def test_verdict_says_that_the_largest_peak_is_missed(compared: Comparison) -> None:
    assert compared.verdict.startswith("No limits set: largest load 8 g (flight 10 g), followed 27 %")
    assert compared.verdict.endswith("; largest peak missed")
    assert list(compared.findings[:2]) == [
        "Largest load: 8 g at 4.00 s, 20 % below the flight's 10 g (no limit set).",
        "Peaks: 1 of 5 above 1.4 g (idle) reproduced; the largest, 10 g at 4.00 s, is 20 % off (tolerance 5 %; "
        "used up: axis 1 acceleration).",
    ]
    assert "missed" not in compare(*reproduced()).verdict
    text = "\n".join(lines(compared.accounting))
    assert "the machine loads the specimen more than the flight: 3.16 g at 6.50 s (flight 0.5 g, idle 1.4 g)" in text
    assert "load peak 3.55 g at 6.00 s: not reproduced, 1.4 g (-61 %), 61 % off at the same instant: left out" in text
    skew = "not reproduced, 5 g (under 0.1 %, as a vector 52 %), 52 % off at the same instant: gimbals"
    assert f"load peak 5 g at 8.00 s: {skew}" in text
    assert "not followed 8.000 to 9.000 s: gimbals, flight's load up to 5 g" in text


def reproduced() -> tuple[Response, Response]:
    """A flight of 10 g between two times of 1 g, on a machine that idles at 1.4 g and makes 9.9 g."""
    high = (TIME > 4.0) & (TIME < 6.0)
    load, actual = (along_z(np.where(high, *each)) for each in ((10.0, 0.5), (9.9, 1.4)))
    axes = AxesResult(ZERO, ZERO, ZERO, actual, actual, ~high, ((0.0, 4.0, "below idle"),), idle=IDLE * G)
    arm = replace(of_tip("arm", TIME, 1e-4 * actual), base=Base(actual, ZERO, ZERO), axes=axes)
    return flight_of(load), arm


def test_verdict_of_what_is_reproduced() -> None:
    compared = compare(*reproduced())
    assert compared.verdict == "No limits set: largest load 9.9 g (flight 10 g), followed 18 % of the time"
    assert list(compared.findings) == [
        "Largest load: 9.9 g at 4.00 s, 1.0 % below the flight's 10 g (no limit set).",
        "Peaks: 1 of 1 above 1.4 g (idle) reproduced; 10 g at 4.00 s is 1 % off (tolerance 5 %).",
        "Followed: 18 % of the time (no limit set); 82 % below idle.",
        "Tip: 9.709 mm at 4.00 s, 1.0 % below the flight's 9.807 mm (no limit set).",
        "Machine: it cannot go below idle, 1.4 g, longest from 6.00 to 11.00 s.",
    ]
    assert compared.accepted is None
    strict = compare(*reproduced(), accept={"tip": 0.005})
    assert strict.verdict == "NOT ACCEPTED: tip -1.0 % (limit 0.5 %); largest load 9.9 g" and strict.accepted is False
    assert "Tip: 9.709 mm at 4.00 s, 1.0 % below the flight's 9.807 mm (limit 0.5 %, missed)." in strict.findings


def test_accepted_by_each_limit(pair: tuple[Response, Response]) -> None:
    one = {"tip": 0.011, "peaks": 0.011, "spread": 1e-9, "followed": 0.18}
    good = compare(*reproduced(), accept=one)
    assert good.accepted is True and all(each.passed for each in good.criteria)
    for name, limit in {"tip": 0.009, "peaks": 0.009, "followed": 0.19}.items():
        bad = compare(*reproduced(), accept=one | {name: limit})
        assert bad.accepted is False and [each.name for each in bad.criteria if not each.passed] == [name]
        # What is kept does not stand under what is not.
        refused, kept = list(judged_lines(bad))[:2]
        assert refused == f"limits missed: {bad.refusal}" and refused.count("(") == 1
        assert kept.startswith("limits kept: ") and name not in kept and kept.count("(") == 3
    kept = "limits kept: tip -1.0 % (limit 1.1 %), error of peaks 1.0 % at 4.00 s (limit 1.1 %), "
    assert next(judged_lines(good)).startswith(kept)
    # What is not known decides nothing.
    unknown = compare(*reproduced(), accept={"root_moment": 0.5})
    assert unknown.decision == "NOT DECIDED" and str(unknown.criteria[0]) == "root moment unknown (limit 50 %)"


@pytest.mark.parametrize("accept", [{"tips": 0.1}, {"tip": -0.1}, {"tip": float("nan")}])
def test_limits_that_mean_nothing(accept: dict[str, float]) -> None:
    with pytest.raises(InputError, match="accept"):
        compare(*reproduced(), accept=accept)


def test_the_tolerance_decides(pair: tuple[Response, Response]) -> None:
    wide = compare(*pair, tolerance=0.5).accounting
    assert wide.followed_share == pytest.approx(1.0) and not wide.overloads
    # Of a peak's own size: 3.55 g made as 1.4 g, and 5 g turned by 30°, are within half of 10 g.
    assert [(peak.load / G, peak.error > 0.5) for peak in wide.missed] == [(pytest.approx(s), True) for s in (3.55, 5)]
    for tolerance in (0.01, 0.02, 0.1, 0.2, 0.51, 0.55, 0.7):
        some = compare(*pair, tolerance=tolerance).accounting
        assert [bool(peak.reason) for peak in some.peaks] == [peak.error > tolerance for peak in some.peaks]
    assert facts_of(wide)["tolerance_load"] == pytest.approx(5 * G) and facts_of(wide)["tolerance_of"] == "peak"
    with pytest.raises(InputError, match="tolerance_of"):
        compare(*pair, tolerance_of="time")
    with pytest.raises(InputError, match="tolerance"):
        compare(*pair, tolerance=0.0)


def test_a_tolerance_of_the_load_at_the_time_does_not_take_1_4_g_for_1_2(pair: tuple[Response, Response]) -> None:
    """Of the pieces above idle, 1.4 g for 1.2 is within 5 % of 10 g, and not within 5 % of 1.2 g."""
    flown, spun = np.array([piece[1:3] for piece in PIECES]).T
    turned = np.array([piece[3] == "gimbals" for piece in PIECES])
    durations = np.array([piece[0] for piece in PIECES])
    followed = (np.abs(spun - flown) <= 0.05 * flown) & ~turned
    instant = compare(*pair, tolerance_of="instant", accept={"followed": 0.4})
    expected = (durations * followed).sum() / durations.sum()
    assert instant.accounting.followed_share == pytest.approx(expected, abs=1e-3) and expected < 0.1
    assert compare(*pair).accounting.followed_share > 0.25
    assert next(lines(instant.accounting)) == "followed means within 5 % of the load at the time"
    assert instant.accepted is False
    # Below idle what the idling machine makes is no overload, whatever the load of the time is.
    assert [each.time for each in instant.accounting.overloads] == [
        each.time for each in compare(*pair).accounting.overloads
    ]
    assert instant.accounting.allowed == pytest.approx(0.5 * G)


def test_the_error_of_a_peak_at_the_same_instant() -> None:
    """A machine that makes every load 40 ms late: its peaks are right, and at no instant the load."""
    time = 0.005 * np.arange(801)
    load = along_z(5 + 4 * np.sin(2 * np.pi * time))
    late = along_z(5 + 4 * np.sin(2 * np.pi * (time - 0.04)))
    accounting = account(time, alike(load), alike(late), tolerance=0.05)
    peak = accounting.peaks[1]
    assert peak.error < 1e-3 and not peak.reason and peak.time_machine - peak.time == pytest.approx(0.04)
    assert peak.instant_error == pytest.approx(4 * (1 - np.cos(2 * np.pi * 0.04)) / 9, rel=1e-9)
    assert facts_of(accounting)["peaks"][1]["instant_error"] == peak.instant_error
    assert "9 g (under 0.1 %, 40 ms later), 1.4 % off at the same instant" in "\n".join(lines(accounting))


def test_spread_along_a_specimen_on_an_arm() -> None:
    """Along the arm the load goes with the radius: −x_c/R at the root, (L − x_c)/R at the tip."""
    flight, arm = reproduced()
    radius, at = 3.3, 0.1
    rate = np.sqrt(np.linalg.norm(arm.axes.actual, axis=1) / radius)  # type: ignore[union-attr]
    inwards = -(rate**2)[:, None] * [1.0, 0.0, 0.0]
    axes = replace(arm.axes, actual=radius * inwards, reference=radius * inwards, control_point=at)  # type: ignore[type-var]
    base = Base((radius - at) * inwards, rate[:, None] * [0.0, 0.0, 1.0], ZERO)
    (peak,) = compare(flight, replace(arm, axes=axes, base=base)).accounting.peaks
    assert peak.spread == pytest.approx((-at / radius, (LENGTH - at) / radius))
    assert peak.spread_flight == (0.0, 0.0)
    about_y = np.tile([0.0, 1.0, 0.0], (len(TIME), 1))
    turning = replace(flight, base=replace(flight.base, w_WB_B=about_y))
    (peak,) = compare(turning, arm).accounting.peaks
    assert peak.spread_flight[1] == pytest.approx(np.hypot(1, LENGTH / (10 * G)) - 1)


def test_shares_of_limits_over_time() -> None:
    rate, acceleration, jerk = (np.random.default_rng(k).standard_normal((50, 3)) for k in range(3))
    power = np.abs(rate[:, 0] * acceleration[:, 0])
    uses = (
        LimitUse("axis 3", "rate", "rad/s", 1.0, 2.0, 0.0),
        LimitUse("axis 2", "jerk", "rad/s^3", 1.0, 4.0, 0.0),
        LimitUse("axis 1", "rate", "rad/s", 1.0, np.inf, 0.0),
        LimitUse("arm", "power", "W", 300 * power.max(), 500.0, 0.0),
    )
    axes = AxesResult(rate, rate, acceleration, rate, rate, np.zeros(50, bool), (), uses, jerk=jerk)
    shares = axes.limit_shares
    assert set(shares) == {"axis 3 rate", "axis 2 jerk", "arm power"}
    np.testing.assert_allclose(shares["axis 3 rate"], np.abs(rate[:, 2]) / 2)
    np.testing.assert_allclose(shares["axis 2 jerk"], np.abs(jerk[:, 1]) / 4)
    np.testing.assert_allclose(shares["arm power"], 300 * power / 500)
    assert "axis 2 jerk" not in replace(axes, jerk=None).limit_shares


def test_spin_up_is_not_the_flight(pair: tuple[Response, Response]) -> None:
    """A machine's response from standstill to standstill, on the flight's clock: the same comparison."""
    flight, arm = reproduced()
    before = STEP * (np.arange(-300, 0) + 0.5)
    time = np.concatenate([before, TIME, TIME[-1] + STEP * np.arange(1, 301)])
    n = len(before)

    def longer(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values[:1] + 0 * values[:n], values, values[-1:] + 0 * values[:n]])

    axes = arm.axes
    assert axes is not None
    parts = {name: longer(getattr(axes, name)) for name in ("angle", "rate", "acceleration", "reference", "actual")}
    moved = longer(arm.displacement) * np.where(time < 0, 9.0, 1.0)[:, None, None]
    whole = replace(
        with_body(arm, displacement=moved),
        time=time,
        base=each_leaf(longer, arm.base),
        axes=replace(axes, not_followed=longer(axes.not_followed), **parts),
    )
    # A peak between the steps of the spin-up is none of the flight's.
    early = replace(whole.peaks, max_size=1.0, time_of_max_size=-1.0)
    one, two = compare(flight, arm), compare(flight, with_body(whole, peaks=early))
    assert two.verdict == one.verdict
    np.testing.assert_array_equal(two.time, TIME)
    np.testing.assert_array_equal(two.difference, one.difference)
    with pytest.raises(InputError, match="no time in common"):
        compare(flight, replace(whole, time=time + 1000.0))


@pytest.mark.parametrize(("name", "count"), [("f16_8g_turn", 5), ("f16_pulls_and_push", 7)])
def test_no_peak_of_a_record_is_missing(name: str, count: int) -> None:
    """Against SciPy's peaks of the load's logarithm, in which a dip of a tenth is a prominence."""
    record = np.genfromtxt(DATA / f"{name}.csv", delimiter=",", names=True)
    time, load = record["time_s"], -G * np.stack([record[f"n_{axis}_g"] for axis in "xyz"], axis=1)
    size = np.linalg.norm(load, axis=1)
    # At the ends and below idle as low as nothing: both separate.
    level = np.log(np.where(size > IDLE * G, size, 1e-3))
    tops, _ = find_peaks(np.pad(level, 1, constant_values=-9.0), prominence=-np.log(0.9))
    flown = alike(load)
    accounting = account(time, flown, flown, tolerance=0.05, idle=IDLE * G)
    assert [peak.time for peak in accounting.peaks] == pytest.approx(time[tops - 1].tolist(), abs=0.011)
    assert [peak.load for peak in accounting.peaks] == pytest.approx(size[tops - 1].tolist())
    assert len(accounting.peaks) == count and accounting.main.load == size.max()  # type: ignore[union-attr]
    low = account(time, flown, still(load), tolerance=0.05, idle=IDLE * G).not_followed
    assert {each.reason for each in low} == {"below idle", "corner"}
    assert all((each.flight_peak > IDLE * G) == (each.reason == "corner") for each in low)


def still(load: np.ndarray) -> History:
    """A machine that makes no load at all."""
    return alike(0 * load)
