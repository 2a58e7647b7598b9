"""The largest values over a whole flight, in flight and on the machine."""

from __future__ import annotations

import numpy as np

from gbeam.results.accounting import PeakPair
from gbeam.results.response import Response
from gbeam.results.result import Flags, Floats


def peak_pairs(flight: Response, centrifuge: Response, during: slice) -> dict[str, PeakPair]:
    """Largest sizes over the flight's times, each from its own response.

    Parameters
    ----------
    flight, centrifuge : Response
    during : slice
        The centrifuge's samples in the flight's time.

    Returns
    -------
    dict of str to PeakPair
        Of the vectors ``tip``, ``root_force`` and ``root_moment``, and of the ``stress`` at any station; NaN where
        either response does not have it.
    """
    last = centrifuge.time[during][-1]
    one = _peaks(flight, flight.time <= last + 1e-12 * abs(last))
    two = _peaks(centrifuge, during)
    return {name: PeakPair(one[name][0], two[name][0], one[name][1], two[name][1]) for name in one}


def _peaks(response: Response, part: slice | Flags) -> dict[str, tuple[float, float]]:
    """Largest sizes and their times over some of a response's samples."""
    time, loads = response.time[part], response.loads
    sizes = {"tip": np.linalg.norm(response.tip[part], axis=1)}
    if loads is not None:
        sizes["root_force"] = np.linalg.norm(loads.root_force[part], axis=1)
        sizes["root_moment"] = np.linalg.norm(loads.root_moment[part], axis=1)
        sizes["stress"] = loads.stress[part].max(axis=1)

    def peak(size: Floats) -> tuple[float, float]:
        i = int(np.argmax(size))
        return (float(size[i]), float(time[i])) if np.isfinite(size).all() else (np.nan, np.nan)

    known = {name: peak(size) for name, size in sizes.items()}
    return {name: known.get(name, (np.nan, np.nan)) for name in ("tip", "root_force", "root_moment", "stress")}
