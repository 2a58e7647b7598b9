"""Stress of a reduced solid over time, at its nodes: extrapolated in elements, averaged over those of a material."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from typing import Any, Self

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Complex, Flags, Floats, Indices
from gbeam.errors import InputError
from gbeam.numerics.sparse import add_to_rows
from gbeam.results.solids import SolidStress, StressAt, Surface, SurfaceModes, von_mises
from gbeam.solids.elements import TENSOR, chunks
from gbeam.solids.geometry import Mesh
from gbeam.solids.norms import LargestNorms
from gbeam.solids.shape_functions import KINDS, extrapolation, reference

VERTICES, TIMES = 1500, 1000  # of pictures, about
AROUND = np.array([way for way in product((1.0, 0.0, -1.0), repeat=3) if way > (0.0, 0.0, 0.0)])  # half of all ways
HALVES = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])  # of strains with twice the tensor's shear, in the tensor
SETTLED = 1e-9  # of a range of stress
ENOUGH = 1e-3  # of the largest shape: one that is less is not seen
# Corners of the faces of elements, by their number.
FACES = {
    4: ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
    6: ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    8: ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}


@dataclass(frozen=True, eq=False)
class NodalStress(Value):
    """Stresses of a mesh by the first `size` of n coordinates: displacements `every_shape` (k, 3, n) of its nodes and
    stresses `every_table` (p, 6, n) per unit coordinate.

    Its causes are these coordinates and h = 0 or 1 rise of the temperature, K, by whose unit nodes move by `swelling`
    (k, 3, h), while the coordinates are held, and stresses change by `heat` (p, 6, h). A pair is a node and a material
    of its elements; `known` (p,) is its number, material · nodes + node. `felt_at` are the pairs that some coordinate
    stresses most. Once a coarser mesh was `compared`, `singular` (p,) flags those where stress grows without limit as a
    mesh gets finer; where these would be too many, `excess` is the number of their nodes, and none is flagged.
    """

    mesh: Mesh
    every_shape: Floats
    envelope: Floats
    known: Indices
    every_table: Floats
    size: int
    felt_at: Indices
    singular: Flags
    swelling: Floats
    heat: Floats
    compared: bool = False
    excess: int = 0

    @classmethod
    def from_shapes(cls, mesh: Mesh, shapes: Floats, swelling: Floats | None = None) -> Self:
        """Compute the stresses in shapes (k, 3, n) of the nodes, and by heat with a `swelling` (k, 3, h).

        They are extrapolated to the nodes in each element, and averaged over the elements of one material.
        """
        count, names, n = len(mesh.points), _materials(mesh), shapes.shape[-1]
        pairs = [names.index(block.material) * count + np.unique(block.nodes) for block in mesh.blocks]
        known_pairs = np.unique(np.concatenate(pairs))
        no_flags, nothing = np.zeros(len(known_pairs), dtype=bool), np.empty((0, 6, n))
        swelling = np.zeros((count, 3, 0)) if swelling is None else swelling
        empty = cls(
            mesh, shapes, hull(mesh.points), known_pairs, nothing, n, known_pairs[:0], no_flags, swelling, nothing
        )
        causes = n + swelling.shape[-1]
        total, element_counts = np.zeros((len(known_pairs), 6, causes)), np.zeros(len(known_pairs))
        for element_pairs, stresses in empty.elements(mesh.blocks):
            pair, stress = element_pairs.ravel(), stresses.reshape(-1, 6, causes)
            add_to_rows(total, pair, stress)
            add_to_rows(element_counts, pair, np.ones(len(pair)))
        every_table, heat = np.split(total / element_counts[:, None, None], [n], axis=-1)
        averaged_stress = replace(empty, every_table=every_table, heat=heat)
        return replace(averaged_stress, felt_at=averaged_stress.most_stressed(np.arange(len(known_pairs))))

    def most_stressed(self, pairs: Indices) -> Indices:
        """Pairs, among `pairs`, at which the von Mises stress of some coordinate, or by heat, is largest."""
        tables = np.concatenate([self.every_table[pairs], self.heat[pairs]], axis=-1)
        sizes = von_mises(np.moveaxis(tables, 1, 2))
        return np.asarray(pairs[np.unique(sizes.argmax(axis=0))])

    @property
    def shapes(self) -> Floats:
        """Displacements of the nodes by unit coordinates, (k, 3, n)."""
        return self.every_shape[..., : self.size]

    @property
    def table(self) -> Floats:
        """Stresses at all pairs by a unit of each cause, (p, 6, n + h)."""
        return self.stresses(slice(None))

    def stresses(self, pairs: Any) -> Floats:
        """Stresses at pairs, of an index, slice or array, by a unit of each cause, (..., 6, n + h)."""
        return np.concatenate([self.every_table[pairs][..., : self.size], self.heat[pairs]], axis=-1)

    @property
    def moved(self) -> Floats:
        """Displacements of the nodes by a unit of each cause, (k, 3, n + h)."""
        return np.concatenate([self.shapes, self.swelling], axis=-1)

    @property
    def node(self) -> Indices:
        """Nodes of the pairs."""
        return self.known % len(self.mesh.points)

    @property
    def clamps(self) -> dict[str, str]:
        """Nodes that each group of the clamp holds, in words, by its name."""
        count = len(np.unique(self.mesh.numbers))
        return {name: f"{number:,} of {count:,} nodes" for name, number in self.mesh.clamps.items()}

    @property
    def material(self) -> list[str]:
        """Materials of the pairs."""
        names = _materials(self.mesh)
        return [names[i] for i in self.known // len(self.mesh.points)]

    def strain(self, point: str, along: Any) -> Floats:
        """Normal strain (n + h,) at a named point by a unit of each cause, in a direction of the point's axes."""
        if point not in self.mesh.named_points:
            raise InputError("at", f"is {point!r}", f"choose from {', '.join(self.mesh.named_points)}")
        x, y, z = self.mesh.axes(point) @ np.asarray(along, dtype=float) / np.linalg.norm(along)
        shares = np.array([x * x, y * y, z * z, y * z, x * z, x * y])  # of strains with twice the tensor's shear
        return np.asarray(shares @ self.strained(self.pairs_at(point)))

    def pairs_at(self, point: str, size: Floats | None = None) -> Indices:
        """Pairs of a named point: one for its node, or one for each node of an interface.

        Where a node has several materials, the pair is that of the largest `size` (p,), or the first.
        """
        interfaces = self.mesh.interfaces
        nodes = interfaces[point] if point in interfaces else self.mesh.stations[point]
        order = np.flatnonzero(np.isin(self.node, nodes))
        order = order if size is None else order[np.argsort(-size[order], kind="stable")]
        return np.asarray(order[np.unique(self.node[order], return_index=True)[1]])

    def strained(self, pairs: Indices) -> Floats:
        """Mean strains (6, n + h) at pairs by a unit of each cause, with twice the tensor's shear. They follow from the
        stresses by the elasticity of each material.
        """
        materials, table = self.material, self.stresses(pairs)
        total = np.zeros(table.shape[1:])
        for name in {materials[pair] for pair in pairs}:
            elasticity = next(block.elasticity for block in self.mesh.blocks if block.material == name)
            alike = np.array([materials[pair] == name for pair in pairs])
            total += np.linalg.solve(elasticity, table[alike].sum(axis=0))
        return np.asarray(total / len(pairs))

    def parts(
        self, time: Floats, base: Any, causes: Floats, *, motion: str, model: str, environment: str
    ) -> dict[str, Any]:
        """Fields of a response by causes (t, n + h): the stress, and the surface in motion at some of the times."""
        samples = np.unique(np.linspace(0, len(time) - 1, TIMES).round().astype(int))
        skin, sizes = self._skin(causes[samples])
        surface = Surface(**skin, time=time[samples], sizes=sizes)
        return {"solid": solid_stress(self, time, causes, motion=motion, model=model), "surface": surface}

    def in_modes(self, modes: Complex) -> SurfaceModes:
        """The surface as it moves in modes (k, n)."""
        skin, sizes = self._skin(np.pad(np.concatenate([modes.real, modes.imag]), ((0, 0), (0, self.heat.shape[-1]))))
        return SurfaceModes(**skin, sizes=sizes[: len(modes)] + 1j * sizes[len(modes) :])

    def _skin(self, q: Floats) -> tuple[dict[str, Any], Floats]:
        """Fields of the surface with its s principal shapes under causes q (t, n + h), and their sizes (t, s).

        The shapes are those of a singular value decomposition, in which causes count by the stress that they make.
        """
        vertices, triangles = surface_of(self.mesh)
        count = len(self.mesh.points)
        # At a vertex of two materials the first.
        first = np.full(count, -1)
        first[self.node[::-1]] = np.arange(len(self.known))[::-1]
        stress, displacements = self.stresses(first[vertices]), self.moved[vertices]
        size = np.sqrt((stress**2).sum(axis=(0, 1)))
        size_vectors, sizes, cause_vectors = np.linalg.svd(q * size, full_matrices=False)
        shape_count = max(1, int((sizes > ENOUGH * sizes[0]).sum()))
        mixed = (cause_vectors[:shape_count] / np.where(size > 0, size, np.inf)).T  # causes of unit shapes
        skin = {
            "vertices": self.mesh.points[vertices],
            "triangles": triangles,
            "shapes": np.moveaxis(displacements @ mixed, -1, 0),
            "stress": np.moveaxis(stress @ mixed, -1, 0),
            "judged": ~self.singular[first[vertices]],
        }
        return skin, size_vectors[:, :shape_count] * sizes[:shape_count]

    def elements(self, blocks: Any) -> Iterator[tuple[Indices, Floats]]:
        """Yield pairs (e, k) at the nodes of some blocks' elements, and stresses there by a unit of each cause, (e, k,
        6, n + h).
        """
        names, count, displacements = _materials(self.mesh), len(self.mesh.points), self.moved
        rise = np.repeat([0.0, 1.0], [self.size, displacements.shape[-1] - self.size])
        for part in chunks(self.mesh.points, blocks, "stress"):
            pair = np.searchsorted(self.known, names.index(part.block.material) * count + part.nodes)
            outward, stress = extrapolation(part.block.kind), part.stress(displacements, rise=rise)
            yield pair, np.einsum("kq,eqvn->ekvn", outward, stress, optimize=True)

    def spread(self, pair: int, q: Floats) -> float:
        """Range of von Mises stress by causes q (n + h,) among the elements that share a pair, as a share of the
        mean's.
        """
        number, node = divmod(int(self.known[pair]), len(self.mesh.points))
        material = _materials(self.mesh)[number]
        blocks_there = [
            replace(block, nodes=block.nodes[(block.nodes == node).any(axis=1)])
            for block in self.mesh.blocks
            if block.material == material
        ]
        parts = [stress[pairs == pair] @ q for pairs, stress in self.elements(blocks_there)]
        mean = float(von_mises(self.stresses(pair) @ q))
        return float(np.ptp(von_mises(np.concatenate(parts)))) / mean if mean > 0 else 0.0

    def felt(self, causes: Floats) -> Floats:
        """Stress components (t, c) over time at the pairs `felt_at`, by causes (t, n + h)."""
        return np.asarray(np.tensordot(causes, self.stresses(self.felt_at), (1, 2)).reshape(len(causes), -1))

    def histories(self, q: Floats) -> tuple[Floats, Indices, Floats]:
        """Largest von Mises stress of every pair over time, (p,), the time at which, (p,), and the largest of all pairs
        that are not singular at each time, (t,).
        """
        table, count = deviatoric(self.table), len(self.known)
        size, steps = np.zeros(count), np.zeros(count, dtype=int)
        if self.singular.any():
            largest = LargestNorms(table[:, self.singular], q)
            size[self.singular], steps[self.singular] = largest.size, largest.when
            table = table[:, ~self.singular]
        largest = LargestNorms(table, q)
        size[~self.singular], steps[~self.singular] = largest.size, largest.when
        return size, steps, largest.over


