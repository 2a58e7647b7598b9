"""A comparison of flight and centrifuge, and its parts: frozen records of arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Figured, Flags, Floats, Part

AGREEMENT = 0.25  # of flight's peak: beyond, the two do not agree


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
    """

    control_point: float
    gradient: Floats
    max_gradient: Floats
    max_acceleration: Floats
    tip_bound: Floats
    force_bound: Floats
    moment_bound: Floats
    length: float

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


@dataclass(frozen=True, repr=False, eq=False)
class Comparison(Figured):
    """How a centrifuge's response differs from the flight's that it imitates, where its target is the flight's load.

    Parameters
    ----------
    flight, centrifuge : str
        Names of the motions.
    time : (t,) s
    difference : (t, 3)
        Tip displacement on the centrifuge less in flight, m.
    covered : (t,) bool
        Times compared: those at which the target was not held.
    max_difference, rms_difference : (3,)
        Over the covered times, m.
    peak_flight, peak_centrifuge : (3,)
        Largest displacement over the covered times, m.
    stations : Statistics or None
        Displacement of every station, with trend and elastic vibration apart; None where the record is too short.
    mismatch : Mismatch or None
        Acceleration that the centrifuge gives the beam's points and the flight does not, and what it implies.
    root : RootLoads or None
        What the root carries in both environments.
    shock : Shock or None
        Shock response spectra of the tip's acceleration.
    """

    flight: str
    centrifuge: str
    time: Floats
    difference: Floats
    covered: Flags
    max_difference: Floats
    rms_difference: Floats
    peak_flight: Floats
    peak_centrifuge: Floats
    stations: Statistics | None = None
    mismatch: Mismatch | None = None
    root: RootLoads | None = None
    shock: Shock | None = None

    @property
    def relative(self) -> Floats:
        """Largest difference over the flight's largest displacement, per axis, (3,); NaN without displacement."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.peak_flight > 0, self.max_difference / self.peak_flight, np.nan)

    @property
    def main_axis(self) -> int:
        """Axis (0, 1, 2) along which the tip moves most in flight; z where no time is compared."""
        return int(np.argmax(self.peak_flight)) if self.covered.any() else 2

    @property
    def agrees(self) -> bool:
        """Whether the tip's displacement differs by a quarter of the flight's peak at most."""
        return bool(self.covered.any() and self.relative[self.main_axis] <= AGREEMENT)

    @property
    def verdict(self) -> str:
        """One line that a person can quote."""
        if not self.covered.any():
            return f"{self.centrifuge} never carries {self.flight}'s load: the target was held all the time"
        main, root = self.main_axis, ""
        if self.root is not None:
            root = f", root moment {'within' if self.agrees else 'by'} {_percent(self.root.moment_agreement)}"
        differs, peak = (f"{1e3 * each[main]:.4g} mm" for each in (self.max_difference, self.peak_flight))
        share = float(self.relative[main])
        if not math.isfinite(share):
            still = int(np.argmax(self.max_difference))
            moved = f"{1e3 * self.max_difference[still]:.4g} mm along {'xyz'[still]} on {self.centrifuge}"
            return f"{self.flight} does not move the tip, which differs by up to {moved}{root}, {self._when}"
        if self.agrees:
            return (
                f"tip displacement along {'xyz'[main]} on {self.centrifuge} agrees with {self.flight} within "
                f"{_percent(share)} of its peak ({differs} of {peak}){root}, {self._when}"
            )
        return (
            f"{self.centrifuge} does not agree with {self.flight}: tip differs along {'xyz'[main]} by up to {differs}, "
            f"{_times(share)} {self.flight}'s peak ({peak}){root}, {self._when}"
        )

    def __str__(self) -> str:
        return self.verdict[:1].upper() + self.verdict[1:]

    def __repr__(self) -> str:
        return f"Comparison: {self.verdict}"

    @property
    def _when(self) -> str:
        """The times compared, in words."""
        if self.covered.all():
            return "throughout"
        edges = np.flatnonzero(np.diff(self.covered, prepend=False, append=False))
        if len(edges) > 2:
            return f"over {100 * self.covered.mean():.0f} % of the time"
        first, last = edges[0], edges[1] - 1
        if last == len(self.time) - 1:
            return f"from {self.time[first]:.4g} s on"
        return f"from {self.time[first]:.4g} to {self.time[last]:.4g} s"


def _percent(share: float) -> str:
    # Rounded first: two digits without an exponent.
    return f"{float(f'{100 * share:.2g}'):g} %" if math.isfinite(share) else "an unknown share"


def _times(share: float) -> str:
    """A share in words that go before what it is a share of: 8.8 times, or 31 % of."""
    return f"{share:.2g} times" if share >= 1 else f"{_percent(share)} of"
