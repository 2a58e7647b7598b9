"""A system in flight and on the centrifuge that imitates it: compared as one beam is, with the numbers of one body."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb

STRIP = gb.Beam(
    0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9, yield_strength=270e6), damping_ratio=0.01
)
LOAD = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
TURN = gb.Flight(z=LOAD)
MACHINE = gb.Centrifuge(TURN, arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0))
OPTIONS: dict[str, Any] = {"duration": 8.0, "step": 4e-3, "integrator": "gauss", "estimate": False}


def test_a_system_of_one_beam_compares_as_the_beam() -> None:
    structure = gb.assemble(STRIP, "exact", axial=0, y=1, z=2)
    system = gb.System({"strip": structure}, {"clamp": gb.Joint("fixed", "strip")})
    of_beam, of_system = (
        gb.compare(*(gb.simulate(each, motion, **OPTIONS) for motion in (TURN, MACHINE)), accept={"tip": 0.05})
        for each in (structure, system)
    )
    np.testing.assert_allclose(of_system.difference, of_beam.difference, atol=1e-7)
    assert of_system.root is not None and of_beam.root is not None
    for name in ("tip", "root_force", "root_moment", "stress"):
        one, other = of_system.peaks[name], of_beam.peaks[name]
        assert (one.flight, one.machine) == pytest.approx((other.flight, other.machine), rel=1e-4), name
    assert of_system.accepted is of_beam.accepted is True


def test_two_beams_on_a_rigid_body_are_flown_and_spun() -> None:
    """The root of all is the ground: its force is that of the whole mass, flown and spun."""
    structure = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=2)
    block = gb.RigidBody(0.5, (1e-3, 1e-3, 1e-3), points={"left": (0, 0.1, 0), "right": (0, -0.1, 0)})
    joints = {"bolts": gb.Joint("fixed", "block")} | {
        name: gb.Joint("fixed", name, f"block.{name}") for name in ("left", "right")
    }
    system = gb.System({"block": block, "left": structure, "right": structure}, joints)
    flight, spun = (gb.simulate(system, motion, **OPTIONS) for motion in (TURN, MACHINE))
    compared = gb.compare(flight, spun, point="left.tip")
    mass = 0.5 + 2 * 2700 * 0.3 * 0.02 * 0.004
    assert compared.peaks["root_force"].flight == pytest.approx(70.0 * mass, rel=0.02)
    assert 0 < compared.relative[2] < 0.1 and compared.root is not None
    largest = max(each.peaks.largest_stress.value for each in flight.beams.values())  # type: ignore[union-attr]
    assert compared.peaks["stress"].flight == pytest.approx(largest, rel=1e-3)
    assert compared.shock is not None
    control = gb.compare(flight, spun, point="left.tip", control={"left.tip": 1.0, "right.tip": 1.0}).shock
    assert control is not None and "right.tip" in control.control
    assert gb.compare(flight, spun).max_difference.shape == (3,)
    with pytest.raises(gb.InputError, match="choose from"):
        gb.compare(flight, spun, point="left.top")
    with pytest.raises(gb.InputError, match="a system and a beam"):
        gb.compare(flight, gb.simulate(structure, MACHINE, **OPTIONS))
