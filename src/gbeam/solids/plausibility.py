"""Elements and clamps that cannot be computed, and what is implausible in a mesh or known to be inaccurate."""

from __future__ import annotations

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.limits import BOUNDLESS
from gbeam.solids.elements import determinants
from gbeam.solids.geometry import Mesh
from gbeam.solids.held import HeldPlace, about, levers, refuse_free
from gbeam.solids.shape_functions import KINDS
from gbeam.solids.stress import corners_of, outer_triangles
from gbeam.structure.supports import DIRECTIONS

FLAT = 1e-6  # of the largest volume of a part of it: an element with less anywhere is folded
STRAIGHT = 1e-6  # of the size: points that are nearer to a line do not hold a body
LARGE, HEAVY = 20.0, 1e4  # m and kg: nobody mounts more on a machine
SMALL = 1e-3  # m
SLIVERS = 0.01  # of all elements: a few long ones of a mesher lock nothing
APART = 1e-6  # of the size: nodes that are nearer are at one place
PART = 0.1  # of the linear elements: fewer that fill a thickness are at edges


def refuse_far(where: str, places: Floats, unit: float = 1.0) -> None:
    """Refuse nodes, at places (k, 3) in a `unit`, m, that are farther away than the limit of any place."""
    farthest = float(np.abs(places).max(initial=0.0))
    if farthest > BOUNDLESS / unit:
        raise InputError(where, f"has a node at {farthest:.4g} in a unit of {unit:g} m", "write it again")


def refuse_folded(mesh: Mesh) -> None:
    """Refuse elements that are turned inside out or folded."""
    bad: list[int] = []
    for block in mesh.blocks:
        volumes = determinants(mesh.points, block)
        bad += block.numbers[~(volumes.min(axis=1) > FLAT * np.abs(volumes).max(axis=1))].tolist()
    if bad:
        listed = ", ".join(map(str, bad[:3])) + (", ..." if len(bad) > 3 else "")
        count = "1 element" if len(bad) == 1 else f"{len(bad)} elements"
        fix = "mesh it again, or number their nodes the other way round"
        raise InputError("mesh", f"has {count} turned inside out or folded: {listed}", fix)


def refuse_twice(mesh: Mesh) -> None:
    """Refuse elements on the corners of other elements, which would count twice."""
    by_corners: dict[bytes, int] = {}
    pairs = list[tuple[int, int]]()
    for block in mesh.blocks:
        corners = np.sort(block.nodes[:, : corners_of(block.kind)], axis=1)
        for number, nodes in zip(block.numbers.tolist(), corners, strict=True):
            key = nodes.tobytes()
            if key in by_corners:
                pairs.append((number, by_corners[key]))
            by_corners.setdefault(key, number)
    if pairs:
        listed = ", ".join(f"{number} on those of {first}" for number, first in pairs[:3])
        listed += ", ..." if len(pairs) > 3 else ""
        count = "1 element" if len(pairs) == 1 else f"{len(pairs):,} elements"
        raise InputError("mesh", f"has {count} on the nodes of others: {listed}", "delete one of each pair")


