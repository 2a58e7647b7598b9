"""Superposition, and what one model or machine becomes of another in a limit, at its order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from gbeam import (
    Beam,
    Centrifuge,
    Flight,
    Hub,
    Model,
    Sine,
    assemble,
    constant,
    simulate,
    solve_equilibrium,
    trapezoid,
)
from gbeam.results import Base

from .strategies import EXACT, beams, few, first_frequency, frequencies, numbers, theorem, vectors


@pytest.mark.parametrize("integrator", ["newmark", "gauss"])
@few
@given(beam=beams(bodies=False), shares=vectors(2.0, 2))
def test_superposition(integrator: str, beam: Beam, shares: np.ndarray) -> None:
    """Coordinates of a linear model under two loads across the beam are the sum of those under each share of them.

    A body off the axis would turn a load across the beam into a stiffness, as a load along the beam is one.
    """
    structure, period = assemble(beam, Model("FOAM", 1, 2, 2)), 2 * np.pi / first_frequency(beam)

    def run(first: float, second: float) -> np.ndarray:
        # All have the same corners, and with them the same steps.
        ramp = trapezoid(8.0 * second, jerk=abs(8.0 * second) / period, start=0.3 * period, hold=period)
        flight = Flight(y=Sine(5.0 * first, 1.3 * period), z=ramp)
        return simulate(
            structure, flight, duration=3 * period, step=period / 40, integrator=integrator, estimate=False
        ).q

    a, b = shares + np.where(shares < 0, -0.1, 0.1)
    both, one, other = run(a + 0.7, b + 2.5), run(a, b), run(0.7, 2.5)
    np.testing.assert_allclose(both, one + other, atol=1e-11 * np.abs(one).max(), rtol=0)


@few
@given(beam=beams(bodies=False, taper=False), way=numbers(0.0, 6.0), size=numbers(0.03, 0.06))
def test_exact_leaves_foam_with_the_third_power(beam: Beam, way: float, size: float) -> None:
    """Half the load, an eighth of the difference across the beam."""
    s, m = beam.section.at(0.0), beam.material
    level = size * 8 * m.youngs_modulus * s.inertia_y / (m.density * s.area * beam.length**3)
    load = level * np.array([0.0, np.cos(way), np.sin(way)])
    exact, foam = (assemble(beam, Model(kind, *EXACT)) for kind in ("exact", "FOAM"))
    # Each to its own shapes: the difference at an infinitesimal load is that of the shapes, and is taken off.
    o = np.zeros(3)

    def gap(share: float) -> np.ndarray:
        one, other = (x.displacement(solve_equilibrium(x, Base(share * load, o, o)).q)[-1, 1:] for x in (exact, foam))
        return one - other

    none = gap(1e-3) / 1e-3
    whole, half = (np.linalg.norm(gap(share) - share * none) for share in (1.0, 0.5))
    assert np.log2(whole / half) == pytest.approx(3.0, abs=0.06)


@theorem
@given(beam=beams(), radius=numbers(0.0, 1.0), setting=numbers(-1.5, 1.5))
def test_foam_leaves_tlam_with_the_square_of_the_rate(beam: Beam, radius: float, setting: float) -> None:
    """ω² of the first mode and the deflection under a load: half the rate, a quarter of the difference."""
    foam, tlam = (assemble(beam, Model(kind, 1, 2, 2)) for kind in ("FOAM", "TLAM"))
    scale = first_frequency(beam)

    def gap(rate: float) -> float:
        hub = Hub(radius=radius * beam.length, rate=constant(rate), setting_angle=setting)
        a, b = (frequencies(x, hub, gyroscopic=False)[0] for x in (foam, tlam))
        return float(a**2 - b**2)

    whole, half = gap(0.02 * scale), gap(0.01 * scale)
    assert whole > 0  # it stiffens
    assert np.log2(whole / half) == pytest.approx(2.0, abs=0.01)


@theorem
@given(beam=beams(), level=numbers(10.0, 60.0), share=numbers(0.0, 1.0), side=numbers(0.0, 6.0))
def test_a_long_arm_is_a_flight(beam: Beam, level: float, share: float, side: float) -> None:
    """Ten times the arm, a tenth of the difference: at zero rates the centrifuge is the flight."""
    structure = assemble(beam, Model("FOAM", 1, 2, 2))
    flight = Flight(x=0.3 * level, y=level * np.cos(side), z=level * np.sin(side))

    def gap(arm: float) -> float:
        machine = Centrifuge(flight, arm=arm, control_point=share * beam.length, inverse="flat", gravity=False,
                             span=(0.0, 1.0))  # fmt: skip
        at_rest = (solve_equilibrium(structure, motion.base(0.5)) for motion in (machine, flight))
        one, other = (structure.tip(each.q) for each in at_rest)
        # On the machine the specimen is turned about its axis by axis 3 until the load is along its own axes.
        return float(np.linalg.norm(one - other) / np.linalg.norm(other))

    near, far = gap(1e3 * beam.length), gap(1e4 * beam.length)
    assert near < 0.1
    assert far == pytest.approx(near / 10, rel=0.02)


@theorem
@given(level=vectors(30.0), at=numbers(0.0, 1.0))
def test_a_control_point_at_the_root_feels_the_flights_load_alone(level: np.ndarray, at: float) -> None:
    """At the control point itself the machine's load is the flight's, whatever the arm."""
    load = level + np.where(level < 0, -12.0, 12.0)
    flight = Flight(x=load[0], y=load[1], z=load[2])
    machine = Centrifuge(flight, arm=3.3, control_point=0.0, inverse="flat", gravity=False, span=(0.0, 1.0))
    np.testing.assert_allclose(machine.base(np.array(at)).a_WO_B, load, atol=1e-9 * np.linalg.norm(load))
