"""Two responses compared: a pure function of two results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gbeam.analysis.imitation.accounting import gradients, judge
from gbeam.analysis.imitation.fatigue import fatigue
from gbeam.analysis.imitation.quantities import Peak, Quantities, largest
from gbeam.arrays.types import Flags, Floats
from gbeam.constants import ToleranceOf
from gbeam.errors import InputError, placing_within
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.kinds import kinds
from gbeam.guards.quantities import Ratio
from gbeam.numerics.samples import interpolated, largest_oscillator_acceleration, low_pass
from gbeam.results.accounting import TOLERANCE, PeakPair
from gbeam.results.comparison import Comparison
from gbeam.results.criteria import KINDS_OF_LIMITS, STRESS_AT, Limits, checked_limits
from gbeam.results.machine import Imitated
from gbeam.results.measures import (
    LoadDifference,
    RootHistory,
    RootLoads,
    Shock,
    Sizes,
    StationStatistics,
)
from gbeam.results.parts import Base, Influence
from gbeam.results.response import Response
from gbeam.results.sensors import Sensor


def peak_pairs(flight: Quantities, machine: Quantities, during: slice, tip: int) -> dict[str, PeakPair]:
    """Largest sizes over the flight's times in each run, by name. "tip" is the point of number `tip`.

    NaN stands for a size that a run does not have.
    """
    in_flight, on_machine = flight.peaks(_compared_times(flight, machine, during), tip), machine.peaks(during, tip)
    pairs = dict[str, PeakPair]()
    for name, (size, time) in in_flight.items():
        machine_size, machine_time = on_machine[name]
        pairs[name] = PeakPair(size, machine_size, time, machine_time)
    return pairs


def _compared_times(flight: Quantities, machine: Quantities, during: slice) -> Flags:
    """Flags of the flight's times up to the last one that is compared."""
    last = machine.response.time[during][-1]
    return flight.response.time <= last + _ROUNDING * abs(last)


def _stresses_at(at: str, flight: Quantities, machine: Quantities, during: slice) -> PeakPair:
    """Largest stress at a named point over the flight's times in each run, or NaN if either has none there."""
    peaks = list[Peak]()
    for run, part in ((flight, _compared_times(flight, machine, during)), (machine, during)):
        stress = run.stress_at("stress_at", at)
        if stress is None:
            return PeakPair(place_flight=at, place_machine=at)
        peaks.append(largest(run.response.time[part], stress[part, None]))
    (in_flight, time_flight), (on_machine, time_machine) = peaks
    return PeakPair(in_flight, on_machine, time_flight, time_machine, at, at)


CUTOFF = 0.5  # of the lowest natural frequency: trend below, elastic vibration above
QUALITY = 10.0  # of the oscillators of the shock response spectrum
_SPECTRUM = 60  # frequencies
_HIGHEST = 1 / 8  # of the sampling rate: above, the peaks between samples are missed
_FEWEST = 16  # samples worth filtering
_ROUNDING = 1e-12  # of the last time


