"""The equations of a structure on a free hub as a function of numbers, which NumPy evaluates and JAX can compile."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam import Hub, Structure
from gbeam.arrays import namespace, record
from gbeam.mechanics import Inputs, Tree, hub_system

Array = Any


@record
class Hinged:
    """Residual (..., 1 + n) of y = (θ, q), the hub's angle and the coordinates of the structure on its rim."""

    tree: Tree
    idle: Inputs

    def __call__(self, y: Array, yd: Array, ydd: Array, inputs: tuple[Array, Array | None]) -> Array:
        """Residual under a torque (...), N m, on the hub and load components (..., loads, 6), or None."""
        torque, loads = inputs
        efforts = namespace(torque, y).asarray(torque)[..., None] * np.eye(1, self.tree.size)[0]
        return self.tree(y, yd, ydd, replace(self.idle, efforts=efforts, loads=(None, loads)))

    def residual(self, y: Array, yd: Array, ydd: Array, torque: Array, loads: Array | None = None) -> Array:
        """The same with torque and load components apart."""
        return self(y, yd, ydd, (torque, loads))


def hinged(structure: Structure, hub: Hub) -> Hinged:
    """Equations of a structure on a hub that turns freely."""
    system = hub_system(structure, hub)
    inputs = system.inputs(np.zeros(()))
    return Hinged(system.tree.contracted(inputs.ground), inputs)
