"""Forces and moments on points of a system."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from gbeam.arrays.tree import Value, assign, follows
from gbeam.arrays.types import Numbers
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Components, Quantity
from gbeam.motion.profiles.combine import as_profile
from gbeam.motion.profiles.profile import Profile


@typed
@dataclass(frozen=True, eq=False)
class PointForce(Value):
    """A force and a moment on a point of a system, such as thrust.

    Attributes
    ----------
    history : (Profile, Profile)
        Force and moment over time.

    Examples
    --------
    >>> gb.PointForce("bus.nozzle", force=(0, 0, 20.0), follower=True).on
    'bus.nozzle'
    """

    on: Annotated[str, 'the point: "bus.nozzle"']
    force: Annotated[
        Numbers | Profile | None,
        Quantity("force"),
        Components(
            "A force on a point by components, each a quantity or a profile; those left out are zero.",
            x="component along x",
            y="component along y",
            z="component along z",
        ),
        "force on the point: { x, y, z }",
    ] = None
    moment: Annotated[
        Numbers | Profile | None,
        Quantity("torque"),
        Components(
            "A moment on a point by components, each a quantity or a profile; those left out are zero.",
            x="component about x",
            y="component about y",
            z="component about z",
        ),
        "moment on the point: { x, y, z }",
    ] = None
    follower: Annotated[bool, "true if the components turn with the point; false if they keep to the ground's axes"] = (
        False
    )
    history: tuple[Profile, Profile] = follows()

    def __post_init__(self) -> None:
        zero = (0.0, 0.0, 0.0)
        force = as_profile("force", zero if self.force is None else self.force, 3)
        moment = as_profile("moment", zero if self.moment is None else self.moment, 3)
        assign(self, history=(force, moment))
