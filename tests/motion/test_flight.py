"""Flight: translation only."""

import numpy as np

from gbeam.motion import Flight, trapezoid


def test_flight_is_its_load_without_rotation() -> None:
    flight = Flight(z=trapezoid(98.0, jerk=40.0, start=1.0, hold=4.0))
    t = np.linspace(0, 12, 25)
    base = flight.base(t)
    np.testing.assert_allclose(base.a_WO_B, flight.acceleration(t))
    assert not np.any(base.w_WB_B) and not np.any(base.alpha_WB_B) and base.w_WB_B.shape == (25, 3)
    assert flight.base(2.0).a_WO_B.shape == (3,)
    assert flight.breaks.size == 6
