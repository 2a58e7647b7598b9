"""The equations of a complete model (CFOAM, fourth-order, exact): D'Alembert's sum over the particles of its field.

Σ m (∂r/∂q)·a + K q + C q̇ = Q. On a free hub the moment of the same forces about the axis is the hub's row. All arrays
may have leading axes: at one instant the sums are compiled by JAX for time steps, over many they are NumPy's.
"""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import concatenated, namespace
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.hub import FreeHub, Ground, free_hub
from gbeam.mechanics.equations.inertia import Inertia
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.equations.virtual_work import LoadWork

Array = Any


@record
class Complete:
    """The equations of a complete model; `damping` and `stiffness` (n, n) are constant."""

    inertia: Inertia
    damping: Array
    stiffness: Array
    work: LoadWork | None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.damping.shape[0])

    def strain_energy(self, q: Array) -> Array:
        """U, J."""
        return 0.5 * q @ self.stiffness @ q

    def residual(
        self,
        q: Array,
        qd: Array,
        qdd: Array,
        a_WO_B: Array,
        w_WB_B: Array,
        alpha_WB_B: Array,
        load_values: Array | None = None,
    ) -> Array:
        """Residual (..., n) on a base with given acceleration (or specific force), angular velocity and angular
        acceleration (..., 3).
        """
        return self.demanded(q, qd, qdd, a_WO_B, w_WB_B, alpha_WB_B, load_values)[0]

    def demanded(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces on the coordinates (..., n), and force N and moment N m at the root (..., 3), that motion demands."""
        along, force, moment = self.inertia.forces(q, qd, qdd, a, w, alpha)
        along = along + (q @ self.stiffness + qd @ self.damping)
        if self.work is None or loads is None:
            return along, force, moment
        load, pull, turn = self.work.generalised(q, loads)
        return along - load, force - pull, moment - turn


@record
class CompleteHub:
    """The equations of a free hub with a complete model on its rim, y = (θ, q)."""

    system: Complete
    mount: Any
    ground: Ground

    def residual(self, y: Array, yd: Array, ydd: Array, torque: Array, load_values: Array | None = None) -> Array:
        """Residual (..., n + 1) of hub and beam under a torque on the hub, N m, and load components (..., loads, 6)."""
        (angle, q), (rate, qd), (change, qdd) = ((each[..., 0], each[..., 1:]) for each in (y, yd, ydd))
        _, onward, axis = self.mount.R_HB  # the hub's axes in those of the base
        base = self.mount.base(angle, rate, change)
        motion = base.a_WO_B, base.w_WB_B, base.alpha_WB_B
        beam, force, moment = self.system.demanded(q, qd, qdd, *motion, load_values)
        # About the root, and of the resultant there, e × r_O being along y of the hub.
        about = moment @ axis + self.mount.radius * (force @ onward)
        turning = self.ground.torque(angle, rate, change) + about - torque
        return concatenated([turning[..., None], beam])

    def about(self, c: Coefficients) -> FreeHub:
        """Put a linear model on the hub's rim."""
        return free_hub(c, self.mount, self.ground)

    def momentum(self, y: Array, yd: Array) -> Array:
        """Angular momentum of hub and beam about the axis, N m s."""
        inertia = self.system.inertia
        xp = namespace(y, inertia.mass)
        r, rd, _ = inertia.field.paths(y[1:], yd[1:], xp.zeros_like(y[1:]))
        lever = xp.cross(self.mount.R_HB[2], r + self.mount.radius * self.mount.R_HB[0])
        return self.ground.inertia * yd[0] + xp.sum(inertia.mass[:, None] * lever * (lever * yd[0] + rd))
