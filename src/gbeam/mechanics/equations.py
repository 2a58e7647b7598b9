"""Lagrange's equations of an energy, by automatic differentiation; the constant coefficients of a linear model.

A residual is zero where the equations hold. Nothing here knows which model it differentiates.
"""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.mechanics.energy import Energy
from gbeam.mechanics.field import Coordinates
from gbeam.mechanics.virtual_work import Applied, Work

Vector = Float[Array, "3"]
Matrix = Float[Array, "n n"]


class Damped(eqx.Module):
    """An energy with its linear damping matrix, N s per unit of the coordinates, and the work of the loads on it.

    `applied` (loads, 6) holds the loads at the time in question; None, as `work`, where there are none.
    """

    energy: Energy
    damping: Matrix
    work: Work | None = None
    applied: Applied | None = None

    def under(self, applied: Applied | None) -> Damped:
        """The same system under other loads."""
        return Damped(self.energy, self.damping, self.work, applied)

    def generalised(self, q: Coordinates) -> Float[Array, " n_6"]:
        """Loads: their resultant at the root, N and N m, base axes, then the forces on the coordinates, (6 + n,)."""
        if self.work is None or self.applied is None:
            return jnp.zeros(6 + self.damping.shape[0])
        return self.work.generalised(q, self.applied)


def on_prescribed_base(
    system: Damped,
    q: Coordinates,
    qd: Coordinates,
    qdd: Coordinates,
    a_WO_B: Vector,
    w_WB_B: Vector,
    alpha_WB_B: Vector,
) -> Coordinates:
    """Residual d/dt ∂T/∂q̇ − ∂T/∂q + Cq̇ + ∂U/∂q − Q on a base whose motion is given, (n,).

    Only the root's acceleration matters, so v_O = 0 with rate a_O. A specific force a − g in its place puts gravity on.

    Parameters
    ----------
    q, qd, qdd : (n,) coordinates and their rates
    a_WO_B : (3,) acceleration of the root, base axes, m/s²
    w_WB_B, alpha_WB_B : (3,) angular velocity and acceleration of the base, base axes, rad/s, rad/s²
    """
    kinetic = system.energy.kinetic
    u = jnp.concatenate([jnp.zeros(3), w_WB_B])
    ud = jnp.concatenate([a_WO_B, alpha_WB_B])
    _, momentum_rate = jax.jvp(jax.grad(kinetic, 2), (u, q, qd), (ud, qd, qdd))
    inertial = momentum_rate - jax.grad(kinetic, 1)(u, q, qd)
    return inertial + system.damping @ qd + jax.grad(system.energy.potential)(q) - system.generalised(q)[6:]


class Hub(eqx.Module):
    """A rigid hub that turns about z of its own axes H, the beam's root on its x axis.

    Parameters
    ----------
    radius : m, to the root
    inertia : kg m², about the axis
    R_HB : (3, 3)
        From base axes to hub axes: how the beam is mounted.
    stiffness, damping : N m/rad, N m s/rad
        Torsional spring and damper to the ground; the spring is at ease at θ = 0.
    gravity : (3,) or None
        Acceleration of free fall, m/s², in hub axes at θ = 0.
    """

    radius: Float[Array, ""] = eqx.field(converter=jnp.asarray)
    inertia: Float[Array, ""] = eqx.field(converter=jnp.asarray)
    R_HB: Float[Array, "3 3"] = eqx.field(converter=jnp.asarray, default_factory=lambda: jnp.eye(3))
    stiffness: Float[Array, ""] = eqx.field(converter=jnp.asarray, default=0.0)
    damping: Float[Array, ""] = eqx.field(converter=jnp.asarray, default=0.0)
    gravity: Vector | None = None

    def twist(self, rate: Float[Array, ""]) -> Float[Array, 6]:
        """Twist (v_O, ω) of the root at a hub rate, base axes."""
        return jnp.concatenate([self.radius * self.R_HB[1], self.R_HB[2]]) * rate

    def potential(self, energy: Energy, y: Array) -> Float[Array, ""]:
        """Energy of the hub's spring, and of hub and beam in gravity, y = (θ, q), J."""
        spring = 0.5 * self.stiffness * y[0] ** 2
        if self.gravity is None:
            return spring
        mass, moment = energy.mass_and_moment(y[1:])
        centre = self.R_HB @ moment + jnp.stack([mass * self.radius, 0 * mass, 0 * mass])
        c, s = jnp.cos(y[0]), jnp.sin(y[0])
        turned = jnp.stack([c * centre[0] - s * centre[1], s * centre[0] + c * centre[1], centre[2]])
        return spring - self.gravity @ turned


def hub_kinetic(energy: Energy, hub: Hub, y: Array, yd: Array) -> Float[Array, ""]:
    """Kinetic energy of hub and beam, y = (θ, q), J (2009 (9))."""
    return 0.5 * hub.inertia * yd[0] ** 2 + energy.kinetic(hub.twist(yd[0]), y[1:], yd[1:])


