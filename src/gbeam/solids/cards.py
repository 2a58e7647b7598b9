"""Masses, rigid links and springs in files of Nastran, Abaqus and CalculiX, which meshio leaves out."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.mechanics.tree.system import RigidBody
from gbeam.numerics.eigen import Floats
from gbeam.solids.links import Links, coupling
from gbeam.solids.shape_functions import Indices
from gbeam.solids.texts import abaqus_keywords, ending_of

NASTRAN, ABAQUS = (".bdf", ".fem", ".nas"), (".inp",)
APART = 1e-6  # of the size of a mesh: nodes that are farther apart are not one place


class Lump(NamedTuple):
    """A mass on a node, with its centre from there and its inertia (3, 3) about that, in axes of the file."""

    name: str
    node: int
    mass: float
    offset: Floats
    inertia: Floats


class Spring(NamedTuple):
    """A spring from a node to another one, or to the base, with its stiffness (6,) along and about the file's axes."""

    name: str
    nodes: tuple[int, ...]
    stiffness: Floats


@dataclass(frozen=True)
class Cards:
    """Statements of a file besides its mesh: places of nodes in it by their numbers, nodes that a rigid link holds, by
    its name, masses, and springs; and the words of it that are read.
    """

    index: Mapping[int, int] = field(default_factory=dict)
    rigid: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    lumps: tuple[Lump, ...] = ()
    springs: tuple[Spring, ...] = ()
    words: tuple[str, ...] = ()


def cards_of(source: Any) -> Cards:
    """Read what a file says besides its mesh; nothing of a file of another kind."""
    ending = ending_of(source)
    try:
        return _nastran(source) if ending in NASTRAN else _abaqus(source) if ending in ABAQUS else Cards()
    except (ValueError, TypeError, IndexError, KeyError) as error:
        problem = f"{os.fspath(source)} has masses, links or springs that cannot be read: {error}"
        raise InputError("mesh", problem, "mend them, or leave mass_unit out") from None


OTHERWISE = "give it as a link, a body or a spring in place of mass_unit"


def _refused(name: str, problem: str, fix: str = OTHERWISE) -> InputError:
    return InputError("mesh", f"has {name}, which {problem}", fix)


def _nastran(source: str | os.PathLike[str]) -> Cards:
    try:
        from pyyeti.nastran import bulk
    except ModuleNotFoundError:
        raise InputError("", "pyyeti is not installed", 'install it with: pip install "gbeam[nastran]"') from None

    def rows(card: str) -> Iterator[list[Any]]:
        """Rows of a card, with as many blanks behind as any has fields; its name has no other letters behind."""
        for row in bulk.rdcards(os.fspath(source), rf"{card}[ ,*]", regex=True, return_var="list", no_data_return=[]):
            yield [*row, *[""] * 24]

    def numbers(values: list[Any]) -> Floats:
        return np.array([each if each != "" else 0.0 for each in values], dtype=float)

    grids = [(int(row[0]), row[5]) for row in rows("GRID")]
    turned = {number for number, system in grids if system not in ("", 0)}
    rigid, lumps, springs = dict[str, tuple[int, ...]](), list[Lump](), list[Spring]()
    for row in rows("RBE2"):
        name = f"RBE2 {row[0]}"
        if row[2] not in (123, 123456):
            raise _refused(name, f"holds the components {row[2]} alone")
        rigid[name] = (int(row[1]), *(int(each) for each in row[3:] if isinstance(each, int)))
    for row in rows("CONM2"):
        name = f"CONM2 {row[0]}"
        if row[2] not in ("", 0):
            raise _refused(name, f"is in coordinate system {row[2]}", "export it in the basic system")
        xx, xy, yy, xz, yz, zz = numbers(row[8:14])
        # The card has the products of inertia, of which the tensor has the opposite.
        tensor = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
        lumps.append(Lump(name, int(row[1]), float(row[3] or 0.0), numbers(row[4:7]), tensor))
    scalar = {int(row[i]): float(row[i + 1]) for row in rows("PELAS") for i in (0, 4) if row[i] != ""}
    for card in ("CELAS1", "CELAS2"):
        for row in rows(card):
            name, value = f"{card} {row[0]}", scalar.get(row[1]) if card == "CELAS1" else row[1]
            ends = [(int(row[i]), int(row[i + 1])) for i in (2, 4) if row[i] not in ("", 0)]
            if value is None:
                raise _refused(name, f"names PELAS {row[1]}, which is not there", "export it too")
            if len({way for _, way in ends}) != 1 or not 1 <= ends[0][1] <= 6:
                raise _refused(name, "joins unlike components")
            springs.append(Spring(name, tuple(node for node, _ in ends), float(value) * np.eye(6)[ends[0][1] - 1]))
    properties = {int(row[0]): numbers(row[2:8]) for row in rows("PBUSH") if row[1] == "K"}
    for row in rows("CBUSH"):
        name = f"CBUSH {row[0]}"
        if row[7] != 0:
            raise _refused(name, "has axes of its own", "give it CID 0, the basic system")
        if row[1] not in properties:
            raise _refused(name, f"names PBUSH {row[1]}, whose K is not there", "export it too")
        joined = tuple(int(each) for each in row[2:4] if each not in ("", 0))
        springs.append(Spring(name, joined, properties[row[1]]))
    for each in springs:
        if turned.intersection(each.nodes):
            raise _refused(each.name, "acts along axes of a coordinate system", "export its nodes in the basic system")
    words = ("CONM2", "RBE2", "CELAS1", "CELAS2", "CBUSH")
    return Cards({number: i for i, (number, _) in enumerate(grids)}, rigid, tuple(lumps), tuple(springs), words)


