"""Measures of an imitation: differences of tip, load and root loads, shock and fatigue."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gbeam.guards.arguments import typed_methods
from gbeam.guards.quantities import Positions
from gbeam.results.declared import declared, fact, internal, part, quantity
from gbeam.results.result import Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class StressCycles(Part):
    """Rainflow cycles of a stress (ASTM E1049-85, 5.4.4)."""

    range: Floats = quantity("Pa", "range of the stress cycle", "cycle_", key=None, note="largest range first")
    mean: Floats = quantity("Pa", "its mean", "cycle_", key=None)
    count: Floats = quantity("", "1 of a full cycle, 0.5 of a half", "cycle_", key=None)

    @declared("", "number of cycles", name=None, key="cycles")
    def total(self) -> float:
        return float(self.count.sum())

    @declared("Pa", "largest range", name=None, key="largest_range")
    def largest(self) -> float:
        """Largest range, Pa, or zero without cycles."""
        return float(self.range.max(initial=0.0))

    def equivalent_range(self, exponent: float) -> float:
        """Range of the one cycle that does the same damage, (Σ n Δσᵐ)^(1/m) Pa, or zero without cycles."""
        scale = self.largest  # taken out, so that no power of a stress overflows
        return scale * float(np.sum(self.count * (self.range / scale) ** exponent)) ** (1 / exponent) if scale else 0.0


@dataclass(frozen=True, repr=False, eq=False)
class Fatigue(Part):
    """Stress cycles in both environments at the root of a beam, where a solid's von Mises stress is largest, or at a
    point; each at the extreme fibre, or on the plane, where the normal stress ranges most.
    """

    exponent: float = fact("m of Wöhler's curve, N Δσᵐ = constant")
    flight: StressCycles = part("cycles of the whole run", name="stress_*_flight")
    machine: StressCycles = part("cycles of the whole run, spin-up and spin-down included", name="stress_*_machine")
    place: str = fact("where the stress is", name="stress_place", default="of the root")

    @declared("Pa", "range of the one cycle that does the same damage in flight", role="fact", name=None,
              key="flight.equivalent_range")  # fmt: skip
    def equivalent_flight(self) -> float:
        return self.flight.equivalent_range(self.exponent)

    @declared("Pa", "range of the one cycle that does the same damage on the machine", role="fact", name=None,
              key="machine.equivalent_range")  # fmt: skip
    def equivalent_machine(self) -> float:
        return self.machine.equivalent_range(self.exponent)

    @declared("", "damage of the machine over flight's")
    def damage_ratio(self) -> float:
        """Damage on the machine over that in flight by Palmgren and Miner, Σ n Δσᵐ. Means count for nothing.

        NaN without cycles in flight, inf beside cycles that are next to none.
        """
        flight = self.equivalent_flight
        with np.errstate(over="ignore"):
            return float((np.float64(self.equivalent_machine) / flight) ** self.exponent) if flight > 0 else math.nan


_FELT = 0.1  # of the flight's largest spectrum: an axis with less is no part of the shock


@dataclass(frozen=True, repr=False, eq=False)
class Sizes(Part):
    """Sizes of displacements over the times compared, per station and direction."""

    peak: Floats = quantity("m", "largest displacement", "axis")
    rms: Floats = quantity("m", "root mean square displacement", "axis")
    residual: Floats = quantity(
        "m",
        "residual vibration",
        "axis",
        note="half peak-to-peak of the elastic vibration, from the residual's start on where one is given",
    )


_FILTER = "Butterworth 4th order, zero phase"


@dataclass(frozen=True, repr=False, eq=False)
class StationStatistics(Part):
    """Displacements of all stations in both environments, and the tip's trend and elastic vibration apart.

    Trend: a Butterworth low-pass of fourth order, run forwards and backwards so that it shifts nothing in time, −6 dB
    at the cut-off; vibration: the rest (2020, section 4.3). Where the slope of a displacement jumps by k m/s, a false
    vibration of up to 0.12 k/cutoff appears within one period of the cut-off. The ends are continued by their point
    reflection, and the first and last half period of the cut-off are less certain.
    """

    json_rows: ClassVar[dict[str, str]] = {"station": "stations"}

    stations: Floats = quantity(
        "m", "position along the beam from the root", "station", role="coordinate", key="at", note="the last is the tip"
    )
    cutoff: float = fact("half the lowest natural frequency at rest", "Hz")
    flight: Sizes = part("in flight", "station", name="station_*_flight")
    centrifuge: Sizes = part("on the centrifuge", "station", name="station_*_centrifuge")
    difference: Sizes = part("of the difference", "station", name="station_*_difference")
    trend_flight: Floats = quantity("m", f"tip in flight below the cut-off, {_FILTER}", "time axis")
    trend_centrifuge: Floats = quantity("m", f"tip on the centrifuge below the cut-off, {_FILTER}", "time axis")
    vibration_flight: Floats = quantity("m", f"tip in flight above the cut-off, {_FILTER}", "time axis")
    vibration_centrifuge: Floats = quantity("m", f"tip on the centrifuge above the cut-off, {_FILTER}", "time axis")

    tip: int = internal("", "number of the station that is the tip", default=-1)

    @property
    def trend_difference(self) -> Floats:
        """Difference of the tip, centrifuge less flight, (t, 3) m."""
        return self.trend_centrifuge - self.trend_flight


@typed_methods
@dataclass(frozen=True, repr=False, eq=False)
class LoadDifference(Part):
    """Acceleration that grows with the distance from the control point: Δa(x, t) = gradient(t) (x − x_c)."""

    control_point: float = fact("x_c, from the root", "m", name=None)
    gradient: Floats = quantity(
        "1/s^2",
        "difference of the acceleration per distance from the control point",
        "time axis",
        note="centrifuge less flight of [−(ω_y² + ω_z²), ω_x ω_y + α_z, ω_x ω_z − α_y]",
    )
    max_gradient: Floats = quantity("1/s^2", "largest size over the times compared", "axis", name=None)
    max_acceleration: Floats = quantity(
        "m/s^2", "largest size of Δa at the end of the beam where it is larger", "axis", name=None
    )
    tip_bound: Floats = quantity(
        "m",
        "quasi-static displacement of the tip under the largest gradient",
        "axis",
        name=None,
        note="of a uniform cantilever (m L⁵/EI) |11/120 − ξ/8| max|gradient|, ξ = x_c/L",
    )
    force_bound: Floats = quantity(
        "N", "the same of the force at the root", "axis", name=None, note="m L² |1/2 − ξ| max|gradient|"
    )
    moment_bound: Floats = quantity(
        "N m",
        "the same of the moment at the root, in the plane of x and the axis",
        "axis",
        name=None,
        note="m L³ |1/3 − ξ/2| max|gradient|",
    )
    length: float = fact("length of the beam, L", "m", name=None)
    best: tuple[float, float] = internal(
        "m",
        "control points with the least moment at the root, and the least displacement of the tip",
        note="that with the least vibration of a uniform cantilever lies between",
        default=(-np.inf, np.inf),
    )

    @property
    def placed(self) -> bool:
        """True if the control point is among the best, within a hundredth of the length."""
        slack = 0.01 * self.length
        return self.best[0] - slack <= self.control_point <= self.best[1] + slack

    @property
    def tip_envelope(self) -> Floats:
        """Size of the tip's quasi-static displacement under the gradient of each time, (t, 3) m."""
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.where(self.max_gradient > 0, np.abs(self.gradient) / self.max_gradient, 0.0)
        return np.asarray(self.tip_bound * share)

    def field(self, x: Positions) -> Floats:
        """Δa at positions `x` (s,) m from the root, (t, s, 3) m/s²."""
        return self.gradient[:, None, :] * (np.asarray(x)[:, None] - self.control_point)


