"""The beam's axis for pictures."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from gbeam import Flight, Hub
from gbeam.analysis import TIMES, outline_of

from ..specimens import BODY, LENGTH, laden, states
from .helpers import strip

ROLL = gb.constant(np.array([0.5, 0.0, 0.0]))


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "exact"])
def test_outline_ends_where_the_tip_is_and_begins_at_the_root(kind: str) -> None:
    structure, time = laden(kind), np.linspace(0, 1, 7)
    q = states(structure.size, 7, 1e-3, 1)
    outline = outline_of(structure, Hub(radius=0.5), time, q)
    assert outline is not None
    assert outline.points[[0, -1]] == pytest.approx([0, LENGTH]) and (np.diff(outline.points) > 0).all()
    tip = structure.displacement(q)[:, -1]  # without what is of third order
    np.testing.assert_allclose(outline.displacement[:, -1], tip, rtol=1e-5)
    # The root's springs are the last coordinates: along x, along z, about y and z.
    root = np.stack([q[:, -4], np.zeros(7), q[:, -3]], axis=1)
    np.testing.assert_allclose(outline.displacement[:, 0], root, atol=1e-3 * np.abs(outline.displacement).max())
    assert [BODY.at, BODY.mass] in outline.bodies.tolist() and outline.radius == 0.5


def test_outline_of_a_long_run_has_its_first_and_last_time() -> None:
    structure, time = strip(), np.linspace(0, 9, 4 * TIMES)
    outline = outline_of(structure, Flight(z=1.0), time, states(structure.size, len(time), 1e-4, 2))
    assert outline is not None
    assert len(outline.time) == TIMES and outline.time[[0, -1]].tolist() == [0, 9]
    assert not outline.displacement[:, 0].any() and np.isnan(outline.radius)
    np.testing.assert_allclose([outline.width, outline.thickness], [[0.02] * 16, [0.004] * 16])


def test_axes_turn_in_flight_where_its_rates_are_given() -> None:
    structure, time = strip(), np.linspace(0, 2, 41)
    q = states(structure.size, len(time), 1e-4, 2)
    still, turning = (outline_of(structure, flight, time, q) for flight in (Flight(z=1.0), Flight(z=1.0, rates=ROLL)))
    assert still is not None and still.attitude is None
    assert turning is not None and turning.attitude is not None
    angle = 0.25 * time  # half of a roll at 0.5 rad/s
    np.testing.assert_allclose(turning.attitude[:, :2], np.stack([np.cos(angle), np.sin(angle)], axis=1), atol=1e-12)
    assert not turning.attitude[:, 2:].any()
