"""Elements and groups of a mesh as of meshio, with the units and numbers of its file."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.guards.units import UnitError, quantity
from gbeam.printable import shortened
from gbeam.solids.exodus import ENDINGS as EXODUS
from gbeam.solids.shape_functions import KINDS
from gbeam.solids.texts import AGAIN

_INTERNAL = "gmsh:"  # begins the names of sets that nobody gave
_ENTITIES = "gmsh:geometrical"
# Ends of the names of files that hold meshes, also of surfaces and of geometry, of which the reader says what lacks.
MESHES = {
    *EXODUS, ".avs", ".bdf", ".fem", ".inp", ".mdpa", ".med", ".mesh", ".meshb", ".msh", ".nas", ".su2", ".ugrid",
    ".vtk", ".vtu", ".xdmf", ".xmf", ".cgns", ".iges", ".igs", ".obj", ".ply", ".step", ".stl", ".stp",
}  # fmt: skip
THICKNESS = ("PSHELL", "SHELL SECTION")
_OF_DIM = {0: "point", 1: "line", 2: "surface", 3: "volume"}  # Gmsh's words for groups of these dimensions
_BARE = re.compile(r"-?\d+")  # a group without a name
_NUMBER = re.compile(rf"(?:({'|'.join(_OF_DIM.values())}) )?({_BARE.pattern})")  # or its kind and number


def unit_size(where: str, unit: str, kind: str) -> float:
    """Return the size of a unit, m or kg."""
    try:
        return quantity(f"1 {unit}", kind)
    except UnitError as error:
        fix = error.hint or f'give one such as "{"mm" if kind == "length" else "Mg"}"'
        raise InputError(where, f"is {unit!r}: {error.problem}", fix) from None


def ignored_statements(source: Any, mesh: Any, read: Collection[str] = ()) -> list[str]:
    """Warn of a file's statements on masses, stiffness and constraints, but for those with names in `read`."""
    counts = {name: count for name, count in getattr(mesh, "carrying", {}).items() if name not in read}
    if not counts:
        return []
    listed = ", ".join(f"{name} ({count})" for name, count in counts.items())
    return [f"the mesh: {listed} in {Path(source).name} are not read: their masses, stiffness and constraints lack"]


class Elements(NamedTuple):
    """Elements of one block of a mesh: the index of the block, their indices in it, their kind, their nodes (e, k) and,
    for shells, their thicknesses (e,), m.
    """

    block: int
    which: Indices
    kind: str
    nodes: Indices
    thickness: Floats | None


def elements_of(mesh: Any, thickness: float | Mapping[str, float] | None) -> list[Elements]:
    """Elements that are computed: solids, and surfaces with a thickness. InputError where there are none, or some of a
    kind that is not computed.
    """
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
        values = [positive(f"thickness.{name}".rstrip("."), value, "m") for name, value in named.items()]
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
            known = ", ".join(name for name in KINDS if (KINDS[name].shell > 0) == (thick is not None))
            raise InputError("mesh", f"has {counts[kind]} elements of kind {kind}", f"use {known}")
        elements.append(Elements(i, which, kind, nodes, thick))
    return elements


def numbers_of(mesh: Any) -> list[Indices]:
    """Numbers of the elements of each block: those of a text file, or counted from 1."""
    ends = np.cumsum([len(block.data) for block in mesh.cells])
    counted = [np.arange(end - len(block.data), end) + 1 for end, block in zip(ends, mesh.cells, strict=True)]
    return [getattr(block, "numbers", default) for block, default in zip(mesh.cells, counted, strict=True)]


def node_numbers_of(mesh: Any) -> Indices:
    """Numbers of the nodes: those of a text file, or counted from 1."""
    return np.asarray(getattr(mesh, "numbers", range(1, len(mesh.points) + 1)))


def refuse_missing(mesh: Any, elements: Iterable[Elements]) -> None:
    """Refuse elements on nodes that are not in the mesh."""
    numbers = numbers_of(mesh)
    for part in elements:
        for i, k in np.argwhere((part.nodes < 0) | (part.nodes >= len(mesh.points)))[:1]:
            element, node = numbers[part.block][part.which[i]], part.nodes[i, k] + 1
            raise InputError("mesh", f"has element {element} on node {node} of {len(mesh.points)}", AGAIN)


def assigned(mesh: Any, where: str, values: Any, blocks: Iterable[int]) -> dict[int, Indices]:
    """Assign the `values` of groups to elements. The result has, by block, the index (e,) of each element's value.

    It is -1 for an element in none of the groups, and 0 for all if `values` is a single value.
    """
    owner = {i: np.full(len(mesh.cells[i].data), -1 if isinstance(values, Mapping) else 0) for i in blocks}
    if not isinstance(values, Mapping):
        return owner
    dims = {mesh.cells[i].dim for i in owner}
    for number, name in enumerate(values):
        chosen = elements_in(mesh, f"{where}.{name}", name, dims)
        if chosen is None:
            raise no_group(mesh, f"{where}.{name}", name)
        for i, index in owner.items():
            taken = index[chosen[i]]
            if (taken >= 0).any():
                both = f"{list(values)[taken.max()]!r} and {name!r}"
                verb = "gives" if where == "thickness" else "give"
                raise InputError(where, f"{verb} {(taken >= 0).sum()} elements two: {both}", "give each one")
            index[chosen[i]] = number
    return owner


