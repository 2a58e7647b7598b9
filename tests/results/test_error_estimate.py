"""Estimated errors of several quantities together."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from gbeam.results import ErrorEstimate

share = st.floats(1e-9, 10.0)


@given(st.lists(st.tuples(share, share, share, share), min_size=1, max_size=4))
def test_each_cause_is_the_largest_of_several_quantities(parts: list[tuple[float, float, float, float]]) -> None:
    errors = [ErrorEstimate(a, b, c, total=a + b + c).adding(beam_theory=d) for a, b, c, d in parts]
    together = ErrorEstimate.from_largest(errors)
    steps, shapes, models, theories = map(max, zip(*parts, strict=True))
    assert (together.step, together.shapes, together.model, together.beam_theory) == (steps, shapes, models, theories)
    assert together.total == max(each.total for each in errors)
    assert together.slender == max(each.slender for each in errors)


def test_what_no_quantity_knows_is_not_known() -> None:
    assert math.isnan(ErrorEstimate.from_largest([]).total)
    known = ErrorEstimate(1e-3, 2e-3, math.nan, total=3e-3)
    together = ErrorEstimate.from_largest([known, ErrorEstimate()])
    assert together.total == 3e-3 and math.isnan(together.model) and math.isnan(together.beam_theory)
