"""Best values against closed forms, and what cannot be kept."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

from ..scenarios import APPENDAGE, SLEW, model, response

Call = Callable[..., Any]
THICKNESS, POINT = "beam.section.thickness", "motion.spin.control_point"


def test_a_requirement_that_decides_gives_the_closed_form(fast: Path) -> None:
    # The load grows as the thickness, the deflection falls as its square: the thinnest beam that is stiff enough.
    before = gb.sensitivity(fast, ["flight.tip.z"], [THICKNESS], verb="static").figures[0]
    optimum = gb.optimise(
        fast, "flight.loads.root_force.z", [THICKNESS], subject_to=["flight.tip.z >= -2 mm"], verb="static",
        motion="flight", bounds={THICKNESS: ("2 mm", "8 mm")},
    )  # fmt: skip
    assert optimum.values[0] == pytest.approx(0.004 * np.sqrt(before / -0.002), rel=1e-5)
    (required,) = optimum.requirements
    assert required.active and required.kept and optimum.outcome == "done" and not optimum.at_bound.any()
    assert optimum.figure == pytest.approx(optimum.figure_before * optimum.values[0] / 0.004, rel=1e-6)


def test_of_a_verdict_the_size_is_minimised(fast: Path) -> None:
    optimum = gb.optimise(fast, "verdict.tip", [POINT], bounds={POINT: (0.05, 0.3)})
    # The nearer to the root, the less.
    assert optimum.at_bound.all() and abs(optimum.figure) < 0.2 * abs(optimum.figure_before)
    again = gb.study(gb.read_scenario(fast, [f"{POINT}={float(optimum.values[0])!r}"])).comparisons[0]
    assert optimum.figure == pytest.approx(again.figures["tip"], abs=1e-12)  # of a run with its own steps
    assert (np.diff(np.abs(optimum.history)) < 0).all() and optimum.path.shape == (len(optimum.history), 1)


def test_the_name_of_a_motion_decides_nothing(fast: Path) -> None:
    """A motion called torque had a tip in N m, whose limit in mm was refused; one called step had no derivatives."""
    text = fast.read_text(encoding="utf-8")
    subject, bounds = ["tip.z >= -2 mm"], {THICKNESS: ("2 mm", "8 mm")}
    least = {}
    for name in ("torque", "step"):
        file = fast.with_name(f"{name}.toml")
        file.write_text(text.replace("[motion.flight]", f"[motion.{name}]").replace('"flight"\narm', f'"{name}"\narm'))
        required = [f"{name}.{each}" for each in subject]
        optimum = gb.optimise(
            file,
            f"{name}.loads.root_force.z",
            [THICKNESS],
            subject_to=required,
            verb="static",
            motion=name,
            bounds=bounds,
        )
        assert (optimum.unit, optimum.requirements[0].unit) == ("N", "m")
        least[name] = optimum.values
        assert gb.sensitivity(file, [f"{name}.tip.z.max_abs"], [THICKNESS]).units == ("m",)
    assert least["torque"] == least["step"]


def test_requirements_that_no_values_keep_are_said(fast: Path, gbeam: Call) -> None:
    words = ("optimize", fast, "--verb", "static", "--minimise", "flight.loads.root_force.z", "--over", THICKNESS)
    done = gbeam(*words, "--bounds", f"{THICKNESS}=3 mm:5 mm", "--subject-to", "flight.tip.z >= -0.1 mm", "--json")
    facts = json.loads(done.out)
    assert done.status == 1 and facts["outcome"] == "limits exceeded"
    assert not facts["subject_to"][0]["kept"]
    assert (
        facts["parameters"][THICKNESS]["value"] == pytest.approx(0.005) and facts["parameters"][THICKNESS]["at_bound"]
    )


@pytest.mark.parametrize(
    ("minimise", "over", "subject", "words"),
    [
        ("spin.tip.z.max_abs", POINT, "limits", "names limits, of which the scenario has none"),
        ("spin.tip.z.max_abs", POINT, "spin.tip.z.max_abs < 2 mm", "--subject-to is 'spin.tip.z.max_abs < 2 mm'"),
        ("spin.tip.z.max_abs", POINT, "spin.tip.z.max_abs <= 2 kg", "--subject-to of spin.tip.z.max_abs"),
        ("spin.tip.z.max_abs", POINT, "spin.steps <= 3", "--subject-to 'spin.steps' is a count"),
        ("spin.steps", POINT, "", "--minimise 'spin.steps' is a count"),
        ("spin.tip.z.max_abs", "motion.spin.controlpoint", "", "--over .*did you mean 'motion.spin.control_point'"),
    ],
)
def test_what_cannot_be_minimised_is_refused(fast: Path, minimise: str, over: str, subject: str, words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        gb.optimise(
            fast, minimise, [over], subject_to=[subject] if subject else [], overrides=["response.estimate=false"]
        )


def test_values_that_the_scenario_refuses_are_named(fast: Path) -> None:
    """On the way to the mass that bends the beam most, beyond the tip."""
    at = "beam.masses[0].at"
    heavy = ['beam.masses=[{ at = "250 mm", mass = "50 g" }]']
    words = r"--bounds allow beam.masses\[0\].at = 0.\d+ m, which the scenario refuses: .*beyond the tip; give narrower"
    with pytest.raises(gb.InputError, match=words):
        options = {"verb": "static", "motion": "flight", "bounds": {at: (0.1, 0.4)}}
        gb.optimise(fast, "tip.z", [at], overrides=heavy, **options)  # type: ignore[arg-type]


def test_a_figure_that_depends_on_nothing_is_said(fast: Path) -> None:
    best = gb.optimise(
        fast, "root_force.y", [THICKNESS], verb="static", motion="flight", bounds={THICKNESS: (3e-3, 5e-3)}
    )
    assert best.warnings == (f"root_force.y does not depend on {THICKNESS}",)


def test_the_command_writes_a_scenario_a_file_and_a_plot(fast: Path, gbeam: Call, with_figures: None) -> None:
    words = ("optimize", fast, "--verb", "static", "--minimise", "flight.loads.root_force.z", "--over", THICKNESS)
    done = gbeam(*words, "--bounds", f"{THICKNESS}=3 mm:5 mm", "--write", "best.toml", "--out", "best")
    assert done.status == 0 and "on its bound" in done.out
    assert 'thickness = "3 mm"' in Path("best.toml").read_text(encoding="utf-8")
    assert sorted(path.name for path in Path("best").iterdir()) == ["optimum.nc", "optimum.png", "optimum.svg"]


def test_all_searches_of_a_figure_with_one_valley_agree(fast: Path, gbeam: Call) -> None:
    words = ("optimize", fast, "--verb", "static", "--minimise", "flight.loads.root_force.z", "--over", THICKNESS)
    bound = ("--bounds", f"{THICKNESS}=3 mm:8 mm", "--subject-to", "flight.tip.z >= -2 mm", "--starts", "3")
    done = gbeam(*words, *bound, "--motion", "flight")
    assert done.status == 0 and "3 of 3 searches end at these values" in done.out


def test_several_starts_find_the_least_of_many_valleys(tmp_path: Path) -> None:
    file = tmp_path / "slewing.toml"
    slew = SLEW.replace("60 rpm", "1 rad/s").replace('"2 s"', '"4 s"')
    file.write_text(
        APPENDAGE + model("FOAM", 0, 1, 0) + slew + response("12 s", residual_from="10 s"), encoding="utf-8"
    )
    duration, left = "motion.slew.rate.duration", "tip.y.residual_amplitude"
    one, several = (gb.optimise(file, left, [duration], bounds={duration: (2.0, 10.0)}, starts=n) for n in (1, 4))
    tried = gb.sweep(file, {duration: "2 s:10 s:33"}, [left])
    assert several.figure <= one.figure and several.figure <= tried.measures[left].min()
    assert several.starts == 4 and 1 <= several.agreed <= 4
    assert several.evaluations > one.evaluations
