"""A case: one beam in one model, the environments it is put into, and how its response is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gbeam.mechanics.assembly import Model
from gbeam.motion import Centrifuge, Flight, HubRate, HubTorque
from gbeam.structure.beam import Beam

Motion = Flight | Centrifuge | HubRate | HubTorque


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


@dataclass(frozen=True)
class Case:
    """What a scenario describes, as objects.

    Parameters
    ----------
    title : str
    beam : Beam
    model : Model
    motions : mapping of str to motion
        By name, in the scenario's order.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    response : ResponseSettings
    stations : tuple of float
        Positions of output from the root besides the tip, m.
    """

    title: str
    beam: Beam
    model: Model
    motions: Mapping[str, Motion]
    response: ResponseSettings
    tracks: Mapping[str, str] = field(default_factory=dict)
    stations: tuple[float, ...] = ()