@kinds(accept=KINDS_OF_LIMITS)
@typed
def compare(
    flight: Response,
    centrifuge: Response,
    *,
    point: str | None = None,
    tolerance: Ratio = TOLERANCE,
    tolerance_of: ToleranceOf = "peak",
    accept: Limits | None = None,
    control: Mapping[str, float] | None = None,
    damage_at: str | None = None,
    stress_at: str | None = None,
    sensors: Mapping[str, Sensor] | None = None,
) -> Comparison:
    """Compare the response on a centrifuge with that in the flight it imitates.

    Parameters
    ----------
    flight, centrifuge : Response
        Sampled at any times; the flight's are interpolated where they differ. A response without a name goes by its
        environment.
    point : str, optional
        Named point whose displacement is compared, and whose acceleration the shock response spectra are of; by
        default the tip. Of a system ``body.point``, by default the one that moves farthest in flight; its root loads
        are those of the ground, its stress is the largest of all beams and meshes.
    tolerance : float
        Share of the flight's load by which the machine's may differ and count as following.
    tolerance_of : str
        ``peak``: of the flight's largest load; ``instant``: of its load at each time.
    accept : mapping of str to float or tuple of float, optional
        Limits that decide whether the imitation is accepted, by the names of ``[motion.NAME.accept]``: shares, such as
        ``{"tip": 0.02}``; of ``srs`` and ``damage`` the largest ratio of machine to flight, either way, or the least
        and the largest, ``{"srs": (0.84, 1.41)}``.
    control : mapping of str to float, optional
        Weights of named points: the shock response spectra are the weighted mean of those there, in place of the tip's.
    damage_at : str, optional
        Named point whose fatigue damage is compared; by default the root of a beam, and of a solid where its
        von Mises stress is largest; of several beams, solids or materials that where the stress ranges most in flight.
    stress_at : str, optional
        Named point whose stress the limit ``stress`` is on, of a solid von Mises'; by default the largest anywhere.
    sensors : mapping of str to Sensor, optional
        Accelerometers by the names of points: the shock response spectra there are of what they read, see
        :meth:`Response.reading_at`.

    Returns
    -------
    Comparison
        Over the flight's times: peaks and accounting of all of them, the rest of those at which the target is the
        flight's load. Root loads and spectra need the responses' loads, the bounds of the load's difference their
        influence, trend and vibration their frequencies.

    Raises
    ------
    InputError
        If a limit has no such name, or means nothing, there is no such point, or a sensor is not resolved.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> turn = gb.Flight(z=load)
    >>> machine = gb.Centrifuge(
    ...     turn, arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> options = {"duration": 8.0, "step": 0.002, "estimate": False}
    >>> flight = gb.simulate(structure, turn, **options)
    >>> run = gb.simulate(structure, machine, **options)
    >>> comparison = gb.compare(flight, run, accept={"tip": 0.05})
    >>> print(f"{comparison.relative[2]:.2%}")
    0.26%
    """
    limits = checked_limits(accept)
    flown, spun = Quantities.from_response("flight", flight), Quantities.from_response("centrifuge", centrifuge)
    if flown.points != spun.points:
        raise InputError("centrifuge", "is of another specimen than flight", "give two responses of one specimen")
    chosen = point or flown.farthest
    span, reproduced = (float(flight.time[0]), float(flight.time[-1])), centrifuge.flight_span
    first, last = max(span[0], reproduced[0]), min(span[1], reproduced[1])
    slack = _ROUNDING * max(map(abs, span))
    begin, end = np.searchsorted(centrifuge.time, (first - slack, last + slack))
    during = slice(int(begin), int(end))  # spin-up and spin-down are not the flight's
    time = centrifuge.time[during]
    if not len(time):
        raise InputError("centrifuge", "has no time in common with the flight", "compute both for the same times")

    short = time[0] > span[0] + slack or time[-1] < span[1] - slack
    whole_span = span if short and flight.whole is None else flight.whole

    def in_flight(values: Floats) -> Floats:
        return interpolated(time, flight.time, values)

    axes = centrifuge.axes
    tip = flown.index("point", chosen)
    reference, actual = in_flight(flown.displacement), spun.displacement[during]
    tip_flight, tip_actual = reference[:, tip], actual[:, tip]
    covered = np.ones(len(time), dtype=bool) if axes is None else ~axes.not_followed[during]
    difference = tip_actual - tip_flight
    root, shock = None, None
    if flown.root is not None and spun.root is not None and covered.any():
        (force_flown, moment_flown), (force_spun, moment_spun) = flown.root, spun.root
        history = RootHistory(in_flight(force_flown), force_spun[during], in_flight(moment_flown), moment_spun[during])
        root = _root(covered, history, in_flight(flown.root_stress), spun.root_stress[during])
    weights = _weights(control, flown)
    sensors = {} if sensors is None else sensors
    felt = _felt(flown, sensors), _felt(spun, sensors)
    if felt[0] is not None and felt[1] is not None and covered.any():
        shock = _shock(time, covered, in_flight(felt[0]), felt[1][during], weights, chosen, sensors, flown)
    first_name, second_name = (run.name or run.environment for run in (flight, centrifuge))
    names = first_name, second_name if second_name != first_name else f"the second {second_name}"
    growth = in_flight(gradients(flown.base.w_WB_B, flown.base.alpha_WB_B))
    rotation_gradients = gradients(spun.base.w_WB_B[during], spun.base.alpha_WB_B[during])
    run = None if axes is None else axes.imitated
    if run is None or not _has_flight_load(run, flight.time[_compared_times(flown, spun, during)], flown.base):
        # By the steps of the responses.
        run = Imitated(centrifuge.time, _interpolated(centrifuge.time, flight.time, flown.base), spun.base, axes)
    run_span = float(time[0]), float(time[-1])
    accounting, load = judge(run, run_span, centrifuge.ends, tolerance=tolerance, tolerance_of=tolerance_of)
    margins = [margin for margin in (flown.margin, spun.margin) if margin is not None]
    return Comparison(
        flight=names[0],
        centrifuge=names[1],
        time=time,
        difference=difference,
        covered=covered,
        max_difference=_largest(difference, covered),
        rms_difference=_rms(difference, covered),
        peak_flight=_largest(tip_flight, covered),
        peak_centrifuge=_largest(tip_actual, covered),
        peaks={"largest_load": load}
        | peak_pairs(flown, spun, during, tip)
        | ({} if stress_at is None else {STRESS_AT: _stresses_at(stress_at, flown, spun, during)}),
        accounting=accounting,
        accept=limits,
        stations=_statistics(time, covered, reference, actual, spun, tip),
        load_difference=_load_difference(covered, spun, (rotation_gradients - growth)[..., 0], tip),
        root=root,
        shock=shock,
        fatigue=fatigue(flown, spun, damage_at),
        yield_strength=spun.yield_strength,
        margins_of_materials=(margins[0], margins[1]) if len(margins) == 2 else None,
        whole=whole_span,
        scale=flight.scale,
        exceeded="" if axes is None else axes.largest_excess,
        kept_every=centrifuge.kept_every,
        point=chosen,
    )  # fmt: skip


