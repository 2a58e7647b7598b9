"""A scenario as text and as fields, and its records."""

from __future__ import annotations

import inspect
import json
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import gbeam as gb
from gbeam.app import arguments
from gbeam.app import verbs as offered
from gbeam.cli import parsed
from gbeam.cli import verbs as program
from gbeam.questions import QUESTIONS

from ..calling import Answer
from ..scenarios import FAST, RAMPS
from .conftest import Site

_REFERENCE = (Path(__file__).parents[2] / "docs" / "scenario.md").read_text(encoding="utf-8")


def test_messages_are_the_command_lines(site: Site, gbeam: Callable[..., Answer]) -> None:
    text = FAST.replace('"300 mm"', '"300 kg"').replace('"3.3 m"', '"-3 m"')
    said = site.call("POST", "/api/document", site.opened, json={"text": text}).json()["errors"]
    file = site.folder / "wrong.toml"
    file.write_text(text)
    known = gbeam("check", file, "--json").json["error"]
    assert [(each["path"], each["message"], each["hint"], each["line"]) for each in said] == [
        (each["path"], each["message"], each["hint"], each["line"]) for each in known
    ]
    assert {each["path"] for each in said} >= {"beam.length"}


def test_the_form_has_every_key_of_the_schema(site: Site) -> None:
    built = site.call("POST", "/api/document", site.opened, json={"text": FAST}).json()
    entries = {each["path"]: each for each in _entries(built["form"])}
    assert entries["beam.length"]["value"] == "300 mm" and entries["beam.length"]["unit"] == "m"
    assert entries["beam.damping_ratio"]["value"] == "0.01" and entries["motion.spin.gravity"]["value"] == "false"
    assert "main axis" in entries["motion.spin.arm"]["help"]
    assert built["errors"] == [] and "Scenario valid." in built["meaning"]
    # What the page of the scenario file lists for a table is what the form offers, written or not.
    tables = {"beam": "[beam]", "motion.spin": '[motion.NAME], kind = "centrifuge"', "response": "[response]"}
    for path, heading in tables.items():
        listed = _REFERENCE.split(f"### {heading}")[1].split("###")[0]
        keys = {line.split("`")[1] for line in listed.splitlines() if line.startswith("| `")}
        assert keys - {"kind"} == {each["key"] for each in entries[path]["inside"]}
    assert entries["motion.spin.inverse"]["options"] == ["quasi-static", "flat", "exact", "planned"]
    assert entries["response.step"]["default"] == "auto" and entries["beam.loads"]["kind"] == "list"
    assert not entries["beam.loads"]["written"] and entries["beam.section"]["required"]
    assert entries["motion"]["options"] == ["flight", "centrifuge", "hub", "arm"]


