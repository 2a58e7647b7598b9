"""Equations of motion as an integrator sees them, linear or a residual, and the coordinates over time that it gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.tree import record

Array = Any
Floats = NDArray[np.float64]
Drive = Callable[[Array], Any]  # times (t,) -> what drives the equations there, arrays with that leading axis


@record
class LinearTerms:
    """C, K (k, n, n) and F (k, n) as sums over features φ of the inputs, such as C = Σ φ_k C_k."""

    velocity: Array
    stiffness: Array
    force: Array

    @property
    def each(self) -> tuple[Array, Array, Array]:
        """Terms of C, of K and of F."""
        return self.velocity, self.stiffness, self.force

    @property
    def nonzero(self) -> tuple[Array, Array, Array]:
        """Flags of the terms of C, K and F that are not zero, (k,) each."""
        c, k, f = (np.any(np.reshape(part, (len(part), -1)), axis=1) for part in self.each)
        return c, k, f


@dataclass(frozen=True, eq=False)
class LinearEquations:
    """M q̈ + C(t) q̇ + K(t) q = F(t): `matrices` maps inputs at times (t,) to C, K, F; `terms` and `features` give the
    same as sums; to `rest`, symmetric C and K, steps are fitted.
    """

    mass: Array
    matrices: Callable[[Any], tuple[Array, Array, Array]]
    drive: Drive
    terms: Callable[[], LinearTerms] | None = None
    features: Callable[[Any], Array] | None = None
    rest: tuple[Array, Array] | None = None


@dataclass(frozen=True, eq=False)
class NonlinearEquations:
    """r(q, q̇, q̈; inputs(t)) = 0, (..., n), analytic and linear in q̈; leading axes of its arguments are broadcast. Its
    arrays are arguments of a compiled program.
    """

    residual: Any
    drive: Drive
    controllers: Any = None
    samplings: Any = None


@dataclass(frozen=True)
class Trajectory:
    """Coordinates (t, n) over time (t,), as far as the integration got before it failed or was stopped."""

    time: Floats
    q: Any
    qd: Any
    qdd: Any
    converged: bool = True
    stopped: bool = False

    @property
    def whole(self) -> bool:
        """Whether it came to its end."""
        return self.converged and not self.stopped

    def at(self, steps: Any) -> Trajectory:
        """The trajectory at some of its steps."""
        return replace(self, time=self.time[steps], q=self.q[steps], qd=self.qd[steps], qdd=self.qdd[steps])
