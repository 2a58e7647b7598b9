"""The exact model with more shapes beside a solution: its residual there, and its linear equations about it.

The residual R of the complete equations at a solution is what the solution's own model and shapes leave out; to first
order the error is the response of the linear equations to −R, and no program is compiled for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.mechanics.equations import sampled
from gbeam.mechanics.equations.hub import FreeHub, ground_of
from gbeam.mechanics.section_forces import absolute_accelerations
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.results.result import Floats


@dataclass(frozen=True, eq=False)
class Sampled:
    """A solution at times (t,) in the coordinates (t, n) of a structure with more shapes; `hub` (t, 3) has angle, rate
    and acceleration.
    """

    time: Floats
    base: Base
    p: Floats
    pd: Floats
    pdd: Floats
    hub: Floats | None = None
    motion: Any = None
    loads: Floats | None = None

    def moved(self, d: Floats, dd: Floats, ddd: Floats) -> Sampled:
        """The same with corrections (t, first + n) and their rates; of a hub's angle in the first column."""
        hub, base = self.hub, self.base
        if hub is not None:
            hub = hub + np.stack([x[:, 0] for x in (d, dd, ddd)], axis=1)
            base = self.motion.mount.base(*hub.T)
            d, dd, ddd = (x[:, 1:] for x in (d, dd, ddd))
        return Sampled(self.time, base, self.p + d, self.pd + dd, self.pdd + ddd, hub, self.motion, self.loads)


def complete_residual(structure: Structure, at: Sampled) -> Floats:
    """Residual (t, first + n) of a structure's complete equations; a free hub's row comes first."""
    assert structure.inertia is not None and structure.elasticity is not None
    c, inertia = structure.coefficients, structure.inertia
    r, rd, rdd = sampled.paths(inertia.positions, at.p, at.pd, at.pdd)
    force = np.asarray(inertia.mass)[:, None] * absolute_accelerations(np, at.base, r, rd, rdd)
    beam = sampled.inertia_forces(inertia, at.p, force)
    beam += sampled.elastic_forces(structure.elasticity, at.p, c.stiffness) + at.pd @ c.damping
    total, about = np.zeros((2, len(at.p), 3))
    if structure.work is not None and at.loads is not None:
        along, total, about = sampled.load_forces(structure.work, at.p, at.loads)
        beam -= along
    if at.hub is None:
        return beam
    mount, ground = at.motion.mount, ground_of(at.motion)
    axis, root = mount.R_HB[2], mount.radius * mount.R_HB[0]
    moment = np.cross(r, force).sum(axis=1) - about
    turning = ground.torque(*at.hub.T) - at.motion.torque(at.time)
    turning = turning + moment @ axis + (force.sum(axis=1) - total) @ np.cross(axis, root)
    return np.concatenate([turning[:, None], beam], axis=1)


def linear_residual(structure: Structure, at: Sampled) -> Floats:
    """Residual (t, n) of a linear model's equations on the base that the solution has."""
    base = at.base
    velocity, stiffness, force = structure.coefficients.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, at.loads)
    inside = (velocity @ at.pd[..., None] + stiffness @ at.p[..., None])[..., 0]
    return np.asarray(at.pdd @ structure.coefficients.mass + inside - force)


def hub_torque(hub: FreeHub, at: Sampled) -> Floats:
    """Torque (t,) that the inertia of a linear beam takes from a free hub."""
    assert at.hub is not None
    q, qd, qdd, (_, rate, acceleration) = at.p, at.pd, at.pdd, at.hub.T
    swept, coupling = hub.f2 - q @ hub.k2, hub.b0 + q @ hub.b1.T
    inertia = hub.rigid + ((hub.f2 + swept) * q).sum(axis=1)
    quadratic = 2 * rate * (swept * qd).sum(axis=1) + (qd * (qd @ hub.b1.T)).sum(axis=1)
    return np.asarray(inertia * acceleration + (coupling * qdd).sum(axis=1) + quadratic)
