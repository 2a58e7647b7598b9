"""Readings of gauges, strains and loads of sections of beams, among the other measurements of a system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import NamedTuple

import numpy as np

from gbeam.analysis.system.histories import carried
from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.types import Floats
from gbeam.mechanics.section_forces import sections
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import Acting
from gbeam.mechanics.tree.equations import Inputs, State, Tree
from gbeam.mechanics.tree.signals import CARRIED, carried_of, measurements
from gbeam.mechanics.tree.system import System, stations_of
from gbeam.results.parts import Base


class Strained(NamedTuple):
    """A gauge on a body: its strain by unit coordinates of a solid (n,), or by unit loads (6,) of a `section`."""

    body: str
    share: Floats
    section: int | None = None

    def read(self, system: System, state: State, acting: list[list[Acting]], inputs: Inputs) -> Array:
        """Strain (t,) in a motion (t,) of a tree."""
        k, body = system.order.index(self.body), system.bodies[self.body]
        if self.section is None:
            return state.q[k][-1] @ self.share
        assert isinstance(body, Structure) and body.sections is not None
        q, qd, qdd, a, w, alpha, hung = carried(system, state, self.body, acting)
        loads = sections(body, body.sections, Base(a, w, alpha), q, qd, qdd, inputs.loads[k], hung)
        of_section = [each[:, self.section] for each in (loads.section_force, loads.section_moment)]
        return namespace(*of_section).concatenate(of_section, axis=-1) @ self.share


def carrying(system: System, name: str) -> Strained:
    """Gauge that reads a component of what a section carries: ``strip.root.moment_y``."""
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
    """Values (..., k) of measurements, gauges among them, at unknown coordinates (..., n) and inputs, broadcast."""
    felt = carried_of(system)
    gauges = {**(strained or {}), **{each: carrying(system, each) for each in wanted if each in felt}}
    plain = measurements(system, tree, y, yd, ydd, inputs, [each for each in wanted if each not in gauges])
    if plain.shape[-1] == len(wanted):
        return plain
    xp, ground = namespace(plain, inputs.ground.a), inputs.ground
    ranks = {"prescribed": 2, "efforts": 1, "wrenches": 2}
    driving = {name: (getattr(inputs, name), rank) for name, rank in ranks.items()}
    driving = {name: each for name, each in driving.items() if each[0] is not None}
    leading = [each.shape[: each.ndim - rank] for each, rank in driving.values()]
    shape = np.broadcast_shapes(ground.a.shape[:-1], *(each.shape[:-1] for each in (y, yd, ydd)), *leading)

    def flat(leaf: Array, rank: int) -> Array:
        trailing = leaf.shape[leaf.ndim - rank :]
        return xp.broadcast_to(leaf, (*shape, *trailing)).reshape(-1, *trailing)

    y, yd, ydd = (flat(each, 1) for each in (y, yd, ydd))
    frame = {each.name: flat(getattr(ground, each.name), 2 if each.name == "R" else 1) for each in fields(ground)}
    every = replace(
        inputs,
        ground=replace(ground, **frame),
        loads=tuple(None if each is None else flat(each, 2) for each in inputs.loads),
        **{name: flat(*each) for name, each in driving.items()},
    )
    state = tree.motion(y, yd, ydd, every)
    *_, acting = tree.demanded(state, every)
    rest = iter(xp.moveaxis(plain, -1, 0))
    values = [
        gauges[each].read(system, state, acting, every).reshape(shape) if each in gauges else next(rest)
        for each in wanted
    ]
    return xp.stack([xp.broadcast_to(each, shape) for each in values], axis=-1)
