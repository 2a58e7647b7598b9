"""When a linear model's stiffness stops being positive definite."""

from __future__ import annotations

import numpy as np
import pytest

from gbeam.analysis.equilibrium.definiteness import first_loss, lowest_over_time
from gbeam.results.response import BaseMotion

from .helpers import LENGTH, OMEGA, strip

TLAM = strip("TLAM").coefficients


def spin(rate: np.ndarray) -> BaseMotion:
    """Rotation about y, in whose plane the strip bends, hub radius 0; an angular acceleration that must not matter."""
    o = np.zeros_like(rate)
    return BaseMotion(np.stack([o, o, o], 1), np.stack([o, rate, o], 1), np.stack([o, rate, o], 1))


def test_tlam_softens_by_the_square_of_the_rate() -> None:
    """TLAM without foreshortening has K − Ω²M in the plane of rotation: lost at Ω = ω₁."""
    rate = np.array([0.0, 0.5, 1.0]) * OMEGA
    base = spin(rate)
    found = lowest_over_time(TLAM, base, np.arange(3))
    np.testing.assert_allclose(found, OMEGA**2 - rate**2, atol=1e-8 * OMEGA**2)


def test_first_loss_is_found_between_the_samples() -> None:
    time = np.linspace(0, 2, 9)
    when, rate = first_loss(TLAM, time, spin(time * OMEGA)) or (np.nan, np.nan)
    assert when == pytest.approx(1.0, abs=1e-6)
    assert rate == pytest.approx(OMEGA, rel=1e-6)
    between = np.linspace(0, 2, 100)
    when, rate = first_loss(TLAM, between, spin(between * OMEGA)) or (np.nan, np.nan)
    assert rate == pytest.approx(OMEGA, rel=1e-3)
    assert when == pytest.approx(1.0, rel=1e-3)


def test_no_loss_and_loss_from_the_start() -> None:
    time = np.linspace(0, 1, 5)
    assert first_loss(TLAM, time, spin(0.9 * OMEGA * time)) is None
    assert first_loss(TLAM, time, spin((2 - time) * OMEGA)) == (0.0, pytest.approx(2 * OMEGA))


def test_foam_does_not_lose_it_on_a_hub() -> None:
    foam = strip().coefficients
    rate = np.linspace(0, 5 * OMEGA, 20)
    base = spin(rate)
    on_rim = BaseMotion(np.outer(rate**2, [-LENGTH, 0, 0]), base.w_WB_B, base.alpha_WB_B)
    assert first_loss(foam, np.linspace(0, 1, 20), on_rim) is None
