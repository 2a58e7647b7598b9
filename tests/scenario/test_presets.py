"""Presets of standards: every figure has a clause, and what could not be read is asked for, never invented."""

import tomllib
from importlib.resources import files

import pytest

import gbeam as gb
from gbeam.scenario import PRESETS, preset_of, text_of

from ..scenarios import BOX_ON_ARM

FIXED = {"level", "dwell", "directions"}  # by standards
GIVEN = {"level": '"7 g"', "dwell": '"30 s"', "directions": '{ up = "+z", aft = "-x" }'}


def read(tmp_path, name, **keys):
    lines = [f'preset = "{name}"', *(f"{key} = {value}" for key, value in keys.items())]
    file = tmp_path / "test.toml"
    file.write_text(BOX_ON_ARM + "\n".join(lines) + "\n", encoding="utf-8")
    return gb.read_scenario(file)


def test_every_file_is_a_preset():
    shipped = [each.name for each in files("gbeam.scenario.presets").iterdir() if each.name.endswith(".toml")]
    assert sorted(shipped) == sorted(f"{name}.toml" for name in PRESETS)


@pytest.mark.parametrize("name", PRESETS)
def test_every_figure_has_a_source_and_the_rest_is_asked_for(name):
    preset = preset_of(name)
    assert {*preset.arm} == {*preset.source}
    assert {*preset.arm} | {*preset.asked} == FIXED
    assert not {*preset.arm} & {*preset.asked}
    assert tomllib.loads(text_of(name)).keys() == {"title", "standard", "arm", "source", "asked"}


@pytest.mark.parametrize("name", PRESETS)
def test_what_a_preset_asks_for_is_named_with_standard_and_clause(name, tmp_path):
    asked = preset_of(name).asked
    for left_out, clause in asked.items():
        keys = {key: GIVEN[key] for key in asked if key != left_out}
        with pytest.raises(gb.InputError) as refused:
            read(tmp_path, name, **keys)
        for words in (preset_of(name).standard, clause, "could not read", f"give {left_out}"):
            assert words in str(refused.value)
    case = read(tmp_path, name, **{key: GIVEN[key] for key in asked})
    assert case.response.duration == pytest.approx(40 + (30 if "dwell" in asked else 60))


def test_what_a_scenario_gives_stands_in_place_of_a_presets(tmp_path):
    levels = '{ fore = { level = "2 g" }, up = { level = "6 g", load = "-y" }, sideways = "+y" }'
    case = read(tmp_path, "mil-std-810h-513-structural", level='"3 g"', dwell='"90 s"', directions=levels)
    felt = {name: motion.base(100.0).a_WO_B / 9.80665 for name, motion in case.motions.items()}
    assert [*felt] == ["test-fore", "test-up", "test-sideways"]
    assert felt["test-fore"] == pytest.approx([2, 0, 1])  # +x is the preset's
    assert felt["test-up"] == pytest.approx([0, -6, 1])
    assert felt["test-sideways"] == pytest.approx([0, 3, 1])
    assert case.response.duration == pytest.approx(130.0)


def test_one_direction_alone_leaves_those_of_a_preset_out(tmp_path):
    case = read(tmp_path, "mil-std-810h-513-crash", level='"8 g"', load='"-z"')
    assert [*case.motions] == ["test"]


def test_results_say_which_standard_and_clauses_they_rest_on(tmp_path):
    (note,) = gb.describe(read(tmp_path, "mil-std-810h-513-structural", level='"9 g"')).notes
    assert note.startswith("test by MIL-STD-810H, method 513.8, acceleration, procedure I: structural test (preset mil")
    assert "dwell by 4.5.2, step 1, at second hand, directions by 4.5.2, step 4, at second hand" in note
    assert "not checked against the standard: level (table 513.8-I" in note
    keys = {"level": '"9 g"', "dwell": '"90 s"', "directions": '{ fore = "+x" }'}
    (note,) = gb.describe(read(tmp_path, "mil-std-810h-513-structural", **keys)).notes
    assert "4.5.2" not in note and "MIL-STD-810H" in note
