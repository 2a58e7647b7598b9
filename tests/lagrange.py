"""Lagrange's equations by automatic differentiation of the kinetic energy: the tests' independent derivation.

T = ½ Σ m_k |v_O + ω × r_k + ṙ_k|² over the particles of a field, complete or truncated to second order in (q, q̇) by
differentiating it at rest. gbeam itself never writes T: its equations are D'Alembert's sum.

Programs are compiled to be compiled fast, not to run fast: each runs a few times only.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam import Structure
from gbeam.arrays import is_jax, namespace, record

from .differences import along, hessian, jacobian

Array = Any
PARTICLES = 160  # as many as any structure of the tests has here
quickly_compiled = partial(jax.jit, compiler_options={"xla_backend_optimization_level": 0})


@record
class Complete:
    """The complete kinetic energy of a structure's particles, and its strain energy."""

    structure: Structure

    @property
    def size(self) -> int:
        return self.structure.size

    def particles(self, q: Array) -> Array:
        return self.structure.particles.positions(q)

    @property
    def mass(self) -> Array:
        return self.structure.mass

    def kinetic(self, u: Array, q: Array, qd: Array) -> Array:
        """J; 2009 (9), 2020 (5). u = (v_O, ω)."""
        if is_jax(q) or is_jax(qd):
            r, rd = jax.jvp(self.particles, (q,), (qd,))
        else:
            r, rd = self.particles(q), along(self.particles, q, qd)
        return _half_m_v_squared(self.mass, u, r, rd)

    def potential(self, q: Array) -> Array:
        return 0.5 * q @ self.structure.coefficients.stiffness @ q


@record
class Quadratic:
    """T₂ = ½ uᵀ(A₀ + A₁q + ½ qA₂q) u + uᵀ(B₀ + B₁q) q̇ + ½ q̇ᵀM q̇, from differentiating T at rest."""

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
        xp = namespace(u, q, qd)
        a1 = xp.einsum("i,ijn,j->n", u, self.a1, u)
        a2 = xp.einsum("i,ijnm,j->nm", u, self.a2, u)
        b1 = xp.einsum("i,inm->nm", u, self.b1)
        base = u @ self.a0 @ u + a1 @ q + 0.5 * q @ a2 @ q
        return 0.5 * base + u @ self.b0 @ qd + q @ b1 @ qd + 0.5 * qd @ self.mass @ qd

    def potential(self, q: Array) -> Array:
        return 0.5 * q @ self.stiffness @ q


def _half_m_v_squared(mass: Array, u: Array, r: Array, rd: Array) -> Array:
    """T of particles with velocities v_O + ω × r + ṙ, J."""
    v = u[:3] + namespace(u, r).cross(u[3:], r) + rd
    return 0.5 * (mass[:, None] * v**2).sum()


@quickly_compiled
def _truncated(mass: Array, place: Array, slope: Array, bend: Array) -> tuple[Array, ...]:
    """A₀, A₁, A₂, B₀, B₁ and M of particles whose places are a polynomial of second degree."""
    zero = jnp.zeros(slope.shape[-1])

    def inertia(q: Array) -> Array:
        """The matrix of T in the rates (v_O, ω, q̇), which is its second derivative."""

        def kinetic(rates: Array) -> Array:
            r, rd = jax.jvp(lambda q: place + (slope + 0.5 * bend @ q) @ q, (q,), (rates[6:],))
            return _half_m_v_squared(mass, rates[:6], r, rd)

        return jax.jacfwd(jax.jacfwd(kinetic))(jnp.zeros(6 + len(zero)))

    def first(q: Array) -> Array:
        return jax.jacfwd(inertia)(q)

    whole, one, two = inertia(zero), first(zero), jax.jacfwd(first)(zero)
    return whole[:6, :6], one[:6, :6], two[:6, :6], whole[:6, 6:], jnp.swapaxes(one[:6, 6:], 1, 2), whole[6:, 6:]


def _with_massless(each: Array) -> np.ndarray:
    """Values of PARTICLES, the last of them without mass: one program serves all numbers of particles."""
    return np.concatenate([each, np.zeros((PARTICLES - len(each), *np.shape(each)[1:]))])


