"""Meshes in text files of Abaqus, CalculiX, Nastran and Gmsh, by the numbers of nodes and elements."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.solids.shape_functions import DIMENSIONS, GMSH_ORDER, NASTRAN_ORDER, SHAPES

NASTRAN, ABAQUS = (".bdf", ".fem", ".nas"), (".inp",)  # endings
AGAIN = "write it again with all of its nodes"
# Elements of Abaqus by their types, of Nastran with their numbers of nodes, of Gmsh by their numbers and dimensions.
TYPES = {
    r"C3D(\d+)[A-Z]*": 3, r"(S|CPS|CPE|CAX|M3D|R3D|SFM3D|STRI)\d\w*": 2, r"[BT]\d\w*|SPRING[2A]": 1,
    r"MASS|ROTARYI|SPRING1|DCOUP3D": 0,
}  # fmt: skip
CARDS = {
    "CTETRA": (3, 4, 10), "CPYRAM": (3, 5, 13), "CPENTA": (3, 6, 15), "CHEXA": (3, 8, 20), "CTRIA3": (2, 3),
    "CTRIAR": (2, 3), "CTRIA6": (2, 6), "CQUAD4": (2, 4), "CQUADR": (2, 4), "CQUAD8": (2, 8), "CBAR": (1, 2),
    "CBEAM": (1, 2), "CROD": (1, 2),
}  # fmt: skip
GMSH = {15: 0, 1: 1, 8: 1, 2: 2, 3: 2, 9: 2, 10: 2, 16: 2} | dict.fromkeys((4, 5, 6, 7, 11, 12, 17, 18, 19), 3)


class Statement(NamedTuple):
    """A keyword of Abaqus with its options and the fields of its lines, or a card of Nastran with its fields."""

    word: str
    options: Mapping[str, str]
    rows: list[list[str]]


class Cells(NamedTuple):
    """Elements of a kind: indices of their nodes (e, k), their dimension, and their numbers (e,) in the file."""

    type: str
    data: Indices
    dim: int
    numbers: Indices


@dataclass
class TextMesh:
    """A mesh as it is read: places of nodes, kinds and nodes of elements, by their numbers in the file.

    `sets` of nodes and `groups` of elements have these numbers by name; `statements` are all of the file. :meth:`place`
    makes meshio's fields of them.
    """

    nodes: dict[int, tuple[float, ...]] = field(default_factory=dict)
    elements: dict[int, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    sets: dict[str, list[int]] = field(default_factory=dict)
    groups: dict[str, list[int]] = field(default_factory=dict)
    statements: list[Statement] = field(default_factory=list)
    cells: list[Cells] = field(default_factory=list)
    point_sets: dict[str, Any] = field(default_factory=dict)
    cell_sets: dict[str, Any] = field(default_factory=dict)
    cell_data: dict[str, Any] = field(default_factory=dict)
    field_data: dict[str, Any] = field(default_factory=dict)
    info: Any = None

    @property
    def points(self) -> Floats:
        """Places (k, 3) of the nodes."""
        return np.array(list(self.nodes.values()), dtype=float).reshape(-1, 3)

    def add(self, noun: str, number: int, value: Any) -> None:
        """Add a node or an element. InputError if another one has its number."""
        if noun == "node" and len(value) != 3:
            raise InputError("mesh", f"has node {number} with {len(value)} coordinates", "give x, y and z of each")
        entries: dict[int, Any] = self.nodes if noun == "node" else self.elements
        if entries.setdefault(number, value) != value:
            raise InputError("mesh", f"has two of {noun} {number}", "number them apart, in one part")

    def place(self, order: Mapping[str, list[int]], file: str) -> None:
        """Make meshio's blocks and sets, in which indices replace numbers. `order` is that of nodes by kinds."""
        index = {number: i for i, number in enumerate(self.nodes)}
        by_kind = dict[str, list[int]]()
        for number, (kind, nodes) in self.elements.items():
            by_kind.setdefault(kind, []).append(number)
            missing = [node for node in nodes if node not in index]
            if missing:
                raise InputError("mesh", f"has element {number} on node {missing[0]}, which is not in {file}", AGAIN)
        place_of = dict[int, tuple[int, int]]()  # block of an element, and index there
        for block, (kind, numbers) in enumerate(by_kind.items()):
            place_of |= {number: (block, i) for i, number in enumerate(numbers)}
            data = np.array([[index[node] for node in self.elements[number][1]] for number in numbers])
            self.cells.append(Cells(kind, data[:, order.get(kind, slice(None))], DIMENSIONS[kind], np.array(numbers)))
        for group, numbers in self.groups.items():
            pairs = np.array([place_of[n] for n in {*numbers} if n in place_of], dtype=int).reshape(-1, 2)
            self.cell_sets[group] = [np.sort(pairs[pairs[:, 0] == block, 1]) for block in range(len(by_kind))]
        for group, nodes_of_set in self.sets.items():
            self.point_sets[group] = np.array([index[node] for node in nodes_of_set], dtype=int)


