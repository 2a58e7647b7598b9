"""A few of the random scenarios of `make validate`: those that share one compiled program."""

from __future__ import annotations

import numpy as np
import pytest

from validation.accuracy.draw import draw
from validation.accuracy.random_scenarios import judge, ratios

# Slews, hubs with the beam inwards, flights and machines, by linear models; one shape, four, and what lies between.
SEEDS = (0, 1, 3, 20, 24)


def test_stated_errors_hold_in_random_scenarios() -> None:
    judged = [judge(seed, draw(seed, ("FOAM", "SFOAM", "TLAM"))) for seed in SEEDS]
    known = [each for each in judged if each is not None]
    assert len(known) >= len(SEEDS) - 1
    of = ratios([each.tip for each in known])
    assert (3 * of >= 1).all() and (of >= 0.1).all()
    assert np.median(of) == pytest.approx(1.0, abs=0.3)


def test_no_error_of_the_force_hides_behind_one_of_the_moment() -> None:
    """TLAM's force along the beam is wrong by 0.027 %; 0.0082 % was stated, that of the moment, which the theory of
    slender beams makes more wrong in all."""
    of = judge(290, draw(290))
    assert of is not None
    stated, true = of.loads
    assert true > 2e-4 and true < stated < 3 * true
