"""R. H. MacNeal and R. L. Harder, A proposed standard set of problems to test finite element accuracy, Finite Elements
in Analysis and Design 1 (1985) 3-20: the curved beam and the twisted beam.

Their theoretical answers: 0.08734 and 0.5022 of the curved, 0.005424 and 0.001754 of the twisted beam. Of the curved
one Castigliano's theorem for a thin ring gives 0.08860 in the plane and 0.50056 out of it, 1.4 % more and 0.3 % less
than theirs, whose sources they do not name: gbeam has the former to six digits.
"""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb

FORCE = 1e-6  # of their unit force, so that the answer is linear


def tip(beam: gb.Beam, way: tuple[float, float, float]) -> np.ndarray:
    """Displacement of the tip per unit of a force along `way`."""
    loaded = gb.Load(beam.length, force=[FORCE * part for part in way])
    whole = gb.Beam(beam.length, beam.section, beam.material, line=beam.line, rotary_inertia=True, loads=[loaded])
    structure = gb.assemble(whole, "exact", axial=5, y=7, z=7, twist=7, shear_y=5, shear_z=5)
    return np.asarray(gb.static(structure).tip) / FORCE


RADIUS, WIDTH, DEPTH = 4.22, 0.2, 0.1  # from 4.12 to 4.32, and 0.1 out of the plane
CURVED = gb.Material(1.0, 1e7, poissons_ratio=0.25)


def quarter() -> gb.Beam:
    line = gb.Line.of_pieces([RADIUS * np.pi / 2], turn_z=np.pi / 2)
    return gb.Beam(line.length, gb.Section.rectangle(WIDTH, DEPTH), CURVED, line=line)


def test_the_curved_beam_in_its_plane() -> None:
    axial, shear, _, _, _, bending = quarter().stiffnesses(0.0)
    expected = np.pi / 4 * RADIUS * (RADIUS**2 / bending + 1 / axial + 1 / shear)
    answer = tip(quarter(), (1.0, 0.0, 0.0))[0]
    assert answer == pytest.approx(expected, rel=1e-6)
    assert answer == pytest.approx(0.08734, rel=0.015)


def test_the_curved_beam_out_of_its_plane() -> None:
    _, _, shear, torsion, bending, _ = quarter().stiffnesses(0.0)
    turned = np.pi / 4 / bending + (3 * np.pi / 4 - 2) / torsion
    expected = RADIUS**3 * turned + np.pi / 2 * RADIUS / shear
    answer = tip(quarter(), (0.0, 0.0, 1.0))[2]
    assert answer == pytest.approx(expected, rel=1e-6)
    assert answer == pytest.approx(0.5022, rel=0.004)


@pytest.mark.parametrize(("axis", "published"), [(1, 0.005424), (2, 0.001754)])
def test_the_twisted_beam(axis: int, published: float) -> None:
    """12 long, 1.1 wide, 0.32 thick, twisted by 90 degrees; the width lies along z at the root, along y at the tip."""
    line = gb.Line.of_pieces([0.0, 12.0], twist=[np.pi / 2, np.pi / 2])
    beam = gb.Beam(12.0, gb.Section.rectangle(1.1, 0.32), gb.Material(1.0, 29e6, poissons_ratio=0.22), line=line)
    way = np.eye(3)[axis]
    assert tip(beam, (way[0], way[1], way[2]))[axis] == pytest.approx(published, rel=0.005)
