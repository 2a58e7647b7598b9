"""Equations of motion as an integrator sees them, linear or a residual, with its derivatives, and their run.

A residual is analytic, and its arrays and what drives it may have leading axes, which are broadcast. The first one is
that of the steps. So complex steps give its derivatives at many states in one call: nothing is compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import each_leaf, record
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.numerics.series import STEP

Drive = Callable[[Array], Any]  # times (t,) -> what drives the equations there, arrays with that leading axis


@record
class LinearTerms:
    """Terms of C, K (k, n, n) and F (k, n), which are sums over features φ of the inputs, such as C = Σ φ_k C_k."""

    velocity: Array
    stiffness: Array
    force: Array

    @property
    def arrays(self) -> tuple[Array, Array, Array]:
        """Terms of C, of K and of F."""
        return self.velocity, self.stiffness, self.force

    def evaluate(self, features: Array) -> tuple[Array, Array, Array]:
        """Return C, K (..., n, n) and F (..., n) at features (..., k). Missing ones at the end count as zero."""
        xp, count = namespace(features, self.force), features.shape[-1]

        def combined(terms: Array) -> Array:
            sums = features @ xp.reshape(terms[:count], (count, -1))
            return xp.reshape(sums, (*sums.shape[:-1], *terms.shape[1:]))

        return combined(self.velocity), combined(self.stiffness), combined(self.force)

    @property
    def nonzero(self) -> tuple[Array, Array, Array]:
        """Flags of the terms of C, K and F that are not zero, (k,) each."""
        c, k, f = (np.any(np.reshape(part, (len(part), -1)), axis=1) for part in self.arrays)
        return c, k, f


@dataclass(frozen=True, eq=False)
class LinearEquations:
    """Linear equations M q̈ + C(t) q̇ + K(t) q = F(t).

    `matrices` maps inputs at times (t,) to C, K and F. `terms` and `features` give the same as sums. Steps are fitted
    to `rest`, symmetric C and K.
    """

    mass: Array
    matrices: Callable[[Any], tuple[Array, Array, Array]]
    drive: Drive
    terms: LinearTerms | None = None
    features: Callable[[Any], Array] | None = None
    rest: tuple[Array, Array] | None = None

    def accelerations(self, q: Array, qd: Array, inputs: Any) -> Array:
        """Accelerations q̈ (t, n) that satisfy the equations at q, q̇ (t, n) and inputs (t, ...)."""
        pieces = []
        for q_piece, qd_piece, inputs_piece in _pieces(q.shape[1], q, qd, inputs):
            c, k, f = self.matrices(inputs_piece)
            force = f - (k @ q_piece[..., None] + c @ qd_piece[..., None])[..., 0]
            pieces.append(solve_systems(self.mass, force.T).T)
        return namespace(*pieces).concatenate(pieces)


@dataclass(frozen=True, eq=False)
class NonlinearEquations:
    """Equations r(q, q̇, q̈; inputs(t)) = 0, (..., n), whose residual is analytic, and linear in q̈.

    Leading axes of the residual's arguments are broadcast, and its arrays are arguments of a compiled program. Steps
    are fitted to its modes at q = 0 under `idle_inputs` of one time (1, ...), which drive nothing. These are None
    where the equations have other modes elsewhere.
    """

    residual: Any
    drive: Drive
    controllers: Any = None
    idle_inputs: Any = None

    def accelerations(self, q: Array, qd: Array, inputs: Any) -> Array:
        """Accelerations q̈ (t, n) that satisfy the equations at q, q̇ (t, n) and inputs (t, ...)."""
        return accelerations(exact_residual(self.residual), q, qd, inputs)


@record
class Fitted:
    """A residual with terms added to M and C (n, n), to which steps are fitted, and the `exact` one without."""

    exact: Any
    mass: Array
    damping: Array

    def __call__(self, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
        """Residual (..., n)."""
        return self.exact(q, qd, qdd, inputs) + (qdd @ self.mass + qd @ self.damping)


def exact_residual(residual: Any) -> Any:
    """Return a residual without the terms that fit steps."""
    return residual.exact if isinstance(residual, Fitted) else residual


@dataclass(frozen=True)
class Trajectory:
    """Coordinates q, qd (t, n) over time (t,), as far as the integration got before it failed or was stopped.

    Accelerations that the scheme does not have at the ends of steps are computed when they are asked for. `samples`
    are those of the controllers in the loop.
    """

    time: Floats
    q: Any
    qd: Any
    known: Any  # q̈ (t, n), or a function that computes it at times of indices (k,)
    converged: bool = True
    stopped: bool = False
    samples: Any = None

    @property
    def reached_end(self) -> bool:
        """True if the integration reached the end of its steps."""
        return self.converged and not self.stopped

    @property
    def failure(self) -> ComputationError | None:
        """Error of a controller's law that ended the integration, or None if none did."""
        return None if self.samples is None or self.samples.failure is None else self.samples.failure[1]

    @property
    def qdd(self) -> Any:
        """Accelerations (t, n)."""
        return self.known(np.arange(len(self.time))) if callable(self.known) else self.known

    def select(self, steps: Any) -> Trajectory:
        """Return the trajectory at the times that `steps`, indices or a slice, chooses."""
        accelerations, index = self.known, np.arange(len(self.time))[steps]
        chosen = (lambda part: accelerations(index[part])) if callable(accelerations) else accelerations[steps]
        return replace(self, time=self.time[steps], q=self.q[steps], qd=self.qd[steps], known=chosen)


