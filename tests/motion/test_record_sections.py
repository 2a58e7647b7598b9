"""Sections of a record by a column that numbers or names them, and several flights of one file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from gbeam import InputError, read_record
from gbeam.motion import Recording

TIME = np.arange(600) / 50  # s
LOAD = np.stack([0.1 * np.sin(TIME), 0.05 * np.cos(TIME), 1 + 0.5 * np.sin(0.7 * TIME)], axis=1)  # g
OPTIONS: dict[str, Any] = {"time": "time", "x": "ax", "y": "ay", "z": "az", "unit": "g"}
EVENTS = ["0"] * 100 + ["1"] * 150 + ["0"] * 50 + ["2"] * 200 + ["0"] * 100


def written(path: Path, events: Sequence[str], names: str = "time,ax,ay,az,event") -> Path:
    rows = (",".join([*(f"{each:.17g}" for each in (t, *load)), event])
            for t, load, event in zip(TIME, LOAD, events, strict=True))  # fmt: skip
    path.write_text("\n".join([names, *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("section", ["2", "2.0", " 2", "2e0"])
def test_a_section_is_the_samples_at_which_its_column_holds_it(tmp_path: Path, section: str) -> None:
    path = written(tmp_path / "x.csv", EVENTS)
    part = read_record(path, **OPTIONS, sections="event", section=section)
    same = read_record(path, **OPTIONS, span=(float(TIME[300]), float(TIME[499])))
    np.testing.assert_array_equal(part.values, same.values)
    np.testing.assert_array_equal(part.times, TIME[300:500])
    record = part.record
    assert record is not None and (record.sections_by, record.section) == ("event", "2")
    assert record.whole == record.span == pytest.approx((6.0, 9.98))  # a section is no part of a flight
    said = [(each.value, each.start, each.end) for each in record.sections]
    assert said == [("0", 0, 1.98), ("1", 2, 4.98), ("0", 5, 5.98), ("2", 6, 9.98), ("0", 10, 11.98)]


@pytest.mark.parametrize("seed", range(4))
def test_sections_at_random_are_what_np_diff_finds(tmp_path: Path, seed: int) -> None:
    """All sections together are the whole record, each with its own samples and nothing of the others."""
    rng = np.random.default_rng(seed)
    edges = np.sort(rng.choice(np.arange(1, 59), 5, replace=False)) * 10
    names = rng.permutation(["climb", "turn 1", "push", "", "nan", "7"])
    events = [names[np.searchsorted(edges, i, side="right")] for i in range(len(TIME))]
    recording = Recording.read(written(tmp_path / "x.csv", events), **OPTIONS, sections="event")
    expected = {name: LOAD[[each == name for each in events]] for name in names if name not in ("", "nan")}
    assert recording.sections is not None and {*recording.sections.names} == {*expected}
    for name, load in expected.items():
        flown = recording.flight(section=str(name)).acceleration
        np.testing.assert_array_equal(flown.values, load * 9.80665)
        np.testing.assert_array_equal(flown.times, TIME[[each == name for each in events]])


def test_flights_of_a_recording_are_those_that_are_read_one_by_one(tmp_path: Path, monkeypatch: Any) -> None:
    path = written(tmp_path / "x.csv", EVENTS)
    spans = (2.0, 5.0), (None, None), (6.0, 12.0)
    alone = [read_record(path, **OPTIONS, span=span) for span in spans]
    recording = Recording.read(path, **OPTIONS)
    path.unlink()  # what has been read is not read again
    for span, record in zip(spans, alone, strict=True):
        flown = recording.flight(*span).acceleration
        np.testing.assert_array_equal(flown.values, record.values)
        assert flown.record is not None and record.record is not None
        assert flown.record.span == record.record.span and flown.record.done == record.record.done
        assert flown.record.as_read is recording.channels  # one copy of the samples for all


def test_a_matlab_file_numbers_its_sections(tmp_path: Path) -> None:
    columns = {"time": TIME, "ax": LOAD[:, 0], "ay": LOAD[:, 1], "az": LOAD[:, 2]}
    scipy.io.savemat(tmp_path / "x.mat", columns | {"run": np.array(EVENTS, dtype=float)})
    record = read_record(tmp_path / "x.mat", **OPTIONS, sections="run", section="1").record
    assert record is not None and record.span == pytest.approx((2.0, 4.98))


def test_what_is_no_number_matters_only_to_the_flight_that_it_is_in(tmp_path: Path) -> None:
    path = written(tmp_path / "x.csv", EVENTS)
    lines = path.read_text(encoding="utf-8").split("\n")
    lines[1 + 350] = ",".join([*lines[1 + 350].split(",")[:3], "", "2"])
    path.write_text("\n".join(lines), encoding="utf-8")
    recording = Recording.read(path, **OPTIONS, sections="event")
    assert recording.flight(section="1").acceleration.times[0] == 2.0
    with pytest.raises(InputError, match=r"row 352, column 'az' is empty"):
        recording.flight(section="2")


TWICE = ["1"] * 100 + ["0"] * 100 + ["1"] * 200 + ["0"] * 200


@pytest.mark.parametrize(
    ("events", "options", "where", "words"),
    [
        (EVENTS, {"section": "7"}, "section", "is 7, which no section is; column 'event' has 0, 1, 2"),
        (EVENTS, {"section": "tunr"}, "section", "is tunr, which no section is"),
        (EVENTS, {"sections": "evnt", "section": "1"}, "sections", "did you mean 'event'?"),
        (EVENTS, {"sections": "az", "section": "1"}, "sections", "changes 599 times and numbers no sections"),
        (EVENTS, {"sections": None, "section": "1"}, "section", "the record has no sections; name the column"),
        (TWICE, {"section": "1"}, "section", 'stands in 2 stretches: 0 to 1.98 s, 4 to 7.98 s; add from = "4 s"'),
        (EVENTS, {"section": "1", "span": (8.0, 10.0)}, "section", "of which 0 row(s) are flown"),
        (["1"] * 3 + ["0"] * 597, {"section": "1"}, "section", "of which 3 row(s) are flown"),
    ],
)
def test_what_is_no_section_is_refused_at_its_place(
    tmp_path: Path, events: list[str], options: dict[str, Any], where: str, words: str
) -> None:
    path = written(tmp_path / "x.csv", events)
    with pytest.raises(InputError) as caught:
        read_record(path, **OPTIONS, **({"sections": "event"} | options))
    assert caught.value.where == f"record.{where}" and words in f"{caught.value.problem}; {caught.value.fix}"


def test_the_fix_of_a_section_in_several_stretches_works(tmp_path: Path) -> None:
    path = written(tmp_path / "x.csv", TWICE)
    with pytest.raises(InputError, match=r'add from = "4 s", to = "7\.98 s", or those of another'):
        read_record(path, **OPTIONS, sections="event", section="1")
    record = read_record(path, **OPTIONS, sections="event", section="1", span=(4.0, 7.98)).record
    assert record is not None and record.span == pytest.approx((4.0, 7.98))


def test_a_part_of_a_section_is_a_part(tmp_path: Path) -> None:
    path = written(tmp_path / "x.csv", EVENTS)
    record = read_record(path, **OPTIONS, sections="event", section="2", span=(7.0, None)).record
    assert record is not None and record.span == pytest.approx((7.0, 9.98))
    assert record.whole == pytest.approx((6.0, 9.98))
