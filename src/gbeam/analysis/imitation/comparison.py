"""Two responses compared: a pure function of two results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gbeam.analysis.imitation.accounting import History, account_of, gradients, largest_load, largest_pair, points_of
from gbeam.analysis.imitation.fatigue import fatigue, stress_at_point
from gbeam.analysis.imitation.specimen import specimen_of
from gbeam.arrays.types import Flags, Floats
from gbeam.constants import ToleranceOf
from gbeam.errors import InputError, placing_within
from gbeam.guards.arguments import typed
from gbeam.guards.checks import index_of, positive
from gbeam.guards.kinds import kinds
from gbeam.numerics.peaks import maxima, near_maxima, seven_point, vector_peaks
from gbeam.numerics.samples import interpolated, largest_riding_acceleration, low_pass
from gbeam.results.accounting import TOLERANCE, PeakPair
from gbeam.results.comparison import Comparison
from gbeam.results.criteria import KINDS_OF_LIMITS, STRESS_AT, Limits, checked_limits
from gbeam.results.measures import (
    Mismatch,
    RootHistory,
    RootLoads,
    Shock,
    Sizes,
    Statistics,
)
from gbeam.results.parts import Influence
from gbeam.results.response import Response
from gbeam.results.sensors import Sensor


def peak_pairs(flight: Response, centrifuge: Response, during: slice, tips: tuple[int, int]) -> dict[str, PeakPair]:
    """Largest sizes over the flight's times in each response, by name; `tips` are the stations of the tip in each.
    ``largest_load`` of the machine is over all of its run. NaN stands for a size that a response lacks.
    """
    last = centrifuge.time[during][-1]
    in_flight = _peaks(flight, flight.time <= last + 1e-12 * abs(last), tips[0])
    on_machine = _peaks(centrifuge, during, tips[1])
    points = points_of(float(centrifuge.stations[-1]), centrifuge.bodies, centrifuge.envelope)
    loads = (largest_load(each.time, each.base, points) for each in (flight, centrifuge))
    pairs = {name: PeakPair(a, on_machine[name][0], t, on_machine[name][1]) for name, (a, t) in in_flight.items()}
    return {"largest_load": largest_pair(*loads)} | pairs


def _peaks(response: Response, part: slice | Flags, tip: int) -> dict[str, tuple[float, float]]:
    """Largest sizes of a response over a part of its times, between steps, and their times, by name."""
    time, peaks = response.time[part], response.peaks
    known = {"tip": (peaks.max_size, peaks.time_of_max_size)}
    if tip != len(response.stations) - 1 and peaks.displacement is not None:
        known["tip"] = float(peaks.displacement.size.value[tip]), float(peaks.displacement.size.time[tip])
    samples = {"tip": lambda: vector_peaks(time, response.displacement[part, tip])}
    if response.solid is not None:
        von_mises = response.solid.von_mises[part, None]
        if response.solid.known:
            samples["stress"] = lambda: _between_steps(time, von_mises)
    elif response.loads is not None:
        loads = response.loads
        stress = np.concatenate([loads.stress_tension[part], -loads.stress_compression[part]], axis=1)
        if np.isfinite(stress).all():
            samples["stress"] = lambda: _between_steps(time, stress)
    if response.loads is not None:
        carried = response.loads
        samples |= {
            "root_force": lambda: vector_peaks(time, carried.section_force[part, 0]),
            "root_moment": lambda: vector_peaks(time, carried.section_moment[part, 0]),
        }
    if peaks.loads is not None:
        worst = int(np.argmax(peaks.loads.stress.value))
        extremes = {
            "root_force": (peaks.loads.force.size, 0),
            "root_moment": (peaks.loads.moment.size, 0),
            "stress": (peaks.loads.stress, worst),
        }
        known |= {name: (float(e.value[k]), float(e.time[k])) for name, (e, k) in extremes.items()}

    def peak(name: str) -> tuple[float, float]:
        """The peak of all the response if it lies in the part, else the largest of the part's samples."""
        value, when = known.get(name, (np.nan, np.nan))
        if np.isfinite(value) and time[0] <= when <= time[-1]:
            return value, when
        if name not in samples:
            return np.nan, np.nan
        values, times = samples[name]()
        most = int(np.argmax(values))
        return float(values[most]), float(times[most])

    names = ("tip", "root_force", "root_moment", "stress")
    return {name: peak(name) for name in names if name != "tip" or response.q.shape[1]}  # a rigid tip does not move