def group_names(mesh: Any) -> list[str]:
    """Names of all groups of nodes and elements. Groups without a name are their numbers, with the kind where several
    kinds have one.
    """
    tags = {tag for values in _tags(mesh) for block in values for tag in np.unique(block).tolist()}
    named = [*mesh.point_sets, *mesh.cell_sets, *mesh.field_data]
    names = list[str]()
    for name in dict.fromkeys([*named, *map(str, sorted(tags))]):
        dims = _dims(mesh, _numbered(mesh, name)) if _BARE.fullmatch(name) and name not in mesh.field_data else []
        names += [f"{_OF_DIM[dim]} {name}" for dim in dims] if len(dims) > 1 else [name]
    return [name for name in names if not name.startswith(_INTERNAL)]


def elements_in(mesh: Any, where: str, name: str, dims: Collection[int] = tuple(_OF_DIM)) -> list[Indices] | None:
    """Elements of a group in each block of the mesh, or None where no elements have this group.

    A group without a name is its number, such as "3", or its kind and number, such as "surface 3". A number that both
    surfaces and volumes have, among those in `dims`, is refused by an InputError about what `where` names.
    """
    if name in mesh.cell_sets and not _BARE.fullmatch(name):
        return _set(mesh, name)
    if name in mesh.field_data:
        number, *dims = map(int, mesh.field_data[name])
    elif match := _NUMBER.fullmatch(name):
        number = int(match[2])
        dims = [dim for dim, noun in _OF_DIM.items() if noun == match[1]] if match[1] else dims
    else:
        return None
    chosen = _numbered(mesh, str(number))
    present = [dim for dim in _dims(mesh, chosen) if dim in dims]
    if len(present) > 1:
        nouns = [_OF_DIM[dim] for dim in present]
        problem = f"is {name!r}, which is {' and '.join(f'a {noun}' for noun in nouns)} of the mesh"
        raise InputError(where, problem, f'write "{nouns[0]} {number}" or "{nouns[-1]} {number}", or name them')
    if chosen is None or not present:
        return None
    return [members if block.dim in present else members[:0] for members, block in zip(chosen, mesh.cells, strict=True)]


def _set(mesh: Any, name: str) -> list[Indices]:
    """Elements of each block in a set of the mesh."""
    return [np.asarray([] if members is None else members, dtype=int) for members in mesh.cell_sets[name]]


def _numbered(mesh: Any, number: str) -> list[Indices] | None:
    """Elements of each block in a group with this number, or None if there is no such group."""
    if number in mesh.cell_sets:
        return _set(mesh, number)
    for values in _tags(mesh):
        chosen = [np.flatnonzero(np.equal(tags, int(number))) for tags in values]
        if any(map(len, chosen)):
            return chosen
    return None


def _dims(mesh: Any, chosen: list[Indices] | None) -> list[int]:
    """Dimensions of the elements of a group, in ascending order."""
    pairs = zip(chosen or (), mesh.cells, strict=chosen is not None)
    return sorted({block.dim for members, block in pairs if len(members)})


def nodes_in(mesh: Any, where: str, name: str) -> Indices:
    """Nodes of a group of nodes or of elements. InputError if there is no such group."""
    if name in mesh.point_sets:
        return np.unique(np.asarray(mesh.point_sets[name], dtype=int))
    elements = elements_in(mesh, where, name)
    if elements is None:
        raise no_group(mesh, where, name)
    parts = [block.data[chosen].ravel() for block, chosen in zip(mesh.cells, elements, strict=True)]
    return np.unique(np.concatenate(parts))


def no_group(mesh: Any, where: str, name: str) -> InputError:
    """Error that a group is not in the mesh. It lists the groups that are, and their places where these are known."""
    if mesh.info:
        listed = shortened("; ".join(f"{group}, {place}" for group, place in mesh.info.items()), 2000)
    else:
        listed = shortened(", ".join(group_names(mesh)), 200)
    fix = f"choose from {listed}" if listed else "the mesh has no groups: name some in it"
    return InputError(where, f"is {name!r}, which is no group of the mesh", fix)


def tags_of(mesh: Any) -> dict[str, list[Any]]:
    """Whole numbers of the elements, such as physical groups or properties, by name and block by block."""

    def whole(tags: Any) -> bool:
        return np.asarray(tags).ndim == 1 and np.asarray(tags).dtype.kind in "iu"

    data = {name: values for name, values in mesh.cell_data.items() if name != _ENTITIES}
    return {name: values for name, values in data.items() if all(map(whole, values))}


def _tags(mesh: Any) -> list[list[Any]]:
    return [*tags_of(mesh).values()]


def is_mesh(name: str) -> bool:
    """True if a file holds a mesh, by the end of its name."""
    return Path(name).suffix.lower() in MESHES
