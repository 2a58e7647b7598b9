"""Variations as text: ranges, lists, distributions, and what is wrong with them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

import gbeam as gb
from gbeam.studies import read_cases, read_variation


@pytest.mark.parametrize(
    ("text", "texts", "unit"),
    [
        ("a.b=4:10:4", ("4", "6", "8", "10"), ""),
        ("a.b=4 g/s:10 g/s:4", ("4 g/s", "6 g/s", "8 g/s", "10 g/s"), "g/s"),
        ("a.b=4:10:4 g/s", ("4 g/s", "6 g/s", "8 g/s", "10 g/s"), "g/s"),
        ("a.b = 0:0.3:4 m", ("0 m", "0.1 m", "0.2 m", "0.3 m"), "m"),
        ("a.b=log(1 m:1000 m:4)", ("1 m", "10 m", "100 m", "1000 m"), "m"),
        ("a.b=-1,2.5,4e1", ("-1", "2.5", "40"), ""),
        ("a.b=60 GPa, 70", ("60 GPa", "70 GPa"), "GPa"),
        ("model.kind=FOAM, exact", ("FOAM", "exact"), ""),
        ("beam.masses[0].mass=1 kg:1 kg:1", ("1 kg",), "kg"),
    ],
)
def test_a_range_or_a_list(text: str, texts: tuple[str, ...], unit: str) -> None:
    answer = read_variation(text)
    assert (answer.texts, answer.unit) == (texts, unit)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("arm", "is not PATH=VALUES"),
        ("a b=1:2:3", "is not PATH=VALUES"),
        ("arm=", "has no values"),
        ("arm=1:2:0", "has 0 values"),
        ("arm=1:2:1", "in one value"),
        ("arm=1:2:x", "has the count"),
        ("arm=1:2:1e3", "has the count"),
        ("arm=1 m:2 s:3", "in m and in s"),
        ("arm=log(-1:2:3)", "in equal ratios"),
        ("arm=1:2:99999999999", "values"),
        ("arm=1,1", "twice"),
        ("arm=1,,2", "empty value"),
        ("arm=gauss(1, 2)", "unknown distribution 'gauss'"),
        ("arm=normal(1)", "has 1 values"),
        ("arm=normal(1, 0)", "normal(1, 0)"),
        ("arm=uniform(2, 1)", "uniform(2, 1)"),
        ("arm=normal(a, b)", "no number"),
        ("arm=lognormal(1 m, 1 m)", "spread in m"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_path(text: str, problem: str) -> None:
    with pytest.raises(gb.InputError) as refused:
        read_variation(text)
    assert problem in str(refused.value) and refused.value.fix


def test_a_misspelt_distribution_is_guessed() -> None:
    with pytest.raises(gb.InputError, match="did you mean 'normal'"):
        read_variation("arm=norml(1, 2)")


def test_a_grid_has_every_combination_once_the_last_fastest() -> None:
    cases = read_cases(["a=1:2:2", "b=x,y,z"])
    assert cases.shape == (2, 3)
    every = [cases.overrides(i) for i in range(len(cases))]
    assert every[:4] == [("a=1", "b=x"), ("a=1", "b=y"), ("a=1", "b=z"), ("a=2", "b=x")]
    assert len(set(every)) == 6


@pytest.mark.parametrize("sampler", ["sobol", "latin", "random"])
def test_samples_follow_their_distributions(sampler: str) -> None:
    over = ["a=normal(70 GPa, 2 GPa)", "b=uniform(1, 3)", "c=lognormal(1 m, 0.5)", "d=triangular(0, 1, 4)"]
    cases = read_cases(over, 512, sampler, seed=3)
    theirs = [stats.norm(70, 2), stats.uniform(1, 2), stats.lognorm(0.5), stats.triang(0.25, 0, 4)]
    for each, distribution in zip(cases.drawn, theirs, strict=True):
        assert each.values is not None
        assert stats.kstest(each.values, distribution.cdf).pvalue > 0.01
    same = read_cases(over, 512, sampler, seed=3)
    assert all(np.array_equal(a.texts, b.texts) for a, b in zip(cases.drawn, same.drawn, strict=True))
    assert read_cases(over, 512, sampler, seed=4).drawn[0].texts != cases.drawn[0].texts
    assert abs(np.corrcoef(*[d.values for d in cases.drawn[:2]])[0, 1]) < 0.15  # type: ignore[misc]


def test_a_grid_and_samples_make_both() -> None:
    cases = read_cases(["a=uniform(0, 1)", "b=1:3:3"], 4)
    assert cases.shape == (3, 4)
    first, last = cases.overrides(0), cases.overrides(11)
    assert first[0] == "b=1" and last[0] == "b=3" and first[1] != last[1]


@pytest.mark.parametrize(
    ("over", "samples", "problem"),
    [
        ([], None, "--over is missing"),
        (["a=1:2:2", "a=3:4:2"], None, "varies a twice"),
        (["a=1:2:2"], 8, "--samples stands without a distribution"),
        (["a=uniform(0, 1)"], 0, "--samples is 0"),
        (["a=uniform(0, 1)"], 10**67, r"--samples makes 1e\+67 values"),
        (["a=lognormal(1, 1000)"], 8, "draws values beyond every number"),
    ],
)
def test_wrong_together(over: list[str], samples: int | None, problem: str) -> None:
    with pytest.raises(gb.InputError, match=problem):
        read_cases(over, samples)


def test_a_seed_below_zero_is_refused() -> None:
    with pytest.raises(gb.InputError, match="--seed is -1"):
        read_cases(["a=uniform(0, 1)"], 4, seed=-1)
