"""Keys of a record in a scenario: units, quantity, and checks that are left out."""

from __future__ import annotations

from pathlib import Path

import pytest

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


def test_acceleration_cannot_be_the_target_of_a_machine_with_gravity() -> None:
    path, words = refused(f"{RECORD}quantity=acceleration")
    assert path == "motion.centrifuge.gravity"
    assert "gravity = false" in words
    build(load(F16, [f"{RECORD}quantity=acceleration", "motion.centrifuge.gravity=false"]))
