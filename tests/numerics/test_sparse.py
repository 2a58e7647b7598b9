"""Factors by each library: answers of springs in a row and in a lattice, in closed form, and what has no answer."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import block_diag, csc_array, diags_array, eye_array, kron

import gbeam as gb
from gbeam.numerics import sparse

ORDER = {"pypardiso": "Pardiso", "rslab": "RSLAB", "scipy": "SuperLU"}


@pytest.fixture(params=ORDER, ids=ORDER.get)
def library(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A library, with those that go before it not installed."""
    before = list(ORDER)[: list(ORDER).index(request.param)]
    for name in before:
        monkeypatch.setitem(sys.modules, name, None)
    sparse.solver.cache_clear()
    if not before and sparse.solver() != "Pardiso":  # MKL is proprietary, and no dependency of the tests
        pytest.skip("pypardiso is not installed")
    assert sparse.solver() == ORDER[request.param]
    yield request.param
    sparse.solver.cache_clear()


def row(springs: int) -> csc_array:
    """Masses in a row between two walls, with springs of 1 N/m."""
    return csc_array(diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(springs - 1, springs - 1)))


def lattice(springs: int) -> csc_array:
    """Such rows along three axes."""
    one, eye = row(springs), eye_array(springs - 1)
    return csc_array(kron(kron(one, eye), eye) + kron(kron(eye, one), eye) + kron(kron(eye, eye), one))


@pytest.mark.usefixtures("library")
def test_a_row_of_springs_under_its_weight_is_a_parabola() -> None:
    place = np.arange(1, 1000)
    with sparse.factorised(row(1000)) as solve:
        displacement = solve(np.stack([np.ones(999), np.zeros(999), place == 500], axis=1))
    midway = np.minimum(place, 1000 - place) / 2
    expected = np.stack([place * (1000 - place) / 2, np.zeros(999), midway], axis=1)
    np.testing.assert_allclose(displacement, expected, rtol=1e-9)


@pytest.mark.usefixtures("library")
def test_frequencies_of_a_lattice_of_equal_springs() -> None:
    """ω² = 2 Σ (1 − cos kπ/n): the second to the fourth are one."""
    n = 12
    start = np.random.default_rng(0).standard_normal(((n - 1) ** 3, 8))
    with sparse.factorised(lattice(n)) as solve:
        inverse, _ = sparse.lowest_modes(solve, eye_array((n - 1) ** 3), start, 5)
    first, second = 2 * (1 - np.cos(np.array([1, 2]) * np.pi / n))
    expected = [3 * first, *[2 * first + second] * 3, first + 2 * second]
    np.testing.assert_allclose(1 / inverse, expected, rtol=1e-9)


@pytest.mark.usefixtures("library")
def test_a_mass_that_nothing_holds_is_refused() -> None:
    loose = csc_array(block_diag([row(1000), csc_array((1, 1))]))
    fault = r"springs is (singular|not positive definite); hold the structure"
    with pytest.raises(gb.InputError, match=fault), sparse.factorised(loose, "springs"):
        pass


def test_what_is_too_large_names_the_library_and_a_licence_that_is_not_free(library: str) -> None:
    named = {"pypardiso": r"Pardiso of MKL \(proprietary: Intel .*License\)", "rslab": "RSLAB", "scipy": "SuperLU"}
    with pytest.raises(gb.InputError, match=rf"mesh makes 5e\+07 unknowns, .* hours by {named[library]}; mesh it"):
        sparse.refuse_cost("mesh", 50_000_000)
    sparse.refuse_cost("mesh", 200_000)


def test_a_negative_spring_is_refused(library: str) -> None:
    if library == "scipy":
        pytest.skip("LU has no signs of pivots: `reduce` judges the modes")
    buckled = row(1000) - 1e-4 * eye_array(999)  # beyond (π/1000)²
    fault = r"springs is not positive definite; hold the structure"
    with pytest.raises(gb.InputError, match=fault), sparse.factorised(csc_array(buckled), "springs"):
        pass


def test_factors_that_no_memory_holds_are_not_begun(monkeypatch: pytest.MonkeyPatch) -> None:
    """The library would end the process."""
    monkeypatch.setattr(
        "rslab.analyze", lambda matrix, **_: SimpleNamespace(memory_plan=lambda _: {"peak_bytes": 2**60})
    )
    monkeypatch.setattr(sparse, "solver", lambda: "RSLAB")
    with pytest.raises(MemoryError), sparse.factorised(row(1000)):
        pass
