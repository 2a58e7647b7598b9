"""Example machines, to plan with before the limits of one's own are at hand. They are no real machine's data sheet.

What is published is the arm and, roughly, the load and its onset; the gimbals' limits are assumed throughout, and
`source` says which is which.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion.centrifuge.machine.limits import AxisLimit, MachineLimits

_IDLE = 1.4 * STANDARD_GRAVITY  # the baseline from which human centrifuges start their profiles, assumed for all


@dataclass(frozen=True)
class Machine:
    """An example machine.

    Parameters
    ----------
    arm : float
        From axis 1 to the control point, m.
    limits : MachineLimits
    idle : float
        Load at which it idles, below which a target is held, m/s².
    source : str
        Where the numbers come from.
    """

    arm: float
    limits: MachineLimits
    idle: float
    source: str


def _example(arm: float, load_g0: float, onset_g0_per_s: float, gimbal: AxisLimit, source: str) -> Machine:
    """Arm limits from a load and its onset: R ω² = a, dω/dt = j / (2 sqrt(R a)) where it is largest, at 1.5 g0.

    The jerk lets the arm reach that acceleration in 0.1 s.
    """
    rate = np.sqrt(load_g0 * STANDARD_GRAVITY / arm)
    acceleration = onset_g0_per_s * STANDARD_GRAVITY / (2 * np.sqrt(arm * 1.5 * STANDARD_GRAVITY))
    first = AxisLimit(float(rate), float(acceleration), float(10 * acceleration))
    return Machine(arm, MachineLimits(first, gimbal, gimbal), _IDLE, source)


machines: dict[str, Machine] = {
    "human-7.6m": _example(
        7.6,
        12.0,
        6.0,
        AxisLimit(3.0, 10.0, 100.0),
        "EXAMPLE. Arm: 7.6 m (25 ft) with a dual-gimbal gondola, as flightglobal.com reports of the Phoenix centrifuge "
        "of the NASTAR Center. Load and onset, 12 g and 6 g/s, are assumed within the 3 to 30 g and 5 to 15 g/s that "
        "Aerospace 2023, 10(12), 1013 gives for human centrifuges. Gimbal limits: assumed",
    ),
    "specimen-3.3m": _example(
        3.3,
        20.0,
        30.0,
        AxisLimit(15.0, 150.0, 5000.0),
        "EXAMPLE. Arm: 3.3 m, what Zhang et al. 2020 imply by a 0.02 % difference at 6 g (not printed there). All "
        "limits: assumed, for a machine that carries an instrument and no person",
    ),
    "large-15m": _example(
        15.24,
        40.0,
        10.0,
        AxisLimit(3.0, 10.0, 100.0),
        "EXAMPLE. Arm: 50 ft, two gimbals, as Air & Space Magazine (The G Machine) describes the Johnsville "
        "centrifuge; load 40 g and onset 10 g/s as daviddarling.info states of it. Gimbal limits: assumed",
    ),
}