_ALIKE = 1e-3  # of the largest load: flights whose loads differ by less are one


def _has_flight_load(run: Imitated, time: Floats, base: Base) -> bool:
    """True if the flight that a machine imitates has the load of a base at the first times (t,), s, of its motion."""
    load = base.a_WO_B[: len(time)]
    imitated = interpolated(time, run.time, run.flight.a_WO_B)
    return bool(np.abs(imitated - load).max() <= _ALIKE * np.abs(load).max())


def _interpolated(time: Floats, times: Floats, base: Base) -> Base:
    """Motion of a base at other times (t,), s."""
    return Base(*(interpolated(time, times, values) for values in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)))


def _largest(values: Floats, covered: Flags) -> Floats:
    """Largest absolute values (...) of histories (t, ...) over the times covered, or NaN if there are none."""
    return np.abs(values[covered]).max(axis=0) if covered.any() else np.full(values.shape[1:], np.nan)


def _rms(values: Floats, covered: Flags) -> Floats:
    """Root mean squares (...) of histories (t, ...) over the times covered, or NaN if there are none."""
    return np.sqrt(np.mean(values[covered] ** 2, axis=0)) if covered.any() else np.full(values.shape[1:], np.nan)


def _statistics(
    time: Floats, covered: Flags, reference: Floats, actual: Floats, machine: Quantities, tip: int
) -> StationStatistics | None:
    """Sizes at each station of the only body, and trend and vibration of the tip, whose number is `tip`.

    None if the samples are too few, too far apart or over too short a time to separate trend and vibration.
    """
    body = machine.body
    if body is None or not body.frequencies.size or len(time) < _FEWEST or not covered.any():
        return None
    step, cutoff = float(time[1] - time[0]), CUTOFF * float(body.frequencies[0]) / (2 * np.pi)
    if not 1 / (len(time) - 1) < cutoff * step < 0.4:
        return None
    residual = covered & ~(time < machine.response.residual_from)  # all if that is NaN
    residual = residual if residual.any() else covered

    def sizes(values: Floats, trend: Floats) -> Sizes:
        """Largest, root mean square, and half range of the residual vibration."""
        vibration = (values - trend)[residual]
        return Sizes(_largest(values, covered), _rms(values, covered), np.ptp(vibration, axis=0) / 2)

    slow, slow_spun = np.moveaxis(low_pass(np.stack([reference, actual], axis=1), step, cutoff), 1, 0)
    return StationStatistics(
        stations=body.stations,
        cutoff=cutoff,
        flight=sizes(reference, slow),
        centrifuge=sizes(actual, slow_spun),
        difference=sizes(actual - reference, slow_spun - slow),
        trend_flight=slow[:, tip],
        trend_centrifuge=slow_spun[:, tip],
        vibration_flight=(reference - slow)[:, tip],
        vibration_centrifuge=(actual - slow_spun)[:, tip],
        tip=tip,
    )