def second_order(energy: Complete) -> Quadratic:
    """Truncate a kinetic energy to second order in (q, q̇) by differentiating it at rest."""
    zero, particles = np.zeros(energy.size), energy.particles
    of_particles = energy.mass, particles(zero), jacobian(particles, zero), hessian(particles, zero)
    terms = _truncated(*(_with_massless(each) for each in of_particles))
    return Quadratic(*(np.asarray(x) for x in terms), hessian(energy.potential, zero))


def energy_of(structure: Structure) -> Complete | Quadratic:
    """The energy of a structure's model: complete, or truncated where the model is linear."""
    complete = Complete(structure)
    return second_order(complete) if structure.linear else complete


def _momentum_rates(energy: Any, u: Array, ud: Array, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array]:
    """d/dt ∂T/∂(v_O, ω), (6,), and d/dt ∂T/∂q̇ − ∂T/∂q + ∂U/∂q, (n,), as (v_O, ω, q̇) change by (u̇, q̈)."""
    (_, of_q, _), (base, _, beam) = jax.jvp(jax.grad(energy.kinetic, (0, 1, 2)), (u, q, qd), (ud, qd, qdd))
    return base, beam - of_q + jax.grad(energy.potential)(q)


momentum_rates = quickly_compiled(_momentum_rates)


def on_prescribed_base(
    energy: Any, damping: Array, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array
) -> np.ndarray:
    """Residual on a base whose motion is given: v_O = 0 with rate a_O."""
    u, ud = np.concatenate([np.zeros(3), w]), np.concatenate([a, alpha])
    return np.asarray(momentum_rates(energy, u, ud, q, qd, qdd)[1]) + damping @ qd


def twist(radius: float, R_HB: Array) -> np.ndarray:
    """(v_O, ω) in base axes of a hub that turns at 1 rad/s."""
    return np.concatenate([radius * R_HB[1], R_HB[2]])


def hub_kinetic(energy: Any, radius: float, inertia: float, R_HB: Array, y: Array, yd: Array) -> float:
    """Kinetic energy of hub and beam, y = (θ, q), J (2009 (9))."""
    return 0.5 * inertia * yd[0] ** 2 + energy.kinetic(twist(radius, R_HB) * yd[0], y[1:], yd[1:])


def on_free_hub(
    energy: Any, damping: Array, radius: float, inertia: float, R_HB: Array, y: Array, yd: Array, ydd: Array
) -> np.ndarray:
    """Residual of hub and beam without torque, y = (θ, q): T does not depend on θ."""
    per_rate = twist(radius, R_HB)
    base, beam = momentum_rates(energy, per_rate * yd[0], per_rate * ydd[0], y[1:], yd[1:], ydd[1:])
    return np.concatenate([[inertia * ydd[0] + per_rate @ base], beam + damping @ yd[1:]])


@quickly_compiled
def _derivatives(energy: Any) -> Any:
    q0, o = jnp.zeros(energy.size), jnp.zeros(3)

    def residual(q: Array, qd: Array, qdd: Array, a: Array, w: Array, al: Array) -> Array:
        u, ud = jnp.concatenate([jnp.zeros(3), w]), jnp.concatenate([a, al])
        return _momentum_rates(energy, u, ud, q, qd, qdd)[1]

    at_rest = (q0, q0, q0, o, o, o)
    first = jax.jacfwd(residual, (0, 2, 3, 5))(*at_rest)
    second = jax.jacfwd(jax.jacfwd(residual, (0, 1, 4)), (3, 4, 5))(*at_rest)
    return first, second, jax.jacfwd(jax.jacfwd(jax.jacfwd(residual, 0), 4), 4)(*at_rest)


def coefficients(energy: Quadratic) -> dict[str, np.ndarray]:
    """The constant coefficients of a linear model by differentiating Lagrange's residual at rest."""
    (k, m, f_a, f_al), (of_q, of_qd, of_w), k_ww = _derivatives(energy)

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
