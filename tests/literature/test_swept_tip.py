"""J. J. Epps and R. Chandra, The natural frequencies of rotating composite beams with tip sweep, Journal of the
American Helicopter Society 41 (1996) 29-36: an aluminium strip whose last 6 of 37.5 inches are swept back by 0 to 45
degrees.

The measured frequencies are those that GXBeam's documentation prints beside its own (docs, rotating).
"""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb

INCH, PSI, SLUG = 0.0254, 6894.757, 175.1268  # m, Pa, and kg of one pound force s²/in
RATES = 0.0, 500.0, 750.0  # rpm
# Of the first three flapping modes, Hz, at these rates; to 0.1 Hz, at rest to 0.2.
MEASURED = {
    0: ((1.4, 10.2, 14.8), (10.3, 25.2, 36.1), (27.7, 47.0, 62.9)),
    15: ((1.8, 10.1, 14.4), (10.2, 25.2, 34.8), (27.2, 44.4, 55.9)),
    30: ((1.7, 10.2, 14.9), (10.4, 23.7, 30.7), (26.6, 39.3, 48.6)),
    45: ((1.6, 10.2, 14.7), (10.4, 21.6, 26.1), (24.8, 35.1, 44.8)),
}


def flapping(sweep: float, rate: float) -> np.ndarray:
    """The first three frequencies out of the plane of rotation, Hz."""
    line = gb.Line.of_pieces([31.5 * INCH, 0.0, 6 * INCH], turn_z=[0.0, -np.radians(sweep), 0.0])
    material = gb.Material(2.51e-4 * SLUG / INCH**3, 1.06e7 * PSI, poissons_ratio=0.325)
    section = gb.Section.rectangle(1.0 * INCH, 0.063 * INCH)
    beam = gb.Beam(line.length, section, material, line=line, rotary_inertia=True)
    hub = gb.Hub(radius=2.5 * INCH, rate=rate * 2 * np.pi / 60 + 1e-9)
    modes = gb.modes(gb.assemble(beam, "exact", axial=2, y=6, z=12, twist=6), hub)
    return np.asarray(modes.frequency[np.array(modes.direction) == "z"][:3])


@pytest.mark.parametrize("sweep", MEASURED)
def test_a_swept_tip_lowers_the_frequencies_as_measured(sweep: int) -> None:
    """Within 10 %, by which all of them are higher than any beam of this thickness has, straight and at rest too."""
    computed = np.stack([flapping(sweep, rate) for rate in RATES], axis=1)
    np.testing.assert_allclose(computed, MEASURED[sweep], rtol=0.11, atol=0.2)
    if sweep:  # beside the straight blade, at the highest rate, the strip's thickness does not matter
        straight = flapping(0.0, RATES[2])
        shares = computed[:, 2] / straight
        expected = [MEASURED[sweep][k][2] / MEASURED[0][k][2] for k in range(3)]
        np.testing.assert_allclose(shares, expected, rtol=0.065)
