"""Every result says where it comes from, and is computed again from that."""

from __future__ import annotations

import hashlib
import json
import math
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import gbeam as gb
from gbeam.results import Environment, current_environment
from gbeam.scenario import provenance, reproduction

from ..calling import Answer, gbeam, main
from ..scenarios import EVERY_MOTION, FAST, FLIGHT, FREE_HUB, SPECIMEN, model, response

__all__ = ["gbeam"]

pytestmark = pytest.mark.usefixtures("reading_in_process")


RECORD = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
RECORDED = (
    'title = "recorded"\n'
    + SPECIMEN
    + model("FOAM", 0, 1, 1)
    + '[motion.flight]\nkind = "flight"\n'
    + 'record = { file = "turn.csv", time = "time_s", x = "n_x_g", y = "-n_y_g", z = "-n_z_g", unit = "g", '
    + 'to = "1 s" }\n'
    + response("1 s", step="5 ms")
    + "estimate = false\n"
)


@pytest.fixture(scope="module")
def computed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run with a record, which no test changes."""
    place = tmp_path_factory.mktemp("computed")
    shutil.copy(RECORD, place / "turn.csv")
    (place / "s.toml").write_text(RECORDED, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        assert main(["run", "s.toml", "--set", "beam.length=310 mm", "--out", "out"]) == 0
    return place


@pytest.fixture
def result(computed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of the run, in another folder than where it is computed again."""
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copytree(computed, tmp_path / "there")) / "out" / "result.nc"


@pytest.fixture
def hub(tmp_path: Path) -> Path:
    """A free hub."""
    (tmp_path / "hub.toml").write_text(FREE_HUB, encoding="utf-8")
    return tmp_path / "hub.toml"


def test_a_result_is_reproduced_without_its_record(result: Path, gbeam: Callable[..., Answer]) -> None:
    (result.parents[1] / "turn.csv").unlink()
    answer = gbeam("rerun", result)
    assert answer.status == 0 and answer.out.endswith("values and arrays computed again: the same to the last digit\n")
    again = gb.rerun(result)
    assert again.reproduced and not again.differences and not again.changed and again.compared > 60


def _edited(result: Path, change: Callable[[h5py.File], None]) -> Path:
    with h5py.File(result, "r+") as file:
        change(file)
    return result


def _moved(share: float) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        values = file["motions/flight/beam_displacement"]
        moved = values[:]
        moved[7, -1, 2] += share * np.abs(moved).max()
        values[:] = moved

    return change


def test_what_differs_is_named(result: Path, gbeam: Callable[..., Answer]) -> None:
    answer = gbeam("rerun", _edited(result, _moved(1e-12)), "--json")
    assert answer.status == 1 and answer.json["outcome"] == "not reproduced" and answer.json["tolerance"] == 0
    (difference,) = answer.json["differences"]
    assert difference["name"] == "motions/flight/beam_displacement"
    assert difference["size"] == pytest.approx(1e-12, rel=1e-2)


def test_any_damaged_number_is_a_difference(result: Path, gbeam: Callable[..., Answer]) -> None:
    for factor in (math.inf, 1e308):
        answer = gbeam("rerun", _edited(result, _moved(factor)), "--json")
        assert answer.status == 1 and answer.json["outcome"] == "not reproduced" and "Warning" not in answer.err


@pytest.mark.parametrize(
    ("share", "verdict"),
    [
        (0, "the same to the last digit"),
        pytest.param(1e-15, "within rounding", marks=pytest.mark.thorough),
        (1e-10, "within rounding"),
        (1e-8, "NOT reproduced"),
        pytest.param(1e-6, "NOT reproduced", marks=pytest.mark.thorough),
    ],
)
def test_elsewhere_rounding_is_allowed(result: Path, gbeam: Callable[..., Answer], share: float, verdict: str) -> None:
    def change(file: h5py.File) -> None:
        _moved(share)(file)
        file.attrs["platform"] = "Plan 9"
        file.attrs["dependencies"] = file.attrs["dependencies"].replace("numpy ", "numpy 1")

    answer = gbeam("rerun", _edited(result, change))
    assert answer.status == (verdict == "NOT reproduced")
    assert f"values and arrays computed again: {verdict}\n" in answer.out
    assert "platform was Plan 9, is " in answer.out and "numpy was 1" in answer.out
    assert ("motions/flight/beam_displacement: differs by" in answer.out) is (share > 1e-10)


