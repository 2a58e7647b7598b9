"""The kept rows of CalculiX's heated frame and strip: reactions, stress, and modes halfway to buckling."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from validation.codes import calculix_heat as module
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_heat.json").read_text(encoding="utf-8"))["rows"]


def test_a_heated_frame_and_a_heated_strip_are_those_of_calculix() -> None:
    wanted = {(row["case"], row["quantity"]): float(row["reference"]) for row in ROWS}
    words = f"{module.WORDS['fixed']}, 1 K"
    rest = gb.static(module.frame("fixed", module.SMALL).reduced(modes=4, damping_ratio=0.0).structure)
    loads: Any = rest.loads
    force = wanted[words, "force x of the support"]
    assert loads.support_force[0, 0, 0] / module.SMALL == pytest.approx(force, rel=module.STATIC)
    moved = wanted[words, "displacement x of the corner"]
    corner = module.frame("fixed", module.SMALL).named_points.index("corner")
    assert 1e6 * rest.displacement[corner, 0] / module.SMALL == pytest.approx(moved, rel=module.STATIC)
    printed = [wanted[f"a strip between clamps, {module.HOT:g} K", f"mode {n + 1}"] for n in range(module.COUNT)]
    hot = module.strip(module.HOT).reduced(modes=8, damping_ratio=0.0).structure
    np.testing.assert_allclose(gb.modes(hot).frequency[: module.COUNT], printed, rtol=module.HEATED)
