"""The measures by which a place for the specimen is judged: histories of what the mismatch does, per measure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gbeam.analysis.response.record import influence
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import first_step
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.structure import Structure
from gbeam.motion import Flight
from gbeam.motion.bases.base import gradient
from gbeam.motion.centrifuge.centrifuge import MOUNTINGS, Centrifuge
from gbeam.motion.centrifuge.course import INVERSES
from gbeam.motion.centrifuge.kinematics import forward
from gbeam.numerics.filters import displacement
from gbeam.numerics.minimise import coarse
from gbeam.results.result import Flags, Floats

_FACTOR = 4.0  # of the centrifuge's own smoothing, either way


@typed
@dataclass(frozen=True)
class Choice:
    """Options beside the control point: mountings and widths of smoothing.

    Parameters
    ----------
    make : callable
        Of mounting and width of smoothing, s: a centrifuge that tracks the flight; InputError where it cannot.
    mountings : tuple of str
        The scenario's own first.
    widths : tuple of float
        Tried with every mounting, ascending, s.
    refined : bool
        Whether to search on between the best of them and its neighbours.
    limited : bool
        Whether the machine's limits must be kept.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> gb.choice_of(machine, smoothing=[0.1]).mountings
    ('upright', 'inverted')
    """

    make: Callable[[str, float], Centrifuge]
    mountings: tuple[str, ...]
    widths: tuple[float, ...]
    refined: bool = True
    limited: bool = True


@dataclass(frozen=True)
class Altered:
    """A centrifuge with another mounting and width of smoothing."""

    centrifuge: Centrifuge

    def __call__(self, mounting: str, width: float) -> Centrifuge:
        """Return the centrifuge itself where both are its own: it need not be planned again."""
        same = mounting == self.centrifuge.mounting and width == width_of(self.centrifuge)
        return self.centrifuge if same else self.centrifuge.altered(mounting=mounting, smoothing=width)


def width_of(centrifuge: Centrifuge) -> float:
    """Width of the smoothing of its target, s; zero where there is none."""
    return float(centrifuge.smoothing or 0.0)


@typed
def choice_of(centrifuge: Centrifuge, smoothing: Sequence[float] = (), *, limited: bool = True) -> Choice:
    """Return both mountings of a centrifuge, its own first, and widths of smoothing.

    Parameters
    ----------
    centrifuge : Centrifuge
        Prepared for the times that are looked at.
    smoothing : sequence of float
        Width of the kernel to keep, s, or the two ends of a range; without it from a quarter to four times the
        centrifuge's own, or, where the axis motions are planned within the limits and need no smoothing, its own.
    limited : bool
        Whether the machine's limits must be kept.

    Raises
    ------
    InputError
        If there are more than two widths, or one of two is not positive.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> gb.choice_of(machine, smoothing=[0.05, 0.2]).refined
    True
    """
    if len(smoothing) > 2:
        raise InputError("smoothing", f"is given {len(smoothing)} times", "give one width, or the ends of a range")
    if len(smoothing) == 2 and min(smoothing) <= 0:
        raise InputError("smoothing", f"is {min(smoothing):g} s", "give two positive widths")
    width = width_of(centrifuge)
    searched = [width] if INVERSES[centrifuge.method].plans else [width / _FACTOR, width * _FACTOR]
    ends = sorted(smoothing) or searched
    widths = coarse(ends[0], ends[-1])

    others = tuple(name for name in MOUNTINGS if name != centrifuge.mounting)
    return Choice(Altered(centrifuge), (centrifuge.mounting, *others), widths, len(widths) > 1, limited)


@dataclass(frozen=True)
class Histories:
    """A measure over the times compared: of the load's error at C, and of g x and g; (t, k) each; flight's own peak."""

    at_control_point: Floats
    linear: Floats
    uniform: Floats
    scale: float

    def size(self, at: float, total: bool) -> float:
        """Largest size with the control point at `at` m, over flight's peak; in `total` with the load's error at C."""
        return self._largest(self.linear - at * self.uniform + (self.at_control_point if total else 0.0))

    @property
    def error(self) -> float:
        """Measure of the load's error at C alone, which no control point changes."""
        return self._largest(self.at_control_point)

    def _largest(self, values: Floats) -> float:
        return float(np.linalg.norm(values, axis=-1).max(initial=0.0)) / self.scale