def ending_of(source: Any) -> str:
    """The ending of a file's name, in small letters; empty of what is no file."""
    return Path(source).suffix.lower() if isinstance(source, (str, os.PathLike)) else ""


def text_mesh(source: str | os.PathLike[str]) -> TextMesh | None:
    """Read a mesh in a text file of Abaqus, CalculiX, Nastran or Gmsh; None if the file is of another kind."""
    ending = ending_of(source)
    if ending not in TEXTS:
        return None
    path, mesh, (read, order) = Path(source), TextMesh(), TEXTS[ending]
    if not read(mesh, path.read_text(encoding="utf-8", errors="replace"), path.name):
        return None
    mesh.place(order, path.name)
    return mesh


def _read_abaqus(mesh: TextMesh, text: str, _: str) -> bool:
    """Read the statements of a file, then transfer those of `_ABAQUS` into the mesh."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("**")]
    starts = [i for i, line in enumerate(lines) if line.startswith("*")]
    for first, end in pairwise([*starts, len(lines)]):
        while lines[first].rstrip().endswith(",") and first + 1 < end:  # a keyword goes on in the next line
            lines[first + 1] = lines[first].rstrip() + lines[first + 1]
            first += 1
        word, *options = lines[first][1:].split(",")
        pairs = (option.partition("=") for option in options if option.strip())
        values = {key.strip().upper(): value.strip() for key, _, value in pairs}
        rows = [[cell.strip() for cell in line.split(",")] for line in lines[first + 1 : end]]
        mesh.statements.append(Statement(" ".join(word.upper().split()), values, rows))
    for statement in mesh.statements:
        read = _ABAQUS.get(statement.word)
        if read and {"INPUT", "SYSTEM"} & {*statement.options}:
            _refuse(mesh, statement)
        elif read:
            read(mesh, statement)
    return True


def _node(mesh: TextMesh, statement: Statement) -> None:
    for number, *place in statement.rows:
        mesh.add("node", int(number), tuple(float(x or 0) for x in [*place, "", "", ""][:3]))
    _extend(mesh.sets, statement, "NSET", (int(row[0]) for row in statement.rows))


def _element(mesh: TextMesh, statement: Statement) -> None:
    """Add the elements of a statement to the mesh, each by its number and nodes, and to their set."""
    name = statement.options["TYPE"].upper()
    entries = [[int(cell) for cell in row if cell] for row in statement.rows]
    matches = [(dim, match) for pattern, dim in TYPES.items() if (match := re.fullmatch(pattern, name))]
    if not matches:
        raise ValueError(f"elements of type {name} are not known")
    (dim, match), flat = matches[0], list(chain.from_iterable(entries))
    in_line = len(entries[0]) - 1 if entries else 1
    count = int(match[1]) if dim == 3 else in_line  # solids may go on in the next line
    if count not in SHAPES[dim] or len(flat) % (count + 1):
        raise ValueError(f"elements of type {name} have not {count} nodes each")
    numbers, *nodes = np.reshape(flat, (-1, count + 1)).T.tolist()
    for number, of_element in zip(numbers, zip(*nodes, strict=True), strict=True):
        mesh.add("element", number, (SHAPES[dim][count], of_element))
    _extend(mesh.groups, statement, "ELSET", numbers)


def _set(mesh: TextMesh, statement: Statement) -> None:
    sets = mesh.sets if statement.word == "NSET" else mesh.groups
    _extend(sets, statement, statement.word, members(statement.rows, sets, "GENERATE" in statement.options))


def _extend(sets: dict[str, list[int]], statement: Statement, key: str, numbers: Iterable[int]) -> None:
    if key in statement.options:
        sets.setdefault(alike(sets, statement.options[key]), []).extend([*numbers])


def _refuse(_: TextMesh, statement: Statement) -> None:
    if statement.word != "INSTANCE" or any(map(any, statement.rows)):
        fix = "export one mesh into one file, in the basic system"
        raise InputError("mesh", f"has places or nodes by {statement.word}, which is not read", fix)


_ABAQUS: dict[str, Callable[[TextMesh, Statement], None]] = {
    "NODE": _node,
    "ELEMENT": _element,
    "NSET": _set,
    "ELSET": _set,
}
_REFUSED = ("INCLUDE", "SYSTEM", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "INSTANCE")
_ABAQUS |= dict.fromkeys(_REFUSED, _refuse)


def alike(sets: Mapping[str, list[int]], name: str) -> str:
    """Name under which a set exists. Abaqus does not tell capital letters from small ones."""
    return next((other for other in sets if other.upper() == name.upper()), name)


def members(rows: list[list[str]], sets: Mapping[str, list[int]], generated: bool = False) -> Iterator[int]:
    """Yield the numbers in a set's lines, which may name other sets or, if `generated`, give first and last numbers."""
    for row in rows:
        if generated:
            first, last, *step = map(int, filter(None, row))
            yield from range(first, last + 1, step[0] if step else 1)
        else:
            for cell in filter(None, row):
                yield from [int(cell)] if cell.isdigit() else sets[alike(sets, cell)]


