"""Stiffness that holds nothing, beside what is soft or stiff."""

from __future__ import annotations

import numpy as np
import pytest

from gbeam.numerics import answered, unheld


@pytest.mark.parametrize("apart", [1.0, 1e-7, 1e7])
def test_what_holds_nothing_is_told_from_what_is_soft(apart: float) -> None:
    """Two turns under one spring of their sum, which leaves their difference, beside a stiffness 1e15 times as large:
    whatever the units of their coordinates.
    """
    unit = np.diag([1.0, apart, 1.0])
    stiffness, mass = np.array([[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 2e15]]), np.diag([1.0, 1.0, 0.01])
    k, m = (unit @ each @ unit for each in (stiffness, mass))
    (way,) = (unit @ unheld(k, m)).T
    np.testing.assert_allclose(way / way[0], [1.0, -1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(unit @ answered(k, m, unit @ [1.0, 1.0, 2e9]), [0.25, 0.25, 1e-6], rtol=1e-9)
    assert not unheld(k + unit @ np.diag([2e-3, 0.0, 0.0]) @ unit, m).size