@pytest.mark.parametrize(
    ("name", "then", "now", "kept"),
    [
        # As another kernel of OpenBLAS moved them, in a run of one beam.
        ("motions/flight@error_stress_step", 1.737e-16, 4e-19, "rounded"),
        ("motions/spin@error_displacement_step", 7.262e-9, 7.262e-9 * (1 + 2.6e-7), "rounded"),
        ("poles.1.errors.shapes", 8.882e-16, 2.2e-16, "rounded"),
        ("@verdict", "PASS: peak 1.747 mm at 0.00 s", "PASS: peak 1.747 mm at 0.03 s", "rounded"),
        ("@verdict", "PASS: peak 1.747 mm at 0.00 s", "NOT ACCEPTED: peak 1.747 mm at 0.00 s", "differs"),
        ("motions/spin@error_displacement_step", 7.262e-9, 7.5e-9, "differs"),
        ("motions/flight/displacement", 1e-9, 1e-9 * (1 + 2.6e-7), "differs"),
    ],
)
def test_rounding_with_other_versions_is_allowed_in_errors_and_in_numbers_of_words(
    name: str, then: Any, now: Any, kept: str
) -> None:
    origin = gb.read_scenario("examples/zhang2020_example1.toml").provenance
    assert origin is not None
    same = replace(origin, environment=current_environment())
    other = replace(origin, environment=replace(current_environment(), python="3.99"))
    again = reproduction("x.nc", {name: then}, {name: now}, other, lambda _: "")
    assert again.reproduced is (kept != "differs")
    assert again.rounded == (kept == "rounded")
    assert again.agreement == ("within rounding" if again.reproduced else "NOT reproduced")
    assert not reproduction("x.nc", {name: then}, {name: now}, same, lambda _: "").reproduced


@pytest.mark.parametrize(("share", "status"), [(1e-15, 0), (1e-6, 1)])
def test_rounding_of_a_matrix_is_beside_the_rows_with_its_unit(
    hub: Path, gbeam: Callable[..., Answer], share: float, status: int
) -> None:
    """A moment that is zero by symmetry is 1e-12 N m with one NumPy, and something else with another."""
    assert gbeam("linearize", hub, "--motion", "slew", "--out", hub.parent).status == 0
    facts = json.loads((hub.parent / "linear.json").read_text(encoding="utf-8"))
    rows = {each["name"]: row for each, row in zip(facts["outputs"], facts["C"], strict=True)}
    rows["root_moment_x"][2] += share * abs(rows["root_moment_z"][2])
    facts["provenance"]["dependencies"]["numpy"] = "1.0"
    (hub.parent / "linear.json").write_text(json.dumps(facts), encoding="utf-8")
    answer = gbeam("rerun", hub.parent / "linear.json")
    assert answer.status == status and ("within rounding" in answer.out) is (status == 0), answer.out
    assert "numpy was 1.0, is" in answer.out


def test_a_changed_word_or_scenario_is_found(result: Path, gbeam: Callable[..., Answer]) -> None:
    def other_word(file: h5py.File) -> None:
        file["motions/flight"].attrs["outcome"] = "diverged"

    answer = gbeam("rerun", _edited(result, other_word))
    assert answer.status == 1 and "motions/flight@outcome: was diverged, is done" in answer.out

    def other_scenario(file: h5py.File) -> None:
        text = file["scenario"].asstr()[()]
        file["scenario"][()] = text.replace("4 mm", "5 mm")

    answer = gbeam("rerun", _edited(result, other_scenario))
    assert answer.status == 2 and "another scenario than the one that was run" in answer.err


def _of_release(version: str) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        file.attrs["gbeam_version"] = version

    return change


@pytest.mark.parametrize("version", ["0.2.0", "1.0.0"])
def test_an_answer_of_another_release_is_refused(version: str, result: Path, gbeam: Callable[..., Answer]) -> None:
    answer = gbeam("rerun", _edited(result, _of_release(version)))
    assert answer.status == 2
    assert f"was computed by gbeam {version}, and this is {gb.__version__}" in answer.err
    assert f"compute it again by gbeam {version}, or run its scenario anew" in answer.err


def _of_another_version(file: h5py.File) -> None:
    _of_release(".".join([*gb.__version__.split(".")[:2], "99"]))(file)


def test_a_number_of_another_version_that_is_more_than_rounding_is_a_difference(result: Path) -> None:
    """Of 1e-8 of the largest it is one, of 1e-13 it is none."""
    _edited(result, _of_another_version)
    for share, same in ((1e-13, True), (1e-8, False)):
        assert gb.rerun(_edited(result, _moved(share))).reproduced is same


