"""Keys of a record in a scenario: units, quantity, and checks that are left out."""

from __future__ import annotations

from pathlib import Path

import pytest

from gbeam import describe
from gbeam.scenario import ScenarioError, build, load

F16 = Path(__file__).parents[2] / "examples" / "f16_8g_turn.toml"
RECORD = "motion.flight.record."


def refused(*overrides: str) -> tuple[str, str]:
    with pytest.raises(ScenarioError) as caught:
        build(load(F16, list(overrides)))
    (error,) = caught.value.diagnostics
    return error.path, f"{error.message}; {error.hint}"


def test_the_unit_of_the_f16_is_guarded_and_can_be_overridden() -> None:
    path, words = refused(f"{RECORD}unit=m/s^2")
    assert path == f"{RECORD}unit"
    assert "column 'n_x_g' in g; write unit = \"g\"" in words and 'skip_checks = ["unit"]' in words
    build(load(F16, [f"{RECORD}unit=m/s^2", f'{RECORD}skip_checks=["unit"]']))
    build(load(F16, [f"{RECORD}unit=m/s^2", f"{RECORD}skip_checks=true"]))


@pytest.mark.parametrize(
    ("override", "path", "words"),
    [
        ("time_unit=ms", "time_unit", 'time_unit = "s"'),
        ("time_unit=moons", "time_unit", "is 'moons'; choose s or ms"),
        ("z=n_z_g", "z", 'z = "-n_z_g"'),
        ('skip_checks=["sing"]', "skip_checks[0]", "did you mean 'sign'?"),
        ("skip_checks=1", "skip_checks", "not true or false"),
        ("quantity=force", "quantity", "choose"),
    ],
)
def test_record_keys_are_refused_at_their_place(override: str, path: str, words: str) -> None:
    where, text = refused(RECORD + override)
    assert where == RECORD + path
    assert words in text


def test_an_instrument_is_described_by_its_turn_and_arm() -> None:
    turning = ["p=p_rad_s", "q=-q_rad_s", "r=-r_rad_s", "rate_unit=rad/s"]
    keys = ['turn=["0 deg", "5 deg", 0]', 'arm=["0.3 m", 0, "-0.1 m"]', *turning]
    description = describe(build(load(F16, [RECORD + each for each in keys])))
    (record,) = description.records.values()
    assert record.done == (
        "the block's axes are turned by 5 deg about (0, 1, 0) in base axes",
        "at the root, (300, 0, -100) mm from the instrument: turning adds up to 0.09422 g",
    )
    assert refused(f'{RECORD}arm=["0.3 m", 0, 0]')[0] == f"{RECORD}arm"


@pytest.mark.parametrize(
    ("level", "path", "words"),
    [
        ('["0 s", "1 s"]', "level", "is no stretch at rest: the load spreads by 0.0859 g"),
        ('["13 s", "35 s"]', "level[1]", "is 35 s, and the record lasts 0 to 15.99 s"),
        ('["1 s"]', "level", "has 1 entries; give 2"),
        ('["12:00:00", "12:00:01"]', "level[0]", "give a time of the record's own clock"),
    ],
)
def test_a_level_that_is_none_is_refused_at_its_place(level: str, path: str, words: str) -> None:
    where, text = refused(f"{RECORD}level={level}")
    assert where == RECORD + path and words in text


@pytest.mark.parametrize(
    ("rest", "path", "words"),
    [
        ('[{from="0 s", to="1 s"}]', "rest", "is no stretch at rest: the load spreads by 0.0859 g"),
        ('[{from="13 s", to="14 s"}]', "rest", "is no stretch at rest: the load drifts by 0.0241 g"),
        ('[{from="13 s", to="35 s"}]', "rest[0].to", "is 35 s, and the record lasts 0 to 15.99 s"),
        ('[{from="13 s", to="14 s", load="1 g"}]', "rest[0].load", "'1 g' is not a list"),
        ('[{from="13 s", to="14 s", rates=["1 deg/s", 0, 0]}]', "rest.rates", "name the columns of the body's rates"),
        ('["0 s"]', "rest[0]", "'0 s' is not a table; give a table: stretches at rest"),
        ('{from="0 s", to="1 s"}', "rest", "is not a list"),
    ],
)
def test_a_rest_that_is_none_is_refused_at_its_place(rest: str, path: str, words: str) -> None:
    where, text = refused(f"{RECORD}rest={rest}")
    assert where == RECORD + path and words in text


def test_a_level_factor_is_said_wherever_the_flight_is() -> None:
    from gbeam.report import description_text as text

    case = build(load(F16, ["motion.flight.scale=1.25"]))
    assert case.title == "F-16 8 g turn on a 3.3 m arm; flight × 1.25"
    description = describe(case)
    (record,) = description.records.values()
    assert record.flown.largest == pytest.approx([1.25 * each for each in record.read.largest])
    assert record.flown.peak == pytest.approx([1.25 * each for each in record.read.peak])
    lines = text(description)
    assert "motions   flight × 1.25\n" in lines and "accelerations × 1.25\n" in lines
    assert "8.109 g (x 0.854, y 0.273, z 8.06) at 4.92 s  10.14 g (x 1.07, y 0.341, z 10.1) at 4.92 s" in lines
    scenario = load(F16, ["motion.flight.scale=1.25"])
    assert scenario.heading(["motion.flight.scale"]) == scenario.title  # a sweep over it has no such level
    assert build(load(F16)).title == "F-16 8 g turn on a 3.3 m arm"


def test_rates_beside_a_level_factor_are_warned_of() -> None:
    turning = ["p=p_rad_s", "q=-q_rad_s", "r=-r_rad_s", "rate_unit=rad/s"]
    case = build(load(F16, [*(RECORD + each for each in turning), "motion.flight.scale=1.25"]))
    (warning,) = (each for each in describe(case).warnings if "scale" in each)
    assert "motion.flight.scale: accelerations are flown × 1.25, the body's rates as they are given" in warning


def test_acceleration_cannot_be_the_target_of_a_machine_with_gravity() -> None:
    path, words = refused(f"{RECORD}quantity=acceleration")
    assert path == "motion.centrifuge.gravity"
    assert "gravity = false" in words
    build(load(F16, [f"{RECORD}quantity=acceleration", "motion.centrifuge.gravity=false"]))
