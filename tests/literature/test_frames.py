"""Frames of beams: lateral buckling of a right-angle frame (Argyris and others 1979; Simo and Vu-Quoc 1986)."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb

# 240 x 30 x 0.6 mm, E = 71 240 N/mm², nu = 0.31, with the torsion constant b t³/3 of a thin strip, as in both papers.
SECTION = gb.Section.general(
    18e-6, 0.54e-12, 1350e-12, torsion_constant=2.16e-12, shear_coefficient_y=5 / 6, shear_coefficient_z=5 / 6
)
LEG = gb.Beam(0.24, SECTION, gb.Material(2700.0, 71.24e9, poissons_ratio=0.31), damping_ratio=0.0, rotary_inertia=True)
CRITICAL = 1.088  # N, at the free end, in the plane of the frame


def _square(load: float) -> float:
    """Square of the lowest frequency of the frame under a load at its end."""
    leg = gb.assemble(LEG, "exact", y=1, z=4, twist=4)
    corner = gb.Joint("fixed", "second", "first.tip", turn=(0.0, 0.0, -np.pi / 2))
    joints = {"clamp": gb.Joint("fixed", "first"), "corner": corner}
    push = {"push": gb.PointForce("second.tip", (load, 0.0, 0.0))}
    return float(gb.modes(gb.System({"first": leg, "second": leg}, joints, push)).frequency[0] ** 2)


def test_right_angle_frame_buckles_sideways() -> None:
    loads = [1.0, 1.05, 1.08]  # from where the square of the lowest frequency is nearly straight in the load
    roots = np.roots(np.polyfit(loads, [_square(load) for load in loads], 2))
    assert roots[np.abs(roots - 1.08).argmin()] == pytest.approx(CRITICAL, rel=1e-3)
