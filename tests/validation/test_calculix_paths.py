"""The kept rows of CalculiX's clamped beam, shallow arch and toggle frame: gbeam's paths through the snap, anew."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import gbeam as gb
from validation.codes import calculix_paths as module
from validation.record import RESULTS

ROWS = json.loads((RESULTS / "codes.calculix_paths.json").read_text(encoding="utf-8"))["rows"]
WANTED = {(row["case"], row["quantity"]): float(row["reference"]) for row in ROWS}


@pytest.mark.parametrize("name", module.PUSHED)
def test_a_path_through_a_snap_is_that_of_calculix(name: str) -> None:
    """Limit loads, and loads and thrusts along it."""
    strip, push, upper = module.PUSHED[name]
    answer, ours = module.path(strip, "FOAM", push, upper, errors=False)
    case = f"{name}, FOAM"
    limits = [WANTED[case, words] for words in ("largest load before the snap", "least load after it")]
    assert [push * point.factor for point in answer.critical] == pytest.approx(limits, rel=module.LIMIT)
    for column, quantity in ((1, "load"), (2, "thrust")):
        curve = CubicSpline(ours[:, 0], ours[:, column])
        for times in (0.5, 1.0, 1.5):
            wanted = WANTED[case, f"{quantity} at {times:g} times the rise"]
            assert curve(times * strip.rise) == pytest.approx(wanted, rel=module.ALONG)


def test_a_clamped_beam_is_that_of_calculix() -> None:
    case = f"clamped beam, FOAM, {module.EVEN:g} m/s²"
    rest = gb.static(module.model(module.BEAM, "FOAM"), acceleration=(0.0, 0.0, module.EVEN))
    assert rest.loads is not None and rest.loads.support_force is not None
    assert -1e3 * rest.at("beam.middle")[2] == pytest.approx(WANTED[case, "deflection"], rel=module.HELD)
    pull = WANTED[case, "pull along x at the ends"]
    assert rest.loads.support_force[0, -1, 0] == pytest.approx(pull, rel=module.HELD)


def test_what_paths_differ_by_is_kept() -> None:
    """Thousandths of the limit loads; the exact model's loads, with shear, within half of FOAM's of the frame."""
    away = {row["case"]: row["ours"] for row in ROWS if row["quantity"].startswith("load, largest difference")}
    assert len(away) == 4 and max(away.values()) < 1.0
    assert away["Williams' frame, exact"] < 0.5 * away["Williams' frame, FOAM"] < 0.5
    ratios = [row["ours"] / row["reference"] for row in ROWS if "the snap" in row["quantity"]]
    assert np.abs(np.array(ratios) - 1).max() < module.LIMIT