@pytest.mark.parametrize(
    ("then", "now", "units", "differ"),
    [
        ({"x": 1.0, "y": 1e-16}, {"x": 1.0, "y": 3e-16}, {"x": "m", "y": "m"}, ""),
        ({"x": 1.0, "y": 1e-9}, {"x": 1.0, "y": 3e-9}, {"x": "m", "y": "m"}, "y"),
        ({"x": 1.0, "y": 1e-16}, {"x": 1.0, "y": 3e-16}, {"x": "m", "y": "N"}, "y"),
        ({"ratio": 1e-17}, {"ratio": 5e-17}, {"ratio": "1"}, ""),
        ({"ratio": 1e-3}, {"ratio": 1.001e-3}, {"ratio": "1"}, "ratio"),
        # One without a unit that may be any: Hz over Pa beside Hz over m^4.
        ({"figure_unit": "Hz", "slope": [3e-12, 3e7]}, {"figure_unit": "Hz", "slope": [4e-12, 3e7]}, {}, ""),
        ({"figure_unit": "Hz", "slope": 3e-12}, {"figure_unit": "Hz", "slope": 4e-12}, {"slope": "1"}, "slope"),
        ({"t": 10.0, "x": 1.0, "v": 1e-18}, {"t": 10.0, "x": 1.0, "v": 0.0}, {"t": "s", "x": "m", "v": "m s-1"}, ""),
        ({"t": 10.0, "x": 1.0, "a": 1e-9}, {"t": 10.0, "x": 1.0, "a": 0.0}, {"t": "s", "x": "m", "a": "m/s^2"}, "a"),
    ],
)  # fmt: skip
def test_rounding_is_what_is_nothing_beside_the_largest_of_its_unit(
    then: dict[str, Any], now: dict[str, Any], units: dict[str, str], differ: str
) -> None:
    origin = gb.read_scenario("examples/zhang2020_example1.toml").provenance
    assert origin is not None
    other = replace(origin, environment=Environment("0.2.0", "3", "Linux", {}))
    again = reproduction("x.nc", then, now, other, lambda name: units.get(name, ""))
    assert [each.name for each in again.differences if each.size > 1e-9] == ([differ] if differ else [])


def test_one_response_alone_is_computed_again(result: Path, tmp_path: Path) -> None:
    """It was compared with the file of a study, in which none of its names is."""
    (result.parents[1] / "s.toml").write_text(RECORDED, encoding="utf-8")
    study = gb.study(gb.read_scenario(result.parents[1] / "s.toml"))
    study.responses["flight"].save(tmp_path / "flight.nc")
    again = gb.rerun(tmp_path / "flight.nc")
    assert again.reproduced and again.compared > 40


