"""A model with all its nonlinearity as a python-control system."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gbeam.analysis.control.linearization import (
    BASE_RATES,
    coordinate_signals,
    input_signals,
    output_signals,
    outputs_of,
)
from gbeam.analysis.steady.operating_point import REST, on_base, on_hub
from gbeam.guards.arguments import typed
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.state_space import Gauge, import_control


@typed
def nonlinear_system(structure: Structure, motion: Motion, *, gauges: Sequence[Gauge] = ()) -> Any:
    """The model as ``control.nlsys``, complete: on a free hub driven by the torque, on any other base by its motion.

    States are (y, ẏ) and, on a base that is not a free hub, the base's angular velocity; inputs and outputs are those
    of :func:`gbeam.linearize`, not as departures but whole.

    Parameters
    ----------
    structure : Structure
    motion : Flight, Centrifuge or Hub
        Tells the kind of base only.
    gauges : sequence of Gauge

    Raises
    ------
    InputError
        If python-control is not installed.
    """
    control = import_control()
    from gbeam.mechanics.equations.compiled import rates

    straight = np.zeros(structure.size)
    if motion.free:
        point, states = on_hub(structure, motion, 0.0, q=straight), coordinate_signals(structure, 1)
    else:
        point, states = on_base(structure, REST, straight), coordinate_signals(structure, 0) + BASE_RATES
    outputs = outputs_of(structure, point, gauges)

    def update(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.asarray(rates(outputs, np.asarray(x, dtype=float), np.asarray(u, dtype=float))[0])

    def measure(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.asarray(rates(outputs, np.asarray(x, dtype=float), np.asarray(u, dtype=float))[1])

    return control.nlsys(
        update,
        measure,
        states=[signal.name for signal in states],
        inputs=[signal.name for signal in input_signals(structure, motion)],
        outputs=[signal.name for signal in output_signals(gauges, motion)],
        name=structure.kind,
    )
