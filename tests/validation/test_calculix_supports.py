"""The kept rows of CalculiX's portal frame and bracket: modes, reactions and a flight with the other foot on a rail."""

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
    frame, words = module.model("sliding"), module.CASES["sliding"].words
    printed = [wanted[words, f"mode {n + 1}"] for n in range(module.COUNT)]
    np.testing.assert_allclose(gb.modes(frame).frequency[: module.COUNT], printed, rtol=module.CLOSE)
    loads = gb.static(frame, acceleration=(-module.SMALL * module.G, 0.0, 0.0)).loads
    assert loads is not None and loads.support_force is not None
    force = wanted[f"{words}, 1 g along x", "force z of the support"]
    assert loads.support_force[0, 0, 2] / module.SMALL == pytest.approx(force, rel=module.STATIC)


def test_a_reaction_changes_with_the_deformation_as_in_calculix() -> None:
    """By the stress of the coordinates once, and not by that of the load again."""
    words = f"{module.CASES['fixed'].words}, {module.FAR:g} g along x"
    (wanted,) = (float(row["reference"]) for row in ROWS if row["case"] == words)
    frame, answers = module.model("fixed"), []
    for times in (module.SMALL, module.FAR):
        loads = gb.static(frame, acceleration=(-times * module.G, 0.0, 0.0)).loads
        assert loads is not None and loads.support_force is not None
        answers.append(loads.support_force[0, 0, 0] / times)
    assert module.FAR * (answers[1] - answers[0]) == pytest.approx(wanted, rel=module.CHANGED)


def test_a_bracket_on_two_feet_flies_as_in_calculix() -> None:
    """Its corner and both feet at their largest, and the stress; the first modes."""
    name = "bracket on a rail"
    case, flight = module.CASES[name], module.FLIGHTS[name]
    wanted = {(row["case"], row["quantity"]): float(row["reference"]) for row in ROWS}
    bracket = module.frame(name).reduced(modes=8, damping_ratio=0.0)
    printed = [wanted[case.words, f"mode {n + 1}"] for n in range(4)]
    np.testing.assert_allclose(gb.modes(bracket.structure).frequency[:4], printed, rtol=1e-5)
    flown = module.simulated(bracket.structure, flight)
    loads = flown.body.loads
    assert loads is not None and loads.support_force is not None
    corner = 1e6 * flown.body.displacement[:, module.frame(name).named_points.index("corner")]
    vectors = {"displacement {} of the corner": corner, "force {} of the clamp": loads.root_force}
    vectors["force {} of the support"] = loads.support_force[:, 0]
    judged = 0
    for words, over in vectors.items():
        for axis, one in zip("xyz", over.T, strict=True):
            largest = wanted.get((f"{case.words}, {flight.words}", f"{words.format(axis)} at its largest"))
            if largest is not None:
                assert one[np.abs(one).argmax()] == pytest.approx(largest, rel=2 * module.MOVED)
                judged += 1
    assert judged == 7
    most = module.most_stressed(bracket, flown)
    stress = 1e-6 * module.points_of(bracket, flown.q, most).max()
    kept = wanted[f"{case.words}, {flight.words}", "von Mises stress at its largest"]
    assert stress == pytest.approx(kept, rel=2 * module.MOVED)