def _entries(form: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for each in form:
        yield each
        yield from _entries(each.get("inside", []))


def _added(site: Site, text: str, path: str, choice: str = "") -> dict[str, Any]:
    built: dict[str, Any] = site.call(
        "POST", "/api/add", site.opened, json={"text": text, "path": path, "choice": choice}
    ).json()
    return built


def test_tables_are_added_filled_and_removed(site: Site) -> None:
    before = FAST.replace("[beam]", "[beam]  # a comment")
    built = _added(site, before, "beam.masses[0]")
    # What is missing is said at its field, in the words of the command line.
    fields = {each["field"]: each["message"] for each in built["errors"]}
    assert fields == {"beam.masses[0].at": "at is missing", "beam.masses[0].mass": "mass is missing"}
    for path, value in (("beam.masses[0].at", "300 mm"), ("beam.masses[0].mass", "0.1 kg")):
        body = {"text": built["text"], "path": path, "value": value}
        built = site.call("POST", "/api/edit", site.opened, json=body).json()
    assert built["errors"] == [] and tomllib.loads(built["text"])["beam"]["masses"] == [
        {"at": "300 mm", "mass": "0.1 kg"}
    ]
    built = site.call("POST", "/api/remove", site.opened, json={"text": built["text"], "path": "beam.masses"}).json()
    assert built["text"] == before

    built = _added(site, before, "motion.slew", "hub")
    assert {"motion.slew.radius"} <= {each["field"] for each in built["errors"]}
    built = _added(site, built["text"], "motion.slew.rate", "trapezoid")
    missing = {each["field"] for each in built["errors"] if each["field"].startswith("motion.slew.rate")}
    assert missing == {f"motion.slew.rate.{key}" for key in ("level", "jerk", "hold")}


def test_another_kind_keeps_what_both_have(site: Site) -> None:
    built = _added(site, FAST, "motion.flight.acceleration.z", "smooth-step")
    after = tomllib.loads(built["text"])["motion"]["flight"]["acceleration"]["z"]
    assert after == {"profile": "smooth-step", "level": "6 g"}
    built = _added(site, FAST, "beam.section", "circle")
    assert tomllib.loads(built["text"])["beam"]["section"] == {"shape": "circle"}
    assert [each["field"] for each in built["errors"]] == ["beam.section.diameter"]


@pytest.mark.parametrize(
    ("path", "choice"),
    [("beam.length", ""), ("beam.section", "star"), ("motion.a.b", "hub"), ("nothing", ""), ("", ""), ("beam..x", "")],
)
def test_what_the_schema_has_not_is_not_added(site: Site, path: str, choice: str) -> None:
    answer = site.call("POST", "/api/add", site.opened, json={"text": FAST, "path": path, "choice": choice})
    assert answer.status_code == 422 and answer.json()["errors"]


def test_an_emptied_field_is_left_out(site: Site) -> None:
    body = {"text": FAST, "path": "beam.damping_ratio", "value": " "}
    built = site.call("POST", "/api/edit", site.opened, json=body).json()
    assert built["text"] == FAST.replace("damping_ratio = 0.01\n", "")


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("beam.length", "250 mm", "250 mm"),
        ("beam.section.width", '2" cm', '2" cm'),  # a quotation mark stays inside
        ("beam.damping_ratio", "0.02", 0.02),
        ("beam.damping_ratio", "2 %", "2 %"),
        ("motion.spin.gravity", "true", True),
        ("title", "a\nb", "a\nb"),
        ("title", "12", "12"),  # text, whatever it looks like
        ("model.modes.z", "2", 2),
        ("response.stations", '["100 mm", 0.2]', ["100 mm", 0.2]),  # was not written
    ],
)
def test_an_edit_changes_one_value_and_keeps_comments(site: Site, path: str, value: str, expected: object) -> None:
    text = FAST.replace("[beam]", "[beam]  # a comment\n# and another")
    built = site.call("POST", "/api/edit", site.opened, json={"text": text, "path": path, "value": value}).json()
    before, after = tomllib.loads(text), tomllib.loads(built["text"])
    *tables, key = path.split(".")
    for data in (before, after):
        node = data
        for step in tables:
            node = node[step]
        answer = node.pop(key, None)
    assert answer == expected and before == after
    assert "# a comment\n# and another" in built["text"]


@pytest.mark.parametrize("path", ["beam", "beam.nothing", "", "beam..length", "a" * 999])
def test_what_is_not_written_is_not_edited(site: Site, path: str) -> None:
    answer = site.call("POST", "/api/edit", site.opened, json={"text": FAST, "path": path, "value": "1"})
    assert answer.status_code == 422 and answer.json()["errors"]


def test_a_record_takes_the_place_of_a_profile(site: Site) -> None:
    rows = "".join(f"{0.01 * i:.2f},{1 + 0.001 * i}\n" for i in range(101))
    answer = site.call("PUT", "/api/records/pull up.csv", site.opened, content=f"t,n_z\n{rows}".encode())
    known = {"time": "t", "z": "n_z", "unit": "g"}
    assert answer.json() == {"name": "pull up.csv", "columns": ["t", "n_z"], "suggested": known}
    assert site.call("GET", "/api/records/pull up.csv", site.opened).json() == answer.json()
    assert site.call("GET", "/api/records/other.csv", site.opened).status_code == 422
    record = {"file": "pull up.csv", "time": "t", "x": "0", "y": "0", "z": "n_z", "unit": "g"}
    text = FAST.replace(RAMPS, "").replace('level = "6 g"', 'level = "1.2 g"')
    for _ in range(2):  # the second time in place of the first
        body = {"text": text, "motion": "flight", "record": record}
        text = site.call("POST", "/api/record", site.opened, json=body).json()["text"]
        assert tomllib.loads(text)["motion"]["flight"] == {"kind": "flight", "record": record}
    assert "duration" not in tomllib.loads(text).get("response", {})  # which was that of the profile, half the record's
    curves = site.call("POST", "/api/preview", site.opened, json={"text": text}).json()
    z = curves["flights"]["flight"][2]
    assert z[0] == pytest.approx(1, abs=1e-3) and z[-1] == pytest.approx(1.1, abs=2e-3)
    for value in ("0.2 s", "12:00:00"):
        body = {"text": text, "path": "motion.flight.record.from", "value": value}
        part = site.call("POST", "/api/edit", site.opened, json=body).json()
        assert tomllib.loads(part["text"])["motion"]["flight"]["record"]["from"] == value
        field = {each["path"]: each for each in _entries(part["form"])}["motion.flight.record.from"]
        assert (field["value"], field["unit"], field["example"]) == (value, "s", "16 s")
    assert "give a time of the record's own clock, 0 to 1 s" in part["errors"][0]["hint"]


