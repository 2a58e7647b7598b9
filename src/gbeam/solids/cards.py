"""Masses, rigid links and springs in files of Nastran, Abaqus and CalculiX, which meshio leaves out."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.numerics.eigen import Floats
from gbeam.solids.shape_functions import KINDS, Indices, reference
from gbeam.solids.stress import FACES, corners_of
from gbeam.solids.texts import ABAQUS, NASTRAN, abaqus_elements, abaqus_keywords, ending_of


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
    its name, those of a link that has the mean motion of others, with their weights, masses, and springs; and the words
    of it that are read.
    """

    index: Mapping[int, int] = field(default_factory=dict)
    rigid: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    lumps: tuple[Lump, ...] = ()
    springs: tuple[Spring, ...] = ()
    words: tuple[str, ...] = ()
    mean: Mapping[str, tuple[int, Mapping[int, float]]] = field(default_factory=dict)


def cards_of(source: Any) -> Cards:
    """Read what a file says besides its mesh; nothing of a file of another kind."""
    ending = ending_of(source)
    try:
        return _nastran(source) if ending in NASTRAN else _abaqus(source) if ending in ABAQUS else Cards()
    except InputError:
        raise
    except (ValueError, TypeError, IndexError, KeyError) as error:
        problem = f"{os.fspath(source)} has masses, links or springs that cannot be read: {error}"
        raise InputError("mesh", problem, "mend them, or leave mass_unit out") from None


OTHERWISE = "give it as a link, a body or a spring in place of mass_unit"


def refused(name: str, problem: str, fix: str = OTHERWISE) -> InputError:
    """The error that a named statement of a file cannot be taken."""
    return InputError("mesh", f"has {name}, which {problem}", fix)


def _nastran(source: str | os.PathLike[str]) -> Cards:
    try:
        with np.printoptions():  # that the import changes
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
    rigid, whole = dict[str, tuple[int, ...]](), dict[str, tuple[int, ...]]()
    lumps, springs = list[Lump](), list[Spring]()
    for row in rows("RBE2"):
        name = f"RBE2 {row[0]}"
        if row[2] not in (123, 123456):
            raise refused(name, f"holds the components {row[2]} alone")
        whole[name] = (int(row[1]), *(int(each) for each in row[3:] if isinstance(each, int)))
        if row[2] == 123:
            rigid[name] = whole.pop(name)
    for row in rows("RBAR"):
        name, held = f"RBAR {row[0]}", [str(each or "") for each in row[3:5]]
        if sorted(held) != ["", "123456"]:
            raise refused(name, f"holds the components {' and '.join(filter(None, held))} of its ends")
        whole[name] = int(row[1]), int(row[2])
    rigid |= _joined(whole)
    mean = {f"RBE3 {row[0]}": (int(row[2]), _weights(f"RBE3 {row[0]}", row[3:])) for row in rows("RBE3")}
    for row in rows("CONM2"):
        name = f"CONM2 {row[0]}"
        if row[2] not in ("", 0):
            raise refused(name, f"is in coordinate system {row[2]}", "export it in the basic system")
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
                raise refused(name, f"names PELAS {row[1]}, which is not there", "export it too")
            if len({way for _, way in ends}) != 1 or not 1 <= ends[0][1] <= 6:
                raise refused(name, "joins unlike components")
            springs.append(Spring(name, tuple(node for node, _ in ends), float(value) * np.eye(6)[ends[0][1] - 1]))
    properties = {int(row[0]): numbers(row[2:8]) for row in rows("PBUSH") if row[1] == "K"}
    for row in rows("CBUSH"):
        name = f"CBUSH {row[0]}"
        if row[7] != 0:
            raise refused(name, "has axes of its own", "give it CID 0, the basic system")
        if row[1] not in properties:
            raise refused(name, f"names PBUSH {row[1]}, whose K is not there", "export it too")
        joined = tuple(int(each) for each in row[2:4] if each not in ("", 0))
        springs.append(Spring(name, joined, properties[row[1]]))
    for each in springs:
        if turned.intersection(each.nodes):
            raise refused(each.name, "acts along axes of a coordinate system", "export its nodes in the basic system")
    words = ("CONM2", "RBE2", "RBE3", "RBAR", "CELAS1", "CELAS2", "CBUSH")
    return Cards({number: i for i, (number, _) in enumerate(grids)}, rigid, tuple(lumps), tuple(springs), words, mean)


def _weights(name: str, fields: list[Any]) -> dict[int, float]:
    """Weights of the nodes whose mean motion an RBE3 has."""
    held, *rest = [each for each in fields if each != ""]
    end = next((i for i, each in enumerate(rest) if isinstance(each, str)), len(rest))
    weights, starts = dict[int, float](), [i for i, each in enumerate(rest[:end]) if isinstance(each, float)]
    for start, stop in pairwise([*starts, end]):
        weight, ways, *nodes = rest[start:stop]
        if ways not in (123, 123456) or held not in (123, 123456):
            raise refused(name, f"holds the components {held} by the components {ways}")
        weights |= dict.fromkeys(nodes, weight)
    return weights


def _joined(rigid: Mapping[str, tuple[int, ...]]) -> dict[str, tuple[int, ...]]:
    """Rigid links by the names of the first ones, those that share a node as one."""
    joined = dict[str, tuple[int, ...]]()
    for name, nodes in rigid.items():
        shared = [other for other, held in joined.items() if set(nodes) & set(held)]
        every = [number for other in shared for number in joined.pop(other)]
        joined[shared[0] if shared else name] = tuple(dict.fromkeys([*every, *nodes]))
    return joined


