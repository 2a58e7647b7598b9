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
    """Mesh of a file, as of meshio: places (f, 3) m of its nodes in base axes, and rotation to these from the file's;
    points (k, 3) of the solid, and the indices (k,) of the nodes for which they stand; elements, block by block, and
    their points.
    """

    mesh: Any
    places: Floats
    rotation: Floats
    points: Floats
    numbers: Indices
    elements: list[Elements]
    points_of: list[Indices]

    @classmethod
    def of(cls, mesh: Any, size: float, thickness: Any, *, origin: Numbers, turn: Numbers, scale: Numbers) -> Placed:
        """Place a mesh in a unit of a `size`, m: scaled, moved from the origin, turned by a rotation vector."""
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
        """Places (k, 3) of the nodes for which the points stand: of shells on their middle surface."""
        return self.places[self.numbers]

    def group(self, where: str, name: str) -> Indices:
        """Points of a group of nodes or elements; an InputError about `where` refuses one without."""
        points = np.flatnonzero(np.isin(self.numbers, nodes_in(self.mesh, where, name)))
        if not len(points):
            raise InputError(where, f"is {name!r}, which has no node of a solid element or shell", "merge their nodes")
        return points

    def nearest(self, name: str, place: Any) -> int:
        """Point nearest to a place, or of a group's only node; of a shell on the face on the place's side, or the upper
        one.
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
            if len(count := np.unique(middles[points], axis=0)) != 1:
                raise InputError(where, f"is the group {place!r} of {len(count)} nodes", "give one node, or a place")
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
        points = np.flatnonzero(away == away.min())
        arms = self.points[points] - middles[points]
        return int(points[(arms @ (place - middles[points[0]]) > MIDDLE * (arms**2).sum(axis=1)).argmax()])

    def blocks(self, materials: Any) -> tuple[Block, ...]:
        """Elements of each kind and material, one or by groups, whose axes are turned with the mesh."""
        owner = assigned(self.mesh, "materials", materials, (part.block for part in self.elements))
        without = sum(int((owner[part.block][part.which] < 0).sum()) for part in self.elements)
        if without:
            raise InputError("materials", f"give {without} elements none", "name the groups of all elements")
        by_group = materials if isinstance(materials, Mapping) else {"": materials}
        numbers, names, blocks = numbers_of(self.mesh), shared_names(by_group), []
        for m, (name, material) in enumerate(by_group.items()):
            where = f"materials.{name}" if name else "materials"
            try:
                turned = isinstance(material, Orthotropic)
                along = replace(material, axes=np.asarray(material.axes) @ self.rotation.T) if turned else material
                elasticity = along.elasticity
            except InputError as error:
                raise error.within(where) from None
            for (i, which, kind, _, thickness), nodes in zip(self.elements, self.points_of, strict=True):
                chosen = owner[i][which] == m
                if thickness is not None and turned:
                    refuse_oblique(where, self.points, nodes[chosen], kind, along.axes)
                if chosen.any():
                    named = numbers[i][which[chosen]]
                    blocks.append(Block(kind, nodes[chosen], named, names[name], float(material.density), elasticity))
        return tuple(blocks)


def shared_names(materials: Mapping[str, Material | Orthotropic]) -> dict[str, str]:
    """Names of materials by those of their groups: of groups of the same material all, for stress is shared by them."""
    return {
        name: ", ".join(other for other, alike in materials.items() if alike == each)
        for name, each in materials.items()
    }
