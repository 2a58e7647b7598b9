"""Flight against centrifuge: a pure function of two results, tried on histories made by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gbeam import Study, compare

from .helpers import of_tip

TIME = np.linspace(0, 2, 201)
WAVE = np.stack([0 * TIME, 1e-3 * TIME, -3e-3 * np.sin(np.pi * TIME)], axis=1)
EXTRA = np.stack([1e-6 + 0 * TIME, 0 * TIME, 3e-5 * (TIME > 1)], axis=1)


def test_same_response_has_no_difference() -> None:
    compared = compare(of_tip("flight", TIME, WAVE), of_tip("arm", TIME, WAVE))
    assert not compared.difference.any()
    assert compared.covered.all()
    np.testing.assert_allclose(compared.peak_flight, [0, 2e-3, 3e-3], rtol=1e-12)
    assert any(
        "within 0.1 % of the flight's 3.358 mm" in each for each in compared.findings
    )  # the vector's, not z's 3 mm


def test_difference_is_centrifuge_less_flight() -> None:
    compared = compare(of_tip("flight", TIME, WAVE), of_tip("arm", TIME, WAVE + EXTRA))
    np.testing.assert_allclose(compared.difference, EXTRA, atol=1e-18)
    np.testing.assert_allclose(compared.max_difference, [1e-6, 0, 3e-5], atol=1e-18)
    np.testing.assert_allclose(compared.rms_difference, [1e-6, 0, 3e-5 * np.sqrt(100 / 201)], rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(compared.relative[2], 0.01, rtol=1e-12)
    assert np.isnan(compared.relative[0])  # nothing in flight to compare with
    assert (compared.flight, compared.centrifuge) == ("flight", "arm")
    assert compared.peaks["tip"].ratio > 1.007


def test_held_times_do_not_count() -> None:
    compared = compare(of_tip("flight", TIME, WAVE), of_tip("arm", TIME, WAVE + EXTRA, held=TIME > 1))
    np.testing.assert_array_equal(compared.covered, TIME <= 1)
    assert compared.max_difference[2] == 0
    np.testing.assert_allclose(compared.difference, EXTRA, atol=1e-18)  # still there
    np.testing.assert_allclose(compared.peak_flight[1], 1e-3, rtol=1e-12)


def test_nothing_covered() -> None:
    compared = compare(of_tip("flight", TIME, WAVE), of_tip("arm", TIME, WAVE, held=TIME > -1))
    assert np.isnan(compared.max_difference).all() and np.isnan(compared.rms_difference).all()
    assert any(each.startswith("Tip: ") for each in compared.findings)  # the verdict is about the whole flight


def test_other_times_are_interpolated_and_the_later_ones_left_out() -> None:
    coarse = TIME[::4]
    longer = np.linspace(0, 3, 301)
    straight = np.outer(longer, [0.0, 1e-3, 0.0])
    compared = compare(of_tip("flight", coarse, straight[:201:4]), of_tip("arm", longer, straight))
    assert len(compared.time) == 201 and compared.time[-1] == pytest.approx(2.0)
    np.testing.assert_allclose(compared.difference, 0, atol=1e-15)


def test_outcome_of_a_study_is_the_first_that_is_not_done() -> None:
    good = of_tip("flight", TIME, WAVE)
    assert Study("t", {"a": good, "b": good}, ()).outcome == "done"
    assert Study("t", {"a": good, "b": replace(good, outcome="diverged")}, ()).outcome == "diverged"