def _materials(mesh: Any) -> list[str]:
    return list(dict.fromkeys(block.material for block in mesh.blocks))


def hull(points: Floats) -> Floats:
    """Corners of the convex hull of points (k, 3); the points themselves where they are flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.asarray(points[np.sort(ConvexHull(points).vertices)])
    except (QhullError, ValueError):
        return points


def corners_of(kind: str) -> int:
    """Number of corners of an element."""
    return 2 * KINDS[kind].shell or {"tetra": 4, "tetra10": 4, "wedge": 6, "wedge15": 6}.get(kind, 8)


@cache
def face_nodes(kind: str, face: int) -> Indices:
    """Nodes of a solid element on a face: its corners, then those in the middles of its edges and in its own middle."""
    places, corners = reference(kind), list(FACES[corners_of(kind)][face])
    middles = [*(places[corners] + places[np.roll(corners, -1)]) / 2, places[corners].mean(axis=0)]
    distance = np.abs(places[:, None] - middles).max(axis=2)
    return np.array([*corners, *distance.argmin(axis=0)[distance.min(axis=0) < 1e-9]])


def outer_faces(mesh: Any) -> list[tuple[Any, int, Indices]]:
    """Outer faces, which no two elements share. Each entry is a block, the number of a face, and the elements (e,) that
    have it on the outside.
    """
    faces, count = list[tuple[Any, int, Indices]](), len(mesh.points)
    for size in (3, 4):
        sides = [(block, k) for block in mesh.blocks for k, face in enumerate(FACES[corners_of(block.kind)])
                 if len(face) == size]  # fmt: skip
        if sides:
            corners = [block.nodes[:, FACES[corners_of(block.kind)][k]] for block, k in sides]
            first, second, third = np.sort(np.concatenate(corners), axis=1).T[:3]  # no two faces share three corners
            _, edge = np.unique(first * count + second, return_inverse=True)
            _, number, shared = np.unique(edge * count + third, return_inverse=True, return_counts=True)
            parts = np.split(shared[number] == 1, np.cumsum([len(nodes) for nodes in corners])[:-1])
            faces += [(*side, np.flatnonzero(outer)) for side, outer in zip(sides, parts, strict=True)]
    return faces


def outer_triangles(mesh: Any) -> Indices:
    """Corners (f, 3) of the triangles into which the outer faces are divided."""
    triangles = list[Indices]()
    for block, k, elements in outer_faces(mesh):
        corners = block.nodes[elements][:, FACES[corners_of(block.kind)][k]]
        triangles += [corners[:, [0, i, i + 1]] for i in range(1, corners.shape[1] - 1)]
    return np.concatenate(triangles)


def surface_of(mesh: Any, most: int = VERTICES) -> tuple[Indices, Indices]:
    """Nodes (v,) of the outer faces, and the triangles (f, 3) of these that make them up.

    More nodes than about `most` are thinned out: those in a cell of a grid become the one nearest to their mean.
    """
    outside = outer_triangles(mesh)
    nodes, flat = np.unique(outside, return_inverse=True)
    if len(nodes) > most:
        places = mesh.points[nodes] - mesh.points[nodes].min(axis=0)
        cell = np.sqrt(_area(mesh.points[outside]) / most)
        _, group = np.unique(np.floor(places / cell).astype(int), axis=0, return_inverse=True)
        group = group.ravel()
        means = np.stack([np.bincount(group, x) for x in places.T], axis=1) / np.bincount(group)[:, None]
        distance = np.linalg.norm(places - means[group], axis=1)
        order = np.lexsort((distance, group))
        nearest = order[np.unique(group[order], return_index=True)[1]]
        nodes, flat = nodes[nearest], group[flat]
    a, b, c = flat.reshape(-1, 3).T
    return nodes, flat.reshape(-1, 3)[(a != b) & (b != c) & (c != a)]


def _area(corners: Floats) -> float:
    """Area of triangles (f, 3, 3)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(normals, axis=1).sum() / 2)