def test_a_large_record_is_found_where_it_was(
    tmp_path: Path, gbeam: Callable[..., Answer], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(import_module("gbeam.scenario.load"), "EMBEDDED", 1000)
    monkeypatch.chdir(tmp_path)
    shutil.copy(RECORD, "turn.csv")
    Path("s.toml").write_text(RECORDED, encoding="utf-8")
    assert gbeam("run", "s.toml", "--out", "out").status == 0
    assert Path("out/result.nc").stat().st_size < 1_000_000
    assert gbeam("rerun", "out/result.nc").status == 0
    Path("turn.csv").write_text(RECORD.read_text(encoding="utf-8").replace("0.853805", "0.853806"), encoding="utf-8")
    answer = gbeam("rerun", "out/result.nc")
    assert answer.status == 2 and "turn.csv is another record than the one that was run" in answer.err
    Path("turn.csv").unlink()
    answer = gbeam("rerun", "out/result.nc")
    assert answer.status == 2 and "turn.csv is not where it was" in answer.err


def test_files_without_a_scenario_are_refused(tmp_path: Path, gbeam: Callable[..., Answer]) -> None:
    beam = gb.assemble(gb.Beam(0.3, gb.Section.circle(0.01), gb.Material(2700.0, 7e10)), "FOAM", z=1)
    gb.static(beam, gb.Flight(z=1.0)).save(tmp_path / "static.nc")
    (tmp_path / "text.nc").write_text("no netCDF", encoding="utf-8")
    for name, words in (
        ("static.nc", "holds no scenario to run again"),
        ("text.nc", "is not a netCDF-4 file"),
        ("none.nc", "is no file"),
    ):
        answer = gbeam("rerun", tmp_path / name)
        assert answer.status == 2 and words in answer.err


def test_a_study_from_python_is_reproduced_too(tmp_path: Path) -> None:
    (tmp_path / "fast.toml").write_text(FAST, encoding="utf-8")
    study = gb.study(gb.read_scenario(tmp_path / "fast.toml", ["response.step=5 ms"]))
    assert study.provenance is not None and study.provenance.overrides == ("response.step=5 ms",)
    study.save(tmp_path / "x.nc")
    assert gb.rerun(tmp_path / "x.nc").reproduced
    tree = study.to_xarray()
    assert tree.attrs["scenario_sha256"] == study.provenance.sha256
    flight = study.responses["flight"].to_xarray()
    assert str(flight["scenario"].values) == FAST and flight.attrs["overrides"] == "response.step=5 ms"


def test_every_verb_says_where_its_answer_comes_from(tmp_path: Path, gbeam: Callable[..., Answer]) -> None:
    file = tmp_path / "s.toml"
    file.write_text(EVERY_MOTION.replace("4 s", "0.5 s"), encoding="utf-8")
    verbs: list[tuple[Any, ...]] = [
        ("check",),
        ("static", "--motion", "flight"),
        ("modes", "--motion", "flight"),
        ("campbell", "--motion", "slew", "--to", "1 rad/s"),
        ("critical-speed", "--motion", "slew", "--masses", "0.1 kg", "--positions", "0.3 m"),
        ("linearize", "--motion", "flight"),
        ("plan",),
        ("run", "--set", "response.step=5 ms", "--set", "response.estimate=false"),
    ]
    for verb, *options in verbs:
        answer = gbeam(verb, file, *options, "--json", "--out", tmp_path / verb)
        origin = answer.json["provenance"]
        assert origin["command"].startswith(f"gbeam {verb} {file} ") and origin["command"].endswith(verb)
        assert origin["scenario"] == file.read_text(encoding="utf-8") and len(origin["scenario_sha256"]) == 64
        assert origin["gbeam"] == gb.__version__ and origin["dependencies"]["numpy"] == np.__version__
    commands = (tmp_path / "plan" / "commands_spin.csv").read_text(encoding="utf-8")
    assert f"# Made by gbeam {gb.__version__}, Python" in commands and f"gbeam plan {file}" in commands


def test_the_fingerprint_is_of_what_a_scenario_says(tmp_path: Path) -> None:
    from gbeam.scenario import loads

    swapped = FAST.replace(FLIGHT, "") + FLIGHT
    first, second, other = (
        provenance(loads(text)).sha256 for text in (FAST, "# a remark\n" + swapped, FAST.replace("0.5 s", "0.6 s"))
    )
    assert first == second != other


def test_a_record_has_the_hash_of_its_bytes(tmp_path: Path) -> None:
    shutil.copy(RECORD, tmp_path / "turn.csv")
    (tmp_path / "s.toml").write_text(RECORDED, encoding="utf-8")
    origin = gb.read_scenario(tmp_path / "s.toml").provenance
    assert origin is not None
    (record,) = origin.records
    assert record.sha256 == hashlib.sha256(RECORD.read_bytes()).hexdigest() and record.content == RECORD.read_bytes()


def test_changes_of_the_environment_are_named() -> None:
    then = Environment("0.1", "3.11", "Linux", {"numpy": "1", "scipy": "1"})
    now = Environment("0.1", "3.12", "Linux", {"numpy": "2", "jax": "1"})
    assert then.changes(now) == {
        "python": ("3.11", "3.12"),
        "numpy": ("1", "2"),
        "scipy": ("1", "missing"),
        "jax": ("missing", "1"),
    }


@pytest.mark.parametrize(
    "verb",
    [
        ("modes", "--motion", "flight", "--at", "0.2 s"),
        ("static", "--motion", "flight"),
        ("critical-speed", "--motion", "slew", "--to", "500 rad/s"),
        ("check",),
    ],
)
def test_the_json_of_a_verb_is_computed_again(
    verb: tuple[str, ...], tmp_path: Path, gbeam: Callable[..., Answer]
) -> None:
    file = tmp_path / "s.toml"
    file.write_text(EVERY_MOTION.replace("4 s", "0.5 s"), encoding="utf-8")
    assert gbeam(verb[0], file, *verb[1:], "--set", "beam.length=0.31", "--out", tmp_path / "out").status == 0
    file.unlink()
    (written,) = (tmp_path / "out").glob("*.json")
    answer = gbeam("rerun", written)
    assert answer.status == 0 and answer.out.endswith("computed again: the same to the last digit\n"), answer
    text = written.read_text(encoding="utf-8")
    written.write_text(text.replace('"model": "FOAM"', '"model": "TLAM"').replace('"kind": "FOAM"', '"kind": "TLAM"'))
    answer = gbeam("rerun", written)
    assert answer.status == 1 and "was TLAM, is FOAM" in answer.out
    written.write_text(text.replace("{", '{"odd": [1.5, {"a": 1e3}],', 1), encoding="utf-8")
    answer = gbeam("rerun", written)  # damaged: it has names that no answer has
    assert answer.status == 1 and "odd.0: is not there any more" in answer.out, answer
    facts = json.loads(text)
    answers = ("motions", "modes", "critical_speed", "summary")
    key = next(each for each in answers if each in facts)
    del facts[key]
    written.write_text(json.dumps(facts), encoding="utf-8")
    answer = gbeam("rerun", written)
    assert answer.status == 1 and "NOT reproduced" in answer.out, answer
    assert re.search(rf"\n  {key}[^ ]*: is lacking in the file", answer.out), answer


def test_the_netcdf_of_a_search_is_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gbeam: Callable[..., Answer]
) -> None:
    """It was run as responses, none of whose numbers are in the file: nothing was there any more."""
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(EVERY_MOTION.replace("4 s", "0.5 s"), encoding="utf-8")
    goal = ("--verb", "modes", "--minimise", "modes[0].frequency", "--over", "beam.length", "--motion", "flight")
    assert gbeam("optimize", "s.toml", *goal, "--out", "out").status == 0
    Path("s.toml").unlink()
    answer = gbeam("rerun", "out/optimum.nc")
    assert answer.status == 0 and answer.out.endswith("computed again: the same to the last digit\n"), answer
    with pytest.raises(gb.InputError, match="holds no responses but another answer"):
        gb.rerun("out/optimum.nc")