def _abaqus(source: str | os.PathLike[str]) -> Cards:
    index, sets, elements = dict[int, int](), dict[str, list[int]](), dict[str, list[list[int]]]()
    rigid, lumps, springs = dict[str, tuple[int, ...]](), list[Lump](), list[Spring]()
    blocks = list(abaqus_keywords(Path(source).read_text(encoding="utf-8", errors="replace")))
    for word, options, rows in blocks:
        if word == "NODE":
            index |= {int(row[0]): len(index) + i for i, row in enumerate(rows)}
            sets.setdefault(options.get("NSET", ""), []).extend(int(row[0]) for row in rows)
        elif word == "NSET":
            sets.setdefault(options["NSET"], []).extend(_members(rows, sets, "GENERATE" in options))
        elif word == "ELEMENT" and options["TYPE"].upper() in POINTWISE:
            listed = [[int(each) for each in row[1:]] for row in rows]
            elements.setdefault(options.get("ELSET", ""), []).extend(listed)
    for word, options, rows in blocks:
        name = f"*{word} {options.get('ELSET', options.get('NSET', ''))}".strip()
        on = elements.get(options.get("ELSET", ""), [])
        values = [[float(each or 0) for each in row] for row in rows] if word in _VALUED else []
        if word == "MASS":
            lumps += [Lump(name, nodes[0], values[0][0], np.zeros(3), np.zeros((3, 3))) for nodes in on]
        elif word == "ROTARY INERTIA":
            if any(values[0][3:]) or "ORIENTATION" in options:
                raise _refused(name, "has products of inertia, or axes of its own")
            lumps += [Lump(name, nodes[0], 0.0, np.zeros(3), np.diag(values[0][:3])) for nodes in on]
        elif word == "SPRING":
            ways = {int(each) for each in values[0][: len(on[0]) if on else 1]}
            if len(ways) != 1 or "ORIENTATION" in options or any(len(nodes) != len(on[0]) for nodes in on):
                raise _refused(name, "joins unlike components, or has axes of its own")
            springs += [Spring(name, tuple(nodes), values[1][0] * np.eye(6)[min(ways) - 1]) for nodes in on]
        elif word == "RIGID BODY":
            if options.get("NSET") not in sets:
                raise _refused(name, "has no set of nodes", "name them by NSET")
            ends = [int(options[key]) for key in ("REF NODE", "ROT NODE") if key in options]
            rigid[f"{name} of node {ends[0] if ends else ''}".strip()] = (*ends, *sets[options["NSET"]])
    return Cards(index, rigid, tuple(lumps), tuple(springs), (*_VALUED, "RIGID BODY"))


POINTWISE = ("MASS", "ROTARYI", "SPRING1", "SPRING2")
_VALUED = ("MASS", "ROTARY INERTIA", "SPRING")


def _members(rows: list[list[str]], sets: Mapping[str, list[int]], generated: bool) -> Iterator[int]:
    for row in rows:
        if generated:
            first, last, *step = map(int, filter(None, row))
            yield from range(first, last + 1, step[0] if step else 1)
        else:
            for each in filter(None, row):
                yield from [int(each)] if each.isdigit() else sets.get(each, [])


@dataclass(frozen=True)
class Placed:
    """Nodes of a file: places (f, 3) m in base axes, and rotation to these from the file's; points (k, 3) of the solid,
    the nodes (k,) for which they stand, and whether they follow the base.
    """

    places: Floats
    rotation: Floats
    points: Floats
    numbers: Indices
    clamped: Any


