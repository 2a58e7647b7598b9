"""Description of a case: frozen records of its beam, model, motions, flights' records and settings before any run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gbeam.results.result import Floats, Part

Vector = tuple[float, float, float]


@dataclass(frozen=True, repr=False, eq=False)
class Level(Part):
    """The longest stretch of a record in which the load is near 1 g.

    Parameters
    ----------
    start, end : float
        s.
    load : tuple of float
        Its mean, base axes, m/s².
    """

    start: float
    end: float
    load: Vector


@dataclass(frozen=True, repr=False, eq=False)
class RecordSummary(Part):
    """A flight's record as its file has it, in base axes.

    Parameters
    ----------
    file : str
    columns : tuple of str
        Of x, y and z, with their signs.
    quantity : str
        specific-force or acceleration.
    samples : int
        Of the part that is flown.
    rate : float
        Hz.
    span, whole : tuple of float
        First and last time of the part, and of the file, s.
    smallest, largest : tuple of float
        Of x, y and z, m/s².
    peak : tuple of float
        The load where it is largest in size, m/s².
    time_of_peak : float
        s.
    level : Level or None
        None where the load is nowhere near 1 g, or is no specific force.
    clock : str
        Time of day of the file at zero seconds; empty where its times are numbers.
    notes : tuple of str
        What was done to it, and what looks odd.
    """

    file: str
    columns: tuple[str, str, str]
    quantity: str
    samples: int
    rate: float
    span: tuple[float, float]
    whole: tuple[float, float]
    smallest: Vector
    largest: Vector
    peak: Vector
    time_of_peak: float
    level: Level | None = None
    clock: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, repr=False, eq=False)
class Description(Part):
    """Meaning of a case.

    Parameters
    ----------
    title : str
    length : float
        Of the beam, m.
    mass : float
        Of the beam without its bodies, kg.
    bodies : tuple of (position m, mass kg)
    model : str
    counts : mapping of str to int
        Numbers of shapes: axial, along y and along z, and those of twist and shear that the model has.
    frequency : (k,)
        Lowest natural frequencies of the beam on a base at rest, Hz.
    direction : tuple of (k,) str
        axial, y or z.
    motions : mapping of str to str
        Kind of each motion, by name.
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    records : mapping of str to RecordSummary
        Of the flights that have one, by name.
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
    counts: Mapping[str, int]
    frequency: Floats
    direction: tuple[str, ...]
    motions: Mapping[str, str]
    start: float
    duration: float
    step: float | None
    integrator: str
    tracks: Mapping[str, str] = field(default_factory=dict)
    records: Mapping[str, RecordSummary] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    distributions: Mapping[str, str] = field(default_factory=dict)

    @property
    def total_mass(self) -> float:
        """Mass of the beam with its bodies, kg."""
        return self.mass + sum(mass for _, mass in self.bodies)
