"""Quantities of a system read from its coordinates: motions of points, efforts, loads along beams, invariants."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, as_array, namespace
from gbeam.arrays.types import Floats
from gbeam.mechanics.fields.products import turned
from gbeam.mechanics.reactions import Hung
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import Acting
from gbeam.mechanics.tree.body_terms import stations_of
from gbeam.mechanics.tree.closures import DIRECTIONS
from gbeam.mechanics.tree.equations import Inputs, State
from gbeam.mechanics.tree.signal_names import deforming
from gbeam.mechanics.tree.steps import parameters_of_matrices
from gbeam.mechanics.tree.system import System
from gbeam.results.parts import Base, Loads

_OF_BASE = "a_WO_B", "w_WB_B", "alpha_WB_B"
ROUNDING = 1e-12  # of the force times the length: a smaller moment is rounding; likewise a force


class Carried(NamedTuple):
    """A body over time: coordinates, rates, accelerations (t, n), motion (t, 3) of its root, loads on its stations."""

    q: Floats
    qd: Floats
    qdd: Floats
    base: Base
    hung: Hung

    @classmethod
    def joined(cls, pieces: list[Carried]) -> Carried:
        """Join pieces of a body's history, one after the other in time."""
        if len(pieces) == 1:
            return pieces[0]
        first = pieces[0]
        xp = namespace(*first[:3])
        base = Base(*(xp.concatenate([getattr(piece.base, name) for piece in pieces]) for name in _OF_BASE))
        force = xp.concatenate([piece.hung.force for piece in pieces])
        moment = xp.concatenate([piece.hung.moment for piece in pieces])
        q, qd, qdd = (xp.concatenate([piece[k] for piece in pieces]) for k in range(3))
        return cls(q, qd, qdd, base, Hung(first.hung.station, force, moment))

    def select(self, times: Any) -> Carried:
        """Return the body at an index, slice or array of the times."""
        if isinstance(times, slice) and times == slice(None):
            return self
        base = Base(*(getattr(self.base, name)[times] for name in _OF_BASE))
        return Carried(self.q[times], self.qd[times], self.qdd[times], base, self.hung.during(times))


def histories(
    system: System, y: Array, yd: Array, ydd: Array, inputs: Inputs, *, inertial: bool
) -> tuple[dict[str, Floats], dict[str, Carried]]:
    """Histories by key of points, coordinates, efforts and the ground's load, and the states of flexible bodies by
    name.

    They follow from free coordinates (t, n) and rates. If the ground is `inertial`, they include momentum and energy.
    """
    tree = system.tree
    state = tree.motion(y, yd, ydd, inputs)
    frames = state.every_point
    inputs = tree.closed(state, inputs)
    rows, ground, acting = tree.demanded(state, inputs)
    full_state = [y, yd]
    if inputs.prescribed is not None:
        full_state = [tree.complete(unknown, inputs.prescribed[:, k]) for k, unknown in enumerate(full_state)]
    xp = namespace(rows)
    effort = xp.zeros_like(full_state[0]) if inputs.efforts is None else inputs.efforts
    effort = xp.where(np.isin(np.arange(tree.size), tree.fixed), rows, effort)
    values = {
        "place": xp.stack([frame.p for frame in frames], axis=1),
        "velocity": xp.stack([turned(frame.R, frame.v) for frame in frames], axis=1),
        "acceleration": xp.stack([frame.a for frame in frames], axis=1),
        "attitude": xp.stack([parameters_of_matrices(frame.R) for frame in frames], axis=1),
        "angular_velocity": xp.stack([frame.w for frame in frames], axis=1),
        "q": full_state[0],
        "qd": full_state[1],
        "effort": effort,
        "ground_force": -ground.force,
        "ground_moment": -ground.moment,
    }
    if tree.closures:
        gaps, wrenches = tree.gaps(state), np.asarray(inputs.closing)
        gaps = gaps.reshape(*gaps.shape[:-1], -1, 2, 3)
        lost = np.isin(np.arange(DIRECTIONS * len(tree.closures)), tree.conditions, invert=True)
        loads = np.where(lost.reshape(-1, 2, 3), np.nan, wrenches.reshape(gaps.shape))
        sizes = np.linalg.norm(gaps, axis=-1)
        values |= {"gap": sizes[..., 0], "gap_angle": sizes[..., 1]}
        values |= {"closing_force": loads[..., 0, :], "closing_moment": loads[..., 1, :]}
    if inertial:
        gravity = np.zeros(3) if system.gravity is None else as_array(system.gravity)
        momentum, spin, energy = tree.invariants(state, gravity)
        values |= {"momentum": momentum, "angular_momentum": spin, "energy": energy}
    return values, {name: carried(system, state, name, acting) for name in system.flexible}


def deflections(body: Structure, q: Array) -> Array:
    """Displacements (t, p, 3) m of a body's named points relative to its root, by its own coordinates (t, n)."""
    return body.station_displacement(q, np.array([*stations_of(body).values()]))


def deflection(system: System, point: str, q: Array) -> Array | None:
    """Displacement (t, 3) m of a named point relative to the root of its flexible body, from coordinates (t, n). None
    if the point belongs to a rigid body.
    """
    name, k = system.point("point", point)
    body = system.flexible.get(name)
    if body is None or k >= len(stations_of(body)):
        return None
    return deflections(body, q[:, deforming(system.coordinates, name)])[:, k]


def carried(system: System, state: State, name: str, acting: list[list[Acting]]) -> Carried:
    """State of one flexible body over time. `acting` has the wrenches on the points of every body."""
    k = system.order.index(name)
    places, root = list(stations_of(system.bodies[name]).values()), state.roots[k]  # type: ignore[arg-type]
    q, qd, qdd = (values[k][-1] for values in (state.q, state.qd, state.qdd))
    wrenches = [at_point.wrench.brought(at_point.by) for at_point in acting[k]]
    zeros = np.zeros((len(q), 0, 3))
    force, moment = (
        namespace(q).stack([getattr(wrench, part) for wrench in wrenches], axis=1) if wrenches else zeros
        for part in ("force", "moment")
    )
    hung = Hung(np.array([places[at_point.point] for at_point in acting[k]], dtype=int), force, moment)
    return Carried(q, qd, qdd, Base(root.a, root.w, root.alpha), hung)


def loads_of(body: Structure, state: Carried, time: Floats) -> Loads:
    """Loads along a body at times (t,) s, from its state at these times."""
    loads = section_forces(body, state.base, state.q, state.qd, state.qdd, time, hung=state.hung)
    xp = namespace(loads.force)
    force, moment = xp.abs(loads.force).max(axis=(0, 2)), xp.abs(loads.moment).max(axis=(0, 2))
    # A joint that is free carries nothing but rounding.
    idle = {"force": force * body.length <= ROUNDING * moment, "moment": moment <= ROUNDING * force * body.length}
    fields = dict[str, Any]()
    for name, shape in idle.items():
        for key in (name, f"section_{name}"):
            fields[key] = xp.where(shape[:, None], 0.0, getattr(loads, key))
    return replace(loads, **fields)


def held_loads(loads: Loads) -> tuple[Floats, Floats]:
    """Force and moment that hold a body.

    They are those at its root (t, 3). With supports they are those of all its sections and of the supports (t, k, 3),
    as a pin at the root takes no moment.
    """
    if loads.support_force is None or loads.support_moment is None:
        return loads.root_force, loads.root_moment
    xp = namespace(loads.force)
    force = xp.concatenate([loads.force, loads.support_force], axis=1)
    return force, xp.concatenate([loads.moment, loads.support_moment], axis=1)
