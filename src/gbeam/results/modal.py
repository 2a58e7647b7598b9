"""What the questions about small motions return: frozen records of arrays and words."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gbeam.results.response import Floats
from gbeam.results.section_forces import Loads

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class FrozenBase:
    """Motion of the root at one instant, base axes: acceleration m/s², angular velocity rad/s, and its rate rad/s²."""

    a_WO_B: Floats
    w_WB_B: Floats
    alpha_WB_B: Floats


@dataclass(frozen=True)
class Deflection:
    """Relative equilibrium at a frozen base motion.

    Parameters
    ----------
    motion, model : str
    time : float
        s.
    base : FrozenBase
    stations : (s,) m, the last is the tip
    displacement : (s, 3)
        Relative to the base axes, m.
    q : (n,)
        Coordinates.
    strain_energy : float
        J.
    stable : bool
        Whether the stiffness about the equilibrium is positive definite.
    loads : Loads or None
        What the sections carry, of one time.
    """

    motion: str
    model: str
    time: float
    base: FrozenBase
    stations: Floats
    displacement: Floats
    q: Floats
    strain_energy: float
    stable: bool
    loads: Loads | None = None

    @property
    def tip(self) -> Floats:
        """Displacement of the tip, (3,) m."""
        return self.displacement[-1]


@dataclass(frozen=True)
class Instability:
    """An eigenvalue with a positive real part: ``divergence`` without oscillation, ``flutter`` with.

    Parameters
    ----------
    kind : str
    growth_rate : float
        Real part, 1/s.
    frequency : float
        Hz; zero for divergence.
    direction : str
        x, y or z.
    """

    kind: str
    growth_rate: float
    frequency: float
    direction: str


@dataclass(frozen=True)
class Modes:
    """Small vibrations about a relative equilibrium, ascending in frequency.

    Parameters
    ----------
    motion, model : str
    time : float
        s.
    base : FrozenBase
    gyroscopic : bool
        Whether Coriolis coupling is in.
    eigenvalue : (k,) complex
        1/s, of the oscillating modes; one of each pair, with the positive imaginary part.
    direction : tuple of str
        x, y or z, the one in which the beam moves most.
    coordinates : (k, n) complex
        Of unit mass-weighted length.
    stations : (s,) m
    shape : (k, s, 3) complex
        Displacement of the stations, largest component 1.
    equilibrium : (s, 3)
        Displacement about which the beam vibrates, m.
    instabilities : tuple of Instability
    rigid : int
        Number of modes of zero frequency, left out: a free hub's turning.
    overdamped : (r,)
        Negative real eigenvalues, 1/s: decay without oscillation. A divergence comes with one.
    """

    motion: str
    model: str
    time: float
    base: FrozenBase
    gyroscopic: bool
    eigenvalue: Complex
    direction: tuple[str, ...]
    coordinates: Complex
    stations: Floats
    shape: Complex
    equilibrium: Floats
    instabilities: tuple[Instability, ...]
    rigid: int
    overdamped: Floats

    @property
    def frequency(self) -> Floats:
        """Natural frequencies |λ|/2π, (k,) Hz."""
        return np.abs(self.eigenvalue) / (2 * np.pi)

    @property
    def damping_ratio(self) -> Floats:
        """Ratios of critical damping −Re λ/|λ|, (k,); negative for flutter."""
        return -self.eigenvalue.real / np.abs(self.eigenvalue)

    @property
    def stable(self) -> bool:
        """Whether nothing grows."""
        return not self.instabilities


@dataclass(frozen=True)
class Critical:
    """Where the stiffness about the relative equilibrium stops being positive definite, or something grows.

    Parameters
    ----------
    quantity, unit : str
        What was raised: ``hub rate``, rad/s; ``acceleration along x``, m/s²; or ``load factor``, times the loads.
    value : float or None
        None where it is not reached.
    searched_to : float
        End of the search.
    kind : str
        ``divergence``, ``flutter``, ``no equilibrium`` or ``none``.
    direction : str
        Of the mode that is lost; empty where there is none.
    reason : str
        The answer as a sentence.
    model : str
    """

    quantity: str
    unit: str
    value: float | None
    searched_to: float
    kind: str
    direction: str
    reason: str
    model: str


@dataclass(frozen=True)
class CriticalMap:
    """Critical hub rates against a mass on the beam and its position.

    Parameters
    ----------
    motion, model : str
    mass : (m,) kg
    position : (p,) m from the root
    speed : (m, p) rad/s; NaN where it is not reached
    searched_to : float
        rad/s.
    """

    motion: str
    model: str
    mass: Floats
    position: Floats
    speed: Floats
    searched_to: float


@dataclass(frozen=True)
class Crossing:
    """A mode met by a multiple of the speed: frequency = order × speed.

    Parameters
    ----------
    track : int
        Which mode.
    order : int
    speed : float
        rad/s.
    frequency : float
        Hz.
    direction : str
    """

    track: int
    order: int
    speed: float
    frequency: float
    direction: str


@dataclass(frozen=True)
class Campbell:
    """Frequencies against speed, each column one mode followed through crossings and veering.

    Parameters
    ----------
    motion, model : str
    speed : (v,) rad/s
    frequency, damping_ratio : (v, k)
        Hz; NaN where the mode does not oscillate.
    mac : (v, k)
        Modal assurance criterion between a mode and itself at the speed before; 1 at the first.
    direction : tuple of (k,) str
        At the first speed.
    orders : tuple of int
    crossings : tuple of Crossing
    critical : Critical or None
        Where the equilibrium is lost within the range.
    """

    motion: str
    model: str
    speed: Floats
    frequency: Floats
    damping_ratio: Floats
    mac: Floats
    direction: tuple[str, ...]
    orders: tuple[int, ...]
    crossings: tuple[Crossing, ...]
    critical: Critical | None


@dataclass(frozen=True)
class ModelRow:
    """One model's answer to a scenario, beside the reference's.

    Parameters
    ----------
    model : str
    motion : str
    outcome : str
        done, diverged, not converged, or cannot: the model is not made for this.
    message : str
        Why it is not done; what follows is then NaN.
    warnings : tuple of str
        Why the row may not be what it seems.
    peak, time_of_peak : float
        Of the tip in the direction in which the reference moves most, m, s.
    peak_error : float
        Peak over the reference's, less one.
    residual : float
        Amplitude of the vibration left, m; NaN where none was asked for.
    residual_error : float
        Over the reference's, less one.
    phase : float
        Of the vibration left, at the reference's dominant frequency, ahead of the reference's, rad.
    difference : float
        Largest distance between the two histories over the reference's peak.
    hub_angle : float
        At the end, of a free hub, rad; else NaN.
    error_estimate : float
        Of the steps, over the largest displacement.
    steps : int
    seconds : float
        To compute it, once compiled.
    """

    model: str
    motion: str
    outcome: str
    message: str
    warnings: tuple[str, ...]
    peak: float = math.nan
    time_of_peak: float = math.nan
    peak_error: float = math.nan
    residual: float = math.nan
    residual_error: float = math.nan
    phase: float = math.nan
    difference: float = math.nan
    hub_angle: float = math.nan
    error_estimate: float = math.nan
    steps: int = 0
    seconds: float = math.nan


@dataclass(frozen=True)
class ModelStudy:
    """The same scenario by every model; rows by motion, then model.

    Parameters
    ----------
    title, reference : str
        The reference is the model that the others are compared with.
    direction : dict of str to str
        Per motion, the direction compared.
    rows : tuple of ModelRow
    """

    title: str
    reference: str
    direction: dict[str, str]
    rows: tuple[ModelRow, ...]

    @property
    def compared(self) -> bool:
        """Whether there is a reference in every environment."""
        return all(it.outcome == "done" for it in self.rows if it.model == self.reference)
