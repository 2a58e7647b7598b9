"""A strip on the rim of a wheel buckles by the wheel's rotation: sideways where it points along the rim on edge, as a
column where it points inward. Far from the axis its load is even, as of Timoshenko and Gere (Theory of Elastic
Stability, 6.3 and 2.12): 12.85 √(EI GJ)/L³ and 7.837 EI/L³.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import jv

import gbeam as gb

LENGTH, WIDTH, THICKNESS = 0.5, 0.05, 0.0005
ALUMINIUM = gb.Material(2700.0, 70e9, poissons_ratio=0.33)
STRIP = gb.Beam(LENGTH, gb.Section.rectangle(WIDTH, THICKNESS), ALUMINIUM, damping_ratio=0.0)
LINE = 2700.0 * WIDTH * THICKNESS  # kg/m
_, _, _, TORSION, SOFT, _ = (float(each) for each in STRIP.stiffnesses(0.0))


def test_a_strip_on_edge_along_the_rim_buckles_sideways() -> None:
    """The gap to an even load, by tension along the strip and the load's spread, falls as length over radius."""
    factor = 6 * brentq(lambda x: jv(-1 / 6, x), 1.5, 2.5)  # 12.85
    structure = gb.assemble(STRIP, "exact", axial=0, y=2, z=6, twist=6)

    def of_even_load(radius: float, *, twist: bool = True) -> float | None:
        """Load at the root, ρA Ω² R, over √(EI GJ)/L³."""
        scale = np.sqrt(SOFT * TORSION) / LENGTH**3 / (LINE * radius)
        wheel = gb.RigidBody(1.0, (1.0, 1.0, 1.0), points={"rim": (radius, 0.0, 0.0)})
        joints = {
            "spin": gb.Joint("revolute", "wheel", axes=[(0, 0, 1)], rate=gb.constant(1.0)),
            "clamp": gb.Joint("fixed", "strip", on="wheel.rim", turn=(0, 0, np.pi / 2)),
        }
        of = structure if twist else gb.assemble(STRIP, "exact", axial=0, y=2, z=6)
        critical = gb.critical_speed(
            gb.System({"wheel": wheel, "strip": of}, joints), turning="spin.angle", upper=2 * np.sqrt(factor * scale)
        )
        assert critical.value is None or (critical.kind, critical.direction) == ("divergence", "strip z")
        return None if critical.value is None else critical.value**2 / scale

    near, far = of_even_load(100 * LENGTH), of_even_load(1000 * LENGTH)
    assert near is not None and far is not None
    assert near / factor - 1 == pytest.approx(7.0e-3, rel=0.05) and far / factor - 1 == pytest.approx(9e-4, rel=0.1)
    # What is left is the strip's bending on edge before, EI_y/EI_z = 1e-4 and GJ/EI_z = 1.5e-4, as under a dead load.
    assert 1 < (far + (far - near) / 9) / factor < 1 + 3e-4
    assert of_even_load(100 * LENGTH, twist=False) is None


@pytest.mark.parametrize("radius", [1.0, 2.0, 10.0, 1000.0])
def test_a_strip_that_points_inward_buckles_as_a_column(radius: float) -> None:
    """EI w'''' + (N w')' = 0 with N = ρA Ω² ∫ (R − s) ds from x to L, out of the wheel's plane."""

    def at_tip(load: float) -> float:
        def change(x: float, y: np.ndarray) -> np.ndarray:
            push = load * ((radius - 1) * (1 - x) + (1 - x) ** 2 / 2) / radius
            return np.array([y[1], -push * y[0]])  # of the slope: w''' = −N w', without shear force at the tip

        slope = solve_ivp(change, (0.0, 1.0), [0.0, 1.0], rtol=1e-11, atol=1e-13).y
        return float(slope[1, -1])

    expected = brentq(at_tip, 3.0, 20.0 if radius > 1 else 60.0)
    if radius == 1000.0:
        assert expected == pytest.approx(7.837, rel=1e-3)
    structure = gb.assemble(STRIP, "exact", axial=0, y=0, z=7)
    hub = gb.Hub(radius=radius * LENGTH, pointing="inward")
    scale = np.sqrt(SOFT / (LINE * LENGTH**4 * radius))
    critical = gb.critical_speed(structure, hub, upper=2 * scale * np.sqrt(expected))
    assert critical.value is not None and critical.kind == "divergence"
    assert critical.value**2 / scale**2 == pytest.approx(expected, rel=1e-5)
