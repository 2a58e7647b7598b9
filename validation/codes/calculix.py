"""Modes of a spinning strip of solid elements, in CalculiX: a static step with large deformations under centrifugal
load, then the vibration about it. The strip is that of 2020, 300 × 20 × 4 mm. Solids have what gbeam leaves out, shear
and the sections' rotary inertia: "expected" is the difference that these two make to first order, from the mode at
rest with a shear correction of 5/6, and it counts as the reason only of a difference that is near to it. "Mesh" is what
elements of twice the size change. With Poisson's ratio the clamped root also holds the section's shape, and a strip
five times as wide as thick begins to bend like a plate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

import gbeam as gb
from gbeam.results.modal import Modes
from validation.codes.calculix_beam import Answer, Spin, Strip, solve
from validation.table import Row

TITLE = "CalculiX: a spinning strip of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy")
CLOSE = 2e-4
STRIP = Strip(0.3, 0.02, 0.004, 2700.0, 70e9, 0.0)
SIZES = {"y": STRIP.width, "z": STRIP.thickness}  # of the section along a mode's direction
SOURCE = "{} × {} × {} C3D20R".format(*STRIP.elements)


def rows() -> Iterator[Row]:
    """At rest, spinning, set at an angle, with Poisson's ratio; about its own axis with Coriolis' force."""
    yield from case("at rest", STRIP, 0.0, 0.0)
    yield from case("300 rad/s", STRIP, 300.0, 0.0)
    yield from case("300 rad/s, set at 45°", STRIP, 300.0, 45.0)
    yield from case("300 rad/s, Poisson's ratio 0.3", replace(STRIP, poisson=0.3), 300.0, 0.0)
    yield from about_its_axis()


def beam() -> gb.Structure:
    """The strip in gbeam."""
    section = gb.Section.rectangle(STRIP.width, STRIP.thickness)
    return gb.assemble(
        gb.Beam(STRIP.length, section, gb.Material(STRIP.density, STRIP.modulus)), "FOAM", axial=20, y=6, z=8
    )


def case(words: str, strip: Strip, rate: float, degrees: float) -> Iterator[Row]:
    """On a hub of radius 0.1 m that turns about its z; Coriolis' force, which couples stretch and chord, left out."""
    angle, radius = np.deg2rad(degrees), 0.1
    spin = Spin(rate, (-radius, 0.0, 0.0), (0.0, np.sin(angle), np.cos(angle))) if rate else None
    theirs, coarser = solve(strip, spin), solve(replace(strip, elements=(40, 2, 1)), spin)
    structure, hub = beam(), gb.Hub(radius=radius, rate=rate, setting_angle=angle)
    ours = gb.modes(structure, hub, gyroscopic=False)
    if rate:
        tip = gb.static(structure, hub).tip[0]
        reason = "the root holds the section's width" if strip.poisson else "Green's strain in the solids"
        yield Row(words, "stretch of the tip", 1e6 * theirs.stretch, 1e6 * tip, "µm", CLOSE, SOURCE, reason)
    for direction, name, count in (("z", "flap", 3), ("y", "chord", 2)):
        for n in range(count):
            reference, mesh, found = (of_direction(each, direction)[n] for each in (theirs, coarser, ours))
            remark = reason_of(direction, n, strip, reference, found)
            if remark:
                remark += f"; mesh {100 * (mesh / reference - 1):+.1g} %"
            yield Row(words, f"{name} {n + 1}", reference, found, "Hz", CLOSE, SOURCE, remark)


def of_direction(modes: Answer | Modes, direction: str) -> list[float]:
    """Frequencies of the modes in a direction."""
    return [f for f, d in zip(modes.frequency, modes.direction, strict=True) if d == direction]


def reason_of(direction: str, n: int, strip: Strip, reference: float, found: float) -> str:
    """What makes a frequency differ; empty where shear and rotary inertia do not account for it."""
    expected = shear_and_rotary(direction, n, strip.poisson, found)
    near = abs(found / reference - 1 - expected) < 0.1 * expected + CLOSE / 2
    words = f"shear and rotary inertia: {100 * expected:+.2g} % expected"
    if strip.poisson:
        return words + ", less Poisson's stiffening"
    return words if near else ""


def about_its_axis() -> Iterator[Row]:
    """Spinning about x, Coriolis' force couples both directions: the whirling of a shaft."""
    rate = 150.0
    theirs = solve(STRIP, Spin(rate, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), coriolis=True).frequency
    flight = gb.Flight(acceleration=gb.constant(np.zeros(3)), rates=gb.constant(np.array([rate, 0.0, 0.0])))
    ours = gb.modes(beam(), flight).frequency
    for i, (direction, n) in enumerate((("z", 0), ("y", 0), ("z", 1))):
        remark = reason_of(direction, n, STRIP, theirs[i], ours[i])
        yield Row(f"{rate:g} rad/s about its own axis", f"frequency {i + 1}", theirs[i], ours[i], "Hz", CLOSE, SOURCE,
                  remark)  # fmt: skip


def bending_root(n: int) -> float:
    """Of cos λ cosh λ = −1."""
    return brentq(lambda z: np.cos(z) + 1 / np.cosh(z), (n + 0.2) * np.pi, (n + 0.8) * np.pi)


def bending_frequency(direction: str, n: int) -> float:
    """Of the beam at rest, Hz."""
    radius = SIZES[direction] / np.sqrt(12)
    return (bending_root(n) / STRIP.length) ** 2 * radius * np.sqrt(STRIP.modulus / STRIP.density) / (2 * np.pi)


def shear_and_rotary(direction: str, n: int, poisson_ratio: float, frequency: float) -> float:
    """Part by which shear (with bending's share of the stiffness) and rotary inertia lower a frequency, Hz."""
    root = bending_root(n)
    at_rest = bending_frequency(direction, n)
    x, step = np.linspace(0, 1, 4001, retstep=True)
    sigma, z = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root)), root * x
    value = np.cosh(z) - np.cos(z) - sigma * (np.sinh(z) - np.sin(z))
    slope = root * (np.sinh(z) + np.sin(z) - sigma * (np.cosh(z) - np.cos(z)))
    curvature = root**2 * (np.cosh(z) + np.cos(z) - sigma * (np.sinh(z) + np.sin(z)))
    shear = root**3 * (np.sinh(z) - np.sin(z) - sigma * (np.cosh(z) + np.cos(z)))
    squares = [np.trapezoid(f**2, dx=step) for f in (value, slope, curvature, shear)]
    thin = SIZES[direction] ** 2 / 12 / STRIP.length**2
    give = 2 * (1 + poisson_ratio) * 6 / 5
    return 0.5 * thin * ((at_rest / frequency) ** 2 * give * squares[3] / squares[2] + squares[1] / squares[0])
