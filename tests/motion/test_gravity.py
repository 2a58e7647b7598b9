"""Gravity on the machine and in the record: neither is missing without a warning, nor there twice."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gbeam as gb

F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
STRUCTURE = gb.assemble(
    gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01), "FOAM", z=1
)


def machine(*, gravity: bool, quantity: str = "specific-force") -> gb.Centrifuge:
    record = gb.read_record(
        F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g", quantity=quantity, span=(4.5, 6.0),  # type: ignore[arg-type]
    )  # fmt: skip
    flight = gb.Flight(acceleration=gb.smoothed(record, 0.05))
    return gb.Centrifuge(
        flight, arm=3.3, control_point=0.2, inverse="quasi-static", gravity=gravity, smoothing=0.1, span=(4.5, 6.0)
    )


def test_the_commands_of_a_machine_without_gravity_miss_the_flight_by_1_g() -> None:
    without = machine(gravity=False)
    (warning,) = (each for each in gb.plan("spin", without).warnings if "gravity" in each)
    assert warning.startswith("motion.spin.gravity is false, and the record of its flight holds specific force")
    settings = gb.ResponseSettings(start=4.5, duration=1.5, step=2e-3, estimate=False)
    assert any("feels 1 g more" in each for each in gb.simulate(STRUCTURE, without, settings).warnings)
    # What the same axis motions make on the earth.
    time = np.linspace(4.6, 5.9, 50)
    on_earth = machine(gravity=True)
    felt = on_earth.actual_by(without.axes(time))
    np.testing.assert_allclose(np.linalg.norm(felt - without.actual(time), axis=1), 9.80665)
    for right in (on_earth, machine(gravity=False, quantity="acceleration")):
        assert not any("gravity" in each for each in gb.plan("spin", right).warnings)


def test_gravity_is_no_part_of_an_acceleration() -> None:
    with pytest.raises(gb.InputError, match="gravity is true, and the record of its flight holds acceleration"):
        machine(gravity=True, quantity="acceleration")