def on_free_hub(
    system: Damped,
    hub: Hub,
    y: Float[Array, " n_1"],
    yd: Float[Array, " n_1"],
    ydd: Float[Array, " n_1"],
    torque: Float[Array, ""],
    *,
    hub_force: bool = True,
) -> Float[Array, " n_1"]:
    """Residual of hub and beam, y = (θ, q), under a torque on the hub, (n + 1,).

    Parameters
    ----------
    y, yd, ydd : (n + 1,) hub angle rad and beam coordinates, with their rates
    torque : N m
    hub_force : whether the hub feels Q_θ, the terms of its row that are quadratic in the rates (2009 (32)); the
        printed SFOAM drops them and then conserves nothing
    """

    def inertial(yd: Array) -> Array:
        def kinetic(y: Array, yd: Array) -> Array:
            return hub_kinetic(system.energy, hub, y, yd)

        _, momentum_rate = jax.jvp(jax.grad(kinetic, 1), (y, yd), (yd, ydd))
        return momentum_rate - jax.grad(kinetic)(y, yd)

    residual = inertial(yd)
    if not hub_force:
        residual = residual.at[0].set(inertial(jnp.zeros_like(yd))[0])
    loads, unit = system.generalised(y[1:]), hub.twist(jnp.ones(()))
    elastic = system.damping @ yd[1:] + jax.grad(system.energy.potential)(y[1:]) - loads[6:]
    outside = torque - hub.damping * yd[0] + unit @ loads[:6]
    ground = jax.grad(lambda y: hub.potential(system.energy, y))(y)
    return residual + ground + jnp.concatenate([-outside[None], elastic])


class Coefficients(eqx.Module):
    """Constant coefficients of a linear model on a prescribed base.

    M q̈ + (C + ω·G) q̇ + (K + ωω:K_ww + α·K_al + a·K_a) q = ωω:F_ww + α·F_al + a·F_a.
    K_ww and F_ww are symmetric in their first two axes. 2020 (16), (20)–(22); 2009 (24)–(34).
    Loads p (loads, 6) add p·K_p to the stiffness and p·F_p to the right-hand side; `applied` are those of the system.
    """

    mass: Matrix
    damping: Matrix
    gyroscopic: Float[Array, "3 n n"]
    stiffness: Matrix
    k_ww: Float[Array, "3 3 n n"]
    k_al: Float[Array, "3 n n"]
    k_a: Float[Array, "3 n n"]
    f_ww: Float[Array, "3 3 n"]
    f_al: Float[Array, "3 n"]
    f_a: Float[Array, "3 n"]
    k_p: Float[Array, "loads 6 n n"] | None = None
    f_p: Float[Array, "loads 6 n"] | None = None
    applied: Applied | None = None

    def at(
        self, a_WO_B: Vector, w_WB_B: Vector, alpha_WB_B: Vector, applied: Applied | None = None
    ) -> tuple[Matrix, Matrix, Coordinates]:
        """C + G, K and F at a base motion, under the loads `applied` or, without, those of the system."""
        w2 = w_WB_B[:, None] * w_WB_B[None, :]
        velocity = self.damping + jnp.einsum("i,inm->nm", w_WB_B, self.gyroscopic)
        stiffness = (
            self.stiffness
            + jnp.einsum("ij,ijnm->nm", w2, self.k_ww)
            + jnp.einsum("i,inm->nm", alpha_WB_B, self.k_al)
            + jnp.einsum("i,inm->nm", a_WO_B, self.k_a)
        )
        load = jnp.einsum("ij,ijn->n", w2, self.f_ww) + alpha_WB_B @ self.f_al + a_WO_B @ self.f_a
        p = self.applied if applied is None else applied
        if p is not None and self.k_p is not None and self.f_p is not None:
            stiffness = stiffness + jnp.einsum("li,linm->nm", p, self.k_p)
            load = load + jnp.einsum("li,lin->n", p, self.f_p)
        return velocity, stiffness, load


@eqx.filter_jit
def coefficients(system: Damped) -> Coefficients:
    """Find the constant coefficients of a linear model by differentiating its residual at rest.

    The result is the whole truth for an energy truncated to second order; for a complete one it is the linearisation
    about the straight beam.
    """
    n = system.damping.shape[0]
    q0, o = jnp.zeros(n), jnp.zeros(3)
    unloaded = system.under(None)
    k_p = f_p = None
    if system.work is not None and system.applied is not None:

        def force(q: Array, p: Array) -> Array:
            return system.under(p).generalised(q)[6:]

        f_p = jnp.moveaxis(jax.jacfwd(force, 1)(q0, 0 * system.applied), 0, -1)
        k_p = -jnp.moveaxis(jax.jacfwd(jax.jacfwd(force, 1))(q0, 0 * system.applied), (1, 2), (0, 1))

    def residual(q: Array, qd: Array, qdd: Array, a: Array, w: Array, al: Array) -> Array:
        return on_prescribed_base(unloaded, q, qd, qdd, a, w, al)

    first = jax.jacfwd(residual, (0, 2, 3, 5))
    second = jax.jacfwd(jax.jacfwd(residual, (0, 1, 4)), (3, 4, 5))
    third = jax.jacfwd(jax.jacfwd(jax.jacfwd(residual, 0), 4), 4)
    at_rest = (q0, q0, q0, o, o, o)
    (k, m, f_a, f_al), (of_q, of_qd, of_w), k_ww = first(*at_rest), second(*at_rest), third(*at_rest)

    def last_first(a: Array, base_axes: int) -> Array:
        """Move the base's axes, which differentiation puts last, to the front."""
        return jnp.moveaxis(a, tuple(range(-base_axes, 0)), tuple(range(base_axes)))

    return Coefficients(
        mass=m,
        damping=system.damping,
        gyroscopic=last_first(of_qd[1], 1),
        stiffness=k,
        k_ww=last_first(k_ww, 2) / 2,
        k_al=last_first(of_q[2], 1),
        k_a=last_first(of_q[0], 1),
        f_ww=-last_first(of_w[1], 2) / 2,
        f_al=-last_first(f_al, 1),
        f_a=-last_first(f_a, 1),
        k_p=k_p,
        f_p=f_p,
        applied=system.applied,
    )
