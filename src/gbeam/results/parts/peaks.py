"""Largest values of histories, between the steps where they lie there, and when: frozen records of arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class Extremes(Part):
    """Extreme values of histories and their times.

    Parameters
    ----------
    value : (...)
        Unit of the history.
    time : (...)
        s.
    """

    value: Floats
    time: Floats


@dataclass(frozen=True, repr=False, eq=False)
class VectorPeaks(Part):
    """Largest sizes of histories of vectors.

    Parameters
    ----------
    components : Extremes
        Of each component, (..., 3).
    size : Extremes
        Of the vector, (...).
    """

    components: Extremes
    size: Extremes

    def __getitem__(self, place: int | slice) -> VectorPeaks:
        """The peaks at one place, or at some."""
        c, s = self.components, self.size
        return VectorPeaks(Extremes(c.value[place], c.time[place]), Extremes(s.value[place], s.time[place]))


@dataclass(frozen=True, repr=False, eq=False)
class LoadPeaks(Part):
    """Peaks of what the sections of the beam carry, at the root (first) and the stations.

    Parameters
    ----------
    force, moment : VectorPeaks
        N, V_y, V_z, N, and torque, M_y, M_z, N m, axes of the sections, (s,). At the root their sizes are those of the
        base's force and moment on the beam.
    tension, compression : Extremes
        Largest and smallest normal stress over the section, (s,) Pa; NaN where the extreme fibres are unknown.
    beam_torque : Extremes or None
        Largest size of the torque that the beam takes from a hub, () N m.
    """

    force: VectorPeaks
    moment: VectorPeaks
    tension: Extremes
    compression: Extremes
    beam_torque: Extremes | None = None

    @property
    def stress(self) -> Extremes:
        """Largest size of the normal stress over each section, (s,) Pa."""
        pulled = self.tension.value >= -self.compression.value
        return Extremes(
            np.where(pulled, self.tension.value, -self.compression.value),
            np.where(pulled, self.tension.time, self.compression.time),
        )


@dataclass(frozen=True, repr=False, eq=False)
class Peaks(Part):
    """Largest values of a response between all steps computed, and their times.

    They are of the flight's own times, without a machine's spin-up and spin-down.
    The coordinates between steps are the polynomials of fifth degree that have both ends' values, rates and
    accelerations, and the displacement is that of the model there. Loads and stress have no derivatives: near a peak
    they are the polynomial of sixth degree through seven steps. Where JAX traces a run, its peaks are the tip's
    largest samples.

    Parameters
    ----------
    max_abs, time_of_max : (3,)
        Of the tip's displacement along x, y, z, m, s.
    residual_amplitude : (3,)
        Half peak-to-peak of the same from the residual's start to the end, m; NaN where there is no such time.
    max_size, time_of_max_size : float
        Largest length of the tip's displacement, m, s.
    displacement : VectorPeaks or None
        Of all stations, (s,), m.
    loads : LoadPeaks or None
    """

    max_abs: Floats
    time_of_max: Floats
    residual_amplitude: Floats
    max_size: float = math.nan
    time_of_max_size: float = math.nan
    displacement: VectorPeaks | None = None
    loads: LoadPeaks | None = None
