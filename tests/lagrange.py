"""Lagrange's equations by automatic differentiation of the kinetic energy: the tests' independent derivation.

T = ½ Σ m_k |v_O + ω × r_k + ṙ_k|² over the particles of a field, complete or truncated to second order in (q, q̇) by
differentiating it at rest. gbeam itself never writes T: its equations are D'Alembert's sum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam import Structure
from gbeam.arrays.tree import record

Array = Any


@record
class Complete:
    """The complete kinetic energy of a field, and its strain energy."""

    inertia: Any
    elasticity: Any

    @property
    def size(self) -> int:
        slopes = self.inertia.field.strain_slopes()
        return int(slopes.axial.shape[1])

    def particles(self, q: Array) -> Array:
        return self.inertia.positions(q)

    @property
    def mass(self) -> Array:
        return self.inertia.mass

    def kinetic(self, u: Array, q: Array, qd: Array) -> Array:
        """J; 2009 (9), 2020 (5). u = (v_O, ω)."""
        v = velocities(self.particles, q, jnp.concatenate([u, qd]))
        return 0.5 * jnp.sum(self.mass[:, None] * v**2)

    def potential(self, q: Array) -> Array:
        return self.elasticity.energy(q)


@record
class Quadratic:
    """T₂ = ½ uᵀ(A₀ + A₁q + ½ qA₂q) u + uᵀ(B₀ + B₁q) q̇ + ½ q̇ᵀM q̇, found by differentiating T at rest."""

    a0: Array
    a1: Array
    a2: Array
    b0: Array
    b1: Array
    mass: Array
    stiffness: Array

    @property
    def size(self) -> int:
        return int(self.mass.shape[0])

    def kinetic(self, u: Array, q: Array, qd: Array) -> Array:
        a1 = jnp.einsum("i,ijn,j->n", u, self.a1, u)
        a2 = jnp.einsum("i,ijnm,j->nm", u, self.a2, u)
        b1 = jnp.einsum("i,inm->nm", u, self.b1)
        base = u @ self.a0 @ u + a1 @ q + 0.5 * q @ a2 @ q
        return 0.5 * base + u @ self.b0 @ qd + q @ b1 @ qd + 0.5 * qd @ self.mass @ qd

    def potential(self, q: Array) -> Array:
        return 0.5 * q @ self.stiffness @ q


def velocities(particles: Callable[[Array], Array], q: Array, rates: Array) -> Array:
    """Velocities v_O + ω × r + ṙ of particles, linear in the rates (v_O, ω, q̇), (particles, 3) m/s."""
    r, rd = jax.jvp(particles, (q,), (rates[6:],))
    return rates[:3] + jnp.cross(rates[3:6], r) + rd


@jax.jit
def second_order(energy: Complete) -> Quadratic:
    """Truncate a kinetic energy to second order in (q, q̇) by differentiating it at rest."""
    zero, rates = jnp.zeros(energy.size), jnp.zeros(6 + energy.size)
    place, slope = energy.particles(zero), jax.jacfwd(energy.particles)(zero)
    bend = jax.jacfwd(jax.jacfwd(energy.particles))(zero)

    def inertia(q: Array) -> Array:
        """The matrix of T, half a sum of squares of the velocities, in the rates (v_O, ω, q̇)."""

        def polynomial(q: Array) -> Array:
            return place + (slope + 0.5 * bend @ q) @ q

        per_rate = jax.jacfwd(lambda rates: velocities(polynomial, q, rates))(rates)
        return jnp.einsum("kai,k,kaj->ij", per_rate, energy.mass, per_rate)

    whole, first, second = inertia(zero), jax.jacfwd(inertia)(zero), jax.jacfwd(jax.jacfwd(inertia))(zero)
    return Quadratic(
        a0=whole[:6, :6],
        a1=first[:6, :6],
        a2=second[:6, :6],
        b0=whole[:6, 6:],
        b1=jnp.swapaxes(first[:6, 6:], 1, 2),
        mass=whole[6:, 6:],
        stiffness=jax.hessian(energy.potential)(zero),
    )


def energy_of(structure: Structure) -> Complete | Quadratic:
    """The energy of a structure's model: complete, or truncated where the model is linear."""
    complete = Complete(structure.inertia, structure.elasticity)
    return second_order(complete) if structure.linear else complete