_SECTION_AXES = "S: axes of the deformed root section"


@dataclass(frozen=True, repr=False, eq=False)
class RootHistory(Part):
    """Loads of the root at the comparison's times, axes of its section."""

    force_flight: Floats = quantity(
        "N", "N, V_y, V_z at the root in flight", "time axis", name="force_history_flight", frame=_SECTION_AXES
    )
    force_centrifuge: Floats = quantity(
        "N", "N, V_y, V_z at the root on the centrifuge", "time axis", frame=_SECTION_AXES
    )
    moment_flight: Floats = quantity(
        "N m", "torque, M_y, M_z at the root in flight", "time axis", name="moment_history_flight", frame=_SECTION_AXES
    )
    moment_centrifuge: Floats = quantity(
        "N m", "torque, M_y, M_z at the root on the centrifuge", "time axis", frame=_SECTION_AXES
    )


@dataclass(frozen=True, repr=False, eq=False)
class RootLoads(Part):
    """Loads of the root in both environments, over the times compared. Stress is NaN without outer fibres."""

    force_flight: Floats = quantity("N", "largest size of N, V_y, V_z in flight", "axis", name=None, key="force.flight")
    force_centrifuge: Floats = quantity(
        "N", "largest size of N, V_y, V_z on the centrifuge", "axis", name=None, key="force.centrifuge"
    )
    force_difference: Floats = quantity(
        "N", "largest size of their difference", "axis", name=None, key="force.difference"
    )
    moment_flight: Floats = quantity(
        "N m", "largest size of torque, M_y, M_z in flight", "axis", name=None, key="moment.flight"
    )
    moment_centrifuge: Floats = quantity(
        "N m", "largest size of torque, M_y, M_z on the centrifuge", "axis", name=None, key="moment.centrifuge"
    )
    moment_difference: Floats = quantity(
        "N m", "largest size of their difference", "axis", name=None, key="moment.difference"
    )
    stress_flight: float = quantity(
        "Pa", "largest normal stress, in flight", name=None, key="stress.flight", optional=True
    )
    stress_centrifuge: float = quantity(
        "Pa", "largest normal stress, on the centrifuge", name=None, key="stress.centrifuge", optional=True
    )
    stress_difference: float = quantity(
        "Pa", "largest normal stress, difference", name=None, key="stress.difference", optional=True
    )
    history: RootHistory = part("force and moment over time", name="root_", key=None)

    @property
    def main(self) -> int:
        """Component of the moment (0, 1, 2) that is largest in flight."""
        return int(np.argmax(self.moment_flight))

    @property
    def moment_agreement(self) -> float:
        """Largest difference of the bending moment that is largest in flight, over that, or NaN without a moment."""
        largest = float(self.moment_flight[self.main])
        return float(self.moment_difference[self.main]) / largest if largest > 0 else float("nan")


