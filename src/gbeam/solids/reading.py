"""Reading of a solid from the mesh of a file: what is clamped, named, carried and linked in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from gbeam.arrays.types import Flags, Floats, Indices, Numbers
from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.mechanics.plausibility import implausible_material
from gbeam.mechanics.tree.rigid_body import Place, RigidBody
from gbeam.solids.cad import mesh_of
from gbeam.solids.card_links import with_cards
from gbeam.solids.cards import Cards
from gbeam.solids.foreign import THICKNESS, ignored_statements, node_numbers_of, unit_size
from gbeam.solids.geometry import Mesh
from gbeam.solids.held import HeldPlace
from gbeam.solids.links import Links, LinkSpring, coupling, refuse_names
from gbeam.solids.placed import Placed, shared_names
from gbeam.solids.plausibility import doubts_of, refuse_folded, refuse_loose, refuse_twice
from gbeam.structure.attachments import TIP
from gbeam.structure.material import Material, Orthotropic
from gbeam.structure.supports import Support
from gbeam.structure.temperature import Temperature

M = TypeVar("M", bound=Mesh)


def read_solid(
    solid_type: type[M],
    source: Any,
    *,
    materials: Material | Orthotropic | Mapping[str, Material | Orthotropic],
    clamp: str | Sequence[str],
    unit: str | None,
    thickness: float | Mapping[str, float] | None,
    element_size: float | None,
    points: Mapping[str, Any],
    point_masses: Mapping[str, float],
    interfaces: Mapping[str, str],
    links: Mapping[str, str | Sequence[str]],
    carried: Mapping[str, RigidBody],
    springs: Mapping[str, LinkSpring],
    supports: Sequence[Support],
    temperature: Temperature | None,
    origin: Numbers,
    turn: Numbers,
    scale: Numbers,
    mass_unit: str | None,
) -> M:
    """Read a solid of some type. :meth:`gbeam.SolidMesh.read` explains the arguments."""
    mesh, size = mesh_of(source, unit, element_size, cards=mass_unit is not None)
    placed = Placed.from_mesh(mesh, size, thickness, origin=origin, turn=turn, scale=scale)
    clamps = {name: placed.group("clamp", name) for name in ([clamp] if isinstance(clamp, str) else clamp)}
    clamped = np.isin(np.arange(len(placed.points)), np.concatenate([np.zeros(0, dtype=int), *clamps.values()]))
    named = {name: placed.nearest(name, getattr(place, "at", place)) for name, place in points.items()}
    refuse_names(interfaces, named)
    hung = {name: placed.group(f"interfaces.{name}", group) for name, group in interfaces.items()}
    tied = Links.read(placed.group, links, carried, springs, placed.points, clamped)
    statements, lumped = tuple[str, ...](), np.zeros(len(placed.points))
    if mass_unit is not None:
        cards, weight = getattr(mesh, "cards", Cards()), unit_size("mass_unit", mass_unit, "mass")
        tied, lumped = with_cards(cards, tied, placed, clamped, size, weight)
        statements = cards.words
    held = held_places(supports, placed, named, hung, tied, clamped)
    tip = named.pop(TIP, None)
    stations = named | {TIP: _free_tip(placed, clamped, held) if tip is None else tip}
    weights = _spread(placed, stations, point_masses) + lumped
    blocks = placed.blocks(materials, heated=temperature is not None)
    by_group = materials if isinstance(materials, Mapping) else {"": materials}
    names = shared_names(by_group)
    kinds = {names[name]: material for name, material in by_group.items()}
    if thickness is not None:
        statements += THICKNESS
    solid = solid_type(
        points=placed.points,
        blocks=blocks,
        clamped=clamped,
        numbers=node_numbers_of(mesh)[placed.numbers],
        point_masses=weights,
        stations=stations,
        strengths={name: kind.yield_strength for name, kind in kinds.items() if kind.yield_strength is not None},
        interfaces=hung,
        links=tied,
        exponents={name: float(material.fatigue_exponent) for name, material in kinds.items()},
        turns={name: tuple(place.turn) for name, place in points.items() if isinstance(place, Place)},
        clamps={name: len(np.unique(placed.numbers[nodes])) for name, nodes in clamps.items()},
        supports=held,
        temperature=temperature,
    )
    refuse_folded(solid)
    refuse_twice(solid)
    refuse_loose(solid)
    doubts = [*doubts_of(solid, unit or "that of the file"), *ignored_statements(source, mesh, statements)]
    for name, material in by_group.items():
        doubts += implausible_material(f"materials.{name}" if name else "material", material)
    return replace(solid, warnings=tuple(doubts))


def _spread(placed: Placed, stations: Mapping[str, int], point_masses: Mapping[str, float]) -> Floats:
    """Masses (k,) on the points, kg, from those by a station's name, or of a group over which each is spread evenly."""
    weights = np.zeros(len(placed.points))
    for name, mass in point_masses.items():
        where = f"point_masses.{name}"
        nodes = np.array([stations[name]]) if name in stations else placed.group(where, name)
        weights[nodes] += positive(where, mass, "kg") / len(nodes)
    return weights


def _free_tip(placed: Placed, clamped: Flags, places: Sequence[HeldPlace]) -> int:
    """Point farthest from the root that nothing holds, or that the clamp does not where supports hold all others."""
    is_free = ~clamped
    for place in places:
        if place.support.rigid and place.kind == "nodes":
            is_free[place.points] = False
    is_free = is_free if is_free.any() else ~clamped
    return int(np.argmax(np.linalg.norm(placed.middles, axis=1) * is_free))


def held_places(
    supports: Sequence[Support],
    placed: Placed,
    stations: Mapping[str, int],
    interfaces: Mapping[str, Indices],
    links: Links,
    clamped: Flags,
) -> tuple[HeldPlace, ...]:
    """Places that supports hold: points, interfaces, rigid links or groups by their names."""
    places = []
    for i, support in enumerate(supports):
        where, name = f"supports[{i}].at", support.at
        if not isinstance(name, str):
            raise InputError(where, f"is {name!r}, and a mesh is held at groups and points", "give the name of one")
        if name in interfaces or name in links.nodes:
            kind: Any = "interface" if name in interfaces else "link"
            points = interfaces[name] if name in interfaces else links.nodes[name]
            centre = coupling(where, placed.points[points])[0]
            places.append(HeldPlace(support, points, np.arange(len(points)), centre, kind))
            continue
        if name in stations:
            points = np.flatnonzero(placed.numbers == placed.numbers[stations[name]])
        else:
            points = _group_or_known(placed, where, name, [*stations, *interfaces, *links.nodes])
        points = points[~clamped[points]]
        if not len(points):
            fix = "leave it out, or take its nodes out of the clamp"
            raise InputError(where, f"is {name!r}, which the clamp holds already", fix)
        for link, nodes in links.nodes.items():
            if link not in links.weights and (shared := int(np.isin(points, nodes).sum())):
                fix = f"give {link!r}, which is held as a whole"
                raise InputError(where, f"is {name!r}, with {shared} nodes of the rigid link {link}", fix)
        numbers, node = np.unique(placed.numbers[points], return_inverse=True)
        centre = placed.places[numbers].mean(axis=0)
        places.append(HeldPlace(support, points, node, centre))
    return tuple(places)


def _group_or_known(placed: Placed, where: str, name: str, known: Sequence[str]) -> Indices:
    """Points of a group. InputError about `where` lists the groups, and other names that are `known`."""
    try:
        return placed.group(where, name)
    except InputError as error:
        raise InputError(where, error.problem, f"{error.fix}; or a point: {', '.join(known)}") from None
