"""The largest values over a whole flight, in flight and on the machine."""

from __future__ import annotations

import numpy as np

from gbeam.analysis.imitation.largest import largest_load, largest_pair, points_of
from gbeam.analysis.response.peaks import vector_peaks
from gbeam.numerics.peaks import maxima, near_maxima, seven_point
from gbeam.results.imitation.accounting import PeakPair
from gbeam.results.response import Response
from gbeam.results.result import Flags


def peak_pairs(flight: Response, centrifuge: Response, during: slice) -> dict[str, PeakPair]:
    """Largest sizes over the flight's times in each response, by name; ``largest_load`` on the machine is over all of
    its run, and NaN stands where a response lacks one.
    """
    last = centrifuge.time[during][-1]
    one = _peaks(flight, flight.time <= last + 1e-12 * abs(last))
    two = _peaks(centrifuge, during)
    points = points_of(float(centrifuge.stations[-1]), centrifuge.bodies)
    loads = (largest_load(each.time, each.base, points) for each in (flight, centrifuge))
    pairs = {name: PeakPair(one[name][0], two[name][0], one[name][1], two[name][1]) for name in one}
    return {"largest_load": largest_pair(*loads)} | pairs


def _peaks(response: Response, part: slice | Flags) -> dict[str, tuple[float, float]]:
    """Largest sizes between steps and their times, where they lie in some of a response's time."""
    time, of = response.time[part], response.peaks
    known = {"tip": (of.max_size, of.time_of_max_size)}
    samples = {"tip": lambda: vector_peaks(time, response.tip[part])}
    if response.loads is not None:
        loads = response.loads
        stress = np.concatenate([loads.stress_tension[part], -loads.stress_compression[part]], axis=1)
        samples |= {
            "root_force": lambda: vector_peaks(time, loads.section_force[part, 0]),
            "root_moment": lambda: vector_peaks(time, loads.section_moment[part, 0]),
            "stress": lambda: maxima(time, stress, *seven_point(time, stress, near_maxima(time, stress))),
        }
        if not np.isfinite(stress).all():
            del samples["stress"]
    if of.loads is not None:
        worst = int(np.argmax(of.loads.stress.value))
        extremes = {
            "root_force": (of.loads.force.size, 0),
            "root_moment": (of.loads.moment.size, 0),
            "stress": (of.loads.stress, worst),
        }
        known |= {name: (float(e.value[k]), float(e.time[k])) for name, (e, k) in extremes.items()}

    def peak(name: str) -> tuple[float, float]:
        value, when = known.get(name, (np.nan, np.nan))
        if np.isfinite(value) and time[0] <= when <= time[-1]:
            return value, when
        if name not in samples:
            return np.nan, np.nan
        # The response's own largest lies elsewhere, where the two cover different times.
        values, times = samples[name]()
        most = int(np.argmax(values))
        return float(values[most]), float(times[most])

    return {name: peak(name) for name in ("tip", "root_force", "root_moment", "stress")}
