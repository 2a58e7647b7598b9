"""A rigid body, and a rigid specimen: alone on its base, or an item of a system whose corners or bolts are read."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from gbeam.errors import InputError
from gbeam.guards.limits import ENTRIES
from gbeam.scenario.bodies.common import BodyKind, Direction, Inertia, Name, Point, inertia_of, points_of
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.fields import Exponent, Mass, Offset, Place3, Table, by_name, optional

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure
    from gbeam.mechanics.tree.rigid_body import RigidBody as Rigid
    from gbeam.solids.rigid import RigidSpecimen

_ITEM = "corners", "bolts", "bolt_axis", "spread_limit"  # of an item under test, on whose points nothing hangs
_Places = Annotated[tuple[Place3, ...], Field(max_length=ENTRIES)]


class RigidBody(Table):
    """A rigid body."""

    kind: Literal["rigid"] = Field(description="kind of the body")
    mass: Mass = Field(description="mass")
    inertia: Inertia = Field(
        default=(0.0, 0.0, 0.0),
        description="about the centre of mass, axes of the root: principal moments [x, y, z], or three rows; of a size "
        "where it is left out that of an even box",
    )
    centre: Place3 = Field(default=(0.0, 0.0, 0.0), description="centre of mass from the root: [x, y, z]")
    size: tuple[Offset, Offset, Offset] | None = optional("edges [x, y, z] of the box that it fills, about middle")
    middle: Place3 | None = optional("middle of the box from the root, [x, y, z]; the centre of mass where left out")
    corners: _Places = Field(
        default=(),
        description="corners of its envelope where it is no box, whose load is told: [ [x, y, z], ... ]",
    )
    bolts: _Places = Field(
        default=(), description="places of the bolts that hold it by its root, alike: [ [x, y, z], ... ]"
    )
    bolt_axis: Direction | None = optional("direction of the bolts, away from the fixture: [x, y, z]")

    spread_limit: Exponent | None = optional(
        "largest difference of the load at a corner to the centre's that the test order "
        'accepts, over the largest of the centre, such as "10 %"; beyond it the run is not accepted'
    )
    points: dict[Name, Point] = by_name(
        "points by name, on which other bodies hang, forces act and output is given: the place [x, y, z] from the "
        "root, or with axes { at, turn }"
    )


def _body(parts: Collector, where: str, table: RigidBody) -> Rigid | Structure | None:
    """Rigid body of a system, a specimen where corners or bolts are asked for; None if it is refused."""
    if any(getattr(table, key) for key in _ITEM):
        return _specimen(parts, where, table)
    from gbeam.mechanics.tree.rigid_body import RigidBody as Rigid

    def body() -> Rigid:
        return Rigid(table.mass, _moments(table), table.centre, points_of(table))

    return parts.attempt(where, body)


def _specimen(parts: Collector, where: str, table: RigidBody) -> Structure | None:
    """Structure of a rigid specimen, its points among its corners; None if it is refused."""
    from gbeam.solids.rigid import RigidSpecimen

    def specimen() -> RigidSpecimen:
        points: dict[str, Any] = {name: getattr(each, "at", each) for name, each in table.points.items()}
        corners = [*table.corners, *points.values()]
        if table.size is not None:
            signs = np.array(list(product((-0.5, 0.5), repeat=3)))
            corners = [*(_middle(table) + signs * np.asarray(table.size)), *corners]
        if not corners:
            raise InputError("size", "is missing", "give the box that it fills, or its corners")
        bolts = table.bolts or None
        moments = inertia_of(_moments(table))
        return RigidSpecimen(
            table.mass, table.centre, moments, corners,
            bolts=bolts, bolt_axis=table.bolt_axis, spread_limit=table.spread_limit, points=points,
        )  # fmt: skip

    built = parts.attempt(where, specimen)
    return None if built is None else built.structure


def _middle(table: RigidBody) -> Any:
    return np.asarray(table.centre if table.middle is None else table.middle)


def _moments(table: RigidBody) -> Any:
    """Inertia as written, or of a box of uniform density where only its size is; InputError if the two do not fit."""
    if table.size is None:
        if table.middle is not None:
            raise InputError("middle", "is given without a size", "give the edges of the box: size = [x, y, z]")
        return table.inertia
    for i, edge in enumerate(table.size):
        if not edge > 0:
            raise InputError(f"size[{i}]", f"is {edge:g} m", "give a positive length")
    if "inertia" in table.model_fields_set:
        return table.inertia
    if not np.allclose(_middle(table), table.centre):
        fix = "give it: the box is not even, whose middle is not its centre of mass"
        raise InputError("inertia", "is missing", fix)
    squares = np.square(table.size)
    return tuple(table.mass / 12 * (squares.sum() - squares))


BODY = BodyKind(RigidBody, _body, _specimen)
