"""The equations of a complete model (CFOAM, exact): D'Alembert's sum over the particles of its field, by JAX.

Σ m (∂r/∂q)·a + ∂U/∂q + C q̇ = Q, a = a_O + α × r + ω × (ω × r) + 2 ω × ṙ + r̈: one pull-back of the particles' inertia
forces along their places. On a free hub the moment of the same forces about the axis is the hub's row. The key of a
compiled function is sizes, never values.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.arrays.tree import record
from gbeam.mechanics.equations.hub import FreeHub, Ground, free_hub
from gbeam.mechanics.equations.inertia import Elasticity, Weighed
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.equations.virtual_work import LoadWork
from gbeam.mechanics.fields.rotation import cross

Array = Any
Components = tuple[Any, ...]  # three arrays, along x, y and z


@record
class Complete:
    """The equations of a complete model; `stiffness` (n, n) is given where the energy is quadratic."""

    inertia: Weighed
    elasticity: Elasticity
    damping: Array
    stiffness: Array | None
    work: LoadWork | None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.damping.shape[0])

    def strain_energy(self, q: Array) -> Array:
        """U, J."""
        return self.elasticity.energy(q)

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
        """Residual (n,) on a base with given acceleration (or specific force), angular velocity and angular
        acceleration (3,).
        """
        _, force, pull_back, _ = self.inertia_forces(q, qd, qdd, a_WO_B, w_WB_B, alpha_WB_B)
        (along,) = pull_back(force)
        return along + self.inside(q, qd) - self.generalised(q, load_values)[6:]

    def inertia_forces(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array
    ) -> tuple[Components, Components, Any, Array]:
        """Points and inertia forces as three arrays (p,), which compile faster than (p, 3), their pull-back to q, and
        the resultant (3,) N.
        """
        place = self.inertia.points
        r, pull_back = jax.vjp(place, q)

        def moving(q: Array, qd: Array) -> Components:
            return jax.jvp(place, (q,), (qd,))[1]

        rd, rdd = jax.jvp(moving, (q, qd), (qd, qdd))
        turning = tuple(turned + 2 * v for turned, v in zip(cross(w, r), rd, strict=True))
        relative = tuple(map(sum, zip(cross(alpha, r), cross(w, turning), rdd, strict=True)))
        return r, self.inertia.forces(relative, a), pull_back, self.inertia.total(relative, a)

    def inside(self, q: Array, qd: Array) -> Array:
        """Elastic and damping forces on the coordinates, (n,)."""
        elastic = self.stiffness @ q if self.stiffness is not None else jax.grad(self.elasticity.energy)(q)
        return elastic + self.damping @ qd

    def generalised(self, q: Array, load_values: Array | None) -> Array:
        """Resultant of the loads at the root, then their forces on the coordinates, (6 + n,)."""
        if self.work is None or load_values is None:
            return jnp.zeros(6 + self.size)
        return self.work.generalised(q, load_values)


@record
class CompleteHub:
    """The equations of a free hub with a complete model on its rim, y = (θ, q)."""

    system: Complete
    mount: Any
    ground: Ground

    def residual(self, y: Array, yd: Array, ydd: Array, torque: Array, load_values: Array | None = None) -> Array:
        """Residual (n + 1,) of hub and beam under a torque on the hub, N m, and load components (loads, 6)."""
        q, qd, qdd = y[1:], yd[1:], ydd[1:]
        outward, onward, axis = self.mount.R_HB  # the hub's axes in those of the base
        a_x, a_y, a_z = self.mount.root_acceleration(y[0], yd[0], ydd[0])
        a = a_x * outward + a_y * onward + a_z * axis
        r, force, pull_back, resultant = self.system.inertia_forces(q, qd, qdd, a, yd[0] * axis, ydd[0] * axis)
        (beam,) = pull_back(force)
        beam = beam + self.system.inside(q, qd)
        # Of the forces about the axis: about the root, and of their resultant there, e × r_O being along y of the hub.
        about = sum(e * jnp.sum(moment) for e, moment in zip(axis, cross(r, force), strict=True))
        about = about + self.mount.radius * onward @ resultant
        turning = self.ground.torque(y[0], yd[0], ydd[0]) + about - torque
        if self.system.work is not None and load_values is not None:
            forces = self.system.generalised(q, load_values)
            turning, beam = turning - self._twist() @ forces[:6], beam - forces[6:]
        return jnp.concatenate([turning[None], beam])

    def about(self, c: Coefficients) -> FreeHub:
        """Put a linear model on the hub's rim."""
        return free_hub(c, self.mount, self.ground)

    def momentum(self, y: Array, yd: Array) -> Array:
        """Angular momentum of hub and beam about the axis, N m s."""
        inertia = self.system.inertia.inertia
        r, rd = jax.jvp(inertia.positions, (y[1:],), (yd[1:],))
        lever = jnp.cross(self.mount.R_HB[2], r + self.mount.radius * self.mount.R_HB[0])
        return self.ground.inertia * yd[0] + jnp.sum(inertia.mass[:, None] * lever * (lever * yd[0] + rd))

    def _twist(self) -> Array:
        return jnp.concatenate([self.mount.radius * jnp.asarray(self.mount.R_HB)[1], jnp.asarray(self.mount.R_HB)[2]])


@jax.jit
def paths(inertia: Any, field: Any, q: Any, qd: Any, qdd: Any) -> tuple[tuple[Any, Any, Any], tuple[Any, Any, Any]]:
    """Places, velocities and accelerations (t, p, 3) of particles and of a field's points over times, q, qd, qdd (t,
    n).
    """

    def place(q: Any) -> tuple[Any, Any]:
        return inertia.positions(q), field.position(q)

    def moving(q: Any, qd: Any) -> Any:
        return jax.jvp(place, (q,), (qd,))

    def at(q: Any, qd: Any, qdd: Any) -> Any:
        (r, rd), (_, rdd) = jax.jvp(moving, (q, qd), (qd, qdd))
        return tuple(zip(r, rd, rdd, strict=True))

    particles, points = jax.vmap(at)(q, qd, qdd)
    return particles, points
