"""The kept rows of the stress in a fillet, beside gbeam's today on the coarser mesh."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gbeam as gb
from gbeam.results import von_mises
from gbeam.solids import NodalStress
from validation.codes.calculix_fillet import COARSE, NODES, SLOW, bar, fitted
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_fillet.json").read_text(encoding="utf-8"))["rows"]


def test_stress_in_a_fillet_is_calculixs() -> None:
    """With its fit to the nodes to the digits of both; with gbeam's the coarse mesh shows, and the fine one is 1 %."""
    model = bar(COARSE).reduced(modes=2, damping_ratio=0.0)
    rest = gb.static(model.structure, gb.Hub(radius=0.0, rate=SLOW))
    x, y, _ = model.mesh.points.T
    fillet = np.abs(np.hypot(x - 0.035, np.abs(y) - 0.015) - 0.005) < 1e-9
    rows = [row for row in ROWS if row["case"] == f"spun at {SLOW:g} rad/s"]
    coarse, fine = rows[0], rows[3]
    assert von_mises(fitted(model, np.asarray(rest.q)))[fillet].max() == pytest.approx(coarse["reference"], rel=1e-4)
    recovery = model.structure.recovery
    assert isinstance(recovery, NodalStress)
    ours = von_mises(recovery.table @ rest.q)[fillet].max()
    assert ours == pytest.approx(coarse["ours"], rel=1e-6)
    assert ours > coarse["reference"] > fine["reference"]
    assert fine["ours"] == pytest.approx(fine["reference"], rel=NODES)


def test_stress_in_a_fillet_converges_and_is_not_left_out() -> None:
    """Nodes are left out at the sharp edge of the clamp; two meshes have five and ten elements along the fillet."""
    coarser = bar((3, 5, 5, 3, 1)).reduced(modes=2, damping_ratio=0.0)
    model = bar(COARSE).reduced(modes=2, damping_ratio=0.0, coarser=coarser)
    fine = next(row for row in ROWS if row["source"] != ROWS[0]["source"] and row["case"] == f"spun at {SLOW:g} rad/s")
    rest = gb.static(model.structure, gb.Hub(radius=0.0, rate=SLOW))
    stress = model.stress(rest)
    x, y, _ = stress.worst.place
    assert np.hypot(x - 0.035, abs(y) - 0.015) == pytest.approx(0.005)
    assert abs(stress.worst.von_mises / fine["reference"] - 1) < rest.errors.stress.mesh < 0.1
    assert stress.singular is not None and stress.singular.place[0] < 0.01
