"""A specimen that sits another way round in the machine: the same load, by other axis motions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.motion import shift_base
from gbeam.results import Base

LOAD = gb.Sum((gb.constant(20.0), gb.trapezoid(30.0, jerk=25.0, start=1.0, hold=2.0)))
TURN = gb.Flight(x=gb.trapezoid(15.0, jerk=20.0, start=0.5, hold=1.5), y=gb.constant(12.0), z=LOAD)
TIMES = np.linspace(0.0, 7.0, 701)
OPTIONS: dict[str, Any] = {"arm": 3.3, "inverse": "exact", "gravity": True, "smoothing": 0.1, "span": (0.0, 7.0)}


def bases(**more: Any) -> Any:
    return gb.Centrifuge(TURN, **{"control_point": 0.2, **OPTIONS, **more}).base(TIMES)


def same(one: Base, other: Base, tolerance: float) -> None:
    for name in ("a_WO_B", "w_WB_B", "alpha_WB_B"):
        a, b = getattr(one, name), getattr(other, name)
        np.testing.assert_allclose(a, b, atol=tolerance * np.abs(b).max(), err_msg=name)


def test_half_a_turn_about_z_is_the_other_mounting_and_a_roll_changes_nothing() -> None:
    """Yaw by half a turn with the roll reversed takes the module's axes to their opposite but for the third."""
    same(bases(turn=(0, 0, np.pi)), bases(mounting="inverted"), 1e-9)
    same(bases(turn=(0.7, 0, 0)), bases(), 1e-9)
    away = np.linalg.norm(bases(turn=(0, 0, np.pi / 2)).w_WB_B - bases().w_WB_B, axis=1)
    assert away.max() > 0.1 * np.linalg.norm(bases().w_WB_B, axis=1).max()


@pytest.mark.parametrize("turn", [(0.0, 0.0, -np.pi / 2), (0.0, np.pi / 3, 0.0), (0.4, -0.8, 0.3)])
def test_the_control_point_feels_the_flight_whichever_way_round(turn: tuple[float, float, float]) -> None:
    place = np.array([0.02, -0.03, 0.05])
    machine = gb.Centrifuge(TURN, **OPTIONS, control_point=place, turn=turn)
    base = shift_base(machine.base(TIMES), place)
    followed = ~machine.not_followed(TIMES)
    flown = machine.reference(TIMES)
    np.testing.assert_allclose(base.a_WO_B[followed], flown[followed], atol=1e-5 * np.abs(flown).max())
    np.testing.assert_allclose(machine.actual(TIMES), base.a_WO_B, atol=1e-9)
    late = (TIMES > 3.0) & (TIMES < 3.1)  # the plateau: the target is the flight's own load there
    np.testing.assert_allclose(base.a_WO_B[late], TURN.base(TIMES[late]).a_WO_B, rtol=1e-6)
    again = machine.altered(smoothing=0.1)
    same(again.base(TIMES), machine.base(TIMES), 1e-12)


def test_bad_turns_are_refused() -> None:
    with pytest.raises(
        gb.InputError, match=r"loads the beam across by .*; of a specimen that is turned, the beam stands"
    ):
        gb.Centrifuge(gb.Flight(z=LOAD), **OPTIONS, control_point=0.0, turn=(0.0, np.pi / 2, 0.0))
    with pytest.raises(gb.InputError, match="turn"):
        bases(turn=(0.0, 1.0))
    with pytest.raises(gb.InputError, match="control_point"):
        bases(control_point=(0.0, np.nan, 0.0))
