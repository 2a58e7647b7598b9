"""A rise of the temperature in a mesh, by which shells swell and elements push on their nodes."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.mechanics.equations.linear import LoadTerms
from gbeam.mechanics.equations.virtual_work import LoadHistory
from gbeam.mechanics.structure import Structure
from gbeam.solids.elements import geometric_stiffness, thermal_forces
from gbeam.solids.geometry import Mesh


class Heat(NamedTuple):
    """A rise by 1 K in a mesh of k points: its `swelling` (k, 3, h), forces (3 k, h) on the nodes, and history.

    h is 1 if the mesh has a temperature, else 0.
    """

    swelling: Floats
    forces: Floats
    history: LoadHistory | None

    @classmethod
    def from_mesh(cls, mesh: Mesh) -> Self:
        """Compute them of a mesh."""
        count = len(mesh.points)
        if mesh.temperature is None:
            return cls(np.zeros((count, 3, 0)), np.zeros((3 * count, 0)), None)
        swelling = swelling_of(mesh)
        forces = thermal_forces(mesh.points, mesh.blocks, swelling)
        return cls(swelling[..., None], forces[:, None], LoadHistory((mesh.temperature.profiles,)))

    @property
    def number(self) -> int:
        """Number h of the loads that heat it."""
        return self.forces.shape[1]

    def geometric_stiffness(self, mesh: Mesh, static: Floats, shapes: Floats) -> Floats:
        """Geometric stiffness in shapes (k, 3, n) of the mesh where its static displacements (k, 3, h) answer the
        rise, in two halves (2, h, n, n).
        """
        if not self.number:
            return np.zeros((2, 0, shapes.shape[-1], shapes.shape[-1]))
        return geometric_stiffness(mesh.points, mesh.blocks, static + self.swelling, shapes, rise=1.0, strained=False)

    def apply(self, structure: Structure) -> Structure:
        """Return the structure of the mesh under its temperature."""
        if self.history is None:
            return structure
        return replace(structure, history=self.history, load_values=self.history(np.zeros(())), heated=True)

    def terms(self, driven: Floats, stiffness: Floats) -> LoadTerms | None:
        """Terms of its load by the forces `driven` (n, h) on coordinates and what they add to the stiffness, (h, n,
        n).
        """
        if not self.number:
            return None
        n = len(driven)
        constant, slope = np.zeros((1, 6, 6 + n)), np.zeros((1, 6, 6 + n, n))
        constant[0, 0, 6:], slope[0, 0, 6:] = driven[:, 0], -stiffness[0]
        return LoadTerms(constant, slope)


def swelling_of(mesh: Mesh) -> Floats:
    """Displacements (k, 3) by a kelvin of the points on the faces of shells from the middle, by which shells get
    thicker; zero of other points.
    """
    strain, shared = np.zeros((len(mesh.points), 3, 3)), np.zeros(len(mesh.points))
    for block in mesh.blocks:
        points = np.unique(block.nodes)
        strain[points] += block.expansion
        shared[points] += 1
    _, node = np.unique(mesh.numbers, return_inverse=True)
    count = np.bincount(node)
    middles = np.stack([np.bincount(node, x) / count for x in mesh.points.T], axis=1)
    mean = strain / np.maximum(shared, 1)[:, None, None]
    return np.asarray(np.einsum("kab,kb->ka", mean, mesh.points - middles[node]))
