"""Drives of a system in a steady state: what turns at which rate, under which loads."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gbeam.errors import InputError
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.steps import turn_steadily
from gbeam.mechanics.tree.system import System
from gbeam.motion.hub import Hub
from gbeam.motion.protocol import Motion
from gbeam.results.parts import Base


@dataclass(frozen=True)
class Drive:
    """Drives of a system in a steady state: profiles and motion of the ground at a time, or a frozen motion `base` of
    the ground, beside gravity.

    Forces and loads act times a factor. A coordinate, or the hub below where none is named, turns at a rate rad/s that
    changes by `faster` rad/s², and has turned by an angle.
    """

    motion: Motion | None = None
    time: float = 0.0
    coordinate: str = ""
    rate: float | None = None
    turn: float = 0.0
    factor: float = 1.0
    base: Base | None = None
    faster: float = 0.0

    def inputs(self, system: System) -> Inputs:
        """Inputs of a system's tree. A coordinate that turns, but is not prescribed, is appended to those that are."""
        hub_turns = isinstance(self.motion, Hub) and self.rate is not None and not self.coordinate
        inputs, base = system.inputs(np.asarray(float(self.time)), None if hub_turns else self.motion), self.base
        if hub_turns:
            base = self.motion.mount.base(*(np.asarray(float(value)) for value in (self.turn, self.rate, 0.0)))  # type: ignore[union-attr, arg-type]
        if base is not None:
            ground = inputs.ground
            a = base.a_WO_B if hub_turns else base.a_WO_B + ground.a
            inputs = replace(inputs, ground=replace(ground, w=base.w_WB_B, a=a, alpha=base.alpha_WB_B))
        if self.factor != 1.0:
            loads = tuple(None if load is None else self.factor * load for load in inputs.loads)
            wrenches = None if inputs.wrenches is None else self.factor * inputs.wrenches
            inputs = replace(inputs, loads=loads, wrenches=wrenches)
        prescribed = np.zeros((3, 0)) if inputs.prescribed is None else np.array(inputs.prescribed)
        if self.coordinate and self.rate is not None:
            k = system.coordinates.index(self.coordinate)
            if k not in system.tree.fixed:
                prescribed = np.append(prescribed, [[system.start[0][k]], [0.0], [0.0]], axis=1)
            column = system.tree.fixed.index(k) if k in system.tree.fixed else -1
            prescribed[1:, column] = self.rate, self.faster
        if self.turn:
            # All prescribed coordinates go on for as long as the fastest one takes to turn so far.
            fastest = np.abs(np.append(prescribed[1], self.rate or 0.0)).max()
            earlier = prescribed.copy()
            prescribed[0] += prescribed[1] * self.turn / fastest
            for column, k in enumerate(system.tree.fixed):
                if system.coordinates[k].endswith(".e0"):  # the first of four Euler parameters
                    euler = slice(column, column + 4)
                    prescribed[:, euler] = turn_steadily(earlier[:, euler], self.turn / fastest)
        return replace(inputs, prescribed=prescribed if prescribed.size else None)


def any_load(inputs: Inputs) -> bool:
    """True if a load on a body, or a wrench on a point, acts."""
    return any(load is not None and bool(np.any(load)) for load in (*inputs.loads, inputs.wrenches))


def turning_of(system: System, motion: Motion | None, turning: str | None) -> str:
    """Name of the coordinate that turns: `turning`, the only prescribed angle, or the only angle, or "" for a hub."""
    angles = [
        f"{name}.{coordinate}"
        for name, joint in system.joints.items()
        for coordinate in joint.coordinates
        if coordinate.startswith("angle")
    ]
    if turning is None and isinstance(motion, Hub):
        return ""
    if not angles:
        fix = "hold a body by a revolute joint, whose rate is raised, or let the ground move as a hub"
        raise InputError("joints", "have no angle that turns", fix)
    if turning is not None:
        if turning not in angles:
            fix = f"choose from {', '.join(angles)}"
            raise InputError("turning", f"is {turning!r}, which is no angle of a joint", fix)
        return turning
    prescribed = [angle for angle in angles if system.coordinates.index(angle) in system.tree.fixed]
    choices = prescribed or angles
    if len(choices) != 1:
        raise InputError("turning", "is missing", f"say which angle turns: {', '.join(choices)}")
    return choices[0]


def turning_at(drive: Drive, value: float) -> Drive:
    """Return drives whose coordinate turns at a rate, rad/s."""
    return replace(drive, rate=value)


def loaded(drive: Drive, value: float) -> Drive:
    """Return drives whose loads and forces are multiplied by a factor."""
    return replace(drive, factor=value)


def shaken(drive: Drive, value: float) -> Drive:
    """Return drives whose motion is frozen, its accelerations times a factor, its rates times the root of this."""
    assert drive.motion is not None
    base, turned = drive.motion.base(np.asarray(float(drive.time))), np.sqrt(max(value, 0.0))
    frozen = Base(value * base.a_WO_B, turned * base.w_WB_B, value * base.alpha_WB_B)
    return replace(drive, motion=None, base=frozen)


def pushed(drive: Drive, value: float) -> Drive:
    """Return drives whose ground is accelerated along its x axis, m/s²."""
    return replace(drive, base=Base(np.array([value, 0.0, 0.0]), np.zeros(3), np.zeros(3)))
