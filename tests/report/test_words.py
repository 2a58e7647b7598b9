"""Tables in words: side by side where there is room, else folded."""

from __future__ import annotations

import pytest

from gbeam.report import columns, errors_in_words, number, percent, stress_words, tidy
from gbeam.results import ErrorEstimate

HEADS = ["value", "was", "is", "unit"]
ROWS = [["beam.material.youngs_modulus", "7e+10", "6.9e+10", "Pa"], ["beam.length", "0.3", "0.31", "m"]]


def test_a_table_folds_on_a_narrow_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    assert len(columns(HEADS, ROWS)) == 3  # a file takes any width
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "200")
    wide = columns(HEADS, ROWS)
    assert len(wide) == 3 and len({len(line) for line in wide[1:]}) <= 2
    monkeypatch.setenv("COLUMNS", "40")
    folded = columns(HEADS, ROWS)
    assert max(map(len, folded)) <= 40
    assert folded[:4] == ["beam.material.youngs_modulus", "  was    7e+10", "  is     6.9e+10", "  unit   Pa"]
    words = " ".join(folded)
    assert all(cell in words for row in ROWS for cell in row)


@pytest.mark.parametrize(
    ("stress", "said"),
    [
        (0.0, "no stress"),
        (2e-26, "no stress"),  # rounding at a profile's first instant was a margin of 1e34
        (1e-6, "stress 0 to 1.000e-12 MPa, largest in tension at 1.000 m, no stress to yield by"),
        (100e6, "stress 0 to 100.0 MPa, largest in tension at 1.000 m, margin on yield 1.5"),
        (500e6, "stress 0 to 500.0 MPa, largest in tension at 1.000 m, ABOVE YIELD: margin -0.5"),
    ],
)
def test_rounding_is_no_stress(stress: float, said: str) -> None:
    assert stress_words([0.0, 1.0], [0.0, stress], [0.0, 0.0], 250e6) == said


def test_rounding_beside_what_is_of_a_larger_scale_is_zero() -> None:
    """Of a share the scale is the whole; of a displacement that is a difference of places, these."""
    assert percent(3e-17) == "0 %" and percent(3e-13) == percent(9.9e-6) == "< 0.001 %"
    assert errors_in_words({"shapes": 0.01, "model": 3e-18, "total": 0.01}) == "1.0 %"
    assert tidy((1e-18, 1e-12), 1e-12, scale=2.0) == [0.0, 1e-12] and tidy((1e-18,), 1e-18) == [1e-18]


def test_a_small_number_of_one_digit_has_no_point() -> None:
    assert [number(2e-7, 1), number(4.0, 1), number(2e-7)] == ["2e-07", "4", "2.000e-07"]


@pytest.mark.parametrize("share", [10.1, 97610472735.79, 1e300])
def test_a_huge_error_has_no_digits(share: float) -> None:
    huge, half = ErrorEstimate(step=share, model=0.5, total=share + 0.5), ErrorEstimate(total=9.5)
    assert percent(share) == "over 1000 %" and (percent(9.5), percent(0.004)) == ("950 %", "0.40 %")
    assert errors_in_words({"total": share, "step": share, "model": 0.5}) == ("over 1000 % (step over 1000, model 50)")
    assert repr(huge) == "step over 1000 %, model 50 %, total over 1000 %" and repr(half) == "total 950 %"
