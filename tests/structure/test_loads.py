"""Forces and moments on the beam: the classics of large deflection, stability, and loads over time."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import gbeam as gb
from gbeam.results import Base
from validation.published.specimens import PLANAR
from validation.published.tables import ELASTICA

from ..differences import rate
from ..residuals import on_base, virtual_work
from ..specimens import laden, states

STILL = Base(*np.zeros((3, 3)))
LARGE = gb.Model("exact", *PLANAR)  # all large deflections in one size


def beam(length: float, bending: float, *loads: gb.Load, axial: float = 1.0, **options: Any) -> gb.Beam:
    """A beam of unit density and modulus: EI and EA are its section's."""
    return gb.Beam(
        length,
        gb.Section.general(axial, bending, bending),
        gb.Material(1.0, 1.0),
        damping_ratio=0.0,
        loads=loads,
        **{"rotary_inertia": False, **options},
    )


def test_elastica_table() -> None:
    for force, wanted in ELASTICA.items():
        structure = gb.assemble(beam(1.0, 1.0, gb.Load(1.0, force=(0, force, 0)), axial=1e9), LARGE)
        q = gb.solve_equilibrium(structure, STILL).q
        assert structure.field is not None
        moved, tangent = structure.displacement(q)[-1], structure.field.rotation(q)[-1][:, 0]
        actual = (-moved[0], moved[1], np.arctan2(tangent[1], tangent[0]))
        np.testing.assert_allclose(actual, wanted, atol=6e-7)


@pytest.mark.parametrize("follower", [False, True])
def test_roll_up_into_a_full_circle(follower: bool) -> None:
    moment = 2 * np.pi * 3.0 / 10
    structure = gb.assemble(beam(10.0, 3.0, gb.Load(10.0, moment=(0, 0, moment), follower=follower)), LARGE)
    moved = structure.displacement(gb.solve_equilibrium(structure, STILL).q)[-1]
    np.testing.assert_allclose(moved, [-10, 0, 0], atol=1e-11)


def test_geradin_and_cardonas_cantilever_but_for_its_shear() -> None:
    """Published with GA = 3.231e8 N: −2.1597 and −0.59647 m; without shear 0.27 % and 0.43 % less."""
    structure = gb.assemble(beam(5.0, 9.346e6, gb.Load(5.0, force=(0, -6e5, 0)), axial=4.8e8), LARGE)
    moved = structure.displacement(gb.solve_equilibrium(structure, STILL).q)[-1]
    np.testing.assert_allclose(moved, [-0.593880, -2.153761, 0], atol=2e-6)
    # Timoshenko's shear adds F L/GA = 9.3 mm where the beam is straight, and less where it has turned.
    assert 0.5 < (2.1597 + float(moved[1])) / (6e5 * 5 / 3.231e8) < 1


@pytest.mark.parametrize("kind", ["CFOAM", "exact"])
def test_generalised_forces_are_the_virtual_work(kind: str) -> None:
    """F·δr + M·δθ by differentiating the points and their rotations, root springs included."""
    structure = laden(kind)
    (q, none), base = states(structure.size, 2, 0.2, seed=5) * [[1], [0]], Base(*np.zeros((3, 3)))
    free, loaded = (on_base(structure, q, none, none, base, loaded=on) for on in (False, True))
    np.testing.assert_allclose(free - loaded, virtual_work(structure, q)[6:], atol=1e-8)


def _unit_thrust(k: int) -> np.ndarray:
    """Components of two loads of which the k-th pushes along −x by 1 N."""
    values = np.zeros((2, 6))
    values[k, 0] = -1.0
    return values


@cache
def stiffness() -> tuple[np.ndarray, ...]:
    """M, K and what K loses under a dead and under a following unit thrust, of FOAM."""
    thrusts = [gb.Load(1.0, force=(-1.0, 0.0, 0.0), follower=follower) for follower in (False, True)]
    structure = gb.assemble(beam(1.0, 1.0, *thrusts), gb.Model("FOAM", 0, 0, 8)).coefficients
    o, free = np.zeros(3), structure.stiffness
    under = [structure.evaluate(o, o, o, _unit_thrust(k))[1] for k in (0, 1)]
    return tuple(np.asarray(m) for m in (structure.mass, free, free - under[0], free - under[1]))


