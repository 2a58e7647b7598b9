"""Stated against true errors of a hundred random strips under supports: pinned or clamped at the root, held at one to
three more places rigidly or by springs, the last one along it as well or not, with a mass or without, under an even
load and at rest. The truth is the exact model with nine shapes.

What the theory of slender beams leaves out is in neither.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import gbeam as gb
from gbeam.errors import GbeamError
from validation.table import Row

TITLE = "Stated against true errors of beams under supports"
NEEDS = ("numpy", "scipy")
SEEDS = range(100)
SHAPES, STRETCHES = 9, 4  # of the truth
SURE = 1e-6  # a true error below is not known from the truth's own
MOST = 3.0  # times the stated error
SOURCE = "exact, with nine shapes"
METAL = gb.Material(2700.0, 70e9, poissons_ratio=0.3)


class Judged(NamedTuple):
    """Stated and true errors of a strip: of its deflection, of its loads and of its two lowest frequencies."""

    deflection: tuple[float, float]
    loads: tuple[float, float]
    frequencies: list[tuple[float, float]]


def strip(random: np.random.Generator) -> gb.Beam:
    """Draw a strip and its supports."""
    length, width = float(random.uniform(0.2, 1.5)), float(random.uniform(0.01, 0.05))
    thickness = float(random.uniform(0.002, 0.01))
    bending = METAL.youngs_modulus * width * thickness**3 / 12
    supports = [gb.Support(0.0, ["x", "y", "z", "rx", "rz"])] if random.random() < 0.4 else []
    places = np.sort(random.uniform(0.25, 1.0, random.integers(1, 4))) * length
    if random.random() < 0.5:
        places[-1] = length
    for place in places:
        holds = ["z", "ry"] if random.random() < 0.3 else ["z"]
        springs: Any = {}
        if random.random() < 0.3:
            springs["z"] = float(bending / length**3 * 10 ** random.uniform(0, 4))
        if random.random() < 0.2 and "ry" not in holds:
            springs["ry"] = float(bending / length * 10 ** random.uniform(-1, 2))
        supports.append(gb.Support(float(place), holds, stiffness=springs))  # type: ignore[arg-type]
    if random.random() < 0.5:
        supports[-1] = replace(supports[-1], holds=["x", *supports[-1].holds])
    masses = []
    if random.random() < 0.5:
        share = float(random.uniform(0.05, 1.0))
        mass = share * METAL.density * width * thickness * length
        masses = [gb.PointMass(float(random.uniform(0.1, 1.0)) * length, mass)]
    section = gb.Section.rectangle(width, thickness)
    return gb.Beam(length, section, METAL, masses, supports=supports, rotary_inertia=False)


def judged(seed: int) -> Judged | None:
    """Errors of the strip of a seed; None where it or the truth has no answer."""
    random = np.random.default_rng(seed)
    try:
        beam = strip(random)
        kind: Any = str(random.choice(["FOAM", "TLAM", "exact"]))
        ours = gb.assemble(beam, kind, axial=2, z=int(random.integers(2, 5)))
        truth = gb.assemble(beam, "exact", axial=STRETCHES, z=SHAPES)
        load = (0.0, 0.0, float(10 ** random.uniform(0.0, 2.5)))
        rests = [gb.static(model, acceleration=load) for model in (ours, truth)]
        modes = [gb.modes(model) for model in (ours, truth)]
    except GbeamError:
        return None
    if any(answer.outcome != "done" for answer in (*rests, *modes)):
        return None
    errors, of_modes = rests[0].errors, modes[0].errors
    assert of_modes is not None
    moved = [rest.bodies["beam"].displacement for rest in rests]
    carried = []
    for rest in rests:
        loads = rest.loads
        assert loads is not None and loads.support_force is not None
        carried.append(np.concatenate([loads.force[0], loads.support_force[0]]))
    lowest = np.abs(modes[0].frequency[:2] / modes[1].frequency[:2] - 1)
    frequencies = list(zip(of_modes.slender[:2].tolist(), lowest.tolist(), strict=True))
    return Judged((errors.displacement.slender, _apart(*moved)), (errors.loads.slender, _apart(*carried)), frequencies)


def _apart(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Largest difference of vectors, over the largest of ours."""
    return float(np.linalg.norm(theirs - ours, axis=-1).max() / np.linalg.norm(ours, axis=-1).max())


def rows() -> Iterator[Row]:
    """Shares of the strips in which the stated errors hold."""
    answered = [each for each in map(judged, SEEDS) if each is not None]
    pairs = {
        "deflections": [each.deflection for each in answered],
        "forces": [each.loads for each in answered],
        "two lowest frequencies": [pair for each in answered for pair in each.frequencies],
    }
    for name, every in pairs.items():
        known = [(stated, true) for stated, true in every if true > SURE and not math.isnan(stated)]
        within = float(np.mean([true <= MOST * stated for stated, true in known]))
        quantity = f"true error within three times the stated one, share of {len(known)}"
        remark = f"largest true error {max(true for _, true in known):.2g}; {len(answered)} strips"
        yield Row(name, quantity, 1.0, within, "–", 0.05, SOURCE, remark)
