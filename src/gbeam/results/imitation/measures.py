"""Measures of an imitation: differences, mismatch, root loads, shock and fatigue."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class StressCycles(Part):
    """Rainflow cycles of a stress (ASTM E1049-85, 5.4.4).

    Parameters
    ----------
    range, mean : (k,)
        Pa; largest range first.
    count : (k,)
        1 of a full cycle, 0.5 of a half.
    """

    range: Floats
    mean: Floats
    count: Floats

    @property
    def total(self) -> float:
        """Number of cycles."""
        return float(self.count.sum())

    @property
    def largest(self) -> float:
        """Largest range, Pa; zero without cycles."""
        return float(self.range.max(initial=0.0))

    def equivalent_range(self, exponent: float) -> float:
        """Range of the one cycle that does the same damage, (Σ n Δσᵐ)^(1/m) Pa; zero without cycles."""
        scale = self.largest  # taken out, so that no power of a stress overflows
        return scale * float(np.sum(self.count * (self.range / scale) ** exponent)) ** (1 / exponent) if scale else 0.0


@dataclass(frozen=True, repr=False, eq=False)
class Fatigue(Part):
    """Stress cycles at the root in both environments, each at that extreme fibre where the stress ranges most.

    Parameters
    ----------
    exponent : float
        m of Wöhler's curve, N Δσᵐ = constant.
    flight, machine : StressCycles
        Of each whole run, spin-up and spin-down included.
    """

    exponent: float
    flight: StressCycles
    machine: StressCycles

    @property
    def damage_ratio(self) -> float:
        """Damage on the machine over that in flight by Palmgren and Miner, Σ n Δσᵐ; means count for nothing.

        NaN without cycles in flight.
        """
        flight, machine = (each.equivalent_range(self.exponent) for each in (self.flight, self.machine))
        return (machine / flight) ** self.exponent if flight > 0 else math.nan


_FELT = 0.1  # of the flight's largest spectrum: an axis with less is no part of the shock


@dataclass(frozen=True, repr=False, eq=False)
class Sizes(Part):
    """How large a quantity is over the times compared, per station and direction.

    Parameters
    ----------
    peak, rms : (s, 3)
        Largest and root mean square size, unit of the quantity.
    residual : (s, 3)
        Residual vibration: half peak-to-peak of the elastic vibration, from the residual's start on where one is given.
    """

    peak: Floats
    rms: Floats
    residual: Floats


@dataclass(frozen=True, repr=False, eq=False)
class Statistics(Part):
    """Displacements of all stations in both environments, and the tip's trend and elastic vibration apart.

    Trend: a Butterworth low-pass of fourth order, run forwards and backwards so that it shifts nothing in time, −6 dB
    at the cut-off; vibration: the rest (2020, section 4.3). Where the slope of a displacement jumps by k m/s, a false
    vibration of up to 0.12 k/cutoff appears within one period of the cut-off; the ends are continued by their point
    reflection, and the first and last half period of the cut-off are less certain.

    Parameters
    ----------
    stations : (s,)
        From the root, m; the last is the tip.
    cutoff : float
        Hz: half the lowest natural frequency at rest.
    flight, centrifuge, difference : Sizes
        m.
    trend_flight, trend_centrifuge, vibration_flight, vibration_centrifuge : (t, 3)
        Of the tip, m.
    """

    stations: Floats
    cutoff: float
    flight: Sizes
    centrifuge: Sizes
    difference: Sizes
    trend_flight: Floats
    trend_centrifuge: Floats
    vibration_flight: Floats
    vibration_centrifuge: Floats

    @property
    def trend_difference(self) -> Floats:
        """Of the tip, centrifuge less flight, (t, 3) m."""
        return self.trend_centrifuge - self.trend_flight


@dataclass(frozen=True, repr=False, eq=False)
class Mismatch(Part):
    """Acceleration that grows with the distance from the control point: Δa(x, t) = gradient(t) (x − x_c).

    Parameters
    ----------
    control_point : float
        x_c, from the root, m.
    gradient : (t, 3)
        Centrifuge less flight of [−(ω_y² + ω_z²), ω_x ω_y + α_z, ω_x ω_z − α_y], base axes, 1/s².
    max_gradient : (3,)
        Largest size over the times compared, 1/s².
    max_acceleration : (3,)
        Largest size of Δa at the end of the beam where it is larger, m/s².
    tip_bound : (3,)
        Quasi-static displacement of the tip under the largest gradient, m: for a uniform cantilever
        (m L⁵/EI) |11/120 − ξ/8| max|gradient|, ξ = x_c/L.
    force_bound : (3,)
        The same of the force at the root, N: m L² |1/2 − ξ| max|gradient|.
    moment_bound : (3,)
        The same of the moment at the root, in the plane of x and the axis, N m: m L³ |1/3 − ξ/2| max|gradient|.
    length : float
        Of the beam, L, m.
    best : tuple of float
        From the control point with the least moment at the root to that with the least displacement of the tip, m;
        that with the least vibration of a uniform cantilever lies between.
    """

    control_point: float
    gradient: Floats
    max_gradient: Floats
    max_acceleration: Floats
    tip_bound: Floats
    force_bound: Floats
    moment_bound: Floats
    length: float
    best: tuple[float, float] = (-np.inf, np.inf)

    @property
    def placed(self) -> bool:
        """Whether the control point is among the best, within a hundredth of the length."""
        slack = 0.01 * self.length
        return self.best[0] - slack <= self.control_point <= self.best[1] + slack

    @property
    def tip_envelope(self) -> Floats:
        """Size of the tip's quasi-static displacement under the gradient of each time, (t, 3) m."""
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.where(self.max_gradient > 0, np.abs(self.gradient) / self.max_gradient, 0.0)
        return np.asarray(self.tip_bound * share)

    def field(self, x: Floats) -> Floats:
        """Δa at positions `x` (s,) m from the root, (t, s, 3) m/s²."""
        return self.gradient[:, None, :] * (np.asarray(x)[:, None] - self.control_point)


