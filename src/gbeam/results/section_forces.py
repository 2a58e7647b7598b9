"""Internal loads of a beam over time, and the static influence of acceleration fields: frozen records of arrays."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.results.result import Floats, Part


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
    stress : (t, s)
        Largest normal stress at the outer fibre, N/A + |M_y| c_z/I_y + |M_z| c_y/I_z, Pa, with the
        section's extreme fibres c_y and c_z; NaN where these are unknown.
    acceleration : (t, s, 3)
        Of the stations in the world, base axes, m/s²; specific force where gravity acts.
    beam_torque : (t,) or None
        Torque about the hub's axis that the beam takes from the hub, N m.
    drive_torque : (t,) or None
        The same with the hub's own inertia, N m: what its drive supplies; NaN where the inertia is unknown.
    """

    stations: Floats
    force: Floats
    moment: Floats
    section_force: Floats
    section_moment: Floats
    stress: Floats
    acceleration: Floats
    beam_torque: Floats | None = None
    drive_torque: Floats | None = None

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