@jax.jit
def kinetic(energy: Any, u: Array, q: Array, qd: Array) -> Array:
    """T, J, compiled."""
    return energy.kinetic(u, q, qd)


@jax.jit
def rest_matrices(energy: Any) -> tuple[Array, Array]:
    """Mass and stiffness matrices of the undeformed beam on a base at rest."""
    zero = jnp.zeros(energy.size)
    return jax.hessian(energy.kinetic, 2)(jnp.zeros(6), zero, zero), jax.hessian(energy.potential)(zero)


@dataclass(frozen=True)
class Hub:
    """A hub's numbers as T needs them; R_HB from base axes to hub axes."""

    radius: float
    inertia: float
    R_HB: Array
    stiffness: float = 0.0
    damping: float = 0.0


@jax.jit
def on_prescribed_base(
    energy: Any, damping: Array, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array
) -> Array:
    """d/dt ∂T/∂q̇ − ∂T/∂q + Cq̇ + ∂U/∂q on a base whose motion is given: v_O = 0 with rate a_O."""
    u, ud = jnp.concatenate([jnp.zeros(3), w]), jnp.concatenate([a, alpha])
    _, momentum_rate = jax.jvp(jax.grad(energy.kinetic, 2), (u, q, qd), (ud, qd, qdd))
    return momentum_rate - jax.grad(energy.kinetic, 1)(u, q, qd) + damping @ qd + jax.grad(energy.potential)(q)


def hub_kinetic(energy: Any, radius: Array, inertia: Array, R_HB: Array, y: Array, yd: Array) -> Array:
    """Kinetic energy of hub and beam, y = (θ, q), J (2009 (9))."""
    twist = jnp.concatenate([radius * R_HB[1], R_HB[2]]) * yd[0]
    return 0.5 * inertia * yd[0] ** 2 + energy.kinetic(twist, y[1:], yd[1:])


@jax.jit
def on_free_hub(
    energy: Any, damping: Array, radius: Array, inertia: Array, R_HB: Array, y: Array, yd: Array, ydd: Array
) -> Array:
    """Residual of hub and beam without torque, y = (θ, q)."""

    def kinetic(y: Array, yd: Array) -> Array:
        return hub_kinetic(energy, radius, inertia, R_HB, y, yd)

    _, momentum_rate = jax.jvp(jax.grad(kinetic, 1), (y, yd), (yd, ydd))
    elastic = damping @ yd[1:] + jax.grad(energy.potential)(y[1:])
    return momentum_rate - jax.grad(kinetic)(y, yd) + jnp.concatenate([jnp.zeros(1), elastic])


def coefficients(energy: Any, size: int) -> dict[str, np.ndarray]:
    """The constant coefficients of a linear model by differentiating Lagrange's residual at rest."""
    q0, o, none = jnp.zeros(size), jnp.zeros(3), jnp.zeros((size, size))

    @jax.jit
    def derivatives(energy: Any) -> Any:
        def residual(q: Array, qd: Array, qdd: Array, a: Array, w: Array, al: Array) -> Array:
            return on_prescribed_base(energy, none, q, qd, qdd, a, w, al)

        at_rest = (q0, q0, q0, o, o, o)
        first = jax.jacfwd(residual, (0, 2, 3, 5))(*at_rest)
        second = jax.jacfwd(jax.jacfwd(residual, (0, 1, 4)), (3, 4, 5))(*at_rest)
        return first, second, jax.jacfwd(jax.jacfwd(jax.jacfwd(residual, 0), 4), 4)(*at_rest)

    (k, m, f_a, f_al), (of_q, of_qd, of_w), k_ww = derivatives(energy)

    def front(a: Array, base_axes: int) -> np.ndarray:
        """Move the base's axes, which differentiation puts last, to the front."""
        return np.moveaxis(np.asarray(a), tuple(range(-base_axes, 0)), tuple(range(base_axes)))

    return {
        "mass": np.asarray(m),
        "stiffness": np.asarray(k),
        "gyroscopic": front(of_qd[1], 1),
        "k_ww": front(k_ww, 2) / 2,
        "k_al": front(of_q[2], 1),
        "k_a": front(of_q[0], 1),
        "f_ww": -front(of_w[1], 2) / 2,
        "f_al": -front(f_al, 1),
        "f_a": -front(f_a, 1),
    }
