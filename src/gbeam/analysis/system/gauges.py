"""Readings of gauges, strains and loads of sections of beams, among the other measurements of a system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import NamedTuple

import numpy as np

from gbeam.analysis.system.histories import carried
from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.types import Floats
from gbeam.mechanics.causes import causes_of
from gbeam.mechanics.reactions import demanded_with_supports
from gbeam.mechanics.section_forces import sections
from gbeam.mechanics.tree.bodies import Acting
from gbeam.mechanics.tree.body_terms import stations_of
from gbeam.mechanics.tree.equations import Inputs, State, Tree
from gbeam.mechanics.tree.signal_names import CARRIED
from gbeam.mechanics.tree.signals import carried_of, measurements
from gbeam.mechanics.tree.system import System


class Strained(NamedTuple):
    """A gauge on a body: strains by a unit of each cause (n + h,) or, at a `section`, per unit force and moment there
    (6,).
    """

    body: str
    share: Floats
    section: int | None = None

    def read(self, system: System, state: State, acting: list[list[Acting]], inputs: Inputs) -> Array:
        """Reading (t,) of the gauge at states (t,) of the system's tree, with wrenches `acting` on its points."""
        k, body = system.order.index(self.body), system.flexible[self.body]
        if self.section is None:
            return causes_of(body, state.q[k][-1], inputs.loads[k]) @ self.share
        assert body.sections is not None
        q, qd, qdd, base, hung = carried(system, state, self.body, acting)
        every = demanded_with_supports(body, base, q, qd, qdd, inputs.loads[k], hung)
        loads = sections(body, body.sections, base, q, qd, qdd, inputs.loads[k], every)
        force, moment = loads.section_force[:, self.section], loads.section_moment[:, self.section]
        return namespace(force, moment).concatenate([force, moment], axis=-1) @ self.share


def carrying(system: System, name: str) -> Strained:
    """Make the gauge that reads a component of the force or moment in a section, by its name, such as
    ``strip.root.moment_y``.
    """
    owner, _, component = name.rpartition(".")
    body, _, point = owner.partition(".")
    kind, axis = component.split("_")
    stations = stations_of(system.bodies[body])  # type: ignore[arg-type]
    section = 1 + stations[point] if point in stations else 0
    return Strained(body, np.eye(6)[3 * list(CARRIED).index(kind) + "xyz".index(axis)], section)


def read_signals(
    system: System,
    tree: Tree,
    wanted: Sequence[str],
    y: Array,
    yd: Array,
    ydd: Array,
    inputs: Inputs,
    strained: Mapping[str, Strained] | None = None,
) -> Array:
    """Values (..., k) of the `wanted` signals at free coordinates, rates and accelerations (..., n) and inputs,
    broadcast.

    Gauges `strained` and loads of sections may be among the signals.
    """
    section_loads = carried_of(system)
    gauges = {**(strained or {}), **{name: carrying(system, name) for name in wanted if name in section_loads}}
    plain = measurements(system, tree, y, yd, ydd, inputs, [name for name in wanted if name not in gauges])
    if plain.shape[-1] == len(wanted):
        return plain
    xp, ground = namespace(plain, inputs.ground.a), inputs.ground
    ranks = {"prescribed": 2, "efforts": 1, "wrenches": 2}
    driving = {name: (getattr(inputs, name), rank) for name, rank in ranks.items() if getattr(inputs, name) is not None}
    leading = [values.shape[: values.ndim - rank] for values, rank in driving.values()]
    shape = np.broadcast_shapes(ground.a.shape[:-1], *(state.shape[:-1] for state in (y, yd, ydd)), *leading)

    def flat(leaf: Array, rank: int) -> Array:
        """Broadcast the leading axes of a leaf to `shape`, and join them to one of times."""
        trailing = leaf.shape[leaf.ndim - rank :]
        return xp.broadcast_to(leaf, (*shape, *trailing)).reshape(-1, *trailing)

    y, yd, ydd = (flat(state, 1) for state in (y, yd, ydd))
    frame = {part.name: flat(getattr(ground, part.name), 2 if part.name == "R" else 1) for part in fields(ground)}
    inputs = replace(
        inputs,
        ground=replace(ground, **frame),
        loads=tuple(None if load is None else flat(load, 2) for load in inputs.loads),
        **{name: flat(*pair) for name, pair in driving.items()},
    )
    state = tree.motion(y, yd, ydd, inputs)
    *_, acting = tree.demanded(state, inputs)
    plain_signals, signals = iter(xp.moveaxis(plain, -1, 0)), []
    for name in wanted:
        gauge = gauges.get(name)
        signals.append(
            next(plain_signals) if gauge is None else gauge.read(system, state, acting, inputs).reshape(shape)
        )
    return xp.stack([xp.broadcast_to(values, shape) for values in signals], axis=-1)
