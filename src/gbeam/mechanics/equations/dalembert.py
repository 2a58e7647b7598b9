"""The equations of a complete model (CFOAM, fourth-order, exact): D'Alembert's sum over the particles of its field.

Σ m (∂r/∂q)·a + K q + C q̇ = Q. All arrays may have leading axes: at one instant the sums are compiled by JAX for time
steps, over many they are NumPy's.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Self

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.contraction import Reach
from gbeam.mechanics.equations.inertia import Inertia
from gbeam.mechanics.equations.virtual_work import LoadWork


class Demanding:
    """Equations whose residual is what a motion demands along the coordinates."""

    demanded: Callable[..., tuple[Array, Array, Array]]

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
        """Residual (..., n) under a base's acceleration (specific force), angular rate and acceleration (..., 3)."""
        return self.demanded(q, qd, qdd, a_WO_B, w_WB_B, alpha_WB_B, load_values)[0]

    def contracted(self, reach: Reach) -> Self:
        """Return the same equations with fewer sums, where what the root can do allows any: else these."""
        return self


@record
class Complete(Demanding):
    """The equations of a complete model. `damping` and `stiffness` (n, n) are constant."""

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
        return ((q @ self.stiffness) * q).sum(axis=-1) / 2

    def elastic(self, q: Array) -> Array:
        """Forces of the strain energy on the coordinates (..., n)."""
        return q @ self.stiffness

    def mass_moment(self, q: Array) -> tuple[Array, Array]:
        """Mass kg, and its first moment (..., 3) kg m about the root, its axes."""
        return self.inertia.mass_moment(q)

    def demanded(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces that a motion demands, less those of the loads: on the coordinates (..., n), and force, N, and moment,
        N m, at the root (..., 3).
        """
        generalised, force, moment = self.inertia.forces(q, qd, qdd, a, w, alpha)

        generalised = generalised + (q @ self.stiffness + qd @ self.damping)
        if self.work is None or loads is None:
            return generalised, force, moment
        load_generalised, load_force, load_moment = self.work.generalised(q, loads)
        return generalised - load_generalised, force - load_force, moment - load_moment
