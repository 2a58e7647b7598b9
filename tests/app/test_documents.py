"""A scenario as text and as fields, and its records."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from ..calling import Answer
from ..scenarios import FAST
from .conftest import Site


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


def test_fields_are_the_documents_values(site: Site) -> None:
    made = site.call("POST", "/api/document", site.opened, json={"text": FAST}).json()
    fields = {each["path"]: each for each in made["fields"]}
    assert fields["beam.length"]["value"] == "300 mm" and fields["beam.damping_ratio"]["value"] == "0.01"
    assert fields["motion.spin.gravity"]["value"] == "false" and "main axis" in fields["motion.spin.arm"]["help"]
    assert made["errors"] == [] and "Scenario valid." in made["meaning"]


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("beam.length", "250 mm", "250 mm"),
        ("beam.section.width", '2" cm', '2" cm'),  # a quotation mark stays inside
        ("beam.damping_ratio", "0.02", 0.02),
        ("beam.damping_ratio", "2 %", "2 %"),
        ("motion.spin.gravity", "true", True),
        ("title", "a\nb", "a\nb"),
    ],
)
def test_an_edit_changes_one_value_and_keeps_comments(site: Site, path: str, value: str, expected: object) -> None:
    text = FAST.replace("[beam]", "[beam]  # a comment\n# and another")
    made = site.call("POST", "/api/edit", site.opened, json={"text": text, "path": path, "value": value}).json()
    before, after = tomllib.loads(text), tomllib.loads(made["text"])
    *tables, key = path.split(".")
    for data in (before, after):
        node = data
        for step in tables:
            node = node[step]
        found = node.pop(key)
    assert found == expected and before == after
    assert "# a comment\n# and another" in made["text"]


@pytest.mark.parametrize("path", ["beam", "beam.nothing", "", "beam..length", "a" * 999])
def test_what_is_not_written_is_not_edited(site: Site, path: str) -> None:
    answer = site.call("POST", "/api/edit", site.opened, json={"text": FAST, "path": path, "value": "1"})
    assert answer.status_code == 422 and answer.json()["errors"]


def test_a_record_takes_the_place_of_a_profile(site: Site) -> None:
    rows = "".join(f"{0.01 * i:.2f},{1 + 0.001 * i}\n" for i in range(101))
    answer = site.call("PUT", "/api/records/pull up.csv", site.opened, content=f"t,n_z\n{rows}".encode())
    assert answer.json() == {"name": "pull up.csv", "columns": ["t", "n_z"]}
    record = {"file": "pull up.csv", "time": "t", "x": "0", "y": "0", "z": "n_z", "unit": "g"}
    text = FAST.replace('level = "6 g"', 'level = "1.2 g"')
    for _ in range(2):  # the second time in place of the first
        body = {"text": text, "motion": "flight", "record": record}
        text = site.call("POST", "/api/record", site.opened, json=body).json()["text"]
        assert tomllib.loads(text)["motion"]["flight"] == {"kind": "flight", "record": record}
    curves = site.call("POST", "/api/preview", site.opened, json={"text": text}).json()
    z = curves["flights"]["flight"][2]
    assert z[0] == pytest.approx(1, abs=1e-3) and z[-1] == pytest.approx(1.05, abs=2e-3)


def test_a_record_takes_the_place_of_the_examples_profile(site: Site) -> None:
    text = site.call("GET", "/api/examples", site.opened).json()["Flight and centrifuge"]
    site.call("PUT", "/api/records/a.csv", site.opened, content=b"t,z\n0,1\n1,1\n")
    record = {"file": "a.csv", "time": "t", "x": "0", "y": "0", "z": "z", "unit": "g"}
    body = {"text": text, "motion": "flight", "record": record}
    after = tomllib.loads(site.call("POST", "/api/record", site.opened, json=body).json()["text"])
    expected = tomllib.loads(text)
    del expected["motion"]["flight"]["acceleration"]
    expected["motion"]["flight"]["record"] = record
    assert after == expected


@pytest.mark.parametrize(
    "text", ["", "motion = 1", "[[motion]]\nx = 1", "[motion]\nflight = 3", "[motion.flight]", "x"]
)
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
        answer = site.call("POST", "/api/sweeps", site.opened, json={"text": text, "over": over, "measure": measure})
        assert answer.status_code == 422 and answer.json()["errors"]
    assert not (site.folder / "runs").exists()


def test_a_case_of_a_sweep_is_run_once(site: Site) -> None:
    body = {"text": FAST, "over": ["beam.length=300 mm, 310 mm"], "measure": "flight.tip.size.max_abs"}
    sweep = site.call("POST", "/api/sweeps", site.opened, json=body).json()["id"]
    ids = {
        site.call("POST", "/api/runs", site.opened, json={"text": FAST, "case": f"{sweep}/0/{j}"}).json()["id"]
        for j in (0, 0, 1)
    }
    runs = site.call("GET", "/api/runs", site.opened).json()
    assert len(ids) == 2 and sorted(each["verb"] for each in runs) == ["run", "run", "sweep"]
    in_table = FAST + '[sweep]\nover = ["motion.flight.record.file=/etc/passwd"]\n'
    assert site.call("POST", "/api/sweeps", site.opened, json={**body, "text": in_table}).status_code == 422