def test_a_record_of_which_nothing_is_taken_is_refused(site: Site, gbeam: Callable[..., Answer]) -> None:
    """Zeros throughout are no flight, whatever they are said to hold."""
    (site.folder / "records").mkdir()
    (site.folder / "records" / "a.csv").write_text("t,z\n" + "".join(f"{0.01 * i:.2f},1\n" for i in range(101)))
    record = {"file": "a.csv", "time": "t", "x": "0", "y": "0", "z": "0", "unit": "g", "quantity": "acceleration"}
    text = FAST.partition("[motion.spin]")[0] + "[response]\nduration = '0.5 s'\n"
    body = {"text": text, "motion": "flight", "record": record}
    built = site.call("POST", "/api/record", site.opened, json=body).json()
    (problem,) = built["errors"]
    assert problem["path"] == "motion.flight.record" and 'x, y and z are "0"' in problem["message"]
    assert site.call("POST", "/api/runs", site.opened, json={"text": built["text"]}).status_code == 422
    scenario = site.folder / "records" / "zeros.toml"
    scenario.write_text(built["text"])
    answer = gbeam("check", scenario)
    assert answer.status == 2 and "motion.flight.record" in answer.err and "name a column" in answer.err


def test_another_column_leaves_what_else_is_written_of_a_record(site: Site) -> None:
    written = 'record = { file = "a.csv", time = "t", x = "0", y = "0", z = "z", unit = "g"'
    written += ', cutoff = "5 Hz", despike = true }'
    text = FAST.replace('acceleration = { z = { profile = "constant", level = "6 g" } }', written)
    record = {"file": "a.csv", "time": "t", "x": "0", "y": "0", "z": "-z", "unit": "g", "time_unit": "ms"}
    for file, kept in (("a.csv", {"cutoff": "5 Hz", "despike": True}), ("b.csv", {})):
        body = {"text": text, "motion": "flight", "record": {**record, "file": file}}
        after = tomllib.loads(site.call("POST", "/api/record", site.opened, json=body).json()["text"])
        assert after["motion"]["flight"]["record"] == {**record, "file": file, **kept}


def test_examples_are_sound_and_come_with_their_records(site: Site) -> None:
    offered = site.call("GET", "/api/examples", site.opened).json()

    def taken(name: str) -> dict[str, Any]:
        built: dict[str, Any] = site.call("POST", "/api/example", site.opened, json={"name": name}).json()
        return built

    for name in offered:
        assert taken(name)["errors"] == []
    flown = next(name for name in offered if "F-16" in name)
    examples = Path(__file__).parents[2] / "examples"
    record = site.folder / "records" / "f16_8g_turn.csv"
    assert record.read_bytes() == (examples / "data" / "f16_8g_turn.csv").read_bytes()
    expected = (examples / "f16_8g_turn.toml").read_text().replace("data/", "")
    assert taken(flown)["text"] == expected and len([*record.parent.iterdir()]) == 1
    # A file of one's own by that name stays.
    record.write_text("t,z\n0,1\n")
    again = taken(flown)
    assert again["errors"] == [] and 'file = "example f16_8g_turn.csv"' in again["text"]
    assert record.read_text() == "t,z\n0,1\n"
    assert site.call("POST", "/api/example", site.opened, json={"name": "../../x"}).status_code == 422


def test_a_record_takes_the_place_of_the_examples_profile(site: Site) -> None:
    body = {"name": "Flight and centrifuge"}
    text = site.call("POST", "/api/example", site.opened, json=body).json()["text"]
    site.call("PUT", "/api/records/a.csv", site.opened, content=b"t,z\n0,1\n1,1\n")
    record = {"file": "a.csv", "time": "t", "x": "0", "y": "0", "z": "z", "unit": "g"}
    body = {"text": text, "motion": "flight", "record": record}
    after = tomllib.loads(site.call("POST", "/api/record", site.opened, json=body).json()["text"])
    expected = tomllib.loads(text)
    del expected["motion"]["flight"]["acceleration"], expected["response"]["duration"]
    expected["motion"]["flight"]["record"] = record
    assert after == expected


