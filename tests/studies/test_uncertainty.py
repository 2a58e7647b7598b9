"""Distributions in a scenario, and what their samples say: closed forms, and the coverage of every bound."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import gbeam as gb
from gbeam.studies import indices, read_cases, statistics

Call = Callable[..., Any]
STIFFNESS, LEVEL = "beam.material.youngs_modulus", "motion.flight.acceleration.z.level"
UNSURE = '{ lognormal = ["70 GPa", 0.06] }'


@pytest.fixture
def unsure(fast: Path) -> Path:
    """A flight of a beam whose Young's modulus is known to 6 %."""
    text = fast.read_text(encoding="utf-8").replace('youngs_modulus = "70 GPa"', f"youngs_modulus = {UNSURE}")
    fast.write_text(text, encoding="utf-8")
    return fast


def test_every_bound_holds_in_95_of_100_trials() -> None:
    draws = np.random.default_rng(3).normal(2.0, 0.5, (3000, 96))
    normal = stats.norm(2.0, 0.5)
    truth = [2.0, 0.5, *normal.ppf([0.05, 0.5, 0.95])]
    answer = statistics(draws)
    for name, value in zip(answer.names, truth, strict=True):
        low, high = np.nan_to_num(answer[name][:, 1], nan=-np.inf), np.nan_to_num(answer[name][:, 2], nan=np.inf)
        # Order statistics come in whole numbers, so a quantile's interval covers more; a deviation's is asymptotic.
        least, most = (0.925, 0.965) if name in ("mean", "standard deviation") else (0.94, 0.99)
        assert least < np.mean((low <= value) & (value <= high)) < most, name
    ones = (np.random.default_rng(4).random((3000, 96)) < 0.9).astype(float)
    chance = statistics(ones, truth=True)["probability"]
    assert 0.94 < np.mean((chance[:, 1] <= 0.9) & (chance[:, 2] >= 0.9)) < 0.99  # Clopper and Pearson's is at least
    assert statistics(np.ones(20), truth=True)["probability"] == pytest.approx([1, 0.025 ** (1 / 20), 1])


def test_few_draws_have_fewer_bounds_and_none_has_nothing() -> None:
    few = statistics(np.array([[1.0, 2.0, np.nan, 4.0], [np.nan] * 4]))
    assert few.count.tolist() == [3, 0]
    assert few["mean"][0, 0] == pytest.approx(7 / 3) and np.isnan(few.values[1]).all()
    assert np.isnan(few["5 %"][0, 1]) and np.isnan(few["95 %"][0, 2])


def test_the_deviation_of_few_draws_is_estimated_without_bias_of_its_square() -> None:
    """By n − 1, and the mean's bounds by Student's quantile of two degrees of freedom, 4.303."""
    few = statistics(np.array([1.0, 2.0, 4.5]))
    deviation = np.sqrt(((np.array([1.0, 2.0, 4.5]) - 2.5) ** 2).sum() / 2)
    assert few["standard deviation"][0] == pytest.approx(deviation, rel=1e-12)
    assert few["mean"] == pytest.approx(2.5 + 4.302653 * deviation / np.sqrt(3) * np.array([0, -1, 1]), rel=1e-6)


def test_sobol_indices_of_ishigamis_function() -> None:
    """Ishigami and Homma, 1990: a = 7, b = 0.1."""
    a, b = 7.0, 0.1
    cases = read_cases([f"x{i}=uniform(-3.141592653589793, 3.141592653589793)" for i in range(3)], 1024, "saltelli")
    assert cases.shape == (5 * 1024,) and cases.independent == 2048
    x, y, z = (np.asarray(each.values) for each in cases.drawn)
    answer = indices(np.sin(x) + a * np.sin(y) ** 2 + b * z**4 * np.sin(x), ["x", "y", "z"], 0)
    first = 0.5 * (1 + b * np.pi**4 / 5) ** 2, a**2 / 8, 0.0
    both = b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    total = first[0] + both, a**2 / 8, both
    variance = sum(first) + both
    assert answer.values[:, 0, 0] == pytest.approx(np.array(first) / variance, abs=0.02)
    assert answer.values[:, 1, 0] == pytest.approx(np.array(total) / variance, abs=0.02)
    truth = np.stack([first, total], axis=1) / variance
    assert np.all((answer.values[..., 1] <= truth) & (truth <= answer.values[..., 2]))


