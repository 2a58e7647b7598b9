"""Integration schemes as data: Newmark, HHT-α, generalised-α, and the two-stage Gauss method.

A step carries z, m vectors of n numbers (for Gauss q and q̇). Its s stages solve the equations of motion for their
accelerations x at positions and velocities

    q_i = Σ w_q[i, k] z_k + Σ c_q[i, j] x_j,    v_i = Σ w_v[i, k] z_k + Σ c_v[i, j] x_j,

and the next z is g z + d x. The one-step family has the form of Arnold and Brüls (2007): the equations hold exactly at
the end of each step, and a second acceleration a carries the weights, (1−α_m) a₊ + α_m a = (1−α_f) q̈₊ + α_f q̈. That is
the classical scheme for linear systems and second order for configuration-dependent mass as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import holds_jax
from gbeam.arrays.tree import record
from gbeam.arrays.types import Complex, Floats
from gbeam.errors import InputError
from gbeam.integrate.equations import Fitted, LinearEquations, NonlinearEquations, slopes
from gbeam.numerics.eigen import symmetric, symmetric_modes


@record
class Tableau:
    """Coefficients of a scheme at one length of step, or at several on a leading axis.

    Those of the stages are w (s, m) and c (s, s), those of the next z are g (m, m) and d (m, s). `end_z` (2, m) and
    `end_x` (2, s) give q and q̇ at the end of a step, `initial` (m, 3) gives z from q, q̇ and q̈ at the start.
    """

    w_q: Floats
    w_v: Floats
    c_q: Floats
    c_v: Floats
    g: Floats
    d: Floats
    end_z: Floats
    end_x: Floats
    initial: Floats

    def jacobians(self, k: Any, c: Any, m: Any) -> tuple[Any, Any]:
        """Derivatives of the residuals of a step's stages, from K, C and M (1 or t, s, n, n) at the stages.

        J (t, s n, s n) are those with respect to the stages' accelerations, L (t, s n, m n) to the state z before.
        """
        k, c, m = (slope[:, :, None] for slope in (k, c, m))
        c_q, c_v, w_q, w_v = (weights[..., None, None] for weights in (self.c_q, self.c_v, self.w_q, self.w_v))
        (*_, stages, states), n = self.w_q.shape, k.shape[-1]
        # Blocks of stage i and of stage j or vector k; then the axes (t, i, j, n, n) become those of a matrix.
        by_stage = c_q * k + c_v * c + np.eye(stages)[..., None, None] * m
        by_state = w_q * k + w_v * c
        J = by_stage.swapaxes(2, 3).reshape(-1, stages * n, stages * n)
        L = by_state.swapaxes(2, 3).reshape(-1, stages * n, states * n)
        return J, L


@dataclass(frozen=True, eq=False)
class Scheme:
    """An integration scheme with stages at `offsets` of a step; `exponent`, z -> μ with R(μ) = e^z, fits steps of
    linear equations.
    """

    name: str
    order: int
    offsets: tuple[float, ...]
    unit: Tableau
    exponent: Callable[[Complex], Complex] | None = None

    @property
    def ends(self) -> bool:
        """True if the last stage is the end of the step, so that the equations hold there with its acceleration."""
        return self.offsets[-1] == 1.0

    def tableau(self, step: Any) -> Tableau:
        """Tableau of steps of a length, s, or of several (t,)."""
        h = np.asarray(step, dtype=np.float64)[..., None, None]
        return Tableau(**{name: unit * h**power for name, (unit, power) in self._powers.items()})

    @cached_property
    def _powers(self) -> dict[str, tuple[Floats, Any]]:
        powers = powers_of_step(*self.unit.d.shape)
        return {name: (getattr(self.unit, name), power.astype(np.float64)) for name, power in powers.items()}


def powers_of_step(m: int, stages: int) -> dict[str, NDArray[np.int64]]:
    """Powers, −2 to 2, with which the arrays of a tableau grow with the length of the step. z = (q*, v*, c) and (q, q̇,
    q̈) are of orders 0, 1, 2 in 1/step.
    """
    k, pair, x = np.arange(m), np.arange(2)[:, None], np.full(stages, 2)
    return {
        "w_q": np.tile(k, (stages, 1)),
        "w_v": np.tile(k - 1, (stages, 1)),
        "c_q": np.full((stages, stages), 2),
        "c_v": np.full((stages, stages), 1),
        "g": k - k[:, None],
        "d": x - k[:, None],
        "end_z": k - pair,
        "end_x": x - pair,
        "initial": np.arange(3) - k[:, None],
    }


@cache
def _one_step(name: str, alpha_m: float, alpha_f: float, beta: float, gamma: float) -> Scheme:
    """Make a scheme of the one-step family. alpha_m and alpha_f are the weights of the old acceleration and of the old
    forces (Chung and Hulbert), beta and gamma Newmark's parameters.
    """
    share = (1 - alpha_f) / (1 - alpha_m)
    # z = (q*, v*, c): what the stage starts from, and the share c of the new a that is known before.
    q, v, c, x = np.eye(4)  # all below are coefficients of these
    a = c + share * x
    q_new, v_new = q + beta * share * x, v + gamma * share * x
    carried = (alpha_f * x - alpha_m * a) / (1 - alpha_m)
    rows = np.stack(
        [
            q_new + v_new + (0.5 - beta) * a + beta * carried,
            v_new + (1 - gamma) * a + gamma * carried,
            carried,
        ]
    )
    share_known = (alpha_f - alpha_m) / (1 - alpha_m)
    first = np.array(
        [
            [1.0, 1.0, (0.5 - beta) + beta * share_known],
            [0.0, 1.0, (1 - gamma) + gamma * share_known],
            [0.0, 0.0, share_known],
        ]
    )
    # Newmark's scheme carries nothing.
    m = 3 if alpha_m or alpha_f else 2
    c_q, c_v = np.array([[beta * share]]), np.array([[gamma * share]])
    unit = Tableau(
        w_q=np.eye(1, m),
        w_v=np.eye(1, m, k=1),
        c_q=c_q,
        c_v=c_v,
        g=rows[:m, :m],
        d=rows[:m, 3:],
        end_z=np.eye(2, m),
        end_x=np.concatenate([c_q, c_v]),
        initial=first[:m],
    )
    return Scheme(name, 2, (1.0,), unit)


def newmark(beta: float = 0.25, gamma: float = 0.5) -> Scheme:
    """Newmark (1959). The defaults are the average acceleration: no damping, unconditionally stable."""
    if not (gamma >= 0.5 and 2 * beta >= gamma):
        raise InputError(
            "beta",
            f"is {beta:g} with gamma {gamma:g}",
            "2 beta >= gamma >= 1/2 is stable at every step; try 0.25 and 0.5",
        )
    return _one_step("newmark", 0.0, 0.0, beta, gamma)


def hht(alpha: float) -> Scheme:
    """Hilber, Hughes and Taylor (1977): alpha from −1/3 to 0, more damping the lower."""
    if not -1 / 3 <= alpha <= 0:
        raise InputError("alpha", f"is {alpha:g}", "give a value from -1/3 to 0")
    return _one_step("hht", 0.0, -alpha, (1 - alpha) ** 2 / 4, 0.5 - alpha)


def generalized_alpha(rho_inf: float) -> Scheme:
    """Chung and Hulbert (1993): spectral radius rho_inf at infinite frequency, 0 (most damping) to 1."""
    if not 0 <= rho_inf <= 1:
        raise InputError("rho_inf", f"is {rho_inf:g}", "give a value from 0 to 1")
    alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma = 0.5 - alpha_m + alpha_f
    return _one_step("generalized-alpha", alpha_m, alpha_f, (gamma + 0.5) ** 2 / 4, gamma)


@cache
def gauss() -> Scheme:
    """The two-stage Gauss method: order 4, no damping, unconditionally stable (Hairer, Nørsett and Wanner, II.7)."""
    root = 3**0.5 / 6
    a = np.array([[0.25, 0.25 - root], [0.25 + root, 0.25]])
    c = np.array([0.5 - root, 0.5 + root])

    g, d = np.array([[1.0, 1.0], [0.0, 1.0]]), np.stack([0.5 * (1 - c), np.full(2, 0.5)])
    unit = Tableau(
        w_q=np.stack([np.ones(2), c], axis=1),
        w_v=np.array([[0.0, 1.0], [0.0, 1.0]]),
        c_q=a @ a,
        c_v=a,
        g=g,
        d=d,
        end_z=g,
        end_x=d,
        initial=np.eye(2, 3),
    )
    return Scheme("gauss", 4, (float(c[0]), float(c[1])), unit, _gauss_exponent)


def _gauss_exponent(z: Complex) -> Complex:
    """Solve R(μ) = (12 + 6μ + μ²)/(12 − 6μ + μ²) = e^z."""
    half = np.tanh(z / 2)
    return 12 * half / (3 + np.sqrt(9 - 12 * half**2))


# A scheme multiplies a vibration e^λt by R(λh) in a step h, which is e^λh to its order only: lightly damped, it is
# delayed more with every cycle. With μ/h in place of λ, R(μ) = e^λh, it keeps its time. Mass and damping change so;
# stiffness and forces stay, and with them slow deflections. The changes are of the scheme's order in h, and so is the
# error that remains: exponentially fitted (Gautschi, 1961).
FITTED = 2.0  # rad in a step, up to which a mode is fitted; a faster one takes what that one does


def fitting_terms(equations: LinearEquations, scheme: Scheme, step: float) -> tuple[Floats, Floats]:
    """Matrices (n, n) that fit steps of a length, s, to the modes when added to M and C.

    They are zero for a scheme that does not fit its steps.
    """
    if scheme.exponent is None or equations.rest is None:
        nothing = np.zeros(np.shape(equations.mass))
        return nothing, nothing
    return to_modes(scheme.exponent, step, equations.mass, *equations.rest)


def fitted_residual(equations: NonlinearEquations, scheme: Scheme, steps: Any, n: int) -> Any:
    """Return the residual that steps solve, of `n` coordinates, fitted to the modes at q = 0.

    It is the equations' own residual where these do not keep their modes, where the scheme does not fit steps, and
    where JAX traces the residual.
    """
    residual = equations.residual
    if scheme.exponent is None or equations.idle_inputs is None or holds_jax(residual):
        return residual
    zero = np.zeros((1, n))
    at_rest = slopes(residual, zero, zero, zero, equations.idle_inputs)
    stiffness, damping, mass = (symmetric(slope[0]) for slope in at_rest)
    return Fitted(residual, *to_modes(scheme.exponent, steps.longest, mass, damping, stiffness))


def to_modes(exponent: Any, step: Any, mass: Floats, damping: Floats, stiffness: Floats) -> tuple[Floats, Floats]:
    """Matrices (..., n, n) to add to M and C, so that modes keep their periods in steps of a length (...), s."""
    square, modes = symmetric_modes(stiffness, mass)
    frequency = np.sqrt(np.maximum(square, 0.0))
    rate = ((damping @ modes) * modes).sum(axis=-2)
    fits = (frequency > 0) & (np.abs(rate) < 2 * frequency)
    frequency = np.where(fits, frequency, 1.0)  # any value for modes that are left as they are
    angle = np.minimum(frequency * np.asarray(step)[..., None], FITTED)
    ratio = np.where(fits, rate / (2 * frequency), 0.0)
    z = angle * (-ratio + 1j * np.sqrt(1 - ratio**2))  # λ h
    mu = exponent(z)
    # μ² m + μ h c + (ω h)² = 0 with the mode's own stiffness.
    factor = np.abs(z / mu) ** 2
    slower = np.divide(mu.real, z.real, out=np.ones_like(ratio), where=ratio > 0)
    added_mass = np.where(fits, factor - 1, 0.0)
    added_rate = np.where(fits, rate * (slower * factor - 1), 0.0)
    # A modal value v of each mode φ is the matrix Σ M φ v φᵀ M.
    shapes = mass @ modes
    transposed = np.swapaxes(shapes, -1, -2)
    mass_term = shapes * added_mass[..., None, :] @ transposed
    damping_term = shapes * added_rate[..., None, :] @ transposed
    return mass_term, damping_term


SCHEMES: dict[str, Callable[..., Scheme]] = {
    "newmark": newmark,
    "hht": partial(hht, alpha=-0.1),
    "generalized-alpha": partial(generalized_alpha, rho_inf=0.9),
    "gauss": gauss,
}
