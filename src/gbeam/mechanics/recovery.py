"""Parts of a structure beside its equations: its sections, what it recovers, and what it was made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import Value, record
from gbeam.constants import Shapes
from gbeam.mechanics.fields.basis import Counts
from gbeam.structure.beam import Beam


@record
class Sections:
    """Sections at root and stations (s,).

    Their `values` are those of the cross-sections. Outboard of each section are the mass (s, particles) kg and the
    shares of loads (s, loaded). The axes of the root's section stand in columns (3, 3). Stresses by unit loads are
    (points, 3, 6, s), the strength is in Pa. The field's points are at the positions `along` the beam, m.
    """

    values: Any
    mass: Array
    loaded: Array
    root_axes: Array
    stresses: Array | None = None
    yield_strength: Any = None
    fatigue_exponent: Any = np.nan
    along: Array = None


class Recovery(Protocol):
    """Results that a specimen's responses have beside its coordinates, such as the stress of a solid.

    They are linear in n + h causes, coordinates and the rise of the temperature, K, h being 1 where it has one.
    """

    @property
    def envelope(self) -> Array:
        """Corners (c, 3) of its convex hull at rest, from the root, m: its load is largest at one of them."""
        ...

    @property
    def clamps(self) -> Mapping[str, str]:
        """Nodes that each group of a mesh's clamp holds, in words, by its name."""
        ...

    def parts(
        self, time: Array, base: Any, causes: Array, *, motion: str, model: str, environment: str
    ) -> dict[str, Any]:
        """Fields of a response, by name, from its times (t,), base motion (t, 3) and causes (t, n + h)."""
        ...

    def in_modes(self, modes: Array) -> Any:
        """Surface for pictures of modes (k, n) in its coordinates."""
        ...

    def felt(self, causes: Array) -> Array:
        """Stress by causes (t, n + h) where it is largest, (t, c) Pa."""
        ...

    def strain(self, point: str, along: Any) -> Array:
        """Normal strain at a named point in a direction of its axes, by a unit of each cause, (n + h,)."""
        ...


@dataclass(frozen=True, eq=False)
class Source(Value):
    """The beam that a structure was made of, and its model's shapes, whose numbers a study chooses if `automatic`.

    These are `counts`, with the static ones of supports among them.
    """

    beam: Beam
    shapes: Shapes
    counts: Counts
    automatic: bool = False