def _between_steps(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Largest of each history (t, k), known at samples alone, and its time, (k,) each."""
    return maxima(time, values, *seven_point(time, values, near_maxima(time, values)))


def _stresses_at(
    at: str, flight: Response, centrifuge: Response, during: slice
) -> PeakPair:
    """Largest stress at a named point over the flight's times in each response; NaN if either has none there."""
    last, largest = centrifuge.time[during][-1], []
    for response, part in ((flight, flight.time <= last + _ROUNDING * abs(last)), (centrifuge, during)):
        stress = stress_at_point(response, at)
        if stress is None or not np.isfinite(stress[part]).all():
            return PeakPair(place_flight=at, place_machine=at)
        value, time = _between_steps(response.time[part], stress[part, None])
        largest.append((float(value[0]), float(time[0])))
    (in_flight, time_flight), (on_machine, time_machine) = largest
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
    tolerance: float = TOLERANCE,
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
        Over the flight's times: peaks and accounting of all of them, the rest without those at which the target was
        held. Root loads and spectra need the responses' loads, the mismatch's bounds their influence, trend and
        vibration their frequencies.

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
    limits, chosen = checked_limits(accept), point or ""
    runs = flight, centrifuge
    if isinstance(flight, SystemResponse) and isinstance(centrifuge, SystemResponse):
        chosen = chosen or flight.points[int(flight.largest.argmax())]
        flight, centrifuge = specimen_of(flight), specimen_of(centrifuge)
    if isinstance(flight, SystemResponse) or isinstance(centrifuge, SystemResponse):
        raise InputError("centrifuge", "and flight are a system and a beam", "give two responses of one specimen")
    flown, reproduced = (float(flight.time[0]), float(flight.time[-1])), centrifuge.flight_span
    first, last = max(flown[0], reproduced[0]), min(flown[1], reproduced[1])
    slack = _ROUNDING * max(map(abs, flown))
    begin, end = np.searchsorted(centrifuge.time, (first - slack, last + slack))
    during = slice(int(begin), int(end))  # spin-up and spin-down are not the flight's
    time = centrifuge.time[during]
    if not len(time):
        raise InputError("centrifuge", "has no time in common with the flight", "compute both for the same times")

    short = time[0] > flown[0] + slack or time[-1] < flown[1] - slack
    whole = flown if short and flight.whole is None else flight.whole

    def in_flight(values: Floats) -> Floats:
        return interpolated(time, flight.time, values)

    length, axes = float(centrifuge.stations[-1]), centrifuge.axes
    tips = _station(flight, chosen), _station(centrifuge, chosen)
    reference, actual = in_flight(flight.displacement), centrifuge.displacement[during]
    tip_flight, tip_actual = reference[:, tips[0]], actual[:, tips[1]]
    covered = np.ones(len(time), dtype=bool) if axes is None else ~axes.not_followed[during]
    difference = tip_actual - tip_flight
    root, shock = None, None
    if flight.loads is not None and centrifuge.loads is not None and covered.any():
        a, b = flight.loads, centrifuge.loads
        history = RootHistory(
            in_flight(a.section_force[:, 0]), b.section_force[during, 0],
            in_flight(a.section_moment[:, 0]), b.section_moment[during, 0],
        )  # fmt: skip
        root = _root(covered, history, in_flight(a.stress[:, 0]), b.stress[during, 0])
    weights = _weights(control, flight, centrifuge)
    sensors = {} if sensors is None else sensors
    felt = _felt(runs[0], flight, sensors), _felt(runs[1], centrifuge, sensors)
    if felt[0] is not None and felt[1] is not None and covered.any():
        shock = _shock(time, covered, in_flight(felt[0]), felt[1][during], weights, chosen, sensors, flight, centrifuge)
    first_name, second_name = (run.name or run.environment for run in (flight, centrifuge))
    names = first_name, second_name if second_name != first_name else f"the second {second_name}"
    growth = in_flight(gradients(flight.base.w_WB_B, flight.base.alpha_WB_B))
    spun = gradients(centrifuge.base.w_WB_B[during], centrifuge.base.alpha_WB_B[during])
    of_beam, root_load = not len(centrifuge.envelope), in_flight(flight.base.a_WO_B)
    ends = np.array([[length, 0.0, 0.0]]) if of_beam else centrifuge.envelope
    machine_root = centrifuge.base.a_WO_B[during]
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
        peaks=peak_pairs(flight, centrifuge, during, tips)
        | ({} if stress_at is None else {STRESS_AT: _stresses_at(stress_at, *runs, during)}),
        accounting=account_of(
            time, History(root_load, root_load, growth, ends),
            History(machine_root if axes is None else axes.actual[during], machine_root, spun, ends),
            axes, during, tolerance=tolerance, tolerance_of=tolerance_of,
        ),
        accept=limits,
        stations=_statistics(time, covered, reference, actual, centrifuge, tips),
        mismatch=_mismatch(covered, centrifuge, (spun - growth)[..., 0], tips[1]) if of_beam else None,
        root=root,
        shock=shock,
        fatigue=fatigue(*runs, damage_at),
        yield_strength=None if centrifuge.loads is None else centrifuge.loads.yield_strength,
        margins_of_materials=_of_materials(flight, centrifuge),
        whole=whole,
        scale=flight.scale,
        exceeded="" if axes is None else axes.beyond,
        kept_every=centrifuge.kept_every,
        point=chosen,
    )  # fmt: skip


