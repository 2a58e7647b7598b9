"""Two responses compared: a pure function of two results."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.numerics.low_pass import low_pass
from gbeam.numerics.oscillators import riding_acceleration
from gbeam.results.comparison import Comparison, Mismatch, RootLoads, Shock, Sizes, Statistics
from gbeam.results.response import BaseHistory, Floats, Response

CUTOFF = 0.5  # of the lowest natural frequency: trend below, elastic vibration above
QUALITY = 10.0  # of the oscillators of the shock response spectrum
_SPECTRUM = 60  # frequencies
_HIGHEST = 1 / 8  # of the sampling rate: above, the peaks between samples are missed
_FEWEST = 16  # samples worth filtering

Flags = NDArray[np.bool_]


def compare(flight: Response, centrifuge: Response) -> Comparison:
    """Compare the response on a centrifuge with that in the flight it imitates.

    Parameters
    ----------
    flight, centrifuge : Response
        Sampled at any times; the flight's are interpolated where they differ.

    Returns
    -------
    Comparison
        Over the centrifuge's times, without those at which its target was held. Root loads and spectra need the
        responses' loads, the mismatch's bounds their influence, trend and vibration their frequencies.
    """
    time = centrifuge.time[centrifuge.time <= flight.time[-1] * (1 + 1e-12)]
    n = len(time)

    def in_flight(values: Floats) -> Floats:
        return _sampled(time, flight.time, values)

    there, here = in_flight(flight.displacement), centrifuge.displacement[:n]
    covered = np.ones(n, dtype=bool) if centrifuge.axes is None else ~centrifuge.axes.not_followed[:n]
    difference = here[:, -1] - there[:, -1]
    root, shock = None, None
    if flight.loads is not None and centrifuge.loads is not None and covered.any():
        a, b = flight.loads, centrifuge.loads
        root = _root(
            covered,
            in_flight(a.section_force[:, 0]), b.section_force[:n, 0],
            in_flight(a.section_moment[:, 0]), b.section_moment[:n, 0],
            in_flight(a.stress[:, 0]), b.stress[:n, 0],
        )  # fmt: skip
        shock = _shock(time, covered, in_flight(a.acceleration[:, -1]), b.acceleration[:n, -1])
    return Comparison(
        flight=flight.name,
        centrifuge=centrifuge.name,
        time=time,
        difference=difference,
        covered=covered,
        max_difference=_largest(difference, covered),
        rms_difference=_rms(difference, covered),
        peak_flight=_largest(there[:, -1], covered),
        peak_centrifuge=_largest(here[:, -1], covered),
        stations=_statistics(time, covered, there, here, centrifuge),
        mismatch=_mismatch(covered, flight, centrifuge, in_flight(_gradient(flight.base)), n),
        root=root,
        shock=shock,
    )


def _sampled(time: Floats, own: Floats, values: Floats) -> Floats:
    """Values (t, ...) known at the times `own`, at `time`."""
    if len(own) >= len(time) and np.array_equal(own[: len(time)], time):
        return values[: len(time)]
    columns = values.reshape(len(own), -1).T
    return np.stack([np.interp(time, own, column) for column in columns], axis=-1).reshape(len(time), *values.shape[1:])


def _largest(values: Floats, covered: Flags) -> Floats:
    return np.abs(values[covered]).max(axis=0) if covered.any() else np.full(values.shape[1:], np.nan)


def _rms(values: Floats, covered: Flags) -> Floats:
    return np.sqrt(np.mean(values[covered] ** 2, axis=0)) if covered.any() else np.full(values.shape[1:], np.nan)


def _statistics(time: Floats, covered: Flags, there: Floats, here: Floats, centrifuge: Response) -> Statistics | None:
    """Sizes per station, and the tip's trend and vibration."""
    if not centrifuge.frequencies.size or len(time) < _FEWEST or not covered.any():
        return None
    step, cutoff = float(time[1] - time[0]), CUTOFF * float(centrifuge.frequencies[0]) / (2 * np.pi)
    if not cutoff < 0.4 / step:
        return None
    late = covered & ~(time < centrifuge.residual_from)  # all of them where none is given
    late = late if late.any() else covered

    def sizes(values: Floats) -> tuple[Sizes, Floats]:
        trend = low_pass(values, step, cutoff)
        left = (values - trend)[late]
        return Sizes(_largest(values, covered), _rms(values, covered), np.ptp(left, axis=0) / 2), trend[:, -1]

    (flight, slow), (spun, slow_spun), (apart, _) = sizes(there), sizes(here), sizes(here - there)
    return Statistics(
        stations=centrifuge.stations,
        cutoff=cutoff,
        flight=flight,
        centrifuge=spun,
        difference=apart,
        trend_flight=slow,
        trend_centrifuge=slow_spun,
        vibration_flight=there[:, -1] - slow,
        vibration_centrifuge=here[:, -1] - slow_spun,
    )


def _gradient(base: BaseHistory) -> Floats:
    """∂a/∂x along the beam of a base in rotation, base axes, (t, 3) 1/s² (2020 (4))."""
    (wx, wy, wz), (_, aly, alz) = base.w_WB_B.T, base.alpha_WB_B.T
    return np.stack([-(wy**2 + wz**2), wx * wy + alz, wx * wz - aly], axis=1)


def _mismatch(covered: Flags, flight: Response, centrifuge: Response, there: Floats, n: int) -> Mismatch | None:
    if centrifuge.axes is None or not np.isfinite(centrifuge.axes.control_point) or not covered.any():
        return None
    at, length = centrifuge.axes.control_point, float(centrifuge.stations[-1])
    gradient = _gradient(centrifuge.base)[:n] - there
    largest, it = _largest(gradient, covered), centrifuge.influence
    unknown = np.full(3, np.nan)

    def bound(linear: Floats, uniform: Floats) -> Floats:
        return np.abs(linear - at * uniform) * largest

    return Mismatch(
        control_point=at,
        gradient=gradient,
        max_gradient=largest,
        max_acceleration=largest * max(at, length - at),
        tip_bound=unknown if it is None else bound(it.tip_linear, it.tip_uniform),
        force_bound=unknown if it is None else bound(it.force_linear, it.force_uniform),
        moment_bound=unknown if it is None else bound(it.moment_linear, it.moment_uniform),
    )


def _root(covered: Flags, fa: Floats, fb: Floats, ma: Floats, mb: Floats, sa: Floats, sb: Floats) -> RootLoads:
    def size(values: Floats) -> Floats:
        return _largest(values, covered)

    stresses = (float(size(values)) for values in (sa, sb, sb - sa))
    return RootLoads(size(fa), size(fb), size(fb - fa), size(ma), size(mb), size(mb - ma), *stresses)


def _shock(time: Floats, covered: Flags, there: Floats, here: Floats) -> Shock | None:
    if len(time) < _FEWEST:
        return None
    step = float(time[1] - time[0])
    lowest, highest = 1 / float(time[-1] - time[0]), _HIGHEST / step
    frequency = np.geomspace(max(lowest, highest / 1000), highest, _SPECTRUM)

    def spectrum(base: Floats) -> Floats:
        riding = (riding_acceleration(base, 2 * np.pi * f, 0.5 / QUALITY, step) for f in frequency)
        return np.stack([_largest(a, covered) for a in riding])

    return Shock(QUALITY, frequency, spectrum(there), spectrum(here))
