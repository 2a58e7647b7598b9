"""Internal loads of a beam over time, and the static influence of acceleration fields: frozen records of arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from gbeam.results.result import Floats, Part


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
