"""Sections by stiffness and mass matrices against BeamDyn's and Kynema's composite beams.

Q. Wang, M. A. Sprague, J. Jonkman, N. Johnson and B. Jonkman, BeamDyn: a high-fidelity wind turbine blade solver in the
FAST modular framework, Wind Energy 20 (2017) 1439-1462. Numbers are those of Kynema's tests of verification
(static_composite_beam_bending and its twisted one), which print BeamDyn's too: equal to 1e-12.
"""

from __future__ import annotations

import numpy as np

import gbeam as gb

LENGTH = 10.0
UNIT = np.diag([1.0, 1.0, 1.0, 2.0, 1.0, 1.0])  # a mass, which bends nothing


def tip(stiffness: np.ndarray, force: float, line: gb.Line | None = None) -> np.ndarray:
    load = gb.Load(LENGTH, force=(0.0, 0.0, force))
    section = gb.Section.of_matrices(stiffness, UNIT)
    beam = gb.Beam(LENGTH, section, rotary_inertia=True, loads=[load], line=line)
    shapes = {"axial": 8, "y": 9, "z": 9, "twist": 9, "shear_y": 8, "shear_z": 8}
    return np.asarray(gb.static(gb.assemble(beam, "exact", **shapes)).tip)


def test_a_composite_beam_bends_and_twists_by_its_matrix() -> None:
    """A box with layers that couple bending and twist, under 150 lb at its tip."""
    stiffness = 1e3 * np.diag([1368.17, 88.56, 38.78, 16.96, 59.12, 141.47])
    for i, j, value in ((3, 4, 17.61), (3, 5, -0.351), (4, 5, -0.37)):
        stiffness[i, j] = stiffness[j, i] = 1e3 * value
    expected = -9.02726627566299e-02, -6.47488486259036e-02, 1.22973648292371
    np.testing.assert_allclose(tip(stiffness, 150.0), expected, rtol=1e-9)


def test_a_twisted_beam_bends_as_beamdyns() -> None:
    """Twisted by 90 degrees, under 4000 kN; a solid model has (-1.134192, -1.714467, -3.58423) m."""
    stiffness = np.diag([2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8])
    line = gb.Line.of_pieces([LENGTH], twist=np.pi / 2)
    answer = tip(stiffness, -4000e3, line)
    np.testing.assert_allclose(answer, (-1.14152599953942, -1.71805334646388, -3.59321324026952), rtol=1e-7)
    np.testing.assert_allclose(answer, (-1.134192, -1.714467, -3.58423), rtol=0.007)
