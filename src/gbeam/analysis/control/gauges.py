"""Strain gauges on the faces of a beam."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gbeam.errors import InputError
from gbeam.results.steady.state_space import Gauge
from gbeam.structure.beam import Beam


def surface_gauges(beam: Beam, stations: Iterable[float]) -> list[Gauge]:
    """Two gauges at each station, on the extreme fibres towards +z and +y.

    Parameters
    ----------
    beam : Beam
    stations : iterable of float
        From the root, m.

    Raises
    ------
    InputError
        If a station is off the beam, or the extreme fibres of its section are not known.
    """
    gauges: list[Gauge] = []
    for i, at in enumerate(stations):
        if not 0 <= at <= beam.length:
            raise InputError(f"stations[{i}]", f"is {at:g} m, off the beam", f"give 0 to {beam.length:g} m")
        section = beam.section.at(np.array([at]))
        y, z = float(section.extreme_fibre_y[0]), float(section.extreme_fibre_z[0])
        if not np.isfinite((y, z)).all():
            fix = "add extreme_fibre_y and extreme_fibre_z to beam.section"
            raise InputError(f"stations[{i}]", "needs the extreme fibres", fix)
        gauges += [Gauge(at, z=z), Gauge(at, y=y)]
    return gauges
