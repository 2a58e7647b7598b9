"""The equations of motion as residuals r(y, ẏ, ÿ; inputs) of one form, on a given base and on a free hub."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
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

    def pack(self, base: Base, loads: Loads) -> Array:
        """The inputs as one vector: a_O, ω, α and the loads' components, (9 + 6 loads,)."""
        xp = namespace(base.a_WO_B, loads)
        parts = [base.a_WO_B, base.w_WB_B, base.alpha_WB_B]
        return xp.concatenate(parts if loads is None else [*parts, xp.reshape(loads, (-1,))])

    def unpack(self, u: Array) -> tuple[Base, Loads]:
        """The inputs of a vector."""
        return Base(u[:3], u[3:6], u[6:9]), _loads(u[9:])

    def base(self, y: Array, yd: Array, ydd: Array, u: Array) -> Base:
        """Motion of the base."""
        return self.unpack(u)[0]


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

    def pack(self, torque: Array, loads: Loads) -> Array:
        """The inputs as one vector: the torque and the loads' components, (1 + 6 loads,)."""
        xp = namespace(torque, loads)
        alone = xp.reshape(xp.asarray(torque), (1,))
        return alone if loads is None else xp.concatenate([alone, xp.reshape(loads, (-1,))])

    def unpack(self, u: Array) -> tuple[Array, Loads]:
        """The inputs of a vector."""
        return u[0], _loads(u[1:])

    def base(self, y: Array, yd: Array, ydd: Array, u: Array) -> Base:
        """Motion of the base; its acceleration is the specific force where gravity acts."""
        return self.mount.base(y[0], yd[0], ydd[0])


def _loads(flat: Array) -> Loads:
    return None if np.shape(flat)[0] == 0 else flat.reshape(-1, 6)
