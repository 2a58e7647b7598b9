"""Cycles of stress at the root in flight and on a machine, and how much more the one damages: frozen records."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class StressCycles(Part):
    """Rainflow cycles of a stress (ASTM E1049-85, 5.4.4).

    Parameters
    ----------
    range, mean : (k,)
        Pa; largest range first.
    count : (k,)
        1 of a full cycle, 0.5 of a half.
    """

    range: Floats
    mean: Floats
    count: Floats

    @property
    def total(self) -> float:
        """Number of cycles."""
        return float(self.count.sum())

    @property
    def largest(self) -> float:
        """Largest range, Pa; zero without cycles."""
        return float(self.range.max(initial=0.0))

    def equivalent_range(self, exponent: float) -> float:
        """Range of the one cycle that does the same damage, (Σ n Δσᵐ)^(1/m) Pa; zero without cycles."""
        scale = self.largest  # taken out, so that no power of a stress overflows
        return scale * float(np.sum(self.count * (self.range / scale) ** exponent)) ** (1 / exponent) if scale else 0.0


@dataclass(frozen=True, repr=False, eq=False)
class Fatigue(Part):
    """Stress cycles at the root in both environments, each at that extreme fibre where the stress ranges most.

    Parameters
    ----------
    exponent : float
        m of Wöhler's curve, N Δσᵐ = constant.
    flight, machine : StressCycles
        Of each whole run, spin-up and spin-down included.
    """

    exponent: float
    flight: StressCycles
    machine: StressCycles

    @property
    def damage_ratio(self) -> float:
        """Damage on the machine over that in flight by Palmgren and Miner, Σ n Δσᵐ; means count for nothing.

        NaN without cycles in flight.
        """
        flight, machine = (each.equivalent_range(self.exponent) for each in (self.flight, self.machine))
        return (machine / flight) ** self.exponent if flight > 0 else math.nan
