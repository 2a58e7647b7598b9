"""What the stated error of the beam theory assumes where a beam does not say it."""

from __future__ import annotations

import numpy as np

from gbeam.structure.beam import Beam
from gbeam.structure.material import ASSUMED_RATIO
from gbeam.structure.shapes import ASSUMED_SHEAR

NO_TWIST = "no twist (section.torsion_constant is not given)"


def assumptions(beam: Beam) -> tuple[str, ...]:
    """Each in a few words: ``Poisson's ratio 0.3``."""
    words = []
    if beam.material.poissons_ratio is None:
        words.append(f"Poisson's ratio {ASSUMED_RATIO:g}")
    if beam.section.shape == "general":
        if not {"shear_coefficient_y", "shear_coefficient_z"} <= beam.section.dimensions.keys():
            words.append(f"shear coefficients of {ASSUMED_SHEAR:g}")
        if np.isnan(beam.section.torsion_constant(np.zeros(1))).any():
            words.append(NO_TWIST)
    return tuple(words)