def _of_materials(flight: Response, centrifuge: Response) -> tuple[float, float] | None:
    """Least margins on yield of solids in flight and on the machine; None if either is not known."""
    nearest = [None if run.solid is None else run.solid.nearest_yield for run in (flight, centrifuge)]
    in_flight, on_machine = (None if point is None else point.margin for point in nearest)
    return None if in_flight is None or on_machine is None else (in_flight, on_machine)


def _largest(values: Floats, covered: Flags) -> Floats:
    return np.abs(values[covered]).max(axis=0) if covered.any() else np.full(values.shape[1:], np.nan)


def _rms(values: Floats, covered: Flags) -> Floats:
    return np.sqrt(np.mean(values[covered] ** 2, axis=0)) if covered.any() else np.full(values.shape[1:], np.nan)


def _station(response: Response, point: str) -> int:
    """Number of the station of a named point, by default of the tip, the last."""
    return index_of("point", point, response.points) if point else len(response.stations) - 1


def _statistics(
    time: Floats, covered: Flags, reference: Floats, actual: Floats, centrifuge: Response, tips: tuple[int, int]
) -> Statistics | None:
    """Sizes at each station, and trend and vibration of the tip, whose stations in both runs are `tips`; None if the
    samples are too few, too far apart or over too short a time to part trend from vibration.
    """
    if not centrifuge.frequencies.size or len(time) < _FEWEST or not covered.any():
        return None
    step, cutoff = float(time[1] - time[0]), CUTOFF * float(centrifuge.frequencies[0]) / (2 * np.pi)
    if not 1 / (len(time) - 1) < cutoff * step < 0.4:
        return None
    late = covered & ~(time < centrifuge.residual_from)  # all if that is NaN
    late = late if late.any() else covered

    def sizes(values: Floats, trend: Floats) -> Sizes:
        """Largest, root mean square, and half range of the residual vibration."""
        left = (values - trend)[late]
        return Sizes(_largest(values, covered), _rms(values, covered), np.ptp(left, axis=0) / 2)

    slow, slow_spun = np.moveaxis(low_pass(np.stack([reference, actual], axis=1), step, cutoff), 1, 0)
    return Statistics(
        stations=centrifuge.stations,
        cutoff=cutoff,
        flight=sizes(reference, slow),
        centrifuge=sizes(actual, slow_spun),
        difference=sizes(actual - reference, slow_spun - slow),
        trend_flight=slow[:, tips[0]],
        trend_centrifuge=slow_spun[:, tips[1]],
        vibration_flight=(reference - slow)[:, tips[0]],
        vibration_centrifuge=(actual - slow_spun)[:, tips[1]],
        tip=tips[1],
    )