def real(value: str) -> float:
    """Read a number as Nastran writes it, with or without the letter of its exponent. A blank is 0."""
    try:
        return float(value or 0.0)
    except ValueError:
        return float(re.sub(r"(?<=[\d.])(?=[+-])", "e", value.lower().replace("d", "e")))


def _read_nastran(mesh: TextMesh, text: str, file: str) -> bool:
    """Read the cards of bulk data: nodes, elements by property, and nodes that SPC cards hold as sets."""
    cards, bulk = list[list[str]](), re.split(r"^ *BEGIN +\w.*$", text, maxsplit=1, flags=re.M | re.I)[-1]
    for line in re.split(r"^ *ENDDATA\b", bulk, maxsplit=1, flags=re.M | re.I)[0].splitlines():
        bare = line.partition("$")[0].expandtabs().rstrip()
        count = 4 if "*" in bare[:8].partition(",")[0] else 8
        width = 64 // count
        parts = bare.split(",") if "," in bare else [bare[:8], *(bare[i : i + width] for i in range(8, 72, width))]
        first, *fields = [field.strip() for field in [*parts, *[""] * count][: count + 1]]
        if first[:1].isalpha():
            cards.append([first.rstrip("* _").upper(), *fields])  # meshio 5.3.5 writes CHEXA_
        elif bare and cards:
            if first[:1] not in ("", "+", "*"):
                raise ValueError(f"{bare!r} is no card")
            cards[-1] += fields
    held = dict[str, list[tuple[str, Iterable[int]]]]()
    for word, *row in cards:
        mesh.statements.append(Statement(word, {}, [row]))
        if word in ("GRID", "GRDSET") and row[1] not in ("", "0"):
            problem = f"{file} has nodes in coordinate system {row[1]}, which is not read"
            raise InputError("mesh", problem, "export them in the basic system")
        if word == "GRID":
            mesh.add("node", int(row[0]), tuple(map(real, [*row[2:5], "", ""][:3])))
        elif word in CARDS:
            _nastran_element(mesh, word, row)
        elif word in ("SPC", "SPC1"):
            held.setdefault(f"SPC {row[0]}", []).extend(_nastran_held(word, row))
        elif word == "INCLUDE":
            _refuse(mesh, mesh.statements[-1])
    for name, parts in held.items():
        if all({*"123"} <= {*ways} for ways, _ in parts):  # one that leaves a way free is no clamp
            mesh.sets[name] = [node for _, nodes in parts for node in nodes if node in mesh.nodes]
    return True


def _nastran_held(word: str, row: list[str]) -> Iterator[tuple[str, Iterable[int]]]:
    """Yield the components, such as "123", that a card holds, each with the nodes at which it does."""
    if word == "SPC":
        yield from ((ways, [int(node)]) for node, ways in (row[1:3], row[4:6]) if node)
        return
    ways, *nodes = filter(None, row[1:])
    words = [cell.upper() for cell in nodes]
    if "THRU" in words:
        yield ways, range(int(nodes[0]), int(nodes[words.index("THRU") + 1]) + 1)
    else:
        yield ways, map(int, nodes)


