"""Strain gauges on the faces of a beam."""

from __future__ import annotations

import math
from collections.abc import Iterable

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.results.state_space import Gauge
from gbeam.structure.beam import Beam


@typed
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
        try:
            gauges += [surface_gauge(beam, at, face) for face in ("z", "y")]
        except InputError as error:
            raise error.within(f"stations[{i}]") from None
    return gauges


def surface_gauge(beam: Beam, at: float, face: str) -> Gauge:
    """Return the gauge `at` m from the root on the extreme fibre towards a face, ``z``, ``-z``, ``y`` or ``-y``."""
    if not 0 <= at <= beam.length:
        raise InputError("", f"is {at:g} m, off the beam", f"give 0 to {beam.length:g} m")
    sign, axis = -1.0 if face.startswith("-") else 1.0, face[-1]
    fibre = sign * float(getattr(beam.section.at(at), f"extreme_fibre_{axis}"))
    if not math.isfinite(fibre):
        raise InputError("", "needs the extreme fibres", "add extreme_fibre_y and extreme_fibre_z to beam.section")
    return Gauge(at, **{axis: fibre})
