"""What a case means: a frozen record of its beam, model, motions and settings before anything is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gbeam.results.result import Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class Description(Part):
    """What a case means.

    Parameters
    ----------
    title : str
    length : float
        Of the beam, m.
    mass : float
        Of the beam without its bodies, kg.
    bodies : tuple of (position m, mass kg)
    model : str
    counts : tuple of int
        Numbers of shapes: axial, along y, along z.
    frequency : (k,)
        Lowest natural frequencies of the beam on a base at rest, Hz.
    direction : tuple of (k,) str
        axial, y or z.
    motions : mapping of str to str
        Kind of each motion, by name.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    start, duration : float
        Of the response, s.
    step : float or None
        s; None for an automatic one.
    integrator : str
    warnings : tuple of str
        What is implausible.
    distributions : mapping of str to str
        Of the values that have one, by path; the rest is said of their centres.
    """

    title: str
    length: float
    mass: float
    bodies: tuple[tuple[float, float], ...]
    model: str
    counts: tuple[int, int, int]
    frequency: Floats
    direction: tuple[str, ...]
    motions: Mapping[str, str]
    start: float
    duration: float
    step: float | None
    integrator: str
    tracks: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    distributions: Mapping[str, str] = field(default_factory=dict)

    @property
    def total_mass(self) -> float:
        """Of the beam with its bodies, kg."""
        return self.mass + sum(mass for _, mass in self.bodies)
