"""How the beam's root is held: rigidly, or by springs."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.tree import Value
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive

Array = NDArray[np.float64]


@typed
@dataclass(frozen=True, eq=False)
class Root(Value):
    """Springs between the base and the root; where there is none, the root is rigid in that direction.

    Each spring is one more coordinate of the model, in every kind of model, after the shapes' and in this order.

    Parameters
    ----------
    translation_x, translation_y, translation_z : float or None
        Along the base axes, N/m.
    rotation_y, rotation_z : float or None
        About them, N m/rad: y for bending along z, z for bending along y.

    Raises
    ------
    InputError
        If a stiffness is not positive and finite.
    """

    translation_x: float | None = None
    translation_y: float | None = None
    translation_z: float | None = None
    rotation_y: float | None = None
    rotation_z: float | None = None

    def __post_init__(self) -> None:
        for name, value in self.springs.items():
            positive(name, value, "N/m" if name.startswith("translation") else "N m/rad")

    @property
    def springs(self) -> dict[str, float]:
        """The stiffnesses that are given, by name."""
        given = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in given.items() if value is not None}

    def directions(self) -> tuple[Array, Array]:
        """Matrices (3, springs) from the springs' stretches to the root's displacement and rotation vector."""
        move, turn = np.zeros((2, 3, len(self.springs)))
        for column, name in enumerate(self.springs):
            what, axis = name.split("_")
            (move if what == "translation" else turn)["xyz".index(axis), column] = 1.0
        return move, turn
