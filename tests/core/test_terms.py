"""The residual of a linear model as one product is the residual."""

from __future__ import annotations

import numpy as np

import gbeam as gb
from gbeam.analysis.response.differentiated import coefficient_matrix, terms
from gbeam.motion import Base

from ..specimens import ALUMINIUM, STRIP


def test_terms_times_coefficients_are_the_residual_in_three_dimensions_under_a_load() -> None:
    load = gb.Load(at=0.2, force=gb.vector(z=gb.constant(1.0)))
    beam = gb.Beam(0.3, STRIP, ALUMINIUM, [gb.PointMass(0.25, 0.1)], damping_ratio=0.02, loads=[load])
    structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    c, random, count = structure.coefficients, np.random.default_rng(7), 5
    q, qd, qdd = random.standard_normal((3, count, structure.size))
    base = Base(*random.standard_normal((3, count, 3)))
    loads = random.standard_normal((count, 1, 6))
    answer = terms(q, qd, qdd, base, loads) @ coefficient_matrix(c, loaded=True)
    for k in range(count):
        one = c.residual(q[k], qd[k], qdd[k], base.a_WO_B[k], base.w_WB_B[k], base.alpha_WB_B[k], loads[k])
        np.testing.assert_allclose(answer[k], one, rtol=1e-12, atol=1e-12 * np.abs(one).max())
