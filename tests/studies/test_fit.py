"""Values found from synthetic measurements, how sure they are, and what the data cannot tell."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY
from scipy.interpolate import CubicSpline

import gbeam as gb
from gbeam.report import text

from ..scenarios import FLIGHT, SPECIMEN, model, response

Call = Callable[..., Any]
E, DAMPING, DENSITY = "beam.material.youngs_modulus", "beam.damping_ratio", "beam.material.density"
INITIAL = "response.initial.tip_displacement.z"
TRUE = {E: 66e9, DAMPING: 0.013}
# A specimen that is released: 8 periods of its first mode.
RELEASED = (
    'title = "released"\n'
    + SPECIMEN.replace("damping_ratio", "# as it came\ndamping_ratio")
    + model("FOAM", 0, 0, 2)
    + FLIGHT.replace("6 g", "0 g")
    + response("0.25 s", integrator="gauss", step="1 ms")
    + 'initial = { tip_displacement = { z = "3 mm" } }\n'
)
TIME = np.arange(0, 0.2501, 0.0025)


@pytest.fixture
def released(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The scenario, in the current folder."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "released.toml"
    file.write_text(RELEASED, encoding="utf-8")
    return file


def true_case(file: Path, **more: float) -> gb.Case:
    return gb.read_scenario(file, [f"{path}={value!r}" for path, value in (TRUE | more).items()])


def written(name: str, heads: str, *columns: Any) -> str:
    np.savetxt(name, np.column_stack(columns), delimiter=",", header=heads, comments="")
    return name


def histories(file: Path) -> tuple[Any, Any, Any]:
    """Tip, root moment, and strain at 10 mm on the face towards +z, of the true values."""
    case = true_case(file)
    run = gb.simulate(case.remade(stations=[0.01, 0.3]).subject, case.motions["flight"], case.response)
    assert run.loads is not None
    inertia, at = 0.02 * 0.004**3 / 12, list(run.loads.stations).index(0.01)
    strain = run.loads.section_moment[:, at, 1] * 0.002 / (TRUE[E] * inertia)
    every = run.tip[:, 2], run.loads.root_moment[:, 1], strain
    tip, moment, strain = (CubicSpline(run.time, each)(TIME) for each in every)
    return tip, moment, strain


def test_exact_data_of_three_kinds_give_the_true_values(released: Path) -> None:
    tip, moment, strain = histories(released)
    data = written(
        "data.csv",
        "time [ms],tip.z [mm],root_moment.y,strain.-z@10 mm [µm/m]",
        1e3 * TIME,
        1e3 * tip,
        moment,
        -1e6 * strain,
    )
    fitted = gb.fit(released, data, [E, DAMPING])
    assert fitted.values == pytest.approx(list(TRUE.values()), rel=1e-6)
    assert (fitted.errors < 1e-5 * fitted.values).all() and fitted.condition < 10 and not fitted.warnings
    assert [each.unit for each in fitted.columns] == ["m", "N m", ""]
    assert fitted.before.tolist() == [70e9, 0.01]
    ds = fitted.to_xarray()
    assert ds["fitted"].shape == (3, len(TIME)) and float(ds["value"].sel(parameter=E)) == fitted.values[0]


@pytest.mark.slow
def test_true_values_lie_within_two_sigma_in_trials(released: Path) -> None:
    tip, _, _ = histories(released)
    random, inside = np.random.default_rng(2026), np.zeros(2)
    near = [f"{path}={value!r}" for path, value in TRUE.items()]  # searches from afar are tested above
    for _ in range(20):  # of 100, 96 and 94 were inside
        noisy = tip + 0.02 * np.abs(tip).max() * random.standard_normal(len(tip))
        fitted = gb.fit(released, written("data.csv", "time,tip.z", TIME, noisy), [E, DAMPING], overrides=near)
        assert np.abs(fitted.values / list(TRUE.values()) - 1).max() < 0.2
        inside += np.abs(fitted.values - list(TRUE.values())) <= 2 * fitted.errors
    # Of 20 that are inside with a probability of 95.4 %, 16 or fewer are so once in a hundred times.
    assert (inside > 16).all(), inside


def test_frequencies_and_damping_give_the_values_and_their_errors(released: Path) -> None:
    modes = gb.modes(true_case(released).subject, gb.read_scenario(released).motions["flight"])
    data = written(
        "modes.csv", "mode,frequency [Hz],damping_ratio", [1, 2], 1.001 * modes.frequency, modes.damping_ratio
    )
    fitted = gb.fit(released, data, [E, DAMPING])
    # Both frequencies a thousandth too high: a stiffness that is two thousandths.
    assert fitted.values == pytest.approx([1.002001 * TRUE[E], TRUE[DAMPING]], rel=1e-6)
    assert fitted.modal and fitted.at.tolist() == [1, 2]


def test_modes_are_fitted_with_the_options_of_their_question(released: Path, gbeam: Call) -> None:
    """Modes without Coriolis forces, of a hub in the middle of its slew, give the values by the same modes only."""
    hub = Path(__file__).parents[2] / "examples" / "hubbeam2009_slew_3.toml"
    case, plain = gb.read_scenario(hub), {"gyroscopic": False}
    modes = gb.modes(case.subject, case.motions["slew"], 15.0, **plain)
    data = written("still.csv", "mode,frequency", np.arange(1, 4), modes.frequency[:3])
    with_options, without = (gb.fit(hub, data, [E], at=15.0, options=each).values[0] for each in (plain, None))
    true = case.beam.metal.youngs_modulus
    assert with_options == pytest.approx(true, rel=1e-8) and abs(without - true) > 1e-6 * true
    words = "fit", hub, "--data", data, "--free", E, "--at", "15 s", "--no-gyroscopic", "--json"
    assert json.loads(gbeam(*words).out)["parameters"][E]["value"] == with_options
    data = written("tip.csv", "time,tip.z", TIME, TIME)
    with pytest.raises(gb.InputError, match="--gyroscopic is no option of run; leave it out"):
        gb.fit(released, data, [E], options=plain)


def test_errors_and_intervals_of_few_data_are_those_of_linear_least_squares(released: Path) -> None:
    """Every frequency goes as the root of the stiffness: by hand, with n − 1 in the variance and Student's quantile."""
    frequency = gb.modes(gb.read_scenario(released).subject, gb.read_scenario(released).motions["flight"]).frequency
    measured = frequency * [1.004, 0.999]
    fitted = gb.fit(released, written("modes.csv", "mode,frequency [Hz]", [1, 2], measured), [E])
    weights = 1 / measured  # a frequency's noise is a share of it
    root = (weights**2 * frequency * measured).sum() / (weights**2 * frequency**2).sum()
    variance = (((measured - root * frequency) * weights) ** 2).sum() / (2 - 1)
    error = np.sqrt(variance / (weights**2 * frequency**2).sum()) * 2 * root * 70e9
    assert fitted.values[0] == pytest.approx(70e9 * root**2, rel=1e-7)
    assert fitted.errors[0] == pytest.approx(error, rel=1e-4)
    assert fitted.intervals[0] - fitted.values[0] == pytest.approx(12.7062 * error * np.array([-1, 1]), rel=1e-4)


