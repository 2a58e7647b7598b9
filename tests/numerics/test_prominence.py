"""Peaks that a dip separates."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from gbeam.numerics import separate_peaks


def test_known_peaks() -> None:
    values = np.array([3.0, 1, 5, 4.6, 5.2, 4.0, 4.3, 0.5, 2, 2, 2, 0, 7])
    assert separate_peaks(values, 0.6, 0.9) == [
        (0, slice(0, 1)),
        (4, slice(1, 7)),  # 4.6 is no dip below nine tenths of 5, nor 4.0 below nine tenths of 4.3
        (8, slice(8, 11)),
        (12, slice(12, 13)),
    ]
    assert [top for top, _ in separate_peaks(values, 0.6, 0.95)] == [0, 2, 4, 6, 8, 12]
    assert separate_peaks(values, 8.0, 0.9) == []


@pytest.mark.parametrize("seed", range(20))
def test_every_value_belongs_to_a_peak_and_peaks_are_apart(seed: int) -> None:
    """By the definition, on random walks: no other set of peaks has both properties without a peak too many."""
    generator = np.random.default_rng(seed)
    walk = np.abs(np.cumsum(generator.integers(-3, 4, 400))).astype(float)
    floor, dip = float(generator.uniform(0, 3)), 0.9
    answer = separate_peaks(walk, floor, dip)
    tops = [top for top, _ in answer]
    assert tops == sorted(tops)
    for (one, first), (two, second) in pairwise(answer):
        lowest = walk[one:two].min()
        assert lowest < dip * min(walk[one], walk[two]) or lowest <= floor
        assert first.stop <= second.start
    for i in np.flatnonzero(walk > floor):
        (peak,) = (top for top, part in answer if part.start <= i < part.stop)
        assert walk[peak] >= walk[i]
        between = (walk[min(i, p) : max(i, p) + 1].min() for p in tops if walk[p] >= walk[i])
        assert any(lowest > floor and lowest >= dip * walk[i] for lowest in between)