class Answers:
    """Quasi-static answers and the first mode's, to uniform or linear loads, at times when the first centrifuge's
    target is not held: begin with the widest smoothing, which holds longest.
    """

    def __init__(self, structure: Structure, flight: Flight, settings: ResponseSettings) -> None:
        self.step = first_step(structure, flight, settings)
        self.time = settings.start + self.step * np.arange(round(settings.duration / self.step) + 1)
        self.left_out: Flags | None = None
        self.influence = influence(structure)
        c = structure.coefficients
        frequency, modes = structure.rest
        self.frequency, first = float(frequency[0]), modes[:, 0]
        self.damping = float(first @ c.damping @ first) / (2 * self.frequency)
        self.tip = float(np.abs(structure.station_places.first[-1] @ first).max())
        self.uniform = c.f_a @ first
        self.linear = np.array([0.0, c.f_al[2] @ first, -c.f_al[1] @ first])

    def histories(
        self, flight: Flight, centrifuge: Centrifuge
    ) -> tuple[dict[str, Histories], tuple[float, float, float]]:
        """Every measure's, and the largest accelerations of the axes, rad/s²."""
        error, gradient, load, turning, not_followed = self._mismatch(flight, centrifuge)
        self.left_out = not_followed if self.left_out is None else self.left_out
        covered = ~(not_followed | self.left_out)
        if not covered.any():
            raise InputError("tracks", "is never carried: the target is held all the time", "lower idle")
        static, across = self.influence, np.array([0.0, 1.0, 1.0])

        def quasi_static(uniform: Floats, linear: Floats) -> Histories:
            parts = error * uniform, gradient * linear, gradient * uniform
            at_c, growing, even = ((part * across)[covered] for part in parts)
            return Histories(at_c, growing, even, _peak((load * uniform * across)[covered]))

        def vibration(force: Floats) -> Floats:
            trend = force / self.frequency**2
            return self.tip * (displacement(force, self.frequency, self.damping, self.step) - trend)[covered, None]

        measures = {
            "root-shear": quasi_static(static.force_uniform, static.force_linear),
            "root-moment": quasi_static(static.moment_uniform, static.moment_linear),
            "tip": quasi_static(static.tip_uniform, static.tip_linear),
        }
        transverse = self.uniform * across
        measures["vibration"] = Histories(
            vibration(error @ transverse), vibration(gradient @ self.linear), vibration(gradient @ transverse),
            scale=measures["tip"].scale,
        )  # fmt: skip
        accelerations = np.abs(turning).max(axis=0)
        return measures, (float(accelerations[0]), float(accelerations[1]), float(accelerations[2]))

    def _mismatch(self, flight: Flight, centrifuge: Centrifuge) -> tuple[Floats, Floats, Floats, Floats, Flags]:
        """Load at C and gradient less the flight's, the flight's load; axis accelerations; where it is not followed."""
        axes = centrifuge.axes(self.time)
        geometry = centrifuge.geometry
        at_c, flown = forward(axes, geometry.arm, geometry.gravity), flight.base(self.time)
        turning = axes.accelerations
        return (
            at_c.a_WO_B - flown.a_WO_B,
            gradient(at_c.w_WB_B, at_c.alpha_WB_B) - gradient(flown.w_WB_B, flown.alpha_WB_B),
            flown.a_WO_B,
            turning,
            centrifuge.not_followed(self.time),
        )


def _peak(values: Floats) -> float:
    peak = float(np.linalg.norm(values, axis=-1).max(initial=0.0))
    if peak == 0:
        raise InputError("tracks", "loads the beam along its axis only", "track a flight that loads it across")
    return peak
