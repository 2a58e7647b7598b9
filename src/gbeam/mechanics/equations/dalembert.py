"""The equations of a complete model (CFOAM, fourth-order, exact): D'Alembert's sum over the particles of its field.

Σ m (∂r/∂q)·a + K q + C q̇ = Q. All arrays may have leading axes: at one instant the sums are compiled by JAX for time
steps, over many they are NumPy's. With a beam on the rim of a free hub the hub's angle is one more coordinate,
y = (θ, q), whose row is the moment of the same forces about the hub's axis e. For a model whose places are a polynomial
that moment is a polynomial with constant tensors, which are contractions of the coefficients on a prescribed base with
e and with the root's place r_O on the rim: nothing is differentiated. Residuals r(y, ẏ, ÿ; inputs) of all models on a
given base and on a free hub have one form.
"""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import Array, concatenated, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.equations.inertia import Inertia
from gbeam.mechanics.equations.linear import Bending, Coefficients, LoadTerms
from gbeam.mechanics.equations.virtual_work import LoadWork
from gbeam.motion.hub import Mount
from gbeam.results.parts import Base


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
    """Gravity (3,), hub's axes at θ = 0, m/s², and the beam's first moment of mass about the hub's axis, in axes of
    the base, S0 + S1 q + ½ q S2 q, kg m; R_HB (3, 3) turns from the base to the hub.
    """

    gravity: Array
    R_HB: Array
    s0: Array
    s1: Array
    s2: Array

    def forces(self, angle: Array, q: Array) -> tuple[Array, Array]:
        """Torque (...) of gravity about the axis, N m, and its forces on the coordinates, (..., n)."""
        xp = namespace(self.s0, angle, q)
        x, y, z = self.gravity
        c, s = xp.cos(angle), xp.sin(angle)
        g = xp.stack([c * x + s * y, c * y - s * x, z + 0 * c], axis=-1) @ self.R_HB
        slope = self.s1 + xp.einsum("aij,...j->...ai", self.s2, q)
        moment = self.s0 + ((self.s1 + slope) / 2 * q[..., None, :]).sum(axis=-1)
        across = xp.cross(self.R_HB[2], moment)  # e × S
        return _dot(across, g), (g[..., :, None] * slope).sum(axis=-2)


@record
class FreeHub:
    """Equations of a free hub and a beam whose places are a polynomial, 2009 (24)–(34), with J = J0 + 2 F2·q − q K2 q
    and b = b0 + B q: (J_h + J) θ̈ + 2 θ̇ (F2 − K2 q)·q̇ + b·q̈ + q̇·B q̇ = torque of the hub, and
    M q̈ + (C + θ̇ G) q̇ + (K + θ̇² K2) q − θ̇² F2 + θ̈ b = 0 of the beam. Without `hub_force` the hub's row is that of
    SFOAM as printed, 2009 (32), which conserves nothing.
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
    bending: Bending | None = None

    def residual(self, y: Array, yd: Array, ydd: Array, torque: Array, load_values: Array | None = None) -> Array:
        """Residual (..., n + 1) of y = (θ, q) under a torque on the hub, N m, and load components (..., loads, 6)."""
        (angle, q), (rate, qd), (alpha, qdd) = ((each[..., 0], each[..., 1:]) for each in (y, yd, ydd))
        # Products of constants with one vector stand together: one matrix product in a compiled step.
        elastic, k2q, b1q = _rows(q, self.stiffness, self.k2, self.b1)
        damped, turned, b1qd = _rows(qd, self.damping, self.gyroscopic, self.b1)
        swept, coupling = self.f2 - k2q, self.b0 + b1q
        turning = self.ground.torque(angle, rate, alpha) - torque
        turning = turning + (self.rigid + _dot(self.f2 + swept, q)) * alpha + _dot(coupling, qdd)
        if self.hub_force:
            turning = turning + 2 * rate * _dot(swept, qd) + _dot(qd, b1qd)
        rate, alpha = rate[..., None], alpha[..., None]
        beam = qdd @ self.mass + damped + rate * turned + elastic - rate**2 * swept + alpha * coupling
        if self.bending is not None:
            beam = beam + self.bending.forces(q)
        if self.weight is not None:
            about, along = self.weight.forces(angle, q)
            turning, beam = turning - about, beam - along
        if self.loads is not None and load_values is not None:
            forces = self.loads.generalised(q, load_values)
            turning, beam = turning - forces[..., :6] @ self.twist, beam - forces[..., 6:]
        return concatenated([turning[..., None], beam])


def _rows(vector: Array, *matrices: Array) -> Any:
    """Products (..., n) of each of the (n, n) matrices with vectors (..., n)."""
    products, n = vector @ namespace(*matrices).concatenate(matrices).T, len(matrices[0])
    return tuple(products[..., k * n : (k + 1) * n] for k in range(len(matrices)))


def _dot(left: Array, right: Array) -> Array:
    return (left * right).sum(axis=-1)


def free_hub(c: Coefficients, mount: Any, ground: Ground, *, hub_force: bool = True) -> FreeHub:
    """Contract a linear model's coefficients with a hub's axis and the root's place (`mount`) to its free hub's."""
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
        bending=c.bending,
    )


def ground_of(hub: Any) -> Ground:
    """The ground of a free hub of :mod:`gbeam.motion`."""
    return Ground(hub.inertia, hub.stiffness, hub.damping)


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
        """Residual (..., n) under a base's acceleration (specific force), angular rate and acceleration (..., 3)."""
        return self.demanded(q, qd, qdd, a_WO_B, w_WB_B, alpha_WB_B, load_values)[0]

    def demanded(
        self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array, loads: Array | None
    ) -> tuple[Array, Array, Array]:
        """Forces on the coordinates (..., n), and force N and moment N m at the root (..., 3), that a motion demands,
        less those of the loads.
        """
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
        _, tangential, axis = self.mount.R_HB  # the hub's axes in those of the base
        base = self.mount.base(angle, rate, change)
        motion = base.a_WO_B, base.w_WB_B, base.alpha_WB_B
        beam, force, moment = self.system.demanded(q, qd, qdd, *motion, load_values)
        # About the root, and of the resultant there, e × r_O being along y of the hub.
        about = moment @ axis + self.mount.radius * (force @ tangential)
        turning = self.ground.torque(angle, rate, change) + about - torque
        return concatenated([turning[..., None], beam])

    def about(self, c: Coefficients) -> FreeHub:
        """Equations of the same hub with a linear model on its rim."""
        return free_hub(c, self.mount, self.ground)


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
