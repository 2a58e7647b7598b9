"""Second-order systems as an integrator sees them: the acceleration that satisfies the equations of motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

import gbeam._jax  # noqa: F401

Vector = Float[Array, " n"]
Stages = Float[Array, "stages n"]
Weights = Float[Array, "stages stages"]


class State(NamedTuple):
    """Coordinates, velocities, accelerations, and the scheme's own acceleration (equal to them in Newmark's)."""

    q: Vector
    qd: Vector
    qdd: Vector
    a: Vector

    @classmethod
    def rest(cls, q: Vector) -> State:
        """At rest at q."""
        return cls(q, 0 * q, 0 * q, 0 * q)


class System(Protocol):
    """Equations of motion r(q, q̇, q̈; inputs(t)) = 0."""

    def inputs(self, t: Float[Array, " times"]) -> Any:
        """What drives the system at times t, s: a pytree with leading axis `times`."""
        ...

    def acceleration(
        self, q: Vector, qd: Vector, cq: Array | float, cv: Array | float, inputs: Any, guess: Vector
    ) -> tuple[Vector, Bool[Array, ""]]:
        """Solve r(q + cq q̈, q̇ + cv q̈, q̈; inputs) = 0 for q̈ from a guess; the flag says whether that succeeded."""
        ...

    def stages(
        self, q: Stages, qd: Stages, cq: Weights, cv: Weights, inputs: tuple[Any, ...], guess: Stages
    ) -> tuple[Stages, Bool[Array, ""]]:
        """Solve r(qᵢ + Σ cqᵢⱼ q̈ⱼ, q̇ᵢ + Σ cvᵢⱼ q̈ⱼ, q̈ᵢ; inputsᵢ) = 0 for the accelerations of coupled stages."""
        ...


class LinearSystem(eqx.Module):
    """M q̈ + C(t) q̇ + K(t) q = F(t).

    Parameters
    ----------
    mass : (n, n)
    matrices : callable
        Inputs at one time -> C, K, F.
    drive : callable
        Times (k,) -> inputs, a pytree with leading axis k.
    """

    mass: Float[Array, "n n"]
    matrices: Callable[[Any], tuple[Array, Array, Array]]
    drive: Callable[[Array], Any]

    def inputs(self, t: Float[Array, " times"]) -> Any:
        """What drives the system."""
        return self.drive(t)

    def acceleration(
        self, q: Vector, qd: Vector, cq: Array | float, cv: Array | float, inputs: Any, guess: Vector
    ) -> tuple[Vector, Bool[Array, ""]]:
        """One linear solve."""
        c, k, f = self.matrices(inputs)
        qdd = jnp.linalg.solve(self.mass + cv * c + cq * k, f - k @ q - c @ qd)
        return qdd, jnp.array(True)

    def stages(
        self, q: Stages, qd: Stages, cq: Weights, cv: Weights, inputs: tuple[Any, ...], guess: Stages
    ) -> tuple[Stages, Bool[Array, ""]]:
        """One linear solve for all stages."""
        rows, right, every = [], [], range(len(inputs))
        for i in every:
            c, k, f = self.matrices(inputs[i])
            rows.append([(i == j) * self.mass + cv[i, j] * c + cq[i, j] * k for j in every])
            right.append(f - k @ q[i] - c @ qd[i])
        return jnp.linalg.solve(jnp.block(rows), jnp.concatenate(right)).reshape(q.shape), jnp.array(True)


class NonlinearSystem(eqx.Module):
    """r(q, q̇, q̈; inputs) = 0, solved by Newton's method.

    Parameters
    ----------
    residual : callable
        (q, q̇, q̈, inputs at one time) -> (n,).
    drive : callable
        Times (k,) -> inputs, a pytree with leading axis k.
    tolerance : float
        Newton stops when its correction is below this fraction of the accelerations.
    iterations : int
        Newton gives up after so many.
    """

    residual: Callable[[Vector, Vector, Vector, Any], Vector]
    drive: Callable[[Array], Any]
    tolerance: float = 1e-9
    iterations: int = eqx.field(static=True, default=25)

    def inputs(self, t: Float[Array, " times"]) -> Any:
        """What drives the system."""
        return self.drive(t)

    def acceleration(
        self, q: Vector, qd: Vector, cq: Array | float, cv: Array | float, inputs: Any, guess: Vector
    ) -> tuple[Vector, Bool[Array, ""]]:
        """Newton's method."""
        return self._newton(lambda qdd: self.residual(q + cq * qdd, qd + cv * qdd, qdd, inputs), guess)

    def stages(
        self, q: Stages, qd: Stages, cq: Weights, cv: Weights, inputs: tuple[Any, ...], guess: Stages
    ) -> tuple[Stages, Bool[Array, ""]]:
        """Newton's method for all stages at once."""
        together = jax.tree.map(lambda *x: jnp.stack(x), *inputs)

        def residual(flat: Array) -> Array:
            qdd = flat.reshape(guess.shape)
            return jax.vmap(self.residual)(q + cq @ qdd, qd + cv @ qdd, qdd, together).ravel()

        flat, ok = self._newton(residual, guess.ravel())
        return flat.reshape(guess.shape), ok

    def _newton(self, residual: Callable[[Array], Array], guess: Array) -> tuple[Array, Bool[Array, ""]]:
        """Solve for accelerations; the Jacobian is renewed every fifth iteration."""

        def factor(qdd: Array) -> tuple[Array, Array]:
            return jax.scipy.linalg.lu_factor(jax.jacfwd(residual)(qdd))

        def go_on(carry: tuple[Any, ...]) -> Array:
            _, _, size, scale, count = carry
            return (size > self.tolerance * scale) & (count < self.iterations)

        def iterate(carry: tuple[Any, ...]) -> tuple[Any, ...]:
            qdd, lu, _, _, count = carry
            lu = jax.lax.cond(count % 5 == 0, factor, lambda _: lu, qdd)
            correction = jax.scipy.linalg.lu_solve(lu, residual(qdd))
            qdd = qdd - correction
            # An error in q̈ matters as it moves q: measure against what the step itself can move.
            return qdd, lu, jnp.max(jnp.abs(correction)), 1.0 + jnp.max(jnp.abs(qdd)), count + 1

        n = guess.shape[0]
        unset = (jnp.eye(n), jnp.arange(n, dtype=jnp.int32))
        start = (guess, unset, jnp.array(jnp.inf), jnp.array(1.0), jnp.array(0))
        qdd, _, size, scale, _ = jax.lax.while_loop(go_on, iterate, start)
        return qdd, size <= self.tolerance * scale
