"""Masses, rigid links and springs of a file among those of a solid."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.solids.cards import Cards, refused
from gbeam.solids.links import Links, coupling
from gbeam.solids.placed import Placed

APART = 1e-6  # of the size of a mesh: nodes that are farther apart are not one place


def with_cards(
    cards: Cards, links: Links, placed: Placed, clamped: Flags, size: float, mass: float
) -> tuple[Links, Floats]:
    """Add the masses, rigid links and springs of a file to the links of a solid.

    Returns these links, and the masses (k,) of the file on single points, kg. `size` and `mass` are the file's units, m
    and kg; its unit of time is the second.
    """
    ends = np.cumsum(np.bincount(placed.numbers, minlength=len(placed.places)))[:-1]
    points_of = np.split(np.argsort(placed.numbers, kind="stable"), ends)
    node_numbers = np.asarray(cards.nodes).tolist()
    solid_of = dict(zip(node_numbers, points_of, strict=False))
    place_of = dict(zip(node_numbers, placed.places, strict=False))
    within = float(np.linalg.norm(np.ptp(placed.places, axis=0))) * APART
    members, places, owner = dict(links.nodes), dict(links.places), dict[int, str]()
    mean = dict[str, Floats]()
    base, lumped = "the base", np.zeros(len(clamped))

    def refuse_unknown(name: str, numbers: Iterable[int]) -> None:
        if unknown := [number for number in numbers if number not in solid_of]:
            raise refused(name, f"names node {unknown[0]}, which is not there", "export it too")

    def link(name: str, numbers: tuple[int, ...]) -> None:
        """Make a rigid link of nodes by their numbers in the file, or let the base own them if all are clamped."""
        refuse_unknown(name, numbers)
        chosen = np.unique(np.concatenate([solid_of[number] for number in numbers]))
        if len(chosen) and clamped[chosen].all():
            owner.update(dict.fromkeys(numbers, base))
            return
        shared = [owner[number] for number in numbers if number in owner]
        shared += [other for other, held in members.items() if other not in mean and np.isin(chosen, held).any()]
        if shared or clamped[chosen].any():
            raise refused(name, f"shares nodes with {shared[0] if shared else 'the clamp'}", "make them one")
        if len(np.unique(placed.numbers[chosen])) > 1:
            coupling(f"mesh, {name}:", placed.points[chosen])
        members[name], places[name] = chosen, place_of[numbers[0]]
        owner.update(dict.fromkeys(numbers, name))

    def owner_of(name: str, number: int) -> str:
        """Name of the link that moves a node. A node that has none becomes a link."""
        if number not in owner:
            link(f"node {number}" if number in solid_of else name, (number,))
        return owner[number]

    for name, numbers in cards.rigid.items():
        link(name, numbers)
    for name, (number, shares) in cards.mean.items():
        refuse_unknown(name, (number, *shares))
        if len(solid_of[number]) or number in owner:
            raise refused(name, f"moves node {number}, which the solid or a rigid link moves too", "leave one out")
        members[name] = np.concatenate([solid_of[followed] for followed in shares])
        parts = [(solid_of[followed], weight) for followed, weight in shares.items()]
        mean[name] = np.concatenate([np.full(len(points), weight / max(len(points), 1)) for points, weight in parts])
        coupling(f"mesh, {name}:", placed.points[members[name]], mean[name])
        places[name], owner[number] = place_of[number], name
    carried: dict[str, list[tuple[float, Floats, Floats]]] = {}
    # Lumps that turn come first: a mass without inertia on the same node then joins their link.
    for lump in sorted(cards.lumps, key=lambda lump: not (lump.inertia.any() or lump.offset.any())):
        tensor = mass * size**2 * placed.rotation @ lump.inertia @ placed.rotation.T
        offset = size * placed.rotation @ lump.offset
        points = solid_of.get(lump.node, ())
        if lump.node not in owner and len(points):
            if not tensor.any() and not offset.any():
                lumped[points] += mass * lump.mass / len(points)
                continue
            if len(points) == 1:
                fix = "join it to the solid by a rigid link"
                raise refused(lump.name, f"has an offset or inertia on node {lump.node}, which does not turn", fix)
        name = owner_of(lump.name, lump.node)
        if name != base:
            centre = place_of[lump.node] + offset - places[name]
            carried.setdefault(name, []).append((mass * lump.mass, centre, tensor))
    springs = dict(links.springs)
    for k, spring in enumerate(cards.springs):
        joined = [owner_of(spring.name, number) for number in spring.nodes]
        across = max(float(np.linalg.norm(place_of[node] - place_of[spring.nodes[0]])) for node in spring.nodes)
        if across > within:
            raise refused(spring.name, f"joins nodes {across:.3g} m apart", "let it join nodes at one place")
        between = tuple(dict.fromkeys(name for name in joined if name != base))
        if not between or (len(spring.nodes) == 2 and joined[0] == joined[1]):
            continue  # between what moves together
        if not np.allclose(placed.rotation, np.eye(3)):
            raise refused(spring.name, "lies along the mesh's axes, and turn turns them", "leave turn out")
        single = [name for name in between if len(members[name]) == 1]
        if spring.stiffness[3:].any() and single:
            raise refused(spring.name, f"turns {single[0]} of the solid, which does not", "join it by a rigid link")
        springs[f"{spring.name}, {k + 1}"] = (
            between,
            mass * spring.stiffness * np.repeat([1.0, size**2], 3),
            place_of[spring.nodes[0]],
        )
    bodies = dict(links.bodies) | {name: _join_parts(name, parts) for name, parts in carried.items()}
    used = {*bodies, *(name for between, *_ in springs.values() for name in between)}
    members = {name: points for name, points in members.items() if len(points) or name in used}
    tied = Links(
        nodes=members,
        bodies=bodies,
        springs=springs,
        places={name: places[name] for name in members if name in places},
        weights={name: mean[name] for name in members if name in mean},
    )
    for name, chosen in members.items():
        if not len(chosen):
            _refuse_unheld(name, tied)
    return tied, lumped


def _refuse_unheld(name: str, links: Links) -> None:
    """Refuse a link without nodes of the solid that its springs let move freely in some direction."""
    stiffness = sum((values for between, values, _ in links.springs.values() if name in between), np.zeros(6))
    body = links.bodies.get(name)
    inertia = np.zeros(3) if body is None else np.diag(body.tensor) + np.abs(body.centre).sum()
    shifts = stiffness[:3].min() == 0
    turns = (stiffness[3:] == 0)[inertia > 0].any()  # a rotation without inertia is no coordinate
    if shifts or turns:
        raise refused(name, "is on no node of the solid, and its springs leave it a way to move", "hold it")


def _join_parts(name: str, parts: list[tuple[float, Floats, Floats]]) -> RigidBody:
    """Join parts into one body. Each part is its mass, kg, centre (3,) m and inertia (3, 3) about that, kg m²."""
    whole = sum(mass for mass, *_ in parts)
    moment = sum((mass * part_centre for mass, part_centre, _ in parts), np.zeros(3))
    centre = moment / whole if whole else np.zeros(3)
    tensor = np.zeros((3, 3))
    for mass, part_centre, inertia in parts:
        arm = part_centre - centre  # Steiner's theorem
        tensor += inertia + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    if tensor.any() and not whole:
        raise refused(name, "has inertia and no mass")
    return RigidBody(whole, (tensor + tensor.T) / 2, tuple(centre))  # turned, it is symmetric but for rounding
