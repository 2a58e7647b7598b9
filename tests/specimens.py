"""Beams that tests share, in few sizes: structures of equal sizes share their compiled programs.

The hub, appendage and tip mass of 2009 (Table 1), and the 300 mm strip of 2020 (Table 1).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from gbeam import Beam, Load, Material, Model, PointMass, Root, Section, Structure, assemble

from .literature import hubbeam2009 as hub_beam_2009
from .literature import zhang2020

HUB_RADIUS, HUB_INERTIA = hub_beam_2009.HUB_RADIUS, hub_beam_2009.HUB_INERTIA
LENGTH = hub_beam_2009.LENGTH
METAL = Material(hub_beam_2009.DENSITY, hub_beam_2009.YOUNG)
BOX = Section.general(hub_beam_2009.AREA, hub_beam_2009.INERTIA, hub_beam_2009.INERTIA)
RHO_A = hub_beam_2009.DENSITY * hub_beam_2009.AREA  # kg/m
EI = hub_beam_2009.YOUNG * hub_beam_2009.INERTIA  # N m²
TIP = PointMass(LENGTH, 0.1)
# A body off the axis, with inertia, part of the way along.
BODY = PointMass(5.0, 0.3, inertia=(0.02, 0.03, 0.04), offset=(0.05, -0.1, 0.08))
SPRINGS = Root(translation_x=1e5, translation_z=1e4, rotation_y=1e3, rotation_z=2e3)
LOADS = (
    Load(3.0, force=(1.0, 2.0, 3.0), moment=(0.3, 0.2, 0.1), follower=True),
    Load(None, force=(0.1, 0.2, 0.3), moment=(0.03, 0.02, 0.01)),
)
COMPLETE = ("CFOAM", "exact")

STRIP_LENGTH, STRIP_DENSITY, STRIP_YOUNG = zhang2020.LENGTH, zhang2020.DENSITY, zhang2020.YOUNG
STRIP = Section.rectangle(zhang2020.WIDTH, zhang2020.THICKNESS)
ALUMINIUM = Material(STRIP_DENSITY, STRIP_YOUNG)


def appendage(*masses: PointMass, damping_ratio: Any = 0.0, **more: Any) -> Beam:
    """The beam of 2009 with bodies."""
    return Beam(LENGTH, BOX, METAL, masses, damping_ratio, **more)


@cache
def hub_beam(
    kind: str,
    axial: int = 1,
    y: int = 3,
    z: int = 0,
    *,
    mass: float = 0.1,
    at: float = LENGTH,
    damping_ratio: float = 0.0,
    shapes: str = "clamped-free",
) -> Structure:
    """That beam with one point mass, zero or not, in a model."""
    return assemble(appendage(PointMass(at, mass), damping_ratio=damping_ratio), Model(kind, axial, y, z, shapes))


@cache
def laden(kind: str) -> Structure:
    """The same with all there is: a tip mass, a body off its axis, root springs, loads, both directions of bending."""
    axial = 0 if kind == "SFOAM" else 1
    return assemble(appendage(TIP, BODY, damping_ratio=0.01, root=SPRINGS, loads=LOADS), Model(kind, axial, 1, 1))


def strip_beam(**more: Any) -> Beam:
    """The specimen of 2020."""
    return Beam(STRIP_LENGTH, STRIP, ALUMINIUM, **more)


@cache
def strip(kind: str = "FOAM", axial: int = 0, y: int = 0, z: int = 2, *, damping_ratio: float = 0.0) -> Structure:
    """The specimen of 2020 in a model."""
    return assemble(strip_beam(damping_ratio=damping_ratio), Model(kind, axial, y, z))


def states(size: int, count: int, scale: float, seed: int) -> np.ndarray:
    """`count` random vectors (count, size)."""
    return np.random.default_rng(seed).normal(size=(count, size)) * scale
