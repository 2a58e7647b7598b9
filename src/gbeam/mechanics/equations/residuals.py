"""The equations of motion as residuals r(y, ẏ, ÿ; inputs) of one form, on a given base and on a free hub."""

from __future__ import annotations

from typing import Any

from gbeam.arrays.tree import record
from gbeam.motion.bases.base import Base
from gbeam.motion.bases.hub import Mount

Array = Any
Loads = Any  # components of the loads (loads, 6), or None


@record
class OnBase:
    """On a base whose motion is given: y = q, inputs (Base, load components)."""

    equations: Any

    @property
    def first(self) -> int:
        """Index of the beam's first coordinate in y."""
        return 0

    def __call__(self, q: Array, qd: Array, qdd: Array, inputs: tuple[Base, Loads]) -> Array:
        """Residual (n,)."""
        base, loads = inputs
        return self.equations.residual(q, qd, qdd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads)

    def base(self, y: Array, yd: Array, ydd: Array, inputs: Any) -> Base:
        """Motion of the base."""
        return inputs[0]


@record
class OnHub:
    """On a free hub: y = (θ, q), inputs (torque, load components)."""

    equations: Any
    mount: Mount

    @property
    def first(self) -> int:
        """Index of the beam's first coordinate in y."""
        return 1

    def __call__(self, y: Array, yd: Array, ydd: Array, inputs: tuple[Array, Loads]) -> Array:
        """Residual (n + 1,)."""
        return self.equations.residual(y, yd, ydd, *inputs)

    def base(self, y: Array, yd: Array, ydd: Array, inputs: Any) -> Base:
        """Motion of the base; its acceleration is the specific force where gravity acts."""
        return self.mount.base(y[..., 0], yd[..., 0], ydd[..., 0])