def test_quantiles_of_a_frequency_are_those_of_the_root_of_the_stiffness(unsure: Path) -> None:
    measure = ["modes[0].frequency"]
    swept = gb.sweep(unsure, measure=measure, verb="modes", motion="flight", samples=48)
    (stiffness,) = swept.parameters
    assert (stiffness.path, stiffness.drawn, stiffness.unit) == (STIFFNESS, "lognormal(70 GPa, 0.06)", "GPa")
    one = gb.sweep(unsure, [f"{STIFFNESS}=70 GPa"], measure, verb="modes", motion="flight")
    assert one.parameters[0].drawn == "" and not one.statistics  # what is given takes the distribution's place
    centre = float(one.measures[measure[0]][0])
    known = swept.statistics[measure[0]]
    truth = stats.lognorm(0.03, scale=centre)
    for name, value in {"mean": truth.mean(), "standard deviation": truth.std(), "median": centre}.items():
        assert known[name][1] <= value <= known[name][2] and known[name][0] == pytest.approx(value, rel=0.03)
    for name, share in {"5 %": 0.05, "95 %": 0.95}.items():
        assert known[name][0] == pytest.approx(truth.ppf(share), rel=0.01)


def test_sobol_indices_of_a_static_deflection(unsure: Path) -> None:
    """Deflection goes with load over stiffness: the indices of a product of two lognormal numbers."""
    over = [f"{LEVEL}=lognormal(6 g, 0.1)"]
    of_flight = {"verb": "static", "motion": "flight"}
    swept = gb.sweep(unsure, over, ["flight.tip.z"], **of_flight, sampler="saltelli", samples=64)
    assert swept.outcome.shape == (4 * 64,)
    alone = np.expm1(np.array([0.1, 0.06]) ** 2)
    variance = np.prod(1 + alone) - 1
    truth = np.stack([alone, variance - alone[::-1]], axis=1) / variance
    shares = swept.indices["flight.tip.z"]
    assert shares.parameters == (LEVEL, STIFFNESS) and shares.count == 64
    assert np.all((shares.values[..., 1] <= truth) & (truth <= shares.values[..., 2]))
    assert swept.statistics["flight.tip.z"].count == 128  # of the two halves that are independent


def test_histories_stay_in_their_bands(unsure: Path) -> None:
    # Under a load that stands still the beam rests, and the deflection goes with 1/E.
    names = ["flight.tip.z", "flight.root_moment.y"]
    swept = gb.sweep(unsure, histories=names, samples=8, times=5, store="there")
    stiffness = swept.parameters[0].values
    assert swept.histories["flight.tip.z"].shape == (8, 5) and swept.time == pytest.approx(np.linspace(0, 0.5, 5))
    product = swept.histories["flight.tip.z"] * stiffness[:, None]
    assert product == pytest.approx(np.full((8, 5), product[0, 0]), rel=1e-5)
    moment = 2700 * 0.02 * 0.004 * 6 * 9.80665 * 0.3**2 / 2
    assert np.abs(swept.histories["flight.root_moment.y"]) == pytest.approx(np.full((8, 5), moment), rel=0.05)
    assert swept.units == {"flight.tip.z": "m", "flight.root_moment.y": "N m"}
    band = swept.statistics["flight.tip.z"]
    assert band["median"].shape == (5, 3)
    assert band["median"][:, 0] == pytest.approx(np.median(swept.histories["flight.tip.z"], axis=0))
    resumed = gb.sweep(unsure, histories=names, samples=8, times=5, store="there", resume=True)
    assert np.array_equal(resumed.histories["flight.tip.z"], swept.histories["flight.tip.z"])
    response = gb.study(gb.read_scenario(unsure, [f"{STIFFNESS}={float(stiffness[3])!r} GPa"])).responses["flight"]
    assert swept.histories["flight.tip.z"][3, -1] == pytest.approx(response.tip[-1, 2], rel=1e-9)
    assert response.loads is not None  # whose sign is that of the base on the beam
    root = response.loads.root_moment[-1, 1]
    assert swept.histories["flight.root_moment.y"][3, -1] == pytest.approx(root, rel=1e-9)


def test_a_case_that_is_not_done_is_left_out_of_the_estimates(unsure: Path, gbeam: Call) -> None:
    # Beyond the tip a control point is refused.
    over = "motion.spin.control_point=uniform(0 mm, 400 mm)"
    command = ("--verb", "static", "--over", over, "--measure", "flight.tip.z", "--samples", "16", "--out", "there")
    answer = gbeam("sweep", unsure, *command, "--json")
    known = answer.json["statistics"]["flight.tip.z"]
    refused = answer.json["counts"]["refused"]
    assert answer.status == 1 and refused > 0 and known["draws"] == 16 - refused
    done = [each is not None for each in answer.json["measures"]["flight.tip.z"]["values"]]
    assert done == [each == "done" for each in answer.json["outcomes"]]
    assert (
        f"{refused} of 16 cases are not done: the estimates are of the others"
        in gbeam("sweep", unsure, *command, "--resume").out
    )


