"""Controllers in scenarios: the laws they make, and what is refused and where."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

import gbeam as gb
from gbeam.mechanics import gains, in_series, lead_lag, notch, pid
from gbeam.scenario import ScenarioError, build, loads

pytestmark = pytest.mark.usefixtures("reading_in_process")

POINTING, TWO_PANELS = (
    (Path(__file__).parents[2] / "examples" / f"{name}.toml").read_text(encoding="utf-8")
    for name in ("pointing_satellite", "satellite_two_panels")
)


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
    # Its modes are those without the law, which is said.
    assert any("without its controllers, pointing" in each for each in gb.modes(case.system, errors=False).warnings)


def test_a_free_body_is_pointed_in_a_scenario() -> None:
    """Names of attitude and spin, and gains on them, as in Python."""
    names = [f"bus.root.{each}_{axis}" for each in ("attitude", "spin") for axis in "xyz"]
    rows = np.hstack([1.5 * np.eye(3), 6.0 * np.eye(3)]).tolist()
    drives = [f"wheel.moment_{axis}" for axis in "xyz"]
    table = f"measure = {names}\ndrive = {drives}\nlaw = [{{ kind = 'gains', gains = {rows} }}]\nsample = '50 ms'\n"
    case = build(loads(TWO_PANELS.replace("[response]", f"[controllers.pointing]\n{table}\n[response]")))
    same = gb.Feedback(gains(rows), names, drives, 0.05, reference=[0.0] * 6)
    assert case.system.controllers["pointing"] == same
    closed = gb.linearize(case.system, loop="closed", outputs=["bus.root.attitude_x"])
    assert closed.outputs[0].unit == "rad" and closed.eigenvalue.real.max() < 1e-6


FILED = POINTING[: POINTING.index("law = [")] + 'law = [{ kind = "state-space", file = "FILE" }]' + POINTING[
    POINTING.index("]\n", POINTING.index('kind = "notch"')) + 1 :
]  # fmt: skip


def test_a_law_that_is_wrong_is_not_one_too_few() -> None:
    with pytest.raises(ScenarioError, match="unknown choice 'state-spac'") as caught:
        build(loads(FILED.replace("state-space", "state-spac")))
    assert "entries" not in str(caught.value)


@pytest.mark.parametrize("ending", [".npz", ".mat", ".json"])
def test_a_law_is_read_from_a_file(ending: str, tmp_path: Path) -> None:
    """In continuous time as it is, in discrete time with its step; the result runs again from what it holds."""
    file, text = tmp_path / f"law{ending}", FILED.replace("FILE", f"law{ending}")
    named = dict(zip("ABCD", in_series([pid(60.0, 0.0, 220.0, 0.1), notch(2 * np.pi * 4.25, 0.1, 0.3)]), strict=True))
    short = 'duration = "0.1 s"\nstep = "5 ms"\nestimate = false'
    (tmp_path / "case.toml").write_text(text.replace('duration = "40 s"', short))
    held = build(loads(POINTING)).system.controllers["pointing"].law
    for step in (0.0, 0.02):
        parts = dict(zip("ABCD", held, strict=True)) | {"dt": step} if step else named
        if ending == ".npz":
            np.savez(file, **parts)
        elif ending == ".mat":
            savemat(file, parts)
        else:
            file.write_text(json.dumps({key: np.asarray(each).tolist() for key, each in parts.items()}))
        read = gb.read_scenario(tmp_path / "case.toml").system.controllers["pointing"].law
        for one, other in zip(read, held, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-12 * np.abs(other).max())
    gb.study(gb.read_scenario(tmp_path / "case.toml")).save(tmp_path / "result.nc")
    file.unlink()
    assert gb.rerun(tmp_path / "result.nc").reproduced


SINGLE = {name: [[1.0]] for name in "ABCD"}


@pytest.mark.parametrize(
    ("parts", "change", "problem"),
    [
        ({"A": [[1.0]], "B": [[1.0]], "C": [[1.0]]}, "", "holds no D"),
        ({name: [[np.nan]] for name in "ABCD"}, "", "not finite"),
        ({**SINGLE, "dt": 0.03}, "", "step"),
        ({**SINGLE, "dt": 0.02}, ', { kind = "gains", gains = [[1]] }', "give it alone"),
        ({**SINGLE, "dt": 0.02, "Ts": 0.01}, "", "says dt = 0.02 and ts = 0.01"),
        ({}, ", a = [[1]]", "is given beside file"),
        (None, "", "there is no file"),
    ],
)
def test_files_of_laws_that_are_none_are_refused(parts: Any, change: str, problem: str, tmp_path: Path) -> None:
    if parts is not None:
        np.savez(tmp_path / "law.npz", **parts)
    text = FILED.replace("FILE", "law.npz")
    text = (
        text.replace(" }]\n", f"{change} }}]\n") if change.startswith(", a") else text.replace("}]\n", f"}}{change}]\n")
    )
    with pytest.raises(ScenarioError) as caught:
        build(loads(text, folder=tmp_path))
    assert problem in str(caught.value) and "law" in str(caught.value)


@pytest.mark.parametrize("ending", [".npz", ".mat", ".json"])
@pytest.mark.parametrize("step", [True, -1.0, "10 ms"])
def test_discrete_time_without_its_step_is_not_taken_for_continuous(ending: str, step: Any, tmp_path: Path) -> None:
    """dt of python-control is True, Ts of MATLAB is -1, where the law is discrete and nobody said in which steps."""
    file, parts = tmp_path / f"law{ending}", SINGLE | {"dt": step}
    if ending == ".npz":
        np.savez(file, **parts)
    elif ending == ".mat":
        savemat(file, parts)
    else:
        file.write_text(json.dumps(parts))
    with pytest.raises(ScenarioError, match=r"says dt = .*: discrete, and the sample time is not said"):
        build(loads(FILED.replace("FILE", file.name), folder=tmp_path))


@pytest.mark.parametrize(
    ("old", "new", "where", "problem"),
    [
        ('measure = ["axis.angle"]', 'measure = ["axis.angel"]', "controllers.pointing.measure", "axis.angel"),
        ('drive = ["axis.angle"]', 'drive = ["axis.rate"]', "controllers.pointing.drive", "axis.rate"),
        (', smoothing = "100 ms"', "", "controllers.pointing.law[0]", "smoothing is missing"),
        ('measure = ["axis.angle"]', 'measure = ["axis.angle", "axis.angle"]', "controllers.pointing.law[0]", "error"),
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
