"""Meshes in the files of other programs, and the groups in them, by meshio."""

from __future__ import annotations

import contextlib
import io
import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.guards.limits import BINARY_BYTES, refuse_large_file
from gbeam.guards.units import UnitError, quantity
from gbeam.printable import shortened
from gbeam.results.result import Floats
from gbeam.solids.shape_functions import KINDS, Indices
from gbeam.solids.texts import ABAQUS, NASTRAN, ending_of, missing_node

_INTERNAL = "gmsh:"  # begins the names of sets that nobody gave
_ENTITIES = "gmsh:geometrical"
# What meshio passes over, by the ending of the file, with the words that carry mass, stiffness or constraints.
_NASTRAN = re.compile(
    r"^(CONM[12]|CMASS[1-4]|NSM\w*|CELAS[1-4]|CBUSH\w*|RBE[123]|RBAR|RROD|RSPLINE|MPC|CBAR|CBEAM|CBEND|CROD|CONROD|CTUBE"
    r"|CWELD|CFAST|CGAP|PSHELL|PCOMP\w?)\b",
    re.MULTILINE,
)
_ABAQUS = re.compile(
    r"^\* *(MASS|ROTARY INERTIA|NONSTRUCTURAL MASS|SPRING|CONNECTOR SECTION|RIGID BODY|(?:\w+ +)?COUPLING"
    r"|KINEMATIC|DISTRIBUTING|TIE|EQUATION|MPC|CONTACT PAIR|GAP|(?:BEAM|SHELL)(?: GENERAL)? SECTION"
    r"|SOLID SECTION[^\n]*COMPOSITE|TRANSFORM) *(?:,|$)",
    re.MULTILINE | re.IGNORECASE,
)
_POINTWISE = re.compile(
    r"^\*ELEMENT *,(?=[^\n]*TYPE *= *(?:MASS|ROTARYI|SPRING[12A]|DCOUP3D)\b)[^\n]*\n(?:(?!\*)[^\n]*(?:\n|$))*",
    re.M | re.I,
)
_LISTS = re.compile(r"^\*NODE *(?:,[^\n]*)?\n((?:(?!\*)[^\n]*(?:\n|$))*)", re.MULTILINE | re.IGNORECASE)
_SCALAR = re.compile(r"^CELAS[1-4]\b[^\n]*\n(?:\*[^\n]*\n)*", re.MULTILINE)
AGAIN = "write it again with all of its nodes"
THICKNESS = ("PSHELL", "SHELL SECTION")
_UNREAD = dict.fromkeys(NASTRAN, _SCALAR) | dict.fromkeys(ABAQUS, _POINTWISE)  # elements that stop meshio
_WORDS = dict.fromkeys(NASTRAN, _NASTRAN) | dict.fromkeys(ABAQUS, _ABAQUS)


def import_meshio() -> Any:
    """Import meshio; an InputError says how to install it where it is not."""
    try:
        import meshio
    except ModuleNotFoundError:
        raise InputError("", "meshio is not installed", 'install it with: pip install "gbeam[mesh]"') from None
    # Version 5.3.5 reads wedges of 15 nodes, and fails on them where it looks up how many dimensions they have.
    meshio._mesh.topological_dimension.setdefault("wedge15", 3)
    return meshio


def read_mesh(source: str | os.PathLike[str] | Any) -> Any:
    """Return meshio's mesh in a file, or the mesh itself."""
    if not isinstance(source, (str, os.PathLike)):
        return source
    meshio = import_meshio()
    refuse_large_file("mesh", source, BINARY_BYTES, "mesh it more coarsely")
    said = io.StringIO()
    try:
        # It prints what fails and exits.
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            unread = _UNREAD.get(ending_of(source))
            text = _text(source) if unread else ""
            plain = _one_list(unread.sub("", text)) if unread else ""
            if plain == text:
                return meshio.read(source)
            reader = meshio.abaqus if ending_of(source) in ABAQUS else meshio.nastran
            return reader.read(io.StringIO(plain))
    except (Exception, SystemExit) as error:
        if missing := missing_node(source):
            raise InputError("mesh", missing, AGAIN) from None
        words = shortened(" ".join((said.getvalue() or str(error)).split()), 200)
        if isinstance(error, KeyError):  # meshio looks up by its number what a set or an element names
            words = f"number {error.args[0]} is named in it, and is not there"
        fix = "give a file of Gmsh, Nastran, Abaqus, CalculiX or VTK, with its ending"
        raise InputError("mesh", f"{os.fspath(source)} cannot be read: {words}", fix) from None


