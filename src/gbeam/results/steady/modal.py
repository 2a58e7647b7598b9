"""Small vibrations about a relative equilibrium: modes at one instant, and frequencies against a hub's speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from gbeam.results.parts.errors import ErrorEstimate, FrequencyErrors
from gbeam.results.response import BaseMotion
from gbeam.results.result import Complex, Figured, Floats
from gbeam.results.steady.stability import Critical

SHOWN = 6  # frequencies in a short description
FAR = 2.0  # times the highest multiple of the speed: a mode above would press the others to the ground
FEW = 2  # modes drawn in any case


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


@dataclass(frozen=True, repr=False, eq=False)
class Modes(Figured):
    """Small vibrations about a relative equilibrium, ascending in frequency.

    Parameters
    ----------
    motion, model : str
    time : float
        s.
    base : BaseMotion
        At that time, (3,).
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
    damping_given : bool
        Whether the beam has a damping ratio, be it zero; without one it is undamped.
    errors : FrequencyErrors or None
        Of the frequencies; None where there is no estimate.
    width, thickness : (s,) m
        Extent of the section along y and z at the stations, for pictures; empty without a beam.
    round : bool
        Whether the section is round.
    """

    motion: str
    model: str
    time: float
    base: BaseMotion
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
    damping_given: bool = True
    errors: FrequencyErrors | None = None
    width: Floats = field(default_factory=lambda: np.empty(0))
    thickness: Floats = field(default_factory=lambda: np.empty(0))
    round: bool = False

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

    def __repr__(self) -> str:
        of = f" {self.motion!r}" if self.motion else ""
        modes = [f"{f:.4g} Hz {way}" for f, way in zip(self.frequency, self.direction, strict=True)]
        more = f" and {len(modes) - SHOWN} more" if len(modes) > SHOWN else ""
        lines = [f"Modes{of} ({self.model}) at {self.time:.4g} s: {', '.join(modes[:SHOWN])}{more}"]
        lines += [f"{e.kind} along {e.direction}, growing with {e.growth_rate:.4g} 1/s" for e in self.instabilities]
        return self._with_warnings(*lines)


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
    errors : ErrorEstimate
        Of the speed; infinite where the exact model has no such crossing.
    """

    track: int
    order: int
    speed: float
    frequency: float
    direction: str
    errors: ErrorEstimate = field(default_factory=ErrorEstimate)


@dataclass(frozen=True, repr=False, eq=False)
class Campbell(Figured):
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
    errors : FrequencyErrors or None
        Of the modes' frequencies, the largest of those at the first, a middle and the last speed.
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
    errors: FrequencyErrors | None = None

    def __repr__(self) -> str:
        of = f" {self.motion!r}" if self.motion else ""
        lost = "" if self.critical is None or self.critical.value is None else f"\n  {self.critical.reason}"
        return (
            f"Campbell{of} ({self.model}): {len(self.direction)} modes at {len(self.speed)} speeds, "
            f"{self.speed[0]:.4g} to {self.speed[-1]:.4g} rad/s; {len(self.crossings)} crossings with multiples "
            f"{', '.join(str(order) for order in self.orders) or 'none'} of the speed{lost}"
        )


def near_multiples(frequency: Floats, speed: Floats, orders: Sequence[int]) -> list[int]:
    """Which modes a Campbell diagram draws: all but those far above every multiple of the speed.

    Parameters
    ----------
    frequency : (k, v) Hz
    speed : (v,) rad/s
    orders : sequence of int
    """
    far = FAR * max(orders, default=0) * speed[-1] / (2 * np.pi) if len(orders) else np.inf
    return [k for k, each in enumerate(frequency) if k < FEW or not np.nanmin(each, initial=np.inf) > far]
