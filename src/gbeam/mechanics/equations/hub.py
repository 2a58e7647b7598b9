"""A free hub with a beam on its rim: the hub's angle is one more coordinate, y = (θ, q).

D'Alembert's sum gains its moment about the hub's axis e. For a model whose places are a polynomial that moment is a
polynomial with constant tensors, which are contractions of the coefficients on a prescribed base with e and with the
root's place r_O on the rim: nothing is differentiated.
"""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.equations.linear import Coefficients, LoadTerms

Array = Any


@record
class Ground:
    """Inertia of the hub about its axis, kg m², and spring N m/rad and damper N m s/rad between it and the ground."""

    inertia: Array
    stiffness: Array
    damping: Array

    def torque(self, angle: Array, rate: Array, acceleration: Array) -> Array:
        """Torque that the hub itself takes, N m."""
        return self.inertia * acceleration + self.damping * rate + self.stiffness * angle


@record
class Weight:
    """Gravity (3,) at θ = 0 on hub and beam: the first moment of mass about the axis, S0 + S1 q + ½ q S2 q, base."""

    gravity: Array
    R_HB: Array
    s0: Array
    s1: Array
    s2: Array

    def forces(self, angle: Array, q: Array) -> tuple[Array, Array]:
        """Torque of gravity about the axis, N m, and its forces on the coordinates, (n,)."""
        xp = namespace(self.s0, angle, q)
        x, y, z = self.gravity
        c, s = xp.cos(angle), xp.sin(angle)
        g = xp.stack([c * x + s * y, c * y - s * x, z + 0 * c]) @ self.R_HB
        moment = self.s0 + self.s1 @ q + 0.5 * (self.s2 @ q) @ q
        ex, ey, ez = self.R_HB[2]
        mx, my, mz = moment
        across = xp.stack([ey * mz - ez * my, ez * mx - ex * mz, ex * my - ey * mx])  # e × S
        return across @ g, g @ (self.s1 + self.s2 @ q)


@record
class FreeHub:
    """Equations of a free hub and a beam whose places are a polynomial, 2009 (24)–(34): (J_h + J) θ̈ + 2 θ̇ (F2 − K2
    q)·q̇ + b·q̈ + q̇·B q̇ = torque, with J = J0 + 2 F2·q − q K2 q and b = b0 + B q, and M q̈ + (C + θ̇ G) q̇ + (K + θ̇²
    K2) q − θ̇² F2 + θ̈ b = 0; without `hub_force`, 2009 (32), the hub's row is that of SFOAM as printed, which
    conserves nothing.
    """

    mass: Array
    damping: Array
    stiffness: Array
    gyroscopic: Array
    k2: Array
    b1: Array
    f2: Array
    b0: Array
    rigid: Array
    ground: Ground
    twist: Array
    weight: Weight | None
    loads: LoadTerms | None
    hub_force: bool = static()

    def residual(self, y: Array, yd: Array, ydd: Array, torque: Array, load_values: Array | None = None) -> Array:
        """Residual (n + 1,) of hub and beam, y = (θ, q), under a torque on the hub, N m, and load components."""
        xp = namespace(self.mass, y, yd, ydd, torque, load_values)
        q, qd, qdd, rate, alpha = y[1:], yd[1:], ydd[1:], yd[0], ydd[0]
        # Products of constants with one vector stand together: one matrix product in a compiled step.
        elastic, k2q, b1q = _rows(xp, q, self.stiffness, self.k2, self.b1)
        damped, turned, b1qd = _rows(xp, qd, self.damping, self.gyroscopic, self.b1)
        swept, coupling = self.f2 - k2q, self.b0 + b1q
        turning = self.ground.torque(y[0], rate, alpha) - torque
        turning = turning + (self.rigid + (self.f2 + swept) @ q) * alpha + coupling @ qdd
        if self.hub_force:
            turning = turning + 2 * rate * (swept @ qd) + qd @ b1qd
        beam = self.mass @ qdd + damped + rate * turned + elastic - rate**2 * swept + alpha * coupling
        if self.weight is not None:
            about, along = self.weight.forces(y[0], q)
            turning, beam = turning - about, beam - along
        if self.loads is not None and load_values is not None:
            forces = self.loads.generalised(q, load_values)
            turning, beam = turning - self.twist @ forces[:6], beam - forces[6:]
        return xp.concatenate([xp.reshape(turning, (1,)), beam])

    def momentum(self, y: Array, yd: Array) -> Array:
        """Angular momentum of hub and beam about the axis, N m s."""
        q, qd, rate = y[1:], yd[1:], yd[0]
        inertia = self.ground.inertia + self.rigid + (2 * self.f2 - self.k2 @ q) @ q
        return inertia * rate + (self.b0 + self.b1 @ q) @ qd


def _rows(xp: Any, vector: Array, *matrices: Array) -> Any:
    """Products of some (n, n) matrices with a vector, (n,) each."""
    return xp.reshape(xp.concatenate(matrices) @ vector, (len(matrices), -1))


def free_hub(c: Coefficients, mount: Any, ground: Ground, *, hub_force: bool = True) -> FreeHub:
    """Contract the coefficients of a linear model with a hub's axis and the root's place."""
    xp = namespace(c.mass, mount.radius, mount.R_HB)
    radius, R_HB = mount.radius, xp.asarray(mount.R_HB)
    root, along, e = radius * R_HB[0], radius * R_HB[1], R_HB[2]  # r_O, e × r_O, e
    ee = e[:, None] * e[None, :]

    k2 = xp.tensordot(ee, c.k_ww, 2) - xp.tensordot(root, c.k_a, 1)
    f2 = xp.tensordot(ee, c.f_ww, 2) - root @ c.f_a
    b1 = xp.tensordot(e, c.k_al, 1) + xp.tensordot(along, c.k_a, 1)
    b0 = -(e @ c.f_al + along @ c.f_a)
    m, first, (xx, yy, zz, xy, yz, zx) = c.rigid[0], c.rigid[1:4], c.rigid[4:]
    second = xp.stack([xp.stack([xx, xy, zx]), xp.stack([xy, yy, yz]), xp.stack([zx, yz, zz])])
    # Σ m |e × (r_O + r0)|²; r_O is square to e.
    rigid = m * radius**2 + 2 * (root @ first) + xx + yy + zz - e @ second @ e
    weight = None
    if mount.gravity is not None:
        weight = Weight(xp.asarray(mount.gravity), R_HB, m * root + first, -c.f_a, c.k_a)
    return FreeHub(
        mass=c.mass,
        damping=c.damping,
        stiffness=c.stiffness,
        gyroscopic=xp.tensordot(e, c.gyroscopic, 1),
        k2=k2,
        b1=b1,
        f2=f2,
        b0=b0,
        rigid=rigid,
        ground=ground,
        twist=xp.concatenate([along, e]),
        weight=weight,
        loads=c.loads,
        hub_force=hub_force,
    )


def ground_of(hub: Any) -> Ground:
    """The ground of a free hub of :mod:`gbeam.motion`."""
    return Ground(hub.inertia, hub.stiffness, hub.damping)
