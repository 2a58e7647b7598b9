"""How the bodies of a system hang together and how large they are, for pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.tree.equations import State
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.joints import GROUND
from gbeam.mechanics.tree.system import RigidBody, System
from gbeam.results.system import Assembly

Floats = NDArray[np.float64]


def assembly_of(system: System) -> Assembly:
    """Describe the joints of a system, and boxes that have the mass and the inertia of its rigid bodies."""
    holding = {joint.body: joint for joint in system.joints.values()}
    boxes = [_box(system.bodies[name]) for name in system.order]
    size, centre, rotation = (np.stack(each) for each in zip(*boxes, strict=True))
    return Assembly(
        bodies=system.order,
        hangs_on=tuple(holding[name].on for name in system.order),
        joint=tuple(holding[name].kind for name in system.order),
        place_at_rest=np.stack([_place_at_rest(system, holding[name].on) for name in system.order]),
        undeformed=undeformed(system),
        box=size,
        box_centre=centre,
        box_rotation=rotation,
    )


def _place_at_rest(system: System, on: str) -> Floats:
    """Place of a point from the root of its body, which is not deformed, or of the ground's origin."""
    if on == GROUND:
        return np.zeros(3)
    name, point = system.point("on", on)
    link = system.tree.links[system.order.index(name)]
    none = np.zeros(link.body.size)
    places = [each.r for each in link.body.relative(none, none, none)]
    return np.asarray(places[point]) if point < len(places) else np.zeros(3)


def undeformed(system: System) -> Floats:
    """Places of all points with the joints at the start, bodies undeformed."""
    q, zero, still = system.start[0], np.zeros(3), np.zeros(system.tree.size)
    ground = Frame(np.eye(3), zero, zero, zero, zero, zero)
    return np.stack([frame.p for frame in State(system.tree, q, still, still, ground).every_point])


def _box(body: object) -> tuple[Floats, Floats, Floats]:
    """Extents, centre and rotation of an even box with the mass and inertia of a rigid body; NaN of another."""
    if not isinstance(body, RigidBody):
        return np.full(3, np.nan), np.full(3, np.nan), np.full((3, 3), np.nan)
    moments, axes = np.linalg.eigh(body.tensor)
    axes[:, 2] *= np.linalg.det(axes)
    squares = 6 * (moments.sum() - 2 * moments) / body.mass if body.mass > 0 else 0 * moments
    return np.sqrt(np.maximum(squares, 0.0)), np.asarray(body.centre, dtype=float), axes
