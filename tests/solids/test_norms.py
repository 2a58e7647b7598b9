"""Largest norms over time against all norms."""

import numpy as np
import pytest

from gbeam.results import von_mises
from gbeam.solids import LargestNorms, deviatoric

TIME = np.linspace(0.0, 3.0, 1500)[:, None]
RATES = 1.0 + np.arange(12)
HISTORIES = {
    "smooth": np.sin(TIME * RATES),
    "settling": 1.0 - np.exp(-3 * TIME) * np.cos(30 * TIME * RATES),
    "ramp": np.minimum(TIME, 1.0) * RATES,
    "steady": np.ones((1500, 12)),
    "noise": np.random.default_rng(1).normal(size=(1500, 12)),
    **{f"{count} times": np.random.default_rng(count).normal(size=(count, 12)) for count in (1, 2, 3, 9, 10, 65)},
}


@pytest.mark.parametrize("history", HISTORIES)
def test_the_largest_of_all_norms_and_their_first_times(history: str) -> None:
    """Leaving out what cannot be largest changes neither sizes nor times, also where many times are the largest."""
    q, table = HISTORIES[history], np.random.default_rng(0).normal(size=(300, 6, 12)) * 0.5 ** np.arange(12)
    # What the coordinates do most leaves some without stress, but for rounding, and others with little.
    most = np.linalg.svd(q)[2][0]
    table[::3] -= np.where(np.arange(100) % 2, 1.0, 0.999)[:, None, None] * (table[::3] @ most)[..., None] * most
    largest = LargestNorms(deviatoric(table), q)
    every = von_mises((table @ q.T).swapaxes(1, 2))
    assert largest.size == pytest.approx(every.max(axis=1), rel=1e-9)
    assert largest.over == pytest.approx(every.max(axis=0), rel=1e-12)
    first = (every >= (1 - 1e-9) * every.max(axis=1, keepdims=True)).argmax(axis=1)
    assert (largest.when == first)[every.max(axis=1) > 1e-9].all()