@dataclass(frozen=True, repr=False, eq=False)
class RootHistory(Part):
    """What the root carries at the comparison's times, axes of its section.

    Parameters
    ----------
    force_flight, force_centrifuge : (t, 3)
        N, V_y, V_z, N.
    moment_flight, moment_centrifuge : (t, 3)
        Torque, M_y, M_z, N m.
    """

    force_flight: Floats
    force_centrifuge: Floats
    moment_flight: Floats
    moment_centrifuge: Floats


@dataclass(frozen=True, repr=False, eq=False)
class RootLoads(Part):
    """What the root carries in both environments, over the times compared.

    Parameters
    ----------
    force_flight, force_centrifuge, force_difference : (3,)
        Largest size of N, V_y, V_z at the root and of their difference, N.
    moment_flight, moment_centrifuge, moment_difference : (3,)
        Largest size of the torque, M_y, M_z, N m.
    stress_flight, stress_centrifuge, stress_difference : float
        Largest normal stress at the root's outer fibre, Pa; NaN where the outer fibres are unknown.
    history : RootHistory
        Force and moment over time.
    """

    force_flight: Floats
    force_centrifuge: Floats
    force_difference: Floats
    moment_flight: Floats
    moment_centrifuge: Floats
    moment_difference: Floats
    stress_flight: float
    stress_centrifuge: float
    stress_difference: float
    history: RootHistory

    @property
    def main(self) -> int:
        """Component of the moment (0, 1, 2) that is largest in flight."""
        return int(np.argmax(self.moment_flight))

    @property
    def moment_agreement(self) -> float:
        """Largest difference of the bending moment that is largest in flight, over that; NaN without a moment."""
        largest = float(self.moment_flight[self.main])
        return float(self.moment_difference[self.main]) / largest if largest > 0 else float("nan")


@dataclass(frozen=True)
class SpectrumRatio:
    """Ratio of two shock response spectra, machine over flight, at one frequency (Hz) along one axis."""

    ratio: float
    frequency: float
    axis: str

    def __str__(self) -> str:
        return f"at {self.frequency:.3g} Hz along {self.axis}"


@dataclass(frozen=True, repr=False, eq=False)
class Shock(Part):
    """Shock response spectra of the tip's acceleration: largest absolute acceleration of an oscillator riding on it.

    Smallwood's ramp-invariant filter (absolute acceleration, maximax over the times compared); the oscillators begin at
    rest relative to the first sample.

    Parameters
    ----------
    quality : float
        Q of the oscillators.
    frequency : (f,)
        Hz.
    flight, centrifuge : (f, 3)
        m/s², base axes; specific force where gravity acts.
    """

    quality: float
    frequency: Floats
    flight: Floats
    centrifuge: Floats

    @property
    def ratio(self) -> Floats:
        """Machine over flight, (f, 3); an axis counts from a tenth of the flight's largest at the frequency on."""
        least = _FELT * self.flight.max(axis=1, keepdims=True)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.maximum(self.centrifuge, least) / np.maximum(self.flight, least))

    @property
    def extremes(self) -> tuple[SpectrumRatio, ...]:
        """The largest and the smallest ratio; empty where none is known."""
        ratio = self.ratio
        if not np.isfinite(ratio).any():
            return ()
        places = (np.unravel_index(find(ratio), ratio.shape) for find in (np.nanargmax, np.nanargmin))
        return tuple(SpectrumRatio(float(ratio[f, k]), float(self.frequency[f]), "xyz"[k]) for f, k in places)
