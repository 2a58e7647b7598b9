"""Beams that tests share, in few sizes: structures of equal sizes share their compiled programs.

Those of the literature are validation.published.specimens'; these have bodies, springs and loads.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from gbeam import Line, Load, Model, PointMass, Root, Section, Structure, assemble
from validation.published import hubbeam2009 as hub_beam_2009
from validation.published import zhang2020
from validation.published.specimens import ALUMINIUM as ALUMINIUM
from validation.published.specimens import BOX as BOX
from validation.published.specimens import METAL as METAL
from validation.published.specimens import STRIP as STRIP
from validation.published.specimens import appendage as appendage
from validation.published.specimens import hub_beam as hub_beam
from validation.published.specimens import strip as strip
from validation.published.specimens import strip_beam as strip_beam

HUB_RADIUS, HUB_INERTIA = hub_beam_2009.HUB_RADIUS, hub_beam_2009.HUB_INERTIA
LENGTH = hub_beam_2009.LENGTH
RHO_A = hub_beam_2009.DENSITY * hub_beam_2009.AREA  # kg/m
EI = hub_beam_2009.YOUNG * hub_beam_2009.INERTIA  # N m²
TIP = PointMass(LENGTH, 0.1)
# A body off the axis, with inertia, part of the way along.
BODY = PointMass(5.0, 0.3, inertia=(0.02, 0.03, 0.04), offset=(0.05, -0.1, 0.08))
SPRINGS = Root(translation_x=1e5, translation_z=1e4, rotation_y=1e3, rotation_z=2e3)
LOADS = (
    Load(3.0, force=(1.0, 2.0, 3.0), moment=(0.3, 0.2, 0.1), follower=True),
    Load(distributed=(0.1, 0.2, 0.3), distributed_moment=(0.03, 0.02, 0.01)),
)
# Turned at the root, bent and twisted, with a corner midway.
BOW = Line.of_pieces(
    [0.0, 0.4 * LENGTH, 0.0, 0.6 * LENGTH],
    twist=[0.2, 0.5, 0.1, -0.3],
    turn_y=[0.3, -0.8, 0.2, 0.4],
    turn_z=[-0.2, 0.7, 0.5, 0],
)
# A wind turbine's blade, coupled in all strains, its mass beside the axis (GXBeam.jl's test wind-turbine-blade).
_UPPER = [
    [2.389e9, 1.524e6, 6.734e6, -3.382e7, -2.627e7, -4.736e8],
    [4.334e8, -3.741e6, -2.935e5, 1.527e7, 3.835e5],
    [2.743e7, -4.592e5, -6.869e5, -4.742e6],
    [2.167e7, -6.279e5, 1.430e6],
    [1.970e7, 1.209e7],
    [4.406e8],
]
BLADE_STIFFNESS, BLADE_MASS = np.zeros((6, 6)), np.diag([258.053, 258.053, 258.053, 48.59, 2.172, 46.418])
for _row, _values in enumerate(_UPPER):
    BLADE_STIFFNESS[_row, _row:] = BLADE_STIFFNESS[_row:, _row] = _values
for _i, _j, _value in ((0, 4, 7.07839), (0, 5, -71.6871), (1, 3, -7.07839), (2, 3, 71.6871)):
    BLADE_MASS[_i, _j] = BLADE_MASS[_j, _i] = _value
BLADE = Section.of_matrices(BLADE_STIFFNESS / 1e4, BLADE_MASS / 100)
COMPLETE = ("CFOAM", "exact")

STRIP_LENGTH, STRIP_DENSITY, STRIP_YOUNG = zhang2020.LENGTH, zhang2020.DENSITY, zhang2020.YOUNG


@cache
def laden(kind: str) -> Structure:
    """Appendage with all there is: a tip mass, a body off its axis, root springs, loads, both directions of bending; as
    a thick beam with every strain and rotary inertia, straight or curved (`bow`, and its Taylor polynomial),
    or with a composite section.
    """
    beam = appendage(TIP, BODY, damping_ratio=0.01, root=SPRINGS, loads=LOADS)
    if kind.startswith("composite"):
        beam = replace(beam, section=BLADE, material=None, rotary_inertia=True, line=BOW)
        model = kind.partition(" ")[2] or "exact"
        return assemble(beam, model, axial=1, y=1, z=1, twist=1, shear_y=1, shear_z=1)
    if kind.startswith(("thick", "bow")):
        section = BOX.altered(torsion_constant=2e-8, shear_coefficient_y=0.8, shear_coefficient_z=0.7)
        beam = replace(beam, section=section, material=replace(METAL, poissons_ratio=0.3), rotary_inertia=True)
        if kind.startswith("bow"):
            beam = replace(beam, line=BOW)
        model = kind.partition(" ")[2] or "exact"
        return assemble(beam, model, axial=1, y=1, z=1, twist=1, shear_y=1, shear_z=1)
    return assemble(beam, Model(kind, 0 if kind == "SFOAM" else 1, 1, 1))


def states(size: int, count: int, scale: float, seed: int) -> np.ndarray:
    """`count` random vectors (count, size)."""
    return np.random.default_rng(seed).normal(size=(count, size)) * scale
