"""Every example runs, and says what its source says."""

import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam
from gbeam.report.facts import facts as to_json
from gbeam.scenario import build, loads, template

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))
TIP_MASSES = ("0 kg", "0.1 kg", "0.5 kg")


@cache
def run(name: str, *overrides: str) -> gbeam.Study:
    path = next(p for p in EXAMPLES if p.stem == name)
    return gbeam.study(gbeam.read_scenario(path, overrides))


def with_tip(name: str, mass: str) -> gbeam.Study:
    """An example of 2009 with a tip mass; its own is none."""
    return run(name, *([] if mass == TIP_MASSES[0] else [f"beam.masses[0].mass={mass}"]))


def assert_all_known(answer: gbeam.Study) -> None:
    """The file of a run that is done holds only numbers, its JSON null only for what it is not asked for or is none."""
    for path, group in answer.to_xarray().subtree_with_keys:
        for name, each in group.variables.items():
            assert each.dtype.kind != "f" or np.isfinite(each.values).all() or name.endswith("_allowed"), (path, name)
    none = ("residual_amplitude", "relative", "damage_ratio", "errors")
    assert not [place for place in _nulls(to_json(answer)) if not any(f".{each}" in place for each in none)]


def _nulls(value: Any, place: str = "") -> Iterator[str]:
    if isinstance(value, (dict, list, tuple)):
        for key, each in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _nulls(each, f"{place}.{key}")
    elif isinstance(value, float) and math.isnan(value):
        yield place


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_example_is_done_within_its_tolerance(path: Path) -> None:
    case = gbeam.read_scenario(path)
    answer = run(path.stem)
    assert {r.outcome for r in answer.responses.values()} == {"done"}
    assert not gbeam.describe(case).warnings  # nothing implausible
    assert_all_known(answer)
    for response in answer.responses.values():
        assert response.errors.displacement.slender <= case.response.tolerance
        # Undamped, the corners of 2020 ring on for seconds, and a clamp that holds the strip flat changes their phase.
        assert response.error_estimate <= case.response.tolerance or "zhang2020" in path.stem
    assert len(answer.comparisons) == len(case.tracks)


def test_f16_turn_moving_the_specimen_quietens_it(tmp_path: Path) -> None:
    study = run("f16_8g_turn")
    middle = run("f16_8g_turn", "motion.centrifuge.control_point=150 mm")
    (at_node,), (at_middle,) = study.comparisons, middle.comparisons
    assert study.responses["flight"].peaks.max_abs[2] == pytest.approx(2.318e-3, rel=2e-3)
    # Theory: the lever of the static tip vanishes at 11/15 L.
    assert at_node.max_difference[2] < 0.3 * at_middle.max_difference[2]
    assert at_node.peaks["tip"].ratio == pytest.approx(1, abs=1e-3) and at_node.accepted
    assert at_middle.peaks["tip"].ratio > 1.035 and at_middle.accepted is False
    study.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").stat().st_size < 3e6


def test_the_scenario_to_start_from_is_a_good_imitation_as_it_is() -> None:
    study = gbeam.study(build(loads(template("flight"))))
    (comparison,) = study.comparisons
    assert comparison.accepted and comparison.accounting.followed_share == 1
    assert comparison.peaks["tip"].ratio == pytest.approx(1, abs=2e-3)
    assert comparison.mismatch is not None and comparison.mismatch.placed
    axes = study.responses["centrifuge"].axes
    assert axes is not None and axes.within_limits and not axes.warnings and not axes.shortfalls


# 2009, five modes: largest tip displacement, residual amplitude (m), from an independent integration of the same model.
SLEWS = {
    ("2p8", "0 kg"): (0.20439, 8.55e-4),
    ("3", "0 kg"): (0.21714, 7.92e-4),
    ("3", "0.5 kg"): (0.43423, 2.84e-3),
    ("5", "0 kg"): (0.33264, 8.23e-4),
}


@pytest.mark.parametrize(("rate", "mass"), SLEWS)
def test_hubbeam_slews(rate: str, mass: str) -> None:
    peaks = with_tip(f"hubbeam2009_slew_{rate}", mass).responses["slew"].peaks
    largest, residual = SLEWS[rate, mass]
    assert peaks.max_abs[1] == pytest.approx(largest, rel=1e-3)
    assert peaks.residual_amplitude[1] == pytest.approx(residual, rel=1e-2)


# Exact peaks (m) and FOAM's error in %, for tip masses 0, 0.1, 0.5 kg, from two independent exact codes.
TORQUES = {
    "50": ((0.26961, 0.02), (0.35208, 0.07), (0.59384, 0.18)),
    "200": ((1.12747, 0.58), (1.28835, 0.90), (2.25654, 2.84)),
}


@pytest.mark.slow
@pytest.mark.parametrize("torque", TORQUES)
@pytest.mark.parametrize("i", range(3), ids=TIP_MASSES)
def test_hubbeam_torques(torque: str, i: int) -> None:
    exact, error = TORQUES[torque][i]
    peaks = with_tip(f"hubbeam2009_torque_{torque}", TIP_MASSES[i]).responses["slew"].peaks
    assert 100 * (peaks.max_abs[1] / exact - 1) == pytest.approx(error, abs=0.05)
