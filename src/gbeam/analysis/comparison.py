"""Two responses compared: a pure function of two results."""

from __future__ import annotations

import numpy as np

from gbeam.results import Comparison, Response


def compare(flight: Response, centrifuge: Response) -> Comparison:
    """Compare the tip's displacement on a centrifuge with that in the flight it imitates.

    Parameters
    ----------
    flight, centrifuge : Response
        Sampled at any times; the flight's are interpolated where they differ.

    Returns
    -------
    Comparison
        Over the centrifuge's times, without those at which its target was held.
    """
    time = centrifuge.time[centrifuge.time <= flight.time[-1] * (1 + 1e-12)]
    n = len(time)
    there = np.stack([np.interp(time, flight.time, flight.tip[:, i]) for i in range(3)], axis=1)
    here = centrifuge.tip[:n]
    covered = np.ones(n, dtype=bool) if centrifuge.axes is None else ~centrifuge.axes.held[:n]
    difference = here - there

    def largest(values: np.ndarray) -> np.ndarray:
        return np.abs(values[covered]).max(axis=0) if covered.any() else np.full(3, np.nan)

    return Comparison(
        flight=flight.name,
        centrifuge=centrifuge.name,
        time=time,
        difference=difference,
        covered=covered,
        max_difference=largest(difference),
        rms_difference=np.sqrt(np.mean(difference[covered] ** 2, axis=0)) if covered.any() else np.full(3, np.nan),
        peak_flight=largest(there),
        peak_centrifuge=largest(here),
    )