def deviatoric(table: Floats) -> Floats:
    """Combinations (5, ..., n) of stresses xx, yy, zz, yz, xz, xy (..., 6, n) whose norm is the von Mises stress."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(table, -2, 0)
    return np.stack([xx - (yy + zz) / 2, *(np.sqrt(3) * shear for shear in ((yy - zz) / 2, yz, xz, xy))])


def principal(stress: Floats) -> Floats:
    """Principal stresses (..., 3) of stresses (..., 6), in descending order."""
    return np.asarray(np.linalg.eigvalsh(stress[..., TENSOR])[..., ::-1])


def turned(tensor: Floats, axes: Floats) -> Floats:
    """Components xx, yy, zz, yz, xz, xy (..., 6) of tensors along other axes, the columns of `axes` (3, 3)."""
    along = axes.T @ tensor[..., TENSOR] @ axes
    return np.asarray(along[..., [0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])


def critical_plane_stress(stress: Floats) -> Floats:
    """Normal stress (t,) of stresses (t, 6) on the plane where its range over time is largest: the critical plane."""
    normal = AROUND / np.linalg.norm(AROUND, axis=1, keepdims=True)
    most, rounding = np.full(len(normal), -np.inf), SETTLED * np.abs(stress).max()
    while True:
        # Between the extremes on a plane the stress changes most on a principal plane of that change, or as much.
        over = np.einsum("tij,ki,kj->tk", stress[:, TENSOR], normal, normal, optimize=True)
        size = np.ptp(over, axis=0)
        if not (size > (1 + SETTLED) * most + rounding).any():
            return np.asarray(over[:, size.argmax()])
        most, change = size, stress[over.argmax(axis=0)] - stress[over.argmin(axis=0)]
        sizes, axes = np.linalg.eigh(change[:, TENSOR])
        normal = axes[np.arange(len(axes)), :, np.abs(sizes).argmax(axis=1)]


def solid_stress(nodal: NodalStress, time: Floats, q: Floats, **about: Any) -> SolidStress:
    """Return the stress by causes (t, n + h) at times (t,), with the fields `about` its origin."""
    from scipy.spatial import cKDTree

    mesh, node_of, materials, table = nodal.mesh, nodal.node, nodal.material, nodal.table
    largest, when, over = nodal.histories(q)
    strengths = np.array([mesh.strengths.get(name, np.inf) for name in materials])
    exponents = np.array([mesh.exponents.get(name, np.nan) for name in materials])
    judged, kinds = np.where(nodal.singular, 0.0, largest), _materials(mesh)
    of_kind = (np.flatnonzero(np.array(materials) == name) for name in kinds)
    foremost = [int(pairs[judged[pairs].argmax()]) for pairs in of_kind]

    def stress_at(pair: int) -> StressAt:
        """Stress of a pair at the time at which it is largest."""
        t, node, strength = int(when[pair]), int(node_of[pair]), float(strengths[pair])
        return StressAt(
            von_mises=float(largest[pair]),
            principal=principal(table[pair] @ q[t]),
            time=float(time[t]),
            place=mesh.points[node],
            node=int(mesh.numbers[node]),
            material=materials[pair],
            spread=nodal.spread(pair, q[t]),
            yield_strength=strength if np.isfinite(strength) else None,
        )

    singular: dict[str, Any] = {"singular_nodes": nodal.excess if nodal.compared else None, "known": not nodal.excess}
    if nodal.singular.any():
        nodes = np.unique(node_of[nodal.singular])
        depth = cKDTree(mesh.points[node_of[~nodal.singular]]).query(mesh.points[nodes])[0].max()
        top = int(np.where(nodal.singular, largest, 0.0).argmax())
        singular = {"singular": stress_at(top), "singular_nodes": len(nodes), "singular_depth": float(depth)}
    names = mesh.named_points
    chosen = [nodal.pairs_at(name, largest) for name in names]
    tables = np.stack([[table[pairs].mean(axis=0), nodal.strained(pairs)] for pairs in chosen], axis=1)
    stress, strain = np.einsum("kpvn,tn->ktpv", tables, q, optimize=True)
    axes = [mesh.axes(name) for name in names]
    stresses = [turned(tensor, to) for tensor, to in zip(stress.swapaxes(0, 1), axes, strict=True)]
    strains = [turned(tensor * HALVES, to) / HALVES for tensor, to in zip(strain.swapaxes(0, 1), axes, strict=True)]
    at_nodes = np.zeros(len(mesh.points))
    np.maximum.at(at_nodes, node_of, largest)
    return SolidStress(
        time=time,
        von_mises=over,
        worst=stress_at(int(judged.argmax())),
        nearest_yield=stress_at(int((judged / strengths).argmax()))
        if np.isfinite(strengths).any() and not nodal.excess
        else None,
        **singular,
        points=names,
        point_von_mises=von_mises(stress),
        point_principal=principal(stress),
        point_stress=np.stack(stresses, axis=1),
        point_strain=np.stack(strains, axis=1),
        materials=tuple(kinds),
        exponents=exponents[foremost],
        material_normal=np.stack([critical_plane_stress(q @ table[pair].T) for pair in foremost], axis=1),
        point_normal=np.stack([critical_plane_stress(tensor) for tensor in stress.swapaxes(0, 1)], axis=1),
        point_exponent=exponents[[pairs[0] for pairs in chosen]],
        nodes=mesh.points,
        node_von_mises=at_nodes,
        **about,
    )