AT_ONCE = 5_000  # numbers of the states that are evaluated at once: of more, all sections of beams fill memory
HUGE = 2.0**100  # an acceleration beside which no other force is felt: mass times it is all of them
FEWEST = 50  # states evaluated at once: of fewer, each call costs more than its sums


def slopes(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> Array:
    """Derivatives (3, t, r, n) of a function (t, r) by q, q̇, q̈ (t, n), of a residual K, C, M, at inputs (t, ...)."""
    return values_and_slopes(residual, q, qd, qdd, inputs)[1]


def values_and_slopes(residual: Any, q: Array, qd: Array, qdd: Array, inputs: Any) -> tuple[Array, Array]:
    """Return values (t, r) of a function and its derivatives, as of :func:`slopes`, from the same evaluations.

    Each coordinate of q, q̇ and q̈ takes a complex step of its own: Im f(x + i h) / h is the derivative.
    """
    n, pieces = q.shape[1], []
    steps = 1j * STEP * np.eye(3 * n).reshape(3 * n, 1, 3, n)
    for *state, inputs_piece in _pieces(n**2, q, qd, qdd, inputs):
        stepped_state = (values + steps[:, :, k] for k, values in enumerate(state))
        pieces.append(residual(*stepped_state, inputs_piece))
    joined = np.concatenate(pieces, axis=1)
    value = joined[0].real if n else residual(q, qd, qdd, inputs)
    return value, (joined.imag / STEP).reshape(3, n, len(q), joined.shape[-1]).transpose(0, 2, 3, 1)


def masses(residual: Any, q: Array, qd: Array, inputs: Any) -> Array:
    """Mass matrices M (t, n, n) of equations linear in q̈, at q, q̇ (t, n) and inputs (t, ...)."""
    count, n = q.shape
    if not n:  # all motion is prescribed
        return np.zeros((count, 0, 0))
    steps = np.repeat(1j * STEP * np.eye(n)[:, None], count, axis=1)
    return np.moveaxis(residual(q, qd, steps, inputs).imag / STEP, 0, 2)


def accelerations(residual: Any, q: Array, qd: Array, inputs: Any) -> Array:
    """q̈ (t, n) that satisfies equations linear in q̈ at q, q̇ (t, n) and inputs (t, ...), or NaN where M is singular.

    The residual without acceleration is the force, and one of a huge unit acceleration is a column of M.
    """
    pieces, n = [], q.shape[1]
    units = HUGE * np.eye(n + 1, n, k=-1)[:, None]  # no acceleration, and one of each coordinate alone
    for q_piece, qd_piece, inputs_piece in _pieces(n, q, qd, inputs):
        forces = residual(q_piece, qd_piece, np.broadcast_to(units, (n + 1, *q_piece.shape)), inputs_piece)
        mass = forces[1:].transpose(1, 2, 0) / HUGE
        pieces.append(solve_systems(mass, -forces[0][..., None])[..., 0])
    return np.concatenate(pieces)


class Demanded:
    """Accelerations (t, n) that equations demand of a run at its start and at the ends of its kept steps.

    Each is computed when it is first asked for, under the commands of the `samples` of controllers, if there are any.
    """

    def __init__(self, equations: Any, steps: Any, q: Any, qd: Any, samples: Any = None) -> None:
        """Prepare the inputs. Commands act in the step that ends at a time, and none acts at the start."""
        self.equations, self.q, self.qd = equations, q, qd
        self.time = np.append(steps.drive_begin[:1], steps.end[steps.kept])
        self.held = None
        if samples is not None:
            held = samples.held
            self.held = np.concatenate([0 * held[:1], held[steps.kept]])
        self.values, self.computed = np.zeros(q.shape), np.zeros(len(q), dtype=bool)

    def __call__(self, index: Any) -> Any:
        """Accelerations (k, n) at the times of indices (k,), computed where they have not been asked for before."""
        uncomputed = np.unique(index[~self.computed[index]])
        if len(uncomputed):
            inputs = self.equations.drive(self.time[uncomputed])
            if self.held is not None:
                inputs = self.equations.controllers.add_commands(inputs, self.held[uncomputed])
            self.values[uncomputed] = self.equations.accelerations(self.q[uncomputed], self.qd[uncomputed], inputs)
            self.computed[uncomputed] = True
        return self.values[index]


def _pieces(numbers: int, *parts: Any) -> list[Any]:
    """Cut arrays and records (t, ...) along time into pieces that fit memory, where each time needs so many `numbers`.

    Arrays of JAX stay whole.
    """
    count, size = len(parts[0]), max(FEWEST, AT_ONCE // max(numbers, 1))
    if count <= size or is_jax(parts[0]):
        return [parts]
    pieces = [slice(first, first + size) for first in range(0, count, size)]
    return [each_leaf(lambda leaf, piece=piece: leaf[piece], parts) for piece in pieces]  # type: ignore[misc]


def solve_systems(matrix: Array, right_side: Array) -> Array:
    """Solve linear systems. A solution is NaN where its matrix is singular: there NumPy would refuse all systems."""
    try:
        return namespace(matrix, right_side).linalg.solve(matrix, right_side)
    except np.linalg.LinAlgError:
        if matrix.ndim == 2:
            return np.full_like(right_side, np.nan)
        return np.stack([solve_systems(*pair) for pair in zip(matrix, right_side, strict=True)])
