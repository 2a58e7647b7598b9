"""Beams of the literature that rows and tests share, and what their bases do.

The hub, appendage and tip mass of 2009 (Table 1), the 300 mm strip of 2020 (Table 1), the blade without dimensions of
Wright et al., and the robot arm of Simo and Vu-Quoc. Few sizes: structures of equal sizes share compiled programs.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import scipy.linalg

from gbeam import (
    Beam,
    Centrifuge,
    Flight,
    Hub,
    Material,
    Model,
    PointMass,
    Response,
    ResponseSettings,
    Section,
    Sine,
    SmoothStep,
    Structure,
    assemble,
    simulate,
)
from gbeam.analysis import Drive, settled, subject_of
from gbeam.mechanics import Coefficients
from gbeam.results import Base
from validation.published import hubbeam2009, zhang2020

PLANAR = (8, 9, 0)  # of the exact model in a plane: statics share a size
EXACT_2009 = (2, 5)  # strain and rotation shapes: 1e-5 of the peak
FREE_HUB = Hub(radius=hubbeam2009.HUB_RADIUS, inertia=hubbeam2009.HUB_INERTIA)

METAL = Material(hubbeam2009.DENSITY, hubbeam2009.YOUNG)
BOX = Section.general(hubbeam2009.AREA, hubbeam2009.INERTIA, hubbeam2009.INERTIA)
STRIP = Section.rectangle(zhang2020.WIDTH, zhang2020.THICKNESS)
ALUMINIUM = Material(zhang2020.DENSITY, zhang2020.YOUNG)
ARM_2020, MIDDLE_2020 = 3.3, 0.15  # m; the arm follows from the excess at 6 g, the paper does not give it


def appendage(*masses: PointMass, damping_ratio: Any = 0.0, **more: Any) -> Beam:
    """The beam of 2009 with bodies."""
    return Beam(hubbeam2009.LENGTH, BOX, METAL, masses, damping_ratio, **{"rotary_inertia": False, **more})


@cache
def hub_beam(
    kind: str,
    axial: int = 1,
    y: int = 3,
    z: int = 0,
    *,
    mass: float = 0.1,
    at: float = hubbeam2009.LENGTH,
    damping_ratio: float = 0.0,
    shapes: str = "clamped-free",
) -> Structure:
    """Hub beam with one point mass, zero or not, in a model."""
    return assemble(appendage(PointMass(at, mass), damping_ratio=damping_ratio), Model(kind, axial, y, z, shapes))


def slew(
    kind: str, counts: tuple[int, int], rate: float, mass: float = 0.0, duration: float = 50.0, **how: Any
) -> Response:
    """A smooth step of the hub's rate over 30 s, 2009 (43)."""
    motion = Hub(radius=hubbeam2009.HUB_RADIUS, rate=SmoothStep(rate, 30.0))
    settings = ResponseSettings(duration=duration, **{"residual_from": 30.0, **how})
    return simulate(hub_beam(kind, *counts, mass=mass), motion, settings)


def pulse(kind: str, counts: tuple[int, int], torque: float, mass: float = 0.0, **how: Any) -> Response:
    """One sine of the hub's torque over 10 s, 2009 (44)."""
    drive = Hub(radius=hubbeam2009.HUB_RADIUS, inertia=hubbeam2009.HUB_INERTIA, torque=Sine(torque, 10.0))
    settings = ResponseSettings(duration=20.0, residual_from=10.0, **{"step": 5e-3, **how})
    return simulate(hub_beam(kind, *counts, mass=mass), drive, settings)


def strip_beam(**more: Any) -> Beam:
    """The specimen of 2020."""
    return Beam(zhang2020.LENGTH, STRIP, ALUMINIUM, **{"rotary_inertia": False, **more})


@cache
def strip(kind: str = "FOAM", axial: int = 0, y: int = 0, z: int = 2, *, damping_ratio: float = 0.0) -> Structure:
    """The specimen of 2020 in a model."""
    return assemble(strip_beam(damping_ratio=damping_ratio), Model(kind, axial, y, z))


def flight_2020(level: float) -> Flight:
    """A steady load along z, multiples of the paper's g."""
    return Flight(z=level * zhang2020.G0)


def centrifuge_2020(level: float, control_point: float = MIDDLE_2020) -> Centrifuge:
    """The machine that imitates it."""
    return Centrifuge(
        flight_2020(level), arm=ARM_2020, control_point=control_point, inverse="flat", gravity=False, span=(0.0, 1.0)
    )


def unit_beam(slenderness: float = 1000.0, tip: float = 0.0) -> Beam:
    """Unit length, unit mass per length and unit EI, EA = slenderness²; frequencies come without dimensions."""
    inertia, modulus = slenderness**-2, slenderness**2
    section, material = Section.general(1.0, inertia, inertia), Material(1.0, modulus)
    return Beam(1.0, section, material, [PointMass(1.0, tip)], 0.0, rotary_inertia=False)


@cache
def unit_coefficients(counts: tuple[int, int, int], slenderness: float = 1000.0, tip: float = 0.0) -> Coefficients:
    """FOAM's of the unit beam."""
    return assemble(unit_beam(slenderness, tip), Model("FOAM", *counts)).coefficients


@cache
def exact_unit_beam(slenderness: float) -> Structure:
    """The unit beam in the exact model, in a plane."""
    return assemble(unit_beam(slenderness), Model("exact", *PLANAR))


@cache
def robot_arm(counts: tuple[int, int, int] = (2, 5, 0)) -> Structure:
    """EA = 2.8e7 N, EI = 1.4e4 N m², ρA = 1.2 kg/m, L = 10 m; shear (GA = 1e7 N) and rotary inertia are left out."""
    section = Section.general(4e-4, 2e-7, 2e-7)
    none = PointMass(10.0, 0.0)  # the size of 2009's beam
    beam = Beam(10.0, section, Material(3000.0, 7e10), [none], 0.0, rotary_inertia=False)
    return assemble(beam, Model("exact", *counts))


def spinning(rate: float, axis: int, radius: float = 0.0) -> Base:
    """Steady rotation about y (axis 1) or z (axis 2)."""
    return Base(np.array([-radius * rate**2, 0.0, 0.0]), rate * np.eye(3)[axis], np.zeros(3))


def frequencies(c: Coefficients, base: Base, count: int) -> np.ndarray:
    """Lowest circular frequencies of M q̈ + G q̇ + K q = 0, rad/s."""
    G, K, _ = c.evaluate(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
    return gyroscopic_frequencies(c.mass, G, K, count)


def vibration_about_equilibrium(s: Structure, base: Base, count: int) -> np.ndarray:
    """Vibration about the relative equilibrium of a complete model."""
    at = settled(subject_of(s, None).system, Drive(base=base)).linear
    return gyroscopic_frequencies(at.mass, at.velocity, at.stiffness, count)


def gyroscopic_frequencies(M: np.ndarray, G: np.ndarray, K: np.ndarray, count: int) -> np.ndarray:
    """Lowest circular frequencies of a stable conservative system."""
    n = len(M)
    rates = scipy.linalg.eigvals(
        np.block([[np.zeros((n, n)), np.eye(n)], [-K, -G]]), scipy.linalg.block_diag(np.eye(n), M)
    )
    assert np.abs(rates.real).max() < 1e-6 * np.abs(rates).max()  # stable
    return np.sort(rates.imag[rates.imag > 0])[:count]
