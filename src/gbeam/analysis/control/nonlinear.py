"""A model with all its nonlinearity as a python-control system."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.analysis.control.linearization import (
    BASE_RATES,
    Gauge,
    Outputs,
    coordinate_signals,
    input_signals,
    output_signals,
    outputs_of,
)
from gbeam.analysis.control.state_space import import_control
from gbeam.analysis.equilibrium.operating_point import on_base, on_hub
from gbeam.analysis.study.case import Motion
from gbeam.mechanics.assembly import Structure
from gbeam.motion import Base, HubTorque


@eqx.filter_jit
def _rates(outputs: Outputs, x: Array, u: Array) -> tuple[Array, Array]:
    """State's rate and outputs."""
    residual, i = outputs.point.residual, outputs.point.first
    n = len(outputs.point.y)
    y, yd, rate = x[:n], x[n : 2 * n], x[2 * n :]
    full = u if i else jnp.concatenate([u[:3], rate, u[3:]])
    o = jnp.zeros(n)
    ydd = jnp.linalg.solve(jax.jacfwd(residual, 2)(y, yd, o, full), -residual(y, yd, o, full))
    return jnp.concatenate([yd, ydd, u[3:6] if not i else jnp.zeros(0)]), outputs(y, yd, ydd, full)


def nonlinear_system(structure: Structure, motion: Motion, *, gauges: Sequence[Gauge] = ()) -> Any:
    """The model as ``control.nlsys``, complete: on a free hub driven by the torque, on any other base by its motion.

    States are (y, ẏ) and, on a base that is not a free hub, the base's angular velocity; inputs and outputs are those
    of :func:`gbeam.analysis.linearize`, not as departures but whole.

    Parameters
    ----------
    structure : Structure
    motion : Flight, Centrifuge, HubRate or HubTorque
        Tells the kind of base only.
    gauges : sequence of Gauge

    Raises
    ------
    InputError
        If python-control is not installed.
    """
    control = import_control()
    rest = jnp.zeros(structure.size)
    if isinstance(motion, HubTorque):
        point = on_hub(structure, motion, 0.0, q=rest)
        states = coordinate_signals(structure, 1)
    else:
        o = jnp.zeros(3)
        point = on_base(structure, Base(o, o, o), rest)
        states = coordinate_signals(structure, 0) + BASE_RATES
    outputs = outputs_of(structure, point, gauges)

    def update(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.asarray(_rates(outputs, jnp.asarray(x), jnp.asarray(u))[0])

    def measure(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.asarray(_rates(outputs, jnp.asarray(x), jnp.asarray(u))[1])

    return control.nlsys(
        update,
        measure,
        states=[it.name for it in states],
        inputs=[it.name for it in input_signals(structure, motion)],
        outputs=[it.name for it in output_signals(gauges, motion)],
        name=structure.kind,
    )
