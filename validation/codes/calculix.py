"""Modes of a spinning strip of solid elements, in CalculiX: a static step with large deformations under centrifugal
load, then the vibration about it. The strip is that of 2020, 300 × 20 × 4 mm, with shear and its sections' rotary
inertia in gbeam's exact model. "Mesh" is what elements of twice the size change. CalculiX's stress is linear in Green's
strain, a beam's forces in the stretch ε: the strip has EI (1 + 3 ε) in both codes, which is 0.03 % of a frequency at
300 rad/s ("as stretched"), and of the tip's stretch 3/2 ∫ε² is taken off.

With Poisson's ratio a clamp also holds the section's shape, and a strip five times as wide as thick begins to bend like
a plate: what gbeam states for it beside its answer is "stated". A root that frees the width (it does not move along the
strip, and on average neither across nor about its axis) is a beam's. There spin pulls the sections apart by ρΩ²b²/12 on
average, which shortens the tip by ν times that, and where waves are short beside the width the strip bends across less.
The latter is of the order of what shear does, and Hutchinson's shear coefficients (Journal of Applied Mechanics 68,
2001, 87-92) have it, 3.816 for bending about the width and 0.8667 about the thickness, where Cowper's have 0.8497 for
both. Given these the beam has the solids' frequencies; "Cowper's" says what it has without.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import simpson

import gbeam as gb
from gbeam import Modes
from validation.codes.calculix_beam import Answer, Spin, Strip, solve
from validation.table import Row

TITLE = "CalculiX: a spinning strip of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy")
CLOSE = 2e-4
STRIP = Strip(0.3, 0.02, 0.004, 2700.0, 70e9, 0.0)
RADIUS = 0.1  # m, of the hub
GRIPPED = "the root holds the section's width"
SOURCE = "{} × {} × {} C3D20R".format(*STRIP.elements)


def rows() -> Iterator[Row]:
    """At rest, spinning, set at an angle, with Poisson's ratio; about its own axis with Coriolis' force."""
    yield from case("at rest", STRIP, 0.0, 0.0)
    yield from case("300 rad/s", STRIP, 300.0, 0.0)
    yield from case("300 rad/s, set at 45°", STRIP, 300.0, 45.0)
    yield from case("300 rad/s, Poisson's ratio 0.3", replace(STRIP, poisson=0.3), 300.0, 0.0)
    yield from case(
        "300 rad/s, Poisson's ratio 0.3, width free", replace(STRIP, poisson=0.3, gripped=False), 300.0, 0.0
    )
    yield from about_its_axis()


def stretch(strip: Strip, rate: float, x: np.ndarray) -> np.ndarray:
    """Stretch (p,) that a spin about RADIUS makes at positions (p,)."""
    reach = RADIUS * (strip.length - x) + (strip.length**2 - x**2) / 2
    return rate**2 * strip.density / strip.modulus * reach


def hutchinson(depth: float, width: float, ratio: float) -> float:
    """Shear coefficient of a rectangle that bends in the plane of its depth."""
    a, b, n = depth / 2, width / 2, np.pi * np.arange(1, 200)
    series = np.sum(16 * ratio**2 * b**5 * (n * a - b * np.tanh(n * a / b)) / (n**5 * (1 + ratio)))
    c4 = 4 / 45 * a**3 * b * (-12 * a**2 - 15 * ratio * a**2 + 5 * ratio * b**2) + series
    return float(-2 * (1 + ratio) / (9 / (4 * a**5 * b) * c4 + ratio * (1 - (b / a) ** 2)))


def beam(strip: Strip, rate: float = 0.0, shapes: int = 9) -> gb.Structure:
    """The strip in gbeam, with the bending stiffness of Green's strain where a spin about RADIUS stretches it, and
    Hutchinson's shear coefficients where its width is free.
    """
    x = np.linspace(0.0, strip.length, 31)
    width, thickness = strip.width, strip.thickness
    area, factor = width * thickness, 1 + 3 * stretch(strip, rate, x)
    solid = gb.Section.rectangle(width, thickness)
    y, z = solid.shear_coefficients(x, strip.poisson)
    if not strip.gripped:
        y, z = 0 * x + hutchinson(width, thickness, strip.poisson), 0 * x + hutchinson(thickness, width, strip.poisson)
    section = gb.Section.general(
        area + 0 * x,
        area * thickness**2 / 12 * factor,
        area * width**2 / 12 * factor,
        x,
        torsion_constant=solid.torsion_constant(x),
        shear_coefficient_y=y,
        shear_coefficient_z=z,
    )
    metal = gb.Material(strip.density, strip.modulus, poissons_ratio=strip.poisson)
    of_beam = gb.Beam(strip.length, section if rate else solid, metal)
    return gb.assemble(of_beam, "exact", axial=6, y=shapes - 1, z=shapes, shear_y=5, shear_z=6)


def case(words: str, strip: Strip, rate: float, degrees: float) -> Iterator[Row]:
    """On a hub that turns about its z; Coriolis' force, which couples stretch and chord, left out."""
    angle = np.deg2rad(degrees)
    spin = Spin(rate, (-RADIUS, 0.0, 0.0), (0.0, np.sin(angle), np.cos(angle))) if rate else None
    theirs, coarser = solve(strip, spin), solve(replace(strip, elements=(40, 2, 1)), spin)
    hub = gb.Hub(radius=RADIUS, rate=rate, setting_angle=angle)
    plain = beam(strip) if strip.gripped else beam(replace(strip, gripped=True), rate)
    ours, others = (gb.modes(each, hub, gyroscopic=False) for each in (beam(strip, rate), plain))
    if rate:
        x = np.linspace(0.0, strip.length, 31)
        tip = gb.static(beam(strip), hub).tip[0] - 1.5 * simpson(stretch(strip, rate, x) ** 2, x=x)
        if not strip.gripped:
            pulled = strip.density * (rate * strip.width) ** 2 / 12
            tip -= strip.poisson * pulled / strip.modulus * strip.length
        reason = GRIPPED if strip.poisson and strip.gripped else ""
        yield Row(words, "stretch of the tip", 1e6 * theirs.stretch, 1e6 * tip, "µm", CLOSE, SOURCE, reason)
    for direction, name, count in (("z", "flap", 3), ("y", "chord", 2)):
        for n in range(count):
            reference, mesh, computed, other = (of_direction(e, direction)[n] for e in (theirs, coarser, ours, others))
            remark = f"mesh {100 * (mesh / reference - 1):+.1g} %"
            if rate:
                stretched, cowpers = computed / other - 1, other / reference - 1
                what = f"{100 * stretched:+.1g} % as stretched" if strip.gripped else f"Cowper's {100 * cowpers:+.1g} %"
                remark = f"{what}; {remark}"
            if strip.poisson and strip.gripped and others.errors is not None:
                stated = 100 * others.errors.total[list(others.frequency).index(other)]
                remark = f"{GRIPPED}{f': {stated:.1g} % stated' if direction == 'z' else ''}; {remark}"
            yield Row(words, f"{name} {n + 1}", reference, computed, "Hz", CLOSE, SOURCE, remark)


def of_direction(modes: Answer | Modes, direction: str) -> list[float]:
    """Frequencies of the modes in a direction."""
    return [f for f, d in zip(modes.frequency, modes.direction, strict=True) if d == direction]


def about_its_axis() -> Iterator[Row]:
    """Spinning about x, Coriolis' force couples both directions: the whirling of a shaft."""
    rate = 150.0
    theirs = solve(STRIP, Spin(rate, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), coriolis=True).frequency
    flight = gb.Flight(acceleration=gb.constant(np.zeros(3)), rates=gb.constant(np.array([rate, 0.0, 0.0])))
    ours = gb.modes(beam(STRIP), flight).frequency
    for i in range(3):
        yield Row(f"{rate:g} rad/s about its own axis", f"frequency {i + 1}", theirs[i], ours[i], "Hz", CLOSE, SOURCE)