def test_a_step_to_what_the_scenario_refuses_is_taken_back(released: Path) -> None:
    """From 500 mm the first step is to 56 mm, where a point is beyond the tip: that was the end, said of the file."""
    point = 'beam.points=[{ name = "gauge", at = "280 mm" }]'
    true = gb.read_scenario(released, ["beam.length=300 mm", point])
    modes = gb.modes(true.subject, true.motions["flight"])
    data = written("short.csv", "mode,frequency", [1, 2], modes.frequency)
    fitted = gb.fit(released, data, ["beam.length"], overrides=["beam.length=500 mm", point])
    assert fitted.values[0] == pytest.approx(0.3, rel=1e-6)


@pytest.mark.parametrize("lower", [1.0, 0.97])
def test_a_value_may_end_at_the_edge_of_what_the_scenario_allows(released: Path, lower: float) -> None:
    """A mass at the tip, and frequencies lower than any place gives: the derivative is of the side that is allowed."""
    at, heavy = "beam.masses[0].at", 'beam.masses=[{{ at = "{} mm", mass = "50 g" }}]'
    true = gb.read_scenario(released, [heavy.format(300)])
    data = written("tip.csv", "mode,frequency", [1, 2], lower * gb.modes(true.subject).frequency[:2])
    fitted = gb.fit(released, data, [at], overrides=[heavy.format(250)])
    assert 0.299 < fitted.values[0] <= 0.3
    assert fitted.at_bound[0] and np.isnan(fitted.errors[0])
    assert fitted.warnings == (f"{at} lies at the edge of what the scenario allows, and has no error",)


