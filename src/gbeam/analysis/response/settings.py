"""How a response over time is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class ResponseSettings:
    """How a response over time is computed.

    Parameters
    ----------
    duration : float
        s.
    start : float
        Initial time, s.
    step : float or None
        s; None for an automatic one.
    integrator : str
        newmark, hht, generalized-alpha, gauss or adaptive.
    parameters : mapping of str to float
        The integrator's own: beta and gamma; alpha; rho_inf.
    tolerance : float
        Relative error at which the automatic step stops refining.
    residual_from : float or None
        Time from which the residual vibration is measured, s.
    """

    duration: float
    start: float = 0.0
    step: float | None = None
    integrator: str = "newmark"
    parameters: Mapping[str, float] = field(default_factory=dict)
    tolerance: float = 1e-4
    residual_from: float | None = None
