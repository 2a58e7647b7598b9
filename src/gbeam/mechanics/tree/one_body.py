"""Systems of one body: a structure on ground that moves as a motion says, or on a hub that turns freely."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.arrays.types import Floats
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import Joint
from gbeam.mechanics.tree.rigid_body import Place, RigidBody
from gbeam.mechanics.tree.system import CLAMP, System
from gbeam.motion.protocol import Motion

HUB, HINGE, RIM = "hub", "hinge", "rim"  # names of a free hub, its joint, and its point that holds the structure


def moving_system(structure: Structure, motion: Motion | None, name: str = "beam") -> tuple[System, Motion | None]:
    """System of a structure alone in a motion, and the motion of the system's ground: none under a free hub."""
    if motion is None or not motion.free:
        return System.of(structure, name), motion
    return hub_system(structure, motion, name), None


def hub_system(structure: Structure, hub: Any, name: str = "beam") -> System:
    """System of a structure on the rim of a hub, which turns at its rate, or freely under torque, spring and damper."""
    rim = Place(at=hub.mount.place, turn=_turn_of_root(hub))
    # Only the moment about the hinge's axis takes part; equal ones are those of a possible body.
    inertia = 0.0 if hub.inertia is None else hub.inertia
    body = RigidBody(0.0, namespace(inertia).stack([inertia] * 3), points={RIM: rim})
    driven = {"stiffness": hub.stiffness, "damping": hub.damping, "effort": hub.torque}
    hinge = Joint("revolute", HUB, axes=[(0, 0, 1)], **(driven if hub.free else {"rate": hub.rate}))
    clamp = Joint("fixed", name, on=f"{HUB}.{RIM}")
    return System({HUB: body, name: structure}, {HINGE: hinge, CLAMP: clamp}, gravity=hub.gravity)


def _turn_of_root(hub: Any) -> Floats:
    """Rotation vector (3,), rad, of the root's axes in the hub's.

    It is the hub's turn, if given, or else the setting angle about x and, if the beam points inward, half a turn about
    z.
    """
    if hub.turn is not None:
        return np.asarray(hub.turn)
    angle = 0.0 if hub.setting_angle is None else hub.setting_angle
    xp = namespace(angle)
    if hub.pointing == "outward":
        return xp.asarray(angle) * np.array([1.0, 0.0, 0.0])
    return np.pi * (xp.cos(angle / 2) * np.array([0.0, 0.0, 1.0]) + xp.sin(angle / 2) * np.array([0.0, 1.0, 0.0]))