def test_what_the_data_cannot_tell_is_named(released: Path) -> None:
    data = written("modes.csv", "mode,frequency", [1, 2], [34.0, 213.0])
    with pytest.raises(gb.ComputationError, match=f"cannot tell ({E} and {DENSITY}|{DENSITY} and {E}) apart") as raised:
        gb.fit(
            released,
            written("three.csv", "mode,frequency,damping_ratio", [1, 2], [34.0, 213.0], [0.01, 0.01]),
            [E, DENSITY],
        )
    assert raised.value.outcome == "not identifiable"
    with pytest.raises(gb.ComputationError, match=f"do not depend on {INITIAL}"):
        gb.fit(released, data, [INITIAL], motion="flight")


def test_residuals_that_are_no_noise_are_warned_of(released: Path) -> None:
    tip, _, _ = histories(released)
    fitted = gb.fit(released, written("data.csv", "time,tip.z", TIME, tip + 1e-4 * np.sin(20 * TIME)), [E, DAMPING])
    assert "the residuals of tip.z are no noise" in fitted.warnings[0]


def test_a_value_on_its_bound_has_no_error(released: Path) -> None:
    tip, _, _ = histories(released)
    data = written("data.csv", "time,tip.z", TIME, tip)
    fitted = gb.fit(released, data, [E, DAMPING], bounds={DAMPING: ("0.5 %", "1.2 %")})
    assert fitted.at_bound.tolist() == [False, True] and np.isnan(fitted.errors[1])
    assert fitted.values[1] == pytest.approx(0.012) and "lies on its bound" in fitted.warnings[0]


def test_two_times_of_a_gauge_are_a_history_and_feel_what_pulls_the_beam(released: Path) -> None:
    """Pulled along its axis a beam has the strain ρ a (L − x) / E all around."""
    weightless = FLIGHT.replace("6 g", "0 g")
    pulled = weightless.replace("z = {", "x = {").replace("0 g", "50 g")
    text = RELEASED.replace(weightless, pulled).partition("initial")[0]
    released.write_text(text, encoding="utf-8")
    strain = -2800 * 50 * STANDARD_GRAVITY * (0.3 - 0.01) / 70e9
    for times in ([0.0, 0.25], [0.1]):
        data = written("data.csv", "time,strain.z@10 mm,strain.-y@10 mm", times, *2 * [[strain] * len(times)])
        if len(times) > 1:
            fitted = gb.fit(released, data, [DENSITY])
            assert fitted.values == pytest.approx([2800.0]) and fitted.correlation == pytest.approx(1.0)
        else:
            with pytest.raises(gb.InputError, match=r"data\.csv has one time; give two or more"):
                gb.fit(released, data, [DENSITY])


@pytest.mark.parametrize(
    ("heads", "free", "words"),
    [
        ("time,tip.w", [E], "tip.w.*did you mean 'tip.x'|tip.w.*choose one of|tip.w.*did you mean"),
        ("seconds,tip.z", [E], "has no column time or mode"),
        ("time,tip.z [kg]", [E], "in 'kg'"),
        ("time,hub.angle", [E], "flight is no hub"),
        ("time,strain.z@400 mm", [E], "off the beam"),
        ("time [min],tip.z", [E], "the response goes from 0 to 0.25 s"),
        ("mode,frequency", [E, DAMPING, DENSITY, "beam.length"], "no numbers 1, 2"),
        ("time,tip.z", ["beam.lenght"], "--free 'beam.lenght'"),
        ("time,tip.z", ["beam.root.rotation_y"], "is no physical value that the scenario gives"),
        ("time,tip.z", ["response.initial.tip_displacement.y"], "is no physical value"),
    ],
)
def test_what_is_wrong_with_the_data_is_said(released: Path, heads: str, free: list[str], words: str) -> None:
    data = written("data.csv", heads, [0.0, 0.1, 0.2], [1.0, 2.0, 3.0])
    with pytest.raises(gb.InputError, match=words):
        gb.fit(released, data, free)


