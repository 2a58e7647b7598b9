"""Masses, rigid links and springs in files of Nastran, Abaqus and CalculiX, besides their meshes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.solids.shape_functions import DIMENSIONS, SHAPES, shared_area
from gbeam.solids.stress import face_nodes
from gbeam.solids.texts import ABAQUS, NASTRAN, TextMesh, alike, ending_of, members, real

Options = Mapping[str, str]
Rows = list[list[str]]
Nodes = list[tuple[int, ...]]  # of elements


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


# Statements of Nastran, Abaqus and CalculiX that carry mass, stiffness or constraints.
_CARRYING = re.compile(
    r"CONM[12]|CMASS[1-4]|NSM\w*|CELAS[1-4]|CBUSH\w*|RBE[123]|RBAR|RROD|RSPLINE|CBAR|CBEAM|CBEND|CROD|CONROD|CTUBE"
    r"|CWELD|CFAST|CGAP|CSHEAR|C(TRI|QUAD)[^\WX]*X\w*|PSHELL|PCOMP\w?|MASS|ROTARY INERTIA|NONSTRUCTURAL MASS|SPRING|TIE"
    r"|RIGID BODY|CONNECTOR SECTION|(\w+ )?COUPLING|KINEMATIC|DISTRIBUTING|EQUATION|MPC|CONTACT PAIR|GAP|TRANSFORM"
    r"|(BEAM|SHELL)( GENERAL)? SECTION(, \w+)*|SOLID SECTION, COMPOSITE"
)


@dataclass
class Cards:
    """Statements of a file besides its mesh: the numbers (k,) of its nodes, the nodes of each rigid link by its name,
    masses, and springs. `mean` names the node that has the mean motion of others, with the weights of these. `words`
    are the statements that are read.
    """

    nodes: Any = ()
    rigid: dict[str, tuple[int, ...]] = field(default_factory=dict)
    lumps: list[Lump] = field(default_factory=list)
    springs: list[Spring] = field(default_factory=list)
    mean: dict[str, tuple[int, Mapping[int, float]]] = field(default_factory=dict)
    words: tuple[str, ...] = ()

    def parts(self) -> dict[str, Any]:
        """Return the statements as plain values and arrays, which another process can pass on."""
        mean = {name: [node, [*shares], [*shares.values()]] for name, (node, shares) in self.mean.items()}
        lumps, springs = [tuple(lump) for lump in self.lumps], [tuple(spring) for spring in self.springs]
        return {"rigid": self.rigid, "lumps": lumps, "springs": springs, "mean": mean, "words": self.words}

    @classmethod
    def from_parts(cls, nodes: Any, parts: Mapping[str, Any]) -> Cards:
        """Make the statements of what :meth:`parts` returned. There are none for a mesh of another kind of file."""
        if not parts:
            return cls(nodes)
        mean: dict[str, tuple[int, Mapping[int, float]]] = {
            name: (node, dict(zip(numbers, weights, strict=True)))
            for name, (node, numbers, weights) in parts["mean"].items()
        }
        lumps, springs = [Lump(*values) for values in parts["lumps"]], [Spring(*values) for values in parts["springs"]]
        return cls(nodes, parts["rigid"], lumps, springs, mean, parts["words"])


def carrying(mesh: TextMesh) -> dict[str, int]:
    """Count the statements of a file that carry mass, stiffness or constraints, by their names."""
    counts = Counter[str]()
    for word, options, _ in mesh.statements:
        name = ", ".join([word, *(option for option in ("COMPOSITE", "OFFSET") if option in options)])
        counts[name] += bool(_CARRYING.fullmatch(name))
    return dict(+counts)


def read_cards(path: str, mesh: TextMesh) -> Cards:
    """Read the statements of a file besides its mesh, which files of Nastran, Abaqus and CalculiX have."""
    ending = ending_of(path)
    reader = _Nastran if ending in NASTRAN else _Abaqus if ending in ABAQUS else _Reader
    cards = reader(mesh)
    try:
        cards.read()
    except InputError:
        raise
    except (ValueError, TypeError, IndexError, KeyError) as error:
        problem = f"{path} has masses, links or springs that cannot be read: {error}"
        raise InputError("mesh", problem, "mend them, or leave mass_unit out") from None
    return cards


OTHERWISE = "give it as a link, a body or a spring in place of mass_unit"


def refused(name: str, problem: str, fix: str = OTHERWISE) -> InputError:
    """The error that a named statement of a file cannot be taken."""
    return InputError("mesh", f"has {name}, which {problem}", fix)


class _Reader(Cards):
    """Statements as they are read beside a mesh: none."""

    known: ClassVar[tuple[str, ...]] = ()

    def __init__(self, mesh: TextMesh) -> None:
        super().__init__(words=self.known)
        self.mesh = mesh

    def read(self) -> None:
        """Read the statements."""


class _Nastran(_Reader):
    """Cards of Nastran, each by the method of its name."""

    known = ("CONM2", "RBE2", "RBE3", "RBAR", "CELAS1", "CELAS2", "CBUSH")

    def read(self) -> None:
        """Read properties first, then each card by its method, and join rigid links that share nodes."""
        default_system = next((row[5] for row in self._rows("GRDSET")), "")
        systems = [(row[0], default_system if row[5] == "" else row[5]) for row in self._rows("GRID")]
        self._turned = {node for node, system in systems if system not in ("", 0)}
        self._scalar = {row[i]: row[i + 1] for row in self._rows("PELAS") for i in (0, 4) if row[i] != ""}
        self._bush = {row[0]: _numbers(row[2:8]) for row in self._rows("PBUSH") if row[1] == "K"}
        for word in self.words:
            for row in self._rows(word):
                getattr(self, f"_{word.lower()}")(f"{word} {row[0]}", row)
        # Links that hold displacements alone are pinned to one another, and not joined.
        names = {f"RBE2 {row[0]}" for row in self._rows("RBE2") if row[2] == 123}
        pinned = {name: nodes for name, nodes in self.rigid.items() if name in names}
        self.rigid = pinned | _joined({name: nodes for name, nodes in self.rigid.items() if name not in names})

    def _rows(self, word: str) -> Iterator[list[Any]]:
        """Rows of values of all cards of a name. Blanks are appended, so that every field may be asked for."""
        return ([*map(_value, card.rows[0]), *[""] * 24] for card in self.mesh.statements if card.word == word)

    def _rbe2(self, name: str, row: list[Any]) -> None:
        if row[2] not in (123, 123456):
            raise refused(name, f"holds the components {row[2]} alone")
        self.rigid[name] = int(row[1]), *(int(field) for field in row[3:] if isinstance(field, int))

    def _rbar(self, name: str, row: list[Any]) -> None:
        components = [str(cell or "") for cell in row[3:5]]
        if sorted(components) != ["", "123456"]:
            raise refused(name, f"holds the components {' and '.join(filter(None, components))} of its ends")
        self.rigid[name] = int(row[1]), int(row[2])

    def _rbe3(self, name: str, row: list[Any]) -> None:
        """Read the components held, then groups of a weight, its components and its nodes, up to a word."""
        held, *rest = [field for field in row[3:] if field != ""]
        end = next((i for i, field in enumerate(rest) if isinstance(field, str)), len(rest))
        starts = [i for i, field in enumerate(rest[:end]) if isinstance(field, float)]  # weights have a decimal point
        weights = dict[int, float]()
        for start, stop in pairwise([*starts, end]):
            weight, ways, *nodes = rest[start:stop]
            if ways not in (123, 123456) or held not in (123, 123456):
                raise refused(name, f"holds the components {held} by the components {ways}")
            weights |= dict.fromkeys(nodes, weight)
        self.mean[name] = int(row[2]), weights

    def _conm2(self, name: str, row: list[Any]) -> None:
        if row[2] not in ("", 0):
            raise refused(name, f"is in coordinate system {row[2]}", "export it in the basic system")
        xx, xy, yy, xz, yz, zz = _numbers(row[8:14])
        # The card has the products of inertia, of which the tensor has the opposite.
        tensor = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
        self.lumps.append(Lump(name, int(row[1]), float(row[3] or 0.0), _numbers(row[4:7]), tensor))

    def _celas1(self, name: str, row: list[Any]) -> None:
        if row[1] not in self._scalar:
            raise refused(name, f"names PELAS {row[1]}, which is not there", "export it too")
        self._celas2(name, [row[0], self._scalar[row[1]], *row[2:]])

    def _celas2(self, name: str, row: list[Any]) -> None:
        ends = [(int(row[i]), int(row[i + 1])) for i in (2, 4) if row[i] not in ("", 0)]
        if len({way for _, way in ends}) != 1 or not 1 <= ends[0][1] <= 6:
            raise refused(name, "joins unlike components")
        self._spring(name, [node for node, _ in ends], float(row[1]) * np.eye(6)[ends[0][1] - 1])

    def _cbush(self, name: str, row: list[Any]) -> None:
        if row[7] != 0:
            raise refused(name, "has axes of its own", "give it CID 0, the basic system")
        if row[1] not in self._bush:
            raise refused(name, f"names PBUSH {row[1]}, whose K is not there", "export it too")
        self._spring(name, [int(field) for field in row[2:4] if field not in ("", 0)], self._bush[row[1]])

    def _spring(self, name: str, nodes: list[int], stiffness: Floats) -> None:
        if self._turned.intersection(nodes):
            raise refused(name, "acts along axes of a coordinate system", "export its nodes in the basic system")
        self.springs.append(Spring(name, tuple(nodes), stiffness))


def _value(entry: str) -> Any:
    """Value of a field of Nastran, an int, a float or a text."""
    for read in (int, real):
        try:
            return read(entry) if entry else ""
        except ValueError:
            continue
    return entry


def _numbers(values: list[Any]) -> Floats:
    return np.array([value if value != "" else 0.0 for value in values], dtype=float)


def _joined(rigid: Mapping[str, tuple[int, ...]]) -> dict[str, tuple[int, ...]]:
    """Join rigid links that share a node into one, which has the name of the first."""
    groups = dict[str, tuple[int, ...]]()
    for name, nodes in rigid.items():
        sharing = [other for other, members in groups.items() if set(nodes) & set(members)]
        before = [number for other in sharing for number in groups.pop(other)]
        groups[sharing[0] if sharing else name] = tuple(dict.fromkeys([*before, *nodes]))
    return groups


class _Abaqus(_Reader):
    """Keywords of Abaqus and CalculiX, each by the method of its name."""

    known = ("MASS", "ROTARY INERTIA", "SPRING", "RIGID BODY", "COUPLING", "KINEMATIC", "DISTRIBUTING",
             "DISTRIBUTING COUPLING")  # fmt: skip

    def read(self) -> None:
        """Read each statement by its method, with the nodes of the elements in its set."""
        self._coupled = dict[str, str]()
        for word, options, rows in self.mesh.statements:
            if word not in self.words:
                continue
            name = f"*{word} {options.get('ELSET', options.get('NSET', ''))}".strip()
            group = [[options["ELSET"]]] if "ELSET" in options else []
            elements = [self.mesh.elements[number][1] for number in members(group, self.mesh.groups)]
            read = getattr(self, f"_{word.lower().replace(' ', '_')}")
            read(name, options, rows, elements)

    def _mass(self, name: str, _: Options, rows: Rows, elements: Nodes) -> None:
        self.lumps += [Lump(name, nodes[0], float(rows[0][0]), np.zeros(3), np.zeros((3, 3))) for nodes in elements]

    def _rotary_inertia(self, name: str, options: Options, rows: Rows, elements: Nodes) -> None:
        moments = [float(cell or 0) for cell in rows[0]]
        if any(moments[3:]) or "ORIENTATION" in options:
            raise refused(name, "has products of inertia, or axes of its own")
        self.lumps += [Lump(name, nodes[0], 0.0, np.zeros(3), np.diag(moments[:3])) for nodes in elements]

    def _spring(self, name: str, options: Options, rows: Rows, elements: Nodes) -> None:
        """Add the spring of each element, between its two nodes or from its node to the base, along one component."""
        counts = {len(nodes) for nodes in elements}  # of nodes: two between nodes, one to the base
        ways = {int(float(cell or 0)) for cell in rows[0][: max(counts, default=1)]}
        axial = not ways <= {*range(1, 7)}
        if len(ways) != 1 or len(counts) > 1 or axial or {"ORIENTATION", "NONLINEAR"} & {*options}:
            raise refused(name, "joins unlike components, is not linear, or has axes of its own")
        stiffness = float(rows[1][0]) * np.eye(6)[min(ways) - 1]
        self.springs += [Spring(name, nodes, stiffness) for nodes in elements]

    def _rigid_body(self, name: str, options: Options, *_: Any) -> None:
        group = alike(self.mesh.sets, options.get("NSET", ""))
        if group not in self.mesh.sets:
            raise refused(name, "has no set of nodes", "name them by NSET")
        ends = [int(options[key]) for key in ("REF NODE", "ROT NODE") if key in options]
        self.rigid[f"{name} of node {ends[0] if ends else ''}".strip()] = (*ends, *self.mesh.sets[group])

    def _coupling(self, _: str, options: Options, *__: Any) -> None:
        self._coupled = dict(options)

    def _surface(self) -> tuple[str, int, dict[int, float]]:
        """Name, node and weights of the nodes of the coupling that a statement belongs to."""
        weights = _surface(self.mesh, self._coupled.get("SURFACE", ""))
        return f"*COUPLING {self._coupled.get('CONSTRAINT NAME', '')}".strip(), int(self._coupled["REF NODE"]), weights

    def _kinematic(self, _: str, __: Options, rows: Rows, ___: Nodes) -> None:
        """Add a kinematic coupling: a rigid link of the nodes of a surface to the reference node."""
        name, node, weights = self._surface()
        components = set[int]()
        for row in rows:  # first and last component, or one alone
            span = [int(cell) for cell in row if cell]
            if span:
                components |= {*range(span[0], span[min(1, len(span) - 1)] + 1)}
        if components and not components >= {1, 2, 3}:
            raise refused(name, f"holds the components {', '.join(map(str, sorted(components)))} alone")
        self.rigid[name] = node, *sorted({*weights} - {node})

    def _distributing(self, *_: Any) -> None:
        name, node, weights = self._surface()
        self.mean[name] = node, weights

    def _distributing_coupling(self, name: str, _: Options, rows: Rows, elements: Nodes) -> None:
        pairs = ((number, row[1]) for row in rows for number in members([row[:1]], self.mesh.sets))
        self.mean[name] = elements[0][0], {number: float(weight) for number, weight in pairs}


def _surface(mesh: TextMesh, name: str) -> dict[int, float]:
    """Weights of a surface's nodes: 1 for those that are listed, for those of elements' faces shares of the area."""
    surfaces = [statement for statement in mesh.statements if statement.word == "SURFACE"]
    named = [surface for surface in surfaces if surface.options.get("NAME", "").upper() == name.upper()]
    if not named:
        raise refused(f"a coupling of surface {name!r}", "is not there", "export it too")
    _, options, rows = named[0]
    if options.get("TYPE", "").upper() == "NODE":
        return dict.fromkeys(members(rows, mesh.sets), 1.0)
    weights = dict[int, float]()
    for part, *face in rows:
        for number in members([[part]], mesh.groups):
            kind, nodes = mesh.elements[number]
            if DIMENSIONS[kind] == 3:
                nodes = tuple(nodes[i] for i in face_nodes(kind, int(face[0][1:]) - 1)[:8])
            elif face and face[0].upper() not in ("SPOS", "SNEG", "S1", "S2"):
                raise refused(f"surface {name!r}", f"has the edge {face[0]} of a shell", "give its nodes")
            areas = shared_area(SHAPES[2][len(nodes)], np.array([mesh.nodes[node] for node in nodes]))
            for node, area in zip(nodes, areas, strict=True):
                weights[node] = weights.get(node, 0.0) + area
    return weights
