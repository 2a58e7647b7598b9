"""Terms of bodies in the equations of a tree."""

from __future__ import annotations

import numpy as np

from gbeam.arrays.namespace import Array, is_traced
from gbeam.errors import InputError
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.equations.moments import Moments, carried_inertia
from gbeam.mechanics.fields.held import HeldField
from gbeam.mechanics.fields.projected import Field
from gbeam.mechanics.fields.taylor import Expanded
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import (
    Body,
    DeformingBody,
    HeldPoints,
    Points,
    PolynomialPoints,
    StrainedPoints,
    polynomial_points,
)
from gbeam.mechanics.tree.rigid_body import RigidBody


def stations_of(structure: Structure) -> dict[str, int]:
    """Indices, by name, of a structure's named stations; of the tip alone where JAX traces their positions."""
    if structure.source is None or is_traced(structure.stations):
        names = structure.points or ("tip",)
        return {name: len(structure.stations) - len(names) + k for k, name in enumerate(names)}
    named = structure.source.beam.named_points
    return {name: int(np.argmin(np.abs(structure.stations - position))) for name, position in named.items()}


def refuse_turnless(where: str, body: Structure, on: int) -> None:
    """Raise InputError, with the place `where`, if the rotation of a structure's point `on` (index) is not known."""
    if body.field is not None:
        return
    if body.turns is None or not np.isfinite(body.turns[list(stations_of(body).values())[on]]).all():
        fix = "hang it on the root, or on an interface of a solid, or on a node that has rotations"
        raise InputError(where, "is a point of particles, which do not say how it turns", fix)


def body_of(where: str, body: RigidBody | Structure, *, free: bool = False, hinged: bool = False) -> Body:
    """Terms of a body in the equations; InputError unless the body can be in a tree.

    It is `free` if its root moves by unknowns, `hinged` if only by one hinge on the ground.
    """
    if isinstance(body, RigidBody):
        return body.body
    if free and not (body.hub_force or hinged):
        fix = "choose FOAM with no axial shapes, which are the same equations with it"
        raise InputError(f"{where}.model", f"is {body.kind}, whose base does not feel the beam", fix)
    return terms_of(body, free=free)


def terms_of(body: Structure, *, free: bool = False) -> Body:
    """Terms of a structure in the equations on any root.

    If it is `free`, a solid's terms include :func:`carried_inertia`, and the root of SFOAM does not feel the rates of
    its coordinates: its printed equations lack these forces.
    """
    equations, stations = body.equations, np.array(list(stations_of(body).values()))
    points: Points
    if body.field is not None:
        points = _points(body.field, body.first_station + stations)
    else:
        places = body.station_places[stations]
        zeros = np.zeros((*places.first.shape, body.size))
        second, turn = zeros if places.second is None else places.second, 0 * places.first
        if body.turns is not None:
            turn = np.nan_to_num(body.turns[stations])
        points = PolynomialPoints(places.r0, places.first, second, turn, zeros)
    if isinstance(equations, Coefficients):
        mean_inertia = carried_inertia(equations) if free and body.field is None else None
        return DeformingBody(Moments(equations, mean_inertia, hub_force=body.hub_force or not free), points)
    return DeformingBody(equations, points)


def _points(field: Field, at: Array) -> Points:
    """Some points of a beam's field."""
    if isinstance(field, HeldField):
        free = _points(field.free, at)
        assert not isinstance(free, HeldPoints)
        return HeldPoints(free, field.conditions)
    if isinstance(field, Expanded):
        return polynomial_points(field.sections(at))
    return StrainedPoints(field[at])