@dataclass(frozen=True)
class SpectrumRatio:
    """Ratio of two shock response spectra, machine over flight, at one frequency along one axis."""

    ratio: float = quantity("", "machine over flight")
    frequency: float = quantity("Hz", "frequency")
    axis: str = quantity("", "axis")

    def __str__(self) -> str:
        return f"at {self.frequency:.3g} Hz along {self.axis}"


@dataclass(frozen=True, repr=False, eq=False)
class Shock(Part):
    """Shock response spectra of an acceleration: largest absolute acceleration of an oscillator riding on it.

    The acceleration is the tip's, or the spectra are the weighted mean of those at several control points.

    Smallwood's ramp-invariant filter (absolute acceleration, maximax over the times compared). The oscillators begin at
    rest relative to the first sample.
    """

    quality: float = fact("Q of the oscillators", name=None)
    frequency: Floats = quantity("Hz", "frequency of the oscillators", "frequency", role="coordinate")
    flight: Floats = quantity(
        "m/s^2", "shock response spectrum in flight", "frequency axis", name="shock_flight", key=None,
        note="specific force where gravity acts",
    )  # fmt: skip
    centrifuge: Floats = quantity(
        "m/s^2", "the same on the centrifuge", "frequency axis", name="shock_centrifuge", key=None
    )

    control: str = fact("points whose spectra they are, with their weights and sensors", name=None, default="the tip")

    @declared("m/s^2", "spectrum in flight, by frequency", "frequency direction", name=None, key="flight")
    def rows_flight(self) -> Floats:
        return self.flight

    @declared("m/s^2", "spectrum on the centrifuge, by frequency", "frequency direction", name=None, key="centrifuge")
    def rows_centrifuge(self) -> Floats:
        return self.centrifuge

    @property
    def ratio(self) -> Floats:
        """Machine over flight, (f, 3). Less than a tenth of flight's largest at a frequency counts as that tenth."""
        threshold = _FELT * self.flight.max(axis=1, keepdims=True)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.maximum(self.centrifuge, threshold) / np.maximum(self.flight, threshold))

    @declared("", "largest and smallest ratio", "extreme", role="rows", name=None)
    def extremes(self) -> tuple[SpectrumRatio, ...]:
        """The largest and the smallest ratio, or empty where none is known."""
        ratio = self.ratio
        if not np.isfinite(ratio).any():
            return ()
        places = (np.unravel_index(find(ratio), ratio.shape) for find in (np.nanargmax, np.nanargmin))
        return tuple(SpectrumRatio(float(ratio[f, k]), float(self.frequency[f]), "xyz"[k]) for f, k in places)
