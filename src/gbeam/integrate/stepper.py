"""One-step structural integrators as parameters of one scheme: Newmark, HHT-α, generalised-α.

The form is Arnold and Brüls' (2007): the equations of motion hold exactly at the end of each step, and a second
acceleration a carries the weights, (1−α_m) a₊ + α_m a = (1−α_f) q̈₊ + α_f q̈. It is the classical scheme for linear
systems and second order for configuration-dependent mass as well.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
from jaxtyping import Array, Bool

from gbeam.errors import InputError
from gbeam.integrate.system import State, System


class OneStep(eqx.Module):
    """Parameters of the scheme.

    Parameters
    ----------
    alpha_m, alpha_f : float
        Weights of the old acceleration and the old forces (Chung and Hulbert 1993).
    beta, gamma : float
        Newmark's parameters.
    """

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    order: int = eqx.field(static=True, default=2)
    offsets: tuple[float, ...] = eqx.field(static=True, default=(1.0,))

    def start(self, system: System, state: State, inputs: Any) -> tuple[State, Bool[Array, ""]]:
        """Give the initial state the acceleration that its equations demand."""
        blank = system.blank(state.q.shape[0])
        qdd, ok, _ = system.acceleration(state.q, state.qd, 0.0, 0.0, inputs, state.qdd, blank)
        return State(state.q, state.qd, qdd, qdd, blank), ok

    def step(self, system: System, state: State, h: Array, inputs: tuple[Any, ...]) -> tuple[State, Bool[Array, ""]]:
        """One step of length h, with the inputs at its end."""
        q, qd, qdd, a, memory = state
        carried = (self.alpha_f * qdd - self.alpha_m * a) / (1 - self.alpha_m)
        share = (1 - self.alpha_f) / (1 - self.alpha_m)
        q_star = q + h * qd + h**2 * ((0.5 - self.beta) * a + self.beta * carried)
        qd_star = qd + h * ((1 - self.gamma) * a + self.gamma * carried)
        cq, cv = h**2 * self.beta * share, h * self.gamma * share
        new, ok, memory = system.acceleration(q_star, qd_star, cq, cv, inputs[0], qdd, memory)
        return State(q_star + cq * new, qd_star + cv * new, new, carried + share * new, memory), ok


def newmark(beta: float = 0.25, gamma: float = 0.5) -> OneStep:
    """Newmark (1959); the defaults are the average acceleration: no damping, unconditionally stable."""
    if not (gamma >= 0.5 and 2 * beta >= gamma):
        raise InputError(
            "beta",
            f"is {beta:g} with gamma {gamma:g}",
            "2 beta >= gamma >= 1/2 is stable at every step; try 0.25 and 0.5",
        )
    return OneStep(0.0, 0.0, beta, gamma)


def hht(alpha: float) -> OneStep:
    """Hilber, Hughes and Taylor (1977): alpha from −1/3 to 0, more damping the lower."""
    if not -1 / 3 <= alpha <= 0:
        raise InputError("alpha", f"is {alpha:g}", "give a value from -1/3 to 0")
    return OneStep(0.0, -alpha, (1 - alpha) ** 2 / 4, 0.5 - alpha)


def generalized_alpha(rho_inf: float) -> OneStep:
    """Chung and Hulbert (1993): spectral radius rho_inf at infinite frequency, 0 (most damping) to 1."""
    if not 0 <= rho_inf <= 1:
        raise InputError("rho_inf", f"is {rho_inf:g}", "give a value from 0 to 1")
    alpha_m, alpha_f = (2 * rho_inf - 1) / (rho_inf + 1), rho_inf / (rho_inf + 1)
    gamma = 0.5 - alpha_m + alpha_f
    return OneStep(alpha_m, alpha_f, (gamma + 0.5) ** 2 / 4, gamma)
