"""The kept rows of CalculiX's board, disc sector and strip: displacements under 1 g, modes at rest and spinning."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gbeam as gb
from validation.codes import calculix_specimens as module
from validation.codes.calculix_solid import SMALL
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_specimens.json").read_text(encoding="utf-8"))["rows"]


@pytest.mark.parametrize("name", module.CASES)
def test_a_solid_is_that_of_calculix(name: str) -> None:
    """Within 1e-4: of a disc a spin raises the first frequency by half."""
    wanted = {(row["case"], row["quantity"]): float(row["reference"]) for row in ROWS if row["case"].startswith(name)}
    _, rate, radius = module.CASES[name]
    structure = module.structure(name)
    for spin, words in ((0.0, "at rest"), (rate, f"{rate:g} rad/s")):
        vibration = gb.modes(structure, gb.Hub(radius=radius, rate=spin), gyroscopic=False).frequency
        printed = [wanted[f"{name}, {words}", f"mode {n + 1}"] for n in range(module.COUNT)]
        np.testing.assert_allclose(vibration[: module.COUNT], printed, rtol=module.SPUN)
    for i, way in enumerate("xyz"):
        moved = gb.static(structure, acceleration=tuple(-SMALL * module.G * np.eye(3)[i])).tip / SMALL
        for k, axis in enumerate("xyz"):
            if (key := (f"{name}, 1 g along {way}", f"displacement {axis} of the tip")) in wanted:
                assert 1e6 * moved[k] == pytest.approx(wanted[key], rel=module.STATIC)