def test_a_sweep_of_distributions_is_computed_again_from_its_json(unsure: Path, gbeam: Call) -> None:
    command = ("--verb", "static", "--measure", "flight.tip.z", "--samples", "4", "--sampler", "latin", "--seed", "5")
    assert gbeam("sweep", unsure, *command, "--out", "there").status == 0
    unsure.unlink()
    again = gbeam("rerun", "there/sweep.json")
    assert again.status == 0 and not Path("out").exists(), again.err


def test_how_probable_it_is_that_a_machine_is_accepted(fast: Path, gbeam: Call) -> None:
    text = fast.read_text(encoding="utf-8")
    place = 'control_point = { uniform = ["0 mm", "300 mm"] }\naccept = { tip = "0.02 %" }'
    fast.write_text(text.replace('control_point = "150 mm"', place), encoding="utf-8")
    command = ("--measure", "verdict.tip, verdict.accepted", "--samples", "6", "--out", "there", "--netcdf")
    answer = gbeam("sweep", fast, *command)
    assert answer.status == 0 and "verdict.accepted, of 6 draws" in answer.out and "probability" in answer.out
    assert "NOT ACCEPTED" in answer.out and "are not done" not in answer.out
    with xr.open_zarr("there/sweep.zarr") as data, xr.open_dataset("there/sweep.nc") as same:
        accepted = data["verdict.accepted"].values
        assert np.array_equal(accepted == 1, np.abs(data["verdict.tip"].values) <= 2e-4) and 0 < accepted.sum() < 6
        bounds = stats.binomtest(int(accepted.sum()), 6).proportion_ci(0.95)
        low, high = (float(data["verdict.accepted probability"].sel(bound=each)) for each in ("low", "high"))
        assert (low, high) == pytest.approx((bounds.low, bounds.high))
        assert same["verdict.tip statistics"].equals(data["verdict.tip statistics"])


def test_one_value_is_needed_where_nothing_is_drawn(unsure: Path, gbeam: Call) -> None:
    answer = gbeam("run", unsure)
    assert answer.status == 2
    assert f"{STIFFNESS}: is a distribution, lognormal(70 GPa, 0.06), and this needs one value" in answer.err
    assert f"fast.toml:5:56: {STIFFNESS}" in answer.err and "`gbeam sweep` draws from it" in answer.err
    assert gbeam("modes", unsure, "--motion", "flight", "--set", f"{STIFFNESS}=70 GPa").status == 0
    checked = gbeam("check", unsure)
    assert checked.status == 0 and f"{STIFFNESS}: lognormal(70 GPa, 0.06); here its centre" in checked.out


@pytest.mark.parametrize(
    ("value", "problem"),
    [
        ('{ norml = ["70 GPa", "2 GPa"] }', "did you mean 'normal'?"),
        ('{ normal = "70 GPa" }', "has no list of numbers in normal"),
        ('{ normal = ["70 GPa", "2 kg"] }', "has values in GPa and in kg"),
        ('{ normal = ["70 kg", "2 kg"] }', "is a mass"),
        ('{ uniform = ["70 GPa"] }', "give 2: from, to"),
        ('{ normal = ["70 GPa", "0 GPa"] }', "give a standard deviation above zero"),
    ],
)
def test_a_wrong_distribution_is_placed(fast: Path, gbeam: Call, value: str, problem: str) -> None:
    answer = gbeam("sweep", fast, "--set", f"{STIFFNESS}={value}", "--verb", "static", "--measure", "flight.tip.z")
    assert answer.status == 2 and problem in answer.err and STIFFNESS in answer.err and not Path("out").exists()


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (("--history", "flight.tip.q"), "'flight.tip.q' is no history; did you mean 'tip.z'?"),
        (("--history", "tip.z"), "leaves the motion out; write flight.tip.z"),
        (("--history", "fligth.tip.z"), "names no motion; did you mean 'flight'?"),
        (("--history", "flight.tip.z", "--times", "1"), "--times is 1"),
        (("--history", "flight.tip.z", "--verb", "static"), "stands with --verb static"),
        (("--history", "flight.tip.z", "--times", "1000000000"), "which would take 16 GB"),
    ],
)
def test_a_wrong_history_is_refused(unsure: Path, gbeam: Call, arguments: tuple[str, ...], problem: str) -> None:
    answer = gbeam("sweep", unsure, "--samples", "2", *arguments, "--set", "response.estimate=false", "--out", "there")
    assert answer.status == 2 and problem in answer.err and not Path("there").exists()