def test_nothing_is_written_by_computing_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gbeam: Callable[..., Answer]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(EVERY_MOTION.replace("4 s", "0.5 s"), encoding="utf-8")
    goal = ("--verb", "modes", "--minimise", "modes[0].frequency", "--over", "beam.length", "--write", "best.toml")
    for verb in (("modes", "s.toml", "--report"), ("optimize", "s.toml", *goal)):
        answer = gbeam(*verb, "--motion", "flight", "--json")
        assert answer.status == 0
        for each in ("out", "best.toml"):
            shutil.rmtree(each, ignore_errors=True)
            Path(each).unlink(missing_ok=True)
        Path("answer.json").write_text(answer.out, encoding="utf-8")
        assert gbeam("rerun", "answer.json").status == 0
        assert sorted(each.name for each in tmp_path.iterdir()) == ["answer.json", "s.toml"]


def test_whole_numbers_beyond_floats_are_differences(tmp_path: Path, gbeam: Callable[..., Answer]) -> None:
    file = tmp_path / "s.toml"
    file.write_text(EVERY_MOTION.replace("4 s", "0.5 s"), encoding="utf-8")
    assert gbeam("modes", file, "--motion", "flight", "--out", tmp_path).status == 0
    facts = json.loads((tmp_path / "modes.json").read_text(encoding="utf-8"))
    facts["modes"][0]["frequency"] = 10**400
    (tmp_path / "modes.json").write_text(json.dumps(facts), encoding="utf-8")
    assert gbeam("rerun", tmp_path / "modes.json").status == 1


def test_json_that_is_none_of_gbeams_is_refused(tmp_path: Path, gbeam: Callable[..., Answer]) -> None:
    text, none, other = "is no JSON of a result", "is not the JSON of a result", "is no JSON of gbeam with a provenance"
    texts = {"{}": other, "[1]": none, "no JSON": text, '{"provenance": {"command": "rm"}}': other}
    same = {"gbeam": "0", "python": "3", "platform": "", "dependencies": {}, "records": [], "overrides": []}
    listed = {"provenance": same | {"scenario": "", "scenario_sha256": "", "command": [["gbeam"]]}}
    texts[json.dumps(listed)] = other
    for text, problem in texts.items():
        (tmp_path / "x.json").write_text(text, encoding="utf-8")
        answer = gbeam("rerun", tmp_path / "x.json")
        assert answer.status == 2 and problem in answer.err
    assert gbeam("rerun", tmp_path / "none.json").status == 2


def test_what_one_of_both_alone_holds_is_a_difference(result: Path) -> None:
    def lacks(file: h5py.File) -> None:
        place = next(iter(file["motions"].values()))
        del place["beam_displacement"]

    again = gb.rerun(_edited(result, lacks))
    assert not again.reproduced
    assert [str(each) for each in again.differences] == ["motions/flight/beam_displacement: is lacking in the file"]
    _edited(result, lambda file: file["motions/flight"].attrs.update(of_then=1.0))
    _edited(result, _of_another_version)
    words = {each.name: each.what for each in gb.rerun(result).differences}
    assert words["motions/flight@of_then"] == "is not there any more"
    assert "is lacking in the file" in words.values()