def _load_difference(covered: Flags, machine: Quantities, gradient: Floats, tip: int) -> LoadDifference | None:
    """Difference of the load along a straight beam by its gradient (t, 3) 1/s², and bounds of its effects.

    None for other specimens, and without a control point on the beam.
    """
    axes, body = machine.response.axes, machine.body
    influence = None if body is None else body.influence
    if axes is None or body is None or influence is None or axes.place is not None or not covered.any():
        return None
    if not np.isfinite(axes.control_point):
        return None
    x_c, length, largest = axes.control_point, float(body.stations[-1]), _largest(gradient, covered)

    def bound(linear: Floats, uniform: Floats) -> Floats:
        return np.abs(linear - x_c * uniform) * largest

    return LoadDifference(
        control_point=x_c,
        gradient=gradient,
        max_gradient=largest,
        max_acceleration=largest * max(x_c, length - x_c),
        tip_bound=bound(influence.tip_linear, influence.tip_uniform)
        if tip == influence.station % len(body.stations)
        else np.full(3, np.nan),
        force_bound=bound(influence.force_linear, influence.force_uniform),
        moment_bound=bound(influence.moment_linear, influence.moment_uniform),
        length=length,
        best=_best_control_points(influence),
    )


def _best_control_points(influence: Influence) -> tuple[float, float]:
    """Least and largest of the best control points x_c.

    There a field g (x − x_c) across the beam leaves the root without a moment, or the tip at rest.
    """
    uniform = np.concatenate([influence.moment_uniform[1:], influence.tip_uniform[1:]])
    linear = np.concatenate([influence.moment_linear[1:], influence.tip_linear[1:]])
    answers = uniform != 0  # a model may have no shapes along y
    points = linear[answers] / uniform[answers]
    return float(points.min()), float(points.max())


def _root(covered: Flags, history: RootHistory, stress_flight: Floats, stress_centrifuge: Floats) -> RootLoads:
    """Largest root loads and stress in flight and on the machine, and the largest of their difference."""

    def sizes(reference: Floats, actual: Floats) -> tuple[Floats, Floats, Floats]:
        return _largest(reference, covered), _largest(actual, covered), _largest(actual - reference, covered)

    force = sizes(history.force_flight, history.force_centrifuge)
    moment = sizes(history.moment_flight, history.moment_centrifuge)
    stress = sizes(stress_flight, stress_centrifuge)
    return RootLoads(*force, *moment, float(stress[0]), float(stress[1]), float(stress[2]), history)


def _weights(control: Mapping[str, float] | None, run: Quantities) -> dict[str, float]:
    """Shares of the control points by name. InputError if one is no point, or a weight is not positive."""
    weights = {} if control is None else control
    for name, weight in weights.items():
        positive(f"control.{name}", weight, "(a weight)")
        run.index("control", name)
    return {name: weight / sum(weights.values()) for name, weight in weights.items()}


def _felt(run: Quantities, sensors: Mapping[str, Sensor]) -> Floats | None:
    """Accelerations (t, p, 3) of all points, or what their sensors read, or None if they are not known."""
    if run.acceleration is None or not sensors:
        return run.acceleration
    felt = np.array(run.acceleration)
    for name, sensor in sensors.items():
        with placing_within(f"sensors.{name}"):
            felt[:, run.index("point", name)] = run.response.reading_at(name, sensor)
    return felt


def _shock(
    time: Floats,
    covered: Flags,
    reference: Floats,
    actual: Floats,
    weights: Mapping[str, float],
    tip: str,
    sensors: Mapping[str, Sensor],
    run: Quantities,
) -> Shock | None:
    """Shock response spectra of accelerations (t, p, 3): those at the tip, or their weighted mean at control points.

    None if there are too few samples.
    """
    if len(time) < _FEWEST:
        return None
    step = float(time[1] - time[0])
    lowest, highest = 1 / float(time[-1] - time[0]), _HIGHEST / step
    frequency = np.geomspace(max(lowest, highest / 1000), highest, _SPECTRUM)
    mean = np.zeros((_SPECTRUM, 6))
    for name, share in (weights or {tip: 1.0}).items():
        point = run.index("point", name)
        pair = np.concatenate([reference[:, point], actual[:, point]], axis=1)
        mean += share * largest_oscillator_acceleration(pair, 2 * np.pi * frequency, 0.5 / QUALITY, step, covered)
    if weights:
        words = {name: ", as its sensor reads" if name in sensors else "" for name in weights}
        control = ", ".join(f"{name} ({100 * share:.3g} %{words[name]})" for name, share in weights.items())
    else:
        control = (tip or "the tip") + (" (as its sensor reads)" if (tip or "tip") in sensors else "")
    return Shock(QUALITY, frequency, mean[:, :3], mean[:, 3:], control=control)
