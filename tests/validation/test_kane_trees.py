"""A few of the random trees of `make validate`, against Kane's equations: places, reactions, drives and energy."""

from __future__ import annotations

import pytest

from validation.codes.kane_trees import compared, drawn

# All kinds of joints; springs, friction, stops, drives, prescribed rates. The others have them all.
SEEDS = (pytest.param(1, marks=pytest.mark.thorough), pytest.param(2, marks=pytest.mark.thorough), 3, 4, 5, 18)
KANE = 1e-5  # of the largest: with stops; the smooth ones agree to 1e-9
COULOMB = 2e-5  # with friction, whose law there is Coulomb's and gbeam's smooth about zero rate


@pytest.mark.parametrize("seed", SEEDS)
def test_random_trees_move_as_by_kanes_equations(seed: int) -> None:
    apart = compared(seed)
    assert apart is not None
    rubbing = any("friction" in joint.laws for joint in drawn(seed)[1].joints)
    assert max(apart[:-1]) < (COULOMB if rubbing else KANE if seed not in (3, 5) else 1e-9)
    assert apart.place < 2 * apart.stated + (COULOMB if rubbing else 1e-9)
