"""Displacements and rotations of a mesh's named points: nodes, and interfaces, which move as their nodes on average."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gbeam.arrays.types import Floats, Indices
from gbeam.mechanics.fields.taylor import Places
from gbeam.solids.geometry import Mesh
from gbeam.solids.links import attached


@dataclass(frozen=True)
class Stations:
    """Named points of a mesh: `nodes` (s,) at places (s, 3) m, the last of which is the tip, and interfaces.

    Interfaces have centres (i, 3) m, and unit `forces` and moments on these, (3 k, 6 i), as loads on all nodes. In
    results they come before the tip.
    """

    nodes: Indices
    places: Floats
    centres: Floats
    forces: Floats

    @classmethod
    def from_mesh(cls, mesh: Mesh) -> Stations:
        """Take the named points of a mesh. The clamp takes the forces that interfaces have on its nodes."""
        centres, forces = attached(mesh.points, mesh.interfaces)
        forces[np.repeat(mesh.clamped, 3)] = 0.0
        nodes = np.array([*mesh.stations.values()])
        return cls(nodes, mesh.points[nodes], centres, forces)

    def displacements(self, fields: Floats) -> Floats:
        """Displacements (s + i, 3, m) of the points from those (k, 3, m) of all nodes."""
        return self._insert_before_tip(fields[self.nodes], self._mean(fields)[:, 0])

    def expansion(self, shapes: Floats, pushed: Floats) -> tuple[Places, Floats | None]:
        """Places of the points as functions of the coordinates, and rotations (s + i, 3, n) per coordinate.

        Interfaces move to second order by what unit forces on them add to the stiffness, `pushed` (3 i, n, n).
        Rotations are NaN where unknown, and None without interfaces.
        """
        count, n = len(self.centres), shapes.shape[-1]
        r0, first = self._insert_before_tip(self.places, self.centres), self.displacements(shapes)
        if not count:
            return Places(r0, first), None
        # Work of a force in displacements of second order: what its stress adds to the stiffness, with the other sign.
        second = self._insert_before_tip(np.zeros((len(self.nodes), 3, n, n)), -pushed.reshape(count, 3, n, n))
        turns = self._insert_before_tip(np.full((len(self.nodes), 3, n), np.nan), self._mean(shapes)[:, 1])
        return Places(r0, first, second), turns

    def _mean(self, fields: Floats) -> Floats:
        """Mean displacements and rotations (i, 2, 3, m) of the interfaces, from those (k, 3, m) of all nodes."""
        columns = fields.shape[-1]
        return (self.forces.T @ fields.reshape(-1, columns)).reshape(len(self.centres), 2, 3, columns)

    def _insert_before_tip(self, node_values: Floats, interface_values: Floats) -> Floats:
        """Insert the values of the interfaces into those of the nodes, before the tip's."""
        return np.insert(node_values, [len(self.nodes) - 1] * len(self.centres), interface_values, axis=0)
