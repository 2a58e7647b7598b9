"""The pictures of the README and the first tutorial show what gbeam computes: docs/pictures.py."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import gbeam as gb

DOCS = Path(__file__).parents[2] / "docs"
sys.path.insert(0, str(DOCS))
import pictures  # type: ignore[import-not-found, unused-ignore]  # noqa: E402

LARGEST = 1.5e6  # bytes of the moving picture


@pytest.fixture(scope="module")
def plan() -> gb.MachinePlan:
    case = gb.read_scenario(pictures.EXAMPLE)
    return gb.plan("centrifuge", case.motions["centrifuge"], "flight")


def test_the_machine_is_drawn_as_it_turns_the_specimen(plan: gb.MachinePlan) -> None:
    """By the attitude of the picture: ω² r towards the axis and gravity upwards, while the arm turns evenly."""
    axes = plan.axes
    steady = (plan.time > 6) & (plan.time < 9)
    assert np.abs(axes.acceleration[steady, 0]).max() < 0.2
    for i in np.flatnonzero(steady)[::100]:
        out, turned = pictures.attitude(axes.angle[i])
        np.testing.assert_allclose(turned.T @ turned, np.eye(3), atol=1e-12)
        felt = -axes.arm * axes.rate[i, 0] ** 2 * out + [0, 0, pictures.G]
        np.testing.assert_allclose(turned.T @ felt, axes.actual[i], atol=0.01 * np.linalg.norm(felt))


def test_bars_are_the_limits_of_the_plan(plan: gb.MachinePlan) -> None:
    (axes,) = pictures.limits(SimpleNamespace(responses={"centrifuge": plan})).axes
    finite = [use for use in plan.axes.limits if np.isfinite(use.allowed)]
    assert [bar.get_width() for bar in axes.patches] == pytest.approx([100 * use.share for use in finite])
    assert [each.get_text() for each in axes.get_yticklabels()] == [f"{use.axis} {use.quantity}" for use in finite]


def test_the_moving_picture_is_small() -> None:
    assert 1e4 < (DOCS / "f16.gif").stat().st_size < LARGEST