def refuse_loose(mesh: Mesh) -> None:
    """Refuse a part of the mesh that neither the clamp nor supports hold."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if mesh.clamped.all():
        raise InputError("clamp", f"holds all {len(mesh.points)} nodes", "name the surface that is screwed on")
    pairs = [(np.repeat(b.nodes[:, 0], b.nodes.shape[1]), b.nodes.ravel()) for b in mesh.blocks]
    _, first, node = np.unique(mesh.numbers, return_index=True, return_inverse=True)
    pairs += [(first[node], np.arange(len(node)))]  # of shells the points that stand for a node
    pairs += [(np.full(len(nodes), nodes[0]), nodes) for nodes in mesh.links.joined]
    rows, columns = (np.concatenate(indices) for indices in zip(*pairs, strict=True))
    graph = coo_array((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(len(mesh.points),) * 2)
    count, part = connected_components(graph, directed=False)
    for i in range(count):
        nodes = part == i
        if any(nodes[sprung].any() for sprung in mesh.links.base_nodes):
            continue  # the factorisation says whether the springs hold it
        held = mesh.points[nodes & mesh.clamped]
        size = np.linalg.svd(held - held.mean(axis=0), compute_uv=False) if len(held) > 2 else np.zeros(3)
        if size[1] > STRAIGHT * np.linalg.norm(np.ptp(mesh.points[nodes], axis=0)):
            continue
        if supports := [place for place in mesh.supports if nodes[place.points].any()]:
            moved = [motion for place in supports for motion in _held_motions(mesh, place)]
            refuse_free("supports", np.concatenate([*moved, *_clamped_motions(held)]), mesh.points[nodes])
            continue
        middle = ", ".join(f"{x:.3g}" for x in mesh.points[nodes].mean(axis=0))
        where = "the mesh" if count == 1 else f"a part of {nodes.sum()} nodes about ({middle}) m"
        fix = "clamp three nodes or more that lie on no line" + ("" if count == 1 else ", or merge coincident nodes")
        raise InputError("clamp", f"holds {where} at {len(held)} nodes, so that it moves without strain", fix)


def _held_motions(mesh: Mesh, place: HeldPlace) -> list[Floats]:
    """Rigid motions (g, 6) about the origin, each along the directions that a support holds."""
    elastic = *place.support.rigid, *place.support.stiffness
    return [place.levers(mesh.points, way) @ about(place.centre) for way in elastic]


def _clamped_motions(points: Floats) -> list[Floats]:
    """Rigid motions (g, 6) about the origin at clamped points (g, 3), along x, y and z."""
    return [levers(points, way) for way in DIRECTIONS[:3]] if len(points) else []


def doubts_of(mesh: Mesh, unit: str) -> list[str]:
    """Warn of what is implausible in a mesh, or known to be inaccurate."""
    size, mass = float(np.linalg.norm(np.ptp(mesh.points, axis=0))), mesh.mass
    doubts = []
    if size > LARGE or mass > HEAVY or size < SMALL:
        other = "mm" if size > LARGE or mass > HEAVY else "m"
        other = other if other != unit else "another one"
        doubts.append(f"the mesh is {size:.3g} m across and weighs {mass:.3g} kg with unit = {unit!r}; is it {other}?")
    pairs = np.unique(np.sort(mesh.numbers[_unmerged(mesh, APART * size)]), axis=0)
    if len(pairs):
        first, second = pairs[0]
        doubts.append(
            f"{len(pairs):,} pairs of nodes lie at one place and are not merged, such as {first} and {second}: "
            "the mesh does not hold together there; merge them, if it should"
        )
    return doubts + locking(mesh)


def locking(mesh: Mesh) -> list[str]:
    """Warn of elements that are too stiff by more than meshes of them differ from one another."""
    doubts, slenderness = list[str](), _slenderness(mesh)
    linear = [ratios for block, ratios in zip(mesh.blocks, slenderness, strict=True) if KINDS[block.kind].linear]
    if linear:
        ratios = np.concatenate(linear)
        thin = ratios[np.isfinite(ratios)]
        doubt = f"{len(ratios)} linear elements bend too stiffly (shear locking): use quadratic ones"
        if len(thin) > PART * len(ratios):
            # Bent, a bilinear element of sides a and b stores (1/(1 − ν) + (a/b)²/2)/(1 + ν) times the energy.
            times = np.sqrt(1 + 0.385 * np.median(thin) ** 2)
            doubt += f"; {len(thin)} fill a thickness alone, whose frequencies of bending are about {times:.2g} times"
            doubt += " those of the solid"
        doubts.append(doubt)
    flat = sum(len(block.nodes) for block in mesh.blocks if block.kind == "triangle")
    if flat and np.unique(mesh.numbers, return_counts=True)[1].max() > 2:
        doubts.append(
            f"{flat} triangles of three nodes are too stiff in their own plane, where folded shells bend: use "
            "quadrilaterals, or triangles of six nodes"
        )
    locking = [
        ratios[np.isfinite(ratios) & (ratios > KINDS[block.kind].long)]
        for block, ratios in zip(mesh.blocks, slenderness, strict=True)
    ]
    long = np.concatenate(locking)
    if len(long) > SLIVERS * sum(map(len, slenderness)):
        doubts.append(
            f"{len(long)} elements fill a thickness alone and are up to {long.max():.2g} times as long as it: they may "
            "lock in bending; make them shorter, or use hexahedra of 27 nodes"
        )
    return doubts


def _unmerged(mesh: Mesh, distance: float) -> Indices:
    """Pairs (p, 2) of points within `distance` of each other that belong to different nodes. They share no element and
    are not both in rigid links.
    """
    from scipy.sparse import coo_array
    from scipy.spatial import KDTree

    pairs = KDTree(mesh.points).query_pairs(distance, output_type="ndarray")
    linked = np.isin(pairs, np.concatenate([[-1], *mesh.links.joined])).all(axis=1)
    pairs = pairs[(mesh.numbers[pairs[:, 0]] != mesh.numbers[pairs[:, 1]]) & ~linked]
    for block in mesh.blocks:
        count, corners = block.nodes.shape
        owned = (block.nodes.ravel(), np.repeat(np.arange(count), corners))
        elements_of = coo_array((np.ones(count * corners), owned), shape=(len(mesh.points), count)).tocsr()
        shared = elements_of[pairs[:, 0]].multiply(elements_of[pairs[:, 1]]).sum(axis=1)
        pairs = pairs[shared == 0]
    return pairs


def _slenderness(mesh: Mesh) -> list[Floats]:
    """Ratios (e,) of length to thickness of the elements of each block, along principal axes of their corners.

    They are NaN for an element with a corner inside the solid, which does not fill the solid's thickness alone.
    """
    outside = np.zeros(len(mesh.points), dtype=bool)
    outside[outer_triangles(mesh)] = True
    ratios = []
    for block in mesh.blocks:
        corners = block.nodes[:, : corners_of(block.kind)]
        size = np.linalg.svd(mesh.points[corners] - mesh.points[corners].mean(axis=1, keepdims=True), compute_uv=False)
        ratios.append(np.where(outside[corners].all(axis=1), size[:, 0] / size[:, 2], np.nan))
    return ratios
