"""Geometry of a solid: nodes, elements, what is clamped, carried and named."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Flags, Floats, Indices, Numbers
from gbeam.solids.elements import Block, masses
from gbeam.solids.held import HeldPlace
from gbeam.solids.links import Links
from gbeam.structure.temperature import Temperature


@dataclass(frozen=True, eq=False)
class Mesh(Value):
    """Nodes and elements of a solid; :class:`gbeam.SolidMesh` is one and says of each field its meaning."""

    points: Floats
    blocks: tuple[Block, ...]
    clamped: Flags
    numbers: Indices
    point_masses: Floats
    stations: dict[str, int]
    strengths: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    interfaces: dict[str, Indices] = field(default_factory=dict)
    links: Links = field(default_factory=Links)
    exponents: dict[str, float] = field(default_factory=dict)
    turns: dict[str, Numbers] = field(default_factory=dict)
    clamps: dict[str, int] = field(default_factory=dict)
    supports: tuple[HeldPlace, ...] = ()
    temperature: Temperature | None = None

    @property
    def mass(self) -> float:
        """Mass with that on the nodes and of the bodies that it carries, kg."""
        elements = sum(masses(self.points, block).sum() for block in self.blocks)
        return float(elements + self.point_masses.sum() + sum(body.mass for body in self.links.bodies.values()))

    @property
    def named_points(self) -> tuple[str, ...]:
        """Names of the points that are put out: nodes, interfaces, and the tip."""
        *names, tip = self.stations
        return (*names, *self.interfaces, tip)

    def axes(self, point: str) -> Floats:
        """Return the axes of a named point in the base axes, in columns (3, 3).

        Parameters
        ----------
        point : str
            Its name.
        """
        from scipy.spatial.transform import Rotation

        return np.asarray(Rotation.from_rotvec(self.turns.get(point, (0.0, 0.0, 0.0))).as_matrix())
