"""Operating points of a motion frozen at a time."""

from __future__ import annotations

from typing import Any

from gbeam.analysis.equilibrium.hub_point import settled_hub
from gbeam.analysis.equilibrium.point import OperatingPoint, held_base, on_base
from gbeam.errors import InputError
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion

Array = Any


def operating_point(
    structure: Structure, motion: Motion | None, time: float = 0.0, q: Array | None = None, qd: Array | None = None
) -> OperatingPoint:
    """Freeze a motion at a time, with the beam in relative equilibrium or at q, qd (n,); a free hub keeps the angular
    momentum that torque and damper left since time zero, or rests where its spring balances the torque.
    """
    loaded, structure = structure.history is not None, structure.at_time(time)
    if motion is None or not motion.free:
        return on_base(structure, held_base(motion, time), q, qd)
    hub: Any = motion
    if time > 0 and float(hub.stiffness) == 0 and (loaded or hub.mount.gravity is not None):
        raise InputError(
            "time",
            f"is {time:g} s, when gravity or loads have moved a free hub",
            "give time 0 or a rate, or ask `gbeam run` how it moves",
        )
    return settled_hub(structure, hub, time, q, qd)
