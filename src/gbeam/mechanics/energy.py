"""One kinetic energy of a displacement field on a moving base, and its truncation to second order.

T = ½ Σ m_k |v_O + ω × r_k + ṙ_k|² over particles: the beam's quadrature points and the attached bodies. The base
twist is u = (v_O, ω), base axes. Every model is such an energy; none has equations of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Protocol

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.mechanics.field import Coordinates, Field, Points, Strains

Twist = Float[Array, "6"]


class Energy(Protocol):
    """Kinetic and potential energy of the beam in its coordinates, on a base with a given twist."""

    @property
    def size(self) -> int:
        """Number of coordinates."""
        ...

    def kinetic(self, u: Twist, q: Coordinates, qd: Coordinates) -> Float[Array, ""]:
        """Kinetic energy, J."""
        ...

    def potential(self, q: Coordinates) -> Float[Array, ""]:
        """Strain energy, J."""
        ...

    def mass_and_moment(self, q: Coordinates) -> tuple[Float[Array, ""], Float[Array, 3]]:
        """Mass, kg, and its first moment Σ m r about the root, base axes, kg m: what gravity acts on."""
        ...


class FieldEnergy(eqx.Module):
    """The complete kinetic energy of a field.

    Parameters
    ----------
    field : Field
        Its points are the particles' stations.
    station : (particles,) index of each particle's point in the field
    mass : (particles,) kg
    offset : (particles, 3) m, from the beam's axis in section axes; None where all particles lie on the axis
    rigidity : (g,) each, EA N, EI_y and EI_z N m² times the quadrature weights, N m and N m³; and the root's springs
    """

    field: Field
    station: Array
    mass: Float[Array, " particles"]
    offset: Float[Array, "particles 3"] | None
    rigidity: Strains
    size: int = eqx.field(static=True)

    def particles(self, q: Coordinates) -> Points:
        """Positions of the particles, base axes, (particles, 3) m."""
        r = self.field.position(q)[self.station]
        if self.offset is None:
            return r
        return r + jnp.einsum("kij,kj->ki", self.field.rotation(q)[self.station], self.offset)

    def kinetic(self, u: Twist, q: Coordinates, qd: Coordinates) -> Float[Array, ""]:
        """Kinetic energy, J (2009 (9), 2020 (5))."""
        v = _velocities(self.particles, q, jnp.concatenate([u, qd]))
        return 0.5 * jnp.sum(self.mass[:, None] * v**2)

    def potential(self, q: Coordinates) -> Float[Array, ""]:
        """Energy of beam and root's springs, ½ ∫ EA ε² + EI_y κ_y² + EI_z κ_z² dx + ½ Σ k s², J.

        2009 (10); 2020 (8), corrected.
        """
        pairs = zip(self.rigidity, self.field.strains(q), strict=True)
        return 0.5 * sum((jnp.sum(k * e**2) for k, e in pairs), start=jnp.zeros(()))

    def mass_and_moment(self, q: Coordinates) -> tuple[Float[Array, ""], Float[Array, 3]]:
        """Mass, kg, and its first moment about the root, base axes, kg m."""
        return jnp.sum(self.mass), self.mass @ self.particles(q)


def _velocities(particles: Callable[[Coordinates], Points], q: Coordinates, rates: Array) -> Points:
    """Velocities v_O + ω × r + ṙ of particles, linear in the rates (v_O, ω, q̇), (particles, 3) m/s."""
    r, rd = jax.jvp(particles, (q,), (rates[6:],))
    return rates[:3] + jnp.cross(rates[3:6], r) + rd


class QuadraticEnergy(eqx.Module):
    """A kinetic energy truncated to second order in (q, q̇); the base twist is never truncated.

    T₂ = ½ uᵀ(A₀ + A₁q + ½ qA₂q) u + uᵀ(B₀ + B₁q) q̇ + ½ q̇ᵀM q̇. The coefficients are found once, so that nothing is
    integrated along the beam inside a time step.
    """

    a0: Float[Array, "6 6"]
    a1: Float[Array, "6 6 n"]
    a2: Float[Array, "6 6 n n"]
    b0: Float[Array, "6 n"]
    b1: Float[Array, "6 n n"]
    mass: Float[Array, "n n"]
    stiffness: Float[Array, "n n"]

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.mass.shape[0]

    def kinetic(self, u: Twist, q: Coordinates, qd: Coordinates) -> Float[Array, ""]:
        """Kinetic energy, J."""
        # Contracted with u first: what is left has the size of the beam's own matrices.
        a1 = jnp.einsum("i,ijn,j->n", u, self.a1, u)
        a2 = jnp.einsum("i,ijnm,j->nm", u, self.a2, u)
        b1 = jnp.einsum("i,inm->nm", u, self.b1)
        base = u @ self.a0 @ u + a1 @ q + 0.5 * q @ a2 @ q
        return 0.5 * base + u @ self.b0 @ qd + q @ b1 @ qd + 0.5 * qd @ self.mass @ qd

    def potential(self, q: Coordinates) -> Float[Array, ""]:
        """Strain energy, J."""
        return 0.5 * q @ self.stiffness @ q

    def mass_and_moment(self, q: Coordinates) -> tuple[Float[Array, ""], Float[Array, 3]]:
        """Mass, kg, and its first moment about the root, base axes, kg m, truncated as T is."""
        # The linear momentum of a base that turns at 1 rad/s: ω × Σ m r.
        a = self.a0[:3] + self.a1[:3] @ q + 0.5 * self.a2[:3] @ q @ q
        return a[0, 0], jnp.stack([a[1, 5], -a[0, 5], -a[1, 3]])


@eqx.filter_jit
def rest_matrices(energy: Energy) -> tuple[Float[Array, "n n"], Float[Array, "n n"]]:
    """Mass and stiffness matrices of the undeformed beam on a base at rest."""
    zero = jnp.zeros(energy.size)
    return jax.hessian(energy.kinetic, 2)(jnp.zeros(6), zero, zero), jax.hessian(energy.potential)(zero)


@eqx.filter_jit
def second_order(energy: FieldEnergy) -> QuadraticEnergy:
    """Truncate a kinetic energy to second order in (q, q̇) by differentiating it at rest."""
    zero, rates = jnp.zeros(energy.size), jnp.zeros(6 + energy.size)
    # The derivatives wanted see no more of the places than their Taylor polynomial: quicker to differentiate.
    place, slope = energy.particles(zero), jax.jacfwd(energy.particles)(zero)
    bend = jax.jacfwd(jax.jacfwd(energy.particles))(zero)

    def inertia(q: Coordinates) -> Array:
        """The matrix of T, half a sum of squares of the velocities, in the rates (v_O, ω, q̇)."""
        per_rate = jax.jacfwd(partial(_velocities, lambda q: place + (slope + 0.5 * bend @ q) @ q, q))(rates)
        return jnp.einsum("kai,k,kaj->ij", per_rate, energy.mass, per_rate)

    whole, first, second = inertia(zero), jax.jacfwd(inertia)(zero), jax.jacfwd(jax.jacfwd(inertia))(zero)
    return QuadraticEnergy(
        a0=whole[:6, :6],
        a1=first[:6, :6],
        a2=second[:6, :6],
        b0=whole[:6, 6:],
        b1=jnp.swapaxes(first[:6, 6:], 1, 2),
        mass=whole[6:, 6:],
        stiffness=jax.hessian(energy.potential)(zero),
    )