def with_cards(cards: Cards, links: Links, nodes: Placed, size: float, mass: float) -> tuple[Links, Floats]:
    """Links with those of a file, whose units of length and mass are given, m and kg, and of time s; and its masses on
    nodes of the solid (k,), kg.
    """
    if cards.index and len(cards.index) != len(nodes.places):
        problem = f"has {len(cards.index)} nodes where its masses and links are, and {len(nodes.places)} in all"
        raise InputError("mesh", problem, "write it into one file, without includes")
    ends = np.cumsum(np.bincount(nodes.numbers, minlength=len(nodes.places)))[:-1]
    points_of = np.split(np.argsort(nodes.numbers, kind="stable"), ends)
    solid_of = {number: points_of[i] for number, i in cards.index.items()}
    place_of = {number: nodes.places[i] for number, i in cards.index.items()}
    within = float(np.linalg.norm(np.ptp(nodes.places, axis=0))) * APART
    members, places, owner = dict(links.nodes), dict(links.places), dict[int, str]()
    base, weights = "the base", np.zeros(len(nodes.clamped))

    def link(name: str, numbers: tuple[int, ...]) -> None:
        if unknown := [each for each in numbers if each not in solid_of]:
            raise _refused(name, f"names node {unknown[0]}, which is not there", "export it too")
        chosen = np.unique(np.concatenate([solid_of[each] for each in numbers]))
        if len(chosen) and nodes.clamped[chosen].all():
            owner.update(dict.fromkeys(numbers, base))
            return
        shared = [owner[each] for each in numbers if each in owner]
        shared += [other for other, held in members.items() if np.isin(chosen, held).any()]
        if shared or nodes.clamped[chosen].any():
            raise _refused(name, f"shares nodes with {shared[0] if shared else 'the clamp'}", "make them one")
        if len(np.unique(nodes.numbers[chosen])) > 1:
            coupling(f"mesh, {name}:", nodes.points[chosen])
        members[name], places[name] = chosen, place_of[numbers[0]]
        owner.update(dict.fromkeys(numbers, name))

    def owned(name: str, number: int) -> str:
        if number not in owner:
            link(f"node {number}" if number in solid_of else name, (number,))
        return owner[number]

    for name, numbers in cards.rigid.items():
        link(name, numbers)
    carried: dict[str, list[tuple[float, Floats, Floats]]] = {}
    # First those that turn, which a mass on the same node joins.
    for each in sorted(cards.lumps, key=lambda lump: not (lump.inertia.any() or lump.offset.any())):
        tensor = mass * size**2 * nodes.rotation @ each.inertia @ nodes.rotation.T
        offset = size * nodes.rotation @ each.offset
        alike = solid_of.get(each.node, ())
        if each.node not in owner and len(alike):
            if not tensor.any() and not offset.any():
                weights[alike] += mass * each.mass / len(alike)
                continue
            if len(alike) == 1:
                fix = "join it to the solid by a rigid link"
                raise _refused(each.name, f"has an offset or inertia on node {each.node}, which does not turn", fix)
        name = owned(each.name, each.node)
        if name != base:
            at = place_of[each.node] + offset - places[name]
            carried.setdefault(name, []).append((mass * each.mass, at, tensor))
    held = dict(links.springs)
    for k, spring in enumerate(cards.springs):
        joined = [owned(spring.name, number) for number in spring.nodes]
        across = max(float(np.linalg.norm(place_of[each] - place_of[spring.nodes[0]])) for each in spring.nodes)
        if across > within:
            raise _refused(spring.name, f"joins nodes {across:.3g} m apart", "let it join nodes at one place")
        between = tuple(dict.fromkeys(each for each in joined if each != base))
        if not between or (len(spring.nodes) == 2 and joined[0] == joined[1]):
            continue  # between what moves together
        if not np.allclose(nodes.rotation, np.eye(3)):
            raise _refused(spring.name, "lies along the mesh's axes, and turn turns them", "leave turn out")
        alone = [each for each in between if len(members[each]) == 1]
        if spring.stiffness[3:].any() and alone:
            raise _refused(spring.name, f"turns {alone[0]} of the solid, which does not", "join it by a rigid link")
        held[f"{spring.name}, {k + 1}"] = (
            between,
            mass * spring.stiffness * np.repeat([1.0, size**2], 3),
            place_of[spring.nodes[0]],
        )
    bodies = dict(links.bodies) | {name: _together(name, parts) for name, parts in carried.items()}
    used = {*bodies, *(each for between, *_ in held.values() for each in between)}
    members = {name: each for name, each in members.items() if len(each) or name in used}
    tied = Links(members, bodies, held, {name: places[name] for name in members if name in places})
    for name, chosen in members.items():
        if not len(chosen):
            _refuse_unheld(name, tied)
    return tied, weights


def _refuse_unheld(name: str, links: Links) -> None:
    """Refuse a link of no node of the solid that no spring holds."""
    stiffness = sum((each for between, each, _ in links.springs.values() if name in between), np.zeros(6))
    body = links.bodies.get(name)
    resisting = np.zeros(3) if body is None else np.diag(body.tensor) + np.abs(body.centre).sum()
    loose = stiffness[:3].min() == 0 or (stiffness[3:] == 0)[resisting > 0].any()
    if loose:
        raise _refused(name, "is on no node of the solid, and its springs leave it a way to move", "hold it")


def _together(name: str, parts: list[tuple[float, Floats, Floats]]) -> RigidBody:
    """One body of masses, centres and inertias about these."""
    whole = sum(mass for mass, *_ in parts)
    centre = sum((mass * at for mass, at, _ in parts), np.zeros(3)) / whole if whole else np.zeros(3)
    tensor = np.zeros((3, 3))
    for mass, at, inertia in parts:
        arm = at - centre
        tensor += inertia + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    if tensor.any() and not whole:
        raise _refused(name, "has inertia and no mass")
    return RigidBody(whole, (tensor + tensor.T) / 2, tuple(centre))  # turned, it is symmetric but for rounding