def _one_list(text: str) -> str:
    """A file of Abaqus with its nodes in one list, of which meshio takes the last one only."""
    lists = list(_LISTS.finditer(text))
    if len(lists) < 2:
        return text
    start = lists[0].start()
    nodes = "".join(each[1] for each in lists)
    return f"{text[:start]}*NODE\n{nodes}{_LISTS.sub('', text[start:])}"


def unit_size(where: str, unit: str, kind: str) -> float:
    """Return the size of a unit, m or kg."""
    try:
        return quantity(f"1 {unit}", kind)
    except UnitError as error:
        fix = error.hint or f'give one such as "{"mm" if kind == "length" else "Mg"}"'
        raise InputError(where, f"is {unit!r}: {error.problem}", fix) from None


def refuse_systems(source: Any) -> None:
    """Refuse a file of Nastran with places in coordinate systems, which meshio takes for the basic one."""
    if ending_of(source) not in NASTRAN:
        return
    for line in _text(source).splitlines():
        if not line.startswith("GRID"):
            continue
        system = line.split(",")[2] if "," in line else line[24:40] if line[4] == "*" else line[16:24]
        if system.strip() not in ("", "0"):
            problem = f"{os.fspath(source)} has nodes in coordinate system {system.strip()}, which is not read"
            raise InputError("mesh", problem, "export them in the basic system")


def left_out(source: Any, read: Collection[str] = ()) -> list[str]:
    """Warnings of what a file says of masses, stiffness and constraints and that is not read."""
    words = _WORDS.get(ending_of(source))
    if words is None:
        return []
    counts = Counter(" ".join(each[1].upper().split()) for each in words.finditer(_text(source)))
    counts = Counter({name: count for name, count in counts.items() if name not in read})
    if not counts:
        return []
    listed = ", ".join(f"{name} ({count})" for name, count in counts.items())
    return [f"the mesh: {listed} in {Path(source).name} are not read: their masses, stiffness and constraints lack"]


def _text(source: Any) -> str:
    return Path(source).read_text(encoding="utf-8", errors="replace")


class Elements(NamedTuple):
    """Elements of one block of a mesh: the number of the block, which of it, their kind, their nodes (e, k), and, of
    shells, their thicknesses (e,), m.
    """

    block: int
    which: Indices
    kind: str
    nodes: Indices
    thickness: Floats | None


def elements_of(mesh: Any, thickness: float | Mapping[str, float] | None) -> list[Elements]:
    """Elements that are computed, solids and surfaces with a thickness; InputError where there are none or others."""
    counts: Counter[str] = Counter()
    for block in mesh.cells:
        counts[block.type] += len(block.data)
    listed = ", ".join(f"{n} of kind {kind}" for kind, n in counts.items() if n) or "none at all"
    dims = [block.dim if len(block.data) else 0 for block in mesh.cells]
    if 3 not in dims and (thickness is None or 2 not in dims):
        fix = "give thickness, for shells, or mesh the volume" if 2 in dims else "mesh the volume, not its surface"
        raise InputError("mesh", f"has no solid elements: {listed}", fix)
    if 3 in dims and thickness is not None and not isinstance(thickness, Mapping):
        fix = 'give it by group, such as { board = "1.6 mm" }: other surfaces only name groups'
        raise InputError("thickness", "is one, in a mesh that has solid elements too", fix)
    flat = [i for i, dim in enumerate(dims) if dim == 2]
    chosen: list[tuple[int, Indices, Floats | None]] = []
    for i, owner in assigned(mesh, "thickness", thickness, flat).items() if thickness is not None else ():
        named = thickness if isinstance(thickness, Mapping) else {"": thickness}
        values = [positive(f"thickness.{name}".rstrip("."), each, "m") for name, each in named.items()]
        which = np.flatnonzero(owner >= 0)
        if len(which) < len(owner) and 3 not in dims:
            fix = "name the groups of all elements"
            raise InputError("thickness", f"gives {len(owner) - len(which)} elements none", fix)
        if len(which):
            chosen.append((i, which, np.array(values, dtype=float)[owner[which]]))
    chosen += [(i, np.arange(len(mesh.cells[i].data)), None) for i, dim in enumerate(dims) if dim == 3]
    elements = []
    for i, which, thick in chosen:
        kind, nodes = mesh.cells[i].type, np.asarray(mesh.cells[i].data)[which]
        if kind == "quad9":  # whose middle is left out
            kind, nodes = "quad8", nodes[:, :8]
        if kind not in KINDS:
            known = ", ".join(each for each in KINDS if (KINDS[each].shell > 0) == (thick is not None))
            raise InputError("mesh", f"has {counts[kind]} elements of kind {kind}", f"use {known}")
        elements.append(Elements(i, which, kind, nodes, thick))
    return elements


