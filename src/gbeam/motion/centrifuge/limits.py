"""Limits of a centrifuge's axes, example machines, and how a motion begins and ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, get_args

import numpy as np

from gbeam.arrays.tree import assign, record
from gbeam.arrays.types import Floats
from gbeam.constants import STANDARD_GRAVITY, MachineName, Start
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, positive
from gbeam.guards.quantities import Quantity
from gbeam.results.machine import LimitUse

QUANTITIES = {"rate": "rad/s", "acceleration": "rad/s^2", "jerk": "rad/s^3"}


@typed
@dataclass(frozen=True)
class AxisLimit:
    """Limits of one axis of a centrifuge.

    Examples
    --------
    >>> gb.AxisLimit(rate=7.0, acceleration=10.0)
    AxisLimit(rate=7.0, acceleration=10.0, jerk=None)
    """

    rate: Annotated[Annotated[float, Quantity("angular rate", "positive")] | None, "largest rate, of either sign"] = (
        None
    )
    acceleration: Annotated[
        Annotated[float, Quantity("angular acceleration", "positive")] | None, "largest acceleration, of either sign"
    ] = None
    jerk: Annotated[Annotated[float, Quantity("angular jerk", "positive")] | None, "largest jerk, of either sign"] = (
        None
    )


@typed
@dataclass(frozen=True)
class MachineLimits:
    """Limits of a three-axis centrifuge as a person gives them. Exceeding one ends in exit status 1 unless allowed.

    Examples
    --------
    >>> limits = gb.MachineLimits(axis1=gb.AxisLimit(rate=7.0), inertia=2000.0, power=30e3)
    >>> limits.power
    30000.0
    """

    axis1: Annotated[AxisLimit, "the arm: { rate, acceleration, jerk }"] = field(default_factory=AxisLimit)
    axis2: Annotated[AxisLimit, "yaw at the arm's end: { rate, acceleration, jerk }"] = field(default_factory=AxisLimit)
    axis3: Annotated[AxisLimit, "roll about the beam: { rate, acceleration, jerk }"] = field(default_factory=AxisLimit)
    inertia: Annotated[
        Annotated[float, Quantity("moment of inertia", "positive")] | None,
        "moment of inertia of all that turns about axis 1; gives the arm's power",
    ] = None
    power: Annotated[
        Annotated[float, Quantity("power", "positive")] | None,
        "largest power that speeds the arm up or brakes it, J ω1 dω1/dt without friction and drag; needs inertia",
    ] = None

    def completed(self, example: MachineLimits) -> MachineLimits:
        """Limits in which those that are not known are those of an `example`."""
        axes = {f"axis{k}": _completed(axis, example.axes[k - 1]) for k, axis in enumerate(self.axes, start=1)}
        return replace(_completed(self, example), **axes)

    @property
    def axes(self) -> tuple[AxisLimit, AxisLimit, AxisLimit]:
        """Limits of the three axes."""
        return self.axis1, self.axis2, self.axis3


def _completed(limits: Any, example: Any) -> Any:
    """Limits with those of an example that are None in them."""
    return replace(limits, **{name: getattr(example, name) for name, value in vars(limits).items() if value is None})


@record
class Limits:
    """Limits as arrays: infinite where nothing is given."""

    axes: Any  # (3, 3): of rate, acceleration, jerk (rows) of axes 1, 2, 3 (columns)
    inertia: Any  # kg m²; zero if not given
    power: Any  # W

    def __init__(self, limits: MachineLimits | None = None) -> None:
        """Collect the limits in arrays, with infinity for those that are not given."""
        machine = MachineLimits() if limits is None else limits
        if machine.power is not None and machine.inertia is None:
            raise InputError("limits.power", "is given without the inertia", 'add inertia = "2000 kg m^2" of the arm')

        def limit(value: float | None) -> float:
            return np.inf if value is None else float(value)

        assign(
            self,
            axes=np.asarray([[limit(getattr(axis, name)) for axis in machine.axes] for name in QUANTITIES]),
            inertia=np.asarray(0.0 if machine.inertia is None else float(machine.inertia)),
            power=np.asarray(limit(machine.power)),
        )


def usage(
    time: Floats,
    rate: Floats,
    acceleration: Floats,
    jerk: Floats,
    limits: Limits,
) -> tuple[LimitUse, ...]:
    """Return the use of each limit by a motion at times (n,) s.

    `rate`, `acceleration` and `jerk` (n, 3) are those of the three axes, in rad/s and its derivatives.
    """
    allowed = np.asarray(limits.axes)
    quantities = list(zip(QUANTITIES, QUANTITIES.values(), (rate, acceleration, jerk), strict=True))
    uses = [
        _use(f"axis {axis + 1}", name, unit, time, values[:, axis], float(allowed[row, axis]))
        for axis in range(3)
        for row, (name, unit, values) in enumerate(quantities)
    ]
    if limits.inertia > 0:
        power = float(limits.inertia) * rate[:, 0] * acceleration[:, 0]
        uses.append(_use("arm", "power", "W", time, power, float(limits.power)))
    return tuple(uses)


def _use(axis: str, quantity: str, unit: str, time: Floats, values: Floats, allowed: float) -> LimitUse:
    size = np.abs(values)
    peak = int(np.argmax(size))
    return LimitUse(axis, quantity, unit, float(size[peak]), allowed, float(time[peak]))


def exceeded(uses: Sequence[LimitUse]) -> tuple[LimitUse, ...]:
    """Uses above the limits."""
    return tuple(use for use in uses if use.exceeded)


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
        Load at which it idles, the least load of a target, m/s².
    source : str
        Where the numbers come from.
    """

    arm: float
    limits: MachineLimits
    idle: float
    source: str


def _example(arm: float, load_g0: float, onset_g0_per_s: float, gimbal: AxisLimit, source: str) -> Machine:
    """Limits from a load and its onset: R ω² = a, dω/dt = j / (2 sqrt(R a)) at 1.5 g0, and jerk to it in 0.1 s."""
    rate = np.sqrt(load_g0 * STANDARD_GRAVITY / arm)
    acceleration = onset_g0_per_s * STANDARD_GRAVITY / (2 * np.sqrt(arm * 1.5 * STANDARD_GRAVITY))
    first = AxisLimit(float(rate), float(acceleration), float(10 * acceleration))
    return Machine(arm, MachineLimits(first, gimbal, gimbal), _IDLE, source)


machines: dict[MachineName, Machine] = {
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


STARTS = get_args(Start)


@dataclass(frozen=True)
class Ends:
    """Beginning and end of a centrifuge's motion, before the flight's first time and after its last: see Centrifuge."""

    start: Start = "rest"
    spin_up: float | None = None  # from standstill to the flight's first time, s; None: found within the limits
    spin_down: float | None = None  # from its last time to standstill, likewise

    def __post_init__(self) -> None:
        """Refuse a spin-up or spin-down of a machine that starts at idle, and read the durations in seconds."""
        choice("start", self.start, STARTS)
        for name in ("spin_up", "spin_down"):
            duration = getattr(self, name)
            if duration is None:
                continue
            if self.start == "idle":
                raise InputError(name, "does not go with start = idle", f'leave it out, or give start = "{STARTS[0]}"')
            object.__setattr__(self, name, float(positive(name, duration, "s")))