def _mismatch(covered: Flags, centrifuge: Response, gradient: Floats, tip: int) -> Mismatch | None:
    """Mismatch along a beam by the gradient (t, 3) 1/s², and bounds of its effects; None without a control point."""
    if centrifuge.axes is None or not np.isfinite(centrifuge.axes.control_point) or not covered.any():
        return None
    if centrifuge.axes.place is not None:  # beside the beam
        return None
    x_c, length = centrifuge.axes.control_point, float(centrifuge.stations[-1])
    largest, influence = _largest(gradient, covered), centrifuge.influence
    unknown = np.full(3, np.nan)

    def bound(linear: Floats, uniform: Floats) -> Floats:
        return np.abs(linear - x_c * uniform) * largest

    return Mismatch(
        control_point=x_c,
        gradient=gradient,
        max_gradient=largest,
        max_acceleration=largest * max(x_c, length - x_c),
        tip_bound=unknown
        if influence is None or tip != len(centrifuge.stations) - 1
        else bound(influence.tip_linear, influence.tip_uniform),
        force_bound=unknown if influence is None else bound(influence.force_linear, influence.force_uniform),
        moment_bound=unknown if influence is None else bound(influence.moment_linear, influence.moment_uniform),
        length=length,
        best=(-np.inf, np.inf) if influence is None else _best_control_points(influence),
    )


def _best_control_points(influence: Influence) -> tuple[float, float]:
    """Control points at which a field g (x − x_c) across the beam leaves the root no moment, or the tip at rest."""
    uniform = np.concatenate([influence.moment_uniform[1:], influence.tip_uniform[1:]])
    linear = np.concatenate([influence.moment_linear[1:], influence.tip_linear[1:]])
    felt = uniform != 0  # a model may have no shapes along y
    points = linear[felt] / uniform[felt]
    return float(points.min()), float(points.max())


def _root(covered: Flags, history: RootHistory, stress_flight: Floats, stress_centrifuge: Floats) -> RootLoads:
    """Largest root loads and stress in flight, on the machine, and of their difference."""

    def sizes(reference: Floats, actual: Floats) -> tuple[Floats, Floats, Floats]:
        return _largest(reference, covered), _largest(actual, covered), _largest(actual - reference, covered)

    force = sizes(history.force_flight, history.force_centrifuge)
    moment = sizes(history.moment_flight, history.moment_centrifuge)
    stress = sizes(stress_flight, stress_centrifuge)
    return RootLoads(*force, *moment, float(stress[0]), float(stress[1]), float(stress[2]), history)


def _weights(control: Mapping[str, float] | None, *responses: Response) -> dict[str, float]:
    """Shares of the control points by name; InputError if a response lacks one, or a weight is not positive."""
    for name, weight in ({} if control is None else control).items():
        positive(f"control.{name}", weight, "(a weight)")
        for response in responses:
            if name not in response.points:
                raise InputError(f"control.{name}", "is no point", f"choose from {', '.join(response.points)}")
    total = sum(({} if control is None else control).values())
    return {} if control is None else {name: weight / total for name, weight in control.items()}


def _felt(run: Response, response: Response, sensors: Mapping[str, Sensor]) -> Floats | None:
    """Accelerations (t, s, 3) of all points, or readings at points with sensors; None if not known."""
    felt = response.accelerations
    if felt is None or not sensors:
        return felt
    felt = np.array(felt)
    for name, sensor in sensors.items():
        with placing_within(f"sensors.{name}"):
            felt[:, _station(response, name)] = run.reading_at(name, sensor)
    return felt


def _shock(
    time: Floats,
    covered: Flags,
    reference: Floats,
    actual: Floats,
    weights: Mapping[str, float],
    tip: str,
    sensors: Mapping[str, Sensor],
    *responses: Response,
) -> Shock | None:
    """Shock response spectra by accelerations (t, s, 3) at the tip, or their weighted mean at control points; None if
    samples are few.
    """
    if len(time) < _FEWEST:
        return None
    step = float(time[1] - time[0])
    lowest, highest = 1 / float(time[-1] - time[0]), _HIGHEST / step
    frequency = np.geomspace(max(lowest, highest / 1000), highest, _SPECTRUM)
    mean = np.zeros((_SPECTRUM, 6))
    for name, share in (weights or {tip: 1.0}).items():
        of_flight, of_machine = (_station(response, name) for response in responses)
        pair = np.concatenate([reference[:, of_flight], actual[:, of_machine]], axis=1)
        mean += share * largest_riding_acceleration(pair, 2 * np.pi * frequency, 0.5 / QUALITY, step, covered)
    read = dict.fromkeys(sensors, ", as its sensor reads")
    control = ", ".join(f"{name} ({100 * share:.3g} %{read.get(name, '')})" for name, share in weights.items())
    control = control or (tip or "the tip") + (" (as its sensor reads)" if (tip or "tip") in sensors else "")
    return Shock(QUALITY, frequency, mean[:, :3], mean[:, 3:], control=control)
