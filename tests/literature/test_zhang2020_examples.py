"""Zhang 2020, section 4: its four examples, each figure with what is printed, what we find, and the verdict.

Errata that matter here (all, with the equations: validation/published/zhang2020.py): the control point lies at the
intersection of axes 2 and 3 (1 and 2 are parallel); arm radius, gravity, inverse kinematics, corner shape, time step,
spin-up and the load profiles of examples 2 and 3 are not stated; sentence (4) of section 4.4 repeats
"flight/centrifugal" wrongly; the model has no damping, so that the vibration of every corner persists; a control point
that is "always consistent" is impossible at a sharp corner.

| figure | printed | ours | verdict |
|---|---|---|---|
| ex. 1, tip excess on the centrifuge, 6 g | 0.02 % | 0.0202 % | reproduced with R = 3.3 m, which follows from it |
| ex. 2, static tip, 6 g plateau | - | 1.7243 mm | agrees with Euler-Bernoulli; profile unreadable |
| ex. 3, largest tip, centrifuge/flight | 3.136/3.148 mm | - | profile unknown: only the ratio's size can be judged |
| ex. 4, static tip in flight, 10 g | 2.875 mm | 2.8738 mm | -0.04 %, unexplained |
| ex. 4, static tip on the centrifuge | 2.876 mm | 2.8748 mm | -0.04 % |
| ex. 4, vibration at 4, 8, 10 g/s | 0.083, 0.170, 0.215 mm | 0.0831, 0.1700, 0.2144 mm | kernel fitted: consistent |
| the same, as the example runs it | 0.083, 0.170, 0.215 mm | 0.0838, 0.1757, 0.2108 mm | and what leaves idle |
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from jerk_study import jerk_study

from gbeam import (
    Beam,
    Centrifuge,
    Flight,
    Material,
    Model,
    Section,
    Structure,
    assemble,
    read_scenario,
    simulate,
    static,
)

G, ARM, KERNEL = 9.81, 3.3, 0.0596
PRINTED = {4: 0.083, 8: 0.170, 10: 0.215}  # mm by g/s, Table 2
EXAMPLE = Path(__file__).parents[2] / "examples" / "zhang2020_example4.toml"


@cache
def specimen() -> Structure:
    return assemble(
        Beam(0.3, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9), damping_ratio=0.0), Model("FOAM", 1, 3, 3)
    )


def tip(motion: Flight | Centrifuge) -> float:
    """Along z, m."""
    return float(abs(static(specimen(), motion, time=0.5).tip[2]))


def flight(level: float) -> float:
    return tip(Flight(z=level * G))


def centrifuge(level: float) -> float:
    return tip(
        Centrifuge(Flight(z=level * G), arm=ARM, control_point=0.15, inverse="flat", gravity=False, span=(0.0, 1.0))
    )


def test_example_1_constant_6_g() -> None:
    assert centrifuge(6) / flight(6) - 1 == pytest.approx(0.0002, abs=0.00005)  # printed 0.02 %


def test_example_2_plateau_of_6_g() -> None:
    assert flight(6) == pytest.approx(1.724291e-3, abs=1e-9)


def test_example_3_differs_by_less_than_half_a_percent() -> None:
    """Printed 3.136 and 3.148 mm, 0.38 % apart: of the size of the corner vibration on a plateau of some 11 g."""
    assert abs(3.136 / 3.148 - 1) < 0.005
    level = 3.148e-3 / flight(1)
    assert 10.9 < level < 11.0  # g: the largest load that example 3 must have held


def test_example_4_static() -> None:
    assert flight(10) == pytest.approx(2.875e-3, rel=5e-4)
    assert centrifuge(10) == pytest.approx(2.876e-3, rel=5e-4)


def test_example_4_vibration() -> None:
    study = jerk_study(specimen(), [4 * G, 8 * G, 10 * G], [ARM], law="flat", level=10 * G, smoothing=KERNEL)
    np.testing.assert_allclose(1e3 * study.simulated[:, 0], list(PRINTED.values()), rtol=0.003)


@pytest.mark.parametrize(("jerk", "idle", "swing"), [(4, 8, 0.0838), (8, 8, 0.1757), (10, 8, 0.2108), (8, 3, 0.3189)])
def test_example_4_swings_by_its_corner_alone(jerk: int, idle: int, swing: float) -> None:
    """Swings are those that the file states, within 4 % of Table 2; leaving 3 g adds a vibration that nothing damps."""
    changes = {"motion.flight.acceleration.z.jerk": f"{jerk} g/s", "motion.centrifuge.idle": f"{idle} g"}
    shorter = {"response.duration": "4.5 s", "response.step": "1 ms", "response.estimate": "false"}
    case = read_scenario(EXAMPLE, [f"{key}={value}" for key, value in (changes | shorter).items()])
    run = simulate(case.subject, case.motions["centrifuge"], case.over_time)
    plateau = 1 + 10 / jerk + KERNEL
    swings = 1e3 * np.ptp(run.tip[(run.time > plateau) & (run.time < plateau + 0.9), 2]) / 2
    assert swings == pytest.approx(swing, rel=0.004)
    assert (abs(swings / PRINTED[jerk] - 1) < 0.04) == (idle == 8)