def refuse_missing(source: Any, mesh: Any, elements: Iterable[Elements]) -> None:
    """Refuse elements on nodes that are not in the mesh."""
    first = np.cumsum([0, *(len(block.data) for block in mesh.cells)])
    for each in elements:
        lacking = np.argwhere((each.nodes < 0) | (each.nodes >= len(mesh.points)))
        for i, k in lacking[:1]:
            number, node = first[each.block] + each.which[i] + 1, each.nodes[i, k] + 1
            words = f"has element {number} on node {node} of {len(mesh.points)}"
            raise InputError("mesh", missing_node(source) or words, AGAIN)


def assigned(mesh: Any, where: str, values: Any, blocks: Iterable[int]) -> dict[int, Indices]:
    """Number of the one of some values by group, or of a single one, that each element has, -1 where none."""
    owner = {i: np.full(len(mesh.cells[i].data), -1 if isinstance(values, Mapping) else 0) for i in blocks}
    if not isinstance(values, Mapping):
        return owner
    for number, name in enumerate(values):
        chosen = elements_in(mesh, name)
        if chosen is None:
            raise no_group(mesh, f"{where}.{name}", name)
        for i, each in owner.items():
            taken = each[chosen[i]]
            if (taken >= 0).any():
                both = f"{list(values)[taken.max()]!r} and {name!r}"
                verb = "gives" if where == "thickness" else "give"
                raise InputError(where, f"{verb} {(taken >= 0).sum()} elements two: {both}", "give each one")
            each[chosen[i]] = number
    return owner


def group_names(mesh: Any) -> list[str]:
    """Names of all groups of nodes and elements."""
    names = [*mesh.point_sets, *mesh.cell_sets, *mesh.field_data]
    for values in _tags(mesh):
        names += [str(tag) for tag in sorted({int(tag) for block in values for tag in np.unique(block)})]
    return list(dict.fromkeys(name for name in names if not name.startswith(_INTERNAL)))


def elements_in(mesh: Any, name: str) -> list[Indices] | None:
    """Elements of a group in each block of the mesh; None where it is none of elements."""
    if name in mesh.cell_sets:
        return [np.asarray([] if each is None else each, dtype=int) for each in mesh.cell_sets[name]]
    tag = mesh.field_data.get(name)
    for values in _tags(mesh):
        if tag is None and name.lstrip("-").isdigit():
            chosen = [np.flatnonzero(np.asarray(each) == int(name)) for each in values]
        elif tag is not None:
            chosen = [
                np.flatnonzero((np.asarray(each) == int(tag[0])) & (block.dim == int(tag[1])))
                for each, block in zip(values, mesh.cells, strict=True)
            ]
        else:
            continue
        if any(map(len, chosen)):
            return chosen
    return None


def nodes_in(mesh: Any, where: str, name: str) -> Indices:
    """Nodes of a group, of nodes or of elements; an InputError where there is none."""
    if name in mesh.point_sets:
        return np.unique(np.asarray(mesh.point_sets[name], dtype=int))
    elements = elements_in(mesh, name)
    if elements is None:
        raise no_group(mesh, where, name)
    parts = [block.data[each].ravel() for block, each in zip(mesh.cells, elements, strict=True)]
    return np.unique(np.concatenate(parts))


def no_group(mesh: Any, where: str, name: str) -> InputError:
    """Error of a group that is not in the mesh."""
    names = [f"{each}, {about}" for each, about in (mesh.info or {}).items()] or group_names(mesh)
    listed = shortened("; ".join(names) if mesh.info else ", ".join(names), 2000 if mesh.info else 200)
    known = f"choose from {listed}" if names else "the mesh has no groups: name some in it"
    return InputError(where, f"is {name!r}, which is no group of the mesh", known)


def _tags(mesh: Any) -> list[list[Any]]:
    """Whole numbers of the elements, such as physical groups or properties, block by block."""
    return [
        values
        for name, values in mesh.cell_data.items()
        if name != _ENTITIES
        and all(np.asarray(each).ndim == 1 and np.asarray(each).dtype.kind in "iu" for each in values)
    ]
