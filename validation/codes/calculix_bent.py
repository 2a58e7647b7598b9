"""The beam of Princeton's experiment as solid elements in CalculiX, bent far by a force at its tip: 508 mm of
aluminium, 12.4 by 3.2 mm, across its soft side and at 45°, with gbeam's exact model beside it.

A root that frees the section's width is a beam's in bending. It still holds the warping, so that over Vlasov's length
√(E C/GJ), with C = b³h³/144 here 3.2 mm, the section hardly twists, where the torque is largest. At 45° gbeam's torsion
is stiffer by that length over the first 50 mm; without it, with "free warping", the stiff side is 1 % away. A clamp
that holds the width too makes the beam 0.4 % stiffer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import gbeam as gb
from validation.codes.calculix_beam import Strip, bent
from validation.published.space_beams import deflection
from validation.table import Row

TITLE = "CalculiX: Princeton's beam of solid elements"
NEEDS = ("calculix-ccx", "numpy", "scipy")
FORCE, NEAR = 13.345, 0.05  # N; m, over which torsion is stiffer
STRIP = Strip(0.508, 12.3777e-3, 3.2024e-3, 2700.0, 71.7e9, 0.31, (60, 2, 1), gripped=False)
METAL = gb.Material(STRIP.density, STRIP.modulus, poissons_ratio=STRIP.poisson)


def rows() -> Iterator[Row]:
    """Across the soft side, the width free and held; then at 45°."""
    along = 0.0, FORCE
    free, held = (bent(each, along)[2] for each in (STRIP, replace(STRIP, gripped=True)))
    ours, source = tip(along)[2], "60 × 2 × 1 C3D20R"
    yield Row("soft side", "tip, width free", 1e3 * free, ours, "mm", 2e-4, source)
    reason = "the root holds the section's width: 0.3 % stated"
    yield Row("soft side", "tip, width held", 1e3 * held, ours, "mm", 2e-4, source, reason)
    slanted = FORCE * np.sqrt(0.5), FORCE * np.sqrt(0.5)
    solid, source = bent(replace(STRIP, elements=(30, 6, 2)), slanted), "30 × 6 × 2 C3D20R"
    plain, stiffer = tip(slanted), tip(slanted, warping=True)
    for axis, name in ((1, "stiff"), (2, "soft")):
        remark = f"{100 * (plain[axis] / stiffer[axis] - 1):+.1g} % with free warping"
        yield Row("45°", f"tip along the {name} side", 1e3 * solid[axis], stiffer[axis], "mm", 1e-3, source, remark)


def tip(force: tuple[float, float], *, warping: bool = False) -> np.ndarray:
    """Displacement (3,) mm of the beam's tip; with `warping` held at its root."""
    length, width, thickness = STRIP.length, STRIP.width, STRIP.thickness
    x = np.array([0.0, NEAR - 1e-6, NEAR + 1e-6, length])
    solid, even = gb.Section.rectangle(width, thickness), np.ones(4)
    torsion = float(solid.torsion_constant(0.0))
    vlasov = np.sqrt(2 * (1 + STRIP.poisson) * (width * thickness) ** 3 / 144 / torsion)
    y, z = solid.shear_coefficients(x, STRIP.poisson)
    section = gb.Section.general(
        width * thickness * even,
        width * thickness**3 / 12 * even,
        thickness * width**3 / 12 * even,
        x,
        torsion_constant=torsion * np.where(warping & (x < NEAR), 1 / (1 - vlasov / NEAR), 1.0),
        shear_coefficient_y=y,
        shear_coefficient_z=z,
    )
    load = gb.Load(length, force=(0.0, *force))
    return 1e3 * deflection(gb.Beam(length, section if warping else solid, METAL, loads=[load]), length)
