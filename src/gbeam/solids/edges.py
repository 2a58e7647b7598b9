"""Edges at which the stress of an elastic solid grows without limit as its mesh gets finer."""

from __future__ import annotations

import numpy as np

from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.solids.elements import Block
from gbeam.solids.geometry import Mesh
from gbeam.solids.shape_functions import jacobians, reference, shapes_at
from gbeam.solids.stress import FACES, corners_of, face_nodes, outer_faces
from gbeam.structure.supports import DIRECTIONS

ACROSS = 0.1  # of a unit normal: a direction in which more than that of it presses a face
SHARP = np.cos(np.radians(30.0))  # between the normals of two faces; in a fillet's elements they are nearer


def singular_nodes(mesh: Mesh) -> Flags:
    """Flags (k,) of nodes where stress has no limit as a mesh gets finer.

    They are on the edges of clamps, supports and rigid links, where the stress grows slowly, and in the elements at
    re-entrant edges.
    """
    flags, corner = _held_edges(mesh), _re_entrant(mesh)
    for block in mesh.blocks:
        flags[block.nodes[corner[block.nodes].any(axis=1)]] = True
    return flags


def _held_edges(mesh: Mesh) -> Flags:
    """Flags (k,) of nodes at the edge of a clamp, support or rigid link: those on an outer face that is held in part.

    A support that holds faces along directions in which it slides on the face beside, as at a plane of symmetry, has no
    such edge there.
    """
    flags = np.zeros(len(mesh.points), dtype=bool)
    linked_sets = [
        nodes for name, nodes in mesh.links.nodes.items() if name not in mesh.links.weights and len(nodes) > 1
    ]
    all_axes = np.eye(3)
    sets = [(nodes, all_axes, False) for nodes in (np.flatnonzero(mesh.clamped), *linked_sets)]
    for place in mesh.supports:
        ways = [DIRECTIONS.index(way) for way in place.support.rigid if way in "xyz"]
        if place.kind == "nodes" and ways:
            sets.append((place.points, all_axes[ways], True))
    for nodes, directions, by_support in sets:
        is_held, on_whole_face, is_outer = np.zeros_like(flags), np.zeros_like(flags), np.zeros_like(flags)
        is_held[nodes] = True
        for block, face, elements in outer_faces(mesh):
            face_points = block.nodes[elements][:, face_nodes(block.kind, face)]  # nodes of each face
            on_whole_face[face_points[is_held[face_points].all(axis=1)]] = True
            corners = mesh.points[face_points[:, :3]]
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            pressed = np.abs(normal @ directions.T).max(axis=1) > ACROSS
            part = is_held[face_points] & ~is_held[face_points].all(axis=1, keepdims=True)
            flags[face_points[part & pressed[:, None]]] = True
            is_outer[face_points] = True
        if by_support:  # where points and lines are held alone
            flags |= is_held & is_outer & ~on_whole_face
    return flags


def _re_entrant(mesh: Mesh) -> Flags:
    """Flags (k,) of nodes on re-entrant edges, whose two outer faces meet at a sharper angle than those of a fillet."""
    parts = [_edges_of_faces(mesh, *faces) for faces in outer_faces(mesh)]
    ends, normals, centres = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = np.argsort(ends[:, 0] * len(mesh.points) + ends[:, 1], kind="stable")
    ends, normals, centres = ends[order], normals[order], centres[order]
    _, first, count = np.unique(ends[:, :2], axis=0, return_index=True, return_counts=True)
    one = first[count == 2]
    other = one + 1  # equal edges follow one another
    is_sharp = (normals[one] * normals[other]).sum(axis=2).max(axis=1) < SHARP
    # At a re-entrant edge the other face lies on the side to which the normal of the one points.
    away = centres[other] - mesh.points[ends[one, :2]].mean(axis=1)
    met = one[is_sharp & ((away * normals[one].mean(axis=1)).sum(axis=1) > 0)]
    flags = np.zeros(len(mesh.points), dtype=bool)
    flags[ends[met]] = True
    return flags


def _edges_of_faces(mesh: Mesh, block: Block, face: int, elements: Indices) -> tuple[Indices, Floats, Floats]:
    """Edges of one face, by its number, of some elements.

    Returns the nodes (m, 3) at their ends, ascending, and in their middle, or at an end once more. Then it returns the
    outward normals at both ends, (m, 2, 3), and the middle of the face, (m, 3).
    """
    face_points, places = face_nodes(block.kind, face), reference(block.kind)
    count = len(FACES[corners_of(block.kind)][face])
    corners = face_points[:count]
    # The outward normal in the reference element, which maps to places by the inverse of the Jacobian.
    normal = np.cross(places[corners[1]] - places[corners[0]], places[corners[2]] - places[corners[0]])
    normal *= np.sign(normal @ (places[corners[0]] - places[: corners_of(block.kind)].mean(axis=0)))
    nodes = block.nodes[elements]
    maps = jacobians(mesh.points, nodes, shapes_at(block.kind, places[corners])[1])
    normals = np.einsum("c,eqcd->eqd", normal, np.linalg.inv(maps))
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    start, end = np.arange(count), np.roll(np.arange(count), -1)
    middles = face_points[count : 2 * count] if len(face_points) >= 2 * count else corners
    ends = np.stack([nodes[:, corners[start]], nodes[:, corners[end]]], axis=2).reshape(-1, 2)
    of_ends = np.stack([normals[:, start], normals[:, end]], axis=2).reshape(-1, 2, 3)
    order = np.argsort(ends, axis=1)
    edges = np.concatenate([np.take_along_axis(ends, order, axis=1), nodes[:, middles].reshape(-1, 1)], axis=1)
    centres = np.repeat(mesh.points[nodes[:, corners]].mean(axis=1), count, axis=0)
    return edges, np.take_along_axis(of_ends, order[..., None], axis=1), centres
