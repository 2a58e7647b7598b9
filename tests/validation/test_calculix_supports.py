"""The kept rows of CalculiX's portal frame: modes and reactions with the other foot on a rail."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gbeam as gb
from validation.codes import calculix_supports as module
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_supports.json").read_text(encoding="utf-8"))["rows"]


def test_a_frame_on_a_rail_is_that_of_calculix() -> None:
    wanted = {(row["case"], row["quantity"]): float(row["reference"]) for row in ROWS}
    frame, words = module.model("sliding"), module.WORDS["sliding"]
    printed = [wanted[words, f"mode {n + 1}"] for n in range(module.COUNT)]
    np.testing.assert_allclose(gb.modes(frame).frequency[: module.COUNT], printed, rtol=module.CLOSE)
    loads = gb.static(frame, acceleration=(-module.SMALL * module.G, 0.0, 0.0)).loads
    assert loads is not None and loads.support_force is not None
    force = wanted[f"{words}, 1 g along x", "force z of the support"]
    assert loads.support_force[0, 0, 2] / module.SMALL == pytest.approx(force, rel=module.STATIC)


def test_a_reaction_changes_with_the_deformation_as_in_calculix() -> None:
    """By the stress of the coordinates once, and not by that of the load again."""
    words = f"{module.WORDS['fixed']}, {module.FAR:g} g along x"
    (wanted,) = (float(row["reference"]) for row in ROWS if row["case"] == words)
    frame, answers = module.model("fixed"), []
    for times in (module.SMALL, module.FAR):
        loads = gb.static(frame, acceleration=(-times * module.G, 0.0, 0.0)).loads
        assert loads is not None and loads.support_force is not None
        answers.append(loads.support_force[0, 0, 0] / times)
    assert module.FAR * (answers[1] - answers[0]) == pytest.approx(wanted, rel=module.CHANGED)