def _nastran_element(mesh: TextMesh, word: str, row: list[str]) -> None:
    """Add the element of a card to the mesh, and to the group of its property."""
    (dim, *counts), number = CARDS[word], int(row[0])
    end = 2 + counts[-1]
    nodes, rest = tuple(int(cell) for cell in row[2:end] if cell), row[end:]
    if len(nodes) not in counts:
        raise ValueError(f"{word} {number} has {len(nodes)} nodes")
    angle = 4 if word == "CQUAD8" else 0  # the only field behind the nodes that an element of a shell may have
    if dim == 2 and any(real(cell) for i, cell in enumerate(rest) if i != angle):
        problem = f"has {word} {number}, which has an offset or thicknesses of its own"
        raise InputError("mesh", problem, "leave them out")
    mesh.add("element", number, (SHAPES[dim][len(nodes)], nodes))
    mesh.groups.setdefault(row[1] or row[0], []).append(number)


def _read_gmsh(mesh: TextMesh, text: str, _: str) -> bool:
    """Read a file of version 2.2 or 4.1 as text; return False of another one, or of a binary one."""

    def section(name: str) -> list[list[str]]:
        inside = text.partition(f"${name}\n")[2].partition(f"$End{name}")[0]
        return [line.split() for line in inside.splitlines() if line.strip()]

    form = re.search(r"^\$MeshFormat\s+(2(?:\.[0-2])?|4(?:\.1)?) 0 ", text, re.M)
    if not form:
        return False
    nodes, elements = section("Nodes")[1:], section("Elements")[1:]
    names = {(int(row[0]), row[1]): " ".join(row[2:]).strip('"') for row in section("PhysicalNames")[1:]}
    numbered, number_of = dict[str, list[int]](), dict[Any, int]()  # elements by tag; number by kind and nodes
    mesh.groups |= {name: [] for name in names.values()}

    def add(number: str, kind: str, nodes: list[str], tags: list[str]) -> None:
        """Add an element to the mesh, unless it is there, and to the groups of its tags."""
        dim = GMSH.get(int(kind), 3)
        if len(nodes) not in SHAPES[dim] or int(kind) not in GMSH:
            raise ValueError(f"element {number} is of Gmsh's type {kind}")
        element = SHAPES[dim][len(nodes)], tuple(map(int, nodes))
        first = number_of.setdefault(element, int(number))  # one of two groups is there twice, by two numbers
        mesh.add("element", first, element)
        for tag in tags:
            numbered.setdefault(tag, []).append(first)
            if (dim, tag) in names:
                mesh.groups[names[dim, tag]].append(first)

    if form[1].startswith("2"):
        for number, *place in nodes:
            mesh.add("node", int(number), tuple(map(float, place)))
        for number, kind, count, *rest in elements:
            add(number, kind, rest[int(count) :], [tag for tag in rest[: int(count)][:1] if tag != "0"])
    else:
        physical = _physical(section("Entities"))
        for _head, rows in _blocks(nodes, 2):
            half = len(rows) // 2
            for (number,), place in zip(rows[:half], rows[half:], strict=True):
                mesh.add("node", int(number), tuple(map(float, place[:3])))
        for (dim, entity, kind, _), rows in _blocks(elements, 1):
            for number, *on_nodes in rows:
                add(number, kind, on_nodes, physical.get((int(dim), entity), []))
    named = {name: members for name, members in mesh.groups.items() if members}
    mesh.groups = named | {tag: numbered[tag] for tag in sorted(numbered, key=int)}
    return True


def _blocks(rows: list[list[str]], times: int) -> Iterator[tuple[list[str], list[list[str]]]]:
    """Yield the head and the lines of each block. The head ends with a number, and `times` as many lines follow."""
    head = 0
    while head < len(rows):
        end = head + 1 + times * int(rows[head][3])
        yield rows[head], rows[head + 1 : end]
        head = end


def _physical(rows: list[list[str]]) -> dict[tuple[int, str], list[str]]:
    """Physical groups of points, curves, surfaces and volumes, by dimensions and numbers in the list of entities."""
    dims = [dim for dim, count in enumerate(rows[0] if rows else []) for _ in range(int(count))]
    groups = dict[tuple[int, str], list[str]]()
    for dim, row in zip(dims, rows[1:], strict=True):
        count, *tags = row[4 if dim == 0 else 7 :]  # behind a place, or a box
        groups[dim, row[0]] = [tag.lstrip("-") for tag in tags[: int(count)]]
    return groups


TEXTS: dict[str, tuple[Callable[[TextMesh, str, str], bool], dict[str, list[int]]]] = {
    ".msh": (_read_gmsh, GMSH_ORDER),
    **dict.fromkeys(NASTRAN, (_read_nastran, NASTRAN_ORDER)),
    **dict.fromkeys(ABAQUS, (_read_abaqus, {})),
}
