"""What an analysis returns: frozen records of arrays and words. No model, solver or callable inside."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gbeam.results.comparison import Comparison
from gbeam.results.section_forces import Influence, Loads

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BaseHistory:
    """Motion of the root over time, base axes.

    Parameters
    ----------
    a_WO_B : (t, 3)
        Acceleration of the root, m/s²; specific force a − g where gravity acts.
    w_WB_B, alpha_WB_B : (t, 3)
        Angular velocity rad/s and acceleration rad/s².
    """

    a_WO_B: Floats
    w_WB_B: Floats
    alpha_WB_B: Floats


@dataclass(frozen=True)
class HubResult:
    """A hub turning about z: angle rad, rate rad/s, acceleration rad/s², torque N m (NaN where the rate is given)."""

    angle: Floats
    rate: Floats
    acceleration: Floats
    torque: Floats


@dataclass(frozen=True)
class LimitUse:
    """How much of one of its limits a machine uses.

    Parameters
    ----------
    axis : str
        axis 1, axis 2, axis 3 or arm.
    quantity : str
        rate, acceleration, jerk or power.
    unit : str
        Of `used` and `allowed`.
    used : float
        Largest size.
    allowed : float
        Infinite where no limit is given.
    time : float
        When it is used, s.
    """

    axis: str
    quantity: str
    unit: str
    used: float
    allowed: float
    time: float

    @property
    def share(self) -> float:
        """Used over allowed; zero where no limit is given."""
        return self.used / self.allowed

    @property
    def exceeded(self) -> bool:
        """Whether more is used than allowed, beyond rounding."""
        return self.share > 1 + 1e-9

    def __str__(self) -> str:
        return (
            f"{self.axis} {self.quantity} {self.used:.4g} of {self.allowed:.4g} {self.unit} ({self.share:.0%}) "
            f"at {self.time:.3f} s"
        )


@dataclass(frozen=True)
class Shortfall:
    """A stretch of time in which a machine cannot make the load of the flight.

    Parameters
    ----------
    start, end : float
        s.
    reason : str
        below idle, below gravity, across below gravity, turns sharply.
    time : float
        When it is worst, s.
    reference, possible : float
        There: what the flight asks for, and the nearest that the machine can make.
    unit : str
        Of both.
    remedy : str
        The smallest change that would make it reachable.
    """

    start: float
    end: float
    reason: str
    time: float
    reference: float
    possible: float
    unit: str
    remedy: str

    def __str__(self) -> str:
        # A turn too sharp may yet be made: axis 2 pays for it.
        can = "is the most without a jerk of axis 2" if self.reason == "turns sharply" else "can be made"
        return (
            f"{self.start:.3f} to {self.end:.3f} s: {self.reason}, {self.reference:.3g} {self.unit} "
            f"at {self.time:.3f} s "
            f"where {self.possible:.3g} {self.unit} {can}; {self.remedy}"
        )


@dataclass(frozen=True)
class AxesResult:
    """A three-axis centrifuge over time.

    Parameters
    ----------
    angle, rate, acceleration : (t, 3)
        Of axes 1, 2, 3; rad, rad/s, rad/s².
    reference, actual : (t, 3)
        Load at the control point, base axes, m/s²: what was asked, and what the axes make.
    not_followed : (t,) bool
        Where the target is not the flight's load.
    episodes : tuple of (start s, end s, reason)
        The stretches of time in which it is not.
    limits : tuple of LimitUse
        Rate, acceleration and jerk of every axis, used and allowed.
    shortfalls : tuple of Shortfall
        Where the machine cannot make the flight's load, by how much, and what would help.
    control_point : float
        From the root along the beam, m.
    warnings : tuple of str
        Where the inverse does not keep what it promises, by how much and why.
    """

    angle: Floats
    rate: Floats
    acceleration: Floats
    reference: Floats
    actual: Floats
    not_followed: NDArray[np.bool_]
    episodes: tuple[tuple[float, float, str], ...]
    limits: tuple[LimitUse, ...] = ()
    shortfalls: tuple[Shortfall, ...] = ()
    control_point: float = math.nan
    warnings: tuple[str, ...] = ()

    @property
    def within_limits(self) -> bool:
        """Whether no limit of the machine is exceeded."""
        return not any(use.exceeded for use in self.limits)

    @property
    def exceeding(self) -> str:
        """The limits that are exceeded, by how much and when; empty where none is."""
        broken = [str(use) for use in self.limits if use.exceeded]
        return f"exceeds {'; '.join(broken)}" if broken else ""

    @property
    def tracking_error(self) -> Floats:
        """Size of actual − reference, (t,) m/s²."""
        return np.asarray(np.linalg.norm(self.actual - self.reference, axis=1))


@dataclass(frozen=True)
class MachinePlan:
    """What a centrifuge does to imitate a flight, without a beam.

    Parameters
    ----------
    name, tracks : str
        Of the motion, and of the flight.
    arm : float
        m.
    outcome : str
        done or limits exceeded.
    message : str
        Which limits, where the outcome is not done.
    time : (t,) s
    axes : AxesResult
        At these times.
    """

    name: str
    tracks: str
    arm: float
    outcome: str
    message: str
    time: Floats
    axes: AxesResult


@dataclass(frozen=True)
class Commands:
    """The axis motions at a controller's sample time.

    Parameters
    ----------
    sample : float
        s.
    time : (t,) s
    angle, rate, acceleration : (t, 3)
        Of axes 1, 2, 3; rad, rad/s, rad/s².
    """

    sample: float
    time: Floats
    angle: Floats
    rate: Floats
    acceleration: Floats


class PlotHeading(Protocol):
    """What a plot's title says of a result: the motion's name and how its computation ended."""

    @property
    def name(self) -> str: ...
    @property
    def outcome(self) -> str: ...
    @property
    def time(self) -> Floats: ...


@dataclass(frozen=True)
class Peaks:
    """Extremes of the tip's displacement at every step computed, along x, y, z.

    Parameters
    ----------
    max_abs, time_of_max : (3,)
        m, s.
    residual_amplitude : (3,)
        Half peak-to-peak from the residual's start to the end, m; NaN where none was asked for or reached.
    """

    max_abs: Floats
    time_of_max: Floats
    residual_amplitude: Floats


@dataclass(frozen=True)
class Response:
    """Response of the beam in one environment.

    Parameters
    ----------
    name : str
        The motion's name.
    environment : str
        flight, centrifuge or hub.
    model : str
        The model's kind.
    outcome : str
        done, diverged or not converged.
    message : str
        What happened and what to try, where the outcome is not done.
    warnings : tuple of str
    time : (t,) s
    stations : (s,) m, the last is the tip
    displacement : (t, s, 3)
        Relative to the base axes, m.
    q, qd : (t, n)
        Coordinates and their rates.
    base : BaseHistory
    peaks : Peaks
    integrator : str
    step : float
        s; NaN for adaptive steps.
    steps : int
    error_estimate : float
        Largest error of the tip's displacement, as a fraction of its largest size, estimated from a second run with
        another step; NaN where none was made.
    residual_from : float
        s; NaN where not given.
    hub : HubResult or None
    axes : AxesResult or None
    qdd : (t, n)
        Accelerations of the coordinates.
    frequencies : (n,)
        Natural frequencies at rest, rad/s, ascending.
    loads : Loads or None
        Internal loads at the root and the stations.
    influence : Influence or None
        Static answer of the beam to acceleration fields.
    """

    name: str
    environment: str
    model: str
    outcome: str
    message: str
    warnings: tuple[str, ...]
    time: Floats
    stations: Floats
    displacement: Floats
    q: Floats
    qd: Floats
    base: BaseHistory
    peaks: Peaks
    integrator: str
    step: float
    steps: int
    error_estimate: float
    residual_from: float
    hub: HubResult | None = None
    axes: AxesResult | None = None
    qdd: Floats = field(default_factory=lambda: np.empty((0, 0)))
    frequencies: Floats = field(default_factory=lambda: np.empty(0))
    loads: Loads | None = None
    influence: Influence | None = None

    @property
    def tip(self) -> Floats:
        """Displacement of the tip relative to the base axes, (t, 3) m."""
        return self.displacement[:, -1]


@dataclass(frozen=True)
class Failure:
    """Why there is no whole response in an environment: the outcome, such as diverged, and what happened."""

    outcome: str
    message: str


@dataclass(frozen=True)
class Study:
    """The responses of one beam in all environments of a scenario, and their comparisons.

    Where a response has no state to start from there is a failure in its place.
    """

    title: str
    responses: dict[str, Response]
    comparisons: tuple[Comparison, ...]
    failures: Mapping[str, Failure] = field(default_factory=dict)

    @property
    def unfinished(self) -> Mapping[str, Failure]:
        """Why not every environment is done, by name."""
        cut = {name: Failure(it.outcome, it.message) for name, it in self.responses.items() if it.outcome != "done"}
        return {**cut, **self.failures}

    @property
    def outcome(self) -> str:
        """``done`` where every response is, else the first other outcome."""
        return next((it.outcome for it in self.unfinished.values()), "done")
