"""A rigid body, and a rigid specimen: alone on its base, or an item of a system whose corners or bolts are read."""

from __future__ import annotations

from itertools import product
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from gbeam.errors import InputError
from gbeam.guards.limits import ENTRIES
from gbeam.guards.quantities import PositionVector, Quantity, Shape
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.rigid_body import RigidBody as Rigid
from gbeam.scenario.bodies.common import BodyKind, Inertia, Point, inertia_of
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.declared import arguments_of, table_of
from gbeam.scenario.schema.fields import Name, Place3, Table
from gbeam.solids.rigid import RigidSpecimen

_ITEM = "corners", "bolts", "bolt_axis", "spread_limit", "supports"  # of an item under test, or on supports
_Places = Annotated[tuple[Place3, ...], Field(max_length=ENTRIES)]


def _rigid(
    *,
    mass: float,
    inertia: Any = None,
    centre: Any = (0.0, 0.0, 0.0),
    size: Annotated[
        Annotated[Any, Quantity("length"), Shape((3,))] | None,
        "edges [x, y, z] of the box that it fills, about middle",
    ] = None,
    middle: Annotated[
        PositionVector | None, "middle of the box from the root, [x, y, z]; the centre of mass where left out"
    ] = None,
    points: Any = None,
) -> Rigid:
    """A rigid body."""
    return Rigid(mass, _moments(mass, inertia, centre, size, middle), centre, points or {})


def _specimen(
    *, size: Any = None, middle: Any = None, points: Any = None, corners: Any = (), **others: Any
) -> Structure:
    """Structure of a rigid specimen, its points among its corners."""
    mass, centre = others.pop("mass"), others.pop("centre", (0.0, 0.0, 0.0))
    moments = inertia_of(_moments(mass, others.pop("inertia", None), centre, size, middle))
    places = {name: getattr(point, "at", point) for name, point in (points or {}).items()}
    listed = [*corners, *places.values()]
    if size is not None:
        signs = np.array(list(product((-0.5, 0.5), repeat=3)))
        listed = [*(_middle(centre, middle) + signs * np.asarray(size)), *listed]
    if not listed:
        raise InputError("size", "is missing", "give the box that it fills, or its corners")
    return RigidSpecimen(mass, centre, moments, listed, points=places, **others).structure


def _lone_specimen(parts: Collector, where: str, table: Table) -> Structure | None:
    """Structure of a rigid specimen alone on its base, or None if it is refused."""
    return _object(parts, where, table, _specimen)


def _in_system(parts: Collector, where: str, table: Table) -> Rigid | Structure | None:
    """Rigid body of a system, a specimen where corners or bolts are asked for, or None if it is refused."""
    return _object(parts, where, table, _specimen if any(getattr(table, key) for key in _ITEM) else _rigid)


def _object(parts: Collector, where: str, table: Table, make: Any) -> Any:
    """Object of a table by one of the two functions, or None if it is refused."""
    errors_before = len(parts.errors)
    arguments = arguments_of(parts, where, table, {"kind", *(() if make is _specimen else _ITEM)})
    return parts.attempt(where, make, **arguments) if len(parts.errors) == errors_before else None


def _middle(centre: Any, middle: Any) -> Any:
    return np.asarray(centre if middle is None else middle)


def _moments(mass: float, inertia: Any, centre: Any, size: Any, middle: Any) -> Any:
    """Inertia as written, or of a box of uniform density where only its size is; InputError if the two do not fit."""
    if size is None:
        if middle is not None:
            raise InputError("middle", "is given without a size", "give the edges of the box: size = [x, y, z]")
        return (0.0, 0.0, 0.0) if inertia is None else inertia
    for i, edge in enumerate(size):
        if not edge > 0:
            raise InputError(f"size[{i}]", f"is {edge:g} m", "give a positive length")
    if inertia is not None:
        return inertia
    if not np.allclose(_middle(centre, middle), centre):
        fix = "give it: the box is not even, whose middle is not its centre of mass"
        raise InputError("inertia", "is missing", fix)
    squares = np.square(size)
    return tuple(mass / 12 * (squares.sum() - squares))


_INERTIA = (
    "about the centre of mass, axes of the root: principal moments [x, y, z], or three rows; of a size where it is "
    "left out that of an even box"
)
_CORNERS = "corners of its envelope where it is no box, whose load is told: [ [x, y, z], ... ]"
_POINTS = (
    "points by name, on which other bodies hang, forces act and output is given: the place [x, y, z] from the root, or "
    "with axes { at, turn }"
)
BODY = BodyKind(
    table_of(
        _rigid,
        _rigid,
        RigidSpecimen,
        Rigid,
        name="RigidBody",
        tag=("kind", "rigid"),
        changed={
            "inertia": (Inertia, Field(default=(0.0, 0.0, 0.0), description=_INERTIA)),
            "corners": (_Places, Field(default=(), description=_CORNERS)),
            "points": (
                Annotated[dict[Name, Point], Field(max_length=ENTRIES)],
                Field(default_factory=dict, description=_POINTS),
            ),
        },
    ),
    _in_system,
    _lone_specimen,
)
