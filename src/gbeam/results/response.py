"""The response of a beam in one environment: what moved, how well it is known, and what the base did meanwhile."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from gbeam.arrays.namespace import is_traced
from gbeam.results.declared import quantity
from gbeam.results.errors import Errors
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Influence, Loads, Outline, Peaks
from gbeam.results.result import Figured, Floats, Part, brief


@dataclass(frozen=True, repr=False, eq=False)
class BaseMotion(Part):
    """Motion of the root in base axes, at one instant or over time, (..., 3)."""

    a_WO_B: Floats = quantity(
        "m/s^2",
        "acceleration of the root; specific force where gravity acts",
        "axis",
        name="root_acceleration",
        key="acceleration",
    )
    w_WB_B: Floats = quantity(
        "rad/s", "angular velocity of the base", "axis", name="angular_velocity", key="angular_velocity"
    )
    alpha_WB_B: Floats = quantity(
        "rad/s^2", "angular acceleration of the base", "axis", name="angular_acceleration", key="angular_acceleration"
    )


@dataclass(frozen=True, repr=False, eq=False)
class HubResult(Part):
    """A hub turning about z.

    Parameters
    ----------
    angle, rate, acceleration : (t,)
        rad, rad/s, rad/s².
    drive_torque : (t,) or None
        Torque of the hub's drive, N m; None where the rate is prescribed and the hub's inertia not known.
    free : bool
        Whether the hub's motion is a result: its rate is not prescribed.
    """

    angle: Floats
    rate: Floats
    acceleration: Floats
    drive_torque: Floats | None = None
    free: bool = False


class PlotHeading(Protocol):
    """What a plot's title says of a result: the motion's name and how its computation ended."""

    @property
    def name(self) -> str: ...
    @property
    def outcome(self) -> str: ...
    @property
    def time(self) -> Floats: ...


@dataclass(frozen=True, repr=False, eq=False)
class Response(Figured):
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
        done, diverged (the displacement left what the model can mean, or the beam lost its stability for so long that
        whatever deviates grows a thousandfold) or not converged.
    message : str
        What happened and what to try, where the outcome is not done.
    time : (t,) s
    stations : (s,) m, the last is the tip
    displacement : (t, s, 3)
        Relative to the base axes, m.
    q, qd : (t, n)
        Coordinates and their rates.
    base : BaseMotion
        Over time, (t, 3).
    peaks : Peaks
    integrator : str
    step : float
        s.
    steps : int
    error_estimate : float
        Total error of the tip's displacement, as a fraction of its largest size: that of `errors`; NaN where there is
        no estimate.
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
    errors : Errors
        Of displacement, loads and stress, with what they are made of.
    damping_ratio : float or tuple of float
        Modal, of the modes of the beam on a base at rest.
    initial : str
        How it begins, in words.
    outline : Outline or None
        The beam's shape at some of the times, and what carries it; None where there is no beam.
    bodies : (b, 3)
        Centres of mass of the bodies on the undeformed beam, from the root, base axes, m.
    whole : tuple of float or None
        First and last time of the whole flight, s, of which this is a part; None where it is all of it.
    kept_every : int
        How many samples of the histories make one in a file.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> response = gb.simulate(structure, turn, duration=6.0)
    >>> response.outcome, response.displacement.shape[1:]
    ('done', (1, 3))
    >>> print(f"{1e3 * response.peaks.max_abs[2]:.3f} mm at {response.peaks.time_of_max[2]:.1f} s")
    2.302 mm at 2.5 s
    """

    name: str
    environment: str
    model: str
    outcome: str
    message: str
    time: Floats
    stations: Floats
    displacement: Floats
    q: Floats
    qd: Floats
    base: BaseMotion
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
    errors: Errors = field(default_factory=Errors)
    damping_ratio: float | tuple[float, ...] = math.nan
    initial: str = ""
    outline: Outline | None = None
    bodies: Floats = field(default_factory=lambda: np.empty((0, 3)))
    whole: tuple[float, float] | None = None
    kept_every: int = 1

    @property
    def tip(self) -> Floats:
        """Displacement of the tip relative to the base axes, (t, 3) m."""
        return self.displacement[:, -1]

    @property
    def flight_span(self) -> tuple[float, float]:
        """First and last time of the flight, s: without the spin-up and the spin-down of a machine."""
        first, last = float(self.time[0]), float(self.time[-1])
        return (first, last) if self.axes is None else (max(first, self.axes.span[0]), min(last, self.axes.span[1]))

    def __repr__(self) -> str:
        if is_traced(self.peaks.max_abs):
            return brief(self)
        of = f" {self.name!r}" if self.name else ""
        main = int(np.argmax(self.peaks.max_abs))
        unknown = math.isnan(self.error_estimate)
        error = "no error estimate" if unknown else f"estimated error {self.error_estimate:.2g} of the peak"
        lines = [
            f"Response{of} ({self.environment}, {self.model}): {self.outcome}",
            *([self.message] if self.message else []),
            f"tip up to {1e3 * self.peaks.max_abs[main]:.4g} mm along {'xyz'[main]}, "
            f"at {self.peaks.time_of_max[main]:.4g} s of {self.time[0]:.4g} to {self.time[-1]:.4g} s",
            f"{self.integrator}, {self.steps} steps of {1e3 * self.step:.4g} ms; {error}",
            *(f"warning: {each}" for each in self.warnings),
        ]
        return "\n  ".join(lines)
