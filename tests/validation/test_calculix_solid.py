"""The kept rows of CalculiX's bracket: its modes, and what a spin changes in them."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gbeam as gb
from validation.codes import calculix_solid
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_solid.json").read_text(encoding="utf-8"))["rows"]


def test_a_bracket_vibrates_as_in_calculix() -> None:
    """At rest to the digits that it prints, and by a spin within 2 % of what it changes."""
    structure = calculix_solid.model().structure
    spins = (
        gb.Hub(radius=calculix_solid.RADIUS, rate=0.0),
        gb.Hub(radius=calculix_solid.RADIUS, rate=calculix_solid.RATE),
    )
    still, spun = (gb.modes(structure, spin, gyroscopic=False).frequency for spin in spins)
    wanted = {row["quantity"]: float(row["reference"]) for row in ROWS if "mode" in row["quantity"]}
    for n in range(calculix_solid.COUNT):
        assert still[n] == pytest.approx(wanted[f"mode {n + 1}"], rel=2e-6)
    changed = 1e3 * (spun - still)
    for n in range(calculix_solid.SHIFTED):
        assert changed[n] == pytest.approx(wanted[f"change of mode {n + 1}"], rel=0.02)
    assert np.sign(changed[:6]).tolist() == [1, 1, 1, -1, 1, -1]
