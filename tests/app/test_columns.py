"""Columns of a record suggested by their names and units, or not at all."""

from __future__ import annotations

import pytest

from gbeam.app import suggested

NONE: dict[str, str] = {}


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        (
            "time_s n_x_g n_y_g n_z_g p_rad_s q_rad_s r_rad_s alpha_deg mach",
            "time=time_s time_unit=s x=n_x_g y=n_y_g z=n_z_g unit=g p=p_rad_s q=q_rad_s r=r_rad_s rate_unit=rad/s",
        ),
        ("t ax ay az", "time=t x=ax y=ay z=az"),  # in g or in m/s²: not said
        ("Time_ms Nz_g", "time=Time_ms time_unit=ms z=Nz_g unit=g"),
        ("Zeit N_z", "time=Zeit z=N_z unit=g"),  # a load factor has no dimension
        ("t a_z_m_s2 a_x_m_s2", "time=t x=a_x_m_s2 z=a_z_m_s2 unit=m/s^2"),
        ("t AccZ_mps2 zAccel", "time=t"),  # two of z
        ("t az nz nx", "time=t"),  # two records in one: x of which?
        ("t time az", "z=az"),
        ("rec.t rec.az IMU/acc_x", "time=rec.t z=rec.az x=IMU/acc_x"),
        ("t p q", "time=t"),  # of three rates two
        ("t rollrate pitch_rate Yaw_Rate_deg_s", "time=t"),  # in which unit are two of them?
        ("frame_time_ms fz Fz_N gz speed_x N_z_down", ""),
    ],
)
def test_names_say_what_they_hold(columns: str, expected: str) -> None:
    assert suggested((name, "") for name in columns.split()) == dict(each.split("=", 1) for each in expected.split())


def test_units_that_a_file_states_decide() -> None:
    axes = [(f"Acceleration {axis} [g]", "g") for axis in "XYZ"]
    named = dict(zip("xyz", (name for name, _ in axes), strict=True))
    answer = suggested([("Time [ms]", "ms"), *axes])
    assert answer == {"time": "Time [ms]", "time_unit": "ms", "unit": "g", **named}
    assert suggested([("p", "Pa"), ("q", "°/s"), ("r", "°/s"), ("az", "N")]) == {}
    assert suggested([("p", "°/s"), ("q", "°/s"), ("r", "deg/s")]) == {
        "p": "p",
        "q": "q",
        "r": "r",
        "rate_unit": "deg/s",
    }
    assert suggested([("ax", "g"), ("az", "m/s²")]) == {}  # one of them is wrong
