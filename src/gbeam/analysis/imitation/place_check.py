"""A placement checked by simulation: the model's own response at a control point, against that in flight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np

from gbeam.analysis.imitation.comparison import CUTOFF, compare
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.structure import Structure
from gbeam.motion import Base, Centrifuge, Flight
from gbeam.numerics.filters.low_pass import low_pass
from gbeam.numerics.interpolation import interpolated
from gbeam.results.imitation.placement import Verification
from gbeam.results.response import Response
from gbeam.results.result import Floats


@record
class _Carried:
    """A base in translation with the load that a centrifuge makes at its control point: no mismatch anywhere."""

    kind: ClassVar[str] = "flight"
    free: ClassVar[bool] = False
    centrifuge: Centrifuge

    def base(self, t: Any) -> Base:
        load = self.centrifuge.actual(t)
        none = namespace(load).zeros_like(load)
        return Base(load, none, none)

    def corners(self, step: float) -> Floats:
        return self.centrifuge.corners(step)

    def over(self, start: float, end: float) -> Self:
        return self

    def beyond(self, start: float, end: float) -> tuple[float, float]:
        return self.centrifuge.beyond(start, end)


def verify(
    structure: Structure, flight: Flight, machines: Mapping[str, Centrifuge], settings: ResponseSettings
) -> tuple[Verification, ...]:
    """Simulate flight and machines, prepared for the settings' span and named by their places, and compare."""
    settings = replace(settings, estimate=False)  # a verification states none
    in_flight = simulate(structure, flight, settings)
    cutoff = CUTOFF * float(in_flight.frequencies[0]) / (2 * np.pi)
    # Machines at different control points share their axis motions, and the current one may be at the middle.
    carried: dict[int, Response] = {}
    responses: dict[tuple[int, float], Response] = {}
    verifications = []
    for name, machine in machines.items():
        motion, at = id(machine.course), float(machine.control_point)
        if (motion, at) not in responses:
            responses[motion, at] = simulate(structure, machine, settings)
        if motion not in carried:
            carried[motion] = simulate(structure, _Carried(machine), settings)
        response = responses[motion, at]
        comparison = compare(in_flight, response)
        # Whose automatic step may differ.
        own = interpolated(response.time, carried[motion].time, carried[motion].tip)
        swing = response.tip - own
        swing -= low_pass(swing, float(response.time[1] - response.time[0]), cutoff)
        compared = np.isin(response.time, comparison.time[comparison.covered])
        force, moment = np.nan, np.nan
        if comparison.root is not None:
            root = comparison.root
            force, moment = (float(each[1:].max()) for each in (root.force_difference, root.moment_difference))
        verifications.append(
            Verification(
                name,
                at,
                _largest(comparison.difference[comparison.covered]),
                _largest(swing[compared]),
                moment,
                force,
            )
        )
    return tuple(verifications)


def _largest(vectors: Floats) -> float:
    """Of the parts across the beam."""
    return float(np.linalg.norm(vectors[:, 1:], axis=1).max(initial=0.0))