def test_bounds_that_leave_out_the_start_are_refused(released: Path) -> None:
    data = written("data.csv", "time,tip.z", [0.0, 0.1, 0.2], [1.0, 2.0, 3.0])
    with pytest.raises(gb.InputError, match="leave out the scenario's value"):
        gb.fit(released, data, [E], bounds={E: ("10 GPa", "20 GPa")})
    with pytest.raises(gb.InputError, match=r"2 values for 1|names 3 values for 3"):
        gb.fit(released, data, [E, DAMPING, DENSITY])


def test_the_command_writes_a_scenario_with_the_values(released: Path, gbeam: Call, with_figures: None) -> None:
    tip, _, _ = histories(released)
    data = written("data.csv", "time,tip.z", TIME, tip)
    words = ("fit", released, "--data", data, "--free", f"{E},{DAMPING}")
    done = gbeam(*words, "--write", "fitted.toml", "--out", "found", "--json")
    assert done.status == 0
    facts = json.loads(done.out)
    assert facts["parameters"][E]["value"] == pytest.approx(TRUE[E], rel=1e-6)
    text = Path("fitted.toml").read_text(encoding="utf-8")
    assert 'youngs_modulus = "66 GPa"' in text and "# as it came\ndamping_ratio = 0.013" in text
    assert gb.read_scenario("fitted.toml").beam.material.youngs_modulus == pytest.approx(TRUE[E], rel=1e-6)
    assert sorted(path.name for path in Path("found").iterdir()) == ["fit.nc", "fit.png", "fit.svg"]
    assert gbeam(*words, "--write", "x.toml", "--set", "beam.length=0.2").status == 2


def test_the_values_of_a_loads_profile_are_found(released: Path) -> None:
    profile = 'profile = "smooth-step", level = "2 N", duration = "50 ms", start = "10 ms"'
    loaded = RELEASED.replace("[model]", f'[[beam.loads]]\nat = "300 mm"\nforce = {{ z = {{ {profile} }} }}\n[model]')
    released.write_text(loaded, encoding="utf-8")
    level, duration = "beam.loads[0].force.z.level", "beam.loads[0].force.z.duration"
    case = gb.read_scenario(released, [f"{level}=2.3 N", f"{duration}=42 ms"])
    run = gb.simulate(case.subject, case.motions["flight"], case.response)
    data = written("data.csv", "time,tip.z", TIME, CubicSpline(run.time, run.tip[:, 2])(TIME))
    fitted = gb.fit(released, data, [level, duration])
    assert fitted.values == pytest.approx([2.3, 0.042], rel=1e-5) and fitted.units == ("N", "s")


def test_several_starts_find_a_valley_that_one_does_not(released: Path) -> None:
    tip, *_ = histories(released)
    early = TIME <= 0.1  # three periods
    noise = np.random.default_rng(5).normal(0.0, 1e-5, early.sum())
    data = written("early.csv", "time,tip.z", TIME[early], tip[early] + noise)
    begun = ["beam.damping_ratio=0.013", "beam.material.youngs_modulus=35 GPa"]
    one, several = (
        gb.fit(released, data, [E], bounds={E: ("30 GPa", "150 GPa")}, overrides=begun, starts=n) for n in (1, 6)
    )
    assert abs(one.values[0] / TRUE[E] - 1) > 0.1 and (one.starts, one.agreed) == (1, 1)
    assert abs(several.values[0] - TRUE[E]) < 4 * several.errors[0] < 0.01 * TRUE[E]
    assert several.starts == 6 and 1 <= several.agreed < 6 and several.before[0] == 35e9
    assert "of 6 searches end at these values" in text(several)
    with pytest.raises(gb.InputError, match="--starts is 0"):
        gb.fit(released, data, [E], overrides=begun, starts=0)
