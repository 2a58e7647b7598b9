"""How much a machine's run damages the root of the specimen, beside the flight's."""

from __future__ import annotations

import numpy as np

from gbeam.numerics.peaks import turning_points
from gbeam.results.imitation.measures import Fatigue, StressCycles
from gbeam.results.response import Response
from gbeam.results.result import Floats

_NOTHING = 1e-9  # of the largest stress: a smaller cycle is rounding


def fatigue(flight: Response, machine: Response) -> Fatigue | None:
    """Rainflow cycles of the root's stress in both runs, with the flight's material's exponent; None where one has no
    stress.
    """
    loads = flight.loads
    stresses = [None if each.loads is None else each.loads.root_fibre for each in (flight, machine)]
    if loads is None or any(stress is None or not np.isfinite(stress).all() for stress in stresses):
        return None
    cycles = (
        stress_cycles(response.time, stress)
        for response, stress in zip((flight, machine), stresses, strict=True)
        if stress is not None
    )
    return Fatigue(loads.fatigue_exponent, *cycles)


def stress_cycles(time: Floats, stress: Floats) -> StressCycles:
    """Rainflow cycles of a stress over time (t,), s, Pa, with its extremes between samples."""
    import rainflow

    rows = [row[:3] for row in rainflow.extract_cycles(turning_points(time, stress).tolist())]
    cycles = np.array(rows, dtype=float).reshape(-1, 3)
    cycles = cycles[cycles[:, 0] > _NOTHING * np.abs(stress).max()]
    return StressCycles(*cycles[np.argsort(-cycles[:, 0], kind="stable")].T)
