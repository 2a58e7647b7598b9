"""A flight's record from the command line: a part of it, what `check` says of it, and what is odd in it."""

from __future__ import annotations

import html
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gbeam as gb

from ..calling import Answer
from ..scenarios import SPECIMEN, model

Call = Callable[..., Answer]

# A pull that is followed, and at 11.2 s a quick one of 3.5 g that the smoothing rounds off.
CORNERS = {0: 1.5, 1: 1.5, 3: 6.0, 4: 6.0, 6: 1.5, 10.65: 1.5, 11.2: 3.5, 11.75: 1.5, 15.99: 1.5}
MACHINE = """\
[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "200 mm"
inverse = "flat"
gravity = true
smoothing = "420 ms"
accept = { peaks = "5 %" }
spin_up = "2 s"
spin_down = "2 s"
"""
SCENARIO = (
    'title = "a quick peak"\n'
    + SPECIMEN
    + model("FOAM", 0, 0, 2)
    + '[motion.flight]\nkind = "flight"\n'
    + '[motion.flight.record]\nfile = "flight.csv"\ntime = "t"\nx = "0"\ny = "0"\nz = "z"\nunit = "g"\n'
    + MACHINE
)
DURATION = '[response]\nduration = "6 s"\n'
TO = "motion.flight.record.to=6 s"
UNJUDGED = "--set", "response.estimate=false"


