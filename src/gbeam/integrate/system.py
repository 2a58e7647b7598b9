"""Second-order systems as an integrator sees them: the acceleration that satisfies the equations of motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

import gbeam.arrays.jax_setup  # noqa: F401

Vector = Float[Array, " n"]
Stages = Float[Array, "stages n"]
Weights = Float[Array, "stages stages"]
_ROUNDING = 1e3  # times the tolerance: what the rounding of stiff modes may leave of a correction


class State(NamedTuple):
    """Coordinates, velocities, accelerations, and the scheme's own acceleration (equal to them in Newmark's).

    `memory` is what the system wants to be given again in the next step.
    """

    q: Vector
    qd: Vector
    qdd: Vector
    a: Vector
    memory: Any = ()

    @classmethod
    def rest(cls, q: Vector) -> State:
        """At rest at q."""
        return cls(q, 0 * q, 0 * q, 0 * q)


class System(Protocol):
    """Equations of motion r(q, q̇, q̈; inputs(t)) = 0."""

    def inputs(self, t: Float[Array, " times"]) -> Any:
        """What drives the system at times t, s: a pytree with leading axis `times`."""
        ...

    def blank(self, size: int) -> Any:
        """Memory of a solution for `size` accelerations that has not been asked for yet."""
        ...

    def acceleration(
        self, q: Vector, qd: Vector, cq: Array | float, cv: Array | float, inputs: Any, guess: Vector, memory: Any
    ) -> tuple[Vector, Bool[Array, ""], Any]:
        """Solve r(q + cq q̈, q̇ + cv q̈, q̈; inputs) = 0 for q̈ from a guess.

        The flag says whether that succeeded; the memory is that of the last such solution with like cq and cv.
        """
        ...

    def stages(
        self, q: Stages, qd: Stages, cq: Weights, cv: Weights, inputs: tuple[Any, ...], guess: Stages, memory: Any
    ) -> tuple[Stages, Bool[Array, ""], Any]:
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

    def blank(self, size: int) -> tuple[()]:
        """Nothing to remember."""
        return ()

    def acceleration(
        self, q: Vector, qd: Vector, cq: Array | float, cv: Array | float, inputs: Any, guess: Vector, memory: tuple[()]
    ) -> tuple[Vector, Bool[Array, ""], tuple[()]]:
        """One linear solve."""
        c, k, f = self.matrices(inputs)
        qdd = jnp.linalg.solve(self.mass + cv * c + cq * k, f - k @ q - c @ qd)
        return qdd, jnp.array(True), ()

    def stages(
        self, q: Stages, qd: Stages, cq: Weights, cv: Weights, inputs: tuple[Any, ...], guess: Stages, memory: tuple[()]
    ) -> tuple[Stages, Bool[Array, ""], tuple[()]]:
        """One linear solve for all stages."""
        rows, right, every = [], [], range(len(inputs))
        for i in every:
            c, k, f = self.matrices(inputs[i])
            rows.append([(i == j) * self.mass + cv[i, j] * c + cq[i, j] * k for j in every])
            right.append(f - k @ q[i] - c @ qd[i])
        qdd = jnp.linalg.solve(jnp.block(rows), jnp.concatenate(right)).reshape(q.shape)
        return qdd, jnp.array(True), ()


class Factored(NamedTuple):
    """A Jacobian as its LU factors, and whether there is one yet."""

    lu: Array
    pivots: Array
    known: Bool[Array, ""]


class NonlinearSystem(eqx.Module):
    """r(q, q̇, q̈; inputs) = 0, solved by Newton's method.

    Parameters
    ----------
    residual : callable
        (q, q̇, q̈, inputs at one time) -> (n,).
    drive : callable
        Times (k,) -> inputs, a pytree with leading axis k.
    tolerance : float
        Newton stops when its correction is below this fraction of the accelerations, or no longer falls and below a
        thousand times that: the rounding of stiff modes.
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

    def blank(self, size: int) -> Factored:
        """No Jacobian yet."""
        return Factored(jnp.eye(size), jnp.arange(size, dtype=jnp.int32), jnp.array(False))

    def acceleration(
        self, q: Vector, qd: Vector, cq: Array | float, cv: Array | float, inputs: Any, guess: Vector, memory: Factored
    ) -> tuple[Vector, Bool[Array, ""], Factored]:
        """Newton's method."""
        return self._newton(lambda qdd: self.residual(q + cq * qdd, qd + cv * qdd, qdd, inputs), guess, memory)

    def stages(
        self, q: Stages, qd: Stages, cq: Weights, cv: Weights, inputs: tuple[Any, ...], guess: Stages, memory: Factored
    ) -> tuple[Stages, Bool[Array, ""], Factored]:
        """Newton's method for all stages at once."""
        together = jax.tree.map(lambda *x: jnp.stack(x), *inputs)

        def residual(flat: Array) -> Array:
            qdd = flat.reshape(guess.shape)
            return jax.vmap(self.residual)(q + cq @ qdd, qd + cv @ qdd, qdd, together).ravel()

        flat, ok, memory = self._newton(residual, guess.ravel(), memory)
        return flat.reshape(guess.shape), ok, memory

    def _newton(
        self, residual: Callable[[Array], Array], guess: Array, memory: Factored
    ) -> tuple[Array, Bool[Array, ""], Factored]:
        """Solve for accelerations with the last Jacobian, renewed where three iterations do not suffice."""

        def factor(qdd: Array) -> Factored:
            lu, pivots = jax.scipy.linalg.lu_factor(jax.jacfwd(residual)(qdd))
            return Factored(lu, pivots, jnp.array(True))

        def go_on(carry: tuple[Any, ...]) -> Array:
            _, _, size, before, scale, count = carry
            stalled = (size > before / 2) & (size <= _ROUNDING * self.tolerance * scale)
            return (size > self.tolerance * scale) & ~stalled & (count < self.iterations)

        def iterate(carry: tuple[Any, ...]) -> tuple[Any, ...]:
            qdd, last, before, _, _, count = carry
            last = jax.lax.cond(~last.known | (count % 4 == 3), factor, lambda _: last, qdd)
            correction = jax.scipy.linalg.lu_solve((last.lu, last.pivots), residual(qdd))
            qdd = qdd - correction
            # An error in q̈ matters as it moves q: measure against what the step itself can move.
            return qdd, last, jnp.max(jnp.abs(correction)), before, 1.0 + jnp.max(jnp.abs(qdd)), count + 1

        start = (guess, memory, jnp.array(jnp.inf), jnp.array(jnp.inf), jnp.array(1.0), jnp.array(0))
        qdd, last, size, _, scale, _ = jax.lax.while_loop(go_on, iterate, start)
        return qdd, size <= _ROUNDING * self.tolerance * scale, last
