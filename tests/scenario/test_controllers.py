"""Controllers in scenarios: the laws they make, and what is refused and where."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics.tree.laws import in_series, lead_lag, notch, pid
from gbeam.scenario import ScenarioError, build, loads

POINTING = (Path(__file__).parents[2] / "examples" / "pointing_satellite.toml").read_text(encoding="utf-8")


def _gain(law: tuple[np.ndarray, ...], s: complex) -> complex:
    a, b, c, d = law
    return complex((c @ np.linalg.solve(s * np.eye(len(a)) - a, b) + d)[0, 0])


def test_laws_are_their_transfer_functions() -> None:
    s = 0.3 + 2.0j
    parts = [pid(2.0, 3.0, 0.5, 0.1), lead_lag(1.5, 4.0, 9.0), notch(3.0, 0.2, 0.4)]
    gains = [
        2.0 + 3.0 / s + 0.5 * s / (1 + 0.1 * s),
        1.5 * (1 + s / 4.0) / (1 + s / 9.0),
        (s**2 + 2 * 0.2 * 0.4 * 3.0 * s + 9.0) / (s**2 + 2 * 0.4 * 3.0 * s + 9.0),
    ]
    for law, gain in zip(parts, gains, strict=True):
        assert _gain(law, s) == pytest.approx(gain)
    assert _gain(in_series(parts), s) == pytest.approx(np.prod(gains))
    assert abs(_gain(parts[2], 3.0j)) == pytest.approx(0.2)


def test_a_scenario_is_the_system_in_python() -> None:
    case = build(loads(POINTING))
    law = case.system.controllers["pointing"]
    assert (law.measure, law.drive, law.sample, law.delay) == (("axis.angle",), ("axis.angle",), 0.02, 0.02)
    continuous = in_series([pid(60.0, 0.0, 220.0, 0.1), notch(2 * np.pi * 4.25, 0.1, 0.3)])
    same = gb.Feedback(continuous, ["axis.angle"], ["axis.angle"], 0.02, 0.02, [20.0], [0.0])
    assert law == same
    # What it measures is taken from the reference: it pushes back.
    assert law.effort(0.0, np.array([0.1]), law.start)[0] < 0


@pytest.mark.parametrize(
    ("old", "new", "where", "problem"),
    [
        ('measure = ["axis.angle"]', 'measure = ["axis.angel"]', "controllers.pointing.measure", "axis.angel"),
        ('drive = ["axis.angle"]', 'drive = ["axis.rate"]', "controllers.pointing.drive", "axis.rate"),
        (', smoothing = "100 ms"', "", "controllers.pointing.law[0]", "smoothing is missing"),
        ('measure = ["axis.angle"]', 'measure = ["axis.angle", "axis.angle"]', "controllers.pointing.law[0]", "a pid"),
        ("limit = [20]", "limit = [20, 20]", "controllers.pointing.limit", "[20"),
        ('sample = "20 ms"', 'sample = "20 m"', "controllers.pointing.sample", "20 m"),
        ('kind = "notch"', 'kind = "noch"', "controllers.pointing.law[1]", "noch"),
        (
            '{ kind = "pid", kp = 60, kd = 220, smoothing = "100 ms" }', '{ kind = "gains", gains = [[1, 2]] }',
            "controllers.pointing.law", "has a matrix B",
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_at_its_place(old: str, new: str, where: str, problem: str) -> None:
    assert old in POINTING
    with pytest.raises(ScenarioError) as caught:
        build(loads(POINTING.replace(old, new)))
    message = str(caught.value)
    assert where.rpartition(".")[2].partition("[")[0] in message and problem in message, message
