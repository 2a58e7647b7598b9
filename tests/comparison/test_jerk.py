"""2020, example 4 over jerk and arm radius: the √j law from rest and the j√R law of a rounded corner, by simulation."""

from __future__ import annotations

from math import factorial
from typing import Any

import mpmath
import numpy as np
import pytest
from jerk_laws import corner_transforms, first_mode, flat_terms, hann_transform
from jerk_study import jerk_study, main, studies

from gbeam import InputError

G = 9.81
W1, WIDTH = 229.6914, 0.0596


def test_first_mode_and_kernel(structure: Any) -> None:
    frequency, c1, lever = first_mode(structure, 0.15)
    assert frequency == pytest.approx(W1, abs=1e-3)  # docs/theory.md, sections 9 and 13
    assert lever / 0.3 == pytest.approx(0.226477, abs=1e-6)
    assert c1 * 4 * G / frequency == pytest.approx(0.0050709e-3, rel=1e-4)
    assert abs(hann_transform(frequency * WIDTH)) == pytest.approx(0.0208, abs=1e-4)


def test_example_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    main()
    table = capsys.readouterr().out
    assert table.count("R = 3.3 m") == 2 and "goes with j^0.51 R^-0.49" in table


@pytest.mark.parametrize(("law", "powers"), [("from-rest", (0.5, -0.5)), ("flat", (1.0, 0.5))])
def test_laws_over_the_whole_sweep(law: str, powers: tuple[float, float]) -> None:
    """1, 4, 8 and 15 g/s on arms of 1.5, 3.3, 7.6 and 15 m, as the example has them."""
    study = studies()[law]
    assert study.simulated.shape == (4, 4)
    assert np.abs(study.error).max() < 0.05
    # The leading order alone is off by more where j and R are large.
    assert np.abs(study.simulated / study.leading - 1).max() > 0.08
    np.testing.assert_allclose(study.exponents, powers, rtol=0.05)


def test_printed_amplitudes(structure: Any) -> None:
    """2020 Table 2, with R = 3.3 m and a kernel of 59.6 ms, both fitted: 0.083, 0.170, 0.215 mm.

    docs/theory.md, section 9: an independent simulation has 0.0836, 0.171 and 0.2156 mm, the leading order 0.081 j/4.
    """
    study = jerk_study(structure, [4 * G, 8 * G, 10 * G], [3.3], law="flat", level=10 * G, smoothing=WIDTH)
    np.testing.assert_allclose(study.simulated[:, 0], [0.0836e-3, 0.171e-3, 0.2156e-3], rtol=0.01)
    np.testing.assert_allclose(study.leading[:, 0], np.array([4, 8, 10]) / 4 * 0.081e-3, rtol=0.005)
    np.testing.assert_allclose(study.predicted, study.simulated, rtol=0.005)


def lag_transform(j: float, arm: float, level: float) -> complex:
    """∫ δ e^{iωt} dt of the whole lag: Gauss's rule within the kernel; by parts, to eight terms, on the ramp before."""
    nodes, weights = np.polynomial.legendre.leggauss(300)
    t, u = nodes * WIDTH / 2, nodes / 2
    s = 0.5 - u - np.sin(2 * np.pi * u) / (2 * np.pi)
    r = WIDTH * ((0.5 - u) ** 2 / 2 - (1 + np.cos(2 * np.pi * u)) / (2 * np.pi) ** 2)
    lag = np.arctan(j * s * np.sqrt(arm) / (2 * (level - j * r) ** 1.5))
    inside = np.sum(weights * WIDTH / 2 * lag * np.exp(1j * W1 * t))
    series = mpmath.taylor(lambda x: mpmath.atan(j * mpmath.sqrt(arm) / (2 * (level + j * x) ** 1.5)), -WIDTH / 2, 8)
    before = sum(float(c) * factorial(k) * (-1) ** k / (1j * W1) ** (k + 1) for k, c in enumerate(series))
    return complex(inside + before * np.exp(-1j * W1 * WIDTH / 2))


def test_next_order_against_a_quadrature_of_the_lag_itself() -> None:
    errors = []
    for part in (1.0, 0.5, 0.25):
        j, arm, level = part * 8 * G, 7.6, 10 * G
        jump = j * np.sqrt(arm) / (2 * level**1.5)
        factor = abs(lag_transform(j, arm, level)) * W1 / (jump * abs(hann_transform(W1 * WIDTH)))
        terms = flat_terms(np.array(j), np.array(jump), level, WIDTH, W1)
        errors.append(abs(abs(1 + terms.sum()) - factor))
        assert abs(factor - 1) > 3 * errors[-1]
    assert errors[0] < 2e-3
    np.testing.assert_array_less(3.5, np.array(errors[:-1]) / errors[1:])  # what is left is of the second order
    assert abs(corner_transforms(W1 * WIDTH)[1]) == pytest.approx(8.37, abs=0.01)


@pytest.mark.parametrize(
    ("options", "where", "words"),
    [
        ({"law": "exact"}, "law", "choose one of from-rest, flat"),
        ({"smoothing": None}, "smoothing", "is missing"),
        ({"jerks": [0.0]}, "jerks", "positive"),
        ({"jerks": [40 * G]}, "jerks", "6 periods must pass"),
        ({"level": 3 * G, "arms": [15.0]}, "jerks", "next order is"),
        ({"law": "from-rest", "jerks": [15 * G], "arms": [100.0]}, "jerks", "known up to 50%"),
    ],
)
def test_refusals(structure: Any, options: dict[str, Any], where: str, words: str) -> None:
    arguments = {"jerks": [4 * G], "arms": [3.3], "law": "flat", "level": 10 * G, "smoothing": WIDTH, **options}
    with pytest.raises(InputError, match=words) as caught:
        jerk_study(structure, arguments.pop("jerks"), arguments.pop("arms"), **arguments)
    assert caught.value.where == where
