"""Mesh of a file in the axes of the base: its points, and elements, groups and places among them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.arrays.types import Floats, Indices, Numbers
from gbeam.errors import InputError
from gbeam.guards.checks import positive
from gbeam.numerics.sparse import refuse_cost
from gbeam.solids.elements import Block
from gbeam.solids.foreign import Elements, assigned, elements_of, nodes_in, numbers_of, refuse_missing
from gbeam.solids.plausibility import refuse_far
from gbeam.solids.shells import points_of, refuse_oblique
from gbeam.structure.attachments import TIP, checked_name
from gbeam.structure.material import Material, Orthotropic

MIDDLE = 1e-6  # of half of the thickness of a shell: a place that is nearer to the middle is on neither side


@dataclass(frozen=True)
class Placed:
    """The mesh of a file in base axes: places (f, 3) m of its nodes, and the rotation to base axes from the file's.

    The solid has points (k, 3), which stand for the nodes of indices (k,) in `numbers`; shells have two for a node. The
    elements are listed block by block, and `points_of` has their points.
    """

    mesh: Any
    places: Floats
    rotation: Floats
    points: Floats
    numbers: Indices
    elements: list[Elements]
    points_of: list[Indices]

    @classmethod
    def from_mesh(
        cls, mesh: Any, size: float, thickness: Any, *, origin: Numbers, turn: Numbers, scale: Numbers
    ) -> Placed:
        """Place a mesh with a unit of a `size`, m: scale it, move its origin, and turn it by a rotation vector."""
        from scipy.spatial.transform import Rotation

        places = np.asarray(mesh.points, dtype=float)
        if places.ndim != 2 or places.shape[1] != 3 or not np.isfinite(places).all():
            raise InputError("mesh", f"has points of shape {places.shape}, or not finite", "give x, y and z of each")
        refuse_far("mesh", places, size)
        elements = elements_of(mesh, thickness)
        used = np.unique(np.concatenate([block.nodes.ravel() for block in elements]))
        refuse_cost("mesh", 3 * len(used) * (1 if thickness is None else 2))
        refuse_missing(mesh, elements)
        for i, factor in enumerate(scale):
            positive(f"scale[{i}]", factor, "")
        rotation = Rotation.from_rotvec(turn).as_matrix()
        middles = (size * places * np.asarray(scale, dtype=float) - np.asarray(origin, dtype=float)) @ rotation.T
        points, numbers, of_elements = points_of(middles, elements)
        return cls(mesh, middles, rotation, points, numbers, elements, of_elements)

    @property
    def middles(self) -> Floats:
        """Places (k, 3) of the nodes for which the points stand. For shells they are on the middle surface."""
        return self.places[self.numbers]

    def group(self, where: str, name: str) -> Indices:
        """Points of a group of nodes or elements. An InputError about `where` refuses a group without any."""
        points = np.flatnonzero(np.isin(self.numbers, nodes_in(self.mesh, where, name)))
        if not len(points):
            raise InputError(where, f"is {name!r}, which has no node of a solid element or shell", "merge their nodes")
        return points

    def nearest(self, name: str, place: Any) -> int:
        """Point nearest to a place, or the point of a group's only node. On a shell it is on the face on the side of
        the place, or on the upper one.
        """
        where = f"points.{name}"
        if name != TIP:
            try:
                checked_name(name)
            except InputError as error:
                raise error.within("points") from None
        middles = self.middles
        if isinstance(place, str):
            points = self.group(where, place)
            count = len(np.unique(middles[points], axis=0))
            if count != 1:
                raise InputError(where, f"is the group {place!r} of {count} nodes", "give one node, or a place")
            return int(points[0])
        place = np.asarray(place, dtype=float)
        if place.shape != (3,) or not np.isfinite(place).all():
            raise InputError(where, f"is {place!r}", "give x, y and z in m, or a group")
        away = np.linalg.norm(middles - place, axis=1)
        size = float(np.linalg.norm(np.ptp(self.points, axis=0)))
        if away.min() > 0.1 * size:
            x, y, z = middles[away.argmin()]
            fix = f"give a place on the solid, in m: that node is at ({x:.4g}, {y:.4g}, {z:.4g}) m"
            raise InputError(where, f"is {away.min():.3g} m from the nearest node", fix)
        points = np.flatnonzero(away == away.min())  # two on a shell, at arms from its middle
        arms = self.points[points] - middles[points]
        on_side = arms @ (place - middles[points[0]]) > MIDDLE * (arms**2).sum(axis=1)
        return int(points[on_side.argmax()])

    def blocks(self, materials: Any, *, heated: bool) -> tuple[Block, ...]:
        """Blocks of elements of each kind and material, one for all or by groups, with axes turned like the mesh, and
        with their expansions if the mesh is `heated`.
        """
        owner = assigned(self.mesh, "materials", materials, (part.block for part in self.elements))
        without = sum(int((owner[part.block][part.which] < 0).sum()) for part in self.elements)
        if without:
            raise InputError("materials", f"give {without} elements none", "name the groups of all elements")
        by_group = materials if isinstance(materials, Mapping) else {"": materials}
        numbers, names, blocks = numbers_of(self.mesh), shared_names(by_group), []
        for m, (name, material) in enumerate(by_group.items()):
            where = f"materials.{name}" if name else "materials"
            has_axes = isinstance(material, Orthotropic)
            try:
                turned = replace(material, axes=np.asarray(material.axes) @ self.rotation.T) if has_axes else material
                elasticity = turned.elasticity
                expansion = np.asarray(turned.thermal_strain) if heated else np.zeros((3, 3))
            except InputError as error:
                raise error.within(where) from None
            for (i, which, kind, _, thickness), nodes in zip(self.elements, self.points_of, strict=True):
                chosen = owner[i][which] == m
                if thickness is not None and has_axes:
                    refuse_oblique(where, self.points, nodes[chosen], kind, turned.axes)
                if chosen.any():
                    which, density = numbers[i][which[chosen]], float(material.density)
                    blocks.append(Block(kind, nodes[chosen], which, names[name], density, elasticity, expansion))
        return tuple(blocks)


def shared_names(materials: Mapping[str, Material | Orthotropic]) -> dict[str, str]:
    """Names of materials by their groups. Groups with equal materials share one name, which lists them all: stress is
    averaged over their elements together.
    """
    names = dict[str, str]()
    for name, material in materials.items():
        names[name] = ", ".join(other for other, alike in materials.items() if alike == material)
    return names
