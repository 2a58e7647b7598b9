"""Static answer of the straight beam to acceleration fields of its base: what a mismatch along it can do."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.mechanics.structure import Structure
from gbeam.results.parts import Influence

Array = Any


def influence(structure: Structure) -> Influence:
    """Static answers of the straight beam to uniform, angular (a_y = α_z x, a_z = −α_y x) and centripetal (−ω² x)
    accelerations.
    """
    c = structure.coefficients
    linear = np.stack([-c.f_ww[2, 2], c.f_al[2], -c.f_al[1]])
    per_q = structure.station_places.first[-1]

    def tip(load: Array) -> Array:
        return np.diagonal(per_q @ np.linalg.solve(c.stiffness, load.T))

    total, first, second = float(c.rigid[0]), float(c.rigid[1]), float(c.rigid[4])
    across = np.array([0.0, 1.0, 1.0])
    return Influence(
        tip_uniform=tip(c.f_a),
        tip_linear=tip(linear),
        force_uniform=np.full(3, -total),
        force_linear=np.full(3, -first),
        moment_uniform=-first * across,
        moment_linear=-second * across,
    )