def test_a_dead_thrust_buckles_at_eulers_load() -> None:
    _, free, dead, _ = stiffness()
    critical = 1 / scipy.linalg.eigvals(dead, free).real.max()
    assert critical == pytest.approx(np.pi**2 / 4, rel=2e-4)


def test_a_following_thrust_flutters_at_becks_load() -> None:
    mass, free, _, following = stiffness()

    def flutters(force: float) -> bool:
        return bool(np.abs(scipy.linalg.eigvals(free - force * following, mass).imag).max() > 1e-6)

    assert not flutters(20.04) and flutters(20.07)  # Beck 1952: 20.05


@pytest.mark.parametrize(
    "model",
    [gb.Model("FOAM", 0, 0, 2), pytest.param(gb.Model("exact", 0, 0, 2), marks=pytest.mark.slow)],
    ids=["FOAM", "exact"],
)
def test_a_spread_load_over_time_is_an_acceleration_of_the_base(model: gb.Model) -> None:
    """ρA = 1: the force per length −a(t) and the base's acceleration a(t) are one load."""
    pulse = gb.vector(z=gb.trapezoid(0.4, jerk=2.0, start=0.1, hold=0.5))
    counter = gb.vector(z=gb.trapezoid(-0.4, jerk=2.0, start=0.1, hold=0.5))
    settings = gb.ResponseSettings(1.5, step=0.005)
    none = gb.Load(distributed=gb.vector(z=gb.constant(0.0)))  # of the same sizes
    moving = gb.simulate(gb.assemble(beam(1.0, 1.0, none), model), gb.Flight(acceleration=pulse), settings)
    pushed = gb.simulate(
        gb.assemble(beam(1.0, 1.0, gb.Load(distributed=counter)), model), gb.Flight(acceleration=gb.vector()), settings
    )
    np.testing.assert_allclose(pushed.tip, moving.tip, atol=1e-9 * np.abs(moving.tip).max())


def test_equilibrium_takes_the_loads_at_its_time() -> None:
    structure = gb.assemble(
        beam(1.0, 1.0, gb.Load(1.0, force=gb.vector(z=gb.SmoothStep(3e-3, 2.0)))), gb.Model("FOAM", 0, 0, 2, "adapted")
    )
    tips = [float(structure.displacement(gb.solve_equilibrium(structure, STILL, t).q)[-1, 2]) for t in (0.0, 1.0, 2.0)]
    np.testing.assert_allclose(tips, [0.0, 0.5e-3, 1e-3], rtol=0.05, atol=1e-12)
    frozen = structure.at_time(2.0)
    np.testing.assert_allclose(frozen.displacement(gb.solve_equilibrium(frozen, STILL).q)[-1, 2], tips[2])


def test_truncated_work_is_the_first_order_of_the_complete_one() -> None:
    loads = [gb.Load(1.0, (1.0, 2.0, 3.0), (0.4, 0.5, 0.6)), gb.Load(distributed=(0.2, 0.3, 0.4), follower=True)]
    full = gb.assemble(beam(1.0, 1.0, *loads), gb.Model("CFOAM", 1, 2, 2))
    q = np.random.default_rng(1).normal(size=5)
    value, slope = virtual_work(full, 0 * q), rate(lambda t: virtual_work(full, t * q))
    assert full.coefficients.loads is not None
    np.testing.assert_allclose(full.coefficients.loads.generalised(q, full.load_values), value + slope, atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"at": 1.0}, "has neither force nor moment"),
        ({"at": -1.0, "force": (0, 0, 1)}, "at is -1 m"),
        ({"at": 1.0, "force": (0, 1)}, r"force is \(0, 1\)"),
    ],
)
def test_impossible_loads_are_refused(wrong: dict[str, Any], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        gb.Load(**wrong)


def test_a_load_beyond_the_tip_is_refused() -> None:
    with pytest.raises(gb.InputError, match=r"loads\[0\].at is 2 m, beyond the tip"):
        beam(1.0, 1.0, gb.Load(2.0, force=(0, 0, 1)))
