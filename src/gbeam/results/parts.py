"""Parts of a response: the outline for pictures, peaks, and what the sections carry; frozen records of arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np

from gbeam.results.result import Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class Outline(Part):
    """The beam's axis from root to tip over time, its size, and that of the machine or hub that carries it.

    Parameters
    ----------
    points : (p,)
        Positions along the straight beam, the first 0, the last the tip, m.
    width, thickness : (p,)
        Extent of the section along y and z, m.
    round : bool
        Whether the section is round.
    bodies : (b, 2)
        Position m and mass kg of each body on the beam.
    time : (u,)
        Some of the response's times, s.
    displacement : (u, p, 3)
        Of the points, relative to the base axes, m.
    arm : float
        Of a centrifuge, m; NaN where there is none.
    radius : float
        From a hub's axis to the root, m; NaN where there is none.
    R_HB : (3, 3)
        Rotation from base to hub axes.
    attitude : (u, 4) or None
        Of base axes that turn in flight: quaternions w, x, y, z of the rotation to the axes at the first time, by the
        angular velocity given. The attitude at the first time, heading too, is not known. None without rates.
    """

    points: Floats
    width: Floats
    thickness: Floats
    round: bool
    bodies: Floats
    time: Floats
    displacement: Floats
    arm: float = math.nan
    radius: float = math.nan
    R_HB: Floats = field(default_factory=lambda: np.eye(3))
    attitude: Floats | None = None


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


def yield_margin(yield_strength: float, stress: Floats) -> Floats:
    """Margin on yield, yield strength over the size of the stress less one: negative beyond yield, inf unstressed."""
    with np.errstate(divide="ignore"):
        return np.asarray(yield_strength / stress - 1)


@dataclass(frozen=True, repr=False, eq=False)
class Loads(Part):
    """What the sections of the beam carry, and what its base must supply.

    The outboard part of the beam acts on the inboard part with `force` and `moment` at the section's deformed
    position: a positive axial force is tension, a positive M_z bends towards +y, a positive M_y towards −z. A body
    fixed to the beam at a station counts as outboard of it.

    Parameters
    ----------
    stations : (s,)
        From the root, m; the first is the root, the last the tip.
    force, moment : (t, s, 3)
        Base axes, N and N m.
    section_force : (t, s, 3)
        N, V_y, V_z in the axes of the deformed section, N.
    section_moment : (t, s, 3)
        Torque, M_y, M_z in the same axes, N m.
    stress_tension, stress_compression : (t, s)
        Largest and smallest normal stress over the section, N/A ± (|M_y| c_z/I_y + |M_z| c_y/I_z), of a round section
        N/A ± √(M_y² + M_z²) c/I, Pa, with the section's extreme fibres c_y and c_z; NaN where these are unknown.
    acceleration : (t, s, 3)
        Of the stations in the world, base axes, m/s²; specific force where gravity acts.
    beam_torque : (t,) or None
        Torque about the hub's axis that the beam takes from the hub, N m.
    drive_torque : (t,) or None
        The same with the hub's own inertia, N m: what its drive supplies; None where the inertia is unknown.
    root_fibre : (t,) or None
        Normal stress at that extreme fibre of the root where it ranges most, Pa; None where a run is traced.
    yield_strength : float or None
        Of the material, Pa; None where it is not given.
    fatigue_exponent : float
        Of the material's Wöhler curve.
    """

    stations: Floats
    force: Floats
    moment: Floats
    section_force: Floats
    section_moment: Floats
    stress_tension: Floats
    stress_compression: Floats
    acceleration: Floats
    beam_torque: Floats | None = None
    drive_torque: Floats | None = None
    root_fibre: Floats | None = None
    yield_strength: float | None = None
    fatigue_exponent: float = math.nan

    def during(self, part: slice) -> Loads:
        """The same at some of the times."""
        over_time = [
            each.name for each in fields(self) if np.ndim(getattr(self, each.name)) and each.name != "stations"
        ]
        return replace(self, **{name: getattr(self, name)[part] for name in over_time})

    @property
    def stress(self) -> Floats:
        """Largest size of the normal stress over the section, in tension or compression, (t, s) Pa."""
        # They are N/A ± the bending stress: the larger size without a choice, and with NumPy's or JAX's arrays.
        middle = (self.stress_tension + self.stress_compression) / 2
        return abs(middle) + (self.stress_tension - self.stress_compression) / 2

    @property
    def margin(self) -> Floats | None:
        """Margin on yield, yield strength over stress less one, (t, s); None where the strength is not given."""
        return None if self.yield_strength is None else yield_margin(self.yield_strength, self.stress)

    @property
    def root_force(self) -> Floats:
        """Force of the base on the beam, base axes, (t, 3) N."""
        return -self.force[:, 0]

    @property
    def root_moment(self) -> Floats:
        """Moment of the base on the beam about the root, base axes, (t, 3) N m."""
        return -self.moment[:, 0]


@dataclass(frozen=True, repr=False, eq=False)
class Influence(Part):
    """Static answer of the beam, straight and at rest, to acceleration fields of its base: e and g·x, base axes.

    Column i is the answer to the field along axis i: a uniform acceleration of 1 m/s² (`*_uniform`), or one that
    grows by 1 m/s² for every metre from the root (`*_linear`).

    Parameters
    ----------
    tip_uniform, tip_linear : (3,)
        Displacement of the tip along the field, m per m/s² and m per 1/s².
    force_uniform, force_linear : (3,)
        Inertia force at the root along the field: minus the mass, kg, and minus its first moment, kg m.
    moment_uniform, moment_linear : (3,)
        Its arm's share about the root, in the plane of x and the field: first and second moment of the mass, negative,
        kg m and kg m²; zero for the field along x.
    """

    tip_uniform: Floats
    tip_linear: Floats
    force_uniform: Floats
    force_linear: Floats
    moment_uniform: Floats
    moment_linear: Floats
