"""K.-J. Bathe and S. Bolourchi, Large displacement analysis of three-dimensional beam structures, International Journal
for Numerical Methods in Engineering 14 (1979) 961-986: a cantilever bent by 45 degrees under a force out of its plane.

Their tip displacement at 600 lb is (-23.5, 13.4, 53.4) in: along the first tangent, away from the centre, out of the
plane. Kynema's test of curved beams (static_composite_beam_bending_curved) has 15 digits, equal to BeamDyn's, of a
parabola through three points of the arc, which is 0.4 % from the arc's own answer.
"""

from __future__ import annotations

import numpy as np

import gbeam as gb

RADIUS, FORCE = 100.0, 600.0
PUBLISHED = -23.5, 13.4, 53.4
KYNEMA = -23.6459716009047, 13.7208006040058, 53.5776450626987
MIDDLE, END = (38.2683, -7.61205), (70.7107, -29.2893)


def tip(line: gb.Line) -> np.ndarray:
    """Displacement of the tip with Kynema's stiffnesses: E A = 1e7, k G A = 4.16667e6, GJ = EI = 8.333e5."""
    moment = 8.333e5 / 1e7
    section = gb.Section.general(
        1.0, moment, moment, torsion_constant=2 * moment, shear_coefficient_y=0.833334, shear_coefficient_z=0.833334
    )
    force = gb.Load(line.length, force=(0.0, 0.0, FORCE))
    material = gb.Material(1.0, 1e7, shear_modulus=5e6)
    beam = gb.Beam(line.length, section, material, line=line, rotary_inertia=True, loads=[force])
    return np.asarray(gb.static(gb.assemble(beam, "exact", axial=4, y=7, z=7, twist=6, shear_y=4, shear_z=4)).tip)


def test_the_bend_of_bathe_and_bolourchi() -> None:
    arc = gb.Line.of_pieces([RADIUS * np.pi / 4], turn_z=-np.pi / 4)
    np.testing.assert_allclose(tip(arc), PUBLISHED, rtol=0.016)


def test_the_parabola_of_kynema_and_beamdyn() -> None:
    slope, bend = np.linalg.solve([[MIDDLE[0], MIDDLE[0] ** 2], [END[0], END[0] ** 2]], [MIDDLE[1], END[1]])
    x = np.linspace(0, END[0], 13)
    line = gb.Line.of_points(np.stack([x, slope * x + bend * x**2, 0 * x], axis=1))
    np.testing.assert_allclose(tip(line), KYNEMA, rtol=2e-6)