@pytest.fixture
def scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The record and its scenario, in the current folder."""
    monkeypatch.chdir(tmp_path)
    time = 0.01 * np.arange(1600)
    load = np.interp(time, list(CORNERS), list(CORNERS.values()))
    np.savetxt("flight.csv", np.column_stack([time, load]), delimiter=",", header="t,z", comments="", fmt="%.6g")
    file = tmp_path / "s.toml"
    file.write_text(SCENARIO)
    return file


def test_a_flight_is_not_accepted_by_leaving_out_what_is_missed(scenario: Path, gbeam: Call) -> None:
    """With a duration of 6 s the run was accepted, and the verdict spoke of the flight."""
    whole = gbeam("run", scenario, *UNJUDGED)
    assert (
        whole.status == 1 and "NOT ACCEPTED: error of peaks 6." in whole.err and "3.5 g at 11.20 s, is 6." in whole.out
    )
    assert " of 15.99 s" not in whole.out
    scenario.write_text(SCENARIO + DURATION, encoding="utf-8")
    cut = gbeam("run", scenario)
    assert cut.status == 2
    assert cut.err == (
        f"{scenario}:31:12: response.duration: is 6 s, and the record of 'flight' lasts 15.99 s: "
        "the rest would be left out\n"
        '    31 | duration = "6 s"\n'
        "       |            ^^^^^\n"
        "       = leave it out, or ask for a part on the record itself: "
        'to = "6 s" in [motion.flight.record]\n'
    )


def test_a_part_is_run_where_it_is_asked_for_and_said_first(scenario: Path, gbeam: Call) -> None:
    answer = gbeam("run", scenario, "--set", TO, *UNJUDGED, "--json", "--out", "out")
    (comparison,) = answer.json["comparisons"]
    assert answer.status == 0 and comparison["accepted"]
    assert comparison["verdict"].startswith("PASS for a part of the flight: error of peaks ")
    assert any("from 0 to 6 of 15.99 s, the part that was run" in each for each in comparison["findings"])
    assert comparison["lines"][0].startswith("limits kept for 0 to 6 of 15.99 s only: error of peaks")
    assert comparison["span"] == {"start": 0.0, "end": pytest.approx(6.0)}
    assert comparison["whole"] == {"start": 0.0, "end": 15.99}
    for name in ("flight", "spin"):
        assert answer.json["motions"][name]["whole"] == {"start": 0.0, "end": 15.99}
    said = "motion.flight: 0 to 6 of 15.99 s are flown, and the rest is left out"
    assert said in answer.json["motions"]["flight"]["warnings"]
    tree = xr.open_datatree("out/result.nc")
    assert tree.attrs["verdict"] == comparison["verdict"] and "Verdict" not in tree.attrs
    kept = tree["comparisons/spin"]
    assert [float(kept[name]) for name in ("flight_from", "flight_to", "whole_from", "whole_to")] == pytest.approx(
        [0.0, 6.0, 0.0, 15.99]
    )
    assert float(tree["motions/flight/whole_to"]) == 15.99
    tree.close()
    answer = gbeam("run", scenario, "--set", "motion.flight.record.from=10 s", *UNJUDGED, "--json")
    (later,) = answer.json["comparisons"]
    assert later["verdict"].startswith("NOT ACCEPTED for a part of the flight: error of peaks ")
    assert later["verdict"].endswith("; largest peak missed")
    assert any("from 10 to 15.99 of 15.99 s" in each for each in later["findings"])
    assert gbeam("run", scenario, "--set", "motion.flight.record.to=6 s", "--set", "response.duration=5 s").status == 2


def test_flights_of_other_lengths_have_their_own_times(scenario: Path, gbeam: Call) -> None:
    other = SCENARIO.split("[motion.flight]")[1].split("[motion.spin]")[0].replace("motion.flight", "motion.short")
    scenario.write_text(SCENARIO + "[motion.short]" + other + 'to = "9 s"\n', encoding="utf-8")
    answer = gbeam("check", scenario)
    assert answer.status == 0, answer.err
    assert "response  flight 0 to 15.99 s, short 0 to 9 s" in answer.out
    told = gbeam("check", scenario, "--json").json
    assert told["motions"]["short"]["span"] == {"start": 0.0, "end": 9.0}
    assert "start" not in told["response"]
    refused = gbeam("check", scenario, "--set", "response.duration=9 s")
    assert refused.status == 2
    assert 'ask for a part on the record itself: to = "9 s" in [motion.flight.record]' in refused.err
    same = gbeam("check", scenario, "--set", "motion.flight.record.to=9 s", "--json").json
    assert same["response"]["duration"] == 9.0 and "span" not in same["motions"]["short"]


def test_python_says_the_part_too(scenario: Path) -> None:
    """Of a record, of profiles that end later, and where the machine's run is shorter than the flight's."""
    record = gb.read_record("flight.csv", "t", "0", "0", "z", "g")
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
    structure = gb.assemble(beam, "FOAM", z=1)

    def both(flight: gb.Flight, *, of_machine: float = 6.0) -> gb.Comparison:
        machine = gb.Centrifuge(flight, arm=3.3, control_point=0.2, inverse="flat", gravity=True, smoothing=0.06)
        runs = ((flight, 6.0), (machine, of_machine))
        a, b = (gb.simulate(structure, each, duration=length, step=2e-3, estimate=False) for each, length in runs)
        return gb.compare(a, b, accept={"peaks": 0.05})

    cut = both(gb.Flight(acceleration=record))
    assert (
        cut.whole == (0.0, 15.99)
        and cut.part == "0 to 6 of 15.99 s"
        and "0 to 6 of 15.99 s, the part that was run" in str(cut)
    )
    assert both(gb.Flight(z=gb.tabulated([0, 3, 12], [15.0, 60.0, 15.0]))).part == "0 to 6 of 12 s"
    assert both(gb.Flight(z=gb.tabulated([0, 3, 6], [15.0, 60.0, 15.0]))).part == ""
    assert both(gb.Flight(z=gb.tabulated([0, 3, 6], [15.0, 60.0, 15.0])), of_machine=5.0).part == "0 to 5 of 6 s"


def test_check_says_what_a_record_is(scenario: Path, gbeam: Call) -> None:
    answer = gbeam("check", scenario)
    assert answer.status == 0
    assert answer.out.split("tracks flight\n")[1].split("  response")[0] == (
        "  record    flight: flight.csv, 0 to 15.99 s, specific force\n"
        "                          read and flown\n"
        "            samples       1600 at 100 Hz\n"
        "            x = 0\n"
        "            y = 0\n"
        "            z = z         1.5 to 6 g\n"
        "            largest load  6 g (x 0, y 0, z 6) at 3 s\n"
        "            nowhere level, near 1 g, for a second\n"
    )
    described = gbeam("check", scenario, "--json").json["records"]["flight"]
    assert described["read"] == described["flown"] and described["level"] is None
    assert described["read"]["samples"] == 1600 and described["read"]["rate"] == pytest.approx(100)
    assert described["read"]["largest"] == {"x": 0, "y": 0, "z": pytest.approx(6 * 9.80665)}
    part = gbeam("check", scenario, "--set", "motion.flight.record.from=2 s", "--set", TO)
    assert "flight.csv, 2 to 6 of 15.99 s, specific force\n" in part.out and "401 at 100 Hz" in part.out
    assert "warning: motion.flight: 2 to 6 of 15.99 s are flown, and the rest is left out" in part.out


def test_check_says_what_is_read_beside_what_is_flown(scenario: Path, gbeam: Call) -> None:
    """After lost samples, spikes, cut-off and resampling, which are asked for: no warning says so."""
    rows = Path("flight.csv").read_text(encoding="utf-8").splitlines()
    rows[901:904] = [f"{0.01 * i:.2f},9" for i in (900, 901, 902)]
    del rows[401:405]
    Path("flight.csv").write_text("\n".join(rows), encoding="utf-8")
    asked = ["despike=true", "bridge=50 ms", "cutoff=10 Hz", "resample=200 Hz"]
    answer = gbeam("check", scenario, *[word for each in asked for word in ("--set", f"motion.flight.record.{each}")])
    assert answer.status == 0 and "warning" not in answer.out, answer.err
    table = answer.out.split("specific force\n")[1].split("  response")[0]
    assert table == (
        "                          read                        flown\n"
        "            samples       1596 at 99.75 Hz            3199 at 200 Hz\n"
        "            x = 0\n"
        "            y = 0\n"
        "            z = z         1.5 to 9 g                  1.494 to 6.004 g\n"
        "            largest load  9 g (x 0, y 0, z 9) at 9 s  6.004 g (x 0, y 0, z 6) at 3.03 s\n"
        "            nowhere level, near 1 g, for a second\n"
        "            3 sample(s) that look like spikes, in 1 run(s), the first at 9 s (row 898), were replaced: "
        "z was 1.5 g to 9 g, is 1.5 g to 6 g\n"
        "            low-pass at 10 Hz, zero phase\n"
        "            resampled at 200 Hz\n"
        "            gaps on straight lines, from s   to s         lost  after\n"
        "                                        3.99  4.04          4  row 401\n"
    )


def test_check_and_run_say_what_is_odd_in_a_record(scenario: Path, gbeam: Call) -> None:
    rows = Path("flight.csv").read_text(encoding="utf-8").splitlines()
    z = np.array([float(row.split(",")[1]) for row in rows[1:]])
    odd = np.minimum(z, 5.537)
    odd[800] = 1.9
    lines = [f"{0.01 * i:.2f},{value:g}" for i, value in enumerate(odd)]
    Path("flight.csv").write_text("\n".join(["t,z", *lines]), encoding="utf-8")
    notes = (
        "motion.flight.record: z, column 'z', stands at its extreme, 5.537 g, from 2.8 to 4.2 s (rows 282 to 422): ",
        "motion.flight.record: 1 sample(s) that look like spikes, in 1 run(s), the first at 8 s (row 802), are kept; d",
    )
    checked, ran = gbeam("check", scenario, "--json").json, gbeam("run", scenario, "--set", TO, "--json").json
    for note in notes:
        assert any(warning.startswith(note) for warning in checked["warnings"])
    assert any(warning.startswith(notes[0]) for warning in ran["motions"]["flight"]["warnings"])
    along = [f"motion.flight.record.{each}" for each in ('z="0"', 'x="z"')] + ["motion.spin.idle=1.4 g"]
    arguments = [word for each in along for word in ("--set", each)]
    assert "lies along the beam (x is 5.537 g), which bends it little" in gbeam("check", scenario, *arguments).out


def test_check_draws_what_was_read_over_what_is_flown(gbeam: Call, with_figures: None, tmp_path: Path) -> None:
    examples = Path(__file__).parents[2] / "examples"
    folder = tmp_path / "drawn"
    answer = gbeam("check", examples / "campaign.toml", "--out", folder)
    assert answer.status == 0, answer.err
    pictures = ["file_turn", "record_turn", "record_pull", "record_push"]
    expected = {"check.json"} | {f"{name}.{kind}" for name in pictures for kind in ("png", "svg")}
    assert {file.name for file in folder.iterdir()} == expected
    assert all(file.stat().st_size > 1000 for file in folder.iterdir())
    assert f"9 files in {folder}: check.json, file_turn.png/.svg, record_pull.png/.svg" in answer.out
    told = json.loads((folder / "check.json").read_text(encoding="utf-8"))
    record = told["records"]["push"]
    assert (record["section"], record["sections_by"], len(record["offsets"])) == ("3", "event", 2)
    assert "as_read" not in record and record["offsets"][0]["load"]["z"] == pytest.approx(0.0215 * 9.80665, rel=0.01)
    again = gbeam("check", examples / "campaign.toml", "--out", folder, "--set", "motion.turn.record.sections=nix")
    assert again.status == 2 and {file.name for file in folder.iterdir()} == expected  # nothing is half written
    only = gbeam("check", examples / "campaign.toml", "--out", folder, "--json")
    assert only.json["records"].keys() == {"turn", "pull", "push"} and "files in" not in only.out


def test_the_page_of_check_has_its_words_and_the_records(scenario: Path, gbeam: Call, tmp_path: Path) -> None:
    answer = gbeam("check", scenario, "--out", tmp_path / "checked", "--report")
    page = (tmp_path / "checked" / "check.html").read_text(encoding="utf-8")
    assert answer.status == 0 and "check.html" in answer.out
    first = next(line.strip() for line in answer.out.splitlines() if line.startswith("  record"))
    assert html.escape(first, quote=False) in page and "as flown in base axes" in page
    assert '<span class="badge good">valid</span>' in page