@pytest.mark.parametrize("text", ["", "motion = 1", "[[motion]]\nx = 1", "[motion]\nflight = 3", "[motion.spin]", "x"])
def test_a_record_needs_a_flight_that_is_written(site: Site, text: str) -> None:
    body = {"text": text, "motion": "flight", "record": {"file": "a.csv"}}
    answer = site.call("POST", "/api/record", site.opened, json=body)
    assert answer.status_code == 422 and answer.json()["errors"]


def test_a_record_without_columns_is_refused(site: Site) -> None:
    answer = site.call("PUT", "/api/records/x.mat", site.opened, content=b"\x00\x01nothing")
    assert answer.status_code == 422 and answer.json()["errors"]
    assert Path(site.folder / "records").is_dir()


@pytest.mark.parametrize(
    ("over", "measure"),
    [
        ([], "tip"),
        (["beam.length=1:2:2"] * 3, "tip"),
        (["motion.flight.record.file=/etc/passwd"], "tip"),
        (["--out=/tmp/x"], "tip"),
        (["beam={}"], "tip"),
        (["beam.length="], "tip"),
        (["beam.length=1:2:2"], "--out /tmp/x"),
        (["beam.length=1:2:2"], ""),
    ],
)
def test_sweeps_vary_values_of_the_form_only(site: Site, over: list[str], measure: str) -> None:
    with_record = FAST.replace(
        'acceleration = { z = { profile = "constant", level = "6 g" } }',
        'record = { file = "a.csv", time = "t", x = "0", y = "0", z = "z", unit = "g" }',
    )
    for text in (FAST, with_record):
        answer = site.call("POST", "/api/runs", site.opened, json={"text": text, **_sweep(over, measure)})
        assert answer.status_code == 422 and answer.json()["errors"]
    assert not (site.folder / "runs").exists()


def _sweep(over: list[str], measure: str) -> dict[str, Any]:
    return {"verb": "sweep", "options": [*(f"over={each}" for each in over), f"measure={measure}"]}


def test_the_example_of_a_measure_is_one_of_a_flight_and_a_centrifuge(tmp_path: Path) -> None:
    """It stood in the form of a sweep, and was refused: the tip's peak could be that of either motion."""
    (measure,) = (each.example for each in offered()["sweep"].options if each.name == "measure")
    (tmp_path / "fast.toml").write_text(FAST, encoding="utf-8")
    swept = gb.sweep(tmp_path / "fast.toml", ["motion.spin.arm=2 m, 3.3 m"], [measure])
    assert list(swept.measures) == [measure] and swept.outcome.tolist() == ["done", "done"]


def test_a_case_of_a_sweep_is_run_once(site: Site) -> None:
    body = {"text": FAST, **_sweep(["beam.length=300 mm, 310 mm"], "flight.tip.size.max_abs")}
    sweep = site.call("POST", "/api/runs", site.opened, json=body).json()["id"]
    ids = {
        site.call("POST", "/api/runs", site.opened, json={"text": FAST, "case": f"{sweep}/0/{j}"}).json()["id"]
        for j in (0, 0, 1)
    }
    runs = site.call("GET", "/api/runs", site.opened).json()
    assert len(ids) == 2 and sorted(each["verb"] for each in runs) == ["run", "run", "sweep"]
    in_table = FAST + '[sweep.over]\n"motion.flight.record.file" = "/etc/passwd"\n'
    assert site.call("POST", "/api/runs", site.opened, json={**body, "text": in_table}).status_code == 422


@pytest.mark.parametrize(
    ("verb", "options"),
    [
        ("app", []),
        ("run", ["set=beam.length=1"]),
        ("fit", ["data=/etc/passwd"]),
        ("fit", ["data=../secret.csv"]),
        ("fit", ["data=not-there.csv"]),
        ("modes", ["at=--out"]),
        ("modes", ["at=1 s", "at=2 s"]),
        ("modes", ["at= "]),
        ("modes", ["gyroscopic=perhaps"]),
        ("modes", ["motion=\x1b[31m"]),
        ("optimize", ["write=x.toml"]),
        ("place", ["write", "write"]),
        ("modes", ["x" * 2000]),
    ],
)
def test_verbs_take_their_own_options_only(site: Site, verb: str, options: list[str]) -> None:
    answer = site.call("POST", "/api/runs", site.opened, json={"text": FAST, "verb": verb, "options": options})
    assert answer.status_code == 422 and not (site.folder / "runs").exists()


