"""Rigid bodies and their points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.namespace import Array, as_array, is_jax, namespace
from gbeam.arrays.tree import Value, assign
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, vector
from gbeam.guards.kinds import kinds
from gbeam.guards.quantities import Mass, PositionVector, Quantity, RotationVector
from gbeam.mechanics.tree.bodies import (
    Rigid,
)
from gbeam.mechanics.tree.steps import rotation_matrix

ROOT = "root"


@typed
@dataclass(frozen=True, eq=False)
class Place(Value):
    """A point of a rigid body, with axes.

    Examples
    --------
    >>> gb.Place(at=(0.5, 0, 0), turn=(0, 0, 1.5)).turn
    (0, 0, 1.5)
    """

    at: Annotated[PositionVector, "place from the body's root, in its axes: [x, y, z]"] = (0.0, 0.0, 0.0)
    turn: Annotated[RotationVector, "rotation vector of the point's axes in those of the root: [x, y, z]"] = (
        0.0,
        0.0,
        0.0,
    )

    def __post_init__(self) -> None:
        vector("at", self.at), vector("turn", self.turn)


@kinds(points="length")
@typed
@dataclass(frozen=True, eq=False)
class RigidBody(Value):
    """A rigid body of a system.

    Raises
    ------
    InputError
        If a value is impossible, or the inertia is not that of a rigid body.

    Examples
    --------
    >>> bus = gb.RigidBody(50.0, (8.0, 10.0, 12.0), points={"left": (0.5, 0, 0)})
    >>> bus.mass
    50.0
    """

    mass: Annotated[Mass, "mass"]
    inertia: Annotated[
        Any,
        Quantity("moment of inertia"),
        "about the centre of mass, axes of the root: principal moments [x, y, z], or three rows",
    ] = (0.0, 0.0, 0.0)
    centre: Annotated[PositionVector, "centre of mass from the root: [x, y, z]"] = (0.0, 0.0, 0.0)
    points: Annotated[
        Mapping[str, Any],
        "points by name, on which other bodies hang, forces act and output is given: the place [x, y, z] from the "
        "root, or with axes { at, turn }",
    ] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse an inertia that no body has, and names that no point can have."""
        vector("centre", self.centre)
        moments = np.zeros(3) if is_jax(self.tensor) else np.linalg.eigvalsh(self.tensor)
        if moments[0] < -1e-12 * moments[-1] or moments[-1] > moments[:2].sum() * (1 + 1e-9) + 1e-300:
            fix = "no principal moment is negative, or exceeds the sum of the other two"
            raise InputError("inertia", f"has the principal moments {moments} kg m²", fix)
        for name in self.points:
            if not name.isidentifier() or name == ROOT:
                raise InputError(f"points.{name}", "is no name of a point", "give letters, digits and underscores")
        points = {name: point if isinstance(point, Place) else Place(point) for name, point in self.points.items()}
        assign(self, points=points)

    @property
    def tensor(self) -> Array:
        """Inertia (3, 3) about the centre of mass, kg m²."""
        tensor = array("inertia", self.inertia)
        tensor = namespace(tensor).diag(tensor) if tensor.shape == (3,) else tensor
        if tensor.shape != (3, 3) or not (is_jax(tensor) or (np.abs(tensor - tensor.T) <= 0).all()):
            raise InputError("inertia", f"is {self.inertia!r}", "give three principal moments or a symmetric 3 × 3")
        return tensor

    @property
    def body(self) -> Rigid:
        """Terms of the body in the equations."""
        places = [as_array(point.at) for point in self.points.values()]
        turns = [rotation_matrix(point.turn) for point in self.points.values()]
        xp = namespace(*places, *turns)
        places, turns = xp.reshape(xp.asarray(places), (-1, 3)), xp.reshape(xp.asarray(turns), (-1, 3, 3))
        return Rigid(self.mass, as_array(self.centre), self.tensor, places, turns)
