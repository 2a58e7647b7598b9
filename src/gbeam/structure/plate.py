"""Strips that bend as plates: how far their sections are kept from bending across, and stiffen by it.

A narrow beam bends across as it bends, by −ν of its curvature: EI. Kept flat it is stiffer by ν²/(1 − ν²): a plate in
cylindrical bending. A strip is kept flat near a clamp, and where it is bent so far that bending across would stretch
its edges. Both follow from one term, w + (y²/2 − b²/24) c, in the energy of a plate of width b and thickness h.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.structure.beam import Beam

Array = NDArray[np.float64]
ZONE = 0.9  # of one term's length: what several terms leave of it


def stiffening(beam: Beam, x: Array, bent: Array) -> tuple[Array, Array]:
    """Factors (p,) on EI_y and EI_z at x (p,) by which the strip is stiffer than a beam, at sizes of curvatures (2, p),
    1/m.
    """
    ratio, (width, thickness) = float(beam.material.ratio), beam.section.at(x).extents()
    most = ratio**2 / (1 - ratio**2)
    flat = [
        near_clamp_or_bent(ratio, x, across, through, curvature) * np.maximum(1 - (through / across) ** 2, 0)
        for across, through, curvature in ((width, thickness, bent[0]), (thickness, width, bent[1]))
    ]
    own = 1 / (1 - ratio**2) if beam.section.plate else 1.0
    return (1 + most * flat[0]) / own, 1 + most * flat[1]


def near_clamp_or_bent(ratio: float, x: Array, across: Array, through: Array, curvature: Array) -> Array:
    """How far sections are kept flat, from 0 (free to bend across) to 1 (as in a plate), at positions (p,): c = c' = 0
    at the clamp in b⁴/720 c'''' − (1 − ν) b²/6 c'' + c = −ν w'', to which the stretch adds (1 − ν²) (b² w''/h)²/60 c
    (Searle, 1907).
    """
    mean = (1 - ratio) / 6
    root = np.sqrt(mean**2 - 4 / 720)
    near, far = np.sqrt(360 * (mean + root)), np.sqrt(360 * (mean - root))
    place = x / (ZONE * across)
    clamped = (near * np.exp(-far * place) - far * np.exp(-near * place)) / (near - far)
    searle = (1 - ratio**2) * (across**2 * curvature / through) ** 2 / 60
    return 1 - (1 - clamped) / (1 + searle)