def test_refusals_are_answers_where_a_page_asks_for_that(site: Site) -> None:
    body = {"text": FAST, "verb": "app"}
    plain = site.call("POST", "/api/runs", site.opened, json=body)
    asked = site.call("POST", "/api/runs", site.opened | {"x-gbeam-refusal": "1"}, json=body)
    assert (plain.status_code, asked.status_code) == (422, 200) and plain.json() == asked.json()
    assert "x-gbeam-refusal" in asked.headers and not (site.folder / "runs").exists()
    assert "x-gbeam-refusal" not in site.call("GET", "/api/runs", site.opened | {"x-gbeam-refusal": "1"}).headers


def test_values_that_are_distributions_are_swept_only(site: Site) -> None:
    text = FAST.replace('"70 GPa"', '{ normal = ["70 GPa", "2 GPa"] }')
    built = site.call("POST", "/api/document", site.opened, json={"text": text}).json()
    assert built["errors"] == []
    field = next(each for each in _entries(built["form"]) if each["path"] == "beam.material.youngs_modulus")
    assert tomllib.loads(f"x = {field['value']}")["x"] == {"normal": ["70 GPa", "2 GPa"]}
    answer = site.call("POST", "/api/runs", site.opened, json={"text": text})
    assert answer.status_code == 422 and "this needs one value" in answer.json()["errors"][0]["message"]
    body = {"text": text, "verb": "sweep", "options": ["measure=tip.size.max_abs", "samples=4"]}
    assert site.call("POST", "/api/runs", site.opened, json=body).status_code == 200


def test_a_fit_reads_a_file_that_was_dropped(site: Site) -> None:
    site.call("PUT", "/api/records/measured.csv", site.opened, content=b"time,tip.z [mm]\n0,0\n1,1\n")
    body = {"text": FAST, "verb": "fit", "options": ["data=measured.csv", "free=beam.damping_ratio", "write"]}
    number = site.call("POST", "/api/runs", site.opened, json=body).json()["id"]
    assert (site.folder / "runs" / number / "input" / "measured.csv").read_text().startswith("time,tip.z")
    # What is written names records as the scenario does: it has to lie beside them.
    words = json.loads((site.folder / "runs" / number / "state.json").read_text())["arguments"]
    assert words == ["--data=input/measured.csv", "--free=beam.damping_ratio", "--write=input/found.toml"]


@pytest.mark.parametrize("verb", offered())
def test_options_are_the_command_lines(verb: str) -> None:
    data = tomllib.loads(FAST)
    needed = {"optimize": "minimise=tip", "fit": "data=a.csv", "sweep": "over=beam.length=1 m"}.get(verb, "")
    reached = set()
    for option in offered()[verb].options:
        for value in option.choices or [option.example or "flight"]:
            other = [needed] if needed and not needed.startswith(f"{option.name}=") else []
            options = arguments(verb, [option.name if option.ticked else f"{option.name}={value}", *other], data)
            function, bound = parsed([verb, "x.toml", *options])
            assert function.__name__ == verb.replace("-", "_")
            assert value in repr(bound.arguments) or option.ticked
            reached |= {*bound.arguments}
    function, _ = parsed([verb, "x.toml", *([f"--{needed}"] if needed else [])])
    assert "output" in inspect.signature(function).parameters and "*" not in offered()[verb].options  # it has a report
    # None of the command line's is missing, but for those about where it writes and on which machines it runs.
    left = {"scenario", "output", "scheduler", "resume", "yes", "options"}
    assert {*inspect.signature(function).parameters} - reached <= left
    if verb in QUESTIONS:  # those of a question are one argument
        assert {*QUESTIONS[verb].options} <= {each.name.removeprefix("no-") for each in offered()[verb].options}


def test_every_verb_of_a_scenario_is_on_the_page() -> None:
    apart = {"app", "new", "check", "presets", "schema", "report", "rerun"}  # of the page itself, or of no scenario
    assert {*program()} - {*offered()} == apart and {*offered()} <= {*program()}