def _abaqus(source: str | os.PathLike[str]) -> Cards:
    index, sets, elements = dict[int, int](), dict[str, list[int]](), dict[str, list[list[int]]]()
    rigid, lumps, springs = dict[str, tuple[int, ...]](), list[Lump](), list[Spring]()
    mean, coupled = dict[str, tuple[int, Mapping[int, float]]](), ("*COUPLING", 0, "")
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
                raise refused(name, "has products of inertia, or axes of its own")
            lumps += [Lump(name, nodes[0], 0.0, np.zeros(3), np.diag(values[0][:3])) for nodes in on]
        elif word == "SPRING":
            ways = {int(each) for each in values[0][: len(on[0]) if on else 1]}
            if len(ways) != 1 or "ORIENTATION" in options or any(len(nodes) != len(on[0]) for nodes in on):
                raise refused(name, "joins unlike components, or has axes of its own")
            springs += [Spring(name, tuple(nodes), values[1][0] * np.eye(6)[min(ways) - 1]) for nodes in on]
        elif word == "RIGID BODY":
            if options.get("NSET") not in sets:
                raise refused(name, "has no set of nodes", "name them by NSET")
            ends = [int(options[key]) for key in ("REF NODE", "ROT NODE") if key in options]
            rigid[f"{name} of node {ends[0] if ends else ''}".strip()] = (*ends, *sets[options["NSET"]])
        elif word == "COUPLING":
            coupled = (
                f"*COUPLING {options.get('CONSTRAINT NAME', '')}".strip(),
                int(options["REF NODE"]),
                options["SURFACE"],
            )
        elif word == "KINEMATIC":
            name, node, surface = coupled
            held = {
                way for row in rows if any(row) for way in range(int(row[0]), int(row[1] if row[1:] else row[0]) + 1)
            }
            if held and not held >= {1, 2, 3}:
                raise refused(name, f"holds the components {', '.join(map(str, sorted(held)))} alone")
            rigid[name] = node, *sorted(_surface(blocks, sets, surface) - {node})
        elif word == "DISTRIBUTING":
            name, node, surface = coupled
            nodes = _surface(blocks, sets, surface)
            if "NODE" not in [about.get("TYPE", "").upper() for _, about, _ in blocks if about.get("NAME") == surface]:
                fix = "give a surface of nodes, or *DISTRIBUTING COUPLING, which has them"
                raise refused(name, "shares forces out by the areas of faces", fix)
            mean[name] = node, dict.fromkeys(nodes, 1.0)
        elif word == "DISTRIBUTING COUPLING":
            pairs = ((number, row[1]) for row in rows for number in _members([row[:1]], sets, False))
            mean[name] = on[0][0], {number: float(weight) for number, weight in pairs}
    read = (*_VALUED, "RIGID BODY", "COUPLING", "KINEMATIC", "DISTRIBUTING", "DISTRIBUTING COUPLING")
    return Cards(index, rigid, tuple(lumps), tuple(springs), read, mean)


POINTWISE = ("MASS", "ROTARYI", "SPRING1", "SPRING2", "DCOUP3D")
_VALUED = ("MASS", "ROTARY INERTIA", "SPRING")


def _members(rows: list[list[str]], sets: Mapping[str, list[int]], generated: bool) -> Iterator[int]:
    for row in rows:
        if generated:
            first, last, *step = map(int, filter(None, row))
            yield from range(first, last + 1, step[0] if step else 1)
        else:
            for each in filter(None, row):
                yield from [int(each)] if each.isdigit() else sets.get(each, [])


def _surface(blocks: list[Any], sets: Mapping[str, list[int]], name: str) -> set[int]:
    """Nodes of a surface of nodes, of faces of solid elements by Abaqus's numbers, or of shells."""
    named = [(options, rows) for word, options, rows in blocks if word == "SURFACE" and options.get("NAME") == name]
    if not named:
        raise refused(f"a coupling of surface {name!r}", "is not there", "export it too")
    options, rows = named[0]
    if options.get("TYPE", "").upper() == "NODE":
        return set(_members(rows, sets, False))
    elements, groups = dict[int, tuple[bool, list[int]]](), dict[str, list[int]]()
    for word, about, lines in blocks:
        if word == "ELEMENT":
            listed = dict(abaqus_elements(lines))
            solid = about["TYPE"].upper().startswith("C3D")
            elements |= {number: (solid, on) for number, on in listed.items()}
            groups.setdefault(about.get("ELSET", ""), []).extend(listed)
        elif word == "ELSET":
            groups.setdefault(about["ELSET"], []).extend(_members(lines, groups, "GENERATE" in about))
    nodes = set[int]()
    for part, *face in rows:
        for number in _members([[part]], groups, False):
            solid, on = elements[number]
            nodes.update([on[i] for i in _on_face(len(on), int(face[0][1:]) - 1)] if solid else on)
    return nodes


@cache
def _on_face(count: int, face: int) -> Indices:
    """Nodes, of so many, on a face of a solid element: those in the plane of its corners."""
    kind = next(kind for kind, each in KINDS.items() if not each.shell and len(reference(kind)) == count)
    places, corners = reference(kind), FACES[corners_of(kind)][face][:3]
    across = np.cross(*(places[list(corners[1:])] - places[corners[0]]))
    return np.flatnonzero(np.abs((places - places[corners[0]]) @ across) < 1e-9)
