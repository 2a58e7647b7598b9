"""Beams of the literature, without dimensions where their source has none: ρA = L = 1, and EI = 1 along z."""

from __future__ import annotations

from functools import cache

from gbeam import Beam, Hub, Material, Model, PointMass, Section, Sine, Structure, assemble, constant

AREA = 1e-2
HUB = Hub(radius=0.0, rate=constant(1.0))
# The beam of 2009 Table 1.
BOX, ALUMINIUM = Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), Material(2766.7, 6.8952e10)
HUB_2009 = Hub(radius=0.5, rate=constant(1.0))
FREE_2009 = Hub(radius=0.5, inertia=200.0, torque=Sine(200.0, 10.0))


def slender(slenderness: float, *masses: PointMass, chord: float = 1.0) -> Beam:
    """ρA = 1, L = 1, EI_y = 1, EI_z = `chord`, EA = slenderness² (λ = sqrt(A L²/I))."""
    e = slenderness**2 / AREA
    section, material = Section.general(AREA, 1 / e, chord / e), Material(1 / AREA, e)
    return Beam(1.0, section, material, masses, rotary_inertia=False)


def beam_2009(mass: float = 0.0, at: float = 8.0, damping_ratio: float = 0.0) -> Beam:
    """The beam of 2009 with a mass."""
    return Beam(8.0, BOX, ALUMINIUM, [PointMass(at, mass)] if mass else [], damping_ratio, rotary_inertia=False)


@cache
def structure_2009(kind: str, axial: int, y: int, z: int = 0, mass: float = 0.0, damping: float = 0.0) -> Structure:
    """The hub beam of 2009 in a model."""
    return assemble(beam_2009(mass, damping_ratio=damping), Model(kind, axial, y, z))
