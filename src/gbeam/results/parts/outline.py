"""What a picture of a beam in motion needs besides its response: the shape of the beam and of what carries it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

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
