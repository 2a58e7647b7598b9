"""The kept rows of CalculiX's shells: displacements under 1 g, modes at rest and spinning."""

from __future__ import annotations

import json

import numpy as np
import pytest

from validation.codes import calculix_shells as module
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_shells.json").read_text(encoding="utf-8"))["rows"]


@pytest.mark.parametrize("name", module.CASES)
def test_a_shell_is_that_of_calculix(name: str) -> None:
    """With twenty elements along it, within 2e-3 of the limit of CalculiX's, which a clamp and folds stiffen."""
    wanted = {(row["case"], row["quantity"]): float(row["reference"]) for row in ROWS if row["case"].startswith(name)}
    shell, rate = module.model(name, module.SIZES[0]), module.CASES[name][2]
    for spin, words in {0.0: "at rest", rate: f"{rate:g} rad/s" if rate else "at rest"}.items():
        printed = [wanted[f"{name}, {words}", f"mode {n + 1}"] for n in range(module.COUNT)]
        np.testing.assert_allclose(module.modes(spin, shell), printed, rtol=module.CLOSE)
    for way, axis in enumerate("xz" if rate else ""):
        moved = module.moved(2 * way, shell)["xz".index(axis) * 2]
        assert moved == pytest.approx(wanted[f"{name}, 1 g along {axis}", f"displacement {axis} of the tip"], rel=4e-4)
