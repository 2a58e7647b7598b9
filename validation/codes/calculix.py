"""Modes of a spinning strip of solid elements, in CalculiX: a static step with large deformations under centrifugal
load, then the vibration about it. The strip is that of 2020, 300 × 20 × 4 mm, with shear and its sections' rotary
inertia in gbeam's exact model. "Mesh" is what elements of twice the size change. CalculiX's stress is linear in Green's
strain, a beam's forces in the stretch ε: the strip has EI (1 + 3 ε) in both codes, which is 0.03 % of a frequency at
300 rad/s ("as stretched"). With Poisson's ratio the clamped root also holds the section's shape, and a strip five times
as wide as thick begins to bend like a plate: what gbeam states for it beside its answer is "stated".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import gbeam as gb
from gbeam.results.modal import Modes
from validation.codes.calculix_beam import Answer, Spin, Strip, solve
from validation.table import Row

TITLE = "CalculiX: a spinning strip of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy")
CLOSE = 2e-4
STRIP = Strip(0.3, 0.02, 0.004, 2700.0, 70e9, 0.0)
RADIUS = 0.1  # m, of the hub
SOURCE = "{} × {} × {} C3D20R".format(*STRIP.elements)


def rows() -> Iterator[Row]:
    """At rest, spinning, set at an angle, with Poisson's ratio; about its own axis with Coriolis' force."""
    yield from case("at rest", STRIP, 0.0, 0.0)
    yield from case("300 rad/s", STRIP, 300.0, 0.0)
    yield from case("300 rad/s, set at 45°", STRIP, 300.0, 45.0)
    yield from case("300 rad/s, Poisson's ratio 0.3", replace(STRIP, poisson=0.3), 300.0, 0.0)
    yield from about_its_axis()


def beam(strip: Strip, rate: float = 0.0, shapes: int = 9) -> gb.Structure:
    """The strip in gbeam, with the bending stiffness of Green's strain where a spin about RADIUS stretches it."""
    x = np.linspace(0.0, strip.length, 31)
    stretch = rate**2 * strip.density / strip.modulus * (RADIUS * (strip.length - x) + (strip.length**2 - x**2) / 2)
    area, thin, wide = strip.width * strip.thickness, strip.thickness**2 / 12, strip.width**2 / 12
    solid = gb.Section.rectangle(strip.width, strip.thickness)
    y, z = solid.shear_coefficients(x, strip.poisson)
    section = gb.Section.general(
        area + 0 * x,
        area * thin * (1 + 3 * stretch),
        area * wide * (1 + 3 * stretch),
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
    structure, hub = beam(strip, rate), gb.Hub(radius=RADIUS, rate=rate, setting_angle=angle)
    plain = structure if not rate else beam(strip)
    ours, hookes = (gb.modes(each, hub, gyroscopic=False) for each in (structure, plain))
    if rate:
        tip = gb.static(plain, hub).tip[0]
        reason = "the root holds the section's width" if strip.poisson else "Green's strain in the solids"
        yield Row(words, "stretch of the tip", 1e6 * theirs.stretch, 1e6 * tip, "µm", CLOSE, SOURCE, reason)
    for direction, name, count in (("z", "flap", 3), ("y", "chord", 2)):
        for n in range(count):
            reference, mesh, found, hooke = (of_direction(e, direction)[n] for e in (theirs, coarser, ours, hookes))
            remark = f"mesh {100 * (mesh / reference - 1):+.1g} %"
            if rate:
                remark = f"{100 * (found / hooke - 1):+.1g} % as stretched; " + remark
            if strip.poisson and hookes.errors is not None:
                stated = 100 * hookes.errors.total[list(hookes.frequency).index(hooke)]
                words_of = f"{stated:.1g} % stated" if direction == "z" else "gbeam states that of flap only"
                remark = f"the root holds the section's width: {words_of}; {remark}"
            yield Row(words, f"{name} {n + 1}", reference, found, "Hz", CLOSE, SOURCE, remark)


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
