"""2020, example 4 over jerk and arm radius: the √j law from rest and the j√R law of a rounded corner, by simulation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam import InputError
from gbeam.analysis.jerk import first_mode, hann_transform, jerk_study

G = 9.81


def test_first_mode_and_kernel(structure: Any) -> None:
    frequency, c1, lever = first_mode(structure, 0.15)
    assert frequency == pytest.approx(229.6914, abs=1e-3)  # theory.md A5
    assert lever / 0.3 == pytest.approx(0.226477, abs=1e-6)
    assert c1 * 4 * G / frequency == pytest.approx(0.0050709e-3, rel=1e-4)
    assert abs(hann_transform(frequency * 0.0596)) == pytest.approx(0.0208, abs=1e-4)


@pytest.mark.slow
def test_from_rest_goes_with_the_root_of_the_jerk(structure: Any) -> None:
    study = jerk_study(structure, [1 * G, 4 * G], [1.65, 3.3], law="from-rest", level=10 * G)
    assert np.abs(study.error).max() < 0.05
    # What is left grows with sqrt(jR): the arm's tangential acceleration acting on the bent beam.
    size = np.sqrt(np.outer(study.jerks, study.arms))
    np.testing.assert_allclose(study.error / size, study.error[1, 1] / size[1, 1], rtol=0.2)


@pytest.mark.slow
def test_rounded_corner_goes_with_the_jerk_and_the_root_of_the_arm(structure: Any) -> None:
    study = jerk_study(structure, [2 * G, 4 * G], [3.3, 7.6], law="flat", level=10 * G, smoothing=0.0596)
    assert np.abs(study.error).max() < 0.05


def test_printed_amplitudes(structure: Any) -> None:
    """2020 Table 2, first row: 0.083 mm at 4 g/s with R = 3.3 m and a kernel of 59.6 ms, both fitted."""
    study = jerk_study(structure, [4 * G], [3.3], law="flat", level=10 * G, smoothing=0.0596)
    assert study.simulated[0, 0] == pytest.approx(0.0836e-3, rel=0.01)


def test_refusals(structure: Any) -> None:
    with pytest.raises(InputError, match="choose one of from-rest, flat"):
        jerk_study(structure, [1.0], [1.0], law="exact", level=1.0)
    with pytest.raises(InputError, match="smoothing is missing"):
        jerk_study(structure, [1.0], [1.0], law="flat", level=1.0)
